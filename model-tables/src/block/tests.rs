use super::field::{Field, Visit};
use super::read::TipBlock;
use super::section::{self, SectionKind};
use super::write::{TipData, sign};
use super::*;
use crate::constants::{
    AirReference, DesignConstants, Quantity, Transducer, TransducerKind, ZeroAssumptions,
};
use crate::material::series::{Factor, SeriesStep, TermStep, WallSeries};
use crate::table::ContactLookup as _;
use crate::table::feedback::FeedbackScale;
use crate::table::law::{BlendLaw, Touched};
use crate::table::{Constant, Layout, Powers};
use crate::units::PressureRise;
use std::collections::BTreeSet;
use std::convert::Infallible;

const CONSTANTS: DesignConstants = DesignConstants {
    hash: 0x0123_4567_89AB_CDEF,
    table_version: 4,
    certificate: 0xFEDC_BA98_7654_3210,
    rest_pressure: 20_000,
    maximum_pressure: 60_000,
    transducer: Transducer {
        range: [0, 100_000],
        resolution: 10_000,
        noise: 5_000,
        quantity: Quantity::Gauge,
        kind: TransducerKind::Ratiometric {
            output: [6_554, 58_982],
            supply_measured: false,
        },
    },
    zero: ZeroAssumptions::NONE,
};

/// One segment of two octaves; both outputs are near the rise.
const LAYOUT: Layout = Layout {
    fraction_bits: 2,
    maximum: 11,
    bias: 4,
    octaves: 1,
    halvings: 0,
    powers: Powers::Two,
    constant: Constant::Whole,
    first_index: 28,
    shifts: [4, 4],
};

/// Force and indentation are the rise: `U/2 - 4 + U (1/2 - s)` in octaves that end at `U` = 16 and 8.
const WORDS: [i32; 8] = [
    4 << 18,
    4 << 18,
    (16 << 2) << 16 | 16 << 2,
    0,
    0,
    0,
    (8 << 2) << 16 | 8 << 2,
    0,
];

const CALIBRATION: StoredCalibration = StoredCalibration {
    zero: 20_123_000,
    temperature: i32::MIN,
    coefficient: -5,
    gain: 1_000,
};

/// Of straight lines over `t`.
const LAW: BlendLaw = BlendLaw {
    reference: 8_000,
    offset: 2_000,
    least: [3_000, 20_000],
    last: [11, 11],
    force: [[4096, 0, 0], [2048, 0, 0]],
    indentation: [[4096, 0, 0], [2048, 0, 0]],
};

const DATA: TipData<'_> = TipData {
    constants: CONSTANTS,
    layout: LAYOUT,
    words: &WORDS,
    name: "a-tip_1",
    calibration: Some(CALIBRATION),
    relaxation: None,
    object: None,
    feedback: None,
};

/// A half of a term is lost, and it takes a tenth of a change.
fn wall(terms: usize) -> WallSeries {
    let mut step = SeriesStep {
        settled: Factor::nearest(0.1),
        forgets: Factor::nearest(0.01),
        stiffness: 10 << SeriesStep::STIFFNESS_BITS,
        count: terms,
        ..SeriesStep::default()
    };
    for term in &mut step.terms[..terms] {
        *term = TermStep {
            lost: Factor::nearest(0.5),
            share: Factor::nearest(0.1),
        };
    }
    WallSeries {
        step,
        remaining_permille: 30,
        fluid_least: 10_000,
        fluid_half: 5_000,
        weight_gain: 40_000,
        weight_half: 700,
        retouch: 10_000,
        temperature_gain: 20_000,
    }
}

#[test]
fn a_wall_in_time_is_written_and_read() {
    for terms in [1, 7, 8] {
        let relaxation = Some(wall(terms));
        let block = TipData { relaxation, ..DATA }.write();
        assert_eq!(
            TipBlock::read(&block).expect("it is whole").relaxation,
            relaxation
        );
    }
    let elastic = DATA.write();
    assert_eq!(TipBlock::read(&elastic).expect("it is whole").relaxation, None);
}

