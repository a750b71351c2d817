//! Why a job on a tip failed, with the remedy.

use fingertip::link::load::{LoadKind, LoadOutcome, refused};
use std::fmt;

/// Why it failed.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum LoadFailure {
    /// A command was not answered.
    NoAnswer(&'static str),
    /// There was no connection for too long.
    NoConnection(String),
    /// The board refused.
    Refused(LoadKind, LoadOutcome, u16),
    /// A board of one tip was asked for another than that.
    NoNumber {
        /// What was asked for.
        wanted: String,
        /// The name of the design in the file.
        own: Option<String>,
    },
    /// The hand has no such tip, or was asked for none.
    NoSuchTip {
        /// What was asked for.
        wanted: Option<String>,
        /// What its tips are called.
        names: Vec<String>,
    },
    /// The board did not come back, or with another design than was to be in use.
    NotInUse {
        /// The hash of its last hello.
        found: Option<u64>,
    },
}

impl fmt::Display for LoadFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAnswer("info") => {
                f.write_str("no board answers; see that it is a fingertip's port, at its speed")
            }
            Self::NoAnswer("arm") => f.write_str(
                "the board does not answer `arm`: its firmware was built without the feature load-tip; flash one that has it",
            ),
            Self::NoAnswer(what) => write!(f, "the board no longer answers (`{what}`); see to the line and load again"),
            Self::NoConnection(reason) => {
                write!(f, "no connection: {reason}; see that the board is plugged in, and load again")
            }
            Self::Refused(kind, outcome, findings) => {
                write!(f, "the board refused `{}`: {}", kind.word(), label(*kind, *outcome, *findings))
            }
            Self::NoNumber { wanted, own } => {
                write!(f, "--tip {wanted} is no number, and the board has one tip")?;
                match own {
                    Some(own) => write!(f, ", the file `{own}`: give 0, or the file of that tip"),
                    None => f.write_str(": give 0"),
                }
            }
            Self::NoSuchTip { wanted, names } => {
                let names = names.join(", ");
                match wanted {
                    Some(wanted) => write!(f, "the hand has no tip `{wanted}`: give --tip with one of {names}"),
                    None => write!(f, "the board is a hand: give --tip with one of {names}"),
                }
            }
            Self::NotInUse { found: Some(found) } => write!(
                f,
                "the board is back with design {found:016x}, which is not the one that was to be in use; load again"
            ),
            Self::NotInUse { found: None } => {
                f.write_str("the board did not come back after the restart; switch it off and on")
            }
        }
    }
}

/// An outcome with its remedy.
fn label(kind: LoadKind, outcome: LoadOutcome, findings: u16) -> String {
    let plain = match outcome {
        LoadOutcome::OutOfBounds => {
            "the block is longer than its memory; ask a coarser accuracy of the design"
        }
        LoadOutcome::Busy => "it is about to restart; try again",
        LoadOutcome::NothingToRollBack => "nothing was loaded, so that there is nothing to take back",
        LoadOutcome::MemoryFailed => {
            "its flash does not take the block; what was in use still is; try another board"
        }
        LoadOutcome::WrongTip => "it has no such tip; take --tip 0",
        LoadOutcome::OutOfOrder if kind == LoadKind::ReadBack => {
            "no loaded tip is in use, its image's own tables are; load one first"
        }
        LoadOutcome::OutOfOrder => "it lost track of the load; load again",
        LoadOutcome::OtherHash => "the block is of another design than the file; load again",
        LoadOutcome::NotArmed => "it is not armed; load again",
        LoadOutcome::Done => "done",
        LoadOutcome::BlockRefused => {
            const REASONS: [(u16, &str); 6] = [
                (refused::LENGTH, "its length differs"),
                (refused::CHECK, "its CRC-32 differs"),
                (refused::LAYOUT, "its layout is not the firmware's"),
                (refused::TABLES, "its tables may answer wrongly"),
                (refused::VALUE, "a value of it is out of its range"),
                (
                    refused::TRANSDUCER,
                    "it is for another transducer than the firmware's; make the tip of a design with that [transducer]",
                ),
            ];
            let reasons: Vec<&str> = REASONS
                .iter()
                .filter(|(bit, _)| findings & bit != 0)
                .map(|(_, words)| *words)
                .collect();
            return format!("the tip cannot be used there: {}", reasons.join(", "));
        }
    };
    plain.to_owned()
}
