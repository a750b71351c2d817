//! Bytes of a file -> text.

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Files that people take for tables, by their first bytes.
const OTHER_FILES: [(&[u8], &str); 5] = [
    (
        b"PK\x03\x04",
        "an Excel or OpenDocument workbook, or a zip archive",
    ),
    (b"\xd0\xcf\x11\xe0", "an old Excel workbook"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x89HDF", "an HDF5 or MATLAB file"),
];
/// Texts that people take for tables, by their first characters.
const OTHER_TEXTS: [(&str, &str); 4] = [
    ("<", "HTML or XML"),
    ("{", "JSON"),
    ("[{", "JSON"),
    ("[[", "JSON"),
];
/// Bytes at which a file without a byte order mark is looked at.
const LOOKED_AT: usize = 4096;

/// The text, and the name of its encoding where that is not UTF-8.
///
/// # Errors
/// One line: what the file is in place of text.
pub(super) fn decode(bytes: &[u8]) -> Result<(String, Option<&'static str>), String> {
    if let Some((_, what)) = OTHER_FILES.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(format!("is {what}, not text: export the table as CSV"));
    }
    let encoding = Encoding::for_bom(bytes).map_or_else(|| without_mark(bytes), |(encoding, _)| encoding);
    let (text, _, broken) = encoding.decode(bytes);
    if broken || text.contains('\0') {
        return Err(format!(
            "is not text: its bytes are no {}; export the table as CSV",
            encoding.name()
        ));
    }
    let start = text.trim_start_matches('\u{feff}').trim_start();
    if let Some((_, what)) = OTHER_TEXTS.iter().find(|(first, _)| start.starts_with(first)) {
        return Err(format!(
            "is {what}, not a table of cells: export the table as CSV"
        ));
    }
    let name = (encoding != UTF_8).then(|| {
        if encoding == WINDOWS_1252 {
            "Latin-1"
        } else {
            encoding.name()
        }
    });
    Ok((text.into_owned(), name))
}

/// The encoding of bytes without a byte order mark: UTF-16 has every other byte zero, Latin-1 is what is no UTF-8.
fn without_mark(bytes: &[u8]) -> &'static Encoding {
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let zeros = |first: usize| {
        start
            .iter()
            .skip(first)
            .step_by(2)
            .filter(|byte| **byte == 0)
            .count()
    };
    let (even, odd) = (zeros(0), zeros(1));
    if 5 * odd > start.len() && even == 0 {
        UTF_16LE
    } else if 5 * even > start.len() && odd == 0 {
        UTF_16BE
    } else if std::str::from_utf8(bytes).is_ok() {
        UTF_8
    } else {
        WINDOWS_1252
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_the_same_in_every_encoding() {
        const TEXT: &str = "Tiefe (\u{b5}m);Kraft (N)\n1;2\n";
        let sixteen = |of: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
            let mark = mark.then_some(0xfeff);
            mark.into_iter().chain(TEXT.encode_utf16()).flat_map(of).collect()
        };
        let latin: Vec<u8> = TEXT.chars().map(|c| u32::from(c) as u8).collect();
        for (bytes, name) in [
            (TEXT.as_bytes().to_vec(), None),
            ([b"\xef\xbb\xbf", TEXT.as_bytes()].concat(), None),
            (latin, Some("Latin-1")),
            (sixteen(u16::to_le_bytes, true), Some("UTF-16LE")),
            (sixteen(u16::to_be_bytes, true), Some("UTF-16BE")),
            (sixteen(u16::to_le_bytes, false), Some("UTF-16LE")),
            (sixteen(u16::to_be_bytes, false), Some("UTF-16BE")),
        ] {
            assert_eq!(decode(&bytes), Ok((TEXT.to_owned(), name)));
        }
    }

    #[test]
    fn what_is_no_text_is_named() {
        for (bytes, reason) in [
            (&b"PK\x03\x04\x14\0"[..], "an Excel or OpenDocument workbook"),
            (&b"MATLAB 5.0 MAT-file"[..], "a MATLAB file"),
            (&b"a,b\n1,\0\0\0\n"[..], "is not text"),
            (&b"<html><table>"[..], "is HTML or XML"),
            (&b" [{\"force_n\": 1}]"[..], "is JSON"),
        ] {
            assert!(decode(bytes).expect_err("no text").contains(reason));
        }
    }
}
