//! How far the reports are from the truth.

use crate::plant::Plant;
use crate::record::Row;
use fingertip::status::Status;
use model_tables::curve::Contact;

/// Errors are taken in percent of reading from this share of full scale up.
pub const FROM_SHARE_OF_FULL_SCALE: f64 = 0.05;

/// Standard deviations of the transducer's noise that a report may be off.
const DEVIATIONS: f64 = 2.0;

/// From where on a pressure rise is wrong, in the transducer's noise or resolution, whichever is more. A report is one sample
/// of a part on a bus where its neighbours came late, else an average: white noise of one gets there once in two million.
const WRONG: f64 = 5.0;

/// What a run comes to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunAccuracy {
    /// Reports with values.
    pub readings: usize,
    /// Median error of the force, share of reading, over the reports from 5 % of full scale up.
    pub force_median: f64,
    /// Median error of the indentation, relative to its reading.
    pub indentation_median: f64,
    /// Root mean square of the pressure rise's error, pascals, over all readings.
    pub pressure_error: f64,
    /// Share of the readings whose pressure rise is within two standard deviations of the transducer's noise.
    pub pressure_within: f64,
    /// Share of the readings whose force a pressure within two standard deviations and the tables' accuracy explain. Not a number of a
    /// press in time, where no curve explains it.
    pub force_within: f64,
    /// The same of the indentation, relative.
    pub indentation_within: f64,
}

/// Error of the force as a share of the true force, for a row from 5 % of full scale up.
pub fn force_error(row: &Row, full_scale: Contact) -> Option<f64> {
    share(row.truth.force, row.reported?.force, full_scale.force)
}

/// Error of the indentation as a share of the true one, for a row from 5 % of full scale up.
pub fn indentation_error(row: &Row, full_scale: Contact) -> Option<f64> {
    share(
        row.truth.indentation,
        row.reported?.indentation,
        full_scale.indentation,
    )
}

fn share(truth: f64, reported: f64, full_scale: f64) -> Option<f64> {
    (truth >= FROM_SHARE_OF_FULL_SCALE * full_scale).then(|| reported / truth - 1.0)
}

/// Whether pressure rise, force and indentation are what a pressure within `deviations` standard deviations of
/// the transducer's noise around the truth would give, through tables as accurate as the design asks.
pub fn within(row: &Row, plant: &Plant, deviations: f64) -> Option<[bool; 3]> {
    let reported = row.reported?;
    let allowed = deviations * plant.transducer().noise;
    let rise = row.truth.pressure_rise;
    Some(explained(reported, [rise - allowed, rise + allowed], plant))
}

/// Whether pressure rise, force and indentation are what pressure rises between these two would give, through tables as
/// accurate as the design asks.
fn explained(reported: Contact, rises: [f64; 2], plant: &Plant) -> [bool; 3] {
    let [low, high] = rises.map(|rise| plant.curve().at_pressure_rise(rise));
    if plant.timed().is_some() {
        // No curve of pressure explains force and indentation in time.
        return [
            (rises[0]..=rises[1]).contains(&reported.pressure_rise),
            true,
            true,
        ];
    }
    let [force, indentation] = plant.tables_allowed();
    let between = |low: f64, reported: f64, high: f64, tables: f64| {
        (low * (1.0 - tables)..=high * (1.0 + tables)).contains(&reported)
    };
    [
        (rises[0]..=rises[1]).contains(&reported.pressure_rise),
        between(low.force, reported.force, high.force, force),
        between(
            low.indentation,
            reported.indentation,
            high.indentation,
            indentation,
        ),
    ]
}

/// A reading that the firmware vouches for and that is not so: pressure rise, force or indentation are none that the fingertip
/// had while the samples of the report were measured, not even with [`WRONG`] times the transducer's noise or resolution
/// added or taken away, and through tables as accurate as the design asks.
pub fn is_wrong(row: &Row, plant: &Plant) -> bool {
    let (Status::Ok, Some(reported)) = (row.status, row.reported) else {
        return false;
    };
    let allowed = WRONG * plant.transducer().fineness();
    let [low, high] = plant.pressure_rises(row.time);
    explained(reported, [low - allowed, high + allowed], plant) != [true; 3]
}

