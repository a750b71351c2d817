//! Pressure rise -> elastic pressure -> force and indentation, where the wall relaxes.
//!
//! A wall that relaxes as `g(t) = 1 + sum g_i exp(-t / tau_i)` answers an indentation with `P = g * P_e`, the convolution of its series with the
//! changes of the pressure `P_e` that the settled wall has at that indentation. Each step of time inverts it exactly:
//!
//! `q_i -= k_i q_i; d = P - P_e - sum q_i; P_e += d / (1 + sum c); q_i += d c_i / (1 + sum c)`
//!
//! with `k_i = 1 - exp(-dt / tau_i)` and `c_i = g_i tau_i / dt k_i`. Afterwards `P = P_e + sum q_i` again, so that nothing drifts. The tables
//! lead from `P_e` to the indentation and to the settled force `F_e`.
//!
//! The contact's force is borne by the fluid, whose pressure acts on the area of contact at once, and by the wall, which remembers. Of the
//! settled force the fluid bears the share `phi = P_e / (P_1 + P_e)`; `P_1` belongs to the design. So
//!
//! `F = phi A P + (1 - phi) g * F_e` with `A = F_e / P_e`.
//!
//! A plate cannot pull: there is no force below zero.
//!
//! All states are 64-bit integers. A change of pressure, of at most 2^57, is shared, and nothing that the terms hold grows beyond it.

use crate::signal::design::Design;
use crate::signal::report::Contact;
use crate::status::Warnings;
use model_tables::material::series::{Factor, SeriesStep, WallSeries};
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Pressures are counted in `1 / 2^32` pascal here: the term of 10 000 s still moves by less than 0.01 Pa at 1 kHz.
pub const FRACTION_BITS: u32 = 32;
/// Largest pressure, pascals either way: of the states' word a hundredth, as terms may add.
const LARGEST: i64 = 1 << 24;
const LARGEST_STATE: i64 = LARGEST << FRACTION_BITS;
/// Part of the tables' range, `1 / 2^8`, below which the area counts as constant.
const AREA_SHIFT: u32 = 8;
/// Bits of forces below a micronewton, and of the place between two counts.
const FORCE_BITS: u32 = 16;
/// One as a share.
const WHOLE: u32 = 1 << 16;
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
    /// `F_e`, and to it what `q_i` is to `P_e`.
    settled: i64,
    forces: [i64; TERMS],
    /// The largest force, forgotten with the slowest term.
    peak_force: i64,
}

/// What the tables have at an elastic pressure, between two counts.
struct Lookup {
    elastic: PressureRise,
    /// With [`FORCE_BITS`].
    force: i64,
    indentation: i32,
    saturated: bool,
}

impl Lookup {
    #[inline(never)]
    fn at(design: &impl Design, elastic: i64) -> Self {
        let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
        let part = (elastic >> (below_count - FORCE_BITS)) & i64::from(WHOLE - 1);
        // The states' words have room for a hundred times a largest pressure of 2^24 Pa, which has 41 bits here.
        let counts = (elastic >> below_count).clamp(i64::from(-i32::MAX), i64::from(i32::MAX - 1)) as i32;
        let [below, above] = [counts, counts + 1].map(|count| design.lookup(PressureRise(count)));
        // Outputs are below 2^31.
        let between =
            |below: i32, above: i32| (i64::from(below) << FORCE_BITS) + i64::from(above - below) * part;
        Self {
            elastic: PressureRise(counts),
            force: between(below.force.0, above.force.0),
            indentation: (between(below.indentation.0, above.indentation.0) >> FORCE_BITS) as i32,
            saturated: below.saturated,
        }
    }
}

impl<const TERMS: usize> Relaxing<TERMS> {
    /// At untouched rest for ever.
    pub const NEW: Self = Self {
        elastic: 0,
        held: [0; TERMS],
        settled: 0,
        forces: [0; TERMS],
        peak_force: 0,
    };

    /// It has been at a pressure for ever.
    pub fn settle(&mut self, design: &impl Design, rise: PressureRise) {
        *self = Self::NEW;
        self.elastic = pressure(design, rise);
        self.settled = Lookup::at(design, self.elastic).force;
    }

