//! Pressure rise -> elastic pressure -> force and indentation, where the wall relaxes.
//!
//! A wall relaxes as `g(t) = 1 + sum g_i exp(-t / tau_i)`. Its pressure at an indentation is `P = w g * (P_e / w)`: the convolution
//! of its series with the changes of `P_e`, the pressure of the settled wall at that indentation. The weight `w = 1 / (1 + kappa
//! P_e / (P_2 + P_e))` falls as the contact grows, because stress from a smaller contact has little effect on the present one. Each
//! time step inverts the convolution exactly, with `v = P_e / w`:
//!
//! `q_i -= k_i q_i; d = P / w - v - sum q_i; v += d / (1 + sum c); q_i += d c_i / (1 + sum c)`
//!
//! with `k_i = 1 - exp(-dt / tau_i)` and `c_i = g_i tau_i / dt k_i`. Afterwards `P / w = v + sum q_i` holds again, so there is no
//! drift. The weight is that of the `P_e` extrapolated half a step from the two previous steps; from there, one step of Newton's
//! method gives the `P_e` of `v`. An error of the extrapolation changes the next one by at most `P_e / w` times the weight's slope,
//! 0.48 of it, so errors do not grow. The tables give the indentation and the settled force `F_e` at `P_e`.
//!
//! Two parts carry the contact force: the fluid, whose pressure acts on the contact area at once, and the wall, which has a memory.
//! The fluid carries the share `phi = phi_0 + (1 - phi_0) P_e / (P_1 + P_e)` of the settled force. Therefore
//!
//! `F = phi A P + (1 - phi) g * F_e` with `A = F_e / P_e`.
//!
//! A wall that is touched again before it has recovered is still indented. The new contact begins with no area, at the settled
//! pressure `P_l` where the force was last 0. After that, the force `F` is smaller by `rho (F + 4 A P_0) P_l / P_e`, with `P_0`
//! the pressure below rest at that time: the new contact carries at once the force with which the fluid pulled. The contact
//! grows beyond the old one, and the effect decays within seconds. `P_l` is at most `-4 P_0`: a wall that pulls little has
//! recovered, even if its series, at another temperature, gives more.
//!
//! A free wall recovers faster than the tables of a pressed one say: while the pressure is below rest, its pole rises by about three
//! sixteenths more than the settled indentation falls. The indentation is smaller by this rebound `b`, by at most a quarter of it.
//! A new contact forgets `b` within seconds, as it forgets `P_l`, and faster as it grows: by eight times the relative growth of
//! the indentation. A wall that hardly relaxes follows its tables: a fall counts by the factor `1 - 1 / (1 + sum c)`.
//!
//! `kappa`, `P_2`, `phi_0`, `P_1` and `rho` belong to the design: its tables' generator fits them to a press of the solid in time.
//!
//! A plate cannot pull: there is no force below zero.
//!
//! All states are integers; those of the memory have 64 bits. A change of pressure is at most 2^57. It is divided among the
//! terms, so no term exceeds it.

use crate::signal::design::Design;
use crate::signal::report::Contact;
use crate::status::Warnings;
use model_tables::material::series::{Factor, SeriesStep, WallSeries};
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Fraction bits of a pressure here: its unit is `1 / 2^32` pascal. In one step of 1 kHz, the term of 10 000 s moves by less than 0.01 Pa.
pub const FRACTION_BITS: u32 = 32;
/// Largest pressure, pascals either way: one five-hundredth of the range of a state. The weights divide by up to eight, and the terms may add up.
const LARGEST: i64 = 1 << 22;
const LARGEST_STATE: i64 = LARGEST << FRACTION_BITS;
/// The area counts as constant below `1 / 2^8` of the tables' range.
const AREA_SHIFT: u32 = 8;
/// Fraction bits of forces in micronewtons, and of the position between two counts.
const FORCE_BITS: u32 = 16;
/// The value 1 as a share.
pub const WHOLE: u32 = 1 << 16;
/// The loss of force on a wall that is touched again starts at `2^PULL_SHIFT` times the pull of the fluid before.
const PULL_SHIFT: u32 = 2;
/// Sixteenths of the fall of the settled indentation by which the pole of a free wall rises in addition.
const REBOUND: i64 = 3;
const REBOUND_SHIFT: u32 = 4;
/// The rebound is at most `1 / 2^2` of the indentation.
const MAX_REBOUND_SHIFT: u32 = 2;
/// The relative growth of the indentation reduces the rebound by this multiple of itself.
const GROWTHS: i32 = 8;
/// Fraction bits of the rebound in nanometres: it has 31 bits up to 134 mm.
const REBOUND_BITS: u32 = 6;

