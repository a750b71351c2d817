//! A random scene and its truth: the product's own solid in time, pressed twice onto one object by its travel.

use model_tables::curve::Curve;
use model_tables::design::Design;
use model_tables::material::relaxation::Relaxation;
use model_tables::object::{Friction, Object, Shape};
use model_tables::random::Random;
use model_tables::solid::history::{Drive, History, HistoryError, Instant};
use model_tables::solid::mesh::Elements;
use model_tables::table::law::Touched;

/// Forces that a plate is pressed with, newtons; an object of another shape takes less or more at the same travel.
const FORCES: [f64; 2] = [0.2, 8.0];
/// Seconds of a ramp, a hold, a release, and of the time between two grasps.
const RAMPS: [f64; 2] = [0.1, 30.0];
const HOLDS: [f64; 2] = [0.3, 10.0];
const RELEASES: [f64; 2] = [0.1, 3.0];
const RESTS: [f64; 2] = [1.0, 30.0];
/// Balls, metres.
const BALLS: [f64; 2] = [5e-3, 50e-3];
/// Cups over the crown's radius of curvature: from the tightest whose blend the default design's chip offers.
const CUPS: [f64; 2] = [2.65, 8.0];
/// Largest travel over the height.
const DEEPEST: f64 = 0.3;
/// Where an object waits between two grasps, over the height: well above the wall.
const ABOVE: f64 = -0.03;
/// Largest pressure rise over that of the design's deepest press: there a hand stops.
const PRESSURE: f64 = 0.9;
/// Temperature of the wall, degrees Celsius.
const ROOM: [f64; 2] = [15.0, 25.0];
/// Instants of each phase.
const INSTANTS: [u32; 4] = [48, 24, 32, 12];
/// First instant of a hold, seconds.
const SOON: f64 = 1e-3;

/// A part of a grasp.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum GraspPhase {
    /// The object comes.
    Press,
    /// It stays where it is.
    Hold,
    /// It leaves.
    Release,
    /// It is away.
    Away,
}

/// One grasp.
#[derive(Clone, Copy, Debug)]
pub struct Grasp {
    /// Travel from first touch of the untouched wall, metres.
    pub depth: f64,
    /// Press, hold, release, and until the next, seconds.
    pub seconds: [f64; 4],
}

/// Two grasps of one object.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// What is grasped.
    pub object: Touched,
    /// Temperature of the wall, degrees Celsius.
    pub celsius: f64,
    /// One after the other.
    pub grasps: [Grasp; 2],
}

/// The solid at an instant of a scene.
#[derive(Clone, Copy, Debug)]
pub struct SceneInstant {
    /// Of which grasp.
    pub grasp: usize,
    /// In which part of it.
    pub phase: GraspPhase,
    /// Time since the scene began, seconds.
    pub time: f64,
    /// The solid.
    pub now: Instant,
}

/// What scenes are drawn for.
#[derive(Clone, Debug)]
pub struct SceneSpace {
    /// The tip. The semi-axes of its membrane are those of the outer surface.
    pub design: Design,
    /// Its series; without a term the wall is elastic.
    pub relaxation: Relaxation,
    /// Its settled press onto a plate.
    pub plate: Curve,
    /// Of the solid in time.
    pub elements: Elements,
}

impl SceneSpace {
    fn height(&self) -> f64 {
        self.design.membrane.axial_semi_axis
    }

