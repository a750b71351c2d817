//! What everything adds to a reading of 0.2, 1 and 5 N: the [budget](crate::budget) of a design, with what the world adds. The page
//! `model-tables/ERROR_BUDGET.md`.

use crate::budget::{Budget, rise_where};
use fingertip::signal::zero::limits::Limits;
use model_tables::generate::Generated;
use model_tables::generate::object::quoted;
use model_tables::model::own_error::OwnError;
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use std::fmt::Write as _;

/// Readings at which the errors are stated, newtons.
pub const FORCES: [f64; 3] = [0.2, 1.0, 5.0];
/// How far the wall of an elastic design is from the temperature of its constants, kelvins, and that temperature.
const KELVINS: f64 = 10.0;
const ROOM: f64 = 293.15;
/// Of a relaxing wall at its own temperature, percent of force and indentation over the largest pressed: as tested.
const RELAXING: [f64; 2] = [3.0, 1.0];
/// Of a relaxing wall a kelvin warmer or colder than the series, which nobody measures: percent of the force, and millimetres of
/// indentation at 0.5, 1 and 2 mm.
const KELVIN_FORCE: f64 = 5.0;
const KELVIN_DEPTH: [(f64, f64); 3] = [(0.5, 0.05), (1.0, 0.08), (2.0, 0.11)];

/// The sources that are of what is touched.
const OBJECT: &str = "object not told: balls from 5 mm, tilts to 20 degrees";
const FRICTION: &str = "friction of a plate, coefficient 0.3";

/// What one source adds at each of the [`FORCES`]: percent of reading, least and most, of force and of indentation.
struct Share {
    name: String,
    source: &'static str,
    percent: [[[f64; 2]; 2]; FORCES.len()],
}

/// Everything of one design.
pub struct RealUse {
    name: String,
    /// Whether the tables reach the force.
    reached: [bool; FORCES.len()],
    /// Largest errors, or a standard deviation: of the reading.
    budget: Budget,
    shares: Vec<Share>,
}

impl RealUse {
    /// Of a design.
    pub fn of(generated: &Generated) -> Self {
        let tables = &generated.certified.tables;
        let bits = tables.layout.fraction_bits;
        let last = tables.contact_at(PressureRise(tables.layout.maximum));
        let rises = FORCES.map(|force| {
            rise_where(generated, |reading| {
                f64::from(reading.force.0) >= 1e6 * force.min(last.force.newtons())
            })
        });
        let budget = Budget::at(generated, rises);
        let read = |pascals: f64| {
            let reading = tables.contact_at(PressureRise::from_pascals(pascals, bits));
            [reading.force.newtons(), reading.indentation.metres()]
        };
        let pascals = rises.map(|rise| PressureRise(rise).pascals(bits));
        let height = 1e-3 * generated.design.membrane.axial_semi_axis_mm;
        let mut shares = Vec::new();
        let mut add = |name: &str, source: &'static str, percent: &dyn Fn(f64) -> [[f64; 2]; 2]| {
            shares.push(Share {
                name: name.to_owned(),
                source,
                percent: pascals.map(percent),
            });
        };
        let constants = generated.constants();
        let bound = f64::from(Limits::of(&constants, bits).bound) * PressureRise(1).pascals(bits);
        add("zero, as far off as an ok reading allows", "derived", &|rise| {
            let [low, at, high] = [(rise - bound).max(0.0), rise, rise + bound].map(read);
            // At the end of the tables the slope below is that above.
            [0, 1].map(|output| {
                let below = 100.0 * (low[output] / at[output] - 1.0);
                let above = 100.0 * (high[output] / at[output] - 1.0);
                [below, if above > 0.0 { above } else { -below }]
            })
        });
        if let Some(OwnError::Compared(found)) = &generated.membrane_error {
            let both = [found.force_percent, found.indentation_percent];
            add(
                "model: a membrane, against the solid of its wall",
                "measured",
                &|_| both.map(|percent| [-percent, percent]),
            );
        }
        if generated.design.relaxation.is_some() {
            add("time: a press and hold", "tested", &|_| {
                RELAXING.map(|percent| [-percent, percent])
            });
            add("temperature: the wall 1 K off", "quoted", &|rise| {
                let [_, depth] = read(rise);
                let percent = 0.1 * depth_error(1e3 * depth) / depth;
                [[-KELVIN_FORCE, KELVIN_FORCE], [-percent, percent]]
            });
        } else {
            add(
                "temperature: the wall 10 K off, its stiffness as the absolute temperature",
                "derived",
                &|rise| {
                    let at = read(rise);
                    let ends = [1.0 - KELVINS / ROOM, 1.0 + KELVINS / ROOM].map(|stiffness| {
                        let [force, depth] = read(rise / stiffness);
                        [stiffness * force / at[0], depth / at[1]]
                    });
                    [0, 1].map(|output| {
                        let [one, other] = ends.map(|ratios| 100.0 * (ratios[output] - 1.0));
                        [one.min(other), one.max(other)]
                    })
                },
            );
        }
        if let Some(band) = &generated.band {
            add(OBJECT, "solved, quoted", &|rise| {
                let row = band.at(rise).copied().unwrap_or_else(|| band.widest());
                [row.force_percent, row.indentation_percent]
            });
        }
        add(FRICTION, "quoted", &|rise| {
            let [_, depth] = read(rise);
            let force = 100.0 * (quoted::rubbed_force(depth / height) - 1.0);
            let shallower = read(rise / quoted::rubbed_pressure(depth / height))[1];
            [
                [force.min(0.0), force.max(0.0)],
                [100.0 * (shallower / depth - 1.0), 0.0],
            ]
        });
        Self {
            name: generated.design.name.clone(),
            reached: FORCES.map(|force| force <= last.force.newtons()),
            budget,
            shares,
        }
    }
}

