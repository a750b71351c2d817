//! The `designer` command line: one module a subcommand.
//!
//! Exit status 0 only if everything asked for was given. Otherwise one line on standard error that names what
//! was asked, the limit or the key, and the remedy; nothing on standard output, nothing half-written left behind.

mod actuator;
mod at_force;
mod bench;
mod calibration;
mod estimate;
mod estimate_in_time;
mod feedback_loop;
mod fit;
mod history;
mod load;
mod materials;
mod model;
mod monitor;
mod numbers;
mod profile;
mod published;
mod report;
mod rest;
mod size;
mod solve;
mod sweep;
mod table;
mod time_rows;
mod tip;

use crate::table_text::one_line;
use clap::builder::PossibleValue;
use clap::error::ErrorKind;
use clap::{CommandFactory as _, Parser, Subcommand, ValueEnum};
use model_tables::design_file::DesignFile;
use model_tables::material::stability::Margin;
use model_tables::membrane::TensionField;
use output::rows::Format;
use output::{CommandAnswer, Refusal, files};
use std::fmt::Display;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// Solves fingertip designs and makes their tables.
#[derive(Debug, Parser)]
#[command(name = "designer", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// How rows are printed [default: table on a terminal, csv otherwise]
    #[arg(long, global = true)]
    format: Option<Format>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Computes the rest state and the limits of a design
    #[command(after_help = "Example:\n  cargo designer rest model-tables/designs/index-fingertip.toml")]
    Rest {
        /// The design file
        design: PathBuf,
    },
    /// Solves pressed states of a design, one row each, in the order given
    #[command(
        after_help = "Example:\n  cargo designer solve model-tables/designs/index-fingertip.toml --indentation-mm 0.2,0.5,1.0 --format csv"
    )]
    Solve(solve::Arguments),
    /// Solves a press in time of a wall that relaxes: pressure, force and shape at given times
    #[command(after_help = "Example:\n  cargo designer history my.toml --history grasp.csv --format csv")]
    History(history::Arguments),
    /// Prints shape, stretches and tensions of one state along the meridian, from the pole to the equator
    #[command(after_long_help = profile::COLUMN_HELP)]
    Profile(profile::Arguments),
    /// Writes the tables of a design: Rust source, binary, CSV, and the certificate
    #[command(
        after_help = "Example:\n  cargo designer table model-tables/designs/index-fingertip.toml --out target/tables"
    )]
    Table(table::Arguments),
    /// Writes or shows a tip file: all data of one fingertip, to be loaded without a compiler
    #[command(after_help = tip::HELP)]
    Tip(tip::Arguments),
    /// Loads a tip file onto a board over its serial port, returns to the previous tip, or reads the tip in use back
    #[command(after_help = load::HELP)]
    Load(load::Arguments),
    /// Writes one page with everything about a design: HTML that needs no network
    #[command(
        after_help = "Example:\n  cargo designer report model-tables/designs/index-fingertip.toml --out target/report"
    )]
    Report(report::Arguments),
    /// Charts speed against accuracy of every method and of the models: SVG and CSV
    #[command(after_help = "Example:\n  cargo designer chart paper --out target/chart")]
    Chart(compare::chart::ChartArguments),
    /// Maps over designs where each method answers, refuses or is silently wrong, and the time for a state
    #[command(after_help = "Example:\n  cargo designer atlas --stride 4 --out target/atlas")]
    Atlas(compare::robustness_map::RobustnessMapArguments),
    /// Compares the models over random walls: error against time, and the choice of `model.kind = "auto"`
    #[command(after_help = "Example:\n  cargo designer ladder --designs 50 --out target/ladder")]
    Ladder(compare::ladder::LadderArguments),
    /// Computes the readings of the chip at given pressure rises, bit for bit
    #[command(
        after_help = "Example:\n  cargo designer estimate model-tables/designs/index-fingertip.toml --pressure-rise-pa 642,2571"
    )]
    Estimate(estimate::Arguments),
    /// Solves the feedback membrane: contact diameter, blocked force and volume change at gauge pressures
    #[command(after_help = "Example:\n  cargo designer actuator my.toml --pressure-kpa 5,17.9")]
    Actuator(actuator::Arguments),
    /// Solves fingertip and feedback membrane together: touch force and the feedback force on the wearer
    #[command(after_help = "Example:\n  cargo designer loop my.toml --indentation-mm 0.5,1.0,2.0")]
    Loop(feedback_loop::Arguments),
    /// Calibrates a design to bench data
    #[command(after_help = fit::HELP)]
    Fit(fit::Arguments),
    /// Measures what a calibration gains, on synthetic devices
    #[command(after_help = "Example:\n  cargo designer calibration --out model-tables/CALIBRATION.md")]
    Calibration(calibration::Arguments),
    /// Finds designs for a wanted force over the indentation, or for a job
    #[command(after_help = size::HELP)]
    Size(size::Arguments),
    /// Solves many designs to Parquet: grids, Latin hypercubes, Sobol sequences; resumable, in shards
    #[command(after_help = sweep::HELP)]
    Sweep(sweep::Arguments),
    /// Lists the materials that a design can name, with the sources of their constants
    #[command(
        after_help = "Example:\n  cargo designer materials --format json\n\nIn a design: [material] preset = \"ecoflex-00-30\""
    )]
    Materials,
    /// Prints completions for a shell
    ///
    /// For example: cargo designer completions bash > ~/.local/share/bash-completion/completions/designer
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Shows live readings of a board, from its serial port or the emulated board's socket
    Monitor(monitor::Arguments),
    /// Compares the source paper's numbers with the results from its stated inputs
    #[command(after_help = "Example:\n  cargo designer published --out model-tables/PUBLISHED.md")]
    Published(published::Arguments),
}

