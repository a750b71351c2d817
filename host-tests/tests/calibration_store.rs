//! The stored calibration survives a power cut at every step, every failing operation, and whatever lies in the flash.

use embassy_futures::block_on;
use fingertip::signal::calibration::Calibration;
use fingertip::status::Stored;
use fingertip::storage::log::StoreError;
use fingertip::storage::record::LENGTH;
use fingertip::storage::store::{Identity, Store};
use fingertip::units::Millipascals;
use host_tests::nor_flash::{Defect, SimulatedFlash, later};
use host_tests::{assert_faults_says, workspace};

const IDENTITY: Identity = Identity {
    design_hash: 0x0123_4567_89AB_CDEF,
    table_version: 1,
    firmware: [0, 1, 0],
    range: [0, 100_000],
};

/// Few places, so that slots turn over often.
const SLOT: usize = 8 * LENGTH;
type Flash = SimulatedFlash<SLOT>;

/// The units of the boards' memories, and their slots.
const WORD: usize = 4;
const DOUBLE_WORD: usize = 8;
const SECTOR: usize = 16 * 1024;
const PAGE: usize = 2 * 1024;

fn calibration(number: i32) -> Calibration {
    Calibration {
        zero: Some(Millipascals(20_000_000 + number)),
        ..Calibration::default()
    }
}

fn open<const N: usize, const U: usize>(
    flash: SimulatedFlash<N, U>,
) -> (Store<SimulatedFlash<N, U>>, Stored) {
    block_on(Store::open(flash, N as u32, IDENTITY))
}

fn save<const N: usize, const U: usize>(
    flash: SimulatedFlash<N, U>,
    number: i32,
) -> (SimulatedFlash<N, U>, Result<(), StoreError>) {
    let (mut store, _) = open(flash);
    let saved = block_on(store.save(later(), Some(calibration(number))));
    (store.into_flash(), saved)
}

/// What a start finds.
fn read_back<const N: usize, const U: usize>(flash: &SimulatedFlash<N, U>) -> (Stored, Option<Calibration>) {
    let (store, state) = open(flash.clone());
    (state, store.calibration())
}

/// Saves 0 to `saves`, each behind the one before: the memory before each and after the last.
fn histories<const N: usize, const U: usize>(saves: i32) -> Vec<SimulatedFlash<N, U>> {
    let (mut store, _) = open(SimulatedFlash::erased(1));
    let mut flashes = vec![store.clone().into_flash()];
    for number in 0..saves {
        assert_eq!(block_on(store.save(later(), Some(calibration(number)))), Ok(()));
        flashes.push(store.clone().into_flash());
    }
    assert_eq!(
        read_back(&flashes[saves as usize]),
        (Stored::InUse, Some(calibration(saves - 1)))
    );
    flashes
}

/// Every step of save `number`, cut with every look of the half-done step.
fn cuts<const N: usize, const U: usize>(
    before: &SimulatedFlash<N, U>,
    number: i32,
) -> impl Iterator<Item = SimulatedFlash<N, U>> {
    let (whole, _) = save(before.clone(), number);
    let looks = SimulatedFlash::<N, U>::looks().iter();
    (0..whole.steps() - before.steps()).flat_map(move |steps| {
        looks.clone().map(move |&look| {
            let seed = steps + 1000 * number as u64;
            let cut = before.clone().leaving(look, seed).failing_after(steps);
            let (flash, saved) = save(cut, number);
            assert!(saved.is_err(), "cut after {steps} steps");
            flash.powered_up()
        })
    })
}

/// After a cut of save `number` the calibration before it or its own is in use, and the next save works.
fn assert_consistent<const N: usize, const U: usize>(flash: &SimulatedFlash<N, U>, number: i32) {
    let (state, found) = read_back(flash);
    let before = (number > 0).then(|| calibration(number - 1));
    if found == Some(calibration(number)) {
        assert_eq!(state, Stored::InUse, "save {number}");
    } else {
        assert_eq!(found, before, "save {number}");
        // A place that may hold a later record is reported; it never hides the one before.
        assert!(
            number == 0 || matches!(state, Stored::InUse | Stored::Unreadable),
            "save {number}: {state:?}"
        );
    }
    let (flash, saved) = save(flash.clone(), number + 1);
    assert_eq!(saved, Ok(()), "after save {number}");
    assert_eq!(read_back(&flash), (Stored::InUse, Some(calibration(number + 1))));
}

