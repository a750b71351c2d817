//! Text -> header and rows of cells: comments, separator, lines before the header, a row of units.

use super::decimal::is_number;
use super::encoding;
use super::header::{self, Top};
use super::one_line;

/// Separators, the surest first: a comma may also be a decimal mark, a blank part of a name.
const SEPARATORS: [(u8, &str); 4] = [(b'\t', "tabs"), (b';', "`;`"), (b'|', "`|`"), (b',', "commas")];
/// Rows by which a separator is judged.
const JUDGED: usize = 60;

/// A row of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SheetRow {
    /// Line of the file, counted from 1.
    pub(crate) line: u64,
    cells: Vec<String>,
}

impl SheetRow {
    /// A cell, empty beyond the end.
    pub(crate) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", String::as_str)
    }

    /// A cell of numbers without a comment after it.
    pub(crate) fn number_text(&self, column: usize) -> &str {
        let cell = self.cell(column);
        // `1.#QNAN` has no comment.
        let comment = cell
            .match_indices('#')
            .find(|(at, _)| cell[..*at].chars().next_back().is_none_or(char::is_whitespace));
        comment.map_or(cell, |(at, _)| &cell[..at]).trim()
    }
}

/// A table as text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sheet {
    /// Names of the columns; numbers from 1 on where the file has none.
    pub(crate) header: Vec<String>,
    /// Whether the file names its columns.
    pub(crate) named: bool,
    /// The row of units under the header, where there is one.
    pub(crate) units: Option<Vec<String>>,
    /// The rows.
    pub(crate) rows: Vec<SheetRow>,
    /// How the file was read where it is no plain CSV in UTF-8, one line each.
    pub(crate) notes: Vec<String>,
}

impl Sheet {
    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// One line: what is wrong, and where.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, String> {
        let (bytes, mut notes) = whole(bytes);
        let (original, encoding) = encoding::decode(bytes)?;
        notes.extend(encoding.map(|name| format!("read as {name} text")));
        let text = without_comments(&original);
        let (separator, text) = separator(&text)?;
        if separator != b',' {
            let name = SEPARATORS.iter().find(|known| known.0 == separator);
            notes.extend(name.map(|(_, name)| format!("cells are separated by {name}")));
        }
        let rows = split(&text, separator)?;
        let mut sheet = Self::of_rows(rows, separator)?;
        if !sheet.named
            && let Some(names) = names_in_comment(&original, &sheet, separator)
        {
            let line = sheet.rows[0].line;
            notes.push(format!(
                "the names of the columns are those of the comment above line {line}"
            ));
            (sheet.header, sheet.named) = (names, true);
        }
        notes.append(&mut sheet.notes);
        Ok(Self { notes, ..sheet })
    }

    /// Finds the header among the rows.
    fn of_rows(mut rows: Vec<SheetRow>, separator: u8) -> Result<Self, String> {
        let cells: Vec<&[String]> = rows.iter().map(|row| row.cells.as_slice()).collect();
        if rows.is_empty() {
            return Err("has no rows".to_owned());
        }
        if header::lies(&cells) {
            return Err("has its columns as rows, with the names first: turn rows into columns".to_owned());
        }
        let top = header::find(&cells).or_else(|| first_of_usual_width(&rows));
        let mut notes = Vec::new();
        let (mut header, mut units) = (Vec::new(), None);
        let named = top.is_some();
        if let Some(top) = top {
            if top.header > 0 {
                notes.push(format!(
                    "the {} lines before the header, in line {}, were left out",
                    top.header, rows[top.header].line
                ));
            }
            let mut above: Vec<SheetRow> = rows.drain(..=top.units.unwrap_or(top.header)).collect();
            units = top.units.and_then(|_| above.pop()).map(|row| row.cells);
            header = above.pop().map_or_else(Vec::new, |row| row.cells);
            repeated(&mut rows, &header, units.as_deref(), &mut notes);
            header = header.iter().map(|name| one_line(name)).collect();
            // Separators at the end of the header alone.
            while header.last().is_some_and(String::is_empty)
                && rows.iter().any(|row| row.cells.len() < header.len())
            {
                header.pop();
            }
            if let Some(units) = &mut units {
                units.resize(header.len(), String::new());
            }
        } else {
            let width = usual_width(&rows);
            if rows[0].cells.len() != width {
                let first = rows
                    .iter()
                    .find(|row| row.cells.len() == width)
                    .unwrap_or(&rows[0]);
                return Err(uneven(first, rows[0].line, rows[0].cells.len(), separator));
            }
            header.extend((1..=width).map(|column| column.to_string()));
        }
        let width = header.len();
        for row in &mut rows {
            let comment = row.cells.iter().position(|cell| cell.contains('#'));
            let beyond = row.cells.iter().skip(width).any(|cell| !cell.is_empty());
            if row.cells.len() < width || (beyond && comment.is_none_or(|at| at >= width)) {
                return Err(uneven(row, 0, width, separator));
            }
            row.cells.truncate(width);
        }
        Ok(Self {
            header,
            named,
            units,
            rows,
            notes,
        })
    }
}

