//! Pseudo-random numbers that are the same on every host.

/// `SplitMix64` (Steele, Lea, Flood 2014), from its state.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform from 0 to below `end`, which is above 0; off by less than `end / 2^64`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.bits() % end
    }

    /// Uniform in 0 .. 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the logarithm between two numbers above 0.
    pub fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.unit())
    }

    /// A normal deviate (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        // Above 0, up to 1: the logarithm is finite.
        let [distance, angle] = [self.unit(), self.unit()].map(|unit| unit + 1.0 / (1_u64 << 53) as f64);
        libm::sqrt(-2.0 * libm::log(distance)) * libm::cos(core::f64::consts::TAU * angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitmix_gives_its_published_numbers() {
        // The first outputs for seed 1234567 (Vigna's reference implementation).
        let mut random = Random(1_234_567);
        assert_eq!(random.bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn deviates_have_the_moments_of_the_normal_distribution() {
        let mut random = Random(7);
        let n = 200_000;
        let deviates: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let moment = |power: i32| deviates.iter().map(|d| d.powi(power)).sum::<f64>() / f64::from(n);
        // Five standard errors of each moment: sqrt(1/n), sqrt(2/n), sqrt(96/n).
        assert!(moment(1).abs() < 5.0 * libm::sqrt(1.0 / f64::from(n)));
        assert!((moment(2) - 1.0).abs() < 5.0 * libm::sqrt(2.0 / f64::from(n)));
        assert!((moment(4) - 3.0).abs() < 5.0 * libm::sqrt(96.0 / f64::from(n)));
        let inside = deviates.iter().filter(|d| d.abs() <= 2.0).count() as f64 / f64::from(n);
        assert!((inside - 0.9545).abs() < 0.0025, "{inside}");
    }
}
