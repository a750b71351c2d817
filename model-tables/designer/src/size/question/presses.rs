//! The search: a coarse solid of each shape, pressed once, scaled to materials and sizes and held against every part; the nearest ones pressed
//! again by their material's own law.

use super::SizingQuestion;
use super::catalogue::CataloguePart;
use model_tables::curve::Contact;
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::preset::Preset;
use model_tables::material::relaxation::Relaxation;
use model_tables::material::{Hyperelastic as _, Law};
use model_tables::object::Object;
use model_tables::solid::press::{COARSE, Press};
use rayon::prelude::*;

/// Heights over radii, walls over radii, and radii over the largest of the search.
const ASPECTS: [f64; 3] = [0.6, 0.8, 1.0];
const WALLS: [f64; 6] = [0.04, 0.06, 0.085, 0.12, 0.17, 0.24];
const SIZES: [f64; 5] = [1.0, 0.87, 0.75, 0.65, 0.56];
/// Indentations over the height at which a press is solved. Deeper the bonded rim takes part and the mesh has to be finer.
const DEPTHS: [f64; 14] = [
    0.003, 0.006, 0.012, 0.025, 0.05, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28, 0.32, 0.36, 0.4,
];
/// Part of a range that a press may fill, by the coarse solid.
const FILLED: f64 = 0.93;
/// The same of a ball: its design is pressed as deep by a plate, at more pressure.
const FILLED_BY_BALL: f64 = 0.5;
/// Half the shear modulus of the law of the first presses, pascals; they are scaled to that of each material.
const REFERENCE: f64 = 1e5;
/// Part of the greatest force that a first press has to reach.
const EASED: f64 = 0.85;
/// Presses by their own law, of one material at most, and for the greatest force.
const NEAREST: usize = 32;
const OF_MATERIAL: usize = 4;
const GREATEST: usize = 4;
/// Radius of a press that is scaled, metres.
const UNIT: f64 = 1e-2;

/// A tip and a part, by a coarse solid.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// The material.
    pub material: &'static Preset,
    /// Outer surface and wall, metres.
    pub membrane: Membrane,
    /// The transducer.
    pub part: &'a CataloguePart,
    /// Indentation at the greatest force of the question, metres.
    pub deepest: f64,
    /// The lightest touch that it tells, newtons.
    pub touch: f64,
    /// The largest `I1 - 3` over that of the material's test; `None` where that is not known.
    pub strain_share: Option<f64>,
}

/// What the search found.
#[derive(Clone, Debug)]
pub struct SearchedTips<'a> {
    /// Tips with a part that reach the greatest force within range and tested strain, the lightest touch first.
    pub reaching: Vec<Candidate<'a>>,
    /// The greatest force of all, newtons, whatever the lightest touch.
    pub greatest: f64,
    /// Presses solved.
    pub solved: usize,
}

/// Stress over the relaxed one at the end of a load that grows evenly for so many seconds: the mean of the series over them.
pub fn stiffening(series: Option<&Relaxation>, seconds: f64) -> f64 {
    series.map_or(1.0, |series| {
        series.terms().iter().fold(1.0, |sum, term| {
            let x = seconds / term.time;
            sum + term.weight * (1.0 - libm::exp(-x)) / x
        })
    })
}

/// A shape that is pressed, and the radii that its press stands for, metres.
struct PressedShape {
    membrane: Membrane,
    radii: Vec<f64>,
}

/// The shapes within the space.
fn shapes(question: &SizingQuestion) -> Vec<PressedShape> {
    // A plate has no length of its own: one press stands for every size.
    let is_scaled = question.touched() == Object::PLATE;
    let [diameter, height] = question.space_mm.map(|mm| 1e-3 * mm);
    let mut shapes = Vec::new();
    for aspect in ASPECTS {
        let largest = (0.5 * diameter).min(height / aspect);
        for wall in WALLS {
            let shape = |radius: f64, radii: Vec<f64>| PressedShape {
                membrane: Membrane {
                    radial_semi_axis: radius,
                    axial_semi_axis: aspect * radius,
                    thickness: wall * radius,
                },
                radii,
            };
            let radii: Vec<f64> = SIZES
                .map(|part| part * largest)
                .into_iter()
                .filter(|radius| wall * radius >= 0.999e-3 * question.making_mm[1])
                .collect();
            if is_scaled && !radii.is_empty() {
                shapes.push(shape(UNIT, radii));
            } else {
                shapes.extend(radii.into_iter().map(|radius| shape(radius, vec![radius])));
            }
        }
    }
    shapes
}

