//! `designer size` of a target with `[transmission]`: haptic loops for a wanted feedback force over touch force.

use crate::size::transmission::target::WantedLoop;
use crate::size::transmission::{self, SizedLoop};
use model_tables::solid::disc::FarSide;
use output::progress::Progress;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal, files};
use std::path::Path;

const COLUMNS: &[&str] = &[
    "rank",
    "material",
    "actuator_material",
    "radial_semi_axis_mm",
    "axial_semi_axis_mm",
    "thickness_mm",
    "actuator_diameter_mm",
    "actuator_thickness_mm",
    "transmission",
    "misfit_percent",
    "touch_force_n",
    "feedback_force_n",
    "pressure_rise_kpa",
    "percent_for_radial_tolerance",
    "percent_for_axial_tolerance",
    "percent_for_thickness_tolerance",
    "percent_for_diameter_tolerance",
    "percent_for_actuator_thickness_tolerance",
    "percent_for_air",
    "percent_for_tube",
    "percent_for_temperature",
];

/// Sizes a loop, and writes the designs to a folder if there is one.
pub(super) fn run(
    file: &Path,
    text: &str,
    best: usize,
    out: Option<&Path>,
) -> Result<CommandAnswer, Refusal> {
    let wanted = WantedLoop::parse(text, &file.display().to_string()).map_err(Refusal::of)?;
    let progress = Progress::new("sizing");
    let (mut found, solved) = transmission::size(&wanted, &|part| progress.set(part));
    progress.finish();
    if found.is_empty() {
        return Err(Refusal::about(
            file,
            &format_args!(
                "no loop within the bounds can be pressed {} mm deep with its pressure in the transducer's range: widen `[bounds]`, or take \
                 another range or material",
                1e3 * wanted.indentation
            ),
        ));
    }
    found.truncate(best);
    let mut rows = Rows::new(COLUMNS);
    for (rank, sized) in found.iter().enumerate() {
        rows.push(row(rank + 1, sized));
    }
    let first = &found[0];
    let mut notes = vec![
        format!(
            "{solved} loops solved; the best has {:.4} for {} wanted ({:.2} % off)",
            first.answer.ratio,
            wanted.ratio,
            100.0 * first.misfit
        ),
        format!(
            "a tolerance of {} mm in every dimension changes its ratio by {:.1} %, {} mm^3 of air by {:.1} %, {} mm^3/kPa of tube by {:.1} %, \
             {} K by {:.2} % (the moduli go with the absolute temperature)",
            1e3 * wanted.tolerance,
            100.0 * first.making(),
            1e9 * wanted.disturbing_air,
            100.0 * first.by_air,
            1e12 * wanted.disturbing_tube,
            100.0 * first.by_tube,
            wanted.disturbing_kelvin,
            100.0 * first.by_temperature
        ),
    ];
    if first.misfit > 0.01 {
        notes.push(
            "the bounds have no loop nearer to the wanted ratio that was found: widen them, or ask for another ratio"
                .to_owned(),
        );
    }
    if let Some(out) = out {
        files::expect_folder(out, &[])?;
        let contents: Vec<(String, Vec<u8>)> = found
            .iter()
            .enumerate()
            .map(|(rank, sized)| {
                let name = format!("{}-{}", wanted.name, rank + 1);
                (format!("{name}.toml"), design(&name, sized, &wanted).into_bytes())
            })
            .collect();
        files::write_all(out, &contents)?;
        notes.push(format!("wrote {} designs to {}", found.len(), out.display()));
    }
    Ok(CommandAnswer { rows, notes })
}

fn row(rank: usize, sized: &SizedLoop) -> Vec<Cell> {
    let mut row = vec![
        Cell::Count(rank),
        Cell::word(sized.candidate.tip.name),
        Cell::word(sized.candidate.actuator.name),
    ];
    row.extend(
        sized
            .candidate
            .dimensions
            .map(|length| Cell::Number(1e3 * length)),
    );
    row.extend([
        Cell::Number(sized.answer.ratio),
        Cell::Number(100.0 * sized.misfit),
        Cell::Number(sized.answer.touch_force),
        Cell::Number(sized.answer.feedback_force),
        Cell::Number(1e-3 * sized.answer.pressure_rise),
    ]);
    row.extend(sized.by_tolerance.map(|part| Cell::Number(100.0 * part)));
    row.extend([sized.by_air, sized.by_tube, sized.by_temperature].map(|part| Cell::Number(100.0 * part)));
    row
}

/// A design file of a loop, for `designer loop`.
fn design(name: &str, sized: &SizedLoop, wanted: &WantedLoop) -> String {
    let micrometres = |metres: f64| libm::round(1e6 * metres) / 1e3;
    let [radial, axial, wall, diameter, thickness] = sized.candidate.dimensions.map(micrometres);
    let over = match wanted.far_side {
        FarSide::Free => String::new(),
        FarSide::Plate { gap } => format!("gap_mm = {:?}\n", micrometres(gap)),
        FarSide::Foundation { gap, stiffness } => format!(
            "gap_mm = {:?}\nfoundation_kpa_per_mm = {:?}\n",
            micrometres(gap),
            1e-6 * stiffness
        ),
    };
    format!(
        "# Sized for `{}`: {:.4} of the touch force at {} mm.\n\
         name = \"{name}\"\n\n\
         [membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\n\
         [material]\npreset = \"{}\"\n\n\
         [model]\nkind = \"auto\"\n\n\
         [fluid]\ncompliance_mm3_per_kpa = {:?}\n\n\
         [actuator]\ndiameter_mm = {diameter:?}\nthickness_mm = {thickness:?}\n{over}trapped_air_mm3 = {:?}\n\n\
         [actuator.material]\npreset = \"{}\"\n\n\
         [press]\nmax_indentation_mm = {:?}\n",
        wanted.name,
        sized.answer.ratio,
        1e3 * wanted.indentation,
        sized.candidate.tip.name,
        1e12 * wanted.tube,
        1e9 * wanted.air,
        sized.candidate.actuator.name,
        micrometres(wanted.indentation),
    )
}
