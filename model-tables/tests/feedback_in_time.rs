//! The haptic loop in time: between its elastic limits, which the loop without time gives, with nothing lost on the way.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::AGILUS30;
use model_tables::material::relaxation::{Relaxation, Term};
use model_tables::model::Kind;
use model_tables::model::feedback::{Loop, LoopState};
use model_tables::object::{Friction, Object};
use model_tables::solid::disc::{Disc, DiscDesign, DiscInTime, DiscState, FarSide};
use model_tables::solid::gas::{STANDARD_ATMOSPHERE, TrappedGas};
use model_tables::solid::history::{Drive, History, Instant};
use model_tables::solid::mesh::Elements;

const TIP: Elements = Elements { through: 1, along: 8 };
const DISC: Elements = Elements {
    through: 1,
    along: 10,
};
/// `g(0) = 3`.
const SERIES: [Term; 2] = [
    Term {
        time: 0.1,
        weight: 0.5,
    },
    Term {
        time: 1.0,
        weight: 1.5,
    },
];
const SKIN: FarSide = FarSide::Foundation {
    gap: 0.05e-3,
    stiffness: 2e7,
};

fn printed(law: Law, compliance: f64) -> Design {
    Design {
        membrane: Membrane {
            radial_semi_axis: 9e-3,
            axial_semi_axis: 7e-3,
            thickness: 1e-3,
        },
        law,
        rest: RestBy::Unstretched,
        compliance,
        object: Object::PLATE,
    }
}

fn actuator(law: Law, far_side: FarSide) -> DiscDesign {
    DiscDesign {
        diameter: 9e-3,
        thickness: 1e-3,
        law,
        far_side,
        friction: Friction::NONE,
    }
}

/// The loop in time at the ends of these rows of seconds and metres.
struct Played {
    history: History,
    rows: Vec<(Instant, DiscState)>,
}

fn play(
    tip: &[Term],
    disc: &[Term],
    compliance: f64,
    far_side: FarSide,
    gas: TrappedGas,
    rows: &[[f64; 2]],
) -> Played {
    let series = |terms| Relaxation::new(terms, 20.0, 0.0);
    let disc = DiscInTime::new(&actuator(AGILUS30, far_side), &series(disc), DISC).expect("a disc");
    let design = printed(AGILUS30, compliance);
    let mut history =
        History::with_actuator(&design, &series(tip), TIP, [0.0; 2], disc, gas).expect("at rest");
    let rows = rows
        .iter()
        .map(|&[time, depth]| {
            let instant = history.advance(time, Drive::Indentation(depth)).expect("a state");
            (instant, history.actuator().expect("an actuator"))
        })
        .collect();
    Played { history, rows }
}

/// The loop without time, of walls so many times as stiff.
fn settled(
    tip: f64,
    disc: f64,
    compliance: f64,
    far_side: FarSide,
    gas: TrappedGas,
    depth: f64,
) -> LoopState {
    let [tip, disc] = [tip, disc].map(|factor| AGILUS30.stiffened(factor));
    let disc = Disc::new(&actuator(disc, far_side), DISC).expect("a disc");
    Loop::new(Kind::Solid(TIP), &printed(tip, compliance), disc)
        .expect("at rest")
        .with_gas(gas)
        .at_indentation(depth)
        .expect("a state")
}

fn same((instant, disc): (Instant, DiscState), truth: &LoopState, tolerance: f64) {
    let pairs = [
        (instant.pressure_rise, truth.touch.pressure_rise),
        (instant.force, truth.touch.force),
        (disc.force, truth.actuator.force),
        (disc.volume, truth.volume_moved),
        (disc.travel, truth.actuator.travel),
    ];
    for (found, truth) in pairs {
        assert!(
            (found - truth).abs() <= tolerance * truth.abs(),
            "{found} {truth}"
        );
    }
}

const AIR: TrappedGas = TrappedGas {
    volume: 10e-9,
    ambient: STANDARD_ATMOSPHERE,
};

