//! The loaded tips of a hand: one is loaded while all are read, power may fail at every step of it, and no other tip is ever another one
//! than before.

use embassy_futures::block_on;
use fingertip::device::tip_loader::{FoundTip, LARGEST_BLOCK, TipLoader};
use fingertip::image::ImageDesign;
use fingertip::link::load::{CHUNK, LoadCommand, LoadKind, LoadOutcome, LoadReply, LoadRequest, Piece};
use fingertip::link::tips::{AnyDecoder, AnyFrame, TipsMessage};
use fingertip::signal::design::Design as _;
use fingertip::status::Warnings;
use fingertip::units::Microseconds;
use host_tests::hand_device::{HandDevice, NAMES, TIPS, loader};
use host_tests::nor_flash::SimulatedFlash;
use host_tests::tip_device::tip;
use model_tables::block::MAGIC;
use model_tables::block::read::stated;
use monitor::load::{LoadFailure, LoadJob, Loading};
use std::time::Duration;

/// Room for a block of some hundred bytes.
const SLOT: usize = 2048;

/// The units of memories without and with error correction.
const WORD: usize = 4;
const DOUBLE_WORD: usize = 8;

/// The hash of the design of the image, and that of a tip which is loaded.
const IMAGE: u64 = ImageDesign::CONSTANTS.hash;
const NEW: u64 = 0x9999;

/// The one that is loaded.
const LOADED: usize = 3;

/// What a start finds of each tip, as the hash in use.
type Hashes = [u64; TIPS];

/// A board with power.
struct Bench<const U: usize> {
    flash: SimulatedFlash<SLOT, U>,
    loader: TipLoader<TIPS>,
    buffer: Vec<u8>,
    now: Microseconds,
}

impl<const U: usize> Bench<U> {
    /// Switched on; what it finds.
    fn start(flash: SimulatedFlash<SLOT, U>) -> (Self, Hashes) {
        let mut bench = Self {
            flash,
            loader: loader(SLOT as u32),
            buffer: vec![0; LARGEST_BLOCK],
            now: Microseconds(0),
        };
        let found = std::array::from_fn(|tip| {
            match block_on(bench.loader.start(tip, &mut bench.flash, &mut bench.buffer)) {
                FoundTip::Image => IMAGE,
                FoundTip::Loaded(design, _) => design.parameters().constants.hash,
                FoundTip::Refused => panic!("tip {tip} is refused"),
            }
        });
        (bench, found)
    }

    fn ask(&mut self, tip: usize, command: LoadCommand) -> LoadOutcome {
        self.now.0 += 1000;
        let request = LoadRequest { sequence: 1, command };
        let asked = (tip as u8, request);
        match block_on(
            self.loader
                .request(self.now, &mut self.flash, asked, &mut self.buffer),
        ) {
            LoadReply::Answer { outcome, .. } => outcome,
            LoadReply::Data { .. } => LoadOutcome::Done,
        }
    }

    /// Arm, begin, chunks, verify, activate; the first answer that is not "done".
    fn load(&mut self, tip: usize, block: &[u8], hash: u64) -> Result<(), (LoadKind, LoadOutcome)> {
        let chunks = block
            .chunks(CHUNK)
            .enumerate()
            .map(|(at, bytes)| chunk(at, bytes));
        let all = [LoadCommand::Arm, begin(tip, block)]
            .into_iter()
            .chain(chunks)
            .chain([LoadCommand::Verify, LoadCommand::Activate { hash }]);
        for command in all {
            match self.ask(tip, command) {
                LoadOutcome::Done => {}
                outcome => return Err((command.kind(), outcome)),
            }
        }
        Ok(())
    }

    fn roll_back(&mut self, tip: usize) -> LoadOutcome {
        self.ask(tip, LoadCommand::Arm);
        self.ask(tip, LoadCommand::RollBack)
    }
}

fn begin(tip: usize, block: &[u8]) -> LoadCommand {
    let (length, check) = stated(block).expect("a block");
    LoadCommand::Begin {
        tip: tip as u8,
        length,
        check,
    }
}

fn chunk(at: usize, bytes: &[u8]) -> LoadCommand {
    LoadCommand::Chunk {
        offset: (at * CHUNK) as u32,
        bytes: Piece::of(bytes).expect("not empty"),
    }
}

