//! Head and sections of a block, each described once. Units and ranges are those of the types.

use super::StoredCalibration;
use super::field::Visit;
use crate::constants::{DesignConstants, Transducer, ZeroAssumptions};
use crate::material::series::WallSeries;
use crate::table::Layout;
use crate::table::feedback::FeedbackScale;
use crate::table::law::{BlendLaw, Touched};

/// The kinds of sections, by their number.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum SectionKind {
    /// What the firmware needs to know of the design beside its tables.
    Constants = 1,
    /// Pressure rise to force and indentation of a flat plate, and the wall elastic.
    Tables = 2,
    /// What is known of this one fingertip.
    Calibration = 3,
    /// The design's name.
    Name = 4,
    /// The wall in time.
    Relaxation = 5,
    /// The reference ball's tables, and how much of it other objects have.
    Object = 6,
    /// The force of the feedback actuator.
    Feedback = 7,
    /// What the design states of its zero, if anything.
    Zero = 8,
}

impl SectionKind {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Constants,
        Self::Tables,
        Self::Calibration,
        Self::Name,
        Self::Relaxation,
        Self::Object,
        Self::Feedback,
        Self::Zero,
    ];

    /// The highest number.
    pub const HIGHEST: usize = Self::Zero as usize;

    /// The only version of it so far.
    pub const VERSION: u16 = 1;

    /// The kind of a number.
    pub fn of(number: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| *kind as u16 == number)
    }

    /// What it is called.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Constants => "constants",
            Self::Tables => "tables",
            Self::Calibration => "calibration",
            Self::Name => "name",
            Self::Relaxation => "relaxation",
            Self::Zero => "zero",
            Self::Object => "object",
            Self::Feedback => "feedback",
        }
    }
}

/// Of the head: which design it is.
///
/// # Errors
/// The visitor's.
pub fn identity<V: Visit>(value: &mut DesignConstants, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("hash", &mut value.hash)?;
    visit.field("table_version", &mut value.table_version)?;
    visit.field("certificate", &mut value.certificate)
}

/// The pressures of the design: the first part of its constants.
///
/// # Errors
/// The visitor's.
pub fn pressures<V: Visit>(value: &mut DesignConstants, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("rest_pressure", &mut value.rest_pressure)?;
    visit.field("maximum_pressure", &mut value.maximum_pressure)
}

/// The second part of the constants.
///
/// # Errors
/// The visitor's.
pub fn transducer<V: Visit>(value: &mut Transducer, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("range", &mut value.range)?;
    visit.field("resolution", &mut value.resolution)?;
    visit.field("noise", &mut value.noise)?;
    visit.field("quantity", &mut value.quantity)?;
    visit.field("kind", &mut value.kind)
}

/// What the design states of its zero.
///
/// # Errors
/// The visitor's.
pub fn zero<V: Visit>(value: &mut ZeroAssumptions, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("drift", &mut value.drift)?;
    visit.field("per_kelvin", &mut value.per_kelvin)?;
    visit.field("fluid_head", &mut value.fluid_head)?;
    visit.field("hysteresis", &mut value.hysteresis)?;
    visit.field("creep", &mut value.creep)?;
    visit.field("bound", &mut value.bound)?;
    visit.field("air", &mut value.air)
}

/// The first part of the tables; the words of the segments follow.
///
/// # Errors
/// The visitor's.
pub fn layout<V: Visit>(value: &mut Layout, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("pressure_fraction_bits", &mut value.fraction_bits)?;
    visit.field("maximum", &mut value.maximum)?;
    visit.field("bias", &mut value.bias)?;
    visit.field("octaves", &mut value.octaves)?;
    visit.field("halvings", &mut value.halvings)?;
    visit.field("powers", &mut value.powers)?;
    visit.field("constant", &mut value.constant)?;
    visit.field("first_index", &mut value.first_index)?;
    visit.field("force_shift", &mut value.shifts[0])?;
    visit.field("indentation_shift", &mut value.shifts[1])
}

/// The calibration.
///
/// # Errors
/// The visitor's.
pub fn calibration<V: Visit>(value: &mut StoredCalibration, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("zero", &mut value.zero)?;
    visit.field("temperature", &mut value.temperature)?;
    visit.field("coefficient", &mut value.coefficient)?;
    visit.field("gain", &mut value.gain)
}

/// The first part of the wall in time; its terms follow.
///
/// # Errors
/// The visitor's.
pub fn relaxation<V: Visit>(value: &mut WallSeries, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("remaining_permille", &mut value.remaining_permille)?;
    visit.field("fluid_least", &mut value.fluid_least)?;
    visit.field("fluid_half", &mut value.fluid_half)?;
    visit.field("weight_gain", &mut value.weight_gain)?;
    visit.field("weight_half", &mut value.weight_half)?;
    visit.field("retouch", &mut value.retouch)?;
    visit.field("temperature_gain", &mut value.temperature_gain)?;
    visit.field("stiffness", &mut value.step.stiffness)?;
    visit.field("settled", &mut value.step.settled)?;
    visit.field("forgets", &mut value.step.forgets)
}

/// Of the objects: what is touched at the start, and the law of the weights; the words of the reference ball follow.
///
/// # Errors
/// The visitor's.
pub fn object<V: Visit>(start: &mut Touched, law: &mut BlendLaw, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("start", start)?;
    visit.field("reference", &mut law.reference)?;
    visit.field("offset", &mut law.offset)?;
    visit.field("least", &mut law.least)?;
    visit.field("last", &mut law.last)?;
    visit.field("force", &mut law.force)?;
    visit.field("indentation", &mut law.indentation)
}

/// Of the feedback actuator: how a sum is read; the words follow.
///
/// # Errors
/// The visitor's.
pub fn feedback<V: Visit>(value: &mut FeedbackScale, visit: &mut V) -> Result<(), V::Stop> {
    visit.field("shift", &mut value.shift)?;
    visit.field("at_rest", &mut value.at_rest)
}
