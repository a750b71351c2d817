//! What a job asks next, and how long its answer may take.

use fingertip::link::load::LoadCommand;
use std::time::Duration;

/// What is sent next.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Asked {
    /// Who is there.
    Info,
    Load(LoadCommand),
}

impl Asked {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Load(command) => command.kind().word(),
        }
    }

    /// How long its answer may take: an erasure takes two seconds at most, and the board's patience with one of a hand ends after three.
    pub(super) const fn patience(self, of_a_hand: bool) -> Duration {
        Duration::from_millis(match self {
            Self::Load(LoadCommand::Begin { .. }) if of_a_hand => 3_500,
            Self::Load(LoadCommand::Begin { .. }) => 2_500,
            Self::Load(LoadCommand::Verify | LoadCommand::RollBack | LoadCommand::Activate { .. }) => 1_500,
            Self::Info | Self::Load(_) => 250,
        })
    }
}
