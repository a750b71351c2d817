//! A grasp of eight hours, and what drift and weather do to it.

use fingertip::image::ImageDesign;
use fingertip::signal::design::Design;
use fingertip::signal::report::Report;
use fingertip::status::{Status, Touch, Warnings};
use host_tests::assert_faults_says;
use host_tests::world::{WithAbsolutePart, World, full_scale, rest, sample};

/// Virtual time from sample to sample: as long as the follower of drift takes for one step.
const STEP: u64 = 20_000;
const HOUR: u64 = 3_600_000_000;

/// What a grasp came to.
struct Held {
    first: Report,
    last: Report,
    /// When the zero was reported to be aged, hours.
    aged: Option<f64>,
}

fn force(report: &Report) -> f64 {
    f64::from(report.outcome.expect("a reading").force.0)
}

impl Held {
    /// By how much the force moved, percent.
    fn moved(&self) -> f64 {
        (force(&self.last) / force(&self.first) - 1.0) * 100.0
    }
}

/// Presses to `share` of the tables' pressure and holds for eight hours while the zero drifts, pascals an hour.
fn hold<D: Design + Copy>(design: D, share: f64, drift: f64) -> Held {
    let mut world = World::zeroed(design, rest(&design));
    world.ask(fingertip::link::command::Command::Tare);
    for _ in 0..400 {
        world.step(1000, Ok(sample(&design, rest(&design))));
    }
    let rise = share * full_scale(&design);
    for ms in 0..1000 {
        world.step(
            1000,
            Ok(sample(&design, rest(&design) + rise * f64::from(ms) / 1000.0)),
        );
    }
    let from = world.now;
    let mut held: Option<Held> = None;
    while world.now < from + 8 * HOUR {
        let hours = (world.now - from) as f64 / HOUR as f64;
        let report = world.step(STEP, Ok(sample(&design, rest(&design) + rise + drift * hours)));
        let reading = report.outcome.expect("a grasp is read");
        assert_eq!(reading.touch, Touch::Touched);
        if let Some(held) = &mut held {
            held.last = report;
            if held.aged.is_none() && reading.warnings.contains(Warnings::ZERO_AGED) {
                held.aged = Some(hours);
            }
        } else if world.now > from + 10 * STEP {
            held = Some(Held {
                first: report,
                last: report,
                aged: None,
            });
        }
    }
    held.expect("eight hours are long")
}

#[test]
fn the_force_of_a_gauge_part_moves_by_less_than_a_percent_in_eight_hours() {
    for share in [0.5, 0.9] {
        for drift in [-2.0, 2.0] {
            let held = hold(ImageDesign, share, drift);
            assert_eq!(held.last.status(), Status::Ok);
            assert!(held.moved().abs() < 1.0, "{share}, {drift}: {}", held.moved());
        }
        let (still, drifting) = (hold(ImageDesign, share, 0.0), hold(ImageDesign, share, 2.0));
        assert!(still.moved().abs() < 1e-12);
        assert_faults_says(&format!(
            "| {:.0} % of full scale | gauge | 2 Pa/h | {:.2} | ok |",
            share * 100.0,
            drifting.moved()
        ));
    }
}

#[test]
fn weather_moves_the_force_of_an_absolute_part_and_it_says_so() {
    for weather in [25.0, 100.0] {
        let held = hold(WithAbsolutePart, 0.5, weather);
        let aged = held.aged.expect("it cannot be followed");
        assert!(matches!(held.last.status(), Status::Warning(Warnings::ZERO_AGED)));
        assert_faults_says(&format!(
            "| 50 % of full scale | absolute | {weather} Pa/h of weather | {:.1} | zero aged, after {:.0} min |",
            held.moved(),
            aged * 60.0
        ));
    }
}

#[test]
fn weather_is_followed_while_nothing_touches() {
    // 8 m of stairs in 25 s up, and down again.
    let mut world = World::zeroed(WithAbsolutePart, rest(&WithAbsolutePart));
    world.ask(fingertip::link::command::Command::Tare);
    let mut worst = 0.0_f64;
    for ms in 0..60_000 {
        let seconds = f64::from(ms) / 1000.0;
        let height = if seconds < 2.0 {
            0.0
        } else {
            (seconds - 2.0).min(25.0) * 0.32
        };
        let pascals = rest(&WithAbsolutePart) - height * 12.0;
        let report = world.step(1000, Ok(sample(&WithAbsolutePart, pascals)));
        if let Ok(reading) = report.outcome {
            worst = worst.max(host_tests::world::rise(&WithAbsolutePart, &report).map_or(0.0, f64::abs));
            assert_ne!(reading.touch, Touch::Touched);
        }
    }
    assert!(worst < 20.0, "{worst}");
}
