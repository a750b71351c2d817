//! `designer calibration`: what a calibration gains, on stand-ins for a device, and the page about it.

use super::published::quoted::{FORCES, INDENTATIONS};
use super::published::solid::SOLID;
use crate::fit::data::{Data, DataChoice};
use crate::fit::findings;
use crate::fit::parameter::Parameter;
use crate::fit::{self, DataQuantity, Fit};
use crate::size;
use crate::size::target::Target;
use model_tables::design_file::DesignFile;
use output::files;
use output::rows::{Cell, Rows, significant};
use output::{CommandAnswer, Refusal};
use std::fmt::Write as _;
use std::path::PathBuf;

const COLUMNS: &[&str] = &[
    "case",
    "force_rms_before_n",
    "force_rms_after_n",
    "pressure_rms_before_kpa",
    "pressure_rms_after_kpa",
];

/// The membrane that stands in best for the printed index fingertip.
const STAND_IN: &str = include_str!("stand-in.toml");
const PAPER: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../designs/paper-prestretched.toml"
));
const HUMAN: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../targets/human-fingertip.toml"
));

/// The stand-in as it is drawn, solved as a solid.
const DOME: &str = "name = \"dome\"\n[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n\
                    [material]\npreset = \"agilus30\"\n[model]\nkind = \"solid\"\n";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The page to write (Markdown)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// One fit of the page.
struct Case {
    name: &'static str,
    fit: Fit,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    use Parameter::{
        Compliance, IndentationOffset, Material, PoleStretch, PressureGain, PressureOffset, Thickness,
    };
    if let Some(out) = &arguments.out {
        files::expect_room(out)?;
    }
    let dome = dome_data();
    let case = |name: &'static str, text: &str, data: &Data, chosen: &[Parameter]| -> Result<Case, Refusal> {
        let file = DesignFile::parse(text, name).map_err(Refusal::of)?;
        let fit = fit::fit(&file, data, chosen).map_err(|error| Refusal(format!("{name}: {error}")))?;
        Ok(Case { name, fit })
    };
    let everything = [
        Material,
        Thickness,
        PoleStretch,
        Compliance,
        PressureGain,
        PressureOffset,
        IndentationOffset,
    ];
    let domes = [
        case("membrane, usual parameters", STAND_IN, &dome, &Parameter::USUAL)?,
        case("membrane, every parameter", STAND_IN, &dome, &everything)?,
        case("solid, modulus alone", DOME, &dome, &[Material])?,
    ];
    let paper_data = paper_data();
    let papers = [
        case("modulus alone", PAPER, &paper_data, &[Material])?,
        case(
            "modulus and stretch",
            PAPER,
            &paper_data,
            &[Material, PoleStretch],
        )?,
        case("usual parameters", PAPER, &paper_data, &Parameter::USUAL)?,
    ];
    let mut notes = Vec::new();
    if let Some(out) = &arguments.out {
        let target = Target::parse(HUMAN, "human-fingertip.toml").map_err(Refusal::of)?;
        let page = page(&domes, &papers, &paper_data, &target);
        files::write_one(out, page.into_bytes())?;
        notes.push(format!("wrote {}", out.display()));
    }
    let mut rows = Rows::new(COLUMNS);
    for case in domes.iter().chain(&papers) {
        let rms = |of: &[Option<fit::check::Misfit>; 2], k: usize, factor: f64| {
            of[k].map_or(Cell::word(""), |misfit| Cell::Number(factor * misfit.rms))
        };
        rows.push(vec![
            Cell::word(case.name),
            rms(&case.fit.before, 0, 1.0),
            rms(&case.fit.after, 0, 1.0),
            rms(&case.fit.before, 1, 1e-3),
            rms(&case.fit.after, 1, 1e-3),
        ]);
    }
    Ok(CommandAnswer { rows, notes })
}

/// The solid dome as a bench would have measured it.
fn dome_data() -> Data {
    let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
    for state in SOLID {
        let _ = writeln!(
            text,
            "{},{},{}",
            1e3 * state.indentation,
            state.force,
            1e-3 * state.pressure
        );
    }
    Data::parse(&text, "solid finite elements", &DataChoice::default())
        .expect("published numbers are good data")
}