/// A percentage with its sign; none of what rounds to 0.
fn signed(percent: f64) -> String {
    if percent.abs() < 0.05 {
        "0.0".to_owned()
    } else {
        format!("{percent:+.1}")
    }
}

/// Millimetres a kelvin at a depth in millimetres, in proportion below the first.
fn depth_error(depth: f64) -> f64 {
    let mut before = (0.0, 0.0);
    for at in KELVIN_DEPTH {
        if depth <= at.0 {
            return before.1 + (at.1 - before.1) * (depth - before.0) / (at.0 - before.0);
        }
        before = at;
    }
    before.1
}

/// The page.
pub fn markdown(designs: &[RealUse]) -> String {
    let mut text = "# Error budget: all error sources of a reading\n\
    \n\
    The tables list the error of each source for a reading of 0.2, 1 and 5 N on a plate, in percent of the force (F) and of the\n\
    indentation (H). The error is the truth minus the reading, largest to either side; *sd* is one standard deviation.\n\
    `UPDATE_EXPECT=1 cargo test --package host-tests --test golden` writes this page; the same test fails when it is stale.\n\
    The stages of the chip are those of [their budget](../host-tests/BUDGET.md).\n\
    \n\
    - Zero: the bound of an ok reading, drift and transducer's temperature included.\n\
    - Time: `index-fingertip` computes the relaxation of its wall. The remaining error in the first press is tested\n\
    \x20 (`cargo test -p host-tests --test relaxing_wall`). Without that computation, tables like those of `index-fingertip-elastic`\n\
    \x20 read 8.2 N on such a wall for 5 N pressed in 1 s (the same test). The other designs state no series, so their error in time\n\
    \x20 is unknown.\n\
    - Temperature of the wall: for a relaxing wall, one kelvin, quoted from finite elements (5 % of F; 0.05, 0.08 and 0.11 mm of H\n\
    \x20 at 0.5, 1 and 2 mm). For the others, that of ideal rubber, whose stiffness is proportional to the absolute temperature.\n\
    - Object and friction: the band of [the certificate](golden) for an object unknown to the chip; effects are not combined.\n\
    - Not included: material constants and thickness of one fingertip; [a calibration](CALIBRATION.md) corrects for them.\n"
        .to_owned();
    for design in designs {
        let _ = write!(
            text,
            "\n## {}\n\n| source | from | F at 0.2 N | H | F at 1 N | H | F at 5 N | H |\n|---|---|---|---|---|---|---|---|\n",
            design.name
        );
        let line = |text: &mut String, name: &str, source: &str, cells: [[String; 2]; FORCES.len()]| {
            let cells: Vec<String> = cells
                .into_iter()
                .zip(design.reached)
                .flat_map(|(cells, reached)| {
                    cells.map(|cell| if reached { cell } else { "beyond".to_owned() })
                })
                .collect();
            let _ = writeln!(text, "| {name} | {source} | {} |", cells.join(" | "));
        };
        for term in &design.budget.terms {
            let kind = if term.bound { "" } else { "sd " };
            let cells = term
                .percent
                .map(|both| both.map(|percent| format!("{kind}{percent:.2}")));
            line(&mut text, term.name, term.source, cells);
        }
        for share in &design.shares {
            let cells = share
                .percent
                .map(|both| both.map(|ends| ends.map(signed).join(" to ")));
            line(&mut text, &share.name, share.source, cells);
        }
        let chip = [0, 1, 2].map(|place| design.budget.sum(place).map(|percent| format!("{percent:.2}")));
        line(&mut text, "**the chip's stages**", "sum", chip);
        for (name, with_object) in [
            ("**all on a plate, root of the squares**", false),
            ("**all, root of the squares**", true),
        ] {
            let all = [0, 1, 2].map(|place| {
                let chip = design.budget.sum(place);
                [0, 1].map(|output| {
                    let sum = |end: usize| {
                        let shares = design.shares.iter().filter(|share| {
                            with_object || ![OBJECT, FRICTION].contains(&share.name.as_str())
                        });
                        let squares = shares.map(|share| share.percent[place][output][end].powi(2));
                        (squares.sum::<f64>() + chip[output].powi(2)).sqrt()
                    };
                    [-sum(0), sum(1)].map(signed).join(" to ")
                })
            });
            line(&mut text, name, "sum", all);
        }
    }
    text.push_str(IN_TIME);
    text.push_str(GRASPS);
    text.push_str(TILT_AND_FRICTION);
    text.push_str(PLATES);
    text
}

