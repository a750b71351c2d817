//! Panels with linear axes and round ticks, beside the logarithmic ones of [`crate::drawing`].

use crate::drawing::{Anchor, BLACK, Drawing, GREY};
use crate::rows::plain;

const GRID: &str = "#e4e4e4";
/// Ticks of an axis, about.
const TICKS: f64 = 5.0;

/// A linear axis.
#[derive(Clone, Copy, Debug)]
pub struct LinearAxis {
    /// Its first value, a whole number of steps.
    start: f64,
    /// Its last value, a whole number of steps.
    pub end: f64,
    /// Between ticks.
    step: f64,
    /// Where start and end lie, pixels.
    pub pixels: [f64; 2],
}

impl LinearAxis {
    /// An axis that holds values up to `largest`, with round ticks.
    pub fn from_zero(largest: f64, pixels: [f64; 2]) -> Self {
        Self::over([0.0, if largest > 0.0 { largest } else { 1.0 }], pixels)
    }

    /// An axis of degrees, from the pole to the base.
    pub fn quarter_turn(pixels: [f64; 2]) -> Self {
        Self {
            start: 0.0,
            end: 90.0,
            step: 15.0,
            pixels,
        }
    }

    /// An axis that holds the values between two, the first less than the second.
    pub fn over([least, largest]: [f64; 2], pixels: [f64; 2]) -> Self {
        let rough = (largest - least) / TICKS;
        let decade = libm::pow(10.0, libm::floor(libm::log10(rough)));
        let step = [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .map(|round| round * decade)
            .find(|step| *step >= 0.999 * rough)
            .unwrap_or(10.0 * decade);
        Self {
            start: step * libm::floor(least / step + 1e-9),
            end: step * libm::ceil(largest / step - 1e-9),
            step,
            pixels,
        }
    }

    /// Where a value lies; values beyond the ends lie at the ends.
    pub fn at(&self, value: f64) -> f64 {
        let part = ((value - self.start) / (self.end - self.start)).clamp(0.0, 1.0);
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }

    fn ticks(&self) -> impl Iterator<Item = f64> + use<> {
        let (step, first) = (self.step, libm::round(self.start / self.step));
        let count = libm::round((self.end - self.start) / step) as usize;
        (0..=count).map(move |k| step * (first + k as f64))
    }
}

/// A frame with two linear axes.
#[derive(Clone, Copy, Debug)]
pub struct LinearPanel {
    /// To the right.
    pub x: LinearAxis,
    /// Upward.
    pub y: LinearAxis,
}

impl LinearPanel {
    /// Where a point lies.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// Grid, frame and numbers.
    pub fn draw(&self, drawing: &mut Drawing) {
        let ([left, right], [bottom, top]) = (self.x.pixels, self.y.pixels);
        for tick in self.x.ticks() {
            let x = self.x.at(tick);
            drawing.line([x, bottom], [x, top], GRID, 1.0);
            drawing.text([x, bottom + 17.0], Anchor::Middle, 12.0, BLACK, &label(tick));
        }
        for tick in self.y.ticks() {
            let y = self.y.at(tick);
            drawing.line([left, y], [right, y], GRID, 1.0);
            drawing.text([left - 7.0, y + 4.0], Anchor::End, 12.0, BLACK, &label(tick));
        }
        let corners = [
            [left, bottom],
            [right, bottom],
            [right, top],
            [left, top],
            [left, bottom],
        ];
        drawing.path(&corners, GREY, 1.0);
    }
}

/// A tick's number.
fn label(tick: f64) -> String {
    plain(tick, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_a_round_number() {
        for (largest, end, step) in [
            (2.11, 2.5, 0.5),
            (0.38, 0.4, 0.1),
            (144.3, 150.0, 50.0),
            (10.0, 10.0, 2.0),
        ] {
            let axis = LinearAxis::from_zero(largest, [0.0, 100.0]);
            assert!(
                (axis.end - end).abs() < 1e-9 && (axis.step - step).abs() < 1e-9,
                "{axis:?}"
            );
        }
        let axis = LinearAxis::over([-0.3, 2.1], [0.0, 100.0]);
        assert!(
            (axis.start + 0.5).abs() < 1e-9 && (axis.end - 2.5).abs() < 1e-9,
            "{axis:?}"
        );
        assert!((axis.at(1.0) - 50.0).abs() < 1e-9);
        assert_eq!(
            (label(0.4), label(50.0), label(0.0)),
            ("0.4".into(), "50".into(), "0".into())
        );
    }
}
