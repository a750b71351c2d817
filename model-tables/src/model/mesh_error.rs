//! The discretisation error of a solid: its states compared with those of finer meshes.
//!
//! A mesh is refined through the wall and along the meridian, each alone, and the differences are added. A mesh refined both
//! ways at once can agree by chance: near the end of the press of a shallow dome an element more through the wall lowers the
//! pressure where more elements along it raise it.

use super::choice::FINE;
use super::{Kind, ModelError};
use crate::curve::Contact;
use crate::design::Design;
use crate::solid::mesh::Elements;
use crate::solid::press::Press;
use std::fmt;

/// Part of the largest reading below which a difference counts as one of that.
const FROM: f64 = 0.01;

/// Largest estimate that is one, relative: where the next meshes differ by that much, ever finer ones may differ by more. Of 2000 random solids
/// (`cargo campaign solids`) eight are off by more than their estimate, which is 0.68 to 1.5 there.
const KNOWN: f64 = 0.5;

/// Differences of force and pressure rise of given states from those of finer meshes at the same indentations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshError {
    /// The mesh.
    pub elements: Elements,
    /// Its refinements: through the wall, and along the meridian.
    pub finer: [Elements; 2],
    /// Sum of the differences from both refinements, largest of force and pressure rise and of all states, relative, >= 0.
    pub difference: f64,
    /// Estimate of the same from ever finer meshes, relative, >= 0; see [`MeshError::is_known`].
    pub bound: f64,
}

/// An element more through the wall; and 8 for 5 along it, no fewer than [`FINE`] has.
pub fn finer(elements: Elements) -> [Elements; 2] {
    [
        Elements {
            through: elements.through + 1,
            ..elements
        },
        Elements {
            along: (8 * elements.along).div_ceil(5).max(FINE.along),
            ..elements
        },
    ]
}

impl MeshError {
    /// Whether the estimate can be relied upon: it is at most half of the reading.
    pub fn is_known(&self) -> bool {
        self.bound <= KNOWN
    }

    /// Of states of a design's solid; force and pressure rise at equal indentation.
    ///
    /// # Errors
    /// [`ModelError`] where a finer mesh does not have every state.
    pub fn of(design: &Design, elements: Elements, found: &[Contact]) -> Result<Self, ModelError> {
        let finer = finer(elements);
        let mut truths = Vec::with_capacity(finer.len());
        for elements in finer {
            let mut press = Press::new(design, elements)?;
            let contacts: Result<Vec<Contact>, ModelError> = found
                .iter()
                .map(|contact| Ok(press.contact_at(contact.indentation)?))
                .collect();
            truths.push(contacts?);
        }
        Ok(Self::between(elements, finer, found, [&truths[0], &truths[1]]))
    }

