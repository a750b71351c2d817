//! TE MS5837-02BA on I2C: absolute pressure up to 2 bar, gel-filled, made to be immersed (datasheet of 09/2017).
//!
//! The part of 30 bar has another scale, and the same version bits as the 02BA01. With the formula of this part, its pressures
//! would read as a twentieth. It is recognised by its calibration word C1, and by the air, which would read as 5 kPa.
//!
//! The part gives two raw words and, once, six calibration words guarded by a CRC; the pressure is computed here,
//! with the second-order compensation below 20 degC.

use crate::status::Fault;
use crate::transducer::bus::{self, Bus};
use crate::transducer::driver::{Driver, Sample, recognise};
use crate::units::{Centidegrees, Millipascals, saturate};
use embedded_hal_async::delay::DelayNs;
use model_tables::constants::{conversion, period};

/// Time from one sample to the next, microseconds.
pub const PERIOD: u32 = period::MS5837;

/// Commands (datasheet, "Commands"). The conversions' low bits choose the oversampling.
const RESET: u8 = 0x1E;
const PROM: u8 = 0xA0;
/// Temperature with 256 samples. Its noise of 0.012 degC changes the pressure by less than a pascal.
const CONVERT_TEMPERATURE: u8 = 0x50;
/// Pressure with 2048 samples: 2.8 Pa of noise.
const CONVERT_PRESSURE: u8 = 0x46;
const READ_ADC: u8 = 0x00;

/// Times that the part may take, microseconds: reload after a reset, and the conversions of 256 and 2048 samples.
const RELOAD: u32 = 10_000;
const TEMPERATURE_CONVERSION: u32 = conversion::MS5837[0];
const PRESSURE_CONVERSION: u32 = conversion::MS5837[1];
/// A command, a byte and three bytes with their addresses at 400 kHz, microseconds.
const READ: u32 = 150;

/// Versions in bits 11:5 of the first word: the 02BA01 and the 02BA21. (0x1A is the 30 bar part.)
const VERSIONS: [u16; 2] = [0x00, 0x15];

/// The sensitivity C1 is above this. The datasheets' typical values are 46372 for the 02BA and 34982 for the 30BA; the parts
/// that the authors of `ArduPilot` collected (pull request 29122) are separated by 37000.
const MIN_SENSITIVITY: u16 = 37_000;

/// What the part measures, pascals: 10 to 2000 mbar.
const LOWEST: i64 = 1_000;
const HIGHEST: i64 = 200_000;

/// The part.
#[derive(Debug)]
pub struct Ms5837<B, D> {
    bus: B,
    delay: D,
    address: u8,
    calibration: Option<Calibration>,
    /// Whether the part has given a plausible pressure since the last start.
    recognised: bool,
}

impl<B: Bus, D: DelayNs> Ms5837<B, D> {
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

    async fn command(&mut self, command: u8) -> Result<(), Fault> {
        self.bus.write(self.address, &[command]).await.map_err(bus::fault)
    }

    /// Starts a conversion, waits for it and reads it.
    async fn convert(&mut self, command: u8, microseconds: u32) -> Result<u32, Fault> {
        self.command(command).await?;
        self.delay.delay_us(microseconds).await;
        let mut word = [0; 3];
        self.bus
            .write_read(self.address, &[READ_ADC], &mut word)
            .await
            .map_err(bus::fault)?;
        match u32::from_be_bytes([0, word[0], word[1], word[2]]) {
            // The word was read before the conversion ended, after a reset during it, or twice.
            0 => Err(Fault::SensorBusy),
            // A line that nobody drives.
            0x00FF_FFFF => Err(Fault::SensorImplausible),
            word => Ok(word),
        }
    }
}

impl<B: Bus, D: DelayNs> Driver for Ms5837<B, D> {
    async fn start(&mut self) -> Result<(), Fault> {
        self.calibration = None;
        self.recognised = false;
        self.command(RESET).await?;
        self.delay.delay_us(RELOAD).await;
        let mut prom = [0; 7];
        for (n, word) in prom.iter_mut().enumerate() {
            let mut bytes = [0; 2];
            self.bus
                .write_read(self.address, &[PROM + 2 * n as u8], &mut bytes)
                .await
                .map_err(bus::fault)?;
            *word = u16::from_be_bytes(bytes);
        }
        self.calibration = Some(Calibration::of(prom)?);
        Ok(())
    }

