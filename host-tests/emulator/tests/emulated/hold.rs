//! A minute of one grasp on the running image.

use crate::run;
use fingertip::status::Status;
use host_tests::assert_faults_says;

/// When the grasp stands still, seconds.
const STANDS: f64 = 0.85;
/// Of each end of the hold, seconds: their mean has no noise to speak of.
const MEAN: f64 = 5.0;

#[test]
fn the_force_of_a_grasp_of_a_minute_stays() {
    let run = run("long-hold");
    let mean = |from: f64, until: f64| {
        let rows = run.record.rows.iter();
        let held: Vec<f64> = rows
            .filter(|row| (from..until).contains(&row.time))
            .map(|row| {
                assert_eq!(row.status, Status::Ok, "{row:?}");
                row.reported.expect("a reading").force
            })
            .collect();
        assert!(held.len() > 4_900, "{}", held.len());
        held.iter().sum::<f64>() / held.len() as f64
    };
    let (first, last) = (mean(STANDS, STANDS + MEAN), mean(run.time - MEAN, run.time));
    let moved = 100.0 * (last / first - 1.0).abs();
    let reports = run.record.rows.len();
    println!("{reports} reports; from {first:.6} N to {last:.6} N, {moved:.4} %");
    assert!(moved < 0.05, "{moved} %");
    assert_faults_says(
        "emulated, 60 s of a grasp at 50 % of the indentation: the force moves by less than 0.05 %",
    );
    assert_eq!((run.record.lost, run.resets.len()), (0, 0));
}
