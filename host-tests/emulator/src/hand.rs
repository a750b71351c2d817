//! The image of a hand on the board: several plants on the converter's channels, and what came over the serial wire.

use crate::bench::{
    BenchError, CallCounter, Moment, emulator, gaps, seconds, stack_depth, stack_of, starts_the_clock,
};
use crate::board::Nucleo;
use crate::image::Image;
use crate::multiplexer::BusCommand;
use crate::plant::Plant;
use crate::record::instant;
use crate::transducer::{ElectricalOutput, EmulatedTransducer};
use fingertip::link::band::BandMessage;
use fingertip::link::load::LoadReply;
use fingertip::link::telemetry::{Answer, Hello};
use fingertip::link::tips::{AnyDecoder, AnyFrame, TipHello, TipsMessage};
use fingertip::link::wire::DecodeError;
use fingertip::signal::report::Report;
use rigless::emulator::{Access, AccessKind, Driver, Host, Settled, Start, Stop, Watch};
use rigless::session::Session;
use rigless::time::VirtualNanos;
use std::ops::Range;

/// How often what came over the wire is taken, virtual nanoseconds.
const LISTEN: u64 = 1_000_000;
/// Control register 2 of ADC1, and the bit in it that starts it (RM0090 13.13.3).
const CONVERTER_CONTROL: u64 = 0x4001_2008;
const START: u64 = 1 << 30;
/// A tip's conversion, and that of the internal reference, nanoseconds: 40 and 68 cycles of 4 MHz.
const CONVERSION: u64 = 10_000;
const REFERENCE: u64 = 17_000;
/// The internal reference as a share of the supply: 1.21 V of 3.3 V.
const REFERENCE_SHARE: f64 = 1.21 / 3.3;
/// ADC1's channels that a hand's channels 0 to 5 are.
const CHANNELS: [u8; 6] = [3, 10, 13, 9, 12, 5];

/// A hand and what happens to it.
#[derive(Clone, Debug)]
pub struct EmulatedHand {
    /// The plants, on the hand's channels from 0 on or on its bus.
    pub tips: Vec<Plant>,
    /// The places of their parts on the bus; empty: they are on the channels.
    pub places: Vec<BusPlace>,
    /// While these seconds of virtual time pass, the part of this tip holds the data line of its branch; `None`: no
    /// part does.
    pub held: Option<(usize, Range<f64>)>,
    /// While these seconds of virtual time pass, each code lies in its neighbour's place.
    pub shifted: Range<f64>,
    /// Bytes that the host sends, each at its time, seconds, ascending.
    pub sent: Vec<(f64, Vec<u8>)>,
}

/// Where the part of a tip is on the bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusPlace {
    /// Its seven-bit address.
    pub address: u8,
    /// The multiplexer's address and the branch that it is behind; `None`: it is on the bus itself.
    pub branch: Option<[u8; 2]>,
}

/// The reports of one instant.
#[derive(Clone, Debug)]
pub struct HandInstant {
    /// That instant, seconds since power-on.
    pub time: f64,
    /// When the last byte of the frame had come, seconds.
    pub came: f64,
    /// `k` of the unit of pressures.
    pub pressure_fraction_bits: u8,
    /// The reports, in the order of the tips.
    pub reports: Vec<Report>,
}

/// What a run of a hand leaves behind.
#[derive(Clone, Debug, Default)]
pub struct HandRun {
    /// The frames of readings, in order.
    pub instants: Vec<HandInstant>,
    /// The board's greetings, with the number of its tips.
    pub boards: Vec<(Hello, u8)>,
    /// The tips' greetings.
    pub greetings: Vec<TipHello>,
    /// Answers, with their tips.
    pub answers: Vec<(u8, Answer)>,
    /// Bands of the tips that are not told what they touch, with the number of the tip.
    pub bands: Vec<(u8, BandMessage)>,
    /// Answers to commands that load a tip, with their tips.
    pub loads: Vec<(u8, LoadReply)>,
    /// What did not read as a frame.
    pub broken: Vec<DecodeError>,
    /// Frames that the sequence numbers say are missing.
    pub lost: u64,
    /// Frames of version 2.
    pub of_version_2: usize,
    /// Virtual time, seconds.
    pub time: f64,
    /// Instructions retired.
    pub instructions: u64,
    /// Bytes of the stack that were used since the last reset; `None` before the end.
    pub stack: Option<u64>,
    /// The instructions of each call of the last function asked for, with those of the others before it.
    pub calls: Vec<u64>,
    /// The commands to the parts on the bus.
    pub commands: Vec<BusCommand>,
    /// How often two parts on the bus answered at once.
    pub clashes: usize,
    /// Transactions on the bus.
    pub transactions: usize,
    /// What the image asked of the part that the emulator does not model, in words.
    pub gaps: Vec<String>,
}

