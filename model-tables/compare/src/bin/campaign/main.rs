//! `cargo campaign NAME`: long seeded campaigns, of which the tests run a small part.

mod designs;
mod objects;

use clap::{Args, Parser, Subcommand};
use compare::campaign::grasps::GraspedTip;
use compare::campaign::lives::{self, tip};
use compare::campaign::{solids, walls};
use designs::MembraneArguments;
use model_tables::design_file::DesignFile;
use objects::{BlendArguments, CostArguments, ObjectArguments, PlateArguments};
use std::error::Error;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Long seeded campaigns.
#[derive(Debug, Parser)]
#[command(name = "campaign")]
struct Arguments {
    #[command(subcommand)]
    campaign: Campaign,
}

#[derive(Debug, Subcommand)]
enum Campaign {
    /// Checks the states of random membranes by virtual work and a second discretisation
    #[command(after_help = "Example:\n  cargo campaign designs --designs 10000 --seed 2026")]
    Designs(MembraneArguments),
    /// Compares the model that `kind = "auto"` chooses for random walls with the refined solid
    #[command(after_help = "Example:\n  cargo campaign walls --designs 200 --seed 0")]
    Walls(DrawArguments),
    /// Solves random solids alone, in lists, by half steps and on finer meshes
    #[command(after_help = "Example:\n  cargo campaign solids --designs 2000 --seed 0")]
    Solids(DrawArguments),
    /// Runs random lives of fingertips through the signal path, with all effects that move a zero
    #[command(after_help = "Example:\n  cargo campaign lives --lives 5000 --days 50 --seed 2026")]
    Lives(LivesArguments),
    /// Presses random objects unknown to the chip, and checks the band that a design states
    #[command(after_help = "Example:\n  cargo campaign objects --objects 2000 --seed 2026")]
    Objects(ObjectArguments),
    /// Measures what a state onto a ball costs beside one onto a plate
    #[command(after_help = "Example:\n  cargo campaign cost --sweeps 15")]
    Cost(CostArguments),
    /// Compares the blend of tables of a plate and a ball with other ways to read a ball, on several domes
    #[command(after_help = "Example:\n  cargo campaign blends --out blends")]
    Blends(BlendArguments),
    /// Grasps random objects in time, through the firmware's own signal path
    #[command(after_help = "Example:\n  cargo campaign grasps --scenes 30 --worlds 4 --seed 2026")]
    Grasps(GraspArguments),
    /// Grasps plates in time that are tilted or rub, by quoted figures
    #[command(after_help = "Example:\n  cargo campaign plates --scenes 24 --worlds 2 --seed 2026")]
    Plates(PlateArguments),
}

#[derive(Debug, Args)]
struct GraspArguments {
    /// Scenes of two grasps, each solved in time once
    #[arg(long, default_value_t = 30)]
    scenes: u64,
    /// Zeros and noises of each scene, half of them of an absolute part
    #[arg(long, default_value_t = 4)]
    worlds: u64,
    /// What the draw depends on
    #[arg(long, default_value_t = 2026)]
    seed: u64,
    /// Designs that rest unstretched, without `[object]`; repeatable
    #[arg(
        long,
        value_name = "FILE",
        default_values = [
            "model-tables/designs/index-fingertip.toml",
            "model-tables/designs/index-fingertip-elastic.toml"
        ]
    )]
    design: Vec<PathBuf>,
}

#[derive(Debug, Args)]
struct LivesArguments {
    /// Lives of 1 to 10 minutes
    #[arg(long, default_value_t = 100)]
    lives: u64,
    /// Lives of 8 to 24 hours
    #[arg(long, default_value_t = 0)]
    days: u64,
    /// What the draw depends on
    #[arg(long, default_value_t = 2026)]
    seed: u64,
    /// Only the life of this number, of the short ones or, after them, of the long ones
    #[arg(long, value_name = "N")]
    life: Option<u64>,
    /// Absolute parts are also lifted while they are pressed, which breaks an assumption
    #[arg(long)]
    lift_while_pressed: bool,
}

