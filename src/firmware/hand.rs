//! The tasks of a hand's firmware: [`signal`] makes the reports of all tips, [`send`] puts them on the line, [`listen`] takes
//! commands from it. The first one feeds the watchdog, while all report.

use crate::firmware::queues::{
    FRAMES, IDLE, LISTEN, OUTBOX, REFUSED, REMEMBER, REQUESTS, SEND, SENT, TASK_MONITOR, Waiting, alive,
    refuse,
};
use crate::firmware::retained;
use core::cell::RefCell;
use core::sync::atomic::Ordering;
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Ticker, with_timeout};
use fingertip::board::{self, Board, Clock, Line, Port, SerialRx, Watchdog};
use fingertip::device::hand::Hand;
use fingertip::device::logic::Beginning;
use fingertip::device::task_monitor::{CrashRecord, GOOD_RUN, Stage};
use fingertip::image::{NAME, NAMES, PERIOD, RANKS, SCANS, TIPS, TRANSDUCERS, Tips};
use fingertip::link::outbox::Outbox;
use fingertip::link::tips::read_request;
use fingertip::link::wire::{Deframer, Encoded};
use fingertip::signal::report::Report;
use fingertip::status::{Fault, LastFault, Status, Stored};
use fingertip::transducer::scan::Scan;

/// From one look at the tasks, and one feed of the watchdog, to the next, microseconds.
const LOOK: u64 = 16_000;

/// From one note for the next run to the next, microseconds.
const NOTES: u64 = 1_000_000;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // Before anything that can hang, so that every reset is counted.
    let reset_cause = board::begin();
    let start = CrashRecord::start(retained::read(), reset_cause, NAMES.hash);
    retained::write(&start.crash_record);
    let board = Board::take(start.give_up);
    retained::enter(Stage::Transducer);
    let number = |text: &str| text.parse().unwrap_or(u8::MAX);
    let beginning = Beginning {
        reset_cause,
        start,
        stored: Stored::None,
        stored_sequence: 0,
        calibration: None,
        clock_failed: !board.crystal,
        firmware: [
            number(env!("CARGO_PKG_VERSION_MAJOR")),
            number(env!("CARGO_PKG_VERSION_MINOR")),
            number(env!("CARGO_PKG_VERSION_PATCH")),
        ],
    };
    defmt::info!(
        "fingertip {=str}, hand {=str} ({=u64:016x}), reset by {=str}",
        env!("CARGO_PKG_VERSION"),
        NAME,
        NAMES.hash,
        reset_cause.word()
    );
    let clock = board.clock;
    let waiting = OUTBOX.init_with(|| Waiting {
        frames: RefCell::new(Outbox::new(FRAMES.take().each_mut())),
        more: Signal::new(),
    });
    spawner.spawn(send(board.line, waiting, SENT.take()).expect("spawned once"));
    spawner.spawn(listen(board.serial_rx, clock).expect("spawned once"));
    signal(clock, board.port, waiting, board.watchdog, &beginning).await
}

/// Turns samples into reports, and answers commands. Period: [`PERIOD`]. Deadline: the next one; when late, samples are lost, which is
/// reported and counted. Feeds the watchdog as long as the other tasks report too. Without a converter it measures nothing and
/// reports so at the same pace.
async fn signal(
    clock: Clock,
    port: Option<Port>,
    waiting: &'static Waiting,
    mut watchdog: Watchdog,
    beginning: &Beginning,
) -> ! {
    let mut tips = Tips::new(beginning);
    let mut hand = Hand::new(NAMES, &mut tips.each());
    let mut crash_record = CrashRecord {
        detail: Stage::Running as u32,
        ..beginning.start.crash_record
    };
    let mut log = Log::default();
    let mut pace = Ticker::every(Duration::from_micros(u64::from(PERIOD)));
    let mut scan = port.map(|port| Scan::<_, TIPS, RANKS, SCANS>::new(TRANSDUCERS, port));
    let (mut last_sample, mut next_look, mut next_note) = (None, 0, 0);
    loop {
        let samples = if let Some(scan) = &mut scan {
            scan.next().await
        } else {
            pace.next().await;
            [Err(Fault::ResetLoop); TIPS]
        };
        let now = clock.now();
        if now.0 >= next_look && waiting.frames.borrow().is_empty() {
            // All that was put there before was taken.
            alive(SEND, clock);
        }
        if let Some(sample) = samples.iter().find_map(|sample| sample.ok()) {
            let measured = now.0.saturating_sub(u64::from(sample.age));
            let lost = missing(last_sample.replace(measured), measured);
            for tip in tips.each() {
                let counters = tip.counters();
                counters.samples_lost = counters.samples_lost.saturating_add(lost);
            }
        }
        let reports = hand.step(&mut tips.each(), now, &samples, |frame| waiting.put_frame(frame));
        log.reports(&reports);
        if let Ok(asked) = REQUESTS.try_receive()
            && !hand.request(&mut tips.each(), now, asked, |frame| waiting.put_frame(frame))
        {
            refuse();
        }
        if now.0 < next_look {
            continue;
        }
        next_look = now.0.saturating_add(LOOK);
        // Nothing is stored.
        alive(REMEMBER, clock);
        for tip in tips.each() {
            let counters = tip.counters();
            counters.frames_dropped = waiting.frames.borrow().dropped();
            counters.commands_refused = REFUSED.load(Ordering::Relaxed);
        }
        match TASK_MONITOR.lock(|task_monitor| task_monitor.borrow().late(now)) {
            None => watchdog.pet(),
            Some(task) => retained::record_fault(LastFault::Late, task as u32),
        }
        if now.0 >= next_note {
            next_note = now.0.saturating_add(NOTES);
            crash_record.good = now.0 >= GOOD_RUN;
            retained::write(&crash_record);
        }
    }
}

