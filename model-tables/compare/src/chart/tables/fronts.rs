//! Bytes and instructions of the tables over designs of many kinds and accuracies, and why some need more.

use model_tables::curve::Contact;
use model_tables::design_file::{Accuracy, DEFAULT_MODEL_PERCENT, DesignFile};
use model_tables::generate::{self, NoTables, Solved};
use output::Refusal;
use rayon::prelude::*;
use std::fmt::Write as _;

/// Accuracies, percent of reading from 1 % of full scale up.
pub(super) const PERCENTS: [f64; 5] = [1.0, 0.125, 0.1, 0.02, 0.01];
/// The transducer's resolution, pascals: fine enough for all of them.
const RESOLUTION: f64 = 2.0;

/// Name, undeformed semi-axes and wall in millimetres, law, stretch of the pole at rest, depth of the press in millimetres.
type Kind = (&'static str, [f64; 3], &'static str, f64, f64);

const AGILUS30: &str = "law = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0";

/// Oblate, spherical and prolate; three laws; hardly stretched at rest to far stretched.
const KINDS: [Kind; 9] = [
    ("oblate 8.5 x 6.5, Agilus30", [8.5, 6.5, 1.0], AGILUS30, 1.02, 2.5),
    ("oblate 9 x 5, Agilus30", [9.0, 5.0, 1.0], AGILUS30, 1.1, 2.5),
    ("oblate 4.5 x 2.7, Agilus30", [4.5, 2.7, 1.0], AGILUS30, 2.3, 2.5),
    (
        "oblate 9 x 5, neo-Hookean",
        [9.0, 5.0, 1.0],
        "law = \"neo-hookean\"\nc1_pa = 150000.0",
        1.5,
        3.0,
    ),
    (
        "sphere 6, neo-Hookean",
        [6.0, 6.0, 0.8],
        "law = \"neo-hookean\"\nc1_pa = 200000.0",
        1.3,
        2.5,
    ),
    (
        "sphere 7, Yeoh",
        [7.0, 7.0, 1.0],
        "law = \"yeoh\"\nc1_pa = 120000.0\nc2_pa = 8000.0\nc3_pa = 1000.0",
        1.02,
        3.0,
    ),
    (
        "prolate 5 x 8, Yeoh",
        [5.0, 8.0, 1.0],
        "law = \"yeoh\"\nc1_pa = 160000.0\nc2_pa = 5000.0\nc3_pa = 500.0",
        1.05,
        2.5,
    ),
    ("prolate 5 x 7.5, Agilus30", [5.0, 7.5, 1.0], AGILUS30, 1.02, 3.0),
    ("prolate 4 x 6, Agilus30", [4.0, 6.0, 0.7], AGILUS30, 2.5, 3.5),
];

/// What tables of an accuracy cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cost {
    pub(super) bytes: usize,
    pub(super) instructions: u32,
}

/// A design with its costs.
pub(super) struct Front {
    name: &'static str,
    stretch: f64,
    /// Octaves of pressure from where the indentation reaches 1 % of its full scale to the end.
    octaves: f64,
    /// Local exponents of the indentation over the pressure rise, at that place and at the end.
    exponents: [f64; 2],
    /// One for each accuracy, nothing where none was found.
    pub(super) costs: Vec<Option<Cost>>,
}

fn file(&(name, [radial, axial, wall], law, stretch, depth): &Kind) -> Result<DesignFile, Refusal> {
    let text = format!(
        "name = \"front\"\n\
         [membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
         [material]\n{law}\n[rest]\npole_stretch = {stretch:?}\n[press]\nmax_indentation_mm = {depth:?}\n\
         [transducer]\nkind = \"ratiometric\"\nrange_kpa = [0.0, 1000.0]\nresolution_pa = {RESOLUTION:?}\n\
         output_fraction_at_range = [0.1, 0.9]\n"
    );
    DesignFile::parse(&text, name).map_err(Refusal::of)
}

/// Solves every design and makes its tables at each of `percents`.
pub(super) fn measure(percents: &[f64]) -> Result<Vec<Front>, Refusal> {
    KINDS.par_iter().map(|kind| one(kind, percents)).collect()
}

fn one(kind: &Kind, percents: &[f64]) -> Result<Front, Refusal> {
    let refuse = |error: &dyn std::fmt::Display| Refusal(format!("{}: {error}", kind.0));
    let solved = generate::solve(&file(kind)?).map_err(|error| refuse(&error))?;
    let costs = percents
        .par_iter()
        .map(|&percent| cost(&solved, percent).map_err(|error| refuse(&error)))
        .collect::<Result<_, _>>()?;
    let from = solved.curve.at_indentation(0.01 * solved.end.indentation);
    let exponent = |at: Contact| {
        let next = solved.curve.at_pressure_rise(0.98 * at.pressure_rise);
        libm::log(at.indentation / next.indentation) / libm::log(at.pressure_rise / next.pressure_rise)
    };
    Ok(Front {
        name: kind.0,
        stretch: kind.3,
        octaves: libm::log2(solved.end.pressure_rise / from.pressure_rise),
        exponents: [exponent(from), exponent(solved.end)],
        costs,
    })
}

