//! Commands, floods, hangs and resets, on the running image.

use crate::{Run, run};
use emulator::accuracy::is_wrong;
use emulator::record::Row;
use fingertip::device::logic::findings;
use fingertip::link::command::{CommandKind, Outcome};
use fingertip::status::{LastFault, ResetCause, Status, Stored, Touch, Warnings};

/// Readings are back this long after a reset, seconds.
const RECOVERY: f64 = 0.05;

fn assert_nothing_is_wrong(run: &Run) {
    let wrong: Vec<&Row> = run
        .record
        .rows
        .iter()
        .filter(|row| is_wrong(row, &run.plant))
        .collect();
    assert!(
        wrong.is_empty(),
        "{} wrong, the first {:?}",
        wrong.len(),
        wrong.first()
    );
}

/// The reports from a time in seconds up to another.
fn between(run: &Run, from: f64, until: f64) -> Vec<&Row> {
    let rows = run.record.rows.iter();
    rows.filter(|row| (from..until).contains(&row.time)).collect()
}

#[test]
fn every_command_is_answered_and_a_pressed_fingertip_is_not_tared() {
    let run = run("commands");
    assert_nothing_is_wrong(&run);
    let answers: Vec<(CommandKind, Outcome)> = run
        .record
        .answers
        .iter()
        .map(|answer| (answer.command, answer.outcome))
        .collect();
    assert_eq!(
        answers,
        [
            (CommandKind::Tare, Outcome::Done),
            (CommandKind::Undo, Outcome::Done),
            (CommandKind::Info, Outcome::Done),
            (CommandKind::SelfTest, Outcome::Done),
            // The emulated flash keeps nothing: what is read back is not what was written.
            (CommandKind::Save, Outcome::MemoryFailed),
            (CommandKind::Tare, Outcome::Touched),
            (CommandKind::Rate, Outcome::Done),
        ]
    );
    assert_eq!(run.record.answers[3].findings, findings::NOT_STORED);
    // Reports go on while flash is erased, all from one bank to the other.
    assert_eq!((run.record.lost, run.record.broken.len()), (0, 0));
    assert_eq!(run.record.hellos.last().map(|hello| hello.samples_lost), Some(0));
    assert_eq!(
        run.record.hellos.last().map(|hello| hello.stored),
        Some(Stored::None)
    );
    let reports = run.record.rows.len();
    assert!(
        (4_600..4_730).contains(&reports),
        "{reports}: one in a hundred at the end"
    );
}

#[test]
fn a_hang_in_a_grasp_is_reset_and_the_grasp_goes_on() {
    let run = run("hang-in-a-grasp");
    assert_nothing_is_wrong(&run);
    assert_eq!(run.resets.len(), 1, "{:?}", run.resets);
    let hello = run.record.hellos.last().expect("it greets");
    assert_eq!(hello.reset_cause, ResetCause::Watchdog);
    assert_eq!(hello.last_fault, LastFault::Hang);
    assert_eq!(hello.resets_in_a_row, 1);
    // The zero from before the reset is in use: readings are right, and ok.
    let after = between(&run, 1.6 + 0.45 + RECOVERY, 2.55);
    assert!(after.len() > 400, "{}", after.len());
    for row in after {
        assert_eq!((row.status, row.touch), (Status::Ok, Touch::Touched), "{row:?}");
    }
}

#[test]
fn a_reset_in_a_grasp_takes_no_zero() {
    let run = run("reset-in-a-grasp");
    assert_nothing_is_wrong(&run);
    assert_eq!(run.resets.len(), 1, "{:?}", run.resets);
    let hello = run.record.hellos.last().expect("it greets");
    assert_eq!(
        (hello.reset_cause, hello.last_fault),
        (ResetCause::Pin, LastFault::None)
    );
    let after = between(&run, 0.9 + 2.0 + RECOVERY, 3.4);
    assert!(after.len() > 300, "{}", after.len());
    for row in after {
        assert_eq!(row.status, Status::Warning(Warnings::ZERO_UNVERIFIED), "{row:?}");
        let read = row.reported.expect("a reading").pressure_rise;
        assert!((read / row.truth.pressure_rise - 1.0).abs() < 0.01, "{row:?}");
    }
}

#[test]
fn a_flood_on_the_line_delays_nothing_and_is_counted() {
    let run = run("serial-flood");
    assert_nothing_is_wrong(&run);
    assert_eq!((run.record.lost, run.record.broken.len()), (0, 0));
    assert_eq!(run.resets, Vec::<String>::new());
    let hello = run.record.hellos.last().expect("it answers after the flood");
    assert_eq!((hello.samples_lost, hello.frames_dropped), (0, 0));
    assert!(hello.commands_refused > 100, "{hello:?}");
    for pair in between(&run, 0.5, 1.4).windows(2) {
        let step = pair[1].time - pair[0].time;
        assert!((step - 1e-3).abs() < 2e-5, "{step} s at {} s", pair[0].time);
    }
}
