//! The certificate of tables, as TOML: their proven errors and properties.

use super::NEVER;
use crate::block::field::{Field, Visit};
use crate::block::section;
use crate::generate::design::{AccuracyLimit, Generated};
use crate::generate::feedback::CertifiedFeedback;
use crate::generate::object::{Band, ObjectTables, quoted};
use crate::generate::{ChipSeries, Errors, TABLE_VERSION};
use crate::model::own_error::OwnError;
use crate::table::ContactLookup as _;
use crate::table::feedback::words_per_segment;
use crate::units::PressureRise;
use std::fmt::{self, Write as _};

/// A line of TOML for each field that is a word.
struct Words<'a>(&'a mut String);

impl Visit for Words<'_> {
    type Stop = fmt::Error;

    fn field<T: Field>(&mut self, name: &'static str, value: &mut T) -> fmt::Result {
        let mut bytes = Vec::new();
        value.put(&mut bytes);
        let word = i32::get(&bytes).ok_or(fmt::Error)?;
        writeln!(self.0, "{name} = {word}")
    }
}

/// The certificate as TOML.
pub(super) fn text(generated: &Generated) -> String {
    let mut text = String::new();
    write_certificate(generated, &mut text).expect(NEVER);
    text
}

fn write_certificate(generated: &Generated, out: &mut String) -> fmt::Result {
    let tables = &generated.certified.tables;
    let certificate = &generated.certified.certificate;
    let mut hash = String::new();
    for byte in generated.design.hash() {
        write!(hash, "{byte:02x}")?;
    }
    let how = if certificate.every_input_evaluated {
        "# What holds of the tables of this design. Every representable input was evaluated with the lookup\n\
         # that runs on the chip, and compared with the curve of the full model."
    } else {
        "# What holds of the tables of this design on every representable input, as the lookup that runs on the chip\n\
         # answers it, compared with the curve of the full model. Largest errors, steps and monotonicity are exact: bounds\n\
         # of the sums settle all inputs but those evaluated. Mean and root-mean-square errors are of evenly spaced inputs."
    };
    writeln!(
        out,
        "{how}\n\
         design = \"{}\"\n\
         design_sha256 = \"{hash}\"\n\
         table_version = {}\n\
         inputs_checked = {}\n\
         bytes = {}\n\
         # Of a lookup on the chip, inlined, both outputs and the saturation flag: counted from its shape.\n\
         instructions = {}\n\
         rest_pressure_pa = {:.3}\n\
         maximum_pressure_rise_pa = {:?}\n\
         saturation_flagged = true\n\
         # Relative error of the comparison: local polynomials of degree five stand for the curve.\n\
         comparison_error = {:.1e}\n",
        generated.design.name,
        TABLE_VERSION,
        certificate.inputs,
        tables.bytes(),
        tables.instructions(),
        generated.rest_pressure,
        PressureRise(tables.layout.maximum).pascals(tables.layout.fraction_bits),
        certificate.comparison_error,
    )?;
    if let Some(kind) = generated.kind {
        writeln!(out, "[model]\nkind = \"{kind}\"")?;
    }
    if let Some(model) = &generated.model_error {
        writeln!(
            out,
            "# The curve against states of its own on a finer mesh, between those it was made from.\n\
             mesh = \"{}\"\n\
             states = {}\n\
             force_percent = {:.1e}\n\
             indentation_percent = {:.1e}\n",
            model.better, model.states, model.force_percent, model.indentation_percent
        )?;
    }
    if let Some(error) = &generated.membrane_error {
        writeln!(
            out,
            "[model.membrane] # the error of the membrane itself, at the pressure rises of a solid"
        )?;
        match error {
            OwnError::Compared(found) => writeln!(
                out,
                "against = \"{}\"\n\
                 states = {}\n\
                 force_percent = {:.1e}\n\
                 indentation_percent = {:.1e}",
                found.better, found.states, found.force_percent, found.indentation_percent
            )?,
            OwnError::Estimated { percent, .. } => writeln!(
                out,
                "# No solid has this rest state: thickness over radius.\n\
                 estimated_percent = {percent:.1e}"
            )?,
            OwnError::Unknown { .. } => {}
        }
    }
    if let (Some(accuracy), Some(_)) = (&generated.design.accuracy, generated.own_error()) {
        writeln!(
            out,
            "# The largest error of the model itself that the design allows.\n\
             model_percent_allowed = {:?}\n",
            accuracy.model_percent
        )?;
    }
    writeln!(
        out,
        "[layout] # an input count is 2^-pressure_fraction_bits pascal"
    )?;
    section::layout(&mut tables.layout.clone(), &mut Words(out))?;
    writeln!(out, "segments = {}", tables.segments())?;
    writeln!(out, "words_per_segment = {}", tables.layout.words())?;
    let asked = generated.asked_percent();
    write_errors("force", "un", asked[0], &certificate.force, out)?;
    write_errors("indentation", "nm", asked[1], &certificate.indentation, out)?;
    write_beside(generated, asked[0], out)?;
    write_transducer(generated, out)
}

