//! Pressure rise -> the same with less noise, exactly one block later.
//!
//! The block average is the main filter. This one adds the shortest symmetric kernel, 1-2-1 over 4: white noise
//! falls to sqrt(6)/4 = 0.61 of itself, a ramp passes unchanged, and the delay is one block at every
//! frequency, so a time stamp can take it back exactly.

use crate::report::{Fault, Warnings};
use model_tables::units::PressureRise;

/// By how many blocks the output lags the newest input.
pub const GROUP_DELAY: u32 = 1;

/// The filter stage: the last two rises, with what qualified them.
#[derive(Clone, Debug)]
pub struct Filter {
    older: Option<(PressureRise, Warnings)>,
    newer: Option<(PressureRise, Warnings)>,
}

impl Filter {
    /// A filter that has seen nothing yet.
    pub const NEW: Self = Self {
        older: None,
        newer: None,
    };

    /// The filtered rise of the block before this one. What qualifies any of the three qualifies the result.
    ///
    /// # Errors
    /// [`Fault::Settling`] for the first two blocks after the start or a gap.
    #[inline]
    pub fn step(
        &mut self,
        rise: PressureRise,
        warnings: Warnings,
    ) -> Result<(PressureRise, Warnings), Fault> {
        let older = self.older;
        let newer = self.newer;
        self.older = newer;
        self.newer = Some((rise, warnings));
        let ((oldest, first), (middle, second)) = older.zip(newer).ok_or(Fault::Settling)?;
        // Four words of 31 bits and the sign: 34 bits; a quarter of it fits the word again.
        let sum = i64::from(oldest.0) + 2 * i64::from(middle.0) + i64::from(rise.0);
        Ok((
            PressureRise(((sum + 2) >> 2) as i32),
            first.and(second).and(warnings),
        ))
    }

    /// A gap: what was before it is not next to what comes after.
    pub fn interrupt(&mut self) {
        *self = Self::NEW;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn filtered(rises: &[i32]) -> Vec<Option<i32>> {
        let mut filter = Filter::NEW;
        rises
            .iter()
            .map(|&rise| {
                let step = filter.step(PressureRise(rise), Warnings::NONE);
                step.ok().map(|(rise, _)| rise.0)
            })
            .collect()
    }

    #[test]
    fn a_ramp_comes_out_unchanged_one_block_later() {
        assert_eq!(
            filtered(&[100, 200, 300, 400]),
            [None, None, Some(200), Some(300)]
        );
    }

    #[test]
    fn an_impulse_comes_out_as_one_two_one() {
        assert_eq!(
            filtered(&[0, 0, 400, 0, 0])[2..],
            [Some(100), Some(200), Some(100)]
        );
    }

    #[test]
    fn a_gap_empties_it() {
        let mut filter = Filter::NEW;
        for _ in 0..3 {
            let _ = filter.step(PressureRise(7), Warnings::NONE);
        }
        filter.interrupt();
        for _ in 0..2 {
            assert_eq!(filter.step(PressureRise(9), Warnings::NONE), Err(Fault::Settling));
        }
        assert_eq!(
            filter.step(PressureRise(9), Warnings::NONE),
            Ok((PressureRise(9), Warnings::NONE))
        );
    }

    #[test]
    fn a_warning_holds_as_long_as_its_block_is_inside() {
        let mut filter = Filter::NEW;
        let warnings = [false, false, true, false, false, false].map(|saturated| {
            filter
                .step(PressureRise(0), Warnings::SATURATED.when(saturated))
                .map(|(_, warnings)| warnings == Warnings::SATURATED)
        });
        assert_eq!(warnings[2..], [Ok(true), Ok(true), Ok(true), Ok(false)]);
    }

    proptest! {
        #[test]
        fn the_result_lies_between_its_inputs(rises in any::<[i32; 3]>()) {
            let result = filtered(&rises)[2].expect("three blocks settle it");
            prop_assert!(result >= *rises.iter().min().expect("three"));
            prop_assert!(result <= *rises.iter().max().expect("three"));
        }
    }
}
