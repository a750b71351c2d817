//! The stored calibration survives a power cut at every step, every failing operation, and whatever lies in the flash.

use embassy_futures::block_on;
use fingertip::calibration::Calibration;
use fingertip::record::LENGTH;
use fingertip::store::{Identity, Store, StoreError};
use fingertip::telemetry::Stored;
use fingertip::transducer::Millipascals;
use host_tests::assert_faults_says;
use host_tests::nor_flash::{Defect, SimulatedFlash};

const IDENTITY: Identity = Identity {
    design_hash: 0x0123_4567_89AB_CDEF,
    table_version: 1,
    firmware: [0, 1, 0],
    range: [0, 100_000],
};

/// Few places, so that slots turn over often.
const SLOT: usize = 8 * LENGTH;
type Flash = SimulatedFlash<SLOT>;

fn calibration(number: i32) -> Calibration {
    Calibration {
        zero: Some(Millipascals(20_000_000 + number)),
        ..Calibration::default()
    }
}

fn open<const N: usize>(flash: SimulatedFlash<N>) -> (Store<SimulatedFlash<N>>, Stored) {
    block_on(Store::open(flash, N as u32, IDENTITY))
}

fn save<const N: usize>(
    flash: SimulatedFlash<N>,
    number: i32,
) -> (SimulatedFlash<N>, Result<(), StoreError>) {
    let (mut store, _) = open(flash);
    let saved = block_on(store.save(Some(calibration(number))));
    (store.into_flash(), saved)
}

/// What a start finds.
fn served<const N: usize>(flash: &SimulatedFlash<N>) -> (Stored, Option<Calibration>) {
    let (store, state) = open(flash.clone());
    (state, store.calibration())
}

/// Saves 0 to `saves`, each in the memory as the one before left it.
fn histories(saves: i32) -> Vec<Flash> {
    let mut flashes = vec![Flash::erased(1)];
    for number in 0..saves {
        let (flash, saved) = save(flashes[number as usize].clone(), number);
        assert_eq!(saved, Ok(()));
        assert_eq!(served(&flash), (Stored::Serves, Some(calibration(number))));
        flashes.push(flash);
    }
    flashes
}

/// Every step of save `number`, cut with a different look of the half-done step.
fn cuts(before: &Flash, number: i32, seed: u64) -> Vec<Flash> {
    let (whole, _) = save(before.clone(), number);
    (0..whole.steps() - before.steps())
        .map(|steps| {
            let cut = before.clone().seeded(seed + steps).failing_after(steps);
            let (flash, saved) = save(cut, number);
            assert!(saved.is_err(), "cut after {steps} steps");
            flash.powered_up()
        })
        .collect()
}

/// After a cut of save `number` the calibration before it or its own serves, and the next save works.
fn assert_consistent(flash: &Flash, number: i32) {
    let (state, found) = served(flash);
    let before = (number > 0).then(|| calibration(number - 1));
    if found != Some(calibration(number)) {
        assert_eq!(found, before, "save {number}");
        assert!(number == 0 || state == Stored::Serves, "save {number}: {state:?}");
    }
    let (flash, saved) = save(flash.clone(), number + 1);
    assert_eq!(saved, Ok(()), "after save {number}");
    assert_eq!(served(&flash), (Stored::Serves, Some(calibration(number + 1))));
}

#[test]
fn power_may_fail_at_every_step_of_every_save() {
    let flashes = histories(60);
    let mut points = 0;
    for (number, before) in flashes[..60].iter().enumerate() {
        for seed in [1, 1_000_001, 2_000_003, 3_000_017] {
            for flash in cuts(before, number as i32, seed) {
                assert_consistent(&flash, number as i32);
                points += 1;
            }
        }
    }
    assert_faults_says(&format!("{points} power cuts, one at every step of 60 saves"));
}

