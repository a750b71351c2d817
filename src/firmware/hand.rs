//! The tasks of a hand's firmware: [`signal`] makes the reports of all tips, [`send`] sends them, [`listen`] receives commands,
//! [`remember`] stores the calibrations. `signal` feeds the watchdog as long as all tasks report.

#[cfg(feature = "load-tip")]
use crate::firmware::hand_tips;
use crate::firmware::line::{listen, send};
use crate::firmware::queues::{
    self, REFUSED, REQUESTS, SEND, SENT, STORED, TO_STORE, Waiting, alive, refuse,
};
#[cfg(not(feature = "load-tip"))]
use crate::firmware::queues::{IDLE, REMEMBER};
use crate::firmware::retained;
use crate::firmware::samples::{self, Samples};
use crate::firmware::watch::{self, NOTES, WATCHDOG_PERIOD, missing, version};
use core::sync::atomic::Ordering;
use defmt_rtt as _;
use embassy_executor::Spawner;
#[cfg(not(feature = "load-tip"))]
use embassy_time::with_timeout;
use embassy_time::{Duration, Ticker};
use fingertip::board::{self, Board, Clock, SLOT, Watchdog};
use fingertip::device::hand::Hand;
use fingertip::device::kept_zeros::ZeroWords;
use fingertip::device::logic::Beginning;
use fingertip::device::task_monitor::{CrashRecord, GOOD_RUN, Stage, Start};
use fingertip::image::{EVERY, HandStart, NAME, NAMES, PERIOD, TIPS, Tips};
use fingertip::signal::report::Report;
use fingertip::status::{Fault, Status, Stored};
use fingertip::storage::hand_store::{HandStore, StoredTip};
#[cfg(not(feature = "load-tip"))]
use fingertip::{
    board::FlashMemory,
    device::logic::ToStore,
    image::{IDENTITIES, RECORD},
    storage::log::StoreError,
};

/// After too many resets in a row, the flash is not read.
const NOT_READ: StoredTip = StoredTip {
    state: Stored::Unreadable,
    number: 0,
    calibration: None,
};

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // This comes before anything that can hang, so that every reset is counted.
    let reset_cause = board::begin();
    let start = CrashRecord::start(retained::begin(), reset_cause, NAMES.hash);
    retained::write(&start.crash_record);
    let kept = retained::read_zeros().zeros(NAMES.hash);
    #[cfg(not(feature = "load-tip"))]
    let board = Board::take(start.give_up, reset_cause);
    #[cfg(not(feature = "load-tip"))]
    let identities = IDENTITIES;
    #[cfg(feature = "load-tip")]
    let mut board = Board::take(start.give_up, reset_cause);
    #[cfg(feature = "load-tip")]
    let (found, loader) = hand_tips::start(&mut board.memory, start.give_up).await;
    #[cfg(feature = "load-tip")]
    let identities = found.identities;
    let firmware = version();
    let mut store = (!start.give_up).then(|| HandStore::new(board.memory, SLOT, identities, firmware));
    if let Some(store) = &mut store {
        retained::enter(Stage::Store);
        store.load().await;
    }
    retained::enter(Stage::Transducer);
    let mut tip = 0;
    let beginnings = kept.map(|kept| {
        let stored = store.as_ref().map_or(NOT_READ, |store| store.stored(tip));
        #[cfg(feature = "load-tip")]
        let stored = found.complete(tip, stored);
        tip += 1;
        Beginning {
            reset_cause,
            start: Start { kept, ..start },
            stored: stored.state,
            stored_sequence: stored.number,
            calibration: stored.calibration,
            clock_failed: !board.crystal,
            firmware,
        }
    });
    defmt::info!(
        "fingertip {=str}, hand {=str} ({=u64:016x}), reset by {=str}, clock: {=str}",
        env!("CARGO_PKG_VERSION"),
        NAME,
        NAMES.hash,
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
    spawner.spawn(hand_tips::remember(store, loader, clock, waiting).expect("spawned once"));
    let start = HandStart {
        beginnings: &beginnings,
        #[cfg(feature = "load-tip")]
        loaded: &found.loaded,
    };
    let samples = match board.port {
        Some(port) => Some(samples::of(port, clock, spawner).await),
        None => None,
    };
    signal(clock, samples, waiting, board.watchdog, start).await
}

