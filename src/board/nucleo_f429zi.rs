//! NUCLEO-F429ZI (ST user manual UM1974): STM32F429ZI at 128 MHz, ST-LINK/V2-1 with a serial port.
//!
//! | what | where | why |
//! |---|---|---|
//! | clock | HSE, 8 MHz, bypass | the ST-LINK's MCO drives it by default (UM1974 6.8.1); a crystal is not fitted |
//! | transducer, analogue | PA3, `ADC123_IN3` | A0 of the Zio and Arduino header (UM1974 table 19) |
//! | its supply, where it is measured | PC0, `ADC123_IN10` | A1 of that header |
//! | a hand's channels 0 to 5 | PA3, PC0, PC3, PB1, PC2, PA5; `ADC1_IN3`, `10`, `13`, `9`, `12`, `5` | A0, A1, A2, A6, A7, D13: pins of ADC1 that the board uses for nothing else (UM1974 tables 19 and 20) |
//! | transducer, bus | PB8, PB9, I2C1 | D15 and D14 of that header, with pull-ups at the transducer |
//! | RESET of a hand's multiplexers | PF13 | D7 of that header, used for nothing else; open-drain, with the breakout's pull-up |
//! | serial port | PD8, PD9, USART3 | the ST-LINK's virtual COM port by default (UM1974 6.9) |
//! | calibration | flash from `0x0810_0000`, two sectors of 16 KB | bank 2: erasing it does not stall code in bank 1, where the image is |
//! | a loaded tip (`load-tip`) | the two sectors behind it, from `0x0810_8000` | the same |
//! | loaded tips of a hand | the rest of bank 2, two sectors a tip: two of 16 KB, one of 64, seven of 128 | what is erased apart: five tips |
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
#[cfg(not(all(hand, feature = "load-tip")))]
use embassy_stm32::flash::Bank2Region1;
use embassy_stm32::flash::{self, Flash};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::i2c;
use embassy_stm32::peripherals::{self, DMA1_CH1, DMA1_CH3, USART3};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peri, bind_interrupts, dma, pac, usart};

pins! {
    board {
        watchdog: IWDG,
        #[cfg(transducer = "ratiometric")]
        converter: ADC1,
        serial: USART3,
        receive: PD9,
        transmit: PD8,
        transmit_dma: DMA1_CH3,
        receive_dma: DMA1_CH1,
        flash: FLASH,
    }
    bus {
        i2c: I2C1,
        clock: PB8,
        data: PB9,
        transmit_dma: DMA1_CH6,
        receive_dma: DMA1_CH0,
        #[cfg(multiplexer)]
        multiplexer_reset: PF13,
    }
}

bind_interrupts!(pub(super) struct Interrupts {
    DMA1_STREAM1 => dma::InterruptHandler<DMA1_CH1>;
    DMA1_STREAM3 => dma::InterruptHandler<DMA1_CH3>;
    FLASH => flash::InterruptHandler;
    USART3 => usart::InterruptHandler<USART3>;
});

#[cfg(not(transducer = "ratiometric"))]
bind_interrupts!(pub(super) struct BusInterrupts {
    I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
    I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
    DMA1_STREAM0 => dma::InterruptHandler<peripherals::DMA1_CH0>;
    DMA1_STREAM6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
});

/// Clock and data of the bus of a hand: the port of each, and its place there.
#[cfg(all(transducer = "bus", hand))]
pub(super) const LINES: [(pac::gpio::Gpio, usize); 2] = [(pac::GPIOB, 8), (pac::GPIOB, 9)];

/// What a hand's `channel` counts: A0, A1, A2, A6, A7 and D13 of the Zio and Arduino headers.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) const CHANNELS: [Input; 6] = [
    Input::new(3, pac::GPIOA, 3),
    Input::new(10, pac::GPIOC, 0),
    Input::new(13, pac::GPIOC, 3),
    Input::new(9, pac::GPIOB, 1),
    Input::new(12, pac::GPIOC, 2),
    Input::new(5, pac::GPIOA, 5),
];

/// The transducer's output.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) const OUTPUT: Input = Input::new(3, pac::GPIOA, 3);

/// Its supply.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) const SUPPLY: Input = Input::new(10, pac::GPIOC, 0);

/// The crystal oscillator of the ST-LINK.
const HSE: Hertz = Hertz(8_000_000);

/// Half used by reports of 46 bytes each millisecond, or by those of five tips. By 35 from 32 MHz: 914 286, 0.8 % slow; of a hand by 32,
/// exactly.
pub(super) const BAUD: u32 = if cfg!(hand) { 1_000_000 } else { 921_600 };

/// The serial port's clock: APB1.
pub(super) const SERIAL_CLOCK: u32 = 32_000_000;

/// What the clock comes from, for the log.
pub const CLOCK: &str = "HSE";

/// The slowest report comes after a transducer's start, 60 ms; the oscillator of the watchdog runs at 17 to 47 kHz for a
/// nominal 32 (DS9405 table 43), so this is 136 to 376 ms.
pub(super) const WATCHDOG: u32 = 200_000;

/// The crystal is given this many looks to be ready, at least 3 ms at the 16 MHz the core starts with (DS9405 table 38: 2 ms).
const LOOKS: u32 = 8_000;