fn cost(solved: &Solved, percent: f64) -> Result<Option<Cost>, NoTables> {
    let accuracy = Accuracy {
        force_percent_of_reading: percent,
        indentation_percent_of_reading: percent,
        from_percent_of_full_scale: 1.0,
        model_percent: DEFAULT_MODEL_PERCENT,
    };
    match generate::tables(&solved.curve, solved.end, &accuracy, RESOLUTION) {
        Ok(certified) => Ok(Some(Cost {
            bytes: certified.tables.bytes(),
            instructions: certified.tables.instructions(),
        })),
        Err(NoTables::Inaccurate { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// `bytes / instructions`.
fn label(cost: Option<Cost>) -> String {
    cost.map_or("none".to_owned(), |cost| {
        format!("{} / {}", cost.bytes, cost.instructions)
    })
}

/// The rows of the page.
pub(super) fn rows(fronts: &[Front]) -> Vec<String> {
    fronts
        .iter()
        .map(|front| {
            let costs: Vec<String> = front.costs.iter().copied().map(label).collect();
            format!(
                "| {} | {:?} | {:.1} | {:.2} .. {:.2} | {} |",
                front.name,
                front.stretch,
                front.octaves,
                front.exponents[0],
                front.exponents[1],
                costs.join(" | ")
            )
        })
        .collect()
}

/// The same as CSV.
pub(super) fn csv(fronts: &[Front]) -> String {
    let mut text =
        "design,pole_stretch,octaves,first_exponent,last_exponent,percent,bytes,instructions\n".to_owned();
    for front in fronts {
        for (percent, cost) in PERCENTS.iter().zip(&front.costs) {
            let cost = cost.map_or(",".to_owned(), |cost| {
                format!("{},{}", cost.bytes, cost.instructions)
            });
            let _ = writeln!(
                text,
                "{},{:?},{:.3},{:.4},{:.4},{percent:?},{cost}",
                front.name.replace(',', ";"),
                front.stretch,
                front.octaves,
                front.exponents[0],
                front.exponents[1],
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Where the page is kept.
    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tables");

    /// Most bytes and instructions at 0.1 %, but for one design: the longest way to touch down takes an instruction more, as the
    /// page explains.
    const MAX_COST: Cost = Cost {
        bytes: 192,
        instructions: 28,
    };
    const SLOWER: usize = 1;
    /// Bytes that do at 0.125 %, but for so many designs: a soft touch-down takes a segment more, as the page explains.
    const COARSER: usize = 128;
    const LARGER: usize = 3;

    /// With `UPDATE_EXPECT` set it writes the page, as the command does; without, it holds two accuracies of it.
    #[test]
    fn nine_designs_are_as_small_as_the_page_says() {
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            let contents = super::super::contents();
            for (name, content) in contents.unwrap_or_else(|Refusal(reason)| panic!("{reason}")) {
                std::fs::write(Path::new(FOLDER).join(name), content).expect("it can be written");
            }
        }
        let fronts = measure(&[0.125, 0.1]).unwrap_or_else(|Refusal(reason)| panic!("{reason}"));
        let page = std::fs::read_to_string(Path::new(FOLDER).join("README.md")).expect("the page");
        let (mut larger, mut slower) = (0, 0);
        for (front, row) in fronts.iter().zip(rows(&fronts)) {
            println!("{row}");
            let [Some(coarser), Some(fine)] = front.costs[..] else {
                panic!("{}: no tables", front.name)
            };
            assert!(
                fine.bytes <= MAX_COST.bytes && fine.instructions <= MAX_COST.instructions + 1,
                "{row}"
            );
            slower += usize::from(fine.instructions > MAX_COST.instructions);
            larger += usize::from(coarser.bytes > COARSER);
            // The page has three accuracies more.
            let cells = |row: &str| {
                row.split('|')
                    .map(|cell| cell.trim().to_owned())
                    .collect::<Vec<_>>()
            };
            let stated = page
                .lines()
                .find(|line| line.starts_with(&format!("| {} |", front.name)));
            let (stated, found) = (cells(stated.unwrap_or_default()), cells(&row));
            assert!(
                stated.len() == 11 && stated[..5] == found[..5] && stated[6..8] == found[5..7],
                "the page is stale: {row}"
            );
        }
        assert!(
            larger <= LARGER && slower <= SLOWER,
            "{larger} designs take more than {COARSER} bytes, {slower} more than {} instructions",
            MAX_COST.instructions
        );
    }
}
