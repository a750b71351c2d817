//! NUCLEO-G474RE (ST user manual UM2505): STM32G474RE at 104 MHz, ST-LINK/V3E with a serial port. Built for both kinds of port, never run: no
//! emulator of it was found, and nothing here was tried on hardware.
//!
//! | what | where | why |
//! |---|---|---|
//! | clock | HSE, 24 MHz | a crystal of the board's own (UM2505, HSE clock) |
//! | transducer, analogue | PA0, `ADC1_IN1` | A0 of the Arduino header |
//! | its supply, where it is measured | PA1, `ADC1_IN2` | A1 of that header |
//! | a hand's channels 0 to 5 | PA0, PA1, PB0, PC1, PC0, PC2; `ADC1_IN1`, `2`, `15`, `7`, `6`, `8` | A0, A1, A3, A4, A5, and pin 35 of CN7; A2 (PA4) is not a channel of ADC1 |
//! | transducer, bus | PA15, PB7, I2C1 | pins 17 and 21 of CN7, with pull-ups at the transducer. Not D15: its pin PB8 is `BOOT0` at reset, and a pull-up there starts the boot loader instead of the image |
//! | RESET of a hand's multiplexers | PA8 | D7 of the Arduino header, used for nothing else; open-drain, with the breakout's pull-up |
//! | serial port | PA2, PA3, LPUART1 | the ST-LINK's virtual COM port by default |
//! | serial port, shared (`rs485`) | PA9, PA10, USART1; driver enable PA12 | D8 and D2 of the Arduino header and pin 12 of CN10, to a transceiver with RE at DE |
//! | calibration | flash from `0x0804_0000`, two pages of 2 KB | bank 2: erasing it does not stall code in bank 1, where the image is |
//! | a loaded tip (`load-tip`) | the six pages behind it | the same |
//! | loaded tips of a hand | six pages a tip | the same |
//!
//! The flash has two banks as the chip is delivered (option `DBANK`); the driver stops the start of a chip that was set to one bank.
//!
//! The transducer's output reaches A0 at no more than 10 kilo-ohm, as a share of the board's 3.3 V, which are the
//! converter's reference and supply the transducer too. A transducer with another supply (`supply = "measured"`: 5 V,
//! say) gives its output to A0 and its supply to A1, through two dividers of one ratio that leave 1.7 to 3.2 V of the
//! supply. A pull-up of about 1 megohm to 3.3 V makes a broken wire read as open.

#[cfg(transducer = "ratiometric")]
use super::pins::Input;
use crate::status::ResetCause;
#[cfg(all(hand, feature = "load-tip"))]
use crate::storage::tip_slots::Slot;
use embassy_stm32::flash::{self, Bank2Region, Flash};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::i2c;
use embassy_stm32::pac;
use embassy_stm32::peripherals::{self, DMA1_CH2, DMA1_CH3};
use embassy_stm32::rcc::{Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllRDiv, PllSource, Sysclk, mux};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peri, bind_interrupts, dma, usart};

pins! {
    board {
        watchdog: IWDG,
        #[cfg(transducer = "ratiometric")]
        converter: ADC1,
        #[cfg(not(feature = "rs485"))]
        serial: LPUART1,
        #[cfg(not(feature = "rs485"))]
        receive: PA3,
        #[cfg(not(feature = "rs485"))]
        transmit: PA2,
        #[cfg(feature = "rs485")]
        serial: USART1,
        #[cfg(feature = "rs485")]
        receive: PA10,
        #[cfg(feature = "rs485")]
        transmit: PA9,
        #[cfg(feature = "rs485")]
        driver_enable: PA12,
        transmit_dma: DMA1_CH3,
        receive_dma: DMA1_CH2,
        flash: FLASH,
    }
    bus {
        i2c: I2C1,
        clock: PA15,
        data: PB7,
        transmit_dma: DMA1_CH4,
        receive_dma: DMA1_CH5,
        #[cfg(multiplexer)]
        multiplexer_reset: PA8,
    }
}

bind_interrupts!(pub(super) struct Interrupts {
    DMA1_CHANNEL2 => dma::InterruptHandler<DMA1_CH2>;
    DMA1_CHANNEL3 => dma::InterruptHandler<DMA1_CH3>;
    FLASH => flash::InterruptHandler;
    #[cfg(not(feature = "rs485"))]
    LPUART1 => usart::InterruptHandler<peripherals::LPUART1>;
    #[cfg(feature = "rs485")]
    USART1 => usart::InterruptHandler<peripherals::USART1>;
});

#[cfg(not(transducer = "ratiometric"))]
bind_interrupts!(pub(super) struct BusInterrupts {
    I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
    I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
    DMA1_CHANNEL4 => dma::InterruptHandler<peripherals::DMA1_CH4>;
    DMA1_CHANNEL5 => dma::InterruptHandler<peripherals::DMA1_CH5>;
});

