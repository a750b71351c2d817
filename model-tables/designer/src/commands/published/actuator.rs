//! The paper's feedback actuator: its formula, the disc as a solid, and the loop with the printed fingertip.

use super::markdown::{number, published, ratio, table};
use super::paper::Paper;
use super::quoted::{
    BLOCKED_FORCE, BLOCKED_PRESSURE, MEASURED_BLOCKED_FORCE, VOLUME, VOLUME_CHANGE, VOLUME_CHANGE_PRESSURE,
};
use model_tables::design_file::DesignFile;
use model_tables::material::preset::AGILUS30;
use model_tables::model::feedback::Loop;
use model_tables::model::{Fingertip, Kind};
use model_tables::object::Friction;
use model_tables::solid::disc::{DISC, Disc, DiscDesign, DiscState, FarSide};
use model_tables::solid::press::FULL;
use output::Refusal;

/// Diameter and thickness of the paper's actuator, metres; the thickness is that of its printed walls.
const DIAMETER: f64 = 9e-3;
const THICKNESS: f64 = 1e-3;
/// The indentation of the loop, metres: that of the paper's last force.
pub(super) const INDENTATION: f64 = 2e-3;
/// Skin over the actuator: kilopascals a millimetre in the middle of what fingertips have.
const SKIN: f64 = 20.0;

/// The disc with something over it.
pub(super) struct Held {
    /// In words.
    pub(super) title: String,
    /// At the pressures of the published force and of the published volume.
    pub(super) states: [DiscState; 2],
    /// In the loop: pressure rise, touch force, feedback force, volume moved, over those of the fingertip alone and its volume.
    pub(super) haptic: [f64; 6],
}

/// The published actuator.
pub(super) struct OfPaper {
    pub(super) held: Vec<Held>,
}

impl OfPaper {
    pub(super) fn solve(printed: &DesignFile) -> Result<Self, Refusal> {
        let design = printed.design();
        let kind = Kind::Solid(FULL);
        let mut alone = Fingertip::of(kind, &design).map_err(Refusal::of)?;
        let volume = alone.rest().volume;
        let alone = alone.contact_at(INDENTATION).map_err(Refusal::of)?;
        let over = [
            (
                "a rigid plate that touches it".to_owned(),
                FarSide::Plate { gap: 0.0 },
            ),
            (
                format!("skin of {SKIN} kPa/mm"),
                FarSide::Foundation {
                    gap: 0.0,
                    stiffness: 1e6 * SKIN,
                },
            ),
            ("nothing".to_owned(), FarSide::Free),
        ];
        let held = over.into_iter().map(|(title, far_side)| {
            let design_of_disc = DiscDesign {
                diameter: DIAMETER,
                thickness: THICKNESS,
                law: AGILUS30,
                far_side,
                friction: Friction::NONE,
            };
            let mut disc = Disc::new(&design_of_disc, DISC).map_err(Refusal::of)?;
            let mut at = |pressure| disc.at_pressure(pressure).map_err(Refusal::of);
            let states = [at(BLOCKED_PRESSURE)?, at(VOLUME_CHANGE_PRESSURE)?];
            let mut haptic = Loop::new(kind, &design, disc).map_err(Refusal::of)?;
            let state = haptic.at_indentation(INDENTATION).map_err(Refusal::of)?;
            Ok(Held {
                title,
                states,
                haptic: [
                    state.touch.pressure_rise,
                    state.touch.force,
                    state.actuator.force,
                    state.volume_moved,
                    state.touch.force / alone.force,
                    state.volume_moved / volume,
                ],
            })
        });
        Ok(Self {
            held: held.collect::<Result<_, Refusal>>()?,
        })
    }
}

