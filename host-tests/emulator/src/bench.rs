//! The image running on the board, with the plant on its pin and a listener on its serial wire.

use crate::board::Nucleo;
use crate::image::{Image, ImageError};
use crate::plant::Plant;
use crate::scenario::Happening;
use fingertip::link::command::{self, Request};
use rigless::emulator::{Access, AccessKind, Driver, Hit, Host, Settled, Start, Stop, Watch};
use rigless::session::{Reset, Session};
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::{ControlFlow, Range};

/// How often the listener gets what came over the wire, virtual nanoseconds.
const LISTEN: u64 = 1_000_000;

/// The control registers of the timers that may keep the image's time, TIM2 to TIM5 (RM0090 table 1), and the
/// bit in them that starts the counter.
const TIMER_CONTROL: [u64; 4] = [0x4000_0000, 0x4000_0400, 0x4000_0800, 0x4000_0c00];
const COUNTER_ENABLE: u64 = 1;

/// What the image fills its unused stack with.
const PAINT: u64 = 0xCCCC_CCCC;

/// Hears what comes over the serial wire.
pub trait Listener: Send + 'static {
    /// One byte came; the run ends when this breaks.
    fn hear(&mut self, byte: u8, moment: Moment, plant: &Plant) -> ControlFlow<()>;

    /// Bytes for the board, asked for every millisecond; `time` is virtual, seconds since power-on.
    fn say(&mut self, _time: f64) -> Vec<u8> {
        Vec::new()
    }
}

/// When a byte came, in seconds of virtual time since power-on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// The end of its stop bit, seconds of emulated time.
    pub time: f64,
    /// When the image's own clock read zero, since the last reset, seconds of emulated time.
    pub clock_zero: f64,
}

/// Addresses, each with the instructions retired whenever the core arrived there.
pub type Arrivals = BTreeMap<u64, Vec<u64>>;

/// What a run leaves behind.
#[derive(Debug)]
pub struct RunOutcome<L> {
    /// The listener with what it kept.
    pub listener: L,
    /// Virtual time, seconds.
    pub time: f64,
    /// Instructions retired.
    pub instructions: u64,
    /// The instructions of each report, in order: of one call of each function asked for, from its first to the one
    /// that returns, those of interrupts taken meanwhile included.
    pub calls: Vec<u64>,
    /// When the core arrived at each address watched.
    pub arrivals: Arrivals,
    /// Resets after power-on, in words.
    pub resets: Vec<String>,
    /// Bytes of the stack that were used since the last reset; `None` if the listener ended the run.
    pub stack: Option<u64>,
    /// What the image asked of the part that the emulator does not model, in words. Empty, or the run proves
    /// less than it seems to.
    pub gaps: Vec<String>,
}

/// Why there was no run, or why it ended early.
#[derive(Debug)]
pub enum BenchError {
    /// Something is missing in the image.
    Image(ImageError),
    /// The emulator refused.
    Emulator(String),
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Emulator(error) => write!(f, "the emulated board stopped: {error}"),
        }
    }
}

impl std::error::Error for BenchError {}

impl From<ImageError> for BenchError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

/// Runs `image` from power-on until `duration` (seconds) has passed or the listener breaks; counts the
/// instructions of the functions in `counted`, by owner and name (see [`Image::function`]), up to each return of the
/// last.
///
/// # Errors
/// [`BenchError`] when the image lacks `counted`, or the emulator cannot run it.
pub fn run<L: Listener>(
    image: &Image,
    plant: Plant,
    duration: f64,
    counted: &[(&str, &str)],
    listener: L,
) -> Result<RunOutcome<L>, BenchError> {
    run_watching(image, plant, duration, counted, &[], listener)
}