#[test]
fn power_may_fail_again_at_every_step_of_the_save_after_a_cut() {
    // The ninth save turns the slots over: the one before it, it, and the one after.
    let flashes = histories(10);
    let mut points = 0;
    for number in 7..10_i32 {
        for first in cuts(&flashes[number as usize], number, 7) {
            let (_, found) = served(&first);
            let before = if found == Some(calibration(number)) {
                number
            } else {
                number - 1
            };
            for second in cuts(&first, number + 1, 11) {
                let (state, found) = served(&second);
                assert_eq!(state, Stored::Serves);
                assert!(
                    found == Some(calibration(before)) || found == Some(calibration(number + 1)),
                    "{found:?}"
                );
                points += 1;
            }
        }
    }
    assert_faults_says(&format!("{points} pairs of cuts"));
}

#[test]
fn the_slots_of_the_board_turn_over_too() {
    const BOARD: usize = 16 * 1024;
    let mut flash = SimulatedFlash::<BOARD>::erased(1);
    let places = (BOARD / LENGTH) as i32;
    let (mut store, _) = open(flash);
    for number in 0..=places {
        assert_eq!(block_on(store.save(Some(calibration(number)))), Ok(()));
    }
    flash = store.into_flash();
    assert_eq!(served(&flash), (Stored::Serves, Some(calibration(places))));
    assert_eq!(flash.steps(), (places as u64 + 1) * LENGTH as u64 / 4 + 16);
}

#[test]
fn every_operation_may_fail_once_or_for_ever() {
    let flashes = histories(12);
    let mut failures = 0;
    for (number, before) in flashes[..12].iter().enumerate() {
        let number = number as i32;
        let (whole, _) = save(before.clone().with(Defect::None), number);
        for from in 0..whole.operations() {
            for times in [1, u64::MAX] {
                for defect in [Defect::Fails { from, times }, Defect::Pretends { from, times }] {
                    let (flash, saved) = save(before.clone().with(defect), number);
                    let flash = flash.powered_up();
                    let (_, found) = served(&flash);
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
    assert_eq!(block_on(store.save(Some(calibration(6)))), Ok(()));
    let (store, state) = block_on(Store::open(store.into_flash(), SLOT as u32, other));
    assert_eq!(
        (state, store.calibration()),
        (Stored::Serves, Some(calibration(6)))
    );
}

#[test]
fn values_that_cannot_be_are_refused_though_their_check_fits() {
    let (mut store, _) = open(Flash::erased(1));
    let absurd = Calibration {
        gain: 2_000_000,
        ..Calibration::default()
    };
    assert_eq!(block_on(store.save(Some(absurd))), Ok(()));
    assert_eq!(served(&store.into_flash()), (Stored::Damaged, None));
}

#[test]
fn what_was_stored_can_be_made_void() {
    let (flash, _) = save(Flash::erased(1), 5);
    let (mut store, _) = open(flash);
    assert_eq!(block_on(store.save(None)), Ok(()));
    assert_eq!(served(&store.into_flash()), (Stored::None, None));
}

#[test]
fn both_slots_damaged_are_said_so_and_written_again() {
    let flashes = histories(10);
    let mut flash = flashes[10].clone();
    for (i, byte) in flash.bytes_mut().iter_mut().enumerate() {
        *byte ^= (i % 7) as u8 & !1;
    }
    assert_eq!(served(&flash), (Stored::Damaged, None));
    let (flash, saved) = save(flash, 11);
    assert_eq!(saved, Ok(()));
    assert_eq!(served(&flash), (Stored::Serves, Some(calibration(11))));
}

#[test]
fn what_is_stored_already_is_not_stored_again_and_wear_has_an_end() {
    let (flash, _) = save(Flash::erased(1), 5);
    let (again, saved) = save(flash.clone(), 5);
    assert_eq!((saved, again.steps()), (Ok(()), flash.steps()));

    // 8 saves to a slot: 20 000 erasures are 160 000 saves.
    let (mut store, _) = open(Flash::erased(1));
    let worn = (0..200_000)
        .find(|&number| block_on(store.save(Some(calibration(number)))) == Err(StoreError::WornOut));
    assert_eq!(worn, Some(8 + 20_000 * 8));
    let last = worn.map_or(0, |worn| worn - 1);
    assert_eq!(
        served(&store.into_flash()),
        (Stored::Serves, Some(calibration(last)))
    );
}
