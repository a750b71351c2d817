//! What happens to the fingertip: the plate's travel over time, and faults of the transducer's wire.

use crate::transducer::Wiring;
use fingertip::link::command::Command;
use model_tables::table::law::Touched;
use serde::Deserialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// One scenario, as its file gives it. `host-tests/scenarios/README.md` explains the words.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// One sentence for the person watching.
    pub about: String,
    /// Seed of the transducer's noise.
    #[serde(default)]
    pub seed: u64,
    /// Pressure of the air around the board, kilopascals: what a barometer measures, 30 .. 120.
    #[serde(default = "standard_air_kpa")]
    pub air_kpa: f64,
    /// The design that it is made for, relative to the workspace; `None`: the default design.
    #[serde(default)]
    pub design: Option<String>,
    /// The plate's travel, one phase after another.
    pub phase: Vec<Phase>,
    /// What happens to the transducer's wire, in any order; it is sound at other times.
    #[serde(default)]
    pub wire: Vec<WireFault>,
    /// What happens to the chip and its serial line, in any order.
    #[serde(default)]
    pub event: Vec<Event>,
    /// Plate and wire begin anew when it is over, for ever; events happen once. No word of the file.
    #[serde(skip)]
    pub repeats: bool,
}

/// The standard atmosphere at sea level, kilopascals (ISO 2533).
pub(crate) const fn standard_air_kpa() -> f64 {
    101.325
}

/// Something that happens to the chip or its serial line.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// When, milliseconds.
    pub at_ms: f64,
    /// What.
    pub is: Happening,
    /// How long it lasts, milliseconds; `None` of what happens at an instant.
    pub for_ms: Option<f64>,
    /// Of the command `object`: radius of a ball, millimetres; negative: of a cup; `None`: a plate.
    pub radius_mm: Option<f64>,
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Happening {
    /// The core executes nothing for a while: the firmware hangs.
    Hang,
    /// The reset pin is pulled.
    PinReset,
    /// The host sends bytes that mean nothing, without a pause.
    Flood,
    /// The host sends a command.
    Tare,
    /// Another.
    Undo,
    /// Another.
    Save,
    /// Another.
    Info,
    /// Another.
    SelfTest,
    /// Another: every hundredth report.
    Rate,
    /// Another: what is touched from now on.
    Object,
}

/// What a radius in millimetres stands for: a ball; negative: a cup; `None`: a plate.
fn touched(radius_mm: Option<f64>) -> Touched {
    let micrometres = |millimetres: f64| libm::round(1e3 * millimetres) as i32;
    match radius_mm {
        None => Touched::Plate,
        Some(radius) if radius < 0.0 => Touched::Cup(micrometres(-radius)),
        Some(radius) => Touched::Ball(micrometres(radius)),
    }
}

impl Event {
    /// The command it is, if it is one.
    pub fn command(&self) -> Option<Command> {
        match self.is {
            Happening::Object => Some(Command::Object(touched(self.radius_mm))),
            other => other.command(),
        }
    }
}

impl Happening {
    /// The command it is by itself, if it is one.
    fn command(self) -> Option<Command> {
        match self {
            Self::Hang | Self::PinReset | Self::Flood | Self::Object => None,
            Self::Tare => Some(Command::Tare),
            Self::Undo => Some(Command::Undo),
            Self::Save => Some(Command::Save { gain: None }),
            Self::Info => Some(Command::Info),
            Self::SelfTest => Some(Command::SelfTest { indentation: 0 }),
            Self::Rate => Some(Command::Rate { every: 100 }),
        }
    }

    /// Whether it lasts.
    const fn lasts(self) -> bool {
        matches!(self, Self::Hang | Self::Flood)
    }
}

/// A stretch of the plate's travel: from where it is to another indentation, at a constant speed.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// What it is called: "rest", "press", "hold", "release", ...
    pub name: String,
    /// How long it takes, milliseconds, > 0.
    pub duration_ms: f64,
    /// Indentation at its end, percent of the largest the design is made for, 0 .. 100; `None`: the plate stays where
    /// it is.
    pub to_percent: Option<f64>,
    /// Force at its end, newtons, 0 .. 100; the plate keeps it until it is given another goal. `None`: `to_percent` has the goal.
    pub to_force_n: Option<f64>,
    /// What touches in this phase: a ball of this radius, millimetres; negative: a cup; `None`: a plate.
    pub radius_mm: Option<f64>,
}

