//! Every kind of transducer, in air of two pressures, through rest, tare, press, hold and release, a reset that keeps its memory,
//! and starts with a calibration in flash.

use crate::stored::with_stored;
use crate::{design_with, firmware_for};
use emulator::accuracy::is_wrong;
use emulator::bench;
use emulator::fingertip_design::FingertipDesign;
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::record::{Recorder, Recording, Row};
use emulator::scenario::{Event, Happening, Scenario};
use emulator::transducer::{EmulatedTransducer, Part};
use fingertip::link::command::{CommandKind, Outcome};
use fingertip::signal::calibration::Calibration;
use fingertip::status::{Fault, Status, Stored};
use fingertip::units::Millipascals;
use model_tables::design_file::DesignFile;
use model_tables::generate;
use std::fmt;

/// Pressures of the air, kilopascals: at sea level, and 2000 m above it.
const AIRS: [f64; 2] = [101.3, 80.0];
/// Least share of the reports after the zero that are ok.
const OK: f64 = 0.99;
/// A tare is answered by then, seconds after it is asked for.
const TARE: f64 = 1.0;
/// Of the shorter stories, milliseconds: the rest before the press, the tare in it, the hold.
const REST: f64 = 2_000.0;
const TARE_AT: f64 = 1_000.0;
/// In a hold of this length the firmware hangs at a time, for a time.
const HOLD: f64 = 1_500.0;
const HANG_AFTER: f64 = 200.0;
const HANG: f64 = 450.0;
/// A part on a bus answers after power-on, seconds.
const STARTED: f64 = 0.1;
/// A report is made of this many samples.
const SAMPLES: f64 = 3.0;

/// The range of the default design's transducer, and in its place that of an NXP MPX4250A: Vs (0.004 P - 0.04) from 20 to 250 kPa,
/// absolute. Half a code of a converter of 12 bits is 30 Pa of that.
const GAUGE_BRIDGE: &str = "range_kpa = [0.0, 100.0]
resolution_pa = 10.0
output_fraction_at_range = [0.1, 0.9]
noise_pa = 10.0";
const MPX4250A: &str = "quantity = \"absolute\"
range_kpa = [20.0, 250.0]
resolution_pa = 30.0
output_fraction_at_range = [0.04, 0.96]
noise_pa = 30.0";

/// Each kind with a design that it fits: a shipped one, or one in which the transducer was exchanged.
fn kinds() -> Vec<(&'static str, FingertipDesign)> {
    let light = |kind: &str| {
        design_with(
            "skin-light-touch",
            "kind = \"dps310\"",
            &format!("kind = {kind:?}"),
        )
    };
    vec![
        (
            "ratiometric",
            FingertipDesign::read(&host_tests::design("index-fingertip-elastic")).expect("it is shipped"),
        ),
        (
            "ratiometric, supply measured",
            design_with(
                "skin-analogue",
                "kind = \"ratiometric\"",
                "kind = \"ratiometric\"\nsupply = \"measured\"",
            ),
        ),
        (
            "ratiometric, absolute",
            design_with("index-fingertip-elastic", GAUGE_BRIDGE, MPX4250A),
        ),
        ("abp2", light("abp2")),
        ("ms5837-02ba", light("ms5837-02ba")),
        ("dps310", light("dps310")),
    ]
}

/// What happens to a fingertip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Story {
    /// The scenario `long-rest`.
    LongRest,
    /// The firmware hangs in a grasp: the watchdog resets it, and its memory is kept.
    Reset,
    /// A start with the zero in flash, stored in the same air.
    Stored,
    /// A start with the zero in flash, stored in the other air.
    StoredElsewhere,
}

impl Story {
    const ALL: [Self; 4] = [Self::LongRest, Self::Reset, Self::Stored, Self::StoredElsewhere];

    /// Its scenario in air of a pressure, kilopascals. The plate does the same in each.
    fn scenario(self, air_kpa: f64) -> Scenario {
        let mut scenario = Scenario::named("long-rest").expect("it is shipped");
        scenario.air_kpa = air_kpa;
        if self != Self::LongRest {
            scenario.phase[0].duration_ms = REST;
            scenario.event[0].at_ms = TARE_AT;
        }
        if self == Self::Reset {
            scenario.phase[2].duration_ms = HOLD;
            let hold = REST + scenario.phase[1].duration_ms;
            scenario.event.push(Event {
                at_ms: hold + HANG_AFTER,
                is: Happening::Hang,
                for_ms: Some(HANG),
                radius_mm: None,
            });
        }
        scenario
    }

