//! The reasons why no model gives an answer.

use crate::limit::Limit;
use crate::membrane::press::MembraneError;
use crate::solid::SolidError;
use std::fmt;

/// Why a model gives no answer: in its own words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelError {
    /// The membrane.
    Membrane(MembraneError),
    /// The solid.
    Solid(SolidError),
}

impl ModelError {
    /// The end of the press, if the requested indentation is beyond it.
    pub fn beyond(&self) -> Option<Limit> {
        match *self {
            Self::Membrane(MembraneError::BeyondLimit { limit, .. })
            | Self::Solid(SolidError::BeyondLimit { limit, .. }) => Some(limit),
            _ => None,
        }
    }

    /// The same with every indentation as `read` has it.
    #[must_use]
    pub fn read_by(self, read: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Membrane(error) => Self::Membrane(error.read_by(read)),
            Self::Solid(error) => Self::Solid(error.read_by(read)),
        }
    }
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Membrane(error) => error.fmt(f),
            Self::Solid(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ModelError {}

impl From<MembraneError> for ModelError {
    fn from(error: MembraneError) -> Self {
        Self::Membrane(error)
    }
}

impl From<SolidError> for ModelError {
    fn from(error: SolidError) -> Self {
        Self::Solid(error)
    }
}
