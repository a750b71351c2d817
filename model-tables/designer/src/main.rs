//! The `designer` command: everything is in [`designer::commands`].

use std::process::ExitCode;

fn main() -> ExitCode {
    designer::commands::main()
}
