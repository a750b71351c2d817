//! The file of a hand: its tips, each with its own design and the input of its transducer on the board.

pub mod bus;

use super::bounds::Bounds;
use super::document;
use super::error::{DesignFileError, Problem};
use super::section::{KeyFault, Section};
use super::{DesignFile, Supply, TransducerKindSection};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use toml::de::DeTable;

/// Analogue inputs that every board offers a hand.
pub const CHANNELS: u8 = 6;
/// Tips that a frame can number.
pub const MAX_TIPS: usize = 12;
/// Bytes of a tip's name that a frame carries.
const TIP_NAME: usize = 32;
const KEYS: &str = "a `[[tip]]` with name, design, and channel or bus";

/// A hand file's content.
#[derive(Clone, Debug, PartialEq)]
pub struct HandFile {
    /// The hand's name: letters, digits, `-` and `_`.
    pub name: String,
    /// `[[tip]]`, in the order of the file: at least one.
    pub tips: Vec<TipSection>,
    /// Of error messages.
    file: String,
}

/// `[[tip]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct TipSection {
    /// Its name: letters, digits, `-` and `_`, no two of a hand alike.
    pub name: String,
    /// Its design file.
    pub design: PathBuf,
    /// Where its transducer is.
    pub place: TransducerPlace,
    /// Line of its `design` in the hand's file, counted from 1.
    line: Option<usize>,
}

/// Where a tip's transducer is on the board.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum TransducerPlace {
    /// `channel`: an analogue input of the board's table, 0 to [`CHANNELS`] - 1.
    Channel(u8),
    /// `bus`, `address`, `multiplexer`: a part on an I2C bus.
    Bus {
        /// Number of the bus, from 1.
        bus: u8,
        /// The multiplexer that it is behind.
        branch: Option<MultiplexerBranch>,
        /// Its seven-bit address; `None`: its design's.
        address: Option<u8>,
    },
}

/// A branch of a TCA9548A (Texas Instruments, SCPS207).
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct MultiplexerBranch {
    /// The multiplexer's seven-bit address, 0x70 to 0x77 (section 8.6.2).
    pub multiplexer: u8,
    /// Its downstream channel, 0 to 7.
    pub number: u8,
}

/// Whether the text is of a hand.
pub fn is_hand(text: &str) -> bool {
    DeTable::parse(text).is_ok_and(|document| designs_in(document.get_ref()).is_some())
}

/// The design files that the tips of a hand name, each once; `None` where the document has no `tip`.
pub(super) fn designs_in(document: &DeTable<'_>) -> Option<String> {
    let tips = document.get("tip")?.get_ref();
    let names = tips.as_array().map(|tips| {
        tips.iter()
            .filter_map(|tip| tip.get_ref().as_table()?.get("design")?.get_ref().as_str())
            .fold(Vec::new(), |mut names, name| {
                if !names.contains(&name) {
                    names.push(name);
                }
                names
            })
    });
    Some(names.unwrap_or_default().join(", "))
}

impl HandFile {
    /// Reads and checks a hand file; its designs are not read.
    ///
    /// # Errors
    /// [`DesignFileError`] with the file's name, and the line where there is one.
    pub fn read(path: &Path) -> Result<Self, DesignFileError> {
        Self::parse(&document::read(path)?, &path.display().to_string())
    }

    /// Checks the text of a hand file. `file` is its path: designs are relative to its folder, and errors give it as the name.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, DesignFileError> {
        hand(text, file).map_err(|fault| DesignFileError::at(file, fault))
    }

    /// The designs of its tips, in their order, each checked against the place that its tip names.
    ///
    /// # Errors
    /// [`DesignFileError`] of a design, or of the tip that a design, its address or the time of the bus does not fit.
    pub fn designs(&self) -> Result<Vec<DesignFile>, DesignFileError> {
        let designs: Vec<DesignFile> = self
            .tips
            .iter()
            .map(|tip| self.design(tip))
            .collect::<Result<_, _>>()?;
        let analogue = |tip: &TipSection| matches!(tip.place, TransducerPlace::Channel(_));
        if let Some(tip) = self.tips.iter().find(|tip| !analogue(tip))
            && let Some(other) = self.tips.iter().find(|tip| analogue(tip))
        {
            let found = format!("on the bus, and that of {} on the converter", other.name);
            let allowed = "on the same as all others: a hand's reports are of one instant, and the two have periods of their own";
            return Err(self.refuse(tip, "place", found, allowed));
        }
        bus::BusRound::of(self, &designs, bus::SET_UP)?;
        Ok(designs)
    }

    /// The first eight bytes, big-endian, of the SHA-256 of its tips: their names, where they are, and the hashes of their designs.
    pub fn hash(&self, designs: &[DesignFile]) -> u64 {
        hash(self.tips.iter().zip(designs))
    }

    /// The same of each tip alone: what its stored calibration is for.
    pub fn tip_hashes(&self, designs: &[DesignFile]) -> Vec<u64> {
        let tips = self.tips.iter().zip(designs);
        tips.map(|tip| hash([tip])).collect()
    }

    fn design(&self, tip: &TipSection) -> Result<DesignFile, DesignFileError> {
        let design = DesignFile::read(&tip.design)?;
        let path = tip.design.display().to_string();
        let Some(transducer) = &design.transducer else {
            return Err(self.refuse(tip, "design", path, "a design with a [transducer]"));
        };
        let wanted = match (tip.place, &transducer.kind) {
            (TransducerPlace::Channel(_), TransducerKindSection::Ratiometric { supply, .. }) => {
                match supply {
                    Supply::Reference => None,
                    Supply::Measured => {
                        Some("one with transducer.supply = \"reference\": a hand's scan measures no supply")
                    }
                }
            }
            (TransducerPlace::Channel(_), _) => Some(
                "one whose transducer.kind is \"ratiometric\", as the tip has `channel`; give `bus` for a part on a bus",
            ),
            (TransducerPlace::Bus { .. }, TransducerKindSection::Ratiometric { .. }) => Some(
                "one whose transducer is on a bus, as the tip has `bus`; give `channel` for a ratiometric one",
            ),
            (TransducerPlace::Bus { .. }, _) => None,
        };
        match wanted {
            None => Ok(design),
            Some(wanted) => Err(self.refuse(tip, "design", path, wanted)),
        }
    }

    fn refuse(&self, tip: &TipSection, key: &str, found: String, allowed: &str) -> DesignFileError {
        DesignFileError {
            file: self.file.clone(),
            line: tip.line,
            problem: Problem::Value {
                key: format!("tip.{key} of {}", tip.name),
                found,
                allowed: allowed.to_owned(),
            },
        }
    }
}

