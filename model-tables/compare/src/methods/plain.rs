//! The plain membrane as the methods for comparison integrate it.
//!
//! Dimensionless: lengths over `a0`, stresses over the shear modulus `mu`, pressures over `mu h0 / a0`. State
//! `rho` (deformed radius) and `p = x W_1 cos(phi)` over the meridian's parameter `t`; with the first integral
//! `q = x W_1 sin(phi) = P rho^2 / 2 - load`, `load = P rho_c^2 / 2 = F / 2 pi`, nothing is singular but the pole:
//!
//! ```text
//! N = sqrt(p^2 + q^2),  W_1(l1, rho / x) = N / x,  cos(phi) = p / N,  sin(phi) = q / N
//! rho' = l1 g cos(phi)      p' = g (W_2 - P l1 rho sin(phi))
//! height' = l1 g sin(phi)   volume' = pi rho^2 height'
//! ```
//!
//! Under the plate `q = 0` and `N = p` keeps its sign. Beside the state run its variations by three parameters.

use super::MethodFailure;
use core::f64::consts::PI;
use model_tables::design::{Design, RestBy};
use model_tables::material::stability;
use model_tables::material::{Derivatives, Hyperelastic, Law, Scaled};
use model_tables::membrane::state::UnitScale;

/// Components of the state in the free zone: radius, `p`, height, volume.
pub const STATE: usize = 4;
/// Parameters whose variations are carried along.
pub const VARIED: usize = 3;
/// The state of the free zone and its variations.
pub type Free = [f64; STATE * (1 + VARIED)];
/// Radius and `p` under the plate, and their variation by the pole stretch.
pub type ContactState = [f64; 4];

/// Index of the radius.
pub const RADIUS: usize = 0;
/// Index of `p`.
pub const THRUST: usize = 1;
/// Index of the height.
pub const HEIGHT: usize = 2;
/// Index of the volume.
pub const VOLUME: usize = 3;

/// The membrane of a design, dimensionless.
#[derive(Clone, Copy, Debug)]
pub struct PlainMembrane {
    /// Axial over radial semi-axis.
    pub aspect: f64,
    /// The law over its shear modulus.
    pub law: Scaled<Law>,
    /// Units.
    pub scale: UnitScale,
    /// Pole stretch of the rest state.
    pub pole_stretch: f64,
    /// Compliance of tubing, actuator and bubbles, dimensionless: over that of the membrane's units.
    pub compliance: f64,
    /// The law may lose its stability, so that it has to be watched: some constant of it is negative.
    pub watched: bool,
}

/// What loads the free zone, and its variation by the three parameters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Load {
    /// Pressure, dimensionless.
    pub pressure: f64,
    /// Plate force over `2 pi`.
    pub load: f64,
    /// Variations of the dimensionless pressure.
    pub pressure_by: [f64; VARIED],
    /// Variations of the dimensionless load.
    pub load_by: [f64; VARIED],
}

/// What an integration remembers from stage to stage.
#[derive(Clone, Copy, Debug)]
pub struct LastStretches {
    /// The last meridional stretch: the next one is near.
    pub stretch: f64,
    /// What was met on the way.
    pub met: Met,
}

/// What an integration met on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// Least of `W_1` and `W_2`, dimensionless: below zero some tension is negative.
    pub least: f64,
    /// The law was not stable somewhere.
    pub unstable: bool,
}

impl Met {
    /// Nothing yet.
    pub const NOTHING: Self = Self {
        least: f64::INFINITY,
        unstable: false,
    };

    /// Takes note of a point with its stretches.
    pub fn note(&mut self, problem: &PlainMembrane, [l1, l2]: [f64; 2], [w1, w2]: [f64; 2]) {
        self.least = self.least.min(w1).min(w2);
        if problem.watched && !self.unstable {
            self.unstable = !stability::margin(&problem.law, l1, l2).is_stable();
        }
    }
}

impl LastStretches {
    /// Nothing met yet; stretches near `stretch` to come.
    pub fn new(stretch: f64) -> Self {
        Self {
            stretch,
            met: Met::NOTHING,
        }
    }
}

/// Newton steps of the inversion of the law.
const MAX_INVERSIONS: usize = 40;

impl PlainMembrane {
    /// The membrane of a design.
    ///
    /// # Errors
    /// [`MethodFailure::RestNotByPoleStretch`].
    pub fn new(design: &Design) -> Result<Self, MethodFailure> {
        let RestBy::PoleStretch(pole_stretch) = design.rest else {
            return Err(MethodFailure::RestNotByPoleStretch);
        };
        let modulus = design.law.shear_modulus();
        let scale = UnitScale::new(&design.membrane, modulus);
        Ok(Self {
            aspect: design.membrane.axial_semi_axis / design.membrane.radial_semi_axis,
            law: Scaled {
                law: design.law,
                factor: 1.0 / modulus,
            },
            scale,
            pole_stretch,
            compliance: design.compliance * scale.pressure / scale.volume(),
            watched: match design.law {
                Law::NeoHookean { c1 } => c1 < 0.0,
                Law::MooneyRivlin { c1, c2 } => c1.min(c2) < 0.0,
                Law::Yeoh { c1, c2, c3 } => c1.min(c2).min(c3) < 0.0,
            },
        })
    }

