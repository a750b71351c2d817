//! A design file to a plant: the full model, solved afresh.

use crate::plant::Plant;
use crate::scenario::Scenario;
use crate::transducer::{Part, Transducer, Wiring};
use model_tables::design_file::{DesignFile, DesignFileError, TransducerKindSection};
use model_tables::press::{CurveFailure, ModelError};
use model_tables::rung::Rung;
use std::fmt;
use std::path::{Path, PathBuf};

/// A design with a plate to press it and a transducer that the board's converter can read.
#[derive(Clone, Debug)]
pub struct FingertipDesign {
    /// Where it was read from, absolute.
    pub path: PathBuf,
    file: DesignFile,
    max_indentation: f64,
    transducer: Transducer,
}

/// Why a design cannot be pressed.
#[derive(Debug)]
pub enum FingertipDesignError {
    /// The file is wrong.
    File(DesignFileError),
    /// The file lacks a section that a press needs.
    Lacks(PathBuf, &'static str),
    /// There is no model of the transducer.
    NoModel(PathBuf),
    /// The scenario has a fault that the transducer cannot have.
    NoSuchFault(PathBuf, Wiring),
    /// The model has no rest state.
    Rest(ModelError),
    /// The model does not reach the deepest indentation.
    Press(CurveFailure),
}

impl fmt::Display for FingertipDesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::Lacks(path, section) => write!(f, "{}: [{section}] is missing", path.display()),
            Self::NoModel(path) => write!(
                f,
                "{}: transducer.kind must be \"ratiometric\" or \"dps310\": of the others there is no emulated part",
                path.display()
            ),
            Self::NoSuchFault(path, wiring) => write!(
                f,
                "{}: the scenario's wire.is = {wiring:?} cannot happen to its transducer: choose another scenario, or \
                 another transducer.kind",
                path.display()
            ),
            Self::Rest(error) => error.fmt(f),
            Self::Press(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FingertipDesignError {}

/// The workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The design that the image is built for when none is asked for: `FINGERTIP_DESIGN`, which is relative to the
/// workspace, or the index fingertip.
pub fn default_path() -> PathBuf {
    let asked = std::env::var_os("FINGERTIP_DESIGN").filter(|path| !path.is_empty());
    workspace().join(asked.map_or("model-tables/designs/index-fingertip.toml".into(), PathBuf::from))
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
        let (part, output_at_range) = match section.kind {
            TransducerKindSection::Ratiometric {
                output_fraction_at_range,
            } => (Part::Analogue, output_fraction_at_range),
            TransducerKindSection::Dps310 { address } => (Part::Dps310(address), [0.0; 2]),
            TransducerKindSection::Abp2 { .. } | TransducerKindSection::Ms5837 => {
                return Err(FingertipDesignError::NoModel(path));
            }
        };
        let transducer = Transducer {
            range: section.range_kpa.map(|kilopascals| kilopascals * 1e3),
            output_at_range,
            noise: section.noise_pa,
            part,
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

    /// Hash of the design, as the image for it carries it: the first eight bytes of its SHA-256.
    pub fn hash(&self) -> u64 {
        let [a, b, c, d, e, f, g, h, ..] = self.file.hash();
        u64::from_be_bytes([a, b, c, d, e, f, g, h])
    }

    /// Solves the full model for a press to the deepest indentation and puts it through `scenario`.
    ///
    /// # Errors
    /// [`FingertipDesignError::NoSuchFault`], [`FingertipDesignError::Rest`] and [`FingertipDesignError::Press`].
    pub fn plant(&self, scenario: Scenario) -> Result<Plant, FingertipDesignError> {
        let part = self.transducer.part;
        if let Some(fault) = scenario.wire.iter().find(|fault| !fault.is.concerns(part)) {
            return Err(FingertipDesignError::NoSuchFault(self.path.clone(), fault.is));
        }
        let mut press = Rung::new(&self.file).map_err(FingertipDesignError::Rest)?;
        let rest_pressure = press.rest_pressure();
        let curve = press
            .curve(self.max_indentation)
            .map_err(FingertipDesignError::Press)?;
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
        .with_tables_allowed(allowed))
    }
}
