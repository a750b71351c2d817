//! NUCLEO-L432KC (ST user manual UM1956): STM32L432KC at 24 MHz, small and frugal, ST-LINK/V2-1 with a serial port.
//!
//! | what | where | why |
//! |---|---|---|
//! | clock | HSI16 | no crystal is fitted but the 32 kHz one; 1 % off at most (DS11451 table 49) is enough for the serial port |
//! | transducer, analogue | PA0, `ADC1_IN5` | A0 of the Nano header (UM1956 table 9) |
//! | its supply, where it is measured | PA1, `ADC1_IN6` | A1 of that header |
//! | transducer, bus | PB6, PB7, I2C1 | D5 and D4 of that header, with pull-ups at the transducer; A5 and A4 (PA5, PA6) are wired to them by default (SB16, SB18) and stay inputs |
//! | serial port | PA2, PA15, USART2 | the ST-LINK's virtual COM port by default (UM1956 6.8) |
//! | calibration | the last two pages of flash, 2 KB each | erasing one stalls the code for 25 ms at most (DS11451 table 58): samples are lost, which is said |
//!
//! The transducer's output reaches A0 at no more than 10 kilo-ohm, as a share of the board's 3.3 V, which are the
//! converter's reference and supply the transducer too. A transducer with another supply (`supply = "measured"`: 5 V,
//! say) gives its output to A0 and its supply to A1, through two dividers of one ratio that leave 1.7 to 3.2 V of the
//! supply. A pull-up of about 1 megohm to 3.3 V makes a broken wire read as open.
//!
//! 24 MHz is the slowest from which the converter's and the serial port's clock divide, and below the 26 MHz of the lower
//! core voltage. Between samples the core sleeps; the converter needs the clocks, so it does not stop.

#[cfg(transducer = "ratiometric")]
use super::SUPPLY_MEASURED;
#[cfg(not(transducer = "ratiometric"))]
use super::i2c::{I2cBus, Wires};
use super::memory::Patient;
#[cfg(transducer = "ratiometric")]
use core::sync::atomic::{AtomicU32, Ordering, fence};
#[cfg(transducer = "ratiometric")]
use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::flash::{self, Bank1Region, Flash};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::gpio::{Level, OutputOpenDrain, Speed};
#[cfg(not(transducer = "ratiometric"))]
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Async;
use embassy_stm32::peripherals::{DMA1_CH6, DMA1_CH7, IWDG, USART2};
use embassy_stm32::rcc::{Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux};
#[cfg(not(transducer = "ratiometric"))]
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
    DMA1_CHANNEL6 => dma::InterruptHandler<DMA1_CH6>;
    DMA1_CHANNEL7 => dma::InterruptHandler<DMA1_CH7>;
    FLASH => flash::InterruptHandler;
    USART2 => usart::InterruptHandler<USART2>;
});

#[cfg(not(transducer = "ratiometric"))]
bind_interrupts!(struct BusInterrupts {
    I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
    I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
    DMA2_CHANNEL6 => dma::InterruptHandler<peripherals::DMA2_CH6>;
    DMA2_CHANNEL7 => dma::InterruptHandler<peripherals::DMA2_CH7>;
});

/// Half used by reports of 46 bytes each millisecond. From 24 MHz the divider gives 923 077, 0.2 % fast.
const BAUD: u32 = 921_600;

/// The slowest report comes after a transducer's start, 60 ms; the oscillator of the watchdog runs at 29.5 to 34 kHz
/// (DS11451 table 52), so this is 188 to 217 ms.
const WATCHDOG: u32 = 200_000;

/// The serial port's sender.
pub(crate) type Line = UartTx<'static, Async>;

/// The serial port's receiver.
pub(crate) type Ears = RingBufferedUartRx<'static>;

/// Bytes heard and not yet taken: 2.8 ms of a line that never pauses.
static HEARD: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);

/// Where the calibration lies: behind the image.
pub(crate) type Memory = Patient<Bank1Region<'static, flash::Async>>;

/// Bytes of each of its two slots: a page.
pub(crate) const SLOT: u32 = 2 * 1024;

/// The first of them, from the start of the flash.
pub(super) const CALIBRATION: u32 = 256 * 1024 - 2 * SLOT;

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
    /// Always: there is none that could fail.
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
            clock: peripherals.PB6,
            data: peripherals.PB7,
            sender: peripherals.DMA2_CH7,
            receiver: peripherals.DMA2_CH6,
        }));

        let mut serial = usart::Config::default();
        serial.baudrate = BAUD;
        let (line, ears) = Uart::new(
            peripherals.USART2,
            peripherals.PA15,
            peripherals.PA2,
            peripherals.DMA1_CH7,
            peripherals.DMA1_CH6,
            Interrupts,
            serial,
        )
        .expect("the rate divides from the clock")
        .split();
        let flash = Flash::new(peripherals.FLASH, Interrupts).into_regions();

        Self {
            clock,
            port,
            line,
            ears: ears.into_ring_buffered(HEARD.take()),
            memory: Patient::new(flash.bank1_region, CALIBRATION),
            watchdog,
            crystal: true,
        }
    }
}

/// Starts the watchdog, and reads and clears the flags of the last reset: all that is done before that reset is counted.
/// Until it is set in [`Board::take`], the watchdog is fed for half a second (RM0394 36.3.2). Every internal reset also pulls the pin, so that one is
/// asked last, and a brown-out is a power-on too (RM0394 6.1.1).
pub(crate) fn begin() -> ResetCause {
    pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::START));
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|register| register.set_rmvf(true));
    if flags.iwdgrstf() || flags.wwdgrstf() {
        ResetCause::Watchdog
    } else if flags.lpwrrstf() {
        ResetCause::LowPower
    } else if flags.sftrstf() {
        ResetCause::Software
    } else if flags.borrstf() {
        ResetCause::PowerOn
    } else if flags.pinrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}

