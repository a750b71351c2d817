//! The local equations of the membrane: equilibrium at one point of the meridian.
//!
//! Everything here is dimensionless: lengths over the radial semi-axis `a0`, stresses over the law's shear
//! modulus `mu`, pressures over `mu h0 / a0`.
//!
//! Undeformed meridian `x = sin t`, `y = beta cos t`, arc rate `g`. The state is `u = l2 = rho / x` and
//! `w = p / x` with `p = x W_1 cos(phi)`; the first integral of the free zone gives
//! `k = q / x = x W_1 sin(phi) / x = P (rho^2 - rho_c^2) / (2 x)`, so that neither the pole nor a vertical tangent
//! is singular:
//!
//! ```text
//! n = sqrt(w^2 + k^2) = W_1(l1, u)          gives l1
//! u' = (l1 g cos(phi) - x' u) / x           cos(phi) = w / n
//! w' = (g (W_2 - P l1 u x sin(phi)) - x' w) / x   sin(phi) = k / n
//! ```
//!
//! Under a plate `k = 0`, `phi = 0`, and `n = w` keeps its sign. On a frictionless sphere of curvature `c` (of a ball above, of a cup
//! below 0) the tangent is known, `sin(phi) = -c rho`, and what is left of equilibrium is that along it, `(x W_1)' = g cos(phi) W_2`:
//!
//! ```text
//! n = w / cos(phi)                          gives l1
//! u' = (l1 g cos(phi) - x' u) / x
//! w' = (g (W_2 cos^2(phi) - c^2 rho l1 x n) - x' w) / x
//! ```
//!
//! The vertical balance of the contact zone gives the force, `F = pi P rho_c^2 - 2 pi h0 x_c W_1 sin(phi_c)`. With `rho_F` from
//! `F = pi P rho_F^2` the free zone's first integral is `q = P (rho^2 - rho_F^2) / 2` whatever touches: that radius, which is the
//! contact's own under a plate alone, is the parameter here, and at the contact's edge both zones have one tangent.
//!
//! ```text
//! P (rho_c^2 - rho_F^2) / 2 + c rho_c x_c n_c = 0
//! ```
//!
//! A membrane that cannot push takes the relaxed
//! energy (Pipkin 1986; Steigmann 1990): where hoop wrinkles stand, `W_2 = 0` and `l1` follows from the energy
//! `W(l1, l1^-1/2)` of uniaxial tension.

mod sphere;

use crate::material::{Derivatives, Hyperelastic};
use crate::solver::collocation::GaussPoint;
use core::f64::consts::PI;

/// Index of the pole parameter among the parameters of the problem (pole stretch, or edge of the slack core).
pub const POLE: usize = 0;
/// Index of the pressure.
pub const PRESSURE: usize = 1;
/// Index of the radius of the disc on which the pressure makes up the force: under a plate the deformed contact radius.
pub const CONTACT_RADIUS: usize = 2;
/// Index of the contact parameter, the `t` of the contact edge.
pub const CONTACT_PARAMETER: usize = 3;

/// Index of the height among the integrals.
pub const HEIGHT: usize = 0;
/// Index of the volume.
pub const VOLUME: usize = 1;

/// Whether the membrane may push.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TensionField {
    /// Compression relaxed into wrinkles and slack: what a thin sheet does.
    #[default]
    Relaxed,
    /// The membrane equations as they stand, with negative tensions where they come out so.
    Plain,
}

/// The two zones of a pressed membrane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    /// On what touches.
    Contact,
    /// Free, carrying the pressure.
    Free,
}

impl Zone {
    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Contact => "contact",
            Self::Free => "free",
        }
    }
}

/// Response of the constitutive law at a point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Response {
    /// Meridional stretch.
    pub l1: f64,
    /// `W_2`, dimensionless, zero where hoop wrinkles stand.
    pub w2: f64,
    /// `dl1/dn`, dimensionless.
    pub l1_by_n: f64,
    /// `dl1/du`, dimensionless.
    pub l1_by_u: f64,
    /// `dW_2/dl1`.
    w2_by_l1: f64,
    /// `dW_2/du` at fixed `l1`.
    w2_by_u: f64,
    /// Hoop wrinkles stand here.
    pub wrinkled: bool,
}

