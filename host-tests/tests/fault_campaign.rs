//! Random grasps, random faults, random commands: no panic, no wrong number with status ok, no zero taken while pressed.

use fingertip::device::task_monitor::CrashRecord;
use fingertip::image::ImageDesign;
use fingertip::link::command::Command;
use fingertip::signal::zero::{StartUp, Zero};
use fingertip::status::{Fault, ResetCause, Status};
use fingertip::transducer::driver::Sample;
use fingertip::units::Millipascals;
use host_tests::assert_faults_says;
use host_tests::world::{World, beginning, full_scale, rest, rise, sample};
use model_tables::random::Random;

/// A reading that is off by more than this is wrong, pascals: 7 noise floors of the transducer. 6 a commanded tare may take
/// away when a host says that nothing presses; an outlier smaller than 4 passes for noise, and the filter takes a
/// quarter to a half of it.
fn tolerance() -> f64 {
    7.0 * ImageDesign::CONSTANTS.transducer.noise_floor() as f64 / 1000.0
}

/// What is done to the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verb {
    Off,
    Garbage,
    Wrong,
    Slow,
    Delayed,
    Intermittent,
}

const VERBS: [Verb; 6] = [
    Verb::Off,
    Verb::Garbage,
    Verb::Wrong,
    Verb::Slow,
    Verb::Delayed,
    Verb::Intermittent,
];

/// A grasp: corners in milliseconds and shares of full scale, straight lines between.
struct Grasp(Vec<(f64, f64)>);

impl Grasp {
    fn random(random: &mut Random) -> Self {
        let (mut time, mut corners) = (0.0, vec![(0.0, 0.0)]);
        let mut at = 0.0;
        while time < 5_000.0 {
            let to = if at > 0.0 && random.below(2) == 0 {
                0.0
            } else {
                random.unit() * 0.95
            };
            time += 300.0 + 500.0 * random.unit();
            corners.push((time, to));
            time += 900.0 * random.unit();
            corners.push((time, to));
            at = to;
        }
        Self(corners)
    }

    /// Pascals over rest.
    fn rise(&self, ms: f64) -> f64 {
        let after = self
            .0
            .partition_point(|&(time, _)| time <= ms)
            .min(self.0.len() - 1);
        let ((t0, s0), (t1, s1)) = (self.0[after - 1], self.0[after]);
        let share = if t1 > t0 {
            ((ms - t0) / (t1 - t0)).clamp(0.0, 1.0)
        } else {
            1.0
        };
        (s0 + (s1 - s0) * share) * full_scale(&ImageDesign)
    }
}

#[derive(Default)]
struct Tally {
    samples: u64,
    injected: u64,
    episodes: u64,
    readings: u64,
    tares: u64,
    slowest_recovery: u64,
}

/// One sample of a faulty transducer.
fn disturbed(verb: Verb, pascals: f64, i: u64, random: &mut Random) -> Result<Sample, Fault> {
    let sound = sample(&ImageDesign, pascals);
    match verb {
        Verb::Off => Err(Fault::SensorAbsent),
        Verb::Garbage => {
            let pressure = Millipascals(random.bits() as i32);
            Ok(Sample { pressure, ..sound })
        }
        Verb::Wrong if i.is_multiple_of(20) => {
            let pressure = Millipascals(sound.pressure.0 ^ 1 << random.below(31));
            Ok(Sample { pressure, ..sound })
        }
        Verb::Intermittent if random.below(3) == 0 => Err(Fault::BusFault),
        Verb::Delayed => Ok(Sample { age: 5_500, ..sound }),
        Verb::Wrong | Verb::Intermittent | Verb::Slow => Ok(sound),
    }
}

