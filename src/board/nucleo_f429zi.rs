//! NUCLEO-F429ZI (ST user manual UM1974): STM32F429ZI at 128 MHz, ST-LINK/V2-1 with a serial port.
//!
//! | what | where | why |
//! |---|---|---|
//! | clock | HSE, 8 MHz, bypass | the ST-LINK's MCO drives it by default (UM1974 6.8.1); a crystal is not fitted |
//! | transducer, analogue | PA3, `ADC123_IN3` | A0 of the Zio and Arduino header (UM1974 table 19) |
//! | its supply, where it is measured | PC0, `ADC123_IN10` | A1 of that header |
//! | transducer, bus | PB8, PB9, I2C1 | D15 and D14 of that header, with pull-ups at the transducer |
//! | serial port | PD8, PD9, USART3 | the ST-LINK's virtual COM port by default (UM1974 6.9) |
//! | calibration | flash from `0x0810_0000`, two sectors of 16 KB | bank 2: erasing it does not stall code in bank 1, where the image is |
//!
//! The transducer's output reaches A0 at no more than 10 kilo-ohm, as a share of the board's 3.3 V, which are the
//! converter's reference and supply the transducer too. A transducer with another supply (`supply = "measured"`: 5 V,
//! say) gives its output to A0 and its supply to A1, through two dividers of one ratio that leave 1.7 to 3.2 V of the
//! supply. A pull-up of about 1 megohm to 3.3 V makes a broken wire read as open.

#[cfg(transducer = "ratiometric")]
use super::SUPPLY_MEASURED;
#[cfg(not(transducer = "ratiometric"))]
use super::i2c::{I2cBus, Wires};
use super::memory::Patient;
#[cfg(transducer = "ratiometric")]
use core::sync::atomic::{AtomicU32, Ordering, fence};
#[cfg(transducer = "ratiometric")]
use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::flash::{self, Bank2Region1, Flash};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::gpio::{Level, OutputOpenDrain, Speed};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Async;
use embassy_stm32::peripherals::{DMA1_CH1, DMA1_CH3, IWDG, USART3};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, RingBufferedUartRx, Uart, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, dma, pac, peripherals};
use embassy_time::Instant;
#[cfg(transducer = "ratiometric")]
use embassy_time::{Duration, Ticker};
use fingertip::report::Microseconds;
use fingertip::telemetry::ResetCause;
#[cfg(transducer = "ratiometric")]
use fingertip::{
    counts::{BLOCK_LENGTH, Block, PERIOD, Ring},
    transducer::ratiometric,
};
use static_cell::ConstStaticCell;

bind_interrupts!(struct Interrupts {
    DMA1_STREAM1 => dma::InterruptHandler<DMA1_CH1>;
    DMA1_STREAM3 => dma::InterruptHandler<DMA1_CH3>;
    FLASH => flash::InterruptHandler;
    USART3 => usart::InterruptHandler<USART3>;
});

#[cfg(not(transducer = "ratiometric"))]
bind_interrupts!(struct BusInterrupts {
    I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
    I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
    DMA1_STREAM0 => dma::InterruptHandler<peripherals::DMA1_CH0>;
    DMA1_STREAM6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
});

/// The crystal oscillator of the ST-LINK.
const HSE: Hertz = Hertz(8_000_000);

/// Half used by reports of 46 bytes each millisecond. From 32 MHz the divider gives 920 863, 0.1 % slow.
const BAUD: u32 = 921_600;

/// The slowest report comes after a transducer's start, 60 ms; the oscillator of the watchdog runs at 17 to 47 kHz for a
/// nominal 32 (DS9405 table 43), so this is 136 to 376 ms.
const WATCHDOG: u32 = 200_000;

/// The crystal is given this many looks to be ready, some 3 ms at the 16 MHz the core starts with (DS9405 table 38: 2 ms).
const LOOKS: u32 = 8_000;

/// The serial port's sender.
pub(crate) type Line = UartTx<'static, Async>;

/// The serial port's receiver.
pub(crate) type Ears = RingBufferedUartRx<'static>;

/// Bytes heard and not yet taken: 2.8 ms of a line that never pauses.
static HEARD: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);

/// Where the calibration lies: the first sectors of bank 2.
pub(crate) type Memory = Patient<Bank2Region1<'static, flash::Async>>;

