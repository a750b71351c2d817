//! The `designer` command: everything is in [`model_tables::designer`].

use std::process::ExitCode;

fn main() -> ExitCode {
    model_tables::designer::main()
}
