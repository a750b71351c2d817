//! Lines for whoever watches. When nobody does any more (`cargo demo | head`), the demo ends quietly.

use emulator::output;
use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};

/// Prints one line.
pub(crate) fn line(arguments: Arguments<'_>) {
    let written = writeln!(stdout(), "{arguments}");
    if written.is_err_and(|error| error.kind() == ErrorKind::BrokenPipe) {
        output::abandon();
        std::process::exit(0);
    }
}

/// `println!` that ends the demo where that one would panic.
macro_rules! say {
    ($($argument:tt)*) => { $crate::say::line(format_args!($($argument)*)) };
}
pub(crate) use say;
