//! `designer table`: writes the tables of a design.

use super::estimate::refusal;
use super::rows::{Cell, Rows};
use super::{Answer, Refusal};
use crate::generate::from_design_file;
use std::fs;
use std::path::{Path, PathBuf};

const COLUMNS: &[&str] = &["file", "size_bytes"];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// The folder to write to; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<Answer, Refusal> {
    let file = &arguments.design;
    let generated = from_design_file(file).map_err(|error| refusal(file, error))?;
    let contents: [(&str, Vec<u8>); 4] = [
        ("tables.rs", generated.rust_source().into_bytes()),
        ("tables.bin", generated.binary()),
        ("tables.csv", generated.csv().into_bytes()),
        ("certificate.toml", generated.certificate().into_bytes()),
    ];
    write_all(&arguments.out, &contents)?;
    let mut rows = Rows::new(COLUMNS);
    for (name, content) in &contents {
        rows.push(vec![
            Cell::Text(arguments.out.join(name).display().to_string()),
            Cell::Count(content.len()),
        ]);
    }
    let certificate = &generated.certified.certificate;
    let notes = vec![format!(
        "{}: {} bytes of tables; over all {} inputs the errors stay within {:.4} % (force) and {:.4} % \
         (indentation) of reading",
        generated.design.name,
        generated.certified.tables.bytes(),
        certificate.inputs,
        certificate.force.of_reading.max,
        certificate.indentation.of_reading.max,
    )];
    Ok(Answer { rows, notes })
}

/// Writes every file beside its place first, then moves them all in; on failure removes what it wrote.
pub(super) fn write_all(folder: &Path, contents: &[(&str, Vec<u8>)]) -> Result<(), Refusal> {
    let cannot = |path: &Path, error: std::io::Error| {
        Refusal(format!(
            "{} cannot be written: {error}; choose another --out",
            path.display()
        ))
    };
    fs::create_dir_all(folder).map_err(|error| cannot(folder, error))?;
    let places: Vec<(PathBuf, PathBuf)> = contents
        .iter()
        .map(|(name, _)| {
            let temporary = format!(".{name}.{}", std::process::id());
            (folder.join(temporary), folder.join(name))
        })
        .collect();
    let written = places
        .iter()
        .zip(contents)
        .try_for_each(|((temporary, _), (_, content))| {
            fs::write(temporary, content).map_err(|error| cannot(temporary, error))
        })
        .and_then(|()| {
            places.iter().try_for_each(|(temporary, place)| {
                fs::rename(temporary, place).map_err(|error| cannot(place, error))
            })
        });
    if written.is_err() {
        for (temporary, _) in &places {
            // What was moved or never written is not there any more.
            let _ = fs::remove_file(temporary);
        }
    }
    written
}
