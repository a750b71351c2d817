//! Grasps of plates that are tilted or rub: the product's own solid on a frictionless plate in time, changed by the [quoted] figures.
//!
//! The figures are ratios of settled states. Here they are used in time and on releases too, where no figure is known.

use super::chip;
use super::scene::{Scene, SceneInstant};
use super::tally::{GraspRow, GraspTally};
use super::{GraspedTip, PlayedScene, why};
use model_tables::curve::Curve;
use model_tables::generate::object::quoted;
use model_tables::random::Random;
use model_tables::table::law::Touched;
use std::fmt;

/// The coefficient of friction of the quoted figures.
const QUOTED_FRICTION: f64 = 0.3;
/// Degrees up to which a tilt counts as small.
const SMALL_TILT: f64 = 10.0;

/// What is not as the tables take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlateTouch {
    /// On the axis, frictionless.
    Flat,
    /// Tilted by so many degrees; where in the quoted range of its force, 0 to 1.
    Tilted(f64, f64),
    /// With a coefficient of friction.
    Rubbed(f64),
}

impl PlateTouch {
    /// Those of the scene of a number: one of each kind.
    fn draw(seed: u64, index: u64) -> [Self; 3] {
        let mut random = Random(seed ^ index.wrapping_mul(0xa076_1d64_78bd_642f));
        random.bits();
        [
            Self::Flat,
            Self::Tilted(random.uniform(0.0, quoted::MAX_TILT), random.uniform(0.0, 1.0)),
            Self::Rubbed(random.uniform(0.0, QUOTED_FRICTION)),
        ]
    }

    /// Changes an instant on a flat, frictionless plate, whose settled press is `plate`, of a dome of this height, metres.
    pub fn change(self, instant: &mut SceneInstant, plate: &Curve, height: f64) {
        let now = &mut instant.now;
        match self {
            Self::Flat => {}
            Self::Tilted(degrees, part) => {
                let [least, most] = quoted::tilted_force(degrees);
                let force = least + part * (most - least);
                now.force *= force;
                if now.indentation > 0.0 {
                    now.indentation *= quoted::tilted_product(degrees) / force;
                }
            }
            Self::Rubbed(coefficient) => {
                if now.indentation <= 0.0 || now.force <= 0.0 {
                    return;
                }
                let share = coefficient / QUOTED_FRICTION;
                let settled = plate.at_indentation(now.indentation.min(plate.end().indentation));
                let stiffened = libm::pow(quoted::rubbed_pressure(now.indentation / height), share);
                // What a table reads at the raised pressure, and what the force then is.
                let read = plate
                    .at_pressure_rise((settled.pressure_rise * stiffened).min(plate.end().pressure_rise));
                now.pressure_rise *= stiffened;
                now.force *= read.force / settled.force
                    * libm::pow(quoted::rubbed_force(read.indentation / height), share);
            }
        }
    }

    const fn row(self) -> usize {
        match self {
            Self::Flat => 0,
            Self::Tilted(degrees, _) if degrees <= SMALL_TILT => 1,
            Self::Tilted(..) => 2,
            Self::Rubbed(_) => 3,
        }
    }
}

/// What came of each kind of plate, of a chip that is told nothing.
#[derive(Clone, Debug, Default)]
pub struct PlateTally {
    /// Flat, tilted a little, tilted more, rubbed.
    pub rows: [GraspTally; 4],
    /// Scenes without a state.
    pub unsolved: u64,
}

impl GraspedTip {
    /// Scenes of plates, each flat, tilted and rubbed. `progress` is called with the number done.
    pub fn run_plates(&self, seed: u64, scenes: u64, worlds: u64, progress: impl Fn(u64)) -> PlateTally {
        let mut tally = PlateTally::default();
        for index in 0..scenes {
            let scene = Scene {
                object: Touched::Plate,
                ..self.space.draw(seed, index)
            };
            match self.space.solve(&scene) {
                Ok(truth) => self.play_plates(seed, index, worlds, &scene, &truth, &mut tally),
                Err(error) => {
                    tally.unsolved += 1;
                    eprintln!("scene {index}: {}", why(&error));
                }
            }
            progress(index + 1);
        }
        tally
    }

    fn play_plates(
        &self,
        seed: u64,
        index: u64,
        worlds: u64,
        scene: &Scene,
        truth: &[SceneInstant],
        tally: &mut PlateTally,
    ) {
        let stiffness = if self.relaxes() {
            1.0
        } else {
            chip::warmed(scene.celsius)
        };
        let height = self.space.design.membrane.axial_semi_axis;
        for touch in PlateTouch::draw(seed, index) {
            let mut changed = truth.to_vec();
            for instant in &mut changed {
                touch.change(instant, &self.space.plate, height);
            }
            let row = &mut tally.rows[touch.row()];
            row.scenes += 1;
            for world in 0..worlds {
                let block = &self.blocks[(world % 2) as usize];
                // The same zero and noise for each kind.
                let seed = seed ^ (index * worlds + world).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                if let Some(readings) = chip::play(block, scene, &changed, false, stiffness, seed) {
                    let played = PlayedScene {
                        scene: *scene,
                        told: false,
                        readings,
                    };
                    row.add(self, &played);
                }
            }
        }
    }
}

impl fmt::Display for PlateTally {
    /// A table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const WORDS: [&str; 4] = [
            "flat, without friction",
            "tilted by up to 10 degrees (quoted)",
            "tilted by 10 to 20 degrees (quoted)",
            "with a coefficient of friction up to 0.3 (quoted)",
        ];
        writeln!(
            f,
            "| plates | scenes | F median, % | F 95 % | H median, % | H 95 % | within 3 sigma, % | within all that is stated, % |\n\
             |---|---|---|---|---|---|---|---|"
        )?;
        for (words, row) in WORDS.iter().zip(&self.rows) {
            let Some(errors) = row.row(false, GraspRow::All) else {
                continue;
            };
            let [median, most] = [errors.within(0.5), errors.within(0.95)];
            let [_, near, stated] = errors.shares().map(|share| 100.0 * share);
            writeln!(
                f,
                "| {words} | {} | {:.1} | {:.1} | {:.1} | {:.1} | {near:.1} | {stated:.1} |",
                row.scenes, median[0], most[0], median[1], most[1]
            )?;
        }
        if self.unsolved > 0 {
            writeln!(f, "\n{} scenes without a state.", self.unsolved)?;
        }
        Ok(())
    }
}
