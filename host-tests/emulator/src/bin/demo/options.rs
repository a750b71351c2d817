//! The command line of `cargo demo`.

use clap::Parser;
use emulator::fingertip_design::{default_path, workspace};
use emulator::scenario::Scenario;
use std::path::PathBuf;
use std::process::ExitCode;

/// Runs the real firmware image on an emulated STM32 while a plate presses the fingertip, and shows what it
/// reports beside the truth. No board is needed.
#[derive(Debug, Parser)]
#[command(
    name = "cargo demo",
    bin_name = "cargo demo",
    version,
    after_help = "Examples:\n  cargo demo\n  cargo demo --scenario regrasp\n  cargo demo --scenario staircase --design my.toml --out demo\n  \
                  cargo demo --serve 127.0.0.1:4000    (and in another terminal: cargo designer monitor tcp:127.0.0.1:4000)"
)]
struct Arguments {
    /// Design file of the fingertip [default: the scenario's own, `FINGERTIP_DESIGN`, or the index fingertip]
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    /// Scenario: a name in host-tests/scenarios, or a file
    #[arg(long, value_name = "NAME", default_value = "press-hold-release")]
    scenario: String,
    /// Folder for the chart and the CSV file [default: target/demo]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// CSV file [default: in the folder of --out]
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Serve the board's serial line at this address instead; the scenario repeats until Ctrl-C
    #[arg(long, value_name = "HOST:PORT", conflicts_with_all = ["out", "csv"])]
    serve: Option<String>,
}

/// What to do.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// The design file asked for.
    design: Option<PathBuf>,
    /// The scenario's name or file.
    pub(crate) scenario: String,
    /// Where the chart goes.
    pub(crate) chart: PathBuf,
    /// Where the CSV file goes.
    pub(crate) csv: PathBuf,
    /// Where the serial wire is served instead.
    pub(crate) serve: Option<String>,
}

impl Options {
    /// The design file: the one asked for, else the scenario's own, else the default.
    pub(crate) fn design(&self, scenario: &Scenario) -> PathBuf {
        let own = scenario.design.as_ref().map(|design| workspace().join(design));
        self.design.clone().or(own).unwrap_or_else(default_path)
    }
}

/// The options given, or the exit code after saying in one line what is wrong with them.
pub(crate) fn parse() -> Result<Options, ExitCode> {
    let arguments = Arguments::try_parse().map_err(|error| {
        if error.use_stderr() {
            // The first line says it; the rest is usage, which `--help` prints.
            let text = error.to_string();
            eprintln!(
                "{} (see `cargo demo --help`)",
                text.lines().next().unwrap_or_default()
            );
            ExitCode::FAILURE
        } else {
            print!("{error}");
            ExitCode::SUCCESS
        }
    })?;
    let out = arguments
        .out
        .unwrap_or_else(|| workspace().canonicalize().unwrap_or_default().join("target/demo"));
    let stem = PathBuf::from(&arguments.scenario);
    let stem = stem
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    Ok(Options {
        design: arguments.design,
        scenario: arguments.scenario,
        serve: arguments.serve,
        chart: out.join(format!("{stem}.svg")),
        csv: arguments.csv.unwrap_or_else(|| out.join(format!("{stem}.csv"))),
    })
}
