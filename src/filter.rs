//! Pressure rise -> the same with less noise and without wild samples, exactly one block later.
//!
//! The block average is the main filter. This one adds the shortest symmetric kernel, 1-2-1 over 4: white noise
//! falls to sqrt(6)/4 = 0.61 of itself, a ramp passes unchanged, and the delay is one block at every
//! frequency, so a time stamp can take it back exactly.
//!
//! The block that is reported has one neighbour on each side, which tells a wild sample (flipped bits) from a press
//! without any further delay: a fingertip does not leap and return within two blocks from a standstill. Such a sample
//! is replaced by what its neighbours say, and counted. Where a leap may be a press or not, or is faster than any
//! press, there is [`Fault::Jump`] and no number.

use crate::pressure::Pressure;
use crate::report::{Fault, Warnings};
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

/// By how many blocks the output lags the newest input.
pub const GROUP_DELAY: u32 = 1;

/// A leap of one block that noise does not explain, in grains of the transducer: its second difference has 2.4 times
/// the noise of a block, so white noise gets there less than once in 10^10 blocks.
const LEAP_GRAINS: i64 = 8;

/// The fastest press there is takes this long over the whole table, microseconds: 2.5 mm at 0.6 m/s.
const FASTEST_PRESS: u64 = 4_000;

/// Blocks without a number after a leap that no press makes. One that comes back within them leaves no trace.
const JUMP_HOLD: u8 = 8;

/// How far a rise may leap from one block to the next, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Leaps {
    /// Above: not noise.
    pub noise: i64,
    /// Above: no press.
    pub press: i64,
}

impl Leaps {
    /// The leaps of a design whose blocks come every `period` microseconds.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32, period: u32) -> Self {
        let noise =
            Pressure::from_millipascals(constants.transducer.grain() * LEAP_GRAINS, fraction_bits).0 as i64;
        let span = constants.maximum_pressure.saturating_sub(constants.rest_pressure);
        // Below 2^31 * 2^32 / 4000 before the unit, which is at most 2^16 and clamped.
        let press = span as i64 * period as i64 * 1000 / FASTEST_PRESS as i64;
        let press = Pressure::from_millipascals(press, fraction_bits).0 as i64;
        Self {
            noise,
            press: if press > 2 * noise { press } else { 2 * noise },
        }
    }
}

/// One block as the filter keeps it.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    rise: PressureRise,
    warnings: Warnings,
}

/// The filter stage: the last three blocks.
#[derive(Clone, Debug)]
pub struct Filter {
    leaps: Leaps,
    /// Oldest first.
    history: [Block; 3],
    /// How many of them there are, the newest ones.
    filled: u8,
    /// Blocks left of a [`JUMP_HOLD`].
    hold: u8,
    rejected: u32,
}

impl Filter {
    /// A filter that has seen nothing yet.
    pub const fn new(leaps: Leaps) -> Self {
        let none = Block {
            rise: PressureRise(0),
            warnings: Warnings::NONE,
        };
        Self {
            leaps,
            history: [none; 3],
            filled: 0,
            hold: 0,
            rejected: 0,
        }
    }

    /// Wild samples replaced so far.
    pub const fn rejected(&self) -> u32 {
        self.rejected
    }

    /// The filtered rise of the block before this one. What qualifies any of the three qualifies the result.
    ///
    /// # Errors
    /// [`Fault::Settling`] for the first two blocks after the start or a gap, [`Fault::Jump`] where the rise leaps as
    /// no press does.
    #[inline]
    pub fn step(
        &mut self,
        rise: PressureRise,
        warnings: Warnings,
    ) -> Result<(PressureRise, Warnings), Fault> {
        let newest = Block { rise, warnings };
        let [before, oldest, middle] = self.history;
        self.history = [oldest, middle, newest];
        if self.filled < 2 {
            self.filled += 1;
            return Err(Fault::Settling);
        }
        let run_up = if self.filled == 2 { 0 } else { leap(before, oldest) };
        self.filled = 3;
        let (rising, leaving) = (leap(oldest, middle), leap(middle, newest));
        let noise = self.leaps.noise;
        if self.hold == 0 && rising.abs() <= noise && leaving.abs() <= noise {
            return Ok(smooth(oldest, middle, newest));
        }
        self.leapt(run_up, rising, leaving)
    }

    /// The same where a neighbour leaps.
    #[cold]
    fn leapt(&mut self, run_up: i64, rising: i64, leaving: i64) -> Result<(PressureRise, Warnings), Fault> {
        let [oldest, middle, newest] = self.history;
        let Leaps { noise, press } = self.leaps;
        let alone = rising.abs() > noise && leaving.abs() > noise && (rising > 0) != (leaving > 0);
        // Within a run-up of its own size a peak may be the turn of a fast press.
        let from_standstill = 4 * run_up.abs() <= rising.abs();
        if alone && from_standstill {
            let mean = (i64::from(oldest.rise.0) + i64::from(newest.rise.0)) >> 1;
            self.history[1] = Block {
                rise: PressureRise(mean as i32),
                warnings: oldest.warnings.and(newest.warnings),
            };
            self.rejected = self.rejected.saturating_add(1);
        } else if !alone && rising.abs() > press {
            self.hold = JUMP_HOLD;
        }
        if self.hold > 0 {
            self.hold -= 1;
            return Err(Fault::Jump);
        }
        if alone && !from_standstill {
            return Err(Fault::Jump);
        }
        if leaving.abs() > noise && (leaving - rising).abs() > noise && !alone {
            // The newest may be wild, which only the next block will tell.
            return Ok((middle.rise, oldest.warnings.and(middle.warnings)));
        }
        Ok(smooth(oldest, self.history[1], newest))
    }

    /// A gap: what was before it is not next to what comes after.
    pub fn interrupt(&mut self) {
        self.filled = 0;
        self.hold = 0;
    }
}

/// Below 2^33.
fn leap(from: Block, to: Block) -> i64 {
    i64::from(to.rise.0) - i64::from(from.rise.0)
}

fn smooth(oldest: Block, middle: Block, newest: Block) -> (PressureRise, Warnings) {
    // Four words of 31 bits and the sign: 34 bits; a quarter of it fits the word again.
    let sum = i64::from(oldest.rise.0) + 2 * i64::from(middle.rise.0) + i64::from(newest.rise.0);
    (
        PressureRise(((sum + 2) >> 2) as i32),
        oldest.warnings.and(middle.warnings).and(newest.warnings),
    )
}

#[cfg(test)]
mod tests;
