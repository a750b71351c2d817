//! The page: Markdown around the numbers.
//!
//! Few digits of each number, so that the page says what a reader can use and is the same on every host.

use super::actuator::OfPaper;
use super::lifted;
use super::markdown::{number, published, ratio, table};
use super::paper::Paper;
use super::quoted;
use super::solid::{Beside, COMPLIANCE, SOLID, SOLID_COMPLIANT_FORCE, SOLID_CONTACT_RADIUS, Solid};
use core::f64::consts::PI;
use output::Refusal;
use output::rows::significant;

/// What writes the page.
pub(super) const COMMAND: &str = "cargo designer published --out model-tables/PUBLISHED.md";

/// The whole page.
pub(super) fn markdown(paper: &Paper, solid: &Solid, feedback: &OfPaper) -> Result<String, Refusal> {
    Ok(format!(
        "# Published numbers, and how far a membrane is from a real dome\n\
         \n\
         Written by `{COMMAND}`; a test fails when it is stale. Columns named *here* are computed by this crate when the \
         page is written; *published* and *solid* are quoted.\n\
         \n\
         {}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}",
        numbers(paper),
        forces(paper),
        readings(paper),
        misprints(),
        others(),
        feedback.markdown(paper),
        lifted::markdown()?,
        distance(solid),
        mistaken(solid),
        consequences(solid),
    ))
}

fn numbers(paper: &Paper) -> String {
    let rows = paper.rows.iter().map(|row| {
        vec![
            row.title.to_owned(),
            published(row.published),
            number(row.here),
            ratio(row.here / row.published),
            row.reason.clone(),
        ]
    });
    format!(
        "## The source paper\n\
         \n\
         G. Shi, A. Shariati, I. Eames, H. Wurdemann, *Modelling the compression of a soft ellipsoid fingertip*, Soft \
         Matter 18 (2022) 9076. Its stated inputs are `designs/paper-prestretched.toml`: semi-axes 4.5 mm (radial) and \
         2.7 mm (axial), wall 1 mm, Agilus30 (C1 = 160355 Pa, C2 = 46559 Pa), stretched to 2.3 at the pole. These inputs do \
         not give the paper's numbers, and nothing in this project is tuned to reach them.\n\
         \n\
         {}\n\
         The published end of the press is the inflated height less the undeformed one, {} mm with these inputs; here the \
         press ends at {} mm, where the bulge touches the base plane. The paper measured {} N of blocked force at 17.9 \
         kPa. Its own 1.98 N would need a contact {} mm wide, while its formula makes 9 mm into {} mm.\n",
        table(
            &["quantity", "published", "here", "here / published", "reason"],
            rows
        ),
        number(paper.height_difference * 1e3),
        number(paper.limit * 1e3),
        published(quoted::MEASURED_BLOCKED_FORCE),
        number(paper.blocked_diameter * 1e3),
        number(paper.contact_diameter * 1e3),
    )
}

fn forces(paper: &Paper) -> String {
    let forces = &paper.forces;
    let row = |title: &str, values: [f64; 3]| {
        let mut row = vec![title.to_owned()];
        for (value, published) in values.into_iter().zip(quoted::FORCES) {
            row.push(format!("{} ({})", number(value), ratio(value / published)));
        }
        row
    };
    let mut quoted = vec!["published model, Agilus30".to_owned()];
    quoted.extend(quoted::FORCES.map(published));
    let text = |cells: [&str; 4]| cells.map(str::to_owned).to_vec();
    format!(
        "### What \"pressure times contact area\" could mean\n\
         \n\
         Force in newtons, and in brackets its ratio to the published one.\n\
         \n\
         {}\n\
         The first line is the force: it alone is the derivative of the strain energy by the indentation. The third line \
         comes close at 1.5 mm and at no other indentation.\n",
        table(
            &["force, N, at", "0.5 mm", "1.5 mm", "2 mm"],
            [
                row("total pressure, deformed contact", forces.total),
                row("pressure rise, deformed contact", forces.of_rise),
                row("total pressure, undeformed contact", forces.on_undeformed),
                quoted,
                text(["published model, skin", "0.27", "-", "1.99"]),
                text(["published, finite elements", "0.36", "-", "2.09"]),
                text(["published, experiment", "0.32", "-", "1.94"]),
            ]
        )
    )
}

