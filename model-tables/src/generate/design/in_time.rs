//! The six numbers of a design that the chip's rules for a relaxing wall need, fitted to one press of the solid in time.
//!
//! The rules are those of the firmware's `signal::relaxation`, here in `f64`. First the weight is fitted to the indentation, then
//! the fluid's share to the force, during press, hold and release, then the reduction of the force on
//! renewed contact to a second press.
//!
//! A wall that is warmer by `dT` than its series passes through the same states `exp(shift dT)` times as fast. The settled pressure
//! for a pressure `P` applied at once, `P_e = J(t) P`, therefore moves by `shift dT t dJ/dt P`. If `J` rises from near 0 to 1 as
//! `t^n / (1 + t^n)`, as for a wall of many relaxation times, this is `n shift dT P_e (1 - P_e / P)`. The gain `n shift dT` is that
//! of the press and of the hold.

use super::GenerateError;
use crate::curve::{Contact, Curve};
use crate::design::Design;
use crate::design_file::{Accuracy, Axes, DesignFile, ShapeSection};
use crate::material::relaxation::{Decay, MAX_TERMS, Relaxation};
use crate::material::series::{LEFT_TIME, WALL_TEMPERATURE};
use crate::model::{Fingertip, Kind};
use crate::solid::history::{Drive, History, HistoryError};
use crate::solid::mesh::Elements;

/// Of the press and of the settled states beside it: their difference is what is fitted, and a finer mesh moves both alike.
const ELEMENTS: Elements = Elements {
    through: 2,
    along: 24,
};
/// How deep is pressed at most, over the height; half as deep, and a quarter, where the solid finds no state there.
const DEEP: f64 = 0.25;
const DEPTHS: [f64; 3] = [1.0, 0.5, 0.25];
/// Pressed, held, let go, left alone and pressed again in so many seconds, and in so many instants.
const SECONDS: [f64; 5] = [1.0, 3.0, 1.0, 5.0, 0.5];
const INSTANTS: u32 = 100;
/// Settled states, from a part of the depth to a little beyond it.
const STATES: u32 = 32;
const FIRST: f64 = 0.004;
const BEYOND: f64 = 1.2;
/// Errors count from these parts of the largest force and indentation on.
const FROM: [f64; 2] = [0.05, 0.05];
/// Errors that count as one. While pressed and held: of force and indentation over the truth, for a wall that a second stiffens twofold or
/// more, and in proportion for one that it stiffens less.
const PRESSED: [f64; 2] = [0.04, 0.02];
/// On the release: of the force over its peak, of the indentation over the height.
const LEFT: [f64; 2] = [0.05, 0.05];
/// A wall that a second stiffens by less than this has no weight: it gains a tenth of a percent while pressed, and costs the force several
/// percent of the peak on the release of a tall dome.
const MIN_STIFFENING: f64 = 0.5;
/// Bounds of the fit: logarithms of `P_2` and `P_1` over the pressure at the depth, of `1 + kappa`, and the least share.
const WEIGHT: [[f64; 2]; 2] = [[-4.2, 1.5], [0.0, 2.0]];
const SHARE: [[f64; 2]; 2] = [[-4.2, 4.2], [0.0, 1.0]];
/// Largest share that a wall touched again may bear less.
const MAX_RETOUCH: f64 = 0.75;
/// Where a wall was left, and the force from which on it is less: so many times the pressure below rest, and what the fluid pulls. See
/// the firmware's `signal::relaxation`.
const LEFT_PULLS: f64 = 4.0;
const PULL: f64 = 4.0;
/// Steps of the first look, and halvings of them.
const LOOK: u32 = 7;
const HALVINGS: u32 = 8;

/// Parameters of a design for the chip's rules for a relaxing wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InTime {
    /// `phi_0`: share of the contact's force that the fluid bears at no pressure, 0 to 1.
    pub fluid_least: f64,
    /// `P_1`: settled pressure rise at which it bears half of the rest too, pascals, > 0.
    pub fluid_half: f64,
    /// `kappa` of the weight `1 / (1 + kappa P / (P_2 + P))`: 0 to below 7.
    pub weight_gain: f64,
    /// `P_2` of it, pascals, > 0.
    pub weight_half: f64,
    /// Reduction of the force on a wall that is touched again before it has recovered, over `P_l / P_e`, where `P_l` is the settled pressure
    /// where the force was last 0: 0 to `MAX_RETOUCH`.
    pub retouch: f64,
    /// Change of the settled pressure by [`WALL_TEMPERATURE`], over `P_e (1 - P_e / P)`, >= 0.
    pub temperature_gain: f64,
}