/// The source paper's own points.
fn paper_data() -> Data {
    let mut text = String::from("indentation_mm,force_n\n");
    for (depth, force) in INDENTATIONS.iter().zip(FORCES) {
        let _ = writeln!(text, "{},{force}", 1e3 * depth);
    }
    Data::parse(&text, "the paper's points", &DataChoice::default()).expect("published numbers are good data")
}

fn number(value: f64) -> String {
    significant(value, 3)
}

fn percent(fitted: f64, measured: f64) -> String {
    let off = 100.0 * (fitted / measured - 1.0);
    format!("{off:+.1}")
}

/// The residuals of one quantity, in the order of the data.
fn of(fit: &Fit, quantity: DataQuantity) -> Vec<&fit::Residual> {
    fit.residuals
        .iter()
        .filter(|residual| residual.quantity == quantity)
        .collect()
}

fn page(domes: &[Case; 3], papers: &[Case; 3], paper_data: &Data, target: &Target) -> String {
    let mut text = String::from(
        "# What a calibration gains\n\n\
         Written by `cargo designer calibration --out model-tables/CALIBRATION.md`; a test fails when it is stale.\n\n\
         ## A stand-in for a device: a real dome of 1 mm\n\n\
         The solid finite elements of `PUBLISHED.md` (9 x 7 mm outside, wall 1 mm, Agilus30, not stretched, rigid fluid) as if \
         a bench had measured them, and the membrane that stands in best for it (mid-surface 8.5 x 6.5 mm, pole stretch 1.02) fitted \
         to them: with the usual parameters (modulus, stretch at rest, compliance) and with all. Numbers are deviations from the bench in percent of reading.\n\n\
         | H, mm | F, N | as drawn | usual | every | rise, kPa | as drawn | usual | every |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    let [usual, every, solid] = domes;
    for (i, state) in SOLID.iter().enumerate() {
        let _ = write!(text, "| {}", number(1e3 * state.indentation));
        for (quantity, unit) in [(DataQuantity::Force, 1.0), (DataQuantity::Rise, 1e-3)] {
            let residual = |case: &Case| *of(&case.fit, quantity)[i];
            let drawn = residual(usual);
            let _ = write!(
                text,
                " | {} | {}",
                number(unit * drawn.measured),
                percent(drawn.before, drawn.measured)
            );
            for case in [usual, every] {
                let residual = residual(case);
                let _ = write!(text, " | {}", percent(residual.fitted, residual.measured));
            }
        }
        text.push_str(" |\n");
    }
    text.push_str("\n| fit | parameter | drawn | fitted | standard error |\n|---|---|---|---|---|\n");
    for case in [usual, every] {
        for estimate in &case.fit.estimates {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} |",
                case.name,
                estimate.parameter,
                number(estimate.start),
                if estimate.held.is_some() {
                    findings::state(estimate.held).to_owned()
                } else {
                    number(estimate.value)
                },
                estimate
                    .standard_error
                    .map_or_else(|| "-".to_owned(), |error| significant(error, 1)),
            );
        }
    }
    let worst = solid
        .fit
        .residuals
        .iter()
        .map(|residual| 100.0 * (residual.fitted / residual.measured - 1.0).abs())
        .fold(0.0, f64::max);
    let _ = writeln!(
        text,
        "\nThe same dome solved as a solid, as drawn (`[model] kind = \"solid\"`), needs no calibration: with its modulus \
         fitted (a factor of {:.2}) force and pressure rise stay within {:.0} % of reading everywhere.",
        solid.fit.values.get(Parameter::Material),
        libm::ceil(worst)
    );
    text.push_str(
        "\nA membrane can be fitted to a wall that bends, but only with values that the device does not have: the data were \
        made with the modulus as drawn, no stretch, no compliance and no offset. Such a calibration is valid inside the range \
        of its data, and for no other depth or dome. The standard errors do not include this model error, only noise. Modulus \
        and wall thickness have the same effect on a membrane, so the wall is held.\n\n",
    );
    text.push_str(SURENESS);
    text.push_str(&paper_section(papers, paper_data));
    text.push_str(&size_section(target));
    text
}

