//! A loaded tip survives a power cut at every step of loading, activating and rolling back: what a start finds is the tip from before
//! or the new one, whole; and whatever a cut left behind, the next load succeeds.

use embassy_futures::block_on;
use fingertip::device::tip_loader::{FoundTip, LARGEST_BLOCK, TipLoader};
use fingertip::image::ImageDesign;
use fingertip::link::load::{
    CHUNK, LoadCommand, LoadKind, LoadOutcome, LoadReply, LoadRequest, Piece, refused,
};
use fingertip::signal::design::Design as _;
use fingertip::units::Microseconds;
use host_tests::nor_flash::{Defect, SimulatedFlash};
use host_tests::tip_device::{loader, tip};
use model_tables::block::read::stated;
use model_tables::block::write::sign;
use model_tables::random::Random;

/// Room for a block of some hundred bytes.
const SLOT: usize = 2048;

/// How often each look of what is half done is drawn.
const MIXTURES: usize = 3;

/// The units of the boards' memories.
const WORD: usize = 4;
const DOUBLE_WORD: usize = 8;

/// The design's own hash in the image, and those of tips.
const IMAGE: u64 = ImageDesign::CONSTANTS.hash;
const FIRST: u64 = 0x1111;
const SECOND: u64 = 0x2222;

/// A board with power.
struct Bench<const U: usize> {
    flash: SimulatedFlash<SLOT, U>,
    loader: TipLoader<1>,
    buffer: Vec<u8>,
    now: Microseconds,
}

impl<const U: usize> Bench<U> {
    /// Switched on; what it finds, as the hash in use and the gain, or that it refuses what is there.
    fn start(flash: SimulatedFlash<SLOT, U>) -> (Self, Result<(u64, i32), ()>) {
        let mut bench = Self {
            flash,
            loader: loader(SLOT as u32),
            buffer: vec![0; LARGEST_BLOCK],
            now: Microseconds(0),
        };
        let found = match block_on(bench.loader.start(0, &mut bench.flash, &mut bench.buffer)) {
            FoundTip::Image => Ok((IMAGE, 0)),
            FoundTip::Loaded(design, calibration) => {
                let gain = calibration.expect("the tips have one").gain;
                Ok((design.parameters().constants.hash, gain))
            }
            FoundTip::Refused => Err(()),
        };
        (bench, found)
    }

    fn ask(&mut self, command: LoadCommand) -> (LoadOutcome, u16) {
        self.now.0 += 1000;
        let request = LoadRequest { sequence: 1, command };
        match block_on(
            self.loader
                .request(self.now, &mut self.flash, (0, request), &mut self.buffer),
        ) {
            LoadReply::Answer {
                outcome, findings, ..
            } => (outcome, findings),
            LoadReply::Data { .. } => (LoadOutcome::Done, 0),
        }
    }

    /// Begin, chunks, verify; the first answer that is not "done".
    fn load(&mut self, block: &[u8]) -> Result<(), (LoadKind, LoadOutcome, u16)> {
        let (length, check) = stated(block).expect("a block");
        let chunks = block
            .chunks(CHUNK)
            .enumerate()
            .map(|(at, bytes)| LoadCommand::Chunk {
                offset: (at * CHUNK) as u32,
                bytes: Piece::of(bytes).expect("not empty"),
            });
        let begin = [
            LoadCommand::Arm,
            LoadCommand::Begin {
                tip: 0,
                length,
                check,
            },
        ];
        for command in begin.into_iter().chain(chunks).chain([LoadCommand::Verify]) {
            match self.ask(command) {
                (LoadOutcome::Done, _) => {}
                (outcome, findings) => return Err((command.kind(), outcome, findings)),
            }
        }
        Ok(())
    }

    fn load_and_activate(&mut self, block: &[u8], hash: u64) -> Result<(), (LoadKind, LoadOutcome, u16)> {
        self.load(block)?;
        match self.ask(LoadCommand::Activate { hash }) {
            (LoadOutcome::Done, _) => Ok(()),
            (outcome, findings) => Err((LoadKind::Activate, outcome, findings)),
        }
    }

    fn roll_back(&mut self) -> LoadOutcome {
        self.ask(LoadCommand::Arm);
        self.ask(LoadCommand::RollBack).0
    }
}

/// A memory that these tips were loaded into, one after the other.
fn loaded<const U: usize>(hashes: &[u64]) -> SimulatedFlash<SLOT, U> {
    let mut flash = SimulatedFlash::erased(1);
    for &hash in hashes {
        let (mut bench, _) = Bench::start(flash);
        bench
            .load_and_activate(&tip(hash, hash as i32), hash)
            .expect("the memory is sound");
        flash = bench.flash;
    }
    flash
}

