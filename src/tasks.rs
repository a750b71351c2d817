//! The two tasks of the firmware: [`signal`] makes reports, [`send`] puts them on the line.

use crate::board::{Board, Clock, Converter, Line, Watchdog};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::channel::{Channel, TrySendError};
use embassy_time::{Duration, with_timeout};
use fingertip::calibration::Calibration;
use fingertip::counts::{self, BLOCK_LENGTH, CountSum, PERIOD, Window};
use fingertip::design::Design;
use fingertip::image::ImageDesign;
use fingertip::pipeline::Pipeline;
use fingertip::report::{Fault, Microseconds, Report, Status, Warnings};
use fingertip::tare::StartUp;
use fingertip::telemetry::{self, Frame, Hello, Message, ResetCause};
use fingertip::transducer::ratiometric::Conversion;
use panic_probe as _;

/// From one hello to the next, microseconds.
const HELLO_PERIOD: u64 = 1_000_000;

/// Every how many reports one goes to the log.
const LOGGED: u32 = 250;

/// A converter that gives nothing for this long has stalled.
const STALLED: Duration = Duration::from_micros(2 * PERIOD as u64);

/// Frames waiting for the line: 8 ms of reports. When full the oldest goes, and is counted.
static QUEUE: Channel<ThreadModeRawMutex, Frame, 8> = Channel::new();

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = Board::take();
    spawner.spawn(send(board.line).expect("spawned once"));
    signal(board.clock, board.converter, board.watchdog, board.reset_cause).await
}

/// Turns blocks into reports. Period: one block, 1 ms. Deadline: the next block; when late, samples are lost, which is
/// reported and counted. Feeds the watchdog with every block that became a report, so that neither a hang here
/// nor a dead converter goes on for ever.
async fn signal(
    clock: Clock,
    mut converter: Converter,
    mut watchdog: Watchdog,
    reset_cause: ResetCause,
) -> ! {
    let start_up = StartUp::after(reset_cause, None);
    let mut pipeline = Pipeline::<ImageDesign>::new(start_up, Calibration::default(), Warnings::NONE);
    let mut publisher = Publisher::new(reset_cause);
    let mut log = Log::default();
    let mut codes = [0; BLOCK_LENGTH];
    loop {
        let (block_end, block) = match with_timeout(STALLED, converter.block(&mut codes)).await {
            Ok(Ok(block_end)) => {
                watchdog.pet();
                publisher.count_lost(block_end);
                let window = const { Window::of(&ImageDesign::CONSTANTS.transducer.kind) };
                (block_end, counts::sum(&codes, window))
            }
            Ok(Err(_overrun)) => (clock.now(), Err(Fault::SamplesLost)),
            Err(_timeout) => (clock.now(), Err(Fault::ConverterStalled)),
        };
        let report = report_of(&mut pipeline, block_end, block);
        log.report(&report);
        publisher.report(block_end, report);
    }
}

/// From averaged counts to both results.
// A boundary that stays in the image, so that its instructions can be counted.
#[inline(never)]
fn report_of(
    pipeline: &mut Pipeline<ImageDesign>,
    now: Microseconds,
    block: Result<CountSum, Fault>,
) -> Report {
    let conversion = const { Conversion::of(&ImageDesign::CONSTANTS.transducer) };
    pipeline.step(now, block.map(|sum| conversion.sample(sum, 0)))
}

/// Numbers the frames and queues them.
struct Publisher {
    sequence: u16,
    next_hello: u64,
    last_block: Option<Microseconds>,
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
            last_block: None,
            hello,
        }
    }

    /// Counts the blocks missing between the last one and this.
    fn count_lost(&mut self, block_end: Microseconds) {
        if let Some(last) = self.last_block.replace(block_end) {
            let passed = u32::try_from(block_end.0.saturating_sub(last.0)).unwrap_or(u32::MAX);
            // Rounded, because the end of a block is known to a conversion or two.
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
