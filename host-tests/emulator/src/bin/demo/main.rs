//! `cargo demo`: the real image on an emulated board feels a press, beside the truth.
#![forbid(unsafe_code)]

mod live;
mod options;
mod say;
mod summary;

use emulator::bench;
use emulator::chart::{self, Caption};
use emulator::fingertip_design::FingertipDesign;
use emulator::image::Image;
use emulator::output::{self, Output};
use emulator::record::{Recorder, write_csv};
use emulator::scenario::Scenario;
use emulator::serve::Server;
use options::Options;
use say::say;
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Largest median error that the reports may have, percent of reading.
const TARGET_PERCENT: f64 = 0.5;

/// Exit status after an interrupt, as shells have it: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    // Whoever interrupts it finds no half-written files.
    if let Err(error) = ctrlc::set_handler(|| {
        output::abandon();
        std::process::exit(INTERRUPTED);
    }) {
        eprintln!("note: an interrupt will leave files behind ({error})");
    }
    let outcome = match options::parse() {
        Ok(options) => match &options.serve {
            Some(address) => serve(&options, address),
            None => demo(&options),
        },
        Err(exit) => return exit,
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn demo(options: &Options) -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::named(&options.scenario)?;
    let design = FingertipDesign::read(&options.design(&scenario))?;
    let mut csv = Output::create(&options.csv)?;
    let mut svg = Output::create(&options.chart)?;

    say!(
        "1/3 building the firmware image for the NUCLEO-F429ZI and {} ...",
        design.name()
    );
    let image = Image::firmware(Some(&design.path))?;
    let truth = design.truth(&scenario);
    say!("2/3 the truth of {}: {truth} ...", design.name());
    let started = Instant::now();
    let plant = design.plant(scenario.clone())?;
    say!("    in {:.1} s", started.elapsed().as_secs_f64());
    say!(
        "3/3 running the image on the emulated STM32F427: {} ({:.1} s)",
        options.scenario,
        scenario.duration()
    );
    say!("    {}\n", scenario.about);

    let started = Instant::now();
    let table = live::Table::new(scenario.clone(), plant.feedback_truth(0.0).is_some());
    let outcome = bench::run(
        &image,
        plant.clone(),
        scenario.duration(),
        &[],
        Recorder::new(table.into_printer()),
    )?;
    let wall = started.elapsed().as_secs_f64();
    let (time, instructions) = (outcome.time, outcome.instructions);
    let (resets, gaps) = (outcome.resets, outcome.gaps);
    let record = outcome.listener.into_record();
    if record.rows.is_empty() {
        return Err("the firmware sent no report".into());
    }

    let accuracy = emulator::accuracy::RunAccuracy::of(&record.rows, &plant);
    let caption = Caption {
        title: format!("{} on {}", options.scenario, design.name()),
        subtitle: format!(
            "{} readings; median error from 5 % of full scale up: force {:.3} %, indentation {:.3} % of reading",
            accuracy.readings,
            accuracy.force_median * 100.0,
            accuracy.indentation_median * 100.0
        ),
        full_scale: plant.full_scale(),
        static_tables: plant.timed().map(|_| plant.curve().clone()),
        target_percent: TARGET_PERCENT,
        truth: truth.words(),
    };
    write_csv(&record.rows, caption.static_tables.as_ref(), &mut csv)?;
    svg.write_all(chart::svg(&record.rows, &caption)?.as_bytes())?;
    let files: [PathBuf; 2] = [svg.finish()?, csv.finish()?];

    summary::print(&record, &plant, &accuracy);
    say!(
        "\n{time:.1} s on the chip ({:.0} instructions/ms) took {wall:.1} s",
        instructions as f64 / (time * 1e3)
    );
    for trouble in resets.iter().map(|reset| format!("reset: {reset}")).chain(gaps) {
        say!("note: {trouble}");
    }
    say!("chart   {}\nnumbers {}", files[0].display(), files[1].display());
    Ok(())
}

/// The board behind a socket, for ever.
fn serve(options: &Options, address: &str) -> Result<(), Box<dyn Error>> {
    let scenario = Scenario {
        repeats: true,
        ..Scenario::named(&options.scenario)?
    };
    let design = FingertipDesign::read(&options.design(&scenario))?;
    let server = Server::bind(address)
        .map_err(|error| format!("--serve {address}: {error}; take another HOST:PORT"))?;
    let address = server.address()?;
    say!(
        "building the firmware image for the NUCLEO-F429ZI and {} ...",
        design.name()
    );
    let image = Image::firmware(Some(&design.path))?;
    say!("the truth of {}: {} ...", design.name(), design.truth(&scenario));
    let plant = design.plant(scenario)?;
    say!(
        "serving {} at tcp:{address}, until Ctrl-C; watch it with",
        options.scenario
    );
    say!("    cargo designer monitor tcp:{address}");
    bench::run(&image, plant, f64::INFINITY, &[], server)?;
    Ok(())
}
