//! The tasks of a hand's firmware: [`signal`] makes the reports of all tips, [`send`] puts them on the line, [`listen`] takes
//! commands from it. The first one feeds the watchdog, while all report.

use crate::firmware::line::{listen, send};
use crate::firmware::queues::{self, REFUSED, REMEMBER, REQUESTS, SEND, SENT, Waiting, alive, refuse};
use crate::firmware::retained;
use crate::firmware::watch::{self, NOTES, WATCHDOG_PERIOD, missing, version};
use core::sync::atomic::Ordering;
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_time::{Duration, Ticker};
use fingertip::board::{self, Board, Clock, Port, Watchdog};
use fingertip::device::hand::Hand;
use fingertip::device::logic::Beginning;
use fingertip::device::task_monitor::{CrashRecord, GOOD_RUN, Stage};
use fingertip::image::{NAME, NAMES, PERIOD, RANKS, SCANS, TIPS, TRANSDUCERS, Tips};
use fingertip::signal::report::Report;
use fingertip::status::{Fault, Status, Stored};
use fingertip::transducer::scan::Scan;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // Before anything that can hang, so that every reset is counted.
    let reset_cause = board::begin();
    let start = CrashRecord::start(retained::read(), reset_cause, NAMES.hash);
    retained::write(&start.crash_record);
    let board = Board::take(start.give_up);
    retained::enter(Stage::Transducer);
    let beginning = Beginning {
        reset_cause,
        start,
        stored: Stored::None,
        stored_sequence: 0,
        calibration: None,
        clock_failed: !board.crystal,
        firmware: version(),
    };
    defmt::info!(
        "fingertip {=str}, hand {=str} ({=u64:016x}), reset by {=str}",
        env!("CARGO_PKG_VERSION"),
        NAME,
        NAMES.hash,
        reset_cause.word()
    );
    let clock = board.clock;
    let waiting = queues::outbox();
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
    let (mut last_sample, mut next_feed, mut next_note) = (None, 0, 0);
    loop {
        let samples = if let Some(scan) = &mut scan {
            scan.next().await
        } else {
            pace.next().await;
            [Err(Fault::ResetLoop); TIPS]
        };
        let now = clock.now();
        if now.0 >= next_feed && waiting.frames.borrow().is_empty() {
            // All that was put there before was taken.
            alive(SEND, clock);
        }
        if let Some(sample) = samples.iter().find_map(|sample| sample.ok()) {
            let measured = now.0.saturating_sub(u64::from(sample.age));
            let lost = missing(last_sample.replace(measured), measured, PERIOD);
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
        if now.0 < next_feed {
            continue;
        }
        next_feed = now.0.saturating_add(WATCHDOG_PERIOD);
        // Nothing is stored.
        alive(REMEMBER, clock);
        for tip in tips.each() {
            let counters = tip.counters();
            counters.frames_dropped = waiting.frames.borrow().dropped();
            counters.commands_refused = REFUSED.load(Ordering::Relaxed);
        }
        watch::feed(&mut watchdog, now);
        if now.0 >= next_note {
            next_note = now.0.saturating_add(NOTES);
            crash_record.good = now.0 >= GOOD_RUN;
            retained::write(&crash_record);
        }
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
