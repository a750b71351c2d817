//! Pressure transducers on a bus or on the chip's converter, one file per part, and the supervisor that restarts them.

pub mod abp2;
pub mod bus;
pub mod counts;
pub mod dps310;
pub mod driver;
pub mod ms5837;
#[cfg(tips)]
pub mod multiplexer;
pub mod ratiometric;
#[cfg(tips)]
pub mod rounds;
#[cfg(tips)]
pub mod scan;
#[cfg(test)]
mod script;
#[cfg(tips)]
pub mod shared_bus;
pub mod supervisor;
