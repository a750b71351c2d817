//! The stored calibrations of a hand survive a power cut at every step: of the tip that is saved the old one or the new one is
//! there, of the others their own.

use embassy_futures::block_on;
use fingertip::signal::calibration::Calibration;
use fingertip::status::Stored;
use fingertip::storage::hand_record::length;
use fingertip::storage::hand_store::{HandStore, TipIdentity};
use fingertip::storage::log::StoreError;
use fingertip::units::Millipascals;
use host_tests::nor_flash::{Defect, SimulatedFlash, later};

const TIPS: usize = 5;
const LENGTH: usize = length(TIPS);
/// Few places, so that slots turn over often.
const SLOT: usize = 4 * LENGTH;
/// The units of the boards' memories, and their slots.
const WORD: usize = 4;
const DOUBLE_WORD: usize = 8;
const SECTOR: usize = 16 * 1024;
const PAGE: usize = 2 * 1024;

type Hand<const S: usize, const U: usize> = HandStore<SimulatedFlash<S, U>, TIPS, LENGTH>;
/// Of each tip what became of its calibration, and the calibration.
type Kept = [(Stored, Option<Calibration>); TIPS];

fn identities() -> [TipIdentity; TIPS] {
    std::array::from_fn(|tip| TipIdentity {
        hash: 0x0123_4567_89AB_CDE0 + tip as u64,
        table_version: 5,
        range: [0, 100_000],
    })
}

fn calibration(number: i32) -> Calibration {
    Calibration {
        zero: Some(Millipascals(20_000_000 + number)),
        gain: number,
        ..Calibration::default()
    }
}

fn open_as<const S: usize, const U: usize>(
    flash: SimulatedFlash<S, U>,
    identities: [TipIdentity; TIPS],
) -> Hand<S, U> {
    let mut store = HandStore::new(flash, S as u32, identities, [0, 1, 0]);
    block_on(store.load());
    store
}

fn open<const S: usize, const U: usize>(flash: SimulatedFlash<S, U>) -> Hand<S, U> {
    open_as(flash, identities())
}

fn kept<const S: usize, const U: usize>(store: &Hand<S, U>) -> Kept {
    std::array::from_fn(|tip| {
        let stored = store.stored(tip);
        (stored.state, stored.calibration)
    })
}

/// What a start finds.
fn read_back<const S: usize, const U: usize>(flash: &SimulatedFlash<S, U>) -> Kept {
    kept(&open(flash.clone()))
}

/// The tip of a save.
const fn tip(number: i32) -> usize {
    number as usize * 2 % TIPS
}

/// Saves 0 to `saves` of one tip after the other, each with another calibration: the memory before each, with what is kept.
fn histories<const S: usize, const U: usize>(saves: i32) -> Vec<(SimulatedFlash<S, U>, Kept)> {
    let mut store = open(SimulatedFlash::erased(1));
    let mut expected = [(Stored::None, None); TIPS];
    let mut histories = vec![(store.clone().into_flash(), expected)];
    for number in 0..saves {
        assert_eq!(
            block_on(store.save(later(), tip(number), Some(calibration(number)))),
            Ok(())
        );
        expected[tip(number)] = (Stored::InUse, Some(calibration(number)));
        assert_eq!(kept(&store), expected, "save {number}");
        let flash = store.clone().into_flash();
        assert_eq!(read_back(&flash), expected, "save {number}");
        histories.push((flash, expected));
    }
    histories
}

