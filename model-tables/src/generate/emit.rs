//! The forms in which tables are written.
//!
//! Rust source and the binary block give the same fields: those that [`crate::block::section`] describes.

use super::TABLE_VERSION;
use super::design::{Generated, Limit, integer};
use super::object::ObjectTables;
use super::owned::OwnedTables;
use super::tally::Errors;
use crate::block::field::{Field, Visit};
use crate::block::section;
use crate::block::write::{ObjectData, TipData};
use crate::constants::{DesignConstants, ZeroAssumptions};
use crate::material::series::{SeriesStep, WallSeries};
use crate::model::own_error::OwnError;
use crate::units::PressureRise;
use std::fmt::{self, Write as _};

/// Force that a relaxing wall may still bear where the chip reads none, permille of the peak before: finite elements of presses
/// and releases, of walls of a ninth of the radius, and of thinner ones than [`THIN`].
const REMAINING: u32 = 30;
const REMAINING_THIN: u32 = 50;
/// Thickness over radius.
const THIN: f64 = 0.1;

const NEVER: &str = "writing to a string does not fail";

impl Generated {
    /// Rust source of `TABLES` and `DESIGN`, for `include!`.
    pub fn rust_source(&self) -> String {
        rust_source(self)
    }

    /// What the firmware needs to know of the design beside its tables.
    pub fn constants(&self) -> DesignConstants {
        DesignConstants {
            hash: self.hash(),
            table_version: TABLE_VERSION,
            certificate: self.certificate_hash(),
            rest_pressure: integer(self.rest_pressure),
            maximum_pressure: integer(self.rest_pressure + self.end.pressure_rise),
            transducer: self.transducer(),
            zero: self.design.zero.assumptions(self.design.air),
        }
    }

    /// The tip's data as a [`crate::block`], without a calibration.
    pub fn binary(&self) -> Vec<u8> {
        let tables = &self.certified.tables;
        TipData {
            constants: self.constants(),
            layout: tables.layout,
            words: &tables.words,
            name: &self.design.name,
            calibration: None,
            relaxation: self.wall(),
            object: self.certified.object.as_ref().map(|object| ObjectData {
                start: object.start,
                law: object.law,
                words: &object.ball.words,
            }),
        }
        .write()
    }

    /// Its wall in time as the chip knows it, if it relaxes.
    pub fn wall(&self) -> Option<WallSeries> {
        let relaxation = self.design.relaxation.as_ref()?;
        let membrane = &self.design.design().membrane;
        let thin = membrane.thickness <= THIN * membrane.radial_semi_axis;
        let period = 1e-6 * f64::from(self.transducer().kind.period());
        Some(WallSeries {
            step: SeriesStep::over(relaxation, period),
            remaining_permille: if thin { REMAINING_THIN } else { REMAINING },
        })
    }

    /// The tables as CSV: one row a word.
    pub fn csv(&self) -> String {
        csv(self)
    }

    /// The certificate as TOML.
    pub fn certificate(&self) -> String {
        certificate(self)
    }
}

fn rust_source(generated: &Generated) -> String {
    let mut text = String::new();
    write_rust(generated, &mut text).expect(NEVER);
    text
}

fn write_rust(generated: &Generated, out: &mut String) -> fmt::Result {
    let tables = &generated.certified.tables;
    let layout = &tables.layout;
    let shape = format!(
        "model_tables::table::Tables<{}, {}>",
        tables.segments(),
        layout.words()
    );
    writeln!(
        out,
        "// Tables of the design `{}`, {} bytes. Generated: change the design, not this file.\n",
        generated.design.name,
        tables.bytes()
    )?;
    let mut constants = generated.constants();
    writeln!(
        out,
        "/// Its `name`.\n\
         pub const NAME: &str = {:?};\n\n\
         /// What the firmware needs to know of the design beside its tables.\n\
         pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {{",
        generated.design.name
    )?;
    let mut source = Source { out, indent: 4 };
    section::identity(&mut constants, &mut source)?;
    section::pressures(&mut constants, &mut source)?;
    writeln!(
        source.out,
        "    transducer: model_tables::constants::Transducer {{"
    )?;
    source.indent = 8;
    section::transducer(&mut constants.transducer, &mut source)?;
    writeln!(source.out, "    }},")?;
    if constants.zero == ZeroAssumptions::NONE {
        writeln!(
            source.out,
            "    zero: model_tables::constants::ZeroAssumptions::NONE,"
        )?;
    } else {
        writeln!(
            source.out,
            "    zero: model_tables::constants::ZeroAssumptions {{"
        )?;
        section::zero(&mut constants.zero, &mut source)?;
        writeln!(source.out, "    }},")?;
    }
    writeln!(source.out, "}};\n")?;
    writeln!(
        out,
        "/// The type of [`TABLES`].\npub type DesignTables = {shape};\n"
    )?;
    writeln!(
        out,
        "/// Pressure rise -> force and indentation.\n\
         pub const TABLES: DesignTables = model_tables::table::Tables {{\n\
         \x20   layout: model_tables::table::Layout {{"
    )?;
    section::layout(&mut tables.layout.clone(), &mut Source { out, indent: 8 })?;
    writeln!(out, "    }},\n    segments: [")?;
    write_segments(tables, 8, out)?;
    writeln!(out, "    ],\n}};")?;
    if let Some(object) = &generated.certified.object {
        write_objects(object, out)?;
    }
    match generated.wall() {
        Some(wall) => write_wall(wall, out),
        None => Ok(()),
    }
}

