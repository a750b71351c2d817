//! The serial line, both ways: frames on the [`wire`], what the board sends ([`telemetry`], from an [`outbox`]) and what the
//! host may ask ([`command`]). `PROTOCOL.md` beside this file is the page to write a client from.

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
