//! Pressure rise -> elastic pressure -> force and indentation, where the wall relaxes.
//!
//! A wall that relaxes as `g(t) = 1 + sum g_i exp(-t / tau_i)` answers an indentation with `P = g * P_e`, the convolution of its series with the
//! changes of the pressure `P_e` that the settled wall has at that indentation. Each step of time inverts it exactly:
//!
//! `q_i -= k_i q_i; d = (P - P_e - sum q_i) / (1 + sum c_i); P_e += d; q_i += c_i d`
//!
//! with `k_i = 1 - exp(-dt / tau_i)` and `c_i = g_i tau_i / dt k_i`. Afterwards `P = P_e + sum q_i` again, so that nothing drifts. The tables
//! lead from `P_e` to the indentation and to the settled force `F_e`.
//!
//! The contact's area goes with `P_e` and the stress with `P`, so the force is between a convolution of `F_e` and `A P` with `A = F_e / P_e`.
//! Pressed and held, `F = w (y + sum r_i)` with `y = F_e / w` and `w = sqrt(A)` is nearest to finite elements; released and pressed
//! again, `A P`. The one goes over into the other as `P_e` falls from its peak.
//!
//! All states are 64-bit integers and saturate.

use crate::signal::design::Design;
use crate::status::Warnings;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Pressures are counted in `1 / 2^32` pascal here: the term of 10 000 s still moves by less than 0.01 Pa at 1 kHz.
pub const FRACTION_BITS: u32 = 32;
/// Largest pressure, pascals either way: of the states' word a hundredth, as terms may add.
const LARGEST: i64 = 1 << 24;
/// Part of the tables' range, `1 / 2^8`, below which the area counts as constant.
const AREA_SHIFT: u32 = 8;
/// The fall of `P_e` from its peak, `1 / 2^5` of it, over which the force goes over to `A P`.
const FALL_SHIFT: u32 = 5;
/// Bits of `y` below the square root of a micronewton times a count.
const ROOT_BITS: u32 = 24;

/// A factor >= 0: `mantissa / 2^shift`.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Factor {
    /// 32 bits.
    pub mantissa: u32,
    /// 0 to 95.
    pub shift: u32,
}

impl Factor {
    /// The nearest product; saturates.
    fn of(self, x: i64) -> i64 {
        // Below 2^63 * 2^32 = 2^95.
        let product = i128::from(x) * i128::from(self.mantissa);
        let half = (1_i128 << self.shift) >> 1;
        let rounded = (product + half) >> self.shift;
        rounded.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64
    }
}

/// What a term does in a step of time.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct TermStep {
    /// `k`: what is lost of it.
    pub lost: Factor,
    /// `c`: what it takes of a change.
    pub taken: Factor,
}

/// A series over a step of time.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct SeriesStep<const TERMS: usize> {
    /// Its terms, the slowest last.
    pub terms: [TermStep; TERMS],
    /// `1 / (1 + sum c_i)`.
    pub inverse: Factor,
}

/// What a relaxing wall's pressure says.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct RelaxedReading {
    /// The settled wall's pressure rise at the same indentation.
    pub elastic: PressureRise,
    /// Force on the fingertip.
    pub force: Micronewtons,
    /// Indentation of its pole; an upper bound while recovering.
    pub indentation: Nanometres,
    /// What qualifies both.
    pub warnings: Warnings,
}

/// A wall's memory, from untouched rest on.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Relaxing<const TERMS: usize> {
    elastic: i64,
    /// `q_i`.
    held: [i64; TERMS],
    /// `y` and `r_i`.
    root: i64,
    roots: [i64; TERMS],
    /// The largest `P_e`, forgotten with the slowest term.
    peak: i64,
}

impl<const TERMS: usize> Default for Relaxing<TERMS> {
    fn default() -> Self {
        Self {
            elastic: 0,
            held: [0; TERMS],
            root: 0,
            roots: [0; TERMS],
            peak: 0,
        }
    }
}

