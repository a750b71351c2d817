//! The image starts with a calibration in its flash. (What it saves itself is not kept there: the emulated flash cannot
//! be written.)

use crate::{design, firmware};
use emulator::bench;
use emulator::image::Image;
use emulator::record::{Recorder, Recording, Row};
use emulator::scenario::Scenario;
use fingertip::image::ImageDesign;
use fingertip::signal::calibration::Calibration;
use fingertip::status::{Status, Stored, Warnings};
use fingertip::storage::store::Identity;
use fingertip::units::Millipascals;
use host_tests::nor_flash;

/// The default board's slots, and where they lie.
const SLOT: usize = 16 * 1024;
const CALIBRATION: u64 = 0x0810_0000;
/// The trim that is stored: 2 % more, parts in a million.
const GAIN: i32 = 20_000;

/// An image with a calibration in its flash, saved for the design of this hash and a transducer's range in pascals.
pub(crate) fn with_stored(
    image: &Image,
    design_hash: u64,
    range: [i32; 2],
    calibration: Calibration,
) -> Image {
    let identity = Identity {
        design_hash,
        table_version: ImageDesign::CONSTANTS.table_version,
        firmware: [0, 1, 0],
        range,
    };
    let bytes = nor_flash::saved::<SLOT>(identity, calibration);
    image.clone().with_flash(CALIBRATION, bytes)
}

/// Runs the default scenario with this hash in the stored record.
fn run(design_hash: u64) -> Recording {
    let constants = ImageDesign::CONSTANTS;
    let calibration = Calibration {
        zero: Some(Millipascals(constants.rest_pressure * 1000)),
        gain: GAIN,
        ..Calibration::default()
    };
    let image = with_stored(firmware(), design_hash, constants.transducer.range, calibration);
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome = bench::run(&image, plant, 2.0, &[], recorder).expect("the image runs");
    assert_eq!((outcome.resets, outcome.gaps), (vec![], vec![]), "resets, gaps");
    outcome.listener.into_record()
}

/// Reported over true pressure rise in the hold, and the statuses there.
fn held(record: &Recording) -> (f64, Vec<Status>) {
    let rows = record.rows.iter().filter(|row| (1.6..1.95).contains(&row.time));
    let ratio = |row: &Row| row.reported.expect("a reading").pressure_rise / row.truth.pressure_rise;
    let ratios: Vec<f64> = rows.clone().map(ratio).collect();
    let mut statuses: Vec<Status> = rows.map(|row| row.status).collect();
    statuses.dedup();
    (ratios.iter().sum::<f64>() / ratios.len() as f64, statuses)
}

#[test]
fn a_stored_calibration_is_in_use() {
    let record = run(design().hash());
    let hello = record.hellos.last().expect("it greets");
    assert_eq!((hello.stored, hello.stored_sequence), (Stored::InUse, 1));
    let (ratio, statuses) = held(&record);
    assert!((ratio - 1.02).abs() < 1e-3, "{ratio}");
    // 98 % of the tables and 2 % more of the pressure is beyond them.
    assert!(
        statuses
            .iter()
            .all(|status| matches!(status, Status::Ok | Status::Warning(Warnings::SATURATED))),
        "{statuses:?}"
    );
}

#[test]
fn another_designs_calibration_is_refused_and_reported() {
    let record = run(!design().hash());
    let hello = record.hellos.last().expect("it greets");
    assert_eq!(hello.stored, Stored::OtherDesign);
    let (ratio, statuses) = held(&record);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    assert_eq!(statuses, [Status::Warning(Warnings::CALIBRATION_REFUSED)]);
}
