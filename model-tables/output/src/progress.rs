//! A bar for work that takes a while, on standard error, and only where a person watches it.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal as _;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

/// Parts of the whole that are shown.
const PARTS: u64 = 1000;

/// A bar.
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar with a name; nothing at all where standard error is no terminal.
    pub fn new(name: &'static str) -> Self {
        let target = if std::io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(PARTS), target);
        // A template that cannot be read would be the default bar, which is as good.
        if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:40}] {percent} % {elapsed}") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(name);
        Self(bar)
    }

    /// The part that is done, 0 to 1.
    pub fn set(&self, part: f64) {
        self.0.set_position((part * PARTS as f64) as u64);
    }

    /// Away with it.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// How often [`Ticks`] tells where nothing else is asked.
const EVERY: Duration = Duration::from_secs(1);

/// A line each second, or as often as asked, on standard error, terminal or not, until it is dropped.
pub struct Ticks {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Ticks {
    /// Begins; `tell` gives the line of now.
    pub fn begin(tell: impl Fn() -> String + Send + 'static) -> Self {
        Self::every(EVERY, tell)
    }

    /// The same with a line after each `interval`.
    pub fn every(interval: Duration, tell: impl Fn() -> String + Send + 'static) -> Self {
        let (stop, stopped) = mpsc::channel::<()>();
        let thread = std::thread::spawn(move || {
            while stopped.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                eprintln!("progress: {}", tell());
            }
        });
        Self {
            stop: Some(stop),
            thread: Some(thread),
        }
    }
}

impl Drop for Ticks {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A thread that only prints: it can end in no other way.
            let _ = thread.join();
        }
    }
}
