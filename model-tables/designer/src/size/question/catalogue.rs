//! The catalogue of pressure transducers (TOML): the parts that a sizing chooses from.

use model_tables::constants::{Quantity, period};
use model_tables::design_file::bounds::Bounds;
use model_tables::design_file::section::{KeyFault, Section};
use model_tables::design_file::{
    DesignFile, DesignFileError, Problem, TransducerKindSection, TransducerSection, document,
};
use std::fmt::Write as _;
use std::path::Path;

/// The shipped catalogue.
pub const SHIPPED: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../transducers.toml"));
/// Weather: what moves the zero of an absolute part, pascals a second (1 hPa an hour).
const WEATHER: f64 = 100.0 / 3600.0;
/// A touch begins above this many noise floors over the zero (`TOUCH_FLOORS` of the firmware).
pub const TOUCH_FLOORS: f64 = 6.0;
/// What may press on a part.
pub const MEDIA: [&str; 3] = ["air", "oil", "water"];

/// A transducer that can be bought.
#[derive(Clone, Debug, PartialEq)]
pub struct CataloguePart {
    /// Its name in the catalogue.
    pub name: String,
    /// Its name for people.
    pub title: String,
    /// `[transducer]` of a design that has it.
    pub section: TransducerSection,
    /// The same as text.
    pub text: String,
    /// What may press on it, of [`MEDIA`].
    pub media: Vec<String>,
    /// Source of its noise.
    pub noise_from: String,
    /// Its datasheet.
    pub datasheet: String,
}

impl CataloguePart {
    /// Reports a second that the firmware makes of it.
    pub fn rate(&self) -> f64 {
        let period = match self.section.kind {
            TransducerKindSection::Ratiometric { .. } => period::CONVERTER,
            TransducerKindSection::Abp2 { .. } => period::ABP2,
            TransducerKindSection::Ms5837 => period::MS5837,
            TransducerKindSection::Dps310 { .. } => period::DPS310,
        };
        1e6 / f64::from(period)
    }

    /// The largest gauge pressure that it reads, pascals.
    pub fn highest(&self) -> f64 {
        1e3 * self.section.gauge_range_kpa()[1]
    }

    /// The largest change of its zero within a grasp, pascals: the weather, of an absolute part.
    pub fn weather(&self, grasp_s: f64) -> f64 {
        match self.section.quantity {
            Quantity::Absolute => WEATHER * grasp_s,
            Quantity::Gauge => 0.0,
        }
    }

    /// The least pressure rise that is a touch at the end of a grasp, pascals.
    pub fn touch(&self, grasp_s: f64) -> f64 {
        let floor = self.section.noise_pa.max(self.section.resolution_pa);
        TOUCH_FLOORS * floor + self.weather(grasp_s)
    }
}

/// Reads a catalogue.
///
/// # Errors
/// [`DesignFileError`] with the file's name, and the line where there is one.
pub fn read(path: &Path) -> Result<Vec<CataloguePart>, DesignFileError> {
    parse(&document::read(path)?, &path.display().to_string())
}

/// Checks the text of a catalogue; `file` is the name that errors give it.
///
/// # Errors
/// [`DesignFileError`] for the first thing that is wrong.
pub fn parse(text: &str, file: &str) -> Result<Vec<CataloguePart>, DesignFileError> {
    parts(text).map_err(|fault| DesignFileError::at(file, fault))
}

fn parts(text: &str) -> Result<Vec<CataloguePart>, KeyFault> {
    let tables = document::tables(text)?;
    let mut root = Section::root(text, tables.get_ref());
    let listed = root.needed_sub("part", "a table for each transducer, as [part.NAME]")?;
    root.finish()?;
    listed
        .every_sub()?
        .into_iter()
        .map(|(name, section)| part(name, section))
        .collect()
}

