//! A clamped membrane of Ecoflex 00-30 that lifts weights, as measured by others, beside a flat membrane with a rigid centre.
//!
//! Campbell, Muhaxheri, Guilhoto, Santangelo, Perdikaris, Pikul and Yim, "Active Learning Design: Modeling Force Output for Axisymmetric Soft Pneumatic
//! Actuators" (arXiv 2504.01156); data in the repository `gmcampbell/SPA_Design` (MIT licence), `mass_lift_data_dictionary_N_Pa.pkl`, key
//! `[2.0, 25.4, nan, nan, nan, nan]`. Quoted here are medians of the pressure within 0.6 mm of a height, of the membrane without rings.

use super::markdown::{number, published, ratio, table};
use model_tables::material::{Derivatives, Hyperelastic};
use output::Refusal;

/// Radius of the rigid disc bonded to the centre, metres.
const CORE: f64 = 25.4e-3;
/// Radius of the clamp, metres.
const CLAMP: f64 = 70e-3;
/// Undeformed thickness, metres.
const THICKNESS: f64 = 2e-3;
/// Shear modulus that their tensile test gave, pascals, and limit of `I1 - 3` of their Gent law.
pub(super) const PUBLISHED_MODULUS: f64 = 31_700.0;
const LIMIT: f64 = 39.6;

/// Heights in millimetres and median pressures in pascals under a force in newtons: 1.5, 2.5 and 4 kg.
pub(super) struct Lift {
    pub(super) force: f64,
    pub(super) rows: &'static [[f64; 2]],
}

/// As measured.
pub(super) const LIFTS: [Lift; 3] = [
    Lift {
        force: 14.715,
        rows: &[
            [10.0, 2203.0],
            [20.0, 2467.0],
            [30.0, 2693.0],
            [40.0, 2856.0],
            [50.0, 2969.0],
            [60.0, 3116.0],
        ],
    },
    Lift {
        force: 24.525,
        rows: &[
            [10.0, 3338.0],
            [20.0, 3409.0],
            [30.0, 3446.0],
            [40.0, 3471.0],
            [50.0, 3554.0],
        ],
    },
    Lift {
        force: 39.24,
        rows: &[
            [10.0, 4417.0],
            [20.0, 4261.0],
            [30.0, 4147.0],
            [40.0, 4105.0],
            [50.0, 4163.0],
        ],
    },
];

/// Gent's law, `W = -mu J / 2 ln(1 - (I1 - 3) / J)`.
#[derive(Clone, Copy)]
struct Gent {
    modulus: f64,
}

impl Gent {
    /// `I1 - 3` and its derivatives by both stretches.
    fn invariant(l1: f64, l2: f64) -> [f64; 3] {
        let l3 = 1.0 / (l1 * l2);
        [
            l1 * l1 + l2 * l2 + l3 * l3 - 3.0,
            2.0 * (l1 - l3 * l3 / l1),
            2.0 * (l2 - l3 * l3 / l2),
        ]
    }
}

impl Hyperelastic for Gent {
    fn energy(&self, l1: f64, l2: f64) -> f64 {
        let [i, ..] = Self::invariant(l1, l2);
        -0.5 * self.modulus * LIMIT * libm::log(1.0 - i / LIMIT)
    }

    fn derivatives(&self, l1: f64, l2: f64) -> Derivatives {
        let [i, by_1, by_2] = Self::invariant(l1, l2);
        let l3 = 1.0 / (l1 * l2);
        let square = l3 * l3;
        let slope = 0.5 * self.modulus * LIMIT / (LIMIT - i);
        let curvature = slope / (LIMIT - i);
        Derivatives {
            w1: slope * by_1,
            w2: slope * by_2,
            w11: curvature * by_1 * by_1 + slope * (2.0 + 6.0 * square / (l1 * l1)),
            w12: curvature * by_1 * by_2 + slope * 4.0 * square / (l1 * l2),
            w22: curvature * by_2 * by_2 + slope * (2.0 + 6.0 * square / (l2 * l2)),
        }
    }

    fn shear_modulus(&self) -> f64 {
        self.modulus
    }
}

/// Steps of Runge and Kutta's method from the core to the clamp.
const STEPS: usize = 60;