    /// Undeformed radius, its rate, and the arc rate at `t`.
    pub fn meridian(&self, t: f64) -> (f64, f64, f64) {
        let (sin, cos) = libm::sincos(t);
        let axial = self.aspect * sin;
        (sin, cos, libm::sqrt(cos * cos + axial * axial))
    }

    /// The law at the meridional stretch with `W_1(l1, u) = n`.
    pub fn invert(&self, n: f64, u: f64, memory: &mut LastStretches) -> Option<Derivatives> {
        let mut l1 = memory.stretch;
        for _ in 0..MAX_INVERSIONS {
            let d = self.law.derivatives(l1, u);
            if d.w11.is_nan() || d.w11 <= 0.0 {
                return None;
            }
            let step = (n - d.w1) / d.w11;
            l1 = (l1 + step).clamp(0.5 * l1, 2.0 * l1);
            if step.abs() < 1e-9 * l1 {
                memory.stretch = l1;
                memory.met.note(self, [l1, u], [n, d.w2]);
                return Some(self.law.derivatives(l1, u));
            }
        }
        None
    }

    /// Second-order coefficient of `rho / x` at the pole, and the curvature `phi / t` there.
    ///
    /// With `u = u0 + u2 t^2` in the equations above, `16 W_11 u2 = (beta^2 - kappa^2) (w0 + (3 W_11 - W_12) u0)`.
    fn pole_series(&self, pole_stretch: f64, pressure: f64) -> (f64, f64, Derivatives) {
        let d = self.law.derivatives(pole_stretch, pole_stretch);
        let curvature = 0.5 * pressure * pole_stretch * pole_stretch / d.w1;
        let second = (self.aspect * self.aspect - curvature * curvature)
            * (d.w1 + (3.0 * d.w11 - d.w12) * pole_stretch)
            / (16.0 * d.w11);
        (second, curvature, d)
    }

    /// The state at a small `t` under the plate.
    pub fn contact_start(&self, t: f64, pole_stretch: f64) -> ContactState {
        let (second, _, d) = self.pole_series(pole_stretch, 0.0);
        let x = libm::sin(t);
        // W_1 = w0 + W_11 l12 t^2 + W_12 u2 t^2 with l12 = 3 u2 - u0 beta^2 / 2.
        let stretch = 3.0 * second - 0.5 * pole_stretch * self.aspect * self.aspect;
        let thrust = d.w11 * stretch + d.w12 * second;
        [
            x * (pole_stretch + second * t * t),
            x * (d.w1 + thrust * t * t),
            x,
            x * (d.w11 + d.w12),
        ]
    }

    /// The state at a small `t` of a membrane without a plate; its first parameter is the pole stretch.
    pub fn free_start(&self, t: f64, pole_stretch: f64, pressure: f64) -> Free {
        let (second, curvature, d) = self.pole_series(pole_stretch, pressure);
        let x = libm::sin(t);
        let square = curvature * curvature;
        let stretch = 3.0 * second - 0.5 * pole_stretch * (self.aspect * self.aspect - square);
        // p = x W_1 cos(phi).
        let thrust = d.w11 * stretch + d.w12 * second - 0.5 * square * d.w1;
        let mut y = [0.0; STATE * (1 + VARIED)];
        y[RADIUS] = x * (pole_stretch + second * t * t);
        // W_1 at the stretches of t, times cos(phi).
        y[THRUST] = x * (d.w1 + thrust * t * t);
        y[HEIGHT] = 0.5 * pole_stretch * curvature * t * t;
        y[STATE + RADIUS] = x;
        y[STATE + THRUST] = x * (d.w11 + d.w12);
        y
    }

    /// Rates under the plate.
    pub fn contact_rates(
        &self,
        t: f64,
        y: &ContactState,
        memory: &mut LastStretches,
    ) -> Option<ContactState> {
        let (x, _, g) = self.meridian(t);
        let (u, n) = (y[0] / x, y[1] / x);
        let d = self.invert(n, u, memory)?;
        let l1 = memory.stretch;
        let (u_by, n_by) = (y[2] / x, y[3] / x);
        let l1_by = (n_by - d.w12 * u_by) / d.w11;
        Some([g * l1, g * d.w2, g * l1_by, g * (d.w12 * l1_by + d.w22 * u_by)])
    }

