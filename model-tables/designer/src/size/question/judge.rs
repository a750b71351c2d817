//! A candidate as a design file: solved by the model that its wall needs, with its tables, and what the chip reads of them.

use super::SizingQuestion;
use super::presses::{Candidate, coarse, lightest, stiffening};
use model_tables::curve::Curve;
use model_tables::design::Membrane;
use model_tables::design_file::DesignFile;
use model_tables::generate::{Generated, from_design_or_worse};
use model_tables::model::Fingertip;
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use rayon::prelude::*;
use std::fmt::Write as _;

/// How much deeper than the coarse solid's greatest force a design is pressed, in force.
const BEYOND: f64 = 1.03;
/// Accuracy of the tables that is asked first, percent of reading; what a part cannot tell is asked less of.
pub const ACCURACY: f64 = 1.0;
/// The same of tables with a ball's beside them: their blend is worth a few percent, and finer ones are searched for in vain for seconds.
const ACCURACY_OF_BLEND: f64 = 2.0;
/// Halvings of a pressure that is looked for.
const HALVINGS: usize = 40;
/// Digits after the point of what an accuracy is rounded up to.
const HUNDREDTHS: f64 = 100.0;

/// A design that meets a question.
#[derive(Clone, Debug)]
pub struct SizedTip<'a> {
    /// Material, size, part.
    pub candidate: Candidate<'a>,
    /// Its design file.
    pub text: String,
    /// Its tables.
    pub generated: Generated,
    /// The lightest touch that it tells at the end of a grasp, newtons.
    pub lightest_n: f64,
    /// The pressure rise there, pascals.
    pub lightest_pa: f64,
    /// A step of the transducer there, newtons.
    pub step_n: f64,
    /// The weather within a grasp there, newtons; 0 of a gauge part.
    pub weather_n: f64,
    /// Gauge pressure at the greatest force of the question, pascals.
    pub greatest_pa: f64,
    /// Indentation there, metres.
    pub deepest: f64,
    /// The greatest force that its tables read, newtons.
    pub end_n: f64,
    /// Change of the force at one pressure for a wall off by the tolerance, relative, the largest; `None` where that wall has no press.
    pub by_tolerance: Option<f64>,
}

/// A design file that needs no accuracy that its part cannot tell, and its tables; `design` writes its text with the accuracies of force
/// and indentation in percent, of which `asked` comes first.
///
/// # Errors
/// One line, of what gives no tables.
pub fn tabled(asked: f64, design: impl Fn(f64) -> String) -> Result<(String, Generated), String> {
    let make = |percent: f64| -> Result<(String, Generated), String> {
        let text = design(percent);
        let file = DesignFile::parse(&text, "design").map_err(|error| error.to_string())?;
        let generated = from_design_or_worse(file).map_err(|error| error.to_string())?;
        Ok((text, generated))
    };
    let (text, generated) = make(asked)?;
    if generated.shortfall().is_none() {
        return Ok((text, generated));
    }
    let certificate = &generated.certified.certificate;
    let least = certificate
        .force
        .allowed_percent
        .max(certificate.indentation.allowed_percent);
    let (text, generated) = make(libm::ceil(HUNDREDTHS * least) / HUNDREDTHS)?;
    match generated.shortfall() {
        None => Ok((text, generated)),
        Some(shortfall) => Err(shortfall),
    }
}

