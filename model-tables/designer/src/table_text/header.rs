//! Where the names of the columns stand: above the first run of numbers, with or without a row of units between.

use super::decimal::is_number;
use super::is_missing;

/// Rows of numbers by which a table is told from a row or two of results above it.
const RUN: usize = 3;
/// Rows at most of a table whose columns stand as rows.
const LYING_ROWS: usize = 12;
/// What a row of units holds, in lower case.
const UNITS: [&str; 34] = [
    "mm", "um", "\u{b5}m", "\u{3bc}m", "nm", "cm", "m", "in", "n", "mn", "cn", "kn", "g", "gf", "kg", "kgf",
    "lbf", "pa", "hpa", "kpa", "mpa", "bar", "mbar", "psi", "mmhg", "s", "sec", "ms", "min", "v", "mv", "%",
    "\u{b0}c", "hz",
];

/// Places among the rows.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Top {
    /// Of the names.
    pub(super) header: usize,
    /// Of the units; `None` where there is no such row.
    pub(super) units: Option<usize>,
}

/// The names above the first run of numbers; `None` where no row without a number stands above one with two.
pub(super) fn find(rows: &[&[String]]) -> Option<Top> {
    let mut first = None;
    for at in 1..rows.len() {
        if !is_data(rows[at]) || !is_text(rows[at - 1]) {
            continue;
        }
        let run = rows[at..].iter().take_while(|row| is_data(row)).count();
        let top = above(rows, at);
        if run >= RUN {
            return Some(top);
        }
        first = first.or(Some(top));
    }
    first
}

/// Whether each row holds a column: a name first, no name twice, and then numbers alone.
pub(super) fn lies(rows: &[&[String]]) -> bool {
    let named = |row: &&[String]| {
        row.len() > 2
            && !is_number(&row[0])
            && !is_missing(&row[0])
            && row[1..].iter().all(|cell| is_number(cell))
    };
    rows.len() <= LYING_ROWS
        && rows.iter().all(named)
        && rows
            .iter()
            .enumerate()
            .all(|(i, row)| row.len() > rows.len() && rows[..i].iter().all(|other| other[0] != row[0]))
}

/// The header, and the row of units, above the numbers that begin at a row.
fn above(rows: &[&[String]], at: usize) -> Top {
    let alone = Top {
        header: at - 1,
        units: None,
    };
    let Some(before) = at.checked_sub(2).filter(|&before| is_text(rows[before])) else {
        return alone;
    };
    let [upper, lower] = [rows[before], rows[at - 1]];
    let fits =
        filled(upper) > 1 && filled(upper) == filled(lower) && !lower.iter().any(|cell| has_unit(cell));
    if fits || are_units(lower) {
        Top {
            header: before,
            units: Some(at - 1),
        }
    } else {
        alone
    }
}

/// Cells up to the last that is not empty.
fn filled(row: &[String]) -> usize {
    row.iter()
        .rposition(|cell| !cell.is_empty())
        .map_or(0, |last| last + 1)
}

/// A row of numbers: two of them, or one among cells that are missing.
fn is_data(row: &[String]) -> bool {
    // `0.5 mm` is a number too: its reader refuses it by name.
    let number = |cell: &String| cell.split_whitespace().next().is_some_and(is_number);
    let numbers = row.iter().filter(|cell| number(cell)).count();
    numbers > 1
        || row.iter().all(|cell| number(cell) || is_missing(cell)) && row.iter().any(|cell| !cell.is_empty())
}

/// A row without a number.
fn is_text(row: &[String]) -> bool {
    !row.iter().any(|cell| is_number(cell)) && row.iter().any(|cell| !is_missing(cell))
}

/// `(mm)`, or `mm`.
fn are_units(row: &[String]) -> bool {
    let unit = |cell: &String| {
        let bare = cell.trim_matches(['(', ')', '[', ']', ' ']).to_lowercase();
        cell.starts_with(['(', '[']) || UNITS.contains(&bare.as_str())
    };
    row.iter().any(unit) && row.iter().all(|cell| unit(cell) || is_missing(cell))
}

/// `Depth (mm)` or `force_n`: a name with its unit.
fn has_unit(cell: &str) -> bool {
    cell.find(['(', '[']).is_some_and(|at| at > 0) || cell.contains('_')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn top(text: &str) -> Option<(usize, Option<usize>)> {
        let rows: Vec<Vec<String>> = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect())
            .collect();
        let rows: Vec<&[String]> = rows.iter().map(Vec::as_slice).collect();
        find(&rows).map(|top| (top.header, top.units))
    }

    #[test]
    fn names_stand_above_the_numbers() {
        for (text, found) in [
            ("a,b\n1,2\n3,4", Some((0, None))),
            ("a,b\nmm,N\n1,2\n3,4", Some((0, Some(1)))),
            ("a,b,note\n(mm),(N),\n1,2,\n3,4,", Some((0, Some(1)))),
            (
                "Model,M5\nRate,100,Hz\nDepth (mm),Load (N),Note\n1,2,\n3,4,\n5,6,",
                Some((2, None)),
            ),
            (
                ",Load (N),E (MPa)\n1,2,3\nMean,2,3\na,b,c\n1,2,3\n1,2,3\n1,2,3",
                Some((3, None)),
            ),
            ("File,tip\nDepth (mm),Load (N)\n1,2\n3,4\n5,6", Some((1, None))),
            ("a,b\nnan,nan\n1,2\n3,4", Some((0, None))),
            ("1,2\n3,4", None),
            ("name,n\nx,1\ny,2", None),
        ] {
            assert_eq!(top(text), found, "{text}");
        }
    }
}
