//! Commands that wait for their answer: one of a kind at a time, each answered, given up, or lost with the connection.

use fingertip::link::command::{Command, CommandKind, Outcome};
use fingertip::link::telemetry::Answer;
use model_tables::table::known::{KnownContact, doubts};
use std::time::Duration;

/// What a self-test finds, by the bits of its answer (PROTOCOL.md, kind 4).
const FINDINGS: [&str; 8] = [
    "no reading",
    "zero unverified",
    "nothing stored",
    "leak or bubble suspected",
    "softer than the model at the indentation given",
    "the run before ended in a fault",
    "samples were lost",
    "the crystal failed",
];

/// Commands on their way.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pending(Vec<(u16, CommandKind, Duration)>);

impl Pending {
    /// The number of the command of this kind that is not answered yet.
    pub(crate) fn waiting(&self, kind: CommandKind) -> Option<u16> {
        self.0
            .iter()
            .find(|(_, one, _)| *one == kind)
            .map(|(sequence, ..)| *sequence)
    }

    /// A command was sent.
    pub(crate) fn sent(&mut self, sequence: u16, command: Command, now: Duration) {
        self.0
            .push((sequence, command.kind(), now + patience(command.kind())));
    }

    /// Whether the answer is to one of these; it is one no longer.
    pub(crate) fn answered(&mut self, answer: &Answer) -> bool {
        let before = self.0.len();
        self.0
            .retain(|(sequence, kind, _)| (*sequence, *kind) != (answer.command_sequence, answer.command));
        self.0.len() < before
    }

    /// Those whose answer is overdue, given up.
    pub(crate) fn overdue(&mut self, now: Duration) -> Vec<(u16, CommandKind)> {
        self.given_up(|until| until <= now)
    }

    /// All of them, given up: the board was reset or is out of reach.
    pub(crate) fn lost(&mut self) -> Vec<(u16, CommandKind)> {
        self.given_up(|_| true)
    }

    fn given_up(&mut self, which: impl Fn(Duration) -> bool) -> Vec<(u16, CommandKind)> {
        let gone = self
            .0
            .iter()
            .filter(|(.., until)| which(*until))
            .map(|(sequence, kind, _)| (*sequence, *kind))
            .collect();
        self.0.retain(|(.., until)| !which(*until));
        gone
    }
}

/// How long an answer may take, twice what the protocol allows at least.
fn patience(kind: CommandKind) -> Duration {
    Duration::from_secs(match kind {
        CommandKind::Tare => 5,
        CommandKind::Save | CommandKind::Forget => 10,
        _ => 3,
    })
}

/// A command's name, as `PROTOCOL.md` has it.
pub(crate) fn name(kind: CommandKind) -> &'static str {
    match kind {
        CommandKind::Tare => "tare",
        CommandKind::Undo => "undo",
        CommandKind::Save => "save",
        CommandKind::Info => "info",
        CommandKind::SelfTest => "self-test",
        CommandKind::Rate => "rate",
        CommandKind::Forget => "forget",
        CommandKind::Air => "air",
        CommandKind::Object => "object",
        CommandKind::Indentation => "indentation",
    }
}

/// An answer for the journal.
pub(crate) fn describe(answer: &Answer) -> String {
    let outcome = match answer.outcome {
        Outcome::Done => "done",
        Outcome::Touched => "refused: the fingertip is touched, or may be",
        Outcome::Restless => "refused: the fingertip did not keep still",
        Outcome::OutOfBounds => "refused: the zero is further off than any transducer drifts",
        Outcome::NoReading => "refused: there are no readings",
        Outcome::Busy => "refused: the same is under way",
        Outcome::NothingToUndo => "refused: there is nothing to undo",
        Outcome::ZeroUnverified => "refused: no verified zero; tare first",
        Outcome::MemoryFailed => "failed: the memory did not take it",
        Outcome::NotInImage => "refused: the design in the image has no use for it",
        Outcome::SavedTooOften => {
            "refused: saved too often; one save in 6.5 minutes, or later on a hand's small flash"
        }
        Outcome::NoSuchObject => "refused: the design has no tables of such an object",
    };
    let findings = match answer.command {
        CommandKind::SelfTest => format!(": {}", findings(answer.findings)),
        _ => String::new(),
    };
    let findings = answer.known.map_or(findings, |known| known_indentation(&known));
    format!(
        "{} {}: {outcome}{findings}",
        name(answer.command),
        answer.command_sequence
    )
}

/// What an indentation that the host knows told.
fn known_indentation(known: &KnownContact) -> String {
    let doubts: String = [
        (
            doubts::LIGHT,
            "; a light touch: the force is up to 17 % low, the curvature unknown",
        ),
        (
            doubts::SHALLOW,
            "; less deep than a plate: a cup, friction, or a wrong indentation",
        ),
        (
            doubts::TIGHT,
            "; curved more than any ball that was solved: at least this curvature",
        ),
    ]
    .iter()
    .filter(|(bit, _)| known.doubts & bit != 0)
    .map(|(_, words)| *words)
    .collect();
    format!(
        ", {:.4} N within {:.4} N, curvature {:.1} 1/m within {:.1} 1/m{doubts}",
        known.force.newtons(),
        known.force_sigma.newtons(),
        1e-3 * f64::from(known.curvature),
        1e-3 * f64::from(known.curvature_sigma),
    )
}

/// What a self-test found, in words.
fn findings(bits: u16) -> String {
    let mut found: Vec<String> = FINDINGS
        .iter()
        .enumerate()
        .filter(|(bit, _)| bits >> bit & 1 == 1)
        .map(|(_, words)| (*words).to_owned())
        .collect();
    let unknown = bits >> FINDINGS.len();
    if unknown != 0 {
        found.push(format!("{unknown:#x} above what this monitor knows"));
    }
    if found.is_empty() {
        "nothing found".to_owned()
    } else {
        found.join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_are_told_in_the_words_of_the_protocol() {
        let page = include_str!("../../../../src/link/PROTOCOL.md");
        let row = page
            .lines()
            .find(|line| line.contains("of a self-test: findings"))
            .expect("the page has them");
        for (bit, words) in FINDINGS.iter().enumerate() {
            let listed = format!("{bit} {words}");
            assert!(row.contains(&listed), "{listed} in {row}");
        }
        assert_eq!(findings(0), "nothing found");
        assert_eq!(findings(0b101), "no reading; nothing stored");
        assert_eq!(findings(0x100), "0x1 above what this monitor knows");
    }
}
