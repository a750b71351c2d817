//! The chip's converter for a hand: free-running scans of the tips' channels and the internal reference. The DMA fills a ring of
//! two blocks of scans.

use super::chip;
use crate::image::{CHANNELS, PERIOD, ROW, ROWS, SCANS, TIPS};
use crate::transducer::scan::{ScanBlock, ScanConverter};
use core::sync::atomic::{AtomicU32, Ordering, fence};
use embassy_stm32::Peri;
use embassy_stm32::peripherals::ADC1;
use embassy_time::{Duration, Ticker};

/// Time of one conversion of a tip's channel, microseconds.
const CONVERSION: u32 = 10;

/// Checks that the period of the build script is that of the converter.
const _: () = assert!(PERIOD == SCANS as u32 * (CONVERSION * TIPS as u32 + chip::IDENTITY_CONVERSION));

/// Number of codes in the ring.
const LENGTH: usize = 2 * 2 * ROW * ROWS;

/// The ring that the converter's DMA fills.
static RING: [ScanBlock<ROW, ROWS>; 2] = [const { [const { [const { AtomicU32::new(0) }; ROW] }; ROWS] }; 2];

/// ADC1 on the pins of the hand's channels.
pub struct DmaScan {
    ticker: Ticker,
}

impl DmaScan {
    /// The ticks come this long after the end of a block, microseconds.
    const MARGIN: u64 = 20;

    pub(super) fn new(adc: Peri<'static, ADC1>) -> Self {
        chip::power_converter(adc);
        chip::set_up_scan(&CHANNELS);
        Self {
            ticker: Ticker::every(Duration::from_micros(u64::from(PERIOD))),
        }
    }
}

impl ScanConverter<ROW, ROWS> for DmaScan {
    const PERIOD: u32 = PERIOD;

    fn restart(&mut self) {
        chip::restart_converter(RING.as_ptr() as u32, LENGTH as u16);
        self.ticker.reset_after(Duration::from_micros(Self::MARGIN));
    }

    async fn tick(&mut self) {
        self.ticker.next().await;
    }

    fn position(&self) -> Option<usize> {
        let running = chip::converter_runs();
        let position = LENGTH - usize::from(chip::conversions_left());
        // The fence makes the DMA's data visible before its count is used.
        fence(Ordering::SeqCst);
        running.then_some(position)
    }

    fn ring(&self) -> &[ScanBlock<ROW, ROWS>; 2] {
        &RING
    }
}