/// Cuts power at every step of every save; how many cuts.
fn sweep<const S: usize, const U: usize>(saves: std::ops::Range<i32>) -> usize {
    let histories = histories::<S, U>(saves.end);
    let mut cuts = 0;
    for number in saves {
        let (before, expected) = &histories[number as usize];
        let (after, _) = &histories[number as usize + 1];
        let new = Some(calibration(number));
        for steps in 0..after.steps() - before.steps() {
            for &look in SimulatedFlash::<S, U>::looks() {
                cuts += 1;
                let cut = before.clone().failing_after(steps).leaving(look, steps);
                let mut store = open(cut);
                let _ = block_on(store.save(later(), tip(number), new));
                let flash = store.into_flash().powered_up();
                let found = read_back(&flash);
                for other in 0..TIPS {
                    let (state, calibration) = found[other];
                    let own = other == tip(number);
                    let (was_in, was) = expected[other];
                    // Never another's, never a mixture.
                    assert!(
                        calibration == was || own && calibration == new,
                        "save {number}, step {steps}, {look:?}: tip {other} has {calibration:?}"
                    );
                    let told = if own && calibration == new {
                        Stored::InUse
                    } else {
                        was_in
                    };
                    assert!(
                        state == told || matches!(state, Stored::Unreadable | Stored::Damaged),
                        "save {number}, step {steps}, {look:?}: tip {other} is {state:?}"
                    );
                }
                // The save is done again, and every tip has its own.
                let mut store = open(flash);
                assert_eq!(block_on(store.save(later(), tip(number), new)), Ok(()));
                let found = read_back(&store.into_flash());
                for other in 0..TIPS {
                    let was = if other == tip(number) {
                        new
                    } else {
                        expected[other].1
                    };
                    assert_eq!(
                        found[other].1, was,
                        "save {number}, step {steps}, {look:?}, tip {other}"
                    );
                }
                assert_eq!(found[tip(number)].0, Stored::InUse);
            }
        }
    }
    cuts
}

#[test]
fn power_may_fail_at_every_step_of_every_save_of_a_hand() {
    let cuts = sweep::<SLOT, WORD>(0..14) + sweep::<SLOT, DOUBLE_WORD>(0..14);
    println!("{cuts} cuts");
    assert!(cuts > 4_000, "{cuts}");
}

#[test]
fn power_may_fail_while_the_slots_of_a_board_turn_over() {
    for (cuts, places) in [
        (sweep::<SECTOR, WORD>(85..86), SECTOR / LENGTH),
        (sweep::<PAGE, DOUBLE_WORD>(10..11), PAGE / LENGTH),
    ] {
        println!("{places} places: {cuts} cuts");
        assert!(places == 85 || places == 10, "{places}");
        assert!(cuts > 150, "{cuts}");
    }
}

#[test]
fn a_tip_that_is_forgotten_leaves_the_others_theirs() {
    let (flash, mut expected) = histories::<SLOT, WORD>(5).pop().expect("the last");
    let mut store = open(flash);
    assert_eq!(block_on(store.save(later(), 3, None)), Ok(()));
    expected[3] = (Stored::None, None);
    assert_eq!(read_back(&store.clone().into_flash()), expected);
    // It knows which save that was, and the others theirs.
    let numbers: Vec<u32> = (0..TIPS).map(|tip| store.stored(tip).number).collect();
    assert_eq!(numbers, [1, 4, 2, 6, 3]);
    // There is no sixth.
    assert_eq!(block_on(store.save(later(), 5, None)), Err(StoreError::Failed));
    assert_eq!(store.stored(5).state, Stored::None);
}

#[test]
fn what_is_stored_already_is_not_stored_again() {
    let (flash, expected) = histories::<SLOT, WORD>(5).pop().expect("the last");
    let before = flash.steps();
    let mut store = open(flash);
    for number in 0..5 {
        assert_eq!(
            block_on(store.save(later(), tip(number), expected[tip(number)].1)),
            Ok(())
        );
    }
    assert_eq!(store.into_flash().steps(), before);
}