/// Cuts these saves at every step, with every look; how many cuts that are.
fn sweep<const N: usize, const U: usize>(saves: impl IntoIterator<Item = i32>) -> usize {
    let saves: Vec<i32> = saves.into_iter().collect();
    let flashes = histories::<N, U>(*saves.last().expect("some saves") + 1);
    let mut points = 0;
    for number in saves {
        for flash in cuts(&flashes[number as usize], number) {
            assert_consistent(&flash, number);
            points += 1;
        }
    }
    points
}

/// Cuts these saves at every step, and the save after each cut again.
fn sweep_twice<const N: usize, const U: usize>(saves: std::ops::Range<i32>) -> usize {
    let flashes = histories::<N, U>(saves.end);
    let mut points = 0;
    for number in saves {
        for first in cuts(&flashes[number as usize], number) {
            let (_, found) = read_back(&first);
            let before = if found == Some(calibration(number)) {
                number
            } else {
                number - 1
            };
            for second in cuts(&first, number + 1) {
                let (_, found) = read_back(&second);
                assert!(
                    found == Some(calibration(before)) || found == Some(calibration(number + 1)),
                    "{found:?}"
                );
                let (again, saved) = save(second, number + 2);
                assert_eq!(saved, Ok(()));
                assert_eq!(read_back(&again), (Stored::InUse, Some(calibration(number + 2))));
                points += 1;
            }
        }
    }
    points
}

#[test]
fn the_slots_here_are_the_boards() {
    for (board, slot) in [
        ("nucleo_f429zi", SECTOR),
        ("nucleo_l432kc", PAGE),
        ("nucleo_g474re", PAGE),
    ] {
        let file = workspace().join("src/board").join(board).with_extension("rs");
        let source = std::fs::read_to_string(file).expect("the board has a file");
        let line = format!("pub const SLOT: u32 = {} * 1024;", slot / 1024);
        assert!(source.contains(&line), "{board}: {line}");
    }
}

#[test]
fn power_may_fail_at_every_step_of_every_save() {
    let words = sweep::<SLOT, WORD>(0..60);
    let double_words = sweep::<SLOT, DOUBLE_WORD>(0..60);
    assert_faults_says(&format!(
        "{words} power cuts in units of 4 bytes and {double_words} in units of 8 bytes with error correction, at every \
         step of 60 saves with every look"
    ));
}

#[test]
fn power_may_fail_again_at_every_step_of_the_save_after_a_cut() {
    // The ninth save turns the slots over: the one before it, it, and the one after.
    let words = sweep_twice::<SLOT, WORD>(7..10);
    let double_words = sweep_twice::<SLOT, DOUBLE_WORD>(7..10);
    assert_faults_says(&format!("{words} and {double_words} pairs of cuts"));
}

#[test]
fn power_may_fail_while_the_slots_of_a_board_turn_over() {
    // A sector has 341 places, a page 42: the first saves, and those at the end of either slot.
    let sectors = sweep::<SECTOR, WORD>([0, 1, 339, 340, 341, 342, 681, 682, 683]);
    let pages = sweep::<PAGE, DOUBLE_WORD>(0..86);
    assert_faults_says(&format!(
        "{sectors} cuts at the turns of two 16 KB sectors, {pages} at every step of 86 saves in two 2 KB pages"
    ));
}

/// A memory with saves 0 to `saves` whose record `number` is spoilt: on memory with error correction a unit of it.
fn spoilt(saves: i32, number: usize, unit: usize) -> SimulatedFlash<SLOT, DOUBLE_WORD> {
    let flashes = histories::<SLOT, DOUBLE_WORD>(saves);
    flashes[saves as usize]
        .clone()
        .spoilt_at(number % 16 * LENGTH + unit * DOUBLE_WORD)
}

#[test]
fn a_record_that_cannot_be_read_leaves_the_one_before_and_is_reported() {
    for saves in [1, 5, 8, 9, 16, 17] {
        for unit in 0..LENGTH / DOUBLE_WORD {
            let flash = spoilt(saves, saves as usize - 1, unit);
            let before = (saves > 1).then(|| calibration(saves - 2));
            assert_eq!(read_back(&flash), (Stored::Unreadable, before), "{saves}, {unit}");
            let (flash, saved) = save(flash, saves - 2);
            // Also what the record before holds already, as the lost one may have been another.
            assert_eq!(saved, Ok(()));
            assert_eq!(read_back(&flash), (Stored::InUse, Some(calibration(saves - 2))));
        }
    }
}