impl<const TERMS: usize> Relaxing<TERMS> {
    /// Goes on by a step of time to a pressure rise.
    pub fn step(
        &mut self,
        design: &impl Design,
        step: &SeriesStep<TERMS>,
        rise: PressureRise,
    ) -> RelaxedReading {
        let bits = design.parameters().pressure_fraction_bits;
        let largest = LARGEST << FRACTION_BITS;
        let pressure = (i64::from(rise.0) << (FRACTION_BITS - bits)).clamp(-largest, largest);
        self.invert(step, pressure);
        let counts = self.elastic >> (FRACTION_BITS - bits);
        let elastic = PressureRise(counts.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32);
        let reading = design.lookup(elastic);

        let last = design.parameters().last_rise.0;
        // Force, and the square root of force times pressure, where the area is taken.
        let place = elastic.0.clamp((last >> AREA_SHIFT).max(1), last);
        let of_area = design.lookup(PressureRise(place)).force.0;
        let root = root(reading.force.0, elastic.0.clamp(0, last));
        let change = root.saturating_sub(self.root);
        self.root = root;
        let mut sum = root;
        for (state, term) in self.roots.iter_mut().zip(&step.terms) {
            *state = state
                .saturating_sub(term.lost.of(*state))
                .saturating_add(term.taken.of(change));
            sum = sum.saturating_add(*state);
        }
        let convolved = scaled(of_area, sum, self::root(of_area, place));
        let by_area = scaled(of_area, i64::from(rise.0), i64::from(place));
        let force = self
            .between(step, convolved, by_area)
            .clamp(0, i64::from(i32::MAX)) as i32;
        let recovering = force == 0 && rise.0 < 0;
        RelaxedReading {
            elastic,
            force: Micronewtons(force),
            indentation: reading.indentation,
            warnings: Warnings::SATURATED
                .when(reading.saturated)
                .and(Warnings::RECOVERING.when(recovering)),
        }
    }

    /// The elastic pressure at a pressure.
    fn invert(&mut self, step: &SeriesStep<TERMS>, pressure: i64) {
        let mut rest = pressure.saturating_sub(self.elastic);
        for (state, term) in self.held.iter_mut().zip(&step.terms) {
            *state = state.saturating_sub(term.lost.of(*state));
            rest = rest.saturating_sub(*state);
        }
        let change = step.inverse.of(rest);
        self.elastic = self.elastic.saturating_add(change);
        for (state, term) in self.held.iter_mut().zip(&step.terms) {
            *state = state.saturating_add(term.taken.of(change));
        }
    }

    /// From the convolved force to that by the area as the elastic pressure falls from its peak.
    fn between(&mut self, step: &SeriesStep<TERMS>, convolved: i64, by_area: i64) -> i64 {
        if let Some(slowest) = step.terms.last() {
            self.peak = self.peak.saturating_sub(slowest.lost.of(self.peak));
        }
        self.peak = self.peak.max(self.elastic);
        let whole = (self.peak >> FALL_SHIFT).max(1);
        let fall = self.peak.saturating_sub(self.elastic).min(whole);
        let part = i128::from(by_area.saturating_sub(convolved)) * i128::from(fall) / i128::from(whole);
        convolved.saturating_add(part as i64)
    }
}

/// `sqrt(force * pressure)`, with [`ROOT_BITS`] below one; both >= 0.
fn root(force: i32, pressure: i32) -> i64 {
    // Below 2^62.
    let product = u64::from(force.max(0).unsigned_abs()) * u64::from(pressure.max(0).unsigned_abs());
    if product == 0 {
        return 0;
    }
    // All bits of the word give a root of 32.
    let shift = product.leading_zeros() & !1;
    let root = (product << shift).isqrt();
    ((root << ROOT_BITS) >> (shift / 2)) as i64
}

/// `force * part / whole`, of a whole > 0; saturates.
fn scaled(force: i32, part: i64, whole: i64) -> i64 {
    let quotient = i128::from(force) * i128::from(part) / i128::from(whole.max(1));
    quotient.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64
}

#[cfg(test)]
mod tests;
