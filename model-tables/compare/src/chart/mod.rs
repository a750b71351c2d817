//! `designer chart`: speed against accuracy of every method, and the ladder of models, as SVG and CSV; or what tables cost.

mod ladder;
mod speed;
mod tables;

use crate::methods::approximations::{APPROXIMATIONS, MeasuredErrors, SAMPLES, Yardstick};
use crate::methods::benchmark::{self, BenchmarkDesign, DESIGNS, Sweep};
use model_tables::membrane::TensionField;
use output::files;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::fmt::Write as _;
use std::path::PathBuf;

const COLUMNS: &[&str] = &["file", "size_bytes"];
/// The ladder is measured from this part of the limit on, down to that of a sweep.
const LADDER_FROM: f64 = 1e-5;

/// What is asked.
#[derive(Debug, clap::Args)]
pub struct ChartArguments {
    /// The designs: paper, finger, skin [default: all three]
    #[arg(value_parser = ["paper", "finger", "skin"])]
    designs: Vec<String>,
    /// Write the cost of tables over designs and accuracies instead: a page and CSV
    #[arg(long, conflicts_with = "designs")]
    tables: bool,
    /// Folder for the files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "target/chart")]
    out: PathBuf,
}

/// A design with what was measured.
struct Measured {
    sweep: Sweep,
    results: Vec<benchmark::Result>,
    ladder: Vec<MeasuredErrors>,
}

/// Measures, writes the files, and gives a row a file.
///
/// # Errors
/// [`Refusal`] where a design cannot be solved or a file not be written.
pub fn run(arguments: &ChartArguments) -> Result<CommandAnswer, Refusal> {
    files::expect_folder(&arguments.out, &[])?;
    let contents = if arguments.tables {
        tables::contents()?
    } else {
        methods(arguments)?
    };
    files::write_all(&arguments.out, &contents)?;
    let mut rows = Rows::new(COLUMNS);
    for (name, content) in &contents {
        rows.push(vec![
            Cell::Text(arguments.out.join(name).display().to_string()),
            Cell::Count(content.len()),
        ]);
    }
    Ok(CommandAnswer {
        rows,
        notes: Vec::new(),
    })
}

/// The methods of solving, and the ladder of models.
fn methods(arguments: &ChartArguments) -> Result<Vec<(&'static str, Vec<u8>)>, Refusal> {
    let chosen: Vec<BenchmarkDesign> = DESIGNS
        .into_iter()
        .filter(|d| arguments.designs.is_empty() || arguments.designs.iter().any(|name| name == d.name))
        .collect();
    let measured = chosen.iter().map(measure).collect::<Result<Vec<_>, _>>()?;
    Ok(vec![
        ("speed-accuracy.svg", speed::svg(&measured).into_bytes()),
        ("speed-accuracy.csv", results_csv(&measured).into_bytes()),
        ("ladder.svg", ladder::svg(&measured).into_bytes()),
        ("ladder.csv", ladder_csv(&measured).into_bytes()),
        ("sweeps.csv", sweeps_csv(&measured).into_bytes()),
    ])
}

fn measure(design: &BenchmarkDesign) -> Result<Measured, Refusal> {
    let refuse = |reason: String| Refusal(format!("{}: {reason}", design.name));
    eprintln!("{}: solving the states to compare with", design.title);
    let sweep = Sweep::new(design).map_err(|error| refuse(error.to_string()))?;
    let methods = benchmark::methods();
    let results = benchmark::run(&sweep, &methods, |round| {
        if round < 3 || round % 10 == 0 {
            eprintln!("{}: {} methods, round {}", design.title, methods.len(), round + 1);
        }
    });
    eprintln!("{}: measuring the ladder of models", design.title);
    let deepest = sweep.indentations.last().copied().unwrap_or_default();
    let range = [LADDER_FROM * deepest, deepest];
    let yardstick = Yardstick::new(&design.design, TensionField::Plain, range)
        .map_err(|error| refuse(error.to_string()))?;
    let ladder = APPROXIMATIONS
        .map(|approximation| yardstick.measure(approximation))
        .to_vec();
    Ok(Measured {
        sweep,
        results,
        ladder,
    })
}

/// What became of a sweep, in a word or a sentence without commas.
fn outcome(result: &benchmark::Result) -> String {
    result
        .failure
        .as_ref()
        .map_or("ok".to_owned(), |reason| reason.replace(',', ";"))
}

fn results_csv(measured: &[Measured]) -> String {
    let mut text = "design,method,settings,us_per_state,worst_force_error,median_force_error,states_found,\
                    states_asked,repetitions,truth_uncertainty,outcome\n"
        .to_owned();
    for design in measured {
        for result in &design.results {
            let _ = writeln!(
                text,
                "{},{},{},{:.6},{:.6e},{:.6e},{},{},{},{:.1e},{}",
                design.sweep.design.name,
                result.method.family(),
                result.method.settings(),
                result.seconds * 1e6,
                result.worst,
                result.median,
                result.found,
                result.asked,
                result.repetitions,
                design.sweep.uncertainty,
                outcome(result)
            );
        }
    }
    text
}

fn ladder_csv(measured: &[Measured]) -> String {
    let mut text =
        "design,fidelity,us_per_state,indentation_mm,force_error,pressure_rise_error,outcome\n".to_owned();
    for design in measured {
        for evidence in &design.ladder {
            for sample in &evidence.samples {
                let (error, outcome) = match sample.force {
                    Ok(error) => (format!("{error:.6e}"), "ok".to_owned()),
                    Err(failure) => (String::new(), failure.to_string()),
                };
                let rise = if sample.rise.is_finite() {
                    format!("{:.6e}", sample.rise)
                } else {
                    String::new()
                };
                let _ = writeln!(
                    text,
                    "{},{},{:.6},{:.14},{error},{rise},{outcome}",
                    design.sweep.design.name,
                    evidence.approximation,
                    evidence.seconds * 1e6 / SAMPLES as f64,
                    sample.indentation * 1e3,
                );
            }
        }
    }
    text
}

fn sweeps_csv(measured: &[Measured]) -> String {
    let mut text = "design,indentation_mm,force_n\n".to_owned();
    for design in measured {
        for (indentation, force) in design.sweep.indentations.iter().zip(&design.sweep.forces) {
            let name = design.sweep.design.name;
            let _ = writeln!(text, "{name},{:.15},{force:.15}", indentation * 1e3);
        }
    }
    text
}