fn hash<'a>(tips: impl IntoIterator<Item = (&'a TipSection, &'a DesignFile)>) -> u64 {
    let mut digest = Sha256::new();
    for (tip, design) in tips {
        digest.update(format!("{} {:?} ", tip.name, tip.place));
        digest.update(design.hash());
    }
    let [a, b, c, d, e, f, g, h, ..] = <[u8; 32]>::from(digest.finalize());
    u64::from_be_bytes([a, b, c, d, e, f, g, h])
}

fn hand(text: &str, file: &str) -> Result<HandFile, KeyFault> {
    let tables = document::tables(text)?;
    let mut root = Section::root(text, tables.get_ref());
    let name = root.name(64, document::NAME)?;
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let mut tips: Vec<TipSection> = Vec::new();
    let sections = root.subs("tip", KEYS)?;
    for mut section in sections {
        let tip = tip(&mut section, folder)?;
        check(&section, &tips, &tip)?;
        section.finish()?;
        tips.push(tip);
    }
    root.finish()?;
    Ok(HandFile {
        name,
        tips,
        file: file.to_owned(),
    })
}

fn tip(section: &mut Section<'_>, folder: &Path) -> Result<TipSection, KeyFault> {
    const DESIGN: &str = "a design file in quotes, relative to the hand's file";
    let name = section.name(TIP_NAME, "1 to 32 letters, digits, `-` or `_` in quotes")?;
    let design = folder.join(section.needed_text("design", DESIGN)?);
    let line = section.line_of("design");
    let channel = section.number(
        "channel",
        Bounds::within(0.0, f64::from(CHANNELS - 1), "(an analogue input of the board)"),
    )?;
    let bus = section.number("bus", Bounds::within(1.0, 1.0, "(the board's I2C bus)"))?;
    let place = match (channel, bus) {
        (Some(channel), None) => {
            for key in ["address", "multiplexer"] {
                if section.has(key) {
                    return Err(section.refuse(key, "left out, as channel is given"));
                }
            }
            TransducerPlace::Channel(integer(section, "channel", channel)?)
        }
        (None, Some(bus)) => TransducerPlace::Bus {
            bus: integer(section, "bus", bus)?,
            branch: branch(section)?,
            address: section
                .number("address", Bounds::within(8.0, 119.0, "(a seven-bit address)"))?
                .map(|address| integer(section, "address", address))
                .transpose()?,
        },
        (Some(_), Some(_)) => return Err(section.refuse("bus", "left out, as channel is given")),
        (None, None) => {
            return Err(section.missing("channel", "an analogue input, 0 to 5, or bus for a part on a bus"));
        }
    };
    Ok(TipSection {
        name,
        design,
        place,
        line,
    })
}

fn branch(section: &mut Section<'_>) -> Result<Option<MultiplexerBranch>, KeyFault> {
    const BRANCH: &str = "[address, branch] of a TCA9548A: 0x70 to 0x77, and 0 to 7";
    let numbers = section.whole_numbers("multiplexer", BRANCH)?;
    match numbers.as_deref() {
        None => Ok(None),
        Some(&[multiplexer @ 0x70..=0x77, number @ 0..=7]) => Ok(Some(MultiplexerBranch {
            multiplexer: multiplexer as u8,
            number: number as u8,
        })),
        Some(_) => Err(section.refuse("multiplexer", BRANCH)),
    }
}

fn integer(section: &Section<'_>, key: &str, number: f64) -> Result<u8, KeyFault> {
    if libm::fmod(number, 1.0) > 0.0 {
        Err(section.refuse(key, "a whole number"))
    } else {
        Ok(number as u8)
    }
}

/// A tip beside those before it.
fn check(section: &Section<'_>, before: &[TipSection], tip: &TipSection) -> Result<(), KeyFault> {
    if before.len() == MAX_TIPS {
        return Err(section.refuse("name", &format!("one of at most {MAX_TIPS} tips of a hand")));
    }
    if before.iter().any(|other| other.name == tip.name) {
        return Err(section.refuse("name", "another one than every other tip's of the hand"));
    }
    if let TransducerPlace::Channel(_) = tip.place
        && let Some(other) = before.iter().find(|other| other.place == tip.place)
    {
        let analogue = before
            .iter()
            .filter(|tip| matches!(tip.place, TransducerPlace::Channel(_)));
        let allowed = if analogue.count() == usize::from(CHANNELS) {
            format!("left out: a board reads {CHANNELS} analogue tips, and all are taken")
        } else {
            format!("another one than that of tip {}", other.name)
        };
        return Err(section.refuse("channel", &allowed));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
