//! The file of a sweep: a base design, what varies, and what is computed.

use super::sample::{Method, Sample};
use super::sobol::MOST_DIMENSIONS;
use model_tables::design_file::bounds::Bounds;
use model_tables::design_file::section::{KeyFault, Section, line_at};
use model_tables::design_file::{DesignFile, DesignFileError, Problem};
use output::files;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::Path;
use toml::de::DeTable;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// Designs of a part where a file does not say.
const DESIGNS_PER_PART: u64 = 1000;
/// Numbers that a part may hold, so that its memory stays far below 200 MB.
const MOST_NUMBERS: u64 = 2_000_000;
/// Designs of a sweep at most: what the Sobol sequence has.
const MOST_DESIGNS: u64 = 1 << 32;
/// Numbers of a row that is not a curve, about.
const NUMBERS_A_ROW: u64 = 40;
/// Lists of a curve, with what says how long they are.
const NUMBERS_A_STATE: u64 = 8;

/// What is computed of each design.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Computed {
    /// The rest state and the limits, as `designer rest`.
    pub rest: bool,
    /// States of a press, as `designer solve`.
    pub curve: bool,
    /// The tables, as `designer table`.
    pub tables: bool,
}

/// A sweep.
#[derive(Clone, Debug)]
pub struct Space {
    base: DocumentMut,
    /// What varies, in the order of the file.
    pub variables: Vec<Variable>,
    /// Its points.
    pub sample: Sample,
    /// What is computed.
    pub computed: Computed,
    /// States of a curve, equally spaced, the last at `press.max_indentation_mm`.
    pub curve_states: u64,
    /// Whether tables count that do not reach the accuracy that the design asks.
    pub allow_worse: bool,
    /// Designs of a part.
    pub designs_per_part: u64,
}

/// One key of the design that varies.
#[derive(Clone, Debug)]
pub struct Variable {
    /// The design's key, `membrane.thickness_mm`.
    pub key: String,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    Range {
        from: f64,
        to: f64,
        logarithmic: bool,
        steps: Option<u64>,
    },
    List(Vec<Value>),
}

impl Variable {
    /// Whether every value is a number.
    pub fn is_numeric(&self) -> bool {
        match &self.values {
            Values::Range { .. } => true,
            Values::List(values) => values.iter().all(|value| number(value).is_some()),
        }
    }

    /// Values of a grid.
    fn steps(&self) -> u64 {
        match &self.values {
            Values::Range { steps, .. } => steps.unwrap_or(1),
            Values::List(values) => values.len() as u64,
        }
    }

    /// The value at a part of the way, 0 to 1; a list's is the one whose share of the way that is.
    fn at(&self, part: f64) -> Value {
        match &self.values {
            Values::List(values) => {
                let place = (part * values.len() as f64) as usize;
                values[place.min(values.len() - 1)].clone()
            }
            &Values::Range {
                from,
                to,
                logarithmic,
                ..
            } => {
                // Exact at both ends.
                Value::from(if part <= 0.0 {
                    from
                } else if part >= 1.0 {
                    to
                } else if logarithmic {
                    from * libm::pow(to / from, part)
                } else {
                    from + (to - from) * part
                })
            }
        }
    }

    /// The value of a grid's step.
    fn step(&self, step: u64) -> Value {
        match &self.values {
            Values::List(values) => values[step as usize].clone(),
            Values::Range { .. } => self.at(step as f64 / (self.steps() - 1).max(1) as f64),
        }
    }
}

/// The number that a value is.
pub fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

