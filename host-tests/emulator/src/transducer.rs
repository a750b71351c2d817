//! The pressure transducer: pressure to a share of the converter's reference, or to a part on the bus.

use fingertip::transducer;
use model_tables::constants::Quantity;

/// What the transducer does to a pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmulatedTransducer {
    /// What it measures.
    pub quantity: Quantity,
    /// Pressures at the two ends of its own range, pascals, ascending; gauge or absolute as `quantity` is.
    pub range: [f64; 2],
    /// Output at those ends, as a share of the reference, 0 .. 1.
    pub output_at_range: [f64; 2],
    /// Noise of one reading, one standard deviation, pascals, >= 0.
    pub noise: f64,
    /// Smallest change that a reading shows, pascals, > 0.
    pub resolution: f64,
    /// What the board reads.
    pub part: Part,
    /// Its supply at the board's input, as a share of the converter's reference, 0 .. 1; 1 where it is that reference.
    pub supply: f64,
}

/// What the board reads of a transducer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Its voltage.
    Analogue,
    /// A DPS310 on the bus, at this address.
    Dps310(u8),
    /// An ABP2 on the bus, at this address, with these counts at the ends of its range.
    Abp2(u8, [u32; 2]),
    /// An MS5837-02BA on the bus, at this address.
    Ms5837(u8),
    /// In the place of the one before, its sister of 30 bar with the same version in its words.
    Ms5837ThirtyBar(u8),
    /// In a DPS310's place a Goertek SPL06: the same identity, and no register for the source of its coefficients.
    Spl06(u8),
}

impl Part {
    /// The same part at another address of its bus; an analogue one has none.
    #[must_use]
    pub fn at(self, address: u8) -> Self {
        match self {
            Self::Analogue => Self::Analogue,
            Self::Dps310(_) => Self::Dps310(address),
            Self::Abp2(_, counts) => Self::Abp2(address, counts),
            Self::Ms5837(_) => Self::Ms5837(address),
            Self::Ms5837ThirtyBar(_) => Self::Ms5837ThirtyBar(address),
            Self::Spl06(_) => Self::Spl06(address),
        }
    }
}

/// What the transducer does to the board at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElectricalOutput {
    /// A voltage and the transducer's supply, as shares of the converter's reference, 0 .. 1.
    Share(f64, f64),
    /// A pressure on a part on the bus, pascals, gauge or absolute as the part measures, and what is wrong with it.
    Pressure(f64, Wiring),
}

/// What is on the transducer's wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wiring {
    /// The transducer.
    #[default]
    Sound,
    /// Nothing: the wire is broken, and the input's pull-up takes it to the reference.
    Open,
    /// Ground.
    Short,
    /// Its supply, where it is not the converter's reference, is a tenth lower.
    Sag,
    /// It has no supply.
    Unsupplied,
    /// Of a part on the bus: it does not answer.
    Off,
    /// Its readings stay what they were.
    Stuck,
    /// It answers with noise.
    Garbage,
    /// Nobody drives the data line: all ones.
    Wrong,
    /// It is never ready.
    Slow,
    /// It is ready half a millisecond late.
    Delayed,
    /// One start in seven is not acknowledged.
    Intermittent,
    /// It is reset, once, and loses its settings.
    Reset,
}

impl Wiring {
    /// Whether it can happen to a transducer.
    pub fn concerns(self, transducer: &EmulatedTransducer) -> bool {
        let analogue = transducer.part == Part::Analogue;
        match self {
            Self::Sound => true,
            Self::Open | Self::Short => analogue,
            Self::Sag | Self::Unsupplied => analogue && transducer.supply < 1.0,
            _ => !analogue,
        }
    }
}

impl EmulatedTransducer {
    /// The pressure that it measures, pascals, where the gauge pressure in the fluid and the pressure of the air are these.
    pub fn measured(&self, gauge: f64, air: f64) -> f64 {
        match self.quantity {
            Quantity::Gauge => gauge,
            Quantity::Absolute => air + gauge,
        }
    }

    /// One standard deviation of its noise or its resolution, whichever is more, pascals.
    pub fn fineness(&self) -> f64 {
        self.noise.max(self.resolution)
    }

    /// From one sample to the next, seconds.
    pub fn period(&self) -> f64 {
        let microseconds = match self.part {
            Part::Analogue => fingertip::transducer::counts::PERIOD,
            Part::Dps310(_) | Part::Spl06(_) => transducer::dps310::PERIOD,
            Part::Abp2(..) => transducer::abp2::PERIOD,
            Part::Ms5837(_) | Part::Ms5837ThirtyBar(_) => transducer::ms5837::PERIOD,
        };
        f64::from(microseconds) * 1e-6
    }

    /// The output at a pressure that it measures, pascals, a share of the supply. It ends at the rails.
    pub fn output(&self, pressure: f64) -> f64 {
        let ([low, high], [at_low, at_high]) = (self.range, self.output_at_range);
        (at_low + (pressure - low) / (high - low) * (at_high - at_low)).clamp(0.0, 1.0)
    }

    /// Change of pressure that changes the output by `share` of the reference, pascals.
    pub fn pressure_of(&self, share: f64) -> f64 {
        share * (self.range[1] - self.range[0]) / (self.output_at_range[1] - self.output_at_range[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HUNDRED_KPA: EmulatedTransducer = EmulatedTransducer {
        quantity: Quantity::Gauge,
        range: [0.0, 100e3],
        output_at_range: [0.1, 0.9],
        noise: 10.0,
        resolution: 5.0,
        part: Part::Analogue,
        supply: 1.0,
    };

    #[test]
    fn runs_from_a_tenth_to_nine_tenths_over_its_range() {
        assert!((HUNDRED_KPA.output(0.0) - 0.1).abs() < 1e-15);
        assert!((HUNDRED_KPA.output(50e3) - 0.5).abs() < 1e-15);
        assert!((HUNDRED_KPA.output(100e3) - 0.9).abs() < 1e-15);
    }

    #[test]
    fn an_absolute_part_measures_the_air_too() {
        let absolute = EmulatedTransducer {
            quantity: Quantity::Absolute,
            ..HUNDRED_KPA
        };
        assert!((absolute.measured(2e3, 80e3) - 82e3).abs() < 1e-9);
        assert!((HUNDRED_KPA.measured(2e3, 80e3) - 2e3).abs() < 1e-9);
    }

    #[test]
    fn its_fineness_is_noise_or_resolution() {
        let coarse = EmulatedTransducer {
            resolution: 30.0,
            ..HUNDRED_KPA
        };
        assert!((HUNDRED_KPA.fineness() - 10.0).abs() < 1e-12);
        assert!((coarse.fineness() - 30.0).abs() < 1e-12);
    }

    #[test]
    fn ends_at_the_rails() {
        assert!(HUNDRED_KPA.output(-1e6).abs() < 1e-15);
        assert!((HUNDRED_KPA.output(1e6) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn one_code_of_a_twelve_bit_converter_is_thirty_and_a_half_pascals() {
        assert!((HUNDRED_KPA.pressure_of(1.0 / 4096.0) - 30.517_578_125).abs() < 1e-9);
    }
}