/// Clock and data of the bus of a hand: the port of each, and its place there.
#[cfg(all(transducer = "bus", hand))]
pub(super) const LINES: [(pac::gpio::Gpio, usize); 2] = [(pac::GPIOA, 15), (pac::GPIOB, 7)];

/// What a hand's `channel` counts: A0, A1, A3, A4 and A5 of the Arduino header, and pin 35 of CN7.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) const CHANNELS: [Input; 6] = [
    Input::new(1, pac::GPIOA, 0),
    Input::new(2, pac::GPIOA, 1),
    Input::new(15, pac::GPIOB, 0),
    Input::new(7, pac::GPIOC, 1),
    Input::new(6, pac::GPIOC, 0),
    Input::new(8, pac::GPIOC, 2),
];

/// The transducer's output.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) const OUTPUT: Input = Input::new(1, pac::GPIOA, 0);

/// Its supply.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) const SUPPLY: Input = Input::new(2, pac::GPIOA, 1);

/// The board's crystal.
const HSE: Hertz = Hertz(24_000_000);

/// Half used by reports of 46 bytes each millisecond, or by those of five tips. The port divides in 256ths: 921 596, and 1 000 000 exactly.
pub(super) const BAUD: u32 = if cfg!(hand) { 1_000_000 } else { 921_600 };

/// The serial port's clock: APB1.
pub(super) const SERIAL_CLOCK: u32 = 104_000_000;

/// What the clock comes from, for the log.
pub const CLOCK: &str = "HSE";

/// The slowest report comes after a transducer's start, 60 ms; the oscillator of the watchdog runs at 29.5 to 34 kHz
/// (DS12288, LSI characteristics), so this is 188 to 217 ms.
pub(super) const WATCHDOG: u32 = 200_000;

/// The crystal is given this many looks to be ready, some 4 ms at the 16 MHz the core starts with (DS12288, HSE characteristics: 2 ms).
const LOOKS: u32 = 10_000;

/// Where the calibration lies: the first pages of bank 2.
pub(super) type Region = Bank2Region<'static, flash::Async>;

/// Bytes of each of its two slots: a page.
pub const SLOT: u32 = 2 * 1024;

/// The first of them, from the start of the region.
pub(super) const CALIBRATION: u32 = 0;

/// Slots of the loaded tips of a hand, from [`TIPS`] on, two a tip.
#[cfg(all(hand, feature = "load-tip"))]
pub const TIP_SLOTS: [Slot; 10] = {
    let mut slots = [Slot {
        begin: 0,
        length: 6 * 1024,
    }; 10];
    let mut number = 0;
    while number < slots.len() {
        slots[number].begin = slots[number].length * number as u32;
        number += 1;
    }
    slots
};

/// Bytes of each slot of a loaded tip: three pages, as a block may have two.
#[cfg(all(not(hand), feature = "load-tip"))]
pub const TIP_SLOT: u32 = 6 * 1024;

/// The first of them, from the start of the region: behind the calibration.
#[cfg(feature = "load-tip")]
pub const TIPS: u32 = CALIBRATION + 2 * SLOT;

/// The flash of the calibration.
pub(super) fn region(flash: Peri<'static, peripherals::FLASH>) -> Region {
    Flash::new(flash, Interrupts).into_regions().bank2_region
}

/// The clocks, and whether the crystal runs.
pub(super) fn clocks(_cause: ResetCause) -> (Config, bool) {
    let crystal = crystal_runs();
    let mut config = Config::default();
    config.rcc.hsi = !crystal;
    config.rcc.hse = crystal.then_some(Hse {
        freq: HSE,
        mode: HseMode::Oscillator,
    });
    // 8 MHz into the PLL, of the crystal's 24 or the internal 16.
    let (source, prediv) = if crystal {
        (PllSource::HSE, PllPreDiv::DIV3)
    } else {
        (PllSource::HSI, PllPreDiv::DIV2)
    };
    config.rcc.pll = Some(Pll {
        source,
        prediv,
        mul: PllMul::MUL26,
        // 26 MHz for the converter: a conversion of 260 cycles is then 10 us to the cycle.
        divp: Some(PllPDiv::DIV8),
        divq: None,
        // 104 MHz, and not the part's 170: no more is needed, and the serial port's rates divide from it.
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    config.rcc.mux.adc12sel = mux::Adcsel::PLL1_P;
    (config, crystal)
}

/// Whether the crystal is ready in time. The clocks' set-up, later, would wait for it for ever.
fn crystal_runs() -> bool {
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    (0..LOOKS).any(|_| pac::RCC.cr().read().hserdy())
}

/// A crystal that stops raises the non-maskable interrupt from now on (RM0440, clock security system): a fault and a reset, after which the
/// internal oscillator takes its place. Without it the PLL would run on at a rate that nobody knows.
pub(super) fn guard_crystal(runs: bool) {
    if runs {
        pac::RCC.cr().modify(|w| w.set_csson(true));
    }
}
