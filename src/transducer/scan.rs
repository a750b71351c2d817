//! Ratiometric transducers of a hand, read by one converter that scans their channels: blocks of scans -> a sample of each, all of
//! one instant, or why there is none.
//!
//! Each scan ends with the chip's internal reference. A scan that has shifted by a place, as the part's may after an overrun,
//! puts another channel's code there: outside of [`REFERENCE`] it is a fault of every tip, and the converter is started anew. The
//! check is blind while the code that comes to that place happens to be in the window: with 10 % to 90 % of the supply over
//! 100 kPa, from 30.1 to 36.9 kPa.

use crate::status::Fault;
use crate::transducer::counts::{self, BLOCK_LENGTH, Complete, CountSum, FULL_SCALE, Window};
use crate::transducer::driver::Sample;
use crate::transducer::ratiometric::Conversion;
use core::sync::atomic::{AtomicU16, Ordering};
use model_tables::constants::Transducer;

/// Codes of the internal reference: 1.18 to 1.24 V (DS9405 table 84, DS11451, embedded voltage reference) of a supply of 3.3 V within 5 %.
pub const REFERENCE: Window = Window {
    short: 1393,
    open: 1620,
};

/// Scans as DMA writes them, a code for each rank; the last rank is the internal reference's. Atomic, because the DMA may write
/// while it is read.
pub type ScanBlock<const RANKS: usize, const SCANS: usize> = [[AtomicU16; RANKS]; SCANS];

/// A converter that scans for ever and whose DMA fills a ring of two blocks.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait ScanConverter<const RANKS: usize, const SCANS: usize> {
    /// One block, microseconds.
    const PERIOD: u32;

    /// Starts it at the front of the ring, also from any state it is stuck in.
    fn restart(&mut self);

    /// Waits until a block has just been filled: once a [`ScanConverter::PERIOD`], at once when that is past.
    async fn tick(&mut self);

    /// Codes of the ring that are written, less than its length; nothing if it stopped because a code was not fetched
    /// in time.
    fn position(&self) -> Option<usize>;

    /// The ring.
    fn ring(&self) -> &[ScanBlock<RANKS, SCANS>; 2];
}

/// The transducers of a hand on a converter.
#[derive(Debug)]
pub struct Scan<C, const TIPS: usize, const RANKS: usize, const SCANS: usize> {
    converter: C,
    started: bool,
    last: usize,
    tips: [(Window, Conversion); TIPS],
}

impl<C: ScanConverter<RANKS, SCANS>, const TIPS: usize, const RANKS: usize, const SCANS: usize>
    Scan<C, TIPS, RANKS, SCANS>
{
    const BLOCK: usize = RANKS * SCANS;

    /// The transducers, in the order of the scan's ranks.
    ///
    /// # Panics
    /// If one is not ratiometric.
    pub fn new(transducers: [Transducer; TIPS], converter: C) -> Self {
        const { assert!(RANKS == TIPS + 1 && SCANS > 0) };
        Self {
            converter,
            started: false,
            last: 0,
            tips: transducers.map(|transducer| (Window::of(&transducer.kind), Conversion::of(&transducer))),
        }
    }

    /// The next samples, or the reason why there are none: of a tip's line its own, of the converter all tips'.
    pub async fn next(&mut self) -> [Result<Sample, Fault>; TIPS] {
        if !self.started {
            self.converter.restart();
            self.started = true;
            self.last = 0;
        }
        self.converter.tick().await;
        match self.block() {
            Ok(samples) => samples,
            Err((fault, restart)) => {
                self.started = !restart;
                [Err(fault); TIPS]
            }
        }
    }

    /// The samples of the last block, or a fault and whether the converter has to be started anew.
    fn block(&mut self) -> Result<[Result<Sample, Fault>; TIPS], (Fault, bool)> {
        let position = self.converter.position().ok_or((Fault::SamplesLost, true))?;
        let Complete { half, since } = counts::look(&mut self.last, position, Self::BLOCK)
            .map_err(|fault| (fault, fault == Fault::ConverterStalled))?;
        let block = &self.converter.ring()[half];
        if sum(block, TIPS, REFERENCE).is_err() {
            return Err((Fault::ChannelIdentity, true));
        }
        let late = since * C::PERIOD / Self::BLOCK as u32;
        let mut rank = 0;
        let samples = self.tips.each_ref().map(|(window, conversion)| {
            let total = sum(block, rank, *window);
            rank += 1;
            total.map(|total| Sample {
                age: C::PERIOD / 2 + late,
                ..conversion.sample(of_a_hundred::<SCANS>(total), 0)
            })
        });
        let now = self.converter.position();
        if now.is_some_and(|now| self.last / Self::BLOCK == now / Self::BLOCK % 2) {
            Ok(samples)
        } else {
            Err((Fault::SamplesLost, false))
        }
    }
}

/// The sum that a block of a single transducer would have: at most 50 * 4095 * 100 < 2^25 on the way.
const fn of_a_hundred<const SCANS: usize>(total: u32) -> CountSum {
    let scans = SCANS as u32;
    CountSum((total * BLOCK_LENGTH as u32 + scans / 2) / scans)
}

/// The codes of a rank added up, at most 50 * 4095 < 2^18.
///
/// # Errors
/// [`Fault::SensorOpen`] or [`Fault::SensorShort`] when even one code lies outside of the window.
fn sum<const RANKS: usize, const SCANS: usize>(
    block: &ScanBlock<RANKS, SCANS>,
    rank: usize,
    window: Window,
) -> Result<u32, Fault> {
    const BIT: u32 = 1 << 15;
    let end = FULL_SCALE + 1;
    // Added to a code, each sets bit 15 exactly from the window's edge on.
    let from_open = BIT - u32::from(window.open.min(end));
    let above_short = BIT - 1 - u32::from(window.short.min(FULL_SCALE));
    let (mut total, mut open, mut inside) = (0, 0, u32::MAX);
    for code in block.as_flattened().iter().skip(rank).step_by(RANKS) {
        let code = u32::from(code.load(Ordering::Relaxed));
        total += code;
        open |= code + from_open;
        inside &= code + above_short;
    }
    if open & BIT != 0 {
        Err(Fault::SensorOpen)
    } else if inside & BIT == 0 {
        Err(Fault::SensorShort)
    } else {
        Ok(total)
    }
}

#[cfg(test)]
mod tests;
