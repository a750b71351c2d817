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
    /// Memory of its wall.
    type Wall: Wall;
    /// Storage for the measured surroundings that move the zero.
    type Around: Around;

    /// Parameters of the design for the signal path, apart from the tables.
    fn parameters(&self) -> &Parameters;

    /// Relaxation series of the wall. `None` for an elastic wall.
    fn series(&self) -> Option<&WallSeries> {
        None
    }

    /// The limits of a zero, as a copy. With a copy, the image does not have to keep the other parameters.
    fn limits(&self) -> Limits {
        self.parameters().limits
    }

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    fn lookup(&self, rise: PressureRise) -> Reading;

    /// Force of the feedback actuator at a pressure rise. `None` for a design without an actuator.
    #[inline]
    fn feedback(&self, _rise: PressureRise) -> Option<Micronewtons> {
        None
    }

    /// The largest rise that the lookup covers for the current object.
    #[inline]
    fn last_rise(&self) -> PressureRise {
        self.parameters().last_rise
    }

    /// Selects the object that is touched from now on. A design without `[object]` has tables for the plate only.
    ///
    /// # Errors
    /// [`NoSuchObject`]; the previous object stays selected.
    fn touch(&mut self, _touched: Touched) -> Result<(), NoSuchObject> {
        Err(NoSuchObject)
    }

    /// The band of an unknown object. `None` if the host states the touched object, or while the host names an object other
    /// than that of the band.
    #[cfg(band)]
    fn band(&self) -> Option<&ChipBand> {
        None
    }

    /// Stores the last reading for use with a known indentation; `None` if it cannot be used. A design without `[object]` ignores it.
    #[inline]
    fn note(&mut self, _read: Option<ReadPair>) {}

    /// The contact from a known indentation, above 0, and the last stored reading. `None` without a stored reading.
    #[inline]
    fn tell(&self, _known: Nanometres) -> Option<KnownContact> {
        None
    }
}

/// A pressure rise to be read.
#[derive(Clone, Copy, Debug)]
pub struct Rise {
    /// Time of the rise.
    pub time: Microseconds,
    /// The rise.
    pub rise: PressureRise,
    /// Its 1-sigma.
    pub sigma: PressureRise,
    /// Warnings about the rise.
    pub warnings: Warnings,
}

/// Memory that a wall keeps of its past pressure.
pub trait Wall: Clone + core::fmt::Debug {
    /// A wall whose past is unknown.
    const NEW: Self;

    /// Force and indentation at a rise, with their 1-sigma.
    fn read(&mut self, design: &impl Design, rise: Rise) -> (Contact, Sigma);

    /// Whether the wall's memory lowers the pressure. If so, the pressure is no evidence for the zero.
    fn lowers_the_pressure(&self) -> bool;

    /// The zero moved: adds `by` counts to every rise so far.
    fn shift(&mut self, design: &impl Design, by: PressureRise);

    /// The pressure since the last reading is unknown.
    fn lose_track(&mut self);
}

/// The design has no tables for this object, or the radius is smaller than the smallest solved radius.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct NoSuchObject;

/// Parameters of a design, prepared for each stage. They are computed once; for an image, by the compiler.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Parameters {
    /// The design itself.
    pub constants: DesignConstants,
    /// `k`: pressures are counted in `1 / 2^k` pascal, 0 to 16.
    pub pressure_fraction_bits: u32,
    /// The largest rise that the tables cover. Above it, readings saturate.
    pub last_rise: PressureRise,
    /// Below this rise a reading is flagged.
    pub lowest_rest: PressureRise,
    /// Lower end of the transducer's range, millipascals. The true pressure may be lower than a reading below it.
    pub lowest_read: i32,
    /// Time from one sample to the next, microseconds.
    pub period: u32,
    /// Conversion of the transducer's pressure to counts.
    pub scale: Scale,
    /// Limits of a zero without a stored calibration.
    pub limits: Limits,
    /// Rates at which the measured surroundings move a zero.
    pub rates: Rates,
    /// Step limits of the filter.
    pub step_limits: StepLimits,
    /// Thresholds of a touch.
    pub thresholds: Thresholds,
    /// Fall of the zero that indicates a leak.
    pub fall: Fall,
    /// Uncertainty of a rise.
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

    /// The same for a tip of a hand: one sample every `period` microseconds, averaged from `codes` codes of the converter.
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

    /// The same for a tip of a hand on a bus: one sample every `period` microseconds.
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

    /// Longest time between two neighbouring samples, microseconds. A longer time is a gap.
    pub const fn gap(&self) -> u64 {
        20 * self.period as u64
    }
}