/// A memory that these tips were loaded into, one after the other: each the number of its tip and its hash.
fn loaded<const U: usize>(tips: &[(usize, u64)]) -> SimulatedFlash<SLOT, U> {
    let mut flash = SimulatedFlash::of_slots(2 * TIPS, 1);
    for &(number, hash) in tips {
        let (mut bench, _) = Bench::start(flash);
        bench
            .load(number, &tip(hash, 0), hash)
            .expect("the memory is sound");
        flash = bench.flash;
    }
    flash
}

#[test]
fn each_tip_has_its_own_slots_and_goes_back_alone() {
    let all: Vec<(usize, u64)> = (0..TIPS).map(|tip| (tip, 0x100 + tip as u64)).collect();
    let (mut bench, found) = Bench::start(loaded::<WORD>(&all));
    assert_eq!(found, [0x100, 0x101, 0x102, 0x103, 0x104]);
    // Read back from each.
    for tip in 0..TIPS {
        let command = LoadCommand::ReadBack {
            offset: 16,
            length: 8,
        };
        let request = LoadRequest { sequence: 2, command };
        let asked = (tip as u8, request);
        let reply = block_on(bench.loader.request(
            Microseconds(1),
            &mut bench.flash,
            asked,
            &mut bench.buffer,
        ));
        let LoadReply::Data { bytes, .. } = reply else {
            panic!("{reply:?}");
        };
        assert_eq!(bytes.as_slice(), (0x100 + tip as u64).to_le_bytes(), "tip {tip}");
    }
    assert_eq!(bench.roll_back(1), LoadOutcome::Done);
    assert_eq!(bench.loader.changed(), 1);
    let (_, found) = Bench::start(bench.flash);
    assert_eq!(found, [0x100, IMAGE, 0x102, 0x103, 0x104]);
}

#[test]
fn a_load_is_of_one_tip_and_another_one_ends_it() {
    let (mut bench, _) = Bench::start(SimulatedFlash::<SLOT, WORD>::of_slots(2 * TIPS, 1));
    let block = tip(NEW, 0);
    let first = chunk(0, &block[..CHUNK]);
    assert_eq!(bench.ask(0, LoadCommand::Arm), LoadOutcome::Done);
    assert_eq!(bench.ask(2, begin(2, &block)), LoadOutcome::Done);
    assert_eq!(bench.ask(2, first), LoadOutcome::Done);
    // Another tip has no load under way, and its begin names it.
    for command in [first, LoadCommand::Verify, LoadCommand::Activate { hash: NEW }] {
        assert_eq!(bench.ask(1, command), LoadOutcome::OutOfOrder, "{command:?}");
    }
    assert_eq!(bench.ask(1, begin(2, &block)), LoadOutcome::WrongTip);
    assert_eq!(bench.ask(TIPS, LoadCommand::Arm), LoadOutcome::WrongTip);
    assert_eq!(bench.ask(1, begin(1, &block)), LoadOutcome::Done);
    assert_eq!(bench.ask(2, first), LoadOutcome::OutOfOrder);
    assert_eq!(bench.ask(1, first), LoadOutcome::Done);
}

/// What is done with a tip, and whether the board answered that all of it was done.
type Act<const U: usize> = fn(&mut Bench<U>) -> bool;

/// Cuts power at every step of an act; how many cuts.
fn sweep<const U: usize>(before: &SimulatedFlash<SLOT, U>, act: Act<U>, after: u64) -> u64 {
    let (mut whole, was) = Bench::start(before.clone());
    assert!(act(&mut whole), "the memory is sound");
    let steps = whole.flash.steps() - before.steps();
    let mut cuts = 0;
    for step in 0..steps {
        for (seed, &look) in SimulatedFlash::<SLOT, U>::looks().iter().enumerate() {
            let flash = before
                .clone()
                .leaving(look, 1000 * step + seed as u64)
                .failing_after(step);
            let (mut bench, _) = Bench::start(flash);
            let done = act(&mut bench);
            let (mut bench, found) = Bench::start(bench.flash.powered_up());
            for tip in 0..TIPS {
                let kept = found[tip] == was[tip] && !(done && tip == LOADED);
                let new = tip == LOADED && found[tip] == after;
                assert!(
                    kept || new,
                    "step {step}, {look:?}: tip {tip} is {:x}",
                    found[tip]
                );
            }
            cuts += 1;
            // Whatever the cut left, the next load succeeds.
            assert_eq!(bench.load(LOADED, &tip(9, 0), 9), Ok(()), "step {step}, {look:?}");
            let mut expected = was;
            expected[LOADED] = 9;
            assert_eq!(Bench::start(bench.flash).1, expected, "step {step}, {look:?}");
        }
    }
    cuts
}