/// Runs the image of a hand from power-on until `duration` (seconds) has passed; counts the instructions of the functions in
/// `counted` as [`crate::bench::run`] does.
///
/// # Errors
/// [`BenchError`] when the image lacks `counted`, or the emulator cannot run it.
///
/// # Panics
/// For a hand of no tip.
pub fn run(
    image: &Image,
    hand: EmulatedHand,
    duration: f64,
    counted: &[(&str, &str)],
) -> Result<HandRun, BenchError> {
    let counter = CallCounter::of(image, counted)?;
    let elf = rigless::image::Image::new(image.path(), image.bytes().to_vec(), None).map_err(emulator)?;
    let board = if hand.places.is_empty() {
        Nucleo::new(&hand.tips[0].transducer())
    } else {
        let parts = hand.tips.iter().zip(&hand.places).map(|(plant, place)| {
            let transducer = plant.transducer();
            let part = transducer.part.at(place.address);
            (EmulatedTransducer { part, ..transducer }, place.branch)
        });
        Nucleo::with_bus(&parts.collect::<Vec<_>>())
    };
    let board = Box::new(board.map_err(emulator)?);
    let mut session = Session::new(board, 0, VirtualNanos(LISTEN)).map_err(emulator)?;
    for address in counter.addresses() {
        session.watch(Watch::Instruction(address));
    }
    let driver = HandBench {
        sent: 0,
        hand,
        counter,
        bytes: vec![],
        commands: vec![],
        scanning_since: None,
        clock_zero: None,
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
    let driver = finished.driver;
    let mut finished_session = finished.session;
    let mut run = HandRun {
        time,
        instructions,
        stack: driver.stack,
        gaps: gaps(&finished_session),
        ..read(&driver.bytes, driver.clock_zero.unwrap_or_default())
    };
    run.calls = driver.counter.into_calls();
    run.commands = driver.commands;
    if let Some(trunk) = finished_session.board_mut().trunk() {
        run.clashes = trunk.clashes();
        run.transactions = trunk.transactions();
    }
    Ok(run)
}

/// The frames in bytes, each with the time at which it came; the image's clock read zero at another.
fn read(bytes: &[(f64, u8)], clock_zero: f64) -> HandRun {
    let mut run = HandRun::default();
    let mut decoder = AnyDecoder::default();
    let mut last: Option<u16> = None;
    for &(came, byte) in bytes {
        let frame = match decoder.push(byte) {
            None => continue,
            Some(Err(error)) => {
                run.broken.push(error);
                continue;
            }
            Some(Ok(AnyFrame::One(_))) => {
                run.of_version_2 += 1;
                continue;
            }
            Some(Ok(AnyFrame::Tips(frame))) => frame,
        };
        if let Some(before) = last.replace(frame.sequence) {
            run.lost += u64::from(frame.sequence.wrapping_sub(before).wrapping_sub(1));
        }
        match frame.message {
            TipsMessage::Readings {
                time,
                pressure_fraction_bits,
                reports,
            } => run.instants.push(HandInstant {
                time: instant(
                    time.0 as f64 * 1e-6,
                    Moment {
                        time: came,
                        clock_zero,
                    },
                ),
                came,
                pressure_fraction_bits,
                reports: reports.to_vec(),
            }),
            TipsMessage::Board { hello, tips } => run.boards.push((hello, tips)),
            TipsMessage::Tip(hello) => run.greetings.push(hello),
            TipsMessage::Answer { tip, answer } => run.answers.push((tip, answer)),
            TipsMessage::Band { tip, band } => run.bands.push((tip, band)),
            TipsMessage::Load { tip, reply } => run.loads.push((tip, reply)),
        }
    }
    run
}

/// What the emulator calls as it goes.
struct HandBench {
    hand: EmulatedHand,
    /// Of the bytes to be sent.
    sent: usize,
    counter: CallCounter,
    bytes: Vec<(f64, u8)>,
    commands: Vec<BusCommand>,
    /// When the converter was started last, nanoseconds.
    scanning_since: Option<u64>,
    clock_zero: Option<f64>,
    stack_range: Range<u64>,
    stack: Option<u64>,
    end: VirtualNanos,
}

impl HandBench {
    /// The rank whose conversion is under way; that after the tips is the internal reference's.
    fn rank(&self, at: u64) -> usize {
        let tips = self.hand.tips.len() as u64;
        let scan = tips * CONVERSION + REFERENCE;
        let since = self.scanning_since.map_or(0, |start| at.saturating_sub(start));
        ((since % scan) / CONVERSION).min(tips) as usize
    }

    /// The voltage that the conversion under way takes, with noise of its own.
    ///
    /// The emulated converter takes its inputs in whole units and its internal reference as 1210 of them. The reference of the
    /// conversions is therefore another one while that is converted: only the ratio counts.
    fn convert(&mut self, board: &mut Nucleo, at: u64) {
        let rank = self.rank(at);
        let time = at as f64 * 1e-9;
        let tips = self.hand.tips.len();
        let source = if self.hand.shifted.contains(&time) {
            (rank + 1) % (tips + 1)
        } else {
            rank
        };
        let share = match self.hand.tips.get_mut(source).map(|plant| plant.output(time)) {
            Some(ElectricalOutput::Share(share, _)) => share,
            Some(ElectricalOutput::Pressure(..)) => 0.0,
            None => REFERENCE_SHARE,
        };
        match CHANNELS.get(rank).filter(|_| rank < tips) {
            Some(&channel) => board.set_share(channel, share),
            None => board.set_internal_reference(share),
        }
    }

    /// The pressures on the parts on the bus, with noise of their own, and what is wrong with their wires.
    fn press(&mut self, board: &mut Nucleo, at: u64) {
        let time = at as f64 * 1e-9;
        for (tip, plant) in self.hand.tips.iter_mut().enumerate() {
            if let ElectricalOutput::Pressure(pascals, wiring) = plant.output(time)
                && let Some(trunk) = board.trunk()
            {
                trunk.set(tip, pascals, wiring);
            }
        }
    }

    /// Whether a branch of the bus is held, after an access of the image.
    fn hold(&self, board: &mut Nucleo, at: VirtualNanos) {
        let time = seconds(at);
        let held = self.hand.held.as_ref().filter(|(_, when)| when.contains(&time));
        board.hold(at, held.map(|(tip, _)| *tip));
    }

    fn note(&mut self, access: Access) {
        if access.kind != AccessKind::Write {
            return;
        }
        if access.address == CONVERTER_CONTROL && access.value & START != 0 {
            self.scanning_since = Some(access.virtual_time.0);
        }
        if starts_the_clock(&access) && self.clock_zero.is_none() {
            self.clock_zero = Some(seconds(access.virtual_time));
        }
    }
}

impl Driver<Nucleo> for HandBench {
    fn on_settled(&mut self, session: &mut Session<Nucleo>, _host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Stop(stop) if !self.hand.places.is_empty() => {
                self.press(session.board_mut(), stop.at.0);
                self.hold(session.board_mut(), stop.at);
            }
            Settled::Stop(stop) => self.convert(session.board_mut(), stop.at.0),
            Settled::Access { access, .. } => {
                self.note(access);
                if !self.hand.places.is_empty() {
                    self.hold(session.board_mut(), access.virtual_time);
                    return;
                }
                if access.address == CONVERTER_CONTROL {
                    self.convert(session.board_mut(), access.virtual_time.0);
                }
            }
            Settled::Hit(hit) => self.counter.hit(hit),
            _ => {}
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Nucleo>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        let taken = session.board_mut().take_bytes();
        self.bytes
            .extend(taken.into_iter().map(|(at, byte)| (seconds(at), byte)));
        self.commands.extend(session.board_mut().take_commands());
        while let Some((at, bytes)) = self.hand.sent.get(self.sent)
            && *at <= seconds(stop.at)
        {
            session.board_mut().send(bytes);
            self.sent += 1;
        }
        if stop.at >= self.end {
            self.stack = stack_depth(&self.stack_range, host);
            return None;
        }
        Some(VirtualNanos(stop.at.0 + LISTEN))
    }
}
