//! Tables that arrive as bytes: what is accepted, what is refused, held against evaluation of every input.

use certified_lookup::generate::{AccuracyGoal, CurvePair, CurvePoint, OwnedTables, fit};
use certified_lookup::{Layout, LoadedTables, TablesError};
use proptest::prelude::*;
use std::sync::OnceLock;

/// A root and a square, of inputs up to 4000.
struct Bent;

impl CurvePair for Bent {
    fn at(&self, input: f64) -> [f64; 2] {
        [
            3e3 * (input + 400.0).sqrt() - 6e4,
            input * input / 40.0 + 20.0 * input,
        ]
    }

    fn points(&self) -> Vec<CurvePoint> {
        let inputs = (1..=80).map(|i| 50.0 * f64::from(i));
        inputs
            .map(|input| CurvePoint {
                input,
                outputs: self.at(input),
            })
            .collect()
    }
}

/// Tables of that, with some hundred thousand inputs.
fn bent() -> &'static OwnedTables {
    static TABLES: OnceLock<OwnedTables> = OnceLock::new();
    TABLES.get_or_init(|| {
        let end = CurvePoint {
            input: 4000.0,
            outputs: Bent.at(4000.0),
        };
        let goal = AccuracyGoal {
            percent_of_reading: [0.2; 2],
            from_percent_of_full_scale: 1.0,
        };
        fit(&Bent, end, &goal, 0.5).expect("tables")
    })
}

fn bytes(words: &[i32]) -> Vec<[u8; 4]> {
    words.iter().map(|word| word.to_le_bytes()).collect()
}

/// The first input after which an output falls, by evaluation.
fn first_fall(tables: &OwnedTables) -> Option<i32> {
    (0..tables.layout.maximum).find(|&count| {
        let [low, high] = [count, count + 1].map(|count| tables.lookup(count).values);
        high[0] < low[0] || high[1] < low[1]
    })
}

#[test]
fn loaded_tables_read_as_those_that_were_made() {
    let made = bent();
    let words = bytes(&made.words);
    let loaded = LoadedTables::new(made.layout, &words).expect("sound");
    assert_eq!((loaded.layout(), loaded.words()), (&made.layout, &words[..]));
    let last = made.layout.maximum;
    for input in [-i32::MAX, -1, 0, 1, last / 3, last / 2, last, last + 1, i32::MAX] {
        assert_eq!(loaded.lookup(input), made.lookup(input));
    }
}

type Spoil = fn(&mut Layout);

#[test]
fn each_field_of_a_layout_has_its_range() {
    let made = bent();
    let words = bytes(&made.words);
    let spoils: [(&str, Spoil); 13] = [
        ("fraction_bits", |layout| {
            layout.fraction_bits = 17;
        }),
        ("maximum", |layout| layout.maximum = 0),
        ("maximum", |layout| layout.maximum = 1 << 30),
        ("bias", |layout| layout.bias = 0),
        ("bias", |layout| layout.bias = 1 << 30),
        ("octaves", |layout| layout.octaves = 0),
        ("octaves", |layout| layout.octaves = 3),
        ("halvings", |layout| {
            (layout.octaves, layout.halvings) = (1, 4);
        }),
        ("halvings", |layout| (layout.octaves, layout.halvings) = (2, 1)),
        ("first shift", |layout| layout.shifts[0] = 32),
        ("second shift", |layout| layout.shifts[1] = 32),
        ("first_index", |layout| layout.first_index += 1),
        ("first_index", |layout| layout.first_index -= 1),
    ];
    for (field, spoil) in spoils {
        let mut layout = made.layout;
        spoil(&mut layout);
        let refused = LoadedTables::new(layout, &words).expect_err(field);
        assert_eq!(refused, TablesError::Layout(field));
    }
}

#[test]
fn a_segment_too_few_or_too_many_is_refused() {
    let made = bent();
    let needed = made.words.len();
    for found in [0, needed - 1, needed + 1] {
        let words = vec![[0; 4]; found];
        assert_eq!(
            LoadedTables::new(made.layout, &words).expect_err("words"),
            TablesError::Words { needed, found }
        );
    }
}

#[test]
fn zero_reads_zero() {
    for output in 0..2 {
        let mut made = bent().clone();
        let lowest = made.words.len() - made.layout.words();
        made.words[lowest + output] += 1 << 24;
        assert_ne!(made.lookup(0).values, [0; 2]);
        let refused = LoadedTables::new(made.layout, &bytes(&made.words)).expect_err("not zero");
        assert_eq!(refused, TablesError::Zero);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Whatever a word is changed to: tables that are accepted fall nowhere, and those refused for a fall have one.
    #[test]
    fn accepted_tables_never_fall(place in 0..10_000_usize, bit in 0..32_u32) {
        let mut tables = bent().clone();
        let at = place % tables.words.len();
        tables.words[at] ^= 1 << bit;
        let fall = first_fall(&tables);
        match LoadedTables::new(tables.layout, &bytes(&tables.words)) {
            Ok(_) => prop_assert_eq!(fall, None),
            Err(TablesError::Falls(after)) => {
                prop_assert!(fall.is_some_and(|first| first <= after), "{:?} {}", fall, after);
            }
            Err(TablesError::Zero) => prop_assert_ne!(tables.lookup(0).values, [0; 2]),
            Err(TablesError::Flat(_)) => {}
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}

/// Four bits of every word: what does not fall is accepted.
#[test]
fn sound_tables_are_accepted() {
    let made = bent();
    let (mut sound, mut refused) = (0, 0);
    for at in 0..made.words.len() {
        for bit in [0, 3, 16, 19] {
            let mut tables = made.clone();
            tables.words[at] ^= 1 << bit;
            if tables.lookup(0).values != [0; 2] || first_fall(&tables).is_some() {
                continue;
            }
            sound += 1;
            refused += i32::from(LoadedTables::new(tables.layout, &bytes(&tables.words)).is_err());
        }
    }
    assert!(sound > 10 && refused == 0, "{refused} of {sound}");
}