    /// The scene of a number.
    pub fn draw(&self, seed: u64, index: u64) -> Scene {
        let mut random = Random(seed ^ index.wrapping_mul(0xd134_2543_de82_ef95));
        random.bits();
        let micrometres = |metres: f64| libm::round(metres * 1e6) as i32;
        let radial = self.design.membrane.radial_semi_axis;
        let crown = radial * radial / self.height();
        let object = match random.bits() % 10 {
            0..4 => Touched::Plate,
            4..8 => Touched::Ball(micrometres(random.logarithmic(BALLS[0], BALLS[1]))),
            _ => Touched::Cup(micrometres(crown * random.logarithmic(CUPS[0], CUPS[1]))),
        };
        let celsius = random.uniform(ROOM[0], ROOM[1]);
        let grasps = [(); 2].map(|()| {
            let seconds = [RAMPS, HOLDS, RELEASES, RESTS].map(|[low, high]| random.logarithmic(low, high));
            let force = random.logarithmic(FORCES[0], FORCES[1]);
            Grasp {
                depth: self.depth(force, seconds[0]),
                seconds,
            }
        });
        Scene {
            object,
            celsius,
            grasps,
        }
    }

    /// The travel that a plate needs for about a force at the end of a ramp.
    fn depth(&self, force: f64, ramp: f64) -> f64 {
        // The series' mean over the ramp.
        let terms = self.relaxation.terms().iter();
        let stiffened: f64 = terms
            .map(|term| term.weight * term.time / ramp * -libm::expm1(-ramp / term.time))
            .sum();
        let settled = force / (1.0 + stiffened);
        let (mut low, mut high) = (0.0, self.plate.end().indentation.min(DEEPEST * self.height()));
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.plate.at_indentation(middle).force < settled {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// The solid in time.
    ///
    /// # Errors
    /// [`HistoryError`] where it finds no state.
    pub fn solve(&self, scene: &Scene) -> Result<Vec<SceneInstant>, HistoryError> {
        let metres = |micrometres: i32| f64::from(micrometres) * 1e-6;
        let design = Design {
            object: Object {
                shape: match scene.object {
                    Touched::Plate => Shape::Plate,
                    Touched::Ball(radius) => Shape::Ball {
                        radius: metres(radius),
                    },
                    Touched::Cup(radius) => Shape::Cup {
                        radius: metres(radius),
                    },
                    Touched::Cylinder(radius) => Shape::Cylinder {
                        radius: metres(radius),
                    },
                },
                friction: Friction::NONE,
            },
            ..self.design
        };
        let wall = self.relaxation.at(scene.celsius);
        let mut history = History::new(&design, &wall, self.elements, 0.0, 0.0)?;
        let most = PRESSURE * self.plate.end().pressure_rise;
        let mut instants = vec![SceneInstant {
            grasp: 0,
            phase: GraspPhase::Press,
            time: 0.0,
            now: history.now(),
        }];
        let (mut time, above) = (0.0, ABOVE * self.height());
        for (grasp, Grasp { depth, seconds }) in scene.grasps.iter().enumerate() {
            let mut deepest = *depth;
            let from = history.now().indentation;
            let phases = [
                GraspPhase::Press,
                GraspPhase::Hold,
                GraspPhase::Release,
                GraspPhase::Away,
            ];
            for ((phase, seconds), count) in phases.into_iter().zip(seconds).zip(INSTANTS) {
                let begin = time;
                for k in 1..=count {
                    let part = f64::from(k) / f64::from(count);
                    // Dense where the contact is small, and after a change.
                    let (passed, travel) = match phase {
                        GraspPhase::Press => {
                            let part = part * libm::sqrt(part);
                            (part * seconds, from + part * (*depth - from))
                        }
                        GraspPhase::Release => {
                            let left = (1.0 - part) * libm::sqrt(1.0 - part);
                            ((1.0 - left) * seconds, above + left * (deepest - above))
                        }
                        GraspPhase::Hold => (SOON * libm::pow(seconds / SOON, part), deepest),
                        GraspPhase::Away => (SOON * libm::pow(seconds / SOON, part), above),
                    };
                    time = begin + passed;
                    let now = history.advance(time, Drive::Indentation(travel))?;
                    instants.push(SceneInstant {
                        grasp,
                        phase,
                        time,
                        now,
                    });
                    if phase == GraspPhase::Press && now.pressure_rise > most {
                        deepest = travel;
                        break;
                    }
                }
            }
        }
        Ok(instants)
    }
}
