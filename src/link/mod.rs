//! The serial line, both ways: frames on the [`wire`], frames from the board ([`telemetry`], queued in an [`outbox`]) and
//! commands from the host ([`command`]). To write a client, use `PROTOCOL.md` beside this file.

#[cfg(band)]
pub mod band;
pub mod command;
#[cfg(feature = "load-tip")]
pub mod load;
pub mod outbox;
pub mod sink;
pub mod telemetry;
#[cfg(tips)]
pub mod tips;
pub mod wire;
