//! Infineon DPS310 on I2C: absolute pressure, 30 to 120 kPa. It suits a light touch only: its range ends 12 kPa above the
//! densest air (datasheet V1.2 of 2020-10-15, whose sections are cited).
//!
//! A Goertek SPL06 answers with the same identity and the same coefficients, measures to 110 kPa only, and lacks the register
//! that states the temperature sensor of the coefficients. The driver would use its coefficients with the wrong sensor
//! (Infineon/DPS310-Pressure-Sensor issue 20, `ArduPilot` pull request 32480). The driver therefore refuses a part that does
//! not name the sensor on the pressure element. This also refuses a DPS310 that is calibrated for the other sensor, which the
//! datasheet allows.
//!
//! One pressure and one temperature are commanded for each sample, so that the time of each is known, and the settings are read
//! back with the words. This detects a part that reset itself and continues with another scale.

use crate::status::Fault;
use crate::transducer::bus::{self, Bus};
use crate::transducer::driver::{Driver, Sample, recognise};
use crate::units::{Centidegrees, Millipascals, saturate};
use embedded_hal_async::delay::DelayNs;
use model_tables::constants::{conversion, period};

/// Time from one sample to the next, microseconds.
pub const PERIOD: u32 = period::DPS310;

/// Registers (section 7, table 15).
const PRS_B2: u8 = 0x00;
const PRS_CFG: u8 = 0x06;
const TMP_CFG: u8 = 0x07;
const MEAS_CFG: u8 = 0x08;
const CFG_REG: u8 = 0x09;
const RESET: u8 = 0x0C;
const ID: u8 = 0x0D;
const COEF: u8 = 0x10;
const COEF_SRCE: u8 = 0x28;

/// `PROD_ID` and `REV_ID` (section 8.10).
const IDENTITY: u8 = 0x10;
/// `SOFT_RST` (section 8.9).
const SOFT_RESET: u8 = 0x09;
/// Flags of `MEAS_CFG` (section 8.5).
const COEF_RDY: u8 = 0x80;
const SENSOR_RDY: u8 = 0x40;
const TMP_RDY: u8 = 0x20;
const PRS_RDY: u8 = 0x10;
/// `MEAS_CTRL`: one pressure, one temperature.
const COMMAND_PRESSURE: u8 = 0x01;
const COMMAND_TEMPERATURE: u8 = 0x02;

/// Four pressures averaged: 8.4 ms, and 0.5 Pa of noise (section 8.3, table 16); the word needs no shift.
const PRESSURE_PRECISION: u8 = 0x02;
const PRESSURE_CONVERSION: u32 = conversion::DPS310[1];
const PRESSURE_SCALE: i64 = 3_670_016;
/// One temperature: 3.6 ms.
const TEMPERATURE_PRECISION: u8 = 0x00;
const TEMPERATURE_CONVERSION: u32 = conversion::DPS310[0];
const TEMPERATURE_SCALE: i64 = 524_288;
/// Bit of `COEF_SRCE` and `TMP_CFG`: the temperature sensor on the pressure element instead of the other one (sections 8.4 and
/// 8.12). The sensor to which the coefficients belong must be read.
const TEMPERATURE_SOURCE: u8 = 0x80;
const TEMPERATURE_SETTINGS: u8 = TEMPERATURE_SOURCE | TEMPERATURE_PRECISION;

/// Time from a reset until the coefficients can be read, microseconds (section 3.6, table 8: at most 40 ms).
const START_UP: u32 = 40_000;
/// Number of times that a flag is read before the driver gives up.
const ATTEMPTS: u32 = 8;
/// Time between these attempts, microseconds.
const PATIENCE: u32 = 250;
/// Reading flags, words and settings at 400 kHz, microseconds.
const READ: u32 = 400;

/// What the part measures, pascals (section 3.2, table 3).
const LOWEST: i64 = 30_000;
const HIGHEST: i64 = 120_000;
/// A pressure further below the range than this, pascals, or a temperature outside -40 to 85 degC, is not a measurement.
const MARGIN: i64 = 1_000;

