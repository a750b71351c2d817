//! What a column's heading says: a quantity and a unit, `Pressure (in bar)` or `force_n`.

use std::fmt;

/// A quantity of the bench.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Measured {
    /// Indentation.
    Indentation,
    /// Force.
    Force,
    /// Pressure rise over rest.
    PressureRise,
}

/// A unit's names and its size in SI.
type Unit = (&'static [&'static str], f64);

const LENGTHS: &[Unit] = &[
    (
        &["mm", "millimetre", "millimetres", "millimeter", "millimeters"],
        1e-3,
    ),
    (
        &[
            "um",
            "\u{b5}m",
            "\u{3bc}m",
            "micron",
            "microns",
            "micrometre",
            "micrometer",
        ],
        1e-6,
    ),
    (&["m", "metre", "metres", "meter"], 1.0),
    (&["cm"], 1e-2),
    (&["nm"], 1e-9),
    (&["in", "inch", "inches"], 0.0254),
];
const FORCES: &[Unit] = &[
    (&["N", "newton", "newtons"], 1.0),
    (&["mN"], 1e-3),
    (&["cN"], 1e-2),
    (&["kN"], 1e3),
    (&["gf", "g"], 9.806_65e-3),
    (&["kgf", "kg"], 9.806_65),
    (&["daN"], 10.0),
    (&["lbf"], 4.448_222),
    (&["ozf"], 0.278_013_9),
];
const PRESSURES: &[Unit] = &[
    (&["kPa", "kilopascal", "kilopascals"], 1e3),
    (&["Pa", "pascal", "pascals", "N/m2"], 1.0),
    (&["hPa", "mbar"], 1e2),
    (&["MPa", "N/mm2"], 1e6),
    (&["bar"], 1e5),
    (&["psi"], 6_894.757),
    (&["mmHg", "Torr"], 133.322),
    (&["cmH2O"], 98.0665),
    (&["mmH2O"], 9.80665),
    (&["mH2O"], 9_806.65),
    (&["inH2O", "inWC", "inWG"], 249.088_9),
    (&["inHg"], 3_386.389),
    (&["kgf/cm2", "kg/cm2"], 98_066.5),
    (&["atm"], 101_325.0),
];
/// Milli and mega differ by their case alone, and these are no units of a fingertip's bench.
const DOUBTFUL: [&str; 4] = ["mPa", "MN", "Mm", "Mbar"];

/// What follows a unit of a gauge pressure and of an absolute one, in lower case.
const GAUGE: [&str; 4] = ["(g)", "gauge", "rel", "g"];
const ABSOLUTE: [&str; 4] = ["(a)", "absolute", "abs", "a"];

/// Names that tell a quantity, in lower case.
const INDENTATION_NAMES: &[&str] = &[
    "indentation",
    "indentation depth",
    "indent",
    "depth",
    "displacement",
    "penetration",
    "penetration depth",
    "travel",
    "stroke",
    "deflection",
    "compression",
    "extension",
    "compressive extension",
    "compressive displacement",
    "axial displacement",
    "crosshead",
    "crosshead travel",
    "crosshead displacement",
    "tiefe",
    "eindringtiefe",
    "eindr\u{fc}cktiefe",
    "weg",
    "standardweg",
    "traversenweg",
    "profondeur",
    "enfoncement",
];
const FORCE_NAMES: &[&str] = &[
    "force",
    "normal force",
    "contact force",
    "load",
    "load cell",
    "load cell force",
    "compressive load",
    "compressive force",
    "axial load",
    "axial force",
    "kraft",
    "normalkraft",
    "standardkraft",
    "force normale",
];
const PRESSURE_NAMES: &[&str] = &[
    "pressure rise",
    "rise",
    "pressure",
    "gauge pressure",
    "relative pressure",
    "pressure change",
    "pressure difference",
    "delta pressure",
    "delta p",
    "dp",
    "fluid pressure",
    "internal pressure",
    "pressure gauge",
    "druck",
    "\u{fc}berdruck",
    "druckanstieg",
    "pression",
    "pression relative",
];

