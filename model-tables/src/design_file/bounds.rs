//! The range of numbers that a key accepts, and the hints for numbers in a wrong unit.

use std::fmt::Write as _;

/// Units that lengths are written in by a slip, millimetres.
const LENGTH_SLIPS: &[(&str, f64)] = &[("m", 1e3), ("um", 1e-3)];
/// Lengths of a fingertip, from a hair to a hand; walls and presses from a hundredth of a millimetre on.
pub(super) const LENGTH: Bounds = Bounds::above(0.0, 1000.0, "mm").usually([0.01, 200.0], LENGTH_SLIPS);
/// Semi-axes.
pub(super) const SEMI_AXIS: Bounds = Bounds::above(0.0, 1000.0, "mm").usually([0.2, 200.0], LENGTH_SLIPS);

/// Numbers a key may take.
#[derive(Clone, Copy)]
pub struct Bounds {
    low: f64,
    high: f64,
    open_low: bool,
    pub(super) unit: &'static str,
    usual: Option<Usual>,
}

/// Numbers that a key has in practice, and what slips of its unit leave them.
#[derive(Clone, Copy)]
struct Usual {
    low: f64,
    high: f64,
    /// Units that people write in its place, and what one of each is.
    slips: &'static [(&'static str, f64)],
}

impl Bounds {
    /// `low < value <= high`.
    pub const fn above(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low,
            high,
            open_low: true,
            unit,
            usual: None,
        }
    }

    /// `low <= value <= high`.
    pub const fn within(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low,
            high,
            open_low: false,
            unit,
            usual: None,
        }
    }

    /// Refuses a number out of `[low, high]` that would be in it in another unit: pairs of that unit and its size.
    #[must_use]
    pub const fn usually(self, [low, high]: [f64; 2], slips: &'static [(&'static str, f64)]) -> Self {
        Self {
            usual: Some(Usual { low, high, slips }),
            ..self
        }
    }

    /// What a number would be in the units that it may have been written in by a slip.
    pub(super) fn slips(self, value: f64) -> Option<String> {
        let usual = self.usual?;
        let usually = |value: f64| (usual.low..=usual.high).contains(&value);
        if usually(value) {
            return None;
        }
        let meant: Vec<String> = usual
            .slips
            .iter()
            .filter(|(_, size)| usually(value * size))
            // Nine digits: a product without its rounding.
            .filter_map(|(name, size)| Some((name, format!("{:.8e}", value * size).parse::<f64>().ok()?)))
            .map(|(name, meant)| format!("{meant} {} if {value} is in {name}", self.unit))
            .collect();
        (!meant.is_empty()).then(|| meant.join(", "))
    }

    pub(super) fn admits(self, value: f64) -> bool {
        let above = if self.open_low {
            value > self.low
        } else {
            value >= self.low
        };
        above && value <= self.high
    }

    pub(super) fn describe(self) -> String {
        let from = if self.open_low { "above" } else { "at least" };
        let mut text = format!("a number {from} {} and at most {}", self.low, self.high);
        if !self.unit.is_empty() {
            let _ = write!(text, " {}", self.unit);
        }
        text
    }
}
