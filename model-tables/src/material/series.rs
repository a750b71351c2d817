//! The series of a relaxing wall over a step of time, in the integers that the chip computes with.

use super::relaxation::{MAX_TERMS, Relaxation, Term};

/// A factor from 0 to below 1: `mantissa / 2^(32 + shift)`.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Factor {
    /// 32 bits.
    pub mantissa: u32,
    /// 0 to [`Factor::MAX_SHIFT`].
    pub shift: u32,
}

impl Factor {
    /// Largest shift.
    pub const MAX_SHIFT: u32 = 31;

    /// The nearest factor to a value from 0 to 1; one too small for the word is 0.
    pub fn nearest(value: f64) -> Self {
        let (fraction, exponent) = libm::frexp(value);
        // From 2^31 to 2^32, which is one too many.
        let mantissa = libm::round(libm::ldexp(fraction, 32)) as u32;
        match u32::try_from(-exponent) {
            Ok(shift @ 0..=Self::MAX_SHIFT) if value > 0.0 => Self { mantissa, shift },
            // One.
            Err(_) if value > 0.0 => Self {
                mantissa: u32::MAX,
                shift: 0,
            },
            _ => Self::default(),
        }
    }

    /// Its product with a number, at most one unit below.
    #[inline(always)]
    #[allow(clippy::inline_always)] // a dozen instructions
    pub const fn of(self, x: i64) -> i64 {
        // The product over 2^32, rounded down: less than the number.
        let high = (x >> 32) * self.mantissa as i64;
        let low = ((x as u32 as u64) * self.mantissa as u64) >> 32;
        // No wider shift, which the compiler then knows.
        (high + low as i64) >> (self.shift & Self::MAX_SHIFT)
    }
}

/// Change of a term in a time step.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct TermStep {
    /// `k = 1 - exp(-dt / tau)`: the fraction of it that is lost.
    pub lost: Factor,
    /// `c / (1 + sum c)` with `c = g tau / dt k`: its share of a change of stress.
    pub share: Factor,
}

/// A series over a step of time.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct SeriesStep {
    /// `1 / (1 + sum c)`: the settled wall's share of a change of stress.
    pub settled: Factor,
    /// `1 + sum c`, in `1 / 2^`[`SeriesStep::STIFFNESS_BITS`]: the stress of a change over the settled wall's.
    pub stiffness: u32,
    /// What is lost over the step of where a wall was left: see [`LEFT_TIME`].
    pub forgets: Factor,
    /// How many terms it has.
    pub count: usize,
    /// The terms, the slowest last; those beyond the count are 0.
    pub terms: [TermStep; MAX_TERMS],
}

impl SeriesStep {
    /// Bits below one of the stiffness, which is below 2^16.
    pub const STIFFNESS_BITS: u32 = 16;

    /// A series over a step of so many seconds, > 0.
    pub fn over(relaxation: &Relaxation, seconds: f64) -> Self {
        let taken = |term: &Term| term.over(seconds).taken;
        let stiffness = relaxation.terms().iter().fold(1.0, |sum, term| sum + taken(term));
        let scaled = libm::ldexp(stiffness, Self::STIFFNESS_BITS as i32);
        let mut step = Self {
            settled: Factor::nearest(1.0 / stiffness),
            forgets: Factor::nearest(-libm::expm1(-seconds / LEFT_TIME)),
            // The end of the word stands for more: no design of that has tables.
            stiffness: libm::round(scaled) as u32,
            count: relaxation.terms().len(),
            ..Self::default()
        };
        for (step, term) in step.terms.iter_mut().zip(relaxation.terms()) {
            *step = TermStep {
                lost: Factor::nearest(-libm::expm1(-seconds / term.time)),
                share: Factor::nearest(taken(term) / stiffness),
            };
        }
        step
    }

    /// Whether the settled wall and the terms share no more than the whole of a change: then nothing that they hold grows beyond
    /// what they are given.
    pub(crate) fn is_passive(&self) -> bool {
        let part = |factor: Factor| u64::from(factor.mantissa) >> (factor.shift & Factor::MAX_SHIFT);
        let shares = self
            .terms()
            .iter()
            .fold(part(self.settled), |sum, term| sum + part(term.share));
        shares <= 1 << 32
    }

    /// A change of the settled wall's stress as the whole wall's, for a number below 2^46.
    pub const fn stiffened(&self, change: i64) -> i64 {
        let stiffness = Factor {
            mantissa: self.stiffness,
            shift: 0,
        };
        stiffness.of(change << Self::STIFFNESS_BITS)
    }

    /// What is left of the terms' stress after a step, and its sum.
    // Once in the image.
    #[inline(never)]
    pub fn decay(&self, held: &mut [i64]) -> i64 {
        let mut sum = 0;
        for (state, term) in held.iter_mut().zip(self.terms()) {
            *state -= term.lost.of(*state);
            sum += *state;
        }
        sum
    }

    /// The terms take their shares of a change of stress.
    #[inline(never)]
    pub fn take(&self, held: &mut [i64], change: i64) {
        for (state, term) in held.iter_mut().zip(self.terms()) {
            *state += term.share.of(change);
        }
    }

    /// Its terms.
    pub fn terms(&self) -> &[TermStep] {
        self.terms.get(..self.count).unwrap_or(&self.terms)
    }
}

/// Temperature difference between a wall and its series if it is not measured: one standard deviation, kelvin.
pub const WALL_TEMPERATURE: f64 = 2.0;

