//! The page: Markdown around the numbers.

use super::fronts::{self, Front, PERCENTS};
use super::{ASKED, Chosen, Design, Measured, OURS, RESOLUTIONS};
use std::fmt::Write as _;

/// What writes the page.
const COMMAND: &str = "cargo designer chart --tables --out model-tables/tables";
/// Accuracy at which the ways are compared, percent of reading.
const COMPARED: f64 = 0.1;

/// The ways: their name, words, and whether a search makes their cost depend on their size.
pub(super) const WAYS: [(&str, &str, bool); 12] = [
    (OURS, "fingertip: sums of gapped powers over octaves", false),
    ("octave_linear", "octaves, linear, i32", false),
    ("octave_quadratic", "octaves, quadratic, i32", false),
    ("octave_cubic", "octaves, cubic, i32", false),
    ("linear_f32", "searched knots, linear, f32", true),
    ("cubic_f32", "searched knots, cubic (PCHIP), f32", true),
    ("warped_f32", "knots even in the root, linear, f32", false),
    ("uniform_q31", "even knots, linear, q31 (CMSIS-DSP)", false),
    ("uniform_q15", "even knots, linear, q15 (CMSIS-DSP)", false),
    ("rational_f32", "rational in the root, f32", false),
    ("power_libm", "power law, libm powf", false),
    ("power_micromath", "power law, micromath powf", false),
];

/// The whole page.
pub(super) fn markdown(fronts: &[Front], designs: &[Design]) -> String {
    format!(
        "# What the tables cost\n\
         \n\
         Written by `{COMMAND}`; tests fail when it is stale.\n\
         \n\
         {}\n{}\n{}",
        of_designs(fronts),
        of_transducers(designs),
        of_ways(designs)
    )
}

fn of_designs(fronts: &[Front]) -> String {
    let percents = PERCENTS.map(|percent| format!("{percent} %")).join(" | ");
    let mut text = format!(
        "## Over designs and accuracies\n\
         \n\
         Bytes / instructions of force and indentation together, at a largest error of so much of reading from 1 % of full scale up\n\
         (the same in absolute terms below), certified over every input; a transducer of 2 Pa. No output falls anywhere. The\n\
         instructions are the lookup's own, from its shape; the image's are counted as they run.\n\
         \n\
         | design | pole stretch at rest | octaves | exponent | {percents} |\n\
         |---|---|---|---|---|---|---|---|---|\n"
    );
    for row in fronts::rows(fronts) {
        let _ = writeln!(text, "{row}");
    }
    text.push_str(
        "\nWhat a design needs goes with two of its numbers. *Octaves*: from the pressure at 1 % of the full indentation to that at\n\
         the end; below, the errors are absolute and one segment does. A segment spans two octaves, so half as many segments\n\
         are needed, and one or two for first contact, at 16 bytes each (20 with four powers). *Exponent*: the local power with\n\
         which the indentation follows the pressure, there and at the end; the further it goes, the more each sum has to bend.\n\
         Domes that are hardly stretched at rest touch down softly: most octaves, hence more than 128 bytes at 0.125 %. The one\n\
         with most of them needs a sixth power, which is an instruction more: 29 where the others take 28 or less.\n\
         *none*: 16-bit coefficients do not reach so far there.\n",
    );
    text
}

fn of_transducers(designs: &[Design]) -> String {
    let resolutions: Vec<String> = RESOLUTIONS
        .iter()
        .map(|pascals| format!("{pascals} Pa"))
        .collect();
    let mut text = format!(
        "## Over transducers\n\
         \n\
         What the tool chooses for a coarse transducer and for a fine one: bytes / instructions, and what it holds the tables to where\n\
         that is not what was asked. Half of what a transducer tells apart, where that is least as a share of a reading, is as fine as\n\
         tables need be: the certificate and `cargo designer table` say which of the two it was.\n\
         \n\
         | design | asked | {} |\n\
         |---|---|{}\n",
        resolutions.join(" | "),
        "---|".repeat(resolutions.len())
    );
    for design in designs {
        for percent in ASKED {
            let cells: Vec<String> = RESOLUTIONS
                .iter()
                .map(|&resolution| {
                    let of = |chosen: &&Chosen| {
                        chosen.percent.to_bits() == percent.to_bits()
                            && chosen.resolution.to_bits() == resolution.to_bits()
                    };
                    design.chosen.iter().find(of).map_or("none".to_owned(), |chosen| {
                        let cost = format!("{} / {}", chosen.bytes, chosen.instructions);
                        if chosen.held > percent {
                            format!("{cost}, held to {:.3} %", chosen.held)
                        } else {
                            cost
                        }
                    })
                })
                .collect();
            let _ = writeln!(text, "| {} | {percent} % | {} |", design.name, cells.join(" | "));
        }
    }
    text
}

fn of_ways(designs: &[Design]) -> String {
    let names: Vec<String> = designs
        .iter()
        .map(|design| format!("{}: bytes | instructions", design.name))
        .collect();
    let mut text = format!(
        "## Beside other ways\n\
         \n\
         The least bytes at which each way keeps {COMPARED} % of reading, and its instructions then; in brackets the least error it\n\
         reaches where it does not. Instructions are of both results as one function on the emulated chip, median over 64 inputs\n\
         ([instructions.csv](instructions.csv), held by `cargo test-all`); the figures of these tables are those of their shape\n\
         and what the call of the shipped ones adds. The others get what is best for them: an input already in their own unit, knots\n\
         and values fitted to least largest error, and one search for both results where they have a search; 8-byte knots and\n\
         up. Their errors are found at 20 000 inputs, those of these tables at every input. All points:\n\
         [lookups.csv](lookups.csv).\n\
         \n\
         ![error against bytes and instructions](lookups.svg)\n\
         \n\
         | way | {} |\n\
         |---|{}\n",
        names.join(" | "),
        "---|---|".repeat(designs.len())
    );
    for (way, words, _) in WAYS {
        let cells: Vec<String> = designs.iter().map(|design| cell(design, way)).collect();
        let _ = writeln!(text, "| {words} | {} |", cells.join(" | "));
    }
    text
}

fn cell(design: &Design, way: &str) -> String {
    let points: Vec<&Measured> = design.measured.iter().filter(|point| point.way == way).collect();
    let good = points
        .iter()
        .filter(|point| point.errors.of_reading <= COMPARED)
        .min_by_key(|point| point.bytes);
    if let Some(point) = good {
        return format!("{} | {}", point.bytes, point.instructions);
    }
    let best = points
        .iter()
        .min_by(|a, b| a.errors.of_reading.total_cmp(&b.errors.of_reading));
    best.map_or("- | -".to_owned(), |point| {
        format!(
            "{} ({:.2} %) | {}",
            point.bytes, point.errors.of_reading, point.instructions
        )
    })
}
