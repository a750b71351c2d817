//! Cells -> numbers: decimal points or decimal commas, the same in the whole file.

/// What stands before the decimals.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Decimal {
    /// `1,234.5`
    Point,
    /// `1.234,5`
    Comma,
}

/// What one cell shows of the decimals of its file.
enum Evidence {
    /// Nothing: no number, or a whole one.
    None,
    /// It can be read in one way only.
    Only(Decimal),
    /// Decimals after this mark, or groups of thousands.
    Either(Decimal),
}

impl Decimal {
    /// The decimals of a file, from its cells of numbers with their lines.
    ///
    /// # Errors
    /// One line: cells that contradict each other, or a comma that can be either.
    pub(crate) fn of<'a>(cells: impl Iterator<Item = (u64, &'a str)>) -> Result<Self, String> {
        let mut sure: Option<(Self, u64, &str)> = None;
        let mut unsure: Option<(u64, &str)> = None;
        for (line, cell) in cells {
            match evidence(cell) {
                Evidence::None => {}
                Evidence::Only(mark) => match sure {
                    Some((other, at, found)) if other != mark => {
                        return Err(format!(
                            "has decimal points and decimal commas: `{found}` in line {at}, `{cell}` in line {line}; write \
                             one of the two"
                        ));
                    }
                    Some(_) => {}
                    None => sure = Some((mark, line, cell)),
                },
                Evidence::Either(mark) => {
                    if mark == Self::Comma && unsure.is_none() {
                        unsure = Some((line, cell));
                    }
                }
            }
        }
        match (sure, unsure) {
            (Some((mark, ..)), _) => Ok(mark),
            (None, None) => Ok(Self::Point),
            (None, Some((line, cell))) => Err(format!(
                "line {line}: `{cell}` may have a decimal comma or a group of thousands: write decimal points"
            )),
        }
    }

    /// The number of a cell; `None` if it is none.
    pub(crate) fn number(self, cell: &str) -> Option<f64> {
        let (mark, group) = match self {
            Self::Point => ('.', ','),
            Self::Comma => (',', '.'),
        };
        let mut text = without_spaced_groups(&cell.trim().replace('\u{2212}', "-"));
        if text.contains(group) {
            let whole = text.split(mark).next().unwrap_or_default();
            if !is_grouped(whole, group) || text.matches(group).count() != whole.matches(group).count() {
                return None;
            }
            text.retain(|c| c != group);
        }
        let text = text.replace(mark, ".");
        text.parse::<f64>()
            // Fortran's exponent: `1.5D-03`.
            .or_else(|_| text.replacen(['d', 'D'], "e", 1).parse::<f64>())
            .ok()
            .filter(|number| number.is_finite())
    }
}

/// What stands between groups of thousands and is no decimal mark: apostrophes, and blanks that do not break.
const SPACES: [char; 5] = ['\'', '\u{2019}', '\u{a0}', '\u{202f}', '\u{2009}'];

/// `1'234.5` as `1234.5`; anything else as it is.
fn without_spaced_groups(text: &str) -> String {
    let whole = text.split(['.', ',']).next().unwrap_or_default();
    match SPACES.iter().find(|space| whole.contains(**space)) {
        Some(&space) if is_grouped(whole, space) => {
            whole.chars().filter(|c| *c != space).collect::<String>() + &text[whole.len()..]
        }
        _ => text.to_owned(),
    }
}

/// Digits in groups of three, the first not zero: `1,234,567`.
fn is_grouped(text: &str, group: char) -> bool {
    let mut parts = text.trim_start_matches(['+', '-']).split(group);
    let digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let first = parts.next().unwrap_or_default();
    (1..=3).contains(&first.len())
        && digits(first)
        && !first.starts_with('0')
        && parts.all(|part| part.len() == 3 && digits(part))
}

/// Whether a cell is a number, with a decimal point or a decimal comma.
pub(super) fn is_number(cell: &str) -> bool {
    [Decimal::Point, Decimal::Comma]
        .iter()
        .any(|decimal| decimal.number(cell).is_some())
}

fn evidence(cell: &str) -> Evidence {
    let cell = cell.trim();
    let marks: Vec<char> = cell.chars().filter(|c| matches!(c, '.' | ',')).collect();
    let mark = |mark: char| {
        if mark == ',' {
            Decimal::Comma
        } else {
            Decimal::Point
        }
    };
    let other = |mark: char| {
        if mark == ',' {
            Decimal::Point
        } else {
            Decimal::Comma
        }
    };
    let Some((&first, &last)) = marks.first().zip(marks.last()) else {
        return Evidence::None;
    };
    let found = if first != last || cell.contains(SPACES) {
        Evidence::Only(mark(last))
    } else if is_grouped(cell, first) {
        if marks.len() > 1 {
            Evidence::Only(other(first))
        } else {
            Evidence::Either(mark(first))
        }
    } else {
        Evidence::Only(mark(first))
    };
    // Words and dates show nothing.
    let readable = [Decimal::Point, Decimal::Comma]
        .iter()
        .any(|decimal| decimal.number(cell).is_some());
    if readable { found } else { Evidence::None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(cells: &[&str]) -> Result<Decimal, String> {
        Decimal::of((2..).zip(cells.iter().copied()))
    }

    #[test]
    fn one_cell_that_is_sure_decides_for_the_file() {
        for (cells, mark) in [
            (&["1", "2"][..], Decimal::Point),
            (&["0.5", "1.234"], Decimal::Point),
            (&["1.234"], Decimal::Point),
            (&["0,5", "1,234"], Decimal::Comma),
            (&["1.234,5"], Decimal::Comma),
            (&["1,234.5", "2,000"], Decimal::Point),
            (&["25.11.2026", "0,123"], Decimal::Comma),
            (&["100,000", "1\u{a0}015,150"], Decimal::Comma),
            (&["1'015.150"], Decimal::Point),
        ] {
            assert_eq!(of(cells), Ok(mark), "{cells:?}");
        }
        for (cells, reason) in [
            (&["0.5", "0,6"][..], "`0.5` in line 2, `0,6` in line 3"),
            (&["1,234"], "line 2: `1,234` may have a decimal comma"),
        ] {
            assert!(of(cells).expect_err("unclear").contains(reason));
        }
    }

    #[test]
    fn numbers_are_read_as_their_file_writes_them() {
        use Decimal::{Comma, Point};
        for (decimal, cell, number) in [
            (Comma, "1.234,5", Some(1234.5)),
            (Comma, "-0,5e-3", Some(-0.0005)),
            (Point, "1,234.5", Some(1234.5)),
            (Point, "\u{2212}2.5", Some(-2.5)),
            (Point, "1,23.5", None),
            (Point, "inf", None),
            (Point, "2,5", None),
            (Point, "1'234'567.5", Some(1_234_567.5)),
            (Comma, "-1\u{202f}234,5", Some(-1234.5)),
            (Point, "1'23.5", None),
            (Point, "1.5D-03", Some(0.0015)),
            (Point, "D", None),
        ] {
            assert_eq!(decimal.number(cell), number, "{cell}");
        }
    }
}
