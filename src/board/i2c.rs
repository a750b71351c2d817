//! The bus to a transducer. It is set up again for every transaction, so that a disturbed line cannot block the peripheral: an I2C
//! of the STM32F4 that was disturbed reports busy until it is reset. A transaction that takes too long is aborted.

use super::chosen::{BusInterrupts, BusPins};
use crate::transducer::bus::{Bus, OPERATION_LIMIT};
use embassy_stm32::gpio::{Level, OutputOpenDrain, Speed};
use embassy_stm32::i2c::{Config, Error, I2c, Master};
use embassy_stm32::mode::Async;
use embassy_stm32::time::Hertz;
use embassy_time::{Duration, Timer, with_timeout};
use embedded_hal_async::i2c::{self, Operation};

/// Half a clock pulse of a line that is freed by hand: 100 kHz.
const HALF_PULSE: Duration = Duration::from_micros(5);

/// The bus on the board's pins, at 400 kHz, with pull-ups of 2.2 to 4.7 kilo-ohm on the transducer's side.
pub struct I2cBus(pub(super) BusPins);

impl I2cBus {
    /// The peripheral, reset and set up.
    fn i2c(&mut self) -> I2c<'_, Async, Master> {
        let pins = &mut self.0;
        let mut config = Config::default();
        config.frequency = Hertz(400_000);
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

    /// Clock and data as plain lines, released.
    fn lines(&mut self) -> [OutputOpenDrain<'_>; 2] {
        let pins = &mut self.0;
        [
            OutputOpenDrain::new(pins.clock.reborrow(), Level::High, Speed::Low),
            OutputOpenDrain::new(pins.data.reborrow(), Level::High, Speed::Low),
        ]
    }
}

impl i2c::ErrorType for I2cBus {
    type Error = Error;
}

impl i2c::I2c for I2cBus {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        let mut i2c = self.i2c();
        let limit = Duration::from_micros(u64::from(OPERATION_LIMIT));
        with_timeout(limit, i2c.transaction(address, operations))
            .await
            .unwrap_or(Err(Error::Timeout))
    }
}

impl Bus for I2cBus {
    async fn clear(&mut self) {
        let [mut clock, mut data] = self.lines();
        // A part in the middle of a byte lets go after at most nine pulses (UM10204 3.1.16).
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
}