/// The membrane: shape and law, dimensionless.
#[derive(Clone, Copy, Debug)]
pub struct LocalEquations<L> {
    /// Axial over radial semi-axis.
    pub aspect: f64,
    /// The law over its shear modulus.
    pub law: L,
    /// Whether it may push.
    pub tension_field: TensionField,
    /// Curvature of the object, over `1 / a0`: 0 for a plate, above 0 for a ball, below 0 for a cup.
    pub curvature: f64,
}

/// The undeformed meridian at a point.
#[derive(Clone, Copy, Debug)]
pub struct Meridian {
    /// Radius `x = sin t`, over the radial semi-axis.
    pub x: f64,
    /// `x' = cos t`, dimensionless.
    pub x_rate: f64,
    /// Arc rate `g`, over the radial semi-axis.
    pub arc_rate: f64,
}

impl<L: Hyperelastic> LocalEquations<L> {
    /// The undeformed meridian at `t` (0 = pole, pi/2 = equator).
    #[inline]
    pub fn meridian(&self, t: f64) -> Meridian {
        let (x, x_rate) = libm::sincos(t);
        self.meridian_of(x, x_rate)
    }

    #[inline]
    fn meridian_of(&self, x: f64, x_rate: f64) -> Meridian {
        let y_rate = self.aspect * x;
        Meridian {
            x,
            x_rate,
            arc_rate: libm::sqrt(x_rate * x_rate + y_rate * y_rate),
        }
    }

    /// The meridian at `fractions` of an interval: one sine and cosine at its middle, the addition theorems around it.
    #[inline]
    pub fn meridians<const S: usize>(&self, start: f64, length: f64, fractions: &[f64; S]) -> [Meridian; S] {
        if length > LONGEST_SERIES {
            return fractions.map(|f| self.meridian(start + f * length));
        }
        let (sin, cos) = libm::sincos(start + 0.5 * length);
        fractions.map(|f| {
            let d = (f - 0.5) * length;
            let q = d * d;
            // Taylor's series to d^14: the rest is below 1e-17 for |d| <= 0.25.
            let s = d
                * (1.0
                    - q / 6.0
                        * (1.0
                            - q / 20.0
                                * (1.0
                                    - q / 42.0 * (1.0 - q / 72.0 * (1.0 - q / 110.0 * (1.0 - q / 156.0))))));
            let c = 1.0
                - q / 2.0
                    * (1.0
                        - q / 12.0
                            * (1.0
                                - q / 30.0
                                    * (1.0
                                        - q / 56.0
                                            * (1.0 - q / 90.0 * (1.0 - q / 132.0 * (1.0 - q / 182.0))))));
            self.meridian_of(sin * c + cos * s, cos * c - sin * s)
        })
    }

    /// Inverts `W_1(l1, u) = n` for the meridional stretch, from `guess`. `None` where the law gives no answer.
    #[inline]
    pub fn respond(&self, n: f64, u: f64, guess: f64) -> Option<Response> {
        if self.tension_field == TensionField::Relaxed && u < 1.0 && n >= 0.0 {
            let (l1, slope) = self.uniaxial(n, guess)?;
            if u * u * l1 < 1.0 {
                return Some(Response {
                    l1,
                    l1_by_n: 1.0 / slope,
                    wrinkled: true,
                    ..Response::default()
                });
            }
        }
        let (l1, d) = self.invert(n, u, guess)?;
        let by_n = 1.0 / d.w11;
        Some(Response {
            l1,
            w2: d.w2,
            l1_by_n: by_n,
            l1_by_u: -d.w12 * by_n,
            w2_by_l1: d.w12,
            w2_by_u: d.w22,
            wrinkled: false,
        })
    }