/// The file without what loggers and old programs leave at its end: zero bytes of a file that was made before it was filled, and the
/// mark of the end of a text.
fn whole(bytes: &[u8]) -> (&[u8], Vec<String>) {
    let end = bytes
        .iter()
        .rposition(|byte| *byte != 0)
        .map_or(0, |last| last + 1);
    let mut notes = Vec::new();
    let mut text = bytes;
    // Text of two bytes a character has zeros elsewhere too.
    if end < bytes.len() && end > 0 && !bytes[..end].contains(&0) {
        text = &bytes[..end];
        notes.push(format!(
            "the {} zero bytes at the end of the file were left out",
            bytes.len() - end
        ));
    }
    (text.strip_suffix(b"\x1a").unwrap_or(text), notes)
}

/// The header where no names stand above numbers: the first row that is as wide as most, without a number.
fn first_of_usual_width(rows: &[SheetRow]) -> Option<Top> {
    let width = usual_width(rows);
    let header = rows.iter().position(|row| row.cells.len() == width)?;
    let words = |row: &SheetRow| row.cells.len() == width && !row.cells.iter().any(|cell| is_number(cell));
    words(&rows[header]).then(|| Top {
        header,
        units: rows.get(header + 1).filter(|row| words(row)).map(|_| header + 1),
    })
}

/// Takes rows out that are the header, or the units, again.
fn repeated(rows: &mut Vec<SheetRow>, header: &[String], units: Option<&[String]>, notes: &mut Vec<String>) {
    let is_again = |row: &SheetRow| row.cells == header || Some(row.cells.as_slice()) == units;
    if let Some(row) = rows.iter().find(|row| row.cells == header) {
        notes.push(format!(
            "the header is repeated in line {}: its rows follow the others",
            row.line
        ));
        rows.retain(|row| !is_again(row));
    }
}

/// Names in the comment right above the first row of numbers, as programs write that mark their header as one.
fn names_in_comment(text: &str, sheet: &Sheet, separator: u8) -> Option<Vec<String>> {
    let above = (sheet.rows.first()?.line as usize).checked_sub(1)?;
    let lines: Vec<&str> = text.lines().take(above).collect();
    let comment = lines.iter().rev().find(|line| !line.trim().is_empty())?.trim();
    let names = comment.trim_start_matches(['#', '%', '/']);
    let mut cells = split(names, separator).ok()?.pop()?.cells;
    if cells.len() == 1 {
        cells = names.split_whitespace().map(str::to_owned).collect();
    }
    let fits = names.len() < comment.len() && cells.len() == sheet.header.len();
    (fits && !cells.iter().any(|cell| cell.is_empty() || is_number(cell))).then_some(cells)
}

/// Why a row does not fit the width of its table.
fn uneven(row: &SheetRow, other: u64, width: usize, separator: u8) -> String {
    let found = row.cells.len();
    let of = if other > 0 {
        format!("line {other}")
    } else {
        "the header".to_owned()
    };
    let digits =
        |cell: &String| !cell.is_empty() && cell.trim_start_matches('-').bytes().all(|c| c.is_ascii_digit());
    if separator == b',' && found > width && found <= 2 * width && row.cells.iter().all(digits) {
        return format!(
            "line {} has {found} cells and {of} {width}: decimal commas and commas between cells cannot be told apart; \
             export with `;` between cells or with decimal points",
            row.line
        );
    }
    format!(
        "line {} has {found} cells and {of} {width}: complete or remove the line",
        row.line
    )
}

/// Lines that are comments, emptied, so that the others keep their numbers; and a line that names the separator.
fn without_comments(text: &str) -> String {
    text.trim_start_matches('\u{feff}')
        .lines()
        .map(|line| {
            let start = line.trim_start();
            if start.starts_with(['#', '%'])
                || start.starts_with("//")
                || start.to_lowercase().starts_with("sep=")
            {
                "\n".to_owned()
            } else {
                format!("{line}\n")
            }
        })
        .collect()
}

/// The separator that most rows agree on, and the text to split with it.
fn separator(text: &str) -> Result<(u8, String), String> {
    let mut best: Option<(usize, u8)> = None;
    for (separator, _) in SEPARATORS {
        let Ok(rows) = split(text, separator) else {
            continue;
        };
        let judged = &rows[..rows.len().min(JUDGED)];
        let width = usual_width(judged);
        let agreed = judged.iter().filter(|row| row.cells.len() == width).count();
        if width > 1 && best.is_none_or(|(most, _)| agreed > most) {
            best = Some((agreed, separator));
        }
    }
    if let Some((_, separator)) = best {
        return Ok((separator, text.to_owned()));
    }
    // Columns between blanks.
    let blanks: String = text
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join("\t") + "\n")
        .collect();
    if usual_width(&split(&blanks, b'\t')?) > 1 {
        return Ok((b'\t', blanks));
    }
    // One column: what it lacks is for its reader to say.
    Ok((b',', text.to_owned()))
}

