//! What can be wrong with a design file.

use std::fmt;

/// A design file that cannot be used; `Display` is one line.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct DesignFileError {
    /// The file.
    pub file: String,
    /// Line of the offence, counted from 1; `None` where there is none (a missing section, a missing file).
    pub line: Option<usize>,
    /// What is wrong.
    pub problem: Problem,
}

/// What is wrong.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Problem {
    /// The file cannot be read.
    Unreadable(String),
    /// The text is not TOML.
    Syntax(String),
    /// A key or section that must be there is not.
    Missing {
        /// Its full name.
        key: String,
        /// What it has to be.
        allowed: String,
    },
    /// A key or section nobody knows.
    Unknown {
        /// Its full name.
        key: String,
        /// The names known in that place.
        allowed: String,
    },
    /// The file is of a hand, which has no fingertip of its own.
    Hand {
        /// The design files of its tips.
        designs: String,
    },
    /// A value that cannot be.
    Value {
        /// Full name of the key.
        key: String,
        /// The value, as written.
        found: String,
        /// What it has to be.
        allowed: String,
    },
}

impl DesignFileError {
    /// A fault (the line, where there is one, and what is wrong there) in a file of that name.
    pub fn at(file: &str, (line, problem): (Option<usize>, Problem)) -> Self {
        Self {
            file: file.to_owned(),
            line,
            problem,
        }
    }
}

impl fmt::Display for DesignFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(reason) => write!(f, "the design file cannot be read: {}", one_line(reason)),
            Self::Syntax(reason) => write!(f, "not valid TOML: {}", one_line(reason)),
            Self::Missing { key, allowed } => write!(f, "`{key}` is missing: needs {allowed}"),
            Self::Unknown { key, allowed } => {
                write!(f, "`{key}` is not a known key")?;
                if let Some(nearest) = nearest(key, allowed) {
                    write!(f, ", did you mean `{nearest}`?")?;
                }
                write!(f, ": allowed are {allowed}")
            }
            Self::Hand { designs } => write!(
                f,
                "this is a hand, which has no fingertip of its own: name the design of one of its tips: {designs}"
            ),
            Self::Value { key, found, allowed } => {
                write!(f, "`{key}` is {}: must be {allowed}", one_line(found))
            }
        }
    }
}

impl core::error::Error for DesignFileError {}

/// Likeness of two names from which on one is a slip of the other.
const ALIKE: f64 = 0.85;

/// The allowed name that a key is a slip of.
fn nearest<'a>(key: &str, allowed: &'a str) -> Option<&'a str> {
    let key = key.rsplit('.').next().unwrap_or(key);
    allowed
        .split(", ")
        .map(|name| (strsim::jaro_winkler(key, name), name))
        .filter(|(alike, _)| *alike > ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// Shortest name of which one letter more, less or other is a slip: `c1_pa` and `c2_pa` are two names.
const MIN_LENGTH: usize = 8;

/// Whether a key of a file is a slip of the one that is missing.
pub(super) fn is_slip(found: &str, missing: &str) -> bool {
    missing.len() >= MIN_LENGTH && strsim::damerau_levenshtein(found, missing) == 1
}

/// Line breaks and runs of spaces become single spaces.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
