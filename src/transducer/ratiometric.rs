//! A transducer whose voltage is a fraction of its supply, read by the chip's converter: the sum of a block of codes -> pressure.
//! If the supply is also the converter's reference, it cancels. For another supply, the board measures it in every second code, and
//! a division cancels it.

use crate::status::Fault;
use crate::transducer::counts::{self, Block, CountSum, Edges, PERIOD, Ring, Window};
use crate::transducer::driver::{Driver, Sample};
use crate::units::{Millipascals, saturate};
use model_tables::constants;
use model_tables::constants::TransducerKind;

/// A free-running converter whose DMA fills a ring of two blocks.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait Converter {
    /// Time of one conversion, microseconds. [`counts::BLOCK_LENGTH`] conversions take one [`PERIOD`].
    const CONVERSION: u32;

    /// Starts the converter at the front of the ring, from any state. If the supply is measured, the first of two codes
    /// measures the output and the second the supply.
    fn restart(&mut self);

    /// Waits until a block has just been filled, once each [`PERIOD`]. Returns at once if that time is past.
    async fn tick(&mut self);

    /// Number of codes written in the ring, less than its length. `None` if the converter stopped because a code was not
    /// fetched in time.
    fn position(&self) -> Option<usize>;

    /// The ring.
    fn ring(&self) -> &[Block; 2];
}

/// Whether a design's transducer has a supply of its own, which the board measures beside the output.
pub const fn supply_measured(transducer: &constants::Transducer) -> bool {
    matches!(
        transducer.kind,
        TransducerKind::Ratiometric {
            supply_measured: true,
            ..
        }
    )
}

/// The transducer on a converter.
#[derive(Debug)]
pub struct Ratiometric<C> {
    converter: C,
    ring: Ring,
    edges: Edges,
    supply_measured: bool,
    conversion: Conversion,
}

impl<C: Converter> Ratiometric<C> {
    /// The transducer of a design on a converter.
    ///
    /// # Panics
    /// If the design has another kind of transducer.
    pub fn new(transducer: &constants::Transducer, converter: C) -> Self {
        let supply_measured = supply_measured(transducer);
        let window = Window::of(&transducer.kind);
        Self {
            converter,
            ring: Ring::default(),
            edges: if supply_measured {
                Edges::of_output_and_supply(window)
            } else {
                Edges::of_output(window)
            },
            supply_measured,
            conversion: Conversion::of(transducer),
        }
    }
}

impl<C: Converter> Driver for Ratiometric<C> {
    async fn start(&mut self) -> Result<(), Fault> {
        self.converter.restart();
        self.ring = Ring::default();
        Ok(())
    }

    async fn sample(&mut self) -> Result<Sample, Fault> {
        self.converter.tick().await;
        let Some(position) = self.converter.position() else {
            self.start().await?;
            return Err(Fault::SamplesLost);
        };
        let complete = self.ring.look(position)?;
        let block = &self.converter.ring()[complete.half];
        let sum = if self.supply_measured {
            counts::sum_of_supply(block, self.edges)
        } else {
            counts::sum(block, self.edges)
        };
        let now = self.converter.position();
        if now.is_some_and(|now| self.ring.still_holds(now)) {
            Ok(self.conversion.sample(sum?, complete.since * C::CONVERSION))
        } else {
            Err(Fault::SamplesLost)
        }
    }

    /// A start frees the converter.
    async fn free(&mut self) {}
}

/// `pressure = (gain * sum + offset) / 2^shift`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Conversion {
    /// Below 2^31.
    gain: i32,
    /// Includes half a millipascal for rounding; |offset| < 2^62.
    offset: i64,
    /// 0 to 40, so that the gain has 31 bits. Multiplied by a sum of 19 bits, the rounding of the gain changes a result by at
    /// most 2^19 / 2^31 = 2^-12 of the pressure of one unit of the sum.
    shift: u32,
    /// A higher pressure is beyond the transducer's range.
    range_end: Millipascals,
}