/// One life of five seconds.
fn live(seed: u64, tally: &mut Tally) {
    let mut random = Random(seed);
    let base = rest(&ImageDesign) + 200.0 * (random.unit() - 0.5);
    let mut world = World::zeroed(ImageDesign, base);
    let grasp = Grasp::random(&mut random);
    let started = world.now;
    let mut fault: Option<(Verb, u64)> = None;
    let mut ended: Option<u64> = None;
    let truth = |at: u64| grasp.rise((at.saturating_sub(started)) as f64 / 1000.0);
    let mut i = 0;
    let mut late = false;
    while world.now < started + 5_000_000 {
        i += 1;
        if fault.is_none() && random.below(250) == 0 {
            let verb = VERBS[random.below(VERBS.len() as u64) as usize];
            fault = Some((verb, world.now + 1000 * (1 + random.below(200))));
            tally.episodes += 1;
        }
        if fault.is_some_and(|(_, until)| world.now >= until) {
            fault = None;
            ended = Some(world.now);
        }
        if random.below(200) == 0 {
            world.ask(Command::Tare);
            tally.tares += 1;
        }
        let noise = 1.0 * random.normal();
        let delayed = matches!(fault, Some((Verb::Delayed, _)));
        // Late samples are the same ones, later: the first comes after a pause.
        let paused = delayed && !std::mem::replace(&mut late, delayed);
        late = delayed;
        let age = if delayed { 5_500 } else { 500 };
        let later = match fault {
            Some((Verb::Slow, _)) => 3000,
            _ if paused => 6000,
            _ => 1000,
        };
        let pascals = base + truth((world.now + later).saturating_sub(age)) + noise;
        let taken = match fault {
            Some((verb, _)) => disturbed(verb, pascals, i, &mut random),
            None => Ok(sample(&ImageDesign, pascals)),
        };
        tally.samples += 1;
        tally.injected += u64::from(fault.is_some());
        let zero = world.zero();
        let report = world.step(later, taken);
        let pressed = truth(world.now) > 70.0 && truth(world.now.saturating_sub(300_000)) > 70.0;
        assert!(
            !pressed || world.zero() == zero,
            "seed {seed}: the zero moved at {} from {zero:?} to {:?}, {} {:?}",
            world.now,
            world.zero(),
            truth(world.now),
            fault
        );
        if report.status() == Status::Ok {
            tally.readings += 1;
            let off = rise(&ImageDesign, &report).expect("it is ok") - truth(report.time.0);
            assert!(
                off.abs() < tolerance(),
                "seed {seed}: off by {off} at {} ({fault:?})",
                world.now
            );
        }
        // A reading, be it qualified for another reason: a zero that has aged stays so.
        if fault.is_none()
            && report.outcome.is_ok()
            && let Some(ended) = ended.take()
        {
            tally.slowest_recovery = tally.slowest_recovery.max(world.now - ended);
        }
        if let (Some((Verb::Off, _)), Err(fault)) = (fault, report.outcome) {
            assert_eq!(fault, Fault::SensorAbsent);
        }
    }
}

#[test]
fn random_lives_with_random_faults() {
    let mut tally = Tally::default();
    for seed in 0..600 {
        live(seed, &mut tally);
    }
    assert!(tally.readings > tally.samples / 2);
    assert_faults_says(&format!(
        "{} episodes of {} disturbed samples in 600 lives of 5 s, {} commanded tares",
        tally.episodes, tally.injected, tally.tares
    ));
    assert_faults_says(&format!(
        "back after at most {} ms",
        tally.slowest_recovery.div_ceil(1000)
    ));
}

#[test]
fn a_still_press_at_power_up_is_reported_or_small() {
    let mut largest = 0.0_f64;
    let mut presses = 0;
    for pascals in (0..3_000).step_by(10) {
        let press = f64::from(pascals);
        let mut world = World::new(
            ImageDesign,
            &beginning(&ImageDesign, ResetCause::PowerOn, None, None),
        );
        let mut last = None;
        for _ in 0..2_100 {
            last = Some(world.step(1000, Ok(sample(&ImageDesign, rest(&ImageDesign) + press))));
        }
        let report = last.expect("it reports");
        let read = rise(&ImageDesign, &report).expect("it has a zero by then");
        if report.status() == Status::Ok {
            largest = largest.max(press - read);
        } else {
            assert_eq!(report.status().to_string(), "warning: zero unverified");
            assert!((read - press).abs() < 1.0);
        }
        presses += 1;
    }
    assert_faults_says(&format!(
        "{presses} still presses at power-up: up to {largest} Pa they are taken for the zero, above they read right and say \
         \"zero unverified\""
    ));
}

#[test]
fn no_reset_that_nobody_asked_for_takes_a_zero() {
    let kept = Zero {
        pressure: fingertip::units::Pressure(
            (rest(&ImageDesign) * f64::from(1 << ImageDesign::PARAMETERS.pressure_fraction_bits)) as i32,
        ),
        bound: 0,
        verified: true,
    };
    let left = CrashRecord {
        design_hash: ImageDesign::CONSTANTS.hash,
        zero: Some(kept),
        ..CrashRecord::default()
    };
    let mut resets = 0;
    for cause in [
        ResetCause::Watchdog,
        ResetCause::Software,
        ResetCause::LowPower,
        ResetCause::Unknown,
    ] {
        for left in [None, Some(left)] {
            for press in (0..100).map(|i| f64::from(i) * full_scale(&ImageDesign) / 100.0) {
                let begins = beginning(&ImageDesign, cause, None, left);
                assert_eq!(
                    StartUp::after(
                        cause,
                        begins.start.kept,
                        ImageDesign::CONSTANTS.transducer.quantity
                    ),
                    left.map_or(StartUp::Stored, |_| StartUp::Kept(kept))
                );
                let mut world = World::new(ImageDesign, &begins);
                let mut last = None;
                for _ in 0..30 {
                    last = Some(world.step(1000, Ok(sample(&ImageDesign, rest(&ImageDesign) + press))));
                }
                let report = last.expect("it reports");
                let read = rise(&ImageDesign, &report).expect("readings at once");
                assert!((read - press).abs() < 1.0, "{cause}: {read} for {press}");
                assert_eq!(report.status() == Status::Ok, left.is_some());
                resets += 1;
            }
        }
    }
    assert_faults_says(&format!("{resets} resets in a grasp"));
}