    /// Goes on by a step of time to a pressure rise.
    pub fn step(&mut self, design: &impl Design, wall: &WallSeries, rise: PressureRise) -> RelaxedReading {
        let step = &wall.step;
        let parameters = design.parameters();
        let pressure = pressure(design, rise);
        let stress = pressure - self.elastic - decay(step, &mut self.held);
        take(step, &mut self.held, stress);
        self.elastic += step.settled.of(stress);
        let at = Lookup::at(design, self.elastic);
        let convolved = self.convolved(step, at.force);
        let pressed_before = at.elastic.0 > parameters.limits.margin;
        let by_fluid = by_area(design, self.elastic, &at, rise);
        let half = wall.fluid_half.min(i32::MAX.unsigned_abs()) as i32;
        let by_wall = share(part(half, half.saturating_add(at.elastic.0.max(0))));
        let force = by_fluid + by_wall.of(convolved - by_fluid);
        let force = (force >> FORCE_BITS).clamp(0, i64::from(i32::MAX)) as i32;
        if let Some(slowest) = step.terms().last() {
            self.peak_force -= slowest.lost.of(self.peak_force);
        }
        self.peak_force = self.peak_force.max(i64::from(force) << FORCE_BITS);

        let recovering = pressed_before && force == 0 && rise.0 < 0;
        let below = !pressed_before && rise < parameters.lowest_rest;
        RelaxedReading {
            elastic: at.elastic,
            settled: Micronewtons((at.force >> FORCE_BITS) as i32),
            lowered: pressed_before && rise.0 < at.elastic.0.saturating_sub(parameters.limits.margin),
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

    /// `g * F_e` where the settled force becomes another one. A force has 44 bits, and 60 stiffened.
    fn convolved(&mut self, step: &SeriesStep, settled: i64) -> i64 {
        let change = settled - core::mem::replace(&mut self.settled, settled);
        let left = decay(step, &mut self.forces);
        let stress = step.stiffened(change);
        take(step, &mut self.forces, stress);
        // The terms took all but the settled wall's share.
        settled + left + stress - change
    }

    /// The largest force so far, forgotten with the slowest term.
    pub fn peak_force(&self) -> Micronewtons {
        Micronewtons((self.peak_force >> FORCE_BITS) as i32)
    }

    /// The zero moved, and with it every pressure: by so many counts.
    pub fn shift(&mut self, design: &impl Design, by: PressureRise) {
        self.elastic = (self.elastic + pressure(design, by)).clamp(-LARGEST_STATE, LARGEST_STATE);
    }
}

/// `A P` with the area `A = F_e / P_e`, with [`FORCE_BITS`].
fn by_area(design: &impl Design, elastic: i64, at: &Lookup, rise: PressureRise) -> i64 {
    let parameters = design.parameters();
    let below_count = FRACTION_BITS - parameters.pressure_fraction_bits;
    let last = i64::from(design.last_rise().0) << below_count;
    let place = elastic.clamp(last >> AREA_SHIFT, last);
    let force = if place == elastic {
        at.force
    } else {
        Lookup::at(design, place).force
    };
    // `force / place` to 2^-15 of itself: 32 bits over 16, each shifted to the top of its word.
    let (force, place) = (force.max(1) as u64, place.max(1) as u64);
    let (up, down) = (force.leading_zeros(), place.leading_zeros());
    let ratio = ((force << up) >> 32) as u32 / ((place << down) >> 48) as u32;
    // 16 or 17 bits. From a pressure with 32 bits below a pascal to a force with 16 below a micronewton: an area is below 32 768 mm2.
    let area = Factor {
        mantissa: ratio << 15,
        shift: up.saturating_sub(down + 1).min(Factor::MAX_SHIFT),
    };
    area.of(pressure(design, rise))
}

/// What is left of the terms after a step, and their sum.
#[inline(never)]
fn decay(step: &SeriesStep, terms: &mut [i64]) -> i64 {
    let mut sum = 0;
    for (state, term) in terms.iter_mut().zip(step.terms()) {
        *state -= term.lost.of(*state);
        sum += *state;
    }
    sum
}

/// The terms take their shares of a change.
#[inline(never)]
fn take(step: &SeriesStep, terms: &mut [i64], change: i64) {
    for (state, term) in terms.iter_mut().zip(step.terms()) {
        *state += term.share.of(change);
    }
}

/// A part of a whole, as a share: at least nothing and at most all of it.
fn part(of: i32, whole: i32) -> u32 {
    let (of, whole) = (of.max(0) as u32, whole.max(1) as u32);
    if of >= whole {
        return WHOLE;
    }
    // As many of 16 bits as the word has room for come before the division.
    let up = whole.leading_zeros().min(16);
    ((of << up) / (whole >> (16 - up))).min(WHOLE)
}

/// A share as a factor; one is the largest there is.
fn share(share: u32) -> Factor {
    Factor {
        mantissa: (share << 15).saturating_mul(2),
        shift: 0,
    }
}

/// A pressure as the wall's memory counts it.
fn pressure(design: &impl Design, rise: PressureRise) -> i64 {
    let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
    (i64::from(rise.0) << below_count).clamp(-LARGEST_STATE, LARGEST_STATE)
}

#[cfg(test)]
mod tests;
