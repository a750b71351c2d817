//! The points of a sweep in the unit cube. Each is a function of its number alone, so that shards and resumed runs
//! agree and nothing has to be kept.

use super::sobol;
use model_tables::random::Random;

/// Weyl increment of `SplitMix64`: its state after `k` numbers is the seed and `k` of these.
const INCREMENT: u64 = 0x9e37_79b9_7f4a_7c15;
/// Rounds of the Feistel network that permutes strata.
const ROUNDS: u64 = 6;

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Every combination of the values.
    Grid,
    /// One point in each of `count` equal strata of every key.
    LatinHypercube,
    /// The Sobol sequence; with a seed shifted digitally.
    Sobol,
    /// Independent and uniform.
    Random,
}

impl Sampling {
    /// The method that a file names.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "grid" => Self::Grid,
            "latin-hypercube" => Self::LatinHypercube,
            "sobol" => Self::Sobol,
            "random" => Self::Random,
            _ => return None,
        })
    }
}

/// The points of one sweep.
#[derive(Clone, Copy, Debug)]
pub struct SamplePoints {
    /// How they are drawn; a grid has no points in the cube.
    pub method: Sampling,
    /// How many.
    pub count: u64,
    /// Seed of the random points; `None` of grids and Sobol points, which have none.
    pub seed: Option<u64>,
    /// Coordinates of a point.
    pub dimensions: usize,
}

impl SamplePoints {
    /// Coordinate `dimension` of point `number`, in `0 .. 1`.
    pub fn unit(&self, number: u64, dimension: usize) -> f64 {
        let seed = self.seed.unwrap_or(0);
        match self.method {
            Sampling::Grid => 0.0,
            Sampling::Random => self.chance(seed, number, dimension),
            Sampling::LatinHypercube => {
                let key = Random(seed ^ (dimension as u64).wrapping_mul(0xd1b5_4a32_d192_ed03)).bits();
                let stratum = permuted(number, self.count, key);
                let within = self.chance(seed ^ 0x5bd1_e995, number, dimension);
                // Rounding may reach the end of the last stratum, which belongs to no point.
                ((stratum as f64 + within) / self.count as f64).min(1.0 - f64::EPSILON)
            }
            Sampling::Sobol => {
                let shift = self
                    .seed
                    .map_or(0, |seed| self.random(seed, 0, dimension).bits() >> 32);
                f64::from(sobol::coordinate(number as u32, dimension) ^ shift as u32) / 4_294_967_296.0
            }
        }
    }

    fn chance(&self, seed: u64, number: u64, dimension: usize) -> f64 {
        self.random(seed, number, dimension).unit()
    }

    /// The seed's stream at a place of its own for each point and coordinate.
    fn random(&self, seed: u64, number: u64, dimension: usize) -> Random {
        let place = number
            .wrapping_mul(self.dimensions as u64)
            .wrapping_add(dimension as u64);
        Random(seed.wrapping_add(place.wrapping_mul(INCREMENT)))
    }
}

/// A permutation of `0 .. count`: a Feistel network over the next even power of two, walked until it is back inside.
fn permuted(number: u64, count: u64, key: u64) -> u64 {
    let bits = u64::BITS - count.saturating_sub(1).leading_zeros();
    let half = bits.div_ceil(2).max(1);
    let mask = (1_u64 << half) - 1;
    let mut value = number;
    loop {
        let (mut left, mut right) = (value >> half, value & mask);
        for round in 0..ROUNDS {
            let mixed = Random(key ^ right ^ (round << 56)).bits() & mask;
            (left, right) = (right, left ^ mixed);
        }
        value = left << half | right;
        if value < count {
            return value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(method: Sampling, count: u64) -> SamplePoints {
        SamplePoints {
            method,
            count,
            seed: Some(7),
            dimensions: 3,
        }
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_every_stratum() {
        for count in [1, 2, 3, 17, 64, 1000] {
            let sample = sample(Sampling::LatinHypercube, count);
            for dimension in 0..3 {
                let mut seen = vec![false; count as usize];
                for number in 0..count {
                    let stratum = (sample.unit(number, dimension) * count as f64) as usize;
                    assert!(!seen[stratum], "{count} points, stratum {stratum} twice");
                    seen[stratum] = true;
                }
            }
        }
    }

    #[test]
    fn coordinates_are_independent_and_uniform() {
        const COUNT: u64 = 4096;
        for method in [Sampling::LatinHypercube, Sampling::Random, Sampling::Sobol] {
            let sample = sample(method, COUNT);
            for (a, b) in [(0, 1), (1, 2), (0, 2)] {
                let (mut mean, mut product) = (0.0, 0.0);
                for number in 0..COUNT {
                    let [x, y] = [a, b].map(|dimension| sample.unit(number, dimension) - 0.5);
                    mean += x / COUNT as f64;
                    product += 12.0 * x * y / COUNT as f64;
                }
                // Four standard deviations of independent points: sqrt(1/12) / 64 and 1 / 64.
                assert!(mean.abs() < 0.018, "{method:?}: mean {mean}");
                assert!(
                    product.abs() < 0.0625,
                    "{method:?}: correlation {product} of {a} and {b}"
                );
            }
        }
    }

    #[test]
    fn random_points_are_the_stream_of_the_seed() {
        let sample = sample(Sampling::Random, 10);
        let mut stream = Random(7);
        for number in 0..10 {
            for dimension in 0..3 {
                let expected = stream.unit();
                assert_eq!(sample.unit(number, dimension).to_bits(), expected.to_bits());
            }
        }
    }
}
