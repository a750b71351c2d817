//! Tests on a real board, through its debug probe: `cargo test-board`, each after a reset of its own. They were built, and not run: no
//! board was at hand. The guide `host-tests/guides/flash-a-board.md` tells what to wire and what is overwritten.
#![cfg_attr(target_os = "none", no_std, no_main)]

/// What reaches below the language: kept memory, the paint of the stack, registers of the core.
#[cfg(target_os = "none")]
mod below {
    #![allow(unsafe_code)]

    use core::cell::UnsafeCell;
    use core::mem::MaybeUninit;

    /// Marks a run's number as one.
    const MAGIC: u32 = 0x5A7E_0000;

    struct Kept(UnsafeCell<MaybeUninit<u32>>);

    // SAFETY: one core, and no interrupt handler uses it.
    unsafe impl Sync for Kept {}

    #[unsafe(link_section = ".uninit.run")]
    static RUN: Kept = Kept(UnsafeCell::new(MaybeUninit::uninit()));

    /// The number that the run before left for this one, which is taken; 0: none.
    pub(super) fn take_run() -> u32 {
        // SAFETY: a plain word, for which any bits are a value.
        let found = unsafe { RUN.0.get().cast::<u32>().read_volatile() };
        leave_run(0);
        if found & 0xFFFF_0000 == MAGIC {
            found & 0xFFFF
        } else {
            0
        }
    }

    /// Leaves a number for the next run.
    pub(super) fn leave_run(run: u32) {
        // SAFETY: as above; nothing holds a reference into it.
        unsafe { RUN.0.get().cast::<u32>().write_volatile(MAGIC | run) }
    }

    /// The watchdog stands still while the probe holds the core: bit 12 of `DBGMCU_APB1_FZ` (RM0090 38.16.4), `DBGMCU_APB1FZR1` of the
    /// STM32L4 and STM32G4, which is at the same address.
    pub(super) fn hold_watchdog_with_the_core() {
        let register = 0xE004_2008 as *mut u32;
        // SAFETY: a register of the debugger's, which nothing else writes.
        unsafe { register.write_volatile(register.read_volatile() | 1 << 12) }
    }

    /// Starts the core's counter of cycles.
    pub(super) fn start_cycles() {
        // SAFETY: nothing else uses these peripherals of the core.
        let mut core = unsafe { cortex_m::Peripherals::steal() };
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
    }

    unsafe extern "C" {
        static mut _stack_end: u32;
        static mut _stack_start: u32;
    }

    /// What the unused stack is filled with.
    const PAINT: u32 = 0xCCCC_CCCC;

    /// Words below the present end of the stack that painting leaves alone: its own.
    const OWN: usize = 64;

    /// Words of the stack.
    fn length() -> usize {
        (&raw const _stack_start as usize - &raw const _stack_end as usize) / size_of::<u32>()
    }

    /// Paints the unused stack.
    #[inline(never)]
    pub(super) fn paint_stack() {
        let end = &raw mut _stack_end;
        let unused = (cortex_m::register::msp::read() as usize - end as usize) / size_of::<u32>();
        for word in 0..unused.saturating_sub(OWN) {
            // SAFETY: below everything in use, and within the stack.
            unsafe { end.add(word).write_volatile(PAINT) }
        }
    }

    /// Bytes of the stack, and how many of them were used since it was painted.
    pub(super) fn stack_used() -> [usize; 2] {
        let end = &raw const _stack_end;
        // SAFETY: within the stack.
        let is_paint = |&word: &usize| unsafe { end.add(word).read_volatile() } == PAINT;
        let free = (0..length()).take_while(is_paint).count();
        [length() * size_of::<u32>(), (length() - free) * size_of::<u32>()]
    }
}

#[cfg(target_os = "none")]
mod checks {
    use super::below;
    use core::hint::black_box;
    use cortex_m::peripheral::{DWT, SCB};
    use defmt_rtt as _;
    use embassy_executor::Executor;
    use embassy_futures::join::join;
    use embassy_futures::select::{Either, select};
    use embassy_time::{Duration, Instant, Timer, block_for, with_timeout};
    use fingertip::board::{self, Board, FlashMemory, SLOT, Watchdog};
    use fingertip::device::logic::{Beginning, Device};
    use fingertip::device::task_monitor::CrashRecord;
    use fingertip::image::{FirmwareDesign, ImageDesign};
    use fingertip::link::telemetry::{Frame, encode};
    use fingertip::signal::calibration::Calibration;
    use fingertip::status::{ResetCause, Stored};
    use fingertip::storage::store::{Identity, Store};
    use fingertip::transducer::driver::Sample;
    use fingertip::units::{Microseconds, Millipascals};
    use static_cell::StaticCell;