impl Measured {
    /// All of them.
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Indentation, Self::Force, Self::PressureRise];

    /// Its column's name in the contract.
    pub fn column(self) -> &'static str {
        match self {
            Self::Indentation => "indentation_mm",
            Self::Force => "force_n",
            Self::PressureRise => "pressure_rise_kpa",
        }
    }

    /// What SI is multiplied by for its column.
    pub fn per_si(self) -> f64 {
        match self {
            Self::Indentation => 1e3,
            Self::Force => 1.0,
            Self::PressureRise => 1e-3,
        }
    }

    fn names(self) -> &'static [&'static str] {
        match self {
            Self::Indentation => INDENTATION_NAMES,
            Self::Force => FORCE_NAMES,
            Self::PressureRise => PRESSURE_NAMES,
        }
    }

    fn units(self) -> &'static [Unit] {
        match self {
            Self::Indentation => LENGTHS,
            Self::Force => FORCES,
            Self::PressureRise => PRESSURES,
        }
    }

    /// Size of a unit in SI: by its exact name, else whatever the case of its letters; of a pressure also with a word for gauge.
    pub(super) fn unit(self, name: &str) -> Option<f64> {
        let name = one_word(name);
        self.plain_unit(&name).or_else(|| {
            let of_gauge = || without_ending(&name, &GAUGE).find_map(|unit| self.plain_unit(unit));
            (self == Self::PressureRise).then(of_gauge).flatten()
        })
    }

    /// Whether a unit is that of an absolute pressure: `psia`, `mbar abs`.
    pub(super) fn is_absolute_unit(name: &str) -> bool {
        let name = one_word(name);
        Self::PressureRise.unit(&name).is_none()
            && without_ending(&name, &ABSOLUTE).any(|unit| Self::PressureRise.plain_unit(unit).is_some())
    }

    fn plain_unit(self, name: &str) -> Option<f64> {
        let find = |same: &dyn Fn(&str) -> bool| {
            let unit = self
                .units()
                .iter()
                .find(|(names, _)| names.iter().any(|known| same(known)));
            unit.map(|(_, size)| *size)
        };
        if DOUBTFUL.contains(&name) {
            return None;
        }
        find(&|known| known == name).or_else(|| find(&|known| known.eq_ignore_ascii_case(name)))
    }

    /// The units, for a message.
    pub(super) fn unit_names(self) -> String {
        let names: Vec<&str> = self.units().iter().map(|(names, _)| names[0]).collect();
        names.join(", ")
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Indentation => "indentation",
            Self::Force => "force",
            Self::PressureRise => "pressure rise",
        })
    }
}

/// A unit without blanks and points, its powers as digits: `kgf/cm\u{b2}` is `kgf/cm2`, and `in. Hg` `inHg`.
fn one_word(unit: &str) -> String {
    unit.chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '.' | '^' | '_'))
        .map(|c| {
            if matches!(c, '\u{b2}' | '\u{2082}') {
                '2'
            } else {
                c
            }
        })
        .collect()
}

/// What stands before each of some endings that a unit has.
fn without_ending<'a>(unit: &'a str, endings: &'a [&str]) -> impl Iterator<Item = &'a str> {
    endings.iter().filter_map(move |ending| {
        let at = unit.len().checked_sub(ending.len())?;
        let (start, end) = unit.split_at_checked(at)?;
        end.eq_ignore_ascii_case(ending).then_some(start)
    })
}

/// A heading, taken apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Heading {
    /// Its words in lower case, without the unit.
    pub(super) name: String,
    /// The unit as it is written, if one is.
    pub(super) unit: Option<String>,
}

impl Heading {
    /// Takes a heading apart: a unit in parentheses or brackets, after `in` or `/`, or as the last word.
    pub(super) fn of(text: &str) -> Self {
        let text = text.trim();
        let (name, unit) = bracketed(text)
            .or_else(|| text.rsplit_once(" in "))
            .or_else(|| text.rsplit_once('/'))
            .map_or((text, None), |(name, unit)| (name, Some(bare(unit).to_owned())));
        let mut words = words(name);
        let unit = unit.filter(|unit| !unit.is_empty()).or_else(|| {
            let last = words.last()?;
            let known = words.len() > 1 && Measured::ALL.iter().any(|quantity| quantity.unit(last).is_some());
            (known || (words.len() > 1 && DOUBTFUL.contains(&last.as_str())))
                .then(|| words.pop())
                .flatten()
        });
        Self {
            name: words.join(" ").to_lowercase(),
            unit,
        }
    }

    /// The quantity that its name tells.
    pub(super) fn quantity(&self) -> Option<Measured> {
        Measured::ALL
            .into_iter()
            .find(|quantity| quantity.names().contains(&self.name.as_str()))
    }

    /// Whether its name is an absolute pressure's.
    pub(super) fn is_absolute(&self) -> bool {
        let says = self
            .name
            .split(' ')
            .any(|word| matches!(word, "absolute" | "abs" | "absolutdruck"));
        let of_unit = self.unit.as_deref().is_some_and(Measured::is_absolute_unit);
        let of_pressure = ["press", "druck"].iter().any(|word| self.name.contains(word));
        of_pressure && (says || of_unit)
    }
}