    /// Pressure of the air that the zero in flash was stored in, kilopascals.
    fn stored_in(self, air_kpa: f64) -> Option<f64> {
        match self {
            Self::LongRest | Self::Reset => None,
            Self::Stored => Some(air_kpa),
            Self::StoredElsewhere => AIRS
                .into_iter()
                .find(|other| other.to_bits() != air_kpa.to_bits()),
        }
    }
}

impl fmt::Display for Story {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::LongRest => "long-rest",
            Self::Reset => "reset in a grasp",
            Self::Stored => "zero stored here",
            Self::StoredElsewhere => "zero stored elsewhere",
        })
    }
}

/// What came of one story.
struct Told {
    story: Story,
    /// Reports after the zero, and how many of them are ok, or faults.
    reports: usize,
    ok: usize,
    faults: usize,
    /// Of all reports.
    wrong: usize,
    /// What was not as it should be, in words.
    complaints: Vec<String>,
}

impl Told {
    fn ok_percent(&self) -> f64 {
        100.0 * self.ok as f64 / self.reports as f64
    }
}

fn tell(design: &FingertipDesign, image: &Image, plant: &Plant, story: Story, air_kpa: f64) -> Told {
    let image = match story.stored_in(air_kpa) {
        None => image.clone(),
        Some(kpa) => {
            let zero = Millipascals((1e3 * plant.rest_in(1e3 * kpa)).round() as i32);
            let calibration = Calibration {
                zero: Some(zero),
                ..Calibration::default()
            };
            let range = plant.transducer().range.map(|pascals| pascals as i32);
            with_stored(image, design.hash(), range, calibration)
        }
    };
    let scenario = story.scenario(air_kpa);
    let plant = plant.through(scenario.clone());
    let recorder = Recorder::new(|_: &Row| {});
    let outcome =
        bench::run(&image, plant.clone(), scenario.duration(), &[], recorder).expect("the image runs");
    let record = outcome.listener.into_record();

    let recovery = 0.1 + SAMPLES * plant.transducer().period();
    let counted: Vec<&Row> = record
        .rows
        .iter()
        .filter(|row| row.time >= 1e-3 * scenario.event[0].at_ms + TARE)
        .filter(|row| {
            !scenario.event.iter().any(|event| {
                event.is == Happening::Hang
                    && (1e-3 * event.at_ms..1e-3 * (event.at_ms + HANG) + recovery).contains(&row.time)
            })
        })
        .collect();
    let wrong: Vec<&Row> = record.rows.iter().filter(|row| is_wrong(row, &plant)).collect();
    let mut complaints = complaints(story, &record);
    if outcome.resets.len() != usize::from(story == Story::Reset) || !outcome.gaps.is_empty() {
        complaints.push(format!("resets {:?}, gaps {:?}", outcome.resets, outcome.gaps));
    }
    // A report a period; the hang and what follows it take less than a third of that story.
    let expected =
        (scenario.duration() - TARE - 1e-3 * scenario.event[0].at_ms) / plant.transducer().period();
    if (counted.len() as f64) < 0.6 * expected {
        complaints.push(format!("{} reports of {expected:.0}", counted.len()));
    }
    let count = |wanted: fn(&Status) -> bool| counted.iter().filter(|row| wanted(&row.status)).count();
    let ok = count(|status| *status == Status::Ok);
    if (ok as f64) < OK * counted.len() as f64 {
        let first = counted.iter().find(|row| row.status != Status::Ok);
        complaints.push(format!(
            "{ok} of {} ok, the first that is not: {first:?}",
            counted.len()
        ));
    }
    if let Some(row) = wrong.first() {
        complaints.push(format!("{} wrong, the first: {row:?}", wrong.len()));
    }
    Told {
        story,
        reports: counted.len(),
        ok,
        faults: count(|status| matches!(status, Status::Fault(_))),
        wrong: wrong.len(),
        complaints,
    }
}

/// What the firmware sent beside its reports that it should not have.
fn complaints(story: Story, record: &Recording) -> Vec<String> {
    let mut complaints = vec![];
    let answers: Vec<(CommandKind, Outcome)> = record
        .answers
        .iter()
        .map(|answer| (answer.command, answer.outcome))
        .collect();
    if answers != [(CommandKind::Tare, Outcome::Done)] {
        complaints.push(format!("{answers:?}"));
    }
    let stored = match story {
        Story::LongRest | Story::Reset => Stored::None,
        Story::Stored | Story::StoredElsewhere => Stored::InUse,
    };
    if record.hellos.last().is_none_or(|hello| hello.stored != stored) {
        complaints.push(format!("{:?}", record.hellos.last()));
    }
    // Frames are numbered anew after a reset, and one is cut off by it.
    if story != Story::Reset && (record.lost, record.broken.len()) != (0, 0) {
        complaints.push(format!("{} frames lost, broken {:?}", record.lost, record.broken));
    }
    complaints
}

