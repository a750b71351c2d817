//! Reads a block of bytes into the data of a tip, or gives the reason for a refusal. Work and memory are bounded, nothing is
//! copied, and no byte sequence causes a panic or a read outside the block.

use super::field::{Field, Visit};
use super::section::{self, SectionKind};
use super::{
    BlockError, ENTRY, HEAD, LAYOUT_VERSION, LONGEST_NAME, MAGIC, StoredCalibration, aligned, check,
};
use crate::constants::{DesignConstants, Quantity, Transducer, TransducerKind, ZeroAssumptions};
use crate::material::series::{SeriesStep, WallSeries};
use crate::table::LoadedTables;
use crate::table::feedback::{FeedbackScale, LoadedFeedback};
use crate::table::law::{BlendLaw, Touched};
use crate::table::objects::LoadedObjects;
use crate::table::{Constant, Layout, Powers};

/// Widest range of a transducer, pascals: in millipascals it fits a word.
const WIDEST_RANGE: i32 = 2_000_000;

/// Largest value of the section of the zero, millipascals: 100 kPa, so that no sum of them leaves a word.
pub const LARGEST_STATED: i32 = 100_000_000;

/// Forces of the feedback actuator at rest are below this, micronewtons.
const LARGEST_FORCE: i32 = 1 << 30;

/// The data of one tip, checked; words and name stay in the block.
#[derive(Clone, Copy, Debug)]
pub struct TipBlock<'a> {
    /// The design beside its tables.
    pub constants: DesignConstants,
    /// Its tables.
    pub tables: LoadedTables<'a>,
    /// Its name.
    pub name: &'a str,
    /// Calibration of this one fingertip; `None` where it was not calibrated.
    pub calibration: Option<StoredCalibration>,
    /// The wall in time; `None` of an elastic wall.
    pub relaxation: Option<WallSeries>,
    /// Tables of other objects; `None` where the design has no `[object]`.
    pub objects: Option<LoadedObjects<'a>>,
    /// The force of the feedback actuator; `None` where the design has none that presses.
    pub feedback: Option<LoadedFeedback<'a>>,
}

impl<'a> TipBlock<'a> {
    /// Reads a block at the begin of `bytes`, which may go on after it, as a slot of a flash does.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn read(bytes: &'a [u8]) -> Result<Self, BlockError> {
        let (block, mut head) = whole(bytes)?;
        let mut constants = NO_CONSTANTS;
        head.of = SectionKind::Constants;
        section::identity(&mut constants, &mut head)?;
        let sections = Sections::of(block, &mut head)?;

        let mut own = sections.needed(SectionKind::Constants)?;
        section::pressures(&mut constants, &mut own)?;
        section::transducer(&mut constants.transducer, &mut own)?;
        own.end()?;
        check_constants(&constants)?;

        let mut own = sections.needed(SectionKind::Tables)?;
        let mut layout = NO_LAYOUT;
        section::layout(&mut layout, &mut own)?;
        let (words, []) = own.bytes.as_chunks::<4>() else {
            return Err(BlockError::SectionLength(SectionKind::Tables));
        };

        let name = core::str::from_utf8(sections.needed(SectionKind::Name)?.bytes).unwrap_or_default();
        let plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if !(1..=LONGEST_NAME).contains(&name.len()) || !name.bytes().all(plain) {
            return Err(BlockError::Value(SectionKind::Name, "name"));
        }

