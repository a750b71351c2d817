//! Whether a law is stable at the stretches a state reaches.
//!
//! A membrane whose law loses strong ellipticity forms bands and necks that no smooth solution shows, so a state there
//! is at best one of several. In the plane of an isotropic membrane the condition (Knowles and Sternberg 1977) is,
//! with `a = (l1 W_1 - l2 W_2) / (l1^2 - l2^2)` and `b = (l2 W_1 - l1 W_2) / (l1^2 - l2^2)`,
//!
//! ```text
//! W_11 > 0,   W_22 > 0,   a > 0 (Baker and Ericksen),   sqrt(W_11 W_22) + a > |W_12 + b|
//! ```
//!
//! and where hoop wrinkles stand the uniaxial energy `W(l, l^-1/2)` must be convex. Limit points of inflation are
//! no loss of stability of the law: at a given volume the state beyond them is as stable as before.

use crate::material::Hyperelastic;
use core::fmt;

/// Kind of instability of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// It softens under stretch: `W_11` or `W_22` is not positive.
    Necking,
    /// The larger stress is not along the larger stretch.
    Shearing,
    /// It forms bands oblique to the stretches.
    Banding,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Necking => "it necks under further stretch",
            Self::Shearing => "it shears without resistance",
            Self::Banding => "it forms shear bands",
        })
    }
}

/// How far a law is from losing its stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// 1 in the undeformed state, not positive where the law is unstable.
    pub value: f64,
    /// The first instability.
    pub mode: Mode,
    /// Meridional stretch.
    pub meridional_stretch: f64,
    /// Hoop stretch.
    pub hoop_stretch: f64,
}

impl Margin {
    /// Whether the law is stable there.
    pub fn is_stable(&self) -> bool {
        self.value > 0.0
    }

    /// The smaller of two margins.
    #[must_use]
    pub fn least(self, other: Self) -> Self {
        if other.value < self.value { other } else { self }
    }
}

/// Stretches closer than this, relative, are taken as equal.
const EQUAL: f64 = 1e-5;

/// The margin of a law at the stretches `l1, l2` of a membrane taut both ways.
pub fn margin<L: Hyperelastic>(law: &L, l1: f64, l2: f64) -> Margin {
    let modulus = law.shear_modulus();
    let d = law.derivatives(l1, l2);
    let (a, b) = if (l1 - l2).abs() < EQUAL * l1 {
        let mean = 0.5 * (l1 + l2);
        let d = law.derivatives(mean, mean);
        let (difference, stress) = (d.w11 - d.w12, d.w1 / mean);
        (0.5 * (difference + stress), 0.5 * (difference - stress))
    } else {
        let squares = l1 * l1 - l2 * l2;
        (
            (l1 * d.w1 - l2 * d.w2) / squares,
            (l2 * d.w1 - l1 * d.w2) / squares,
        )
    };
    // Over their values in the undeformed state: 4 mu, mu, 2 mu.
    let necking = d.w11.min(d.w22) / (4.0 * modulus);
    let shearing = a / modulus;
    let banding = (libm::sqrt((d.w11 * d.w22).max(0.0)) + a - (d.w12 + b).abs()) / (2.0 * modulus);
    let mut least = (necking, Mode::Necking);
    for (value, mode) in [(shearing, Mode::Shearing), (banding, Mode::Banding)] {
        if value < least.0 && least.0 > 0.0 {
            least = (value, mode);
        }
    }
    Margin {
        value: least.0,
        mode: least.1,
        meridional_stretch: l1,
        hoop_stretch: l2,
    }
}

/// The margin where hoop wrinkles stand: uniaxial tension along the meridian.
pub fn uniaxial_margin<L: Hyperelastic>(law: &L, l1: f64) -> Margin {
    let root = libm::sqrt(l1);
    let d = law.derivatives(l1, 1.0 / root);
    Margin {
        // 3 mu in the undeformed state.
        value: (d.w11 - 0.5 * d.w12 / (l1 * root)) / (3.0 * law.shear_modulus()),
        mode: Mode::Necking,
        meridional_stretch: l1,
        hoop_stretch: 1.0 / root,
    }
}

/// Samples a unit of stretch when the first loss is looked for.
const SAMPLES: f64 = 200.0;

