//! The fewest terms of a wall's series that read as all of them do, at the time from one report to the next.
//!
//! The chip inverts the convolution of its series at each report ([`crate::material::series`]). Terms that relax faster than that are dashpots
//! side by side, and one can stand for several. Two neighbouring terms become one of the same viscosity `sum g tau`, the stress in an even
//! flow. It also has the same stiffness in a step, the same `sum g tau^2` or the same `sum g`, whichever adds the least error.
//!
//! The error that fewer terms add is found on presses, holds and partial releases: the pressure of the whole series, inverted with the
//! fewer terms, beside the settled pressure that it belongs to. Force and indentation follow the settled pressure less than in proportion
//! (indentation), and through the area alone (force). Terms are merged as long as the error is within the accuracy that the design asks of its tables.

use crate::design_file::Accuracy;
use crate::material::relaxation::{MAX_TERMS, Relaxation, Term};
use std::fmt;

/// Presses take so many seconds, and so many reports at least: the pressure of a faster one is not straight from one report to the next.
/// Each is held so many times as long, and so large a part of it is released as fast.
const PRESSES: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
const REPORTS: f64 = 16.0;
const HELD: f64 = 3.0;
const RELEASED: f64 = 0.5;
/// Errors count from this part of the press on.
const FROM: f64 = 0.05;
/// A step over the time since the last turn; one report at least.
const STEP: f64 = 0.03;

/// A series as the chip has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipSeries {
    /// Its terms, at the temperature of the whole series and with its shift.
    pub series: Relaxation,
    /// How many terms the whole series has.
    pub of: usize,
    /// From one report to the next, seconds, > 0.
    pub period: f64,
    /// The error that it adds, percent of the settled pressure; 0 if it has all terms.
    pub added_percent: f64,
    /// What one term fewer would add, percent of the settled pressure; `None` if there is only one.
    pub next_percent: Option<f64>,
    /// The most that is allowed, percent of the settled pressure: the smaller of the errors that the design asks of its tables.
    pub allowed_percent: f64,
}

impl ChipSeries {
    /// The fewest terms of a series, for reports every `period` seconds, > 0.
    pub fn fewest(whole: &Relaxation, period: f64, accuracy: &Accuracy) -> Self {
        let mut found = Self {
            series: *whole,
            of: whole.terms().len(),
            period,
            added_percent: 0.0,
            next_percent: None,
            allowed_percent: f64::min(
                accuracy.force_percent_of_reading,
                accuracy.indentation_percent_of_reading,
            ),
        };
        loop {
            let next = merged(&found.series, period)
                .map(|series| (error_percent(whole, &series, period), series))
                .min_by(|one, other| one.0.total_cmp(&other.0));
            found.next_percent = next.map(|(percent, _)| percent);
            match next {
                Some((percent, series)) if percent <= found.allowed_percent => {
                    (found.series, found.added_percent) = (series, percent);
                }
                _ => return found,
            }
        }
    }
}

impl fmt::Display for ChipSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.series.terms().len();
        write!(
            f,
            "{count} of {} terms of the series are enough for a report every {} ms",
            self.of,
            // Whole microseconds.
            libm::round(1e6 * self.period) / 1e3
        )?;
        if count < self.of {
            write!(
                f,
                ": they add {:.2} % of the settled pressure",
                self.added_percent
            )?;
        }
        match self.next_percent {
            Some(next) => write!(
                f,
                "{} {} would add {next:.2} %, and [accuracy] allows {} %",
                if count < self.of { "," } else { ":" },
                count - 1,
                self.allowed_percent
            ),
            None => Ok(()),
        }
    }
}

/// The series with two neighbouring terms as one.
fn merged(series: &Relaxation, period: f64) -> impl Iterator<Item = Relaxation> {
    let terms = series.terms();
    (1..terms.len()).flat_map(move |slow| {
        let pair = [terms[slow - 1], terms[slow]];
        let ones = [as_stiff(pair, period), of_moment(pair, 2), of_moment(pair, 0)];
        ones.into_iter().map(move |one| {
            let mut fewer = [Term::default(); MAX_TERMS];
            fewer[..slow].copy_from_slice(&terms[..slow]);
            fewer[slow - 1] = one;
            fewer[slow..terms.len() - 1].copy_from_slice(&terms[slow + 1..]);
            Relaxation::new(&fewer[..terms.len() - 1], series.temperature, series.shift)
        })
    })
}

