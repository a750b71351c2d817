//! Errors of a campaign of grasps: how large, and how often within what was reported.

use super::scene::GraspPhase;
use super::{GraspedTip, PlayedScene};
use model_tables::table::law::Touched;
use std::collections::BTreeMap;
use std::fmt;

/// Smallest true force whose error is taken in percent, newtons.
const FROM: f64 = 0.2;
/// Standard deviations that a reading may be off.
const DEVIATIONS: f64 = 3.0;
/// What the README states of a wall that is stepped in time: percent of the largest force and indentation so far.
const IN_TIME: [f64; 2] = [7.0, 2.0];
/// Kelvins from the temperature of the series within which a wall is as warm as the chip takes it to be.
const AS_WARM: f64 = 1.0;
/// Degrees Celsius of the series.
const OWN: f64 = 20.0;

/// A row of the result.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum GraspRow {
    /// Everything in contact.
    All,
    /// Onto plates.
    Plate,
    /// Onto balls.
    Ball,
    /// Into cups.
    Cup,
    /// While pressed, the first time.
    Press,
    /// While held, the first time.
    Hold,
    /// On releases.
    Release,
    /// While pressed and held the second time.
    Next,
    /// Of walls as warm as their series, within a kelvin.
    OwnTemperature,
}

impl GraspRow {
    const fn words(self) -> &'static str {
        match self {
            Self::All => "**all**",
            Self::Plate => "plates",
            Self::Ball => "balls",
            Self::Cup => "cups",
            Self::Press => "first press",
            Self::Hold => "first hold",
            Self::Release => "releases",
            Self::Next => "next press and hold",
            Self::OwnTemperature => "wall within 1 K of 20 degrees",
        }
    }
}

/// Errors of one row.
#[derive(Clone, Debug, Default)]
pub struct GraspErrors {
    /// Percent of the truth of force and indentation, each with its weight.
    errors: [Vec<(f64, f64)>; 2],
    /// Weights of all, of those without a value, of those within the deviations, and of those within all that is stated.
    weights: [f64; 4],
}

impl GraspErrors {
    /// The error of force and indentation, percent, that this share stays within.
    pub fn within(&self, share: f64) -> [f64; 2] {
        [0, 1].map(|output| {
            let mut sorted = self.errors[output].clone();
            sorted.sort_by(|one, other| one.0.total_cmp(&other.0));
            let whole: f64 = sorted.iter().map(|error| error.1).sum();
            let mut passed = 0.0;
            let found = sorted.iter().find(|error| {
                passed += error.1;
                passed >= share * whole
            });
            found.map_or(f64::NAN, |error| error.0)
        })
    }

    /// The share without a value, and of those with one the share within three deviations, and within all that is stated.
    pub fn shares(&self) -> [f64; 3] {
        let [all, without, near, stated] = self.weights;
        [without / all, near / (all - without), stated / (all - without)]
    }
}

/// What came of scenes, not told and told.
#[derive(Clone, Debug, Default)]
pub struct GraspTally {
    rows: BTreeMap<(bool, GraspRow), GraspErrors>,
    /// Readings in contact.
    pub readings: u64,
    /// Force read of what does not touch, percent of the largest force of the scene, each with its weight.
    free: Vec<(f64, f64)>,
    /// Scenes of which the solid found a state.
    pub scenes: u64,
    /// How many have none, by reason.
    pub reasons: BTreeMap<&'static str, u64>,
}

impl GraspTally {
    /// Scenes of which the solid found no state.
    pub fn unsolved(&self) -> u64 {
        self.reasons.values().sum()
    }

    /// A row, of a chip that is told or not told what it touches.
    pub fn row(&self, told: bool, row: GraspRow) -> Option<&GraspErrors> {
        self.rows.get(&(told, row))
    }

    /// The force read of what no longer touches, percent of the largest force of the scene: what 95 % stay within, and the largest.
    pub fn free(&self) -> [f64; 2] {
        let free = GraspErrors {
            errors: [self.free.clone(), vec![]],
            ..GraspErrors::default()
        };
        [free.within(0.95)[0], free.within(1.0)[0]]
    }

