//! A design file to a plant: the full model, solved afresh, or what was measured where the design has tables from data.

use crate::plant::Plant;
use crate::scenario::{Scenario, WireFault};
use crate::timed::TimedPress;
use crate::transducer::{EmulatedTransducer, Part, Wiring};
use model_tables::curve::CurveFailure;
use model_tables::curve::{Contact, Curve};
use model_tables::design_file::{
    Calibration, DesignFile, DesignFileError, ObjectSection, ShapeSection, Supply, TransducerKindSection,
    Transfer,
};
use model_tables::generate::feedback::FeedbackCurve;
use model_tables::generate::{self, GenerateError};
use model_tables::model::Fingertip;
use model_tables::model::ModelError;
use model_tables::model::choice::elements_in_time;
use model_tables::model::feedback::{Loop, LoopError};
use model_tables::object::Friction;
use model_tables::solid::disc::DISC;
use model_tables::solid::history::{History, HistoryError};
use std::fmt;
use std::path::{Path, PathBuf};

/// A design with a plate to press it and a transducer that the board's converter can read.
#[derive(Clone, Debug)]
pub struct FingertipDesign {
    /// Where it was read from, absolute.
    pub path: PathBuf,
    file: DesignFile,
    max_indentation: f64,
    transducer: EmulatedTransducer,
}

/// What the truth of a run is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum RunTruth {
    /// The full model of an elastic wall.
    Model,
    /// What was measured.
    Data,
    /// The solid in time, of a wall that relaxes.
    InTime,
    /// The settled states of a wall that relaxes. The scenario moves the plate by a share of the largest indentation. A real wall would press
    /// back harder than that, beyond most transducers.
    Settled,
}

impl RunTruth {
    /// In two or three words, for the key of a chart.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Model => "full model",
            Self::Data => "measured data",
            Self::InTime => "solid in time",
            Self::Settled => "settled wall, not in time",
        }
    }
}

impl fmt::Display for RunTruth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Model => "the full model",
            Self::Data => "the measured data",
            Self::InTime => "the solid in time, as the wall relaxes",
            Self::Settled => {
                "the settled states of a wall that relaxes: as pressed for ever, and no real press is. The firmware takes the pressure \
                 for that of a wall in time, and its force and indentation differ. --scenario regrasp has the truth in time"
            }
        })
    }
}

/// Why a design cannot be pressed.
#[derive(Debug)]
pub enum FingertipDesignError {
    /// The file is wrong.
    File(DesignFileError),
    /// The file lacks a section that a press needs.
    Lacks(PathBuf, &'static str),
    /// The scenario has a fault that the transducer cannot have.
    NoSuchFault(PathBuf, Wiring),
    /// The model has no rest state.
    Rest(ModelError),
    /// The model does not reach the deepest indentation.
    Press(CurveFailure<ModelError>),
    /// Fingertip and actuator do not, together.
    Loop(LoopError),
    /// The scenario cannot be played with this design, and why.
    InTime(PathBuf, &'static str),
    /// The solid in time does not go through the scenario.
    History(PathBuf, HistoryError),
    /// The data of a design from data do not.
    Data(PathBuf, Box<GenerateError>),
}

impl fmt::Display for FingertipDesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::Lacks(path, section) => write!(f, "{}: [{section}] is missing", path.display()),
            Self::NoSuchFault(path, wiring) => write!(
                f,
                "{}: the scenario's wire.is = {wiring:?} cannot happen to its transducer: choose another scenario, or \
                 another transducer.kind",
                path.display()
            ),
            Self::Rest(error) => error.fmt(f),
            Self::Press(error) => error.fmt(f),
            Self::Loop(error) => error.fmt(f),
            Self::InTime(path, why) => write!(f, "{}: {why}", path.display()),
            Self::History(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Data(path, error) => write!(f, "{}: {error}", path.display()),
        }
    }
}

impl std::error::Error for FingertipDesignError {}

/// The one address that an MS5837 has.
const MS5837: u8 = 0x76;

fn on_the_bus(part: Part) -> (Part, [f64; 2], Supply) {
    (part, [0.0; 2], Supply::Reference)
}

/// A measured supply: 5 V through a divider that leaves 3 V, of 3.3 V.
const MEASURED_SUPPLY: f64 = 3.0 / 3.3;

/// The workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The design that the image is built for when none is asked for: `FINGERTIP_DESIGN`, which is relative to the
/// workspace, or the index fingertip.
pub fn default_path() -> PathBuf {
    let asked = std::env::var_os("FINGERTIP_DESIGN");
    workspace().join(asked.unwrap_or_else(|| "model-tables/designs/index-fingertip-elastic.toml".into()))
}