    /// `l1` with `W_1(l1, u) = n`, and the law there.
    #[inline]
    fn invert(&self, n: f64, u: f64, guess: f64) -> Option<(f64, Derivatives)> {
        let mut l1 = guess;
        for _ in 0..MAX_INVERSIONS {
            let d = self.law.derivatives(l1, u);
            let step = (n - d.w1) / d.w11;
            if d.w11.is_nan() || d.w11 <= 0.0 {
                return None;
            }
            l1 = (l1 + step).clamp(0.5 * l1, 2.0 * l1);
            if step.abs() < INVERSION_TOLERANCE * l1 {
                let d = if step.abs() < 1e-15 * l1 {
                    d
                } else {
                    self.law.derivatives(l1, u)
                };
                return Some((l1, d));
            }
        }
        None
    }

    /// `l1` with `W_1(l1, l1^-1/2) = n`, and the slope of that function.
    pub fn uniaxial(&self, n: f64, guess: f64) -> Option<(f64, f64)> {
        let mut l1 = guess.max(1.0);
        for _ in 0..MAX_INVERSIONS {
            let root = libm::sqrt(l1);
            let d = self.law.derivatives(l1, 1.0 / root);
            let slope = d.w11 - 0.5 * d.w12 / (l1 * root);
            if slope.is_nan() || slope <= 0.0 {
                return None;
            }
            let step = (n - d.w1) / slope;
            l1 = (l1 + step).clamp(0.5 * l1, 2.0 * l1);
            if step.abs() < INVERSION_TOLERANCE * l1 {
                return Some((l1, slope));
            }
        }
        None
    }

    /// `n = W_1` at a point: the meridional tension times `l2 / h0`, signed under the plate.
    pub fn tension_measure(
        &self,
        zone: Zone,
        t: f64,
        [u, w]: [f64; 2],
        pressure: f64,
        contact_radius: f64,
    ) -> f64 {
        match zone {
            Zone::Contact if self.curvature != 0.0 => {
                w / self.contact_cosine(u * libm::sin(t)).unwrap_or(1.0)
            }
            Zone::Contact => w,
            Zone::Free => {
                let x = libm::sin(t);
                let rho = u * x;
                let k = 0.5 * pressure * (rho * rho - contact_radius * contact_radius) / x;
                libm::sqrt(w * w + k * k)
            }
        }
    }