fn readings(paper: &Paper) -> String {
    let rows = paper.readings.iter().rev().map(|reading| {
        let mut row = vec![
            reading.title.clone(),
            number(reading.rest_pressure * 1e-3),
            number(reading.equator_radius * 1e3),
            number(reading.aspect),
            number(reading.volume * 1e9),
        ];
        row.extend(
            reading
                .forces
                .map(|force| force.map_or_else(|| "beyond the end".to_owned(), number)),
        );
        row
    });
    let mut quoted = vec!["published".to_owned(), published(quoted::REST_PRESSURE * 1e-3)];
    quoted.extend([quoted::EQUATOR_RADIUS * 1e3, quoted::ASPECT, quoted::VOLUME * 1e9].map(published));
    quoted.extend(quoted::FORCES.map(published));
    format!(
        "### Other readings of the inputs\n\
         \n\
         {}\n\
         The volume is that of the half body above the base; the whole one holds twice as much. None of these gives the \
         published line, in which radius and aspect agree with the outside of the printed part, 9 x 7 mm.\n",
        table(
            &[
                "reading",
                "rest pressure, kPa",
                "equator radius, mm",
                "aspect",
                "volume, mm^3",
                "F at 0.5 mm, N",
                "F at 1.5 mm, N",
                "F at 2 mm, N",
            ],
            rows.chain([quoted])
        )
    )
}

/// What was found by reading the paper; none of it is computed here.
fn misprints() -> String {
    "### The printed equations\n\
     \n\
     Found by reading, not computed by this page:\n\
     \n\
     - Equation 3 carries a square root that does not belong there.\n\
     - Equation 8 makes the meridional curvature of a dome negative, and equation 9 carries the minus that goes with \
     it.\n\
     \n\
     Taken literally they make the pole singular, and the rest pressure then depends on where the integration starts: \
     about 2.1 kPa when it starts at 1e-16. That is a plausible origin of the published 2.1 kPa, and not a \
     reproduction of it. This crate solves the equations without the misprints. They are checked against closed forms, \
     independent solutions and the work of the plate (`tests/`).\n"
        .to_owned()
}

/// Where numbers of others were looked for; none of it is computed here.
fn others() -> String {
    "### Presses that others published\n\
     \n\
     This list is quoted from publications, not computed by this page. No published press of a fluid-filled dome with a held \
     rim was found that gives numbers of force or pressure over the travel of the plate. Similar published problems do not \
     correspond to this one:\n\
     \n\
     - A spherical membrane between two plates (W. W. Feng, W. H. Yang, J. Appl. Mech. 40 (1973) 209; T. J. \
     Lardner, P. Pujara, Mechanics Today 5 (1980) 161): its equator widens as it is pressed, while the rim of a \
     fingertip is held.\n\
     - A flat circular membrane, clamped and inflated against a plate (R. Long, K. R. Shull, C.-Y. Hui, J. Mech. \
     Phys. Solids 58 (2010) 1225): the pressure is given and the plate stands still, while a fingertip keeps its \
     volume and the plate moves; and it is flat where nothing stretches it.\n\
     - Elastic spherical shells between rigid plates (D. P. Updike, A. Kalnins, J. Appl. Mech. 39 (1972) 172): \
     small strains of a thin shell, without a fluid.\n"
        .to_owned()
}

