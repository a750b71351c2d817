//! What every subcommand says of a design's material and calibration.

use super::warn;
use model_tables::design_file::{Calibration, DesignFile};
use model_tables::material::preset::Preset;
use model_tables::model::Fingertip;
use model_tables::model::ModelError;
use std::path::Path;

/// The depth to press to, metres, for what the bench's stage reads, millimetres: from first touch on.
pub(super) fn depth(calibration: &Calibration, read_mm: f64) -> f64 {
    let read = read_mm / 1e3;
    if read < 0.0 {
        // As it was asked, so that it is refused as it was asked.
        read
    } else {
        calibration.indentation_of(read).max(0.0)
    }
}

/// An error of the model in the frame of the bench.
pub(super) fn as_read(calibration: &Calibration, error: impl Into<ModelError>) -> ModelError {
    error
        .into()
        .read_by(|metres| calibration.indentation_read(metres))
}

/// What a report says of the design's material.
pub(super) fn caution(design: &DesignFile) -> Option<String> {
    Preset::of(&design.material).map(about)
}

/// Source, range, rate and caution of a material, on one line.
pub(super) fn about(preset: &Preset) -> String {
    let strain = preset.strain.map_or_else(
        || "strain range not stated".to_owned(),
        |strain| format!("strain up to {:.0} %", 100.0 * strain),
    );
    format!(
        "{}: {}; {strain}, rate {}; {}",
        preset.title, preset.source, preset.rate, preset.caution
    )
}

/// Points of a membrane's meridian at which its strain is looked at.
const POINTS: usize = 61;
/// Warns when the state at `depth` metres (0 is rest) leaves the range of strain that the material was fitted in.
pub(super) fn warn_of_strain(file: &Path, design: &DesignFile, tip: &mut Fingertip, depth: f64) {
    if let Some(reason) = beyond_strain(design, tip, depth) {
        warn(file, &reason);
    }
}

/// What to say when the state at `depth` metres (0 is rest) leaves the range of strain that the material was fitted in.
pub(super) fn beyond_strain(design: &DesignFile, tip: &mut Fingertip, depth: f64) -> Option<String> {
    let preset = Preset::of(&design.material)?;
    let most = preset.largest_invariant()?;
    let reached = match tip {
        Fingertip::Membrane(press) => press
            .profile(depth, POINTS)
            .ok()?
            .map(|point| {
                let [a, b] = [point.meridional_stretch, point.hoop_stretch].map(|stretch| stretch * stretch);
                a + b + 1.0 / (a * b) - 3.0
            })
            .fold(0.0, f64::max),
        Fingertip::Solid(press) => press.largest_invariant(depth).ok()? - 3.0,
    };
    (reached > most).then(|| {
        format!(
            "at indentation {} mm the stretches reach I1 - 3 = {reached:.2}, beyond {most:.2} up to which the constants of \
             {} were fitted; stretch or press less, or fit the law further",
            depth * 1e3,
            preset.title
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stage_touches_first_at_its_offset() {
        let calibration = Calibration {
            indentation_offset_mm: 0.2,
            ..Calibration::default()
        };
        assert!((depth(&calibration, 0.5) - 0.3e-3).abs() < 1e-15);
        assert!(depth(&calibration, 0.1).abs() < 1e-300);
        assert!(depth(&calibration, -0.1) < 0.0);
    }
}
