//! Hencky's series for a clamped circular membrane under a small uniform pressure ("Über den Spannungszustand in kreisrunden Platten mit
//! verschwindender Biegungssteifigkeit", Z. Math. Phys. 63 (1915) 311).
//!
//! With `n = N_r / (E t) = (q^(2/3) / 4) sum b_k r^2k` and the load `q = P a / (E t)`, compatibility is `sum k (k + 1) b_k s^k m^2 = -2 s` for
//! `m = sum b_k s^k`, `s = r^2`; the rim does not move where `sum (2k + 1 - nu) b_k = 0`; and `w' = -q r / (2 n)`.

/// Terms of the series.
const TERMS: usize = 60;

/// The series of one Poisson's ratio.
pub(crate) struct Hencky {
    poisson: f64,
    terms: [f64; TERMS],
}

/// The coefficients that follow from the first.
fn terms(first: f64) -> [f64; TERMS] {
    let mut b = [0.0; TERMS];
    let mut squares = [0.0; TERMS];
    b[0] = first;
    squares[0] = first * first;
    for k in 1..TERMS {
        let right = if k == 1 { -2.0 } else { 0.0 };
        let known: f64 = (1..k).map(|j| (j * (j + 1)) as f64 * b[j] * squares[k - j]).sum();
        b[k] = (right - known) / ((k * (k + 1)) as f64 * squares[0]);
        squares[k] = (0..=k).map(|j| b[j] * b[k - j]).sum();
    }
    b
}

impl Hencky {
    /// The membrane of a Poisson's ratio.
    pub(crate) fn new(poisson: f64) -> Self {
        let at_rim = |first: f64| -> f64 {
            let b = terms(first);
            (0..TERMS).map(|k| ((2 * k + 1) as f64 - poisson) * b[k]).sum()
        };
        let (mut low, mut high) = (1.4, 4.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at_rim(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Self {
            poisson,
            terms: terms(low),
        }
    }

    /// The first coefficient, which fixes the tension at the centre.
    pub(crate) fn first(&self) -> f64 {
        self.terms[0]
    }

    /// The load whose strain at the centre, the largest, is this.
    pub(crate) fn load(&self, strain: f64) -> f64 {
        (4.0 * strain / ((1.0 - self.poisson) * self.first())).powf(1.5)
    }

    /// Deflection of the centre over the radius: `q^(1/3)` times the integral of `1 / m` over `s` from 0 to 1, by Simpson's rule.
    pub(crate) fn deflection(&self, load: f64) -> f64 {
        const PARTS: usize = 200;
        let over = |i: usize| {
            let s = i as f64 / PARTS as f64;
            1.0 / self.terms.iter().rev().fold(0.0, |sum, b| sum * s + b)
        };
        let sum: f64 = (0..=PARTS)
            .map(|i| {
                let weight = match i {
                    0 | PARTS => 1.0,
                    odd if odd % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                weight * over(i)
            })
            .sum();
        load.cbrt() * sum / (3.0 * PARTS as f64)
    }
}
