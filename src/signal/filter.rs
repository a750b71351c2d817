//! Pressure rise -> pressure rise with less noise and without outliers, exactly one block later.
//!
//! The block average is the main filter. This one adds the shortest symmetric kernel, 1-2-1 over 4: white noise falls to sqrt(6)/4
//! = 0.61 of itself, and a ramp passes unchanged. The delay is one block at every frequency, so the time stamp corrects it exactly.
//!
//! The reported block has one neighbour on each side. They distinguish an outlier (flipped bits) from a press without further
//! delay, because the pressure of a press does not step away and back within two blocks. An outlier is replaced by a value from its
//! neighbours, and counted. If a step cannot be classified, or is faster than any press, the result is [`Fault::Jump`] and no
//! number.

use crate::status::{Fault, Warnings};
use crate::units::Pressure;
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

/// Delay of the output, in blocks. It is one, because the output belongs to the block before the newest one.
pub const GROUP_DELAY: u32 = 1;

/// Largest bend of three blocks that noise explains, in noise floors of the transducer. A second difference has 2.4 times the
/// noise of a block. White noise of a whole noise floor therefore exceeds this once in a thousand blocks, and those blocks are
/// not averaged. The noise of a converter is a tenth of that and never exceeds it.
const STEP_NOISE_FLOORS: i64 = 8;

/// Duration of the fastest possible press over the whole table, microseconds: 2.5 mm at 0.6 m/s.
const FASTEST_PRESS: u64 = 4_000;

/// Sets the bend of a fast press, microseconds. The press covers the whole table in 0.2 s, and its pressure grows with the
/// power 2.5 of its depth. Its bend is the whole table times the square of (block / this time). At the end of the press this is
/// 2.5 x 1.5 times the square of (block / 0.2 s).
const FAST_BEND: i64 = 100_000;

/// Number of blocks that report no value after a step too fast for any press. A step that returns within these blocks has no further effect.
const JUMP_HOLD: u8 = 8;

/// How far a rise may step or bend from one block to the next, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct StepLimits {
    /// A larger bend is not noise.
    pub noise: i64,
    /// A larger step is too fast for a press.
    pub press: i64,
    /// A larger bend is too sharp for a fast press; at least half of `noise`.
    pub bend: i64,
}

impl StepLimits {
    /// The step limits of a design whose blocks come every `period` microseconds.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32, period: u32) -> Self {
        let noise = Pressure::from_millipascals(
            constants.transducer.noise_floor() * STEP_NOISE_FLOORS,
            fraction_bits,
        )
        .0 as i64;
        let span = constants.maximum_pressure.saturating_sub(constants.rest_pressure);
        // Below 2^31 * 2^32 / 4000 before the unit, which is at most 2^16 and clamped.
        let press = span as i64 * period as i64 * 1000 / FASTEST_PRESS as i64;
        let press = Pressure::from_millipascals(press, fraction_bits).0 as i64;
        // Below 2^31 * 40 000^2, which is below 2^62: no round is longer.
        let period = period as i64;
        let bend = span as i64 * (period * period) / (FAST_BEND * FAST_BEND / 1000);
        let bend = Pressure::from_millipascals(bend, fraction_bits).0 as i64;
        Self {
            noise,
            bend: if 2 * bend > noise { bend } else { noise / 2 },
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
    step_limits: StepLimits,
    /// Oldest first.
    history: [Block; 3],
    /// Number of valid blocks in `history`; they are the newest ones.
    filled: u8,
    /// Remaining blocks of a [`JUMP_HOLD`].
    hold: u8,
    /// Whether the last sample was evenly spaced in time.
    even: bool,
    rejected: u32,
}

impl Filter {
    /// A filter without any block yet.
    pub const fn new(step_limits: StepLimits) -> Self {
        let none = Block {
            rise: PressureRise(0),
            warnings: Warnings::NONE,
        };
        Self {
            step_limits,
            history: [none; 3],
            filled: 0,
            hold: 0,
            even: false,
            rejected: 0,
        }
    }

    /// Outliers replaced so far.
    pub const fn rejected(&self) -> u32 {
        self.rejected
    }

