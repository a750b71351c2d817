//! A part on the board's bus, and what can happen to it there: a DPS310 as the emulator's authors model it, an ABP2 or an
//! MS5837-02BA by their datasheets.

use crate::abp2::Abp2Chip;
use crate::ms5837::{self, Ms5837Chip};
use crate::transducer::{EmulatedTransducer, Part, Wiring};
use model_tables::random::Random;
use rigless::chip::Timeline;
use rigless::chip::dps310::{Dps310, Sdo};
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

/// Registers of the DPS310; an SPL06 lacks the last one.
const MEAS_CFG: u8 = 0x08;
const RESET: u8 = 0x0C;
const COEF_SRCE: u8 = 0x28;
const SOFT_RESET: u8 = 0x09;
/// Both ready flags of `MEAS_CFG`.
const READY: u8 = 0x30;
/// A delayed DPS310 shows its flags at the third look.
const LOOKS: u8 = 2;
/// Any other part is late by this.
const LATE: VirtualNanos = VirtualNanos(500_000);
/// An intermittent bus does not acknowledge one start in this many.
const ONE_IN: u64 = 7;

/// The part itself.
#[derive(Debug)]
enum Chip {
    Dps310(Box<Dps310>),
    Abp2(Abp2Chip),
    Ms5837(Ms5837Chip),
}

/// The part behind its wires.
#[derive(Debug)]
pub(crate) struct Sensor {
    chip: Chip,
    address: u8,
    /// A register that it does not have: it reads as zeros.
    lacks: Option<u8>,
    wiring: Wiring,
    /// The part is to be reset at the next start.
    resets: bool,
    /// The next byte written names the register.
    names: bool,
    register: u8,
    /// Looks at the flags that will find none.
    hidden: u8,
    starts: u64,
    garbage: Random,
}

impl Sensor {
    /// The part of a transducer, powered up; nothing if it is on no bus.
    pub(crate) fn new(transducer: &EmulatedTransducer) -> Option<Self> {
        let (chip, address) = match transducer.part {
            Part::Analogue => return None,
            Part::Dps310(address) | Part::Spl06(address) => {
                let sdo = if address == Sdo::Low.address() {
                    Sdo::Low
                } else {
                    Sdo::High
                };
                (Chip::Dps310(Box::new(Dps310::new(sdo))), address)
            }
            Part::Abp2(address, counts) => {
                let part = Abp2Chip::new(counts.map(f64::from), transducer.range);
                (Chip::Abp2(part), address)
            }
            Part::Ms5837(address) => (Chip::Ms5837(Ms5837Chip::new(ms5837::TWO_BAR)), address),
            Part::Ms5837ThirtyBar(address) => (Chip::Ms5837(Ms5837Chip::new(ms5837::THIRTY_BAR)), address),
        };
        Some(Self {
            chip,
            address,
            lacks: matches!(transducer.part, Part::Spl06(_)).then_some(COEF_SRCE),
            wiring: Wiring::Sound,
            resets: false,
            names: false,
            register: 0,
            hidden: 0,
            starts: 0,
            garbage: Random(0),
        })
    }

    /// The pressure on the part, pascals, gauge or absolute as it measures, and what is wrong with its wires. A stuck part
    /// feels nothing.
    pub(crate) fn set(&mut self, pascals: f64, wiring: Wiring) {
        let late = match wiring {
            Wiring::Slow => None,
            Wiring::Delayed => Some(LATE),
            _ => Some(VirtualNanos(0)),
        };
        let feels = wiring != Wiring::Stuck;
        match &mut self.chip {
            Chip::Dps310(chip) if feels => chip.set_pressure(pascals.round().max(0.0) as u32),
            Chip::Dps310(_) => {}
            Chip::Abp2(chip) => {
                chip.late = late;
                if feels {
                    chip.pascals = pascals;
                }
            }
            Chip::Ms5837(chip) => {
                chip.late = late;
                if feels {
                    chip.pascals = pascals;
                }
            }
        }
        self.resets |= wiring == Wiring::Reset && self.wiring != Wiring::Reset;
        self.wiring = wiring;
    }

    fn reset(&mut self, context: &mut Timeline<'_, '_>) {
        match &mut self.chip {
            Chip::Dps310(chip) => {
                chip.start(self.address, false, context);
                chip.write(RESET, context);
                chip.write(SOFT_RESET, context);
                chip.stop(context);
            }
            Chip::Abp2(chip) => chip.reset(),
            Chip::Ms5837(chip) => chip.reset(),
        }
    }
}

// Runs start from reset: nothing of the board is ever saved.
impl Store for Sensor {}

impl Peer for Sensor {
    fn start(&mut self, address: u8, read: bool, context: &mut Timeline<'_, '_>) -> bool {
        if std::mem::take(&mut self.resets) {
            self.reset(context);
        }
        self.starts += 1;
        self.names = !read;
        let heard = match self.wiring {
            Wiring::Off => false,
            Wiring::Intermittent => !self.starts.is_multiple_of(ONE_IN),
            _ => address == self.address,
        };
        if !heard {
            return false;
        }
        match &mut self.chip {
            Chip::Dps310(chip) => return chip.start(address, read, context),
            Chip::Abp2(chip) => chip.start(read, context),
            Chip::Ms5837(chip) => chip.start(read, context),
        }
        true
    }

    fn write(&mut self, byte: u8, context: &mut Timeline<'_, '_>) -> bool {
        if std::mem::take(&mut self.names) {
            self.register = byte;
        } else {
            if self.register == MEAS_CFG {
                self.hidden = LOOKS;
            }
            self.register = self.register.wrapping_add(1);
        }
        match &mut self.chip {
            Chip::Dps310(chip) => return chip.write(byte, context),
            Chip::Abp2(chip) => chip.write(byte),
            Chip::Ms5837(chip) => chip.write(byte, context),
        }
        true
    }

    fn read(&mut self, last: bool, context: &mut Timeline<'_, '_>) -> u8 {
        let register = self.register;
        self.register = register.wrapping_add(1);
        let (byte, flags) = match &mut self.chip {
            Chip::Dps310(chip) => (chip.read(last, context), register == MEAS_CFG),
            Chip::Abp2(chip) => (chip.read(), false),
            Chip::Ms5837(chip) => (chip.read(), false),
        };
        let byte = if self.lacks == Some(register) { 0 } else { byte };
        match self.wiring {
            Wiring::Garbage => (self.garbage.bits() >> 56) as u8,
            // A line that nobody drives.
            Wiring::Wrong => 0xFF,
            Wiring::Slow if flags => byte & !READY,
            Wiring::Delayed if flags && self.hidden > 0 => {
                self.hidden -= 1;
                byte & !READY
            }
            _ => byte,
        }
    }

    fn stop(&mut self, context: &mut Timeline<'_, '_>) {
        match &mut self.chip {
            Chip::Dps310(chip) => chip.stop(context),
            Chip::Abp2(chip) => chip.stop(context),
            Chip::Ms5837(_) => {}
        }
    }
}
