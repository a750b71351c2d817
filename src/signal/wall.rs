//! Pressure rise -> force and indentation with their 1-sigma: for an elastic wall from the tables, for a relaxing one also from its
//! past.
//!
//! A relaxing wall's past is not known at the start, after a gap in the samples, or where the transducer was at its lower end. Two
//! states then bracket it. One continues as if no time had passed (at the start: as if just pressed). The other is that of a wall
//! that has settled at this pressure. The values are the mean of both, and the 1-sigma includes half of their difference, until the
//! two states agree.
//!
//! The wall's temperature is not measured. The 1-sigma includes its effect from [`WallSeries::temperature_gain`], through elastic
//! pressure and tables.

use crate::signal::contact::{contact, through_tables};
use crate::signal::design::{Design, Rise, Wall};
use crate::signal::relaxation::{RelaxedReading, Relaxing, WHOLE, part};
use crate::signal::report::{Contact, Sigma};
use crate::signal::uncertainty::hypotenuse;
use crate::status::Warnings;
use crate::units::Microseconds;
use model_tables::material::series::WallSeries;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// The two states count as equal if their difference is below the 1-sigma divided by this.
const TOGETHER: i32 = 4;

/// Effect of the wall's temperature on the elastic pressure after a release, when the pressure is below the elastic pressure.
/// As a share of their difference and of the design's gain, in 1/65536. Three sixteenths is the median of releases of dome A of
/// 9 x 7 x 1 mm over two minutes.
const RELEASED: u32 = 3 << 12;

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

/// The memory of a wall whose relaxation series has up to `TERMS` terms.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Memory<const TERMS: usize> {
    wall: Relaxing<TERMS>,
    /// The second state of the bracket, used while `open`.
    settled: Relaxing<TERMS>,
    open: bool,
    /// Whether the pressure is known without a gap since the last reading, and the time and rise of that reading.
    tracked: bool,
    time: Microseconds,
    rise: PressureRise,
    lowered: bool,
}

impl<const TERMS: usize> Wall for Memory<TERMS> {
    const NEW: Self = Self {
        wall: Relaxing::NEW,
        settled: Relaxing::NEW,
        open: false,
        tracked: false,
        time: Microseconds(0),
        rise: PressureRise(0),
        lowered: false,
    };

    fn read(&mut self, design: &impl Design, rise: Rise) -> (Contact, Sigma) {
        let Some(series) = design.series() else {
            return Elastic.read(design, rise);
        };
        let steps = self.steps(design, series, &rise);
        let step = rise.rise.0.saturating_sub(self.rise.0) / steps;
        let mut readings = [RelaxedReading::default(); 2];
        for left in (0..steps).rev() {
            let between = PressureRise(rise.rise.0 - step * left);
            readings[0] = self.wall.step(design, series, between);
            if self.open {
                readings[1] = self.settled.step(design, series, between);
            }
        }
        self.rise = rise.rise;
        let [first, second] = readings;
        self.lowered = first.lowered;
        let mut values = first.contact;
        let mut sigma = sigma_of(design, series, &self.wall, &first, &rise);
        if self.open {
            let other = second.contact;
            let force = middle(values.force.0, other.force.0, sigma.force.0);
            let indentation = middle(values.indentation.0, other.indentation.0, sigma.indentation.0);
            values.force = Micronewtons(force.value);
            values.indentation = Nanometres(indentation.value);
            sigma.force = Micronewtons(force.sigma);
            sigma.indentation = Nanometres(indentation.sigma);
            let doubtful = force.doubtful || indentation.doubtful;
            values.warnings = values
                .warnings
                .and(other.warnings)
                .and(Warnings::PAST_UNKNOWN.when(doubtful));
            self.open = force.open || indentation.open;
        }
        values.warnings = values.warnings.and(rise.warnings);
        (values, sigma)
    }

    fn lowers_the_pressure(&self) -> bool {
        self.lowered
    }