/// What else has tables of the same layout, and what is left open.
fn write_beside(generated: &Generated, asked: f64, out: &mut String) -> fmt::Result {
    let fewer = |chip: &ChipSeries| chip.series.terms().len() < chip.of;
    if let Some(chip) = generated.chip_series.filter(fewer) {
        writeln!(
            out,
            "\n[relaxation] # the fewest terms with which the chip reads as with the whole series, and what they add to the settled pressure\n\
             terms = {}\n\
             of = {}\n\
             added_percent = {:.4}\n\
             allowed_percent = {:?}",
            chip.series.terms().len(),
            chip.of,
            chip.added_percent,
            chip.allowed_percent
        )?;
    }
    if let Some(feedback) = &generated.certified.feedback {
        write_feedback(feedback, generated.feedback_mesh_percent, asked, out)?;
    }
    if let Some(object) = &generated.certified.object {
        let unknown = generated.design.object.is_some_and(|object| object.unknown);
        write_blend(object, unknown, out)?;
    }
    if let Some(band) = &generated.band {
        write_band(band, out)?;
    }
    Ok(())
}

/// The force of the feedback actuator.
fn write_feedback(
    feedback: &CertifiedFeedback,
    mesh: Option<f64>,
    asked: f64,
    out: &mut String,
) -> fmt::Result {
    write_errors("feedback", "un", asked, &feedback.errors, out)?;
    writeln!(
        out,
        "# The errors are of the force gained since rest. Its tables have the layout of the others, and words of their own.\n\
         at_rest_un = {}\n\
         shift = {}\n\
         words_per_segment = {}\n\
         bytes = {}\n\
         comparison_error = {:.1e}",
        feedback.scale.at_rest,
        feedback.scale.shift,
        words_per_segment(&feedback.layout),
        feedback.bytes(),
        feedback.comparison_error,
    )?;
    match mesh {
        Some(percent) => writeln!(
            out,
            "# The largest error of the force against meshes of both ends that are finer, percent of reading.\n\
             mesh_percent = {percent:.1e}"
        ),
        None => Ok(()),
    }
}

/// What a blend of the plate's tables and the reference ball's is worth.
fn write_blend(object: &ObjectTables, unknown: bool, out: &mut String) -> fmt::Result {
    let law = &object.law;
    let bits = object.ball.layout.fraction_bits;
    let millimetres = |micrometres: i32| f64::from(micrometres) * 1e-3;
    writeln!(
        out,
        "\n[object] # tables blended of the plate's and a reference object's, as the chip blends them. A cylinder takes half the weights\n\
         # of a ball: quoted, not solved.\n\
         start = \"{}\"\n\
         reference_{}_mm = {:?}\n\
         bytes = {}",
        object.start,
        if object.reference.is_cup() { "cup" } else { "ball" },
        millimetres(object.reference.code().1),
        2 * object.ball.bytes(),
    )?;
    if law.least[0] > 0 {
        writeln!(out, "least_ball_mm = {:?}", millimetres(law.least[0]))?;
    }
    if unknown {
        writeln!(out, "chosen = \"the start has the smallest band\"")?;
    }
    if law.least[1] > 0 {
        writeln!(out, "least_cup_mm = {:?}", millimetres(law.least[1]))?;
    }
    let [ball, cup] = law.last.map(|last| PressureRise(last).pascals(bits));
    writeln!(
        out,
        "last_rise_of_balls_pa = {ball:?}\n\
         last_rise_of_cups_pa = {cup:?}\n\
         errors_from_pa = {:.1}",
        object.from
    )?;
    for error in &object.errors {
        writeln!(
            out,
            "\n[[object.error]] # largest, against the solved object, percent of reading: as deep as the design is pressed, and up to\n\
             # the last pressure rise that is answered\n\
             radius_mm = {:.3}\n\
             fitted = {}",
            error.radius_mm, error.fitted
        )?;
        for (name, errors) in [("pressed", error.pressed), ("answered", error.answered)] {
            writeln!(
                out,
                "{name}_to_pa = {:.1}\n\
                 {name}_force_percent = {:.2}\n\
                 {name}_indentation_percent = {:.2}",
                errors.last, errors.force_percent, errors.indentation_percent
            )?;
        }
    }
    Ok(())
}