/// The same, and notes when the core arrives at each address in `watched`.
///
/// # Errors
/// As [`run`].
pub fn run_watching<L: Listener>(
    image: &Image,
    plant: Plant,
    duration: f64,
    counted: &[(&str, &str)],
    watched: &[u64],
    listener: L,
) -> Result<RunOutcome<L>, BenchError> {
    let counter = CallCounter::of(image, counted)?;
    let elf = rigless::image::Image::new(image.path(), image.bytes().to_vec(), None).map_err(emulator)?;
    let board = Box::new(Nucleo::new(&plant.transducer()).map_err(emulator)?);
    let mut session = Session::new(board, 0, VirtualNanos(LISTEN)).map_err(emulator)?;
    let mut addresses: Vec<u64> = counter.addresses().chain(watched.iter().copied()).collect();
    addresses.sort_unstable();
    addresses.dedup();
    for address in addresses {
        session.watch(Watch::Instruction(address));
    }
    let driver = Bench {
        plant,
        listener,
        counter,
        arrivals: watched.iter().map(|&address| (address, Vec::new())).collect(),
        clock_zero: None,
        resets: 0,
        last_stop: 0.0,
        stack_range: stack_of(image)?,
        stack: None,
        end: VirtualNanos((duration * 1e9) as u64),
    };
    let mut images = vec![elf];
    for (address, bytes) in image.beside() {
        let beside = rigless::image::Image::new(image.path(), bytes.clone(), Some(*address));
        images.push(beside.map_err(emulator)?);
    }
    let finished = rigless::emulator::run(session, &Start::new(&images), driver).map_err(emulator)?;
    let (time, instructions) = finished
        .stop
        .map_or((0.0, 0), |stop| (seconds(stop.at), stop.instruction_count));
    Ok(RunOutcome {
        stack: finished.driver.stack,
        listener: finished.driver.listener,
        time,
        instructions,
        calls: finished.driver.counter.calls,
        arrivals: finished.driver.arrivals,
        resets: finished.session.resets().iter().map(describe).collect(),
        gaps: gaps(&finished.session),
    })
}

/// Where the stack of an image is: it grows from the end of this to the start.
pub(crate) fn stack_of(image: &Image) -> Result<Range<u64>, ImageError> {
    Ok(image.symbol("_stack_end")?..image.symbol("_stack_start")?)
}

/// Bytes of it that were used; `None` if it cannot be read.
pub(crate) fn stack_depth(stack: &Range<u64>, host: &mut dyn Host) -> Option<u64> {
    for address in stack.clone().step_by(4) {
        if host.read(address, Width::W32).ok()? != PAINT {
            return Some(stack.end - address);
        }
    }
    Some(0)
}

pub(crate) fn emulator(error: impl fmt::Display) -> BenchError {
    BenchError::Emulator(error.to_string())
}

pub(crate) fn seconds(at: VirtualNanos) -> f64 {
    at.0 as f64 * 1e-9
}

fn describe(reset: &Reset) -> String {
    format!("{:?} at {:.3} ms", reset.cause, seconds(reset.at) * 1e3)
}

/// Everything the emulator answered without a model behind it.
pub(crate) fn gaps(session: &Session<Nucleo>) -> Vec<String> {
    let unmapped = session.unmapped().into_iter().map(|gap| gap.to_string());
    let refused = session
        .refused()
        .iter()
        .map(|(address, fault)| format!("refused {address:#010x}: {fault:?}"));
    let unimplemented = session
        .unimplemented()
        .iter()
        .map(|(address, gap)| format!("unimplemented {address:#010x}: {gap:?}"));
    let told = session
        .told()
        .map(|told| format!("{} {}: {}", told.instance, told.register, told.reason));
    unmapped.chain(refused).chain(unimplemented).chain(told).collect()
}

/// What the emulator calls as it goes.
struct Bench<L> {
    plant: Plant,
    listener: L,
    counter: CallCounter,
    arrivals: Arrivals,
    clock_zero: Option<f64>,
    resets: usize,
    /// Milliseconds.
    last_stop: f64,
    stack_range: Range<u64>,
    stack: Option<u64>,
    end: VirtualNanos,
}

impl<L> Bench<L> {
    /// Everything that the scenario has for the time since the last stop.
    fn happen(&mut self, session: &mut Session<Nucleo>, stop: Stop, host: &mut dyn Host) {
        let now = seconds(stop.at) * 1e3;
        let since = std::mem::replace(&mut self.last_stop, now);
        for (number, event) in self.plant.scenario().event.iter().enumerate() {
            let begins = (since..now).contains(&event.at_ms);
            let ends = event.at_ms + event.for_ms.unwrap_or(0.0);
            let over = (since..now).contains(&ends);
            match event.is {
                Happening::Hang if begins => host.hold(true),
                Happening::Hang if over => host.hold(false),
                Happening::PinReset if begins => {
                    session.reset_by_pin(stop.at, stop.instruction_count, host);
                }
                // More than the line carries in a millisecond, a different byte each, some of them zero.
                Happening::Flood if since >= event.at_ms && since < ends => {
                    let bytes: Vec<u8> = (0..100_u64)
                        .map(|i| ((i + stop.at.0 / 1000).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 58) as u8)
                        .collect();
                    session.board_mut().send(&bytes);
                }
                _ => {
                    if let Some(command) = event.command().filter(|_| begins) {
                        let sequence = number as u16;
                        session
                            .board_mut()
                            .send(&command::encode(&Request { sequence, command }));
                    }
                }
            }
        }
    }