/// Samples missing between the last one and the one measured at this time.
fn missing(last: Option<u64>, measured: u64) -> u32 {
    last.map_or(0, |last| {
        let passed = u32::try_from(measured.saturating_sub(last)).unwrap_or(u32::MAX);
        // Rounded, because the time of a block is known to a conversion or two.
        (passed.saturating_add(PERIOD / 2) / PERIOD).saturating_sub(1)
    })
}

/// Sends frames. Period: as they come. Deadline: a period on average (a report takes 0.5 ms on the line); when late,
/// the queue drops its oldest, and the signal task is none the later for it.
#[embassy_executor::task]
async fn send(mut line: Line, waiting: &'static Waiting, mut frame: &'static mut Encoded) {
    loop {
        waiting.more.wait().await;
        while waiting.frames.borrow_mut().take(&mut frame) {
            // The line has no receiver that could refuse; a failed transfer shows as a gap in the sequence.
            let _ = line.write(frame.as_slice()).await;
        }
    }
}

/// Takes commands. Period: as they come. Deadline: the ring of bytes is full, 2.8 ms of a line that never pauses; when
/// late, bytes are lost, which is counted. Work is bounded by the rate of the line, and other tasks run in between.
#[embassy_executor::task]
async fn listen(mut serial_rx: SerialRx, clock: Clock) {
    let mut deframer = Deframer::default();
    let mut bytes = [0; 32];
    loop {
        alive(LISTEN, clock);
        let received = match with_timeout(IDLE, serial_rx.read(&mut bytes)).await {
            Ok(Ok(length)) => bytes.get(..length).unwrap_or(&[]),
            Ok(Err(_lost)) => {
                refuse();
                &[]
            }
            Err(_idle) => continue,
        };
        for &byte in received {
            let Some(body) = deframer.push(byte) else {
                continue;
            };
            let taken = body.and_then(|body| read_request(&body));
            if !taken.is_ok_and(|asked| REQUESTS.try_send(asked).is_ok()) {
                refuse();
            }
        }
        embassy_futures::yield_now().await;
    }
}

/// What goes to the debugger: every change of a tip's status.
struct Log([Option<Status>; TIPS]);

impl Default for Log {
    fn default() -> Self {
        Self([None; TIPS])
    }
}

impl Log {
    fn reports(&mut self, reports: &[Report; TIPS]) {
        for ((report, last), name) in reports.iter().zip(&mut self.0).zip(NAMES.tips) {
            let status = report.status();
            if *last == Some(status) {
                continue;
            }
            *last = Some(status);
            let time = report.time.0;
            match status {
                Status::Ok => defmt::info!("{=u64} us: {=str}: ok", time, name),
                Status::Fault(fault) => {
                    defmt::info!("{=u64} us: {=str}: fault: {=str}", time, name, fault.reason());
                }
                Status::Warning(warnings) => {
                    for reason in warnings.reasons() {
                        defmt::info!("{=u64} us: {=str}: warning: {=str}", time, name, reason);
                    }
                }
            }
        }
    }
}