#[test]
fn an_older_record_that_cannot_be_read_matters_to_nobody() {
    for (saves, spoilt_ones) in [(8, 0..7), (12, 0..11)] {
        for number in spoilt_ones {
            let flash = spoilt(saves, number, 2);
            let latest = Some(calibration(saves - 1));
            assert_eq!(read_back(&flash), (Stored::InUse, latest), "{number}");
            let mut flash = flash;
            for next in saves..saves + 20 {
                let (after, saved) = save(flash, next);
                assert_eq!(saved, Ok(()), "{number}, {next}");
                assert_eq!(read_back(&after), (Stored::InUse, Some(calibration(next))));
                flash = after;
            }
        }
    }
}

#[test]
fn a_later_save_stays_the_last_when_a_lost_record_comes_back() {
    let flashes = histories::<SLOT, DOUBLE_WORD>(5);
    let (flash, saved) = save(flashes[5].clone().spoilt_at(4 * LENGTH), 99);
    assert_eq!(saved, Ok(()));
    let (store, _) = open(flash);
    // Its place may have held number 5.
    assert_eq!(store.sequence(), 6);
}

#[test]
fn one_rotten_bit_of_the_last_record_is_reported_too() {
    let flashes = histories::<SLOT, WORD>(5);
    for bit in 0..8 * LENGTH {
        let mut flash = flashes[5].clone();
        flash.bytes_mut()[4 * LENGTH + bit / 8] ^= 1 << (bit % 8);
        assert_eq!(
            read_back(&flash),
            (Stored::Unreadable, Some(calibration(3))),
            "{bit}"
        );
    }
}

/// The last record wherever in the two slots it lies: a save, or that what was stored is void.
#[test]
fn a_rotten_bit_of_the_last_record_never_brings_back_an_older_one_unsaid() {
    let places = (SLOT / LENGTH) as i32;
    for saves in 1..=2 * places + 1 {
        let (mut store, _) = open(Flash::erased(1));
        for number in 0..saves {
            assert_eq!(block_on(store.save(later(), Some(calibration(number)))), Ok(()));
        }
        for last in [None, Some(calibration(99))] {
            let mut store = store.clone();
            let mut before = store.clone().into_flash();
            assert_eq!(block_on(store.save(later(), last)), Ok(()));
            let mut after = store.into_flash();
            let written: Vec<usize> = (0..2 * SLOT / LENGTH)
                .filter(|place| {
                    let bytes = |flash: &mut Flash| flash.bytes_mut()[place * LENGTH..][..LENGTH].to_vec();
                    let written = bytes(&mut after);
                    bytes(&mut before) != written && written != [0xFF; LENGTH]
                })
                .collect();
            assert_eq!(written.len(), 1, "{saves}");
            for bit in (0..8 * LENGTH).step_by(5) {
                let mut flash = after.clone();
                flash.bytes_mut()[written[0] * LENGTH + bit / 8] ^= 1 << (bit % 8);
                let (state, _) = read_back(&flash);
                assert_eq!(state, Stored::Unreadable, "{saves} saves, bit {bit}");
            }
        }
    }
}

#[test]
fn nothing_but_places_that_cannot_be_read_is_reported_and_written_over() {
    let mut flash = histories::<SLOT, DOUBLE_WORD>(16)[16].clone();
    for place in 0..16 {
        flash = flash.spoilt_at(place * LENGTH);
    }
    assert_eq!(read_back(&flash), (Stored::Unreadable, None));
    let (flash, saved) = save(flash, 20);
    assert_eq!(saved, Ok(()));
    assert_eq!(read_back(&flash), (Stored::InUse, Some(calibration(20))));
}

