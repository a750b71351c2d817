use super::*;
use embassy_futures::block_on;
use model_tables::constants::{Quantity, TransducerKind};
use std::cell::Cell;
use std::sync::atomic::Ordering;

const TIPS: usize = 2;
const RANKS: usize = TIPS + 1;
const SCANS: usize = 20;
/// Two scans are a row.
const ROW: usize = row(TIPS);
const ROWS: usize = RANKS * SCANS / (2 * ROW);
/// 1.21 V of 3.3 V.
const IN_PLACE: u16 = 1501;

/// 4 % of the supply at 0, 94 % at 100 kPa.
const MPX5100: Transducer = Transducer {
    range: [0, 100_000],
    resolution: 10_000,
    noise: 10_000,
    quantity: Quantity::Gauge,
    kind: TransducerKind::Ratiometric {
        output: [2621, 61604],
        supply_measured: false,
    },
};

/// A converter by hand: a block further at each tick.
struct Hand {
    ring: [ScanBlock<ROW, ROWS>; 2],
    position: Cell<usize>,
    step: usize,
    overrun: bool,
    restarts: usize,
}

impl ScanConverter<ROW, ROWS> for &mut Hand {
    const PERIOD: u32 = 900;

    fn restart(&mut self) {
        self.position.set(2);
        self.overrun = false;
        self.restarts += 1;
    }

    async fn tick(&mut self) {
        self.position
            .set((self.position.get() + self.step) % (2 * RANKS * SCANS));
    }

    fn position(&self) -> Option<usize> {
        (!self.overrun).then(|| self.position.get())
    }

    fn ring(&self) -> &[ScanBlock<ROW, ROWS>; 2] {
        &self.ring
    }
}

/// A block whose every scan has these codes.
fn block<const RANKS: usize, const ROW: usize, const ROWS: usize>(
    codes: [u16; RANKS],
) -> ScanBlock<ROW, ROWS> {
    let code = |place: usize| u32::from(codes[place % RANKS]);
    core::array::from_fn(|row| {
        core::array::from_fn(|word| {
            let place = 2 * (row * ROW + word);
            AtomicU32::new(code(place) | code(place + 1) << 16)
        })
    })
}

impl Hand {
    /// Puts a code into a scan of a block.
    fn put(&mut self, half: usize, [scan, rank]: [usize; 2], code: u16) {
        let place = scan * RANKS + rank;
        let word = &self.ring[half].as_flattened()[place / 2];
        let shift = 16 * (place % 2);
        let others = word.load(Ordering::Relaxed) & !(0xFFFF << shift);
        word.store(others | u32::from(code) << shift, Ordering::Relaxed);
    }
}

/// Every scan has these codes.
fn hand(codes: [u16; RANKS]) -> Hand {
    Hand {
        ring: [block(codes), block(codes)],
        position: Cell::new(0),
        step: RANKS * SCANS,
        overrun: false,
        restarts: 0,
    }
}

/// What so many looks give.
fn looks(hand: &mut Hand, count: usize) -> Vec<[Result<Sample, Fault>; TIPS]> {
    let mut scan = Scan::<_, TIPS, ROW, ROWS>::new([MPX5100; TIPS], hand);
    (0..count).map(|_| *block_on(scan.next())).collect()
}

#[test]
fn each_tip_has_its_own_pressure_and_all_one_age() {
    // Vout = Vs (0.009 P + 0.04): codes 1000 and 2000 are 22.689 and 49.823 kPa.
    let mut hand = hand([1000, 2000, IN_PLACE]);
    for samples in looks(&mut hand, 9) {
        let [a, b] = samples.map(|sample| sample.expect("nothing is wrong"));
        for (sample, code) in [(a, 1000.0), (b, 2000.0)] {
            let exact = 1e6 * (code / 4095.0 - 0.04) / 0.009;
            assert!(
                (f64::from(sample.pressure.0) - exact).abs() < 2000.0,
                "{sample:?} for {exact}"
            );
            // The middle of its block, and two of sixty conversions since its end.
            assert_eq!(sample.age, 450 + 30);
        }
    }
    assert_eq!(hand.restarts, 1);
}