/// The force is the rise and 50 uN at rest: one word for the constant, one for both coefficients.
#[test]
fn a_feedback_force_is_written_and_read() {
    const FEEDBACK: [i32; 4] = [4 << 18, (16 << 2) << 16, 0, (8 << 2) << 16];
    let scale = FeedbackScale {
        shift: 4,
        at_rest: 50,
    };
    let with = |scale: FeedbackScale, words: &'static [i32]| {
        TipData {
            feedback: Some((scale, words)),
            ..DATA
        }
        .write()
    };
    let block = with(scale, &FEEDBACK);
    let tip = TipBlock::read(&block).expect("it is whole");
    let feedback = tip.feedback.expect("it has one");
    for rise in -1..=12 {
        let force = feedback.lookup(PressureRise(rise)).0;
        assert_eq!(force, 50 + tip.tables.contact_at(PressureRise(rise)).force.0);
    }
    assert!(tip.sections().any(|kind| kind == SectionKind::Feedback));
    let plain = DATA.write();
    assert!(TipBlock::read(&plain).expect("it is whole").feedback.is_none());
    let below = FeedbackScale { at_rest: -1, ..scale };
    let value = BlockError::Value(SectionKind::Feedback, "at_rest");
    assert_eq!(error(&with(below, &FEEDBACK)), value);
    let wide = FeedbackScale { shift: 32, ..scale };
    let layout = BlockError::Tables(TablesError::Layout("feedback_shift"));
    assert_eq!(error(&with(wide, &FEEDBACK)), layout);
    let short = BlockError::Tables(TablesError::Words { needed: 4, found: 3 });
    assert_eq!(error(&with(scale, &FEEDBACK[..3])), short);
}

#[test]
fn a_wall_in_time_that_cannot_be_is_refused() {
    let refused = |relaxation: WallSeries| {
        let relaxation = Some(relaxation);
        error(&TipData { relaxation, ..DATA }.write())
    };
    let value = |field| BlockError::Value(SectionKind::Relaxation, field);
    assert_eq!(
        refused(wall(0)),
        BlockError::SectionLength(SectionKind::Relaxation)
    );
    let mut odd = wall(2);
    odd.remaining_permille = 1001;
    assert_eq!(refused(odd), value("remaining_permille"));
    for half in [0, 1 << 31] {
        let mut odd = wall(2);
        odd.fluid_half = half;
        assert_eq!(refused(odd), value("fluid_half"));
        let mut odd = wall(2);
        odd.weight_half = half;
        assert_eq!(refused(odd), value("weight_half"));
    }
    let mut odd = wall(2);
    odd.fluid_least = (1 << 16) + 1;
    assert_eq!(refused(odd), value("fluid_least"));
    let mut odd = wall(2);
    odd.weight_gain = 7 << 16;
    assert_eq!(refused(odd), value("weight_gain"));
    let mut odd = wall(2);
    odd.retouch = (1 << 16) + 1;
    assert_eq!(refused(odd), value("retouch"));
    let mut odd = wall(2);
    odd.temperature_gain = 1 << 16;
    assert_eq!(refused(odd), value("temperature_gain"));
    let mut odd = wall(2);
    odd.step.stiffness = (1 << SeriesStep::STIFFNESS_BITS) - 1;
    assert_eq!(refused(odd), value("stiffness"));
    let mut odd = wall(2);
    odd.step.settled.shift = 32;
    assert_eq!(refused(odd), value("settled"));
    let mut odd = wall(2);
    odd.step.terms[1].share.shift = 32;
    assert_eq!(refused(odd), value("term"));
    // More than the whole of a change.
    let mut odd = wall(2);
    odd.step.terms[1].share = Factor::nearest(0.9);
    assert_eq!(refused(odd), value("term"));
}

fn error(block: &[u8]) -> BlockError {
    TipBlock::read(block).expect_err("it is refused")
}

/// A block with these bytes from there on, and its check made anew.
fn changed(at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut block = DATA.write();
    block[at..at + bytes.len()].copy_from_slice(bytes);
    sign(&mut block);
    block
}