        let mut calibration = None;
        if let Some(mut own) = sections.of_kind(SectionKind::Calibration) {
            let mut found = StoredCalibration {
                zero: 0,
                temperature: 0,
                coefficient: 0,
                gain: 0,
            };
            section::calibration(&mut found, &mut own)?;
            own.end()?;
            calibration = Some(found);
        }
        let relaxation = match sections.of_kind(SectionKind::Relaxation) {
            Some(own) => Some(relaxation(own)?),
            None => None,
        };
        if let Some(mut own) = sections.of_kind(SectionKind::Zero) {
            section::zero(&mut constants.zero, &mut own)?;
            own.end()?;
            check_zero(&constants.zero)?;
        }
        // Last, because it takes the most work.
        let tables = LoadedTables::new(layout, words)?;
        let objects = match sections.of_kind(SectionKind::Object) {
            None => None,
            Some(own) => Some(objects(own, tables)?),
        };
        let feedback = match sections.of_kind(SectionKind::Feedback) {
            None => None,
            Some(own) => Some(feedback(own, tables)?),
        };
        Ok(Self {
            constants,
            tables,
            name,
            calibration,
            relaxation,
            objects,
            feedback,
        })
    }

    /// What it holds, in the order of the sections.
    pub fn sections(&self) -> impl Iterator<Item = SectionKind> + use<> {
        let held = [
            true,
            true,
            self.calibration.is_some(),
            true,
            self.relaxation.is_some(),
            self.objects.is_some(),
            self.feedback.is_some(),
            self.constants.zero != ZeroAssumptions::NONE,
        ];
        SectionKind::ALL
            .into_iter()
            .zip(held)
            .filter_map(|(kind, held)| held.then_some(kind))
    }
}

/// Bytes of the block that begins as these do, and the CRC-32 that it states; nothing for what is no block of this layout.
/// It may be longer than `bytes`, and nothing of it is checked yet.
pub fn stated(bytes: &[u8]) -> Option<(u32, u32)> {
    let head = bytes.get(..HEAD)?;
    let [length, check] = <[u32; 2]>::get(head.get(8..16)?)?;
    let known = head.starts_with(&MAGIC) && head.get(4..6)? == LAYOUT_VERSION.to_le_bytes();
    known.then_some((length, check))
}

/// The wall in time: at least one term, and as many as the section has bytes for.
fn relaxation(mut own: Cursor<'_>) -> Result<WallSeries, BlockError> {
    let mut wall = WallSeries::default();
    section::relaxation(&mut wall, &mut own)?;
    let value = |field| BlockError::Value(SectionKind::Relaxation, field);
    if wall.remaining_permille > 1000 {
        return Err(value("remaining_permille"));
    }
    for (field, share) in [("fluid_least", wall.fluid_least), ("retouch", wall.retouch)] {
        if share > 1 << 16 {
            return Err(value(field));
        }
    }
    if wall.weight_gain > WallSeries::LARGEST_GAIN {
        return Err(value("weight_gain"));
    }
    if wall.temperature_gain >= 1 << 16 {
        return Err(value("temperature_gain"));
    }
    for (field, half) in [("fluid_half", wall.fluid_half), ("weight_half", wall.weight_half)] {
        if !(1..=i32::MAX.unsigned_abs()).contains(&half) {
            return Err(value(field));
        }
    }
    if wall.step.stiffness < 1 << SeriesStep::STIFFNESS_BITS {
        return Err(value("stiffness"));
    }
    for term in &mut wall.step.terms {
        if !own.bytes.is_empty() {
            own.field("term", term)?;
            wall.step.count += 1;
        }
    }
    own.end()?;
    if wall.step.count == 0 {
        return Err(BlockError::SectionLength(SectionKind::Relaxation));
    }
    if !wall.step.is_passive() {
        return Err(value("term"));
    }
    Ok(wall)
}

/// The section of other objects, beside the tables of the plate.
fn objects<'a>(mut own: Cursor<'a>, plate: LoadedTables<'a>) -> Result<LoadedObjects<'a>, BlockError> {
    let (mut start, mut law) = (Touched::Plate, NO_LAW);
    section::object(&mut start, &mut law, &mut own)?;
    let (words, []) = own.bytes.as_chunks::<4>() else {
        return Err(BlockError::SectionLength(SectionKind::Object));
    };
    if let Some(field) = law.out_of_range(plate.layout().maximum) {
        return Err(BlockError::Value(SectionKind::Object, field));
    }
    if law.weights(start).is_none() {
        return Err(BlockError::Value(SectionKind::Object, "start"));
    }
    Ok(LoadedObjects::new(start, law, plate, words)?)
}

