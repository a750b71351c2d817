//! Random walls: every fidelity of the ladder against the refined solid, and what the rule of `auto` lets through.

use crate::methods::light_contact::LightContact;
use model_tables::curve::Contact;
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::{AGILUS30, SKIN};
use model_tables::model::ModelError;
use model_tables::model::choice::{LADDER, PARTS, Wanted};
use model_tables::model::{Fingertip, Kind};
use model_tables::object::Object;
use model_tables::random::Random;
use model_tables::solid::inflation::mid_surface;
use std::time::Instant;

/// Accuracies that the rule is asked for, relative.
pub const ASKED: [f64; 5] = [0.1, 0.05, 0.02, 0.01, 0.005];
/// Deepest indentation over the undeformed height.
const DEPTH: f64 = 0.35;
/// The part of the deepest reading below which errors count in absolute terms.
pub const FROM: f64 = 0.01;

/// A wall whose semi-axes are the outer surface's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomWall {
    /// Its number.
    pub index: u64,
    /// The design.
    pub design: Design,
}

/// What a fidelity did.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// Its contacts, or why there are none.
    pub contacts: Result<Vec<Contact>, ModelError>,
    /// Time of a state, from rest on, seconds.
    pub seconds: f64,
    /// Largest error against the refined solid, relative.
    pub error: f64,
}

/// Every fidelity of one wall.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredWall {
    /// The wall.
    pub case: RandomWall,
    /// The closed form of the membrane's light contact, relative error; `None` where it has not all states.
    pub closed_form: Option<f64>,
    /// The ladder, in its order; `None` where a fidelity does not apply.
    pub fidelities: [Option<Evidence>; LADDER.len()],
}

/// What the rule takes, and the error it lets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taken {
    /// Place on the ladder.
    pub fidelity: usize,
    /// Against the refined solid, relative.
    pub error: f64,
}

/// The wall of a number: outer radius 5 to 12 mm, height 0.6 to 1.4 of it, wall 0.1 to 1.5 mm, one in three unstretched, the
/// others stretched by 1 % to 100 % at the pole.
pub fn draw(index: u64) -> RandomWall {
    let mut random = Random(index);
    let radial = random.uniform(5e-3, 12e-3);
    let axial = radial * random.uniform(0.6, 1.4);
    let thickness = random.logarithmic(0.1e-3, 1.5e-3).min(0.25 * radial.min(axial));
    let stretch = 1.0 + random.logarithmic(0.01, 1.0);
    let law = match index % 3 {
        0 => AGILUS30,
        1 => SKIN,
        _ => Law::Yeoh {
            c1: 20_400.0,
            c2: 4_470.0,
            c3: 0.0,
        },
    };
    let rest = if random.unit() < 1.0 / 3.0 {
        RestBy::Unstretched
    } else {
        RestBy::PoleStretch(stretch)
    };
    RandomWall {
        index,
        design: Design {
            membrane: Membrane {
                radial_semi_axis: radial,
                axial_semi_axis: axial,
                thickness,
            },
            law,
            rest,
            compliance: 0.0,
            object: Object::PLATE,
        },
    }
}

impl RandomWall {
    /// What is asked of it, to an accuracy.
    pub fn wanted(&self, error: f64) -> Wanted {
        Wanted {
            error,
            from: FROM,
            deepest: DEPTH * self.design.membrane.axial_semi_axis,
            is_stated: true,
        }
    }

    /// Solves every fidelity.
    pub fn measure(self) -> MeasuredWall {
        let wanted = self.wanted(1.0);
        let mut fidelities = LADDER.map(|kind| kind.applies(&self.design).then(|| self.solve(kind, &wanted)));
        let truth = match &fidelities[LADDER.len() - 1] {
            Some(Evidence {
                contacts: Ok(truth), ..
            }) => truth.clone(),
            _ => Vec::new(),
        };
        for evidence in fidelities.iter_mut().flatten() {
            if let Ok(contacts) = &evidence.contacts {
                evidence.error = wanted.distance(contacts, &truth);
            }
        }
        let closed_form = matches!(self.design.rest, RestBy::PoleStretch(_))
            .then(|| self.closed_form(&wanted))
            .flatten()
            .map(|contacts| wanted.distance(&contacts, &truth));
        MeasuredWall {
            case: self,
            closed_form,
            fidelities,
        }
    }

    fn solve(&self, kind: Kind, wanted: &Wanted) -> Evidence {
        let rest = Fingertip::of(kind, &self.design);
        let start = Instant::now();
        let contacts = rest.and_then(|mut fidelity| wanted.contacts(&mut fidelity));
        Evidence {
            contacts,
            seconds: start.elapsed().as_secs_f64() / PARTS.len() as f64,
            error: f64::INFINITY,
        }
    }

    fn closed_form(&self, wanted: &Wanted) -> Option<Vec<Contact>> {
        let membrane = Design {
            membrane: mid_surface(&self.design.membrane),
            ..self.design
        };
        let model = LightContact::new(&membrane).ok()?;
        PARTS
            .iter()
            .map(|part| model.at_indentation(part * wanted.deepest).ok())
            .collect()
    }
}

impl MeasuredWall {
    /// Whether the refined solid has every state.
    pub fn has_truth(&self) -> bool {
        self.fidelities[LADDER.len() - 1]
            .as_ref()
            .is_some_and(|evidence| evidence.contacts.is_ok())
    }

    /// What the rule takes for an accuracy.
    pub fn take(&self, error: f64) -> Taken {
        let wanted = self.case.wanted(error);
        let mut below: Vec<(usize, &[Contact])> = Vec::new();
        let mut taken = LADDER.len() - 1;
        for (place, evidence) in self.fidelities.iter().enumerate() {
            let Some(Evidence {
                contacts: Ok(contacts),
                ..
            }) = evidence
            else {
                continue;
            };
            if LADDER[place].is_coarse() {
                continue;
            }
            below.push((place, contacts));
            let fidelities = below.iter().map(|&(_, contacts)| contacts);
            let own_error = wanted.own_error(LADDER[place], &self.case.design);
            let judged = wanted.judge(fidelities, contacts, own_error);
            if let Some(near) = judged {
                taken = below[near].0;
                break;
            }
        }
        Taken {
            fidelity: taken,
            error: self.fidelities[taken]
                .as_ref()
                .map_or(f64::INFINITY, |evidence| evidence.error),
        }
    }
}