#[test]
fn what_is_written_is_read() {
    for calibration in [None, Some(CALIBRATION)] {
        let mut block = TipData { calibration, ..DATA }.write();
        block.extend([0xFF; 5]); // the rest of a slot
        let tip = TipBlock::read(&block).expect("it is whole");
        assert_eq!(
            (tip.constants, tip.name, tip.calibration),
            (CONSTANTS, "a-tip_1", calibration)
        );
        assert_eq!(*tip.tables.layout(), LAYOUT);
        for rise in [-5, 0, 1, 3, 4, 7, 11, 12, i32::MAX] {
            let reading = tip.tables.contact_at(PressureRise(rise));
            let held = rise.clamp(0, 11);
            assert_eq!((reading.force.0, reading.indentation.0), (held, held), "{rise}");
            assert_eq!((reading.negative, reading.saturated), (rise < 0, rise > 11));
        }
    }
}

#[test]
fn a_block_that_is_cut_off_changed_or_another_ones_is_refused_by_reason() {
    let block = DATA.write();
    assert_eq!(error(b""), BlockError::NoBlock);
    assert_eq!(error(b"FTIQ"), BlockError::NoBlock);
    for length in 4..block.len() {
        assert!(
            matches!(error(&block[..length]), BlockError::Short { .. }),
            "{length}"
        );
    }
    assert_eq!(error(&changed(4, &[2, 0])), BlockError::LayoutVersion(2));
    // Every bit counts: of the magic, of the version, of the length, else the check.
    for bit in 0..8 * block.len() {
        let mut block = block.clone();
        block[bit / 8] ^= 1 << (bit % 8);
        let expected = match bit / 8 {
            0..4 => matches!(error(&block), BlockError::NoBlock),
            4..6 => matches!(error(&block), BlockError::LayoutVersion(_)),
            8..12 => matches!(error(&block), BlockError::Short { .. } | BlockError::Check),
            _ => error(&block) == BlockError::Check,
        };
        assert!(expected, "bit {bit}: {:?}", error(&block));
    }
}

#[test]
fn what_a_design_states_of_its_zero_is_a_section_of_its_own() {
    let stated = ZeroAssumptions {
        drift: 5_000,
        per_kelvin: 1_500,
        fluid_head: 70_000,
        hysteresis: 40_000,
        creep: 30_000,
        bound: 250_000,
        air: AirReference::Host,
    };
    let with = |zero| {
        let constants = DesignConstants { zero, ..CONSTANTS };
        TipData { constants, ..DATA }.write()
    };
    let block = with(stated);
    // An entry of the directory, six words and a code; without it a block is what it was.
    assert_eq!(block.len(), DATA.write().len().next_multiple_of(4) + ENTRY + 28);
    let tip = TipBlock::read(&block).expect("it is whole");
    assert_eq!(tip.constants.zero, stated);
    assert_eq!(with(ZeroAssumptions::NONE), DATA.write());
    // Below 0, above 100 kPa, another reference.
    let at = block.len() - 28;
    for (offset, value, field) in [
        (0, -1, "drift"),
        (12, 100_000_001, "hysteresis"),
        (20, i32::MIN, "bound"),
        (24, 3, "air"),
    ] {
        let mut block = block.clone();
        block[at + offset..at + offset + 4].copy_from_slice(&i32::to_le_bytes(value));
        sign(&mut block);
        assert_eq!(error(&block), BlockError::Value(SectionKind::Zero, field));
    }
}

#[test]
fn a_section_that_is_not_known_fails_the_whole_block() {
    let entry = |section: usize| HEAD + ENTRY * section;
    for number in [0, 9, u16::MAX] {
        let block = changed(entry(3), &number.to_le_bytes());
        assert_eq!(error(&block), BlockError::UnknownSection(number));
    }
    assert_eq!(
        error(&changed(entry(1) + 2, &[2, 0])),
        BlockError::SectionVersion(SectionKind::Tables, 2)
    );
    // Twice the same, and out of order.
    assert_eq!(error(&changed(entry(1), &[1, 0])), BlockError::Directory);
    assert_eq!(error(&changed(entry(0), &[3, 0])), BlockError::Directory);
    // Longer than the block, before its place, overlapping.
    for (at, bytes) in [
        (entry(3) + 8, u32::MAX),
        (entry(0) + 4, 0),
        (entry(1) + 4, 92),
        (36, 3),
        (36, u32::MAX),
    ] {
        let found = error(&changed(at, &bytes.to_le_bytes()));
        assert!(
            matches!(found, BlockError::Directory),
            "{bytes} at {at}: {found:?}"
        );
    }
}