    fn shift(&mut self, design: &impl Design, by: PressureRise) {
        if let Some(series) = design.series() {
            self.wall.shift(design, series, by);
            self.settled.shift(design, series, by);
        }
        self.rise.0 = self.rise.0.saturating_add(by.0);
    }

    fn lose_track(&mut self) {
        self.tracked = false;
    }
}

impl<const TERMS: usize> Memory<TERMS> {
    /// Number of report periods since the last reading. If that is unknown, it is one, and the bracket opens.
    fn steps(&mut self, design: &impl Design, series: &WallSeries, to: &Rise) -> i32 {
        let parameters = design.parameters();
        let passed = to.time.0.saturating_sub(self.time.0);
        self.time = to.time;
        if core::mem::replace(&mut self.tracked, true) && passed <= parameters.gap() {
            // At most 20.
            return ((passed as u32 + parameters.period / 2) / parameters.period).max(1) as i32;
        }
        // At rest both states are the same.
        self.open = to.rise.0.saturating_abs() > parameters.thresholds.release.0;
        if self.open {
            self.settled.settle(design, series, to.rise);
        }
        1
    }
}

/// The middle of two values, with its 1-sigma.
struct Middle {
    value: i32,
    sigma: i32,
    /// `doubtful`: half of their difference exceeds the 1-sigma. `open`: it is large enough to count beside the 1-sigma.
    doubtful: bool,
    open: bool,
}

#[inline(never)]
fn middle(one: i32, other: i32, sigma: i32) -> Middle {
    let apart = (one.abs_diff(other) / 2) as i32;
    Middle {
        value: i32::midpoint(one, other),
        sigma: hypotenuse(sigma, apart),
        doubtful: apart > sigma,
        open: apart > sigma / TOGETHER,
    }
}

/// The 1-sigma from three sources: the rise, through the tables at the elastic pressure; the wall's temperature; and the force
/// that a recovering wall may still carry.
fn sigma_of<const TERMS: usize>(
    design: &impl Design,
    series: &WallSeries,
    wall: &Relaxing<TERMS>,
    at: &RelaxedReading,
    rise: &Rise,
) -> Sigma {
    let settled = Contact {
        force: at.settled,
        ..at.contact
    };
    let mut sigma = through_tables(design, at.elastic, &settled, rise.sigma);
    let moved = by_temperature(series, rise.rise.0, at.elastic.0);
    let warmer = through_tables(design, at.elastic, &settled, PressureRise(moved));
    // The pressure is measured, so the force changes in proportion to the contact area, which is the settled force divided by the elastic pressure.
    let force = part(warmer.force.0, at.settled.0);
    let elastic = part(moved, at.elastic.0);
    let area = part(force.abs_diff(elastic) as i32, (WHOLE + elastic) as i32);
    let mut open = (at.contact.force.0.unsigned_abs(), area, 16);
    if at.contact.warnings.contains(Warnings::RECOVERING) {
        // 4194 / 2^22 is a thousandth.
        open = (
            wall.peak_force().0.unsigned_abs(),
            series.remaining_permille * 4194,
            22,
        );
    }
    // Below 2^53.
    let force = ((u64::from(open.0) * u64::from(open.1)) >> open.2) as i32;
    sigma.force = Micronewtons(hypotenuse(sigma.force.0, force));
    sigma.indentation = Nanometres(hypotenuse(sigma.indentation.0, warmer.indentation.0));
    sigma
}

/// Effect of the wall's unknown temperature on the elastic pressure, counts >= 0, less than the difference of rise and elastic pressure.
fn by_temperature(series: &WallSeries, rise: i32, elastic: i32) -> i32 {
    let share = if rise > elastic {
        part(elastic, rise)
    } else {
        RELEASED
    };
    let gain = (share * series.temperature_gain.min(WHOLE - 1)) >> 16;
    ((u64::from(rise.abs_diff(elastic)) * u64::from(gain)) >> 16).min(u64::from(i32::MAX.unsigned_abs()))
        as i32
}

#[cfg(test)]
mod tests;
