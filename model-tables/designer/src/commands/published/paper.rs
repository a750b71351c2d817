//! The paper's numbers, and what its stated inputs give.
//!
//! Shi, Shariati, Eames and Wurdemann, Soft Matter 18 (2022) 9076. Nothing here is tuned towards them.

use super::quoted::{
    ASPECT, BLOCKED_FORCE, BLOCKED_PRESSURE, EQUATOR_RADIUS, FORCES, HOOP_STRETCH, INDENTATIONS,
    REST_PRESSURE, VOLUME, VOLUME_CHANGE, VOLUME_CHANGE_PRESSURE,
};
use super::readings::{Reading, readings};
use super::shipped;
use core::f64::consts::{FRAC_PI_4, PI};
use model_tables::actuator::{Actuator, Blocked, FREE_DIAMETER};
use model_tables::design::{Design, RestBy};
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{MembraneError, Press};
use model_tables::membrane::state::{PressShape, PressedState};
use output::Refusal;

/// A published number and ours, in the unit that its name states.
pub(super) struct Row {
    /// Name of the quantity, with its unit.
    pub(super) quantity: &'static str,
    /// In words.
    pub(super) title: &'static str,
    /// The paper's.
    pub(super) published: f64,
    /// What the stated inputs give.
    pub(super) here: f64,
    /// Why they differ, where that is known.
    pub(super) reason: String,
}

/// Force at the published indentations by three readings of "pressure times contact area", newtons.
pub(super) struct Forces {
    /// Total pressure on the deformed contact: the force.
    pub(super) total: [f64; 3],
    /// Pressure over that of the rest state on the deformed contact.
    pub(super) of_rise: [f64; 3],
    /// Total pressure on the undeformed area of the contact.
    pub(super) on_undeformed: [f64; 3],
}

/// Everything the page says about the paper.
pub(super) struct Paper {
    pub(super) rows: Vec<Row>,
    pub(super) forces: Forces,
    pub(super) readings: Vec<Reading>,
    /// Contact diameter that the published blocked force would need, metres.
    pub(super) blocked_diameter: f64,
    /// Contact diameter of the formula at that pressure, metres.
    pub(super) contact_diameter: f64,
    /// Blocked force of the formula, newtons, and its volume change, cubic metres, each at its published pressure.
    pub(super) blocked_force: f64,
    pub(super) volume_change: f64,
    /// End of the press, metres, and what the paper puts in its place: inflated height less undeformed height.
    pub(super) limit: f64,
    pub(super) height_difference: f64,
}

impl Paper {
    /// Solves the stated inputs and the other readings of them.
    pub(super) fn solve() -> Result<Self, Refusal> {
        let file = shipped(
            "paper-prestretched.toml",
            include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../designs/paper-prestretched.toml"
            )),
        )?;
        let design = file.design();
        let failed = |error: MembraneError| Refusal(format!("the paper's design: {error}"));
        let mut press = Press::new(&design, TensionField::Relaxed).map_err(failed)?;
        let rest = *press.rest();
        let mut states = Vec::new();
        for indentation in INDENTATIONS {
            states.push(press.at_indentation(indentation).map_err(failed)?);
        }
        let at = |of: &dyn Fn(&PressedState) -> f64| core::array::from_fn(|i| of(&states[i]));
        let a0 = design.membrane.radial_semi_axis;
        let forces = Forces {
            total: at(&|state| state.force),
            of_rise: at(&|state| state.pressure_rise * state.contact_area()),
            on_undeformed: at(&|state| {
                let radius = a0 * libm::sin(state.contact_parameter);
                state.shape.pressure * PI * radius * radius
            }),
        };
        let limit = press.limit().map_err(failed)?.indentation;

        let wide = Design {
            rest: RestBy::EquatorRadius(EQUATOR_RADIUS),
            ..design
        };
        let wide_press = Press::new(&wide, TensionField::Relaxed).map_err(failed)?;

        let actuator = Actuator::new(FREE_DIAMETER, design.membrane.thickness, &design.law);
        let of_actuator = |pressure: f64| {
            actuator
                .at_pressure(pressure)
                .map_err(|error| Refusal(format!("the paper's actuator: {error}")))
        };
        let blocked = of_actuator(BLOCKED_PRESSURE)?;
        let changed = of_actuator(VOLUME_CHANGE_PRESSURE)?;
        let blocked_diameter = libm::sqrt(BLOCKED_FORCE / (FRAC_PI_4 * BLOCKED_PRESSURE));

        let numbers = Numbers {
            rest,
            at_published_radius: *wide_press.rest(),
            hoop_stretch: rest.edge_radius / a0,
            forces: forces.total,
            blocked,
            changed,
        };
        Ok(Self {
            rows: numbers.rows(),
            forces,
            readings: readings(&design)?,
            blocked_diameter,
            contact_diameter: blocked.contact_diameter,
            blocked_force: blocked.blocked_force,
            volume_change: changed.volume_change,
            limit,
            height_difference: rest.height - design.membrane.axial_semi_axis,
        })
    }
}