/// Bytes of each of its two slots: a sector.
pub(crate) const SLOT: u32 = 16 * 1024;

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
    /// What the transducer is on, if anything is to be measured.
    pub(crate) port: Option<Port>,
    /// The way out for frames.
    pub(crate) line: Line,
    /// The way in for commands.
    pub(crate) ears: Ears,
    /// Where the calibration lies.
    pub(crate) memory: Memory,
    /// Running from here on.
    pub(crate) watchdog: Watchdog,
    /// Whether the crystal runs; the chip's own oscillator, 1 % off, has taken its place if not.
    pub(crate) crystal: bool,
}

/// What the transducer is on: the converter, ...
#[cfg(transducer = "ratiometric")]
pub(crate) type Port = Converter;

/// ... or the bus.
#[cfg(not(transducer = "ratiometric"))]
pub(crate) type Port = I2cBus<I2c1>;

impl Board {
    /// Sets up clocks, pins and peripherals. Called once; all failures in here are faults of this file, found by
    /// running the image once.
    ///
    /// After `gave_up` nothing is measured, and what the transducer is on is left alone.
    pub(crate) fn take(gave_up: bool) -> Self {
        let crystal = crystal_runs();
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
        let peripherals = embassy_stm32::init(config);
        let clock = Clock {
            start: Instant::now(),
        };

        let mut watchdog = IndependentWatchdog::new(peripherals.IWDG, WATCHDOG);
        watchdog.unleash();

        #[cfg(transducer = "ratiometric")]
        let port = (!gave_up).then(|| Converter::new(Adc::new(peripherals.ADC1)));
        #[cfg(not(transducer = "ratiometric"))]
        let port = (!gave_up).then_some(I2cBus(I2c1 {
            i2c: peripherals.I2C1,
            clock: peripherals.PB8,
            data: peripherals.PB9,
            sender: peripherals.DMA1_CH6,
            receiver: peripherals.DMA1_CH0,
        }));

        let mut serial = usart::Config::default();
        serial.baudrate = BAUD;
        let (line, ears) = Uart::new(
            peripherals.USART3,
            peripherals.PD9,
            peripherals.PD8,
            peripherals.DMA1_CH3,
            peripherals.DMA1_CH1,
            Interrupts,
            serial,
        )
        .expect("the rate divides from the clock")
        .split();

        steady_bank_2();
        let flash = Flash::new(peripherals.FLASH, Interrupts).into_regions();

        Self {
            clock,
            port,
            line,
            ears: ears.into_ring_buffered(HEARD.take()),
            memory: Patient::new(flash.bank2_region1, 0),
            watchdog,
            crystal,
        }
    }
}

/// Starts the watchdog, and reads and clears the flags of the last reset: all that is done before that reset is counted.
/// Until it is set in [`Board::take`], the watchdog is fed for half a second (RM0090 21.3.3). Every internal reset also pulls the pin, so that one is
/// asked last (RM0090 6.1.1).
pub(crate) fn begin() -> ResetCause {
    pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::START));
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

/// Whether the crystal is ready in time. The clocks' set-up, later, would wait for it for ever.
fn crystal_runs() -> bool {
    pac::RCC.cr().modify(|w| w.set_hsebyp(true));
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    (0..LOOKS).any(|_| pac::RCC.cr().read().hserdy())
}

/// The ring that the converter's DMA fills: see [`Converter`].
#[cfg(transducer = "ratiometric")]
static RING: [Block; 2] = [const { [const { AtomicU32::new(0) }; BLOCK_LENGTH / 2] }; 2];

/// ADC1 on PA3, free-running at 4 MHz, its DMA (stream 0 of DMA2, channel 0) filling [`RING`] without an interrupt: the
/// clock, of the same oscillator, says when a block is there.
///
/// 28 cycles of sampling (7 us, enough for 10 kilo-ohm) and 12 of conversion are 10 us; 100 of them 1 ms to the cycle. Where
/// the supply is measured, every second one is of PC0.
#[cfg(transducer = "ratiometric")]
pub(crate) struct Converter {
    ticker: Ticker,
}

#[cfg(transducer = "ratiometric")]
impl Converter {
    const CHANNEL: u8 = 3;
    const SUPPLY: u8 = 10;
    const SUPPLY_PIN: usize = 0;

    /// The ticks come this long after the end of a block, microseconds.
    const MARGIN: u64 = 20;

