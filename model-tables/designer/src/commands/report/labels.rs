//! Numbers of a report, each with its unit, and the units that SI quantities are given in.

use maud::{Markup, html};
use output::rows::plain;

/// Digits of a number.
const DIGITS: i32 = 4;

/// A quantity: the factor from SI, and its unit.
#[derive(Clone, Copy)]
pub(super) struct Unit {
    pub(super) per_si: f64,
    pub(super) name: &'static str,
}

const fn unit(per_si: f64, name: &'static str) -> Unit {
    Unit { per_si, name }
}

pub(super) const KPA: Unit = unit(1e-3, "kPa");
pub(super) const PA: Unit = unit(1.0, "Pa");
pub(super) const NEWTON: Unit = unit(1.0, "N");
pub(super) const MM: Unit = unit(1e3, "mm");
pub(super) const MM3: Unit = unit(1e9, "mm\u{b3}");
pub(super) const TENSION: Unit = unit(1.0, "N/m");
/// Stretches: deformed over undeformed length.
pub(super) const STRETCH: Unit = unit(1.0, "mm/mm");
pub(super) const PERCENT: Unit = unit(1.0, "%");
pub(super) const DEGREES: Unit = unit(180.0 / core::f64::consts::PI, "\u{b0}");
pub(super) const SECONDS: Unit = unit(1.0, "s");
pub(super) const MILLISECONDS: Unit = unit(1e3, "ms");

impl Unit {
    /// A number of SI in this unit, with the unit.
    pub(super) fn say(self, si: f64) -> Markup {
        self.given(&plain(self.per_si * si, DIGITS))
    }

    /// A number that is written already.
    pub(super) fn given(self, number: &str) -> Markup {
        html! { span.number { (number) } "\u{a0}" span.unit { (self.name) } }
    }

    /// As plain text, for titles.
    pub(super) fn text(self, si: f64) -> String {
        format!("{} {}", plain(self.per_si * si, 3), self.name)
    }
}

/// A whole number of something.
pub(super) fn count(number: impl std::fmt::Display, of: &str) -> Markup {
    html! { span.number { (number) } "\u{a0}" span.unit { (of) } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_carry_their_unit() {
        assert_eq!(MM.text(2.5e-3), "2.5 mm");
        assert_eq!(
            KPA.say(179_061.8).into_string(),
            "<span class=\"number\">179.1</span>\u{a0}<span class=\"unit\">kPa</span>"
        );
        assert_eq!((plain(0.0, 4), plain(30.0, 4)), ("0".into(), "30".into()));
    }
}