fn sweeps<const U: usize>() -> u64 {
    let load: Act<U> = |bench| bench.load(LOADED, &tip(NEW, 0), NEW).is_ok();
    let back: Act<U> = |bench| bench.roll_back(LOADED) == LoadOutcome::Done;
    let others = [(0, 0x100), (2, 0x102), (4, 0x104)];
    let mut with_it = others.to_vec();
    with_it.extend([(LOADED, 0x103), (LOADED, 0x203)]);
    sweep(&loaded(&others), load, NEW)
        + sweep(&loaded(&with_it), load, NEW)
        + sweep(&loaded(&with_it), back, 0x103)
}

#[test]
fn power_cuts_at_every_step_change_no_tip_but_the_one_that_is_loaded() {
    let cuts = [sweeps::<WORD>(), sweeps::<DOUBLE_WORD>()];
    println!("cuts, with units of 4 bytes and of 8 with error correction: {cuts:?}");
    assert!(cuts.iter().all(|&cuts| cuts > 500));
}

/// A line of 1 000 000 baud, bytes a millisecond, and how long bytes wait on the host's side of USB, milliseconds.
const LINE: usize = 100;
const USB: usize = 1;

/// Erasing a sector of 16, 64 and 128 KB in words, typically and at most, and programming a word at most, milliseconds (DS9405 table 48).
const ERASURES: [(u32, [f64; 2]); 3] = [
    (16, [250.0, 500.0]),
    (64, [550.0, 1100.0]),
    (128, [1000.0, 2000.0]),
];
const WORD_MS: f64 = 0.1;

/// One way of the line: what is on its way, millisecond by millisecond.
#[derive(Default)]
struct Way {
    waiting: Vec<u8>,
    late: Vec<Vec<u8>>,
}

impl Way {
    fn carry(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.waiting.extend(bytes);
        let now = self.waiting.drain(..self.waiting.len().min(LINE)).collect();
        self.late.push(now);
        if self.late.len() > USB {
            self.late.remove(0)
        } else {
            Vec::new()
        }
    }
}

/// A hand and a job over the line, in virtual time, until the job has ended.
struct Run {
    device: HandDevice<SimulatedFlash<SLOT_16K>>,
    milliseconds: u64,
    /// Frames of readings that came, each with its board's time, microseconds, and which tips had values; and the bytes of everything.
    readings: Vec<(u64, Vec<bool>)>,
    emitted: usize,
    outcome: Result<monitor::load::Loaded, LoadFailure>,
}

/// Simulated slots that have room for the largest block.
const SLOT_16K: usize = 16 * 1024;

fn carry(mut device: HandDevice<SimulatedFlash<SLOT_16K>>, job: LoadJob, tip: Option<&str>) -> Run {
    let mut loading = Loading::new(job, tip);
    loading.connected();
    let (mut to, mut from) = (Way::default(), Way::default());
    let mut decoder = AnyDecoder::default();
    let (mut milliseconds, mut emitted, mut readings) = (0, 0, Vec::new());
    while loading.outcome().is_none() {
        milliseconds += 1;
        assert!(milliseconds < 20_000, "it ends");
        let now = Duration::from_millis(milliseconds);
        let sent = loading.next(now).unwrap_or_default();
        let report = device.millisecond(&to.carry(&sent));
        emitted += report.len();
        let heard = from.carry(&report);
        for &byte in &heard {
            if let Some(Ok(AnyFrame::Tips(frame))) = decoder.push(byte)
                && let TipsMessage::Readings { time, reports, .. } = frame.message
            {
                let values = reports.iter().map(|report| report.outcome.is_ok()).collect();
                readings.push((time.0, values));
            }
        }
        loading.hear(now, &heard);
        device = device.settled();
    }
    Run {
        device,
        milliseconds,
        readings,
        emitted,
        outcome: loading.outcome().cloned().expect("it has ended"),
    }
}

fn device() -> HandDevice<SimulatedFlash<SLOT_16K>> {
    let mut device = HandDevice::start(SimulatedFlash::of_slots(2 * TIPS, 1), SLOT_16K as u32);
    // Their first zeros are taken: from then on reports have values.
    for _ in 0..1000 {
        device.millisecond(&[]);
    }
    assert!(device.reports().iter().all(|report| report.outcome.is_ok()));
    device
}

