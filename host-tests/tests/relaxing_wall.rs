//! The shipped fingertip that relaxes: pressures of a solid in time, through the whole signal path, against the solid's force and
//! indentation.

use fingertip::link::command::{Command, Outcome};
use fingertip::link::telemetry::Message;
use fingertip::signal::contact::contact;
use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::Relaxing;
use fingertip::signal::report::{Measurement, Report};
use fingertip::status::{Status, Touch, Warnings};
use host_tests::design;
use host_tests::world::{World, sample};
use model_tables::design_file::DesignFile;
use model_tables::generate::{self, Generated};
use model_tables::material::relaxation::MAX_TERMS;
use model_tables::material::series::{SeriesStep, WallSeries};
use model_tables::random::Random;
use model_tables::solid::history::{Drive, History, Instant};
use model_tables::solid::mesh::Elements;
use model_tables::units::PressureRise;
use std::sync::OnceLock;

/// Pressed to 5 N in 1 s, held, let go in a quarter of a second, and after 10 s pressed and held again: seconds and newtons. Between 4.25 s and
/// 14 s nothing touches.
const GRASP: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [1.0, 5.0],
    [4.0, 5.0],
    [4.25, 0.0],
    [14.25, 0.0],
    [15.25, 5.0],
    [18.0, 5.0],
];
/// Of the truth, seconds.
const STEP: f64 = 0.01;

fn generated() -> &'static Generated {
    static GENERATED: OnceLock<Generated> = OnceLock::new();
    GENERATED.get_or_init(|| generate::from_design_file(&design("index-fingertip")).expect("it is shipped"))
}

/// The solid at every step of the grasp.
fn truth() -> &'static [Instant] {
    static TRUTH: OnceLock<Vec<Instant>> = OnceLock::new();
    TRUTH.get_or_init(|| {
        let file = DesignFile::read(&design("index-fingertip")).expect("it is shipped");
        let series = file.relaxation.expect("it relaxes");
        let elements = Elements {
            through: 1,
            along: 24,
        };
        let mut history = History::new(&file.design(), &series, elements, 0.0, 0.0).expect("at rest");
        let mut instants = vec![history.now()];
        for pair in GRASP.windows(2) {
            let steps = ((pair[1][0] - pair[0][0]) / STEP).round();
            for i in 1..=steps as u32 {
                let share = f64::from(i) / steps;
                let at = |axis: usize| pair[0][axis] + share * (pair[1][axis] - pair[0][axis]);
                instants.push(history.advance(at(0), Drive::Force(at(1))).expect("a press"));
            }
        }
        instants
    })
}

/// The truth between two steps: pascals, newtons, metres.
fn between(seconds: f64) -> [f64; 3] {
    let instants = truth();
    let place = (seconds / STEP).min((instants.len() - 1) as f64);
    let index = (place as usize).min(instants.len() - 2);
    let share = place - index as f64;
    let values = |instant: &Instant| [instant.pressure_rise, instant.force, instant.indentation];
    let (before, after) = (values(&instants[index]), values(&instants[index + 1]));
    [0, 1, 2].map(|i| before[i] + share * (after[i] - before[i]))
}

/// The reports of the grasp with the transducer's noise, each with its time in seconds since the press began.
fn played<D: Design + Copy>(design: D) -> (Vec<(f64, Report)>, World<D>) {
    let mut random = Random(5);
    let mut world = World::zeroed(design, 0.0);
    let begin = world.now;
    let mut reports = Vec::new();
    for millisecond in 1..=18_000 {
        let [pascals, ..] = between(1e-3 * f64::from(millisecond));
        // 10 Pa a conversion, a hundred of them.
        let report = world.step(1000, Ok(sample(&design, pascals + random.normal())));
        // A sample of half a millisecond before.
        let seconds = 1e-6 * (report.time.0 as f64 - begin as f64) + 0.5e-3;
        reports.push((seconds, report));
    }
    (reports, world)
}

fn readings(reports: &[(f64, Report)], from: f64, until: f64) -> impl Iterator<Item = (f64, Measurement)> {
    reports
        .iter()
        .filter(move |(seconds, _)| (from..until).contains(seconds))
        .map(|(seconds, report)| (*seconds, report.outcome.expect("a reading")))
}

/// Largest errors of force and indentation over what they are on the first press.
fn errors(reports: &[(f64, Report)], from: f64, until: f64) -> [f64; 2] {
    let depth = between(4.0)[2];
    readings(reports, from, until).fold([0.0; 2], |most, (seconds, reading)| {
        let [_, force, indentation] = between(seconds);
        [
            most[0].max((reading.force.newtons() - force).abs() / 5.0),
            most[1].max((reading.indentation.metres() - indentation).abs() / depth),
        ]
    })
}

