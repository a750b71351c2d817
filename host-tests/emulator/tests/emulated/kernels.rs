//! What other ways to look two curves up cost on the chip, counted as they run: the figures that the chart of lookups is drawn
//! from.

use crate::design;
use emulator::bench::{self, Listener, Moment};
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::scenario::Scenario;
use host_tests::workspace;
use probes::lookup_ways::{INPUTS, SIZES, WAYS};
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::ops::ControlFlow;

/// Where the figures are kept, and the variable that has them written anew.
const KEPT: &str = "model-tables/tables/instructions.csv";
const WRITE: &str = "UPDATE_EXPECT";
/// Another compiler may do a little better or worse.
const SHARE: f64 = 0.1;
/// More than the probe takes, virtual seconds.
const LIMIT: f64 = 0.2;

/// The probe says nothing.
struct Silence;

impl Listener for Silence {
    fn hear(&mut self, _byte: u8, _moment: Moment, _plant: &Plant) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The instructions of each call of a function, in order.
fn calls(counts: &bench::Arrivals, entry: u64, returns: &[u64]) -> Vec<u64> {
    let mut ends: Vec<u64> = returns.iter().flat_map(|at| counts[at].iter().copied()).collect();
    ends.sort_unstable();
    counts[&entry]
        .iter()
        .map(|&begun| {
            let end = ends[ends.partition_point(|&end| end < begun)];
            end - begun
        })
        .collect()
}

#[test]
fn the_ways_to_look_up_cost_what_the_chart_is_drawn_from() {
    let image = Image::build("kernel_probe", Some(&design().path)).expect("the probe builds");
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let places: Vec<(u64, Vec<u64>)> = WAYS
        .iter()
        .map(|(name, _)| {
            let entry = image
                .function("kernel_probe", name)
                .expect("a function of the probe");
            let returns = image.returns_of(entry).expect("an image");
            assert!(!returns.is_empty(), "{name} is never called");
            (entry, returns)
        })
        .collect();
    let watched: Vec<u64> = places
        .iter()
        .flat_map(|(entry, returns)| std::iter::once(*entry).chain(returns.iter().copied()))
        .collect();
    let outcome = bench::run_watching(&image, plant, LIMIT, &[], &watched, Silence).expect("the image runs");

    let mut text = "way,size,instructions_median,instructions_most\n".to_owned();
    for ((name, sized), (entry, returns)) in WAYS.iter().zip(&places) {
        let all = calls(&outcome.arrivals, *entry, returns);
        let sizes = if *sized { &SIZES[..] } else { &[0] };
        assert_eq!(all.len(), INPUTS * sizes.len(), "{name}");
        for (size, calls) in sizes.iter().zip(all.chunks(INPUTS)) {
            let mut calls = calls.to_vec();
            calls.sort_unstable();
            let _ = writeln!(text, "{name},{size},{},{}", calls[INPUTS / 2], calls[INPUTS - 1]);
        }
    }
    println!("{text}");
    let kept = workspace().join(KEPT);
    if env::var_os(WRITE).is_some() {
        fs::write(&kept, &text).expect("it can be written");
    }
    let kept = fs::read_to_string(&kept).expect("the figures are there");
    assert_eq!(
        kept.lines().count(),
        text.lines().count(),
        "{KEPT} is stale: {WRITE}=1 writes it anew"
    );
    for (kept, found) in kept.lines().zip(text.lines()).skip(1) {
        let [kept_fields, found_fields] = [kept, found].map(|line| line.split(',').collect::<Vec<_>>());
        assert_eq!(
            kept_fields[..2],
            found_fields[..2],
            "{KEPT} is stale: {WRITE}=1 writes it anew"
        );
        for (kept_field, found_field) in kept_fields[2..].iter().zip(&found_fields[2..]) {
            let [kept_count, found_count]: [f64; 2] =
                [kept_field, found_field].map(|field| field.parse().expect("a count"));
            assert!(
                (found_count - kept_count).abs() <= SHARE * kept_count,
                "{KEPT} says {kept}, the chip takes {found}: {WRITE}=1 writes it anew"
            );
        }
    }
}