impl Conversion {
    /// The conversion for a ratiometric transducer.
    ///
    /// # Panics
    /// At compile time, for a transducer that the converter cannot read, or for impossible values.
    pub const fn of(transducer: &constants::Transducer) -> Self {
        let TransducerKind::Ratiometric {
            output: [low, high], ..
        } = transducer.kind
        else {
            panic!("the converter reads ratiometric transducers only")
        };
        let [start, end] = transducer.range;
        assert!(
            low < high && high <= 65536,
            "outputs are increasing shares of the supply"
        );
        assert!(
            start < end && end <= i32::MAX / 1000,
            "the range is out of reason"
        );
        // Millipascals for one unit of the sum: span / (output share * full scale). 128 bits cost nothing here, because only
        // the compiler evaluates this.
        let span = ((end as i128 - start as i128) * 1000) << 16;
        let sums = (high - low) as i128 * CountSum::FULL_SCALE as i128;
        let mut shift = 40;
        while rounded(span << shift, sums) > i32::MAX as i128 {
            assert!(shift > 0, "the range is too wide");
            shift -= 1;
        }
        let gain = rounded(span << shift, sums);
        let at_start = (start as i128 * 1000) << shift;
        let sum_at_start = rounded(gain * low as i128 * CountSum::FULL_SCALE as i128, 65536);
        let half = if shift == 0 { 0 } else { 1_i128 << (shift - 1) };
        Self {
            gain: gain as i32,
            offset: (at_start - sum_at_start + half) as i64,
            shift,
            range_end: Millipascals(end * 1000),
        }
    }

    /// The pressure of a block, saturated at the ends of the word.
    // Not inlined, so that the instructions from averaged counts to both results can be counted in the image.
    #[inline(never)]
    pub fn pressure(&self, sum: CountSum) -> Millipascals {
        // gain < 2^31 and sum < 2^19: the product is below 2^50, and with the offset it stays within 63 bits.
        let sum = i64::from(sum.0.min(CountSum::FULL_SCALE));
        Millipascals(saturate((i64::from(self.gain) * sum + self.offset) >> self.shift))
    }

    /// The sample of a block that ended `late` microseconds ago.
    #[inline]
    pub fn sample(&self, sum: CountSum, late: u32) -> Sample {
        let pressure = self.pressure(sum);
        Sample {
            pressure,
            headroom: Millipascals(self.range_end.0.saturating_sub(pressure.0)),
            temperature: None,
            raw: None,
            age: PERIOD / 2 + late,
        }
    }
}

