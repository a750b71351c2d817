//! The firmware's signal path through a scene: the part's noise and steps, a zero anywhere in its bound, drift and weather.

use super::scene::{GraspPhase, Scene, SceneInstant};
use crate::campaign::lives::sample_noise;
use fingertip::signal::calibration::Calibration;
use fingertip::signal::design::Design as _;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::pipeline::Pipeline;
use fingertip::signal::report::Measurement;
use fingertip::signal::uncertainty::averaged;
use fingertip::signal::zero::StartUp;
use fingertip::status::Warnings;
use fingertip::transducer::driver::Sample;
use fingertip::units::{Centidegrees, Microseconds, Millipascals};
use model_tables::constants::{Quantity, TransducerKind};
use model_tables::random::Random;
use model_tables::units::PressureRise;

/// Seconds that a fingertip is left alone when it is switched on, and after its tare.
const SWITCHED_ON: f64 = 1.0;
const TARED: f64 = 1.0;
/// Seconds before first touch in which the zero goes to where it is in the grasps, by the hand's attitude, the part or the air.
const MOVED: f64 = 0.3;
/// Largest drift of the part, and of the weather, pascals an hour.
const DRIFT: f64 = 2.0;
const WEATHER: f64 = 98.0;
/// The air of the place, pascals.
const PLACES: [f64; 2] = [90_000.0, 104_000.0];
/// Ideal rubber: the stiffness goes with the absolute temperature.
const KELVIN: f64 = 273.15;

/// A reading in contact beside the truth.
#[derive(Clone, Copy, Debug)]
pub struct GraspReading {
    /// Of which grasp, and in which part of it.
    pub grasp: usize,
    /// In which part of it.
    pub phase: GraspPhase,
    /// The part of its phase's time that it stands for.
    pub weight: f64,
    /// What was read; `None` where no value holds.
    pub read: Option<GraspValues>,
    /// Newtons and metres.
    pub truth: [f64; 2],
    /// The largest force, newtons, and indentation, metres, of the scene so far.
    pub peak: [f64; 2],
}

/// What is read, newtons and metres.
#[derive(Clone, Copy, Debug)]
pub struct GraspValues {
    /// Force, newtons, and indentation, metres.
    pub values: [f64; 2],
    /// One standard deviation of each.
    pub sigma: [f64; 2],
}