/// A reading from the pressure of a relaxing wall.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct RelaxedReading {
    /// The settled wall's pressure rise at the same indentation, rounded down.
    pub elastic: PressureRise,
    /// Force of the settled wall.
    pub settled: Micronewtons,
    /// Whether the wall's memory of a deeper press lowers the pressure by more than the margin of a quiet window. If so, the
    /// pressure is no evidence for the zero.
    pub lowered: bool,
    /// Force and indentation. While the wall recovers, the indentation is an upper bound.
    pub contact: Contact,
}

/// A wall's memory since untouched rest.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Relaxing<const TERMS: usize> {
    /// `P_e`, and that of the step before.
    elastic: i64,
    before: i64,
    /// `v`.
    weighted: i64,
    /// `q_i`.
    held: [i64; TERMS],
    /// `F_e`; `forces` holds its terms, as `held` holds those of `P_e`.
    settled: i64,
    forces: [i64; TERMS],
    /// The largest force. It decays with the slowest term.
    peak_force: i64,
    /// `P_l`, counts. It decays during a new contact.
    left: i32,
    /// `2^PULL_SHIFT A P` at `P_l`.
    pull: i64,
    /// The settled indentation of the previous step, nanometres.
    indentation: i32,
    /// The rebound `b`, nanometres with [`REBOUND_BITS`].
    rebound: i32,
}

/// Table values at an elastic pressure, interpolated between two counts.
struct Lookup {
    elastic: PressureRise,
    /// In micronewtons with [`FORCE_BITS`] fraction bits.
    force: i64,
    indentation: i32,
    saturated: bool,
}

