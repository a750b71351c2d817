//! Random solids: does an answer depend on what else is asked, is the error stated, and does every press have an end?

use model_tables::curve::Contact;
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::PRESETS;
use model_tables::model::ModelError;
use model_tables::model::choice::Wanted;
use model_tables::model::mesh_error::MeshError;
use model_tables::object::Object;
use model_tables::random::Random;
use model_tables::solid::SolidError;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::Press;
use std::collections::BTreeMap;
use std::fmt;

/// Elements of the solids asked.
const ASKED: Elements = Elements {
    through: 2,
    along: 24,
};
/// Elements of those that judge the error that `designer solve` states.
const JUDGE: Elements = Elements {
    through: 3,
    along: 96,
};
/// Indentations, over the deepest.
const PARTS: [f64; 5] = [0.04, 0.15, 0.4, 0.7, 1.0];
/// Deepest indentation over the undeformed height; less where the press ends before.
const DEPTH: f64 = 0.35;
/// The part of the deepest reading below which errors count in absolute terms.
const FROM: f64 = 0.01;
/// What the judge itself may be off, relative: [`model_tables::model::choice`] has the same of a finer mesh.
const OF_THE_JUDGE: f64 = 6e-3;

/// What became of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SolidVerdict {
    /// Every way gives the same bits, and the stated error covers that of the judge.
    Agrees,
    /// The same, and a finer mesh has no such state, or is off by too much: the error is stated as not known.
    NotKnown,
    /// It has no rest state, for this reason.
    NoRest(&'static str),
    /// Alone, in a list or by half steps: the answers differ.
    DependsOnTheWay,
    /// The judge finds more than the stated error.
    Silent,
    /// A state before the end of the press was not found and is refused; the judge has it.
    NotOnThisMesh,
    /// The same, and the judge does not have it either, or the end is no state.
    Lost,
}

/// A judged solid.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedSolid {
    /// Its number.
    pub index: u64,
    /// The design.
    pub design: Design,
    /// What became of it.
    pub verdict: SolidVerdict,
    /// Error that `designer solve` states, relative; NaN where it is not known.
    pub stated: f64,
    /// Error that the judge finds, relative; NaN where it has not every state.
    pub found: f64,
    /// Word of what ends the press.
    pub ends_by: &'static str,
}

/// The solid of a number: outer radius 5 to 15 mm, height 0.3 to 3 of it, wall 0.01 to 0.3 of it, a law of each kind or a preset, one in three
/// with compliance.
pub fn draw(index: u64) -> Design {
    let mut random = Random(index);
    let radial = random.uniform(5e-3, 15e-3);
    let axial = radial * random.logarithmic(0.3, 3.0);
    // No thicker than two thirds of a flat dome.
    let thickness = (radial * random.logarithmic(0.01, 0.3)).min(0.65 * axial);
    let c1 = random.logarithmic(5e3, 3e5);
    let law = match index % 4 {
        0 => Law::NeoHookean { c1 },
        1 => Law::MooneyRivlin {
            c1,
            c2: c1 * random.uniform(-0.3, 1.0),
        },
        2 => Law::Yeoh {
            c1,
            c2: c1 * random.uniform(-0.1, 0.2),
            c3: c1 * random.uniform(0.0, 0.05),
        },
        _ => PRESETS[(random.bits() % PRESETS.len() as u64) as usize].law,
    };
    // A tenth of the volume inside at a tenth of the modulus.
    let compliance = 0.2 * radial * radial * axial / c1;
    Design {
        membrane: Membrane {
            radial_semi_axis: radial,
            axial_semi_axis: axial,
            thickness,
        },
        law,
        rest: RestBy::Unstretched,
        compliance: if random.unit() < 1.0 / 3.0 {
            compliance
        } else {
            0.0
        },
        object: Object::PLATE,
    }
}

fn list(press: &mut Press, depths: &[f64]) -> Result<Vec<Contact>, SolidError> {
    depths.iter().map(|&depth| press.contact_at(depth)).collect()
}

