//! Gaussian noise that every host computes alike.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Independent normal deviates of mean 0 and standard deviation 1, from a seed.
#[derive(Clone, Debug)]
pub struct Noise {
    generator: ChaCha8Rng,
    /// Box and Muller give two deviates at a time.
    spare: Option<f64>,
}

impl Noise {
    /// The sequence of `seed`.
    pub fn new(seed: u64) -> Self {
        Self {
            generator: ChaCha8Rng::seed_from_u64(seed),
            spare: None,
        }
    }

    /// The next deviate.
    pub fn deviate(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // Uniform in (0, 1]: the logarithm stays finite.
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * self.uniform());
        self.spare = Some(radius * sine);
        radius * cosine
    }

    /// Uniform in [0, 1), 53 bits.
    fn uniform(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_moments_of_the_normal_distribution() {
        let mut noise = Noise::new(7);
        let n = 200_000;
        let deviates: Vec<f64> = (0..n).map(|_| noise.deviate()).collect();
        let moment = |power: i32| deviates.iter().map(|d| d.powi(power)).sum::<f64>() / f64::from(n);
        // Five standard errors of each moment: sqrt(1/n), sqrt(2/n), sqrt(96/n).
        assert!(moment(1).abs() < 5.0 * libm::sqrt(1.0 / f64::from(n)));
        assert!((moment(2) - 1.0).abs() < 5.0 * libm::sqrt(2.0 / f64::from(n)));
        assert!((moment(4) - 3.0).abs() < 5.0 * libm::sqrt(96.0 / f64::from(n)));
        let inside = deviates.iter().filter(|d| d.abs() <= 2.0).count() as f64 / f64::from(n);
        assert!((inside - 0.9545).abs() < 0.0025, "{inside}");
    }

    #[test]
    fn repeats_for_a_seed_and_differs_between_seeds() {
        let draw = |seed| {
            let mut noise = Noise::new(seed);
            (0..8).map(|_| noise.deviate().to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }
}