/// Too long for a test, which runs fewer repeats against the same nominal shares.
const SURENESS: &str = "## How sure the standard errors are, and how long it takes\n\n\
    If the model is right and noise is the only error, the standard errors are correct. Over 200 synthetic benches (25 rows, 1 % noise, the usual \
    parameters) the truth lies within one standard error of the modulus in 68 %, of the stretch in 64 %, of the compliance in 70 % \
    of them (nominal are 68 %, and 7 % either way is chance), and within two in 95, 95 and 97 % (nominal 95 %). `FIT_REPEATS=200 cargo test --release -p designer \
    --test fit standard_errors -- --nocapture` repeats that. Such a fit takes half a second of one core, and the search below 7 s; \
    both commands print how long they took.\n\n";

fn paper_section(papers: &[Case; 3], data: &Data) -> String {
    let mut text = String::from(
        "## The source paper's own points\n\n\
         `designs/paper-prestretched.toml` fitted to the three published forces. Forces in newtons.\n\n\
         | H, mm | published | as drawn | modulus alone | modulus and stretch | usual parameters |\n|---|---|---|---|---|---|\n",
    );
    for (i, row) in data.rows.iter().enumerate() {
        let residuals = papers
            .each_ref()
            .map(|case| of(&case.fit, DataQuantity::Force)[i]);
        let _ = write!(
            text,
            "| {} | {} | {}",
            number(1e3 * row.indentation.unwrap_or_default()),
            residuals[0].measured,
            number(residuals[0].before)
        );
        for residual in residuals {
            let _ = write!(text, " | {}", number(residual.fitted));
        }
        text.push_str(" |\n");
    }
    let exponent = |a: f64, b: f64, from: f64, to: f64| libm::log(b / a) / libm::log(to / from);
    let forces = of(&papers[0].fit, DataQuantity::Force);
    let of_model = exponent(
        forces[1].fitted,
        forces[2].fitted,
        INDENTATIONS[1],
        INDENTATIONS[2],
    );
    let of_paper = exponent(FORCES[1], FORCES[2], INDENTATIONS[1], INDENTATIONS[2]);
    let held: Vec<String> = papers[2]
        .fit
        .unidentified
        .iter()
        .map(|found| found.held.to_string())
        .collect();
    let _ = writeln!(
        text,
        "\nThe size of the forces can be explained, by a modulus of {} times that of Agilus30; their shape cannot. From 1.5 to \
         2 mm the published force grows as the {}-th power of the indentation, and this membrane's as the {}-th; no modulus, \
         stretch or compliance brings the two together. Three forces tell one parameter: of the usual ones the fit holds {}.\n",
        number(papers[0].fit.values.get(Parameter::Material)),
        number(of_paper),
        number(of_model),
        held.join(" and "),
    );
    text
}

fn size_section(target: &Target) -> String {
    let mut text = String::from(
        "## A membrane that feels like a human fingertip\n\n\
         `cargo designer size model-tables/targets/human-fingertip.toml`: 0.32 N at 0.5 mm and 1.94 N at 2 mm. The last \
         column is what 0.1 mm of tolerance in each dimension does to the force.\n\n\
         | material | semi-axes, mm | wall, mm | stretch | misfit, % | peak pressure, kPa | force by tolerance, % |\n\
         |---|---|---|---|---|---|---|\n",
    );
    let mut told: Vec<&str> = Vec::new();
    for sized in size::size(target, &|_| ()).designs {
        if told.contains(&sized.material.name) {
            continue;
        }
        told.push(sized.material.name);
        let membrane = &sized.design.membrane;
        let digits = |value: f64| significant(value, 2);
        let model_tables::design::RestBy::PoleStretch(stretch) = sized.design.rest else {
            continue;
        };
        let _ = writeln!(
            text,
            "| {} | {} x {} | {} | {:.2} | {:.1} | {} | {} |",
            sized.material.title,
            digits(1e3 * membrane.radial_semi_axis),
            digits(1e3 * membrane.axial_semi_axis),
            digits(1e3 * membrane.thickness),
            stretch,
            100.0 * sized.misfit,
            digits(1e-3 * sized.peak_pressure),
            digits(100.0 * sized.making()),
        );
    }
    text
}
