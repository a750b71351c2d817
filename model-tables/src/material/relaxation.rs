//! How a wall relaxes: the series of a quasi-linear viscoelastic material.
//!
//! Stress follows strain as `g(t) = 1 + sum g_i exp(-t / tau_i)` times the relaxed stress, which the [`Law`](super::Law)'s constants
//! give (Fung, "Biomechanics", 2nd ed., 1993, section 7.6). A term that relaxes far faster than a step of time is a dashpot of viscosity
//! `g_i tau_i`, one that relaxes far slower a spring.

/// Most terms of a series.
pub const MAX_TERMS: usize = 8;

/// A term of the series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Term {
    /// Relaxation time at the series' temperature, seconds, > 0.
    pub time: f64,
    /// Weight over the relaxed stress, >= 0.
    pub weight: f64,
}

/// Change of a term over a time step in which the relaxed stress changes linearly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decay {
    /// Share of the term's stress that is left after the step: `exp(-dt / tau)`.
    pub left: f64,
    /// The term's part of a change of the relaxed stress: `g tau / dt (1 - exp(-dt / tau))`.
    pub taken: f64,
}

impl Term {
    /// Over a step of `step` seconds, >= 0; exact.
    pub fn over(self, step: f64) -> Decay {
        let ratio = step / self.time;
        let lost = -libm::expm1(-ratio);
        // Of a change in no time all is taken.
        let mean = if ratio > 0.0 { lost / ratio } else { 1.0 };
        Decay {
            left: 1.0 - lost,
            taken: self.weight * mean,
        }
    }
}

/// The series, its relaxation times increasing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    terms: [Term; MAX_TERMS],
    count: usize,
    /// Temperature of the series, degrees Celsius.
    pub temperature: f64,
    /// `-d ln(tau) / dT`, per kelvin, >= 0: all terms alike.
    pub shift: f64,
}

impl Relaxation {
    /// A series of up to [`MAX_TERMS`] terms; those beyond are left out.
    pub const fn new(terms: &[Term], temperature: f64, shift: f64) -> Self {
        let mut kept = [Term {
            time: 1.0,
            weight: 0.0,
        }; MAX_TERMS];
        let mut count = 0;
        while count < MAX_TERMS && count < terms.len() {
            kept[count] = terms[count];
            count += 1;
        }
        Self {
            terms: kept,
            count,
            temperature,
            shift,
        }
    }

    /// Its terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms[..self.count]
    }

    /// The series at a temperature in degrees Celsius: every relaxation time is `exp(-shift dT)` as long.
    #[must_use]
    pub fn at(mut self, temperature: f64) -> Self {
        let factor = libm::exp(-self.shift * (temperature - self.temperature));
        for term in &mut self.terms {
            term.time *= factor;
        }
        self.temperature = temperature;
        self
    }

    /// `g(0)`: the stress of a change in no time over the relaxed one.
    pub fn instantaneous(&self) -> f64 {
        self.terms().iter().fold(1.0, |sum, term| sum + term.weight)
    }
}

const fn term(time: f64, weight: f64) -> Term {
    Term { time, weight }
}

/// Agilus30 at 20 degrees Celsius, over the relaxed constants of [`AGILUS30`](super::preset::AGILUS30): fitted to the published master
/// curve of dynamic mechanical analysis in the repository Duke-MatSci/materialsmine, storage and loss modulus within 2.9 % (root mean square)
/// from 1e-4 to 158 Hz, where the curve's own relaxed modulus is 7 % less than that of the constants. The shift is the middle of the 0.29 to 0.33 per kelvin that the curve has from 15 to 25 degrees Celsius.
pub const AGILUS30_RELAXATION: Relaxation = Relaxation::new(
    &[
        term(1e-3, 440.8),
        term(1e-2, 109.5),
        term(0.1, 18.78),
        term(1.0, 4.459),
        term(10.0, 1.55),
        term(100.0, 0.4002),
        term(1000.0, 0.2162),
    ],
    20.0,
    0.31,
);

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    /// Storage modulus at a frequency, over the relaxed one.
    fn storage(series: &Relaxation, hertz: f64) -> f64 {
        series.terms().iter().fold(1.0, |sum, term| {
            let x = TAU * hertz * term.time;
            sum + term.weight * x * x / (1.0 + x * x)
        })
    }

    /// The published storage moduli: 2.39, 5.18 and 15.4 megapascals at 0.01, 0.1 and 1 Hz. Their ratios: the curve's own relaxed modulus is 7 % below
    /// that of the constants.
    #[test]
    fn agilus30_stiffens_with_frequency_as_published() {
        let [slow, middle, fast] = [0.01, 0.1, 1.0].map(|hertz| storage(&AGILUS30_RELAXATION, hertz));
        assert!(
            (middle / slow / (5.18 / 2.39) - 1.0).abs() < 0.005,
            "{}",
            middle / slow
        );
        assert!(
            (fast / middle / (15.4 / 5.18) - 1.0).abs() < 0.005,
            "{}",
            fast / middle
        );
    }

    /// Two steps of an even change are one of twice the length: `h2 = left h1 + taken`, each half of the change.
    #[test]
    fn a_step_is_exact_whatever_its_length() {
        let term = term(0.3, 2.0);
        for step in [1e-9, 1e-3, 0.2, 5.0, 1e5] {
            let (half, whole) = (term.over(0.5 * step), term.over(step));
            let twice = half.left * (0.5 * half.taken) + 0.5 * half.taken;
            assert!((twice - whole.taken).abs() < 1e-14 * term.weight, "{step}");
            assert!((half.left * half.left - whole.left).abs() < 1e-14);
        }
        assert!((term.over(0.0).taken - 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_kelvin_more_shortens_every_time() {
        let warm = AGILUS30_RELAXATION.at(21.0);
        for (cold, warm) in AGILUS30_RELAXATION.terms().iter().zip(warm.terms()) {
            assert!((warm.time / cold.time - libm::exp(-0.31)).abs() < 1e-12);
            assert!((warm.weight - cold.weight).abs() < 1e-12);
        }
    }
}