/// Mean magnitude of the force's error of a press in time, percent of its peak force: of the firmware, and of tables of the settled wall on
/// a plate at the pressure that the firmware reports. `None` without a reading, or where the press is none in time.
pub fn force_errors<'a>(rows: impl IntoIterator<Item = &'a Row>, plant: &Plant) -> Option<[f64; 2]> {
    let peak = plant.timed()?.peak_force();
    let (mut count, mut sums) = (0_u32, [0.0; 2]);
    for row in rows {
        let Some(reported) = row.reported else { continue };
        let tables = plant.curve().at_pressure_rise(reported.pressure_rise);
        count += 1;
        for (sum, force) in sums.iter_mut().zip([reported.force, tables.force]) {
            *sum += (force - row.truth.force).abs();
        }
    }
    (count > 0).then(|| sums.map(|sum| 100.0 * sum / (f64::from(count) * peak)))
}

impl RunAccuracy {
    /// Over all rows with values that the firmware vouches for.
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a Row>, plant: &Plant) -> Self {
        let rows: Vec<&Row> = rows.into_iter().filter(|row| row.status == Status::Ok).collect();
        let full_scale = plant.full_scale();
        let of_rows = |error: fn(&Row, Contact) -> Option<f64>| {
            median(
                rows.iter()
                    .filter_map(|row| error(row, full_scale))
                    .map(f64::abs)
                    .collect(),
            )
        };
        let within: Vec<[bool; 3]> = rows
            .iter()
            .filter_map(|row| within(row, plant, DEVIATIONS))
            .collect();
        let readings = within.len();
        let inside =
            |which: usize| within.iter().filter(|row| row[which]).count() as f64 / readings.max(1) as f64;
        let squares: f64 = rows
            .iter()
            .filter_map(|row| Some(row.reported?.pressure_rise - row.truth.pressure_rise))
            .map(|error| error * error)
            .sum();
        let of_curve = |which: usize| {
            if plant.timed().is_some() {
                f64::NAN
            } else {
                inside(which)
            }
        };
        Self {
            readings,
            force_median: of_rows(force_error),
            indentation_median: of_rows(indentation_error),
            pressure_error: libm::sqrt(squares / readings.max(1) as f64),
            pressure_within: inside(0),
            force_within: of_curve(1),
            indentation_within: of_curve(2),
        }
    }
}