#[test]
fn one_tip_is_loaded_by_name_while_the_others_are_read_and_keep_their_zeros() {
    let job = LoadJob::Load {
        block: tip(NEW, 500),
        hash: NEW,
        name: "a-design".to_owned(),
    };
    let run = carry(device(), job, Some(NAMES.tips[LOADED]));
    let loaded = run.outcome.expect("it is loaded");
    assert_eq!(
        (loaded.hash, loaded.tip.as_deref(), loaded.repeated),
        (NEW, Some("ring"), 0)
    );
    let mut expected = [IMAGE; TIPS];
    expected[LOADED] = NEW;
    assert_eq!(run.device.designs(), expected);
    assert_eq!(run.device.restarts, 1);
    // A frame each second instant, before, meanwhile and after, where the clock begins anew; the others are at no fault in any of them, but
    // settle after the restart.
    let steps = run.readings.windows(2).map(|pair| (pair[0].0, pair[1].0));
    let missed = steps.filter(|(before, after)| after > before && after - before > 2_000);
    assert_eq!(missed.collect::<Vec<_>>(), []);
    let faults = run
        .readings
        .iter()
        .filter(|(_, values)| (0..TIPS).any(|tip| tip != LOADED && !values[tip]));
    let faulty = faults.count();
    println!(
        "frames: {}, with a fault of another tip: {faulty}",
        run.readings.len()
    );
    assert!(faulty <= 4, "{faulty}");
    // The loaded one has no zero that was verified, the others go on with theirs.
    let mut device = run.device;
    for (tip, report) in device.reports().iter().enumerate() {
        let found = report.outcome.expect("a reading");
        let unverified = found.warnings.contains(Warnings::ZERO_UNVERIFIED);
        assert_eq!(unverified, tip == LOADED, "tip {tip}: {found:?}");
    }
    for _ in 0..1000 {
        device.millisecond(&[]);
    }
    for (tip, report) in device.reports().iter().enumerate() {
        let found = report.outcome.expect("a reading");
        assert!(
            !found.warnings.contains(Warnings::CALIBRATION_REFUSED),
            "tip {tip}"
        );
    }

    // By its number it is read back, and by its name it goes back.
    let run = carry(device, LoadJob::ReadBack, Some("3"));
    assert_eq!(run.outcome.expect("it is read").block, tip(NEW, 500));
    let run = carry(run.device, LoadJob::RollBack, Some("ring"));
    assert_eq!(run.outcome.expect("it goes back").hash, IMAGE);
    assert_eq!(run.device.designs(), [IMAGE; TIPS]);
}

#[test]
fn a_hand_is_asked_for_a_tip_that_it_has() {
    let job = || LoadJob::Load {
        block: tip(NEW, 0),
        hash: NEW,
        name: "a-design".to_owned(),
    };
    for (wanted, expected) in [
        (
            Some("toe"),
            "the hand has no tip `toe`: give --tip with one of thumb, index, middle, ring, little",
        ),
        (Some("5"), "the hand has no tip `5`: give"),
        (None, "the board is a hand: give --tip with one of thumb"),
    ] {
        let run = carry(device(), job(), wanted);
        let failure = run.outcome.expect_err("there is none").to_string();
        assert!(failure.starts_with(expected), "{failure}");
        assert_eq!(run.device.restarts, 0);
    }
}

#[test]
fn four_kibibytes_are_loaded_at_full_telemetry_of_five_tips() {
    let mut block = vec![0x55; 4096];
    block[..4].copy_from_slice(&MAGIC);
    block[4..6].copy_from_slice(&[1, 0]);
    block[8..12].copy_from_slice(&4096_u32.to_le_bytes());
    let job = LoadJob::Load {
        block,
        hash: 1,
        name: "whole".to_owned(),
    };
    let run = carry(device(), job, Some("ring"));
    // Whole, and no tip: its verification is the last step before activation.
    assert_eq!(
        run.outcome,
        Err(LoadFailure::Refused(
            LoadKind::Verify,
            LoadOutcome::BlockRefused,
            2
        ))
    );
    // A frame of five tips each second millisecond is the least that went by beside it.
    assert!(run.emitted as u64 >= 110 * run.milliseconds / 2);
    let line = run.milliseconds as f64 + WORD_MS * 1024.0;
    for (kilobytes, [typical, most]) in ERASURES {
        let [typical, most] = [line + typical, line + most];
        println!(
            "line: {} ms, with programming {line:.0} ms; a sector of {kilobytes} KB erased: {typical:.0} ms, at most {most:.0} ms",
            run.milliseconds
        );
        assert!(typical <= 2_000.0, "{typical} ms");
        assert!(most <= 2_000.0 || kilobytes == 128, "{most} ms");
    }
}