/// What is drawn, and what counts.
const IN_TIME: &str = "\n## In real use, in time\n\n\
    `cargo campaign grasps --scenes 30 --worlds 4 --seed 2026` prints these tables. A scene is two grasps of one object through the\n\
    firmware's own signal path. Four of ten objects are plates, four balls of 5 to 50 mm radius, two cups from 2.65 times the crown's\n\
    radius of curvature on. These values are drawn with a uniform logarithm: the force of the grasp (0.2 to 8 N on a plate), the ramp\n\
    (0.1 to 30 s), the hold (0.3 to 10 s), the release (0.1 to 3 s), and the time to the next grasp (1 to 30 s). The wall has 15 to 25\n\
    degrees Celsius; the chip assumes 20. Each scene is read in four worlds, with the object told to the chip and not told. Half of the\n\
    worlds have the design's own part, half an absolute one (MS5837-02BA) in weather of up to 98 Pa an hour. Each has the part's noise\n\
    and steps, a drift of up to 2 Pa an hour, and, before the touch, a zero anywhere within the bound of an ok reading.\n\n\
    **The truth is the product's own solid** in time, 2 x 60 elements: what real Agilus30 does is not in it. Of the elastic design it is\n\
    the same solid without a series, its stiffness as the absolute temperature. Errors are percent of the truth where that is 0.2 N or more; each press, hold and\n\
    release counts once, whatever it lasts. *Stated*: three deviations, and where the object is not told the widest of the band, where it is told\n\
    the largest error of a blend in the certificate, and in time 7 % of the largest force and 2 % of the largest indentation so far. The deviation of a wall\n\
    that relaxes holds a wall 2 K off; that of an elastic wall holds none of it.\n\n";

/// As the campaign printed them.
const GRASPS: &str = include_str!("grasps.md");

/// What the campaign of tilted and rubbing plates draws.
const TILT_AND_FRICTION: &str = "\n## Tilt and friction, in time\n\n\
    `cargo campaign plates --scenes 12 --worlds 2 --seed 2026` prints these tables. The scenes are those above, all on a plate, and the chip\n\
    is not told. Each is read flat, tilted by up to 20 degrees, and with a coefficient of friction of up to 0.3, with the same zeros and\n\
    noises. Flat, the truth is the product's own solid. **Tilt and friction are quoted figures** of settled finite elements of the\n\
    9 x 7 mm dome, applied to the solid's force, indentation and pressure. The ratios are taken to hold in time and on releases too, which no\n\
    source states. Lateral forces are not in it.\n\n";

/// As that campaign printed them.
const PLATES: &str = include_str!("plates.md");

/// Median and 95 % error of the force of a design, percent, where the chip is told the object or not, as the campaign printed them; nothing
/// where it did not.
pub fn force_in_real_use(design: &str, told: &str) -> Option<[f64; 2]> {
    let rows = GRASPS
        .split("### ")
        .find(|chapter| chapter.starts_with(&format!("{design}\n")))?;
    let row = rows
        .lines()
        .find(|row| row.starts_with(&format!("| {told} | **all** |")))?;
    let cell = |place: usize| -> Option<f64> { row.split('|').nth(place)?.trim().parse().ok() };
    Some([cell(3)?, cell(4)?])
}
