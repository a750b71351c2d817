//! The file of a sweep: a base design, what varies, and what is computed.

use super::sample::{SamplePoints, Sampling};
use super::sobol::MAX_DIMENSIONS;
use super::vary::{Variable, missing, refuse, variables};
use model_tables::design_file::bounds::Bounds;
use model_tables::design_file::section::{KeyFault, Section};
use model_tables::design_file::{DesignFile, DesignFileError, Problem, document};
use output::files;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::Path;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// Designs of a part where a file does not say.
const DESIGNS_PER_PART: u64 = 1000;
/// Numbers that a part may hold, so that its memory stays far below 200 MB.
const MAX_NUMBERS: u64 = 2_000_000;
/// Designs of a sweep at most: what the Sobol sequence has.
const MAX_DESIGNS: u64 = 1 << 32;
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
    pub sample: SamplePoints,
    /// What is computed.
    pub computed: Computed,
    /// States of a curve, equally spaced, the last at `press.max_indentation_mm`.
    pub curve_states: u64,
    /// Whether tables count that do not reach the accuracy that the design asks.
    pub allow_worse: bool,
    /// Designs of a part.
    pub designs_per_part: u64,
}

impl Space {
    /// Reads and checks the file of a sweep, and the design that it names.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn read(path: &Path) -> Result<Self, DesignFileError> {
        let file = path.display().to_string();
        files::keep(path);
        let text = document::read(path)?;
        parse(&text, path).map_err(|fault| DesignFileError::at(&file, fault))
    }

    /// Checks the text of a sweep's file that has its design in `[base]`; `name` is what errors call it.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn parse(text: &str, name: &str) -> Result<Self, DesignFileError> {
        parse(text, Path::new(name)).map_err(|fault| DesignFileError::at(name, fault))
    }

    /// The values of design `number`, in the order of [`Space::variables`].
    pub fn values(&self, number: u64) -> Vec<Value> {
        if self.sample.method == Sampling::Grid {
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

    /// Keys and sections of the base design.
    pub(super) fn base(&self) -> toml_edit::Iter<'_> {
        self.base.iter()
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
            text += &variable.describe();
            text.push('\n');
        }
        let hash = Sha256::digest(text.as_bytes());
        hash.iter().fold(String::new(), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        })
    }
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

fn whole(section: &mut Section<'_>, key: &'static str, bounds: Bounds) -> Result<Option<u64>, KeyFault> {
    match section.number(key, bounds)? {
        Some(number) if libm::fmod(number, 1.0) > 0.0 => Err(section.refuse(key, "a whole number")),
        number => Ok(number.map(|number| number as u64)),
    }
}

fn parse(text: &str, path: &Path) -> Result<Space, KeyFault> {
    const METHODS: &str = "\"grid\", \"latin-hypercube\", \"sobol\" or \"random\"";
    let parsed = document::tables(text)?;
    let document: DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| (None, Problem::Syntax(error.message().to_owned())))?;
    let mut root = Section::root(text, parsed.get_ref());
    let base = base(&mut root, &document, path)?;
    let mut section = root.needed_sub("sweep", "method, compute")?;
    let method = section.needed_text("method", METHODS)?;
    let method = Sampling::named(method).ok_or_else(|| section.refuse("method", METHODS))?;
    let count = whole(
        &mut section,
        "count",
        Bounds::within(1.0, MAX_DESIGNS as f64, "(designs)"),
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
        (
            seed.is_some() && method == Sampling::Grid,
            "seed",
            "another method",
        ),
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
    root.needed_sub(
        "vary",
        "keys of the design, each with a range or a list of values",
    )?;
    let varied = document["vary"].as_table_like();
    let variables = varied.map_or(Ok(Vec::new()), |table| variables(table, method))?;
    if method == Sampling::Sobol && variables.len() > MAX_DIMENSIONS {
        return Err(section.refuse(
            "method",
            &format!("another one: sobol has {MAX_DIMENSIONS} keys at most"),
        ));
    }
    let count = designs(&section, method, count, &variables)?;
    let designs_per_part = part_size(&section, per_part, variables.len() as u64, curve_states)?;
    section.finish()?;
    root.finish()?;
    let sample = SamplePoints {
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

/// How many designs there are.
fn designs(
    section: &Section<'_>,
    method: Sampling,
    count: Option<u64>,
    variables: &[Variable],
) -> Result<u64, KeyFault> {
    match (method, count) {
        (Sampling::Grid, None) => {
            let all = variables
                .iter()
                .try_fold(1_u64, |all, variable| all.checked_mul(variable.steps()))
                .filter(|&all| all <= MAX_DESIGNS);
            all.ok_or_else(|| section.refuse("method", "another one: this grid has more than 2^32 designs"))
        }
        (Sampling::Grid, Some(_)) => Err(section.refuse(
            "count",
            "left out: a grid has as many designs as its values combine to",
        )),
        (_, Some(count)) => Ok(count),
        (_, None) => Err(section.missing("count", "a whole number of designs")),
    }
}

/// Designs of a part, so few that its numbers take little memory.
fn part_size(
    section: &Section<'_>,
    asked: Option<u64>,
    variables: u64,
    curve_states: u64,
) -> Result<u64, KeyFault> {
    let numbers = NUMBERS_A_ROW + variables + NUMBERS_A_STATE * curve_states;
    let most = (MAX_NUMBERS / numbers).max(1);
    if asked.is_some_and(|asked| asked > most) {
        let allowed = format!("at most {most} with so many columns and states, which keeps the memory small");
        return Err(section.refuse("designs_per_part", &allowed));
    }
    Ok(asked.unwrap_or(DESIGNS_PER_PART.min(most)))
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
            let text = document::read(&file)
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
