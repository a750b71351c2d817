//! Status types that all other modules import: faults (reasons for no reading), warnings, touch, and the cause of the last reset.

use core::fmt;

/// Reasons for no reading. A fault never becomes a number.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Fault {
    /// The transducer's line rests at or above the top of its window: a broken wire, held up by the pull-up.
    SensorOpen,
    /// The transducer's line rests at or below the bottom of its window: a short to ground, or no supply.
    SensorShort,
    /// There is no zero yet: the first one is being taken, or an absolute transducer could take none.
    Zeroing,
    /// The filter is filling again after a gap.
    Settling,
    /// The converter's channels are not in their places.
    #[cfg(tips)]
    ChannelIdentity,
    /// Samples were lost between the converter and the signal path.
    SamplesLost,
    /// The converter gave no samples in time.
    ConverterStalled,
    /// The transducer's supply, where it is measured, is off, sags by half, or is above the converter's reference.
    SensorSupply,
    /// The transducer does not answer at its address.
    SensorAbsent,
    /// The bus to the transducer is held, or broke off.
    BusFault,
    /// Another part answers at the transducer's address.
    WrongSensor,
    /// The transducer's calibration does not fit its check, or cannot be.
    SensorCalibration,
    /// The transducer had no new reading in the longest time a conversion takes.
    SensorBusy,
    /// The transducer found its own memory corrupt.
    SensorMemory,
    /// The transducer's own arithmetic came to its end: its reading is none.
    SensorSaturated,
    /// The transducer was reset by itself and lost its settings.
    SensorReset,
    /// The transducer gave what it cannot have measured.
    SensorImplausible,
    /// The transducer gives the same number for longer than its noise allows.
    Stuck,
    /// The pressure changed faster than a fingertip can make it.
    Jump,
    /// The chip was reset again and again: it measures nothing until power is switched off and on.
    ResetLoop,
}

impl Fault {
    /// Every fault with its code in telemetry; 0 is not used, so that a cleared word names none.
    pub const CODES: [(Self, u8); 19 + cfg!(tips) as usize] = [
        (Self::SensorOpen, 1),
        (Self::SensorShort, 2),
        (Self::Zeroing, 3),
        (Self::Settling, 4),
        (Self::SamplesLost, 5),
        (Self::ConverterStalled, 6),
        (Self::Stuck, 7),
        (Self::Jump, 8),
        (Self::ResetLoop, 9),
        (Self::SensorSupply, 10),
        #[cfg(tips)]
        (Self::ChannelIdentity, 11),
        (Self::SensorAbsent, 16),
        (Self::BusFault, 17),
        (Self::WrongSensor, 18),
        (Self::SensorCalibration, 19),
        (Self::SensorBusy, 20),
        (Self::SensorMemory, 21),
        (Self::SensorSaturated, 22),
        (Self::SensorReset, 23),
        (Self::SensorImplausible, 24),
    ];

    /// The reason in words.
    pub const fn reason(self) -> &'static str {
        match self {
            Self::SensorOpen => "sensor open",
            Self::SensorShort => "sensor short",
            Self::Zeroing => "zeroing",
            Self::Settling => "settling",
            #[cfg(tips)]
            Self::ChannelIdentity => "channel identity",
            Self::SamplesLost => "samples lost",
            Self::ConverterStalled => "converter stalled",
            Self::SensorSupply => "sensor supply",
            Self::SensorAbsent => "sensor absent",
            Self::BusFault => "bus fault",
            Self::WrongSensor => "wrong sensor",
            Self::SensorCalibration => "sensor calibration",
            Self::SensorBusy => "sensor busy",
            Self::SensorMemory => "sensor memory",
            Self::SensorSaturated => "sensor saturated",
            Self::SensorReset => "sensor reset",
            Self::SensorImplausible => "sensor implausible",
            Self::Stuck => "stuck",
            Self::Jump => "jump",
            Self::ResetLoop => "reset loop",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.reason())
    }
}

impl core::error::Error for Fault {}

/// Warnings of a reading, any number at once; without a warning the reading is ok.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Warnings(u16);

