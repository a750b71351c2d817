//! The noise of synthetic benches and records.

use model_tables::random::Random;

/// A normal deviate (Box and Muller). Its numbers are not those of [`Random::normal`]: figures that documents quote are of these.
pub(crate) fn deviate(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.unit()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.unit()).cos()
}
