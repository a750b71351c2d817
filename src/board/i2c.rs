//! The bus to a transducer: set up anew for every transaction, so that nothing a line has done leaves the chip's end
//! stuck (an I2C of the STM32F4 that was disturbed says busy until it is reset), and broken off when it takes too long.

use embassy_stm32::gpio::OutputOpenDrain;
use embassy_stm32::i2c::{Error, I2c, Master};
use embassy_stm32::mode::Async;
use embassy_time::{Duration, Timer, with_timeout};
use embedded_hal_async::i2c::{self, Operation};
use fingertip::transducer::bus::{Bus, OPERATION_LIMIT};

/// Half a clock pulse of a line that is freed by hand: 100 kHz.
const HALF_PULSE: Duration = Duration::from_micros(5);

/// The wires of a bus and the peripheral behind them.
pub(crate) trait Wires {
    /// The peripheral, reset and set up.
    fn i2c(&mut self) -> I2c<'_, Async, Master>;

    /// Clock and data as plain lines, released.
    fn lines(&mut self) -> [OutputOpenDrain<'_>; 2];
}

/// The bus on its wires.
pub(crate) struct I2cBus<W>(pub(crate) W);

impl<W> i2c::ErrorType for I2cBus<W> {
    type Error = Error;
}

impl<W: Wires> i2c::I2c for I2cBus<W> {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        let mut i2c = self.0.i2c();
        let limit = Duration::from_micros(u64::from(OPERATION_LIMIT));
        with_timeout(limit, i2c.transaction(address, operations))
            .await
            .unwrap_or(Err(Error::Timeout))
    }
}

impl<W: Wires> Bus for I2cBus<W> {
    async fn clear(&mut self) {
        let [mut clock, mut data] = self.0.lines();
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