impl Warnings {
    /// No qualification.
    pub const NONE: Self = Self(0);
    /// Beyond the tables' or the transducer's range: force and indentation are lower bounds.
    pub const SATURATED: Self = Self(1);
    /// The zero is not known to be of rest: it is the stored or the design's, an absolute transducer's first, which may hold
    /// a press, or a tared one over all that is known, until it is saved. All values may be offset.
    pub const ZERO_UNVERIFIED: Self = Self(2);
    /// The pressure is below the zero by more than noise: a leak, a lift, a wall that creeps back, or a zero
    /// taken while pressed. Force and indentation are 0 but too low by the unknown offset.
    pub const BELOW_ZERO: Self = Self(4);
    /// The rest pressure fell further than drift, or the thinnest air, explains: fluid is lost, and the tables are for more of it. Latched.
    pub const LEAK_SUSPECTED: Self = Self(8);
    /// The fingertip was softer than its model at a known indentation: air in the fluid. Latched.
    pub const BUBBLE_SUSPECTED: Self = Self(16);
    /// A stored calibration is there and cannot be used (another design's, or damaged): the design's values are in use.
    pub const CALIBRATION_REFUSED: Self = Self(32);
    /// The zero may be off by so much that it may pass for a touch, or hide one: drift since it was last seen untouched, or a
    /// rest pressure that rose slowly or fell. Ends with a tare.
    pub const ZERO_AGED: Self = Self(64);
    /// The transducer's temperature changed in contact. The error of its held compensation may be as large as a touch.
    pub const TEMPERATURE: Self = Self(128);
    /// The crystal failed: time comes from the chip's own oscillator and is a percent off.
    pub const CLOCK: Self = Self(256);
    /// The wall recovers from a press that it has left: the pressure is below the zero, the force 0 and the indentation an upper bound.
    pub const RECOVERING: Self = Self(512);
    /// The past of a relaxing wall is not known: after a reset or a gap, or at the transducer's lower end. Half of the resulting
    /// difference is in the 1-sigma.
    pub const PAST_UNKNOWN: Self = Self(1024);
    /// The pressure swings to and fro by more than six noise floors allow, faster than a hand: hum of the mains, a motor, a
    /// vibration. The 1-sigma allows for it.
    pub const NOISY: Self = Self(1 << 14);

    /// Every reason with its word, the gravest first.
    const REASONS: [(Self, &'static str); 12] = [
        (Self::SATURATED, "saturated"),
        (Self::LEAK_SUSPECTED, "leak suspected"),
        (Self::BUBBLE_SUSPECTED, "bubble suspected"),
        (Self::BELOW_ZERO, "below zero"),
        (Self::RECOVERING, "recovering"),
        (Self::PAST_UNKNOWN, "past unknown"),
        (Self::ZERO_UNVERIFIED, "zero unverified"),
        (Self::CALIBRATION_REFUSED, "calibration refused"),
        (Self::ZERO_AGED, "zero aged"),
        (Self::NOISY, "noisy"),
        (Self::TEMPERATURE, "temperature"),
        (Self::CLOCK, "clock"),
    ];

    /// Every warning at once.
    pub const ALL: Self = Self(2047 | 1 << 14);

    /// The bits, as telemetry carries them.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The warnings of a word in telemetry, or nothing when it has a bit that no warning owns.
    pub fn from_bits(bits: u16) -> Option<Self> {
        (bits & !Self::ALL.0 == 0).then_some(Self(bits))
    }

    /// These and those.
    #[must_use]
    pub const fn and(self, those: Self) -> Self {
        Self(self.0 | those.0)
    }

    /// These, but not those.
    #[must_use]
    pub const fn without(self, those: Self) -> Self {
        Self(self.0 & !those.0)
    }

    /// These when `condition`, else none.
    #[must_use]
    pub const fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::NONE }
    }

    /// Their reasons in words, the gravest first.
    pub fn reasons(self) -> impl Iterator<Item = &'static str> {
        let named = Self::REASONS.iter().filter(move |(one, _)| self.contains(*one));
        named.map(|(_, word)| *word)
    }

    /// Whether these warnings include all of `those`.
    pub const fn contains(self, those: Self) -> bool {
        self.0 & those.0 == those.0
    }
}

impl fmt::Display for Warnings {
    /// The reasons, the gravest first, separated by "; ".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for word in self.reasons() {
            write!(f, "{separator}{word}")?;
            separator = "; ";
        }
        Ok(())
    }
}

/// Status of a report. Displays as `ok`, `warning: <reasons>` or `fault: <reason>`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Status {
    /// The values hold.
    Ok,
    /// There are values, qualified.
    Warning(Warnings),
    /// There are no values.
    Fault(Fault),
}

impl Status {
    /// Of values that these warnings qualify.
    pub fn qualified(warnings: Warnings) -> Self {
        if warnings == Warnings::NONE {
            Self::Ok
        } else {
            Self::Warning(warnings)
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ok => f.write_str("ok"),
            Self::Warning(warnings) => write!(f, "warning: {warnings}"),
            Self::Fault(fault) => write!(f, "fault: {fault}"),
        }
    }
}

/// Whether the fingertip is touched.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Touch {
    /// It cannot be told: there is no reading, the rise is between the thresholds, or it is below them over a zero that is not
    /// verified.
    #[default]
    Unknown,
    /// Nothing presses.
    Untouched,
    /// Something presses.
    Touched,
}