/// The number of cells that most rows have.
fn usual_width(rows: &[SheetRow]) -> usize {
    let mut counts: Vec<(usize, usize)> = Vec::new();
    for width in rows.iter().map(|row| row.cells.len()) {
        match counts.iter_mut().find(|(known, _)| *known == width) {
            Some((_, count)) => *count += 1,
            None => counts.push((width, 1)),
        }
    }
    counts
        .iter()
        .max_by_key(|(_, count)| *count)
        .map_or(0, |(width, _)| *width)
}

/// The rows that have anything in them.
fn split(text: &str, separator: u8) -> Result<Vec<SheetRow>, String> {
    let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    // A record starts where the one before ended: at lines that are empty.
    let line = |byte: usize| {
        let blank = text[byte..].len() - text[byte..].trim_start_matches(['\n', '\r']).len();
        ends.partition_point(|&end| end < byte + blank) as u64 + 1
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| format!("not a CSV file: {}", one_line(&error.to_string())))?;
        if record.iter().any(|cell| !cell.is_empty()) {
            rows.push(SheetRow {
                line: record
                    .position()
                    .map_or(0, |position| line(position.byte() as usize)),
                cells: record.iter().map(str::to_owned).collect(),
            });
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Sheet {
        Sheet::read(text.as_bytes()).expect(text)
    }

    #[test]
    fn separators_are_recognised() {
        for (text, width) in [
            ("a,b\n1,2\n", 2),
            ("a;b\n0,1;0,2\n", 2),
            ("0,1;0,2\n0,3;0,4\n", 2),
            ("a\tb\tc\n1\t2\t\n", 3),
            ("sep=;\na;b\n1;2\n", 2),
            ("a  b\n 1    2\n", 2),
            ("a,b,\n1,2,\n", 3),
            ("a,b\n1,2,\n3,4,\n", 2),
            ("a,b,\n1,2\n3,4\n", 2),
            ("# a,b\n1,2\n3,4\n", 2),
            ("a\n1\n2\n", 1),
        ] {
            let sheet = read(text);
            assert_eq!(sheet.header.len(), width, "{text}");
            assert!(!sheet.rows.is_empty(), "{text}");
        }
    }

    #[test]
    fn lines_are_those_of_the_file() {
        let sheet = read("# one\nname,n\n\n# four\nx,1\n\"two\nlines\",2\n% nine\ny,3\n");
        let lines: Vec<u64> = sheet.rows.iter().map(|row| row.line).collect();
        assert_eq!(lines, [5, 6, 9]);
    }

    #[test]
    fn header_units_and_what_stands_before_them_are_told_apart() {
        let sheet = read(
            "Date,2026\nOperator\nDepth,Force,Pressure\nmm,N,kPa\n1,2,3 # slipped, twice\n4,5,6\n7,8,9\n",
        );
        assert_eq!(sheet.header, ["Depth", "Force", "Pressure"]);
        assert_eq!(
            sheet.units.as_deref(),
            Some(&["mm".to_owned(), "N".to_owned(), "kPa".to_owned()][..])
        );
        assert_eq!(sheet.rows.len(), 3);
        assert_eq!(sheet.rows[0].number_text(2), "3");
        assert!(!read("1,2\n3,4\n").named);
        let commented = read("# run 7\n# depth_mm force_n\n1 2\n3 4\n");
        assert_eq!(commented.header, ["depth_mm", "force_n"]);
        assert!(commented.named && commented.rows.len() == 2);
        let twice = read("a,b\n1,2\n3,4\na,b\n5,6\n\0\0\0");
        assert_eq!((twice.rows.len(), twice.notes.len()), (3, 2), "{:?}", twice.notes);
        assert_eq!(read("a,b\n1.#QNAN,2\n3,4\n").rows[0].number_text(0), "1.#QNAN");
    }

    #[test]
    fn what_cannot_be_split_is_refused_by_its_line() {
        for (text, reason) in [
            ("a,b\n1,2\n3\n", "line 3 has 1 cells and the header 2"),
            ("a,b,c\n0,1,0,2,0,3\n0,2,0,3,0,4\n", "decimal commas"),
            ("", "has no rows"),
            ("force_n,1,2,3\nindentation_mm,4,5,6\n", "turn rows into columns"),
        ] {
            let error = Sheet::read(text.as_bytes()).expect_err(text);
            assert!(error.contains(reason), "{error}");
        }
    }
}