/// Radius missed at the clamp, and height of the core, metres, of a stretch at the core and a pressure. `None` where the membrane cannot be.
fn shoot(law: Gent, stretch: f64, pressure: f64, force: f64) -> Option<[f64; 2]> {
    // Vertical tension through a circle over the thickness: what the fluid carries beyond the weight.
    let vertical =
        |radius: f64| 0.5 * (pressure * radius * radius - force / core::f64::consts::PI) / THICKNESS;
    let pull = CORE * law.derivatives(stretch, 1.0).w1;
    let level = pull * pull - vertical(CORE) * vertical(CORE);
    let mut l1 = stretch;
    // Radius, height and horizontal tension by the undeformed radius.
    let mut slopes = |x: f64, [radius, _, p]: [f64; 3]| {
        let q = vertical(radius);
        let (pull, hoop) = (libm::hypot(p, q), radius / x);
        for _ in 0..40 {
            let d = law.derivatives(l1, hoop);
            let step = ((pull / x - d.w1) / d.w11).clamp(-0.3 * l1, 0.3 * l1);
            l1 += step;
            if step.abs() < 1e-12 {
                break;
            }
        }
        let [cos, sin] = [p / pull, q / pull];
        let d = law.derivatives(l1, hoop);
        [
            l1 * cos,
            -l1 * sin,
            d.w2 - pressure * l1 * radius * sin / THICKNESS,
        ]
    };
    if level <= 0.0 {
        return None;
    }
    let mut y = [CORE, 0.0, libm::sqrt(level)];
    let h = (CLAMP - CORE) / STEPS as f64;
    let along = |y: [f64; 3], by: f64, k: [f64; 3]| [0, 1, 2].map(|i: usize| y[i] + by * k[i]);
    for i in 0..STEPS {
        let x = CORE + h * i as f64;
        let a = slopes(x, y);
        let b = slopes(x + 0.5 * h, along(y, 0.5 * h, a));
        let c = slopes(x + 0.5 * h, along(y, 0.5 * h, b));
        let d = slopes(x + h, along(y, h, c));
        y = [0, 1, 2].map(|i: usize| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    let missed = [y[0] - CLAMP, -y[1]];
    missed.iter().all(|x| x.is_finite()).then_some(missed)
}

/// The pressure at which the core is so high, and the stretch beside it, from those of a height nearby: Newton's method.
fn pressure_at(law: Gent, force: f64, height: f64, near: [f64; 2]) -> Option<[f64; 2]> {
    let [mut stretch, mut pressure] = near;
    for _ in 0..60 {
        let missed = |stretch, pressure| -> Option<[f64; 2]> {
            let [radius, risen] = shoot(law, stretch, pressure, force)?;
            Some([radius, risen - height])
        };
        let now = missed(stretch, pressure)?;
        if now[0].abs().max(now[1].abs()) < 1e-9 {
            return Some([stretch, pressure]);
        }
        let by_stretch = missed(stretch + 1e-7, pressure)?;
        let by_pressure = missed(stretch, pressure + 1e-3)?;
        let [a, c] = [0, 1].map(|i: usize| (by_stretch[i] - now[i]) / 1e-7);
        let [b, d] = [0, 1].map(|i: usize| (by_pressure[i] - now[i]) / 1e-3);
        let determinant = a * d - b * c;
        let by = [
            (b * now[1] - d * now[0]) / determinant,
            (c * now[0] - a * now[1]) / determinant,
        ];
        // No further than the guess is worth.
        let most = (by[0].abs() / 0.05).max(by[1].abs() / (0.1 * pressure)).max(1.0);
        stretch += by[0] / most;
        pressure += by[1] / most;
    }
    None
}

/// Pressures at the heights of a lift. `None` where one is not found.
fn pressures(modulus: f64, lift: &Lift) -> Option<Vec<f64>> {
    let law = Gent { modulus };
    // Near the first height: at the pressure measured there, whatever stretch comes nearest.
    let [height, pressure] = lift.rows[0];
    let mut state = (1..120)
        .filter_map(|i| {
            let stretch = 1.0 + 0.02 * f64::from(i);
            let [radius, risen] = shoot(law, stretch, pressure, lift.force)?;
            Some((libm::hypot(radius, risen - 1e-3 * height), [stretch, pressure]))
        })
        .min_by(|(a, _), (b, _)| a.total_cmp(b))?
        .1;
    lift.rows
        .iter()
        .map(|[height, _]| {
            state = pressure_at(law, lift.force, 1e-3 * height, state)?;
            Some(state[1])
        })
        .collect()
}

/// A lift beside the model.
pub(super) struct Compared {
    pub(super) force: f64,
    /// Height in millimetres, pressure measured and of the model, pascals.
    pub(super) rows: Vec<[f64; 3]>,
    /// The first height, millimetres, from which on the model's pressure falls: a pressure then has more than one height, and is refused.
    pub(super) falls_from: Option<f64>,
}

/// The lifts at a modulus.
fn compare(modulus: f64) -> Option<Vec<Compared>> {
    LIFTS
        .iter()
        .map(|lift| {
            let found = pressures(modulus, lift)?;
            let falls = found.windows(2).position(|pair| pair[1] < pair[0]);
            let rows = lift.rows.iter().zip(&found);
            Some(Compared {
                force: lift.force,
                rows: rows.map(|(row, &here)| [row[0], row[1], here]).collect(),
                falls_from: falls.map(|i| lift.rows[i][0]),
            })
        })
        .collect()
}

/// Largest error of the pressures of the lifts that are measured to rise, relative.
fn error(lifts: &[Compared]) -> f64 {
    lifts
        .iter()
        .filter(|lift| lift.rows.windows(2).all(|pair| pair[1][1] > pair[0][1]))
        .flat_map(|lift| &lift.rows)
        .map(|row| (row[2] / row[1] - 1.0).abs())
        .fold(0.0, f64::max)
}

/// The modulus, pascals, with the smallest largest error, by thirds; that error; and the lifts.
pub(super) fn fitted() -> Option<(f64, f64, Vec<Compared>)> {
    let of = |modulus: f64| compare(modulus).map_or(f64::INFINITY, |lifts| error(&lifts));
    let (mut low, mut high) = (0.8 * PUBLISHED_MODULUS, 1.25 * PUBLISHED_MODULUS);
    while high - low > 3e-3 * PUBLISHED_MODULUS {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if of(a) < of(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let modulus = 0.5 * (low + high);
    let lifts = compare(modulus)?;
    Some((modulus, error(&lifts), lifts))
}

/// The section of the page.
pub(super) fn markdown() -> Result<String, Refusal> {
    let (modulus, error, lifts) =
        fitted().ok_or_else(|| Refusal("the lifted weights: a state was not found".to_owned()))?;
    let rows = lifts.iter().flat_map(|lift| {
        lift.rows.iter().map(|row| {
            let here = match lift.falls_from {
                None => [number(row[2]), ratio(row[2] / row[1])],
                Some(_) => ["refused".to_owned(), "-".to_owned()],
            };
            let mut cells = vec![published(lift.force), published(row[0]), published(row[1])];
            cells.extend(here);
            cells
        })
    });
    let refused: Vec<String> = lifts
        .iter()
        .filter_map(|lift| Some((lift.force, lift.falls_from?)))
        .map(|(force, from)| {
            format!(
                "Under {} N the pressure falls from {} mm on, as measured: a pressure has more than one height there, and is refused.",
                published(force),
                published(from)
            )
        })
        .collect();
    Ok(format!(
        "## A clamped membrane that lifts weights\n\
         \n\
         G. M. Campbell and others, *Active Learning Design: Modeling Force Output for Axisymmetric Soft Pneumatic Actuators*, arXiv 2504.01156; data in \
         the repository gmcampbell/SPA_Design (MIT licence). Ecoflex 00-30, 2 mm, clamped at a radius of 70 mm, with a rigid disc of 25.4 mm bonded to its \
         centre, under weights; *measured* are medians of the pressure within 0.6 mm of a height. *Here* is a flat membrane with that rigid centre (the \
         meridian by Runge and Kutta's method), by Gent's law with their limit of 39.6 and a modulus fitted to what rises: {} kPa, where their tensile \
         test gave {} kPa. Largest error {} %.\n\
         \n\
         {}\n\
         {}\n",
        number(modulus * 1e-3),
        published(PUBLISHED_MODULUS * 1e-3),
        ratio(100.0 * error),
        table(
            &["force, N", "height, mm", "measured, Pa", "here, Pa", "ratio"],
            rows
        ),
        refused.join(" ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivatives are those of the energy.
    #[test]
    fn gents_law_is_one() {
        let law = Gent { modulus: 3e4 };
        for (l1, l2) in [(1.2, 0.9), (2.0, 1.5)] {
            let d = law.derivatives(l1, l2);
            let slope = |of: &dyn Fn(f64) -> f64| (of(1e-5) - of(-1e-5)) / 2e-5;
            let pairs = [
                (d.w1, slope(&|e| law.energy(l1 + e, l2))),
                (d.w2, slope(&|e| law.energy(l1, l2 + e))),
                (d.w11, slope(&|e| law.derivatives(l1 + e, l2).w1)),
                (d.w12, slope(&|e| law.derivatives(l1, l2 + e).w1)),
                (d.w22, slope(&|e| law.derivatives(l1, l2 + e).w2)),
            ];
            for (found, truth) in pairs {
                assert!((found / truth - 1.0).abs() < 1e-6, "{found} {truth}");
            }
        }
    }

    /// Within 5 % with one modulus, near that of the tensile test; what was measured not to rise does not rise here.
    #[test]
    fn lifted_weights_are_those_measured() {
        let (modulus, error, lifts) = fitted().expect("states");
        assert!(error < 0.05, "{error} at {modulus} Pa");
        assert!((modulus / PUBLISHED_MODULUS - 1.0).abs() < 0.1, "{modulus}");
        let falls: Vec<bool> = lifts.iter().map(|lift| lift.falls_from.is_some()).collect();
        assert_eq!(falls, [false, false, true]);
    }
}
