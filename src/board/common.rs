//! The objects that every board gives to the tasks, and their set-up.

use super::chosen::{
    BAUD, CALIBRATION, Interrupts, Pins, Region, SERIAL_CLOCK, WATCHDOG, clocks, guard_crystal, region,
};
#[cfg(all(transducer = "ratiometric", not(hand)))]
use super::converter::DmaConverter as AnaloguePort;
#[cfg(not(transducer = "ratiometric"))]
use super::i2c::I2cBus;
use super::memory::RetryingFlash;
#[cfg(all(transducer = "ratiometric", hand))]
use super::scan::DmaScan as AnaloguePort;
use crate::status::ResetCause;
#[cfg(all(transducer = "bus", hand))]
use crate::transducer::rounds::RoundTimer;
use crate::units::Microseconds;
use embassy_stm32::mode::Async;
use embassy_stm32::pac;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::usart::{self, RingBufferedUartRx, Uart, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_time::Instant;
#[cfg(all(transducer = "bus", hand))]
use embassy_time::{Duration, Timer};
use static_cell::ConstStaticCell;

/// The serial port's sender.
pub type Line = UartTx<'static, Async>;

/// The serial port's receiver.
pub type SerialRx = RingBufferedUartRx<'static>;

/// Error of the port's rate against `baud`, parts in a million. The rate is the clock divided by the nearest whole number.
const fn baud_error(clock: u32, baud: u32) -> u32 {
    let divider = (clock + baud / 2) / baud;
    (clock as u64 * 1_000_000 / divider as u64).abs_diff(baud as u64 * 1_000_000) as u32 / baud
}

/// A receiver with sixteen samples a bit tolerates 3.3 % for both ends together (RM0090 30.3.5); the other end has a crystal,
/// and the L432KC's oscillator adds 1 %.
const _: () = assert!(baud_error(SERIAL_CLOCK, BAUD) < if cfg!(hand) { 1 } else { 10_000 });

/// Received bytes that are not processed yet: 2.8 ms on a line without pauses.
static HEARD: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);

/// The flash of the calibration.
pub type FlashMemory = RetryingFlash<Region>;

/// Resets the chip unless it is fed.
pub type Watchdog = IndependentWatchdog<'static, IWDG>;

/// Time since the board was set up.
///
/// The counter of the executor is not used directly. Its set-up can leave a compare flag set, and the counter then starts one
/// period, 65 536 us, ahead.
#[derive(Clone, Copy)]
pub struct Clock {
    start: Instant,
}

impl Clock {
    /// The present time.
    #[inline(never)]
    pub fn now(self) -> Microseconds {
        Microseconds(Instant::now().as_micros().saturating_sub(self.start.as_micros()))
    }
}

#[cfg(all(transducer = "bus", hand))]
impl RoundTimer for Clock {
    fn now(&self) -> u64 {
        Clock::now(*self).0
    }

    async fn until(&self, time: u64) {
        Timer::at(self.start + Duration::from_micros(time)).await;
    }
}

/// The objects that the tasks get.
pub struct Board {
    /// The time since this set-up.
    pub clock: Clock,
    /// The port of the transducer; `None` if nothing is measured.
    pub port: Option<Port>,
    /// Sender of frames.
    pub line: Line,
    /// Receiver of commands.
    pub serial_rx: SerialRx,
    /// The flash of the calibration.
    pub memory: FlashMemory,
    /// The watchdog, already running.
    pub watchdog: Watchdog,
    /// Whether the crystal runs, if the board has one. If it does not run, the chip's own oscillator, 1 % off, is in use.
    pub crystal: bool,
}

/// The port of the transducer: the converter, ...
#[cfg(transducer = "ratiometric")]
pub type Port = AnaloguePort;

/// ... or the bus.
#[cfg(not(transducer = "ratiometric"))]
pub type Port = I2cBus;

impl Board {
    /// Sets up clocks, pins and peripherals. Called once.
    ///
    /// With `gave_up`, nothing is measured, and the port of the transducer is not set up. `cause` is that of the last reset.
    ///
    /// # Panics
    /// If the board's file has an error. Running the image once shows this.
    pub fn take(gave_up: bool, cause: ResetCause) -> Self {
        let (config, crystal) = clocks(cause);
        let pins = Pins::of(embassy_stm32::init(config));
        let clock = Clock {
            start: Instant::now(),
        };

        guard_crystal(crystal);

        let mut watchdog = IndependentWatchdog::new(pins.watchdog, WATCHDOG);
        watchdog.unleash();

        #[cfg(transducer = "ratiometric")]
        let port = (!gave_up).then(|| AnaloguePort::new(pins.converter));
        #[cfg(not(transducer = "ratiometric"))]
        let port = (!gave_up).then_some(I2cBus(pins.bus));

        let mut serial = usart::Config::default();
        serial.baudrate = BAUD;
        #[cfg(feature = "rs485")]
        {
            // In sixteenths of a bit: half a bit before the first start bit and after the last stop bit.
            serial.de_assertion_time = 8;
            serial.de_deassertion_time = 8;
        }
        #[cfg(not(feature = "rs485"))]
        let new = Uart::new;
        #[cfg(feature = "rs485")]
        let new = Uart::new_with_de;
        let (line, serial_rx) = new(
            pins.serial,
            pins.receive,
            pins.transmit,
            #[cfg(feature = "rs485")]
            pins.driver_enable,
            pins.transmit_dma,
            pins.receive_dma,
            Interrupts,
            serial,
        )
        .expect("the rate divides from the clock")
        .split();

        Self {
            clock,
            port,
            line,
            serial_rx: serial_rx.into_ring_buffered(HEARD.take()),
            memory: RetryingFlash::new(region(pins.flash), CALIBRATION),
            watchdog,
            crystal,
        }
    }
}

/// Starts the watchdog, and reads and clears the flags of the last reset: nothing else is done before that reset is counted.
/// Until [`Board::take`] sets its time, the watchdog expires after half a second (RM0090 21.3.3, RM0394 36.3.2).
pub fn begin() -> ResetCause {
    pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::START));
    super::chip::reset_cause()
}