    /// Bits a second of the line of a board of one tip (`PROTOCOL.md`), and how far it may be off: the L432KC's oscillator by 1 %, the
    /// STM32F4's divider by 0.8 %.
    const BAUD: u64 = 921_600;
    const BAUD_PER_MILLE: u64 = 18;

    /// Resets, each between a save and its reading.
    const RESETS: u32 = 3;

    /// The board, of which a probe may hold the core.
    pub(crate) fn take() -> Board {
        below::hold_watchdog_with_the_core();
        Board::take(false, board::begin())
    }

    /// Does something while the watchdog is fed.
    async fn fed<T>(watchdog: &mut Watchdog, work: impl Future<Output = T>) -> T {
        let feed = async {
            loop {
                watchdog.pet();
                Timer::after_millis(20).await;
            }
        };
        match select(work, feed).await {
            Either::First(done) => done,
            Either::Second(()) => unreachable!("it feeds without an end"),
        }
    }

    /// The store of the image's design, and what is in it.
    async fn open(memory: FlashMemory) -> (Store<FlashMemory>, Stored) {
        let constants = ImageDesign::CONSTANTS;
        let identity = Identity {
            design_hash: constants.hash,
            table_version: constants.table_version,
            firmware: [0, 0, 0],
            range: constants.transducer.range,
        };
        Store::open(memory, SLOT, identity).await
    }

    /// What a run saves for the next one, whose number is its gain.
    fn calibration(run: u32) -> Calibration {
        Calibration {
            gain: run as i32,
            ..Calibration::default()
        }
    }

    /// A run of the test of saves: finds what the run before saved, saves for the next one and resets the chip; the last one empties the
    /// store and returns.
    pub(crate) async fn save_and_reset(board: Board, run: u32) {
        let Board {
            clock,
            mut watchdog,
            memory,
            ..
        } = board;
        let saves = async {
            let (mut store, state) = open(memory).await;
            if run > 0 {
                assert_eq!(state, Stored::InUse, "the save before the reset is not in use");
                assert_eq!(
                    store.calibration(),
                    Some(calibration(run)),
                    "another save is in use"
                );
            }
            let next = (run < RESETS).then(|| calibration(run + 1));
            let saved = store.save(clock.now(), next).await;
            assert_eq!(saved, Ok(()), "the flash does not take a save");
            next.is_some()
        };
        if fed(&mut watchdog, saves).await {
            below::leave_run(run + 1);
            SCB::sys_reset();
        }
    }

    /// A run after a reset by the test itself: goes on with it, and never returns. Without one it returns at once.
    pub(crate) fn go_on() {
        static EXECUTOR: StaticCell<Executor> = StaticCell::new();
        let run = below::take_run();
        if run > 0 {
            EXECUTOR
                .init(Executor::new())
                .run(|spawner| spawner.spawn(next_run(run).expect("spawned once")));
        }
    }

    #[embassy_executor::task]
    async fn next_run(run: u32) {
        save_and_reset(take(), run).await;
        embedded_test::export::check_outcome(());
    }

    /// What is sent comes back over the wire from TX to RX, at the stated rate.
    pub(crate) async fn loop_back(board: Board) {
        const BYTES: usize = 1000;
        let Board {
            mut line,
            mut serial_rx,
            mut watchdog,
            ..
        } = board;
        let sent: [u8; BYTES] = core::array::from_fn(|place| (place * 7) as u8);
        let mut back = [0; BYTES];
        let receive = async {
            let mut length = 0;
            while length < BYTES {
                length += serial_rx
                    .read(&mut back[length..])
                    .await
                    .expect("no byte is lost");
            }
        };
        let began = Instant::now();
        let both = with_timeout(Duration::from_secs(1), join(receive, line.write(&sent)));
        let done = fed(&mut watchdog, both).await;
        let took = began.elapsed().as_micros();
        assert!(done.is_ok(), "not all came back: is TX wired to RX?");
        assert!(back == sent, "other bytes came back");
        // A start bit, eight, and a stop bit.
        let rate = 10 * BYTES as u64 * 1_000_000 / took;
        defmt::info!("{=u64} bits a second", rate);
        assert!(
            rate.abs_diff(BAUD) * 1000 <= BAUD * BAUD_PER_MILLE,
            "{rate} bits a second"
        );
    }

    /// Cycles of reports.
    pub(crate) struct ReportCycles {
        mean: u32,
        most: u32,
        /// From one report to the next.
        period: u32,
    }

