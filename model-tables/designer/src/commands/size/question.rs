//! The buyer's question of `designer size`: from its file or from options to designs with their transducers.

use crate::commands::bench;
use crate::commands::numbers::finite;
use crate::size::question::SizingQuestion;
use crate::size::question::catalogue::{self, CataloguePart, MEDIA};
use crate::size::question::judge::{SizedTip, judge_best};
use crate::size::question::presses::{self, SearchedTips};
use output::progress::Progress;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal, files};
use std::path::{Path, PathBuf};
use std::time::Instant;

const COLUMNS: &[&str] = &[
    "rank",
    "transducer",
    "material",
    "radial_semi_axis_mm",
    "axial_semi_axis_mm",
    "thickness_mm",
    "lightest_touch_n",
    "lightest_touch_pa",
    "transducer_step_n",
    "weather_n",
    "readings_per_second",
    "greatest_force_n",
    "indentation_mm",
    "peak_pressure_kpa",
    "range_kpa",
    "share_of_tested_strain",
    "force_percent_for_thickness_tolerance",
    "model",
    "table_bytes",
    "accuracy_percent",
];
/// Number of designs for a job without `--best`.
const BEST: usize = 3;
/// Share of the search in the progress.
const SEARCH: f64 = 0.4;

/// The job in options, in place of a file.
#[derive(Debug, clap::Args)]
pub(super) struct Words {
    /// Lightest touch to detect, newtons
    #[arg(long, value_name = "N", value_parser = finite, requires = "greatest_force_n", conflicts_with = "target")]
    lightest_touch_n: Option<f64>,
    /// Greatest force to measure, newtons
    #[arg(long, value_name = "N", value_parser = finite, requires = "lightest_touch_n", conflicts_with = "target")]
    greatest_force_n: Option<f64>,
    /// Readings per second
    #[arg(long, value_name = "RATE", value_parser = finite, requires = "lightest_touch_n", default_value_t = 1.0)]
    readings_per_second: f64,
    /// Duration of a grasp, seconds
    #[arg(long, value_name = "S", value_parser = finite, requires = "lightest_touch_n", default_value_t = 1.0)]
    grasp_s: f64,
    /// Medium at the transducer: air, oil or water [default: any of them]
    #[arg(long, value_name = "MEDIUM", requires = "lightest_touch_n", value_parser = MEDIA)]
    filling: Option<String>,
    /// Radius of the grasped ball, millimetres [default: a plate]
    #[arg(long, value_name = "MM", value_parser = finite, requires = "lightest_touch_n")]
    object_radius_mm: Option<f64>,
    /// Largest outer diameter of the tip, millimetres
    #[arg(long, value_name = "MM", value_parser = finite, requires = "lightest_touch_n", default_value_t = 18.0)]
    diameter_mm: f64,
    /// Largest height of the tip, millimetres
    #[arg(long, value_name = "MM", value_parser = finite, requires = "lightest_touch_n", default_value_t = 9.0)]
    height_mm: f64,
}

impl Words {
    /// The job; `None` if the options state none.
    pub(super) fn question(&self) -> Result<Option<SizingQuestion>, Refusal> {
        let (Some(lightest), Some(greatest)) = (self.lightest_touch_n, self.greatest_force_n) else {
            return Ok(None);
        };
        for (option, value, most) in [
            ("lightest-touch-n", lightest, 1e4),
            ("greatest-force-n", greatest, 1e4),
            ("readings-per-second", self.readings_per_second, 1e6),
            ("grasp-s", self.grasp_s, 86_400.0),
            ("object-radius-mm", self.object_radius_mm.unwrap_or(1.0), 1e6),
            ("diameter-mm", self.diameter_mm, 200.0),
            ("height-mm", self.height_mm, 200.0),
        ] {
            if !(value > 0.0 && value <= most) {
                return Err(Refusal(format!(
                    "--{option} {value} is not possible: it must be a number above 0 and at most {most}"
                )));
            }
        }
        if greatest <= lightest {
            return Err(Refusal(format!(
                "--greatest-force-n {greatest} is not possible: it must be more than --lightest-touch-n, {lightest}"
            )));
        }
        Ok(Some(SizingQuestion {
            rate: self.readings_per_second,
            grasp_s: self.grasp_s,
            filling: self.filling.clone(),
            radius_mm: self.object_radius_mm,
            space_mm: [self.diameter_mm, self.height_mm],
            ..SizingQuestion::new(lightest, greatest)
        }))
    }
}

