//! Which column holds what: by the user's word, by the name of the contract, or by a heading that can mean one thing only.

use super::data_error::DataError;
use super::heading::{Heading, Measured, bare};
use crate::table_text::Sheet;

/// Names of the columns that are no quantity.
pub(super) const TRIAL: &str = "trial";
pub(super) const DIRECTION: &str = "direction";
/// Likeness of two names from which on one is a slip of the other.
const ALIKE: f64 = 0.9;

/// A column of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    /// Its place.
    pub(super) at: usize,
    /// What one of its units is in SI.
    pub(super) unit: f64,
}

/// The columns of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Columns {
    /// Indentation, force, pressure rise.
    pub(super) quantities: [Option<Column>; 3],
    pub(super) trial: Option<usize>,
    pub(super) direction: Option<usize>,
    /// What was recognised and what was left aside, one line each.
    pub(super) notes: Vec<String>,
}

impl Columns {
    /// Finds them; `named` are pairs of a name of the contract and the file's.
    ///
    /// # Errors
    /// [`DataError`] where a heading can mean several things, or too few are there.
    pub(super) fn find(
        sheet: &Sheet,
        named: &[(String, String)],
        filters: &[usize],
    ) -> Result<Self, DataError> {
        let mut columns = Self {
            quantities: [None; 3],
            trial: None,
            direction: None,
            notes: Vec::new(),
        };
        for (name, found) in named {
            columns.name(sheet, name, found)?;
        }
        if !sheet.named && named.is_empty() {
            return Err(DataError::NoHeader {
                columns: sheet.header.len(),
            });
        }
        let mut used: Vec<usize> = columns
            .quantities
            .iter()
            .flatten()
            .map(|column| column.at)
            .collect();
        used.extend(filters);
        if sheet.named {
            for quantity in Measured::ALL {
                if columns.quantities[quantity as usize].is_none() {
                    let found = recognise(sheet, quantity, &used, &mut columns.notes)?;
                    used.extend(found.map(|column| column.at));
                    columns.quantities[quantity as usize] = found;
                }
            }
            for (place, name) in [(&mut columns.trial, TRIAL), (&mut columns.direction, DIRECTION)] {
                if place.is_none() {
                    *place = exact(sheet, name)?;
                }
            }
        }
        used.extend(columns.trial.into_iter().chain(columns.direction));
        columns.check(sheet, &used)?;
        Ok(columns)
    }

    /// A column by the user's word.
    fn name(&mut self, sheet: &Sheet, name: &str, found: &str) -> Result<(), DataError> {
        let at = place(sheet, found)?;
        let lower = name.to_lowercase();
        if lower == TRIAL {
            self.trial = Some(at);
        } else if lower == DIRECTION {
            self.direction = Some(at);
        } else {
            let heading = Heading::of(name);
            let known = heading.quantity().zip(heading.unit.as_deref());
            let (quantity, meant) = known
                .and_then(|(quantity, unit)| Some((quantity, (unit, quantity.unit(unit)?))))
                .ok_or_else(|| DataError::UnknownName {
                    name: name.to_owned(),
                })?;
            let stated = stated_unit(sheet, at).filter(|unit| quantity.unit(unit).is_some());
            let unit = stated
                .as_deref()
                .and_then(|unit| quantity.unit(unit))
                .unwrap_or(meant.1);
            if let Some(stated) = stated
                && unit.to_bits() != meant.1.to_bits()
            {
                self.notes.push(format!(
                    "`{found}` is in {stated}, as its heading has it, and not in {}",
                    meant.0
                ));
            }
            self.quantities[quantity as usize] = Some(Column { at, unit });
        }
        Ok(())
    }

    /// Enough columns, and none left aside that was meant to be one.
    fn check(&mut self, sheet: &Sheet, used: &[usize]) -> Result<(), DataError> {
        let known: [&str; 5] = ["indentation_mm", "force_n", "pressure_rise_kpa", TRIAL, DIRECTION];
        let missing = |name: &str| match name {
            TRIAL => self.trial.is_none(),
            DIRECTION => self.direction.is_none(),
            _ => Measured::ALL
                .iter()
                .any(|quantity| quantity.column() == name && self.quantities[*quantity as usize].is_none()),
        };
        let unused: Vec<usize> = (0..sheet.header.len()).filter(|at| !used.contains(at)).collect();
        for &at in &unused {
            let found = &sheet.header[at];
            let lower = found.to_lowercase();
            let near = known.into_iter().find(|name| {
                missing(name) && strsim::jaro_winkler(&lower, name) > ALIKE && first_word_alike(&lower, name)
            });
            if let Some(name) = near {
                return Err(DataError::NearMiss {
                    found: found.clone(),
                    meant: name,
                });
            }
            if self.quantities[Measured::PressureRise as usize].is_none() && Heading::of(found).is_absolute()
            {
                return Err(DataError::Absolute { found: found.clone() });
            }
        }
        if self.quantities.iter().flatten().count() < 2 {
            return Err(DataError::TooFewColumns {
                found: sheet.header.join(", "),
            });
        }
        for quantity in Measured::ALL {
            let could = unused
                .iter()
                .find(|&&at| stated_unit(sheet, at).is_some_and(|unit| quantity.unit(&unit).is_some()));
            if let Some(&at) = could
                && self.quantities[quantity as usize].is_none()
            {
                self.notes.push(format!(
                    "no column is taken as the {quantity}: if `{}` is it, say --columns {}={}",
                    sheet.header[at],
                    quantity.column(),
                    at + 1
                ));
            }
        }
        let names: Vec<&str> = unused
            .iter()
            .map(|&at| sheet.header[at].as_str())
            .filter(|name| !name.is_empty())
            .collect();
        if sheet.named && !names.is_empty() {
            self.notes
                .push(format!("columns that are not used: {}", names.join(", ")));
        }
        Ok(())
    }
}