#[test]
fn a_renamed_or_moved_tip_or_one_of_another_design_has_none_and_the_others_theirs() {
    let (flash, mut expected) = histories::<SLOT, WORD>(5).pop().expect("the last");
    let mut other = identities();
    other[2].hash += 77;
    other[4].table_version += 1;
    let mut store = open_as(flash, other);
    let before = [expected[2].1, expected[4].1];
    expected[2] = (Stored::OtherDesign, None);
    expected[4] = (Stored::OtherDesign, None);
    assert_eq!(kept(&store), expected);
    // A save of another tip keeps them: the hand of before finds its own.
    assert_eq!(block_on(store.save(later(), 0, Some(calibration(9)))), Ok(()));
    let found = read_back(&store.into_flash());
    assert_eq!([found[2].1, found[4].1], before);
    assert_eq!(found[0], (Stored::InUse, Some(calibration(9))));
}

#[test]
fn where_a_later_record_may_be_lost_each_tip_is_told_until_its_own_save() {
    let (flash, expected) = histories::<SLOT, DOUBLE_WORD>(7).pop().expect("the last");
    // The last record, of tip 2, cannot be read: places 0 to 3 of slot 0, then 0 to 2 of slot 1.
    let mut store = open(flash.spoilt_at(SLOT + 2 * LENGTH));
    assert!((0..TIPS).all(|tip| store.stored(tip).state == Stored::Unreadable));
    // What is there is in use: of tip 2 the one before.
    assert_eq!(store.stored(tip(6)).calibration, Some(calibration(1)));
    assert_eq!(block_on(store.save(later(), 0, Some(calibration(9)))), Ok(()));
    let mut store = open(store.into_flash());
    let found = kept(&store);
    assert_eq!(found[0], (Stored::InUse, Some(calibration(9))));
    for other in [1, 3, 4] {
        assert_eq!(found[other], (Stored::Unreadable, expected[other].1), "{other}");
    }
    // The same calibration again ends the doubt.
    assert_eq!(block_on(store.save(later(), 1, expected[1].1)), Ok(()));
    assert_eq!(read_back(&store.into_flash())[1], (Stored::InUse, expected[1].1));
}

#[test]
fn the_record_of_a_board_of_one_tip_is_no_hands_and_is_written_over() {
    let bytes = host_tests::nor_flash::saved::<SLOT>(
        fingertip::storage::store::Identity {
            design_hash: 1,
            table_version: 5,
            firmware: [0, 1, 0],
            range: [0, 100_000],
        },
        calibration(3),
    );
    let mut flash = SimulatedFlash::<SLOT, WORD>::erased(1);
    flash.bytes_mut().copy_from_slice(&bytes);
    let mut store = open(flash);
    assert!((0..TIPS).all(|tip| store.stored(tip).state == Stored::Damaged));
    assert_eq!(block_on(store.save(later(), 1, Some(calibration(4)))), Ok(()));
    let found = read_back(&store.into_flash());
    assert_eq!(found[1], (Stored::InUse, Some(calibration(4))));
    assert_eq!(found[0], (Stored::Unreadable, None));
}

#[test]
fn every_operation_may_fail_once_or_for_ever() {
    let (flash, expected) = histories::<SLOT, WORD>(6).pop().expect("the last");
    let (new, mut lost) = (Some(calibration(9)), 0);
    for from in 0..60 {
        for times in [1, u64::MAX] {
            for defect in [Defect::Fails { from, times }, Defect::Pretends { from, times }] {
                let mut store = open(flash.clone().with(defect));
                let saved = block_on(store.save(later(), 3, new));
                let found = read_back(&store.into_flash().powered_up());
                for other in 0..TIPS {
                    let (state, own) = found[other];
                    let saved_now = other == 3 && own == new;
                    if other == 3 && saved.is_ok() {
                        assert_eq!((state, own), (Stored::InUse, new), "{defect:?}");
                    }
                    // Where a start could not read the last record, a tip may be left with less than it had, and is told.
                    if (state, own) != expected[other] && !saved_now {
                        lost += 1;
                        assert_eq!(state, Stored::Unreadable, "{defect:?}: tip {other}");
                    }
                }
            }
        }
    }
    println!("{lost} of 1200 tips are told that a later calibration may be lost");
}