/// The transducer's wire broken or shorted for a while.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WireFault {
    /// What is wrong: "open" or "short" with a voltage, the other words with a part on the bus.
    pub is: Wiring,
    /// From when, milliseconds.
    pub from_ms: f64,
    /// Until when, milliseconds; `None`: to the end.
    pub until_ms: Option<f64>,
}

/// Why there is no scenario.
#[derive(Debug)]
pub enum ScenarioError {
    /// No file of this name.
    Unknown {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// The file cannot be read.
    Unreadable(PathBuf, std::io::Error),
    /// The file is not a scenario.
    Malformed(PathBuf, toml::de::Error),
    /// A value is impossible.
    Value {
        /// The key.
        key: String,
        /// The value found.
        found: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// No phase at all.
    Empty,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { name, known } => {
                write!(
                    f,
                    "no scenario is called \"{name}\"; there are {}",
                    known.join(", ")
                )
            }
            Self::Unreadable(path, error) => write!(f, "cannot read {}: {error}", path.display()),
            Self::Malformed(path, error) => {
                // One line: where and what. The excerpt that toml adds is for a screenful.
                let line = error.span().map(|span| span.start);
                write!(f, "{}: {}", path.display(), error.message())?;
                line.map_or(Ok(()), |at| write!(f, " (at byte {at})"))
            }
            Self::Value { key, found, allowed } => write!(f, "{key} = {found}, but it must be {allowed}"),
            Self::Empty => write!(f, "a scenario needs at least one [[phase]]"),
        }
    }
}

impl std::error::Error for ScenarioError {}

/// Where the scenario files are.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios")
}

impl Scenario {
    /// The scenario called `name` in [`folder`], or the one in the file of that path.
    ///
    /// # Errors
    /// [`ScenarioError`] when there is none, or it is impossible.
    pub fn named(name: &str) -> Result<Self, ScenarioError> {
        let by_name = folder().join(format!("{name}.toml"));
        let path = if by_name.is_file() {
            by_name
        } else if Path::new(name).is_file() {
            PathBuf::from(name)
        } else {
            return Err(ScenarioError::Unknown {
                name: name.to_owned(),
                known: names(),
            });
        };
        let text =
            std::fs::read_to_string(&path).map_err(|error| ScenarioError::Unreadable(path.clone(), error))?;
        let scenario: Self =
            toml::from_str(&text).map_err(|error| ScenarioError::Malformed(path.clone(), error))?;
        scenario.check()?;
        Ok(scenario)
    }

    /// Length, seconds.
    pub fn duration(&self) -> f64 {
        self.phase.iter().map(|phase| phase.duration_ms * 1e-3).sum()
    }

    /// The place in the story at a time in seconds.
    pub(crate) fn place(&self, time: f64) -> f64 {
        if self.repeats {
            time % self.duration()
        } else {
            time
        }
    }

    /// Whether its truth is a press in time: it has a force to press with, or an object other than a plate.
    pub fn is_in_time(&self) -> bool {
        self.phase
            .iter()
            .any(|phase| phase.to_force_n.is_some() || phase.radius_mm.is_some())
    }

    /// Indentation at a time in seconds, as a share of the largest, 0 .. 1.
    pub fn indentation_share(&self, time: f64) -> f64 {
        let time = self.place(time);
        let (mut begins, mut from) = (0.0, 0.0);
        for phase in &self.phase {
            let lasts = phase.duration_ms * 1e-3;
            let to = phase.to_percent.map_or(from, |percent| percent * 1e-2);
            if time < begins + lasts {
                return from + (to - from) * ((time - begins) / lasts).max(0.0);
            }
            begins += lasts;
            from = to;
        }
        from
    }

    /// The name of the phase at a time in seconds; the last one's after the end.
    pub fn phase_at(&self, time: f64) -> &str {
        let time = self.place(time);
        let mut ends = 0.0;
        self.phase
            .iter()
            .find(|phase| {
                ends += phase.duration_ms * 1e-3;
                time < ends
            })
            .or(self.phase.last())
            .map_or("", |phase| phase.name.as_str())
    }

    /// When each phase ends, seconds.
    pub fn phase_ends(&self) -> impl Iterator<Item = f64> {
        self.phase.iter().scan(0.0, |ends, phase| {
            *ends += phase.duration_ms * 1e-3;
            Some(*ends)
        })
    }