impl Lookup {
    #[inline(never)]
    fn at(design: &impl Design, elastic: i64) -> Self {
        let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
        let part = (elastic >> (below_count - FORCE_BITS)) & i64::from(WHOLE - 1);
        // A state can hold five hundred times the largest pressure of 2^22 Pa. In counts, that pressure has 38 bits.
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
    /// A wall that has always been at untouched rest.
    pub const NEW: Self = Self {
        elastic: 0,
        before: 0,
        weighted: 0,
        held: [0; TERMS],
        settled: 0,
        forces: [0; TERMS],
        peak_force: 0,
        left: 0,
        pull: 0,
        indentation: 0,
        rebound: 0,
    };

    /// Sets the state of a wall that has always been at this pressure.
    pub fn settle(&mut self, design: &impl Design, wall: &WallSeries, rise: PressureRise) {
        *self = Self::NEW;
        self.elastic = pressure(design, rise);
        self.before = self.elastic;
        self.weighted = Weight::at(design, wall, self.elastic).over(self.elastic);
        self.settled = Lookup::at(design, self.elastic).force;
    }

    /// Advances by one time step to a pressure rise.
    pub fn step(&mut self, design: &impl Design, wall: &WallSeries, rise: PressureRise) -> RelaxedReading {
        let step = &wall.step;
        let parameters = design.parameters();
        let pressure = pressure(design, rise);
        let expected = self.elastic + ((self.elastic - self.before) >> 1);
        let weight = Weight::at(design, wall, expected);
        let stress = weight.over(pressure) - self.weighted - step.decay(&mut self.held);
        step.take(&mut self.held, stress);
        self.weighted += scaled(step.settled, stress);
        self.before = self.elastic;
        let off = self.weighted - weight.over(expected);
        self.elastic = expected + off - scaled(weight.flatter(), off);
        let at = Lookup::at(design, self.elastic);
        let convolved = self.convolved(step, at.force);
        let pressed_before = at.elastic.0 > parameters.limits.margin;
        let by_fluid = by_area(design, self.elastic, &at, rise);
        let half = wall.fluid_half.min(i32::MAX.unsigned_abs()) as i32;
        let by_wall = part(half, half.saturating_add(at.elastic.0.max(0)));
        let most = WHOLE - wall.fluid_least.min(WHOLE);
        let by_wall = share(((u64::from(by_wall) * u64::from(most)) >> 16) as u32);
        let force = by_fluid + scaled(by_wall, convolved - by_fluid);
        if let Some(slowest) = step.terms().last() {
            self.peak_force -= scaled(slowest.lost, self.peak_force);
        }
        self.left -= scaled(step.forgets, i64::from(self.left)) as i32;
        if force <= 0 {
            let twice = rise.0.saturating_add(rise.0);
            self.left = self.left.max(0_i32.saturating_sub(twice.saturating_add(twice)));
            self.pull = by_fluid << PULL_SHIFT;
        }
        self.left = self.left.min(at.elastic.0);
        let again = part(self.left, at.elastic.0);
        let less = share(((u64::from(again) * u64::from(wall.retouch.min(WHOLE))) >> 16) as u32);
        let force = if force > 0 {
            force - scaled(less, (force + self.pull).max(-force))
        } else {
            0
        };
        let force = (force >> FORCE_BITS).clamp(0, i64::from(i32::MAX)) as i32;
        self.peak_force = self.peak_force.max(i64::from(force) << FORCE_BITS);

        let recovering = pressed_before && force == 0 && rise.0 < 0;
        let below = !pressed_before && rise < parameters.lowest_rest;
        RelaxedReading {
            elastic: at.elastic,
            settled: Micronewtons((at.force >> FORCE_BITS) as i32),
            lowered: pressed_before && rise.0 < at.elastic.0.saturating_sub(parameters.limits.margin),
            contact: Contact {
                force: Micronewtons(force),
                indentation: Nanometres(self.rebounded(step, at.indentation, rise)),
                warnings: Warnings::SATURATED
                    .when(at.saturated)
                    .and(Warnings::RECOVERING.when(recovering))
                    .and(Warnings::BELOW_ZERO.when(below)),
            },
        }
    }

    /// `g * F_e` after the settled force changed to `settled`. A force has 44 bits, and a stiffened force 60.
    fn convolved(&mut self, step: &SeriesStep, settled: i64) -> i64 {
        let change = settled - core::mem::replace(&mut self.settled, settled);
        let left = step.decay(&mut self.forces);
        let stress = step.stiffened(change);
        step.take(&mut self.forces, stress);
        // The terms took everything except the share of the settled wall.
        settled + left + stress - change
    }

    /// The indentation without the rebound, for the next settled one. Both are from 0 to below 2^31 nm.
    fn rebounded(&mut self, step: &SeriesStep, indentation: i32, rise: PressureRise) -> i32 {
        let fallen = core::mem::replace(&mut self.indentation, indentation).saturating_sub(indentation);
        if rise.0 < 0 {
            let fallen = i64::from(fallen) * (REBOUND << (REBOUND_BITS - REBOUND_SHIFT));
            self.rebound = self
                .rebound
                .saturating_add((fallen - scaled(step.settled, fallen)) as i32);
        } else if self.rebound > 0 {
            let grown = share(part(fallen.saturating_mul(-GROWTHS), indentation));
            self.rebound -= scaled(step.forgets, i64::from(self.rebound)) as i32;
            self.rebound -= scaled(grown, i64::from(self.rebound)) as i32;
        }
        let most = indentation << (REBOUND_BITS - MAX_REBOUND_SHIFT);
        self.rebound = self.rebound.min(most).max(0);
        indentation - (self.rebound >> REBOUND_BITS)
    }

    /// The largest force so far. It decays with the slowest term.
    pub fn peak_force(&self) -> Micronewtons {
        Micronewtons((self.peak_force >> FORCE_BITS) as i32)
    }

    /// The zero moved: adds `by` counts to every pressure.
    pub fn shift(&mut self, design: &impl Design, wall: &WallSeries, by: PressureRise) {
        // The terms keep their values. `v` moves as much as `P / w`, and so does `P_e` in the next step.
        let by = Weight::at(design, wall, self.elastic).over(pressure(design, by));
        self.weighted = (self.weighted + by).clamp(-8 * LARGEST_STATE, 8 * LARGEST_STATE);
    }
}

/// The weight at an elastic pressure.
struct Weight {
    /// `1 / w`, from 1 to below 8, in units of `1 / 2^16`.
    inverse: u32,
    /// The slope of `v` over `P_e`, in the same unit.
    slope: u32,
}

impl Weight {
    #[inline(never)]
    fn at(design: &impl Design, wall: &WallSeries, elastic: i64) -> Self {
        let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
        let counts = (elastic >> below_count).clamp(0, i64::from(i32::MAX)) as i32;
        let half = wall.weight_half.min(i32::MAX.unsigned_abs()) as i32;
        let share = u64::from(part(counts, half.saturating_add(counts)));
        let gain = u64::from(wall.weight_gain.min(WallSeries::LARGEST_GAIN));
        let steep = (share * (u64::from(2 * WHOLE) - share)) >> 16;
        Self {
            inverse: WHOLE + ((gain * share) >> 16) as u32,
            slope: WHOLE + ((gain * steep) >> 16) as u32,
        }
    }