    async fn sample(&mut self) -> Result<Sample, Fault> {
        let calibration = self.calibration.ok_or(Fault::SensorReset)?;
        let temperature = self.convert(CONVERT_TEMPERATURE, TEMPERATURE_CONVERSION).await?;
        // Pressure is measured last, so that it is as recent as possible.
        let pressure = self.convert(CONVERT_PRESSURE, PRESSURE_CONVERSION).await?;
        let sample = calibration.sample(pressure, temperature)?;
        recognise(&mut self.recognised, sample)
    }

    async fn free(&mut self) {
        self.bus.clear().await;
    }
}

/// C1 to C6 (datasheet, "Pressure and temperature calculation").
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
struct Calibration {
    sensitivity: i64,
    offset: i64,
    sensitivity_slope: i64,
    offset_slope: i64,
    reference_temperature: i64,
    temperature_slope: i64,
}

impl Calibration {
    /// Decodes the calibration in the seven words, if they belong to this part and their CRC is right.
    fn of(prom: [u16; 7]) -> Result<Self, Fault> {
        let [first, coefficients @ ..] = prom;
        // An empty memory passes the CRC, because its CRC is 0.
        let empty = coefficients.iter().any(|&word| word == 0 || word == u16::MAX);
        if empty || crc4(prom) != first >> 12 {
            return Err(Fault::SensorCalibration);
        }
        if !VERSIONS.contains(&(first >> 5 & 0x7F)) || coefficients[0] <= MIN_SENSITIVITY {
            return Err(Fault::WrongSensor);
        }
        let [c1, c2, c3, c4, c5, c6] = coefficients.map(i64::from);
        Ok(Self {
            sensitivity: c1 << 16,
            offset: c2 << 17,
            sensitivity_slope: c3,
            offset_slope: c4,
            reference_temperature: c5 << 8,
            temperature_slope: c6,
        })
    }

    /// Computes pressure and temperature from words below 2^24.
    fn sample(&self, pressure: u32, temperature: u32) -> Result<Sample, Fault> {
        // dT within 2^24 and C6 below 2^16: 2^40. Divisions by powers of two are shifts, which round down.
        let dt = i64::from(temperature) - self.reference_temperature;
        let first_order = 2000 + ((dt * self.temperature_slope) >> 23);
        // Within 2^33 + 2^34 and 2^32 + 2^33.
        let offset = self.offset + ((self.offset_slope * dt) >> 6);
        let sensitivity = self.sensitivity + ((self.sensitivity_slope * dt) >> 7);
        // Second order, below 20 degC. |TEMP - 2000| is below 2^18: its square below 2^36.
        let below = (first_order - 2000).min(0);
        let (temperature_second, offset_second, sensitivity_second) = if below < 0 {
            (
                (11 * dt * dt) >> 35,
                (31 * below * below) >> 3,
                (63 * below * below) >> 5,
            )
        } else {
            (0, 0, 0)
        };
        let centidegrees = first_order - temperature_second;
        // D1 SENS is below 2^24 * 2^39 = 2^63 in the worst case. The formula gives pascals; the factor 1000 for millipascals is
        // applied before the last shift: |D1 SENS / 2^21 - OFF| is below 2^43, a thousand of it below 2^53.
        let scaled =
            ((i64::from(pressure) * (sensitivity - sensitivity_second)) >> 21) - (offset - offset_second);
        let millipascals = (scaled * 1000) >> 15;
        if !(-4_000..=8_500).contains(&centidegrees) || millipascals < LOWEST * 1000 {
            return Err(Fault::SensorImplausible);
        }
        Ok(Sample {
            pressure: Millipascals(saturate(millipascals)),
            headroom: Millipascals(saturate(HIGHEST * 1000 - millipascals)),
            temperature: Some(Centidegrees(centidegrees as i16)),
            raw: Some(pressure),
            age: PRESSURE_CONVERSION / 2 + READ,
        })
    }
}

/// The check in the first word's top four bits over everything else: the remainder by x^4 + x + 1 (TE's application
/// note AN520, "CRC calculation").
fn crc4(prom: [u16; 7]) -> u16 {
    let mut remainder = 0_u16;
    // The check itself counts as zero, and an eighth word of zeros follows.
    let words = [
        prom[0] & 0x0FFF,
        prom[1],
        prom[2],
        prom[3],
        prom[4],
        prom[5],
        prom[6],
        0,
    ];
    for byte in words.iter().flat_map(|word| word.to_be_bytes()) {
        remainder ^= u16::from(byte);
        for _ in 0..8 {
            remainder = if remainder & 0x8000 == 0 {
                remainder << 1
            } else {
                remainder << 1 ^ 0x3000
            };
        }
    }
    remainder >> 12
}

#[cfg(test)]
mod tests;
