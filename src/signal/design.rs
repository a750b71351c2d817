//! The fingertip that a signal path is for: folded into the code of an image, or loaded at run time.

use crate::signal::calibration::Calibration;
use crate::signal::filter::Leaps;
use crate::signal::fluid::Fall;
use crate::signal::scale::Scale;
use crate::signal::touch::Thresholds;
use crate::signal::uncertainty::Uncertainty;
use crate::signal::zero::limits::Limits;
use crate::transducer;
use model_tables::block::BlockError;
use model_tables::block::read::TipBlock;
use model_tables::block::section::SectionKind;
use model_tables::constants::DesignConstants;
use model_tables::table::Reading;
use model_tables::table::blend::BlendedTables;
use model_tables::table::law::Touched;
use model_tables::table::loaded::LoadedTables;
use model_tables::table::objects::LoadedObjects;
use model_tables::units::PressureRise;

/// A design with its tables.
pub trait Design {
    /// What the signal path needs of the design beside its tables.
    fn parameters(&self) -> &Parameters;

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    fn lookup(&self, rise: PressureRise) -> Reading;

    /// The last rise that the lookup covers now.
    #[inline]
    fn last_rise(&self) -> PressureRise {
        self.parameters().last_rise
    }

    /// Something else is touched from now on. A design without `[object]` has tables of the plate alone.
    ///
    /// # Errors
    /// [`NoSuchObject`]; what was touched before still is.
    fn touch(&mut self, _touched: Touched) -> Result<(), NoSuchObject> {
        Err(NoSuchObject)
    }
}

/// There are no tables of an object: the design has none, or its radius is tighter than what was solved.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct NoSuchObject;

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
    /// From one sample to the next, microseconds.
    pub period: u32,
    /// Of the transducer's pressure.
    pub scale: Scale,
    /// Of a zero, without a stored calibration.
    pub limits: Limits,
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
        let period = transducer::period(&constants.transducer.kind);
        let limits = Limits::of(&constants, fraction_bits);
        Self {
            pressure_fraction_bits: fraction_bits,
            last_rise,
            lowest_rest: constants.transducer.lowest_rest(fraction_bits),
            period,
            scale: Scale::of(fraction_bits),
            limits,
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
    objects: Option<LoadedObjects<'a>>,
    /// Of what is touched, unless that is a plate.
    blended: Option<BlendedTables>,
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
        let mut design = Self {
            parameters: Parameters::of(tip.constants, layout.pressure_fraction_bits, end),
            tables: tip.tables,
            objects: tip.objects,
            blended: None,
        };
        if let Some(objects) = &tip.objects {
            design
                .touch(objects.start)
                .map_err(|NoSuchObject| BlockError::Value(SectionKind::Object, "start"))?;
        }
        Ok((design, calibration))
    }
}

impl Design for LoadedDesign<'_> {
    fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        match &self.blended {
            Some(tables) => tables.lookup(rise),
            None => self.tables.lookup(rise),
        }
    }

    fn last_rise(&self) -> PressureRise {
        match &self.blended {
            Some(tables) => tables.last_rise(),
            None => self.parameters.last_rise,
        }
    }

    fn touch(&mut self, touched: Touched) -> Result<(), NoSuchObject> {
        let objects = self.objects.as_ref().ok_or(NoSuchObject)?;
        self.blended = match touched {
            Touched::Plate => None,
            touched => Some(objects.blended(touched).ok_or(NoSuchObject)?),
        };
        Ok(())
    }
}
