//! Ratiometric transducers of a hand, read by one converter that scans their channels: blocks of scans -> a sample of each
//! transducer, all at one instant, or the reason why there is none.
//!
//! Each scan ends with the chip's internal reference. If a scan has shifted by one place, which can happen after an overrun,
//! another channel's code is there. A code outside [`REFERENCE`] is a fault of every tip, and the converter is restarted. The check
//! cannot detect the shift while that code is in the window: with 10 % to 90 % of the supply over 100 kPa, from 30.1 to 36.9 kPa.

use crate::status::Fault;
use crate::transducer::counts::{
    self, BLOCK_LENGTH, Complete, CountSum, EARLIER, Edges, Found, LATER, Window,
};
use crate::transducer::driver::Sample;
use crate::transducer::ratiometric::Conversion;
use core::sync::atomic::AtomicU32;
use model_tables::constants::Transducer;

/// Codes of the internal reference: 1.18 to 1.24 V (DS9405 table 84, DS11451, embedded voltage reference) of a supply of 3.3 V within 5 %.
pub const REFERENCE: Window = Window {
    short: 1393,
    open: 1620,
};

/// Rows of a block as DMA writes them, two codes a word, the earlier one in its lower half. A row is one scan if the number of
/// ranks is even, and two scans if it is odd ([`row`]). Atomic, because the DMA may write while it is read.
pub type ScanBlock<const ROW: usize, const ROWS: usize> = [[AtomicU32; ROW]; ROWS];

/// Words of a row of scans of `tips` and the internal reference.
pub const fn row(tips: usize) -> usize {
    let ranks = tips + 1;
    if ranks.is_multiple_of(2) { ranks / 2 } else { ranks }
}

/// A free-running converter that scans its channels. Its DMA fills a ring of two blocks.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait ScanConverter<const ROW: usize, const ROWS: usize> {
    /// Time of one block, microseconds.
    const PERIOD: u32;

    /// Starts the converter at the front of the ring, from any state.
    fn restart(&mut self);

    /// Waits until a block has just been filled, once each [`ScanConverter::PERIOD`]. Returns at once if that time is past.
    async fn tick(&mut self);

    /// Number of codes written in the ring, less than its length. `None` if the converter stopped because a code was not
    /// fetched in time.
    fn position(&self) -> Option<usize>;

    /// The ring.
    fn ring(&self) -> &[ScanBlock<ROW, ROWS>; 2];
}

/// The transducers of a hand on a converter.
#[derive(Debug)]
pub struct Scan<C, const TIPS: usize, const ROW: usize, const ROWS: usize> {
    converter: C,
    started: bool,
    last: usize,
    /// Window edges for each word of a row.
    edges: [Edges; ROW],
    tips: [Conversion; TIPS],
    /// The last samples. They are kept here, because moving them is expensive.
    samples: [Result<Sample, Fault>; TIPS],
}

/// Data of one rank in a block.
#[derive(Clone, Copy, Default)]
struct Rank {
    /// At most 50 * 4095 < 2^18.
    total: u32,
    open: bool,
    short: bool,
}

impl Rank {
    /// The sum of the codes.
    ///
    /// # Errors
    /// [`Fault::SensorOpen`] or [`Fault::SensorShort`] if even one code is outside its window.
    const fn sum(self) -> Result<u32, Fault> {
        if self.open {
            Err(Fault::SensorOpen)
        } else if self.short {
            Err(Fault::SensorShort)
        } else {
            Ok(self.total)
        }
    }
}

impl<C: ScanConverter<ROW, ROWS>, const TIPS: usize, const ROW: usize, const ROWS: usize>
    Scan<C, TIPS, ROW, ROWS>
{
    const RANKS: usize = TIPS + 1;

    /// Codes of a block.
    const BLOCK: usize = 2 * ROW * ROWS;

    /// Scans in a block, which is the number of codes of each rank.
    const SCANS: u32 = (Self::BLOCK / Self::RANKS) as u32;

    /// The transducers, in the order of the scan's ranks.
    ///
    /// # Panics
    /// If one is not ratiometric.
    pub fn new(transducers: [Transducer; TIPS], converter: C) -> Self {
        const { assert!(ROW == row(TIPS) && ROWS > 0) };
        let window = |rank: usize| {
            let tip = transducers.get(rank % Self::RANKS);
            tip.map_or(REFERENCE, |tip| Window::of(&tip.kind))
        };
        Self {
            converter,
            started: false,
            last: 0,
            edges: core::array::from_fn(|word| Edges::of([window(2 * word), window(2 * word + 1)])),
            tips: transducers.each_ref().map(Conversion::of),
            samples: [Err(Fault::SamplesLost); TIPS],
        }
    }

    /// The next samples, or the reason why there are none. A fault of a line affects its tip only; a fault of the converter affects all tips.
    pub async fn next(&mut self) -> &[Result<Sample, Fault>; TIPS] {
        if !self.started {
            self.converter.restart();
            self.started = true;
            self.last = 0;
        }
        self.converter.tick().await;
        if let Err((fault, restart)) = self.block() {
            self.started = !restart;
            self.samples = [Err(fault); TIPS];
        }
        &self.samples
    }

    /// Takes the samples of the last block, or returns a fault and whether the converter must be restarted.
    fn block(&mut self) -> Result<(), (Fault, bool)> {
        let position = self.converter.position().ok_or((Fault::SamplesLost, true))?;
        let Complete { half, since } = counts::look(&mut self.last, position, Self::BLOCK)
            .map_err(|fault| (fault, fault == Fault::ConverterStalled))?;
        let (tips, reference) = self.add_up(half);
        if reference.sum().is_err() {
            return Err((Fault::ChannelIdentity, true));
        }
        let age = C::PERIOD / 2 + since * C::PERIOD / Self::BLOCK as u32;
        for ((sample, conversion), rank) in self.samples.iter_mut().zip(&self.tips).zip(&tips) {
            *sample = rank.sum().map(|total| Sample {
                age,
                ..conversion.sample(Self::of_a_hundred(total), 0)
            });
        }
        let now = self.converter.position();
        if now.is_some_and(|now| self.last / Self::BLOCK == now / Self::BLOCK % 2) {
            Ok(())
        } else {
            Err((Fault::SamplesLost, false))
        }
    }

    /// Adds up a block: the data of each tip, and of the internal reference.
    fn add_up(&self, half: usize) -> ([Rank; TIPS], Rank) {
        let block = &self.converter.ring()[half];
        let (mut tips, mut reference) = ([Rank::default(); TIPS], Rank::default());
        let mut number = 0;
        let mut take = |total: u32, open: u32, short: u32| {
            let rank = tips.get_mut(number).unwrap_or(&mut reference);
            rank.total += total;
            rank.open |= open != 0;
            rank.short |= short != 0;
            number = if number == TIPS { 0 } else { number + 1 };
        };
        for (word, &edges) in self.edges.iter().enumerate() {
            let Found { totals, open, short } = counts::add_up_column(block, word, edges);
            take(totals[0], open & EARLIER, short & EARLIER);
            take(totals[1], open & LATER, short & LATER);
        }
        (tips, reference)
    }

    /// Scales a total to the sum of a block of a single transducer. Intermediate values are at most 50 * 4095 * 100 < 2^25.
    const fn of_a_hundred(total: u32) -> CountSum {
        CountSum((total * BLOCK_LENGTH as u32 + Self::SCANS / 2) / Self::SCANS)
    }
}

#[cfg(test)]
mod tests;
