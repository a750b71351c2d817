//! The inputs with which the chip's lookup is compared with the host's: 12 292 of them, everywhere in and around the
//! tables of a design.

use fingertip::signal::contact::contact;
use fingertip::signal::design::{Design, Parameters};
use fingertip::signal::report::Contact;
use fingertip::signal::report::Measurement;
use fingertip::status::Warnings;
use fingertip::units::Pressure;
use model_tables::units::PressureRise;

/// Every count from 0: the segments are narrowest there.
const CONSECUTIVE: i64 = 4096;

/// Evenly spaced from a sixteenth below zero to a sixteenth beyond the end.
const SPREAD: i64 = 8192;

/// The ends of what a rise can be, and the neighbours of zero.
const CORNERS: [i32; 4] = [i32::MIN, -1, i32::MAX - 1, i32::MAX];

/// How many inputs there are.
pub const LENGTH: usize = CONSECUTIVE as usize + SPREAD as usize + CORNERS.len();

/// The inputs, in the order the chip answers them.
pub fn inputs(design: &Parameters) -> impl Iterator<Item = PressureRise> + use<> {
    let constants = &design.constants;
    let rise = constants.maximum_pressure.saturating_sub(constants.rest_pressure);
    // Below 2^31, so that the products below stay under 2^31 * 18/16 * 2^13.
    let end = i64::from(Pressure::from_pascals(rise, design.pressure_fraction_bits).0);
    let consecutive = 0..CONSECUTIVE;
    let spread = (0..SPREAD).map(move |i| end * 18 / 16 * i / SPREAD - end / 16);
    consecutive
        .chain(spread)
        .chain(CORNERS.map(i64::from))
        .map(PressureRise::held)
}

/// What chip and host answer to an input.
pub fn answer(design: &impl Design, rise: PressureRise) -> Measurement {
    let Contact {
        force,
        indentation,
        warnings,
    } = contact(design, rise, Warnings::NONE);
    Measurement {
        pressure_rise: rise,
        force,
        indentation,
        warnings,
        ..Measurement::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fingertip::image::ImageDesign;
    use fingertip::image::generated::{NAME, TABLES};
    use fingertip::signal::loaded_design::LoadedDesign;
    use model_tables::block::write::TipData;

    #[test]
    fn a_loaded_block_answers_as_the_image_does() {
        let block = TipData {
            constants: ImageDesign::CONSTANTS,
            layout: TABLES.layout,
            words: TABLES.segments.as_flattened(),
            name: NAME,
            calibration: None,
            relaxation: None,
            object: None,
            feedback: None,
        }
        .write();
        let (loaded, _) = LoadedDesign::read(&block).expect("the image's tables can be loaded");
        let mut answers = 0;
        for rise in inputs(&ImageDesign::PARAMETERS) {
            assert_eq!(answer(&loaded, rise), answer(&ImageDesign, rise), "{rise:?}");
            answers += 1;
        }
        assert_eq!(answers, LENGTH);
    }

    #[test]
    fn the_sweep_covers_the_tables_and_both_sides() {
        let end = ImageDesign::PARAMETERS.last_rise.0;
        let inputs: Vec<i32> = inputs(&ImageDesign::PARAMETERS).map(|rise| rise.0).collect();
        assert_eq!(inputs.len(), LENGTH);
        assert_eq!(inputs[4095], 4095);
        assert!(inputs[4096] < 0);
        let beyond = inputs.iter().filter(|&&rise| rise > end).count();
        assert!((400..600).contains(&beyond), "{beyond}");
        let within = inputs.iter().filter(|rise| (0..=end).contains(rise)).count();
        assert!(within > LENGTH * 9 / 10, "{within}");
    }
}
