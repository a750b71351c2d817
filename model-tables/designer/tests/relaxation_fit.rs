//! Series of walls from press-and-hold records: of the solid in time, read with noise, and of an independent code.
//!
//! Coverage over more records than a test has time for: `FIT_REPEATS=200 cargo test --release -p designer --test relaxation_fit
//! intervals -- --nocapture`.

mod program;

use designer::fit::data::DataChoice;
use designer::fit::relaxation::record::HoldRecord;
use designer::fit::relaxation::{FittedTerm, HoldError, RelaxationFit, Told, fit_relaxation};
use fingertip::signal::design::Design as _;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::Relaxing;
use model_tables::design_file::DesignFile;
use model_tables::generate;
use model_tables::material::relaxation::{AGILUS30_RELAXATION, MAX_TERMS, Relaxation, Term};
use model_tables::material::series::SeriesStep;
use model_tables::solid::history::{Drive, History};
use model_tables::solid::mesh::Elements;
use model_tables::units::PressureRise;
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

/// `SplitMix64`, and normal deviates from it (Box and Muller).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }
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
        let pascals = pascals + NOISE * random.normal();
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

/// Truth of each term that a fit tells, in 200 records of 95 % intervals.
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
