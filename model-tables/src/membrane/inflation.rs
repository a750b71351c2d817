//! The slow path to a rest state. It ends at the state, or at the reason why there is none.
//!
//! A law that softens may lose its stability on the path, or the equator of a long membrane may bulge while the pole recedes. The
//! pole stretch then has a maximum, and no state beyond it belongs to that first rise. The path increases the pole stretch, and
//! then the equator's stretch where the pole stretch no longer works.

use crate::material::Hyperelastic;
use crate::material::stability::{self, Margin};
use crate::membrane::adapt::{Adaptive, Graded, Unsolved};
use crate::membrane::closure::{Closure, RestControl};
use crate::membrane::equations::{POLE, PRESSURE};

/// The end of an inflation that does not reach a pole stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The pole stretch has a maximum there, and the equator bulges instead.
    Turns {
        /// The greatest pole stretch.
        greatest: f64,
    },
    /// The law is about to lose its stability, or has lost it.
    Unstable(Margin),
    /// At a given volume and with the edge held, the dome bulges by itself: its volume has a maximum along inflation.
    Bulges,
    /// The solver failed.
    Lost(Unsolved),
}

/// Stiffness over that of a neo-Hookean law under which a law softens.
const SOFTER: f64 = 0.999;
/// Where the way begins, over 1.
const FIRST: f64 = 2e-3;
/// Largest step of the controlling stretch.
const LARGEST_STEP: f64 = 0.05;
/// Step under which a control has ceased to work.
const SMALLEST_STEP: f64 = 1e-4;
/// Margin that leaves no room for a smallest step.
const NO_MARGIN: f64 = 0.02;
/// Fall of the pole stretch from its maximum that is no rounding.
const TURN: f64 = 1e-5;
/// Equator stretch at which the search for a turn is given up.
const LARGEST_EQUATOR: f64 = 12.0;

#[derive(Clone, Copy, PartialEq)]
enum Control {
    Pole,
    Equator,
}

impl<L: Hyperelastic, const S: usize> Adaptive<L, S> {
    /// The margin of the law over a state: the smallest at its pole and Gauss points.
    pub fn stability(&self, graded: &Graded<S>) -> Margin {
        let solution = &graded.solution;
        let law = &self.equilibrium.membrane.law;
        let pole = if solution.start() > 0.0 {
            1.0
        } else {
            solution.parameters[POLE]
        };
        let mut least = stability::margin(law, pole, pole);
        self.equilibrium.for_each_point(solution, |e, j, _, _, response| {
            least = least.least(if response.wrinkled {
                stability::uniaxial_margin(law, response.l1)
            } else {
                stability::margin(law, response.l1, solution.stages[e][j][0])
            });
        });
        least
    }

    /// Whether the law is softer than a neo-Hookean one at the pole or the equator: only then does inflation leave states
    /// out that the equations have.
    pub(crate) fn softens(&self, graded: &Graded<S>) -> bool {
        let law = &self.equilibrium.membrane.law;
        let [equator, _] = graded.solution.nodes[graded.solution.elements()];
        [graded.solution.parameters[POLE], equator]
            .into_iter()
            .any(|stretch| {
                // W_11 of C1 (I1 - 3) at equal stretches, over mu = 2 C1.
                let neo_hookean = 1.0 + 3.0 * libm::pow(stretch, -6.0);
                law.derivatives(stretch, stretch).w11 < SOFTER * neo_hookean * law.shear_modulus()
            })
    }

    /// Whether the volume still grows along the inflation of a dome whose edge is held: where it turns, no volume of fluid
    /// holds the dome. `direction` is that of the state before, which tells which way along is on; neither pressure,
    /// pole nor height do, as each of them may turn on the way of a stable dome.
    fn holds_its_volume(&mut self, state: &mut Graded<S>, direction: &mut [f64; 3]) -> bool {
        let Some(tangent) = self.equilibrium.tangent(&mut state.solution) else {
            return true;
        };
        let solution = &state.solution;
        let now = [
            tangent.pressure / solution.parameters[PRESSURE],
            tangent.volume / solution.volume,
            tangent.height / solution.height,
        ];
        let dot = |other: &[f64; 3]| now.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
        let size = libm::sqrt(dot(&now)).copysign(dot(direction));
        *direction = now.map(|x| x / size);
        direction[1] > 0.0
    }

