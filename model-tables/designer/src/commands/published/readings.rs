//! Other readings of the paper's inputs, so that nobody need try them again.

use super::quoted::{EQUATOR_RADIUS, INDENTATIONS, REST_PRESSURE};
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{MembraneError, Press};
use output::Refusal;

/// The paper's skin.
const SKIN: Law = Law::MooneyRivlin {
    c1: 13_400.0,
    c2: 29_500.0,
};
/// A reading of the inputs.
pub(super) struct Reading {
    /// In words.
    pub(super) title: String,
    /// Pressure of the rest state, pascals.
    pub(super) rest_pressure: f64,
    /// Radius of the inflated equator, metres.
    pub(super) equator_radius: f64,
    /// Height over radius of the inflated dome.
    pub(super) aspect: f64,
    /// Volume of the dome, cubic metres.
    pub(super) volume: f64,
    /// Forces at the published indentations, newtons; `None` beyond the end of the press.
    pub(super) forces: [Option<f64>; 3],
}

/// The inputs as printed (last) and four other readings of them.
pub(super) fn readings(design: &Design) -> Result<Vec<Reading>, Refusal> {
    let Membrane {
        radial_semi_axis,
        axial_semi_axis,
        thickness,
    } = design.membrane;
    let stated = reading("as printed".to_owned(), design)?;
    // Pressure, tension and force go with the thickness.
    let thin = thickness * REST_PRESSURE / stated.rest_pressure;
    Ok(vec![
        reading(
            "semi-axes swapped".to_owned(),
            &Design {
                membrane: Membrane {
                    radial_semi_axis: axial_semi_axis,
                    axial_semi_axis: radial_semi_axis,
                    thickness,
                },
                ..*design
            },
        )?,
        reading(
            "inflated to a radius of 9 mm".to_owned(),
            &Design {
                rest: RestBy::EquatorRadius(EQUATOR_RADIUS),
                ..*design
            },
        )?,
        reading("skin for Agilus30".to_owned(), &Design { law: SKIN, ..*design })?,
        reading(
            format!("wall of {:.5} mm, for the published rest pressure", thin * 1e3),
            &Design {
                membrane: Membrane {
                    thickness: thin,
                    ..design.membrane
                },
                ..*design
            },
        )?,
        stated,
    ])
}

fn reading(title: String, design: &Design) -> Result<Reading, Refusal> {
    let failed = |error: MembraneError| Refusal(format!("the paper's design, {title}: {error}"));
    let mut press = Press::new(design, TensionField::Relaxed).map_err(failed)?;
    let rest = *press.rest();
    let mut forces = [None; 3];
    for (force, indentation) in forces.iter_mut().zip(INDENTATIONS) {
        *force = match press.at_indentation(indentation) {
            Ok(state) => Some(state.force),
            Err(MembraneError::BeyondLimit { .. }) => None,
            Err(error) => return Err(failed(error)),
        };
    }
    Ok(Reading {
        rest_pressure: rest.pressure,
        equator_radius: rest.edge_radius,
        aspect: rest.height / rest.edge_radius,
        volume: rest.volume,
        forces,
        title,
    })
}

#[cfg(test)]
mod tests {
    use super::super::paper::Paper;
    use super::*;

    fn near(found: f64, truth: f64, tolerance: f64) {
        assert!((found / truth - 1.0).abs() < tolerance, "{found} for {truth}");
    }

    #[test]
    fn a_thinner_wall_scales_pressure_and_force_alike() {
        let paper = Paper::solve().unwrap_or_else(|Refusal(reason)| panic!("{reason}"));
        let (thin, stated) = (&paper.readings[3], &paper.readings[4]);
        let ratio = REST_PRESSURE / stated.rest_pressure;
        near(thin.rest_pressure, REST_PRESSURE, 1e-9);
        for (thin, stated) in thin.forces.iter().zip(stated.forces) {
            near(
                thin.expect("within the press"),
                ratio * stated.expect("within the press"),
                1e-6,
            );
        }
    }
}