/// The part.
#[derive(Debug)]
pub struct Dps310<B, D> {
    bus: B,
    delay: D,
    address: u8,
    calibration: Option<Calibration>,
    /// Whether the part has given a plausible pressure since the last start.
    recognised: bool,
}

impl<B: Bus, D: DelayNs> Dps310<B, D> {
    /// A part that is not started yet.
    pub const fn new(address: u8, bus: B, delay: D) -> Self {
        Self {
            bus,
            delay,
            address,
            calibration: None,
            recognised: false,
        }
    }

    async fn read<const N: usize>(&mut self, register: u8) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        self.bus
            .write_read(self.address, &[register], &mut bytes)
            .await
            .map_err(bus::fault)?;
        Ok(bytes)
    }

    async fn write(&mut self, register: u8, value: u8) -> Result<(), Fault> {
        self.bus
            .write(self.address, &[register, value])
            .await
            .map_err(bus::fault)
    }

    /// Waits until all of `flags` are set in `MEAS_CFG`.
    async fn ready(&mut self, flags: u8) -> Result<(), Fault> {
        for _ in 0..ATTEMPTS {
            let [found] = self.read(MEAS_CFG).await?;
            if found & flags == flags {
                return Ok(());
            }
            self.delay.delay_us(PATIENCE).await;
        }
        Err(Fault::SensorBusy)
    }

    async fn set_up(&mut self) -> Result<Calibration, Fault> {
        if self.read(ID).await? != [IDENTITY] {
            return Err(Fault::WrongSensor);
        }
        self.write(RESET, SOFT_RESET).await?;
        self.delay.delay_us(START_UP).await;
        self.ready(COEF_RDY | SENSOR_RDY).await?;
        // The coefficients have no check. Two equal reads show that the bus did not change them.
        let coefficients: [u8; 18] = self.read(COEF).await?;
        if self.read(COEF).await? != coefficients {
            return Err(Fault::SensorCalibration);
        }
        let [source] = self.read(COEF_SRCE).await?;
        if source & TEMPERATURE_SOURCE == 0 {
            return Err(Fault::WrongSensor);
        }
        // Infineon's own driver does this: parts with one fuse bit wrong measure temperature too high without it.
        for (register, value) in [
            (0x0E, 0xA5),
            (0x0F, 0x96),
            (0x62, 0x02),
            (0x0E, 0x00),
            (0x0F, 0x00),
        ] {
            self.write(register, value).await?;
        }
        self.write(PRS_CFG, PRESSURE_PRECISION).await?;
        self.write(TMP_CFG, TEMPERATURE_SETTINGS).await?;
        self.write(CFG_REG, 0).await?;
        Calibration::of(coefficients)
    }
}

impl<B: Bus, D: DelayNs> Driver for Dps310<B, D> {
    async fn start(&mut self) -> Result<(), Fault> {
        self.calibration = None;
        self.recognised = false;
        self.calibration = Some(self.set_up().await?);
        Ok(())
    }

    async fn sample(&mut self) -> Result<Sample, Fault> {
        let calibration = self.calibration.ok_or(Fault::SensorReset)?;
        self.write(MEAS_CFG, COMMAND_TEMPERATURE).await?;
        self.delay.delay_us(TEMPERATURE_CONVERSION).await;
        self.ready(TMP_RDY).await?;
        // Pressure is measured last, so that it is as recent as possible.
        self.write(MEAS_CFG, COMMAND_PRESSURE).await?;
        self.delay.delay_us(PRESSURE_CONVERSION).await;
        self.ready(TMP_RDY | PRS_RDY).await?;
        let [p2, p1, p0, t2, t1, t0, pressure_settings, temperature_settings]: [u8; 8] =
            self.read(PRS_B2).await?;
        if [pressure_settings, temperature_settings] != [PRESSURE_PRECISION, TEMPERATURE_SETTINGS] {
            return Err(Fault::SensorReset);
        }
        let sample = calibration.sample(signed([p2, p1, p0]), signed([t2, t1, t0]))?;
        recognise(&mut self.recognised, sample)
    }

