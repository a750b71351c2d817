//! The tasks of the firmware: [`signal`] makes reports, [`send`] sends them, [`listen`] receives commands, [`remember`] stores
//! the calibration. `signal` feeds the watchdog as long as all four tasks report.

use crate::firmware::line::{listen, send};
use crate::firmware::queues::{self, REFUSED, REQUESTS, SEND, SENT, STORED, TO_STORE, Waiting, alive};
#[cfg(not(feature = "load-tip"))]
use crate::firmware::queues::{IDLE, REMEMBER};
use crate::firmware::retained;
#[cfg(feature = "load-tip")]
use crate::firmware::tip;
use crate::firmware::transducer::{self as chosen, SampleTimer};
use crate::firmware::watch::{self, NOTES, WATCHDOG_PERIOD, missing, version};
use core::sync::atomic::Ordering;
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_time::Delay;
#[cfg(not(feature = "load-tip"))]
use embassy_time::with_timeout;
use fingertip::board::{self, Board, Clock, SLOT, Watchdog};
use fingertip::device::logic::{Beginning, Device};
use fingertip::device::task_monitor::{CrashRecord, GOOD_RUN, Stage};
use fingertip::image::ImageDesign;
use fingertip::image::generated::NAME;
use fingertip::signal::design::Design;
use fingertip::signal::report::Report;
use fingertip::status::{Fault, Status, Stored};
use fingertip::storage::store::{Identity, Store};
use fingertip::transducer::driver::Driver;
use fingertip::transducer::supervisor::TransducerSupervisor;
#[cfg(not(feature = "load-tip"))]
use fingertip::{
    board::FlashMemory, device::logic::ToStore, image::FirmwareDesign, storage::log::StoreError,
};

/// One report out of this many goes to the log.
const LOGGED: u32 = 250;

/// Time from one report to the next, microseconds.
const PERIOD: u32 = ImageDesign::PARAMETERS.period;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // This comes before anything that can hang, so that every reset is counted.
    let reset_cause = board::begin();
    let start = CrashRecord::start(retained::begin(), reset_cause, ImageDesign::CONSTANTS.hash);
    retained::write(&start.crash_record);
    #[cfg(not(feature = "load-tip"))]
    let board = Board::take(start.give_up, reset_cause);
    #[cfg(not(feature = "load-tip"))]
    let design = FirmwareDesign::start();
    #[cfg(feature = "load-tip")]
    let mut board = Board::take(start.give_up, reset_cause);
    #[cfg(feature = "load-tip")]
    let tip::Tip {
        design,
        loader,
        known,
        is_refused,
    } = tip::start(&mut board.memory, start.give_up).await;
    #[cfg(not(feature = "load-tip"))]
    let constants = ImageDesign::CONSTANTS;
    #[cfg(feature = "load-tip")]
    let constants = design.parameters().constants;
    let firmware = version();
    let identity = Identity {
        design_hash: constants.hash,
        table_version: constants.table_version,
        firmware,
        range: constants.transducer.range,
    };
    let mut store = (!start.give_up).then(|| Store::new(board.memory, SLOT, identity));
    let stored = match &mut store {
        None => Stored::Unreadable,
        Some(store) => {
            retained::enter(Stage::Store);
            store.load().await
        }
    };
    retained::enter(Stage::Transducer);
    let beginning = Beginning {
        reset_cause,
        start,
        stored,
        stored_sequence: store.as_ref().map_or(0, Store::sequence),
        calibration: store.as_ref().and_then(Store::calibration),
        clock_failed: !board.crystal,
        firmware,
    };
    #[cfg(feature = "load-tip")]
    let beginning = tip::beginning(beginning, known, is_refused);
    defmt::info!(
        "fingertip {=str}, design {=str} ({=u64:016x}), reset by {=str}, clock: {=str}",
        env!("CARGO_PKG_VERSION"),
        NAME,
        constants.hash,
        reset_cause.word(),
        board::CLOCK
    );
    let clock = board.clock;
    let waiting = queues::outbox();
    spawner.spawn(
        send(
            board.line,
            waiting,
            #[cfg(feature = "rs485")]
            clock,
            SENT.take(),
        )
        .expect("spawned once"),
    );
    spawner.spawn(listen(board.serial_rx, clock).expect("spawned once"));
    #[cfg(not(feature = "load-tip"))]
    spawner.spawn(remember(store, clock).expect("spawned once"));
    #[cfg(feature = "load-tip")]
    spawner.spawn(tip::remember(store, loader, clock, waiting).expect("spawned once"));
    let transducer = board.port.map(chosen::transducer);
    signal(design, clock, transducer, waiting, board.watchdog, &beginning).await
}