/// One term of the viscosity of two, and of their stiffness in a step of so many seconds.
fn as_stiff(pair: [Term; 2], seconds: f64) -> Term {
    let sum = |of: fn(Term, f64) -> f64| of(pair[0], seconds) + of(pair[1], seconds);
    let viscosity = sum(|term, _| term.weight * term.time);
    // In a step a term takes `g tau / dt (1 - exp(-dt / tau))`.
    let taken = seconds * sum(|term, step| term.over(step).taken);
    with_time(pair, -seconds / libm::log1p(-taken / viscosity), viscosity)
}

/// One term of the viscosity of two, and of their `sum g tau^power`, of 2 or 0.
fn of_moment(pair: [Term; 2], power: i32) -> Term {
    let sum = |power: i32| {
        pair.iter().fold(0.0, |sum, term| {
            sum + term.weight * libm::pow(term.time, f64::from(power))
        })
    };
    let viscosity = sum(1);
    let time = if power == 0 {
        viscosity / sum(0)
    } else {
        sum(2) / viscosity
    };
    with_time(pair, time, viscosity)
}

/// Of no weight where two have none, or where rounding leaves no time between theirs.
fn with_time([fast, slow]: [Term; 2], time: f64, viscosity: f64) -> Term {
    if !(fast.time..=slow.time).contains(&time) {
        return Term {
            time: slow.time,
            weight: viscosity / slow.time,
        };
    }
    Term {
        time,
        weight: viscosity / time,
    }
}

/// The largest error of the settled pressure by a series, of pressures of another, percent of it.
fn error_percent(whole: &Relaxation, series: &Relaxation, period: f64) -> f64 {
    PRESSES
        .into_iter()
        .map(|seconds| error_of_press(whole, series, period, f64::max(seconds, REPORTS * period)))
        .fold(0.0, f64::max)
}