    async fn free(&mut self) {
        self.bus.clear().await;
    }
}

/// A word of 24 bits in two's complement, highest byte first.
const fn signed([high, middle, low]: [u8; 3]) -> i32 {
    i32::from_be_bytes([high, middle, low, 0]) >> 8
}

/// The coefficients (section 8.11, table 18).
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
struct Calibration {
    /// 12 bits each.
    c0: i64,
    c1: i64,
    /// 20 bits each.
    c00: i64,
    c10: i64,
    /// 16 bits each.
    c01: i64,
    c11: i64,
    c20: i64,
    c21: i64,
    c30: i64,
}

/// Fraction bits of the scaled words. |Ts| <= 16 and |Ps| < 2.3 then take 32 and 30 bits.
const FRACTION: u32 = 28;

impl Calibration {
    /// The coefficients in registers 0x10 to 0x21.
    fn of(bytes: [u8; 18]) -> Result<Self, Fault> {
        // Empty fuses, or a line that nobody drives.
        if bytes.iter().all(|&byte| byte == bytes[0]) {
            return Err(Fault::SensorCalibration);
        }
        let twelve = |high: u8, low: u8| i64::from(i16::from_be_bytes([high, low]) >> 4);
        let sixteen = |at: usize| i64::from(i16::from_be_bytes([bytes[at], bytes[at + 1]]));
        let twenty =
            |high: u8, middle: u8, low: u8| i64::from(i32::from_be_bytes([high, middle, low, 0]) >> 12);
        Ok(Self {
            c0: twelve(bytes[0], bytes[1]),
            c1: twelve(bytes[1] << 4 | bytes[2] >> 4, bytes[2] << 4),
            c00: twenty(bytes[3], bytes[4], bytes[5]),
            c10: twenty(
                bytes[5] << 4 | bytes[6] >> 4,
                bytes[6] << 4 | bytes[7] >> 4,
                bytes[7] << 4,
            ),
            c01: sixteen(8),
            c11: sixteen(10),
            c20: sixteen(12),
            c21: sixteen(14),
            c30: sixteen(16),
        })
    }

    /// Computes pressure and temperature by sections 4.9.1 and 4.9.2, from signed words of 24 bits.
    fn sample(&self, pressure: i32, temperature: i32) -> Result<Sample, Fault> {
        // The ends of the word are the ends of the part's converter.
        const ENDS: [i32; 2] = [-0x80_0000, 0x7F_FFFF];
        if ENDS.contains(&pressure) || ENDS.contains(&temperature) {
            return Err(Fault::SensorSaturated);
        }
        let ps = (i64::from(pressure) << FRACTION) / PRESSURE_SCALE;
        let ts = (i64::from(temperature) << FRACTION) / TEMPERATURE_SCALE;
        // Coefficients times 1000 take 30 bits, so no product exceeds 2^62.
        let times = |factor: i64, word: i64| (factor * word) >> FRACTION;
        let c = |coefficient: i64| coefficient * 1000;
        let polynomial = times(times(times(c(self.c30), ps) + c(self.c20), ps) + c(self.c10), ps);
        let cross = times(times(c(self.c21), ps) + c(self.c11), ps);
        let millipascals = c(self.c00) + polynomial + times(c(self.c01) + cross, ts);
        let centidegrees = 50 * self.c0 + times(100 * self.c1, ts);
        if !(-4_000..=8_500).contains(&centidegrees) || millipascals < (LOWEST - MARGIN) * 1000 {
            return Err(Fault::SensorImplausible);
        }
        Ok(Sample {
            pressure: Millipascals(saturate(millipascals)),
            headroom: Millipascals(saturate(HIGHEST * 1000 - millipascals)),
            temperature: Some(Centidegrees(centidegrees as i16)),
            raw: Some(pressure as u32),
            age: PRESSURE_CONVERSION / 2 + READ,
        })
    }
}

#[cfg(test)]
mod tests;