/// What the rows are made of.
struct Numbers {
    rest: PressShape,
    /// The rest state with the published equator radius.
    at_published_radius: PressShape,
    hoop_stretch: f64,
    forces: [f64; 3],
    /// The actuator at [`BLOCKED_PRESSURE`].
    blocked: Blocked,
    /// The actuator at [`VOLUME_CHANGE_PRESSURE`].
    changed: Blocked,
}

impl Numbers {
    fn rows(&self) -> Vec<Row> {
        let wide = &self.at_published_radius;
        let radius_reason = format!(
            "9 mm needs a pole stretch of {:.3}, not 2.3; it is the outer radius of the printed part",
            wide.pole_stretch
        );
        let aspect_reason = format!(
            "inflated to a radius of 9 mm it would be {:.4}; 7/9 = 0.778 is the outer shape of the printed part",
            wide.height / wide.edge_radius
        );
        let mut rows = vec![
            row(
                "rest_pressure_kpa",
                "rest pressure, kPa",
                REST_PRESSURE * 1e-3,
                self.rest.pressure * 1e-3,
                "plausibly the misprinted equations, see below",
            ),
            row(
                "equator_radius_mm",
                "radius of the inflated equator, mm",
                EQUATOR_RADIUS * 1e3,
                self.rest.edge_radius * 1e3,
                &radius_reason,
            ),
            row(
                "aspect",
                "height over radius of the inflated dome",
                ASPECT,
                self.rest.height / self.rest.edge_radius,
                &aspect_reason,
            ),
            row(
                "equator_hoop_stretch",
                "hoop stretch of the equator",
                HOOP_STRETCH,
                self.hoop_stretch,
                "the same number as the radius: 9 mm over 4.5 mm",
            ),
        ];
        let titles = [
            ("force_at_0.5_mm_n", "force at 0.5 mm, N"),
            ("force_at_1.5_mm_n", "force at 1.5 mm, N"),
            ("force_at_2.0_mm_n", "force at 2 mm, N"),
        ];
        for (i, (quantity, title)) in titles.into_iter().enumerate() {
            let reason = "no reading of the inputs gives it, see below";
            rows.push(row(quantity, title, FORCES[i], self.forces[i], reason));
        }
        rows.extend([
            row(
                "volume_mm3",
                "volume of the fluid, mm^3",
                VOLUME * 1e9,
                self.rest.volume * 1e9,
                "published through 1.38 mm^3 being 0.432 % of it; reason not known",
            ),
            row(
                "blocked_force_at_17.9_kpa_n",
                "blocked force of the actuator at 17.9 kPa, N",
                BLOCKED_FORCE,
                self.blocked.blocked_force,
                "the paper's formula at its stated inputs; reason not known",
            ),
            row(
                "actuator_volume_change_at_17.935_kpa_mm3",
                "volume change of the actuator at 17.935 kPa, mm^3",
                VOLUME_CHANGE * 1e9,
                self.changed.volume_change * 1e9,
                "the printed product of diameter and height change is an area, not a volume",
            ),
        ]);
        rows
    }
}

fn row(quantity: &'static str, title: &'static str, published: f64, here: f64, reason: &str) -> Row {
    Row {
        quantity,
        title,
        published,
        here,
        reason: reason.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> Paper {
        Paper::solve().unwrap_or_else(|Refusal(reason)| panic!("{reason}"))
    }

    fn near(found: f64, truth: f64, tolerance: f64) {
        assert!((found / truth - 1.0).abs() < tolerance, "{found} for {truth}");
    }

    /// An independent solution of the stated inputs, to the digits it was given with.
    #[test]
    fn the_stated_inputs_give_what_an_independent_solution_gave() {
        let paper = paper();
        let truth = [
            179.06, 8.575, 0.9425, 1.906, 1.470, 8.371, 15.05, 1242.0, 1.17, 1.82,
        ];
        for (row, truth) in paper.rows.iter().zip(truth) {
            near(row.here, truth, 3e-3);
        }
        assert_eq!(paper.rows.len(), truth.len());
        assert!(paper.rows[1].reason.contains("2.407"));
        for (found, truth) in paper.forces.of_rise.iter().zip([0.050, 1.369, 3.82]) {
            near(*found, truth, 1e-2);
        }
        for (found, truth) in paper.forces.on_undeformed.iter().zip([0.285, 1.655, 2.95]) {
            near(*found, truth, 3e-3);
        }
        near(paper.limit, 4.166e-3, 1e-3);
        near(paper.height_difference, 5.38e-3, 1e-3);
    }
}
