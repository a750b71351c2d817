//! The forms in which tables are written.
//!
//! Rust source and the binary block give the same fields: those that [`crate::block::section`] describes.

use super::design::{Generated, integer};
use super::feedback::CertifiedFeedback;
use super::object::ObjectTables;
use super::{OwnedTables, TABLE_VERSION};
use crate::block::StoredCalibration;
use crate::block::field::{Field, Visit};
use crate::block::section;
use crate::block::write::{ObjectData, TipData};
use crate::constants::{DesignConstants, ZeroAssumptions};
use crate::material::series::{SeriesStep, WallSeries};
use crate::table::Layout;
use crate::table::band::ChipBand;
use crate::table::feedback::words_per_segment;
use crate::units::PressureRise;
use std::fmt::{self, Write as _};

mod certificate;

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

    /// The band that the chip sends beside its readings; `None` if the design has no `[object] unknown = true`.
    pub fn chip_band(&self) -> Option<ChipBand> {
        let unknown = self.design.object.is_some_and(|object| object.unknown);
        let bits = self.certified.tables.layout.fraction_bits;
        self.band.as_ref().filter(|_| unknown)?.of_chip(bits)
    }

    /// The tip's data as a [`crate::block`], without a calibration.
    pub fn binary(&self) -> Vec<u8> {
        self.tip(None)
    }

    /// The tip's data as a [`crate::block`], with the calibration of the fingertip.
    pub fn tip(&self, calibration: Option<StoredCalibration>) -> Vec<u8> {
        let tables = &self.certified.tables;
        TipData {
            constants: self.constants(),
            layout: tables.layout,
            words: &tables.words,
            name: &self.design.name,
            calibration,
            relaxation: self.wall(),
            object: self.certified.object.as_ref().map(|object| ObjectData {
                start: object.start,
                law: object.law,
                words: &object.ball.words,
            }),
            feedback: self
                .certified
                .feedback
                .as_ref()
                .map(|feedback| (feedback.scale, feedback.words.as_slice())),
        }
        .write()
    }

    /// Its wall in time as the chip knows it, if it relaxes.
    pub fn wall(&self) -> Option<WallSeries> {
        let chip = self.chip_series.as_ref()?;
        let bits = self.certified.tables.layout.fraction_bits;
        let rules = self.in_time?;
        let counts = |pascals: f64| PressureRise::from_pascals(pascals, bits).0.max(1).unsigned_abs();
        let sixteen_bits = |value: f64| libm::round(65_536.0 * value) as u32;
        let membrane = &self.design.design().membrane;
        let thin = membrane.thickness <= THIN * membrane.radial_semi_axis;
        Some(WallSeries {
            step: SeriesStep::over(&chip.series, chip.period),
            remaining_permille: if thin { REMAINING_THIN } else { REMAINING },
            fluid_least: sixteen_bits(rules.fluid_least).min(1 << 16),
            fluid_half: counts(rules.fluid_half),
            weight_gain: sixteen_bits(rules.weight_gain).min(WallSeries::LARGEST_GAIN),
            weight_half: counts(rules.weight_half),
            retouch: sixteen_bits(rules.retouch).min(1 << 16),
            temperature_gain: sixteen_bits(rules.temperature_gain).min((1 << 16) - 1),
        })
    }

    /// The tables as CSV: one row a word; those of the feedback force follow those of force and indentation in each segment.
    pub fn csv(&self) -> String {
        csv(self)
    }

    /// The certificate as TOML.
    pub fn certificate(&self) -> String {
        certificate::text(self)
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
    write_layout(tables.layout, &mut Source { out, indent: 8 })?;
    writeln!(out, "    }},\n    segments: [")?;
    write_segments(tables, 8, out)?;
    writeln!(out, "    ],\n}};")?;
    if let Some(object) = &generated.certified.object {
        write_objects(object, out)?;
        write_band(generated, out)?;
    }
    if let Some(feedback) = &generated.certified.feedback {
        write_feedback(feedback, out)?;
    }
    match generated.wall() {
        Some(wall) => write_wall(wall, out),
        None => Ok(()),
    }
}

