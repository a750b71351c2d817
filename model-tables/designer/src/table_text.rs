//! Tables of numbers as CSV text, as bench programs write them.

/// A reader of text with blanks around its cells and comments after `#`.
pub(crate) fn reader(text: &str) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes())
}

/// The names of the columns, without a byte order mark.
///
/// # Errors
/// What is wrong with the first line.
pub(crate) fn header(reader: &mut csv::Reader<&[u8]>) -> csv::Result<Vec<String>> {
    let names = reader.headers()?.iter();
    Ok(names
        .map(|name| name.trim_start_matches('\u{feff}').to_owned())
        .collect())
}

/// A message of several lines as one.
pub(crate) fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