impl FingertipDesign {
    /// Reads a design file.
    ///
    /// # Errors
    /// [`FingertipDesignError`].
    pub fn read(path: &Path) -> Result<Self, FingertipDesignError> {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let file = DesignFile::read(&path).map_err(FingertipDesignError::File)?;
        let lacks = |section| FingertipDesignError::Lacks(path.clone(), section);
        let max_indentation = file.max_indentation_mm.ok_or_else(|| lacks("press"))? * 1e-3;
        let section = file.transducer.ok_or_else(|| lacks("transducer"))?;
        let (part, output_at_range, supply) = match section.kind {
            TransducerKindSection::Ratiometric {
                output_fraction_at_range,
                supply,
                source,
            } => (
                Part::Analogue,
                output_fraction_at_range.map(|fraction| source.at_converter(fraction)),
                supply,
            ),
            TransducerKindSection::Dps310 { address } => on_the_bus(Part::Dps310(address)),
            TransducerKindSection::Abp2 { address, transfer } => on_the_bus(Part::Abp2(
                address,
                // 10 % and 90 %, or 30 % and 70 %, of 2^24.
                match transfer {
                    Transfer::A => [1_677_722, 15_099_494],
                    Transfer::B => [5_033_165, 11_744_051],
                },
            )),
            TransducerKindSection::Ms5837 => on_the_bus(Part::Ms5837(MS5837)),
        };
        let transducer = EmulatedTransducer {
            quantity: section.quantity,
            range: section.own_range_kpa().map(|kilopascals| kilopascals * 1e3),
            output_at_range,
            noise: section.noise_pa,
            resolution: section.resolution_pa,
            part,
            supply: match supply {
                Supply::Reference => 1.0,
                Supply::Measured => MEASURED_SUPPLY,
            },
        };
        Ok(Self {
            path,
            file,
            max_indentation,
            transducer,
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// What the truth of a scenario is.
    pub fn truth(&self, scenario: &Scenario) -> RunTruth {
        match (&self.file.calibration.curve, &self.file.relaxation) {
            (None, Some(_)) if scenario.is_in_time() => RunTruth::InTime,
            (None, Some(_)) => RunTruth::Settled,
            (Some(_), _) => RunTruth::Data,
            (None, None) => RunTruth::Model,
        }
    }

    /// Hash of the design, as the image for it carries it: the first eight bytes of its SHA-256.
    pub fn hash(&self) -> u64 {
        let [a, b, c, d, e, f, g, h, ..] = self.file.hash();
        u64::from_be_bytes([a, b, c, d, e, f, g, h])
    }

    /// Solves the full model for a press to the deepest indentation and puts it through `scenario`.
    ///
    /// # Errors
    /// [`FingertipDesignError::NoSuchFault`], [`FingertipDesignError::Rest`] and [`FingertipDesignError::Press`]; of a design from data
    /// [`FingertipDesignError::Data`].
    pub fn plant(&self, scenario: Scenario) -> Result<Plant, FingertipDesignError> {
        let concerns = |fault: &&WireFault| !fault.is.concerns(&self.transducer);
        if let Some(fault) = scenario.wire.iter().find(concerns) {
            return Err(FingertipDesignError::NoSuchFault(self.path.clone(), fault.is));
        }
        let (rest_pressure, curve, feedback) = self.press()?;
        let timed = self.timed(&scenario, &curve)?;
        let allowed = self.file.accuracy.map_or([0.0; 2], |accuracy| {
            [
                accuracy.force_percent_of_reading / 100.0,
                accuracy.indentation_percent_of_reading / 100.0,
            ]
        });
        Ok(Plant::new(
            curve,
            rest_pressure,
            self.max_indentation,
            self.transducer,
            scenario,
        )
        .with_tables_allowed(allowed)
        .with_feedback(feedback)
        .with_timed(timed))
    }

    /// The press in time where the scenario needs one: the solid in time of a wall that relaxes, otherwise the elastic press onto each
    /// object.
    fn timed(&self, scenario: &Scenario, plate: &Curve) -> Result<Option<TimedPress>, FingertipDesignError> {
        if !scenario.is_in_time() {
            return Ok(None);
        }
        let refused = |why| FingertipDesignError::InTime(self.path.clone(), why);
        if self.file.calibration != Calibration::default() || self.file.actuator.is_some() {
            return Err(refused(
                "a scenario by force or with objects needs a design without [calibration] and [actuator]: leave them out",
            ));
        }
        if let Some(relaxation) = &self.file.relaxation {
            if scenario.phase.iter().any(|phase| phase.radius_mm.is_some()) {
                return Err(refused(
                    "phase.radius_mm needs an elastic wall: leave [material.relaxation] out, or take a scenario of a plate",
                ));
            }
            let elements = elements_in_time(self.file.model)
                .ok_or_else(|| refused("a press in time needs model.kind = \"solid\" or \"auto\""))?;
            let failed = |error| FingertipDesignError::History(self.path.clone(), error);
            let history =
                History::new(&self.file.design(), relaxation, elements, 0.0, 0.0).map_err(failed)?;
            return TimedPress::relaxing(history, scenario, self.max_indentation)
                .map(Some)
                .map_err(failed);
        }
        let mut solved: Vec<(Option<f64>, Curve)> = vec![(None, plate.clone())];
        let mut onto = vec![];
        for phase in &scenario.phase {
            let known = solved.iter().find(|(radius, _)| *radius == phase.radius_mm);
            let curve = if let Some((_, curve)) = known {
                curve.clone()
            } else {
                let curve = self.curve_onto(phase.radius_mm)?;
                solved.push((phase.radius_mm, curve.clone()));
                curve
            };
            onto.push(curve);
        }
        Ok(Some(TimedPress::elastic(&onto, scenario, self.max_indentation)))
    }

    /// The press onto a ball of a radius in millimetres; negative: a cup.
    fn curve_onto(&self, radius_mm: Option<f64>) -> Result<Curve, FingertipDesignError> {
        let file = DesignFile {
            object: Some(ObjectSection {
                shape: radius_mm.map_or(ShapeSection::Plate, |radius_mm| ShapeSection::Ball { radius_mm }),
                friction: Friction::NONE,
                unknown: false,
            }),
            ..self.file.clone()
        };
        let mut press = Fingertip::new(&file).map_err(FingertipDesignError::Rest)?;
        press
            .curve(self.max_indentation)
            .map_err(FingertipDesignError::Press)
    }

    /// Rest pressure and press as the transducer reads them, and the force of the actuator that shares the fluid.
    ///
    /// # Errors
    /// [`FingertipDesignError::Rest`], [`FingertipDesignError::Press`] and [`FingertipDesignError::Loop`]; of a design from data
    /// [`FingertipDesignError::Data`].
    fn press(&self) -> Result<(f64, Curve, Option<FeedbackCurve>), FingertipDesignError> {
        let calibration = &self.file.calibration;
        if calibration.curve.is_some() {
            // No model knows such a device: what was measured is all there is.
            let measured = generate::solve(&self.file)
                .map_err(|error| FingertipDesignError::Data(self.path.clone(), Box::new(error)))?;
            return Ok((measured.rest_pressure, measured.curve, measured.feedback));
        }
        let mut press = Fingertip::new(&self.file).map_err(FingertipDesignError::Rest)?;
        let rest_pressure = calibration.pressure_read(press.rest_pressure());
        let haptic = Loop::of_file(&self.file, press.kind(), DISC).map_err(FingertipDesignError::Loop)?;
        let (curve, feedback) = if let Some(mut haptic) = haptic {
            let found = haptic
                .curve(self.max_indentation)
                .map_err(|failure| match failure {
                    CurveFailure::Model(error) => FingertipDesignError::Loop(error),
                    CurveFailure::Shape(error) => FingertipDesignError::Press(CurveFailure::Shape(error)),
                })?;
            let at_rest = found.force_at_rest;
            let gained = found.feedback.map(|gained| self.as_read(&gained)).transpose()?;
            (
                found.touch,
                gained.map(|gained| FeedbackCurve { gained, at_rest }),
            )
        } else {
            let curve = press.curve(self.max_indentation);
            (curve.map_err(FingertipDesignError::Press)?, None)
        };
        Ok((rest_pressure, self.as_read(&curve)?, feedback))
    }

    /// A curve as the transducer reads it.
    fn as_read(&self, curve: &Curve) -> Result<Curve, FingertipDesignError> {
        let gain = self.file.calibration.pressure_gain;
        let read = |point: &Contact| Contact {
            pressure_rise: gain * point.pressure_rise,
            ..*point
        };
        Curve::new(curve.points().iter().map(read).collect())
            .map_err(|error| FingertipDesignError::Press(CurveFailure::Shape(error)))
    }
}
