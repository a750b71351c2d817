//! A board that takes a tip's data, on the host: the firmware's own frames, commands, loader, slots and signal path over a simulated
//! flash, in virtual time. Around them is what the tasks of the image do, and a line that is as bad as it is told.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::NorFlash;
use fingertip::device::logic::{Beginning, Device};
use fingertip::device::task_monitor::CrashRecord;
use fingertip::device::tip_loader::{FoundTip, LARGEST_BLOCK, TipLoader};
use fingertip::image::generated::{NAME, TABLES};
use fingertip::image::{FirmwareDesign, ImageDesign};
use fingertip::link::command;
use fingertip::link::load;
use fingertip::link::outbox::Outbox;
use fingertip::link::telemetry::Message;
use fingertip::link::wire::{Deframer, Encoded};
use fingertip::signal::design::Design as _;
use fingertip::signal::tip_design::TipDesign;
use fingertip::status::{ResetCause, Stored};
use fingertip::storage::tip_slots::TipSlots;
use fingertip::transducer::driver::Sample;
use fingertip::units::{Microseconds, Millipascals};
use model_tables::block::StoredCalibration;
use model_tables::block::write::TipData;
use model_tables::constants::DesignConstants;
use model_tables::random::Random;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Frames that wait for the line, as in the image.
const WAITING: usize = 8;

/// A tip of the image's tables with another hash, and with a gain: two that differ in both can be told apart.
pub fn tip(hash: u64, gain: i32) -> Vec<u8> {
    TipData {
        constants: DesignConstants {
            hash,
            ..ImageDesign::CONSTANTS
        },
        layout: TABLES.layout,
        words: TABLES.segments.as_flattened(),
        name: NAME,
        calibration: Some(StoredCalibration {
            zero: i32::MIN,
            temperature: i32::MIN,
            coefficient: 0,
            gain,
        }),
        relaxation: None,
        object: None,
        feedback: None,
    }
    .write()
}

/// The loader of a board with this transducer, its slots from the begin of a flash on.
pub const fn loader(slot: u32) -> TipLoader<1> {
    TipLoader::new([TipSlots::new(0, slot)], [ImageDesign::CONSTANTS.transducer])
}

/// The board.
#[derive(Debug)]
pub struct TipDevice<F> {
    flash: F,
    slot: u32,
    loader: TipLoader<1>,
    device: Device<TipDesign<'static, FirmwareDesign>>,
    deframer: Deframer,
    outbox: Outbox<'static, WAITING>,
    frame: &'static mut Encoded,
    /// Since its last reset.
    now: Microseconds,
    rest: Millipascals,
    buffer: Vec<u8>,
    /// Resets so far.
    pub restarts: u32,
}

impl<F: NorFlash> TipDevice<F> {
    /// A board that is switched on, with slots of `slot` bytes.
    ///
    /// # Panics
    /// Never: there are as many frames as it asks for.
    pub fn start(mut flash: F, slot: u32) -> Self {
        let mut loader = loader(slot);
        // A board has one for its whole life; a test has few.
        let block: &'static mut [u8] = Box::leak(vec![0; LARGEST_BLOCK].into_boxed_slice());
        let (design, calibration, stored) = match block_on(loader.start(0, &mut flash, block)) {
            FoundTip::Image => (TipDesign::Image(FirmwareDesign::start()), None, Stored::None),
            FoundTip::Loaded(design, calibration) => (TipDesign::Loaded(design), calibration, Stored::None),
            FoundTip::Refused => (TipDesign::Image(FirmwareDesign::start()), None, Stored::Damaged),
        };
        let constants = design.parameters().constants;
        let beginning = Beginning {
            reset_cause: ResetCause::PowerOn,
            start: CrashRecord::start(None, ResetCause::PowerOn, constants.hash),
            stored,
            stored_sequence: 0,
            calibration,
            clock_failed: false,
            firmware: [0, 1, 0],
        };
        let frames = Box::leak(vec![Encoded::NOTHING; WAITING + 1].into_boxed_slice());
        let (first, rest) = frames.split_first_mut().expect("one more than wait");
        let waiting: &'static mut [Encoded; WAITING] = rest.try_into().expect("as many as wait");
        Self {
            flash,
            slot,
            loader,
            device: Device::new(design, &beginning),
            deframer: Deframer::default(),
            outbox: Outbox::new(waiting.each_mut()),
            frame: first,
            now: Microseconds(0),
            rest: Millipascals(1000 * constants.rest_pressure),
            buffer: vec![0; LARGEST_BLOCK],
            restarts: 0,
        }
    }

    /// Bytes that came over the line since the last call, and the next report; gives the bytes of what it says.
    pub fn millisecond(&mut self, heard: &[u8]) -> Vec<u8> {
        self.now.0 += 1000;
        let outbox = &mut self.outbox;
        let mut say = |message: &Message| outbox.put(message);
        let sample = Sample {
            pressure: self.rest,
            headroom: Millipascals(1),
            age: 500,
            ..Sample::default()
        };
        self.device.step(self.now, Ok(sample), &mut say);
        for &byte in heard {
            let Some(Ok(body)) = self.deframer.push(byte) else {
                continue;
            };
            if let Ok(request) = load::read_body(&body) {
                let reply =
                    block_on(
                        self.loader
                            .request(self.now, &mut self.flash, (0, request), &mut self.buffer),
                    );
                say(&Message::Load(reply));
            } else if let Ok(request) = command::read_body(&body) {
                // Nothing is saved: the flash is the tip's alone.
                let _ = self.device.request(self.now, request, &mut say);
            }
        }
        let mut emitted = Vec::new();
        while self.outbox.take(&mut self.frame) {
            emitted.extend_from_slice(self.frame.as_slice());
        }
        emitted
    }