impl Space {
    /// Reads and checks the file of a sweep, and the design that it names.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn read(path: &Path) -> Result<Self, DesignFileError> {
        let file = path.display().to_string();
        files::keep(path);
        let text = read(path)?;
        parse(&text, path).map_err(|(line, problem)| DesignFileError { file, line, problem })
    }

    /// The values of design `number`, in the order of [`Space::variables`].
    pub fn values(&self, number: u64) -> Vec<Value> {
        if self.sample.method == Method::Grid {
            // The last key changes fastest.
            let mut left = number;
            let mut values: Vec<Value> = self
                .variables
                .iter()
                .rev()
                .map(|variable| {
                    let steps = variable.steps();
                    let value = variable.step(left % steps);
                    left /= steps;
                    value
                })
                .collect();
            values.reverse();
            return values;
        }
        let unit = |dimension| self.sample.unit(number, dimension);
        let at = |(dimension, variable): (usize, &Variable)| variable.at(unit(dimension));
        self.variables.iter().enumerate().map(at).collect()
    }

    /// The text of a design with these values.
    pub fn design(&self, values: &[Value]) -> String {
        let mut document = self.base.clone();
        for (variable, value) in self.variables.iter().zip(values) {
            set(document.as_table_mut(), &variable.key, value.clone());
        }
        document.to_string()
    }

    /// Parts of the whole sweep.
    pub fn parts(&self) -> u64 {
        self.sample.count.div_ceil(self.designs_per_part)
    }

    /// SHA-256 of everything that the rows depend on, comments and layout left out.
    pub fn hash(&self) -> String {
        let mut text = String::new();
        flatten(self.base.as_table(), "", &mut text);
        let _ = writeln!(
            text,
            "{:?} {:?} {} {} {}",
            self.sample, self.computed, self.curve_states, self.allow_worse, self.designs_per_part
        );
        for variable in &self.variables {
            let _ = write!(text, "{} ", variable.key);
            match &variable.values {
                Values::Range { .. } => {
                    let _ = write!(text, "{:?}", variable.values);
                }
                Values::List(values) => {
                    for value in values {
                        let _ = write!(text, "{},", plain(value));
                    }
                }
            }
            text.push('\n');
        }
        let hash = Sha256::digest(text.as_bytes());
        hash.iter().fold(String::new(), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        })
    }
}

/// A value without the spaces and comments around it.
pub fn plain(value: &Value) -> String {
    value.clone().decorated("", "").to_string()
}

/// Every key and value of a table, sorted.
fn flatten(table: &dyn TableLike, above: &str, text: &mut String) {
    let mut lines: Vec<String> = table
        .iter()
        .map(|(key, item)| {
            let path = format!("{above}{key}");
            if let Some(table) = item.as_table_like() {
                let mut below = String::new();
                flatten(table, &format!("{path}."), &mut below);
                return below;
            }
            // White space around the numbers of a list is layout.
            let value: String = item.to_string().split_whitespace().collect();
            format!("{path} = {value}\n")
        })
        .collect();
    lines.sort();
    text.extend(lines);
}

/// Sets a key that may lie in sections; those that are missing are made.
fn set(table: &mut dyn TableLike, key: &str, value: Value) {
    match key.split_once('.') {
        None => {
            table.insert(key, Item::Value(value));
        }
        Some((section, rest)) => {
            let item = table.entry(section).or_insert(Item::Table(Table::new()));
            if !item.is_table_like() {
                *item = Item::Table(Table::new());
            }
            if let Some(below) = item.as_table_like_mut() {
                set(below, rest, value);
            }
        }
    }
}

fn read(path: &Path) -> Result<String, DesignFileError> {
    std::fs::read_to_string(path).map_err(|error| DesignFileError {
        file: path.display().to_string(),
        line: None,
        problem: Problem::Unreadable(error.to_string()),
    })
}