/// `a / b` to the nearest, for `a >= 0 < b`.
const fn rounded(a: i128, b: i128) -> i128 {
    (a + b / 2) / b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::Warnings;
    use crate::transducer::script::Stopwatch;
    use crate::transducer::supervisor::TransducerSupervisor;
    use core::sync::atomic::{AtomicU32, Ordering};
    use embassy_futures::block_on;
    use model_tables::constants::Quantity;
    use proptest::prelude::*;
    use std::cell::RefCell;
    use std::rc::Rc;

    fn mpx5100(range: [i32; 2]) -> constants::Transducer {
        constants::Transducer {
            range,
            resolution: 10_000,
            noise: 10_000,
            quantity: Quantity::Gauge,
            kind: TransducerKind::Ratiometric {
                output: [2621, 61604],
                supply_measured: false,
            },
        }
    }

    /// A share of the sum at full scale.
    fn share(share: f64) -> CountSum {
        CountSum((share * f64::from(CountSum::FULL_SCALE)).round() as u32)
    }

    /// The line through both ends in real numbers, millipascals.
    fn line(sum: u32, transducer: &constants::Transducer) -> f64 {
        let TransducerKind::Ratiometric { output, .. } = transducer.kind else {
            unreachable!()
        };
        let share = f64::from(sum) / f64::from(CountSum::FULL_SCALE);
        let [low, high] = output.map(|output| f64::from(output) / 65536.0);
        let [start, end] = transducer.range.map(f64::from);
        1000.0 * (start + (end - start) * (share - low) / (high - low))
    }

    #[test]
    fn half_the_supply_is_51_kilopascals() {
        // Vout = Vs (0.009 P + 0.04): 0.5 of the supply is P = 51.11 kPa, 48.89 kPa below the end.
        let sample = Conversion::of(&mpx5100([0, 100_000])).sample(share(0.5), 0);
        assert!(sample.pressure.0.abs_diff(51_111_000) < 2000, "{sample:?}");
        assert!(sample.headroom.0.abs_diff(48_889_000) < 2000, "{sample:?}");
        assert_eq!(sample.warnings(), Warnings::NONE);
    }

    #[test]
    fn every_sum_is_converted_to_the_nearest_millipascal() {
        for range in [[0, 100_000], [0, 400_000], [-50_000, 50_000], [0, 1_000]] {
            let transducer = mpx5100(range);
            let conversion = Conversion::of(&transducer);
            let tolerance = 0.501 + (line(1, &transducer) - line(0, &transducer)) / 4096.0;
            for sum in (0..=CountSum::FULL_SCALE).step_by(7) {
                let got = f64::from(conversion.sample(CountSum(sum), 0).pressure.0);
                let exact = line(sum, &transducer);
                assert!((got - exact).abs() <= tolerance, "{sum}: {got} for {exact}");
            }
        }
    }

    #[test]
    fn beyond_the_range_is_flagged() {
        let conversion = Conversion::of(&mpx5100([0, 100_000]));
        // The range ends at 94 % of the supply.
        assert_eq!(conversion.sample(share(0.9395), 0).warnings(), Warnings::NONE);
        assert_eq!(conversion.sample(share(0.95), 0).warnings(), Warnings::SATURATED);
    }

    proptest! {
        #[test]
        fn no_sum_panics_and_pressure_never_falls_with_it(sum in any::<u32>(), step in 0_u32..1000) {
            let conversion = Conversion::of(&mpx5100([0, 400_000]));
            let low = conversion.sample(CountSum(sum), 0);
            let high = conversion.sample(CountSum(sum.saturating_add(step)), 0);
            prop_assert!(low.pressure <= high.pressure && low.headroom >= high.headroom);
        }
    }

    /// A converter by hand: it has gone a number of conversions further at each tick, and then once more while a block
    /// is read.
    #[derive(Clone, Default)]
    struct Hand(Rc<RefCell<State>>);

    #[derive(Default)]
    struct State {
        position: usize,
        further: usize,
        while_reading: usize,
        overrun: bool,
        stands: bool,
        restarts: usize,
    }

    struct HandRing {
        hand: Hand,
        ring: [Block; 2],
    }

    impl Converter for HandRing {
        const CONVERSION: u32 = 10;

        fn restart(&mut self) {
            let mut state = self.hand.0.borrow_mut();
            state.position = 0;
            state.further = 102;
            state.overrun = false;
            state.stands = false;
            state.restarts += 1;
        }

        async fn tick(&mut self) {
            let mut state = self.hand.0.borrow_mut();
            state.position += if state.stands { 0 } else { state.further };
            state.further = 100;
        }

        fn position(&self) -> Option<usize> {
            let mut state = self.hand.0.borrow_mut();
            let position = state.position;
            state.position += state.while_reading;
            state.while_reading = 0;
            (!state.overrun).then_some(position % Ring::LENGTH)
        }

        fn ring(&self) -> &[Block; 2] {
            &self.ring
        }
    }

    /// Both blocks at half the supply.
    fn kept() -> (TransducerSupervisor<Ratiometric<HandRing>, Stopwatch>, Hand) {
        kept_with(false, [2047, 2048])
    }

    /// Every two codes of both blocks.
    fn kept_with(
        supply_measured: bool,
        [first, second]: [u32; 2],
    ) -> (TransducerSupervisor<Ratiometric<HandRing>, Stopwatch>, Hand) {
        let hand = Hand::default();
        let block = || core::array::from_fn(|_| AtomicU32::new(second << 16 | first));
        let converter = HandRing {
            hand: hand.clone(),
            ring: [block(), block()],
        };
        let mut transducer = mpx5100([0, 100_000]);
        transducer.kind = TransducerKind::Ratiometric {
            output: [2621, 61604],
            supply_measured,
        };
        let transducer = Ratiometric::new(&transducer, converter);
        (TransducerSupervisor::new(transducer, Stopwatch::default()), hand)
    }

    #[test]
    fn a_measured_supply_is_divided_by() {
        // Half of a supply of 3/4 of the reference.
        let (mut supervisor, _) = kept_with(true, [1536, 3072]);
        let sample = block_on(supervisor.next()).expect("nothing is wrong");
        assert!(sample.pressure.0.abs_diff(51_111_000) < 2000, "{sample:?}");
        let (mut supervisor, hand) = kept_with(true, [0, 0]);
        for _ in 0..5 {
            assert_eq!(block_on(supervisor.next()), Err(Fault::SensorSupply));
        }
        assert_eq!(hand.0.borrow().restarts, 1);
    }

    #[test]
    fn a_running_converter_gives_a_sample_a_period() {
        let (mut supervisor, hand) = kept();
        for _ in 0..100 {
            let sample = block_on(supervisor.next()).expect("nothing is wrong");
            assert!(sample.pressure.0.abs_diff(51_111_000) < 2000, "{sample:?}");
            // The middle of its block, and two conversions since its end.
            assert_eq!(sample.age, 500 + 20);
        }
        assert_eq!(hand.0.borrow().restarts, 1);
    }

    #[test]
    fn an_overrun_is_a_fault_and_over_with_the_next_sample() {
        let (mut supervisor, hand) = kept();
        assert!(block_on(supervisor.next()).is_ok());
        hand.0.borrow_mut().overrun = true;
        assert_eq!(block_on(supervisor.next()), Err(Fault::SamplesLost));
        assert!(block_on(supervisor.next()).is_ok());
    }

    #[test]
    fn a_converter_that_stands_is_started_again_within_three_periods() {
        let (mut supervisor, hand) = kept();
        assert!(block_on(supervisor.next()).is_ok());
        hand.0.borrow_mut().stands = true;
        assert_eq!(block_on(supervisor.next()), Err(Fault::ConverterStalled));
        assert_eq!(block_on(supervisor.next()), Err(Fault::ConverterStalled));
        assert!(block_on(supervisor.next()).is_ok());
    }

    #[test]
    fn a_block_overwritten_while_it_is_read_is_no_sample() {
        let (mut supervisor, hand) = kept();
        assert!(block_on(supervisor.next()).is_ok());
        hand.0.borrow_mut().while_reading = 99;
        assert_eq!(block_on(supervisor.next()), Err(Fault::SamplesLost));
    }

    #[test]
    fn a_late_look_loses_samples_and_says_so() {
        let (mut supervisor, hand) = kept();
        assert!(block_on(supervisor.next()).is_ok());
        for late in [180, 290] {
            hand.0.borrow_mut().further = late;
            assert_eq!(block_on(supervisor.next()), Err(Fault::SamplesLost), "{late}");
            // Back in step with the blocks.
            let position = hand.0.borrow().position;
            hand.0.borrow_mut().further = 102 - position % 100;
            assert!(block_on(supervisor.next()).is_ok(), "{late}");
        }
        assert_eq!(hand.0.borrow().restarts, 1);
    }

    #[test]
    fn a_rail_is_a_fault_that_starts_nothing_anew() {
        let (mut supervisor, hand) = kept();
        assert!(block_on(supervisor.next()).is_ok());
        for (code, fault) in [(0x0FFF, Fault::SensorOpen), (0, Fault::SensorShort)] {
            for block in &supervisor.transducer().converter.ring {
                block[7].store(2048 << 16 | code, Ordering::Relaxed);
            }
            for _ in 0..5 {
                assert_eq!(block_on(supervisor.next()), Err(fault));
            }
        }
        assert_eq!(hand.0.borrow().restarts, 1);
    }
}
