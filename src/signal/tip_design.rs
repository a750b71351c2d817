//! The design of a board that a tip can be loaded onto (feature `load-tip`): the image's own, or a loaded one.

use crate::signal::design::{Design, NoSuchObject, Parameters};
use crate::signal::loaded_design::LoadedDesign;
use crate::signal::wall::Memory;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::material::relaxation::MAX_TERMS;
use model_tables::material::series::WallSeries;
use model_tables::table::Reading;
#[cfg(band)]
use model_tables::table::band::ChipBand;
use model_tables::table::known::{KnownContact, ReadPair};
use model_tables::table::law::Touched;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// A loaded design, or the design compiled into the image.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // one for a board, made once
pub enum TipDesign<'a, I> {
    /// The design of the image.
    Image(I),
    /// The design of a block in the flash.
    Loaded(LoadedDesign<'a>),
}

impl<I: Design> Design for TipDesign<'_, I> {
    type Wall = Memory<MAX_TERMS>;
    type Around = [Surroundings; 1];

    #[inline]
    fn parameters(&self) -> &Parameters {
        match self {
            Self::Image(image) => image.parameters(),
            Self::Loaded(loaded) => loaded.parameters(),
        }
    }

    #[inline]
    fn series(&self) -> Option<&WallSeries> {
        match self {
            Self::Image(image) => image.series(),
            Self::Loaded(loaded) => loaded.series(),
        }
    }

    #[inline]
    fn lookup(&self, rise: PressureRise) -> Reading {
        match self {
            Self::Image(image) => image.lookup(rise),
            Self::Loaded(loaded) => loaded.lookup(rise),
        }
    }

    #[inline]
    fn feedback(&self, rise: PressureRise) -> Option<Micronewtons> {
        match self {
            Self::Image(image) => image.feedback(rise),
            Self::Loaded(loaded) => loaded.feedback(rise),
        }
    }

    #[inline]
    fn last_rise(&self) -> PressureRise {
        match self {
            Self::Image(image) => image.last_rise(),
            Self::Loaded(loaded) => loaded.last_rise(),
        }
    }

    fn touch(&mut self, touched: Touched) -> Result<(), NoSuchObject> {
        match self {
            Self::Image(image) => image.touch(touched),
            Self::Loaded(loaded) => loaded.touch(touched),
        }
    }

    #[cfg(band)]
    fn band(&self) -> Option<&ChipBand> {
        match self {
            Self::Image(image) => image.band(),
            // A block has none.
            Self::Loaded(_) => None,
        }
    }

    #[inline]
    fn note(&mut self, read: Option<ReadPair>) {
        match self {
            Self::Image(image) => image.note(read),
            Self::Loaded(loaded) => loaded.note(read),
        }
    }

    #[inline]
    fn tell(&self, known: Nanometres) -> Option<KnownContact> {
        match self {
            Self::Image(image) => image.tell(known),
            Self::Loaded(loaded) => loaded.tell(known),
        }
    }
}
