//! The page's part that repeats what the design states.

use super::findings::Findings;
use super::labels::{KPA, MM, MM3, NEWTON, PA, STRETCH, Unit, count};
use maud::{Markup, html};
use model_tables::constants::Quantity;
use model_tables::design_file::{Axes, Calibration, RestSection, TransducerKindSection};
use model_tables::limit::EndsBy;
use model_tables::material::Law;
use model_tables::material::preset::Preset;
use output::rows::plain;

const VOLUME_PER_PRESSURE: Unit = Unit {
    per_si: 1.0,
    name: "mm\u{b3}/kPa",
};

/// A row of a table: what, and the number with its unit.
pub(super) type Row = (&'static str, Markup);

pub(super) fn rows(caption: &str, rows: &[Row]) -> Markup {
    html! {
        table {
            caption { (caption) }
            tbody {
                @for (what, number) in rows {
                    tr { th scope="row" { (what) } td.value { (number) } }
                }
            }
        }
    }
}

pub(super) fn inputs(found: &Findings) -> Markup {
    let (rest, limit) = (&found.rest, &found.limit);
    let calibration = &found.file.calibration;
    let ends = match limit.ends_by {
        EndsBy::BulgeTouchesBase => "the bulge touches the base",
        EndsBy::FluidDrained => "the fluid is drained",
        EndsBy::WallTouchesBase => "the wall touches the base",
        EndsBy::MaterialSoftens => "the material softens",
        EndsBy::WallFolds => "the wall folds onto itself",
        EndsBy::NoFurtherState => "no state follows from there",
    };
    let state = [
        (
            "rest pressure, gauge",
            KPA.say(calibration.pressure_read(rest.pressure)),
        ),
        ("stretch of the pole", STRETCH.say(rest.pole_stretch)),
        ("radius of the equator", MM.say(rest.edge_radius)),
        ("height over the base", MM.say(rest.height)),
        ("volume of the fluid", MM3.say(rest.volume)),
        ("limit of the press", MM.say(limit.indentation)),
        ("force at the limit", NEWTON.say(limit.force)),
        (
            "pressure at the limit, gauge",
            KPA.say(calibration.pressure_read(limit.pressure)),
        ),
    ];
    html! {
        section {
            h2 { "Inputs, rest state and limit" }
            div.tables {
                div {
                    (rows("Stated", &stated(found)))
                    @if *calibration != Calibration::default() { (rows("Calibration", &calibrated(calibration))) }
                }
                div {
                    (rows("Solved", &state))
                    p.soft { "The press ends where " (ends) "." }
                    @if found.has_actuator {
                        p.soft {
                            "Fingertip and actuator share the fluid in every state of this page. The limit is that of a fingertip whose \
                             fluid is as compliant as in the deepest state."
                        }
                    }
                }
            }
        }
    }
}

fn stated(found: &Findings) -> Vec<Row> {
    let file = &found.file;
    let membrane = &file.membrane;
    let given = |unit: Unit, number: f64| unit.given(&plain(number, 6));
    let surface = match file.axes {
        Axes::Mid => "of the middle of the wall",
        Axes::Outer => "of the outer surface",
    };
    let mut all: Vec<Row> = vec![
        (
            "radial semi-axis, undeformed",
            given(MM, membrane.radial_semi_axis_mm),
        ),
        (
            "axial semi-axis, undeformed",
            given(MM, membrane.axial_semi_axis_mm),
        ),
        ("semi-axes are", html! { (surface) }),
        ("thickness of the wall", given(MM, membrane.thickness_mm)),
    ];
    let law = match file.material {
        Law::NeoHookean { .. } => "neo-Hookean",
        Law::MooneyRivlin { .. } => "Mooney-Rivlin",
        Law::Yeoh { .. } => "Yeoh",
    };
    let title = Preset::of(&file.material).map_or_else(String::new, |preset| format!(" ({})", preset.title));
    all.push(("material law", html! { (law) (title) }));
    match file.material {
        Law::NeoHookean { c1 } => all.push(("C1", given(PA, c1))),
        Law::MooneyRivlin { c1, c2 } => all.extend([("C1", given(PA, c1)), ("C2", given(PA, c2))]),
        Law::Yeoh { c1, c2, c3 } => {
            all.extend([
                ("C1", given(PA, c1)),
                ("C2", given(PA, c2)),
                ("C3", given(PA, c3)),
            ]);
        }
    }
    all.push(match file.rest {
        RestSection::Unstretched => ("rest", html! { "as it was made" }),
        RestSection::PoleStretch(stretch) => ("rest, stretch of the pole", given(STRETCH, stretch)),
        RestSection::PressureKpa(pressure) => ("rest, pressure", given(KPA, pressure)),
        RestSection::EquatorRadiusMm(radius) => ("rest, radius of the equator", given(MM, radius)),
        RestSection::HeightMm(height) => ("rest, height", given(MM, height)),
    });
    all.push((
        "compliance of the fluid path",
        given(VOLUME_PER_PRESSURE, file.compliance_mm3_per_kpa),
    ));
    if let Some(transducer) = &file.transducer {
        let kind = match transducer.kind {
            TransducerKindSection::Ratiometric { .. } => "ratiometric",
            TransducerKindSection::Abp2 { .. } => "abp2",
            TransducerKindSection::Ms5837 => "ms5837-02ba",
            TransducerKindSection::Dps310 { .. } => "dps310",
        };
        let [low, high] = transducer.range_kpa;
        all.extend([
            (
                "transducer",
                html! { (kind) @if transducer.quantity == Quantity::Absolute { ", absolute" } },
            ),
            ("its range, from", given(KPA, low)),
            ("its range, to", given(KPA, high)),
            ("its resolution", given(PA, transducer.resolution_pa)),
            (
                "its noise, one standard deviation",
                given(PA, transducer.noise_pa),
            ),
        ]);
    }
    all
}

fn calibrated(calibration: &Calibration) -> Vec<Row> {
    let mut all = vec![
        (
            "constants of the material, times",
            count(plain(calibration.material_factor, 5), "Pa/Pa"),
        ),
        (
            "thickness, times",
            count(plain(calibration.thickness_factor, 5), "mm/mm"),
        ),
        (
            "the transducer reads of a pressure",
            count(plain(calibration.pressure_gain, 5), "Pa/Pa"),
        ),
        (
            "the transducer reads at none",
            KPA.given(&plain(calibration.pressure_offset_kpa, 5)),
        ),
        (
            "the stage reads at first touch",
            MM.given(&plain(calibration.indentation_offset_mm, 5)),
        ),
    ];
    if let Some(stretch) = calibration.pole_stretch {
        all.push(("stretch of the pole at rest", STRETCH.given(&plain(stretch, 5))));
    }
    if let Some(compliance) = calibration.compliance_mm3_per_kpa {
        all.push((
            "compliance of the fluid path",
            VOLUME_PER_PRESSURE.given(&plain(compliance, 5)),
        ));
    }
    if let Some(curve) = &calibration.curve {
        all.push(("tables come from data", count(curve.force_n.len(), "knots")));
    }
    all
}
