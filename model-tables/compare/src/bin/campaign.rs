//! `cargo campaign NAME`: long seeded campaigns, of which the tests run a small part.

use clap::{Args, Parser, Subcommand};
use compare::campaign::draw::Case;
use compare::campaign::grasps::GraspedTip;
use compare::campaign::judge::{Judged, Verdict};
use compare::campaign::lives::{self, tip};
use compare::campaign::objects::{self, BandTally, ObjectWorld};
use compare::campaign::{self, Tally, solids, walls};
use model_tables::design_file::DesignFile;
use model_tables::generate;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use output::{Refusal, files};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

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
    /// Grasps random objects in time, through the firmware's own signal path
    #[command(after_help = "Example:\n  cargo campaign grasps --scenes 30 --worlds 4 --seed 2026")]
    Grasps(GraspArguments),
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
struct ObjectArguments {
    /// Objects to draw
    #[arg(long, default_value_t = 2000)]
    objects: u64,
    /// What the draw depends on
    #[arg(long, default_value_t = 2026)]
    seed: u64,
    /// A design without `[object]`
    #[arg(
        long,
        value_name = "FILE",
        default_value = "model-tables/designs/index-fingertip-elastic.toml"
    )]
    design: PathBuf,
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

#[derive(Debug, Args)]
struct MembraneArguments {
    /// Designs to draw; each is pressed to 8 indentations
    #[arg(long, default_value_t = 10_000)]
    designs: u64,
    /// What the draw depends on
    #[arg(long, default_value_t = 2026)]
    seed: u64,
    /// Only this design of the draw, with a line for each of its states; repeatable
    #[arg(long, value_name = "N")]
    design: Vec<u64>,
    /// Print one row per state
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

const COLUMNS: [&str; 23] = [
    "design",
    "aspect",
    "pole_stretch",
    "law",
    "c2_over_c1",
    "c3_over_c1",
    "radial_semi_axis_mm",
    "thickness_mm",
    "c1_pa",
    "compliance",
    "tension_field",
    "part_of_limit",
    "verdict",
    "reason",
    "work_error",
    "work_rounding",
    "second_error",
    "margin",
    "indentation_mm",
    "pressure_kpa",
    "force_n",
    "wrinkled",
    "message",
];

fn row(case: &Case, judged: &Judged) -> Vec<String> {
    let membrane = &case.design.membrane;
    let (law, c1, c2, c3) = match case.design.law {
        Law::NeoHookean { c1 } => ("neo-hookean", c1, 0.0, 0.0),
        Law::MooneyRivlin { c1, c2 } => ("mooney-rivlin", c1, c2, 0.0),
        Law::Yeoh { c1, c2, c3 } => ("yeoh", c1, c2, c3),
    };
    let field = match case.tension_field {
        TensionField::Relaxed => "relaxed",
        TensionField::Plain => "plain",
    };
    let (verdict, reason) = match judged.verdict {
        Verdict::Converged => ("converged", ""),
        Verdict::Warned(judge) => ("warned", judge.unwrap_or_default()),
        Verdict::Refused(reason) => ("refused", reason),
        Verdict::Wrong(judge) => ("wrong", judge),
    };
    let of = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    let state = judged.state.as_ref();
    vec![
        case.index.to_string(),
        (membrane.axial_semi_axis / membrane.radial_semi_axis).to_string(),
        case.pole_stretch.to_string(),
        law.to_owned(),
        (c2 / c1).to_string(),
        (c3 / c1).to_string(),
        (membrane.radial_semi_axis * 1e3).to_string(),
        (membrane.thickness * 1e3).to_string(),
        c1.to_string(),
        case.compliance.to_string(),
        field.to_owned(),
        judged.part.to_string(),
        verdict.to_owned(),
        reason.to_owned(),
        format!("{:e}", judged.work_error),
        format!("{:e}", judged.work_rounding),
        format!("{:e}", judged.second_error),
        judged.margin.to_string(),
        of(state.map(|s| s.indentation * 1e3)),
        of(state.map(|s| s.shape.pressure * 1e-3)),
        of(state.map(|s| s.force)),
        state.map_or("", |s| s.shape.wrinkling.word()).to_owned(),
        judged.message.clone(),
    ]
}

fn main() -> ExitCode {
    let kept = match Arguments::parse().campaign {
        Campaign::Designs(arguments) => designs(&arguments),
        Campaign::Walls(arguments) => Ok(judge_walls(&arguments)),
        Campaign::Solids(arguments) => Ok(judge_solids(&arguments)),
        Campaign::Lives(arguments) => Ok(judge_lives(&arguments)),
        Campaign::Objects(arguments) => judge_objects(&arguments),
        Campaign::Grasps(arguments) => judge_grasps(&arguments),
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

/// Whether 99 % of the objects lay in the band, of the plate's tables and of those for an unknown object.
fn judge_objects(arguments: &ObjectArguments) -> Result<bool, Box<dyn Error>> {
    let design = DesignFile::read(&arguments.design)?;
    if design.object.is_some() {
        return Err(format!(
            "{}: [object] is given: leave it out, the campaign presses objects of its own",
            arguments.design.display()
        )
        .into());
    }
    let world = ObjectWorld::solve(&design, |done| eprint!("\r{} balls solved", done + 1))?;
    eprintln!();
    let mut kept = true;
    for design in [design.clone(), objects::with_unknown(&design)] {
        let generated = generate::from_design(design)?;
        let tally = BandTally::of(&generated, &world, arguments.seed, arguments.objects)
            .ok_or("the design states no band: a ball of 5 or of 20 mm has no press")?;
        if let Some(band) = &generated.band {
            println!("{band}");
            for row in &band.rows {
                println!(
                    "  {:>9.1} to {:>9.1} Pa: force {:+.1} to {:+.1} %, indentation {:+.1} to {:+.1} %",
                    row.from,
                    row.to,
                    row.force_percent[0],
                    row.force_percent[1],
                    row.indentation_percent[0],
                    row.indentation_percent[1]
                );
            }
        }
        println!("{tally}");
        for object in &tally.outside {
            println!("  outside: {object:?}");
        }
        kept &= tally.share() >= 0.99;
    }
    Ok(kept)
}

/// A table for each design; whether the solid found the states of most scenes.
fn judge_grasps(arguments: &GraspArguments) -> Result<bool, Box<dyn Error>> {
    let mut kept = true;
    for (number, file) in arguments.design.iter().enumerate() {
        let design = DesignFile::read(file)?;
        if design.object.is_some() {
            return Err(format!(
                "{}: [object] is given: leave it out, the campaign grasps objects of its own",
                file.display()
            )
            .into());
        }
        let tip = GraspedTip::new(&design, None)?;
        let tally = tip.run(arguments.seed, arguments.scenes, arguments.worlds, |done| {
            eprint!("\r{done} of {} scenes", arguments.scenes);
        });
        eprintln!();
        if number > 0 {
            println!();
        }
        print!("### {}\n\n{tally}", design.name);
        kept &= tally.scenes > tally.unsolved();
    }
    Ok(kept)
}

/// Whether no state was wrong.
fn designs(arguments: &MembraneArguments) -> Result<bool, Box<dyn Error>> {
    if let Some(file) = &arguments.csv {
        files::clear_away_on_interrupt();
        files::expect_room(file).map_err(|Refusal(reason)| reason)?;
    }
    let started = Instant::now();
    let chosen = |index: &u64| {
        let case = campaign::draw::case(arguments.seed, *index);
        eprintln!("{case:#?}");
        let judged = campaign::judge::judge(&case);
        for one in &judged {
            eprintln!(
                "{:.6} {:?} work {:.1e} ({:.1e}) second {:.1e} margin {:.3} {}",
                one.part,
                one.verdict,
                one.work_error,
                one.work_rounding,
                one.second_error,
                one.margin,
                one.message
            );
        }
        (case, judged)
    };
    let results = if arguments.design.is_empty() {
        campaign::run(arguments.seed, arguments.designs, |done| {
            if done % 200 == 0 || done == arguments.designs {
                eprint!("\r{done} of {} designs", arguments.designs);
            }
        })
    } else {
        arguments.design.iter().map(chosen).collect()
    };
    eprintln!();
    if let Some(file) = &arguments.csv {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS)?;
        for (case, judged) in &results {
            for judged in judged {
                writer.write_record(row(case, judged))?;
            }
        }
        files::write_one(file, writer.into_inner()?).map_err(|Refusal(reason)| reason)?;
    }
    let tally = Tally::of(results.iter().flat_map(|(_, judged)| judged));
    println!(
        "designs    {} in {:.1} s",
        results.len(),
        started.elapsed().as_secs_f64()
    );
    print!("{tally}");
    Ok(tally.wrong.is_empty())
}