    /// The same board, reset if it asked for that.
    #[must_use]
    pub fn settled(self) -> Self {
        if self.loader.is_restarting() {
            self.reset()
        } else {
            self
        }
    }

    /// The same board, reset.
    #[must_use]
    pub fn reset(self) -> Self {
        let restarts = self.restarts + 1;
        Self {
            restarts,
            ..Self::start(self.flash, self.slot)
        }
    }
}

/// A line that loses, doubles and breaks frames, one in so many each; 0: never.
#[derive(Clone, Debug)]
pub struct BadLine {
    random: Random,
    one_in: u64,
}

impl BadLine {
    /// A line; `seed` decides which frames.
    pub fn new(seed: u64, one_in: u64) -> Self {
        Self {
            random: Random(seed),
            one_in,
        }
    }

    /// What comes out of it.
    pub fn carry(&mut self, bytes: &[u8]) -> Vec<u8> {
        if self.one_in == 0 {
            return bytes.to_vec();
        }
        let mut out = Vec::new();
        for frame in bytes.split_inclusive(|&byte| byte == 0) {
            match self.random.below(3 * self.one_in) {
                0 => {}
                1 => out.extend(frame.iter().chain(frame)),
                2 => {
                    let at = self.random.below(frame.len() as u64) as usize;
                    out.extend(frame);
                    let from = out.len() - frame.len();
                    out[from + at] ^= 1 << self.random.below(8);
                }
                _ => out.extend(frame),
            }
        }
        out
    }
}

/// A board that a socket can be put in front of.
pub trait Served: Send + 'static {
    /// Bytes that came over the line since the last call, and the next report; gives the bytes of what it says.
    fn millisecond(&mut self, heard: &[u8]) -> Vec<u8>;

    /// The same board, reset if it asked for that.
    #[must_use]
    fn settled(self) -> Self;

    /// The same board, reset.
    #[must_use]
    fn reset(self) -> Self;

    /// Resets so far.
    fn restarts(&self) -> u32;
}

impl<F: NorFlash + Send + 'static> Served for TipDevice<F> {
    fn millisecond(&mut self, heard: &[u8]) -> Vec<u8> {
        TipDevice::millisecond(self, heard)
    }

    fn settled(self) -> Self {
        TipDevice::settled(self)
    }

    fn reset(self) -> Self {
        TipDevice::reset(self)
    }

    fn restarts(&self) -> u32 {
        self.restarts
    }
}

/// A board behind a socket, in the pace of the clock on the wall.
#[derive(Debug)]
pub struct ServedDevice {
    /// `HOST:PORT`.
    pub address: String,
    events: Arc<Events>,
    thread: Option<JoinHandle<u32>>,
}

/// What a test does to it from outside.
#[derive(Debug, Default)]
struct Events {
    ended: AtomicBool,
    /// The connection is to be broken, or the board reset, once.
    cut: AtomicBool,
    reset: AtomicBool,
}

impl ServedDevice {
    /// Puts a board of one tip behind a free port of this host, with the two ways of its line, to it first.
    ///
    /// # Panics
    /// If there is no such port.
    pub fn start<F: NorFlash + Send + 'static>(flash: F, slot: u32, lines: [BadLine; 2]) -> Self {
        Self::serve(move || TipDevice::start(flash, slot), lines)
    }

    /// The same of any board, which is switched on there.
    ///
    /// # Panics
    /// If there is no such port.
    pub fn serve<D: Served>(
        start: impl FnOnce() -> D + Send + 'static,
        [mut to, mut from]: [BadLine; 2],
    ) -> Self {
        let socket = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = socket.local_addr().expect("bound").to_string();
        socket.set_nonblocking(true).expect("it is a socket");
        let events = Arc::new(Events::default());
        let told = Arc::clone(&events);
        let thread = std::thread::spawn(move || {
            let mut device = start();
            let mut client: Option<TcpStream> = None;
            let mut buffer = [0; 4096];
            let mut heard = Vec::new();
            while !told.ended.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
                if told.cut.swap(false, Ordering::Relaxed) {
                    client = None;
                }
                if told.reset.swap(false, Ordering::Relaxed) {
                    device = device.reset();
                }
                if client.is_none() {
                    client = socket.accept().ok().map(|(stream, _)| stream);
                    if let Some(stream) = &client {
                        stream.set_nonblocking(true).expect("it is a socket");
                    }
                }
                let mut lost = false;
                if let Some(stream) = &mut client {
                    match stream.read(&mut buffer) {
                        Ok(0) => lost = true,
                        Ok(count) => heard.extend(to.carry(&buffer[..count])),
                        Err(error) => lost = error.kind() != ErrorKind::WouldBlock,
                    }
                }
                let emitted = from.carry(&device.millisecond(&std::mem::take(&mut heard)));
                if let Some(stream) = &mut client {
                    lost |= stream.write_all(&emitted).is_err();
                }
                if lost {
                    client = None;
                }
                device = device.settled();
            }
            device.restarts()
        });
        Self {
            address,
            events,
            thread: Some(thread),
        }
    }

    /// Breaks the connection.
    pub fn cut(&self) {
        self.events.cut.store(true, Ordering::Relaxed);
    }

    /// Resets the board.
    pub fn reset(&self) {
        self.events.reset.store(true, Ordering::Relaxed);
    }

    /// Switches it off; how often it was reset.
    ///
    /// # Panics
    /// If the board did.
    pub fn end(mut self) -> u32 {
        self.events.ended.store(true, Ordering::Relaxed);
        let thread = self.thread.take().expect("it was not ended before");
        thread.join().expect("the board did not panic")
    }
}
