//! NUCLEO-F429ZI (ST user manual UM1974): STM32F429ZI at 160 MHz, ST-LINK/V2-1 with a serial port.
//!
//! | what | where | why |
//! |---|---|---|
//! | clock | HSE, 8 MHz, bypass | the ST-LINK's MCO drives it by default (UM1974 6.8.1); a crystal is not fitted |
//! | transducer | PA3, `ADC123_IN3` | A0 of the Zio and Arduino header (UM1974 table 19) |
//! | serial port | PD8, `USART3_TX` | the ST-LINK's virtual COM port by default (UM1974 6.9) |
//!
//! The transducer's output must reach A0 in the ratio of its supply to the board's 3.3 V, which is the
//! converter's reference (for a 5 V part: through a divider from the same 5 V), at no more than 10 kilo-ohm. A
//! pull-up of about 1 megohm to 3.3 V makes a broken wire read as open.

use embassy_stm32::adc::{self, Adc, AdcChannel as _, RingBufferedAdc, SampleTime};
use embassy_stm32::mode::Async;
use embassy_stm32::pac;
use embassy_stm32::peripherals::{ADC1, DMA1_CH3, DMA2_CH0, IWDG};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, dma};
use embassy_time::Instant;
use fingertip::counts::{BLOCK_LENGTH, PERIOD};
use fingertip::report::Microseconds;
use fingertip::telemetry::ResetCause;
use static_cell::ConstStaticCell;

bind_interrupts!(struct Interrupts {
    DMA2_STREAM0 => dma::InterruptHandler<DMA2_CH0>;
    DMA1_STREAM3 => dma::InterruptHandler<DMA1_CH3>;
});

/// The crystal oscillator of the ST-LINK.
const HSE: Hertz = Hertz(8_000_000);

/// Clock of the converter: 8 MHz / 4 * 160 / 2 = 160 MHz to the core, / 16 to APB2, / 2 in the converter.
const CONVERTER_CLOCK: u32 = 5_000_000;

/// Cycles of one conversion: 28 of sampling (5.6 us, enough for 10 kilo-ohm) and 12 of conversion, 8 us.
const CONVERSION_CYCLES: u32 = 28 + 12;

/// One conversion, microseconds.
const CONVERSION: u32 = CONVERSION_CYCLES / (CONVERTER_CLOCK / 1_000_000);

// 125 conversions of 40 cycles at 5 MHz are 1 ms to the cycle: the converter itself is the clock of the reports.
// 160 MHz and not the part's 168 or 180 because 5 MHz divides from it and 1 ms then is a whole number of
// conversions; a slow converter also samples long and leaves the core 1.28 million cycles a thousand blocks.
const _: () = assert!(BLOCK_LENGTH as u32 * CONVERSION == PERIOD);

/// 36 % used by reports of 31 bytes each millisecond. From 40 MHz the divider gives 930 233, 0.9 % fast: a tenth of
/// a bit at the end of a frame of ten, with half a bit allowed.
const BAUD: u32 = 921_600;

/// A report comes each millisecond; the oscillator of the watchdog runs at 17 to 47 kHz for a nominal 32 (DS9405
/// table 43), so this is 68 to 188 ms.
const WATCHDOG: u32 = 100_000;

/// Two blocks: the converter fills one half while the other is read.
static RING: ConstStaticCell<[u16; 2 * BLOCK_LENGTH]> = ConstStaticCell::new([0; 2 * BLOCK_LENGTH]);

/// The serial port's sender.
pub(crate) type Line = UartTx<'static, Async>;

/// Resets the chip unless it is fed.
pub(crate) type Watchdog = IndependentWatchdog<'static, IWDG>;

/// Time since the board was set up.
///
/// Not the bare counter of the executor: setting that up can leave a compare flag behind, which starts it one
/// period, 65 536 us, ahead.
#[derive(Clone, Copy)]
pub(crate) struct Clock {
    start: Instant,
}

impl Clock {
    /// The time.
    pub(crate) fn now(self) -> Microseconds {
        Microseconds(Instant::now().as_micros().saturating_sub(self.start.as_micros()))
    }
}