#[test]
fn a_grasp_its_release_and_the_next_grasp_are_read_as_they_are() {
    let block = generated().binary();
    let (design, _) = LoadedDesign::read(&block).expect("it was just written");
    let (reports, world) = played(design);
    let pressed = errors(&reports, 0.01, 4.0);
    let again = errors(&reports, 15.2, 18.0);
    println!("pressed and held: {pressed:.4?}, again at the end of the ramp and held: {again:.4?}");
    assert!(pressed[0] < 0.04 && pressed[1] < 0.02, "{pressed:?}");
    assert!(again[0] < 0.1 && again[1] < 0.02, "{again:?}");

    // What the same pressure is to tables alone.
    let bits = design.parameters().pressure_fraction_bits;
    let [pascals, ..] = between(1.0);
    let still = contact(&design, PressureRise::from_pascals(pascals, bits), Warnings::NONE);
    println!("tables alone at 5 N: {:.2} N", still.force.newtons());
    assert!(still.force.newtons() > 7.5);

    // Let go: no force, within 3 % of the 5 N, and neither a zero that follows the wall nor a touch that it may hide.
    let mut recovering = 0;
    for (seconds, reading) in readings(&reports, 4.5, 14.2) {
        assert_eq!(reading.warnings, Warnings::RECOVERING, "{seconds} s");
        assert_eq!(
            (reading.force.0, reading.touch),
            (0, Touch::Unknown),
            "{seconds} s"
        );
        let share = reading.sigma.force.newtons() / 5.0;
        assert!((0.025..0.045).contains(&share), "{seconds} s: {share}");
        recovering += 1;
    }
    assert!(recovering > 9_000);
    let zero = world.zero().expect("taken");
    assert!(zero.abs() < 5.0, "{zero} Pa");
    // Touched the status is ok.
    for (seconds, reading) in readings(&reports, 0.1, 4.0) {
        assert_eq!(reading.warnings, Warnings::NONE, "{seconds} s");
    }
}

/// A dome that is not the shipped one, and a wall that relaxes a little or as Agilus30.
fn other_dome(radial: f64, axial: f64, wall: f64, law: &str, series: &str) -> DesignFile {
    let text = format!(
        "name = \"other\"\n[membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
         [material]\n{law}\n[material.relaxation]\n{series}\n[model]\nkind = \"solid\"\n\
         [press]\nmax_indentation_mm = {:?}\n[transducer]\nkind = \"ratiometric\"\nrange_kpa = [-50.0, 900.0]\n\
         resolution_pa = 10.0\n[accuracy]\nforce_percent_of_reading = 0.1\nindentation_percent_of_reading = 0.1\n\
         from_percent_of_full_scale = 1.0\n",
        0.3 * axial
    );
    DesignFile::parse(&text, "other.toml").expect("a design")
}

/// What a press, its release and the next grasp may be off: percent of the reading of force and indentation while pressed and held, percent of
/// the peak of the force on the release and on the next grasp.
type Allowed = [f64; 4];

