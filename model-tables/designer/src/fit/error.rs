//! Why there is no fit, in words.

use super::model::DataQuantity;
use super::parameter::Parameter;
use model_tables::model::ModelError;
use std::fmt;

/// Why there is no fit. `Display` is one line with the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum FitError {
    /// The model has no answer for the design.
    Model(ModelError),
    /// The data are a large factor away from the design.
    Units {
        /// Which of them.
        quantity: DataQuantity,
        /// Data over design.
        ratio: f64,
    },
    /// There are fewer data than parameters.
    TooFew {
        /// Data.
        data: usize,
        /// Parameters.
        parameters: usize,
    },
    /// The data determine none of the parameters.
    NothingTold,
    /// No parameter was chosen.
    NothingChosen,
    /// The best value of a parameter is nonsense.
    Nonsense {
        /// Which.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// The method found no least squares.
    Lost,
}

impl From<ModelError> for FitError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(error) => error.fmt(f),
            Self::Units { quantity, ratio } => write!(
                f,
                "the {quantity} of the data is {ratio:.3} times what the design gives at the same places: check the units \
                 (N, kPa, mm) and the design"
            ),
            Self::TooFew { data, parameters } => write!(
                f,
                "{data} measured numbers cannot determine {parameters} parameters: measure more, or fit fewer"
            ),
            Self::NothingTold => write!(
                f,
                "the data determine none of the parameters: measure deeper or with less noise, or fit others"
            ),
            Self::NothingChosen => write!(f, "no parameter is to be fitted: choose at least one"),
            Self::Nonsense { parameter, value } => write!(
                f,
                "the data ask for {parameter} = {value:.4}, which no such device has: check units and design, fit other \
                 parameters, or use --from-data"
            ),
            Self::Lost => write!(
                f,
                "no values of the parameters come near the data: check units and design, or use --from-data"
            ),
        }
    }
}

impl core::error::Error for FitError {}