/// What the search is asked, and where its answer goes.
pub(super) struct Asked<'a> {
    pub(super) question: SizingQuestion,
    pub(super) transducers: Option<&'a PathBuf>,
    pub(super) best: Option<u16>,
    pub(super) out: Option<&'a PathBuf>,
}

pub(super) fn run(asked: Asked<'_>) -> Result<CommandAnswer, Refusal> {
    let Asked {
        question,
        transducers,
        best,
        out,
    } = asked;
    if let Some(out) = out {
        files::expect_folder(out, &[&format!("{}-1.toml", question.name)])?;
    }
    let (file, parts) = match transducers {
        None => (
            Path::new("transducers.toml"),
            catalogue::parse(catalogue::SHIPPED, "transducers.toml").map_err(Refusal::of)?,
        ),
        Some(file) => {
            files::keep(file);
            (file.as_path(), catalogue::read(file).map_err(Refusal::of)?)
        }
    };
    let fit = fit(&question, &parts, file)?;
    let begun = Instant::now();
    let progress = Progress::new("sizing");
    let found = presses::search(&question, &fit, &|part| progress.set(SEARCH * part));
    reaches(&question, &fit, &found)?;
    let best = best.map_or(BEST, usize::from);
    let (met, refused) = judge_best(&question, &found.reaching, best, &|part| {
        progress.set(SEARCH + (1.0 - SEARCH) * part);
    });
    progress.finish();
    if met.is_empty() {
        return Err(Refusal(format!(
            "no design meets the question when it is solved by the model that its wall needs: {}; allow more space, or ask for less",
            refused.first().map_or("none is left", String::as_str)
        )));
    }
    let mut rows = Rows::new(COLUMNS);
    for (rank, design) in met.iter().enumerate() {
        rows.push(row(rank + 1, design));
    }
    let mut notes = notes(&question, &met, &found, begun);
    notes.extend(refused.iter().map(|reason| format!("left out: {reason}")));
    if let Some(out) = out {
        let contents: Vec<(String, Vec<u8>)> = met
            .iter()
            .enumerate()
            .map(|(rank, design)| {
                let name = format!("{}-{}", question.name, rank + 1);
                let named = format!("name = \"{name}\"");
                let text = design
                    .text
                    .replacen(&format!("name = \"{}\"", question.name), &named, 1);
                (format!("{name}.toml"), text.into_bytes())
            })
            .collect();
        files::write_all(out, &contents)?;
        notes.push(format!("wrote {} designs to {}", met.len(), out.display()));
    }
    Ok(CommandAnswer { rows, notes })
}

/// The parts that fit the question; a refusal with every reason where there is none.
fn fit<'a>(
    question: &SizingQuestion,
    parts: &'a [CataloguePart],
    file: &Path,
) -> Result<Vec<&'a CataloguePart>, Refusal> {
    if let Some(unknown) = question
        .parts
        .iter()
        .find(|name| parts.iter().all(|part| part.name != **name))
    {
        let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
        return Err(Refusal::about(
            file,
            &format_args!(
                "no transducer is called {unknown:?}; there are {}",
                names.join(", ")
            ),
        ));
    }
    let fit: Vec<&CataloguePart> = parts
        .iter()
        .filter(|part| question.unfit(part).is_none())
        .collect();
    if fit.is_empty() {
        let reasons: Vec<String> = parts
            .iter()
            .filter_map(|part| Some(format!("{}: {}", part.name, question.unfit(part)?)))
            .collect();
        let filling = question
            .filling
            .as_ref()
            .map_or(String::new(), |filling| format!(" in {filling}"));
        return Err(Refusal::about(
            file,
            &format_args!(
                "no transducer gives {} readings a second{filling} ({}): ask for fewer, or for another filling",
                question.rate,
                reasons.join("; ")
            ),
        ));
    }
    Ok(fit)
}