/// Turns samples into reports, and answers commands. Period: one sample, 1 ms with a converter. Deadline: the next sample; when
/// late, samples are lost, which is reported and counted. Feeds the watchdog between samples, as long as the other tasks report
/// too. A task that does not report is recorded for the next run. Without a transducer it measures nothing, and reports this at
/// the same rate.
async fn signal(
    design: impl Design,
    clock: Clock,
    transducer: Option<impl Driver>,
    waiting: &'static Waiting,
    mut watchdog: Watchdog,
    beginning: &Beginning,
) -> ! {
    let mut device = Device::new(design, beginning);
    let mut crash_record = CrashRecord {
        detail: Stage::Running as u32,
        ..beginning.start.crash_record
    };
    let mut log = Log::default();
    let mut pace = SampleTimer::new(transducer.is_some());
    let mut supervisor = transducer.map(|transducer| TransducerSupervisor::new(transducer, Delay));
    let (mut last_sample, mut next_feed, mut next_note) = (None, 0, 0);
    loop {
        pace.wait().await;
        let sample = match &mut supervisor {
            Some(supervisor) => supervisor.next().await,
            None => Err(Fault::ResetLoop),
        };
        let now = clock.now();
        if now.0 >= next_feed && (waiting.frames.borrow().is_empty() || cfg!(feature = "rs485")) {
            // An empty queue shows that the send task works. On a shared line, frames wait for the host.
            alive(SEND, now);
        }
        if let Ok(sample) = sample {
            let measured = now.0.saturating_sub(u64::from(sample.age));
            let lost = missing(last_sample.replace(measured), measured, PERIOD);
            device.counters.samples_lost = device.counters.samples_lost.saturating_add(lost);
        }
        let report = device.step(now, sample, |message| waiting.put(message));
        log.report(&report, device.parameters().pressure_fraction_bits);
        if let Ok(request) = REQUESTS.try_receive()
            && let Some(to_store) = device.request(now, request, |message| waiting.put(message))
        {
            // Cannot fail: the device has at most one save under way.
            let _ = TO_STORE.try_send(to_store);
        }
        if now.0 < next_feed {
            continue;
        }
        next_feed = now.0.saturating_add(WATCHDOG_PERIOD);
        if let Ok((result, sequence)) = STORED.try_receive() {
            device.stored(now, result, sequence, |message| waiting.put(message));
        }
        device.counters.frames_dropped = waiting.frames.borrow().dropped();
        device.counters.commands_refused = REFUSED.load(Ordering::Relaxed);
        watch::feed(&mut watchdog, now);
        if now.0 >= next_note {
            next_note = now.0.saturating_add(NOTES);
            crash_record.good = now.0 >= GOOD_RUN;
            crash_record.zero = device.zero();
            retained::write(&crash_record);
        }
    }
}

/// Stores the calibration. Period: on request. Deadline: none; other tasks run meanwhile. Without a store every save fails.
#[cfg(not(feature = "load-tip"))]
#[embassy_executor::task]
async fn remember(mut store: Option<Store<FlashMemory>>, clock: Clock) {
    loop {
        let now = clock.now();
        alive(REMEMBER, now);
        if let Ok(ToStore(calibration)) = with_timeout(IDLE, TO_STORE.receive()).await {
            let result = match &mut store {
                Some(store) => store.save(now, calibration).await,
                None => Err(StoreError::Failed),
            };
            let sequence = store.as_ref().map_or(0, Store::sequence);
            STORED.send((result, sequence)).await;
        }
    }
}

/// Log for the debugger: every change of status, and one report out of [`LOGGED`].
#[derive(Default)]
struct Log {
    reports: u32,
    status: Option<Status>,
}

impl Log {
    fn report(&mut self, report: &Report, fraction_bits: u32) {
        let status = report.status();
        if self.status != Some(status) {
            self.status = Some(status);
            let time = report.time.0;
            // `Display` is not used, because its code takes 1.8 kB.
            match status {
                Status::Ok => defmt::info!("{=u64} us: ok", time),
                Status::Fault(fault) => defmt::info!("{=u64} us: fault: {=str}", time, fault.reason()),
                Status::Warning(warnings) => {
                    for reason in warnings.reasons() {
                        defmt::info!("{=u64} us: warning: {=str}", time, reason);
                    }
                }
            }
        }
        self.reports += 1;
        if self.reports < LOGGED {
            return;
        }
        self.reports = 0;
        if let Ok(measurement) = report.outcome {
            defmt::info!(
                "{=u64} us: {=i32} Pa over rest, {=i32} uN, {=i32} nm",
                report.time.0,
                measurement.pressure_rise.0 >> fraction_bits,
                measurement.force.0,
                measurement.indentation.0
            );
        }
    }
}
