//! The haptic loop of a design with an actuator's disc: touch against feedback, and both ends pressed, to one scale.

use super::charts::{self, Labelled};
use super::labels::{KPA, MM, NEWTON};
use super::shapes;
use maud::{Markup, PreEscaped, html};
use model_tables::design::Design;
use model_tables::design_file::DesignFile;
use model_tables::model::Kind;
use model_tables::model::feedback::{Loop, LoopError, LoopState};
use model_tables::model::state::MeridianStation;
use model_tables::solid::disc::{DISC, Disc, FarSide};
use model_tables::solid::section::WallPoint;
use output::rows::significant;

/// States of the curves, and points of a meridian.
const STATES: usize = 12;
const POINTS: usize = 61;

/// A loop as it is pressed.
pub(super) struct Pressing {
    states: Vec<LoopState>,
    /// Why there is none deeper, where the loop ends short of the deepest press.
    ends: Option<String>,
    /// Fingertip and disc in the last state; wall, thickness and gap, metres.
    tip: Vec<MeridianStation>,
    disc: Vec<WallPoint>,
    lengths: [f64; 2],
    gap: Option<f64>,
    on_skin: bool,
}

/// The loop of a design; `None` without a disc, or why there is none.
pub(super) fn pressing(
    file: &DesignFile,
    kind: Kind,
    design: &Design,
    deepest: f64,
) -> Option<Result<Pressing, String>> {
    let disc = file.disc()?;
    let solve = || -> Result<Pressing, LoopError> {
        let actuator = Disc::new(&disc, DISC).map_err(LoopError::Actuator)?;
        let mut haptic = Loop::new(kind, design, actuator)?.with_gas(file.trapped_gas());
        let mut states = vec![haptic.at_indentation(0.0)?];
        let mut ends = None;
        for k in 1..=STATES {
            match haptic.at_indentation(deepest * k as f64 / STATES as f64) {
                Ok(state) => states.push(state),
                Err(error) => {
                    ends = Some(error.to_string());
                    break;
                }
            }
        }
        let last = states[states.len() - 1];
        let (gap, on_skin) = match disc.far_side {
            FarSide::Free => (None, false),
            FarSide::Plate { gap } => (Some(gap), false),
            FarSide::Foundation { gap, .. } => (Some(gap), true),
        };
        Ok(Pressing {
            tip: haptic
                .fingertip_of(&last)?
                .profile(last.touch.indentation, POINTS)?,
            disc: haptic
                .actuator_profile(&last, POINTS)
                .map_err(LoopError::Actuator)?,
            lengths: [design.membrane.thickness, disc.thickness],
            states,
            ends,
            gap,
            on_skin,
        })
    };
    Some(solve().map_err(|error| error.to_string()))
}

/// The section of the page.
pub(super) fn section(pressing: &Result<Pressing, String>) -> Markup {
    let pressing = match pressing {
        Ok(pressing) => pressing,
        Err(reason) => {
            return html! { section { h2 { "The haptic loop" } p { "There is none: " (reason) "." } } };
        }
    };
    let last = &pressing.states[pressing.states.len() - 1];
    let against = |label: &str, of: fn(&LoopState) -> f64| Labelled {
        label: label.to_owned(),
        points: pressing
            .states
            .iter()
            .map(|state| [state.touch.indentation, of(state)])
            .collect(),
    };
    let forces = [
        against("touch", |state| state.touch.force),
        against("feedback", |state| state.actuator.force),
    ];
    let transferred = Labelled {
        label: String::new(),
        points: pressing
            .states
            .iter()
            .map(|state| [state.touch.force, state.actuator.force])
            .collect(),
    };
    html! {
        section {
            h2 { "The haptic loop" }
            p {
                "Fingertip and feedback actuator share the fluid. Pressed by " (MM.say(last.touch.indentation)) " the touch has "
                (NEWTON.say(last.touch.force)) " and the feedback " (NEWTON.say(last.actuator.force))
                @if let Some(ratio) = last.transmission() { ", " (significant(ratio, 3)) " of it" }
                ", at a pressure rise of " (KPA.say(last.touch.pressure_rise)) "; " (significant(1e9 * last.volume_moved, 3))
                " mm\u{b3} of fluid have moved."
                @if let Some(ends) = &pressing.ends { " It goes no deeper: " (ends) "." }
            }
            div.figures {
                figure {
                    (PreEscaped(charts::labelled_forces("Touch and feedback against indentation", &forces)))
                    figcaption { "Force of the touch and of the feedback over the indentation." }
                }
                figure {
                    (PreEscaped(charts::feedback(transferred)))
                    figcaption { "What the wearer feels of a touch." }
                }
                figure {
                    (PreEscaped(picture(pressing)))
                    figcaption { "Both ends pressed, to one scale: fingertip above, actuator below." }
                }
            }
        }
    }
}

/// Both ends.
fn picture(pressing: &Pressing) -> String {
    let last = &pressing.states[pressing.states.len() - 1];
    let description = format!(
        "Pressed fingertip under its plate above, actuator disc below, to one scale; touch {}, feedback {}",
        NEWTON.text(last.touch.force),
        NEWTON.text(last.actuator.force)
    );
    let side = |point: &WallPoint, outside: f64| {
        let shift = outside * pressing.lengths[1] * point.thickness_stretch;
        [
            point.radius + shift * libm::sin(point.angle),
            point.height + shift * libm::cos(point.angle),
        ]
    };
    let disc = [-0.5, 0.5].map(|part| {
        pressing
            .disc
            .iter()
            .map(|point| side(point, part))
            .collect::<Vec<_>>()
    });
    shapes::both_ends(
        &description,
        (&pressing.tip[..], pressing.lengths[0]),
        &disc,
        pressing.gap.map(|gap| pressing.lengths[1] + gap),
        pressing.on_skin,
    )
}
