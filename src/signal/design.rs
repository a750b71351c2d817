//! The fingertip of a signal path: compiled into an image, or [loaded](crate::signal::loaded_design) at run time.

use crate::signal::filter::StepLimits;
use crate::signal::fluid::Fall;
use crate::signal::report::{Contact, Sigma};
use crate::signal::scale::Scale;
use crate::signal::touch::Thresholds;
use crate::signal::uncertainty::Uncertainty;
use crate::signal::zero::limits::{Limits, Rates};
use crate::signal::zero::surroundings::Around;
use crate::status::Warnings;
use crate::units::Microseconds;
use model_tables::constants::DesignConstants;
use model_tables::material::series::WallSeries;
use model_tables::table::Reading;
#[cfg(band)]
use model_tables::table::band::ChipBand;
use model_tables::table::known::{KnownContact, ReadPair};
use model_tables::table::law::Touched;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

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

    /// Force of the feedback actuator at a pressure rise; nothing of a design without one.
    #[inline]
    fn feedback(&self, _rise: PressureRise) -> Option<Micronewtons> {
        None
    }

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

    /// The band of an unknown object; nothing of a design that is told what it touches, and while another object than that of the band is
    /// named.
    #[cfg(band)]
    fn band(&self) -> Option<&ChipBand> {
        None
    }

    /// What was read last, if anything was that a known indentation tells more of. A design without `[object]` forgets it.
    #[inline]
    fn note(&mut self, _read: Option<ReadPair>) {}

    /// What a known indentation, above 0, tells beside what was read last; nothing where nothing was.
    #[inline]
    fn tell(&self, _known: Nanometres) -> Option<KnownContact> {
        None
    }
}

/// A pressure rise to be read.
#[derive(Clone, Copy, Debug)]
pub struct Rise {
    /// When it was.
    pub time: Microseconds,
    /// The rise.
    pub rise: PressureRise,
    /// Its 1-sigma.
    pub sigma: PressureRise,
    /// What qualifies it.
    pub warnings: Warnings,
}

/// Memory of a wall of its past.
pub trait Wall: Clone + core::fmt::Debug {
    /// A wall of whose past nothing is known.
    const NEW: Self;

    /// Force and indentation at a rise, with their 1-sigma.
    fn read(&mut self, design: &impl Design, rise: Rise) -> (Contact, Sigma);

    /// Whether its memory lowers the pressure so that this says nothing of the zero.
    fn lowers_the_pressure(&self) -> bool;

    /// The zero moved, and with it every rise so far, by so many counts.
    fn shift(&mut self, design: &impl Design, by: PressureRise);

    /// What happened since the last reading is not known.
    fn lose_track(&mut self);
}

/// There are no tables for an object: the design has none, or the radius is smaller than the smallest solved one.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct NoSuchObject;

/// Parameters of a design for the stages, each in its own form, computed once: for an image by the compiler.
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
    pub step_limits: StepLimits,
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
            step_limits: StepLimits::of(&constants, fraction_bits, period),
            thresholds: Thresholds::of(&constants, fraction_bits),
            fall: Fall::of(&constants, fraction_bits, &limits),
            uncertainty: Uncertainty::of(&constants, fraction_bits),
            constants,
        }
    }

    /// The same of a tip of a hand: a sample each `period` microseconds, made of so many codes of the converter.
    ///
    /// # Panics
    /// As [`Parameters::of`].
    #[cfg(tips)]
    pub const fn of_scan(
        constants: DesignConstants,
        fraction_bits: u32,
        last_rise: PressureRise,
        [period, codes]: [u32; 2],
    ) -> Self {
        Self {
            period,
            step_limits: StepLimits::of(&constants, fraction_bits, period),
            uncertainty: Uncertainty::averaging(&constants, fraction_bits, codes),
            ..Self::of(constants, fraction_bits, last_rise)
        }
    }

    /// The same of a tip of a hand on a bus: a sample each `period` microseconds.
    ///
    /// # Panics
    /// As [`Parameters::of`].
    #[cfg(tips)]
    pub const fn of_rounds(
        constants: DesignConstants,
        fraction_bits: u32,
        last_rise: PressureRise,
        period: u32,
    ) -> Self {
        Self {
            period,
            step_limits: StepLimits::of(&constants, fraction_bits, period),
            ..Self::of(constants, fraction_bits, last_rise)
        }
    }

    /// Two samples further apart than this are not next to each other, microseconds.
    pub const fn gap(&self) -> u64 {
        20 * self.period as u64
    }
}
