//! What the mesh of a solid costs in accuracy: its states against those of a finer mesh.

use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::model::choice::FINE;
use model_tables::model::{Kind, ModelError};
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::Press;

/// Part of the largest reading below which a difference counts as one of that.
const FROM: f64 = 0.01;

/// The mesh that another one is held to: an element more through the wall and 8 for 5 along it, and no coarser than [`FINE`].
fn finer(elements: Elements) -> Elements {
    Elements {
        through: (elements.through + 1).max(FINE.through),
        along: (8 * elements.along).div_ceil(5).max(FINE.along),
    }
}

/// The largest relative difference of force or pressure rise.
fn difference(found: &[Contact], truth: &[Contact]) -> f64 {
    let of = |quantity: fn(&Contact) -> f64| {
        let full = truth
            .iter()
            .map(|contact| quantity(contact).abs())
            .fold(0.0, f64::max);
        let pairs = found
            .iter()
            .zip(truth)
            .filter(|(_, truth)| quantity(truth).abs() > 0.0);
        pairs
            .map(|(found, truth)| {
                (quantity(found) - quantity(truth)).abs() / quantity(truth).abs().max(FROM * full)
            })
            .fold(0.0, f64::max)
    };
    of(|contact| contact.force).max(of(|contact| contact.pressure_rise))
}

/// How far states of a solid are from those of a finer mesh, in words.
pub(super) fn note(design: &Design, elements: Elements, found: &[Contact]) -> String {
    let finer = finer(elements);
    let kind = Kind::Solid(finer);
    // Of first order through the wall, as at the singular corner of the rim: `n` elements are `n + 1` times as far off as from `n + 1`.
    let times = finer.through / (finer.through - elements.through);
    let truth: Result<Vec<Contact>, ModelError> = Press::new(design, finer).and_then(|mut press| {
        let depths = found.iter().map(|contact| contact.indentation);
        depths.map(|depth| Ok(press.contact_at(depth)?)).collect()
    });
    match truth {
        Ok(truth) => format!(
            "error of the mesh: force and pressure rise differ from those of the {kind} by at most {:.2} %, and by up to {times} \
             times that from those of ever finer meshes",
            100.0 * difference(found, &truth)
        ),
        Err(error) => {
            format!("error of the mesh: not known, as the {kind} does not have every state ({error})")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_held_to_finer_ones() {
        for ([through, along], expected) in [
            ([1, 4], [2, 60]),
            ([1, 24], [2, 60]),
            ([2, 24], [3, 60]),
            ([2, 60], [3, 96]),
        ] {
            let Elements { through, along } = finer(Elements { through, along });
            assert_eq!([through, along], expected);
        }
    }

    /// 10 % of the force; a pressure that is next to nothing counts by the largest.
    #[test]
    fn the_difference_is_the_largest() {
        let contact = |force, pressure_rise| Contact {
            indentation: 1e-3,
            pressure_rise,
            force,
        };
        let truth = [contact(1.0, 1e-9), contact(2.0, 100.0)];
        let found = [contact(1.1, 0.05), contact(2.0, 101.0)];
        assert!((difference(&found, &truth) - 0.1).abs() < 1e-12);
    }
}
