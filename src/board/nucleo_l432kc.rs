//! NUCLEO-L432KC (ST user manual UM1956): STM32L432KC at 24 MHz, small and frugal, ST-LINK/V2-1 with a serial port.
//!
//! | what | where | why |
//! |---|---|---|
//! | clock | HSI16 | no crystal is fitted but the 32 kHz one; 1 % off at most (DS11451 table 49) is enough for the serial port |
//! | transducer, analogue | PA0, `ADC1_IN5` | A0 of the Nano header (UM1956 table 9) |
//! | its supply, where it is measured | PA1, `ADC1_IN6` | A1 of that header |
//! | a hand's channels 0 to 5 | PA0, PA1, PA3, PA4, PA7, PA5; `ADC1_IN5`, `6`, `8`, `9`, `12`, `10` | A0, A1, A2, A3, A6, A4; PA5 is wired to PB7 (SB16), which stays an input |
//! | transducer, bus | PB6, PB7, I2C1 | D5 and D4 of that header, with pull-ups at the transducer; A5 and A4 (PA5, PA6) are wired to them by default (SB16, SB18) and stay inputs |
//! | RESET of a hand's multiplexers | PB0 | D3 of that header, used for nothing else; open-drain, with the breakout's pull-up |
//! | serial port | PA2, PA15, USART2 | the ST-LINK's virtual COM port by default (UM1956 6.8) |
//! | serial port, shared (`rs485`) | PA9, PA10, USART1; driver enable PA12 | D1, D0 and D2 of that header, to a transceiver with RE at DE |
//! | calibration | the last two pages of flash, 2 KB each | erasing one stalls the code for 25 ms at most (DS11451 table 58): samples are lost, and counted |
//! | a loaded tip (`load-tip`) | the six pages before them | erasing three stalls the code for 75 ms at most |
//!
//! The transducer's output reaches A0 at no more than 10 kilo-ohm, as a share of the board's 3.3 V, which are the
//! converter's reference and supply the transducer too. A transducer with another supply (`supply = "measured"`: 5 V,
//! say) gives its output to A0 and its supply to A1, through two dividers of one ratio that leave 1.7 to 3.2 V of the
//! supply. A pull-up of about 1 megohm to 3.3 V makes a broken wire read as open.
//!
//! 24 MHz is the slowest from which the converter's and the serial port's clock divide, and below the 26 MHz of the lower
//! core voltage. Between samples the core sleeps; the converter needs the clocks, so it does not stop.

#[cfg(transducer = "ratiometric")]
use super::pins::Input;
use crate::status::ResetCause;
use embassy_stm32::flash::{self, Bank1Region, Flash};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::i2c;
#[cfg(any(transducer = "ratiometric", hand))]
use embassy_stm32::pac;
use embassy_stm32::peripherals;
use embassy_stm32::rcc::{Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux};
use embassy_stm32::{Config, Peri, bind_interrupts, dma, usart};

pins! {
    board {
        watchdog: IWDG,
        #[cfg(transducer = "ratiometric")]
        converter: ADC1,
        #[cfg(not(feature = "rs485"))]
        serial: USART2,
        #[cfg(not(feature = "rs485"))]
        receive: PA15,
        #[cfg(not(feature = "rs485"))]
        transmit: PA2,
        #[cfg(not(feature = "rs485"))]
        transmit_dma: DMA1_CH7,
        #[cfg(not(feature = "rs485"))]
        receive_dma: DMA1_CH6,
        #[cfg(feature = "rs485")]
        serial: USART1,
        #[cfg(feature = "rs485")]
        receive: PA10,
        #[cfg(feature = "rs485")]
        transmit: PA9,
        #[cfg(feature = "rs485")]
        driver_enable: PA12,
        #[cfg(feature = "rs485")]
        transmit_dma: DMA1_CH4,
        #[cfg(feature = "rs485")]
        receive_dma: DMA1_CH5,
        flash: FLASH,
    }
    bus {
        i2c: I2C1,
        clock: PB6,
        data: PB7,
        transmit_dma: DMA2_CH7,
        receive_dma: DMA2_CH6,
        #[cfg(multiplexer)]
        multiplexer_reset: PB0,
    }
}

