//! Which instructions of an image are a function's, inlined: as its debug information has it.

use crate::image::{Image, ImageError};
use addr2line::gimli::{Dwarf, EndianSlice, Error, LittleEndian, SectionId};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind};

/// The addresses of the instructions of the functions in `chain`, by owner and name as for [`Image::function`], each inlined in
/// the next; increasing.
///
/// What the compiler puts aside on the stack for them is among them: it gives a reload the place in the source of the
/// instruction that it is for.
///
/// # Errors
/// [`ImageError`] when there are none, or no debug information.
pub fn find(image: &Image, chain: &[(&str, &str)]) -> Result<Vec<u64>, ImageError> {
    let file = image.file()?;
    let section = |id: SectionId| -> Result<_, Error> {
        let data = file.section_by_name(id.name()).map(|section| section.data());
        Ok(EndianSlice::new(
            data.and_then(Result::ok).unwrap_or_default(),
            LittleEndian,
        ))
    };
    let debug = |error: Error| ImageError::Debug(error.to_string());
    let context = Dwarf::load(section)
        .and_then(addr2line::Context::from_dwarf)
        .map_err(debug)?;
    let mut own = Vec::new();
    for address in instructions(image)? {
        let mut wanted = chain.iter().peekable();
        let mut frames = context.find_frames(address).skip_all_loads().map_err(debug)?;
        while let (Some((owner, name)), Some(frame)) = (wanted.peek(), frames.next().map_err(debug)?) {
            let path = frame.function.and_then(|function| {
                let mangled = function.raw_name().ok()?.into_owned();
                Some(format!("{:#}", rustc_demangle::demangle(&mangled)))
            });
            if path.is_some_and(|path| path.contains(owner) && path.ends_with(&format!("::{name}"))) {
                wanted.next();
            }
        }
        if wanted.peek().is_none() {
            own.push(address);
        }
    }
    if own.is_empty() {
        let name: Vec<String> = chain
            .iter()
            .map(|(owner, name)| format!("{owner} .. {name}"))
            .collect();
        return Err(ImageError::Symbol {
            name: name.join(" in "),
            found: 0,
        });
    }
    Ok(own)
}

/// The address of every instruction of the image, increasing; the symbols `$t` and `$d` say where code and data begin (ELF for
/// the Arm architecture, 5.5.5).
fn instructions(image: &Image) -> Result<Vec<u64>, ImageError> {
    let file = image.file()?;
    let mut marks: Vec<(u64, bool)> = file
        .symbols()
        .filter_map(|symbol| {
            let name = symbol.name().ok()?;
            let is = |mark: &str| name == mark || name.starts_with(&format!("{mark}."));
            (is("$t") || is("$d")).then(|| (symbol.address() & !1, is("$t")))
        })
        .collect();
    marks.sort_unstable();
    let mut code = Vec::new();
    for section in file
        .sections()
        .filter(|section| section.kind() == SectionKind::Text)
    {
        let bytes = section.data().map_err(|error| image.malformed(error))?;
        let halfwords: Vec<u16> = bytes
            .chunks_exact(2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
            .collect();
        let mut at = 0;
        while at < halfwords.len() {
            let address = section.address() + 2 * at as u64;
            let mark = marks.partition_point(|&(from, _)| from <= address);
            if mark == 0 || !marks[mark - 1].1 {
                at += 1;
                continue;
            }
            code.push(address);
            at += if is_wide(halfwords[at]) { 2 } else { 1 };
        }
    }
    code.sort_unstable();
    Ok(code)
}

/// Whether an instruction has a second half (ARMv7-M ARM A5.1).
fn is_wide(first: u16) -> bool {
    first >> 11 >= 0b11101
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Encodings from the manual's diagrams: `ldr.w r9, [sp, #60]`, `umull r4, r5, r1, r1`, `str r4, [sp, #60]`, `b`.
    #[test]
    fn tells_wide_instructions() {
        assert!(is_wide(0xf8dd) && is_wide(0xfba1) && !is_wide(0x940f) && !is_wide(0xe7fe));
    }
}
