//! The NUCLEO-F429ZI as the image sees it: the microcontroller, its clock, its converter's pins or the part on its
//! bus, its serial wire to the host.

use crate::multiplexer::{BusCommand, BusTrunk};
use crate::sensor::Sensor;
use crate::transducer::{ElectricalOutput, EmulatedTransducer, Part};
use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::cpu::armv7m::windows;
use rigless::device::Level;
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::Error;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::peripherals::SERIAL_PORTS;
use rigless::soc::stm32f427::peripherals::adc::Channel;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::time::VirtualNanos;
use std::collections::VecDeque;
use std::num::{NonZeroU32, NonZeroU64};

/// Name of the board and of its one target.
const NAME: &str = "nucleo-f429zi";
/// The ST-LINK's clock output on the crystal's pins, hertz (UM1974 section 6.8.1).
const CRYSTAL: u64 = 8_000_000;
/// No 32 kHz crystal is needed.
const NO_CRYSTAL: u64 = 0;
/// Supply, millivolts.
const SUPPLY: u32 = 3300;
/// Core clock, hertz. The emulated core retires one instruction in each of its cycles: a Cortex-M4 needs
/// 1.2 to 1.5, so the image has a little less time here than on the part only where it waits for nothing.
const CORE_CLOCK: u64 = 128_000_000;

/// The converter's reference in the unit of its inputs. The emulated converter takes whole millivolts, 1.24 of
/// its codes, and answers `input * 4095 / reference`: only the ratio counts, so both are given in microvolts.
/// (Its internal channels are in millivolts; the image reads none of them.)
const REFERENCE_MICROVOLTS: u32 = SUPPLY * 1000;
/// Half a code. The emulated converter truncates, where the part's first transition is at half a code (DS9405,
/// offset error): without it every reading would be half a code low.
const HALF_CODE_MICROVOLTS: f64 = REFERENCE_MICROVOLTS as f64 / 4095.0 / 2.0;

/// The transducer's pin: A0 of the Arduino header, PA3, channel 3 of ADC1.
const TRANSDUCER_CONVERTER: usize = 0;
const TRANSDUCER_CHANNEL: u8 = 3;
/// Its supply's: A1, PC0.
const SUPPLY_CHANNEL: u8 = 10;
/// The bus of D14 and D15: I2C1, and the one part on it.
const BUS: usize = 0;
const ON_THE_BUS: usize = 0;
/// Its lines, PB8 and PB9, and RESET of a hand's multiplexers, PF13: each port's number and its pin.
const CLOCK_LINE: (usize, u8) = (1, 8);
const DATA_LINE: (usize, u8) = (1, 9);
const MULTIPLEXER_RESET: (usize, u8) = (5, 13);
/// The serial port that the ST-LINK carries to the host.
const HOST_PORT: &str = "USART3";

/// The board.
#[derive(Debug)]
pub(crate) struct Nucleo {
    mcu: Stm32f427,
    transducer: Channel,
    supply: Channel,
    host_port: usize,
}

impl Nucleo {
    /// The board as it is powered on, with a transducer, and a host on its serial wire.
    pub(crate) fn new(transducer: &EmulatedTransducer) -> Result<Self, Error> {
        let mut mcu = Stm32f427::new()?;
        mcu.rcc.attach_crystals(CRYSTAL, NO_CRYSTAL);
        mcu.set_supply(SUPPLY);
        for converter in &mut mcu.adc {
            converter.set_reference(REFERENCE_MICROVOLTS);
        }
        if let Some(sensor) = Sensor::new(transducer) {
            mcu.i2c[BUS].attach(sensor);
        }
        let host_port = SERIAL_PORTS
            .iter()
            .position(|port| port.instance == HOST_PORT)
            .expect("the part has this port");
        mcu.usart[host_port].attach(HostWire::default());
        Ok(Self {
            mcu,
            transducer: Channel::new(TRANSDUCER_CHANNEL).expect("a pin's channel"),
            supply: Channel::new(SUPPLY_CHANNEL).expect("a pin's channel"),
            host_port,
        })
    }

    /// The board with parts on its bus in place of one transducer, each with the multiplexer's address and the branch that it is behind;
    /// the lines have their pull-ups.
    pub(crate) fn with_bus(parts: &[(EmulatedTransducer, Option<[u8; 2]>)]) -> Result<Self, Error> {
        let analogue = EmulatedTransducer {
            part: Part::Analogue,
            ..parts[0].0
        };
        let mut board = Self::new(&analogue)?;
        board.mcu.i2c[BUS].attach(BusTrunk::new(parts));
        for line in [CLOCK_LINE, DATA_LINE, MULTIPLEXER_RESET] {
            board.drive(VirtualNanos(0), line, Level::High);
        }
        Ok(board)
    }

    fn drive(&mut self, at: VirtualNanos, (port, pin): (usize, u8), level: Level) {
        let pin = Pin::new(pin).expect("a port has sixteen pins");
        self.mcu.drive_port(at, port, |port, registers, context| {
            port.drive(pin, Some(level), registers, context);
        });
    }