/// The fields of a layout: a block has each shift as a field of its own.
fn write_layout(mut layout: Layout, source: &mut Source<'_>) -> fmt::Result {
    source.field("fraction_bits", &mut layout.fraction_bits)?;
    source.field("maximum", &mut layout.maximum)?;
    source.field("bias", &mut layout.bias)?;
    source.field("octaves", &mut layout.octaves)?;
    source.field("halvings", &mut layout.halvings)?;
    source.field("powers", &mut layout.powers)?;
    source.field("constant", &mut layout.constant)?;
    source.field("first_index", &mut layout.first_index)?;
    source.field("shifts", &mut layout.shifts)
}

fn write_wall(mut wall: WallSeries, out: &mut String) -> fmt::Result {
    const OF: &str = "model_tables::material::series";
    writeln!(
        out,
        "\n/// The wall in time: only a wall that relaxes has it.\n\
         pub const RELAXATION: {OF}::WallSeries = {OF}::WallSeries {{\n\
         \x20   remaining_permille: {},\n\
         \x20   fluid_least: {},\n\
         \x20   fluid_half: {},\n\
         \x20   weight_gain: {},\n\
         \x20   weight_half: {},\n\
         \x20   retouch: {},\n\
         \x20   temperature_gain: {},\n\
         \x20   step: {OF}::SeriesStep {{\n\
         \x20       count: {},\n\
         \x20       stiffness: {},",
        wall.remaining_permille,
        wall.fluid_least,
        wall.fluid_half,
        wall.weight_gain,
        wall.weight_half,
        wall.retouch,
        wall.temperature_gain,
        wall.step.count,
        wall.step.stiffness
    )?;
    let mut source = Source { out, indent: 8 };
    source.field("settled", &mut wall.step.settled)?;
    source.field("forgets", &mut wall.step.forgets)?;
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

/// The band of a design that is not told what it touches; of another with `[object]` that there is none, which costs the image nothing.
fn write_band(generated: &Generated, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "\n/// The band of an unknown object, for the tables at the start.\n\
         pub const BAND: Option<model_tables::table::band::ChipBand> = {};",
        generated
            .chip_band()
            .map_or_else(|| "None".to_owned(), |band| spelt_band(&band))
    )
}

fn spelt_band(band: &ChipBand) -> String {
    const OF: &str = "model_tables::table::band";
    let rows: Vec<String> = band
        .rows
        .iter()
        .map(|row| {
            format!(
                "        {OF}::ChipBandRow {{ to: model_tables::units::PressureRise({}), force: {:?}, indentation: {:?} }},\n",
                row.to.0, row.force, row.indentation
            )
        })
        .collect();
    format!(
        "Some({OF}::ChipBand {{\n    from: model_tables::units::PressureRise({}),\n    count: {},\n    rows: [\n{}    ],\n}})",
        band.from.0,
        band.count,
        rows.concat()
    )
}

fn write_feedback(feedback: &CertifiedFeedback, out: &mut String) -> fmt::Result {
    const OF: &str = "model_tables::table::feedback";
    let width = words_per_segment(&feedback.layout);
    let segments = feedback.words.len() / width;
    writeln!(
        out,
        "\n/// Pressure rise -> force of the feedback actuator, in the layout of [`TABLES`].\n\
         pub const FEEDBACK: {OF}::FeedbackTables<{segments}, {width}> = {OF}::FeedbackTables {{\n\
         \x20   scale: {OF}::{:?},\n\
         \x20   segments: [",
        feedback.scale
    )?;
    for index in 0..segments {
        writeln!(out, "        {:?},", feedback.segment(index))?;
    }
    writeln!(out, "    ],\n}};")
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

fn csv(generated: &Generated) -> String {
    let tables = &generated.certified.tables;
    let mut text = String::from("segment,from_count,word,value,upper_half,lower_half\n");
    for (index, from) in first_counts(tables).iter().enumerate() {
        let feedback = generated.certified.feedback.as_ref();
        let beside = feedback.map_or(&[][..], |feedback| feedback.segment(index));
        for (at, &word) in tables.segment(index).iter().chain(beside).enumerate() {
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
                let number = layout.place(middle).number;
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
