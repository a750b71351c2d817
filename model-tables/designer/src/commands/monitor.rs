//! `designer monitor`: hands its arguments to the package of that name, which knows the board's telemetry.

use std::ffi::OsString;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(super) struct Arguments {
    /// A serial port (/dev/ttyACM0) or tcp:HOST:PORT, and options: see `designer monitor --help`
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    arguments: Vec<OsString>,
}

/// Runs it, `format` being the option of all subcommands.
pub(super) fn run(arguments: &Arguments, format: Option<&str>) -> ExitCode {
    let mut all = vec![OsString::from("designer monitor")];
    all.extend(arguments.arguments.iter().cloned());
    if let Some(format) = format {
        all.extend(["--format".into(), format.into()]);
    }
    monitor::command::main(all)
}