    fn new(adc: Adc<'static, peripherals::ADC1>) -> Self {
        // Powered and clocked; dropping it would undo that.
        core::mem::forget(adc);
        pac::GPIOA
            .moder()
            .modify(|w| w.set_moder(usize::from(Self::CHANNEL), pac::gpio::vals::Moder::ANALOG));
        let adc = pac::ADC1;
        adc.smpr2()
            .modify(|w| w.set_smp(usize::from(Self::CHANNEL), SampleTime::CYCLES28));
        adc.sqr1().modify(|w| w.set_l(u8::from(SUPPLY_MEASURED)));
        adc.sqr3().modify(|w| w.set_sq(0, Self::CHANNEL));
        if SUPPLY_MEASURED {
            pac::GPIOC
                .moder()
                .modify(|w| w.set_moder(Self::SUPPLY_PIN, pac::gpio::vals::Moder::ANALOG));
            // The upper channels have a register of their own, from 10 on.
            adc.smpr1()
                .modify(|w| w.set_smp(usize::from(Self::SUPPLY) - 10, SampleTime::CYCLES28));
            adc.sqr3().modify(|w| w.set_sq(1, Self::SUPPLY));
            adc.cr1().modify(|w| w.set_scan(true));
        }
        Self {
            ticker: Ticker::every(Duration::from_micros(u64::from(PERIOD))),
        }
    }
}

#[cfg(transducer = "ratiometric")]
impl ratiometric::Converter for Converter {
    const CONVERSION: u32 = 10;

    fn restart(&mut self) {
        use pac::dma::vals::{Dir, Pl, Size};
        let (adc, dma, stream) = (pac::ADC1, pac::DMA2, pac::DMA2.st(0));
        adc.cr2().write(|_| {});
        stream.cr().write(|_| {});
        // It ends the transfer under way, a few cycles.
        while stream.cr().read().en() {}
        dma.ifcr(0).write(|w| {
            w.set_tcif(0, true);
            w.set_htif(0, true);
            w.set_teif(0, true);
            w.set_dmeif(0, true);
            w.set_feif(0, true);
        });
        stream.par().write_value(adc.dr().as_ptr() as u32);
        stream.m0ar().write_value(RING.as_ptr() as u32);
        stream.ndtr().write(|w| w.set_ndt(Ring::LENGTH as u16));
        stream.cr().write(|w| {
            w.set_chsel(0);
            w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
            w.set_pl(Pl::VERY_HIGH);
            w.set_msize(Size::BITS16);
            w.set_psize(Size::BITS16);
            w.set_minc(true);
            w.set_circ(true);
            w.set_en(true);
        });
        adc.sr().write(|_| {});
        adc.cr2().write(|w| {
            w.set_dma(true);
            w.set_dds(pac::adc::vals::Dds::CONTINUOUS);
            w.set_cont(true);
            w.set_adon(true);
        });
        // It needs 3 us to wake (DS9405 table 74).
        embassy_time::block_for(Duration::from_micros(3));
        adc.cr2().modify(|w| w.set_swstart(true));
        self.ticker.reset_after(Duration::from_micros(Self::MARGIN));
    }

    async fn tick(&mut self) {
        self.ticker.next().await;
    }

    fn position(&self) -> Option<usize> {
        let running = !pac::ADC1.sr().read().ovr();
        let position = Ring::LENGTH - usize::from(pac::DMA2.st(0).ndtr().read().ndt());
        // What the DMA wrote before it counted is there to be read.
        fence(Ordering::SeqCst);
        running.then_some(position)
    }

    fn ring(&self) -> &[Block; 2] {
        &RING
    }
}

/// I2C1 on D15 (PB8, clock) and D14 (PB9, data) at 400 kHz, with pull-ups of 2.2 to 4.7 kilo-ohm on the transducer's
/// side.
#[cfg(not(transducer = "ratiometric"))]
pub(crate) struct I2c1 {
    i2c: embassy_stm32::Peri<'static, peripherals::I2C1>,
    clock: embassy_stm32::Peri<'static, peripherals::PB8>,
    data: embassy_stm32::Peri<'static, peripherals::PB9>,
    sender: embassy_stm32::Peri<'static, peripherals::DMA1_CH6>,
    receiver: embassy_stm32::Peri<'static, peripherals::DMA1_CH0>,
}

#[cfg(not(transducer = "ratiometric"))]
impl Wires for I2c1 {
    fn i2c(&mut self) -> I2c<'_, Async, Master> {
        let mut config = i2c::Config::default();
        config.frequency = Hertz(400_000);
        I2c::new(
            self.i2c.reborrow(),
            self.clock.reborrow(),
            self.data.reborrow(),
            self.sender.reborrow(),
            self.receiver.reborrow(),
            BusInterrupts,
            config,
        )
    }

    fn lines(&mut self) -> [OutputOpenDrain<'_>; 2] {
        [
            OutputOpenDrain::new(self.clock.reborrow(), Level::High, Speed::Low),
            OutputOpenDrain::new(self.data.reborrow(), Level::High, Speed::Low),
        ]
    }
}
