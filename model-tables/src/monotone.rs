//! A monotone cubic through points: it rises or falls only where the points do.
//!
//! The slopes are those of the cubic spline, which is twice differentiable, so that fits to it converge. Where the spline would
//! overshoot, they are limited after Hyman (1983): to three times the smaller slope beside a point, and to zero at an extreme. At
//! the ends, the slope is that of a parabola through three points.

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
        let mut slopes = spline_slopes(
            &width,
            &secant,
            end_slope([width[0], width[1]], [secant[0], secant[1]]),
            end_slope([width[n - 2], width[n - 3]], [secant[n - 2], secant[n - 3]]),
        );
        for i in 1..n - 1 {
            let (before, after) = (secant[i - 1], secant[i]);
            slopes[i] = if before * after > 0.0 {
                let most = 3.0 * before.abs().min(after.abs());
                (slopes[i] * before.signum()).clamp(0.0, most) * before.signum()
            } else {
                0.0
            };
        }
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

/// Slopes of the cubic spline with given slopes at its ends: Thomas's algorithm.
fn spline_slopes(width: &[f64], secant: &[f64], first: f64, last: f64) -> Vec<f64> {
    let n = width.len() + 1;
    let (mut above, mut slopes) = (vec![0.0; n], vec![0.0; n]);
    slopes[0] = first;
    for i in 1..n - 1 {
        let (left, right) = (width[i - 1], width[i]);
        let side = 3.0 * (right * secant[i - 1] + left * secant[i]);
        let pivot = 2.0 * (left + right) - right * above[i - 1];
        above[i] = left / pivot;
        slopes[i] = (side - right * slopes[i - 1]) / pivot;
    }
    slopes[n - 1] = last;
    for i in (1..n - 1).rev() {
        slopes[i] -= above[i] * slopes[i + 1];
    }
    slopes
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
            assert!((curve.at(x) / x.exp() - 1.0).abs() < 1e-4, "{x}");
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