fn part(name: &str, mut section: Section<'_>) -> Result<CataloguePart, KeyFault> {
    const PRESSURE: Bounds = Bounds::within(-101.325, 2_000.0, "kPa");
    const FINENESS: Bounds = Bounds::above(0.0, 1e6, "Pa");
    const WORDS: &str = "words in quotes";
    const MEDIUM: &str = "some of \"air\", \"oil\", \"water\" in brackets";
    let title = section.needed_text("title", WORDS)?.to_owned();
    let kind = section.needed_text("kind", "a transducer.kind of a design")?;
    let [low, high] = section.needed_pair("range_kpa", PRESSURE)?;
    let resolution = section.needed_number("resolution_pa", FINENESS)?;
    let noise = section.needed_number("noise_pa", FINENESS)?;
    let mut text = format!(
        "[transducer]\nkind = {kind:?}\nrange_kpa = [{low:?}, {high:?}]\nresolution_pa = {resolution:?}\nnoise_pa = {noise:?}\n"
    );
    if let Some([low, high]) = section.pair(
        "output_fraction_at_range",
        Bounds::within(0.0, 1.0, "of the supply"),
    )? {
        let _ = writeln!(text, "output_fraction_at_range = [{low:?}, {high:?}]");
    }
    for key in ["supply", "transfer"] {
        if let Some(value) = section.text(key, WORDS)? {
            let _ = writeln!(text, "{key} = {value:?}");
        }
    }
    let media: Vec<String> = section
        .texts("media", MEDIUM)?
        .into_iter()
        .map(str::to_owned)
        .collect();
    if media.is_empty() || media.iter().any(|medium| !MEDIA.contains(&medium.as_str())) {
        return Err(section.refuse("media", MEDIUM));
    }
    let noise_from = section.needed_text("noise_from", WORDS)?.to_owned();
    let datasheet = section.needed_text("datasheet", WORDS)?.to_owned();
    // Checked as a design's.
    let design = format!(
        "name = \"x\"\n[membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 1\n\
         [material]\npreset = \"skin\"\n[model]\nkind = \"auto\"\n{text}"
    );
    let transducer = DesignFile::parse(&design, "")
        .map_err(|error| error.problem)
        .and_then(|design| {
            design.transducer.ok_or(Problem::Missing {
                key: "[transducer]".to_owned(),
                allowed: String::new(),
            })
        })
        .map_err(|problem| (section.line(), problem))?;
    let line = section.line();
    section.finish()?;
    if transducer.range_is_absolute() {
        let problem = Problem::Value {
            key: format!("part.{name}.range_kpa"),
            found: format!("[{low}, {high}]"),
            allowed: "gauge pressures".to_owned(),
        };
        return Err((line, problem));
    }
    Ok(CataloguePart {
        name: name.to_owned(),
        title,
        section: transducer,
        text,
        media,
        noise_from,
        datasheet,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_catalogue_is_read_whole() {
        let parts = parse(SHIPPED, "transducers.toml").expect("parts");
        assert_eq!(parts.len(), SHIPPED.matches("[part.").count());
        let named = |name: &str| parts.iter().find(|part| part.name == name).expect("listed");
        // The firmware's periods: 1, 7, 8 and 14 ms.
        assert!((named("hsc-100kpa").rate() - 1000.0).abs() < 1e-9);
        assert!((named("ms5837-02ba").rate() - 142.86).abs() < 0.01);
        assert!((named("abp2-100kpa").rate() - 125.0).abs() < 1e-9);
        // An hour of weather is 100 Pa, on an absolute part alone.
        assert!((named("ms5837-02ba").touch(3600.0) - 6.0 * 2.8 - 100.0).abs() < 1e-9);
        assert!((named("abp2-100kpa").touch(3600.0) - 60.0).abs() < 1e-9);
    }

    #[test]
    fn a_part_that_is_no_transducer_is_refused_by_its_key() {
        for (from, to, key) in [
            ("kind = \"dps310\"", "kind = \"bmp390\"", "transducer.kind"),
            (
                "range_kpa = [0.0, 12.0]",
                "range_kpa = [0.0, 30.0]",
                "transducer.range_kpa",
            ),
            ("media = [\"air\"]", "media = [\"blood\"]", "part.dps310.media"),
            (
                "datasheet = \"Infineon",
                "sheet = \"Infineon",
                "part.dps310.datasheet",
            ),
        ] {
            assert!(SHIPPED.contains(from), "{from}");
            let error = parse(&SHIPPED.replacen(from, to, 1), "t.toml")
                .expect_err("refused")
                .to_string();
            assert!(error.contains(key), "{error}");
        }
    }
}
