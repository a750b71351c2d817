//! The feedback actuator: a flat round membrane that the fluid presses against the wearer's skin.
//!
//! Shi, Shariati, Eames and Wurdemann, Soft Matter 18 (2022) 9076, eqs. 20 and 21: a free diameter `d_f` grows to
//! the contact diameter `d = d_f / (1 - P / E)`, and the blocked force is the pressure on that contact,
//! `F = P pi d^2 / 4`. `E` is Young's modulus in the undeformed state, `6 (C1 + C2)` of a Mooney-Rivlin law.
//!
//! The volume change is that of an incompressible face: its volume `pi d_f^2 / 4 h0` stays, so that it thins by
//! `h0 (1 - (d_f / d)^2)` over the free area. (The paper's `d_f dh` is an area.)

use crate::material::Hyperelastic;
use core::f64::consts::FRAC_PI_4;
use core::fmt;

/// Free diameter of the paper's actuator, metres: the default of a design.
pub const FREE_DIAMETER: f64 = 9e-3;

/// The feedback membrane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator {
    /// Free diameter `d_f`, metres, > 0.
    pub free_diameter: f64,
    /// Undeformed thickness `h0`, metres, > 0.
    pub thickness: f64,
    /// Young's modulus in the undeformed state `E`, pascals, > 0.
    pub youngs_modulus: f64,
}

/// The feedback membrane against the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocked {
    /// Contact diameter, metres.
    pub contact_diameter: f64,
    /// Blocked force, newtons.
    pub blocked_force: f64,
    /// Volume that the face gives way to, cubic metres.
    pub volume_change: f64,
}

/// Why the actuator has no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ActuatorError {
    /// A gauge pressure is a number of at least 0.
    NotAPressure {
        /// What was asked for, pascals.
        asked: f64,
    },
    /// At a pressure of Young's modulus the contact diameter is infinite.
    BeyondPole {
        /// What was asked for, pascals.
        asked: f64,
        /// Young's modulus, pascals.
        pole: f64,
    },
}

impl fmt::Display for ActuatorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotAPressure { asked } => write!(
                f,
                "actuator pressure {} kPa is not possible: it must be a number of at least 0",
                asked / 1e3
            ),
            Self::BeyondPole { asked, pole } => write!(
                f,
                "actuator pressure {} kPa is not below {:.6} kPa, the Young's modulus at which the contact diameter \
                 becomes infinite; ask for less, or take a stiffer material",
                asked / 1e3,
                pole / 1e3
            ),
        }
    }
}

impl core::error::Error for ActuatorError {}

impl Actuator {
    /// An actuator of a law; free diameter and thickness in metres.
    pub fn new(free_diameter: f64, thickness: f64, law: &impl Hyperelastic) -> Self {
        Self {
            free_diameter,
            thickness,
            youngs_modulus: 3.0 * law.shear_modulus(),
        }
    }

    /// The membrane at a gauge pressure in pascals, 0 up to less than Young's modulus.
    ///
    /// # Errors
    /// [`ActuatorError`].
    pub fn at_pressure(&self, pressure: f64) -> Result<Blocked, ActuatorError> {
        if !(pressure >= 0.0 && pressure.is_finite()) {
            return Err(ActuatorError::NotAPressure { asked: pressure });
        }
        if pressure >= self.youngs_modulus {
            return Err(ActuatorError::BeyondPole {
                asked: pressure,
                pole: self.youngs_modulus,
            });
        }
        let strain = pressure / self.youngs_modulus;
        let contact_diameter = self.free_diameter / (1.0 - strain);
        let free_area = FRAC_PI_4 * self.free_diameter * self.free_diameter;
        Ok(Blocked {
            contact_diameter,
            blocked_force: pressure * FRAC_PI_4 * contact_diameter * contact_diameter,
            // 1 - (d_f / d)^2 = 1 - (1 - P/E)^2, without the difference.
            volume_change: free_area * self.thickness * strain * (2.0 - strain),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Law;

    const AGILUS30: Law = Law::MooneyRivlin {
        c1: 160_355.0,
        c2: 46_559.0,
    };

    fn actuator() -> Actuator {
        Actuator::new(9e-3, 1e-3, &AGILUS30)
    }

    fn near(found: f64, truth: f64, tolerance: f64) {
        assert!((found / truth - 1.0).abs() < tolerance, "{found} for {truth}");
    }

    #[test]
    fn agilus30_has_the_values_worked_by_hand() {
        // E = 6 (160355 + 46559) Pa.
        near(actuator().youngs_modulus, 1_241_484.0, 1e-15);
        // P/E = 0.0144182, d = 9 mm / 0.9855818, area 63.61725 mm^2 / 0.9713715.
        let state = actuator().at_pressure(17_900.0).expect("below the pole");
        near(state.contact_diameter, 9.131_662e-3, 1e-6);
        near(state.blocked_force, 1.172_31, 1e-5);
        // P/E = 0.0144464: 63.61725 mm^2 x 1 mm x (1 - 0.9855536^2).
        let state = actuator().at_pressure(17_935.0).expect("below the pole");
        near(state.volume_change, 1.8248e-9, 1e-4);
    }

    #[test]
    fn every_law_has_three_times_its_shear_modulus() {
        // Small strains of W = C1 (I1 - 3): E = 6 C1; the higher constants of Yeoh do not enter.
        let of = |law: Law| Actuator::new(9e-3, 1e-3, &law).youngs_modulus;
        near(of(Law::NeoHookean { c1: 1e5 }), 6e5, 1e-15);
        let yeoh = Law::Yeoh {
            c1: 1e5,
            c2: -1e4,
            c3: 1e3,
        };
        near(of(yeoh), 6e5, 1e-15);
    }

    #[test]
    fn no_pressure_leaves_the_membrane_flat() {
        let state = actuator().at_pressure(0.0).expect("below the pole");
        near(state.contact_diameter, 9e-3, 1e-15);
        assert!(state.blocked_force.abs() < f64::MIN_POSITIVE);
        assert!(state.volume_change.abs() < f64::MIN_POSITIVE);
    }

    #[test]
    fn the_pole_and_what_is_no_pressure_are_refused() {
        let pole = actuator().youngs_modulus;
        assert!(actuator().at_pressure(0.999 * pole).is_ok());
        for asked in [pole, 2.0 * pole] {
            let refused = Err(ActuatorError::BeyondPole { asked, pole });
            assert_eq!(actuator().at_pressure(asked), refused);
        }
        for asked in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                actuator().at_pressure(asked),
                Err(ActuatorError::NotAPressure { .. })
            ));
        }
    }
}
