//! The bus of a hand: its parts, on the bus itself or on the branches of TCA9548A multiplexers (Texas Instruments, SCPS207).

use crate::sensor::Sensor;
use crate::transducer::{EmulatedTransducer, Wiring};
use rigless::chip::Timeline;
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// The first of the eight addresses that a multiplexer can have.
const FIRST: u8 = 0x70;

/// A part and the multiplexer's address and branch that it is behind.
#[derive(Debug)]
struct Placed {
    sensor: Sensor,
    branch: Option<[u8; 2]>,
}

/// Who was addressed.
#[derive(Clone, Copy, Debug)]
enum Addressed {
    Part(usize),
    Multiplexer(usize),
}

/// A command that was written to a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusCommand {
    /// The end of it, seconds of virtual time.
    pub time: f64,
    /// The tip.
    pub tip: usize,
}

/// Everything on the wires of the board's bus.
#[derive(Debug)]
pub(crate) struct BusTrunk {
    parts: Vec<Placed>,
    /// The multiplexers that there are, their registers, and what was written and takes effect at the stop.
    multiplexers: [Option<u8>; 8],
    written: Option<(usize, u8)>,
    addressed: Option<Addressed>,
    /// Bytes were written, and none read, since the bus was free.
    commands: bool,
    sent: Vec<BusCommand>,
    /// How often two parts answered at once.
    clashes: usize,
    /// Transactions that somebody acknowledged, and starts that nobody did.
    transactions: usize,
}

impl BusTrunk {
    /// Parts, each with the multiplexer's address and the branch that it is behind.
    ///
    /// # Panics
    /// For an analogue transducer.
    pub(crate) fn new(parts: &[(EmulatedTransducer, Option<[u8; 2]>)]) -> Self {
        let mut multiplexers = [None; 8];
        for [multiplexer, _] in parts.iter().filter_map(|(_, branch)| *branch) {
            multiplexers[usize::from(multiplexer - FIRST)] = Some(0);
        }
        let parts = parts.iter().map(|(transducer, branch)| Placed {
            sensor: Sensor::new(transducer).expect("a part on a bus"),
            branch: *branch,
        });
        Self {
            parts: parts.collect(),
            multiplexers,
            written: None,
            addressed: None,
            commands: false,
            sent: vec![],
            clashes: 0,
            transactions: 0,
        }
    }

    /// The pressure on the part of a tip, pascals, and what is wrong with its wires.
    pub(crate) fn set(&mut self, tip: usize, pascals: f64, wiring: Wiring) {
        self.parts[tip].sensor.set(pascals, wiring);
    }

    /// Whether the part of a tip is connected to the bus now.
    pub(crate) fn is_connected(&self, tip: usize) -> bool {
        self.parts[tip].branch.is_none_or(|[multiplexer, branch]| {
            let register = self.multiplexers[usize::from(multiplexer - FIRST)];
            register.unwrap_or(0) & 1 << branch != 0
        })
    }

    /// The pin RESET of all multiplexers is low.
    pub(crate) fn reset(&mut self) {
        for register in self.multiplexers.iter_mut().flatten() {
            *register = 0;
        }
    }

    /// The commands since the last call.
    pub(crate) fn take_commands(&mut self) -> Vec<BusCommand> {
        std::mem::take(&mut self.sent)
    }

    /// Transactions that somebody acknowledged, and starts that nobody did.
    pub(crate) const fn transactions(&self) -> usize {
        self.transactions
    }

    /// How often two parts answered at once.
    pub(crate) const fn clashes(&self) -> usize {
        self.clashes
    }
}

// Runs start from reset: nothing of the board is ever saved.
impl Store for BusTrunk {}

impl Peer for BusTrunk {
    fn start(&mut self, address: u8, read: bool, context: &mut Timeline<'_, '_>) -> bool {
        self.addressed = None;
        self.commands = !read;
        let which = usize::from(address.wrapping_sub(FIRST));
        if self.multiplexers.get(which).copied().flatten().is_some() {
            self.addressed = Some(Addressed::Multiplexer(which));
            return true;
        }
        for tip in 0..self.parts.len() {
            if self.is_connected(tip) && self.parts[tip].sensor.start(address, read, context) {
                self.clashes += usize::from(self.addressed.is_some());
                self.addressed = Some(Addressed::Part(tip));
            }
        }
        self.transactions += usize::from(self.addressed.is_none());
        self.addressed.is_some()
    }

    fn write(&mut self, byte: u8, context: &mut Timeline<'_, '_>) -> bool {
        match self.addressed {
            Some(Addressed::Part(tip)) => self.parts[tip].sensor.write(byte, context),
            Some(Addressed::Multiplexer(which)) => {
                self.written = Some((which, byte));
                true
            }
            None => false,
        }
    }

    fn read(&mut self, last: bool, context: &mut Timeline<'_, '_>) -> u8 {
        match self.addressed {
            Some(Addressed::Part(tip)) => self.parts[tip].sensor.read(last, context),
            Some(Addressed::Multiplexer(which)) => self.multiplexers[which].unwrap_or(0),
            None => 0xFF,
        }
    }

    fn stop(&mut self, context: &mut Timeline<'_, '_>) {
        self.transactions += 1;
        if let Some((which, byte)) = self.written.take() {
            self.multiplexers[which] = Some(byte);
        }
        if let Some(Addressed::Part(tip)) = self.addressed.take() {
            self.parts[tip].sensor.stop(context);
            if self.commands {
                let time = context.now().0 as f64 * 1e-9;
                self.sent.push(BusCommand { time, tip });
            }
        }
    }
}