    /// Adds a scene.
    pub(super) fn add(&mut self, tip: &GraspedTip, played: &PlayedScene) {
        let stated = tip.stated(played.scene.object, played.told);
        let own = (played.scene.celsius - OWN).abs() <= AS_WARM;
        for reading in &played.readings {
            let [force, depth] = reading.truth;
            if force < FROM {
                if reading.phase == GraspPhase::Away
                    && force <= 0.0
                    && let Some(read) = &reading.read
                {
                    self.free
                        .push((100.0 * read.values[0] / reading.peak[0].max(FROM), reading.weight));
                }
                continue;
            }
            self.readings += 1;
            let object = match played.scene.object {
                Touched::Plate => GraspRow::Plate,
                Touched::Cup(_) => GraspRow::Cup,
                Touched::Ball(_) | Touched::Cylinder(_) => GraspRow::Ball,
            };
            let phase = match (reading.phase, reading.grasp) {
                (GraspPhase::Release, _) => Some(GraspRow::Release),
                (GraspPhase::Press, 0) => Some(GraspRow::Press),
                (GraspPhase::Hold, 0) => Some(GraspRow::Hold),
                (GraspPhase::Press | GraspPhase::Hold, _) => Some(GraspRow::Next),
                (GraspPhase::Away, _) => None,
            };
            let rows = [
                Some(GraspRow::All),
                Some(object),
                phase,
                own.then_some(GraspRow::OwnTemperature),
            ];
            for row in rows.into_iter().flatten() {
                let errors = self.rows.entry((played.told, row)).or_default();
                errors.weights[0] += reading.weight;
                let Some(read) = &reading.read else {
                    errors.weights[1] += reading.weight;
                    continue;
                };
                let (mut near, mut within) = (true, true);
                for (output, truth) in [force, depth].into_iter().enumerate() {
                    let (value, sigma) = (read.values[output], read.sigma[output]);
                    errors.errors[output].push((100.0 * (value / truth - 1.0).abs(), reading.weight));
                    let deviations = DEVIATIONS * sigma;
                    near &= (value - truth).abs() <= deviations;
                    let in_time = if tip.relaxes() {
                        IN_TIME[output] / 100.0 * reading.peak[output]
                    } else {
                        0.0
                    };
                    let room = deviations + in_time;
                    let [least, most] = stated[output].map(|percent| value * (1.0 + percent / 100.0));
                    within &= (least - room..=most + room).contains(&truth);
                }
                errors.weights[2] += if near { reading.weight } else { 0.0 };
                errors.weights[3] += if within { reading.weight } else { 0.0 };
            }
        }
    }
}

impl fmt::Display for GraspTally {
    /// A table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| the chip | readings of | F median, % | F 95 % | H median, % | H 95 % | without a value, % | within 3 sigma, % | within \
             all that is stated, % |\n|---|---|---|---|---|---|---|---|---|"
        )?;
        for ((told, row), errors) in &self.rows {
            let [median, most] = [errors.within(0.5), errors.within(0.95)];
            let [without, near, stated] = errors.shares().map(|share| 100.0 * share);
            writeln!(
                f,
                "| {} | {} | {:.1} | {:.1} | {:.1} | {:.1} | {without:.1} | {near:.1} | {stated:.1} |",
                if *told { "told" } else { "not told" },
                row.words(),
                median[0],
                most[0],
                median[1],
                most[1],
            )?;
        }
        let [most, largest] = self.free();
        writeln!(
            f,
            "\n{} scenes ({} without a state), {} readings in contact, told and not told. No longer touched: force read {most:.1} % of the scene's \
             largest (95 %), {largest:.1} % at most.",
            self.scenes,
            self.unsolved(),
            self.readings
        )?;
        for (why, scenes) in &self.reasons {
            writeln!(f, "Without a state: {scenes} ({why}).")?;
        }
        Ok(())
    }
}