/// What tables of a design are held to: of one that relaxes from a smaller part of full scale on. What a press of a second reads there has the
/// wall as many times as stiff as settled, and so the settled pressure that the tables are asked at is that much smaller.
pub(super) fn accuracy(asked: Accuracy, relaxation: Option<&Relaxation>) -> Accuracy {
    let stiffened = relaxation.map_or(1.0, |relaxation| {
        let terms = relaxation.terms().iter();
        1.0 + terms.map(|term| term.over(SECONDS[0]).taken).sum::<f64>()
    });
    Accuracy {
        from_percent_of_full_scale: asked.from_percent_of_full_scale / stiffened,
        ..asked
    }
}

/// An instant of the press, and what passed since the one before.
#[derive(Clone, Copy)]
struct Step {
    /// Since the one before.
    seconds: f64,
    decays: [Decay; MAX_TERMS],
    stiffness: f64,
    /// Newtons and metres.
    truth: [f64; 2],
    /// Pascals.
    pressure: f64,
    /// Of [`SECONDS`].
    phase: usize,
    touches: bool,
}

/// A press in time beside the settled states of the same solid.
struct Press {
    terms: usize,
    steps: Vec<Step>,
    settled: Curve,
    /// Settled pressure rise at the depth, pascals.
    end: f64,
    peak: f64,
    depth: f64,
    height: f64,
    /// By how much a second stiffens the wall over its settled state, at most 1.
    stiffening: f64,
    pressed: [f64; 2],
}

/// Fits the four numbers of a design that relaxes: onto the ball that it states, and else onto a plate.
pub(super) fn fitted(
    design: &DesignFile,
    plate: &DesignFile,
    relaxation: &Relaxation,
    end: Contact,
) -> Result<InTime, GenerateError> {
    let on_ball = design
        .object
        .is_some_and(|object| matches!(object.shape, ShapeSection::Ball { radius_mm } if radius_mm > 0.0));
    let touching = if on_ball { design } else { plate };
    let press = Press::solve(&touching.design_to(Axes::Outer), relaxation, end.indentation)?;
    let weight = if press.stiffening < MIN_STIFFENING {
        [press.end, 0.0]
    } else {
        press.weight(least(WEIGHT, |at| press.indentation_error(press.weight(at))))
    };
    let elastic = press.elastic(weight, &press.steps);
    let share = least(SHARE, |at| press.force_error(&elastic, press.share(at)));
    let [fluid_half, fluid_least] = press.share(share);
    let [weight_half, weight_gain] = weight;
    Ok(InTime {
        fluid_least,
        fluid_half,
        weight_gain,
        weight_half,
        retouch: press.retouch(&elastic, [fluid_half, fluid_least]),
        temperature_gain: press.temperature_gain(relaxation, weight, &elastic),
    })
}