/// Solves a candidate, and reads its tables as the chip does.
///
/// # Errors
/// One line, of what it does not meet.
pub fn judge<'a>(
    question: &SizingQuestion,
    name: &str,
    candidate: Candidate<'a>,
) -> Result<SizedTip<'a>, String> {
    let mut deepest = candidate.deepest * libm::pow(BEYOND, 0.5);
    let asked = if question.radius_mm.is_none() {
        ACCURACY
    } else {
        ACCURACY_OF_BLEND
    };
    let mut made = tabled(asked, |percent| {
        design(question, name, &candidate, deepest, percent)
    })?;
    if question.radius_mm.is_none() && made.1.end.force < question.greatest_n {
        // Force grows at least in proportion.
        deepest *= BEYOND * question.greatest_n / made.1.end.force;
        made = tabled(asked, |percent| {
            design(question, name, &candidate, deepest, percent)
        })?;
    }
    let (text, generated) = made;
    // Tables of a plate are read as on the chip; of a ball the model is, whose blend of both tables is within a few percent of it.
    let ball = match question.radius_mm {
        None => None,
        Some(_) => Some(pressed_by_ball(&text, deepest)?),
    };
    let tables = &generated.certified.tables;
    let bits = tables.layout.fraction_bits;
    let read = |pascals: f64| -> [f64; 2] {
        match &ball {
            None => {
                let reading = tables.contact_at(PressureRise::from_pascals(pascals, bits));
                [reading.force.newtons(), reading.indentation.metres()]
            }
            Some(curve) => {
                let contact = curve.at_pressure_rise(pascals);
                [contact.force, contact.indentation]
            }
        }
    };
    let force_at = |pascals: f64| read(pascals)[0];
    let end = ball.as_ref().map_or(generated.end, Curve::end);
    if end.force < question.greatest_n {
        return Err(format!("its press ends at {:.3} N", end.force));
    }
    let stiffened = stiffening(candidate.material.relaxation.as_ref(), question.grasp_s);
    let least = candidate.part.touch(question.grasp_s);
    let lightest_n = lightest(force_at, least, stiffened);
    if lightest_n > question.lightest_n {
        return Err(format!("its lightest touch is {lightest_n:.4} N"));
    }
    let (mut low, mut high) = (0.0, end.pressure_rise);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if force_at(middle) < question.greatest_n {
            low = middle;
        } else {
            high = middle;
        }
    }
    let resolution = candidate.part.section.resolution_pa;
    let around = |pascals: f64| {
        let half = (0.5 * pascals).min(0.5 * least);
        (force_at(least + half) - force_at(least - half)) / (2.0 * half) * pascals
    };
    Ok(SizedTip {
        lightest_n,
        lightest_pa: least,
        step_n: around(resolution),
        weather_n: around(candidate.part.weather(question.grasp_s).max(f64::MIN_POSITIVE)),
        greatest_pa: generated.rest_pressure + high,
        deepest: read(high)[1],
        end_n: end.force,
        by_tolerance: tolerance(question, &candidate),
        candidate,
        text,
        generated,
    })
}

/// The curve of a design against its ball.
fn pressed_by_ball(text: &str, deepest: f64) -> Result<Curve, String> {
    let file = DesignFile::parse(text, "design").map_err(|error| error.to_string())?;
    let mut tip = Fingertip::for_curve(&file).map_err(|error| error.to_string())?;
    tip.curve(deepest).map_err(|error| error.to_string())
}

/// What a wall that is off by the tolerance does to the force at one pressure.
fn tolerance(question: &SizingQuestion, candidate: &Candidate<'_>) -> Option<f64> {
    let law = candidate.material.law;
    let as_drawn = coarse(law, candidate.membrane, question.touched())?;
    let thicker = Membrane {
        thickness: candidate.membrane.thickness + 1e-3 * question.making_mm[0],
        ..candidate.membrane
    };
    let made = coarse(law, thicker, question.touched())?;
    let force_at = |press: &super::presses::PressStates, pascals: f64| {
        press.at(|contact| contact.pressure_rise, pascals).force
    };
    let greatest = as_drawn
        .at(|contact| contact.force, question.greatest_n)
        .pressure_rise;
    let least = candidate.part.touch(question.grasp_s);
    [least, 0.1 * greatest, greatest]
        .into_iter()
        .map(|pascals| (force_at(&made, pascals) / force_at(&as_drawn, pascals) - 1.0).abs())
        .reduce(f64::max)
}