/// Of the solid in time: press in 1 s to a quarter of the height, hold 3 s, release in 1 s, and once more after 10 s, through the chip's own
/// steps, given the solid's pressure. The area times the pressure alone, which forgets what the wall itself bears, is further off.
#[test]
fn force_and_indentation_hold_on_other_domes_and_walls_also_on_the_release_and_the_next_grasp() {
    const AGILUS: &str = "preset = \"agilus30\"";
    const MILD: &str =
        "tau_s = [0.05, 0.5, 5.0]\ng = [0.04, 0.06, 0.05]\ntemperature_c = 20.0\nshift_per_kelvin = 0.0";
    const MOONEY: &str = "law = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0";
    let other: Allowed = [6.5, 3.0, 6.0, 6.0];
    let mild: Allowed = [0.5, 0.5, 6.0, 6.0];
    // Indentation in contact after the first press, millimetres off: at most so much below and above.
    let after = [-0.02, 0.4];
    for (dome, series, most, after) in [
        ([8.0, 8.0, 0.8], AGILUS, other, after),
        ([8.0, 8.0, 0.8], MILD, mild, after),
        ([10.0, 6.0, 1.0], AGILUS, other, after),
        ([10.0, 6.0, 1.0], MILD, mild, after),
        ([6.0, 5.0, 0.6], AGILUS, other, after),
        ([10.0, 8.0, 1.2], AGILUS, other, after),
        // A tall dome with a wall of a sixth of its radius; where it hardly relaxes, 0.02 mm below is not met.
        ([7.0, 9.0, 1.2], AGILUS, other, after),
        ([7.0, 9.0, 1.2], MILD, mild, [-0.1, 0.4]),
    ] {
        let file = other_dome(dome[0], dome[1], dome[2], MOONEY, series);
        let relaxation = file.relaxation.expect("it relaxes");
        let elements = Elements {
            through: 2,
            along: 24,
        };
        let mut history = History::new(&file.design(), &relaxation, elements, 0.0, 0.0).expect("at rest");
        let block = generate::from_design(file).expect("it has tables").binary();
        let (design, _) = LoadedDesign::read(&block).expect("it was just written");
        let wall = WallSeries {
            step: SeriesStep::over(&relaxation, STEP),
            ..*design.series().expect("it relaxes")
        };
        let bits = design.parameters().pressure_fraction_bits;
        let deep = 0.25e-3 * dome[1];
        let depths = [
            [0.0, 0.0],
            [1.0, deep],
            [4.0, deep],
            [5.0, 0.0],
            [15.0, 0.0],
            [16.0, deep],
            [17.0, deep],
        ];
        let mut state = Relaxing::<MAX_TERMS>::NEW;
        let mut instants = Vec::new();
        for pair in depths.windows(2) {
            let steps = ((pair[1][0] - pair[0][0]) / STEP).round();
            for i in 1..=steps as u32 {
                let share = f64::from(i) / steps;
                let at = |axis: usize| pair[0][axis] + share * (pair[1][axis] - pair[0][axis]);
                let now = history
                    .advance(at(0), Drive::Indentation(at(1)))
                    .expect("a press");
                let rise = PressureRise::from_pascals(now.pressure_rise, bits);
                let reading = state.step(&design, &wall, rise);
                let area = reading.settled.newtons() / f64::from(reading.elastic.0.max(1));
                instants.push((at(0), now, reading.contact, area * f64::from(rise.0)));
            }
        }
        let peak = |until: f64| {
            let before = instants.iter().take_while(|(time, ..)| *time <= until);
            before.map(|(_, now, ..)| now.force).fold(0.0, f64::max)
        };
        let (whole, mut found, mut by_area) = (peak(4.0), [0.0_f64; 4], 0.0_f64);
        // How far the indentation is off in contact after the first press, millimetres, least and most.
        let mut left = [0.0_f64; 2];
        for (time, now, read, area) in &instants {
            let force = 100.0 * (read.force.newtons() - now.force).abs();
            let depth = read.indentation.metres() - now.indentation;
            if *time > 4.0 {
                let phase = 2 + usize::from(*time > 10.0);
                found[phase] = found[phase].max(force / peak(*time));
                if now.in_contact() {
                    left = [left[0].min(1e3 * depth), left[1].max(1e3 * depth)];
                }
            } else if now.force >= 0.05 * whole && now.indentation >= 1e-4 {
                found[0] = found[0].max(force / now.force);
                found[1] = found[1].max(100.0 * depth.abs() / now.indentation);
                by_area = by_area.max(100.0 * (area - now.force).abs() / now.force);
            }
        }
        println!(
            "{dome:?} {series}: {found:.2?} %; by area times pressure {by_area:.1} %; indentation in contact after the press {left:.2?} mm off"
        );
        assert!(
            series == MILD || by_area > 1.5 * found[0],
            "{dome:?}: {by_area} {found:?}"
        );
        for (found, most) in found.iter().zip(most) {
            assert!(*found < most, "{dome:?}, {series}: {found:.2?}");
        }
        assert!(
            left[0] > after[0] && left[1] < after[1],
            "{dome:?}, {series}: {left:?} mm"
        );
    }
}

#[test]
fn no_tare_is_taken_of_a_wall_that_recovers() {
    let block = generated().binary();
    let (design, _) = LoadedDesign::read(&block).expect("it was just written");
    let mut world = World::zeroed(design, 0.0);
    for millisecond in 1..=10_000 {
        let [pascals, ..] = between(1e-3 * f64::from(millisecond));
        let report = world.step(1000, Ok(sample(&design, pascals)));
        if millisecond == 6_000 {
            assert!(matches!(report.status(), Status::Warning(warnings) if warnings == Warnings::RECOVERING));
            world.ask(Command::Tare);
        }
    }
    let answers: Vec<Outcome> = world.emitted.iter().filter_map(outcome).collect();
    assert_eq!(answers, [Outcome::Touched]);
    assert!(world.zero().is_some_and(|zero| zero.abs() < 1.0));
}

fn outcome(message: &Message) -> Option<Outcome> {
    match message {
        Message::Answer(answer) => Some(answer.outcome),
        _ => None,
    }
}
