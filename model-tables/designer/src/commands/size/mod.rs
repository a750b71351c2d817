//! `designer size`: membranes for a wanted force over the indentation.

mod chart;
mod transmission;

use super::bench;
use crate::size::target::Target;
use crate::size::transmission::target::WantedLoop;
use crate::size::{self, Sized};
use output::files;
use output::progress::Progress;
use output::rows::{Cell, Rows, significant};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;
use std::time::Instant;

const COLUMNS: &[&str] = &[
    "rank",
    "material",
    "radial_semi_axis_mm",
    "axial_semi_axis_mm",
    "thickness_mm",
    "pole_stretch",
    "misfit_percent",
    "force_n",
    "rest_pressure_kpa",
    "peak_pressure_kpa",
    "largest_stretch",
    "share_of_tested_strain",
    "min_tension_n_per_m",
    "wrinkled",
    "limit_mm",
    "limit_over_deepest",
    "force_percent_for_radial_tolerance",
    "force_percent_for_axial_tolerance",
    "force_percent_for_thickness_tolerance",
    "non_dominated",
];

/// What `--help` says after the options.
pub(super) const HELP: &str = "\
TARGET.toml names the force wanted at indentations, bounds for the dimensions and the stretch at rest, materials to
choose from, the transducer's range, and how exactly a dimension is made (see targets/human-fingertip.toml).
Designs that wrinkle, leave the strain their material was tested in, or leave the transducer's range are left out.

Designs are ranked by misfit (misfits under a percent count alike), then by what making them does to the force.
`force_n` has the force at each indentation of the target. The tolerance columns say by how much the force changes, at the
worst of those indentations, when that dimension alone is off by the tolerance and the stretch at rest is kept.

A target with [transmission] is one of a haptic loop: fingertip and feedback actuator for a wanted feedback force over touch force, with what tolerances,
air, tube and temperature do to that (see targets/feedback.toml).

Examples:
  cargo designer size model-tables/targets/human-fingertip.toml
  cargo designer size model-tables/targets/feedback.toml --out loops/
  cargo designer size model-tables/targets/human-fingertip.toml --best 20 --out sized/";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The target file
    target: PathBuf,
    /// Designs to give
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=100))]
    best: u16,
    /// Folder to write the chart and the designs to; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    files::keep(&arguments.target);
    if let Ok(text) = std::fs::read_to_string(&arguments.target)
        && WantedLoop::is_in(&text)
    {
        let out = arguments.out.as_deref();
        return transmission::run(&arguments.target, &text, arguments.best.into(), out);
    }
    let target = Target::read(&arguments.target).map_err(Refusal::of)?;
    if let Some(out) = &arguments.out {
        files::expect_folder(out, &["size.svg"])?;
    }
    let start = Instant::now();
    let progress = Progress::new("sizing");
    let mut sizing = size::size(&target, &|part| progress.set(part));
    progress.finish();
    let seconds = start.elapsed().as_secs_f64();
    if sizing.designs.is_empty() {
        return Err(Refusal::about(&arguments.target, &size::NOTHING_FOUND));
    }
    let found = sizing.designs.len();
    let all = sizing.designs.clone();
    sizing.designs.truncate(arguments.best.into());
    let mut rows = Rows::new(COLUMNS);
    for (rank, sized) in sizing.designs.iter().enumerate() {
        rows.push(row(rank + 1, sized, &target, &all));
    }
    let best = &sizing.designs[0];
    let mut notes = vec![
        format!(
            "{found} designs found in {} presses of the search and refined, in {seconds:.1} s; the best misses the target by \
             {:.2} % RMS",
            sizing.solved,
            100.0 * best.misfit
        ),
        format!(
            "a tolerance of {} mm changes the force of the best by {:.1} %: more than that a calibration has to take out",
            1e3 * target.tolerance,
            100.0 * best.making()
        ),
        "these are membranes: where the wall is thick and little stretched it also bends; solve the choice again with \
         `[model] kind = \"solid\"`"
            .to_owned(),
    ];
    let mut told: Vec<&str> = Vec::new();
    for sized in &sizing.designs {
        if !told.contains(&sized.material.name) {
            told.push(sized.material.name);
            notes.push(bench::about(sized.material));
        }
    }
    if let Some(out) = &arguments.out {
        let mut contents = vec![("size.svg".to_owned(), chart::draw(&target, &all).into_bytes())];
        for (rank, sized) in sizing.designs.iter().enumerate() {
            let name = format!("{}-{}", target.name, rank + 1);
            contents.push((
                format!("{name}.toml"),
                sized.design_file(&name, &target).into_bytes(),
            ));
        }
        let contents: Vec<(&str, Vec<u8>)> = contents
            .iter()
            .map(|(name, content)| (name.as_str(), content.clone()))
            .collect();
        files::write_all(out, &contents)?;
        notes.push(format!(
            "wrote size.svg and {} designs to {}",
            sizing.designs.len(),
            out.display()
        ));
    }
    Ok(CommandAnswer { rows, notes })
}

fn row(rank: usize, sized: &Sized, target: &Target, all: &[Sized]) -> Vec<Cell> {
    let membrane = &sized.design.membrane;
    let forces: Vec<String> = sized.forces.iter().map(|force| significant(*force, 4)).collect();
    let [radial, axial, wall] = sized.by_tolerance.map(|part| Cell::Number(100.0 * part));
    let front = !all.iter().any(|other| other.dominates(sized));
    vec![
        Cell::Count(rank),
        Cell::word(sized.material.name),
        Cell::Number(1e3 * membrane.radial_semi_axis),
        Cell::Number(1e3 * membrane.axial_semi_axis),
        Cell::Number(1e3 * membrane.thickness),
        Cell::Number(sized.stretch()),
        Cell::Number(100.0 * sized.misfit),
        Cell::Text(forces.join(" ")),
        Cell::Number(1e-3 * sized.rest_pressure),
        Cell::Number(1e-3 * sized.peak_pressure),
        Cell::Number(sized.largest_stretch),
        sized
            .strain_share
            .map_or_else(|| Cell::word("not known"), Cell::Number),
        Cell::Number(sized.least_tension),
        Cell::word(sized.wrinkling.word()),
        Cell::Number(1e3 * sized.limit),
        Cell::Number(sized.limit_margin(target)),
        radial,
        axial,
        wall,
        Cell::word(if front { "yes" } else { "no" }),
    ]
}