/// Refuses a question that no candidate meets, by the nearest that one does.
fn reaches(
    question: &SizingQuestion,
    fit: &[&CataloguePart],
    found: &SearchedTips<'_>,
) -> Result<(), Refusal> {
    let [diameter, height] = question.space_mm;
    let parts = fit.len();
    match found.reaching.first() {
        None if found.greatest < question.greatest_n => Err(Refusal(format!(
            "no design reads {} N: within {diameter} x {height} mm and the ranges of {parts} transducers the greatest force is {:.2} N; \
             ask for that, or allow more space",
            question.greatest_n, found.greatest
        ))),
        None => Err(Refusal(format!(
            "no design reads {} N with its material within the strain that it was tested in; allow more space than {diameter} x {height} mm, \
             or other materials",
            question.greatest_n
        ))),
        Some(nearest) if nearest.touch > question.lightest_n => Err(Refusal(format!(
            "no design tells {} N and reads {} N: the lightest touch of those that read it is {:.4} N ({}, {:.2} x {:.2} x {:.2} mm, {}); \
             ask for that, or for less force, or allow another filling or space",
            question.lightest_n,
            question.greatest_n,
            nearest.touch,
            nearest.material.title,
            1e3 * nearest.membrane.radial_semi_axis,
            1e3 * nearest.membrane.axial_semi_axis,
            1e3 * nearest.membrane.thickness,
            nearest.part.name,
        ))),
        Some(_) => Ok(()),
    }
}

fn notes(
    question: &SizingQuestion,
    met: &[SizedTip<'_>],
    found: &SearchedTips<'_>,
    begun: Instant,
) -> Vec<String> {
    let best = &met[0];
    let part = best.candidate.part;
    let mut notes = vec![
        format!(
            "{} designs meet {} to {} N, {} readings a second, in {} x {} mm; the best tells {:.4} N, at {:.0} Pa, and reads {} N at {:.2} kPa of \
             {} kPa",
            met.len(),
            question.lightest_n,
            question.greatest_n,
            question.rate,
            question.space_mm[0],
            question.space_mm[1],
            best.lightest_n,
            best.lightest_pa,
            question.greatest_n,
            1e-3 * best.greatest_pa,
            1e-3 * part.highest(),
        ),
        format!(
            "{} presses of a coarse solid, the designs by the model that each wall needs, in {:.1} s",
            found.solved,
            begun.elapsed().as_secs_f64()
        ),
    ];
    if let Some(error) = best.generated.own_error() {
        notes.push(format!("the best: {error}"));
    }
    if let Some(percent) = best.by_tolerance {
        notes.push(format!(
            "a wall that is {} mm thicker changes the force at one pressure by up to {:.1} %: a calibration has to take that out",
            question.making_mm[0],
            100.0 * percent
        ));
    }
    let mut told: Vec<&str> = Vec::new();
    for design in met {
        let part = design.candidate.part;
        if !told.contains(&part.name.as_str()) {
            told.push(&part.name);
            notes.push(format!(
                "{}: {} ({}); for {}; noise {} Pa, {}",
                part.name,
                part.title,
                part.datasheet,
                part.media.join(", "),
                part.section.noise_pa,
                part.noise_from
            ));
        }
        let material = design.candidate.material;
        if !told.contains(&material.name) {
            told.push(material.name);
            notes.push(bench::about(material));
        }
    }
    notes
}

fn row(rank: usize, met: &SizedTip<'_>) -> Vec<Cell> {
    let candidate = &met.candidate;
    let membrane = &candidate.membrane;
    let optional = |value: Option<f64>| value.map_or_else(|| Cell::word("not known"), Cell::Number);
    let [accuracy, _] = met.generated.asked_percent();
    vec![
        Cell::Count(rank),
        Cell::Text(candidate.part.name.clone()),
        Cell::word(candidate.material.name),
        Cell::Number(1e3 * membrane.radial_semi_axis),
        Cell::Number(1e3 * membrane.axial_semi_axis),
        Cell::Number(1e3 * membrane.thickness),
        Cell::Number(met.lightest_n),
        Cell::Number(met.lightest_pa),
        Cell::Number(met.step_n),
        Cell::Number(met.weather_n),
        Cell::Number(candidate.part.rate()),
        Cell::Number(met.end_n),
        Cell::Number(1e3 * met.deepest),
        Cell::Number(1e-3 * met.greatest_pa),
        Cell::Number(1e-3 * candidate.part.highest()),
        optional(candidate.strain_share),
        optional(met.by_tolerance.map(|part| 100.0 * part)),
        Cell::Text(
            met.generated
                .kind
                .map_or_else(String::new, |kind| kind.to_string()),
        ),
        Cell::Count(met.generated.certified.tables.bytes()),
        Cell::Number(accuracy),
    ]
}