#[test]
fn a_broken_wire_is_one_tips_fault() {
    let mut hand = hand([1000, 2000, IN_PLACE]);
    hand.put(0, [7, 1], 4095);
    hand.put(1, [19, 0], 0);
    let seen = looks(&mut hand, 2);
    assert!(seen[0][0].is_ok());
    assert_eq!(seen[0][1], Err(Fault::SensorOpen));
    assert_eq!(seen[1][0], Err(Fault::SensorShort));
    assert!(seen[1][1].is_ok());
    assert_eq!(hand.restarts, 1);
}

#[test]
fn channels_out_of_place_are_no_tips_pressure() {
    for shift in 1..RANKS {
        let mut codes = [600, 700, IN_PLACE];
        codes.rotate_left(shift);
        let mut hand = hand(codes);
        for samples in looks(&mut hand, 3) {
            assert_eq!(samples, [Err(Fault::ChannelIdentity); TIPS]);
        }
        // Started anew after each of them.
        assert_eq!(hand.restarts, 3);
    }
    // One code is enough.
    let mut hand = hand([600, 700, IN_PLACE]);
    hand.put(0, [3, 2], 700);
    let seen = looks(&mut hand, 2);
    assert_eq!(seen[0], [Err(Fault::ChannelIdentity); TIPS]);
    assert_eq!(seen[1], [Err(Fault::ChannelIdentity); TIPS]);
}

#[test]
fn the_window_of_the_reference_is_the_datasheets() {
    let code = |volts: f64, supply: f64| 4095.0 * volts / supply;
    assert_eq!(REFERENCE.short, code(1.18, 3.3 * 1.05) as u16 - 1);
    assert_eq!(REFERENCE.open, code(1.24, 3.3 * 0.95).ceil() as u16);
}

#[test]
fn a_converter_that_stands_or_overran_is_started_anew() {
    let mut standing = hand([1000, 2000, IN_PLACE]);
    standing.step = 0;
    let seen = looks(&mut standing, 3);
    // It is within the first block, stands there, and is started anew.
    let faults = [Fault::SamplesLost, Fault::ConverterStalled, Fault::SamplesLost];
    assert_eq!(seen, faults.map(|fault| [Err(fault); TIPS]));
    assert_eq!(standing.restarts, 2);
    let mut overrun = hand([1000, 2000, IN_PLACE]);
    let mut scan = Scan::<_, TIPS, ROW, ROWS>::new([MPX5100; TIPS], &mut overrun);
    assert!(block_on(scan.next())[0].is_ok());
    scan.converter.overrun = true;
    assert_eq!(*block_on(scan.next()), [Err(Fault::SamplesLost); TIPS]);
    assert!(block_on(scan.next())[0].is_ok());
}

/// Beside a sum code by code: an even number of ranks, whose row is a scan, and more rows than one word sums.
#[test]
fn a_block_is_added_up_rank_by_rank() {
    struct Still([ScanBlock<3, 40>; 2]);
    impl ScanConverter<3, 40> for Still {
        const PERIOD: u32 = 1;
        fn restart(&mut self) {}
        async fn tick(&mut self) {}
        fn position(&self) -> Option<usize> {
            None
        }
        fn ring(&self) -> &[ScanBlock<3, 40>; 2] {
            &self.0
        }
    }
    let mut code = 0_u32;
    let blocks: [ScanBlock<3, 40>; 2] = core::array::from_fn(|_| {
        core::array::from_fn(|_| {
            core::array::from_fn(|_| {
                code = code.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                // 1024 to 2047, all of them in their windows but for the reference's.
                AtomicU32::new((code >> 6 & 0x03FF_03FF) | 0x0400_0400)
            })
        })
    });
    let expected: Vec<[u32; 6]> = blocks
        .iter()
        .map(|block| {
            let mut totals = [0; 6];
            for (word, codes) in block.as_flattened().iter().enumerate() {
                let codes = codes.load(Ordering::Relaxed);
                totals[2 * word % 6] += codes & 0xFFFF;
                totals[(2 * word + 1) % 6] += codes >> 16;
            }
            totals
        })
        .collect();
    let scan = Scan::<_, 5, 3, 40>::new([MPX5100; 5], Still(blocks));
    for (half, expected) in expected.iter().enumerate() {
        let (tips, reference) = scan.add_up(half);
        assert_eq!(
            tips.map(super::Rank::sum),
            [0, 1, 2, 3, 4].map(|rank| Ok(expected[rank]))
        );
        assert_eq!(reference.total, expected[5]);
        assert!(reference.sum().is_err());
    }
}