#[test]
fn a_tip_is_loaded_activated_rolled_back_and_read() {
    let (mut bench, found) = Bench::start(SimulatedFlash::<SLOT, WORD>::erased(1));
    assert_eq!(found, Ok((IMAGE, 0)));
    let block = tip(FIRST, 77);
    let read = LoadCommand::ReadBack { offset: 0, length: 8 };
    assert_eq!(bench.ask(read).0, LoadOutcome::OutOfOrder);
    bench.load_and_activate(&block, FIRST).expect("sound");
    // Until it restarts it takes nothing more.
    assert!(bench.loader.is_restarting());
    assert_eq!(bench.ask(LoadCommand::Arm).0, LoadOutcome::Busy);
    let (mut bench, found) = Bench::start(bench.flash);
    assert_eq!(found, Ok((FIRST, 77)));
    let request = LoadRequest {
        sequence: 3,
        command: LoadCommand::ReadBack {
            offset: 8,
            length: 16,
        },
    };
    let reply = block_on(bench.loader.request(
        Microseconds(9),
        &mut bench.flash,
        (0, request),
        &mut bench.buffer,
    ));
    let LoadReply::Data {
        offset,
        bytes,
        sequence,
        ..
    } = reply
    else {
        panic!("{reply:?}");
    };
    assert_eq!((sequence, offset, bytes.as_slice()), (3, 8, &block[8..24]));
    // Beyond its end there is nothing.
    let beyond = LoadCommand::ReadBack {
        offset: block.len() as u32,
        length: 1,
    };
    assert_eq!(bench.ask(beyond).0, LoadOutcome::OutOfBounds);

    // To and fro: what was in use before is in use again.
    let mut flash = loaded::<WORD>(&[FIRST, SECOND]);
    for expected in [FIRST, SECOND, FIRST] {
        let (mut bench, _) = Bench::start(flash);
        assert_eq!(bench.roll_back(), LoadOutcome::Done);
        let (bench, found) = Bench::start(bench.flash);
        assert_eq!(found, Ok((expected, expected as i32)));
        flash = bench.flash;
    }
    let mut flash = loaded::<WORD>(&[FIRST]);
    for expected in [IMAGE, FIRST, IMAGE] {
        let (mut bench, _) = Bench::start(flash);
        assert_eq!(bench.roll_back(), LoadOutcome::Done);
        let (bench, found) = Bench::start(bench.flash);
        assert_eq!(found.expect("whole").0, expected);
        flash = bench.flash;
    }
    // A load that ends before its activation took what was before: the image's own tables are always there.
    let (mut bench, _) = Bench::start(loaded::<WORD>(&[FIRST, SECOND]));
    bench.load(&tip(3, 3)).expect("sound");
    assert_eq!(bench.roll_back(), LoadOutcome::Done);
    let (_, found) = Bench::start(bench.flash);
    assert_eq!(found, Ok((IMAGE, 0)));
    let (mut bench, _) = Bench::start(SimulatedFlash::<SLOT, WORD>::erased(1));
    assert_eq!(bench.roll_back(), LoadOutcome::NothingToRollBack);
}

