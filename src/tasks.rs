//! The two tasks of the firmware: [`signal`] makes reports, [`send`] puts them on the line.

use crate::board::{Board, Clock, Line, Watchdog};
use crate::chosen::{self, Pace};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::channel::{Channel, TrySendError};
use embassy_time::Delay;
use fingertip::calibration::Calibration;
use fingertip::design::Design;
use fingertip::image::ImageDesign;
use fingertip::pipeline::Pipeline;
use fingertip::report::{Microseconds, Report, Status, Warnings};
use fingertip::tare::StartUp;
use fingertip::telemetry::{self, Frame, Hello, Message, ResetCause};
use fingertip::transducer::Transducer;
use fingertip::transducer::keeper::Keeper;
use panic_probe as _;

/// From one hello to the next, microseconds.
const HELLO_PERIOD: u64 = 1_000_000;

/// Every how many reports one goes to the log.
const LOGGED: u32 = 250;

/// From one report to the next, microseconds.
const PERIOD: u32 = Pipeline::<ImageDesign>::PERIOD;

/// Frames waiting for the line: 8 ms of reports. When full the oldest goes, and is counted.
static QUEUE: Channel<ThreadModeRawMutex, Frame, 8> = Channel::new();

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = Board::take();
    if !board.crystal {
        defmt::warn!("the crystal does not run: times are 1 % off");
    }
    spawner.spawn(send(board.line).expect("spawned once"));
    let standing = Warnings::CLOCK.when(!board.crystal);
    let transducer = chosen::transducer(board.port);
    signal(
        board.clock,
        transducer,
        board.watchdog,
        board.reset_cause,
        standing,
    )
    .await
}

/// Turns samples into reports. Period: one sample, 1 ms of a converter. Deadline: the next one; when late, samples are
/// lost, which is reported and counted. Feeds the watchdog with every sample or the reason why there is none, so that
/// a hang here does not go on for ever.
async fn signal(
    clock: Clock,
    transducer: impl Transducer,
    mut watchdog: Watchdog,
    reset_cause: ResetCause,
    standing: Warnings,
) -> ! {
    let start_up = StartUp::after(reset_cause, None);
    let mut pipeline = Pipeline::<ImageDesign>::new(start_up, Calibration::default(), standing);
    let mut publisher = Publisher::new(reset_cause);
    let mut log = Log::default();
    let mut keeper = Keeper::new(transducer, Delay);
    let mut pace = Pace::new();
    loop {
        pace.wait().await;
        let sample = keeper.next().await;
        let now = clock.now();
        watchdog.pet();
        if let Ok(sample) = sample {
            publisher.count_lost(Microseconds(now.0.saturating_sub(u64::from(sample.age))));
        }
        let report = pipeline.step(now, sample);
        log.report(&report);
        publisher.report(now, report);
    }
}

/// Numbers the frames and queues them.
struct Publisher {
    sequence: u16,
    next_hello: u64,
    last_sample: Option<Microseconds>,
    hello: Hello,
}

impl Publisher {
    fn new(reset_cause: ResetCause) -> Self {
        let number = |text: &str| text.parse().unwrap_or(u8::MAX);
        let hello = Hello {
            firmware: [
                number(env!("CARGO_PKG_VERSION_MAJOR")),
                number(env!("CARGO_PKG_VERSION_MINOR")),
                number(env!("CARGO_PKG_VERSION_PATCH")),
            ],
            reset_cause,
            design_hash: ImageDesign::CONSTANTS.hash,
            table_version: ImageDesign::CONSTANTS.table_version,
            report_period: PERIOD,
            ..Hello::default()
        };
        defmt::info!(
            "fingertip {=str}, design {=str} ({=u64:016x}), reset by {}",
            env!("CARGO_PKG_VERSION"),
            ImageDesign::CONSTANTS.name,
            hello.design_hash,
            defmt::Display2Format(&reset_cause)
        );
        Self {
            sequence: 0,
            next_hello: 0,
            last_sample: None,
            hello,
        }
    }

    /// Counts the samples missing between the last one and the one measured at this time.
    fn count_lost(&mut self, measured: Microseconds) {
        if let Some(last) = self.last_sample.replace(measured) {
            let passed = u32::try_from(measured.0.saturating_sub(last.0)).unwrap_or(u32::MAX);
            // Rounded, because the time of a block is known to a conversion or two.
            let missing = (passed.saturating_add(PERIOD / 2) / PERIOD).saturating_sub(1);
            self.hello.samples_lost = self.hello.samples_lost.saturating_add(missing);
        }
    }

    fn report(&mut self, now: Microseconds, report: Report) {
        if now.0 >= self.next_hello {
            self.next_hello = now.0.saturating_add(HELLO_PERIOD);
            self.hello.time = now;
            self.publish(Message::Hello(self.hello));
        }
        self.publish(Message::Report {
            report,
            pressure_fraction_bits: ImageDesign::PRESSURE_FRACTION_BITS as u8,
        });
    }

    fn publish(&mut self, message: Message) {
        let frame = Frame {
            sequence: self.sequence,
            dropped: self.hello.frames_dropped as u16,
            message,
        };
        self.sequence = self.sequence.wrapping_add(1);
        if let Err(TrySendError::Full(frame)) = QUEUE.try_send(frame) {
            let _oldest = QUEUE.try_receive();
            let _ = QUEUE.try_send(frame);
            self.hello.frames_dropped = self.hello.frames_dropped.saturating_add(1);
        }
    }
}

/// Sends frames. Period: as they come. Deadline: a period on average (a report takes 0.5 ms on the line); when late,
/// the queue drops its oldest, and the signal task is none the later for it.
#[embassy_executor::task]
async fn send(mut line: Line) {
    loop {
        let frame = QUEUE.receive().await;
        let encoded = telemetry::encode(&frame);
        // The line has no receiver that could refuse; a failed transfer shows as a gap in the sequence.
        let _ = line.write(encoded.as_slice()).await;
    }
}

/// What goes to the debugger: every change of status, and one report in [`LOGGED`].
#[derive(Default)]
struct Log {
    reports: u32,
    status: Option<Status>,
}

impl Log {
    fn report(&mut self, report: &Report) {
        let status = report.status();
        if self.status != Some(status) {
            self.status = Some(status);
            defmt::info!("{=u64} us: {}", report.time.0, defmt::Display2Format(&status));
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
                measurement.pressure_rise.0 >> ImageDesign::PRESSURE_FRACTION_BITS,
                measurement.force.0,
                measurement.indentation.0
            );
        }
    }
}
