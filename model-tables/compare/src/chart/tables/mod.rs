//! `designer chart --tables`: what force and indentation cost to look up, this way and others, as SVG, CSV and a page.

mod drawing;
mod fronts;
mod page;
mod placing;
mod ways;

use model_tables::design_file::{Accuracy, DEFAULT_MODEL_PERCENT, DesignFile};
use model_tables::generate::{self, NoTables};
use output::Refusal;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use ways::{Errors, Press};

/// Instructions of every way, counted on the emulated chip: `cargo test-all` keeps them.
const INSTRUCTIONS: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../tables/instructions.csv"));

/// The designs of the chart, by name, with the way that the counts have for their tables.
const DESIGNS: [(&str, &str, &str); 3] = [
    (
        "index-fingertip-elastic",
        "index_fingertip_elastic_tables",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../designs/index-fingertip-elastic.toml"
        )),
    ),
    (
        "paper-prestretched",
        "paper_prestretched_tables",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../designs/paper-prestretched.toml"
        )),
    ),
    (
        "skin-analogue",
        "skin_analogue_tables",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../designs/skin-analogue.toml"
        )),
    ),
];

/// What these tables are called among the ways.
const OURS: &str = "fingertip";
/// Accuracies that these tables are made for, percent of reading.
const PERCENTS: [f64; 6] = [2.0, 1.0, 0.5, 0.2, 0.1, 0.05];
/// The transducer's resolution, pascals: fine enough for all of them.
const RESOLUTION: f64 = 1.0;

/// Transducers that the tool's choice is shown for, pascals, and the accuracies asked of it, percent of reading.
const RESOLUTIONS: [f64; 3] = [50.0, 10.0, 1.0];
const ASKED: [f64; 3] = [1.0, 0.1, 0.05];

/// A way at a size, measured.
#[derive(Clone, Debug)]
struct Measured {
    way: &'static str,
    bytes: usize,
    instructions: u32,
    errors: Errors,
}

/// All ways for a design.
struct Design {
    name: &'static str,
    measured: Vec<Measured>,
    chosen: Vec<Chosen>,
}

/// Tables as chosen for an accuracy and a transducer.
struct Chosen {
    /// Percent of reading asked.
    percent: f64,
    /// Of the transducer, pascals.
    resolution: f64,
    /// Percent of reading that they were held to.
    held: f64,
    bytes: usize,
    instructions: u32,
}

/// What is written: names and contents.
pub(super) fn contents() -> Result<Vec<(&'static str, Vec<u8>)>, Refusal> {
    eprintln!("tables of nine designs at {} accuracies", fronts::PERCENTS.len());
    let fronts = fronts::measure(&fronts::PERCENTS)?;
    eprintln!("other ways to look up, fitted to {} designs", DESIGNS.len());
    let designs = DESIGNS
        .par_iter()
        .map(|(name, way, text)| measure(name, way, text))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(vec![
        ("README.md", page::markdown(&fronts, &designs).into_bytes()),
        ("lookups.svg", drawing::svg(&designs).into_bytes()),
        ("lookups.csv", csv(&designs).into_bytes()),
        ("designs.csv", fronts::csv(&fronts).into_bytes()),
    ])
}

