//! Which tip of the board a job is for: the one of a board of one, or one of a hand, by its number or name.

use super::LoadFailure;
use fingertip::link::command::{self, Request};
use fingertip::link::load::{self, LoadRequest};
use fingertip::link::tips::{ALL_TIPS, MAX_TIPS, encode_load, encode_request};
use std::collections::BTreeMap;

/// The tip, as far as it is known.
#[derive(Debug)]
pub(super) struct Target {
    /// As it was asked for: a number or a name.
    wanted: Option<String>,
    /// The name of the design in the file.
    own: Option<String>,
    /// Whether frames of a hand came; `None`: neither those nor a greeting of a board of one.
    is_hand: Option<bool>,
    /// How many tips a hand has, and their names.
    tips: Option<u8>,
    names: BTreeMap<u8, String>,
    number: Option<u8>,
}

impl Target {
    pub(super) fn new(wanted: Option<&str>, own: Option<&str>) -> Self {
        Self {
            wanted: wanted.map(str::to_owned),
            own: own.map(str::to_owned),
            is_hand: None,
            tips: None,
            names: BTreeMap::new(),
            number: None,
        }
    }

    pub(super) fn is_hand(&self) -> bool {
        self.is_hand == Some(true)
    }

    /// A board of one greeted.
    pub(super) fn is_one(&mut self) {
        self.is_hand = Some(false);
    }

    /// A frame of a hand came; whether it is the first.
    pub(super) fn is_a_hand(&mut self) -> bool {
        self.is_hand.replace(true) != Some(true)
    }

    /// A hand has so many tips.
    pub(super) fn has(&mut self, tips: u8) {
        self.tips = Some(tips);
    }

    /// A tip of a hand has this name.
    pub(super) fn greeted(&mut self, tip: u8, name: &str) {
        self.names.insert(tip, name.to_owned());
    }

    /// The tip's number, once it is known.
    pub(super) fn number(&self) -> Option<u8> {
        self.number
    }

    /// Its name, of a hand.
    pub(super) fn name(&self) -> Option<String> {
        self.names.get(&self.number?).cloned()
    }

    /// Finds the tip's number, if what came is enough for that.
    pub(super) fn resolve(&mut self) -> Result<Option<u8>, LoadFailure> {
        if self.number.is_none() {
            self.number = if self.is_hand() {
                self.of_the_hand()?
            } else {
                self.of_one()?
            };
        }
        Ok(self.number)
    }

    fn of_one(&self) -> Result<Option<u8>, LoadFailure> {
        let Some(wanted) = &self.wanted else {
            return Ok(Some(0));
        };
        match wanted.parse::<u8>() {
            _ if self.own.as_ref() == Some(wanted) => Ok(Some(0)),
            Ok(number) if usize::from(number) < MAX_TIPS => Ok(Some(number)),
            _ => Err(LoadFailure::NoNumber {
                wanted: wanted.clone(),
                own: self.own.clone(),
            }),
        }
    }

    fn of_the_hand(&self) -> Result<Option<u8>, LoadFailure> {
        let Some(tips) = self.tips else {
            return Ok(None);
        };
        let named = |wanted: &String| self.names.iter().find(|(_, name)| *name == wanted);
        let found = self.wanted.as_ref().and_then(|wanted| {
            let number = wanted.parse().ok().filter(|&number: &u8| number < tips);
            named(wanted).map(|(number, _)| *number).or(number)
        });
        // A hand of one is a board of one.
        let found = found.or((tips == 1 && self.wanted.is_none()).then_some(0));
        if found.is_none() && self.names.len() == usize::from(tips) {
            return Err(LoadFailure::NoSuchTip {
                wanted: self.wanted.clone(),
                names: self.names.values().cloned().collect(),
            });
        }
        Ok(found)
    }

    /// The bytes of a question who is there.
    pub(super) fn encode_info(&self, request: &Request) -> Vec<u8> {
        if self.is_hand() {
            encode_request(ALL_TIPS, request).to_vec()
        } else {
            command::encode(request).to_vec()
        }
    }

    /// The bytes of a command to the tip.
    pub(super) fn encode(&self, request: &LoadRequest) -> Vec<u8> {
        match self.number.filter(|_| self.is_hand()) {
            Some(tip) => encode_load(tip, request).to_vec(),
            None => load::encode(request).to_vec(),
        }
    }
}