    /// Right-hand side, integrands (height, volume) and derivatives at a point; also the response there.
    ///
    /// `None` where the state is not one a membrane can be in: no tension in the free zone, or stretches at which
    /// the law has lost its stability.
    #[inline]
    pub fn point(
        &self,
        zone: Zone,
        meridian: &Meridian,
        [u, w]: [f64; 2],
        pressure: f64,
        contact_radius: f64,
        guess: f64,
    ) -> Option<(GaussPoint, Response)> {
        if zone == Zone::Contact && self.curvature != 0.0 {
            return self.on_sphere(meridian, [u, w], guess);
        }
        let Meridian {
            x,
            x_rate,
            arc_rate: g,
        } = *meridian;
        let g_t = (self.aspect * self.aspect - 1.0) * x * x_rate / g;
        let over_x = 1.0 / x;
        let mut point = GaussPoint::default();
        if zone == Zone::Contact {
            let r = self.respond(w, u, guess)?;
            let rate = [(g * r.l1 - x_rate * u) * over_x, (g * r.w2 - x_rate * w) * over_x];
            point.rate = rate;
            point.rate_by_state = [
                [(g * r.l1_by_u - x_rate) * over_x, g * r.l1_by_n * over_x],
                [
                    g * (r.w2_by_u + r.w2_by_l1 * r.l1_by_u) * over_x,
                    (g * r.w2_by_l1 * r.l1_by_n - x_rate) * over_x,
                ],
            ];
            point.rate_by_position = [
                (g_t * r.l1 + x * u - rate[0] * x_rate) * over_x,
                (g_t * r.w2 + x * w - rate[1] * x_rate) * over_x,
            ];
            return Some((point, r));
        }
        let rho = u * x;
        let (rho_squared, radius_squared) = (rho * rho, contact_radius * contact_radius);
        let k_by_pressure = 0.5 * (rho_squared - radius_squared) * over_x;
        let k = pressure * k_by_pressure;
        let k_u = pressure * rho;
        let k_radius = -pressure * contact_radius * over_x;
        let k_t = 0.5 * pressure * (rho_squared + radius_squared) * over_x * over_x * x_rate;
        let n = libm::sqrt(w * w + k * k);
        if n.is_nan() || n <= 0.0 || u.is_nan() || u <= 0.0 {
            return None;
        }
        let r = self.respond(n, u, guess)?;
        let over_n = 1.0 / n;
        let (cos, sin) = (w * over_n, k * over_n);
        // l1 cos(phi), l1 sin(phi) and their derivatives by w, k and (through l1 alone) u.
        let (forward, down) = (r.l1 * cos, r.l1 * sin);
        let turn = r.l1 * over_n;
        let cross = cos * sin * (r.l1_by_n - turn);
        let forward_w = cos * cos * r.l1_by_n + sin * sin * turn;
        let down_k = sin * sin * r.l1_by_n + cos * cos * turn;
        let (forward_k, down_w) = (cross, cross);
        let (forward_u, down_u) = (cos * r.l1_by_u + forward_k * k_u, sin * r.l1_by_u + down_k * k_u);

        let rate_0 = (g * forward - x_rate * u) * over_x;
        let load = pressure * rho;
        let hoop = r.w2 - load * down;
        let hoop_w = r.w2_by_l1 * r.l1_by_n * cos - load * down_w;
        let hoop_k = r.w2_by_l1 * r.l1_by_n * sin - load * down_k;
        let hoop_u =
            r.w2_by_u + r.w2_by_l1 * r.l1_by_u - pressure * x * down - load * sin * r.l1_by_u + hoop_k * k_u;
        let rate_1 = (g * hoop - x_rate * w) * over_x;
        point.rate = [rate_0, rate_1];
        let scale = g * over_x;
        point.rate_by_state = [
            [(g * forward_u - x_rate) * over_x, scale * forward_w],
            [scale * hoop_u, (g * hoop_w - x_rate) * over_x],
        ];
        point.rate_by_position = [
            (g_t * forward + g * forward_k * k_t + x * u - rate_0 * x_rate) * over_x,
            (g_t * hoop + g * (hoop_k * k_t - pressure * u * x_rate * down) + x * w - rate_1 * x_rate)
                * over_x,
        ];
        point.rate_by_parameter[0][PRESSURE] = scale * forward_k * k_by_pressure;
        point.rate_by_parameter[0][CONTACT_RADIUS] = scale * forward_k * k_radius;
        point.rate_by_parameter[1][PRESSURE] = scale * (hoop_k * k_by_pressure - rho * down);
        point.rate_by_parameter[1][CONTACT_RADIUS] = scale * hoop_k * k_radius;

        let descent = g * down;
        let descent_by_state = [g * down_u, g * down_w];
        let descent_t = g_t * down + g * down_k * k_t;
        let descent_by_pressure = g * down_k * k_by_pressure;
        let descent_by_radius = g * down_k * k_radius;
        let area = PI * rho_squared;
        point.integrand = [descent, area * descent];
        point.integrand_by_state = [
            descent_by_state,
            [
                2.0 * PI * rho * x * descent + area * descent_by_state[0],
                area * descent_by_state[1],
            ],
        ];
        point.integrand_by_position = [
            descent_t,
            area * descent_t + 2.0 * PI * rho * u * x_rate * descent,
        ];
        point.integrand_by_parameter[HEIGHT][PRESSURE] = descent_by_pressure;
        point.integrand_by_parameter[HEIGHT][CONTACT_RADIUS] = descent_by_radius;
        point.integrand_by_parameter[VOLUME][PRESSURE] = area * descent_by_pressure;
        point.integrand_by_parameter[VOLUME][CONTACT_RADIUS] = area * descent_by_radius;
        Some((point, r))
    }
}

/// Longest interval of [`LocalEquations::meridians`] over which the series are summed.
const LONGEST_SERIES: f64 = 0.5;
/// Newton steps the inversion of the law may take; four suffice from a guess a factor of two off.
const MAX_INVERSIONS: usize = 60;
/// A step this small, relative to the stretch, leaves an error of its square.
const INVERSION_TOLERANCE: f64 = 1e-8;

#[cfg(test)]
mod tests;