/// The least stretch, equal both ways as at a pole, at which a law is unstable; `None` if it is stable up to `largest`.
pub fn equibiaxial_limit<L: Hyperelastic>(law: &L, largest: f64) -> Option<f64> {
    let stable = |stretch: f64| margin(law, stretch, stretch).is_stable();
    let (mut below, mut above) = (1.0, 1.0);
    while stable(above) {
        if above >= largest {
            return None;
        }
        below = above;
        above = (above + 1.0 / SAMPLES).min(largest);
    }
    while above - below > 1e-12 * above {
        let middle = 0.5 * (below + above);
        if stable(middle) {
            below = middle;
        } else {
            above = middle;
        }
    }
    Some(above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Law;

    #[test]
    fn undeformed_state_has_margin_one() {
        for law in [
            Law::NeoHookean { c1: 3.0 },
            Law::MooneyRivlin { c1: 2.0, c2: -0.7 },
            Law::Yeoh {
                c1: 1.0,
                c2: -0.2,
                c3: 0.1,
            },
        ] {
            assert!((margin(&law, 1.0, 1.0).value - 1.0).abs() < 1e-12);
            assert!((uniaxial_margin(&law, 1.0).value - 1.0).abs() < 1e-12);
        }
    }

    /// For `W = C1 (I1 - 3)`, `a = 2 C1`, `b = 2 C1 / (l1 l2)^3`, `W_12 = 4 C1 / (l1 l2)^3`.
    #[test]
    fn neo_hookean_law_is_always_stable() {
        let law = Law::NeoHookean { c1: 0.5 };
        for (l1, l2) in [(1.0, 4.0), (2.0, 2.0), (0.7, 3.0), (5.0, 0.5), (1.1, 1.0)] {
            let found = margin(&law, l1, l2);
            let cube = 1.0 / (l1 * l2).powi(3);
            let w11 = 0.5 * (2.0 + 6.0 / (l1.powi(4) * l2 * l2));
            let w22 = 0.5 * (2.0 + 6.0 / (l2.powi(4) * l1 * l1));
            let banding = ((w11 * w22).sqrt() + 1.0 - 3.0 * cube) / 2.0;
            let expected = (w11.min(w22) / 4.0).min(1.0).min(banding);
            assert!((found.value - expected).abs() < 1e-12, "{l1} {l2}: {found:?}");
            assert!(found.is_stable());
        }
        assert_eq!(equibiaxial_limit(&law, 6.0), None);
    }

    /// With `s = l^2` and `r = -C2/C1`, at equal stretches `W_11 = C1 (1 - r s)(2 + 6/s^3)`, which vanishes at
    /// `l = 1/sqrt(r)`. As `a + b = W_11 - W_12`, the last condition reads `W_11 > 0` and `a = 2 C1 (1 - r/s^2) > 0`.
    #[test]
    fn mooney_rivlin_with_negative_c2_necks_at_equal_stretches() {
        let law = Law::MooneyRivlin { c1: 1.0, c2: -0.25 };
        let limit = equibiaxial_limit(&law, 6.0).expect("a limit");
        assert!((limit - 2.0).abs() < 1e-9, "{limit}");
        assert_eq!(margin(&law, 2.001, 2.001).mode, Mode::Necking);
        assert!(margin(&law, 1.999, 1.999).is_stable());
        // Uniaxial: W_11 - W_12 / (2 l^1.5) = 2 (1 + 2 / l^3) + r (-6 / l^4): softer, never unstable for r < 1.
        let expected = |l: f64| (2.0 * (1.0 + 2.0 / l.powi(3)) - 0.25 * 6.0 / l.powi(4)) / (3.0 * 1.5);
        for l in [1.0, 1.5, 3.0] {
            assert!(
                (uniaxial_margin(&law, l).value - expected(l)).abs() < 1e-12,
                "{l}"
            );
        }
    }

    /// `a = 2 W'(I1)` for any law of `I1` alone: it vanishes where `C1 + 2 C2 (I1 - 3) = 0`; in uniaxial extension the
    /// law has softened before.
    #[test]
    fn yeoh_with_negative_c2_ends_before_its_slope_vanishes() {
        let law = Law::Yeoh {
            c1: 1.0,
            c2: -0.1,
            c3: 0.0,
        };
        // I1 - 3 = 5 at equal stretches: 2 s + 1/s^2 = 8, s = 3.992...
        let limit = equibiaxial_limit(&law, 6.0).expect("a limit");
        // W_11 = (1 - 0.2 e) i11 - 0.2 i1^2 = 0 with s = l^2, i11 = 2 + 6/s^3, i1 = 2 (l - l / s^3), e = 2 s + 1/s^2 - 3.
        let s = limit * limit;
        let e = 2.0 * s + 1.0 / (s * s) - 3.0;
        let first = 2.0 * limit * (1.0 - 1.0 / (s * s * s));
        let w11 = (1.0 - 0.2 * e) * (2.0 + 6.0 / (s * s * s)) - 0.2 * first * first;
        assert!(w11.abs() < 1e-9, "{limit}: {w11}");
        assert!(limit < 3.992_f64.sqrt());
        assert_eq!(margin(&law, 1.001 * limit, 1.001 * limit).mode, Mode::Necking);
        // Beyond the slope's zero nothing resists shear.
        assert!(!margin(&law, 2.2, 1.2).is_stable());
    }

    #[test]
    fn equal_stretches_are_the_limit_of_unequal_ones() {
        let law = Law::Yeoh {
            c1: 1.0,
            c2: -0.03,
            c3: 0.001,
        };
        for l in [1.0, 1.4, 1.9] {
            let (equal, unequal) = (margin(&law, l, l).value, margin(&law, l + 1e-4, l - 1e-4).value);
            assert!((equal - unequal).abs() < 1e-3, "{l}: {equal} {unequal}");
        }
    }
}