#[test]
fn an_elastic_loop_is_the_same_in_time() {
    for far_side in [FarSide::Free, FarSide::Plate { gap: 0.1e-3 }, SKIN] {
        let played = play(
            &[],
            &[],
            0.1e-12,
            far_side,
            AIR,
            &[[0.2, 0.8e-3], [0.3, 1.5e-3], [1.0, 0.8e-3]],
        );
        for (row, depth) in played.rows.into_iter().zip([0.8e-3, 1.5e-3, 0.8e-3]) {
            same(row, &settled(1.0, 1.0, 0.1e-12, far_side, AIR, depth), 1e-4);
        }
    }
}

/// In no time a wall is `g(0)` times as stiff, and after all times relaxed; skin and air have no time. Which of both ends relaxes is told apart.
#[test]
fn a_loop_lies_between_its_elastic_limits() {
    let stiff = 3.0;
    for (tip, disc) in [(&SERIES[..], &[][..]), (&[][..], &SERIES[..])] {
        let at = |series: &[Term]| if series.is_empty() { 1.0 } else { stiff };
        let rows = [[1e-6, 1.2e-3], [60.0, 1.2e-3]];
        let played = play(tip, disc, 0.0, SKIN, AIR, &rows);
        same(
            played.rows[0],
            &settled(at(tip), at(disc), 0.0, SKIN, AIR, 1.2e-3),
            1e-3,
        );
        same(played.rows[1], &settled(1.0, 1.0, 0.0, SKIN, AIR, 1.2e-3), 1e-3);
    }
}

/// Half a percent of the work of plate and fluid may be missing after press, hold and release; after recovery everything is as it was.
#[test]
fn no_work_is_lost_in_time() {
    let rows = [[0.5, 1.5e-3], [1.5, 1.5e-3], [1.8, 0.0], [60.0, 0.0]];
    let disc = DiscInTime::new(
        &actuator(AGILUS30, SKIN),
        &Relaxation::new(&SERIES, 20.0, 0.0),
        DISC,
    )
    .expect("a disc");
    assert!(disc.works().iter().all(|work| *work == 0.0));
    let played = play(&SERIES, &SERIES, 0.0, SKIN, TrappedGas::NONE, &rows[..2]);
    let [supplied, work] = played.history.works();
    assert!((work / supplied - 1.0).abs() < 0.005, "{work} {supplied}");
    let [supplied, work] = played.history.actuator_works().expect("an actuator");
    assert!((work / supplied - 1.0).abs() < 0.005, "{work} {supplied}");
    let played = play(&SERIES, &SERIES, 0.0, SKIN, TrappedGas::NONE, &rows);
    let pressed = played.rows[0];
    let (instant, disc) = played.rows[3];
    assert!(instant.pressure_rise.abs() < 1e-4 * pressed.0.pressure_rise);
    assert!(disc.force == 0.0 && disc.travel.abs() < 1e-3 * pressed.1.travel);
}

/// By a force on the plate the loop is the one by the travel that this makes.
#[test]
fn a_given_force_makes_the_same_loop() {
    let disc = DiscInTime::new(
        &actuator(AGILUS30, SKIN),
        &Relaxation::new(&SERIES, 20.0, 0.0),
        DISC,
    )
    .expect("a disc");
    let design = printed(AGILUS30, 0.0);
    let series = Relaxation::new(&SERIES, 20.0, 0.0);
    let mut history =
        History::with_actuator(&design, &series, TIP, [0.0; 2], disc, TrappedGas::NONE).expect("at rest");
    let mut rows = Vec::new();
    let mut by_force = Vec::new();
    for i in 1..=20 {
        let time = 0.05 * f64::from(i);
        let instant = history.advance(time, Drive::Force(2.0 * time)).expect("a state");
        assert!((instant.force - 2.0 * time).abs() < 1e-5);
        rows.push([time, instant.indentation]);
        by_force.push((instant, history.actuator().expect("an actuator")));
    }
    let played = play(&SERIES, &SERIES, 0.0, SKIN, TrappedGas::NONE, &rows);
    let ((found, disc), (truth, of_truth)) = (played.rows[19], by_force[19]);
    assert!((found.force / truth.force - 1.0).abs() < 0.01);
    assert!((disc.force / of_truth.force - 1.0).abs() < 0.01);
}