/// A unit as it stands in a cell: `(mm)`, `[in bar]`.
pub(super) fn bare(unit: &str) -> &str {
    let unit = unit.trim();
    let unit = match bracketed(unit) {
        Some(("", inner)) => inner.trim(),
        _ => unit,
    };
    unit.strip_prefix("in ").unwrap_or(unit).trim()
}

/// Name and unit of `name (unit)`.
fn bracketed(text: &str) -> Option<(&str, &str)> {
    let inner = text.strip_suffix([')', ']', '}', '>'])?;
    // `Pressure (bar(g))`: to the bracket that the last one closes.
    let mut open = 1;
    let (at, _) = inner.char_indices().rev().find(|(_, c)| {
        match c {
            ')' | ']' | '}' | '>' => open += 1,
            '(' | '[' | '{' | '<' => open -= 1,
            _ => {}
        }
        open == 0
    })?;
    Some((&inner[..at], &inner[at + 1..]))
}

/// Words between blanks, underscores and hyphens, and where a small letter meets a capital word.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for part in text.split(|c: char| c.is_whitespace() || matches!(c, '_' | '-' | '.' | ':' | ',')) {
        let mut word = String::new();
        let letters: Vec<char> = part.chars().collect();
        for (i, &letter) in letters.iter().enumerate() {
            // `PressureRise`, and not `kPa`.
            let begins = letter.is_uppercase()
                && i > 1
                && letters[i - 1].is_lowercase()
                && letters.get(i + 1).is_some_and(|next| next.is_lowercase())
                && letters.len() - i > 2;
            if begins {
                words.push(std::mem::take(&mut word));
            }
            word.push(letter);
        }
        words.push(word);
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_taken_apart() {
        use Measured::{Force, Indentation, PressureRise};
        for (text, quantity, unit, size) in [
            ("force_n", Force, "n", 1.0),
            ("Force (kN)", Force, "kN", 1e3),
            ("FORCE [N]", Force, "N", 1.0),
            ("Load / mN", Force, "mN", 1e-3),
            ("force_mn", Force, "mn", 1e-3),
            ("Pressure (in bar)", PressureRise, "bar", 1e5),
            ("pressure_rise_pa", PressureRise, "pa", 1.0),
            ("PRESSURE_RISE_KPA", PressureRise, "KPA", 1e3),
            ("PressureRise_kPa", PressureRise, "kPa", 1e3),
            ("Pressure in mbar", PressureRise, "mbar", 1e2),
            ("Indentation_mm", Indentation, "mm", 1e-3),
            ("Depth (\u{b5}m)", Indentation, "\u{b5}m", 1e-6),
            ("Depth (in)", Indentation, "in", 0.0254),
            ("Pressure (bar(g))", PressureRise, "bar(g)", 1e5),
            ("Pressure (psig)", PressureRise, "psig", 6_894.757),
            ("Pressure [kPa g]", PressureRise, "kPa g", 1e3),
            ("Pressure (kgf/cm\u{b2})", PressureRise, "kgf/cm\u{b2}", 98_066.5),
            ("Pressure (in. Hg)", PressureRise, "in. Hg", 3_386.389),
            ("Pressure (cm H2O)", PressureRise, "cm H2O", 98.0665),
            ("Compressive extension (mm)", Indentation, "mm", 1e-3),
            ("Standardkraft [kN]", Force, "kN", 1e3),
            ("\u{dc}berdruck (mbar)", PressureRise, "mbar", 1e2),
        ] {
            let heading = Heading::of(text);
            assert_eq!(heading.quantity(), Some(quantity), "{text}: {heading:?}");
            assert_eq!(heading.unit.as_deref(), Some(unit), "{text}");
            let found = quantity.unit(unit).expect("a unit");
            assert!((found / size - 1.0).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn other_columns_are_no_quantity() {
        for text in [
            "pressure_left_kpa",
            "position_mm",
            "time_s",
            "Fz",
            "trial",
            "hold_indentation_mm_inferred",
        ] {
            assert_eq!(Heading::of(text).quantity(), None, "{text}");
        }
        assert_eq!(Heading::of("Force").unit, None);
        assert!(Heading::of("Absolute pressure (kPa)").is_absolute());
        for text in [
            "Pressure (psia)",
            "pressure_mbar_abs",
            "Pressure (bar(a))",
            "Absolutdruck (hPa)",
        ] {
            assert!(Heading::of(text).is_absolute(), "{text}");
        }
        assert!(!Heading::of("Pressure (Pa)").is_absolute() && !Heading::of("Pressure (kPa)").is_absolute());
        assert_eq!(Measured::Force.unit("MN"), None);
        assert_eq!(Measured::PressureRise.unit("mPa"), None);
    }
}