/// The same after power came on: the ST-LINK gives its clock only when it has started, up to 2 s later. A look takes 6 cycles of 16 MHz at the
/// least, so this is 2.2 s or more.
const LOOKS_AFTER_POWER: u32 = 6_000_000;

/// Where the calibration lies: the first sectors of bank 2.
#[cfg(not(all(hand, feature = "load-tip")))]
pub(super) type Region = Bank2Region1<'static, flash::Async>;

/// Where calibrations and tips lie: the flash, of which all of bank 2 is theirs.
#[cfg(all(hand, feature = "load-tip"))]
pub(super) type Region = Flash<'static, flash::Async>;

/// Bytes of each of its two slots: a sector.
pub const SLOT: u32 = 16 * 1024;

/// The first of them, from the start of the region.
pub(super) const CALIBRATION: u32 = if cfg!(all(hand, feature = "load-tip")) {
    0x0010_0000
} else {
    0
};

/// Slots of the loaded tips of a hand, from [`TIPS`] on, two a tip: the sectors 14 to 23 (RM0090 table 6).
#[cfg(all(hand, feature = "load-tip"))]
pub const TIP_SLOTS: [Slot; 10] = {
    const KILOBYTES: [u32; 10] = [16, 16, 64, 128, 128, 128, 128, 128, 128, 128];
    let mut slots = [Slot { begin: 0, length: 0 }; 10];
    let (mut begin, mut number) = (0, 0);
    while number < slots.len() {
        let length = 1024 * KILOBYTES[number];
        slots[number] = Slot { begin, length };
        begin += length;
        number += 1;
    }
    slots
};

/// Bytes of each slot of a loaded tip: a sector.
#[cfg(all(not(hand), feature = "load-tip"))]
pub const TIP_SLOT: u32 = 16 * 1024;

/// The first of them, from the start of the region: behind the calibration.
#[cfg(feature = "load-tip")]
pub const TIPS: u32 = CALIBRATION + 2 * SLOT;

/// The flash of the calibration.
pub(super) fn region(flash: Peri<'static, peripherals::FLASH>) -> Region {
    steady_bank_2();
    let flash = Flash::new(flash, Interrupts);
    #[cfg(not(all(hand, feature = "load-tip")))]
    let flash = flash.into_regions().bank2_region1;
    flash
}

/// The clocks, and whether the crystal runs.
pub(super) fn clocks(cause: ResetCause) -> (Config, bool) {
    let crystal = crystal_runs(match cause {
        ResetCause::PowerOn | ResetCause::BrownOut => LOOKS_AFTER_POWER,
        _ => LOOKS,
    });
    let mut config = Config::default();
    config.rcc.hse = crystal.then_some(Hse {
        freq: HSE,
        mode: HseMode::Bypass,
    });
    // 2 MHz into the PLL has the least jitter (RM0090 6.3.2): of 8 MHz, or of the internal 16.
    let (source, division) = if crystal {
        (PllSource::HSE, PllPreDiv::DIV4)
    } else {
        (PllSource::HSI, PllPreDiv::DIV8)
    };
    config.rcc.pll_src = source;
    // 128 MHz, and not the part's 168 or 180, because the converter's 4 MHz divide from it: a block is then a
    // millisecond to the cycle.
    config.rcc.pll = Some(Pll {
        prediv: division,
        mul: PllMul::MUL128,
        divp: Some(PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    // 32 MHz, of at most 45.
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    // 8 MHz: nothing but the converter lives there.
    config.rcc.apb2_pre = APBPrescaler::DIV16;
    (config, crystal)
}

/// Chips before revision 3 may read bank 2 wrong unless PA12 is pulled low (ES0206 2.2.14); the driver insists on it. On
/// this board it goes to the USB socket, which is not used.
fn steady_bank_2() {
    const REVISION_3: u16 = 0x2001;
    const PA12: usize = 12;
    if pac::DBGMCU.idcode().read().rev_id() < REVISION_3 {
        pac::GPIOA
            .odr()
            .modify(|w| w.set_odr(PA12, pac::gpio::vals::Odr::LOW));
        pac::GPIOA
            .pupdr()
            .modify(|w| w.set_pupdr(PA12, pac::gpio::vals::Pupdr::PULL_DOWN));
        pac::GPIOA
            .moder()
            .modify(|w| w.set_moder(PA12, pac::gpio::vals::Moder::OUTPUT));
    }
}

/// Whether the crystal is ready within so many looks; the watchdog is fed meanwhile. The clocks' set-up, later, would wait for it for ever.
fn crystal_runs(looks: u32) -> bool {
    pac::RCC.cr().modify(|w| w.set_hsebyp(true));
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    (0..looks).any(|_| {
        pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::RESET));
        pac::RCC.cr().read().hserdy()
    })
}

/// A crystal that stops raises the non-maskable interrupt from now on (RM0090 6.2.7): a fault and a reset, after which the internal
/// oscillator takes its place. Without it the PLL would run on at a rate that nobody knows.
pub(super) fn guard_crystal(runs: bool) {
    if runs {
        pac::RCC.cr().modify(|w| w.set_csson(true));
    }
}