    /// The filtered rise of the block before this one. The result has the warnings of all three blocks. `even`: the last three
    /// blocks are equally spaced in time. If they are not, the middle block is returned unchanged, because an average would
    /// belong to another time.
    ///
    /// # Errors
    /// [`Fault::Settling`] for the first two blocks after the start or a gap, [`Fault::Jump`] if the rise steps faster than any
    /// press.
    #[inline]
    pub fn step(
        &mut self,
        rise: PressureRise,
        warnings: Warnings,
        even: bool,
    ) -> Result<(PressureRise, Warnings), Fault> {
        let newest = Block { rise, warnings };
        let [before, oldest, middle] = self.history;
        self.history = [oldest, middle, newest];
        let in_line = core::mem::replace(&mut self.even, even) && even;
        if self.filled < 2 {
            self.filled += 1;
            return Err(Fault::Settling);
        }
        // At the start and after a gap, the rise before the first block is assumed constant.
        let before = if self.filled == 2 { oldest } else { before };
        self.filled = 3;
        let bend = step_between(middle, newest) - step_between(oldest, middle);
        let stepped = bend.abs() > self.step_limits.noise
            || step_between(oldest, middle).abs() > self.step_limits.press;
        if stepped || self.hold > 0 {
            return self.stepped(before, even, in_line);
        }
        Ok(smooth(oldest, middle, newest, even))
    }

    /// The same if the samples bend by more than noise, or step.
    #[cold]
    fn stepped(
        &mut self,
        before: Block,
        even: bool,
        in_line: bool,
    ) -> Result<(PressureRise, Warnings), Fault> {
        let [oldest, middle, newest] = self.history;
        let StepLimits { noise, press, bend } = self.step_limits;
        let (run_up, rising, leaving) = (
            step_between(before, oldest),
            step_between(oldest, middle),
            step_between(middle, newest),
        );
        let (bent, bends) = (rising - run_up, leaving - rising);
        // The middle block is the outlier if the newest lies on the line through the two blocks before the middle, and the
        // middle does not. (Unevenly spaced samples do not define a line.)
        let on_line = (rising + leaving - 2 * run_up).abs() <= noise;
        let outlier =
            in_line && bends.abs() > noise && 2 * bent.abs() > noise && (bent > 0) != (bends > 0) && on_line;
        if outlier {
            let mean = (i64::from(oldest.rise.0) + i64::from(newest.rise.0)) >> 1;
            self.history[1] = Block {
                rise: PressureRise(mean as i32),
                warnings: oldest.warnings.and(newest.warnings),
            };
            self.rejected = self.rejected.saturating_add(1);
        } else if rising.abs() > press {
            self.hold = JUMP_HOLD;
        }
        if self.hold > 0 {
            self.hold -= 1;
            return Err(Fault::Jump);
        }
        if outlier || bends.abs() <= noise {
            return Ok(smooth(oldest, self.history[1], newest, even));
        }
        // A press that began between two samples slows down or continues. It gets faster once, if a block averages over its
        // start from a constant level. A rise that turns, or is faster than any press, lies neither on the old line, with the
        // bend of a fast press, nor on a new one.
        let begins = run_up.abs() <= noise && leaving.abs() <= press;
        let goes_on = leaving.abs() <= noise
            || (rising > 0) == (leaving > 0) && (leaving.abs() <= rising.abs() || begins);
        if bent.abs() > bend && !goes_on {
            return Err(Fault::Jump);
        }
        // Either a corner, or the newest block is an outlier. Only the next block can decide, so the middle block is returned unchanged.
        Ok((middle.rise, oldest.warnings.and(middle.warnings)))
    }

    /// The zero moved: adds `by` counts to the rises so far.
    #[cold]
    pub fn shift(&mut self, by: i32) {
        for block in &mut self.history {
            block.rise = PressureRise(block.rise.0.saturating_add(by));
        }
    }

    /// A gap: samples before it are not neighbours of samples after it.
    pub fn interrupt(&mut self) {
        self.filled = 0;
        self.hold = 0;
    }
}

/// Below 2^33.
fn step_between(from: Block, to: Block) -> i64 {
    i64::from(to.rise.0) - i64::from(from.rise.0)
}

fn smooth(oldest: Block, middle: Block, newest: Block, even: bool) -> (PressureRise, Warnings) {
    let warnings = oldest.warnings.and(middle.warnings).and(newest.warnings);
    if !even {
        return (middle.rise, warnings);
    }
    // The sum of four 32-bit values has 34 bits. A quarter of it fits 32 bits again.
    let sum = i64::from(oldest.rise.0) + 2 * i64::from(middle.rise.0) + i64::from(newest.rise.0);
    (PressureRise(((sum + 2) >> 2) as i32), warnings)
}

#[cfg(test)]
mod tests;