    /// The first timer that is started after a reset keeps the time.
    fn note_clock(&mut self, access: Access) {
        if starts_the_clock(&access) && self.clock_zero.is_none() {
            self.clock_zero = Some(seconds(access.virtual_time));
        }
    }
}

impl<L: Listener> Driver<Nucleo> for Bench<L> {
    /// Every conversion ends in a stop, so the voltage that the next one takes is set anew here, with noise of
    /// its own.
    fn on_settled(&mut self, session: &mut Session<Nucleo>, _host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Stop(stop) => {
                if session.resets().len() > self.resets {
                    self.resets = session.resets().len();
                    self.clock_zero = None;
                }
                let output = self.plant.output(seconds(stop.at));
                session.board_mut().set_transducer(output);
            }
            Settled::Access { access, .. } => self.note_clock(access),
            Settled::Hit(hit) => {
                if let Some(arrivals) = self.arrivals.get_mut(&hit.address) {
                    arrivals.push(hit.instruction_count);
                }
                self.counter.hit(hit);
            }
            _ => {}
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Nucleo>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        self.happen(session, stop, host);
        for (at, byte) in session.board_mut().take_bytes() {
            let moment = Moment {
                time: seconds(at),
                clock_zero: self.clock_zero.unwrap_or_default(),
            };
            if self.listener.hear(byte, moment, &self.plant).is_break() {
                return None;
            }
        }
        let words = self.listener.say(seconds(stop.at));
        if !words.is_empty() {
            session.board_mut().send(&words);
        }
        if stop.at >= self.end {
            self.stack = stack_depth(&self.stack_range, host);
            return None;
        }
        Some(VirtualNanos(stop.at.0 + LISTEN))
    }
}

/// Whether it starts a timer that may keep the image's time.
pub(crate) fn starts_the_clock(access: &Access) -> bool {
    access.kind == AccessKind::Write
        && TIMER_CONTROL.contains(&access.address)
        && access.value & COUNTER_ENABLE != 0
}

/// A function: where it begins and where its callers go on.
struct Counted {
    entry: u64,
    returns: Vec<u64>,
}

/// Counts instructions between functions' entries and returns.
pub(crate) struct CallCounter {
    counted: Vec<Counted>,
    /// Which function was entered last, and when.
    entered: Option<(usize, u64)>,
    /// Since the last return of the last function.
    sum: u64,
    calls: Vec<u64>,
}

impl CallCounter {
    /// Of these functions, by owner and name.
    pub(crate) fn of(image: &Image, counted: &[(&str, &str)]) -> Result<Self, ImageError> {
        let counted = counted
            .iter()
            .map(|(owner, name)| -> Result<Counted, ImageError> {
                let entry = image.function(owner, name)?;
                let returns = image.returns_of(entry)?;
                Ok(Counted { entry, returns })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            counted,
            entered: None,
            sum: 0,
            calls: vec![],
        })
    }

    /// What was counted.
    pub(crate) fn into_calls(self) -> Vec<u64> {
        self.calls
    }

    pub(crate) fn addresses(&self) -> impl Iterator<Item = u64> {
        self.counted
            .iter()
            .flat_map(|function| std::iter::once(function.entry).chain(function.returns.iter().copied()))
    }

    pub(crate) fn hit(&mut self, hit: Hit) {
        if let Some(function) = self
            .counted
            .iter()
            .position(|function| function.entry == hit.address)
        {
            self.entered = Some((function, hit.instruction_count));
        } else if let Some((function, entered)) = self.entered
            && self.counted[function].returns.contains(&hit.address)
        {
            self.entered = None;
            self.sum += hit.instruction_count - entered;
            if function + 1 == self.counted.len() {
                self.calls.push(std::mem::take(&mut self.sum));
            }
        }
    }
}