/// The section of the feedback actuator, beside the tables.
fn feedback<'a>(mut own: Cursor<'a>, tables: LoadedTables<'a>) -> Result<LoadedFeedback<'a>, BlockError> {
    let mut scale = FeedbackScale::default();
    section::feedback(&mut scale, &mut own)?;
    let (words, []) = own.bytes.as_chunks::<4>() else {
        return Err(BlockError::SectionLength(SectionKind::Feedback));
    };
    if !(0..LARGEST_FORCE).contains(&scale.at_rest) {
        return Err(BlockError::Value(SectionKind::Feedback, "at_rest"));
    }
    let layout = tables.layout();
    let segments = tables.words().len() / layout.words();
    Ok(LoadedFeedback::new(layout, segments, scale, words)?)
}

/// The bytes of a block that is of this layout, complete and unchanged, and its head from the identity on.
fn whole(bytes: &[u8]) -> Result<(&[u8], Cursor<'_>), BlockError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(BlockError::NoBlock);
    }
    let short = |needed: usize| BlockError::Short {
        needed,
        found: bytes.len(),
    };
    let mut head = Cursor {
        bytes: bytes.get(..HEAD).ok_or(short(HEAD))?,
        of: SectionKind::Constants,
    };
    let _magic: u32 = head.next("magic")?;
    let version: u16 = head.next("layout version")?;
    if version != LAYOUT_VERSION {
        return Err(BlockError::LayoutVersion(version));
    }
    let head_length: u16 = head.next("length of the head")?;
    let total: u32 = head.next("length")?;
    let stated: u32 = head.next("check")?;
    let total = total as usize;
    let block = bytes.get(..total).ok_or(short(total))?;
    if check(block) != stated {
        return Err(BlockError::Check);
    }
    if usize::from(head_length) > total || usize::from(head_length) < HEAD {
        return Err(BlockError::Directory);
    }
    Ok((block, head))
}

/// The directory: sections in the order of their numbers, one after the other without gaps but those that align them.
struct Sections<'a>([Option<&'a [u8]>; SectionKind::HIGHEST]);

impl<'a> Sections<'a> {
    fn of(block: &'a [u8], head: &mut Cursor<'_>) -> Result<Self, BlockError> {
        let count: u32 = head.next("number of sections")?;
        let directory = (count as usize)
            .checked_mul(ENTRY)
            .and_then(|length| HEAD.checked_add(length))
            .and_then(|end| block.get(HEAD..end))
            .ok_or(BlockError::Directory)?;
        let mut end = HEAD + directory.len();
        if block.get(6..8) != Some(&u16::try_from(end).unwrap_or_default().to_le_bytes()) {
            return Err(BlockError::Directory);
        }
        let mut sections = [None; SectionKind::HIGHEST];
        let mut last = 0;
        for entry in directory.as_chunks::<ENTRY>().0 {
            let mut entry = Cursor {
                bytes: entry,
                of: SectionKind::Constants,
            };
            let number: u16 = entry.next("number")?;
            let version: u16 = entry.next("version")?;
            let [offset, length]: [u32; 2] = entry.next("place")?;
            let kind = SectionKind::of(number).ok_or(BlockError::UnknownSection(number))?;
            if version != SectionKind::VERSION {
                return Err(BlockError::SectionVersion(kind, version));
            }
            let start = aligned(end);
            let padded = block.get(end..start).ok_or(BlockError::Directory)?;
            if number <= last || offset as usize != start || padded.iter().any(|&byte| byte != 0) {
                return Err(BlockError::Directory);
            }
            last = number;
            end = start.checked_add(length as usize).ok_or(BlockError::Directory)?;
            let bytes = block.get(start..end).ok_or(BlockError::Directory)?;
            if let Some(slot) = sections.get_mut(kind as usize - 1) {
                *slot = Some(bytes);
            }
        }
        if end == block.len() {
            Ok(Self(sections))
        } else {
            Err(BlockError::Directory)
        }
    }

