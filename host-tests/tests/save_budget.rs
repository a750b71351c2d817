//! The limit on saves holds over resets and power cuts, so that the flash of the board with the smallest slots lasts ten years.

use embassy_futures::block_on;
use fingertip::signal::calibration::Calibration;
use fingertip::storage::hand_record::length;
use fingertip::storage::hand_store::{HandStore, TipIdentity};
use fingertip::storage::log::StoreError;
use fingertip::storage::record::LENGTH;
use fingertip::storage::save_budget::{AT_ONCE, SLOWEST};
use fingertip::storage::store::{Identity, Store};
use fingertip::units::{Microseconds, Millipascals};
use host_tests::nor_flash::{ERASE_STEPS, HalfDone, SimulatedFlash};

/// The NUCLEO-L432KC's: a page of 2 KB, double words with error correction.
const PAGE: usize = 2 * 1024;
type Flash = SimulatedFlash<PAGE, 8>;

/// Soon after a start.
const SOON: Microseconds = Microseconds(3_000_000);
/// A run that is long enough for one more save.
const LONG: Microseconds = Microseconds(SLOWEST + 2 * 2_100_000);

fn calibration(number: i32) -> Calibration {
    Calibration {
        zero: Some(Millipascals(20_000_000 + number)),
        ..Calibration::default()
    }
}

/// A start, and one save at this time.
fn start_and_save(flash: Flash, now: Microseconds, number: i32) -> (Flash, Result<(), StoreError>) {
    let identity = Identity {
        design_hash: 1,
        table_version: 5,
        firmware: [0, 1, 0],
        range: [0, 100_000],
    };
    let (mut store, _) = block_on(Store::open(flash, PAGE as u32, identity));
    let saved = block_on(store.save(now, Some(calibration(number))));
    (store.into_flash(), saved)
}

#[test]
fn a_board_that_saves_at_every_start_comes_to_the_limit_too() {
    let (mut flash, mut done) = (Flash::erased(1), 0);
    for number in 0..100 {
        let (after, saved) = start_and_save(flash, SOON, number);
        done += u32::from(saved.is_ok());
        assert!(saved.is_ok() || saved == Err(StoreError::TooSoon), "{saved:?}");
        assert_eq!(saved.is_ok(), (number as u32) < AT_ONCE, "{number}");
        flash = after;
    }
    assert_eq!(done, AT_ONCE);
    // Each run of 6.5 minutes pays for one.
    for number in 100..110 {
        let (after, saved) = start_and_save(flash, LONG, number);
        assert_eq!(saved, Ok(()), "{number}");
        let (after, again) = start_and_save(after, SOON, number + 1000);
        assert_eq!(again, Err(StoreError::TooSoon), "{number}");
        flash = after;
    }
}

/// What is stored already is not written, and costs nothing.
#[test]
fn the_same_calibration_again_is_no_save() {
    let mut flash = Flash::erased(1);
    for _ in 0..100 {
        let (after, saved) = start_and_save(flash, SOON, 7);
        assert_eq!(saved, Ok(()));
        flash = after;
    }
    assert_eq!(flash.steps(), LENGTH as u64 / 8);
}

/// Power fails in each save, at each of its steps in turn: the places that are left count.
#[test]
fn a_save_that_is_cut_at_every_start_comes_to_the_limit() {
    for steps in 1..LENGTH as u64 / 8 {
        for &look in HalfDone::CORRECTED {
            let mut flash = Flash::erased(1);
            for number in 0..100 {
                let cut = flash.failing_after(steps).leaving(look, u64::from(number as u32));
                flash = start_and_save(cut, SOON, number).0.powered_up();
            }
            // Without an erasure a page has room for 42, of which one is lost where the first unit is whole and blank.
            let worn = flash.steps() / (steps + 1);
            assert!(worn <= u64::from(AT_ONCE) + 1, "{steps}, {look:?}: {worn} saves");
        }
    }
}

/// Power fails in each erasure of the other slot, which leaves no trace: behind a full slot a start has to wait.
#[test]
fn an_erasure_that_is_cut_at_every_start_comes_to_the_limit() {
    let mut flash = Flash::erased(1);
    let places = (PAGE / LENGTH) as i32;
    for number in 0..places {
        let (after, saved) = start_and_save(flash, LONG, number);
        assert_eq!(saved, Ok(()), "{number}");
        flash = after;
    }
    let full = flash.steps();
    for number in 0..100 {
        let cut = flash.failing_after(ERASE_STEPS / 2);
        let (after, saved) = start_and_save(cut, SOON, number + 1000);
        assert_eq!(saved, Err(StoreError::TooSoon), "{number}");
        flash = after.powered_up();
    }
    assert_eq!(flash.steps(), full);
    assert_eq!(start_and_save(flash, LONG, 2000).1, Ok(()));
}

/// All tips of a hand share the slots, and the limit.
#[test]
fn a_hand_has_one_limit_for_all_its_tips() {
    const TIPS: usize = 5;
    let identities = std::array::from_fn(|tip| TipIdentity {
        hash: tip as u64 + 1,
        table_version: 5,
        range: [0, 100_000],
    });
    let mut store = HandStore::<_, TIPS, { length(TIPS) }>::new(
        SimulatedFlash::<PAGE, 8>::erased(1),
        PAGE as u32,
        identities,
        [0, 1, 0],
    );
    block_on(store.load());
    let mut save = |now, number: i32| {
        let tip = number as usize % TIPS;
        block_on(store.save(now, tip, Some(calibration(number))))
    };
    for number in 0..100 {
        let expected = if number < AT_ONCE as i32 {
            Ok(())
        } else {
            Err(StoreError::TooSoon)
        };
        assert_eq!(save(SOON, number), expected, "{number}");
    }
    // Ten records a page: ten years / (2 x 10 000 x 10) are 26.3 minutes.
    assert_eq!(save(Microseconds(1_560_000_000), 100), Err(StoreError::TooSoon));
    assert_eq!(save(Microseconds(1_590_000_000), 100), Ok(()));
}
