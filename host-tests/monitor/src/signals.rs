//! Signals that end the program: the terminal is put right and rows stay whole, also while nobody reads the output.

use ratatui::crossterm::terminal;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGQUIT};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::process::{self, ExitCode};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

#[cfg(unix)]
const ENDING: [i32; 4] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [SIGINT, SIGTERM];
/// How long the program may take to end by itself.
const PATIENCE: Duration = Duration::from_secs(1);
/// From one look to the next.
const LOOK: Duration = Duration::from_millis(50);

/// Whether a signal asked for the end.
#[derive(Clone, Debug)]
pub(crate) struct Ending(Arc<AtomicUsize>);

impl Ending {
    /// Listens from now on. A program that does not end by itself within a second (nobody reads its output) is ended.
    pub(crate) fn listen() -> io::Result<Self> {
        let signal = Arc::new(AtomicUsize::new(0));
        for one in ENDING {
            flag::register_usize(one, Arc::clone(&signal), one.unsigned_abs() as usize)?;
        }
        let ending = Self(signal);
        let watched = ending.clone();
        thread::spawn(move || {
            while !watched.asked() {
                thread::sleep(LOOK);
            }
            thread::sleep(PATIENCE);
            // Harmless where the terminal was never changed.
            let _ = terminal::disable_raw_mode();
            process::exit(watched.status());
        });
        Ok(ending)
    }

    pub(crate) fn asked(&self) -> bool {
        self.0.load(Ordering::Relaxed) != 0
    }

    /// 0 after Ctrl-C, which is how a watch without an end is ended; else 128 and the signal's number, as shells have it.
    fn status(&self) -> i32 {
        match i32::try_from(self.0.load(Ordering::Relaxed)) {
            Ok(0 | SIGINT) => 0,
            Ok(signal) => 128 + signal,
            Err(_) => 1,
        }
    }

    /// The same for the end of `main`.
    pub(crate) fn exit_code(&self) -> ExitCode {
        u8::try_from(self.status()).map_or(ExitCode::FAILURE, ExitCode::from)
    }
}
