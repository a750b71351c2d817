//! The Runge-Kutta method of order eight of Dormand and Prince, with step control.
//!
//! Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., II.5 and their code DOP853:
//! twelve stages, error estimated from embedded formulae of orders five and three.

mod coefficients;

use super::MethodFailure;
use coefficients::{ERROR_3, ERROR_5, NODES, STAGE_WEIGHTS, WEIGHTS};

const STAGES: usize = 12;
/// Part of the step that the error estimate would allow.
const SAFETY: f64 = 0.9;
/// Bounds of the change of step.
const SHRINK: f64 = 0.2;
const GROW: f64 = 8.0;
/// Change of step when a stage is not admissible.
const RETREAT: f64 = 0.25;
/// Steps below this part of the whole way end the integration.
const NEGLIGIBLE: f64 = 1e-10;
/// Steps at most.
const MAX_STEPS: usize = 20_000;

/// What a step may err.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Tolerance relative to a component, dimensionless.
    pub relative: f64,
    /// Tolerance whatever a component, in that component's dimensionless unit.
    pub absolute: f64,
    /// Only so many components, from the first on, control the step.
    pub controlled: usize,
}

/// Integrates `rates` from `from` to `to > from`. A rate that is `None` is outside of what the equations cover.
///
/// # Errors
/// [`MethodFailure::BlewUp`] where the step became negligible.
pub fn integrate<const N: usize>(
    mut rates: impl FnMut(f64, &[f64; N]) -> Option<[f64; N]>,
    [from, to]: [f64; 2],
    mut y: [f64; N],
    first_step: f64,
    tolerance: &Tolerance,
) -> Result<[f64; N], MethodFailure> {
    let mut t = from;
    let mut step = first_step.min(to - from);
    let mut stages = [[0.0; N]; STAGES];
    let blew_up = |t| MethodFailure::BlewUp { position: t };
    stages[0] = rates(t, &y).ok_or(blew_up(t))?;
    let mut rejected = false;
    for _ in 0..MAX_STEPS {
        let last = t + step * (1.0 + 1e-10) >= to;
        if last {
            step = to - t;
        }
        if step < NEGLIGIBLE * (to - from) && !last {
            return Err(blew_up(t));
        }
        let Some(next) = attempt(&mut rates, t, step, &y, &mut stages) else {
            step *= RETREAT;
            rejected = true;
            if step < NEGLIGIBLE * (to - from) {
                return Err(blew_up(t));
            }
            continue;
        };
        let error = estimate(step, &y, &next, &stages, tolerance);
        if error.is_nan() {
            step *= RETREAT;
            rejected = true;
            continue;
        }
        let factor = if error == 0.0 {
            GROW
        } else {
            (SAFETY * libm::pow(error, -0.125)).clamp(SHRINK, GROW)
        };
        if error > 1.0 {
            step *= factor.min(1.0);
            rejected = true;
            continue;
        }
        t += step;
        y = next;
        if last {
            return Ok(y);
        }
        let Some(rate) = rates(t, &y) else {
            return Err(blew_up(t));
        };
        stages[0] = rate;
        step *= if rejected { factor.min(1.0) } else { factor };
        rejected = false;
    }
    Err(blew_up(t))
}

/// One step; `stages[0]` holds the rate at its start.
fn attempt<const N: usize>(
    rates: &mut impl FnMut(f64, &[f64; N]) -> Option<[f64; N]>,
    t: f64,
    step: f64,
    y: &[f64; N],
    stages: &mut [[f64; N]; STAGES],
) -> Option<[f64; N]> {
    for j in 1..STAGES {
        let mut at = *y;
        for (stage, weight) in stages[..j].iter().zip(&STAGE_WEIGHTS[j]) {
            if *weight != 0.0 {
                for (value, rate) in at.iter_mut().zip(stage) {
                    *value += step * weight * rate;
                }
            }
        }
        stages[j] = rates(t + NODES[j] * step, &at)?;
    }
    let mut next = *y;
    for (stage, weight) in stages.iter().zip(&WEIGHTS) {
        if *weight != 0.0 {
            for (value, rate) in next.iter_mut().zip(stage) {
                *value += step * weight * rate;
            }
        }
    }
    Some(next)
}

/// Error of a step over what is allowed (Hairer's combination of both estimates).
fn estimate<const N: usize>(
    step: f64,
    y: &[f64; N],
    next: &[f64; N],
    stages: &[[f64; N]; STAGES],
    tolerance: &Tolerance,
) -> f64 {
    let controlled = tolerance.controlled.min(N);
    let (mut fifth, mut third) = (0.0, 0.0);
    for i in 0..controlled {
        let allowed = tolerance.absolute + tolerance.relative * y[i].abs().max(next[i].abs());
        let sum = |weights: &[f64; STAGES]| {
            let of_stages = stages.iter().zip(weights);
            of_stages.map(|(stage, weight)| weight * stage[i]).sum::<f64>() / allowed
        };
        let (a, b) = (sum(&ERROR_5), sum(&ERROR_3));
        fifth += a * a;
        third += b * b;
    }
    if fifth == 0.0 && third == 0.0 {
        return 0.0;
    }
    step * fifth / libm::sqrt((fifth + 0.01 * third) * controlled as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tolerance(relative: f64) -> Tolerance {
        Tolerance {
            relative,
            absolute: relative,
            controlled: 2,
        }
    }

    /// A pendulum of small swing for half a turn: sine and cosine.
    #[test]
    fn follows_the_circle_within_its_tolerance() {
        for relative in [1e-5, 1e-8, 1e-11] {
            let [x, y] = integrate(
                |_, y: &[f64; 2]| Some([y[1], -y[0]]),
                [0.0, 3.0],
                [0.0, 1.0],
                0.1,
                &tolerance(relative),
            )
            .expect("smooth");
            let off = (x - libm::sin(3.0)).abs().max((y - libm::cos(3.0)).abs());
            assert!(off < 30.0 * relative, "{relative:e}: {off:e}");
        }
    }

    /// One fixed step of half the size errs by `2^-9` of the whole one's error.
    #[test]
    fn has_order_eight() {
        let error = |step: f64| {
            let mut stages = [[0.0; 1]; STAGES];
            stages[0] = [1.0];
            let next = attempt(&mut |_, y: &[f64; 1]| Some(*y), 0.0, step, &[1.0], &mut stages);
            (next.expect("defined")[0] - libm::exp(step)).abs()
        };
        let order = libm::log2(error(1.0) / error(0.5)) - 1.0;
        assert!((7.6..8.6).contains(&order), "{order}");
    }

    /// `y' = y^2` from 1 has a pole at 1.
    #[test]
    fn a_pole_is_reported_where_it_lies() {
        let outcome = integrate(
            |_, y: &[f64; 1]| (y[0] < 1e12).then_some([y[0] * y[0]]),
            [0.0, 2.0],
            [1.0],
            0.1,
            &tolerance(1e-8),
        );
        assert!(matches!(outcome, Err(MethodFailure::BlewUp { position }) if (position - 1.0).abs() < 1e-6));
    }
}