    /// Makes `state` the rest state of a pole stretch, by inflation from nearly nothing. Of its content nothing is used.
    ///
    /// # Errors
    /// [`End`] where inflation ends before; `state` is then the last one found.
    #[inline(never)] // its copy of a solution stays off the stack of those that do not need it
    pub fn inflate_to(&mut self, pole_stretch: f64, state: &mut Graded<S>) -> Result<(), End> {
        let pole_of = |state: &Graded<S>| state.solution.parameters[POLE];
        let equator_of = |state: &Graded<S>| state.solution.nodes[state.solution.elements()][0];
        if let Some(stretch) = stability::equibiaxial_limit(&self.equilibrium.membrane.law, pole_stretch) {
            return Err(End::Unstable(stability::margin(
                &self.equilibrium.membrane.law,
                stretch,
                stretch,
            )));
        }
        let mut control = Control::Pole;
        self.rest_from_sphere(pole_stretch.min(1.0 + FIRST), state)
            .map_err(End::Lost)?;
        let mut step = LARGEST_STEP.min(4.0 * FIRST);
        let mut greatest = pole_of(state);
        let mut failure = Unsolved::Unsettled;
        let mut direction = [0.0, 1.0, 0.0];
        loop {
            if !self.holds_its_volume(state, &mut direction) {
                return Err(End::Bulges);
            }
            if pole_of(state) >= pole_stretch {
                return Ok(());
            }
            if step < SMALLEST_STEP {
                if control == Control::Equator {
                    let margin = self.stability(state);
                    return Err(if margin.value < NO_MARGIN {
                        End::Unstable(margin)
                    } else {
                        End::Lost(failure)
                    });
                }
                control = Control::Equator;
                step = 10.0 * SMALLEST_STEP;
            }
            let mut next = state.clone();
            let target = match control {
                Control::Pole => RestControl::PoleStretch((pole_of(state) + step).min(pole_stretch)),
                Control::Equator => RestControl::EquatorStretch(equator_of(state) + step),
            };
            match self.settle(&mut next, &Closure::Rest(target)) {
                // A step to another branch.
                Ok(())
                    if (equator_of(&next) - equator_of(state)).abs() < 6.0 * step + SMALLEST_STEP
                        && (pole_of(&next) - pole_of(state)).abs() < 6.0 * step + SMALLEST_STEP => {}
                Ok(()) => {
                    step *= 0.5;
                    continue;
                }
                Err(why) => {
                    failure = why;
                    step *= 0.5;
                    continue;
                }
            }
            if control == Control::Equator {
                if pole_of(&next) >= pole_stretch {
                    // Near enough for the pole to take over.
                    let closure = Closure::Rest(RestControl::PoleStretch(pole_stretch));
                    state.clone_from(&next);
                    self.settle(state, &closure).map_err(End::Lost)?;
                    return if self.holds_its_volume(state, &mut direction) {
                        Ok(())
                    } else {
                        Err(End::Bulges)
                    };
                }
                if pole_of(&next) < greatest - TURN {
                    return Err(End::Turns { greatest });
                }
                if equator_of(&next) > LARGEST_EQUATOR {
                    return Err(End::Lost(failure));
                }
            }
            greatest = greatest.max(pole_of(&next));
            state.clone_from(&next);
            let margin = self.stability(state);
            if !margin.is_stable() {
                return Err(End::Unstable(margin));
            }
            step = (1.5 * step).min(LARGEST_STEP);
        }
    }
}