/// In so many seconds of a new contact a wall forgets where it was left, to 1/e: solids of four domes that are tapped, pressed again as fast, faster
/// and slower, and held.
pub const LEFT_TIME: f64 = 2.0;

/// A wall in time, as the chip knows it.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct WallSeries {
    /// Its series over the time from one report to the next, at its own temperature.
    pub step: SeriesStep,
    /// Force that the wall may still bear where none is read, permille of the peak before.
    pub remaining_permille: u32,
    /// Share of the contact's force that the fluid bears at no pressure, in 1/65536: to 65536. See [`WallSeries::fluid_half`].
    pub fluid_least: u32,
    /// Settled pressure rise at which the fluid bears half of the rest too, and the wall the other half, counts of the tables' pressure: 1 to
    /// `i32::MAX`. Without a least share it is where each bears half.
    pub fluid_half: u32,
    /// `kappa` of the weight `1 / (1 + kappa P / (P_2 + P))` with which stress is remembered over the settled pressure, in 1/65536: to
    /// [`WallSeries::LARGEST_GAIN`].
    pub weight_gain: u32,
    /// `P_2` of it, counts of the tables' pressure: 1 to `i32::MAX`.
    pub weight_half: u32,
    /// What the force of a wall that is touched again before it has recovered is less by, over `P_l / P_e`, `P_l` being the settled pressure where
    /// it last bore nothing, in 1/65536: to 65536.
    pub retouch: u32,
    /// What [`WALL_TEMPERATURE`] moves the settled pressure by, over `P_e (1 - P_e / P)`, in 1/65536: below 65536, 0 of a wall that is the same at
    /// every temperature.
    pub temperature_gain: u32,
}

impl WallSeries {
    /// Largest gain of the weight: below seven, with which the chip's steps do not swing.
    pub const LARGEST_GAIN: u32 = (7 << 16) - 1;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::relaxation::AGILUS30_RELAXATION;

    #[test]
    fn a_product_is_rounded_down() {
        let x = 1_234_567_890_123_456_789_i64;
        for value in [1e-7, 0.25, 0.632, 1.0 - 1e-12, 1.0] {
            for x in [x, -x, i64::MAX, i64::MIN] {
                let (found, exact) = (Factor::nearest(value).of(x) as f64, x as f64 * value);
                // The mantissa is within 2^-32 of the value.
                assert!(
                    (found - exact).abs() <= exact.abs() * 3e-10 + 1.0,
                    "{value}: {found} for {exact}"
                );
            }
        }
        assert_eq!(Factor::nearest(0.0).of(i64::MAX), 0);
        assert_eq!(
            (Factor::nearest(0.25).of(6), Factor::nearest(0.25).of(-6)),
            (1, -2)
        );
    }

    /// Presses at random to 30 kPa of settled pressure, 8 h at 1 kHz: the recursion of [`SeriesStep::decay`] and [`SeriesStep::take`], in `2^-32` Pa, as
    /// the chip has it (its tests hold it to this one), beside the convolution in `f64`, which itself rounds to 1e-16 of 2^15 Pa 3e7 times.
    #[test]
    fn the_elastic_pressure_does_not_drift_in_eight_hours() {
        const PERIOD: f64 = 1e-3;
        const STEPS: u32 = 8 * 3_600_000;
        let series = AGILUS30_RELAXATION;
        let decays: Vec<_> = series.terms().iter().map(|term| term.over(PERIOD)).collect();
        let step = SeriesStep::over(&series, PERIOD);
        let (mut truth, mut stresses) = (0.0, [0.0; MAX_TERMS]);
        let (mut elastic, mut held) = (0_i64, [0_i64; MAX_TERMS]);
        let mut random = crate::random::Random(8);
        let (mut left, mut change, mut largest) = (0, 0.0, 0.0_f64);
        for _ in 0..STEPS {
            if left == 0 {
                // 0.3 to 10 s to somewhere, or a hold.
                left = 300 + (9_700.0 * random.unit()) as u32;
                let target = if random.unit() < 0.3 {
                    truth
                } else {
                    30e3 * random.unit()
                };
                change = (target - truth) / f64::from(left);
            }
            left -= 1;
            truth += change;
            let mut pressure = truth;
            for (stress, decay) in stresses.iter_mut().zip(&decays) {
                *stress = decay.left * *stress + decay.taken * change;
                pressure += *stress;
            }
            let stress = (4_294_967_296.0 * pressure) as i64 - elastic - step.decay(&mut held);
            step.take(&mut held, stress);
            elastic += step.settled.of(stress);
            largest = largest.max((elastic as f64 / 4_294_967_296.0 - truth).abs());
        }
        println!("largest error of the elastic pressure in 8 h at 1 kHz: {largest:.2e} Pa");
        assert!(largest < 0.01, "{largest} Pa");
    }

    /// Nothing of a change of stress is lost, and each term's share is of its stiffness.
    #[test]
    fn shares_are_of_the_whole() {
        let step = SeriesStep::over(&AGILUS30_RELAXATION, 1e-3);
        let change = 1_i64 << 60;
        let shares = step.terms().iter().map(|term| term.share.of(change)).sum::<i64>();
        let whole = shares + step.settled.of(change);
        assert!(step.is_passive());
        assert!((whole - change).abs() < change >> 29, "{whole}");
        let unit = (step.settled.of(change) as f64 * f64::from(step.stiffness)) / 65_536.0;
        assert!((unit / change as f64 - 1.0).abs() < 1e-4, "{unit}");
    }
}
