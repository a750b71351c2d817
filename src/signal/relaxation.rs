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
//! Pressed and held, `F = w (y + sum r_i)` with `w = sqrt(A)`, `y = w P_e` and `r_i` to `y` what `q_i` is to `P_e` is nearest to finite
//! elements; released and pressed again, `A P = w (w P)`. The one goes over into the other as `P_e` falls from its peak.
//!
//! All states are 64-bit integers and saturate.

use crate::signal::contact::Contact;
use crate::signal::design::Design;
use crate::status::Warnings;
use model_tables::material::series::{Factor, SeriesStep};
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Pressures are counted in `1 / 2^32` pascal here: the term of 10 000 s still moves by less than 0.01 Pa at 1 kHz.
pub const FRACTION_BITS: u32 = 32;
/// Largest pressure, pascals either way: of the states' word a hundredth, as terms may add.
const LARGEST: i64 = 1 << 24;
/// Part of the tables' range, `1 / 2^8`, below which the area counts as constant.
const AREA_SHIFT: u32 = 8;
/// The fall of `P_e` from its peak, `1 / 2^5` of it, over which the force goes over to `A P`.
const FALL_SHIFT: u32 = 5;
/// Bits of `y` below the square root of a micronewton times a pascal.
const ROOT_BITS: u32 = 24;
/// Bits between two counts that are looked up, and of a force below a micronewton.
const BETWEEN_BITS: u32 = 16;

/// What a relaxing wall's pressure says.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct RelaxedReading {
    /// The settled wall's pressure rise at the same indentation, rounded down.
    pub elastic: PressureRise,
    /// Its force.
    pub settled: Micronewtons,
    /// The wall's memory of a deeper press lowers the pressure by more than a quiet window leaves open: it says nothing of the zero.
    pub lowered: bool,
    /// Force, and indentation, which is an upper bound while recovering.
    pub contact: Contact,
}

/// A wall's memory, from untouched rest on.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Relaxing<const TERMS: usize> {
    /// `P_e`.
    elastic: i64,
    /// `q_i`.
    held: [i64; TERMS],
    /// `y` and `r_i`.
    root: i64,
    roots: [i64; TERMS],
    /// The largest `P_e`, and the largest force with [`ROOT_BITS`] below one; forgotten with the slowest term.
    peak: i64,
    peak_force: i64,
}

/// What the tables have at an elastic pressure, between two counts.
struct Lookup {
    elastic: PressureRise,
    /// With [`BETWEEN_BITS`] below a micronewton.
    force: i64,
    indentation: i32,
    saturated: bool,
}

impl Lookup {
    fn at(design: &impl Design, elastic: i64) -> Self {
        let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
        let word = |counts: i64| PressureRise(counts.clamp(i64::from(-i32::MAX), i64::from(i32::MAX)) as i32);
        let counts = elastic >> below_count;
        let (below, above) = (design.lookup(word(counts)), design.lookup(word(counts + 1)));
        let part = (elastic >> (below_count - BETWEEN_BITS)) & ((1 << BETWEEN_BITS) - 1);
        // Outputs are below 2^31.
        let between = |below: i32, above: i32| {
            (i64::from(below) << BETWEEN_BITS) + (i64::from(above) - i64::from(below)) * part
        };
        Self {
            elastic: word(counts),
            force: between(below.force.0, above.force.0),
            indentation: (between(below.indentation.0, above.indentation.0) >> BETWEEN_BITS) as i32,
            saturated: below.saturated,
        }
    }
}

impl<const TERMS: usize> Relaxing<TERMS> {
    /// At untouched rest for ever.
    pub const NEW: Self = Self {
        elastic: 0,
        held: [0; TERMS],
        root: 0,
        roots: [0; TERMS],
        peak: 0,
        peak_force: 0,
    };

    /// A wall that has been at a pressure for ever.
    pub fn settled(design: &impl Design, rise: PressureRise) -> Self {
        let elastic = pressure(design, rise);
        let (_, _, root) = Self::area(design, elastic, &Lookup::at(design, elastic));
        Self {
            elastic,
            root,
            peak: elastic.max(0),
            ..Self::NEW
        }
    }

    /// Goes on by a step of time to a pressure rise.
    pub fn step(&mut self, design: &impl Design, step: &SeriesStep, rise: PressureRise) -> RelaxedReading {
        let pressure = pressure(design, rise);
        self.invert(step, pressure);
        let at = Lookup::at(design, self.elastic);
        let (to_root, to_force, root) = Self::area(design, self.elastic, &at);
        let change = root.saturating_sub(self.root);
        self.root = root;
        let mut sum = root;
        for (state, term) in self.roots.iter_mut().zip(step.terms()) {
            *state = state
                .saturating_sub(term.lost.of(*state))
                .saturating_add(term.taken.of(change));
            sum = sum.saturating_add(*state);
        }
        let sum = self.between(step, sum, to_root.of(pressure));
        let force = to_force.of(sum).clamp(0, i64::from(i32::MAX)) as i32;
        self.remember(step, force);
        let parameters = design.parameters();
        let level = parameters.limits.level;
        let pressed_before = at.elastic.0 > level;
        let recovering = pressed_before && force == 0 && rise.0 < 0;
        let below = !pressed_before && rise < parameters.lowest_rest;
        RelaxedReading {
            elastic: at.elastic,
            lowered: pressed_before && rise.0 < at.elastic.0.saturating_sub(level),
            settled: Micronewtons((at.force >> BETWEEN_BITS) as i32),
            contact: Contact {
                force: Micronewtons(force),
                indentation: Nanometres(at.indentation),
                warnings: Warnings::SATURATED
                    .when(at.saturated)
                    .and(Warnings::RECOVERING.when(recovering))
                    .and(Warnings::BELOW_ZERO.when(below)),
            },
        }
    }

