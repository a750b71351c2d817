//! `cargo campaign designs`: random membranes.

use clap::Args;
use compare::campaign::draw::Case;
use compare::campaign::judge::{Judged, Verdict};
use compare::campaign::{self, Tally};
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use output::{Refusal, files};
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
pub(super) struct MembraneArguments {
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

/// Whether no state was wrong.
pub(super) fn designs(arguments: &MembraneArguments) -> Result<bool, Box<dyn Error>> {
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
