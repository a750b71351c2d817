//! Of a board of several fingertips: which tip is followed, and its frames as those of a board of one.

use fingertip::link::command::{self, Request};
use fingertip::link::telemetry::{Hello, Message};
use fingertip::link::tips::{TipsMessage, encode_request};
use std::collections::BTreeMap;

/// The tip that is followed.
#[derive(Clone, Debug)]
pub(crate) struct TipChoice {
    /// Its number or name, as it was asked for.
    wanted: String,
    /// Names by number, from the tips' greetings.
    names: BTreeMap<u8, String>,
    /// The board's greeting and the number of its tips; `None`: a board of one, or none came.
    board: Option<(Hello, u8)>,
    /// Whether frames of several tips came.
    is_hand: bool,
}

impl Default for TipChoice {
    fn default() -> Self {
        Self::of("0")
    }
}

impl TipChoice {
    /// Of a tip's number or name.
    pub(crate) fn of(wanted: &str) -> Self {
        Self {
            wanted: wanted.to_owned(),
            names: BTreeMap::new(),
            board: None,
            is_hand: false,
        }
    }

    /// The same of another board, or of another run of it.
    pub(crate) fn anew(&self) -> Self {
        Self::of(&self.wanted)
    }

    /// Its number, once that is known.
    fn number(&self) -> Option<u8> {
        let named = self.names.iter().find(|(_, name)| **name == self.wanted);
        named
            .map(|(number, _)| *number)
            .or_else(|| self.wanted.parse().ok())
    }

    /// Its frames: what a message has of it, as a board of one would send that.
    pub(crate) fn message(&mut self, message: TipsMessage) -> Option<Message> {
        self.is_hand = true;
        match message {
            TipsMessage::Readings {
                pressure_fraction_bits,
                reports,
                ..
            } => Some(Message::Report {
                report: *reports.get(usize::from(self.number()?))?,
                pressure_fraction_bits,
            }),
            TipsMessage::Board { hello, tips } => {
                self.board = Some((hello, tips));
                None
            }
            TipsMessage::Tip(tip) => {
                self.names.insert(tip.tip, tip.name.as_str().to_owned());
                let (board, _) = self.board?;
                (self.number() == Some(tip.tip)).then_some(Message::Hello(Hello {
                    time: tip.time,
                    design_hash: tip.design_hash,
                    table_version: tip.table_version,
                    report_period: tip.report_period,
                    stored: tip.stored,
                    stored_sequence: tip.stored_sequence,
                    samples_rejected: tip.samples_rejected,
                    ..board
                }))
            }
            TipsMessage::Answer { tip, answer } => {
                (self.number() == Some(tip)).then_some(Message::Answer(answer))
            }
            TipsMessage::Band { tip, band } => (self.number() == Some(tip)).then_some(Message::Band(band)),
            TipsMessage::Load { tip, reply } => (self.number() == Some(tip)).then_some(Message::Load(reply)),
        }
    }

    /// The bytes of a command to it.
    pub(crate) fn encode(&self, request: &Request) -> Vec<u8> {
        match self.number().filter(|_| self.is_hand) {
            Some(tip) => encode_request(tip, request).to_vec(),
            None => command::encode(request).to_vec(),
        }
    }

    /// What it is called, of a hand; why there is none, where the board has no such tip.
    pub(crate) fn label(&self) -> Option<String> {
        let tips = self.board.map(|(_, tips)| tips).filter(|_| self.is_hand)?;
        let names = || self.names.values().cloned().collect::<Vec<_>>().join(", ");
        Some(match self.number().filter(|&number| number < tips) {
            Some(number) => {
                let name = self.names.get(&number).map_or("", String::as_str);
                format!("tip {name} ({number} of {tips})")
            }
            None => format!("no tip `{}`: there are {}", self.wanted, names()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fingertip::link::command::Command;
    use fingertip::link::tips::TipHello;
    use fingertip::link::wire::HAND_VERSION;
    use fingertip::signal::report::Report;
    use fingertip::status::{Fault, Stored};
    use fingertip::units::Microseconds;

    fn greeted(wanted: &str) -> (TipChoice, Vec<Message>) {
        let mut choice = TipChoice::of(wanted);
        let board = TipsMessage::Board {
            hello: Hello::default(),
            tips: 2,
        };
        let mut given: Vec<Message> = choice.message(board).into_iter().collect();
        for (tip, name) in [(0, "thumb"), (1, "index")] {
            let hello = TipHello {
                time: Microseconds(5),
                tip,
                design_hash: u64::from(tip) + 10,
                table_version: 5,
                report_period: 2010,
                stored: Stored::None,
                stored_sequence: 0,
                samples_rejected: 0,
                name: name.try_into().expect("it is short"),
            };
            given.extend(choice.message(TipsMessage::Tip(hello)));
        }
        (choice, given)
    }

    fn readings() -> TipsMessage {
        let report = |fault| Report {
            time: Microseconds(5),
            outcome: Err(fault),
        };
        TipsMessage::Readings {
            time: Microseconds(5),
            pressure_fraction_bits: 8,
            reports: [report(Fault::Zeroing), report(Fault::SensorOpen)]
                .into_iter()
                .collect(),
        }
    }

    #[test]
    fn a_tip_is_followed_by_its_name_or_its_number() {
        for wanted in ["index", "1"] {
            let (mut choice, given) = greeted(wanted);
            assert!(
                matches!(&given[..], [Message::Hello(hello)] if hello.design_hash == 11 && hello.report_period == 2010),
                "{given:?}"
            );
            let report = choice.message(readings());
            assert!(
                matches!(report, Some(Message::Report { report, .. }) if report.outcome == Err(Fault::SensorOpen)),
                "{report:?}"
            );
            assert_eq!(choice.label().as_deref(), Some("tip index (1 of 2)"));
            let request = Request {
                sequence: 1,
                command: Command::Tare,
            };
            let bytes = choice.encode(&request);
            assert!(bytes.contains(&HAND_VERSION) && bytes == encode_request(1, &request).to_vec());
        }
    }

    #[test]
    fn a_tip_that_is_not_there_is_named_with_those_that_are() {
        let (mut choice, given) = greeted("ring");
        assert!(given.is_empty() && choice.message(readings()).is_none());
        assert_eq!(
            choice.label().as_deref(),
            Some("no tip `ring`: there are thumb, index")
        );
    }
}