/// Behaviour of the membrane under compression.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Field {
    /// It wrinkles or goes slack
    Relaxed,
    /// It carries compression, as in the paper
    Plain,
}

impl From<Field> for TensionField {
    fn from(field: Field) -> Self {
        match field {
            Field::Relaxed => Self::Relaxed,
            Field::Plain => Self::Plain,
        }
    }
}

/// Reads the arguments, runs the subcommand, prints its answer.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            return match error.print() {
                // A reader of help may stop reading.
                Err(reason) if reason.kind() != std::io::ErrorKind::BrokenPipe => {
                    refuse(&format!("standard output did not take the help: {reason}"))
                }
                _ => ExitCode::SUCCESS,
            };
        }
        Err(error) => return refuse(&usage(&error)),
    };
    if let Command::Monitor(monitor) = &arguments.command {
        let format = arguments.format.as_ref().and_then(ValueEnum::to_possible_value);
        return monitor::run(monitor, format.as_ref().map(PossibleValue::get_name));
    }
    files::clear_away_on_interrupt();
    let format = arguments.format.unwrap_or(if std::io::stdout().is_terminal() {
        Format::Table
    } else {
        Format::Csv
    });
    match run(&arguments.command, format) {
        Ok(notes) => {
            for remark in REMARKS.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
                eprintln!("{remark}");
            }
            for note in notes {
                eprintln!("note: {note}");
            }
            ExitCode::SUCCESS
        }
        Err(Refusal(reason)) => refuse(&reason),
    }
}