    /// Everything on the bus of a hand.
    pub(crate) fn trunk(&mut self) -> Option<&mut BusTrunk> {
        self.mcu.i2c[BUS].chip_mut::<BusTrunk>(ON_THE_BUS)
    }

    /// The commands to the parts of a hand since the last call.
    pub(crate) fn take_commands(&mut self) -> Vec<BusCommand> {
        self.trunk().map(BusTrunk::take_commands).unwrap_or_default()
    }

    /// The image may have pulled RESET; the data line of the branch of this tip is held low from now on, if of any.
    pub(crate) fn hold(&mut self, at: VirtualNanos, tip: Option<usize>) {
        let (port, pin) = MULTIPLEXER_RESET;
        let pin = Pin::new(pin).expect("a port has sixteen pins");
        let (gpio, registers) = self.mcu.port(port);
        let resets = gpio.level(pin, registers) == Level::Low;
        let Some(trunk) = self.trunk() else { return };
        if resets {
            trunk.reset();
        }
        let held = tip.is_some_and(|tip| trunk.is_connected(tip));
        self.drive(at, DATA_LINE, if held { Level::Low } else { Level::High });
    }

    /// What the transducer does from now on.
    pub(crate) fn set_transducer(&mut self, output: ElectricalOutput) {
        match output {
            ElectricalOutput::Share(output, supply) => {
                for (channel, share) in [(self.transducer, output), (self.supply, supply)] {
                    let microvolts = share * f64::from(REFERENCE_MICROVOLTS) + HALF_CODE_MICROVOLTS;
                    self.mcu.adc[TRANSDUCER_CONVERTER].set_input(channel, microvolts as u32);
                }
            }
            ElectricalOutput::Pressure(pascals, wiring) => {
                if let Some(sensor) = self.mcu.i2c[BUS].chip_mut::<Sensor>(ON_THE_BUS) {
                    sensor.set(pascals, wiring);
                }
            }
        }
    }

    /// The output on one of ADC1's channels from now on, a share of the reference.
    pub(crate) fn set_share(&mut self, channel: u8, share: f64) {
        let microvolts = share * f64::from(REFERENCE_MICROVOLTS) + HALF_CODE_MICROVOLTS;
        let converter = &mut self.mcu.adc[TRANSDUCER_CONVERTER];
        converter.set_reference(REFERENCE_MICROVOLTS);
        converter.set_input(Channel::new(channel).expect("a pin's channel"), microvolts as u32);
    }

    /// The internal reference from now on, a share of the converter's: the emulated one is 1210 units, whatever a unit is.
    pub(crate) fn set_internal_reference(&mut self, share: f64) {
        const INTERNAL: f64 = 1210.0;
        let reference = (INTERNAL / share.max(1e-3)).round();
        self.mcu.adc[TRANSDUCER_CONVERTER].set_reference(reference as u32);
    }

    /// Has the host send bytes, behind those that are under way.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        if let Some(wire) = self.mcu.usart[self.host_port].chip_mut::<HostWire>() {
            wire.to_send.extend(bytes);
        }
    }

    /// The bytes that have come over the serial wire since the last call, each with the end of its stop bit.
    pub(crate) fn take_bytes(&mut self) -> Vec<(VirtualNanos, u8)> {
        self.mcu.usart[self.host_port]
            .chip_mut::<HostWire>()
            .map(|wire| std::mem::take(&mut wire.bytes))
            .unwrap_or_default()
    }
}

// Runs start from reset: nothing of the board is ever saved.
impl Store for Nucleo {}

impl Board for Nucleo {
    fn name(&self) -> &'static str {
        NAME
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![NAME]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.mcu)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let clock = NonZeroU64::new(CORE_CLOCK).expect("a running clock");
        let lines = u32::from(self.mcu.cpu().interrupt_lines);
        let core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz: clock,
            interrupt_lines: NonZeroU32::new(lines).expect("the part has interrupts"),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("eight"),
            instructions_per_second: clock,
            boot: "flash",
        };
        let windows = windows(self.mcu.bus());
        let spec = core.spec_with_parts(&windows, armv7m::Fpu::FpV4Sp, armv7m::MpuRegions::Eight);
        vec![Target::new(NAME, &mut self.mcu, spec)]
    }
}

/// The host's end of the serial wire: it listens, and sends what it is given.
#[derive(Debug, Default)]
struct HostWire {
    bytes: Vec<(VirtualNanos, u8)>,
    to_send: VecDeque<u8>,
}

impl Store for HostWire {}

impl Peer for HostWire {
    fn receive(&mut self, word: u16, context: &mut Timeline<'_, '_>) {
        self.bytes.push((context.now(), word as u8));
    }

    fn transmit(&mut self, _now: VirtualNanos) -> Option<u16> {
        self.to_send.pop_front().map(u16::from)
    }
}
