//! `designer load`: a tip file onto a hand, back to what was before, or read back.

use super::tip;
use model_tables::block::read::TipBlock;
use monitor::link::{Address, BAUD, Link, LinkEvent, SILENCE, silence};
use monitor::load::{LoadJob, Loaded, Loading};
use output::files;
use output::progress::Ticks;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const COLUMNS: &[&str] = &["action", "tip", "design_hash", "size_bytes", "seconds"];

/// From one look at the time to the next.
const LOOK: Duration = Duration::from_millis(2);

/// What `--help` says after the options.
pub(super) const HELP: &str = "\
The firmware must be built with the feature load-tip. The load ends with a restart of the board. After it, the new tip is in use, with a
new zero. If the line breaks during a load, the command waits until it is back and continues.

--tip is the name of the tip on a hand (thumb, index), or its number. A board with one tip needs none, and takes 0 or the name of the
design in the file. The other tips of a hand keep their zeros.

Examples:
  cargo designer load /dev/ttyACM0 tip.bin --tip 0
  cargo designer load /dev/ttyACM0 tip.bin --tip index --baud 1000000
  cargo designer load tcp:127.0.0.1:4000 tip.bin --tip index-fingertip
  cargo designer load /dev/ttyACM0 --roll-back
  cargo designer load /dev/ttyACM0 --read-back in-use.bin";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT
    port: Address,
    /// The tip file that `designer tip` wrote
    #[arg(required_unless_present_any = ["roll_back", "read_back"], conflicts_with_all = ["roll_back", "read_back"])]
    file: Option<PathBuf>,
    /// Tip of the board: its name on a hand, its number, or the name of the design in the file
    #[arg(long = "tip", value_name = "NAME")]
    name: Option<String>,
    /// Return to the tip that was in use before the last load
    #[arg(long, conflicts_with = "read_back")]
    roll_back: bool,
    /// Write the tip in use to this file
    #[arg(long, value_name = "FILE")]
    read_back: Option<PathBuf>,
    /// Speed of the serial port, bits a second
    #[arg(long, value_name = "BAUD", default_value_t = BAUD)]
    baud: u32,
    /// Of a shared line (RS-485, firmware with the feature rs485): give the board the turn after so many milliseconds of silence
    #[arg(long, value_name = "MS", num_args = 0..=1, require_equals = true, default_missing_value = SILENCE, value_parser = silence)]
    poll: Option<Duration>,
}

/// Where the board is.
struct LoadLine {
    port: Address,
    /// Of a shared line: silence before a turn.
    poll: Option<Duration>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let mut port = arguments.port.clone();
    if let Address::Serial { baud, .. } = &mut port {
        *baud = arguments.baud;
    }
    let line = LoadLine {
        port,
        poll: arguments.poll,
    };
    let name = arguments.name.as_deref();
    if let Some(file) = &arguments.file {
        return load(line, file, name);
    }
    if let Some(out) = &arguments.read_back {
        return read_back(line, out, name);
    }
    let (loaded, seconds) = carry(line, LoadJob::RollBack, name)?;
    let tip = loaded.tip.as_deref().unwrap_or("0");
    let rows = row("rolled back", tip, loaded.hash, 0, seconds);
    Ok(answer(rows, &loaded))
}

fn load(line: LoadLine, file: &Path, name: Option<&str>) -> Result<CommandAnswer, Refusal> {
    let block = tip::needed(file)?;
    let held = TipBlock::read(&block).map_err(|error| Refusal::about(file, &error))?;
    let (hash, own) = (held.constants.hash, held.name.to_owned());
    let length = block.len();
    let job = LoadJob::Load {
        block,
        hash,
        name: own.clone(),
    };
    let (loaded, seconds) = carry(line, job, name)?;
    let tip = loaded.tip.as_ref().unwrap_or(&own);
    let rows = row("loaded", tip, loaded.hash, length, seconds);
    Ok(answer(rows, &loaded))
}

fn read_back(line: LoadLine, out: &Path, name: Option<&str>) -> Result<CommandAnswer, Refusal> {
    files::expect_room(out)?;
    let address = line.port.to_string();
    let (mut loaded, seconds) = carry(line, LoadJob::ReadBack, name)?;
    let block = std::mem::take(&mut loaded.block);
    let held = TipBlock::read(&block).map_err(|error| {
        Refusal(format!(
            "{address}: what was read back cannot be used: {error}; read it again"
        ))
    })?;
    let (own, hash) = (held.name.to_owned(), held.constants.hash);
    let length = block.len();
    files::write_one(out, block)?;
    let tip = loaded.tip.as_ref().unwrap_or(&own);
    let rows = row("read back", tip, hash, length, seconds);
    Ok(answer(rows, &loaded))
}

/// Carries a job over the line to its end; how long it took, seconds.
fn carry(line: LoadLine, job: LoadJob, tip: Option<&str>) -> Result<(Loaded, f64), Refusal> {
    let address = line.port.to_string();
    let whole = match &job {
        LoadJob::Load { block, .. } => block.len(),
        LoadJob::RollBack | LoadJob::ReadBack => 0,
    };
    let start = Instant::now();
    let link = Link::start(line.port, line.poll);
    let mut loading = Loading::new(job, tip);
    let done = Arc::new(AtomicUsize::new(0));
    let shown = Arc::clone(&done);
    let tell = move || {
        let done = shown.load(Ordering::Relaxed);
        if whole > 0 {
            format!("load: {done} of {whole} bytes")
        } else {
            format!("load: {done} bytes")
        }
    };
    let _ticks = std::io::stderr().is_terminal().then(|| Ticks::begin(tell));
    let mut connected = false;
    loop {
        match link.next(LOOK) {
            Some(LinkEvent::Connected) => {
                connected = true;
                loading.connected();
            }
            Some(LinkEvent::Bytes(bytes)) => loading.hear(start.elapsed(), &bytes),
            Some(LinkEvent::Lost(reason)) if !connected => {
                return Err(Refusal(format!(
                    "{address} cannot be opened: {reason}; see that the board is plugged in and that no other program has its port"
                )));
            }
            Some(LinkEvent::Lost(reason)) => loading.lost(start.elapsed(), &reason),
            None => {}
        }
        if connected && let Some(bytes) = loading.next(start.elapsed()) {
            link.send(&bytes);
        }
        done.store(loading.done(), Ordering::Relaxed);
        if let Some(outcome) = loading.outcome() {
            let seconds = start.elapsed().as_secs_f64();
            return match outcome {
                Ok(loaded) => Ok((loaded.clone(), seconds)),
                Err(failure) => Err(Refusal(format!("{address}: {failure}"))),
            };
        }
    }
}

fn row(action: &'static str, tip: &str, hash: u64, bytes: usize, seconds: f64) -> Rows {
    let mut rows = Rows::new(COLUMNS);
    rows.push(vec![
        Cell::word(action),
        Cell::Text(tip.to_owned()),
        Cell::Text(format!("{hash:016x}")),
        Cell::Count(bytes),
        Cell::Number(seconds),
    ]);
    rows
}

fn answer(rows: Rows, loaded: &Loaded) -> CommandAnswer {
    let notes = match loaded.repeated {
        0 => Vec::new(),
        times => vec![format!(
            "the line lost something: {times} commands were sent again"
        )],
    };
    CommandAnswer { rows, notes }
}
