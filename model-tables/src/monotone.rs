//! A monotone cubic through points: never rises or falls where they do not.
//!
//! Fritsch and Butland (1984), as PCHIP has it: at every point the weighted harmonic mean of the slopes beside it, zero
//! at an extreme; at the ends a parabola through three points, held back where it would overshoot.

/// The interpolant of strictly increasing places.
#[derive(Clone, Debug)]
pub struct Monotone {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

impl Monotone {
    /// Through the points `(x, y)`; `None` unless there are at least three and `x` increases strictly.
    pub fn new(x: Vec<f64>, y: Vec<f64>) -> Option<Self> {
        let n = x.len();
        if n < 3 || y.len() != n || !x.windows(2).all(|pair| pair[0] < pair[1]) {
            return None;
        }
        let width: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let secant: Vec<f64> = y
            .windows(2)
            .zip(&width)
            .map(|(pair, width)| (pair[1] - pair[0]) / width)
            .collect();
        let mut slopes = vec![0.0; n];
        for i in 1..n - 1 {
            let (before, after) = (secant[i - 1], secant[i]);
            if before * after > 0.0 {
                let (w1, w2) = (2.0 * width[i] + width[i - 1], width[i] + 2.0 * width[i - 1]);
                slopes[i] = (w1 + w2) / (w1 / before + w2 / after);
            }
        }
        slopes[0] = end_slope([width[0], width[1]], [secant[0], secant[1]]);
        slopes[n - 1] = end_slope([width[n - 2], width[n - 3]], [secant[n - 2], secant[n - 3]]);
        Some(Self { x, y, slopes })
    }

    /// The value at a place, held beyond the ends.
    pub fn at(&self, place: f64) -> f64 {
        let last = self.x.len() - 1;
        if place.is_nan() || place <= self.x[0] {
            return self.y[0];
        }
        if place >= self.x[last] {
            return self.y[last];
        }
        let i = self.x.partition_point(|&x| x <= place) - 1;
        let width = self.x[i + 1] - self.x[i];
        let t = (place - self.x[i]) / width;
        let (s, t2) = (1.0 - t, t * t);
        // Hermite's cubic.
        self.y[i] * s * s * (1.0 + 2.0 * t)
            + self.y[i + 1] * t2 * (3.0 - 2.0 * t)
            + width * t * s * (self.slopes[i] * s - self.slopes[i + 1] * t)
    }
}

/// Slope at an end: of a parabola, within what keeps the cubic monotone.
fn end_slope([near, far]: [f64; 2], [first, second]: [f64; 2]) -> f64 {
    let slope = ((2.0 * near + far) * first - near * second) / (near + far);
    if slope * first <= 0.0 {
        0.0
    } else if first * second <= 0.0 && slope.abs() > 3.0 * first.abs() {
        3.0 * first
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_a_smooth_curve() {
        let x: Vec<f64> = (0..=20).map(|i| 0.1 * f64::from(i)).collect();
        let curve = Monotone::new(x.clone(), x.iter().map(|x| x.exp()).collect()).expect("increasing");
        for i in 0..200 {
            let x = 0.01 * f64::from(i);
            assert!((curve.at(x) / x.exp() - 1.0).abs() < 5e-4, "{x}");
        }
        assert!((curve.at(-1.0) - 1.0).abs() < 1e-12 && (curve.at(9.0) - 2.0_f64.exp()).abs() < 1e-12);
    }

    #[test]
    fn never_overshoots_a_step() {
        let x: Vec<f64> = (0..6).map(f64::from).collect();
        let curve = Monotone::new(x, vec![0.0, 0.01, 0.02, 5.0, 5.01, 5.02]).expect("increasing");
        let mut before = 0.0;
        for i in 0..=500 {
            let value = curve.at(0.01 * f64::from(i));
            assert!(value >= before);
            before = value;
        }
    }

    #[test]
    fn wants_increasing_places() {
        assert!(Monotone::new(vec![0.0, 1.0, 1.0], vec![0.0; 3]).is_none());
        assert!(Monotone::new(vec![0.0, 1.0], vec![0.0; 2]).is_none());
    }
}
