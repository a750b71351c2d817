//! Where reports come from: a board's link, or a log.

pub mod replay;

use crate::link::{Link, LinkEvent};
use crate::readings::{LiveReading, Monitor};
use replay::Replay;
use std::thread;
use std::time::Duration;

/// What a source gives.
pub(crate) enum Source {
    Link(Link),
    Replay(Replay),
}

/// What came.
pub(crate) enum SourceEvent {
    Link(LinkEvent),
    Reading(LiveReading),
    /// The log is over.
    End,
}

impl Source {
    /// The next event, if it comes within that time; `now` is the time since the start.
    pub(crate) fn next(&mut self, now: Duration, within: Duration) -> Option<SourceEvent> {
        match self {
            Self::Link(link) => link.next(within).map(SourceEvent::Link),
            Self::Replay(replay) => match replay.due() {
                None => Some(SourceEvent::End),
                Some(due) if due <= now + within => {
                    thread::sleep(due.saturating_sub(now));
                    replay.next().map(SourceEvent::Reading)
                }
                Some(_) => {
                    thread::sleep(within);
                    None
                }
            },
        }
    }
}

/// Takes an event; every report of it goes to `each`. Tells whether the source is at its end.
pub(crate) fn take(
    event: SourceEvent,
    monitor: &mut Monitor,
    now: Duration,
    each: &mut impl FnMut(&LiveReading) -> Result<(), String>,
) -> Result<bool, String> {
    match event {
        SourceEvent::Link(LinkEvent::Connected) => monitor.connected(),
        SourceEvent::Link(LinkEvent::Lost(reason)) => monitor.lost(&reason),
        SourceEvent::Link(LinkEvent::Bytes(bytes)) => {
            for byte in bytes {
                if let Some(reading) = monitor.hear(byte, now) {
                    each(&reading)?;
                }
            }
        }
        SourceEvent::Reading(reading) => each(&monitor.take(reading))?,
        SourceEvent::End => return Ok(true),
    }
    Ok(false)
}