#[test]
fn each_step_needs_the_one_before_and_may_be_repeated() {
    let block = tip(FIRST, 1);
    let (length, check) = stated(&block).expect("a block");
    let begin = LoadCommand::Begin {
        tip: 0,
        length,
        check,
    };
    let chunk = |at: usize| LoadCommand::Chunk {
        offset: (at * CHUNK) as u32,
        bytes: Piece::of(&block[at * CHUNK..block.len().min((at + 1) * CHUNK)]).expect("not empty"),
    };
    let (mut bench, _) = Bench::start(SimulatedFlash::<SLOT, DOUBLE_WORD>::erased(1));
    let activate = LoadCommand::Activate { hash: FIRST };
    for command in [
        begin,
        chunk(0),
        LoadCommand::Verify,
        activate,
        LoadCommand::RollBack,
    ] {
        assert_eq!(bench.ask(command).0, LoadOutcome::NotArmed, "{command:?}");
    }
    bench.ask(LoadCommand::Arm);
    for command in [chunk(0), LoadCommand::Verify, activate] {
        assert_eq!(bench.ask(command).0, LoadOutcome::OutOfOrder, "{command:?}");
    }
    let wrong = LoadCommand::Begin {
        tip: 1,
        length,
        check,
    };
    assert_eq!(bench.ask(wrong).0, LoadOutcome::WrongTip);
    let long = LoadCommand::Begin {
        tip: 0,
        length: LARGEST_BLOCK as u32 + 1,
        check,
    };
    assert_eq!(bench.ask(long).0, LoadOutcome::OutOfBounds);
    // A begin whose answer was lost erases once.
    assert_eq!(bench.ask(begin).0, LoadOutcome::Done);
    let erased = bench.flash.steps();
    assert_eq!(bench.ask(begin).0, LoadOutcome::Done);
    assert_eq!(bench.flash.steps(), erased);
    let chunks = block.len().div_ceil(CHUNK);
    // From the last to the first, each twice: written once.
    for at in (0..chunks).rev() {
        assert_eq!(bench.ask(chunk(at)).0, LoadOutcome::Done);
        let written = bench.flash.steps();
        assert_eq!(bench.ask(chunk(at)).0, LoadOutcome::Done);
        assert_eq!(bench.flash.steps(), written);
    }
    // Another content in the same place, and a chunk that is too short or behind the end.
    let short = LoadCommand::Chunk {
        offset: 0,
        bytes: Piece::of(&block[..8]).expect("not empty"),
    };
    assert_eq!(bench.ask(short).0, LoadOutcome::OutOfBounds);
    let behind = LoadCommand::Chunk {
        offset: (chunks * CHUNK) as u32,
        bytes: Piece::of(&[1; CHUNK]).expect("not empty"),
    };
    assert_eq!(bench.ask(behind).0, LoadOutcome::OutOfBounds);
    let other = LoadCommand::Chunk {
        offset: 0,
        bytes: Piece::of(&[1; CHUNK]).expect("not empty"),
    };
    assert_eq!(bench.ask(other).0, LoadOutcome::MemoryFailed);
    // Not before it is verified, not under another hash, and not after a minute without a command.
    assert_eq!(bench.ask(activate).0, LoadOutcome::OutOfOrder);
    assert_eq!(bench.ask(LoadCommand::Verify).0, LoadOutcome::Done);
    assert_eq!(
        bench.ask(LoadCommand::Activate { hash: SECOND }).0,
        LoadOutcome::OtherHash
    );
    bench.now.0 += 60_000_000;
    assert_eq!(bench.ask(activate).0, LoadOutcome::NotArmed);
    bench.ask(LoadCommand::Arm);
    assert_eq!(bench.ask(activate).0, LoadOutcome::Done);
    assert_eq!(Bench::start(bench.flash).1, Ok((FIRST, 1)));
}

#[test]
fn a_block_that_the_image_does_not_use_is_refused_by_reason_and_changes_nothing() {
    let sound = tip(SECOND, 2);
    let changed = |at: usize, value: &[u8]| {
        let mut block = sound.clone();
        block[at..at + value.len()].copy_from_slice(value);
        sign(&mut block);
        block
    };
    // After the head with its four entries: constants from 88 on, the words of the tables from 168 on (LAYOUT.md).
    let mut damaged = sound.clone();
    damaged[200] ^= 1;
    for (block, findings) in [
        (damaged, refused::CHECK),
        (changed(40, &[99, 0]), refused::LAYOUT),
        (changed(88 + 16, &0_i32.to_le_bytes()), refused::VALUE),
        (changed(88 + 12, &99_000_i32.to_le_bytes()), refused::TRANSDUCER),
        (
            changed(88 + 40 + 40, &(-1_i32 << 20).to_le_bytes()),
            refused::TABLES,
        ),
    ] {
        let (mut bench, _) = Bench::start(loaded::<WORD>(&[FIRST]));
        let answer = bench.load(&block);
        assert_eq!(
            answer,
            Err((LoadKind::Verify, LoadOutcome::BlockRefused, findings))
        );
        let activate = LoadCommand::Activate { hash: SECOND };
        assert_eq!(bench.ask(activate).0, LoadOutcome::OutOfOrder);
        assert_eq!(Bench::start(bench.flash).1, Ok((FIRST, FIRST as i32)));
    }
    // Shorter than it says: the rest of the slot is blank.
    let (mut bench, _) = Bench::start(loaded::<WORD>(&[FIRST]));
    bench.ask(LoadCommand::Arm);
    let (length, check) = stated(&sound).expect("a block");
    bench.ask(LoadCommand::Begin {
        tip: 0,
        length,
        check,
    });
    assert_eq!(
        bench.ask(LoadCommand::Verify),
        (LoadOutcome::BlockRefused, refused::LENGTH)
    );
}

/// What is done to a board while its power fails.
type Act<const U: usize> = fn(&mut Bench<U>) -> bool;