fn write_wall(mut wall: WallSeries, out: &mut String) -> fmt::Result {
    const OF: &str = "model_tables::material::series";
    writeln!(
        out,
        "\n/// The wall in time: only a wall that relaxes has it.\n\
         pub const RELAXATION: {OF}::WallSeries = {OF}::WallSeries {{\n\
         \x20   remaining_permille: {},\n\
         \x20   step: {OF}::SeriesStep {{\n\
         \x20       count: {},\n\
         \x20       stiffness: {},",
        wall.remaining_permille, wall.step.count, wall.step.stiffness
    )?;
    let mut source = Source { out, indent: 8 };
    source.field("settled", &mut wall.step.settled)?;
    writeln!(out, "        terms: [")?;
    for term in &wall.step.terms {
        write!(out, "            ")?;
        term.spell(out)?;
        writeln!(out, ",")?;
    }
    writeln!(out, "        ],\n    }},\n}};")
}

fn write_segments(tables: &OwnedTables, indent: usize, out: &mut String) -> fmt::Result {
    for index in 0..tables.segments() {
        writeln!(out, "{:indent$}{:?},", "", tables.segment(index))?;
    }
    Ok(())
}

fn write_objects(object: &ObjectTables, out: &mut String) -> fmt::Result {
    let (ball, law) = (&object.ball, &object.law);
    writeln!(
        out,
        "\n/// Segments of the reference ball.\npub const BALL: [[i32; {}]; {}] = [",
        ball.layout.words(),
        ball.segments()
    )?;
    write_segments(ball, 4, out)?;
    writeln!(
        out,
        "];\n\n/// How much of it other objects have.\n\
         pub const LAW: model_tables::table::law::BlendLaw = model_tables::table::law::{law:?};\n\n\
         /// What is touched at the start.\n\
         pub const START: model_tables::table::law::Touched = model_tables::table::law::Touched::{:?};",
        object.start
    )
}

/// A line of Rust source for each field.
struct Source<'a> {
    out: &'a mut String,
    indent: usize,
}

impl Visit for Source<'_> {
    type Stop = fmt::Error;

    fn field<T: Field>(&mut self, name: &'static str, value: &mut T) -> fmt::Result {
        write!(self.out, "{:1$}{name}: ", "", self.indent)?;
        value.spell(self.out)?;
        writeln!(self.out, ",")
    }
}

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

fn csv(generated: &Generated) -> String {
    let tables = &generated.certified.tables;
    let mut text = String::from("segment,from_count,word,value,upper_half,lower_half\n");
    for (index, from) in first_counts(tables).iter().enumerate() {
        for (at, &word) in tables.segment(index).iter().enumerate() {
            let (upper, lower) = (word >> 16, word as i16);
            writeln!(text, "{index},{from},{at},{word},{upper},{lower}").expect(NEVER);
        }
    }
    text
}

/// First input of every segment, in the order of the table, by bisection: the index never rises with it.
fn first_counts(tables: &OwnedTables) -> Vec<i32> {
    let layout = &tables.layout;
    (0..tables.segments())
        .map(|index| {
            let (mut low, mut high) = (0, layout.maximum);
            while low < high {
                let middle = low + (high - low) / 2;
                let number = layout.place(PressureRise(middle)).number;
                if number - layout.first_index <= index as u32 {
                    high = middle;
                } else {
                    low = middle + 1;
                }
            }
            low
        })
        .collect()
}

fn certificate(generated: &Generated) -> String {
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
        PressureRise(tables.layout.maximum).pascals(tables.layout.pressure_fraction_bits),
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
    if let Some(object) = &generated.certified.object {
        write_blend(object, out)?;
    }
    write_transducer(generated, out)
}

/// What a blend of the plate's tables and the reference ball's is worth.
fn write_blend(object: &ObjectTables, out: &mut String) -> fmt::Result {
    let law = &object.law;
    let bits = object.ball.layout.pressure_fraction_bits;
    let millimetres = |micrometres: i32| f64::from(micrometres) * 1e-3;
    writeln!(
        out,
        "\n[object] # tables blended of the plate's and a reference ball's, as the chip blends them. A cylinder takes half the weights\n\
         # of a ball: quoted, not solved.\n\
         start = \"{}\"\n\
         reference_ball_mm = {:?}\n\
         bytes = {}\n\
         least_ball_mm = {:?}",
        object.start,
        millimetres(law.reference),
        2 * object.ball.bytes(),
        millimetres(law.least[0]),
    )?;
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

/// What the transducer leaves undecided, beside which the errors of the tables are to be seen.
fn write_transducer(generated: &Generated, out: &mut String) -> fmt::Result {
    let tables = &generated.certified.tables;
    let transducer = &generated.transducer;
    let bits = tables.layout.pressure_fraction_bits;
    let resolvable = generated.certified.resolvable_percent;
    let held_to = generated.limits().map(Limit::word);
    let integers = if held_to.contains(&Limit::Integers.word()) {
        ", or \"integers\" where no tables reach it"
    } else {
        ""
    };
    let touch = tables.lookup(PressureRise::from_pascals(transducer.resolution_pa, bits));
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