/// The stories of one kind in both airs that are wanted, by number of the air and of the story.
fn of_kind(design: &FingertipDesign, wanted: impl Fn(usize, usize) -> bool) -> Vec<(f64, Vec<Told>)> {
    let image = firmware_for(design);
    let plant = design
        .plant(Scenario::named("long-rest").expect("it is shipped"))
        .expect("it can be pressed");
    let in_air = |(air_number, air_kpa)| {
        let stories = Story::ALL.into_iter().enumerate();
        let stories = stories.filter(|(number, _)| wanted(air_number, *number));
        let told = stories.map(|(_, story)| tell(design, image, &plant, story, air_kpa));
        (air_kpa, told.collect())
    };
    AIRS.into_iter().enumerate().map(in_air).collect()
}

/// Every kind meets every air and every story, and every air every story, in half the time of all of them.
#[test]
fn every_transducer_is_ok_and_right_after_its_zero_in_thick_and_thin_air() {
    play(|kind, air, story| (kind + air + story).is_multiple_of(2));
}

#[test]
#[ignore = "minutes: the whole table of FAULTS.md"]
fn every_transducer_in_every_air_and_every_story() {
    play(|_, _, _| true);
}

/// Plays and judges the stories that are wanted, by number of the kind, of the air and of the story.
fn play(wanted: impl Fn(usize, usize, usize) -> bool + Sync) {
    let kinds = kinds();
    let wanted = &wanted;
    let all: Vec<_> = std::thread::scope(|scope| {
        let running: Vec<_> = kinds
            .iter()
            .enumerate()
            .map(|(number, (kind, design))| {
                let wanted = move |air, story| wanted(number, air, story);
                (*kind, scope.spawn(move || of_kind(design, wanted)))
            })
            .collect();
        running
            .into_iter()
            .map(|(kind, thread)| (kind, thread.join().expect("it has not panicked")))
            .collect()
    });
    println!(
        "{:<29} air/kPa  {:<22} reports    ok/%  faults  wrong",
        "transducer", "story"
    );
    let mut failures = vec![];
    for (kind, airs) in &all {
        for (air, told) in airs {
            for one in told {
                println!(
                    "{kind:<29} {air:>7.1}  {:<22} {:>7}  {:>6.1}  {:>6}  {:>5}",
                    one.story,
                    one.reports,
                    one.ok_percent(),
                    one.faults,
                    one.wrong
                );
                if !one.complaints.is_empty() {
                    failures.push(format!("{kind}, {air} kPa, {}: {:?}", one.story, one.complaints));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    for (kind, airs) in &all {
        for (air, told) in airs {
            assert_documented(kind, *air, told);
        }
    }
}

/// The row of `FAULTS.md` has these figures, but for a fault or two: their number depends on the instant.
fn assert_documented(kind: &str, air: f64, told: &[Told]) {
    let path = host_tests::workspace().join("host-tests/FAULTS.md");
    let document = std::fs::read_to_string(path).expect("the document is there");
    let begins = format!("| {kind} | {air:.1} |");
    let row = document.lines().find_map(|line| line.strip_prefix(&begins));
    let row = row.unwrap_or_else(|| panic!("FAULTS.md has no row {begins}"));
    let figures: Vec<f64> = row
        .split('|')
        .filter_map(|cell| cell.trim().parse().ok())
        .collect();
    let (wrong, percents) = figures.split_last().expect("figures follow");
    assert!(
        wrong.abs() < 0.5 && percents.len() == Story::ALL.len(),
        "{begins}{row}"
    );
    for one in told {
        let documented = percents[one.story as usize];
        let allowed = 100.0 * 2.0 / one.reports as f64 + 0.05;
        assert!(
            (documented - one.ok_percent()).abs() <= allowed,
            "{begins}{row}: {} is {:.1}",
            one.story,
            one.ok_percent()
        );
    }
}

/// Runs the image of a design with another part in the place of its own, in air of a pressure, kilopascals.
fn with_part(design: &FingertipDesign, part: Part, air_kpa: f64) -> Recording {
    let scenario = Story::Reset.scenario(air_kpa);
    let plant = design.plant(scenario).expect("it can be pressed");
    let transducer = EmulatedTransducer {
        part,
        ..plant.transducer()
    };
    let recorder = Recorder::new(|_: &Row| {});
    let image = firmware_for(design);
    let outcome = bench::run(image, plant.with_transducer(transducer), 3.0, &[], recorder);
    outcome.expect("the image runs").listener.into_record()
}

#[test]
fn a_part_of_the_same_identity_that_reads_otherwise_is_refused() {
    for (kind, part) in [
        ("dps310", Part::Spl06(0x77)),
        ("ms5837-02ba", Part::Ms5837ThirtyBar(0x76)),
    ] {
        let (_, design) = kinds()
            .into_iter()
            .find(|(name, _)| *name == kind)
            .expect("a kind");
        for air in AIRS {
            let rows = with_part(&design, part, air).rows;
            assert!(rows.iter().all(|row| row.reported.is_none()), "{part:?} is read");
            // After power-on it does not answer at once.
            let started: Vec<&Row> = rows.iter().filter(|row| row.time > STARTED).collect();
            assert!(started.len() > 20, "{part:?}: {} reports", started.len());
            for row in started {
                assert_eq!(row.status, Status::Fault(Fault::WrongSensor), "{part:?}: {row:?}");
            }
        }
    }
}

/// A shipped design with another transducer.
fn with_transducer(shipped: &str, section: &str) -> String {
    let text = std::fs::read_to_string(host_tests::design(shipped)).expect("it is shipped");
    let (before, after) = text.split_once("[transducer]").expect("it has one");
    let (_, after) = after.split_once("[accuracy]").expect("it has one");
    format!("{before}[transducer]\n{section}\nresolution_pa = 1.0\n[accuracy]{after}")
}

/// Designs and transducers that do not fit: what is refused, and the key that is named for it.
const MISFITS: [(&str, &str, &str); 11] = [
    // More than the part measures in the densest air.
    (
        "skin-light-touch",
        "kind = \"dps310\"\nrange_kpa = [0.0, 15.0]",
        "range_kpa",
    ),
    (
        "index-fingertip-elastic",
        "kind = \"dps310\"\nrange_kpa = [0.0, 100.0]",
        "range_kpa",
    ),
    (
        "index-fingertip-elastic",
        "kind = \"ms5837-02ba\"\nrange_kpa = [0.0, 100.0]",
        "range_kpa",
    ),
    // What it measures there is not enough for the press, ...
    (
        "index-fingertip-elastic",
        "kind = \"dps310\"\nrange_kpa = [0.0, 12.0]",
        "transducer.range_kpa",
    ),
    // ... or for the rest.
    (
        "skin-light-touch",
        "kind = \"abp2\"\nrange_kpa = [0.0, 0.5]",
        "transducer.range_kpa",
    ),
    (
        "paper-prestretched",
        "kind = \"dps310\"\nrange_kpa = [0.0, 12.0]",
        "transducer.range_kpa",
    ),
    (
        "paper-prestretched",
        "kind = \"ms5837-02ba\"\nrange_kpa = [0.0, 92.0]",
        "transducer.range_kpa",
    ),
    (
        "paper-prestretched",
        "kind = \"abp2\"\nrange_kpa = [0.0, 100.0]",
        "transducer.range_kpa",
    ),
    (
        "paper-prestretched",
        "kind = \"ratiometric\"\nquantity = \"absolute\"\nrange_kpa = [20.0, 250.0]",
        "transducer.range_kpa",
    ),
    // An absolute part that does not reach the air, and one that is none.
    (
        "index-fingertip-elastic",
        "kind = \"ratiometric\"\nquantity = \"absolute\"\nrange_kpa = [0.0, 100.0]",
        "range_kpa",
    ),
    (
        "skin-light-touch",
        "kind = \"abp2\"\nquantity = \"absolute\"\nrange_kpa = [0.0, 12.0]",
        "quantity",
    ),
];

#[test]
fn a_transducer_that_does_not_fit_its_design_is_refused_in_one_line() {
    for (shipped, section, key) in MISFITS {
        let refused = match DesignFile::parse(&with_transducer(shipped, section), "misfit.toml") {
            Err(error) => error.to_string(),
            Ok(design) => match generate::solve(&design) {
                Err(error) => error.to_string(),
                Ok(_) => panic!("{shipped} with {section} is not refused"),
            },
        };
        println!("{shipped} with {section:?}: {refused}");
        assert!(
            refused.contains(key) && refused.lines().count() == 1,
            "{shipped} with {section}: {refused}"
        );
    }
}