/// Cuts at every step of an act, with every look of what is half done: never anything but what was or what was to be, and after an
/// answer "done" only that. Then the next load succeeds. Gives the cuts.
fn sweep<const U: usize>(before: &SimulatedFlash<SLOT, U>, act: Act<U>, outcomes: [(u64, i32); 2]) -> u64 {
    let steps = {
        let (mut bench, found) = Bench::start(before.clone());
        assert_eq!(found, Ok(outcomes[0]));
        let from = bench.flash.steps();
        assert!(act(&mut bench), "nothing fails here");
        assert_eq!(Bench::start(bench.flash.clone()).1, Ok(outcomes[1]));
        bench.flash.steps() - from
    };
    let mut cuts = 0;
    for step in 0..steps {
        let looks = SimulatedFlash::<SLOT, U>::looks().iter();
        for (seed, &look) in looks
            .cycle()
            .take(MIXTURES * SimulatedFlash::<SLOT, U>::looks().len())
            .enumerate()
        {
            let flash = before
                .clone()
                .leaving(look, 1000 * step + seed as u64)
                .failing_after(step);
            let (mut bench, _) = Bench::start(flash);
            let done = act(&mut bench);
            let (mut bench, found) = Bench::start(bench.flash.powered_up());
            let allowed = if done { &outcomes[1..] } else { &outcomes[..] };
            let found = found.unwrap_or_else(|()| panic!("step {step}, {look:?}: refused"));
            assert!(allowed.contains(&found), "step {step}, {look:?}: {found:?}");
            cuts += 1;
            let loaded = bench.load_and_activate(&tip(9, 9), 9);
            assert_eq!(loaded, Ok(()), "step {step}, {look:?}: the load after it");
            assert_eq!(Bench::start(bench.flash).1, Ok((9, 9)), "step {step}, {look:?}");
        }
    }
    cuts
}

fn sweeps<const U: usize>() -> u64 {
    let load: Act<U> = |bench| bench.load_and_activate(&tip(SECOND, 2), SECOND).is_ok();
    let back: Act<U> = |bench| bench.roll_back() == LoadOutcome::Done;
    let first = (FIRST, FIRST as i32);
    let second = (SECOND, 2);
    let blank = SimulatedFlash::erased(1);
    sweep(&blank, load, [(IMAGE, 0), second])
        + sweep(&loaded(&[FIRST]), load, [first, second])
        + sweep(&loaded(&[5, FIRST]), load, [first, second])
        + sweep(&loaded(&[5, FIRST]), back, [first, (5, 5)])
        + sweep(&loaded(&[FIRST]), back, [first, (IMAGE, 0)])
}

#[test]
fn power_cuts_at_every_step_lose_and_mix_nothing() {
    let cuts = [sweeps::<WORD>(), sweeps::<DOUBLE_WORD>()];
    println!("cuts, with units of 4 bytes and of 8 with error correction: {cuts:?}");
    assert!(cuts.iter().all(|&cuts| cuts > 2_500));
}

/// One load after the other, each cut somewhere or failing somewhere, and started again: whatever is found is a whole tip that was
/// activated, or was to be.
#[test]
fn lives_full_of_cuts_and_failures_never_show_another_tip() {
    for seed in 0..40 {
        let mut random = Random(seed);
        let mut flash = SimulatedFlash::<SLOT, DOUBLE_WORD>::erased(seed);
        let mut known = vec![(IMAGE, 0)];
        for number in 1..20_u64 {
            let (mut bench, before) = Bench::start(flash.powered_up());
            bench.flash = match random.below(4) {
                0 => bench.flash,
                1 => bench.flash.with(Defect::Fails {
                    from: random.below(60),
                    times: 1 + random.below(3),
                }),
                2 => bench.flash.with(Defect::Pretends {
                    from: random.below(60),
                    times: 1 + random.below(3),
                }),
                _ => bench.flash.failing_after(random.below(140)),
            };
            let rolls_back = random.below(5) == 0;
            let done = if rolls_back {
                bench.roll_back() == LoadOutcome::Done
            } else {
                let done = bench
                    .load_and_activate(&tip(number, number as i32), number)
                    .is_ok();
                known.push((number, number as i32));
                done
            };
            let (bench, found) = Bench::start(bench.flash.powered_up());
            let found = found.unwrap_or_else(|()| panic!("seed {seed}, {number}: refused"));
            assert!(known.contains(&found), "seed {seed}, {number}: {found:?}");
            let new = (number, number as i32);
            if !rolls_back {
                let stays = !done && Ok(found) == before;
                assert!(
                    stays || found == new,
                    "seed {seed}, {number}: {found:?} after {before:?}"
                );
            }
            flash = bench.flash;
        }
    }
}
