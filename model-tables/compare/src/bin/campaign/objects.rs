//! Campaigns of what touches: the band of an unknown object, the cost of a ball.

use crate::{grasp_each, without_object};
use clap::Args;
use compare::campaign::blends::{self, page};
use compare::campaign::object_cost;
use compare::campaign::objects::{self, BandTally, ObjectWorld};
use model_tables::design_file::DesignFile;
use model_tables::generate;
use output::{Refusal, files};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct ObjectArguments {
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

/// Whether 99 % of the objects lay in the band, of the plate's tables and of those for an unknown object.
pub(super) fn judge_objects(arguments: &ObjectArguments) -> Result<bool, Box<dyn Error>> {
    let design = without_object(&arguments.design, "presses objects of its own")?;
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

#[derive(Debug, Args)]
pub(super) struct CostArguments {
    /// Sweeps of each object, in turn; the fastest counts
    #[arg(long, default_value_t = 15)]
    sweeps: usize,
    /// Designs; repeatable
    #[arg(
        long,
        value_name = "FILE",
        default_values = [
            "model-tables/designs/index-fingertip-elastic.toml",
            "model-tables/designs/paper-prestretched.toml",
            "model-tables/designs/skin-analogue.toml",
            "model-tables/designs/skin-light-touch.toml"
        ]
    )]
    design: Vec<PathBuf>,
}

/// A row for each object of each design, and the largest time over the plate's.
fn costs_of(designs: &[PathBuf], sweeps: usize) -> Result<(String, f64), Box<dyn Error>> {
    let mut rows = object_cost::HEAD.to_owned();
    let mut most = 0.0_f64;
    for file in designs {
        let design = DesignFile::read(file)?;
        for costs in object_cost::measure_both(&design, sweeps)? {
            for line in costs.to_string().lines() {
                let _ = writeln!(rows, "| {} {line}", design.name);
            }
            most = most.max(costs.largest()[2]);
        }
    }
    Ok((rows, most))
}

/// Whether no ball takes more than 1.3 times the time of the plate.
pub(super) fn cost_of_balls(arguments: &CostArguments) -> Result<bool, Box<dyn Error>> {
    let (rows, most) = costs_of(&arguments.design, arguments.sweeps)?;
    println!("{rows}\nLargest time over the plate's: {most:.2}.");
    Ok(most <= 1.3)
}

#[derive(Debug, Args)]
pub(super) struct BlendArguments {
    /// Folder for the page and its chart; without it the tables are printed
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    cost: CostArguments,
}

/// The page; whether the chip's blend is within 2.5 % on every dome.
pub(super) fn blends_of_tables(arguments: &BlendArguments) -> Result<bool, Box<dyn Error>> {
    let mut domes = Vec::new();
    for (name, size, material) in blends::DOMES {
        eprintln!("{name}");
        domes.push(blends::measure(name, &blends::dome(size, material)?)?);
    }
    let kept = domes
        .iter()
        .all(|dome| dome.worst(blends::BlendWay::TwoWeights).0.largest() <= 2.5);
    let Some(out) = &arguments.out else {
        println!("{}", page::ways(&domes[0]));
        for dome in &domes {
            print!("{}", page::row(dome));
        }
        return Ok(kept);
    };
    let (costs, _) = costs_of(&arguments.cost.design, arguments.cost.sweeps)?;
    let pages = [
        ("OBJECTS.md", page::markdown(&domes, &costs).into_bytes()),
        (page::CHART, page::svg(&domes[0]).into_bytes()),
    ];
    let out: &Path = out;
    files::expect_folder(out, &pages.each_ref().map(|page| page.0)).map_err(|Refusal(reason)| reason)?;
    files::write_all(out, &pages).map_err(|Refusal(reason)| reason)?;
    Ok(kept)
}

#[derive(Debug, Args)]
pub(super) struct PlateArguments {
    /// Scenes of two grasps, each solved in time once
    #[arg(long, default_value_t = 24)]
    scenes: u64,
    /// Zeros and noises of each scene, half of them of an absolute part
    #[arg(long, default_value_t = 2)]
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

/// A table for each design; whether the solid found the states of most scenes.
pub(super) fn plates(arguments: &PlateArguments) -> Result<bool, Box<dyn Error>> {
    grasp_each(
        &arguments.design,
        "grasps plates",
        |tip| {
            tip.run_plates(arguments.seed, arguments.scenes, arguments.worlds, |done| {
                eprint!("\r{done} of {} scenes", arguments.scenes);
            })
        },
        |tally| arguments.scenes > 2 * tally.unsolved,
    )
}
