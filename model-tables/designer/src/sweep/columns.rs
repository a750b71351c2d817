//! Rows to Parquet: which columns a sweep has, and a part's bytes.

use super::space::Space;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::sync::Arc;

/// Columns of the rest state, as `designer rest` has them.
pub(super) const REST: [&str; 8] = [
    "model",
    "rest_pressure_kpa",
    "pole_stretch",
    "equator_radius_mm",
    "height_mm",
    "volume_mm3",
    "max_indentation_mm",
    "ends_by",
];
/// Columns of a curve, lists of the columns of `designer solve`; the last is the worst of the states.
pub(super) const CURVE: [&str; 6] = [
    "curve_indentation_mm",
    "curve_pressure_rise_kpa",
    "curve_force_n",
    "curve_contact_radius_mm",
    "curve_min_tension_n_per_m",
    "wrinkled",
];
/// Columns of the tables, as `designer table` and its certificate state them.
pub(super) const TABLES: [&str; 8] = [
    "table_end_pressure_rise_kpa",
    "table_end_force_n",
    "table_inputs",
    "table_bytes",
    "table_force_error_percent",
    "table_indentation_error_percent",
    "model_error_percent",
    "tables_bin",
];

/// One value of a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Datum {
    /// What was refused, or has no meaning here: null.
    Missing,
    /// A whole number.
    Integer(i64),
    /// A number in the unit that its column's name states.
    Number(f64),
    /// A word, or a line.
    Text(String),
    /// A curve's numbers, one a state.
    Numbers(Vec<f64>),
    /// A file's bytes.
    Bytes(Vec<u8>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Integer,
    Number,
    Text,
    Numbers,
    Bytes,
}

/// The columns of a sweep.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    fields: Vec<(String, Kind)>,
    schema: TypePtr,
    metadata: Vec<KeyValue>,
}

impl Columns {
    /// Those of a space. `metadata` goes into every file.
    pub(super) fn of(space: &Space, metadata: &[(&str, &str)]) -> Result<Self, ParquetError> {
        let mut columns = vec![("design_number".to_owned(), Kind::Integer)];
        for variable in &space.variables {
            let kind = if variable.is_numeric() {
                Kind::Number
            } else {
                Kind::Text
            };
            columns.push((variable.key.clone(), kind));
        }
        columns.extend(["refused_by", "reason"].map(|name| (name.to_owned(), Kind::Text)));
        let computed = space.computed;
        for (asked, names) in [
            (computed.rest, REST.as_slice()),
            (computed.curve, &CURVE),
            (computed.tables, &TABLES),
        ] {
            if asked {
                columns.extend(names.iter().map(|name| ((*name).to_owned(), kind(name))));
            }
        }
        let fields = columns
            .iter()
            .map(|(name, kind)| field(name, *kind).map(Arc::new))
            .collect::<Result<Vec<TypePtr>, ParquetError>>()?;
        let schema = Type::group_type_builder("design").with_fields(fields).build()?;
        let pair = |(key, value): &(&str, &str)| KeyValue::new((*key).to_owned(), (*value).to_owned());
        Ok(Self {
            fields: columns,
            schema: Arc::new(schema),
            metadata: metadata.iter().map(pair).collect(),
        })
    }

