//! `designer size`: membranes for a wanted force over the indentation.

mod chart;
mod question;
mod transmission;

use super::bench;
use crate::size::confirm::{Confirmed, ConfirmedSizing};
use crate::size::question::SizingQuestion;
use crate::size::target::Target;
use crate::size::transmission::target::WantedLoop;
use output::files;
use output::progress::Progress;
use output::rows::{Cell, Rows, significant};
use output::{CommandAnswer, Refusal};
use std::path::{Path, PathBuf};
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
For a job, give --lightest-touch-n and --greatest-force-n, or a file with [wanted] (see targets/egg.toml). The command finds tips with a
transducer of the catalogue that detect the lightest touch and measure the greatest force, at the given rate, in the given space.
`lightest_touch_n` is the smallest force that is a touch at the end of a grasp: six noise floors and the weather, read through the chip's
tables. For a wall that relaxes, it is the larger value of the relaxed wall and of a press within the grasp. `transducer_step_n` and
`weather_n` are one step of the transducer and the weather within a grasp at that force. The tolerance column is the change of the force at
one pressure for a thicker wall. Designs are ranked by the lightest touch.

TARGET.toml states the wanted force at indentations, bounds for the dimensions and the stretch at rest, the materials to
choose from, the transducer's range, and the manufacturing tolerances (see targets/human-fingertip.toml). Designs that
wrinkle, or exceed the tested strain of their material or the transducer's range, are left out.

Designs are ranked by misfit (misfits below one percent count as equal), then by the effect of the tolerances on the force.
`force_n` has the force at each indentation of the target. Each tolerance column is the change of the force, at the worst of
those indentations, if only that dimension is off by its tolerance and the stretch at rest is kept.

A target with [transmission] is for a haptic loop: fingertip and feedback actuator for a wanted ratio of feedback force to touch force. The
columns give the effect of tolerances, air, tube and temperature on this ratio (see targets/feedback.toml).

Examples:
  cargo designer size --lightest-touch-n 0.05 --greatest-force-n 20 --readings-per-second 200
  cargo designer size model-tables/targets/egg.toml --out sized/
  cargo designer size model-tables/targets/human-fingertip.toml
  cargo designer size model-tables/targets/feedback.toml --out loops/
  cargo designer size model-tables/targets/human-fingertip.toml --best 20 --out sized/";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The target file, or a file with the job in `[wanted]`
    #[arg(required_unless_present = "lightest_touch_n")]
    target: Option<PathBuf>,
    #[command(flatten)]
    words: question::Words,
    /// Catalogue of transducers for a job [default: model-tables/transducers.toml]
    #[arg(long, value_name = "FILE")]
    transducers: Option<PathBuf>,
    /// Number of designs [default: 8 for a target, 3 for a job]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    best: Option<u16>,
    /// Folder for the chart (of a target) and the designs; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Designs of a target where `--best` does not say.
const BEST: u16 = 8;

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let asked = match &arguments.target {
        None => arguments.words.question()?,
        Some(file) => {
            files::keep(file);
            SizingQuestion::read(file).map_err(Refusal::of)?
        }
    };
    if let Some(question) = asked {
        return question::run(question::Asked {
            question,
            transducers: arguments.transducers.as_ref(),
            best: arguments.best,
            out: arguments.out.as_ref(),
        });
    }
    match &arguments.target {
        Some(file) => match std::fs::read_to_string(file) {
            Ok(text) if WantedLoop::is_in(&text) => {
                let best = arguments.best.unwrap_or(BEST).into();
                transmission::run(file, &text, best, arguments.out.as_deref())
            }
            _ => of_target(arguments, file),
        },
        None => Err(Refusal("a target file is needed".to_owned())),
    }
}

/// Membranes for a wanted force over the indentation.
fn of_target(arguments: &Arguments, file: &Path) -> Result<CommandAnswer, Refusal> {
    let target = Target::read(file).map_err(Refusal::of)?;
    if let Some(out) = &arguments.out {
        files::expect_folder(out, &["size.svg"])?;
    }
    let start = Instant::now();
    let progress = Progress::new("sizing");
    let best = arguments.best.unwrap_or(BEST).into();
    let sizing = ConfirmedSizing::of(&target, best, &|part| progress.set(part));
    progress.finish();
    let sizing = sizing.map_err(|reason| Refusal::about(file, &reason))?;
    let mut rows = Rows::new(COLUMNS);
    for (rank, design) in sizing.designs.iter().enumerate() {
        rows.push(row(rank + 1, design, &target, &sizing));
    }
    let seconds = start.elapsed().as_secs_f64();
    let best = &sizing.designs[0].sized;
    let mut notes = vec![
        format!(
            "{} designs found in {} presses of the search and refined, in {seconds:.1} s; the best misses the target by \
             {:.2} % RMS",
            sizing.found.designs.len(),
            sizing.found.solved,
            100.0 * best.misfit
        ),
        format!(
            "a tolerance of {} mm changes the force of the best by {:.1} %: more than that a calibration has to take out",
            1e3 * target.tolerance,
            100.0 * best.making()
        ),
        format!(
            "force, misfit and pressures are those of the model that each wall needs: {}; stretches, tension and tolerances are the membrane's",
            kinds(&sizing.designs)
        ),
    ];
    if let Some(first) = sizing.left_out.first() {
        notes.push(format!(
            "{} designs are left out: they get no tables ({first})",
            sizing.left_out.len()
        ));
    }
    let mut told: Vec<&str> = Vec::new();
    for design in &sizing.designs {
        let material = design.sized.material;
        if !told.contains(&material.name) {
            told.push(material.name);
            notes.push(bench::about(material));
        }
    }
    if let Some(out) = &arguments.out {
        let chart = chart::draw(&target, &sizing.found.designs);
        let mut contents = vec![("size.svg".to_owned(), chart.into_bytes())];
        for (rank, design) in sizing.designs.iter().enumerate() {
            let name = format!("{}-{}", target.name, rank + 1);
            contents.push((format!("{name}.toml"), design.design_file(&name).into_bytes()));
        }
        files::write_all(out, &contents)?;
        notes.push(format!(
            "wrote size.svg and {} designs to {}",
            sizing.designs.len(),
            out.display()
        ));
    }
    Ok(CommandAnswer { rows, notes })
}

/// The models of some designs, each once.
fn kinds(confirmed: &[Confirmed]) -> String {
    let mut names: Vec<String> = Vec::new();
    for name in confirmed
        .iter()
        .filter_map(|found| found.kind)
        .map(|kind| kind.to_string())
    {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(", ")
}

fn row(rank: usize, design: &Confirmed, target: &Target, sizing: &ConfirmedSizing) -> Vec<Cell> {
    let sized = &design.sized;
    let membrane = &sized.design.membrane;
    let forces: Vec<String> = sized.forces.iter().map(|force| significant(*force, 4)).collect();
    let [radial, axial, wall] = sized.by_tolerance.map(|part| Cell::Number(100.0 * part));
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
        Cell::word(if sizing.is_non_dominated(design) {
            "yes"
        } else {
            "no"
        }),
    ]
}
