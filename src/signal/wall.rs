//! Pressure rise -> force and indentation with their 1-sigma: of an elastic wall by the tables, of a relaxing one by what it has been
//! through.
//!
//! A relaxing wall's past is not known at the start, after a gap in the samples, or where the transducer was at its lower end. Two states
//! then bracket it: one goes on as if no time had passed (at the start: as if just pressed), the other is that of a wall that has settled at
//! this pressure. Values are the middle of both, half of what they are apart is in the 1-sigma, until they have come together.

use crate::signal::contact::{Contact, contact, through_tables};
use crate::signal::design::Design;
use crate::signal::relaxation::{RelaxedReading, Relaxing};
use crate::signal::report::Sigma;
use crate::signal::uncertainty::hypotenuse;
use crate::status::Warnings;
use crate::units::Microseconds;
use model_tables::material::series::WallSeries;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// What two states differ by, over the 1-sigma, where they count as one: as a divisor.
const TOGETHER: i32 = 4;

/// A pressure rise to be read.
#[derive(Clone, Copy, Debug)]
pub struct Rise {
    /// When it was.
    pub time: Microseconds,
    /// The rise.
    pub rise: PressureRise,
    /// Its 1-sigma.
    pub sigma: PressureRise,
    /// What qualifies it.
    pub warnings: Warnings,
}

/// What a wall remembers of its past.
pub trait Wall: Clone + core::fmt::Debug {
    /// A wall of whose past nothing is known.
    const NEW: Self;

    /// Force and indentation at a rise, with their 1-sigma.
    fn read(&mut self, design: &impl Design, rise: Rise) -> (Contact, Sigma);

    /// Whether its memory lowers the pressure so that this says nothing of the zero.
    fn lowers_the_pressure(&self) -> bool;

    /// The zero moved, and with it every rise so far, by so many counts.
    fn shift(&mut self, design: &impl Design, by: PressureRise);

    /// What happened since the last reading is not known.
    fn lose_track(&mut self);
}

/// A wall without a memory.
#[derive(Clone, Copy, Debug)]
pub struct Elastic;

impl Wall for Elastic {
    const NEW: Self = Self;

    #[inline]
    fn read(&mut self, design: &impl Design, rise: Rise) -> (Contact, Sigma) {
        let at = contact(design, rise.rise, rise.warnings);
        let sigma = through_tables(design, rise.rise, &at, rise.sigma);
        (at, sigma)
    }

    #[inline]
    fn lowers_the_pressure(&self) -> bool {
        false
    }

    #[inline]
    fn shift(&mut self, _: &impl Design, _: PressureRise) {}

    #[inline]
    fn lose_track(&mut self) {}
}

/// The memory of a wall that relaxes in up to so many terms.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Memory<const TERMS: usize> {
    wall: Relaxing<TERMS>,
    /// The other end of the bracket.
    settled: Option<Relaxing<TERMS>>,
    /// Where the wall is, if its past is known.
    last: Option<(Microseconds, PressureRise)>,
    lowered: bool,
}

impl<const TERMS: usize> Wall for Memory<TERMS> {
    const NEW: Self = Self {
        wall: Relaxing::NEW,
        settled: None,
        last: None,
        lowered: false,
    };

    fn read(&mut self, design: &impl Design, rise: Rise) -> (Contact, Sigma) {
        let Some(series) = design.series() else {
            return Elastic.read(design, rise);
        };
        let first = self.go_on(design, series, &rise);
        self.lowered = first.lowered;
        let mut values = first.contact;
        let mut sigma = sigma_of(design, series, &self.wall, &first, rise.sigma);
        if let Some(settled) = &mut self.settled {
            let second = settled.step(design, &series.step, rise.rise);
            let half = |one: i32, other: i32| (i64::from(one).abs_diff(i64::from(other)) / 2) as i32;
            let middle = |one: i32, other: i32| i32::midpoint(one, other);
            let (one, other) = (first.contact, second.contact);
            let apart = [
                half(one.force.0, other.force.0),
                half(one.indentation.0, other.indentation.0),
            ];
            values.force = Micronewtons(middle(one.force.0, other.force.0));
            values.indentation = Nanometres(middle(one.indentation.0, other.indentation.0));
            let known = [sigma.force.0, sigma.indentation.0];
            sigma.force = Micronewtons(hypotenuse(known[0], apart[0]));
            sigma.indentation = Nanometres(hypotenuse(known[1], apart[1]));
            let open = apart
                .iter()
                .zip(&known)
                .any(|(apart, known)| *apart > known / TOGETHER);
            let doubtful = apart.iter().zip(&known).any(|(apart, known)| apart > known);
            values.warnings = values
                .warnings
                .and(other.warnings)
                .and(Warnings::PAST_UNKNOWN.when(doubtful));
            if !open {
                self.settled = None;
            }
        }
        values.warnings = values.warnings.and(rise.warnings);
        (values, sigma)
    }

    fn lowers_the_pressure(&self) -> bool {
        self.lowered
    }

    fn shift(&mut self, design: &impl Design, by: PressureRise) {
        for wall in [Some(&mut self.wall), self.settled.as_mut()]
            .into_iter()
            .flatten()
        {
            wall.shift(design, by);
        }
        if let Some((_, rise)) = &mut self.last {
            rise.0 = rise.0.saturating_add(by.0);
        }
    }

    fn lose_track(&mut self) {
        self.last = None;
    }
}

impl<const TERMS: usize> Memory<TERMS> {
    /// To a rise, in whole reports, even from the last one on.
    fn go_on(&mut self, design: &impl Design, series: &WallSeries, to: &Rise) -> RelaxedReading {
        let parameters = design.parameters();
        let period = u64::from(parameters.period);
        let passed = self
            .last
            .map(|(time, rise)| (to.time.0.saturating_sub(time.0), rise));
        self.last = Some((to.time, to.rise));
        match passed {
            Some((passed, from)) if passed <= parameters.gap() => {
                // At most 20.
                let steps = ((passed + period / 2) / period).max(1) as i64;
                let change = i64::from(to.rise.0) - i64::from(from.0);
                for i in 1..steps {
                    let rise = i64::from(from.0) + change * i / steps;
                    self.wall.step(design, &series.step, PressureRise(rise as i32));
                    if let Some(settled) = &mut self.settled {
                        settled.step(design, &series.step, PressureRise(rise as i32));
                    }
                }
            }
            _ => self.settled = Some(Relaxing::settled(design, to.rise)),
        }
        self.wall.step(design, &series.step, to.rise)
    }
}

/// What the rise leaves open through the tables at the elastic pressure, and what a wall that recovers may still bear.
fn sigma_of<const TERMS: usize>(
    design: &impl Design,
    series: &WallSeries,
    wall: &Relaxing<TERMS>,
    at: &RelaxedReading,
    rise: PressureRise,
) -> Sigma {
    let settled = Contact {
        force: at.settled,
        ..at.contact
    };
    let mut sigma = through_tables(design, at.elastic, &settled, rise);
    if at.contact.warnings.contains(Warnings::RECOVERING) {
        let remaining = i64::from(wall.peak_force().0) * i64::from(series.remaining_permille) / 1000;
        sigma.force = Micronewtons(hypotenuse(sigma.force.0, remaining as i32));
    }
    sigma
}

#[cfg(test)]
mod tests;