    /// What is on the transducer's wire at a time in seconds.
    pub fn wiring(&self, time: f64) -> Wiring {
        let ms = self.place(time) * 1e3;
        self.wire
            .iter()
            .find(|fault| ms >= fault.from_ms && fault.until_ms.is_none_or(|until| ms < until))
            .map_or(Wiring::Sound, |fault| fault.is)
    }

    /// Refuses a new object while the last one presses.
    fn check_changes(
        &self,
        demand: impl Fn(bool, String, f64, &'static str) -> Result<(), ScenarioError>,
    ) -> Result<(), ScenarioError> {
        let (mut pressed, mut last) = (false, None);
        for (i, phase) in self.phase.iter().enumerate() {
            if phase.radius_mm != last {
                let key = format!("phase[{i}].radius_mm");
                let found = phase.radius_mm.unwrap_or(f64::INFINITY);
                demand(
                    !pressed,
                    key,
                    found,
                    "that of the phase before, until it ends at 0",
                )?;
            }
            last = phase.radius_mm;
            pressed = phase
                .to_force_n
                .or(phase.to_percent)
                .map_or(pressed, |goal| goal > 0.0);
        }
        Ok(())
    }

    /// Refuses values that mean nothing.
    fn check(&self) -> Result<(), ScenarioError> {
        let demand = |holds: bool, key: String, found: f64, allowed: &'static str| {
            if holds {
                Ok(())
            } else {
                Err(ScenarioError::Value { key, found, allowed })
            }
        };
        if self.phase.is_empty() {
            return Err(ScenarioError::Empty);
        }
        let found = self.air_kpa;
        demand(
            (30.0..=120.0).contains(&found),
            "air_kpa".to_owned(),
            found,
            "from 30 to 120",
        )?;
        for (i, phase) in self.phase.iter().enumerate() {
            let found = phase.duration_ms;
            let key = format!("phase[{i}].duration_ms");
            demand(
                found > 0.0 && found <= 3.6e6,
                key,
                found,
                "above 0, up to 3600000",
            )?;
            if let Some(found) = phase.to_percent {
                let key = format!("phase[{i}].to_percent");
                demand((0.0..=100.0).contains(&found), key, found, "from 0 to 100")?;
            }
            if let Some(found) = phase.to_force_n {
                let key = format!("phase[{i}].to_force_n");
                let alone = phase.to_percent.is_none();
                demand(alone, key.clone(), found, "left out where there is to_percent")?;
                demand((0.0..=100.0).contains(&found), key, found, "from 0 to 100")?;
            }
            if let Some(found) = phase.radius_mm {
                let key = format!("phase[{i}].radius_mm");
                demand(is_radius(found), key, found, RADIUS)?;
            }
        }
        self.check_changes(demand)?;
        for (i, event) in self.event.iter().enumerate() {
            let key = format!("event[{i}].at_ms");
            demand(event.at_ms >= 0.0, key, event.at_ms, "0 or more")?;
            let found = event.for_ms.unwrap_or(0.0);
            let key = format!("event[{i}].for_ms");
            let (holds, allowed) = if event.is.lasts() {
                (found > 0.0, "above 0 for what lasts")
            } else {
                (event.for_ms.is_none(), "left out for what does not last")
            };
            demand(holds, key, found, allowed)?;
            if let Some(found) = event.radius_mm {
                let key = format!("event[{i}].radius_mm");
                demand(
                    event.is == Happening::Object,
                    key.clone(),
                    found,
                    "left out but for object",
                )?;
                demand(is_radius(found), key, found, RADIUS)?;
            }
        }
        for (i, fault) in self.wire.iter().enumerate() {
            let key = format!("wire[{i}].from_ms");
            demand(fault.from_ms >= 0.0, key, fault.from_ms, "0 or more")?;
            if let Some(found) = fault.until_ms {
                demand(
                    found > fault.from_ms,
                    format!("wire[{i}].until_ms"),
                    found,
                    "above from_ms",
                )?;
            }
        }
        Ok(())
    }
}

/// What a radius must be.
const RADIUS: &str = "from 1 to 1000, or from -1000 to -1 for a cup";

/// Whether a radius in millimetres is that of an object.
fn is_radius(millimetres: f64) -> bool {
    (1.0..=1000.0).contains(&millimetres.abs())
}

/// The names of the scenarios in [`folder`], in order.
fn names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).into_iter().flatten().flatten();
    let mut names: Vec<String> = files
        .map(|file| file.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests;
