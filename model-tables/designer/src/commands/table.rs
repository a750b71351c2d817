//! `designer table`: writes the tables of a design.

use super::{estimate, read};
use output::files;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;
use std::time::Instant;

const COLUMNS: &[&str] = &["file", "size_bytes"];
/// The files, the certificate last: it vouches for the others.
const FILES: [&str; 4] = ["tables.rs", "tables.bin", "tables.csv", "certificate.toml"];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// Folder for the files; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Write the tables even if they do not reach the accuracy that the design requires
    #[arg(long)]
    allow_worse: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design = read(file)?;
    files::expect_folder(&arguments.out, &FILES)?;
    let begun = Instant::now();
    let generated = estimate::generated(file, design, arguments.allow_worse)?;
    let seconds = begun.elapsed().as_secs_f64();
    let contents: [(&str, Vec<u8>); 4] = [
        (FILES[0], generated.rust_source().into_bytes()),
        (FILES[1], generated.binary()),
        (FILES[2], generated.csv().into_bytes()),
        (FILES[3], generated.certificate().into_bytes()),
    ];
    files::write_all(&arguments.out, &contents)?;
    let mut rows = Rows::new(COLUMNS);
    for (name, content) in &contents {
        rows.push(vec![
            Cell::Text(arguments.out.join(name).display().to_string()),
            Cell::Count(content.len()),
        ]);
    }
    let certificate = &generated.certified.certificate;
    let name = &generated.design.name;
    let mut notes = vec![
        format!(
            "{name}: {} bytes of tables; over all {} inputs the errors stay within {:.4} % (force) and {:.4} % \
             (indentation) of reading",
            generated.certified.tables.bytes(),
            certificate.inputs,
            certificate.force.of_reading.max,
            certificate.indentation.of_reading.max,
        ),
        format!("{name}: {}", generated.choice()),
    ];
    notes.extend(generated.certified.feedback.as_ref().map(|feedback| {
        format!(
            "{name}: {} bytes more for the feedback force, within {:.4} % of reading",
            feedback.bytes(),
            feedback.errors.of_reading.max
        )
    }));
    notes.extend(
        generated
            .chip_series
            .iter()
            .map(|series| format!("{name}: {series}")),
    );
    notes.extend([format!("{name}: solved, fitted and certified in {seconds:.1} s")]);
    notes.extend(generated.band.iter().map(|band| format!("{name}: {band}")));
    notes.extend(generated.own_error().map(|error| format!("{name}: {error}")));
    Ok(CommandAnswer { rows, notes })
}