    /// Rates in the free zone.
    pub fn free_rates(&self, t: f64, y: &Free, load: &Load, memory: &mut LastStretches) -> Option<Free> {
        let (x, _, g) = self.meridian(t);
        let (rho, p) = (y[RADIUS], y[THRUST]);
        let q = 0.5 * load.pressure * rho * rho - load.load;
        let tension = libm::sqrt(p * p + q * q);
        if tension.is_nan() || tension <= 0.0 || rho.is_nan() || rho <= 0.0 {
            return None;
        }
        let (cos, sin) = (p / tension, q / tension);
        let d = self.invert(tension / x, rho / x, memory)?;
        let l1 = memory.stretch;
        let descent = g * l1 * sin;
        let area = PI * rho * rho;
        let push = load.pressure * rho;
        let mut rates = [0.0; STATE * (1 + VARIED)];
        rates[RADIUS] = g * l1 * cos;
        rates[THRUST] = g * d.w2 - push * descent;
        rates[HEIGHT] = descent;
        rates[VOLUME] = area * descent;
        for k in 0..VARIED {
            let at = STATE * (1 + k);
            let (rho_by, p_by) = (y[at + RADIUS], y[at + THRUST]);
            let q_by = push * rho_by + 0.5 * rho * rho * load.pressure_by[k] - load.load_by[k];
            let tension_by = cos * p_by + sin * q_by;
            let u_by = rho_by / x;
            let l1_by = (tension_by / x - d.w12 * u_by) / d.w11;
            let cos_by = (p_by - cos * tension_by) / tension;
            let sin_by = (q_by - sin * tension_by) / tension;
            let descent_by = g * (l1_by * sin + l1 * sin_by);
            rates[at + RADIUS] = g * (l1_by * cos + l1 * cos_by);
            rates[at + THRUST] = g * (d.w12 * l1_by + d.w22 * u_by)
                - (load.pressure_by[k] * rho + load.pressure * rho_by) * descent
                - push * descent_by;
            rates[at + HEIGHT] = descent_by;
            rates[at + VOLUME] = 2.0 * PI * rho * rho_by * descent + area * descent_by;
        }
        Some(rates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model_tables::design::Membrane;
    use model_tables::object::Object;

    fn problem() -> PlainMembrane {
        PlainMembrane::new(&Design {
            membrane: Membrane {
                radial_semi_axis: 9e-3,
                axial_semi_axis: 7e-3,
                thickness: 1e-3,
            },
            law: Law::MooneyRivlin { c1: 2e5, c2: 4e4 },
            rest: RestBy::PoleStretch(1.3),
            compliance: 0.0,
            object: Object::PLATE,
        })
        .expect("by pole stretch")
    }

    #[test]
    fn variations_are_derivatives() {
        let problem = problem();
        let rates = |rho: f64, p: f64, pressure: f64, load: f64| {
            let mut y = [0.0; STATE * (1 + VARIED)];
            (y[RADIUS], y[THRUST]) = (rho, p);
            // One parameter varies radius, one the thrust, one pressure and load.
            y[STATE + RADIUS] = 1.0;
            y[2 * STATE + THRUST] = 1.0;
            let load = Load {
                pressure,
                load,
                pressure_by: [0.0, 0.0, 1.0],
                load_by: [0.0, 0.0, 0.5],
            };
            problem
                .free_rates(0.8, &y, &load, &mut LastStretches::new(1.3))
                .expect("admissible")
        };
        let h = 1e-5;
        let (rho, p, pressure, load) = (0.95, 0.4, 1.1, 0.05);
        let exact = rates(rho, p, pressure, load);
        let slopes = [
            (
                rates(rho + h, p, pressure, load),
                rates(rho - h, p, pressure, load),
            ),
            (
                rates(rho, p + h, pressure, load),
                rates(rho, p - h, pressure, load),
            ),
            (
                rates(rho, p, pressure + h, load + 0.5 * h),
                rates(rho, p, pressure - h, load - 0.5 * h),
            ),
        ];
        for (k, (above, below)) in slopes.iter().enumerate() {
            for i in 0..STATE {
                let slope = (above[i] - below[i]) / (2.0 * h);
                let found = exact[STATE * (1 + k) + i];
                assert!((found - slope).abs() < 1e-8, "{k} {i}: {found} {slope}");
            }
        }
    }

    /// Fourth-order defect: the series solves the equations to its order.
    #[test]
    fn the_series_at_the_pole_solves_the_equations() {
        let problem = problem();
        let (stretch, pressure) = (1.3, 0.9);
        let defect = |t: f64| {
            let h = 1e-3 * t;
            let free = |t: f64| problem.free_start(t, stretch, pressure);
            let load = Load {
                pressure,
                ..Load::default()
            };
            let rates = problem
                .free_rates(t, &free(t), &load, &mut LastStretches::new(stretch))
                .expect("admissible");
            let contact = |t: f64| problem.contact_start(t, stretch);
            let under = problem
                .contact_rates(t, &contact(t), &mut LastStretches::new(stretch))
                .expect("admissible");
            let slope = |of: &dyn Fn(f64) -> f64| (of(t + h) - of(t - h)) / (2.0 * h);
            (0..2)
                .map(|i| {
                    (rates[i] - slope(&|t| free(t)[i]))
                        .abs()
                        .max((under[i] - slope(&|t| contact(t)[i])).abs())
                })
                .fold(0.0, f64::max)
        };
        let (coarse, fine) = (defect(0.1), defect(0.05));
        assert!(coarse < 1e-3 && coarse / fine > 12.0, "{coarse:e} {fine:e}");
    }
}