/// Reports while something touches, and while the next grasp is awaited.
pub fn play(
    block: &[u8],
    scene: &Scene,
    truth: &[SceneInstant],
    told: bool,
    stiffness: f64,
    seed: u64,
) -> Option<Vec<GraspReading>> {
    let (mut design, _) = LoadedDesign::read(block).ok()?;
    if told {
        // A cylinder is not drawn, and every other object is offered: or nothing was told.
        design.touch(scene.object).ok()?;
    }
    let mut random = Random(seed);
    random.bits();
    let parameters = *design.parameters();
    let transducer = parameters.constants.transducer;
    let absolute = transducer.quantity == Quantity::Absolute;
    let drift = random.uniform(-DRIFT, DRIFT)
        + if absolute {
            random.uniform(-WEATHER, WEATHER)
        } else {
            0.0
        };
    let air = if absolute {
        random.uniform(PLACES[0], PLACES[1])
    } else {
        0.0
    };
    let bound = PressureRise(design.limits().bound).pascals(parameters.pressure_fraction_bits);
    let moved = random.uniform(-bound, bound);
    let step = f64::from(transducer.resolution) / 1e3 / f64::from(averaged(&transducer.kind));
    let noise = sample_noise(&transducer);
    let bus = !matches!(transducer.kind, TransducerKind::Ratiometric { .. });
    let rest = f64::from(parameters.constants.rest_pressure) + air;
    let mut pipeline = Pipeline::new(design, StartUp::Measured, Calibration::default(), Warnings::NONE);
    let period = u64::from(parameters.period);
    let begin = SWITCHED_ON + TARED;
    let (mut now, mut place, mut tared) = (0_u64, 0_usize, false);
    let (mut peak, mut readings) = ([0.0_f64; 2], Vec::new());
    // The instant that is judged next.
    let mut next = 1;
    while next < truth.len() {
        now += period;
        let seconds = now as f64 / 1e6;
        let measured = seconds - 0.5e-6 * period as f64;
        if !tared && seconds > SWITCHED_ON {
            tared = true;
            let _ = pipeline.tare();
        }
        let since = measured - begin;
        let pressed = stiffness * pressure(truth, &mut place, since);
        let zero = moved * (1.0 + since / MOVED).clamp(0.0, 1.0) + drift * seconds / 3_600.0;
        let pascals = rest + zero + pressed + noise * random.normal();
        let millipascals = libm::round(libm::round(pascals / step) * step * 1e3) as i32;
        let sample = Sample {
            pressure: Millipascals(millipascals),
            headroom: Millipascals(
                transducer.range[1]
                    .saturating_mul(1000)
                    .saturating_sub(millipascals),
            ),
            age: (period / 2) as u32,
            temperature: bus.then_some(Centidegrees(libm::round(100.0 * scene.celsius) as i16)),
            ..Sample::default()
        };
        let report = pipeline.step(Microseconds(now), Ok(sample));
        let at = report.time.0 as f64 / 1e6 - begin;
        // One report may be the first after several instants: each stands for its own time.
        while let Some(instant) = truth.get(next).filter(|instant| instant.time <= at) {
            let before = truth[next - 1];
            peak[0] = peak[0].max(stiffness * instant.now.force);
            peak[1] = peak[1].max(instant.now.indentation);
            let phase = truth
                .iter()
                .filter(|other| other.grasp == instant.grasp && other.phase == instant.phase);
            let (first, last) = phase.fold((f64::INFINITY, 0.0_f64), |(first, last), other| {
                (first.min(other.time), last.max(other.time))
            });
            let share = (instant.time - before.time) / (last - first.min(before.time)).max(1e-9);
            let exact = between(truth, next, at);
            readings.push(GraspReading {
                grasp: instant.grasp,
                phase: instant.phase,
                weight: share,
                read: report.outcome.ok().as_ref().and_then(values),
                truth: [stiffness * exact[0], exact[1]],
                peak,
            });
            next += 1;
        }
    }
    Some(readings)
}

/// What holds as a value: neither a bound nor hidden.
fn values(reading: &Measurement) -> Option<GraspValues> {
    let bounds = [Warnings::SATURATED, Warnings::BELOW_ZERO];
    (!bounds.iter().any(|bound| reading.warnings.contains(*bound))).then_some(GraspValues {
        values: [reading.force.newtons(), reading.indentation.metres()],
        sigma: [reading.sigma.force.newtons(), reading.sigma.indentation.metres()],
    })
}

/// Pressure rise at seconds since the scene began, pascals; `place` only grows.
fn pressure(truth: &[SceneInstant], place: &mut usize, since: f64) -> f64 {
    while truth.get(*place + 1).is_some_and(|next| next.time <= since) {
        *place += 1;
    }
    let from = &truth[*place];
    match truth.get(*place + 1) {
        Some(to) if since > from.time => {
            let part = (since - from.time) / (to.time - from.time);
            from.now.pressure_rise + part * (to.now.pressure_rise - from.now.pressure_rise)
        }
        _ => from.now.pressure_rise,
    }
}

/// Force and indentation at a time from this instant on, less than a report later.
fn between(truth: &[SceneInstant], from: usize, at: f64) -> [f64; 2] {
    let mut place = from;
    while truth.get(place + 1).is_some_and(|next| next.time <= at) {
        place += 1;
    }
    let values = |instant: &SceneInstant| [instant.now.force, instant.now.indentation];
    let one = values(&truth[place]);
    match truth.get(place + 1) {
        Some(next) if at > truth[place].time => {
            let part = (at - truth[place].time) / (next.time - truth[place].time);
            let other = values(next);
            [0, 1].map(|i| one[i] + part * (other[i] - one[i]))
        }
        _ => one,
    }
}

/// Stiffness of an elastic wall at a temperature over that of its constants at 20 degrees Celsius.
pub fn warmed(celsius: f64) -> f64 {
    (KELVIN + celsius) / (KELVIN + 20.0)
}
