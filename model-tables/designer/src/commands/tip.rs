//! `designer tip`: writes the data of one fingertip as a file, or shows what such a file holds.

use super::{estimate, read};
use fingertip::signal::calibration::LARGEST_GAIN;
use fingertip::signal::loaded_design::LoadedDesign;
use model_tables::block::read::{self as block_read, TipBlock};
use model_tables::block::section::SectionKind;
use model_tables::block::{MAGIC, StoredCalibration};
use model_tables::design_file::{Calibration, DesignFile};
use output::files;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

const COLUMNS: &[&str] = &[
    "file",
    "design",
    "design_hash",
    "size_bytes",
    "crc32",
    "sections",
    "certificate_hash",
];

/// No tip is so long; what is longer is another file.
const LONGEST: u64 = 1 << 20;

/// What `--help` says after the options.
pub(super) const HELP: &str = "\
--calibration reads a file that `designer fit --out` wrote: the calibrated design, or a file with only its [calibration]. The tip
then has the tables and the hash of the calibrated design.

Examples:
  cargo designer tip model-tables/designs/index-fingertip.toml --out target/tip.bin
  cargo designer tip tip.toml --calibration calibrated/tip-calibrated.toml --out target/tip.bin
  cargo designer tip target/tip.bin
  cargo designer estimate target/tip.bin --pressure-rise-pa 642,2571";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file; or, without --out, a tip file to show
    design: PathBuf,
    /// Calibration of this fingertip, written by `designer fit --out`
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Gain trim of this fingertip, parts in a million added to the pressure rise, -100000 to 100000
    #[arg(long, value_name = "PPM", allow_hyphen_values = true, value_parser = gain)]
    gain_ppm: Option<i32>,
    /// The tip file to write
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the tip even if its tables do not reach the accuracy that the design requires
    #[arg(long)]
    allow_worse: bool,
}

fn gain(text: &str) -> Result<i32, String> {
    text.parse()
        .ok()
        .filter(|gain: &i32| gain.unsigned_abs() <= LARGEST_GAIN.unsigned_abs())
        .ok_or_else(|| format!("must be a whole number from -{LARGEST_GAIN} to {LARGEST_GAIN}"))
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let found = block(file)?;
    let Some(out) = &arguments.out else {
        return match found {
            Some(block) => Ok(CommandAnswer {
                rows: rows(file, &block)?,
                notes: Vec::new(),
            }),
            None => Err(Refusal::about(
                file,
                &"--out is missing: name the tip file to write, as in --out tip.bin",
            )),
        };
    };
    if found.is_some() {
        return Err(Refusal::about(
            file,
            &"is a tip file, and --out writes one of a design: give the design file, or leave --out out",
        ));
    }
    let design = match &arguments.calibration {
        None => read(file)?,
        Some(calibration) => calibrated(file, calibration)?,
    };
    files::expect_room(out)?;
    let generated = estimate::generated(file, design, arguments.allow_worse)?;
    let block = generated.tip(arguments.gain_ppm.map(|gain| StoredCalibration {
        zero: i32::MIN,
        temperature: i32::MIN,
        coefficient: 0,
        gain,
    }));
    LoadedDesign::read(&block).map_err(|error| Refusal::about(file, &error))?;
    files::write_one(out, block.clone())?;
    let name = &generated.design.name;
    let certificate = &generated.certified.certificate;
    let mut notes = vec![format!(
        "{name}: over all {} inputs the errors stay within {:.4} % (force) and {:.4} % (indentation) of reading",
        certificate.inputs, certificate.force.of_reading.max, certificate.indentation.of_reading.max,
    )];
    notes.extend(generated.own_error().map(|error| format!("{name}: {error}")));
    Ok(CommandAnswer {
        rows: rows(out, &block)?,
        notes,
    })
}

/// The bytes of a tip file, checked; nothing for a file that does not begin as one.
pub(super) fn block(file: &Path) -> Result<Option<Vec<u8>>, Refusal> {
    let mut bytes = Vec::new();
    // What cannot be opened is a design's matter, whose reader says why.
    let read = File::open(file).and_then(|file| file.take(LONGEST).read_to_end(&mut bytes));
    if read.is_err() || !bytes.starts_with(&MAGIC) {
        return Ok(None);
    }
    files::keep(file);
    whole(file, &bytes)?;
    Ok(Some(bytes))
}