fn error_of_press(whole: &Relaxation, series: &Relaxation, period: f64, press: f64) -> f64 {
    let (mut truth, mut read) = (0.0, 0.0);
    let mut stresses = [[0.0; MAX_TERMS]; 2];
    let mut largest = 0.0_f64;
    for (seconds, end) in [(press, 1.0), (HELD * press, 1.0), (press, 1.0 - RELEASED)] {
        let (begin, mut passed) = (truth, 0.0);
        while passed < seconds {
            let step = f64::max(period, STEP * passed);
            passed += step;
            // The last step may go on beyond the turn.
            let change = begin + f64::min(passed / seconds, 1.0) * (end - begin) - truth;
            truth += change;
            let [of_whole, of_fewer] = &mut stresses;
            let (mut pressure, mut left, mut stiffness) = (truth, 0.0, 1.0);
            for (stress, term) in of_whole.iter_mut().zip(whole.terms()) {
                let decay = term.over(step);
                *stress = decay.left * *stress + decay.taken * change;
                pressure += *stress;
            }
            let decays = series.terms().iter().map(|term| term.over(step));
            for (stress, decay) in of_fewer.iter_mut().zip(decays.clone()) {
                *stress *= decay.left;
                left += *stress;
                stiffness += decay.taken;
            }
            let moved = (pressure - read - left) / stiffness;
            read += moved;
            for (stress, decay) in of_fewer.iter_mut().zip(decays) {
                *stress += decay.taken * moved;
            }
            if truth >= FROM {
                largest = largest.max((read / truth - 1.0).abs());
            }
        }
    }
    100.0 * largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::relaxation::AGILUS30_RELAXATION;
    use crate::material::series::SeriesStep;
    use crate::random::Random;

    /// Eight terms, three of them faster than 14 ms.
    const DENSE: Relaxation = Relaxation::new(
        &[
            term(1e-4, 400.0),
            term(1e-3, 100.0),
            term(3e-3, 40.0),
            term(1e-2, 20.0),
            term(0.1, 5.0),
            term(1.0, 2.0),
            term(10.0, 1.0),
            term(100.0, 0.3),
        ],
        20.0,
        0.31,
    );

    const fn term(time: f64, weight: f64) -> Term {
        Term { time, weight }
    }

    fn asked(percent: f64) -> Accuracy {
        Accuracy {
            force_percent_of_reading: percent,
            indentation_percent_of_reading: 2.0 * percent,
            from_percent_of_full_scale: 1.0,
            model_percent: 5.0,
        }
    }

    #[test]
    fn the_count_goes_with_accuracy_and_rate() {
        let count = |series: &Relaxation, period: f64, percent: f64| {
            let found = ChipSeries::fewest(series, period, &asked(percent));
            println!("{found}");
            assert!(found.added_percent <= percent && found.next_percent.is_none_or(|next| next > percent));
            found.series.terms().len()
        };
        // Every report counts at 1 ms, and at 14 ms the terms of 1 and 10 ms are one within 0.6 %.
        assert_eq!(count(&AGILUS30_RELAXATION, 1e-3, 0.1), 7);
        assert_eq!(count(&AGILUS30_RELAXATION, 14e-3, 0.1), 7);
        assert_eq!(count(&AGILUS30_RELAXATION, 14e-3, 0.6), 6);
        assert_eq!(count(&DENSE, 1e-3, 0.1), 8);
        assert_eq!(count(&DENSE, 14e-3, 0.1), 6);
    }

    /// A term that is twice there, and one of no weight, add nothing.
    #[test]
    fn what_is_twice_there_becomes_one() {
        let twice = Relaxation::new(
            &[term(0.1, 3.0), term(0.1, 2.0), term(1.0, 0.0), term(10.0, 1.5)],
            20.0,
            0.0,
        );
        let found = ChipSeries::fewest(&twice, 1e-3, &asked(1e-6));
        let terms = found.series.terms();
        assert_eq!(terms.len(), 2, "{found}");
        for (term, [time, weight]) in terms.iter().zip([[0.1, 5.0], [10.0, 1.5]]) {
            assert!((term.time / time - 1.0).abs() < 1e-9, "{term:?}");
            assert!((term.weight / weight - 1.0).abs() < 1e-9, "{term:?}");
        }
    }

    /// Presses of random lengths, depths and holds, each from rest: pressures of the whole series in `f64`, each report; the chip's integers with
    /// the fewer terms, in `2^-32` Pa. Largest error, percent of the settled pressure.
    fn error_of_the_chip(whole: &Relaxation, found: &ChipSeries) -> f64 {
        let step = SeriesStep::over(&found.series, found.period);
        let decays: Vec<_> = whole.terms().iter().map(|term| term.over(found.period)).collect();
        let mut random = Random(15);
        let mut largest = 0.0_f64;
        for _ in 0..200 {
            let reports = libm::ceil(random.logarithmic(16.0 * found.period, 30.0) / found.period);
            let deep = random.uniform(3e3, 30e3);
            let held = libm::ceil(reports * random.uniform(0.0, 3.0));
            let (mut truth, mut stresses) = (0.0, [0.0; MAX_TERMS]);
            let (mut elastic, mut states) = (0_i64, [0_i64; MAX_TERMS]);
            for report in 0..(2.0 * reports + held) as u32 {
                let report = f64::from(report);
                let change = match report {
                    _ if report < reports => deep / reports,
                    _ if report < reports + held => 0.0,
                    _ => -0.5 * deep / reports,
                };
                truth += change;
                let mut pressure = truth;
                for (stress, decay) in stresses.iter_mut().zip(&decays) {
                    *stress = decay.left * *stress + decay.taken * change;
                    pressure += *stress;
                }
                let stress = (4_294_967_296.0 * pressure) as i64 - elastic - step.decay(&mut states);
                step.take(&mut states, stress);
                elastic += step.settled.of(stress);
                if truth >= 0.05 * deep {
                    largest = largest.max((elastic as f64 / 4_294_967_296.0 / truth - 1.0).abs());
                }
            }
        }
        100.0 * largest
    }

    #[test]
    fn the_chip_reads_with_fewer_terms_as_with_all() {
        for (whole, percent) in [(DENSE, 0.1), (AGILUS30_RELAXATION, 0.6)] {
            let found = ChipSeries::fewest(&whole, 14e-3, &asked(percent));
            let error = error_of_the_chip(&whole, &found);
            println!("{found}; 200 random presses: {error:.4} %");
            assert!(found.series.terms().len() < whole.terms().len());
            // Found on the shortest press, and no more than that on others.
            assert!(error <= 1.05 * found.added_percent + 1e-3, "{error} %");
            // One term fewer than is allowed is seen as such.
            let fewer = ChipSeries {
                series: Relaxation::new(&found.series.terms()[1..], 20.0, 0.31),
                ..found
            };
            assert!(error_of_the_chip(&whole, &fewer) > 10.0 * percent);
        }
    }
}