    fn of_kind(&self, kind: SectionKind) -> Option<Cursor<'a>> {
        let bytes = (*self.0.get(kind as usize - 1)?)?;
        Some(Cursor { bytes, of: kind })
    }

    fn needed(&self, kind: SectionKind) -> Result<Cursor<'a>, BlockError> {
        self.of_kind(kind).ok_or(BlockError::Missing(kind))
    }
}

/// The bytes of a section that are not read yet.
struct Cursor<'a> {
    bytes: &'a [u8],
    of: SectionKind,
}

impl Cursor<'_> {
    fn next<T: Field>(&mut self, name: &'static str) -> Result<T, BlockError> {
        let (own, rest) = self
            .bytes
            .split_at_checked(T::LENGTH)
            .ok_or(BlockError::SectionLength(self.of))?;
        self.bytes = rest;
        T::get(own).ok_or(BlockError::Value(self.of, name))
    }

    fn end(&self) -> Result<(), BlockError> {
        if self.bytes.is_empty() {
            Ok(())
        } else {
            Err(BlockError::SectionLength(self.of))
        }
    }
}

impl Visit for Cursor<'_> {
    type Stop = BlockError;

    fn field<T: Field>(&mut self, name: &'static str, value: &mut T) -> Result<(), BlockError> {
        *value = self.next(name)?;
        Ok(())
    }
}

/// Whether the signal path computes with these: thresholds come from the transducer's noise floor, gates from its range.
fn check_constants(constants: &DesignConstants) -> Result<(), BlockError> {
    let Transducer {
        range: [from, to],
        resolution,
        noise,
        ..
    } = constants.transducer;
    let within = |pressure: i32| (-WIDEST_RANGE..=WIDEST_RANGE).contains(&pressure);
    let fields = [
        ("rest_pressure", within(constants.rest_pressure)),
        (
            "maximum_pressure",
            within(constants.maximum_pressure) && constants.maximum_pressure > constants.rest_pressure,
        ),
        (
            "range",
            within(from) && within(to) && from < to && to - from <= WIDEST_RANGE,
        ),
        ("resolution", resolution > 0),
        ("noise", noise >= 0),
    ];
    match fields.into_iter().find(|(_, holds)| !holds) {
        Some((field, _)) => Err(BlockError::Value(SectionKind::Constants, field)),
        None => Ok(()),
    }
}

/// Whether they are sizes, and something is stated at all: a block of a design that states nothing has no such section.
fn check_zero(zero: &ZeroAssumptions) -> Result<(), BlockError> {
    let fields = [
        ("drift", zero.drift),
        ("per_kelvin", zero.per_kelvin),
        ("fluid_head", zero.fluid_head),
        ("hysteresis", zero.hysteresis),
        ("creep", zero.creep),
        ("bound", zero.bound),
    ];
    let wrong = fields
        .into_iter()
        .find(|(_, value)| !(0..=LARGEST_STATED).contains(value));
    match wrong {
        Some((field, _)) => Err(BlockError::Value(SectionKind::Zero, field)),
        None if *zero == ZeroAssumptions::NONE => Err(BlockError::Value(SectionKind::Zero, "drift")),
        None => Ok(()),
    }
}

/// To be filled.
const NO_CONSTANTS: DesignConstants = DesignConstants {
    hash: 0,
    table_version: 0,
    certificate: 0,
    rest_pressure: 0,
    maximum_pressure: 0,
    transducer: Transducer {
        range: [0; 2],
        resolution: 0,
        noise: 0,
        quantity: Quantity::Gauge,
        kind: TransducerKind::Ms5837 { address: 0 },
    },
    zero: ZeroAssumptions::NONE,
};

/// To be filled.
const NO_LAYOUT: Layout = Layout {
    fraction_bits: 0,
    maximum: 0,
    bias: 0,
    octaves: 0,
    halvings: 0,
    powers: Powers::Two,
    constant: Constant::Half,
    first_index: 0,
    shifts: [0, 0],
};

/// To be filled.
const NO_LAW: BlendLaw = BlendLaw {
    reference: 0,
    offset: 0,
    least: [0; 2],
    last: [0; 2],
    force: [[0; 3]; 2],
    indentation: [[0; 3]; 2],
};