/// What the tasks get.
pub(crate) struct Board {
    /// The time, from here on.
    pub(crate) clock: Clock,
    /// The transducer's samples.
    pub(crate) converter: Converter,
    /// The way out for frames.
    pub(crate) line: Line,
    /// Running from here on.
    pub(crate) watchdog: Watchdog,
    /// Why the chip was reset.
    pub(crate) reset_cause: ResetCause,
}

impl Board {
    /// Sets up clocks, pins and peripherals. Called once; all failures in here are faults of this file, found by
    /// running the image once.
    pub(crate) fn take() -> Self {
        let mut config = Config::default();
        config.rcc.hse = Some(Hse {
            freq: HSE,
            mode: HseMode::Bypass,
        });
        config.rcc.pll_src = PllSource::HSE;
        config.rcc.pll = Some(Pll {
            // 2 MHz into the PLL has the least jitter (RM0090 6.3.2).
            prediv: PllPreDiv::DIV4,
            mul: PllMul::MUL160,
            divp: Some(PllPDiv::DIV2),
            divq: None,
            divr: None,
        });
        config.rcc.sys = Sysclk::PLL1_P;
        config.rcc.ahb_pre = AHBPrescaler::DIV1;
        // 40 MHz, of at most 45.
        config.rcc.apb1_pre = APBPrescaler::DIV4;
        // 10 MHz: nothing but the converter lives there.
        config.rcc.apb2_pre = APBPrescaler::DIV16;
        let peripherals = embassy_stm32::init(config);
        let clock = Clock {
            start: Instant::now(),
        };

        let mut watchdog = IndependentWatchdog::new(peripherals.IWDG, WATCHDOG);
        watchdog.unleash();

        let ring = Adc::new(peripherals.ADC1).into_ring_buffered(
            peripherals.DMA2_CH0,
            RING.take(),
            Interrupts,
            // One channel: a ring of several can come out of step (embassy issue 5025).
            [(peripherals.PA3.degrade_adc(), SampleTime::CYCLES28)].into_iter(),
            adc::CONTINUOUS,
            adc::Exten::DISABLED,
        );

        let mut serial = usart::Config::default();
        serial.baudrate = BAUD;
        let line = UartTx::new(
            peripherals.USART3,
            peripherals.PD8,
            peripherals.DMA1_CH3,
            Interrupts,
            serial,
        )
        .expect("the rate divides from the clock");

        Self {
            clock,
            converter: Converter::new(ring, clock),
            line,
            watchdog,
            reset_cause: take_reset_cause(),
        }
    }
}

/// Reads and clears the flags of the last reset. Every internal reset also pulls the pin, so that one is
/// asked last (RM0090 6.1.1).
fn take_reset_cause() -> ResetCause {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|register| register.set_rmvf(true));
    if flags.wdgrstf() || flags.wwdgrstf() {
        ResetCause::Watchdog
    } else if flags.lpwrrstf() {
        ResetCause::LowPower
    } else if flags.sftrstf() {
        ResetCause::Software
    } else if flags.porrstf() {
        ResetCause::PowerOn
    } else if flags.borrstf() {
        ResetCause::BrownOut
    } else if flags.padrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}

/// The free-running converter, read a block at a time.
pub(crate) struct Converter {
    ring: RingBufferedAdc<'static, ADC1>,
    clock: Clock,
}

/// The reader was more than a block late, and samples were overwritten.
pub(crate) struct Overrun;

impl Converter {
    fn new(mut ring: RingBufferedAdc<'static, ADC1>, clock: Clock) -> Self {
        // Blocks stay the two halves of the ring, also after an overrun.
        ring.set_alignment(BLOCK_LENGTH);
        Self { ring, clock }
    }

    /// Waits for the next block; when its last sample was taken.
    ///
    /// Deadline: one block after its end, or the next call says [`Overrun`] and goes on with fresh samples.
    pub(crate) async fn block(&mut self, codes: &mut [u16; BLOCK_LENGTH]) -> Result<Microseconds, Overrun> {
        let newer = self.ring.read(codes).await.map_err(|_| Overrun)?;
        // What has come since then tells how late this is.
        let late = newer as u64 * u64::from(CONVERSION);
        Ok(Microseconds(self.clock.now().0.saturating_sub(late)))
    }
}