impl OfPaper {
    /// The section of the page.
    pub(super) fn markdown(&self, paper: &Paper) -> String {
        let [blocked, touched, free] = [0, 1, 2].map(|i: usize| &self.held[i]);
        let rows = self.forces(paper);
        let haptic = self.held.iter().map(|held| {
            let [rise, touch, feedback, moved, of_force, of_volume] = held.haptic;
            vec![
                held.title.clone(),
                number(rise * 1e-3),
                number(touch),
                number(feedback),
                ratio(feedback / touch),
                number(moved * 1e9),
                ratio(100.0 * of_volume),
                ratio(of_force),
            ]
        });
        format!(
            "## The feedback actuator: formula, solid and loop\n\
             \n\
             The paper's figure 8 gives the blocked force over the pressure; quoted here are its numbers at {} kPa, and the volume at {} kPa. *Solid* is a disc of 9 x 1 mm, Agilus30, clamped at its rim (`[actuator] thickness_mm`, 2 x 32 elements).\n\
             \n\
             {}\n\
             A disc between the fluid and a plate, clamped at its rim, passes on at most the pressure times its free area: {} N at {} kPa. Neither the \
             published formula nor the measurement is reproduced: both are more than that, and need an area of {} and {} mm^2 where the disc has {}. \
             The paper does not state what increases the measured force (a wider chamber, a bulge over the frame, or a zero of \
             the force).\n\
             \n\
             ### Is the exchange of fluid negligible?\n\
             \n\
             The paper argues so from the volume: {} of {} mm^3, 0.432 %. What counts is how the pressure falls when that volume leaves. The loop of \
             the printed fingertip (`designs/index-fingertip-elastic.toml`, 2 x 24 elements) with the disc, at {} mm (`designer loop`):\n\
             \n\
             {}\n\
             Against a plate that touches it the disc takes {} % of the fluid, and the touch has {} of the force of a closed fingertip: the conclusion \
             holds there. With {} it takes {} % of the volume, and the touch has {} of its force; with nothing over it {} %, and \
             {}: one percent of the volume changes the force by much more than one percent, because a closed fingertip is \
             stiff.\n",
            published(BLOCKED_PRESSURE * 1e-3),
            published(VOLUME_CHANGE_PRESSURE * 1e-3),
            table(
                &[
                    "actuator",
                    "blocked force at 17.9 kPa, N",
                    "volume at 17.935 kPa, mm^3",
                    "travel there, mm"
                ],
                rows
            ),
            number(BLOCKED_PRESSURE * core::f64::consts::FRAC_PI_4 * DIAMETER * DIAMETER),
            published(BLOCKED_PRESSURE * 1e-3),
            number(BLOCKED_FORCE / BLOCKED_PRESSURE * 1e6),
            number(MEASURED_BLOCKED_FORCE / BLOCKED_PRESSURE * 1e6),
            number(core::f64::consts::FRAC_PI_4 * DIAMETER * DIAMETER * 1e6),
            published(VOLUME_CHANGE * 1e9),
            number(VOLUME * 1e9),
            published(INDENTATION * 1e3),
            table(
                &[
                    "over the disc",
                    "pressure rise, kPa",
                    "touch force, N",
                    "feedback force, N",
                    "transmission",
                    "volume moved, mm^3",
                    "% of the fluid",
                    "touch force over that of a closed fingertip",
                ],
                haptic
            ),
            ratio(100.0 * blocked.haptic[5]),
            ratio(blocked.haptic[4]),
            touched.title,
            ratio(100.0 * touched.haptic[5]),
            ratio(touched.haptic[4]),
            ratio(100.0 * free.haptic[5]),
            ratio(free.haptic[4]),
        )
    }

    /// Rows of the actuator alone: published, by the formula, as a solid.
    fn forces(&self, paper: &Paper) -> Vec<Vec<String>> {
        let text = |cells: [String; 4]| cells.to_vec();
        let mut rows = vec![
            text([
                "published formula".to_owned(),
                published(BLOCKED_FORCE),
                published(VOLUME_CHANGE * 1e9),
                "-".to_owned(),
            ]),
            text([
                "published measurement".to_owned(),
                published(MEASURED_BLOCKED_FORCE),
                "-".to_owned(),
                "-".to_owned(),
            ]),
            text([
                "the published formula with its stated inputs".to_owned(),
                number(paper.blocked_force),
                number(paper.volume_change * 1e9),
                "-".to_owned(),
            ]),
        ];
        rows.extend(self.held.iter().map(|held| {
            let [force, volume] = held.states;
            text([
                format!("solid disc under {}", held.title),
                number(force.force),
                number(volume.volume * 1e9),
                number(volume.travel * 1e3),
            ])
        }));
        rows
    }
}