#[derive(Debug, Args)]
struct DrawArguments {
    /// Designs to draw
    #[arg(long, default_value_t = 200)]
    designs: u64,
    /// Number of the first design; the draw depends only on it
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

fn main() -> ExitCode {
    let kept = match Arguments::parse().campaign {
        Campaign::Designs(arguments) => designs::designs(&arguments),
        Campaign::Walls(arguments) => Ok(judge_walls(&arguments)),
        Campaign::Solids(arguments) => Ok(judge_solids(&arguments)),
        Campaign::Lives(arguments) => Ok(judge_lives(&arguments)),
        Campaign::Objects(arguments) => objects::judge_objects(&arguments),
        Campaign::Cost(arguments) => objects::cost_of_balls(&arguments),
        Campaign::Blends(arguments) => objects::blends_of_tables(&arguments),
        Campaign::Grasps(arguments) => judge_grasps(&arguments),
        Campaign::Plates(arguments) => objects::plates(&arguments),
    };
    match kept {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether no error was let through that is larger than allowed.
fn judge_walls(arguments: &DrawArguments) -> bool {
    let mut worst = [0.0_f64; walls::ASKED.len()];
    let mut without = 0;
    for done in 0..arguments.designs {
        let wall = walls::draw(arguments.seed + done).measure();
        if wall.has_truth() {
            for (worst, asked) in worst.iter_mut().zip(walls::ASKED) {
                *worst = worst.max(wall.take(asked).error);
            }
        } else {
            without += 1;
        }
        eprint!("\r{} of {} walls", done + 1, arguments.designs);
    }
    eprintln!();
    println!(
        "walls      {}, {without} of them without a refined state",
        arguments.designs
    );
    let mut kept = true;
    for (worst, asked) in worst.iter().zip(walls::ASKED) {
        println!(
            "allowed    {:.3} %: {:.3} % let through",
            100.0 * asked,
            100.0 * worst
        );
        kept &= *worst <= asked;
    }
    kept
}

/// Whether no solid's answer depended on the way or was off by more than stated; a line for each that was.
fn judge_solids(arguments: &DrawArguments) -> bool {
    let mut counts = solids::SolidCounts::default();
    for done in 0..arguments.designs {
        let judged = solids::judge(arguments.seed + done);
        counts.add(&judged);
        let mut one = solids::SolidCounts::default();
        one.add(&judged);
        if !one.holds() {
            println!("{judged:?}");
        }
        eprint!("\r{} of {} solids", done + 1, arguments.designs);
    }
    eprintln!();
    print!("{counts}");
    counts.holds()
}

/// Whether no reading with status ok was wrong; a line for each life with one.
fn judge_lives(arguments: &LivesArguments) -> bool {
    let count = arguments.lives + arguments.days;
    let mut kinds = [lives::LivesTally::default(); tip::TRANSDUCERS.len()];
    for index in arguments.life.map_or(0..count, |life| life..life + 1) {
        let length = if index < arguments.lives {
            [60.0, 600.0]
        } else {
            [8.0 * 3_600.0, 24.0 * 3_600.0]
        };
        let mut life = lives::Life::draw(arguments.seed, index, length);
        life.lifted_while_pressed = arguments.lift_while_pressed;
        let tally = life.live();
        kinds[life.transducer].add(&tally);
        if tally.wrong > 0 {
            println!(
                "life {index}: {} wrong, by {:.1} Pa at most: {:?}",
                tally.wrong, tally.worst, tally.first_wrong
            );
        }
        eprint!("\r{} of {count} lives", index + 1);
    }
    eprintln!();
    println!(
        "| transducer | lives | resets | samples | ok, % | wrong | wrong where a sample was replaced | error over deviation: RMS | at most |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut all = lives::LivesTally::default();
    for ((name, _), tally) in tip::TRANSDUCERS.iter().zip(&kinds) {
        println!("| {name} | {tally}");
        all.add(tally);
    }
    println!("| all | {all}");
    all.wrong == all.replaced
}

/// A design of a file; `does` is what the campaign does with objects of its own.
fn without_object(file: &Path, does: &str) -> Result<DesignFile, Box<dyn Error>> {
    let design = DesignFile::read(file)?;
    if design.object.is_some() {
        return Err(format!(
            "{}: [object] is given: leave it out, the campaign {does}",
            file.display()
        )
        .into());
    }
    Ok(design)
}

/// A table for each design, of what `run` makes of it; whether each is kept.
fn grasp_each<T: Display>(
    files: &[PathBuf],
    does: &str,
    run: impl Fn(&GraspedTip) -> T,
    is_kept: impl Fn(&T) -> bool,
) -> Result<bool, Box<dyn Error>> {
    let mut kept = true;
    for (number, file) in files.iter().enumerate() {
        let design = without_object(file, does)?;
        let tally = run(&GraspedTip::new(&design, None)?);
        eprintln!();
        if number > 0 {
            println!();
        }
        print!("### {}\n\n{tally}", design.name);
        kept &= is_kept(&tally);
    }
    Ok(kept)
}

/// A table for each design; whether the solid found the states of most scenes.
fn judge_grasps(arguments: &GraspArguments) -> Result<bool, Box<dyn Error>> {
    grasp_each(
        &arguments.design,
        "grasps objects of its own",
        |tip| {
            tip.run(arguments.seed, arguments.scenes, arguments.worlds, |done| {
                eprint!("\r{done} of {} scenes", arguments.scenes);
            })
        },
        |tally| tally.scenes > tally.unsolved(),
    )
}