/// `forse_n` is a slip of `force_n`, `pressure_left_kpa` is another column than `pressure_rise_kpa`.
fn first_word_alike(found: &str, name: &str) -> bool {
    let words = |text: &str| text.split(['_', ' ']).count();
    let distance = strsim::damerau_levenshtein(found, name);
    distance <= 2 && words(found) == words(name)
}

/// The place of a column: its name, whatever the case if that is one column only, or its number.
pub(super) fn place(sheet: &Sheet, name: &str) -> Result<usize, DataError> {
    let same: Vec<usize> = (0..sheet.header.len())
        .filter(|&at| sheet.header[at] == name)
        .collect();
    let alike: Vec<usize> = (0..sheet.header.len())
        .filter(|&at| sheet.header[at].to_lowercase() == name.to_lowercase())
        .collect();
    match (&same[..], &alike[..]) {
        ([at], _) | ([], [at]) => return Ok(*at),
        ([], []) => {}
        ([], several) | (several, _) => return the_same(sheet, several),
    }
    name.parse::<usize>()
        .ok()
        .filter(|number| (1..=sheet.header.len()).contains(number))
        .map(|number| number - 1)
        .ok_or_else(|| DataError::Column {
            missing: name.to_owned(),
            found: sheet.header.join(", "),
        })
}

/// One of several columns of one name, where it does not matter which.
fn the_same(sheet: &Sheet, several: &[usize]) -> Result<usize, DataError> {
    let first = several[0];
    let differ = several
        .iter()
        .find(|&&other| sheet.rows.iter().any(|row| row.cell(first) != row.cell(other)));
    match differ {
        None => Ok(first),
        Some(&other) => Err(DataError::Several {
            what: sheet.header[first].clone(),
            columns: [first, other].map(|at| format!("column {}, `{}`", at + 1, sheet.header[at])),
        }),
    }
}

/// A column by its exact name, capitals or not.
fn exact(sheet: &Sheet, name: &str) -> Result<Option<usize>, DataError> {
    let any = sheet
        .header
        .iter()
        .any(|heading| heading.eq_ignore_ascii_case(name));
    any.then(|| place(sheet, name)).transpose()
}

/// The unit that a heading or the row of units states.
fn stated_unit(sheet: &Sheet, at: usize) -> Option<String> {
    let of_row = sheet.units.as_ref().map(|units| bare(&units[at]).to_owned());
    of_row
        .filter(|unit| !unit.is_empty())
        .or_else(|| Heading::of(&sheet.header[at]).unit)
}

/// The column of a quantity by its heading.
fn recognise(
    sheet: &Sheet,
    quantity: Measured,
    used: &[usize],
    notes: &mut Vec<String>,
) -> Result<Option<Column>, DataError> {
    let canonical = quantity.column();
    if let Some(at) = exact(sheet, canonical)?
        && !used.contains(&at)
    {
        let unit = unit_of(sheet, at, quantity)?;
        if sheet.header[at] != canonical {
            notes.push(format!("`{}` is taken as {canonical}", sheet.header[at]));
        }
        return Ok(Some(Column { at, unit }));
    }
    let found: Vec<usize> = (0..sheet.header.len())
        .filter(|at| !used.contains(at))
        .filter(|&at| Heading::of(&sheet.header[at]).quantity() == Some(quantity))
        .collect();
    let at = match found[..] {
        [] => return Ok(None),
        [at] => at,
        _ => the_same(sheet, &found).map_err(|error| match error {
            DataError::Several { columns, .. } => DataError::Several {
                what: canonical.to_owned(),
                columns,
            },
            other => other,
        })?,
    };
    let unit = unit_of(sheet, at, quantity)?;
    let written = stated_unit(sheet, at).unwrap_or_default();
    notes.push(format!(
        "`{}` is taken as the {quantity}, in {written}",
        sheet.header[at]
    ));
    Ok(Some(Column { at, unit }))
}

/// The size of a column's unit.
fn unit_of(sheet: &Sheet, at: usize, quantity: Measured) -> Result<f64, DataError> {
    let about = |unit: Option<String>| DataError::Unit {
        column: sheet.header[at].clone(),
        unit,
        quantity,
    };
    let of_heading = Heading::of(&sheet.header[at]).unit;
    let stated = stated_unit(sheet, at).ok_or_else(|| about(None))?;
    if quantity == Measured::PressureRise && Measured::is_absolute_unit(&stated) {
        let found = sheet.header[at].clone();
        return Err(DataError::Absolute { found });
    }
    let size = quantity
        .unit(&stated)
        .ok_or_else(|| about(Some(stated.clone())))?;
    if let Some(heading) = of_heading.filter(|heading| {
        quantity
            .unit(heading)
            .is_none_or(|other| other.to_bits() != size.to_bits())
    }) {
        return Err(DataError::TwoUnits {
            column: sheet.header[at].clone(),
            units: [heading, stated],
        });
    }
    Ok(size)
}
