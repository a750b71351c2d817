//! `designer materials`: the materials that a design can name.

use super::bench;
use model_tables::material::Law;
use model_tables::material::preset::PRESETS;
use output::CommandAnswer;
use output::rows::{Cell, Rows};

const COLUMNS: &[&str] = &[
    "preset",
    "law",
    "c1_pa",
    "c2_pa",
    "c3_pa",
    "largest_strain_percent",
    "rate",
];

pub(super) fn run() -> CommandAnswer {
    let mut rows = Rows::new(COLUMNS);
    for preset in &PRESETS {
        let (law, constants) = match preset.law {
            Law::NeoHookean { c1 } => ("neo-hookean", [c1, 0.0, 0.0]),
            Law::MooneyRivlin { c1, c2 } => ("mooney-rivlin", [c1, c2, 0.0]),
            Law::Yeoh { c1, c2, c3 } => ("yeoh", [c1, c2, c3]),
        };
        let [c1, c2, c3] = constants.map(Cell::Number);
        let strain = preset
            .strain
            .map_or_else(|| Cell::word("not stated"), |strain| Cell::Number(100.0 * strain));
        rows.push(vec![
            Cell::word(preset.name),
            Cell::word(law),
            c1,
            c2,
            c3,
            strain,
            Cell::word(preset.rate),
        ]);
    }
    let mut notes: Vec<String> = PRESETS.iter().map(bench::about).collect();
    notes.push(
        "published moduli of one product differ by a factor of two: calibrate a part with `designer fit`"
            .to_owned(),
    );
    CommandAnswer { rows, notes }
}