    impl ReportCycles {
        pub(crate) fn expect_room(&self) {
            let Self { mean, most, period } = *self;
            defmt::info!(
                "a report: {=u32} cycles, {=u32} at most, of {=u32}",
                mean,
                most,
                period
            );
            assert!(
                mean <= period / 4,
                "a report takes more than a quarter of its period"
            );
            assert!(most <= period / 2, "a report takes more than half of its period");
        }
    }

    /// Reports of a fingertip that rests until its zero is taken and is then pressed to half of its tables, with their frames.
    pub(crate) fn reports(watchdog: &mut Watchdog) -> ReportCycles {
        const AT_REST: u64 = 4000;
        const PRESSED: u64 = 2000;
        below::start_cycles();
        let constants = ImageDesign::CONSTANTS;
        let period = ImageDesign::PARAMETERS.period;
        let begun = DWT::cycle_count();
        block_for(Duration::from_micros(1000));
        let millisecond = DWT::cycle_count().wrapping_sub(begun);
        let start = CrashRecord::start(None, ResetCause::PowerOn, constants.hash);
        let beginning = Beginning {
            reset_cause: ResetCause::PowerOn,
            start,
            stored: Stored::None,
            stored_sequence: 0,
            calibration: None,
            clock_failed: false,
            firmware: [0, 0, 0],
        };
        let mut device = Device::new(FirmwareDesign::start(), &beginning);
        let rise = i64::from(constants.maximum_pressure - constants.rest_pressure) * 1000 / 2;
        let (mut sum, mut most, mut read) = (0_u64, 0, 0);
        for number in 0..AT_REST + PRESSED {
            let pressed = number.saturating_sub(AT_REST) as i64;
            let pressure = i64::from(constants.rest_pressure) * 1000 + rise * pressed / PRESSED as i64;
            let sample = Sample {
                pressure: Millipascals(pressure as i32),
                headroom: Millipascals(1000),
                ..Sample::default()
            };
            let now = Microseconds(1000 + u64::from(period) * number);
            let before = DWT::cycle_count();
            let report = device.step(now, Ok(sample), |&message| {
                black_box(encode(&Frame {
                    sequence: number as u16,
                    dropped: 0,
                    message,
                }));
            });
            let took = DWT::cycle_count().wrapping_sub(before);
            if number >= AT_REST {
                sum += u64::from(took);
                most = took.max(most);
                read += u64::from(report.outcome.is_ok());
            }
            if number % 64 == 0 {
                watchdog.pet();
            }
        }
        assert!(
            read * 10 > PRESSED * 9,
            "{read} of {PRESSED} reports are readings"
        );
        ReportCycles {
            mean: (sum / PRESSED) as u32,
            most,
            period: (u64::from(millisecond) * u64::from(period) / 1000) as u32,
        }
    }

    /// Reports, a save and a frame leave half of the stack as it was painted.
    pub(crate) async fn stack(board: Board) {
        let Board {
            clock,
            mut line,
            mut watchdog,
            memory,
            ..
        } = board;
        below::paint_stack();
        reports(&mut watchdog);
        let work = async {
            let (mut store, _) = open(memory).await;
            let saved = store.save(clock.now(), None).await;
            assert_eq!(saved, Ok(()), "the flash does not take a save");
            line.write(&[0]).await.expect("a line takes all");
        };
        fed(&mut watchdog, work).await;
        let [length, used] = below::stack_used();
        defmt::info!("stack: {=usize} of {=usize} bytes", used, length);
        assert!(
            used > 0 && used <= length / 2,
            "{used} of {length} bytes of stack are used"
        );
    }
}

#[cfg(target_os = "none")]
#[embedded_test::setup]
fn setup() {
    crate::checks::go_on();
}

#[cfg(target_os = "none")]
#[embedded_test::tests]
mod tests {
    use crate::checks;
    use fingertip::board::Board;

    #[init]
    fn init() -> Board {
        checks::take()
    }

    #[test]
    async fn a_save_is_in_use_after_each_of_three_resets(board: Board) {
        checks::save_and_reset(board, 0).await;
    }

    #[test]
    #[ignore] // needs a wire from TX to RX
    async fn what_is_sent_comes_back_at_the_stated_rate(board: Board) {
        checks::loop_back(board).await;
    }

    #[test]
    fn a_report_takes_at_most_a_quarter_of_its_period(mut board: Board) {
        checks::reports(&mut board.watchdog).expect_room();
    }

    #[test]
    async fn half_of_the_stack_stays_empty(board: Board) {
        checks::stack(board).await;
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This is an image for a real board, whose tests `cargo test-board` runs through a debug probe."
    );
    std::process::exit(1);
}