/// The ring that the converter's DMA fills: see [`Converter`].
#[cfg(transducer = "ratiometric")]
static RING: [Block; 2] = [const { [const { AtomicU32::new(0) }; BLOCK_LENGTH / 2] }; 2];

/// ADC1 on PA0, free-running at 6 MHz, its DMA (channel 1 of DMA1, request 0) filling [`RING`] without an interrupt: the
/// clock, of the same oscillator, says when a block is there.
///
/// 47.5 cycles of sampling (7.9 us, enough for 10 kilo-ohm) and 12.5 of conversion are 10 us; 100 of them 1 ms to the
/// cycle. Where the supply is measured, every second one is of PA1.
#[cfg(transducer = "ratiometric")]
pub(crate) struct Converter {
    ticker: Ticker,
}

#[cfg(transducer = "ratiometric")]
impl Converter {
    const CHANNEL: u8 = 5;
    const PIN: usize = 0;
    const SUPPLY: u8 = 6;
    const SUPPLY_PIN: usize = 1;

    /// The ticks come this long after the end of a block, microseconds.
    const MARGIN: u64 = 20;

    fn new(adc: Adc<'static, peripherals::ADC1>) -> Self {
        // Powered, clocked and calibrated; dropping it would undo that.
        core::mem::forget(adc);
        pac::GPIOA
            .moder()
            .modify(|w| w.set_moder(Self::PIN, pac::gpio::vals::Moder::ANALOG));
        // The core's 24 MHz by four, in step with it.
        pac::ADC1_COMMON.ccr().modify(|w| w.set_ckmode(0b11));
        let adc = pac::ADC1;
        adc.smpr(0)
            .modify(|w| w.set_smp(usize::from(Self::CHANNEL), SampleTime::CYCLES47_5));
        adc.sqr1().modify(|w| {
            w.set_l(u8::from(SUPPLY_MEASURED));
            w.set_sq(0, Self::CHANNEL);
        });
        if SUPPLY_MEASURED {
            pac::GPIOA
                .moder()
                .modify(|w| w.set_moder(Self::SUPPLY_PIN, pac::gpio::vals::Moder::ANALOG));
            adc.smpr(0)
                .modify(|w| w.set_smp(usize::from(Self::SUPPLY), SampleTime::CYCLES47_5));
            adc.sqr1().modify(|w| w.set_sq(1, Self::SUPPLY));
        }
        adc.cfgr().modify(|w| {
            w.set_cont(true);
            w.set_dmaen(true);
            w.set_dmacfg(pac::adc::vals::Dmacfg::CIRCULAR);
        });
        adc.isr().write(|w| w.set_adrdy(true));
        adc.cr().modify(|w| w.set_aden(true));
        while !adc.isr().read().adrdy() {}
        Self {
            ticker: Ticker::every(Duration::from_micros(u64::from(PERIOD))),
        }
    }
}

#[cfg(transducer = "ratiometric")]
impl ratiometric::Converter for Converter {
    const CONVERSION: u32 = 10;

    fn restart(&mut self) {
        use pac::bdma::vals::{Dir, Pl, Size};
        let (adc, dma, channel) = (pac::ADC1, pac::DMA1, pac::DMA1.ch(0));
        if adc.cr().read().adstart() {
            adc.cr().modify(|w| w.set_adstp(true));
            // It ends the conversion under way, 10 us.
            while adc.cr().read().adstart() {}
        }
        channel.cr().write(|_| {});
        dma.ifcr().write(|w| w.set_gif(0, true));
        dma.cselr().modify(|w| w.set_cs(0, 0));
        channel.par().write_value(adc.dr().as_ptr() as u32);
        channel.mar().write_value(RING.as_ptr() as u32);
        channel.ndtr().write(|w| w.set_ndt(Ring::LENGTH as u16));
        channel.cr().write(|w| {
            w.set_dir(Dir::FROM_PERIPHERAL);
            w.set_pl(Pl::VERY_HIGH);
            w.set_msize(Size::BITS16);
            w.set_psize(Size::BITS16);
            w.set_minc(true);
            w.set_circ(true);
            w.set_en(true);
        });
        adc.isr().write(|w| w.set_ovr(true));
        adc.cr().modify(|w| w.set_adstart(true));
        self.ticker.reset_after(Duration::from_micros(Self::MARGIN));
    }

    async fn tick(&mut self) {
        self.ticker.next().await;
    }

    fn position(&self) -> Option<usize> {
        let running = !pac::ADC1.isr().read().ovr();
        let position = Ring::LENGTH - usize::from(pac::DMA1.ch(0).ndtr().read().ndt());
        // What the DMA wrote before it counted is there to be read.
        fence(Ordering::SeqCst);
        running.then_some(position)
    }

    fn ring(&self) -> &[Block; 2] {
        &RING
    }
}

/// I2C1 on D5 (PB6, clock) and D4 (PB7, data) at 400 kHz, with pull-ups of 2.2 to 4.7 kilo-ohm on the transducer's
/// side.
#[cfg(not(transducer = "ratiometric"))]
pub(crate) struct I2c1 {
    i2c: embassy_stm32::Peri<'static, peripherals::I2C1>,
    clock: embassy_stm32::Peri<'static, peripherals::PB6>,
    data: embassy_stm32::Peri<'static, peripherals::PB7>,
    sender: embassy_stm32::Peri<'static, peripherals::DMA2_CH7>,
    receiver: embassy_stm32::Peri<'static, peripherals::DMA2_CH6>,
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