/// What an object that the chip is not told leaves open.
fn write_band(band: &Band, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "\n[band] # where the chip is not told what it touches: the truth less the reading, percent of reading, least and most, over\n\
         # balls (solved) on the axis, tilted plates and friction (quoted, of a dome of 9 x 7 mm), each alone\n\
         tables_of = \"{}\"\n\
         smallest_ball_mm = {:?}\n\
         largest_tilt_degrees = {:?}",
        band.tables_of,
        band.smallest_ball_mm,
        quoted::MAX_TILT
    )?;
    if let Some(cup) = band.cup_mm {
        writeln!(out, "cup_mm = {cup:?}")?;
    }
    writeln!(out, "rows = [")?;
    for row in &band.rows {
        writeln!(
            out,
            "    {{ from_pa = {:?}, to_pa = {:.1}, force_percent = {:?}, indentation_percent = {:?} }},",
            row.from, row.to, row.force_percent, row.indentation_percent
        )?;
    }
    writeln!(out, "]")
}

/// What the transducer leaves undecided, beside which the errors of the tables are to be seen.
fn write_transducer(generated: &Generated, out: &mut String) -> fmt::Result {
    let tables = &generated.certified.tables;
    let transducer = &generated.transducer;
    let bits = tables.layout.fraction_bits;
    let resolvable = generated.certified.resolvable_percent;
    let held_to = generated.limits().map(AccuracyLimit::word);
    let integers = if held_to.contains(&AccuracyLimit::Integers.word()) {
        ", or \"integers\" where no tables reach it"
    } else {
        ""
    };
    let touch = tables.contact_at(PressureRise::from_pascals(transducer.resolution_pa, bits));
    writeln!(
        out,
        "\n[transducer] # what it leaves undecided: a step of it at first contact, and half a step as a share of the reading where\n\
         # that is least. Tables finer than the smaller of the latter would be waste and are not made.\n\
         resolution_pa = {:?}\n\
         noise_pa = {:?}\n\
         resolution_moves_force_un = {}\n\
         resolution_moves_indentation_nm = {}\n\
         half_step_is_force_percent = {:.6}\n\
         half_step_is_indentation_percent = {:.6}\n\
         # What the tables are held to: \"accuracy\", or \"transducer\" where more was asked than it can tell{}.\n\
         force_held_to = \"{}\"\n\
         indentation_held_to = \"{}\"",
        transducer.resolution_pa,
        transducer.noise_pa,
        touch.force.0,
        touch.indentation.0,
        resolvable[0],
        resolvable[1],
        integers,
        held_to[0],
        held_to[1],
    )
}

fn write_errors(name: &str, unit: &str, asked: f64, errors: &Errors, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "\n[{name}]\n\
         full_scale_{unit} = {:.3}\n\
         reading_from_{unit} = {:.3}\n\
         asked_percent_of_reading = {asked:?}\n\
         allowed_percent_of_reading = {:?}\n\
         max_percent_of_reading = {:.6}\n\
         rms_percent_of_reading = {:.6}\n\
         mean_percent_of_reading = {:.6}\n\
         max_below_percent_of_reading_from = {:.6}\n\
         max_percent_of_full_scale = {:.6}\n\
         rms_percent_of_full_scale = {:.6}\n\
         mean_percent_of_full_scale = {:.6}\n\
         monotone = {}\n\
         strictly_increasing = {}\n\
         falling_steps = {}\n\
         equal_steps = {}\n\
         largest_step_{unit} = {}\n\
         smallest_{unit} = {}\n\
         largest_{unit} = {}",
        errors.full_scale,
        errors.from,
        errors.allowed_percent,
        errors.of_reading.max,
        errors.of_reading.rms,
        errors.of_reading.mean,
        errors.below_percent_of_from,
        errors.of_full_scale.max,
        errors.of_full_scale.rms,
        errors.of_full_scale.mean,
        errors.falling_steps == 0,
        errors.falling_steps + errors.equal_steps == 0,
        errors.falling_steps,
        errors.equal_steps,
        errors.largest_step,
        errors.range[0],
        errors.range[1],
    )
}