    /// A pressure divided by the weight.
    #[inline(never)]
    fn over(&self, pressure: i64) -> i64 {
        // A mantissa of 31 bits at most; a pressure is below 2^56.
        let eighth = Factor {
            mantissa: self.inverse << 12,
            shift: 0,
        };
        scaled(eighth, pressure << 4)
    }

    /// Share by which a change of `P_e` is smaller than the change of `v`.
    fn flatter(&self) -> Factor {
        share(part((self.slope - WHOLE) as i32, self.slope as i32))
    }
}

/// `A P` with the area `A = F_e / P_e`, in micronewtons with [`FORCE_BITS`] fraction bits.
fn by_area(design: &impl Design, elastic: i64, at: &Lookup, rise: PressureRise) -> i64 {
    let parameters = design.parameters();
    let below_count = FRACTION_BITS - parameters.pressure_fraction_bits;
    let last = i64::from(design.last_rise().0) << below_count;
    let place = elastic.max(last >> AREA_SHIFT).min(last);
    let force = if place == elastic {
        at.force
    } else {
        Lookup::at(design, place).force
    };
    // `force / place` to 2^-15 of itself: 32 bits divided by 16 bits, both shifted left as far as possible.
    let (force, place) = (force.max(1) as u64, place.max(1) as u64);
    let (up, down) = (force.leading_zeros(), place.leading_zeros());
    // The divisor is never 0, because its highest bit is set. The compiler cannot see this; `max(1)` removes the panic and makes the image smaller.
    let ratio = ((force << up) >> 32) as u32 / (((place << down) >> 48) as u32).max(1);
    // 16 or 17 bits. From a pressure with 32 bits below a pascal to a force with 16 below a micronewton: an area is below 32 768 mm2.
    let area = Factor {
        mantissa: ratio << 15,
        shift: up.saturating_sub(down + 1).min(Factor::MAX_SHIFT),
    };
    scaled(area, pressure(design, rise))
}

/// Not inlined, so that the image has this product once. The terms have their own.
#[inline(never)]
fn scaled(factor: Factor, x: i64) -> i64 {
    factor.of(x)
}

/// A part of a whole as a share, limited to 0 and [`WHOLE`].
#[inline(never)]
pub fn part(of: i32, whole: i32) -> u32 {
    let (of, whole) = (of.max(0) as u32, whole.max(1) as u32);
    if of >= whole {
        return WHOLE;
    }
    // Shifts the dividend left by up to 16 bits, as far as its word has room. The divisor takes the rest of the shift.
    let up = whole.leading_zeros().min(16);
    ((of << up) / (whole >> (16 - up)).max(1)).min(WHOLE)
}

/// A share as a factor. A share of 1 is the largest factor.
fn share(share: u32) -> Factor {
    Factor {
        mantissa: (share << 15).saturating_mul(2),
        shift: 0,
    }
}

/// A pressure in the unit of the wall's memory.
fn pressure(design: &impl Design, rise: PressureRise) -> i64 {
    let below_count = FRACTION_BITS - design.parameters().pressure_fraction_bits;
    (i64::from(rise.0) << below_count).clamp(-LARGEST_STATE, LARGEST_STATE)
}

#[cfg(test)]
mod tests;