/// The design file of a candidate, pressed to an indentation in metres.
fn design(
    question: &SizingQuestion,
    name: &str,
    candidate: &Candidate<'_>,
    deepest: f64,
    percent: f64,
) -> String {
    let micrometres = |metres: f64| libm::round(1e6 * metres) / 1e3;
    let Candidate {
        material,
        membrane,
        part,
        ..
    } = candidate;
    let mut text = format!(
        "# Sized for {} to {} N, {} readings a second, a grasp of {} s.\n\
         name = \"{name}\"\n\n\
         [membrane]\nradial_semi_axis_mm = {:?}\naxial_semi_axis_mm = {:?}\nthickness_mm = {:?}\n\n\
         [material]\npreset = \"{}\"\n\n",
        question.lightest_n,
        question.greatest_n,
        question.rate,
        question.grasp_s,
        micrometres(membrane.radial_semi_axis),
        micrometres(membrane.axial_semi_axis),
        micrometres(membrane.thickness),
        material.name,
    );
    if material.relaxation.is_some() {
        let _ = write!(text, "[material.relaxation]\npreset = \"{}\"\n\n", material.name);
    }
    if let Some(radius) = question.radius_mm {
        let _ = write!(text, "[object]\nradius_mm = {radius:?}\n\n");
    }
    // What is below the lightest touch is read as well as that.
    let from = (100.0 * question.lightest_n / question.greatest_n).min(1.0);
    let _ = write!(
        text,
        "[model]\nkind = \"auto\"\naxes = \"outer\"\n\n\
         [press]\nmax_indentation_mm = {:?}\n\n\
         # {}, {}: noise by {}.\n{}\n\
         [accuracy]\nforce_percent_of_reading = {percent:?}\nindentation_percent_of_reading = {percent:?}\n\
         from_percent_of_full_scale = {from:?}\n",
        micrometres(deepest),
        part.title,
        part.datasheet,
        part.noise_from,
        part.text,
    );
    text
}

/// Candidates tried for each design wanted, at most.
const TRIED: usize = 2;
/// Candidates of one material.
const OF_MATERIAL: usize = 2;

/// The candidates that are worth solving, the lightest touch first: each part once with a material, and no material more than twice.
fn distinct<'a>(question: &SizingQuestion, reaching: &[Candidate<'a>], most: usize) -> Vec<Candidate<'a>> {
    let mut chosen: Vec<Candidate<'a>> = Vec::new();
    for candidate in reaching.iter().filter(|found| found.touch <= question.lightest_n) {
        let of_material = || {
            chosen
                .iter()
                .filter(|other| other.material.name == candidate.material.name)
        };
        let is_there = of_material().any(|other| other.part.name == candidate.part.name);
        if !is_there && of_material().count() < OF_MATERIAL && chosen.len() < most {
            chosen.push(*candidate);
        }
    }
    chosen
}

/// Solves the best candidates until `best` designs meet the question, the lightest touch first, and why others do not.
pub fn judge_best<'a>(
    question: &SizingQuestion,
    reaching: &[Candidate<'a>],
    best: usize,
    advance: &(dyn Fn(f64) + Sync),
) -> (Vec<SizedTip<'a>>, Vec<String>) {
    let candidates = distinct(question, reaching, TRIED * best);
    let (mut met, mut refused) = (Vec::new(), Vec::new());
    for group in candidates.chunks(rayon::current_num_threads().min(best).max(1)) {
        if met.len() >= best {
            break;
        }
        let found: Vec<Result<SizedTip<'a>, String>> = group
            .par_iter()
            .map(|candidate| judge(question, &question.name, *candidate))
            .collect();
        for (found, candidate) in found.into_iter().zip(group) {
            match found {
                Ok(found) => met.push(found),
                Err(reason) => refused.push(format!(
                    "{} with {}: {reason}",
                    candidate.material.title, candidate.part.name
                )),
            }
        }
        advance((met.len() as f64 / best as f64).min(1.0));
    }
    met.sort_by(|a: &SizedTip<'a>, b| a.lightest_n.total_cmp(&b.lightest_n));
    met.truncate(best);
    (met, refused)
}
