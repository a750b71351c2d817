//! Honeywell ABP2 on I2C: gauge pressure, 24 bits, compensated by the part itself (datasheet 32350268, section 5).
//!
//! `AA 00 00` starts a measurement; seven bytes answer: status, pressure and temperature, the highest byte first. The part has no
//! command for a reset or for its identity. It is recognised by a status that no other part gives.

use crate::status::Fault;
use crate::transducer::bus::{self, Bus};
use crate::transducer::driver::{Driver, Sample};
use crate::units::{Centidegrees, Millipascals, saturate};
use embedded_hal_async::delay::DelayNs;
use model_tables::constants;
use model_tables::constants::{TransducerKind, conversion, period};

/// Time from one sample to the next, microseconds: the part measures about 200 times a second.
pub const PERIOD: u32 = period::ABP2;

const MEASURE: [u8; 3] = [0xAA, 0x00, 0x00];
/// Bits of the status byte that are checked: powered, busy, memory error, saturated arithmetic.
const STATUS_MASK: u8 = 0x65;
const POWERED: u8 = 0x40;
const BUSY: u8 = 0x20;
const MEMORY_ERROR: u8 = 0x04;
const SATURATED: u8 = 0x01;

/// First wait for a measurement, microseconds.
const CONVERSION: u32 = conversion::ABP2;
/// Number of further waits while the part is busy.
const ATTEMPTS: u32 = 4;
/// Length of each further wait, microseconds.
const PATIENCE: u32 = 500;
/// Seven bytes and the address at 400 kHz, microseconds.
const READ: u32 = 200;

/// Largest count of 24 bits. The first and the last count are not measurements.
const FULL_SCALE: u32 = 0x00FF_FFFF;

/// The part.
#[derive(Debug)]
pub struct Abp2<B, D> {
    bus: B,
    delay: D,
    address: u8,
    line: Line,
}

impl<B: Bus, D: DelayNs> Abp2<B, D> {
    /// The part of a design on a bus.
    ///
    /// # Panics
    /// If the design has another kind of transducer.
    pub const fn new(transducer: &constants::Transducer, bus: B, delay: D) -> Self {
        let TransducerKind::Abp2 { address, counts } = transducer.kind else {
            panic!("the design's transducer is no ABP2")
        };
        Self {
            bus,
            delay,
            address,
            line: Line {
                counts,
                range: transducer.range,
            },
        }
    }
}

impl<B: Bus, D: DelayNs> Driver for Abp2<B, D> {
    /// The part needs no set-up. A measurement shows whether it is present and works.
    async fn start(&mut self) -> Result<(), Fault> {
        self.sample().await.map(|_| ())
    }

    async fn sample(&mut self) -> Result<Sample, Fault> {
        self.bus.write(self.address, &MEASURE).await.map_err(bus::fault)?;
        self.delay.delay_us(CONVERSION).await;
        for attempt in 0..ATTEMPTS {
            let mut words = [0; 7];
            self.bus
                .read(self.address, &mut words)
                .await
                .map_err(bus::fault)?;
            match self.line.sample(words) {
                Err(Fault::SensorBusy) => self.delay.delay_us(PATIENCE).await,
                Err(fault) => return Err(fault),
                Ok(sample) => {
                    let age = CONVERSION / 2 + READ + attempt * (PATIENCE + READ);
                    return Ok(Sample { age, ..sample });
                }
            }
        }
        Err(Fault::SensorBusy)
    }

    async fn free(&mut self) {
        self.bus.clear().await;
    }
}

/// Counts to pressure: a straight line.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Counts at the ends of the range.
    counts: [u32; 2],
    /// The range, pascals.
    range: [i32; 2],
}

impl Line {
    /// Decodes the sample in the seven bytes, without its age.
    fn sample(&self, [status, p2, p1, p0, t2, t1, t0]: [u8; 7]) -> Result<Sample, Fault> {
        if status & STATUS_MASK != POWERED {
            // 0xFF means that nobody drives the line. A status without the powered bit is not from this part.
            return Err(if status & POWERED == 0 || status == 0xFF {
                Fault::SensorImplausible
            } else if status & MEMORY_ERROR != 0 {
                Fault::SensorMemory
            } else if status & SATURATED != 0 {
                Fault::SensorSaturated
            } else {
                debug_assert!(status & BUSY != 0, "the mask has no other bit");
                Fault::SensorBusy
            });
        }
        let pressure = u32::from_be_bytes([0, p2, p1, p0]);
        let temperature = u32::from_be_bytes([0, t2, t1, t0]);
        if pressure == 0 || pressure == FULL_SCALE {
            return Err(Fault::SensorSaturated);
        }
        let [low, high] = self.counts.map(i64::from);
        let [start, end] = self.range.map(|pascals| i64::from(pascals) * 1000);
        // At most 2^24 * 2^32 = 2^56; |range| of the design stays below 2^31 millipascals.
        let above = (i64::from(pressure) - low) * (end - start);
        let span = high - low;
        let full = i64::from(FULL_SCALE);
        let pressure_mpa = start + (above + if above < 0 { -span / 2 } else { span / 2 }) / span;
        Ok(Sample {
            pressure: millipascals(pressure_mpa),
            headroom: millipascals(end - pressure_mpa),
            // T = counts * 200 / (2^24 - 1) - 50 degC.
            temperature: Some(Centidegrees(
                ((i64::from(temperature) * 20_000 + full / 2) / full - 5_000) as i16,
            )),
            raw: Some(pressure),
            age: 0,
        })
    }
}

fn millipascals(number: i64) -> Millipascals {
    Millipascals(saturate(number))
}

#[cfg(test)]
mod tests;
