//! A DPS310 on the board's bus, as the emulator's authors model it, and what can happen to it there.

use crate::transducer::Wiring;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rigless::chip::Timeline;
use rigless::chip::dps310::{Dps310, Sdo};
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// Registers of the part.
const MEAS_CFG: u8 = 0x08;
const RESET: u8 = 0x0C;
const SOFT_RESET: u8 = 0x09;
/// Both ready flags of `MEAS_CFG`.
const READY: u8 = 0x30;
/// A delayed part shows its flags at the third look.
const LOOKS: u8 = 2;
/// An intermittent bus does not acknowledge one start in this many.
const ONE_IN: u64 = 7;

/// The part behind its wires.
#[derive(Debug)]
pub(crate) struct Sensor {
    chip: Dps310,
    address: u8,
    wiring: Wiring,
    /// The part is to be reset at the next start.
    resets: bool,
    /// The next byte written names the register.
    names: bool,
    register: u8,
    /// Looks at the flags that will find none.
    hidden: u8,
    starts: u64,
    garbage: ChaCha8Rng,
}

impl Sensor {
    /// The part at an address, powered up.
    pub(crate) fn new(address: u8) -> Self {
        let sdo = if address == Sdo::Low.address() {
            Sdo::Low
        } else {
            Sdo::High
        };
        Self {
            chip: Dps310::new(sdo),
            address,
            wiring: Wiring::Sound,
            resets: false,
            names: false,
            register: 0,
            hidden: 0,
            starts: 0,
            garbage: ChaCha8Rng::seed_from_u64(0),
        }
    }

    /// The pressure on the part, pascals absolute, and what is wrong with its wires. A stuck part feels nothing.
    pub(crate) fn set(&mut self, pascals: f64, wiring: Wiring) {
        if wiring != Wiring::Stuck {
            self.chip.set_pressure(pascals.round().max(0.0) as u32);
        }
        self.resets |= wiring == Wiring::Reset && self.wiring != Wiring::Reset;
        self.wiring = wiring;
    }

    fn reset(&mut self, context: &mut Timeline<'_, '_>) {
        self.chip.start(self.address, false, context);
        self.chip.write(RESET, context);
        self.chip.write(SOFT_RESET, context);
        self.chip.stop(context);
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
            _ => true,
        };
        heard && self.chip.start(address, read, context)
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
        self.chip.write(byte, context)
    }

    fn read(&mut self, last: bool, context: &mut Timeline<'_, '_>) -> u8 {
        let register = self.register;
        self.register = register.wrapping_add(1);
        let byte = self.chip.read(last, context);
        match self.wiring {
            Wiring::Garbage => self.garbage.next_u32() as u8,
            // A line that nobody drives.
            Wiring::Wrong => 0xFF,
            Wiring::Slow if register == MEAS_CFG => byte & !READY,
            Wiring::Delayed if register == MEAS_CFG && self.hidden > 0 => {
                self.hidden -= 1;
                byte & !READY
            }
            _ => byte,
        }
    }

    fn stop(&mut self, context: &mut Timeline<'_, '_>) {
        self.chip.stop(context);
    }
}