/// A value that is not allowed.
fn refuse<T>(
    key: impl Into<String>,
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> Result<T, KeyFault> {
    let problem = Problem::Value {
        key: key.into(),
        found: found.into(),
        allowed: allowed.into(),
    };
    Err((None, problem))
}

fn missing<T>(key: &str, allowed: &str) -> Result<T, KeyFault> {
    let (key, allowed) = (key.to_owned(), allowed.to_owned());
    Err((None, Problem::Missing { key, allowed }))
}

fn whole(section: &mut Section<'_>, key: &'static str, bounds: Bounds) -> Result<Option<u64>, KeyFault> {
    match section.number(key, bounds)? {
        Some(number) if libm::fmod(number, 1.0) > 0.0 => Err(section.refuse(key, "a whole number")),
        number => Ok(number.map(|number| number as u64)),
    }
}

fn parse(text: &str, path: &Path) -> Result<Space, KeyFault> {
    const METHODS: &str = "\"grid\", \"latin-hypercube\", \"sobol\" or \"random\"";
    let parsed = DeTable::parse(text).map_err(|error| {
        let line = error.span().map(|span| line_at(text, span.start));
        (line, Problem::Syntax(error.message().to_owned()))
    })?;
    let document: DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| (None, Problem::Syntax(error.message().to_owned())))?;
    let mut root = Section::root(text, parsed.get_ref());
    let base = base(&mut root, &document, path)?;
    let mut section = root.needed_sub("sweep", "method, compute")?;
    let method = section.needed_text("method", METHODS)?;
    let method = Method::named(method).ok_or_else(|| section.refuse("method", METHODS))?;
    let count = whole(
        &mut section,
        "count",
        Bounds::within(1.0, MOST_DESIGNS as f64, "(designs)"),
    )?;
    let seed = whole(&mut section, "seed", Bounds::within(0.0, 9e15, ""))?;
    let computed = computed(&mut section)?;
    let curve_states = whole(
        &mut section,
        "curve_states",
        Bounds::within(1.0, 10_000.0, "(states)"),
    )?;
    let per_part = whole(
        &mut section,
        "designs_per_part",
        Bounds::within(1.0, 1e6, "(designs)"),
    )?;
    let allow_worse = section.flag("allow_worse")?.unwrap_or(false);
    for (given, key, needs) in [
        (
            curve_states.is_some() && !computed.curve,
            "curve_states",
            "\"curve\"",
        ),
        (allow_worse && !computed.tables, "allow_worse", "\"tables\""),
        (seed.is_some() && method == Method::Grid, "seed", "another method"),
    ] {
        if given {
            return Err(section.refuse(key, &format!("left out, as it needs {needs} in [sweep]")));
        }
    }
    let curve_states = if computed.curve {
        curve_states.unwrap_or(33)
    } else {
        0
    };
    let variables = variables(&mut root, &document, method)?;
    if method == Method::Sobol && variables.len() > MOST_DIMENSIONS {
        return Err(section.refuse(
            "method",
            &format!("another one: sobol has {MOST_DIMENSIONS} keys at most"),
        ));
    }
    let count = match (method, count) {
        (Method::Grid, None) => {
            let all = variables
                .iter()
                .try_fold(1_u64, |all, variable| all.checked_mul(variable.steps()))
                .filter(|&all| all <= MOST_DESIGNS);
            all.ok_or_else(|| section.refuse("method", "another one: this grid has more than 2^32 designs"))?
        }
        (Method::Grid, Some(_)) => {
            return Err(section.refuse(
                "count",
                "left out: a grid has as many designs as its values combine to",
            ));
        }
        (_, Some(count)) => count,
        (_, None) => return Err(section.missing("count", "a whole number of designs")),
    };
    let numbers = NUMBERS_A_ROW + variables.len() as u64 + NUMBERS_A_STATE * curve_states;
    let most = (MOST_NUMBERS / numbers).max(1);
    let designs_per_part = match per_part {
        Some(given) if given > most => {
            let allowed =
                format!("at most {most} with so many columns and states, which keeps the memory small");
            return Err(section.refuse("designs_per_part", &allowed));
        }
        given => given.unwrap_or(DESIGNS_PER_PART.min(most)),
    };
    section.finish()?;
    root.finish()?;
    let sample = Sample {
        method,
        count,
        seed,
        dimensions: variables.len(),
    };
    let space = Space {
        base,
        variables,
        sample,
        computed,
        curve_states,
        allow_worse,
        designs_per_part,
    };
    check(&space)?;
    Ok(space)
}

