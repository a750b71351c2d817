//! Hyperelastic laws of an incompressible membrane.
//!
//! A law is its strain-energy density `W(l1, l2)` per undeformed volume, with the thickness stretch
//! eliminated by incompressibility (`l3 = 1 / (l1 l2)`), and the derivatives of it. Anything that implements
//! [`Hyperelastic`] can be solved; [`Law`] collects the laws a design file can name, [`preset`] materials with their
//! constants.

pub mod preset;
pub mod relaxation;
pub mod series;
pub mod stability;

/// First and second derivatives of the strain energy with respect to the principal stretches, in pascals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// `dW/dl1`, pascals.
    pub w1: f64,
    /// `dW/dl2`, pascals.
    pub w2: f64,
    /// `d2W/dl1^2`, pascals.
    pub w11: f64,
    /// `d2W/dl1 dl2`, pascals.
    pub w12: f64,
    /// `d2W/dl2^2`, pascals.
    pub w22: f64,
}

/// An isotropic, incompressible hyperelastic law in membrane form.
pub trait Hyperelastic {
    /// Strain-energy density, joules per cubic metre (pascals), at the in-plane stretches `l1, l2 > 0`.
    fn energy(&self, l1: f64, l2: f64) -> f64;

    /// Derivatives of the energy at the in-plane stretches `l1, l2 > 0`, in pascals.
    fn derivatives(&self, l1: f64, l2: f64) -> Derivatives;

    /// Shear modulus in the undeformed state, pascals (Young's modulus is three times it).
    fn shear_modulus(&self) -> f64;
}

/// Strain-energy density of the membrane, with its constants in pascals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// `W = C1 (I1 - 3)`.
    NeoHookean {
        /// `C1`, pascals.
        c1: f64,
    },
    /// `W = C1 (I1 - 3) + C2 (I2 - 3)`.
    MooneyRivlin {
        /// `C1`, pascals.
        c1: f64,
        /// `C2`, pascals.
        c2: f64,
    },
    /// `W = C1 (I1 - 3) + C2 (I1 - 3)^2 + C3 (I1 - 3)^3`.
    Yeoh {
        /// `C1`, pascals.
        c1: f64,
        /// `C2`, pascals.
        c2: f64,
        /// `C3`, pascals.
        c3: f64,
    },
}

impl Law {
    /// The law with every constant multiplied by `factor`.
    #[must_use]
    pub fn stiffened(self, factor: f64) -> Self {
        match self {
            Self::NeoHookean { c1 } => Self::NeoHookean { c1: factor * c1 },
            Self::MooneyRivlin { c1, c2 } => Self::MooneyRivlin {
                c1: factor * c1,
                c2: factor * c2,
            },
            Self::Yeoh { c1, c2, c3 } => Self::Yeoh {
                c1: factor * c1,
                c2: factor * c2,
                c3: factor * c3,
            },
        }
    }
}

/// A law in other units: every energy multiplied by `factor`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<L> {
    /// The law.
    pub law: L,
    /// Factor on its energies, dimensionless.
    pub factor: f64,
}

impl<L: Hyperelastic> Hyperelastic for Scaled<L> {
    fn energy(&self, l1: f64, l2: f64) -> f64 {
        self.factor * self.law.energy(l1, l2)
    }

    #[inline]
    fn derivatives(&self, l1: f64, l2: f64) -> Derivatives {
        let d = self.law.derivatives(l1, l2);
        Derivatives {
            w1: self.factor * d.w1,
            w2: self.factor * d.w2,
            w11: self.factor * d.w11,
            w12: self.factor * d.w12,
            w22: self.factor * d.w22,
        }
    }

    fn shear_modulus(&self) -> f64 {
        self.factor * self.law.shear_modulus()
    }
}

/// `I1` and its derivatives at the stretches `l1, l2`.
struct Invariants {
    i1: f64,
    i1_1: f64,
    i1_2: f64,
    i1_11: f64,
    i1_12: f64,
    i1_22: f64,
}

impl Invariants {
    fn first(l1: f64, l2: f64) -> Self {
        let (a, b) = (1.0 / l1, 1.0 / l2);
        let l3 = a * b;
        let l3_squared = l3 * l3;
        Self {
            i1: l1 * l1 + l2 * l2 + l3_squared,
            i1_1: 2.0 * (l1 - l3_squared * a),
            i1_2: 2.0 * (l2 - l3_squared * b),
            i1_11: 2.0 + 6.0 * l3_squared * a * a,
            i1_12: 4.0 * l3_squared * l3,
            i1_22: 2.0 + 6.0 * l3_squared * b * b,
        }
    }
}

impl Hyperelastic for Law {
    fn energy(&self, l1: f64, l2: f64) -> f64 {
        let (a, b) = (l1 * l1, l2 * l2);
        let c = 1.0 / (a * b);
        let i = a + b + c - 3.0;
        match *self {
            Self::NeoHookean { c1 } => c1 * i,
            Self::MooneyRivlin { c1, c2 } => c1 * i + c2 * (1.0 / a + 1.0 / b + a * b - 3.0),
            Self::Yeoh { c1, c2, c3 } => i * (c1 + i * (c2 + i * c3)),
        }
    }