    fn between(elements: Elements, finer: [Elements; 2], found: &[Contact], truths: [&[Contact]; 2]) -> Self {
        // Of first order: through the wall for the singular corner of the rim, along it for the contact's edge, which lies between
        // nodes. `n` elements are then `m / (m - n)` times as far from ever finer meshes as from `m`.
        let times = |coarse: usize, fine: usize| fine as f64 / (fine - coarse) as f64;
        let times = [
            times(elements.through, finer[0].through),
            times(elements.along, finer[1].along),
        ];
        let (mut difference, mut bound) = (0.0_f64, 0.0_f64);
        let quantities: [fn(&Contact) -> f64; 2] = [|contact| contact.force, |contact| contact.pressure_rise];
        for quantity in quantities {
            let full = found.iter().map(quantity).fold(0.0, |a: f64, b| a.max(b.abs()));
            for (state, contact) in found.iter().enumerate() {
                // Nothing touches: a force or a pressure of zero has no error.
                let scale = quantity(contact).abs().max(FROM * full);
                if scale > 0.0 {
                    let shares =
                        truths.map(|truth| (quantity(contact) - quantity(&truth[state])).abs() / scale);
                    difference = difference.max(shares[0] + shares[1]);
                    bound = bound.max(times[0] * shares[0] + times[1] * shares[1]);
                }
            }
        }
        Self {
            elements,
            finer,
            difference,
            bound,
        }
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [through, along] = self.finer.map(Kind::Solid);
        write!(
            f,
            "error of the mesh: force and pressure rise differ from those of the {through} and of the {along} by at most {:.2} % together \
             (of the reading, or of {:.0} % of the largest one asked for), ",
            100.0 * self.difference,
            100.0 * FROM
        )?;
        if self.is_known() {
            write!(
                f,
                "and from those of ever finer meshes by up to about {:.2} %",
                100.0 * self.bound
            )
        } else {
            f.write_str(
                "too much to say how far they are from those of ever finer meshes: give more elements with model.along",
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Membrane, RestBy};
    use crate::material::Law;
    use crate::object::Object;

    const COARSE: Elements = Elements {
        through: 2,
        along: 24,
    };

    #[test]
    fn each_direction_is_refined_alone() {
        for ([through, along], expected) in [
            ([1, 4], [[2, 4], [1, 60]]),
            ([2, 24], [[3, 24], [2, 60]]),
            ([2, 60], [[3, 60], [2, 96]]),
        ] {
            let found = finer(Elements { through, along });
            assert_eq!(found.map(|finer| [finer.through, finer.along]), expected);
        }
    }

    fn contact(force: f64, pressure_rise: f64) -> Contact {
        Contact {
            indentation: 1e-3,
            pressure_rise,
            force,
        }
    }

    /// 1 % down by one refinement and 1 % up by the other are 2 %, which refined both ways at once would be nothing; a
    /// pressure that is next to nothing counts by the largest.
    #[test]
    fn differences_of_opposite_sign_add_up() {
        let found = [contact(1.0, 1e-9), contact(2.0, 100.0)];
        let through = [contact(1.0, 0.005), contact(1.98, 100.0)];
        let along = [contact(1.0, -0.005), contact(2.02, 100.0)];
        let error = MeshError::between(COARSE, finer(COARSE), &found, [&through, &along]);
        assert!((error.difference - 0.02).abs() < 1e-12, "{error:?}");
        // First order: 1 / 2 against 1 / 3, and 1 / 24 against 1 / 60.
        assert!(
            (error.bound - (3.0 + 60.0 / 36.0) * 0.01).abs() < 1e-12,
            "{error:?}"
        );
    }

    /// Meshes that differ by a third of the reading bound nothing.
    #[test]
    fn an_error_of_more_than_half_of_the_reading_is_not_known() {
        let found = [contact(1.0, 100.0)];
        let text = |force: f64| {
            let truth = [contact(force, 100.0)];
            let error = MeshError::between(COARSE, finer(COARSE), &found, [&truth, &found]);
            (error.is_known(), error.to_string())
        };
        let (known, shown) = text(0.9);
        assert!(known && shown.contains("up to about 30.00 %"), "{shown}");
        let (known, shown) = text(0.67);
        assert!(
            !known && shown.contains("33.00 % together") && shown.contains(", too much to say"),
            "{shown}"
        );
    }

    /// A shallow dome pressed to the end, where 2 x 24 elements agree with 3 x 60 within 0.2 % and are 0.5 to 1.1 % from 4 x 128
    /// and 3 x 96.
    #[test]
    fn near_the_end_of_a_press_the_error_is_stated_though_two_meshes_agree() {
        let design = Design {
            membrane: Membrane {
                radial_semi_axis: 12.920_79e-3,
                axial_semi_axis: 4.549_974e-3,
                thickness: 1.106_133e-3,
            },
            law: Law::NeoHookean { c1: 32_415.09 },
            rest: RestBy::Unstretched,
            compliance: 0.0,
            object: Object::PLATE,
        };
        let depth = 1.5925e-3;
        let at = |elements: Elements| {
            let mut press = Press::new(&design, elements).expect("a rest state");
            press.contact_at(depth).expect("a state")
        };
        let found = at(COARSE);
        let away = |through, along| {
            let finer = at(Elements { through, along });
            (found.pressure_rise / finer.pressure_rise - 1.0).abs()
        };
        assert!(away(3, 60) < 2e-3);
        let error = MeshError::of(&design, COARSE, &[found]).expect("finer states");
        let largest = away(3, 96).max(away(4, 128));
        assert!(largest > 6e-3 && error.bound > largest, "{largest} {error:?}");
        assert!(error.bound < 10.0 * largest, "{largest} {error:?}");
    }
}