/// Runs the subcommand and prints its answer; gives its notes.
fn run(command: &Command, format: Format) -> Result<Vec<String>, Refusal> {
    let CommandAnswer { rows, notes } = match command {
        Command::Rest { design } => rest::run(design),
        Command::Solve(arguments) => solve::run(arguments),
        Command::History(arguments) => history::run(arguments),
        Command::Profile(arguments) => profile::run(arguments),
        Command::Table(arguments) => table::run(arguments),
        Command::Tip(arguments) => tip::run(arguments),
        Command::Load(arguments) => load::run(arguments),
        Command::Report(arguments) => report::run(arguments),
        Command::Chart(arguments) => compare::chart::run(arguments),
        Command::Atlas(arguments) => compare::robustness_map::run(arguments),
        Command::Ladder(arguments) => compare::ladder::run(arguments),
        Command::Estimate(arguments) => estimate::run(arguments),
        Command::Actuator(arguments) => actuator::run(arguments),
        Command::Loop(arguments) => feedback_loop::run(arguments),
        Command::Fit(arguments) => fit::run(arguments),
        Command::Calibration(arguments) => calibration::run(arguments),
        Command::Size(arguments) => size::run(arguments),
        Command::Sweep(arguments) => sweep::run(arguments),
        Command::Materials => Ok(materials::run()),
        Command::Published(arguments) => published::run(arguments),
        Command::Completions { shell } => return completions(*shell),
        // Handed over before.
        Command::Monitor(_) => return Ok(Vec::new()),
    }?;
    print(&rows.print(format).map_err(Refusal)?)?;
    Ok(notes)
}

/// Prints a shell's completions; they are no rows.
fn completions(shell: clap_complete::Shell) -> Result<Vec<String>, Refusal> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "designer", &mut text);
    print(&String::from_utf8_lossy(&text))?;
    Ok(Vec::new())
}

fn print(text: &str) -> Result<(), Refusal> {
    let mut stdout = std::io::stdout();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(|error| Refusal(format!("standard output took only a part of the answer: {error}")))
}

/// Lines about an answer, printed once it is given: a refusal is one line alone.
static REMARKS: Mutex<Vec<String>> = Mutex::new(Vec::new());

fn remark(line: String) {
    REMARKS.lock().unwrap_or_else(PoisonError::into_inner).push(line);
}

/// One line of warning on standard error, about an answer that is given.
fn warn(file: &Path, warning: &dyn Display) {
    remark(format!("warning: {}: {warning}", file.display()));
}

/// Warns where the law is not stable over a state, `which` of them in words.
fn warn_of_instability(file: &Path, which: &str, margin: Margin) {
    if !margin.is_stable() {
        warn(
            file,
            &format_args!(
                "{which} the law is not stable at stretches of {:.4} along and {:.4} around ({}): the state is at best \
                 one of several; fit the law up to such stretches",
                margin.meridional_stretch, margin.hoop_stretch, margin.mode
            ),
        );
    }
}

fn refuse(reason: &str) -> ExitCode {
    eprintln!("error: {reason}");
    ExitCode::FAILURE
}

/// What is wrong with the arguments, on one line.
fn usage(error: &clap::Error) -> String {
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let names: Vec<String> = Arguments::command()
            .get_subcommands()
            .map(|subcommand| subcommand.get_name().to_owned())
            .collect();
        return format!(
            "a subcommand is needed: {} (see `designer --help`)",
            names.join(", ")
        );
    }
    let text = error.to_string();
    let mut parts = text.split("\n\n").map(one_line);
    let what = parts.next().unwrap_or_default();
    // What clap takes a misspelt name for.
    let tip = parts
        .find_map(|part| part.strip_prefix("tip: ").map(|tip| format!("; {tip}")))
        .unwrap_or_default();
    format!(
        "{}{tip} (see `designer --help`)",
        what.trim_start_matches("error: ")
    )
}

/// A solid has no tension field.
fn refuse_plain(file: &Path, field: Field) -> Result<(), Refusal> {
    match field {
        Field::Relaxed => Ok(()),
        Field::Plain => Err(Refusal::about(
            file,
            &"--tension-field plain is for membranes, model.kind is \"solid\": leave the option out",
        )),
    }
}

fn read(design: &Path) -> Result<DesignFile, Refusal> {
    files::keep(design);
    let file = DesignFile::read(design).map_err(Refusal::of)?;
    let axes = &file.membrane;
    if axes.axial_semi_axis_mm > axes.radial_semi_axis_mm {
        remark(format!(
            "note: {}: membrane.axial_semi_axis_mm, {}, is more than radial_semi_axis_mm, {}: a dome that is higher than it is \
             wide; are the two swapped?",
            design.display(),
            axes.axial_semi_axis_mm,
            axes.radial_semi_axis_mm
        ));
    }
    Ok(file)
}