    /// The bytes of a part: one row group, so that a reader holds one part at most.
    pub(super) fn encode(&self, rows: &[Vec<Datum>]) -> Result<Vec<u8>, ParquetError> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            // Numbers of a sweep hardly repeat.
            .set_dictionary_enabled(false)
            .set_created_by(concat!("fingertip ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(self.metadata.clone()))
            .build();
        let mut file = SerializedFileWriter::new(Vec::new(), self.schema.clone(), Arc::new(properties))?;
        let mut group = file.next_row_group()?;
        let mut column = 0;
        while let Some(mut writer) = group.next_column()? {
            let values = rows.iter().map(|row| &row[column]);
            match writer.untyped() {
                ColumnWriter::Int64ColumnWriter(writer) => {
                    let (found, levels) = plain(values, |datum| match datum {
                        Datum::Integer(integer) => Some(*integer),
                        _ => None,
                    });
                    let optional = (column > 0).then_some(levels.as_slice());
                    writer.write_batch(&found, optional, None)?;
                }
                ColumnWriter::DoubleColumnWriter(writer) if self.fields[column].1 == Kind::Numbers => {
                    let (found, definition, repetition) = lists(values);
                    writer.write_batch(&found, Some(&definition), Some(&repetition))?;
                }
                ColumnWriter::DoubleColumnWriter(writer) => {
                    let (found, levels) = plain(values, |datum| match datum {
                        Datum::Number(number) => Some(*number),
                        _ => None,
                    });
                    writer.write_batch(&found, Some(&levels), None)?;
                }
                ColumnWriter::ByteArrayColumnWriter(writer) => {
                    let (found, levels) = plain(values, |datum| match datum {
                        Datum::Text(text) => Some(ByteArray::from(text.as_str())),
                        Datum::Bytes(bytes) => Some(ByteArray::from(bytes.clone())),
                        _ => None,
                    });
                    writer.write_batch(&found, Some(&levels), None)?;
                }
                _ => return Err(ParquetError::General("a column of another type".to_owned())),
            }
            writer.close()?;
            column += 1;
        }
        group.close()?;
        file.into_inner()
    }
}

/// What a column of results holds.
fn kind(name: &str) -> Kind {
    match name {
        "model" | "ends_by" | "wrinkled" => Kind::Text,
        "table_inputs" | "table_bytes" => Kind::Integer,
        "tables_bin" => Kind::Bytes,
        name if name.starts_with("curve_") => Kind::Numbers,
        _ => Kind::Number,
    }
}

fn field(name: &str, kind: Kind) -> Result<Type, ParquetError> {
    let physical = match kind {
        Kind::Integer => Physical::INT64,
        Kind::Number | Kind::Numbers => Physical::DOUBLE,
        Kind::Text | Kind::Bytes => Physical::BYTE_ARRAY,
    };
    let logical = (kind == Kind::Text).then_some(LogicalType::String);
    let repetition = if name == "design_number" || kind == Kind::Numbers {
        Repetition::REQUIRED
    } else {
        Repetition::OPTIONAL
    };
    let of_numbers = kind == Kind::Numbers;
    let leaf = Type::primitive_type_builder(if of_numbers { "element" } else { name }, physical)
        .with_repetition(repetition)
        .with_logical_type(logical)
        .build()?;
    if !of_numbers {
        return Ok(leaf);
    }
    // The three levels that the format prescribes for a list.
    let list = Type::group_type_builder("list")
        .with_repetition(Repetition::REPEATED)
        .with_fields(vec![Arc::new(leaf)])
        .build()?;
    Type::group_type_builder(name)
        .with_repetition(Repetition::OPTIONAL)
        .with_logical_type(Some(LogicalType::List))
        .with_fields(vec![Arc::new(list)])
        .build()
}

/// Values that are there, and the definition level of each row.
fn plain<'a, T>(
    values: impl Iterator<Item = &'a Datum>,
    take: impl Fn(&Datum) -> Option<T>,
) -> (Vec<T>, Vec<i16>) {
    let (mut found, mut levels) = (Vec::new(), Vec::new());
    for datum in values {
        let value = take(datum);
        levels.push(i16::from(value.is_some()));
        found.extend(value);
    }
    (found, levels)
}

/// Elements, and the definition and repetition levels of a column of lists: 0 is null, 1 an empty list, 2 an element.
fn lists<'a>(values: impl Iterator<Item = &'a Datum>) -> (Vec<f64>, Vec<i16>, Vec<i16>) {
    let (mut found, mut definition, mut repetition) = (Vec::new(), Vec::new(), Vec::new());
    for datum in values {
        match datum {
            Datum::Numbers(numbers) if !numbers.is_empty() => {
                for (place, &number) in numbers.iter().enumerate() {
                    found.push(number);
                    definition.push(2);
                    repetition.push(i16::from(place > 0));
                }
            }
            other => {
                definition.push(i16::from(matches!(other, Datum::Numbers(_))));
                repetition.push(0);
            }
        }
    }
    (found, definition, repetition)
}