/// The bytes of a tip file, which has to be one.
pub(super) fn needed(file: &Path) -> Result<Vec<u8>, Refusal> {
    match block(file)? {
        Some(block) => Ok(block),
        None if file.is_file() => Err(Refusal::about(
            file,
            &"this is no tip file: it does not begin with FTIP; write one with `designer tip DESIGN --out tip.bin`",
        )),
        None => Err(Refusal::about(
            file,
            &"there is no such file; write one with `designer tip DESIGN --out tip.bin`",
        )),
    }
}

/// Refuses what a hand would refuse, and bytes behind the block, which no tip file has.
fn whole(file: &Path, bytes: &[u8]) -> Result<(), Refusal> {
    LoadedDesign::read(bytes)
        .map_err(|error| Refusal::about(file, &format!("{error}; write it anew with `designer tip`")))?;
    match block_read::stated(bytes) {
        Some((length, _)) if length as usize == bytes.len() => Ok(()),
        _ => Err(Refusal::about(
            file,
            &format!(
                "the file has {} bytes, more than its tip's data; write it anew with `designer tip`",
                bytes.len()
            ),
        )),
    }
}

/// What a tip file holds, on one row.
fn rows(file: &Path, block: &[u8]) -> Result<Rows, Refusal> {
    let tip = TipBlock::read(block).map_err(|error| Refusal::about(file, &error))?;
    let (_, check) = block_read::stated(block).unwrap_or_default();
    let sections: Vec<&str> = tip.sections().map(SectionKind::word).collect();
    let mut rows = Rows::new(COLUMNS);
    rows.push(vec![
        Cell::Text(file.display().to_string()),
        Cell::Text(tip.name.to_owned()),
        Cell::Text(format!("{:016x}", tip.constants.hash)),
        Cell::Count(block.len()),
        Cell::Text(format!("{check:08x}")),
        Cell::Text(sections.join(" ")),
        Cell::Text(format!("{:016x}", tip.constants.certificate)),
    ]);
    Ok(rows)
}

/// The design with a calibration: of a calibrated design of the same fingertip, or of a file with `[calibration]` alone.
fn calibrated(design: &Path, calibration: &Path) -> Result<DesignFile, Refusal> {
    let drawn = read(design)?;
    files::keep(calibration);
    let refuse = |reason: &str| Refusal::about(calibration, &reason);
    let text = std::fs::read_to_string(calibration)
        .map_err(|error| refuse(&format!("the calibration cannot be read: {error}")))?;
    let mut document: DocumentMut = text
        .parse()
        .map_err(|error| refuse(&format!("{error}").replace('\n', " ")))?;
    let section = document
        .remove("calibration")
        .ok_or_else(|| refuse("has no [calibration]: give what `designer fit --out` wrote"))?;
    if document.is_empty() {
        let text = std::fs::read_to_string(design).map_err(|error| Refusal::about(design, &error))?;
        let mut document: DocumentMut = text
            .parse()
            .map_err(|error| Refusal::about(design, &format!("{error}").replace('\n', " ")))?;
        document.insert("calibration", section);
        let merged = document.to_string();
        return DesignFile::parse(&merged, &calibration.display().to_string()).map_err(Refusal::of);
    }
    let found = read(calibration)?;
    // What `fit --from-data` sets anew is the calibrated design's.
    let same = DesignFile {
        calibration: Calibration::default(),
        max_indentation_mm: drawn.max_indentation_mm,
        accuracy: drawn.accuracy,
        ..found.clone()
    };
    let drawn_anew = DesignFile {
        calibration: Calibration::default(),
        ..drawn
    };
    if same != drawn_anew {
        return Err(refuse(&format!(
            "is the calibration of another design than {}: they differ in more than [calibration], [press] and [accuracy]; give the \
             design that was fitted",
            design.display()
        )));
    }
    Ok(found)
}
