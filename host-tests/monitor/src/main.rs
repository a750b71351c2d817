//! The monitor as a program of its own; `designer monitor` is the same.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    monitor::command::main(std::env::args_os())
}
