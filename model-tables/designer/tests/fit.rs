//! Fits to synthetic benches: a known device, pressed by the full model, read with noise.
//!
//! Coverage over more repeats than a test has time for: `FIT_REPEATS=200 cargo test --release -p designer --test fit
//! standard_errors -- --nocapture`.

mod noise;

use designer::fit::data::{Data, DataChoice};
use designer::fit::findings::findings;
use designer::fit::parameter::Parameter;
use designer::fit::{self, Fit, FitError, Held, Measured};
use model_tables::design_file::DesignFile;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use model_tables::random::Random;
use noise::deviate;
use std::fmt::Write as _;

const DESIGN: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/commands/stand-in.toml"));

/// What the device really is.
const TRUTH: &str =
    "\n[calibration]\nmaterial_factor = 1.3\npole_stretch = 1.05\ncompliance_mm3_per_kpa = 0.8\n";

fn design(extra: &str) -> DesignFile {
    DesignFile::parse(&format!("{DESIGN}{extra}"), "design.toml").expect("a design")
}

/// Indentation (mm), force (N), pressure rise (kPa) of the full model, without noise.
fn press(file: &DesignFile, depths: &[f64]) -> Vec<[f64; 3]> {
    let mut press = Press::new(&file.design(), TensionField::Relaxed).expect("a rest state");
    depths
        .iter()
        .map(|&depth| {
            let contact = press.contact_at(1e-3 * depth).expect("within the limit");
            [depth, contact.force, 1e-3 * contact.pressure_rise]
        })
        .collect()
}

fn depths(count: usize) -> Vec<f64> {
    (1..=count).map(|k| 2.5 * k as f64 / count as f64).collect()
}

/// CSV of rows, each number of force and pressure times one plus `noise` times a normal deviate.
fn bench(rows: &[[f64; 3]], noise: f64, random: &mut Random) -> String {
    let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
    for [depth, force, rise] in rows {
        let force = force * (1.0 + noise * deviate(random));
        let rise = rise * (1.0 + noise * deviate(random));
        let _ = writeln!(text, "{depth},{force},{rise}");
    }
    text
}

fn data(text: &str) -> Data {
    Data::parse(text, "bench.csv", &DataChoice::default()).expect("good data")
}

fn value(fit: &Fit, parameter: Parameter) -> (f64, f64) {
    let estimate = fit
        .estimates
        .iter()
        .find(|estimate| estimate.parameter == parameter);
    let estimate = estimate.expect("it was chosen");
    (estimate.value, estimate.standard_error.expect("it was fitted"))
}

const FITTED: [(Parameter, f64); 3] = [
    (Parameter::Material, 1.3),
    (Parameter::PoleStretch, 1.05),
    (Parameter::Compliance, 0.8),
];

#[test]
fn a_perfect_bench_gives_the_device() {
    let rows = press(&design(TRUTH), &depths(20));
    let fit = fit::fit(
        &design(""),
        &data(&bench(&rows, 0.0, &mut Random(1))),
        &Parameter::USUAL,
    )
    .expect("a fit");
    for (parameter, truth) in FITTED {
        let (found, _) = value(&fit, parameter);
        assert!(
            (found / truth - 1.0).abs() < 1e-3,
            "{parameter}: {found} for {truth}"
        );
    }
}

