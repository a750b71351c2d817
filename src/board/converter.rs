//! The chip's free-running converter. Its DMA fills a ring of two blocks without an interrupt. The clock, from the same oscillator,
//! shows when a block is complete.

use super::chip;
use crate::image::ImageDesign;
use crate::transducer::counts::{BLOCK_LENGTH, Block, PERIOD, Ring};
use crate::transducer::ratiometric;
use core::sync::atomic::{AtomicU32, Ordering, fence};
use embassy_stm32::Peri;
use embassy_stm32::peripherals::ADC1;
use embassy_time::{Duration, Ticker};

/// Whether the transducer has its own supply, which is measured beside its output. If so, every second conversion measures the
/// supply.
const SUPPLY_MEASURED: bool = ratiometric::supply_measured(&ImageDesign::CONSTANTS.transducer);

/// The ring that the converter's DMA fills.
static RING: [Block; 2] = [const { [const { AtomicU32::new(0) }; BLOCK_LENGTH / 2] }; 2];

/// ADC1 on the board's analogue pins.
pub struct DmaConverter {
    ticker: Ticker,
}

impl DmaConverter {
    /// The ticks come this long after the end of a block, microseconds.
    const MARGIN: u64 = 20;

    pub(super) fn new(adc: Peri<'static, ADC1>) -> Self {
        chip::power_converter(adc);
        chip::set_up_converter(SUPPLY_MEASURED);
        Self {
            ticker: Ticker::every(Duration::from_micros(u64::from(PERIOD))),
        }
    }
}

impl ratiometric::Converter for DmaConverter {
    const CONVERSION: u32 = 10;

    fn restart(&mut self) {
        chip::restart_converter(RING.as_ptr() as u32, Ring::LENGTH as u16);
        self.ticker.reset_after(Duration::from_micros(Self::MARGIN));
    }

    async fn tick(&mut self) {
        self.ticker.next().await;
    }

    fn position(&self) -> Option<usize> {
        let running = chip::converter_runs();
        let position = Ring::LENGTH - usize::from(chip::conversions_left());
        // The fence makes the DMA's data visible before its count is used.
        fence(Ordering::SeqCst);
        running.then_some(position)
    }

    fn ring(&self) -> &[Block; 2] {
        &RING
    }
}
