//! The fingertip that a signal path is for: folded into the code of an image, or loaded at run time.

use crate::signal::calibration::Calibration;
use crate::signal::filter::Leaps;
use crate::signal::fluid::Fall;
use crate::signal::scale::Scale;
use crate::signal::touch::Thresholds;
use crate::signal::uncertainty::Uncertainty;
use crate::signal::wall::{Memory, Wall};
use crate::signal::zero::limits::{Limits, Rates};
use crate::signal::zero::surroundings::{Around, Surroundings};
use model_tables::block::BlockError;
use model_tables::block::read::TipBlock;
use model_tables::block::section::SectionKind;
use model_tables::constants::DesignConstants;
use model_tables::material::relaxation::MAX_TERMS;
use model_tables::material::series::WallSeries;
use model_tables::table::Reading;
use model_tables::table::loaded::LoadedTables;
use model_tables::units::PressureRise;

/// A design with its tables.
pub trait Design {
    /// What its wall remembers.
    type Wall: Wall;
    /// Room for what is measured around the fingertip and moves its zero.
    type Around: Around;

    /// What the signal path needs of the design beside its tables.
    fn parameters(&self) -> &Parameters;

    /// The wall in time; nothing of an elastic one.
    fn series(&self) -> Option<&WallSeries> {
        None
    }

    /// The limits of a zero among them: a copy, which in an image leaves nothing of the others.
    fn limits(&self) -> Limits {
        self.parameters().limits
    }

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    fn lookup(&self, rise: PressureRise) -> Reading;
}

/// What the stages need of a design, each in its own form, worked out once: by the compiler for an image.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Parameters {
    /// The design itself.
    pub constants: DesignConstants,
    /// `k`: pressures are counted in `1 / 2^k` pascal, 0 to 16.
    pub pressure_fraction_bits: u32,
    /// The last rise that the tables cover; beyond it they are saturated.
    pub last_rise: PressureRise,
    /// Below this rise a reading is flagged.
    pub lowest_rest: PressureRise,
    /// A pressure below the transducer's range, millipascals, may be lower than it is read.
    pub lowest_read: i32,
    /// From one sample to the next, microseconds.
    pub period: u32,
    /// Of the transducer's pressure.
    pub scale: Scale,
    /// Of a zero, without a stored calibration.
    pub limits: Limits,
    /// Of what is measured around the fingertip and moves a zero.
    pub rates: Rates,
    /// Of the filter.
    pub leaps: Leaps,
    /// Of a touch.
    pub thresholds: Thresholds,
    /// Of the zero, when it is a leak.
    pub fall: Fall,
    /// Of a rise.
    pub uncertainty: Uncertainty,
}

impl Parameters {
    /// For a design whose tables count pressures in `1 / 2^fraction_bits` pascal and end at `last_rise`.
    ///
    /// # Panics
    /// For more than 16 fraction bits: at compile time for an image; loaded tables have no more.
    pub const fn of(constants: DesignConstants, fraction_bits: u32, last_rise: PressureRise) -> Self {
        let period = constants.transducer.kind.period();
        let limits = Limits::of(&constants, fraction_bits);
        Self {
            pressure_fraction_bits: fraction_bits,
            last_rise,
            lowest_rest: constants.transducer.lowest_rest(fraction_bits),
            lowest_read: constants.transducer.range[0].saturating_mul(1000),
            period,
            scale: Scale::of(fraction_bits),
            limits,
            rates: Rates::of(&constants, fraction_bits),
            leaps: Leaps::of(&constants, fraction_bits, period),
            thresholds: Thresholds::of(&constants, fraction_bits),
            fall: Fall::of(&constants, fraction_bits, &limits),
            uncertainty: Uncertainty::of(&constants, fraction_bits),
            constants,
        }
    }

    /// Two samples further apart than this are not next to each other, microseconds.
    pub const fn gap(&self) -> u64 {
        20 * self.period as u64
    }
}

/// A design that is known at run time only.
#[derive(Clone, Copy, Debug)]
pub struct LoadedDesign<'a> {
    parameters: Parameters,
    tables: LoadedTables<'a>,
    relaxation: Option<WallSeries>,
}

impl<'a> LoadedDesign<'a> {
    /// The design in a block of a tip's data, with what is stored there of the one fingertip.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn read(block: &'a [u8]) -> Result<(Self, Option<Calibration>), BlockError> {
        let tip = TipBlock::read(block)?;
        let calibration = match &tip.calibration {
            None => None,
            Some(stored) => Some(
                Calibration::stored(stored, tip.constants.transducer.range)
                    .ok_or(BlockError::Value(SectionKind::Calibration, "a value"))?,
            ),
        };
        let layout = tip.tables.layout();
        let end = PressureRise(layout.maximum);
        let design = Self {
            parameters: Parameters::of(tip.constants, layout.pressure_fraction_bits, end),
            tables: tip.tables,
            relaxation: tip.relaxation,
        };
        Ok((design, calibration))
    }
}

impl Design for LoadedDesign<'_> {
    type Wall = Memory<MAX_TERMS>;

    fn series(&self) -> Option<&WallSeries> {
        self.relaxation.as_ref()
    }
    type Around = [Surroundings; 1];

    fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        self.tables.lookup(rise)
    }
}
