//! Series of walls from press-and-hold records: of the solid in time, read with noise, and of an independent code.
//!
//! Coverage over more records than a test has time for: `FIT_REPEATS=200 cargo test --release -p designer --test relaxation_fit
//! intervals -- --nocapture`.

mod noise;
mod program;

use designer::fit::data::DataChoice;
use designer::fit::relaxation::record::HoldRecord;
use designer::fit::relaxation::{FittedTerm, HoldError, Identifiability, RelaxationFit, fit_relaxation};
use fingertip::signal::design::Design as _;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::Relaxing;
use model_tables::design_file::DesignFile;
use model_tables::generate;
use model_tables::material::relaxation::{AGILUS30_RELAXATION, MAX_TERMS, Relaxation, Term};
use model_tables::material::series::{SeriesStep, WallSeries};
use model_tables::random::Random;
use model_tables::solid::history::{Drive, History};
use model_tables::solid::mesh::Elements;
use model_tables::units::PressureRise;
use noise::deviate;
use program::refusal;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The printed fingertip, its series unknown.
const PRINTED: &str = "name = \"printed\"\n\
    [membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 1\n\
    [material]\npreset = \"agilus30\"\n\
    [model]\nkind = \"solid\"\nthrough = 1\nalong = 24\n\
    [press]\nmax_indentation_mm = 2.2\n\
    [transducer]\nkind = \"ratiometric\"\nrange_kpa = [-10, 900]\nresolution_pa = 100\n\
    [accuracy]\nforce_percent_of_reading = 1\nindentation_percent_of_reading = 1\nfrom_percent_of_full_scale = 1\n";
const ELEMENTS: Elements = Elements {
    through: 1,
    along: 24,
};
/// Noise of the pressure, pascals.
const NOISE: f64 = 2.0;

/// A silicone that relaxes by 13 % within 5 s.
fn silicone() -> Relaxation {
    let term = |time: f64, weight: f64| Term { time, weight };
    Relaxation::new(&[term(0.05, 0.04), term(0.5, 0.06), term(5.0, 0.05)], 20.0, 0.0)
}

fn design() -> DesignFile {
    DesignFile::parse(PRINTED, "printed.toml").expect("a design")
}

/// Instants of a press in half a second and a hold: seconds and millimetres. Rows lie 10 ms apart, and in the hold ever farther.
fn press_and_hold(depth: f64, hold: f64) -> Vec<[f64; 2]> {
    let mut instants: Vec<[f64; 2]> = (0..=50)
        .map(|i| f64::from(i) / 50.0)
        .map(|x| [0.5 * x, depth * x])
        .collect();
    let (mut since, mut step) = (0.0, 0.01);
    while since < hold {
        since = hold.min(since + step);
        step *= 1.06;
        instants.push([0.5 + since, depth]);
    }
    instants
}

/// What a wall reads there: seconds, millimetres, pascals, newtons.
fn truth(series: &Relaxation, instants: &[[f64; 2]]) -> Vec<[f64; 4]> {
    let mut history = History::new(&design().design(), series, ELEMENTS, 0.0, 0.0).expect("at rest");
    instants
        .iter()
        .enumerate()
        .map(|(i, &[seconds, millimetres])| {
            let drive = Drive::Indentation(1e-3 * millimetres);
            let instant = if i == 0 {
                history.now()
            } else {
                history.advance(seconds, drive).expect("a press")
            };
            [seconds, millimetres, instant.pressure_rise, instant.force]
        })
        .collect()
}

const HEADER: &str = "trial,time_s,indentation_mm,pressure_rise_pa\n";

/// Rows of a trial with the pressure's noise.
fn read(trial: &str, truth: &[[f64; 4]], random: &mut Random) -> String {
    let mut text = String::new();
    for [seconds, millimetres, pascals, _] in truth {
        let pascals = pascals + NOISE * deviate(random);
        writeln!(text, "{trial},{seconds},{millimetres},{pascals}").expect("a string");
    }
    text
}

fn record(text: &str) -> HoldRecord {
    HoldRecord::read(text.as_bytes(), "hold.csv", &DataChoice::default()).expect("a record")
}

fn fitted(text: &str) -> RelaxationFit {
    fit_relaxation(&design(), &record(text), false).expect("a fit")
}

