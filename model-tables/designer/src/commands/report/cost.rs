//! Speed against accuracy of the models of one design: what a state costs, and how far it is from the finest model's.

use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::design_file::DesignFile;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::{CURVE, FINER, FULL, Press, SWEEP};
use model_tables::model::ModelError;
use model_tables::model::choice::{LADDER, PARTS, REFINED, Wanted};
use model_tables::model::{Fingertip, Kind};
use std::time::Instant;

/// A model of the design, timed.
pub(super) struct Cost {
    pub(super) model: String,
    /// Of one state, warm-started from those before.
    pub(super) seconds: f64,
    /// Largest difference of force or pressure rise from the finest model, over the reading; `None` of the finest itself.
    pub(super) distance: Option<f64>,
    /// Whether the report's numbers are this model's.
    pub(super) used: bool,
}

/// States that were solved, and the seconds a state.
type Solved = (Vec<Contact>, f64);

/// The models of a design, cheapest first, the finest last; those that find no state are left out.
pub(super) fn costs(file: &DesignFile, used: Kind, design: &Design, deepest: f64) -> Vec<Cost> {
    let wanted = Wanted {
        deepest,
        ..Wanted::of(file)
    };
    let mut solved: Vec<(String, bool, Solved)> = Vec::new();
    let mut add = |model: String, is_used: bool, found: Result<Solved, ModelError>| {
        if let Ok(found) = found {
            solved.push((model, is_used, found));
        }
    };
    match used {
        Kind::Membrane => {
            add(
                "membrane, coarse".into(),
                false,
                membrane::<5>(design, SWEEP, deepest),
            );
            add(
                "membrane, for curves".into(),
                false,
                membrane::<6>(design, CURVE, deepest),
            );
            add("membrane".into(), true, membrane::<6>(design, FULL, deepest));
            add(
                "membrane, twice as fine".into(),
                false,
                membrane::<6>(design, FINER, deepest),
            );
        }
        Kind::Solid(elements) => {
            let own = (!LADDER.contains(&used)).then_some(used);
            for kind in LADDER.into_iter().filter(|kind| kind.applies(design)).chain(own) {
                let is_used = kind == Kind::Solid(elements);
                add(kind.to_string(), is_used, states(kind, design, deepest));
            }
            // The finest last.
            solved.sort_by_key(|(model, ..)| *model == Kind::Solid(REFINED).to_string());
        }
    }
    let Some((_, _, (truth, _))) = solved.last() else {
        return Vec::new();
    };
    let truth = truth.clone();
    let last = solved.len() - 1;
    solved
        .into_iter()
        .enumerate()
        .map(|(i, (model, used, (contacts, seconds)))| Cost {
            model,
            seconds,
            distance: (i < last).then(|| wanted.distance(&contacts, &truth)),
            used,
        })
        .collect()
}

fn membrane<const S: usize>(
    design: &Design,
    resolution: Resolution,
    deepest: f64,
) -> Result<Solved, ModelError> {
    let mut press: Press<Law, S> = Press::with_resolution(design, TensionField::Relaxed, resolution)?;
    Ok(timed(deepest, |indentation| press.contact_at(indentation))?)
}

fn states(kind: Kind, design: &Design, deepest: f64) -> Result<Solved, ModelError> {
    let mut tip = Fingertip::of(kind, design)?;
    timed(deepest, |indentation| tip.contact_at(indentation))
}

fn timed<E>(deepest: f64, mut contact_at: impl FnMut(f64) -> Result<Contact, E>) -> Result<Solved, E> {
    let start = Instant::now();
    let contacts = PARTS
        .iter()
        .map(|part| contact_at(part * deepest))
        .collect::<Result<Vec<_>, _>>()?;
    Ok((contacts, start.elapsed().as_secs_f64() / PARTS.len() as f64))
}