#[test]
fn standard_errors_cover_the_truth_as_often_as_they_should() {
    let repeats: u64 = std::env::var("FIT_REPEATS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(60);
    let rows = press(&design(TRUTH), &depths(25));
    let file = design("");
    let (mut within, mut within_two, mut squares) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    for repeat in 0..repeats {
        let text = bench(&rows, 0.01, &mut Random(1000 + repeat));
        let fit = fit::fit(&file, &data(&text), &Parameter::USUAL).expect("a fit");
        for (k, (parameter, truth)) in FITTED.into_iter().enumerate() {
            let (found, error) = value(&fit, parameter);
            let off = (found - truth) / error;
            within[k] += f64::from(u8::from(off.abs() < 1.0)) / repeats as f64;
            within_two[k] += f64::from(u8::from(off.abs() < 2.0)) / repeats as f64;
            squares[k] += off * off / repeats as f64;
        }
    }
    println!("within one standard error (0.683 expected) over {repeats} repeats: {within:.3?}");
    println!("within two (0.954 expected): {within_two:.3?}");
    println!("mean square in standard errors (1 expected): {squares:.3?}");
    // Three standard deviations of a binomial share, and of a mean square: standard errors twice too large, or a quarter too small, fail.
    let chance = |variance: f64| 3.0 * (variance / repeats as f64).sqrt();
    for k in 0..3 {
        assert!((within[k] - 0.683).abs() < chance(0.683 * 0.317), "{within:?}");
        assert!(
            (within_two[k] - 0.954).abs() < chance(0.954 * 0.046),
            "{within_two:?}"
        );
        assert!((squares[k] - 1.04).abs() < chance(2.2), "{squares:?}");
    }
}

#[test]
fn modulus_and_wall_act_as_one_and_one_is_held() {
    let rows = press(&design(TRUTH), &depths(20));
    let chosen = [
        Parameter::Thickness,
        Parameter::Material,
        Parameter::PoleStretch,
        Parameter::Compliance,
    ];
    let fit = fit::fit(&design(""), &data(&bench(&rows, 0.01, &mut Random(7))), &chosen).expect("a fit");
    assert_eq!(fit.unidentified.len(), 1);
    assert_eq!(fit.unidentified[0].held, Parameter::Thickness);
    let wall = fit.estimates.iter().find(|e| e.parameter == Parameter::Thickness);
    assert_eq!(wall.expect("chosen").held, Some(Held::Unidentified));
    // Pressure alone does not tell the gain from the stiffness.
    let mut text = String::new();
    for line in bench(&rows, 0.01, &mut Random(8)).lines() {
        let cells: Vec<&str> = line.split(',').collect();
        let _ = writeln!(text, "{},{}", cells[0], cells[2]);
    }
    let chosen = [Parameter::Material, Parameter::PressureGain];
    let fit = fit::fit(&design(""), &data(&text), &chosen).expect("a fit");
    assert_eq!(fit.unidentified[0].held, Parameter::PressureGain);
}

#[test]
fn gain_and_offsets_of_the_bench_are_found() {
    let mut rows = press(&design(TRUTH), &depths(30));
    for [depth, _, rise] in &mut rows {
        *depth += 0.07;
        *rise = 1.08 * *rise + 0.4;
    }
    let chosen = [
        Parameter::Material,
        Parameter::PoleStretch,
        Parameter::Compliance,
        Parameter::PressureGain,
        Parameter::PressureOffset,
        Parameter::IndentationOffset,
    ];
    let text = bench(&rows, 0.002, &mut Random(3));
    let fit = fit::fit(&design(""), &data(&text), &chosen).expect("a fit");
    for (parameter, truth) in FITTED.into_iter().chain([
        (Parameter::PressureGain, 1.08),
        (Parameter::PressureOffset, 0.4),
        (Parameter::IndentationOffset, 0.07),
    ]) {
        let (found, error) = value(&fit, parameter);
        assert!(
            ((found - truth) / error).abs() < 3.5,
            "{parameter}: {found} +- {error} for {truth}"
        );
        assert!(error < 0.2 * truth, "{parameter}: {error}");
    }
}

#[test]
fn outliers_and_the_order_of_rows_do_not_matter() {
    let rows = press(&design(TRUTH), &depths(30));
    let text = bench(&rows, 0.005, &mut Random(5));
    let clean = fit::fit(&design(""), &data(&text), &Parameter::USUAL).expect("a fit");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let header = lines.remove(0);
    let cells: Vec<f64> = lines[20]
        .split(',')
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    lines[20] = format!("{},{},{}", cells[0], 3.0 * cells[1], cells[2]);
    lines.reverse();
    lines.swap(3, 17);
    let dirty = fit::fit(
        &design(""),
        &data(&format!("{header}\n{}\n", lines.join("\n"))),
        &Parameter::USUAL,
    )
    .expect("a fit");
    assert_eq!(
        dirty.residuals.iter().filter(|residual| residual.outlier).count(),
        1
    );
    for (parameter, _) in FITTED {
        let ((a, error), (b, _)) = (value(&clean, parameter), value(&dirty, parameter));
        assert!((a - b).abs() < error, "{parameter}: {a} {b} +- {error}");
    }
}

#[test]
fn pressure_and_force_alone_find_the_stretch() {
    let rows = press(&design(TRUTH), &depths(30));
    let text: String = bench(&rows, 0.002, &mut Random(11))
        .lines()
        .map(|line| line.split_once(',').expect("three cells").1.to_owned() + "\n")
        .collect();
    let chosen = [Parameter::Material, Parameter::PoleStretch];
    let mut file = design("");
    file.compliance_mm3_per_kpa = 0.8;
    let fit = fit::fit(&file, &data(&text), &chosen).expect("a fit");
    let (stretch, error) = value(&fit, Parameter::PoleStretch);
    assert!((stretch - 1.05).abs() < 4.0 * error, "{stretch} +- {error}");
}

#[test]
fn what_cannot_be_is_refused() {
    let rows = press(&design(TRUTH), &depths(12));
    let in_pascals: Vec<[f64; 3]> = rows.iter().map(|[h, f, p]| [*h, *f, 1e3 * p]).collect();
    let refused = |rows: &[[f64; 3]], chosen: &[Parameter]| {
        fit::fit(&design(""), &data(&bench(rows, 0.0, &mut Random(1))), chosen).expect_err("refused")
    };
    assert!(matches!(
        refused(&in_pascals, &Parameter::USUAL),
        FitError::Units { ratio, .. } if ratio > 500.0
    ));
    assert_eq!(refused(&rows, &[]), FitError::NothingChosen);
    let force_alone = data("indentation_mm,force_n\n0.5,0.2\n1,0.6\n2,4.2\n");
    let chosen = [
        Parameter::Material,
        Parameter::PoleStretch,
        Parameter::Compliance,
        Parameter::IndentationOffset,
    ];
    assert_eq!(
        fit::fit(&design(""), &force_alone, &chosen).expect_err("refused"),
        FitError::TooFew {
            data: 3,
            parameters: 4
        }
    );
}

#[test]
fn what_the_model_does_not_explain_is_reported_to_have_an_order() {
    let rows: Vec<[f64; 3]> = press(&design(TRUTH), &depths(24))
        .into_iter()
        .map(|[h, f, p]| [h, f * (1.0 + 0.3 * (3.0 * h).sin()), p])
        .collect();
    let fit = fit::fit(
        &design(""),
        &data(&bench(&rows, 0.002, &mut Random(2))),
        &Parameter::USUAL,
    )
    .expect("a fit");
    assert!(
        fit.systematic[0].expect("enough data") < -2.58,
        "{:?}",
        fit.systematic
    );
    let honest = press(&design(TRUTH), &depths(24));
    let fit = fit::fit(
        &design(""),
        &data(&bench(&honest, 0.01, &mut Random(2))),
        &Parameter::USUAL,
    )
    .expect("a fit");
    assert!(
        fit.systematic[0].is_none_or(|order| order > -2.58),
        "{:?}",
        fit.systematic
    );
    let validation = fit.validation.expect("enough data");
    let force = validation.force.expect("measured");
    assert!(force.rms_percent() < 2.0, "{force:?}");
}

/// Three trials of the device, each from before first touch on, with zeros of their own: text and zeros (mm, N, kPa).
fn trials_with_zeros() -> (String, [[f64; 3]; 3]) {
    const ZEROS: [[f64; 3]; 3] = [[3.21, 0.35, 0.0], [3.48, -0.2, 0.6], [2.97, 0.0, -0.4]];
    let rows = press(&design(TRUTH), &depths(25));
    let mut random = Random(11);
    let mut text = String::from("trial,indentation_mm,force_n,pressure_rise_kpa\n");
    for (name, [stage, cell, transducer]) in ["a", "b", "c"].into_iter().zip(ZEROS) {
        let before = (1..=8).rev().map(|k| [-0.05 * f64::from(k), 0.0, 0.0]);
        for [depth, force, rise] in before.chain(rows.iter().copied()) {
            let [force, rise] =
                [force, rise].map(|value| value + (0.003 + 0.002 * value) * deviate(&mut random));
            let _ = writeln!(
                text,
                "{name},{},{},{}",
                depth + stage,
                force + cell,
                rise + transducer
            );
        }
    }
    (text, ZEROS)
}

#[test]
fn zeros_of_single_trials_are_found_with_the_device() {
    let (text, zeros) = trials_with_zeros();
    let data = data(&text);
    let refused =
        fit::fit(&design(""), &data, &Parameter::USUAL).map(|fit| findings(&design(""), &data, &fit));
    // Without zeros of the trials first touch at 3 mm is no press of the tip, or told.
    match refused {
        Err(error) => assert!(
            error.to_string().contains("--per-trial indentation-offset"),
            "{error}"
        ),
        Ok(lines) => assert!(
            lines
                .iter()
                .any(|line| line.contains("--per-trial indentation-offset")),
            "{lines:?}"
        ),
    }
    let fit = fit::fit_per_trial(&design(""), &data, &Parameter::USUAL, &Measured::ALL).expect("a fit");
    assert_eq!(fit.trial_zeros.len(), 9);
    for zero in &fit.trial_zeros {
        let truth = zeros[zero.trial][zero.quantity as usize];
        let error = zero.standard_error.expect("more data than parameters");
        assert!(
            ((zero.value - truth) / error).abs() < 4.0 && error < 0.05,
            "{zero:?}: {truth}"
        );
    }
    for (parameter, truth) in FITTED {
        let (found, error) = value(&fit, parameter);
        assert!(
            ((found - truth) / error).abs() < 3.5,
            "{parameter}: {found} +- {error} for {truth}"
        );
    }
    let lines = findings(&design(""), &data, &fit);
    assert!(
        !lines
            .iter()
            .any(|line| line.contains("looks") || line.contains("first touch")),
        "{lines:?}"
    );
    let twice = fit::fit_per_trial(
        &design(""),
        &data,
        &[Parameter::Material, Parameter::ForceOffset],
        &[Measured::Force],
    );
    assert_eq!(
        twice.expect_err("refused"),
        FitError::ZeroTwice(Parameter::ForceOffset)
    );
}

#[test]
fn a_zero_or_a_slow_drift_of_one_trial_is_told() {
    let rows = press(&design(TRUTH), &depths(25));
    for (drift, told) in [
        (false, "the force of trial b looks offset by "),
        (true, "the force of trial b looks to drift by "),
    ] {
        let mut random = Random(17);
        let mut text = String::from("trial,indentation_mm,force_n,pressure_rise_kpa\n");
        for name in ["a", "b", "c"] {
            for (k, [depth, force, rise]) in rows.iter().enumerate() {
                let part = if drift { k as f64 / 24.0 } else { 1.0 };
                let off = if name == "b" { 0.4 * part } else { 0.0 };
                let noise = |value: f64, random: &mut Random| value + 0.003 * deviate(random);
                let _ = writeln!(
                    text,
                    "{name},{depth},{},{}",
                    noise(*force, &mut random) + off,
                    noise(*rise, &mut random)
                );
            }
        }
        let data = data(&text);
        let fit = fit::fit(&design(""), &data, &Parameter::USUAL).expect("a fit");
        let lines = findings(&design(""), &data, &fit);
        let line = lines.iter().find(|line| line.starts_with("the force of trial"));
        let found: Option<f64> = line
            .and_then(|line| line.strip_prefix(told)?.split(' ').next())
            .and_then(|number| number.parse().ok());
        assert!(
            found.is_some_and(|found| (found - 0.4).abs() < 0.03),
            "{told}: {lines:?}"
        );
    }
}

#[test]
fn force_and_pressure_that_do_not_vanish_at_the_same_depth_are_told() {
    // The load cell is read late: at each row the force is that of 0.09 mm before.
    let depths = depths(25);
    let shifted: Vec<f64> = depths.iter().map(|depth| depth - 0.09).collect();
    let (now, before) = (press(&design(TRUTH), &depths), press(&design(TRUTH), &shifted));
    let rows: Vec<[f64; 3]> = now
        .iter()
        .zip(before)
        .map(|([depth, _, rise], [_, force, _])| [*depth, force, *rise])
        .collect();
    let late = data(&bench(&rows, 0.003, &mut Random(5)));
    let fit = fit::fit(&design(""), &late, &Parameter::USUAL).expect("a fit");
    let lines = findings(&design(""), &late, &fit);
    let told = "force and pressure do not vanish at the same depth: the force begins 0.";
    assert!(
        lines
            .iter()
            .any(|line| line.starts_with(told) && line.contains("mm after the pressure")),
        "{lines:?}"
    );
    // Without the model of the device too.
    let lag = fit::lag(&design(""), &late).expect("it is told");
    assert!(lag.to_string().starts_with(told), "{lag}");
    let together = data(&bench(&now, 0.003, &mut Random(5)));
    assert!(fit::lag(&design(TRUTH), &together).is_none());
}