fn distance(solid: &Solid) -> String {
    let side = |beside: &Beside, i: usize| {
        let (pressure, force) = beside.states[i];
        [
            number(pressure * 1e-3),
            ratio(pressure / SOLID[i].pressure),
            number(force),
            ratio(force / SOLID[i].force),
        ]
    };
    let rows = SOLID.iter().enumerate().map(|(i, pressed)| {
        let mut row = vec![
            published(pressed.indentation * 1e3),
            published(pressed.pressure * 1e-3),
            published(pressed.force),
        ];
        row.extend(side(&solid.unstretched, i));
        row.extend(side(&solid.stretched, i));
        row
    });
    format!(
        "## How far a membrane is from a real dome of 1 mm\n\
         \n\
         A printed wall also bends. *Solid* are axisymmetric solid finite elements (quadratic displacement, \
         discontinuous linear pressure, 80 x 4 elements; mesh and penalty error about 0.1 %) of the printed part: 9 x 7 \
         mm outside, wall 1 mm, Agilus30, not stretched at rest, clamped at the equator, rigid fluid, plate without \
         friction. *Membrane* is its mid-surface, 8.5 x 6.5 mm, with compression relaxed into wrinkles: once all but \
         unstretched (pole stretch {}, rest pressure {} kPa), once with the stretch that stands in best for bending (pole \
         stretch {}, rest pressure {} kPa, which its pressures include). Ratios are membrane over solid.\n\
         \n\
         {}",
        published(solid.unstretched.pole_stretch),
        number(solid.unstretched.rest_pressure * 1e-3),
        published(solid.stretched.pole_stretch),
        number(solid.stretched.rest_pressure * 1e-3),
        table(
            &[
                "H, mm",
                "solid P, kPa",
                "solid F, N",
                "unstretched P",
                "ratio",
                "unstretched F",
                "ratio",
                "stretched P",
                "ratio",
                "stretched F",
                "ratio",
            ],
            rows
        )
    )
}

fn mistaken(solid: &Solid) -> String {
    let rows = SOLID.iter().zip(&solid.readings).map(|(pressed, readings)| {
        let mut row = vec![
            published(pressed.pressure * 1e-3),
            published(pressed.indentation * 1e3),
            published(pressed.force),
        ];
        for reading in readings {
            row.extend(match reading {
                Some(contact) => [
                    number(contact.indentation * 1e3),
                    ratio(contact.indentation / pressed.indentation),
                    number(contact.force),
                    ratio(contact.force / pressed.force),
                ],
                None => ["saturated", "-", "saturated", "-"].map(str::to_owned),
            });
        }
        row
    });
    format!(
        "### What the firmware would read off the solid's pressure\n\
         \n\
         It knows only the pressure rise. *Membrane* would be tables of the stretched membrane above, *shipped* are those of \
         `designs/index-fingertip-elastic.toml`, whose model is this crate's own solid (both end at {} mm):\n\
         \n\
         {}",
        published(solid.deepest * 1e3),
        table(
            &[
                "rise, kPa",
                "H, mm",
                "F, N",
                "membrane H, mm",
                "ratio",
                "membrane F, N",
                "ratio",
                "shipped H, mm",
                "ratio",
                "shipped F, N",
                "ratio",
            ],
            rows
        )
    )
}

fn consequences(solid: &Solid) -> String {
    let touch = SOLID[1];
    let effective = libm::sqrt(touch.force / (PI * touch.pressure));
    let (deep, stretched) = (SOLID[7], &solid.stretched);
    format!(
        "### So\n\
         \n\
         - A light touch is carried by bending. At {} mm the solid's force over its pressure means a contact radius of {} \
         mm; its real contact has {} mm. There the force is not the pressure times the contact area. The stretched membrane \
         reads such touches nearly right only because of the choice of its stretch, not because of its physics.\n\
         - A small stretch at rest can replace bending at one depth, but it is no model of bending. Its rest pressure is real \
         only if the fingertip is really filled to that stretch.\n\
         - Compliance of tubing and bubbles matters as much: {} mm^3/kPa turn the solid's {} N at 2 mm into {} N, and the \
         stretched membrane's {} N into {} N.\n\
         - An unstretched printed dome is therefore solved as a solid (`model.kind`), and a part still needs a calibration on \
         the bench. Where the wall is thin or well stretched the membrane is right: `designer ladder` maps where.\n",
        published(touch.indentation * 1e3),
        significant(effective * 1e3, 3),
        published(SOLID_CONTACT_RADIUS * 1e3),
        published(COMPLIANCE * 1e12),
        published(deep.force),
        published(SOLID_COMPLIANT_FORCE),
        number(stretched.states[7].1),
        number(stretched.compliant_force),
    )
}