impl Touch {
    /// Every state with its code in telemetry.
    pub const CODES: [(Self, u8); 3] = [(Self::Unknown, 0), (Self::Untouched, 1), (Self::Touched, 2)];

    /// The state in a word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Untouched => "untouched",
            Self::Touched => "touched",
        }
    }
}

/// Cause of the last reset of the chip.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum ResetCause {
    /// The chip does not say.
    #[default]
    Unknown,
    /// Power was switched on.
    PowerOn,
    /// The reset pin was pulled.
    Pin,
    /// The firmware asked for it.
    Software,
    /// A watchdog was not fed.
    Watchdog,
    /// The supply sagged.
    BrownOut,
    /// A forbidden entry into a low-power mode.
    LowPower,
}

impl ResetCause {
    /// Every cause with its code in telemetry.
    pub const CODES: [(Self, u8); 7] = [
        (Self::Unknown, 0),
        (Self::PowerOn, 1),
        (Self::Pin, 2),
        (Self::Software, 3),
        (Self::Watchdog, 4),
        (Self::BrownOut, 5),
        (Self::LowPower, 6),
    ];
}

impl ResetCause {
    /// The cause in words.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::PowerOn => "power-on",
            Self::Pin => "pin",
            Self::Software => "software",
            Self::Watchdog => "watchdog",
            Self::BrownOut => "brown-out",
            Self::LowPower => "low power",
        }
    }
}

impl fmt::Display for ResetCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// State of the stored calibration.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Stored {
    /// None was ever stored.
    #[default]
    None,
    /// In use.
    InUse,
    /// It is another design's.
    OtherDesign,
    /// There is something, and none of it is whole.
    Damaged,
    /// A place that cannot be read may hold a later one than the record in use, if any is in use.
    Unreadable,
}

impl Stored {
    /// Every state with its code in telemetry.
    pub const CODES: [(Self, u8); 5] = [
        (Self::None, 0),
        (Self::InUse, 1),
        (Self::OtherDesign, 2),
        (Self::Damaged, 3),
        (Self::Unreadable, 4),
    ];
}

/// Cause of the end of the previous run.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum LastFault {
    /// Nothing that left a trace.
    #[default]
    None,
    /// A task did not report in time: its number.
    Late,
    /// The code panicked: the line.
    Panic,
    /// The core met what it cannot execute: the address.
    HardFault,
    /// The watchdog was not fed, and no task was seen to be late: what feeds it hung, or the start did, as the code of a
    /// [`Stage`](crate::device::task_monitor::Stage) tells.
    Hang,
    /// The chip raised its non-maskable interrupt: the address in flash that its error correction gave up, or 0.
    NonMaskable,
    /// The stack reached its end: what the fault left that came of it, as the detail of a hang or of a hard fault.
    StackOverflow,
}

impl LastFault {
    /// Every kind with its code in telemetry.
    pub const CODES: [(Self, u8); 7] = [
        (Self::None, 0),
        (Self::Late, 1),
        (Self::Panic, 2),
        (Self::HardFault, 3),
        (Self::Hang, 4),
        (Self::NonMaskable, 5),
        (Self::StackOverflow, 6),
    ];
}

/// The code of one of a list.
pub(crate) fn code_of<T: Copy + PartialEq>(codes: &[(T, u8)], wanted: T) -> u8 {
    codes
        .iter()
        .find(|(one, _)| *one == wanted)
        .map_or(0, |(_, code)| *code)
}

/// The one of a list that has this code.
pub(crate) fn named_by<T: Copy>(codes: &[(T, u8)], wanted: u8) -> Option<T> {
    codes
        .iter()
        .find(|(_, code)| *code == wanted)
        .map(|(one, _)| *one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_has_words_of_its_own() {
        for (i, (fault, _)) in Fault::CODES.iter().enumerate() {
            for (other, _) in &Fault::CODES[..i] {
                assert!(fault != other && fault.reason() != other.reason());
            }
        }
    }

    #[test]
    fn unknown_warning_bits_are_not_believed() {
        assert_eq!(Warnings::from_bits(7).map(Warnings::bits), Some(7));
        assert_eq!(Warnings::from_bits(2048), None);
        let named = Warnings::REASONS.iter().fold(0, |all, (one, _)| all | one.0);
        assert_eq!(Warnings::ALL.bits(), named);
    }

    #[test]
    fn codes_of_faults_are_distinct_and_not_zero() {
        for (i, (_, code)) in Fault::CODES.iter().enumerate() {
            assert!(*code != 0);
            assert!(Fault::CODES[..i].iter().all(|(_, other)| other != code));
        }
    }
}