fn stiffness(series: &Relaxation, seconds: f64) -> f64 {
    series
        .terms()
        .iter()
        .fold(1.0, |sum, term| sum + term.weight * (-seconds / term.time).exp())
}

/// Whether intervals of time and weight have the truth in them.
fn covers(term: &FittedTerm, truth: Term) -> [bool; 2] {
    let within =
        |ends: Option<[f64; 2]>, value: f64| ends.is_some_and(|[low, high]| (low..=high).contains(&value));
    [
        within(term.time_interval(), truth.time),
        within(term.weight_interval(), truth.weight),
    ]
}

#[test]
fn intervals_have_the_truth_in_them_as_often_as_they_say() {
    let repeats: u32 = std::env::var("FIT_REPEATS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(6);
    // Terms that a hold of 60 s tells.
    for (name, series, told) in [
        ("silicone", silicone(), 0..3),
        ("agilus30", AGILUS30_RELAXATION, 2..5),
    ] {
        let truth = truth(&series, &press_and_hold(1.4, 60.0));
        let (mut hits, mut all, mut right) = ([0_u32; 2], 0_u32, 0_u32);
        let mut most = [0.0_f64; 2];
        for repeat in 0..repeats {
            let fit = fitted(&(HEADER.to_owned() + &read("a", &truth, &mut Random(100 + u64::from(repeat)))));
            right += u32::from(fit.terms.len() == series.terms().len());
            for &term in &series.terms()[told.clone()] {
                let off = |found: &&FittedTerm| (found.time / term.time).ln().abs();
                let found = fit
                    .terms
                    .iter()
                    .min_by(|a, b| off(a).total_cmp(&off(b)))
                    .expect("terms");
                let covered = covers(found, term);
                all += 1;
                for k in 0..2 {
                    hits[k] += u32::from(covered[k]);
                }
                most[0] = most[0].max(off(&found));
                most[1] = most[1].max((found.weight / term.weight).ln().abs());
            }
        }
        let share = hits.map(|hits| f64::from(hits) / f64::from(all));
        println!(
            "{name}: {repeats} records: 95 % intervals have tau in {:.1} %, g in {:.1} %; farthest {:.2} % and {:.2} %; the true number \
             of terms in {right}",
            100.0 * share[0],
            100.0 * share[1],
            100.0 * most[0],
            100.0 * most[1]
        );
        // Three standard deviations below 95 %.
        let least = 0.95 - 3.0 * (0.95 * 0.05 / f64::from(all)).sqrt();
        assert!(
            share.iter().all(|share| *share > least),
            "{name}: {share:?}, at least {least}"
        );
    }
}

/// The design with a series.
fn with(series: &Relaxation) -> DesignFile {
    DesignFile {
        relaxation: Some(*series),
        ..design()
    }
}

/// Largest errors of the chip's stages, in percent of the largest force and indentation of a press: with a series, from the pressures of
/// the
/// truth.
fn read_by_the_chip(series: &Relaxation, truth: &[[f64; 4]]) -> [f64; 2] {
    let generated = generate::from_design(with(series)).expect("tables");
    let block = generated.binary();
    let (chip, _) = LoadedDesign::read(&block).expect("it was just written");
    let bits = chip.parameters().pressure_fraction_bits;
    let memory = WallSeries {
        step: SeriesStep::over(series, 1e-3),
        ..*chip.series().expect("it relaxes")
    };
    let mut wall = Relaxing::<MAX_TERMS>::NEW;
    let most = truth.iter().fold([0.0_f64; 2], |most, row| {
        [most[0].max(row[3]), most[1].max(row[1])]
    });
    let mut errors = [0.0_f64; 2];
    for pair in truth.windows(2) {
        let steps = ((pair[1][0] - pair[0][0]) / 1e-3).round() as u32;
        let mut reading = None;
        for i in 1..=steps {
            let pascals = pair[0][2] + f64::from(i) / f64::from(steps) * (pair[1][2] - pair[0][2]);
            reading = Some(wall.step(&chip, &memory, PressureRise::from_pascals(pascals, bits)));
        }
        let contact = reading.expect("a step").contact;
        errors[0] = errors[0].max(100.0 * (contact.force.newtons() - pair[1][3]).abs() / most[0]);
        errors[1] = errors[1].max(100.0 * (1e3 * contact.indentation.metres() - pair[1][1]).abs() / most[1]);
    }
    errors
}

/// Deeper and slower than the record: 2 mm in 1 s, and held for 2 s.
#[test]
fn a_grasp_is_predicted_from_a_hold_of_a_minute() {
    let held = truth(&AGILUS30_RELAXATION, &press_and_hold(1.4, 60.0));
    let found = fitted(&(HEADER.to_owned() + &read("a", &held, &mut Random(7)))).series;
    let mut grasp: Vec<[f64; 2]> = (0..=200)
        .map(|i| 5e-3 * f64::from(i))
        .map(|t| [t, 2.0 * t])
        .collect();
    grasp.extend((1..=40).map(|i| [1.0 + 0.05 * f64::from(i), 2.0]));
    let grasped = truth(&AGILUS30_RELAXATION, &grasp);
    let known = read_by_the_chip(&AGILUS30_RELAXATION, &grasped);
    let predicted = read_by_the_chip(&found, &grasped);
    println!(
        "chip, largest errors of force and indentation: {predicted:.2?} %, with the true series {known:.2?} %"
    );
    assert!(predicted[0] < 5.0 && predicted[1] < 2.0, "{predicted:?}");
    // The same travel, as the solid has it with both.
    let other = truth(&found, &grasp);
    let largest = |k: usize| grasped.iter().map(|row| row[k]).fold(0.0, f64::max);
    for (k, name) in [(2, "pressure"), (3, "force")] {
        let off = grasped
            .iter()
            .zip(&other)
            .map(|(a, b)| (a[k] - b[k]).abs())
            .fold(0.0, f64::max)
            / largest(k);
        println!("solid, {name}: {:.3} % of the largest", 100.0 * off);
        assert!(off < 0.01, "{name}: {off}");
    }
}

/// A press of 2 mm in 1 s and a hold of 10 s, from another code: within the accuracy of both from the end of the press to that of the hold.
#[test]
fn an_independent_codes_press_gives_the_series_it_was_made_with() {
    let file: Value =
        serde_json::from_str(include_str!("../../tests/reference/relaxation.json")).expect("the file's form");
    let cases = file["cases"].as_array().expect("cases");
    for (id, series, close) in [
        ("A_AG_R1", AGILUS30_RELAXATION, 0.02),
        ("A_SI_R1", silicone(), 0.005),
    ] {
        let case = cases.iter().find(|case| case["id"] == id).expect("its case");
        let column = |name: &str| -> Vec<f64> {
            let values = case[name].as_array().expect("a column");
            values.iter().map(|x| x.as_f64().expect("a number")).collect()
        };
        let [t, h, p, f] = ["t_s", "H_mm", "P_kPa", "F_N"].map(column);
        let mut text = "time_s,indentation_mm,pressure_rise_kpa,force_n\n".to_owned();
        for i in 0..t.len() {
            writeln!(text, "{},{},{},{}", t[i], h[i], p[i], f[i]).expect("a string");
        }
        let held = record(&text);
        assert!(
            held.notes
                .iter()
                .any(|note| note.contains("from the first release on were left out"))
        );
        let fit = fit_relaxation(&design(), &held, false).expect("a fit");
        let mut worst = 0.0_f64;
        for i in 0..=20 {
            let seconds = 0.1 * 100_f64.powf(f64::from(i) / 20.0);
            worst = worst.max((stiffness(&fit.series, seconds) / stiffness(&series, seconds) - 1.0).abs());
        }
        println!(
            "{id}: {} terms, g(t) from 0.1 to 10 s within {:.2} %",
            fit.terms.len(),
            100.0 * worst
        );
        assert!(worst < close, "{id}: {worst}");
    }
}

/// Two temperatures tell the shift; one tells none.
#[test]
fn a_second_temperature_tells_the_shift() {
    let series = Relaxation::new(silicone().terms(), 20.0, 0.2);
    let mut random = Random(3);
    let mut text = "trial,time_s,indentation_mm,pressure_rise_pa,temperature_c\n".to_owned();
    for (name, celsius) in [("cold", 18.0), ("warm", 23.0)] {
        let rows = read(
            name,
            &truth(&series.at(celsius), &press_and_hold(1.4, 60.0)),
            &mut random,
        );
        for row in rows.lines() {
            writeln!(text, "{row},{celsius}").expect("a string");
        }
    }
    let fit = fitted(&text);
    let error = fit.shift_error.expect("two temperatures");
    println!("shift {} +- {error} per kelvin", fit.series.shift);
    assert!(
        (fit.series.shift - 0.2).abs() < 3.0 * error + 1e-3,
        "{} +- {error}",
        fit.series.shift
    );
    assert!((fit.series.temperature - 20.5).abs() < 1e-9);
    // The times are of the mean temperature.
    let at = series.at(20.5);
    for seconds in [0.1, 1.0, 10.0] {
        assert!(
            (stiffness(&fit.series, seconds) / stiffness(&at, seconds) - 1.0).abs() < 2e-3,
            "{seconds} s"
        );
    }
    let one = fitted(
        &(HEADER.to_owned()
            + &read(
                "a",
                &truth(&silicone(), &press_and_hold(1.4, 60.0)),
                &mut Random(4),
            )),
    );
    assert!(one.shift_error.is_none());
}

/// Two depths of one series agree; of two series they do not, and the difference is that of the series.
#[test]
fn depths_are_compared() {
    let shallow = read(
        "shallow",
        &truth(&silicone(), &press_and_hold(0.7, 60.0)),
        &mut Random(5),
    );
    let deep = |series: &Relaxation| read("deep", &truth(series, &press_and_hold(1.4, 60.0)), &mut Random(6));
    let alike = fitted(&(HEADER.to_owned() + &shallow + &deep(&silicone())))
        .depths
        .expect("two depths");
    assert!(!alike.differs, "{alike:?}");
    assert!((alike.depths[0] - 0.7e-3).abs() < 1e-9 && (alike.depths[1] - 1.4e-3).abs() < 1e-9);
    // Half as much again of each weight: 3 % of the whole at the end of the press.
    let softer: Vec<Term> = silicone()
        .terms()
        .iter()
        .map(|term| Term {
            weight: 1.5 * term.weight,
            ..*term
        })
        .collect();
    let other = Relaxation::new(&softer, 20.0, 0.0);
    let unlike = fitted(&(HEADER.to_owned() + &shallow + &deep(&other)))
        .depths
        .expect("two depths");
    println!("alike {alike:?}, unlike {unlike:?}");
    assert!(unlike.differs && unlike.difference > 0.01, "{unlike:?}");
}

/// A wall that has settled by the end of the hold tells its modulus; one that goes on for a quarter of an hour does not.
#[test]
fn the_relaxed_modulus_is_told_or_not() {
    let silicone = truth(&silicone(), &press_and_hold(1.4, 60.0));
    let told = fitted(&(HEADER.to_owned() + &read("a", &silicone, &mut Random(8))))
        .open_moduli
        .expect("moduli");
    assert!(
        told[0] <= 1.0 && told[1] >= 1.0 && told[1] - told[0] < 0.2,
        "{told:?}"
    );
    // A modulus a tenth less than the design's.
    let stiff: Vec<[f64; 4]> = silicone
        .iter()
        .map(|row| [row[0], row[1], 0.9 * row[2], row[3]])
        .collect();
    let text = HEADER.to_owned() + &read("a", &stiff, &mut Random(9));
    let refused = fit_relaxation(&design(), &record(&text), false).expect_err("below the settled wall");
    assert!(
        matches!(refused, HoldError::BelowSettled { ratio, .. } if (ratio - 0.9).abs() < 0.01),
        "{refused}"
    );
    let fit = fit_relaxation(&design(), &record(&text), true).expect("a fit");
    let error = fit.modulus_error.expect("it is free");
    assert!(
        (fit.modulus - 0.9).abs() < 3.0 * error * 0.9 + 1e-3,
        "{} +- {error}",
        fit.modulus
    );

    let agilus = truth(&AGILUS30_RELAXATION, &press_and_hold(1.4, 60.0));
    let fit = fitted(&(HEADER.to_owned() + &read("a", &agilus, &mut Random(8))));
    let open = fit.open_moduli.expect("moduli");
    println!("settled {told:.2?}, relaxing {open:.2?}");
    assert!(open[0] < 0.5 && open[1] > 1.05, "{open:?}");
    let slowest = fit.terms.last().expect("terms");
    assert!(
        slowest.time > 60.0 && slowest.identifiability != Identifiability::Both,
        "{slowest:?}"
    );
}

#[test]
fn what_is_no_record_is_refused_in_a_line() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let write = |name: &str, text: &str| {
        let path = folder.join(format!("hold-{name}"));
        fs::write(&path, text).expect("the test folder");
        path.display().to_string()
    };
    let design = write("design.toml", PRINTED);
    let header = "time_s,indentation_mm,pressure_rise_kpa\n";
    let mut short = header.to_owned();
    let elastic = truth(&Relaxation::new(&[], 20.0, 0.0), &press_and_hold(1.4, 60.0));
    let still = HEADER.to_owned() + &read("a", &elastic, &mut Random(12));
    let mut offset = header.to_owned();
    for i in 0..40 {
        let (t, h) = (0.1 * f64::from(i), (0.1 * f64::from(i)).min(1.0));
        writeln!(short, "{t},{},{}", 0.3 * t, 8.0 * t).expect("a string");
        let settled = 6.75 * h;
        writeln!(offset, "{t},{h},{}", settled + 1.0).expect("a string");
    }
    for (name, text, reason) in [
        (
            "untimed",
            "indentation_mm,pressure_rise_kpa\n0,0\n1,5\n1,4\n",
            "there is no column `time_s`",
        ),
        (
            "one",
            "time_s,pressure_rise_kpa,force_n\n0,0,0\n1,5,1\n2,4,1\n",
            "needs the column indentation_mm",
        ),
        (
            "back",
            "time_s,indentation_mm,pressure_rise_kpa\n0,0,0\n1,1,5\n0.5,1,4\n",
            "line 4: `time_s` is `0.5`: must be after the 1 s",
        ),
        (
            "word",
            "time_s,indentation_mm,pressure_rise_kpa\n0,0,0\n1,1,high\n2,1,4\n",
            "line 3: `pressure_rise_kpa` is `high`",
        ),
        (
            "pressed",
            "time_s,indentation_mm,pressure_rise_kpa\n0,0.5,3\n1,1,5\n2,1,4\n",
            "line 2: the record begins at an indentation of 0.5000 mm",
        ),
        ("short", &short, "hold at least twice as long as the press"),
        ("offset", &offset, "while the tip is untouched: subtract that"),
        ("still", &still, "nothing relaxes in it"),
    ] {
        let line = refusal(&[
            "fit",
            &design,
            &write(&format!("{name}.csv"), text),
            "--relaxation",
        ]);
        assert!(line.contains(reason), "{name}: {line}");
    }
    let line = refusal(&["fit", &design, &design, "--relaxation", "--fit", "material"]);
    assert!(line.contains("cannot be used with"), "{line}");
}