/// The median, or NaN of nothing: nothing measured is nothing proved.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 {
        f64::NAN
    } else {
        0.5 * (values[(n - 1) / 2] + values[n / 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::tests::{closed_form, press, ramp};
    use crate::record::FeedbackPair;
    use fingertip::status::{Fault, Touch};

    /// A row whose force is off by `share`, with a pressure that is off by `pascals`.
    fn row(rise: f64, share: f64, pascals: f64) -> Row {
        let truth = closed_form(rise);
        Row {
            time: 0.0,
            truth,
            status: Status::Ok,
            reported: Some(Contact {
                pressure_rise: rise + pascals,
                force: truth.force * (1.0 + share),
                ..truth
            }),
            sigma: None,
            touch: Touch::Touched,
            feedback: FeedbackPair::default(),
        }
    }

    #[test]
    fn the_median_is_of_the_readings_from_five_percent_up() {
        let plant = press(8e3, ramp());
        // Full scale is 8 kPa, force 1.856 N: 5 % of it is at about 455 Pa.
        let mut rows = vec![row(4e3, 0.001, 0.0), row(6e3, -0.004, 0.0), row(7e3, 0.002, 0.0)];
        rows.extend([row(300.0, 0.5, 0.0); 9]);
        let accuracy = RunAccuracy::of(&rows, &plant);
        assert!((accuracy.force_median - 0.002).abs() < 1e-12);
        assert!(accuracy.indentation_median.abs() < 1e-12);
        assert_eq!(accuracy.readings, 12);
    }

    #[test]
    fn two_deviations_of_ten_pascals_are_twenty_pascals() {
        let plant = press(8e3, ramp());
        // dF/dP at 4 kPa is 2e-4 (1 + 2 * 4e3 / 5e4) = 2.32e-4: 20 Pa are 4.64 mN of 864 mN.
        let rows = [row(4e3, 0.0053, 19.9), row(4e3, -0.0053, -19.9)];
        let accuracy = RunAccuracy::of(&rows, &plant);
        assert!((accuracy.pressure_within - 1.0).abs() < 1e-12);
        assert!((accuracy.force_within - 1.0).abs() < 1e-12);
        assert!((accuracy.pressure_error - 19.9).abs() < 1e-9);
        let rows = [row(4e3, 0.0055, 20.1), row(4e3, 0.0, 0.0)];
        let accuracy = RunAccuracy::of(&rows, &plant);
        assert!((accuracy.pressure_within - 0.5).abs() < 1e-12);
        assert!((accuracy.force_within - 0.5).abs() < 1e-12);
    }

    #[test]
    fn what_the_tables_may_be_off_is_explained_as_well() {
        // 20 Pa explain 0.537 % of the force at 4 kPa (above), and tables of 0.1 % as much more.
        let plant = press(8e3, ramp()).with_tables_allowed([0.001, 0.0]);
        let force_within = |share: f64| RunAccuracy::of(&[row(4e3, share, 0.0)], &plant).force_within;
        assert!((force_within(0.0063) - 1.0).abs() < 1e-12);
        assert!(force_within(0.0065).abs() < 1e-12);
    }

    /// A fingertip held at a pressure rise, and a row of that time.
    fn held(rise: f64, share: f64, pascals: f64) -> (Row, Plant) {
        let mut scenario = ramp();
        let percent = 100.0 * closed_form(rise).indentation / closed_form(8e3).indentation;
        scenario.phase[1].to_percent = Some(percent);
        let row = Row {
            time: 0.55,
            ..row(rise, share, pascals)
        };
        (row, press(8e3, scenario))
    }

    #[test]
    fn a_reading_is_wrong_when_noise_does_not_explain_it() {
        let wrong = |rise, share, pascals| {
            let (row, plant) = held(rise, share, pascals);
            is_wrong(&row, &plant)
        };
        // At 4 kPa 50 Pa explain 11.61 mN of 864 mN, 1.344 %; at 400 Pa 10.17 mN of 80.6 mN, 12.61 %.
        assert!(!wrong(4e3, 0.0133, 0.0) && wrong(4e3, 0.0136, 0.0));
        assert!(!wrong(400.0, 0.125, 0.0) && wrong(400.0, 0.128, 0.0));
        for sign in [-1.0, 1.0] {
            assert!(!wrong(4e3, 0.0, sign * 49.9) && wrong(4e3, 0.0, sign * 50.1));
        }
    }

    #[test]
    fn a_reading_of_a_moving_plate_may_be_of_any_sample_in_it() {
        // A hundredth of the indentation in 4 ms. The report of 0.3 s is made of 1.5 ms on either side.
        let plant = press(8e3, ramp());
        let of = |time: f64| Row {
            time: 0.3,
            truth: plant.truth(0.3),
            reported: Some(plant.truth(time)),
            ..row(0.0, 0.0, 0.0)
        };
        assert!(!is_wrong(&of(0.2986), &plant) && !is_wrong(&of(0.3014), &plant));
        // 50 Pa are another 2.8 ms or less of some 18 Pa.
        assert!(is_wrong(&of(0.295), &plant) && is_wrong(&of(0.305), &plant));
    }

    #[test]
    fn the_corner_of_a_press_is_one_of_its_samples() {
        let [low, high] = press(8e3, ramp()).pressure_rises(0.5);
        assert!((high - 8e3).abs() < 1e-6 && low < high - 20.0, "{low} {high}");
        // The press begins within.
        let [low, high] = press(8e3, ramp()).pressure_rises(0.1);
        assert!(low.abs() < 1e-12 && high > 0.0, "{low} {high}");
    }

    #[test]
    fn faults_and_qualified_readings_do_not_count() {
        let plant = press(8e3, ramp());
        let fault = Row {
            status: Status::Fault(Fault::SensorOpen),
            reported: None,
            ..row(4e3, 0.0, 0.0)
        };
        let accuracy = RunAccuracy::of(&[fault], &plant);
        assert_eq!(accuracy.readings, 0);
        assert!(accuracy.force_median.is_nan());
    }
}