/// The base design: a file, from the folder of the sweep's, or inline.
fn base(root: &mut Section<'_>, document: &DocumentMut, path: &Path) -> Result<DocumentMut, KeyFault> {
    const FILE: &str = "the path of a design file in quotes";
    let named = root.text("design", FILE)?;
    let inline = root.sub("base")?.is_some();
    match (named, inline) {
        (Some(_), true) => Err(root.refuse("design", "left out, as [base] is given")),
        (None, false) => Err(root.missing("design", &format!("{FILE}, or the design itself in [base]"))),
        (Some(name), false) => {
            let file = path.parent().unwrap_or(Path::new("")).join(name);
            files::keep(&file);
            let text = read(&file)
                .or_else(|error| refuse("design", format!("{name:?}"), format!("readable: {error}")))?;
            text.parse().or_else(|error: toml_edit::TomlError| {
                refuse(
                    "design",
                    format!("{name:?}"),
                    format!("valid TOML: {}", error.message()),
                )
            })
        }
        (None, true) => {
            let mut base = DocumentMut::new();
            for (key, item) in document["base"]
                .as_table_like()
                .into_iter()
                .flat_map(TableLike::iter)
            {
                base.insert(key, item.clone());
            }
            Ok(base)
        }
    }
}

fn computed(section: &mut Section<'_>) -> Result<Computed, KeyFault> {
    const ALLOWED: &str = "one or more of \"rest\", \"curve\", \"tables\" in brackets";
    let mut computed = Computed::default();
    for word in section.texts("compute", ALLOWED)? {
        match word {
            "rest" => computed.rest = true,
            "curve" => computed.curve = true,
            "tables" => computed.tables = true,
            _ => return Err(section.refuse("compute", ALLOWED)),
        }
    }
    Ok(computed)
}

fn variables(
    root: &mut Section<'_>,
    document: &DocumentMut,
    method: Method,
) -> Result<Vec<Variable>, KeyFault> {
    root.needed_sub(
        "vary",
        "keys of the design, each with a range or a list of values",
    )?;
    let mut found = Vec::new();
    if let Some(table) = document["vary"].as_table_like() {
        gather(table, "", method, &mut found)?;
    }
    if found.is_empty() {
        return missing(
            "vary",
            "one key of the design at least, with a range or a list of values",
        );
    }
    for (place, variable) in found.iter().enumerate() {
        let inside = |other: &Variable| {
            let (a, b) = (format!("{}.", variable.key), format!("{}.", other.key));
            a.starts_with(&b) || b.starts_with(&a)
        };
        if let Some(other) = found[..place].iter().find(|other| inside(other)) {
            let allowed = format!("left out, as {} is given, which holds the same key", other.key);
            return refuse(format!("vary.{}", variable.key), "given", allowed);
        }
    }
    Ok(found)
}

/// Ranges and lists of a table and of those in it: `membrane.thickness_mm` may stand in quotes or not.
fn gather(
    table: &dyn TableLike,
    above: &str,
    method: Method,
    found: &mut Vec<Variable>,
) -> Result<(), KeyFault> {
    const ALLOWED: &str = "a list of values, or a range { from, to } with steps or scale";
    for (name, item) in table.iter() {
        let key = format!("{above}{name}");
        let full = format!("vary.{key}");
        if let Some(list) = item.as_array() {
            let values: Vec<Value> = list.iter().map(|value| value.clone().decorated("", "")).collect();
            if values.is_empty() {
                return refuse(full, "[]", "a list with one value at least");
            }
            let values = Values::List(values);
            found.push(Variable { key, values });
        } else if let Some(below) = item.as_table_like() {
            if below.contains_key("from") || below.contains_key("to") {
                let values = range(below, &full, method)?;
                found.push(Variable { key, values });
            } else if below.is_empty() {
                return refuse(full, "{}", ALLOWED);
            } else {
                gather(below, &format!("{key}."), method, found)?;
            }
        } else {
            return refuse(full, item.to_string().trim(), ALLOWED);
        }
    }
    Ok(())
}