/// What is written is a design that the tool reads, with the series of the rows.
#[test]
fn the_design_has_the_series_that_was_found() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hold-written");
    let design = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hold-written.toml");
    let data = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hold-written.csv");
    fs::write(&design, format!("# my tip\n{PRINTED}")).expect("the test folder");
    let rows = truth(&silicone(), &press_and_hold(1.4, 60.0));
    fs::write(&data, HEADER.to_owned() + &read("a", &rows, &mut Random(11))).expect("the test folder");
    let (header, rows) = program::header_and_rows(&[
        "fit",
        &design.display().to_string(),
        &data.display().to_string(),
        "--relaxation",
        "--out",
        &folder.display().to_string(),
    ]);
    assert_eq!(
        header,
        "term,tau_s,tau_standard_error_s,tau_low_s,tau_high_s,g,g_standard_error,g_low,g_high,identifiable"
    );
    assert_eq!(rows.len(), 3);
    let written = fs::read_to_string(folder.join("printed-relaxing.toml")).expect("it was written");
    assert!(written.starts_with("# my tip\n"));
    let read = DesignFile::parse(&written, "printed-relaxing.toml").expect("a design");
    let series = read.relaxation.expect("its series");
    for (term, row) in series.terms().iter().zip(&rows) {
        let number = |text: &str| -> f64 { text.parse().expect("a number") };
        assert!(
            (term.time / number(&row[1]) - 1.0).abs() < 1e-5
                && (term.weight / number(&row[5]) - 1.0).abs() < 1e-5
        );
    }
    let residuals = fs::read_to_string(folder.join("residuals.csv")).expect("it was written");
    assert_eq!(residuals.lines().count(), 1 + rows_of(&data));
    assert!(
        fs::read_to_string(folder.join("relaxation.svg"))
            .expect("it was written")
            .contains("<svg")
    );
}

fn rows_of(path: &Path) -> usize {
    fs::read_to_string(path).expect("it was written").lines().count() - 1
}
