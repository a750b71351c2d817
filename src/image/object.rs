//! The design of an image with `[object]`: tables of the touched object, blended when the object changes.

use super::ImageDesign;
use super::generated::{BALL, LAW, START, TABLES};
use crate::signal::design::{Design, NoSuchObject, Parameters};
use crate::signal::zero::limits::Limits;
use model_tables::material::series::WallSeries;
use model_tables::table::Reading;
use model_tables::table::blend::{blend, last_answered};
use model_tables::table::known::{KnownContact, Lookups, ReadPair};
use model_tables::table::law::{Touched, Weights};
use model_tables::units::{Nanometres, PressureRise};

const WORDS: usize = TABLES.layout.words();
const SEGMENTS: usize = TABLES.segments.len();

/// The design with the tables of what is touched in memory.
#[derive(Clone, Debug)]
pub struct ObjectDesign {
    /// Last input covered, counts.
    maximum: i32,
    segments: [[i32; WORDS]; SEGMENTS],
    read: Option<ReadPair>,
}

impl ObjectDesign {
    /// Touching what the design says.
    pub fn start() -> Self {
        let mut design = Self {
            maximum: TABLES.layout.maximum,
            segments: TABLES.segments,
            read: None,
        };
        // The generator saw to it that the law allows it.
        let _ = design.touch(START);
        design
    }

    fn weigh(&mut self, weights: &Weights) {
        blend(
            &TABLES.layout,
            TABLES.segments.as_flattened(),
            BALL.as_flattened(),
            weights,
            self.segments.as_flattened_mut(),
        );
        self.maximum = last_answered(
            &TABLES.layout,
            weights,
            |rise| TABLES.lookup(rise),
            |rise| TABLES.layout.lookup_in(&self.segments, rise),
        );
    }
}

impl Design for ObjectDesign {
    type Wall = <ImageDesign as Design>::Wall;
    type Around = <ImageDesign as Design>::Around;

    #[inline]
    fn series(&self) -> Option<&WallSeries> {
        ImageDesign.series()
    }

    #[inline]
    fn limits(&self) -> Limits {
        ImageDesign.limits()
    }

    #[inline]
    fn parameters(&self) -> &Parameters {
        const { &ImageDesign::PARAMETERS }
    }

    #[inline]
    fn lookup(&self, rise: PressureRise) -> Reading {
        let held = PressureRise(rise.0.min(self.maximum));
        Reading {
            saturated: rise.0 > self.maximum,
            ..TABLES.layout.lookup_in(&self.segments, held)
        }
    }

    #[inline]
    fn last_rise(&self) -> PressureRise {
        PressureRise(self.maximum)
    }

    #[inline(never)]
    fn touch(&mut self, touched: Touched) -> Result<(), NoSuchObject> {
        let weights = LAW.weights(touched).ok_or(NoSuchObject)?;
        self.weigh(&weights);
        self.read = None;
        Ok(())
    }

    #[inline]
    fn note(&mut self, read: Option<ReadPair>) {
        self.read = read;
    }

    #[inline(never)]
    fn tell(&self, known: Nanometres) -> Option<KnownContact> {
        let lookups = Lookups {
            touched: |rise| self.lookup(rise),
            last: [self.last_rise(), PressureRise(TABLES.layout.maximum)],
            plate: |rise| TABLES.lookup(rise),
            ball: |rise| TABLES.layout.lookup_in(&BALL, rise),
        };
        Some(lookups.tell(&LAW, self.read.as_ref()?, known))
    }
}