    /// The elastic pressure at a pressure.
    fn invert(&mut self, step: &SeriesStep, pressure: i64) {
        let mut rest = pressure.saturating_sub(self.elastic);
        for (state, term) in self.held.iter_mut().zip(step.terms()) {
            *state = state.saturating_sub(term.lost.of(*state));
            rest = rest.saturating_sub(*state);
        }
        let change = step.inverse.of(rest);
        self.elastic = self.elastic.saturating_add(change);
        for (state, term) in self.held.iter_mut().zip(step.terms()) {
            *state = state.saturating_add(term.taken.of(change));
        }
    }

    /// The square root `w` of the area at an elastic pressure, micronewtons over a pascal: as a factor from a pressure to `w P`, as one from there
    /// to a force, and `y`.
    fn area(design: &impl Design, elastic: i64, at: &Lookup) -> (Factor, Factor, i64) {
        let parameters = design.parameters();
        let below_count = FRACTION_BITS - parameters.pressure_fraction_bits;
        let last = i64::from(parameters.last_rise.0) << below_count;
        let first = (last >> AREA_SHIFT).max(1);
        let place = elastic.clamp(first, last);
        let force = if place == elastic {
            at.force
        } else {
            Lookup::at(design, place).force
        };
        // `A = force / place 2^16`, each shifted to the top of its word: the ratio has 32 or 33 bits.
        let (force, place) = (force.max(1) as u64, place as u64);
        let (up, down) = (force.leading_zeros(), place.leading_zeros());
        let ratio = (force << up) / ((place << down) >> 32);
        let exponent = down as i32 - up as i32 - 16;
        // An even exponent is left, so that its half is whole.
        let room = 30 + (exponent & 1);
        let root = (ratio << room).isqrt();
        // 10 to 51, as a force has 1 to 44 bits and a place 17 to 56.
        let shift = ((room - exponent) / 2) as u32;
        let mantissa = root as u32;
        let to_root = Factor {
            mantissa,
            shift: shift + FRACTION_BITS - ROOT_BITS,
        };
        let to_force = Factor {
            mantissa,
            shift: shift + ROOT_BITS,
        };
        (to_root, to_force, to_root.of(elastic.clamp(0, last)))
    }

    /// From the convolved root to that by the area as the elastic pressure falls from its peak.
    fn between(&mut self, step: &SeriesStep, convolved: i64, by_area: i64) -> i64 {
        if let Some(slowest) = step.terms().last() {
            self.peak = self.peak.saturating_sub(slowest.lost.of(self.peak));
        }
        self.peak = self.peak.max(self.elastic);
        let whole = (self.peak >> FALL_SHIFT).max(1);
        let fall = self.peak.saturating_sub(self.elastic);
        if fall >= whole {
            return by_area;
        }
        // To 16 bits.
        let excess = (64 - whole.leading_zeros()).saturating_sub(16);
        let part = ((fall >> excess) << 16) as u32 / (whole >> excess) as u32;
        let part = Factor {
            mantissa: part << 16,
            shift: 32,
        };
        convolved.saturating_add(part.of(by_area.saturating_sub(convolved)))
    }

    /// The largest force.
    fn remember(&mut self, step: &SeriesStep, force: i32) {
        if let Some(slowest) = step.terms().last() {
            self.peak_force -= slowest.lost.of(self.peak_force);
        }
        self.peak_force = self.peak_force.max(i64::from(force) << ROOT_BITS);
    }

    /// The largest force so far, forgotten with the slowest term.
    pub fn peak_force(&self) -> Micronewtons {
        Micronewtons((self.peak_force >> ROOT_BITS) as i32)
    }

    /// The zero moved, and with it every pressure: by so many counts.
    pub fn shift(&mut self, design: &impl Design, by: PressureRise) {
        self.elastic = self.elastic.saturating_add(pressure(design, by));
    }
}

/// A pressure as the wall's memory counts it.
fn pressure(design: &impl Design, rise: PressureRise) -> i64 {
    let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
    let largest = LARGEST << FRACTION_BITS;
    (i64::from(rise.0) << below_count).clamp(-largest, largest)
}

#[cfg(test)]
mod tests;
