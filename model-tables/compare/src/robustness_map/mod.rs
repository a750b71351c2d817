//! `designer atlas`: where each method answers, refuses, or is silently wrong; and what a state costs.

mod cost;
mod map;
mod survey;

use output::files;
use output::progress::Progress;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;
use survey::{MAPS, METHODS, Survey, VERDICTS};

const COLUMNS: &[&str] = &["map", "method", "verdict", "cells"];

/// What is asked.
#[derive(Debug, clap::Args)]
pub struct RobustnessMapArguments {
    /// Folder for the files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "target/atlas")]
    out: PathBuf,
    /// Take every n-th cell of a map in each direction
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    stride: u32,
}

/// Measures, writes the files, and gives a row a file.
///
/// # Errors
/// [`Refusal`] where a design cannot be solved or a file not be written.
pub fn run(arguments: &RobustnessMapArguments) -> Result<CommandAnswer, Refusal> {
    files::expect_folder(&arguments.out, &["cost.svg", "cost.csv"])?;
    let stride = arguments.stride as usize;
    let mut contents: Vec<(String, Vec<u8>)> = Vec::new();
    let mut rows = Rows::new(COLUMNS);
    let progress = Progress::new("maps");
    for (number, chart) in MAPS.iter().enumerate() {
        let survey = Survey::new(chart, stride, |done, all| {
            progress.set((number as f64 + done as f64 / all as f64) / MAPS.len() as f64);
        });
        for (method, of_method) in METHODS.iter().zip(survey.counts()) {
            for (verdict, count) in VERDICTS.iter().zip(of_method) {
                if count > 0 {
                    rows.push(vec![
                        Cell::word(chart.name),
                        Cell::word(method.name()),
                        Cell::word(verdict.word()),
                        Cell::Count(count),
                    ]);
                }
            }
        }
        contents.push((format!("{}.svg", chart.name), map::svg(&survey).into_bytes()));
        contents.push((format!("{}.csv", chart.name), survey.csv().into_bytes()));
    }
    progress.finish();
    eprintln!("the cost of a state");
    let costs = cost::measure(stride)?;
    contents.push(("cost.svg".to_owned(), cost::svg(&costs).into_bytes()));
    contents.push(("cost.csv".to_owned(), cost::csv(&costs).into_bytes()));
    files::write_all(&arguments.out, &contents)?;
    Ok(CommandAnswer {
        rows,
        notes: vec![format!(
            "wrote {} files to {}",
            contents.len(),
            arguments.out.display()
        )],
    })
}