fn range(table: &dyn TableLike, key: &str, method: Method) -> Result<Values, KeyFault> {
    let known = ["from", "to", "steps", "scale"];
    if let Some((name, _)) = table.iter().find(|(name, _)| !known.contains(name)) {
        let (key, allowed) = (format!("{key}.{name}"), known.join(", "));
        return Err((None, Problem::Unknown { key, allowed }));
    }
    let end = |name: &str| -> Result<f64, KeyFault> {
        let Some(item) = table.get(name) else {
            return missing(&format!("{key}.{name}"), "the number at this end of the range");
        };
        match item
            .as_value()
            .and_then(number)
            .filter(|number| number.is_finite())
        {
            Some(number) => Ok(number),
            None => refuse(
                format!("{key}.{name}"),
                item.to_string().trim(),
                "a finite number",
            ),
        }
    };
    let (from, to) = (end("from")?, end("to")?);
    if from >= to {
        return refuse(
            format!("{key}.to"),
            to.to_string(),
            format!("more than from, {from}"),
        );
    }
    let logarithmic = match table.get("scale") {
        None => false,
        Some(item) => match item.as_str() {
            Some("linear") => false,
            Some("log") => true,
            _ => {
                return refuse(
                    format!("{key}.scale"),
                    item.to_string().trim(),
                    "\"linear\" or \"log\"",
                );
            }
        },
    };
    if logarithmic && from <= 0.0 {
        return refuse(
            format!("{key}.from"),
            from.to_string(),
            "above 0, as scale is \"log\"",
        );
    }
    let steps = match (table.get("steps"), method == Method::Grid) {
        (None, false) => None,
        (None, true) => {
            return missing(
                &format!("{key}.steps"),
                "a whole number of values, 2 or more, as the method is \"grid\"",
            );
        }
        (Some(item), false) => {
            return refuse(
                format!("{key}.steps"),
                item.to_string().trim(),
                "left out: only a grid has steps",
            );
        }
        (Some(item), true) => match item.as_integer().filter(|steps| (2..=1_000_000).contains(steps)) {
            Some(steps) => Some(steps as u64),
            None => {
                return refuse(
                    format!("{key}.steps"),
                    item.to_string().trim(),
                    "a whole number from 2 to 1 000 000",
                );
            }
        },
    };
    Ok(Values::Range {
        from,
        to,
        logarithmic,
        steps,
    })
}

/// Refuses what would be refused of every design alike.
fn check(space: &Space) -> Result<(), KeyFault> {
    let text = space.design(&space.values(0));
    match DesignFile::parse(&text, "") {
        Err(error) => match error.problem {
            Problem::Unknown { key, allowed } => {
                let section = key.rsplit_once('.').map_or("", |(section, _)| section);
                let varies =
                    |variable: &Variable| variable.key == key || variable.key.starts_with(&format!("{key}."));
                if space.variables.iter().any(varies) {
                    let key = format!("vary.{key}");
                    return Err((None, Problem::Unknown { key, allowed }));
                }
                // A law that varies may leave a constant over, of its design alone.
                let beside = |variable: &Variable| variable.key.starts_with(section);
                if !section.is_empty() && space.variables.iter().any(beside) {
                    return Ok(());
                }
                Err((None, Problem::Unknown { key, allowed }))
            }
            Problem::Syntax(reason) => Err((None, Problem::Syntax(reason))),
            // What a value of the first design does may be its alone.
            _ => Ok(()),
        },
        Ok(design) => {
            let needs = |key: &str, of: &str| {
                missing(
                    key,
                    &format!("in the design, as [sweep] compute asks for \"{of}\""),
                )
            };
            let Computed { curve, tables, .. } = space.computed;
            if design.max_indentation_mm.is_none() && (curve || tables) {
                return needs("[press]", if curve { "curve" } else { "tables" });
            }
            if tables && design.transducer.is_none() {
                return needs("[transducer]", "tables");
            }
            if tables && design.accuracy.is_none() {
                return needs("[accuracy]", "tables");
            }
            Ok(())
        }
    }
}
