//! What varies in a sweep: keys of the design, each with a range or a list of values.

use super::sample::Sampling;
use model_tables::design_file::Problem;
use model_tables::design_file::section::KeyFault;
use std::fmt::Write as _;
use toml_edit::{TableLike, Value};

/// One key of the design that varies.
#[derive(Clone, Debug)]
pub struct Variable {
    /// The design's key, `membrane.thickness_mm`.
    pub key: String,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    Range {
        from: f64,
        to: f64,
        logarithmic: bool,
        steps: Option<u64>,
    },
    List(Vec<Value>),
}

impl Variable {
    /// Whether every value is a number.
    pub fn is_numeric(&self) -> bool {
        match &self.values {
            Values::Range { .. } => true,
            Values::List(values) => values.iter().all(|value| number(value).is_some()),
        }
    }

    /// Key and values on one line, layout left out.
    pub(super) fn describe(&self) -> String {
        let mut text = format!("{} ", self.key);
        match &self.values {
            Values::Range { .. } => {
                let _ = write!(text, "{:?}", self.values);
            }
            Values::List(values) => {
                for value in values {
                    let _ = write!(text, "{},", plain(value));
                }
            }
        }
        text
    }

    /// Values of a grid.
    pub(super) fn steps(&self) -> u64 {
        match &self.values {
            Values::Range { steps, .. } => steps.unwrap_or(1),
            Values::List(values) => values.len() as u64,
        }
    }

    /// The value at a part of the way, 0 to 1; a list's is the one whose share of the way that is.
    pub(super) fn at(&self, part: f64) -> Value {
        match &self.values {
            Values::List(values) => {
                let place = (part * values.len() as f64) as usize;
                values[place.min(values.len() - 1)].clone()
            }
            &Values::Range {
                from,
                to,
                logarithmic,
                ..
            } => {
                // Exact at both ends.
                Value::from(if part <= 0.0 {
                    from
                } else if part >= 1.0 {
                    to
                } else if logarithmic {
                    from * libm::pow(to / from, part)
                } else {
                    from + (to - from) * part
                })
            }
        }
    }

    /// The value of a grid's step.
    pub(super) fn step(&self, step: u64) -> Value {
        match &self.values {
            Values::List(values) => values[step as usize].clone(),
            Values::Range { .. } => self.at(step as f64 / (self.steps() - 1).max(1) as f64),
        }
    }
}

/// The number that a value is.
pub fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// A value without the spaces and comments around it.
pub fn plain(value: &Value) -> String {
    value.clone().decorated("", "").to_string()
}

/// A value that is not allowed.
pub(super) fn refuse<T>(
    key: impl Into<String>,
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> Result<T, KeyFault> {
    let problem = Problem::Value {
        key: key.into(),
        found: found.into(),
        allowed: allowed.into(),
    };
    Err((None, problem))
}

pub(super) fn missing<T>(key: &str, allowed: &str) -> Result<T, KeyFault> {
    let (key, allowed) = (key.to_owned(), allowed.to_owned());
    Err((None, Problem::Missing { key, allowed }))
}

/// The keys of `[vary]`.
pub(super) fn variables(table: &dyn TableLike, method: Sampling) -> Result<Vec<Variable>, KeyFault> {
    let mut found = Vec::new();
    gather(table, "", method, &mut found)?;
    if found.is_empty() {
        return missing(
            "vary",
            "one key of the design at least, with a range or a list of values",
        );
    }
    for (place, variable) in found.iter().enumerate() {
        let inside = |other: &Variable| {
            let (a, b) = (format!("{}.", variable.key), format!("{}.", other.key));
            a.starts_with(&b) || b.starts_with(&a)
        };
        if let Some(other) = found[..place].iter().find(|other| inside(other)) {
            let allowed = format!("left out, as {} is given, which holds the same key", other.key);
            return refuse(format!("vary.{}", variable.key), "given", allowed);
        }
    }
    Ok(found)
}

/// Ranges and lists of a table and of those in it: `membrane.thickness_mm` may stand in quotes or not.
fn gather(
    table: &dyn TableLike,
    above: &str,
    method: Sampling,
    found: &mut Vec<Variable>,
) -> Result<(), KeyFault> {
    const ALLOWED: &str = "a list of values, or a range { from, to } with steps or scale";
    for (name, item) in table.iter() {
        let key = format!("{above}{name}");
        let full = format!("vary.{key}");
        if let Some(list) = item.as_array() {
            let values: Vec<Value> = list.iter().map(|value| value.clone().decorated("", "")).collect();
            if values.is_empty() {
                return refuse(full, "[]", "a list with one value at least");
            }
            let values = Values::List(values);
            found.push(Variable { key, values });
        } else if let Some(below) = item.as_table_like() {
            if below.contains_key("from") || below.contains_key("to") {
                let values = range(below, &full, method)?;
                found.push(Variable { key, values });
            } else if below.is_empty() {
                return refuse(full, "{}", ALLOWED);
            } else {
                gather(below, &format!("{key}."), method, found)?;
            }
        } else {
            return refuse(full, item.to_string().trim(), ALLOWED);
        }
    }
    Ok(())
}

fn range(table: &dyn TableLike, key: &str, method: Sampling) -> Result<Values, KeyFault> {
    let known = ["from", "to", "steps", "scale"];
    if let Some((name, _)) = table.iter().find(|(name, _)| !known.contains(name)) {
        let (key, allowed) = (format!("{key}.{name}"), known.join(", "));
        return Err((None, Problem::Unknown { key, allowed }));
    }
    let end = |name: &str| -> Result<f64, KeyFault> {
        let Some(item) = table.get(name) else {
            return missing(&format!("{key}.{name}"), "the number at this end of the range");
        };
        match item
            .as_value()
            .and_then(number)
            .filter(|number| number.is_finite())
        {
            Some(number) => Ok(number),
            None => refuse(
                format!("{key}.{name}"),
                item.to_string().trim(),
                "a finite number",
            ),
        }
    };
    let (from, to) = (end("from")?, end("to")?);
    if from >= to {
        return refuse(
            format!("{key}.to"),
            to.to_string(),
            format!("more than from, {from}"),
        );
    }
    let logarithmic = match table.get("scale") {
        None => false,
        Some(item) => match item.as_str() {
            Some("linear") => false,
            Some("log") => true,
            _ => {
                return refuse(
                    format!("{key}.scale"),
                    item.to_string().trim(),
                    "\"linear\" or \"log\"",
                );
            }
        },
    };
    if logarithmic && from <= 0.0 {
        return refuse(
            format!("{key}.from"),
            from.to_string(),
            "above 0, as scale is \"log\"",
        );
    }
    let steps = match (table.get("steps"), method == Sampling::Grid) {
        (None, false) => None,
        (None, true) => {
            return missing(
                &format!("{key}.steps"),
                "a whole number of values, 2 or more, as the method is \"grid\"",
            );
        }
        (Some(item), false) => {
            return refuse(
                format!("{key}.steps"),
                item.to_string().trim(),
                "left out: only a grid has steps",
            );
        }
        (Some(item), true) => match item.as_integer().filter(|steps| (2..=1_000_000).contains(steps)) {
            Some(steps) => Some(steps as u64),
            None => {
                return refuse(
                    format!("{key}.steps"),
                    item.to_string().trim(),
                    "a whole number from 2 to 1 000 000",
                );
            }
        },
    };
    Ok(Values::Range {
        from,
        to,
        logarithmic,
        steps,
    })
}
