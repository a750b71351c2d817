//! The bus to a transducer, or to those of a hand. It is set up again for every transaction, so that a disturbed line cannot
//! block the peripheral: a disturbed I2C of the STM32F4 reports busy until it is reset. The steps of a transaction behind a
//! multiplexer share one set-up. A transaction that takes too long is aborted.

#[cfg(hand)]
use super::chosen::LINES;
use super::chosen::{BusInterrupts, BusPins};
use crate::transducer::bus::Bus;
#[cfg(not(hand))]
use crate::transducer::bus::OPERATION_LIMIT;
#[cfg(multiplexer)]
use crate::transducer::multiplexer::{BusBranch, PortError};
use embassy_stm32::gpio::{Level, OutputOpenDrain, Speed};
use embassy_stm32::i2c::{Config, Error, I2c, Master};
use embassy_stm32::mode::Async;
use embassy_stm32::time::Hertz;
use embassy_time::{Duration, Timer, with_timeout};
use embedded_hal_async::i2c::{self, Operation};
#[cfg(hand)]
use model_tables::constants::hand_bus::OPERATION_LIMIT;

/// Half a clock pulse while software frees the bus: 100 kHz.
const HALF_PULSE: Duration = Duration::from_micros(5);

/// Time limit of one transaction.
const LIMIT: Duration = Duration::from_micros(OPERATION_LIMIT as u64);

/// The bus on the board's pins, at 400 kHz, with pull-ups of 2.2 to 4.7 kilo-ohm on the transducer's side.
pub struct I2cBus(pub(super) BusPins);

impl I2cBus {
    /// The peripheral, reset and set up.
    fn i2c(&mut self) -> I2c<'_, Async, Master> {
        let pins = &mut self.0;
        let mut config = Config::default();
        config.frequency = Hertz(400_000);
        // Same limit for the driver's waits that do not yield.
        config.timeout = LIMIT;
        I2c::new(
            pins.i2c.reborrow(),
            pins.clock.reborrow(),
            pins.data.reborrow(),
            pins.transmit_dma.reborrow(),
            pins.receive_dma.reborrow(),
            BusInterrupts,
            config,
        )
    }

    /// Clock and data as plain open-drain outputs, released.
    fn lines(&mut self) -> [OutputOpenDrain<'_>; 2] {
        let pins = &mut self.0;
        [
            OutputOpenDrain::new(pins.clock.reborrow(), Level::High, Speed::Low),
            OutputOpenDrain::new(pins.data.reborrow(), Level::High, Speed::Low),
        ]
    }

    /// Closes all branches (TCA9548A, SCPS207 section 8.3.2: at least 6 ns).
    #[cfg(multiplexer)]
    async fn reset_multiplexers(&mut self) {
        let pin = self.0.multiplexer_reset.reborrow();
        let mut reset = OutputOpenDrain::new(pin, Level::Low, Speed::Low);
        Timer::after(HALF_PULSE).await;
        reset.set_high();
        // The pull-up, 10 kilo-ohm, lifts 100 pF in 1 us.
        Timer::after(HALF_PULSE).await;
    }
}

/// The peripheral while it is set up: for one transaction, or for all steps of a transaction behind a multiplexer.
struct Wire<'a>(I2c<'a, Async, Master>);

impl i2c::ErrorType for Wire<'_> {
    type Error = Error;
}

impl i2c::I2c for Wire<'_> {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        // On a held line, the transaction would wait until its time limit.
        #[cfg(hand)]
        if !is_free() {
            return Err(Error::Bus);
        }
        with_timeout(LIMIT, self.0.transaction(address, operations))
            .await
            .unwrap_or(Err(Error::Timeout))
    }
}

/// Whether nobody holds clock or data. The pins must be set up for the bus.
#[cfg(hand)]
fn is_free() -> bool {
    LINES
        .into_iter()
        .all(|(port, line)| port.idr().read().idr(line) == embassy_stm32::pac::gpio::vals::Idr::HIGH)
}

impl i2c::ErrorType for I2cBus {
    type Error = Error;
}

impl i2c::I2c for I2cBus {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        i2c::I2c::transaction(&mut Wire(self.i2c()), address, operations).await
    }
}

impl Bus for I2cBus {
    async fn clear(&mut self) {
        #[cfg(multiplexer)]
        self.reset_multiplexers().await;
        let [mut clock, mut data] = self.lines();
        #[cfg(hand)]
        if clock.is_high() && data.is_high() {
            return;
        }
        // A part in the middle of a byte releases the line after at most nine pulses (UM10204 3.1.16).
        for _ in 0..9 {
            clock.set_low();
            Timer::after(HALF_PULSE).await;
            clock.set_high();
            Timer::after(HALF_PULSE).await;
        }
        // A stop: data rises while the clock is high.
        data.set_low();
        Timer::after(HALF_PULSE).await;
        data.set_high();
        Timer::after(HALF_PULSE).await;
    }

    #[cfg(multiplexer)]
    async fn through(
        &mut self,
        branch: BusBranch,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), PortError> {
        branch
            .transaction(&mut Wire(self.i2c()), address, operations)
            .await
    }
}