bind_interrupts!(pub(super) struct Interrupts {
    #[cfg(not(feature = "rs485"))]
    DMA1_CHANNEL6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
    #[cfg(not(feature = "rs485"))]
    DMA1_CHANNEL7 => dma::InterruptHandler<peripherals::DMA1_CH7>;
    #[cfg(not(feature = "rs485"))]
    USART2 => usart::InterruptHandler<peripherals::USART2>;
    #[cfg(feature = "rs485")]
    DMA1_CHANNEL4 => dma::InterruptHandler<peripherals::DMA1_CH4>;
    #[cfg(feature = "rs485")]
    DMA1_CHANNEL5 => dma::InterruptHandler<peripherals::DMA1_CH5>;
    #[cfg(feature = "rs485")]
    USART1 => usart::InterruptHandler<peripherals::USART1>;
    FLASH => flash::InterruptHandler;
});

#[cfg(not(transducer = "ratiometric"))]
bind_interrupts!(pub(super) struct BusInterrupts {
    I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
    I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
    DMA2_CHANNEL6 => dma::InterruptHandler<peripherals::DMA2_CH6>;
    DMA2_CHANNEL7 => dma::InterruptHandler<peripherals::DMA2_CH7>;
});

/// Clock and data of the bus of a hand: the port of each, and its place there.
#[cfg(all(transducer = "bus", hand))]
pub(super) const LINES: [(pac::gpio::Gpio, usize); 2] = [(pac::GPIOB, 6), (pac::GPIOB, 7)];

/// What a hand's `channel` counts: A0, A1, A2, A3, A6 and A4 of the Nano header.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) const CHANNELS: [Input; 6] = [
    Input::new(5, pac::GPIOA, 0),
    Input::new(6, pac::GPIOA, 1),
    Input::new(8, pac::GPIOA, 3),
    Input::new(9, pac::GPIOA, 4),
    Input::new(12, pac::GPIOA, 7),
    Input::new(10, pac::GPIOA, 5),
];

/// The transducer's output.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) const OUTPUT: Input = Input::new(5, pac::GPIOA, 0);

/// Its supply.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) const SUPPLY: Input = Input::new(6, pac::GPIOA, 1);

/// Half used by reports of 46 bytes each millisecond, or by those of five tips. By 26 from 24 MHz: 923 077, 0.2 % fast; of a hand by 24,
/// exactly.
pub(super) const BAUD: u32 = if cfg!(hand) { 1_000_000 } else { 921_600 };

/// The serial port's clock: APB1.
pub(super) const SERIAL_CLOCK: u32 = 24_000_000;

/// What the clock comes from, for the log.
pub const CLOCK: &str = "HSI16, to 1 %";

/// The slowest report comes after a transducer's start, 60 ms; the oscillator of the watchdog runs at 29.5 to 34 kHz
/// (DS11451 table 52), so this is 188 to 217 ms.
pub(super) const WATCHDOG: u32 = 200_000;

/// Where the calibration lies: behind the image.
pub(super) type Region = Bank1Region<'static, flash::Async>;

/// Bytes of each of its two slots: a page.
pub const SLOT: u32 = 2 * 1024;

/// The first of them, from the start of the flash.
pub(super) const CALIBRATION: u32 = 256 * 1024 - 2 * SLOT;

/// Bytes of each slot of a loaded tip: three pages, as a block may have two.
#[cfg(all(not(hand), feature = "load-tip"))]
pub const TIP_SLOT: u32 = 6 * 1024;

/// The first of them, from the start of the flash: before the calibration.
#[cfg(all(not(hand), feature = "load-tip"))]
pub const TIPS: u32 = CALIBRATION - 2 * TIP_SLOT;

/// The flash of the calibration.
pub(super) fn region(flash: Peri<'static, peripherals::FLASH>) -> Region {
    Flash::new(flash, Interrupts).into_regions().bank1_region
}

/// The clocks. No crystal is there that could fail.
pub(super) fn clocks(_cause: ResetCause) -> (Config, bool) {
    let mut config = Config::default();
    config.rcc.hsi = true;
    config.rcc.pll = Some(Pll {
        source: PllSource::HSI,
        prediv: PllPreDiv::DIV2,
        mul: PllMul::MUL12,
        divp: None,
        divq: None,
        // 16 MHz / 2 * 12 / 4 = 24 MHz.
        divr: Some(PllRDiv::DIV4),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    // For the calibration; the converter then runs in step with the core.
    config.rcc.mux.adcsel = mux::Adcsel::SYS;
    (config, true)
}

/// There is none.
pub(super) fn guard_crystal(_runs: bool) {}