impl Press {
    fn solve(design: &Design, relaxation: &Relaxation, deepest: f64) -> Result<Self, GenerateError> {
        let deepest = deepest.min(DEEP * design.membrane.axial_semi_axis);
        let mut failed = None;
        for part in DEPTHS {
            match history(design, relaxation, part * deepest) {
                Ok(steps) => return Self::beside(design, relaxation, steps, part * deepest),
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        let none = GenerateError::NotConvolved("no press in time was solved");
        Err(failed.map_or(none, GenerateError::InTime))
    }

    fn beside(
        design: &Design,
        relaxation: &Relaxation,
        steps: Vec<Step>,
        depth: f64,
    ) -> Result<Self, GenerateError> {
        let mut tip = Fingertip::of(Kind::Solid(ELEMENTS), design).map_err(GenerateError::Model)?;
        let mut states = Vec::new();
        for k in 0..STATES {
            let part = FIRST * libm::pow(BEYOND / FIRST, f64::from(k) / f64::from(STATES - 1));
            match tip.contact_at(part * depth) {
                Ok(state) => states.push(state),
                // Beyond the depth there need not be one.
                Err(_) if part > 1.0 => break,
                Err(error) => return Err(GenerateError::Model(error)),
            }
        }
        let settled = Curve::new(states)
            .map_err(|error| GenerateError::Curve(crate::curve::CurveFailure::Shape(error)))?;
        let second = relaxation.terms().iter().map(|term| term.over(1.0).taken);
        let little = second.sum::<f64>().min(1.0);
        let first = steps.iter().filter(|step| step.phase < 3);
        Ok(Self {
            terms: relaxation.terms().len(),
            peak: first.map(|step| step.truth[0]).fold(0.0, f64::max),
            steps,
            end: settled.at_indentation(depth).pressure_rise,
            settled,
            depth,
            height: design.membrane.axial_semi_axis,
            stiffening: little,
            pressed: PRESSED.map(|error| error * little),
        })
    }

    /// `P_2` and `kappa` of a place in the fit.
    fn weight(&self, [half, gain]: [f64; 2]) -> [f64; 2] {
        [self.end * libm::exp(half), libm::expm1(gain)]
    }

    /// `P_1` and the least share.
    fn share(&self, [half, least]: [f64; 2]) -> [f64; 2] {
        [self.end * libm::exp(half), least]
    }

    /// The settled pressure at each instant, within the curve: the chip's rule.
    fn elastic(&self, [half, gain]: [f64; 2], steps: &[Step]) -> Vec<f64> {
        let (mut weighted, mut elastic, mut before) = (0.0, 0.0, 0.0);
        let mut held = [0.0; MAX_TERMS];
        steps
            .iter()
            .map(|step| {
                let expected = f64::max(2.0 * elastic - before, 0.0);
                before = elastic;
                let mut left = 0.0;
                for (held, decay) in held[..self.terms].iter_mut().zip(&step.decays) {
                    *held *= decay.left;
                    left += *held;
                }
                // A step here is longer than the chip's: its weight is that of its end.
                let (from, mut now, mut change) = (weighted, expected, 0.0);
                for _ in 0..3 {
                    let stiffer = 1.0 + gain * now / (half + now);
                    change = (step.pressure * stiffer - from - left) / step.stiffness;
                    elastic = (from + change) / stiffer;
                    now = 0.5 * (now + elastic.max(0.0));
                }
                weighted = from + change;
                for (held, decay) in held[..self.terms].iter_mut().zip(&step.decays) {
                    *held += decay.taken * change;
                }
                elastic
            })
            .collect()
    }

    /// Half of what a wall that is so much colder and one that is so much warmer lie apart, over `P_e (1 - P_e / P)`: the mean while pressed and held.
    fn temperature_gain(&self, relaxation: &Relaxation, weight: [f64; 2], elastic: &[f64]) -> f64 {
        let [colder, warmer] = [-WALL_TEMPERATURE, WALL_TEMPERATURE].map(|apart| {
            let relaxation = relaxation.at(relaxation.temperature + apart);
            let mut steps = self.steps.clone();
            for step in &mut steps {
                (step.decays, step.stiffness) = over(&relaxation, step.seconds);
            }
            self.elastic(weight, &steps)
        });
        let (mut apart, mut unsettled) = (0.0, 0.0);
        for (k, step) in self.steps.iter().enumerate() {
            let elastic = elastic[k];
            if step.phase < 2 && step.truth[1] >= FROM[1] * self.depth && elastic > 0.0 {
                apart += 0.5 * (warmer[k] - colder[k]).abs() / elastic;
                unsettled += f64::max(1.0 - elastic / step.pressure, 0.0);
            }
        }
        if unsettled > 0.0 { apart / unsettled } else { 0.0 }
    }

    /// What a settled pressure has on the curve.
    fn at(&self, elastic: f64) -> Contact {
        if elastic <= 0.0 {
            return Contact::default();
        }
        let end = self.settled.end();
        if elastic >= end.pressure_rise {
            return end;
        }
        self.settled.at_pressure_rise(elastic)
    }

    fn indentation_error(&self, weight: [f64; 2]) -> f64 {
        let read = self
            .elastic(weight, &self.steps)
            .into_iter()
            .map(|elastic| self.at(elastic).indentation);
        self.error(1, self.height, read)
    }

    /// The force at each instant, a wall touched again as one that was never touched.
    fn forces(&self, elastic: &[f64], [half, least]: [f64; 2]) -> impl Iterator<Item = f64> {
        let (mut settled, mut held) = (0.0, [0.0; MAX_TERMS]);
        self.steps.iter().zip(elastic).map(move |(step, &elastic)| {
            let positive = elastic.max(1e-6 * self.end).min(self.settled.end().pressure_rise);
            let area = self.settled.at_pressure_rise(positive).force / positive;
            let change = area * elastic - core::mem::replace(&mut settled, area * elastic);
            let mut convolved = settled;
            for (held, decay) in held[..self.terms].iter_mut().zip(&step.decays) {
                *held = *held * decay.left + decay.taken * change;
                convolved += *held;
            }
            let fluid = least + (1.0 - least) * elastic.max(0.0) / (half + elastic.max(0.0));
            f64::max(fluid * area * step.pressure + (1.0 - fluid) * convolved, 0.0)
        })
    }

    fn force_error(&self, elastic: &[f64], share: [f64; 2]) -> f64 {
        self.error(0, self.peak, self.forces(elastic, share))
    }

    /// Least squares of what the second press is read too high.
    fn retouch(&self, elastic: &[f64], share: [f64; 2]) -> f64 {
        let (mut left, mut pull, mut above, mut square) = (0.0, 0.0, 0.0, 0.0);
        let read = self.forces(elastic, share);
        for ((step, read), &elastic) in self.steps.iter().zip(read).zip(elastic) {
            left *= libm::exp(-step.seconds / LEFT_TIME);
            if read <= 0.0 {
                left = left.max(-LEFT_PULLS * step.pressure);
                let positive = elastic.max(1e-6 * self.end).min(self.settled.end().pressure_rise);
                pull = PULL * self.settled.at_pressure_rise(positive).force / positive * step.pressure;
            }
            left = left.min(elastic);
            if step.phase == 4 && read > 0.0 && left > 0.0 {
                let less = f64::max(read + pull, -read) * left / elastic;
                above += less * (read - step.truth[0]);
                square += less * less;
            }
        }
        (above / f64::max(square, f64::MIN_POSITIVE)).clamp(0.0, MAX_RETOUCH)
    }

    /// Mean fourth powers of what is read of force (0) or indentation (1) off the truth, over what counts as one; on the release over a whole.
    fn error(&self, output: usize, whole: f64, read: impl Iterator<Item = f64>) -> f64 {
        let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
        for (step, read) in self.steps.iter().zip(read) {
            let off = read - step.truth[output];
            let least = [self.peak, self.depth];
            let is_small = (0..2).any(|output| step.truth[output] < FROM[output] * least[output]);
            let (part, off) = match step.phase {
                0 | 1 if is_small => continue,
                0 | 1 => (0, off / step.truth[output] / self.pressed[output]),
                2 if step.touches => (1, off / whole / LEFT[output]),
                _ => continue,
            };
            sums[part] += off * off * off * off;
            counts[part] += 1.0;
        }
        (0..2).map(|part| sums[part] / f64::max(counts[part], 1.0)).sum()
    }
}

/// Pressed, held and let go in time, and pressed again where the solid can be.
fn history(design: &Design, relaxation: &Relaxation, depth: f64) -> Result<Vec<Step>, HistoryError> {
    let mut history = History::new(design, relaxation, ELEMENTS, 0.0, 0.0)?;
    let mut steps = Vec::new();
    let (mut begin, mut before) = (0.0, 0.0);
    for (phase, seconds) in SECONDS.into_iter().enumerate() {
        let turns = [0.0, depth, depth, 0.0, 0.0, depth];
        let [from, to] = [turns[phase], turns[phase + 1]];
        for k in 1..=INSTANTS {
            // Denser after a turn.
            let part = f64::from(k) / f64::from(INSTANTS);
            let part = part * libm::sqrt(part);
            let time = begin + part * seconds;
            let now = match history.advance(time, Drive::Indentation(from + part * (to - from))) {
                Ok(now) => now,
                Err(_) if phase > 2 => return Ok(steps),
                Err(error) => return Err(error),
            };
            let (decays, stiffness) = over(relaxation, time - before);
            steps.push(Step {
                seconds: time - before,
                decays,
                stiffness,
                truth: [now.force, now.indentation],
                pressure: now.pressure_rise,
                phase,
                touches: now.in_contact(),
            });
            before = time;
        }
        begin += seconds;
    }
    Ok(steps)
}

/// What each term does in so many seconds, and how many times as stiff as settled the wall is.
fn over(relaxation: &Relaxation, seconds: f64) -> ([Decay; MAX_TERMS], f64) {
    let mut decays = [Decay::default(); MAX_TERMS];
    let mut stiffness = 1.0;
    for (decay, term) in decays.iter_mut().zip(relaxation.terms()) {
        *decay = term.over(seconds);
        stiffness += decay.taken;
    }
    (decays, stiffness)
}

/// Where a function of two places is least within bounds: a look at a grid, then a compass (Kolda, Lewis and Torczon, "Optimization by direct
/// search", SIAM Review 45, 2003, section 1).
fn least(bounds: [[f64; 2]; 2], error: impl Fn([f64; 2]) -> f64) -> [f64; 2] {
    let mut steps = bounds.map(|[low, high]| (high - low) / f64::from(LOOK - 1));
    let mut best = [0, 1].map(|axis: usize| bounds[axis][0]);
    let mut smallest = error(best);
    for i in 0..LOOK {
        for j in 0..LOOK {
            let at = [
                bounds[0][0] + f64::from(i) * steps[0],
                bounds[1][0] + f64::from(j) * steps[1],
            ];
            let found = error(at);
            if found < smallest {
                (smallest, best) = (found, at);
            }
        }
    }
    for _ in 0..HALVINGS {
        steps = steps.map(|step| 0.5 * step);
        let mut moved = true;
        while moved {
            moved = false;
            for (axis, side) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
                let mut at = best;
                at[axis] = (at[axis] + side * steps[axis]).clamp(bounds[axis][0], bounds[axis][1]);
                let found = error(at);
                if found < smallest {
                    (smallest, best, moved) = (found, at, true);
                }
            }
        }
    }
    best
}
