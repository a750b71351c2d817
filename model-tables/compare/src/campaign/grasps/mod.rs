//! Real use in time: random objects grasped twice, through the firmware's own signal path.
//!
//! [`SceneSpace::draw`](scene::SceneSpace::draw) a scene -> [`SceneSpace::solve`](scene::SceneSpace::solve) it in time, by the product's
//! own solid -> [`chip::play`] it with several zeros and noises, told the object and not told -> [`GraspTally`].

pub mod chip;
pub mod plates;
pub mod scene;
mod tally;

pub use tally::{GraspRow, GraspTally};

use chip::GraspReading;
use model_tables::constants::Quantity;
use model_tables::design_file::{
    DesignFile, ObjectSection, ShapeSection, TransducerKindSection, TransducerSection,
};
use model_tables::generate::{self, GenerateError, Generated};
use model_tables::material::relaxation::Relaxation;
use model_tables::model::choice::FINE;
use model_tables::object::Friction;
use model_tables::solid::history::HistoryError;
use model_tables::solid::mesh::Elements;
use model_tables::table::law::Touched;
use scene::{Scene, SceneSpace};
use std::sync::atomic::{AtomicU64, Ordering};

/// A tip with its data for two parts: the design's own, and an absolute one on a bus, whose zero the air moves.
#[derive(Clone, Debug)]
pub struct GraspedTip {
    /// What its scenes are drawn for.
    pub space: SceneSpace,
    blocks: Vec<Vec<u8>>,
    /// Where the design relaxes.
    relaxes: bool,
    /// What is stated where the chip is not told: the widest of the band, percent of the reading.
    band: [[f64; 2]; 2],
    /// What is stated of blends of balls, and of cups, percent of the reading.
    blends: [[f64; 2]; 2],
    /// What is stated of mesh and tables, percent of the reading.
    own: [f64; 2],
}

/// A scene as it was read, by one zero and noise.
#[derive(Clone, Debug)]
pub struct PlayedScene {
    /// The scene.
    pub scene: Scene,
    /// Whether the chip was told the object.
    pub told: bool,
    /// Its readings.
    pub readings: Vec<GraspReading>,
}

/// The absolute part: TE MS5837-02BA.
const ABSOLUTE: TransducerSection = TransducerSection {
    range_kpa: [-8.0, 90.0],
    resolution_pa: 10.0,
    noise_pa: 10.0,
    quantity: Quantity::Absolute,
    kind: TransducerKindSection::Ms5837,
};

impl GraspedTip {
    /// Of a design that rests unstretched.
    ///
    /// # Errors
    /// [`GenerateError`] where it has no tables.
    pub fn new(design: &DesignFile, elements: Option<Elements>) -> Result<Self, GenerateError> {
        let with_object = DesignFile {
            object: Some(ObjectSection {
                shape: ShapeSection::Plate,
                friction: Friction::NONE,
                unknown: false,
            }),
            ..design.clone()
        };
        let generated = generate::from_design(with_object.clone())?;
        let mut blocks = vec![generated.binary()];
        let absolute = DesignFile {
            transducer: Some(ABSOLUTE),
            ..with_object
        };
        blocks.push(generate::from_design(absolute)?.binary());
        let widest = generated.band.as_ref().map(generate::object::Band::widest);
        let worst = |cups: bool| {
            let errors = generated
                .certified
                .object
                .iter()
                .flat_map(|object| &object.errors);
            errors
                .filter(|error| (error.radius_mm < 0.0) == cups)
                .fold([0.0_f64; 2], |worst, error| {
                    [
                        worst[0].max(error.answered.force_percent),
                        worst[1].max(error.answered.indentation_percent),
                    ]
                })
        };
        Ok(Self {
            space: SceneSpace {
                design: design.design(),
                relaxation: design.relaxation.unwrap_or(Relaxation::new(&[], 20.0, 0.0)),
                plate: generate::solve(design)?.curve,
                elements: elements.unwrap_or(FINE),
            },
            blocks,
            relaxes: design.relaxation.is_some(),
            band: widest.map_or([[0.0; 2]; 2], |row| [row.force_percent, row.indentation_percent]),
            blends: [worst(false), worst(true)],
            own: own_error(&generated),
        })
    }

    /// What is stated of a reading, percent of it, least and most, of force and indentation.
    pub fn stated(&self, object: Touched, told: bool) -> [[f64; 2]; 2] {
        let both = |percent: [f64; 2]| percent.map(|percent| [-percent, percent]);
        match object {
            _ if !told => self.band,
            Touched::Plate => both(self.own),
            Touched::Cup(_) => both(self.blends[1]),
            Touched::Ball(_) | Touched::Cylinder(_) => both(self.blends[0]),
        }
    }

    /// Whether its wall has a series.
    pub const fn relaxes(&self) -> bool {
        self.relaxes
    }

    /// The scene of a number with so many zeros and noises, half of them of the absolute part; or why there is none.
    fn scene(&self, seed: u64, index: u64, worlds: u64) -> Result<Vec<PlayedScene>, &'static str> {
        let scene = self.space.draw(seed, index);
        let truth = self.space.solve(&scene).map_err(|error| why(&error))?;
        let stiffness = if self.relaxes {
            1.0
        } else {
            chip::warmed(scene.celsius)
        };
        let mut played = Vec::new();
        for world in 0..worlds {
            let block = &self.blocks[(world % 2) as usize];
            for told in [false, true] {
                // The same zero and noise, told and not told.
                let seed = seed ^ (index * worlds + world).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let readings = chip::play(block, &scene, &truth, told, stiffness, seed)
                    .ok_or("the chip has no tables of the object")?;
                played.push(PlayedScene {
                    scene,
                    told,
                    readings,
                });
            }
        }
        Ok(played)
    }

    /// So many scenes on every core; the result does not depend on how many there are. `progress` is called with the number done.
    pub fn run(&self, seed: u64, scenes: u64, worlds: u64, progress: impl Fn(u64) + Sync) -> GraspTally {
        let (next, done) = (AtomicU64::new(0), AtomicU64::new(0));
        let work = || {
            let mut found = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= scenes {
                    break found;
                }
                found.push((index, self.scene(seed, index, worlds)));
                progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            }
        };
        let cores = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
        let mut found: Vec<(u64, Result<Vec<PlayedScene>, &'static str>)> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
            let joined = threads.into_iter().flat_map(|thread| {
                thread
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            });
            joined.collect()
        });
        found.sort_by_key(|(index, _)| *index);
        let mut tally = GraspTally::default();
        for (_, played) in found {
            match played {
                Ok(played) => {
                    tally.scenes += 1;
                    for scene in &played {
                        tally.add(self, scene);
                    }
                }
                Err(why) => *tally.reasons.entry(why).or_default() += 1,
            }
        }
        tally
    }
}

/// Why a scene has no truth, in words.
const fn why(error: &HistoryError) -> &'static str {
    match error {
        HistoryError::Unsolved { indentation, .. } if *indentation <= 0.0 => "no state at first touch",
        HistoryError::Unsolved { .. } => "no further state in balance",
        HistoryError::Ends { .. } => "the wall comes down on its base",
        _ => "refused",
    }
}

/// Errors of mesh and tables, percent of the reading.
fn own_error(generated: &Generated) -> [f64; 2] {
    let mesh = generated
        .model_error
        .as_ref()
        .map_or([0.0; 2], |found| [found.force_percent, found.indentation_percent]);
    let certificate = &generated.certified.certificate;
    [
        mesh[0] + certificate.force.of_reading.max,
        mesh[1] + certificate.indentation.of_reading.max,
    ]
}