/// Solves the solid of a number in every way.
pub fn judge(index: u64) -> JudgedSolid {
    let design = draw(index);
    let mut judged = JudgedSolid {
        index,
        design,
        verdict: SolidVerdict::Lost,
        stated: f64::NAN,
        found: f64::NAN,
        ends_by: "",
    };
    let rest = match Press::new(&design, ASKED) {
        Ok(rest) => rest,
        Err(error) => {
            judged.verdict = SolidVerdict::NoRest(match error {
                ModelError::Solid(SolidError::NoStiffness { .. }) => "no-stiffness",
                _ => "rest-unsolved",
            });
            return judged;
        }
    };
    let Ok(limit) = rest.clone().limit() else {
        return judged;
    };
    judged.ends_by = limit.ends_by.word();
    let deepest = (DEPTH * design.membrane.axial_semi_axis).min(limit.indentation);
    let depths = PARTS.map(|part| part * deepest);
    let by_judge = Press::new(&design, JUDGE)
        .ok()
        .and_then(|mut press| list(&mut press, &depths).ok());
    let Ok(in_list) = list(&mut rest.clone(), &depths) else {
        if by_judge.is_some() {
            judged.verdict = SolidVerdict::NotOnThisMesh;
        }
        return judged;
    };
    let alone: Result<Vec<Contact>, SolidError> = depths
        .iter()
        .map(|&depth| rest.clone().contact_at(depth))
        .collect();
    let half_steps: Vec<f64> = depths.iter().flat_map(|depth| [0.5 * depth, *depth]).collect();
    let by_half_steps = list(&mut rest.clone(), &half_steps)
        .map(|contacts| contacts.into_iter().skip(1).step_by(2).collect::<Vec<Contact>>());
    let reversed: Vec<f64> = depths.iter().rev().copied().collect();
    let backwards = list(&mut rest.clone(), &reversed)
        .map(|contacts| contacts.into_iter().rev().collect::<Vec<Contact>>());
    if [alone, by_half_steps, backwards]
        .iter()
        .any(|way| way.as_ref() != Ok(&in_list))
    {
        judged.verdict = SolidVerdict::DependsOnTheWay;
        return judged;
    }
    let wanted = Wanted {
        error: 0.0,
        from: FROM,
        deepest,
        is_stated: true,
    };
    let found = by_judge.map(|truth| wanted.distance(&in_list, &truth));
    let stated = MeshError::of(&design, ASKED, &in_list)
        .ok()
        .filter(MeshError::is_known)
        .map(|error| error.bound);
    judged.verdict = match (stated, found) {
        (Some(stated), Some(found)) => {
            (judged.stated, judged.found) = (stated, found);
            if found <= stated.max(OF_THE_JUDGE) {
                SolidVerdict::Agrees
            } else {
                SolidVerdict::Silent
            }
        }
        (stated, _) => {
            judged.stated = stated.unwrap_or(f64::NAN);
            SolidVerdict::NotKnown
        }
    };
    judged
}

/// How many solids came to what, and how their presses end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolidCounts {
    /// By verdict.
    pub verdicts: BTreeMap<SolidVerdict, u64>,
    /// By the word of the end.
    pub ends: BTreeMap<&'static str, u64>,
}

impl SolidCounts {
    /// Counts one more.
    pub fn add(&mut self, judged: &JudgedSolid) {
        *self.verdicts.entry(judged.verdict).or_default() += 1;
        *self.ends.entry(judged.ends_by).or_default() += 1;
    }

    /// Whether no answer depended on the way, none was off by more than stated, and none was lost.
    pub fn holds(&self) -> bool {
        [
            SolidVerdict::DependsOnTheWay,
            SolidVerdict::Silent,
            SolidVerdict::Lost,
        ]
        .iter()
        .all(|verdict| !self.verdicts.contains_key(verdict))
    }
}

impl fmt::Display for SolidCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (verdict, count) in &self.verdicts {
            writeln!(f, "{count:6} {verdict:?}")?;
        }
        for (ends_by, count) in &self.ends {
            writeln!(f, "{count:6} end by {ends_by}")?;
        }
        Ok(())
    }
}