#[test]
fn the_slots_of_the_board_turn_over_too() {
    let mut flash = SimulatedFlash::<SECTOR, WORD>::erased(1);
    let places = (SECTOR / LENGTH) as i32;
    let (mut store, _) = open(flash);
    for number in 0..=places {
        assert_eq!(block_on(store.save(later(), Some(calibration(number)))), Ok(()));
    }
    flash = store.into_flash();
    assert_eq!(read_back(&flash), (Stored::InUse, Some(calibration(places))));
    assert_eq!(flash.steps(), (places as u64 + 1) * LENGTH as u64 / 4 + 16);
}

#[test]
fn every_operation_may_fail_once_or_for_ever() {
    let flashes: Vec<Flash> = histories(12);
    let mut failures = 0;
    for (number, before) in flashes[..12].iter().enumerate() {
        let number = number as i32;
        let (whole, _) = save(before.clone().with(Defect::None), number);
        for from in 0..whole.operations() {
            for times in [1, u64::MAX] {
                for defect in [Defect::Fails { from, times }, Defect::Pretends { from, times }] {
                    let (flash, saved) = save(before.clone().with(defect), number);
                    let flash = flash.powered_up();
                    let (_, found) = read_back(&flash);
                    if saved.is_ok() {
                        assert_eq!(found, Some(calibration(number)), "{defect:?}");
                    } else {
                        let before = (number > 0).then(|| calibration(number - 1));
                        assert!(
                            found == before || found == Some(calibration(number)),
                            "{defect:?}: {found:?}"
                        );
                    }
                    assert_consistent(&flash, number.max(0));
                    failures += 1;
                }
            }
        }
    }
    assert_faults_says(&format!("{failures} failing or pretending operations"));
}

#[test]
fn another_designs_record_is_refused_and_may_be_replaced() {
    let (flash, _) = save(Flash::erased(1), 5);
    let other = Identity {
        design_hash: 1,
        ..IDENTITY
    };
    let (mut store, state) = block_on(Store::open(flash, SLOT as u32, other));
    assert_eq!((state, store.calibration()), (Stored::OtherDesign, None));
    assert_eq!(block_on(store.save(later(), Some(calibration(6)))), Ok(()));
    let (store, state) = block_on(Store::open(store.into_flash(), SLOT as u32, other));
    assert_eq!(
        (state, store.calibration()),
        (Stored::InUse, Some(calibration(6)))
    );
}

#[test]
fn values_that_cannot_be_are_refused_though_their_check_fits() {
    let (mut store, _) = open(Flash::erased(1));
    let absurd = Calibration {
        gain: 2_000_000,
        ..Calibration::default()
    };
    assert_eq!(block_on(store.save(later(), Some(absurd))), Ok(()));
    assert_eq!(read_back(&store.into_flash()), (Stored::Damaged, None));
}

#[test]
fn what_was_stored_can_be_made_void() {
    let (flash, _) = save(Flash::erased(1), 5);
    let (mut store, _) = open(flash);
    assert_eq!(block_on(store.save(later(), None)), Ok(()));
    assert_eq!(read_back(&store.into_flash()), (Stored::None, None));
}

#[test]
fn both_slots_damaged_are_reported_so_and_written_again() {
    let flashes: Vec<Flash> = histories(10);
    let mut flash = flashes[10].clone();
    for (i, byte) in flash.bytes_mut().iter_mut().enumerate() {
        *byte ^= (i % 7) as u8 & !1;
    }
    assert_eq!(read_back(&flash), (Stored::Damaged, None));
    let (flash, saved) = save(flash, 11);
    assert_eq!(saved, Ok(()));
    assert_eq!(read_back(&flash), (Stored::InUse, Some(calibration(11))));
}

#[test]
fn what_is_stored_already_is_not_stored_again_and_wear_has_an_end() {
    let (flash, _) = save(Flash::erased(1), 5);
    let (again, saved) = save(flash.clone(), 5);
    assert_eq!((saved, again.steps()), (Ok(()), flash.steps()));

    // 8 saves to a slot: 20 000 erasures are 160 000 saves.
    let (mut store, _) = open(Flash::erased(1));
    let worn = (0..200_000)
        .find(|&number| block_on(store.save(later(), Some(calibration(number)))) == Err(StoreError::WornOut));
    assert_eq!(worn, Some(8 + 20_000 * 8));
    let last = worn.map_or(0, |worn| worn - 1);
    assert_eq!(
        read_back(&store.into_flash()),
        (Stored::InUse, Some(calibration(last)))
    );
}