/// Turns samples into reports, and answers commands. Period: [`PERIOD`]. Deadline: the next sample; when late, samples are
/// lost, which is reported and counted. Feeds the watchdog as long as the other tasks report too. Without a converter or a bus
/// it measures nothing, and reports this at the same rate.
async fn signal(
    clock: Clock,
    mut source: Option<Samples>,
    waiting: &'static Waiting,
    mut watchdog: Watchdog,
    start: HandStart<'_>,
) -> ! {
    let mut tips = Tips::new(start);
    let mut hand = Hand::new(NAMES, &mut tips.each(), EVERY);
    let mut crash_record = CrashRecord {
        detail: Stage::Running as u32,
        ..start.beginnings[0].start.crash_record
    };
    let mut log = Log::default();
    let mut pace = Ticker::every(Duration::from_micros(u64::from(PERIOD)));
    let (mut last_sample, mut next_feed, mut next_note) = (None, 0, 0);
    loop {
        let samples = if let Some(source) = &mut source {
            source.next().await
        } else {
            pace.next().await;
            &[Err(Fault::ResetLoop); TIPS]
        };
        let now = clock.now();
        if now.0 >= next_feed && (waiting.frames.borrow().is_empty() || cfg!(feature = "rs485")) {
            // An empty queue shows that the send task works. On a shared line, frames wait for the host.
            alive(SEND, now);
        }
        if let Some(sample) = samples.iter().find_map(|sample| sample.ok()) {
            let measured = now.0.saturating_sub(u64::from(sample.age));
            let lost = missing(last_sample.replace(measured), measured, PERIOD);
            if lost > 0 {
                for tip in tips.each() {
                    let counters = tip.counters();
                    counters.samples_lost = counters.samples_lost.saturating_add(lost);
                }
            }
        }
        if hand.step(&mut tips.each(), now, samples, |frame| waiting.put_frame(frame)) {
            log.reports(hand.reports());
        }
        if let Ok(asked) = REQUESTS.try_receive()
            && !hand.request(
                &mut tips.each(),
                now,
                asked,
                |frame| waiting.put_frame(frame),
                // Cannot fail: each tip has at most one save under way.
                |tip, to_store| _ = TO_STORE.try_send((tip, to_store)),
            )
        {
            refuse();
        }
        if now.0 < next_feed {
            continue;
        }
        next_feed = now.0.saturating_add(WATCHDOG_PERIOD);
        while let Ok(stored) = STORED.try_receive() {
            hand.stored(&mut tips.each(), now, stored, |frame| waiting.put_frame(frame));
        }
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
            let zeros = tips.each().map(|tip| tip.zero());
            retained::write_zeros(ZeroWords::of(NAMES.hash, zeros));
        }
    }
}

/// Stores the calibrations, one tip at a time. Period: on request. Deadline: none; other tasks run meanwhile. Without a store
/// every save fails.
#[cfg(not(feature = "load-tip"))]
#[embassy_executor::task]
async fn remember(mut store: Option<HandStore<FlashMemory, TIPS, RECORD>>, clock: Clock) {
    loop {
        let now = clock.now();
        alive(REMEMBER, now);
        if let Ok((tip, ToStore(calibration))) = with_timeout(IDLE, TO_STORE.receive()).await {
            let (result, number) = match &mut store {
                Some(store) => {
                    let result = store.save(now, usize::from(tip), calibration).await;
                    (result, store.stored(usize::from(tip)).number)
                }
                None => (Err(StoreError::Failed), 0),
            };
            STORED.send((tip, result, number)).await;
        }
    }
}

/// Log for the debugger: every change of a tip's status.
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
