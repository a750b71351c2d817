//! Decides whether a step of Newton's method is the last.
//!
//! Convergence is quadratic: a step is at most a constant times the square of the one before. Two steps to a state give the
//! constant, which changes little along a press. If the previous states predicted a state well enough, its first step can therefore
//! be the last.

/// A step this small is rounding.
const NEGLIGIBLE_STEP: f64 = 3e-13;
/// Steps this small that no longer shrink are rounding, amplified by the condition of the problem.
const LARGEST_ROUNDING: f64 = 2e-9;
/// How many times larger the constant may be than in the states before.
const CONSTANT_SAFETY: f64 = 10.0;
/// What the constant grows by in each state that does not measure it.
const CONSTANT_GROWTH: f64 = 1.5;

/// A step of Newton's method, relative to the solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Largest relative change of the states at the nodes and of pressure and contact.
    pub size: f64,
    /// Change of the pole, relative. It is a singular point: nothing else depends on it strongly, and it settles an iteration
    /// later.
    pub pole: f64,
    /// Factor of the step, 1 for a full step.
    pub damping: f64,
}

/// The steps to a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Convergence {
    /// Relative size that the next step must be sure to stay below for the present one to be the last.
    tolerance: f64,
    /// A step over the square of the one before, at least 1, in the latest pressed states; infinite before any.
    constant: f64,
    /// No step to this state yet.
    first: bool,
    /// The latest step, infinite before any and after one that was damped.
    before: f64,
}

impl Convergence {
    pub(super) const fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            constant: f64::INFINITY,
            first: true,
            before: f64::INFINITY,
        }
    }

    /// Before the first step to a state. The constant of pressed states is of use for pressed states.
    pub(super) fn start(&mut self, pressed: bool) {
        self.first = true;
        self.before = f64::INFINITY;
        if !pressed {
            self.constant = f64::INFINITY;
        }
    }

    /// The latest undamped step.
    pub(super) fn before(&self) -> f64 {
        self.before
    }

    /// Whether a step is the last to a state.
    pub(super) fn is_last(&mut self, step: &Step) -> bool {
        let first = core::mem::replace(&mut self.first, false);
        if step.damping < 1.0 {
            self.before = f64::INFINITY;
            return false;
        }
        let (size, before) = (step.size, self.before);
        let contraction = size / before;
        // The next step is at most this.
        let next = if first {
            CONSTANT_SAFETY * self.constant * size * size
        } else if before.is_finite() && contraction < 1.0 {
            size * contraction * contraction
        } else {
            f64::INFINITY
        };
        let rounding = size < LARGEST_ROUNDING && size > 0.3 * before;
        let small = next < self.tolerance && step.pole < libm::sqrt(self.tolerance);
        let last = size < NEGLIGIBLE_STEP || rounding || small;
        if last {
            self.constant = if before.is_finite() {
                (size.max(NEGLIGIBLE_STEP) / (before * before)).max(1.0)
            } else {
                CONSTANT_GROWTH * self.constant
            };
        }
        self.before = size;
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(size: f64) -> Step {
        Step {
            size,
            pole: 0.0,
            damping: 1.0,
        }
    }

    /// Steps of `x -> x - (x^2 - 2) / 2 x`, whose constant is `1 / (2 sqrt 2)`: below 1, so that 1 counts.
    #[test]
    fn the_first_step_is_the_last_only_where_the_constant_is_known() {
        let mut convergence = Convergence::new(1e-10);
        let mut x: f64 = 1.5;
        convergence.start(true);
        let steps = (1..10).position(|_| {
            let by = (x * x - 2.0) / (2.0 * x);
            x -= by;
            convergence.is_last(&step(by.abs()))
        });
        assert!(steps.is_some_and(|steps| steps > 1) && (x - 2.0_f64.sqrt()).abs() < 1e-10);
        convergence.start(true);
        assert!(convergence.is_last(&step(2e-6)), "10 * 4e-12 is below 1e-10");
        convergence.start(true);
        assert!(!convergence.is_last(&step(4e-6)));
        convergence.start(false);
        assert!(!convergence.is_last(&step(1e-8)), "a state of rest measures anew");
    }

    /// It grows while nothing measures it, until something has to.
    #[test]
    fn a_constant_that_is_not_measured_is_trusted_for_some_states_only() {
        let mut convergence = Convergence::new(1e-10);
        convergence.start(true);
        assert!(!convergence.is_last(&step(1e-3)) && !convergence.is_last(&step(1e-4)));
        assert!(convergence.is_last(&step(1e-8)));
        let trusted = (0..100)
            .take_while(|_| {
                convergence.start(true);
                convergence.is_last(&step(1e-6))
            })
            .count();
        assert!((1..10).contains(&trusted), "{trusted}");
    }

    #[test]
    fn a_damped_step_is_never_the_last() {
        let mut convergence = Convergence::new(1e-4);
        convergence.start(true);
        let damped = Step {
            damping: 0.5,
            ..step(1e-9)
        };
        assert!(!convergence.is_last(&damped) && convergence.before().is_infinite());
    }
}
