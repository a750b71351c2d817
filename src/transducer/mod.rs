//! Pressure transducers: one file a part, on a bus or on the chip's converter, and what keeps each going.

pub mod abp2;
pub mod bus;
pub mod counts;
pub mod dps310;
pub mod driver;
pub mod keeper;
pub mod ms5837;
pub mod ratiometric;
#[cfg(test)]
mod script;

use model_tables::constants::TransducerKind;

/// From one sample of a kind of transducer to the next, microseconds.
pub const fn period(kind: &TransducerKind) -> u32 {
    match kind {
        TransducerKind::Ratiometric { .. } => counts::PERIOD,
        TransducerKind::Abp2 { .. } => abp2::PERIOD,
        TransducerKind::Ms5837 { .. } => ms5837::PERIOD,
        TransducerKind::Dps310 { .. } => dps310::PERIOD,
    }
}