/// Presses every shape, of one law and then of the materials that come nearest by it, and holds them against every part.
pub fn search<'a>(
    question: &SizingQuestion,
    parts: &[&'a CataloguePart],
    advance: &(dyn Fn(f64) + Sync),
) -> SearchedTips<'a> {
    let shapes = shapes(question);
    let reference = Law::NeoHookean { c1: REFERENCE };
    let drafts: Vec<Option<PressStates>> = shapes
        .par_iter()
        .map(|shape| coarse(reference, shape.membrane, question.touched()))
        .collect();
    advance(0.5);
    // By small strains alone: what is a little off may be right by its own law.
    let eased = SizingQuestion {
        greatest_n: EASED * question.greatest_n,
        ..question.clone()
    };
    let mut pairs: Vec<(f64, f64, &'static Preset, usize)> = Vec::new();
    for &material in &question.materials {
        let stiffer = material.law.shear_modulus() / reference.shear_modulus();
        for (k, (shape, draft)) in shapes.iter().zip(&drafts).enumerate() {
            let Some(draft) = draft else { continue };
            let (greatest, found) = against_all(&eased, material, &draft.stiffened(stiffer), shape, parts);
            let touch = found
                .iter()
                .map(|found| found.touch)
                .fold(f64::INFINITY, f64::min);
            pairs.push((touch, greatest, material, k));
        }
    }
    let solved = nearest(pairs);
    let count = drafts.len() + solved.len();
    let found: Vec<(f64, Vec<Candidate<'a>>)> = solved
        .par_iter()
        .filter_map(|&(material, k)| {
            let shape = &shapes[k];
            let (curve, strain) = press(
                material.law,
                shape.membrane,
                question.touched(),
                material.largest_invariant(),
            )?;
            let (greatest, mut found) = against_all(question, material, &curve, shape, parts);
            for candidate in &mut found {
                let scale = candidate.membrane.radial_semi_axis / shape.membrane.radial_semi_axis;
                candidate.strain_share = strain.map(|strain| strain.at(candidate.deepest / scale));
            }
            Some((greatest, found))
        })
        .collect();
    advance(1.0);
    let greatest = found.iter().map(|(force, _)| *force).fold(0.0, f64::max);
    let mut reaching: Vec<Candidate<'a>> = found.into_iter().flat_map(|(_, found)| found).collect();
    reaching.retain(|candidate| candidate.strain_share.is_none_or(|share| share <= 1.0));
    reaching.sort_by(|a, b| a.touch.total_cmp(&b.touch));
    SearchedTips {
        reaching,
        greatest,
        solved: count,
    }
}

/// The materials and shapes that are pressed by their own law: those with the lightest touch, no material more often than
/// [`OF_MATERIAL`], and those with the greatest force.
fn nearest(mut pairs: Vec<(f64, f64, &'static Preset, usize)>) -> Vec<(&'static Preset, usize)> {
    let mut chosen: Vec<(&'static Preset, usize)> = Vec::new();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    for &(touch, _, material, k) in &pairs {
        let of_material = chosen
            .iter()
            .filter(|(other, _)| other.name == material.name)
            .count();
        if touch.is_finite() && of_material < OF_MATERIAL && chosen.len() < NEAREST {
            chosen.push((material, k));
        }
    }
    pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    for &(_, _, material, k) in pairs.iter().take(GREATEST) {
        if chosen
            .iter()
            .all(|(other, shape)| other.name != material.name || *shape != k)
        {
            chosen.push((material, k));
        }
    }
    chosen
}

/// A press of a shape in every size against every part: the greatest force that a part reads, and the candidates.
fn against_all<'a>(
    question: &SizingQuestion,
    material: &'static Preset,
    curve: &PressStates,
    shape: &PressedShape,
    parts: &[&'a CataloguePart],
) -> (f64, Vec<Candidate<'a>>) {
    let mut greatest = 0.0_f64;
    let mut candidates = Vec::new();
    for size in &shape.radii {
        let scale = size / shape.membrane.radial_semi_axis;
        let curve = curve.scaled(scale);
        for &part in parts {
            let (force, candidate) = held_against(question, material, &curve, shape.membrane, scale, part);
            greatest = greatest.max(force);
            candidates.extend(candidate);
        }
    }
    (greatest, candidates)
}

/// States of a press, the untouched one first: straight lines in logarithms.
#[derive(Clone, Debug)]
pub struct PressStates(Vec<Contact>);

impl PressStates {
    fn scaled(&self, scale: f64) -> Self {
        Self(
            self.0
                .iter()
                .map(|contact| Contact {
                    indentation: scale * contact.indentation,
                    pressure_rise: contact.pressure_rise,
                    force: scale * scale * contact.force,
                })
                .collect(),
        )
    }

    /// Of a wall so many times as stiff.
    fn stiffened(&self, stiffer: f64) -> Self {
        Self(
            self.0
                .iter()
                .map(|contact| Contact {
                    pressure_rise: stiffer * contact.pressure_rise,
                    force: stiffer * contact.force,
                    ..*contact
                })
                .collect(),
        )
    }

    /// The deepest state.
    pub fn end(&self) -> Contact {
        self.0[self.0.len() - 1]
    }

    /// The state where `of` it is a value; beyond the first and last ones their slope goes on.
    pub fn at(&self, of: impl Fn(&Contact) -> f64, value: f64) -> Contact {
        let after = self.0.iter().position(|contact| of(contact) >= value);
        let after = after.unwrap_or(self.0.len() - 1).max(1);
        let (a, b) = (self.0[after - 1], self.0[after]);
        let part = libm::log(value / of(&a)) / libm::log(of(&b) / of(&a));
        let between = |a: f64, b: f64| a * libm::pow(b / a, part);
        Contact {
            indentation: between(a.indentation, b.indentation),
            pressure_rise: between(a.pressure_rise, b.pressure_rise),
            force: between(a.force, b.force),
        }
    }
}

/// `I1 - 3` over that of the test, by indentation.
#[derive(Clone, Copy, Debug)]
struct Strain {
    states: [[f64; 2]; DEPTHS.len()],
    count: usize,
}

impl Strain {
    fn at(&self, indentation: f64) -> f64 {
        let states = &self.states[..self.count];
        states
            .iter()
            .find(|[depth, _]| *depth >= indentation)
            .or(states.last())
            .map_or(0.0, |[_, share]| *share)
    }
}

/// A press of a coarse solid, as far as it goes; `None` where fewer than three states are found.
fn press(
    law: Law,
    membrane: Membrane,
    object: Object,
    most: Option<f64>,
) -> Option<(PressStates, Option<Strain>)> {
    let design = Design {
        membrane,
        law,
        rest: RestBy::Unstretched,
        compliance: 0.0,
        object,
    };
    let mut press = Press::new(&design, COARSE).ok()?;
    let mut states = Vec::new();
    let mut strain = Strain {
        states: [[0.0; 2]; DEPTHS.len()],
        count: 0,
    };
    for part in DEPTHS {
        let depth = part * membrane.axial_semi_axis;
        let (Ok(contact), Ok(invariant)) = (press.contact_at(depth), press.largest_invariant(depth)) else {
            break;
        };
        let grows = states.last().is_none_or(|last: &Contact| {
            contact.force > last.force && contact.pressure_rise > last.pressure_rise
        });
        if !(grows && contact.force > 0.0 && contact.pressure_rise > 0.0) {
            break;
        }
        states.push(contact);
        strain.states[strain.count] = [depth, (invariant - 3.0) / most.unwrap_or(f64::INFINITY)];
        strain.count += 1;
    }
    (states.len() >= 3).then(|| (PressStates(states), most.map(|_| strain)))
}

/// A press of a wall, whatever the question: of a tip and its tolerance.
pub fn coarse(law: Law, membrane: Membrane, object: Object) -> Option<PressStates> {
    press(law, membrane, object, None).map(|(pressed, _)| pressed)
}

/// The lightest touch that a press tells where its pressure has to rise to `least`, relaxed or stiffened by what a grasp leaves.
///
/// A wall `m` times as stiff has `m` times the force at `m` times the pressure.
pub fn lightest(force_at: impl Fn(f64) -> f64, least: f64, stiffened: f64) -> f64 {
    force_at(least).max(stiffened * force_at(least / stiffened))
}

/// The greatest force that a part reads of a press, and the candidate where it is what the question asks.
fn held_against<'a>(
    question: &SizingQuestion,
    material: &'static Preset,
    curve: &PressStates,
    membrane: Membrane,
    scale: f64,
    part: &'a CataloguePart,
) -> (f64, Option<Candidate<'a>>) {
    let stiffened = stiffening(material.relaxation.as_ref(), question.grasp_s);
    let end = curve.end();
    let filled = if question.radius_mm.is_none() {
        FILLED
    } else {
        FILLED_BY_BALL
    };
    let highest = filled * part.highest();
    let greatest = if end.pressure_rise > highest {
        curve.at(|contact| contact.pressure_rise, highest).force
    } else {
        end.force
    };
    if greatest < question.greatest_n {
        return (greatest, None);
    }
    let deepest = curve.at(|contact| contact.force, question.greatest_n).indentation;
    let force_at = |pascals: f64| curve.at(|contact| contact.pressure_rise, pascals).force;
    let candidate = Candidate {
        material,
        membrane: Membrane {
            radial_semi_axis: scale * membrane.radial_semi_axis,
            axial_semi_axis: scale * membrane.axial_semi_axis,
            thickness: scale * membrane.thickness,
        },
        part,
        deepest,
        touch: lightest(force_at, part.touch(question.grasp_s), stiffened),
        strain_share: None,
    };
    (greatest, Some(candidate))
}
