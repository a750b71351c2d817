//! `designer monitor`: hands over to the program of that name, which knows the board's telemetry and this crate does not.

use super::Refusal;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

/// The workspace that this was built from.
const WORKSPACE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");

#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(super) struct Arguments {
    /// A serial port (/dev/ttyACM0) or tcp:HOST:PORT, and options: see `designer monitor --help`
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    arguments: Vec<OsString>,
}

/// Runs it in the foreground.
pub(super) fn run(arguments: &Arguments, format: Option<&str>) -> Result<ExitStatus, Refusal> {
    let mut command = program()?;
    command.args(&arguments.arguments);
    if let Some(format) = format {
        command.args(["--format", format]);
    }
    command.status().map_err(|error| {
        Refusal(format!(
            "the monitor cannot be run: {error}; build it with `cargo build --release -p monitor`"
        ))
    })
}

/// Under cargo, what cargo builds; otherwise the program beside this one.
fn program() -> Result<Command, Refusal> {
    if let Some(cargo) = std::env::var_os("CARGO").filter(|_| Path::new(WORKSPACE).is_file()) {
        let mut command = Command::new(cargo);
        command.args([
            "run",
            "--quiet",
            "--release",
            "--package",
            "monitor",
            "--manifest-path",
            WORKSPACE,
            "--",
        ]);
        return Ok(command);
    }
    let beside: Option<PathBuf> = std::env::current_exe()
        .ok()
        .map(|path| path.with_file_name(format!("monitor{}", std::env::consts::EXE_SUFFIX)))
        .filter(|path| path.is_file());
    beside.map(Command::new).ok_or_else(|| {
        Refusal(
            "the program `monitor` is not beside this one: run `cargo designer monitor`, or build it with `cargo build --release -p \
             monitor`"
                .to_owned(),
        )
    })
}
