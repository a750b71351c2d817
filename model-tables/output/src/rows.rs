//! Rows of an answer, and the forms they are printed in.

use std::fmt::Write as _;

/// Significant digits of a number in CSV.
const CSV_DIGITS: i32 = 15;
/// Significant digits of a number in a table for people.
const TABLE_DIGITS: i32 = 7;

/// How rows are printed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Format {
    /// Columns for people
    Table,
    /// Comma-separated values with a header
    Csv,
    /// An array of objects
    Json,
}

/// One value.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number in the unit its column's name states.
    Number(f64),
    /// A whole number.
    Count(usize),
    /// A word.
    Text(String),
    /// What has no meaning here.
    Empty,
}

/// Columns and rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    columns: &'static [&'static str],
    rows: Vec<Vec<Cell>>,
}

impl Rows {
    /// No rows yet.
    pub fn new(columns: &'static [&'static str]) -> Self {
        Self {
            columns,
            rows: Vec::new(),
        }
    }

    /// One row more, a cell a column.
    pub fn push(&mut self, row: Vec<Cell>) {
        debug_assert_eq!(row.len(), self.columns.len());
        self.rows.push(row);
    }

    /// The whole text.
    ///
    /// # Errors
    /// The reason in words, where the form cannot hold a value.
    pub fn print(&self, format: Format) -> Result<String, String> {
        match format {
            Format::Table => Ok(self.table()),
            Format::Csv => self.csv().map_err(|error| error.to_string()),
            Format::Json => self.json().map_err(|error| error.to_string()),
        }
    }

    fn csv(&self) -> Result<String, Box<dyn core::error::Error>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.columns)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(|cell| cell.text(CSV_DIGITS)))?;
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }

    fn json(&self) -> Result<String, serde_json::Error> {
        let objects: Vec<serde_json::Value> = self
            .rows
            .iter()
            .map(|row| {
                let pairs = self.columns.iter().zip(row).map(|(&column, cell)| {
                    let value = match cell {
                        Cell::Number(number) => serde_json::Value::from(*number),
                        Cell::Count(count) => serde_json::Value::from(*count),
                        Cell::Text(text) => serde_json::Value::from(text.as_str()),
                        Cell::Empty => serde_json::Value::Null,
                    };
                    (column.to_owned(), value)
                });
                serde_json::Value::Object(pairs.collect())
            })
            .collect();
        Ok(serde_json::to_string_pretty(&objects)? + "\n")
    }

    /// For people: a column without anything in it is left out.
    fn table(&self) -> String {
        let is_empty = |column: usize| {
            let mut cells = self.rows.iter().map(|row| &row[column]);
            !self.rows.is_empty() && cells.all(|cell| matches!(cell, Cell::Empty))
        };
        let shown: Vec<usize> = (0..self.columns.len())
            .filter(|&column| !is_empty(column))
            .collect();
        let header = shown
            .iter()
            .map(|&column| self.columns[column].to_owned())
            .collect();
        let cells = |row: &Vec<Cell>| {
            shown
                .iter()
                .map(|&column| row[column].text(TABLE_DIGITS))
                .collect()
        };
        let lines: Vec<Vec<String>> = core::iter::once(header)
            .chain(self.rows.iter().map(cells))
            .collect();
        let widths: Vec<usize> = (0..shown.len())
            .map(|column| {
                lines
                    .iter()
                    .map(|line| line[column].chars().count())
                    .max()
                    .unwrap_or(0)
            })
            .collect();
        let mut text = String::new();
        for line in lines {
            let mut padded = String::new();
            for (cell, width) in line.iter().zip(&widths) {
                let _ = write!(padded, "{cell:>width$}  ");
            }
            text.push_str(padded.trim_end());
            text.push('\n');
        }
        text
    }
}

impl Cell {
    /// A word.
    pub fn word(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    fn text(&self, digits: i32) -> String {
        match self {
            Self::Number(number) => significant(*number, digits),
            Self::Count(count) => count.to_string(),
            Self::Text(text) => text.clone(),
            Self::Empty => String::new(),
        }
    }
}

/// A number with that many significant digits, without an exponent where a person can still read it.
pub fn significant(number: f64, digits: i32) -> String {
    if number == 0.0 || !number.is_finite() {
        return format!("{number:.*}", digits as usize - 1);
    }
    let exponent = libm::floor(libm::log10(number.abs())) as i32;
    if (-6..digits).contains(&exponent) {
        format!("{number:.*}", (digits - 1 - exponent).max(0) as usize)
    } else {
        format!("{number:.*e}", digits as usize - 1)
    }
}

/// A number with that many significant digits at most: without needless zeros behind its point.
pub fn plain(number: f64, digits: i32) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let text = significant(number, digits);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_without_anything_is_left_out_for_people_and_kept_for_programs() {
        let mut rows = Rows::new(&["force_n", "wrinkled", "status"]);
        rows.push(vec![Cell::Number(1.0), Cell::Empty, Cell::word("ok")]);
        rows.push(vec![Cell::Number(2.0), Cell::Empty, Cell::Empty]);
        let table = rows.print(Format::Table).expect("a table");
        assert!(!table.contains("wrinkled") && table.contains("status"), "{table}");
        let csv = rows.print(Format::Csv).expect("rows");
        assert!(csv.starts_with("force_n,wrinkled,status\n"), "{csv}");
        assert!(
            Rows::new(&["a", "b"])
                .print(Format::Table)
                .expect("a table")
                .contains('b')
        );
    }

    fn rows() -> Rows {
        let mut rows = Rows::new(&["force_n", "status"]);
        rows.push(vec![Cell::Number(1.0 / 3.0), Cell::word("ok")]);
        rows.push(vec![Cell::Number(0.0), Cell::word("warning: a, b")]);
        rows
    }

    #[test]
    fn csv_has_many_digits_and_quotes_commas() {
        assert_eq!(
            rows().print(Format::Csv).expect("csv"),
            "force_n,status\n0.333333333333333,ok\n0.00000000000000,\"warning: a, b\"\n"
        );
    }

    #[test]
    fn json_has_an_object_a_row_in_the_order_of_the_columns() {
        let text = rows().print(Format::Json).expect("json");
        let value: serde_json::Value = serde_json::from_str(&text).expect("valid");
        assert_eq!(value[1]["status"], "warning: a, b");
        assert!(text.find("force_n") < text.find("status"));
    }

    #[test]
    fn table_is_aligned() {
        assert_eq!(
            rows().print(Format::Table).expect("table"),
            "  force_n         status\n0.3333333             ok\n 0.000000  warning: a, b\n"
        );
    }

    #[test]
    fn numbers_keep_their_significant_digits() {
        assert_eq!(significant(179.061_844_088_872_08, 15), "179.061844088872");
        assert_eq!(significant(-2.5e-3, 7), "-0.002500000");
        assert_eq!(significant(1.5e-12, 3), "1.50e-12");
        assert_eq!(significant(1.5e20, 3), "1.50e20");
    }
}
