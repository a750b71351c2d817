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
         Bytes / instructions of force and indentation together, for the largest error in the heading: percent of reading from 1 % of\n\
         full scale up, the same absolute error below, certified over every input. The transducer has 2 Pa. No output falls anywhere.\n\
         The instructions are computed from the shape of the lookup; those of the image are counted as they run.\n\
         \n\
         | design | pole stretch at rest | octaves | exponent | {percents} |\n\
         |---|---|---|---|---|---|---|---|---|\n"
    );
    for row in fronts::rows(fronts) {
        let _ = writeln!(text, "{row}");
    }
    text.push_str(
        "\nThe size of the tables depends on two numbers of a design. *Octaves*: from the pressure at 1 % of the full indentation to that\n\
        at the end. Below, the errors are absolute and one segment is enough. A segment spans two octaves, so half as many segments\n\
        are needed, and one or two for first contact, at 16 bytes each (20 with four powers). *Exponent*: the local power of the\n\
        indentation over the pressure, at both places. The more it changes, the more each sum must bend. Domes with little stretch at\n\
        rest have a soft first contact. They have the most octaves, and need more than 128 bytes at 0.125 %. The dome with the most\n\
        octaves needs a sixth power, which takes one more instruction: 29, while the others take 28 or less. *none*: 16-bit\n\
        coefficients cannot reach this accuracy.\n",
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
         Bytes / instructions of the tables that the tool chooses for a coarse and for a fine transducer, and their accuracy limit if it\n\
         is not the required one. Tables need not be finer than half of the transducer's resolution, as the smallest fraction of a\n\
         reading. The certificate and `cargo designer table` state which of the two limits applies.\n\
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
         The table lists the fewest bytes with which each method keeps {COMPARED} % of reading, and its instructions. If a method does not\n\
         reach this, its smallest error is in brackets. Instructions are those of both results as one function on the emulated chip,\n\
         median over 64 inputs ([instructions.csv](instructions.csv), checked by `cargo test-all`). For the tables of this project they\n\
         are computed from their shape, plus the call of the shipped tables. The other methods get favourable conditions: an input in\n\
         their own unit, knots and values fitted to the smallest maximum error, and one search for both results. One knot takes\n\
         8 bytes or more. Their errors are found at 20 000 inputs, those of this project's tables at every input. All points:\n\
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