    #[inline]
    fn derivatives(&self, l1: f64, l2: f64) -> Derivatives {
        let i = Invariants::first(l1, l2);
        match *self {
            Self::NeoHookean { c1 } => Derivatives {
                w1: c1 * i.i1_1,
                w2: c1 * i.i1_2,
                w11: c1 * i.i1_11,
                w12: c1 * i.i1_12,
                w22: c1 * i.i1_22,
            },
            Self::MooneyRivlin { c1, c2 } => {
                // dI2/dl1 = l2^2 dI1/dl1: both invariants share their roots.
                let (a, b) = (l1 * l1, l2 * l2);
                Derivatives {
                    w1: (c1 + c2 * b) * i.i1_1,
                    w2: (c1 + c2 * a) * i.i1_2,
                    w11: (c1 + c2 * b) * i.i1_11,
                    w12: c1 * i.i1_12 + 4.0 * c2 * l1 * l2,
                    w22: (c1 + c2 * a) * i.i1_22,
                }
            }
            Self::Yeoh { c1, c2, c3 } => {
                let e = i.i1 - 3.0;
                let slope = c1 + e * (2.0 * c2 + 3.0 * c3 * e);
                let curvature = 2.0 * c2 + 6.0 * c3 * e;
                Derivatives {
                    w1: slope * i.i1_1,
                    w2: slope * i.i1_2,
                    w11: slope * i.i1_11 + curvature * i.i1_1 * i.i1_1,
                    w12: slope * i.i1_12 + curvature * i.i1_1 * i.i1_2,
                    w22: slope * i.i1_22 + curvature * i.i1_2 * i.i1_2,
                }
            }
        }
    }

    fn shear_modulus(&self) -> f64 {
        match *self {
            Self::NeoHookean { c1 } | Self::Yeoh { c1, .. } => 2.0 * c1,
            Self::MooneyRivlin { c1, c2 } => 2.0 * (c1 + c2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [Law; 4] = [
        Law::NeoHookean { c1: 3.0 },
        Law::MooneyRivlin { c1: 2.0, c2: 0.7 },
        Law::Yeoh {
            c1: 1.0,
            c2: -0.05,
            c3: 0.02,
        },
        Law::Yeoh {
            c1: 1.0,
            c2: 0.3,
            c3: 0.0,
        },
    ];
    const STRETCHES: [(f64, f64); 5] = [(1.0, 1.0), (1.3, 0.9), (0.8, 1.7), (2.4, 2.1), (1.02, 1.01)];

    /// Central difference of fourth order.
    fn slope(of: impl Fn(f64) -> f64, at: f64) -> f64 {
        let h = 1e-3;
        (8.0 * (of(at + h) - of(at - h)) - (of(at + 2.0 * h) - of(at - 2.0 * h))) / (12.0 * h)
    }

    #[test]
    fn derivatives_are_those_of_the_energy() {
        for law in LAWS {
            for (l1, l2) in STRETCHES {
                let d = law.derivatives(l1, l2);
                let check = |found: f64, expected: f64| {
                    assert!(
                        (found - expected).abs() < 1e-9 * (1.0 + expected.abs()),
                        "{law:?} {l1} {l2}"
                    );
                };
                check(d.w1, slope(|x| law.energy(x, l2), l1));
                check(d.w2, slope(|x| law.energy(l1, x), l2));
                check(d.w11, slope(|x| law.derivatives(x, l2).w1, l1));
                check(d.w12, slope(|x| law.derivatives(l1, x).w1, l2));
                check(d.w22, slope(|x| law.derivatives(l1, x).w2, l2));
            }
        }
    }

    #[test]
    fn a_stiffened_law_has_so_many_times_the_energy() {
        for law in LAWS {
            for (l1, l2) in STRETCHES {
                let (stiff, soft) = (law.stiffened(2.5).energy(l1, l2), law.energy(l1, l2));
                assert!((stiff - 2.5 * soft).abs() <= 1e-12 * (1.0 + soft.abs()));
            }
        }
    }

    #[test]
    fn undeformed_state_is_free_of_energy_and_tension() {
        for law in LAWS {
            let d = law.derivatives(1.0, 1.0);
            assert!(law.energy(1.0, 1.0).abs() < 1e-15 && d.w1.abs() < 1e-15 && d.w2.abs() < 1e-15);
            // Plane stress, incompressible: W_11 = 4/3 E = 4 mu.
            assert!((d.w11 - 4.0 * law.shear_modulus()).abs() < 1e-12);
        }
    }

    #[test]
    fn isotropic_laws_are_symmetric() {
        for law in LAWS {
            let (a, b) = (law.derivatives(1.4, 0.9), law.derivatives(0.9, 1.4));
            assert!(
                (a.w1 - b.w2).abs() < 1e-13 && (a.w11 - b.w22).abs() < 1e-12 && (a.w12 - b.w12).abs() < 1e-13
            );
        }
    }
}
