//! The data of a tip -> a block of bytes.

use super::field::{Field, Visit};
use super::section::{self, SectionKind};
use super::{CHECK_AT, ENTRY, HEAD, LAYOUT_VERSION, MAGIC, StoredCalibration, aligned, check};
use crate::constants::{DesignConstants, ZeroAssumptions};
use crate::material::series::WallSeries;
use crate::table::Layout;
use crate::table::feedback::FeedbackScale;
use crate::table::law::{BlendLaw, Touched};
use core::convert::Infallible;

/// What a block is made of.
#[derive(Clone, Copy, Debug)]
pub struct TipData<'a> {
    /// The design beside its tables.
    pub constants: DesignConstants,
    /// Where the segments lie.
    pub layout: Layout,
    /// Their words.
    pub words: &'a [i32],
    /// The design's name.
    pub name: &'a str,
    /// Calibration of this one fingertip; `None` where it was not calibrated.
    pub calibration: Option<StoredCalibration>,
    /// The wall in time; `None` of an elastic wall.
    pub relaxation: Option<WallSeries>,
    /// Tables of other objects; `None` where the design has no `[object]`.
    pub object: Option<ObjectData<'a>>,
    /// The force of the feedback actuator, and its words; `None` where the design has none that presses.
    pub feedback: Option<(FeedbackScale, &'a [i32])>,
}

/// Tables of other objects than a plate.
#[derive(Clone, Copy, Debug)]
pub struct ObjectData<'a> {
    /// What is touched at the start.
    pub start: Touched,
    /// The weights over the radius.
    pub law: BlendLaw,
    /// The reference ball's words.
    pub words: &'a [i32],
}

/// Adds the bytes of each field.
struct Bytes(Vec<u8>);

impl Visit for Bytes {
    type Stop = Infallible;

    fn field<T: Field>(&mut self, _name: &'static str, value: &mut T) -> Result<(), Infallible> {
        value.put(&mut self.0);
        Ok(())
    }
}

/// The bytes that a description of fields gives.
fn described(describe: impl FnOnce(&mut Bytes) -> Result<(), Infallible>) -> Vec<u8> {
    let mut bytes = Bytes(Vec::new());
    let Ok(()) = describe(&mut bytes);
    bytes.0
}

impl TipData<'_> {
    /// The block.
    pub fn write(&self) -> Vec<u8> {
        let Self {
            mut constants,
            mut layout,
            mut calibration,
            mut relaxation,
            object,
            feedback,
            ..
        } = *self;
        let identity = described(|visit| section::identity(&mut constants, visit));
        let mut sections = vec![
            (
                SectionKind::Constants,
                described(|visit| {
                    section::pressures(&mut constants, visit)?;
                    section::transducer(&mut constants.transducer, visit)
                }),
            ),
            (
                SectionKind::Tables,
                described(|visit| {
                    section::layout(&mut layout, visit)?;
                    all(self.words, visit)
                }),
            ),
        ];
        if let Some(calibration) = &mut calibration {
            let bytes = described(|visit| section::calibration(calibration, visit));
            sections.push((SectionKind::Calibration, bytes));
        }
        sections.push((SectionKind::Name, self.name.as_bytes().to_vec()));
        if let Some(wall) = &mut relaxation {
            let bytes = described(|visit| {
                section::relaxation(wall, visit)?;
                let mut terms = wall.step.terms().iter();
                terms.try_for_each(|&term| visit.field("term", &mut { term }))
            });
            sections.push((SectionKind::Relaxation, bytes));
        }
        if let Some(mut object) = object {
            let bytes = described(|visit| {
                section::object(&mut object.start, &mut object.law, visit)?;
                all(object.words, visit)
            });
            sections.push((SectionKind::Object, bytes));
        }
        if let Some((mut scale, words)) = feedback {
            let bytes = described(|visit| {
                section::feedback(&mut scale, visit)?;
                all(words, visit)
            });
            sections.push((SectionKind::Feedback, bytes));
        }
        if constants.zero != ZeroAssumptions::NONE {
            let bytes = described(|visit| section::zero(&mut constants.zero, visit));
            sections.push((SectionKind::Zero, bytes));
        }
        block(&identity, &sections)
    }
}

/// Words of tables.
fn all(words: &[i32], visit: &mut Bytes) -> Result<(), Infallible> {
    words
        .iter()
        .try_for_each(|&word| visit.field("word", &mut { word }))
}

/// Head, directory, sections, each from a multiple of four on.
fn block(identity: &[u8], sections: &[(SectionKind, Vec<u8>)]) -> Vec<u8> {
    let head = HEAD + ENTRY * sections.len();
    let mut bytes = Vec::from(MAGIC);
    LAYOUT_VERSION.put(&mut bytes);
    (head as u16).put(&mut bytes);
    // Length and check, known at the end.
    [0_u32; 2].put(&mut bytes);
    bytes.extend(identity);
    (sections.len() as u32).put(&mut bytes);
    let mut end = head;
    for (kind, section) in sections {
        (*kind as u16).put(&mut bytes);
        SectionKind::VERSION.put(&mut bytes);
        let start = aligned(end);
        [start as u32, section.len() as u32].put(&mut bytes);
        end = start + section.len();
    }
    for (_, section) in sections {
        bytes.resize(aligned(bytes.len()), 0);
        bytes.extend(section);
    }
    let total = bytes.len() as u32;
    bytes[CHECK_AT - 4..CHECK_AT].copy_from_slice(&total.to_le_bytes());
    sign(&mut bytes);
    bytes
}

/// Puts the check into a block whose other bytes are final.
pub fn sign(block: &mut [u8]) {
    let sum = check(block);
    if let Some(place) = block.get_mut(CHECK_AT..CHECK_AT + 4) {
        place.copy_from_slice(&sum.to_le_bytes());
    }
}
