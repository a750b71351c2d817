//! A design that is known only at run time, from a block of a tip's data.

use crate::signal::calibration::Calibration;
use crate::signal::design::{Design, NoSuchObject, Parameters};
use crate::signal::wall::Memory;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::block::BlockError;
use model_tables::block::read::TipBlock;
use model_tables::block::section::SectionKind;
use model_tables::material::relaxation::MAX_TERMS;
use model_tables::material::series::WallSeries;
use model_tables::table::LoadedTables;
use model_tables::table::Reading;
use model_tables::table::blend::BlendedTables;
use model_tables::table::feedback::LoadedFeedback;
use model_tables::table::known::{KnownContact, ReadPair};
use model_tables::table::law::Touched;
use model_tables::table::objects::LoadedObjects;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// A design that is known at run time only.
#[derive(Clone, Copy, Debug)]
pub struct LoadedDesign<'a> {
    parameters: Parameters,
    tables: LoadedTables<'a>,
    relaxation: Option<WallSeries>,
    objects: Option<LoadedObjects<'a>>,
    feedback: Option<LoadedFeedback<'a>>,
    /// Tables for the touched object; `None` for a plate.
    blended: Option<BlendedTables>,
    read: Option<ReadPair>,
}

impl<'a> LoadedDesign<'a> {
    /// Reads the design in a block of a tip's data, and the calibration of that fingertip if the block has one.
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
            parameters: Parameters::of(tip.constants, layout.fraction_bits, end),
            tables: tip.tables,
            relaxation: tip.relaxation,
            objects: tip.objects,
            feedback: tip.feedback,
            blended: None,
            read: None,
        };
        if let Some(objects) = &tip.objects {
            design
                .touch(objects.start)
                .map_err(|NoSuchObject| BlockError::Value(SectionKind::Object, "start"))?;
        }
        Ok((design, calibration))
    }

    /// The same for a tip of a hand: one sample every `period` microseconds, averaged from `codes` codes of the converter.
    #[cfg(tips)]
    #[must_use]
    pub fn of_scan(self, [period, codes]: [u32; 2]) -> Self {
        let Parameters {
            constants,
            pressure_fraction_bits,
            last_rise,
            ..
        } = self.parameters;
        Self {
            parameters: Parameters::of_scan(constants, pressure_fraction_bits, last_rise, [period, codes]),
            ..self
        }
    }
}

impl Design for LoadedDesign<'_> {
    type Wall = Memory<MAX_TERMS>;
    type Around = [Surroundings; 1];

    fn series(&self) -> Option<&WallSeries> {
        self.relaxation.as_ref()
    }

    fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        match &self.blended {
            Some(tables) => tables.lookup(rise),
            None => self.tables.lookup(rise.0).into(),
        }
    }

    fn feedback(&self, rise: PressureRise) -> Option<Micronewtons> {
        let feedback = self.feedback.as_ref()?;
        Some(feedback.lookup(rise))
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
        self.read = None;
        Ok(())
    }

    fn note(&mut self, read: Option<ReadPair>) {
        self.read = read;
    }

    fn tell(&self, known: Nanometres) -> Option<KnownContact> {
        let (objects, read) = (self.objects.as_ref()?, self.read.as_ref()?);
        Some(objects.tell(|rise| self.lookup(rise), self.last_rise(), read, known))
    }
}