#[test]
fn values_and_tables_out_of_their_ranges_are_refused_by_name() {
    // After head and four entries: constants from 88 on, tables from 128 on (see `LAYOUT.md`).
    let word = |at: usize, value: i32| error(&changed(at, &value.to_le_bytes()));
    let of_constants = |field| BlockError::Value(SectionKind::Constants, field);
    assert_eq!(word(88, i32::MIN), of_constants("rest_pressure"));
    assert_eq!(word(92, 20_000), of_constants("maximum_pressure"));
    assert_eq!(word(96, 100_000), of_constants("range"));
    assert_eq!(word(104, 0), of_constants("resolution"));
    assert_eq!(word(108, -1), of_constants("noise"));
    assert_eq!(word(112, 2), of_constants("quantity"));
    assert_eq!(word(116, 4), of_constants("kind"));
    let tables = 128;
    for (at, value, field) in [
        (0, 17, "fraction_bits"),
        (4, 0, "maximum"),
        (4, i32::MIN, "maximum"),
        (8, 0, "bias"),
        (12, 3, "octaves"),
        (16, 4, "halvings"),
        (28, 27, "first_index"),
        (32, 32, "first shift"),
        (36, -1, "second shift"),
    ] {
        let expected = BlockError::Tables(TablesError::Layout(field));
        assert_eq!(word(tables + at, value), expected, "{value} at {at}");
    }
    for (at, field) in [(20, "powers"), (24, "constant")] {
        assert_eq!(
            word(tables + at, 3),
            BlockError::Value(SectionKind::Tables, field)
        );
    }
    let words = tables + 40;
    assert_eq!(word(words + 16, 1 << 18), BlockError::Tables(TablesError::Zero));
    // The upper octave begins below the end of the lower one, or falls within itself.
    assert_eq!(word(words, 1 << 18), BlockError::Tables(TablesError::Falls(3)));
    assert_eq!(
        word(words + 8, -64 << 16),
        BlockError::Tables(TablesError::Falls(4))
    );
    let name = DATA.write().len() - 7;
    assert_eq!(
        error(&changed(name, b"\n")),
        BlockError::Value(SectionKind::Name, "name")
    );
}

/// The page gives the fields that are read and written, with their lengths and the order.
#[test]
fn the_page_lists_every_field_where_it_lies() {
    const PAGE: &str = include_str!("LAYOUT.md");
    struct Rows(usize);
    impl Visit for Rows {
        type Stop = Infallible;

        fn field<T: Field>(&mut self, name: &'static str, _: &mut T) -> Result<(), Infallible> {
            let row = format!("| {} | {} | `{name}` |", self.0, T::LENGTH);
            assert!(PAGE.contains(&row), "{row}");
            self.0 += T::LENGTH;
            Ok(())
        }
    }
    let (mut constants, mut layout, mut calibration) = (CONSTANTS, LAYOUT, CALIBRATION);
    let mut rows = Rows(16);
    let Ok(()) = section::identity(&mut constants, &mut rows);
    assert_eq!(rows.0, HEAD - 4);
    let mut rows = Rows(0);
    let Ok(()) = section::pressures(&mut constants, &mut rows);
    let Ok(()) = section::transducer(&mut constants.transducer, &mut rows);
    let mut rows = Rows(0);
    let Ok(()) = section::layout(&mut layout, &mut rows);
    let mut rows = Rows(0);
    let Ok(()) = section::calibration(&mut calibration, &mut rows);
    let mut rows = Rows(0);
    let Ok(()) = section::relaxation(&mut wall(1), &mut rows);
    let mut rows = Rows(0);
    let Ok(()) = section::zero(&mut constants.zero, &mut rows);
    let mut rows = Rows(0);
    let (mut start, mut law) = (Touched::Plate, LAW);
    let Ok(()) = section::object(&mut start, &mut law, &mut rows);
    let mut rows = Rows(0);
    let Ok(()) = section::feedback(&mut FeedbackScale::default(), &mut rows);
    let numbers: BTreeSet<String> = SectionKind::ALL
        .iter()
        .map(|&kind| format!("| {} | {} |", kind as u16, kind.word()))
        .collect();
    for row in numbers {
        assert!(PAGE.contains(&row), "{row}");
    }
}