fn measure(name: &'static str, way: &str, text: &str) -> Result<Design, Refusal> {
    let refuse = |error: &dyn std::fmt::Display| Refusal(format!("{name}: {error}"));
    let file = DesignFile::parse(text, name).map_err(Refusal::of)?;
    let solved = generate::solve(&file).map_err(|error| refuse(&error))?;
    let counts = Counts::read();
    let mut measured = Vec::new();
    for point in Press::new(&solved.curve, solved.end).points() {
        measured.push(Measured {
            way: point.way,
            bytes: point.bytes,
            instructions: counts.of(point.way, point.size),
            errors: point.errors,
        });
    }
    let made = |percent: f64, resolution: f64| {
        let accuracy = Accuracy {
            force_percent_of_reading: percent,
            indentation_percent_of_reading: percent,
            from_percent_of_full_scale: 1.0,
            model_percent: DEFAULT_MODEL_PERCENT,
        };
        match generate::tables(&solved.curve, solved.end, &accuracy, resolution) {
            Ok(certified) => Ok(Some(certified)),
            Err(NoTables::Inaccurate { .. }) => Ok(None),
            Err(error) => Err(refuse(&error)),
        }
    };
    // What a call adds to the work of the lookup itself, which the shape tells.
    let shipped = made(0.1, solved.transducer.resolution_pa)?;
    let call = shipped.map_or(0, |shipped| {
        counts.of(way, 0).saturating_sub(shipped.tables.instructions())
    });
    for percent in PERCENTS {
        let Some(certified) = made(percent, RESOLUTION)? else {
            continue;
        };
        let certificate = &certified.certificate;
        let both = [&certificate.force, &certificate.indentation];
        let largest =
            |of: fn(&generate::Errors) -> f64| both.iter().map(|errors| of(errors)).fold(0.0, f64::max);
        measured.push(Measured {
            way: OURS,
            bytes: certified.tables.bytes(),
            instructions: certified.tables.instructions() + call,
            errors: Errors {
                of_reading: largest(|errors| errors.of_reading.max.max(errors.below_percent_of_from)),
                of_full_scale: largest(|errors| errors.of_full_scale.max),
            },
        });
    }
    let mut chosen = Vec::new();
    for percent in ASKED {
        for resolution in RESOLUTIONS {
            let Some(certified) = made(percent, resolution)? else {
                continue;
            };
            chosen.push(Chosen {
                percent,
                resolution,
                held: certified.certificate.force.allowed_percent,
                bytes: certified.tables.bytes(),
                instructions: certified.tables.instructions(),
            });
        }
    }
    Ok(Design {
        name,
        measured,
        chosen,
    })
}

/// The counted instructions: medians, by way and size.
struct Counts(BTreeMap<(&'static str, usize), u32>);

impl Counts {
    fn read() -> Self {
        let rows = INSTRUCTIONS.lines().skip(1).filter_map(|line| {
            let mut fields = line.split(',');
            let way = fields.next()?;
            let size = fields.next()?.parse().ok()?;
            Some(((way, size), fields.next()?.parse().ok()?))
        });
        Self(rows.collect())
    }

    /// Of a way at a size: searching takes a step for each doubling.
    fn of(&self, way: &'_ str, size: usize) -> u32 {
        let at_least = self
            .0
            .iter()
            .find(|((name, counted), _)| *name == way && *counted >= size);
        at_least.map_or(0, |(_, &count)| count)
    }
}

impl Design {
    /// Whether nothing measured is at least as good in both of an abscissa and the error.
    fn on_front(&self, point: &Measured, abscissa: fn(&Measured) -> f64) -> bool {
        let (cost, error) = (abscissa(point), point.errors.of_reading);
        !self.measured.iter().any(|other| {
            let (other_cost, other_error) = (abscissa(other), other.errors.of_reading);
            other_cost <= cost && other_error <= error && (other_cost < cost || other_error < error)
        })
    }
}

fn bytes(point: &Measured) -> f64 {
    point.bytes as f64
}

fn instructions(point: &Measured) -> f64 {
    f64::from(point.instructions)
}

fn csv(designs: &[Design]) -> String {
    let mut text =
        "design,way,bytes,instructions,max_percent_of_reading,max_percent_of_full_scale,front_of_bytes,\
                    front_of_instructions\n"
            .to_owned();
    for design in designs {
        for point in &design.measured {
            let _ = writeln!(
                text,
                "{},{},{},{},{:.4e},{:.4e},{},{}",
                design.name,
                point.way,
                point.bytes,
                point.instructions,
                point.errors.of_reading,
                point.errors.of_full_scale,
                design.on_front(point, bytes),
                design.on_front(point, instructions),
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_has_its_instructions() {
        let counts = Counts::read();
        for way in page::WAYS {
            if way.0 != OURS {
                let largest = if way.2 { 512 } else { 0 };
                assert!(counts.of(way.0, largest) > 0, "{}", way.0);
            }
        }
        for (_, way, _) in DESIGNS {
            assert!(counts.of(way, 0) > 0, "{way}");
        }
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let point = |bytes, instructions, of_reading| Measured {
            way: OURS,
            bytes,
            instructions,
            errors: Errors {
                of_reading,
                of_full_scale: 0.0,
            },
        };
        let design = Design {
            name: "",
            measured: vec![point(10, 50, 1.0), point(20, 20, 1.0), point(20, 50, 0.5)],
            chosen: Vec::new(),
        };
        let front = |of: fn(&Measured) -> f64| {
            design
                .measured
                .iter()
                .map(|point| design.on_front(point, of))
                .collect::<Vec<_>>()
        };
        assert_eq!(front(bytes), [true, false, true]);
        assert_eq!(front(instructions), [false, true, true]);
    }
}
