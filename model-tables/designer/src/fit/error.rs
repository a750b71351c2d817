//! Why there is no fit, in words.

use super::model::DataQuantity;
use super::parameter::Parameter;
use model_tables::model::ModelError;
use output::rows::significant;
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
    /// Force and pressure rise are both a large factor away from the design.
    DepthUnits {
        /// Data over design: force, and pressure rise.
        ratios: [f64; 2],
    },
    /// The data go deeper than the tip is high.
    TooDeep {
        /// Deepest indentation, metres.
        deepest: f64,
        /// Height of the tip at rest, metres.
        height: f64,
    },
    /// The stage reads so much at first touch, metres, and the design has no press as deep as it reads.
    NotFromFirstTouch(f64),
    /// Force and pressure rise fit each other's place.
    Swapped,
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
    /// A zero is asked of every trial and of all of them together.
    ZeroTwice(Parameter),
    /// The best value of a parameter is nonsense.
    Nonsense {
        /// Which.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// The method found no least squares.
    Lost,
    /// The method did not come to an end.
    Unsettled,
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
                "the {quantity} of the data is {} times what the design gives at the same places: {}check the units (N, kPa, mm) \
                 and the design",
                significant(*ratio, 3),
                slip(*quantity, *ratio)
            ),
            Self::DepthUnits {
                ratios: [force, rise],
            } => write!(
                f,
                "force and pressure rise of the data are {} and {} times what the design gives at these depths: is the indentation in \
                 inches, cm or m, or are they in mN and Pa? check the units (N, kPa, mm) and the design",
                significant(*force, 3),
                significant(*rise, 3)
            ),
            Self::TooDeep { deepest, height } => write!(
                f,
                "the data go {} mm deep, and the tip is {} mm high: {}",
                significant(1e3 * deepest, 4),
                significant(1e3 * height, 4),
                if (0.02..0.9).contains(&(1e-3 * deepest / height)) {
                    "are these micrometres? The column is indentation_mm"
                } else {
                    "give the indentation from first touch on, not the stage's position, in mm, or measure from before first touch on and \
                     find it with --per-trial indentation-offset"
                }
            ),
            Self::NotFromFirstTouch(read) => write!(
                f,
                "first touch is where the stage reads {} mm, and the tip has no press as deep as it reads: count the indentation from \
                 there, or find it with --per-trial indentation-offset",
                significant(1e3 * read, 4)
            ),
            Self::Swapped => write!(
                f,
                "force_n runs as the design's pressure rise and pressure_rise_kpa as its force: the two columns are swapped; \
                 rename them, or say --columns force_n=pressure_rise_kpa,pressure_rise_kpa=force_n"
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
            Self::ZeroTwice(parameter) => write!(
                f,
                "{parameter} is to be fitted for every trial and for all of them together, which act as one: leave it out of --fit or of \
                 --per-trial"
            ),
            Self::Nonsense { parameter, value } => write!(
                f,
                "the data ask for {parameter} = {value:.4}, which no such device has: check units and design, fit other \
                 parameters, or use --from-data"
            ),
            Self::Unsettled => write!(
                f,
                "no least squares after as many states of the model as a fit may take: the data do not run as a pressed tip's, whose \
                 force grows ever faster with the indentation; check columns and zero, fit fewer parameters, or use --from-data"
            ),
            Self::Lost => write!(
                f,
                "no values of the parameters come near the data: check units and design, or use --from-data"
            ),
        }
    }
}

/// Units that data come in by a slip, and what a column in them reads over one in the contract's.
const SLIPS: [(DataQuantity, &str, f64); 7] = [
    (DataQuantity::Rise, "Pa", 1e3),
    (DataQuantity::Rise, "mbar or hPa", 10.0),
    (DataQuantity::Rise, "bar", 1e-2),
    (DataQuantity::Rise, "MPa", 1e-3),
    (DataQuantity::Force, "mN", 1e3),
    (DataQuantity::Force, "gram-force", 101.97),
    (DataQuantity::Force, "kN", 1e-3),
];
/// Data are so many times off a slip at most.
const NEAR: f64 = 4.0;

/// The unit that the data may be in.
fn slip(quantity: DataQuantity, ratio: f64) -> String {
    let off = |size: f64| libm::fabs(libm::log(ratio / size));
    SLIPS
        .iter()
        .filter(|(of, _, size)| *of == quantity && off(*size) < libm::log(NEAR))
        .min_by(|a, b| off(a.2).total_cmp(&off(b.2)))
        .map_or_else(String::new, |(_, unit, _)| format!("are they in {unit}? "))
}

impl core::error::Error for FitError {}
