use super::*;
use crate::device::task_monitor::CrashRecord;
use crate::signal::design::NoSuchObject;
use crate::signal::test_design::{Linear, TRANSDUCERS};
use crate::status::Touch;
use crate::units::{Millipascals, Pressure};
use model_tables::table::Reading;
use model_tables::table::band::{ChipBand, ChipBandRow, MAX_BAND_ROWS};
use model_tables::table::law::Touched;
use model_tables::units::PressureRise;
use proptest::prelude::*;

const BEGINNING: Beginning = Beginning {
    reset_cause: ResetCause::PowerOn,
    start: Start {
        fault: LastFault::None,
        detail: 0,
        kept: None,
        give_up: false,
        crash_record: CrashRecord {
            fault: LastFault::None,
            detail: 0,
            resets: 0,
            good: false,
            design_hash: 1,
            zero: None,
        },
    },
    stored: Stored::None,
    stored_sequence: 0,
    calibration: None,
    clock_failed: false,
    firmware: [0, 1, 0],
};

struct Bench {
    device: Device<Linear>,
    ms: u64,
    emitted: Vec<Message>,
}

impl Bench {
    fn new(beginning: &Beginning) -> Self {
        Self {
            device: Device::new(Linear::NEW, beginning),
            ms: 0,
            emitted: vec![],
        }
    }

    fn zeroed() -> Self {
        let mut bench = Self::new(&BEGINNING);
        bench.steps(400, 20_000.0);
        bench.emitted.clear();
        bench
    }

    fn steps(&mut self, times: u64, pascals: f64) {
        let sample = Sample {
            pressure: Millipascals((pascals * 1000.0) as i32),
            headroom: Millipascals(1),
            age: 500,
            ..Sample::default()
        };
        for _ in 0..times {
            self.ms += 1;
            let emitted = &mut self.emitted;
            self.device
                .step(Microseconds(self.ms * 1000), Ok(sample), |message| {
                    emitted.push(*message);
                });
        }
    }

    fn ask(&mut self, command: Command) -> Option<ToStore> {
        let emitted = &mut self.emitted;
        let request = Request { sequence: 9, command };
        self.device
            .request(Microseconds(self.ms * 1000), request, |message| {
                emitted.push(*message);
            })
    }

    fn stored(&mut self, result: Result<(), StoreError>) {
        let emitted = &mut self.emitted;
        self.device
            .stored(Microseconds(self.ms * 1000), result, 17, |message| {
                emitted.push(*message);
            });
    }

    fn answers(&mut self) -> Vec<(CommandKind, Outcome, u16)> {
        self.emitted
            .drain(..)
            .filter_map(|message| match message {
                Message::Answer(answer) => {
                    assert_eq!(answer.command_sequence, 9);
                    Some((answer.command, answer.outcome, answer.findings))
                }
                _ => None,
            })
            .collect()
    }

    fn reports(&self) -> usize {
        self.emitted
            .iter()
            .filter(|message| matches!(message, Message::Report { .. }))
            .count()
    }
}

#[test]
fn a_report_each_period_and_a_hello_each_second() {
    let mut bench = Bench::zeroed();
    bench.steps(2_000, 20_000.0);
    assert_eq!(bench.reports(), 2_000);
    assert_eq!(bench.emitted.len(), 2_002);
}

#[test]
fn at_a_lower_rate_a_change_of_status_is_still_reported_at_once() {
    let mut bench = Bench::zeroed();
    bench.ask(Command::Rate { every: 100 });
    assert_eq!(bench.answers(), [(CommandKind::Rate, Outcome::Done, 0)]);
    bench.steps(1_000, 20_000.0);
    assert_eq!(bench.reports(), 10);
    bench.emitted.clear();
    bench.steps(20, 70_000.0);
    let statuses: Vec<String> = bench
        .emitted
        .iter()
        .filter_map(|message| match message {
            Message::Report { report, .. } => Some(report.status().to_string()),
            _ => None,
        })
        .collect();
    assert_eq!(statuses, ["fault: jump", "warning: saturated"]);
}

#[test]
fn a_tare_is_answered_when_it_is_taken_or_refused() {
    let mut bench = Bench::zeroed();
    bench.ask(Command::Tare);
    assert_eq!(bench.answers(), []);
    bench.ask(Command::Tare);
    assert_eq!(bench.answers(), [(CommandKind::Tare, Outcome::Busy, 0)]);
    bench.steps(300, 20_010.0);
    assert_eq!(bench.answers(), [(CommandKind::Tare, Outcome::Done, 0)]);
    bench.ask(Command::Undo);
    bench.ask(Command::Undo);
    assert_eq!(
        bench.answers(),
        [
            (CommandKind::Undo, Outcome::Done, 0),
            (CommandKind::Undo, Outcome::NothingToUndo, 0)
        ]
    );
    bench.ask(Command::Tare);
    bench.steps(2_100, 21_000.0);
    assert_eq!(bench.answers(), [(CommandKind::Tare, Outcome::Touched, 0)]);
}

#[test]
fn a_save_is_answered_when_the_memory_has_it() {
    let mut bench = Bench::zeroed();
    let to_store = bench.ask(Command::Save { gain: Some(1_000) });
    let calibration = to_store.and_then(|to_store| to_store.0).expect("a verified zero");
    assert!((calibration.zero.expect("a zero").0 - 20_000_000).abs() < 100);
    assert_eq!(calibration.gain, 1_000);
    assert_eq!(bench.ask(Command::Save { gain: None }), None);
    assert_eq!(bench.answers(), [(CommandKind::Save, Outcome::Busy, 0)]);
    bench.stored(Ok(()));
    assert_eq!(bench.answers(), [(CommandKind::Save, Outcome::Done, 0)]);
    // The next one keeps the gain.
    let again = bench
        .ask(Command::Save { gain: None })
        .and_then(|to_store| to_store.0);
    assert_eq!(again.map(|calibration| calibration.gain), Some(1_000));
    bench.emitted.clear();
    bench.stored(Err(StoreError::Failed));
    assert_eq!(bench.answers(), [(CommandKind::Save, Outcome::MemoryFailed, 0)]);
    // The store limits how often.
    assert!(bench.ask(Command::Save { gain: None }).is_some());
    bench.stored(Err(StoreError::TooSoon));
    assert_eq!(bench.answers(), [(CommandKind::Save, Outcome::SavedTooOften, 0)]);
    bench.ask(Command::Info);
    let Some(Message::Hello(hello)) = bench.emitted.first() else {
        panic!("{:?}", bench.emitted);
    };
    assert_eq!((hello.stored, hello.stored_sequence), (Stored::InUse, 17));
}

#[test]
fn without_a_verified_zero_nothing_is_saved() {
    let mut bench = Bench::new(&BEGINNING);
    bench.steps(2_100, 25_000.0);
    bench.emitted.clear();
    assert_eq!(bench.ask(Command::Save { gain: None }), None);
    assert_eq!(bench.answers(), [(CommandKind::Save, Outcome::ZeroUnverified, 0)]);
}

#[test]
fn what_was_stored_can_be_forgotten() {
    let mut bench = Bench::zeroed();
    assert_eq!(bench.ask(Command::Forget), Some(ToStore(None)));
    bench.stored(Ok(()));
    assert_eq!(bench.answers(), [(CommandKind::Forget, Outcome::Done, 0)]);
}

#[test]
fn a_self_test_names_what_it_finds() {
    let mut bench = Bench::zeroed();
    bench.ask(Command::SelfTest { indentation: 0 });
    assert_eq!(
        bench.answers(),
        [(CommandKind::SelfTest, Outcome::Done, findings::NOT_STORED)]
    );
    // 1 nm a count of 1/256 Pa: 500 Pa are 0.128 mm.
    bench.steps(5, 20_500.0);
    bench.emitted.clear();
    bench.ask(Command::SelfTest { indentation: 128_000 });
    bench.ask(Command::SelfTest { indentation: 256_000 });
    bench.steps(1, 20_500.0);
    bench.ask(Command::SelfTest { indentation: 0 });
    let found: Vec<u16> = bench.answers().iter().map(|(_, _, found)| *found).collect();
    let stored = findings::NOT_STORED;
    assert_eq!(found, [stored, stored | findings::SOFT, stored | findings::FLUID]);
    let mut silent = Bench::new(&BEGINNING);
    silent.ask(Command::SelfTest { indentation: 0 });
    assert_eq!(silent.answers()[0].2, findings::NO_READING | findings::NOT_STORED);
}

fn given_up() -> Bench {
    let zero = Zero {
        pressure: Pressure::from_pascals(20_000, Linear::PRESSURE_FRACTION_BITS),
        bound: 0,
        verified: true,
    };
    let mut bench = Bench::new(&Beginning {
        reset_cause: ResetCause::Watchdog,
        start: Start {
            give_up: true,
            kept: Some(zero),
            ..BEGINNING.start
        },
        ..BEGINNING
    });
    bench.steps(500, 20_000.0);
    bench
}

#[test]
fn after_too_many_resets_it_measures_nothing() {
    assert!(given_up().emitted.iter().all(|message| match message {
        Message::Report { report, .. } => report.outcome == Err(Fault::ResetLoop),
        _ => true,
    }));
}

#[test]
fn after_too_many_resets_every_command_is_answered() {
    let found = findings::NO_READING | findings::NOT_STORED;
    for (command, outcome, findings) in [
        (Command::Tare, Outcome::NoReading, 0),
        (Command::Undo, Outcome::NothingToUndo, 0),
        (Command::Save { gain: None }, Outcome::NoReading, 0),
        (Command::Info, Outcome::Done, 0),
        (Command::SelfTest { indentation: 0 }, Outcome::Done, found),
        (Command::Rate { every: 10 }, Outcome::Done, 0),
        (Command::Forget, Outcome::Done, 0),
    ] {
        let mut bench = given_up();
        bench.emitted.clear();
        if bench.ask(command).is_some() {
            bench.stored(Ok(()));
        }
        bench.steps(2_500, 20_000.0);
        assert_eq!(bench.answers(), [(command.kind(), outcome, findings)]);
    }
}

/// The report periods of two hellos: the first, and one at every tenth report.
fn greeted_periods(transducer: usize) -> [u32; 2] {
    let mut device = Device::new(Linear::with(TRANSDUCERS[transducer]), &BEGINNING);
    let mut greeted = vec![];
    let mut hear = |message: &Message| {
        if let Message::Hello(hello) = message {
            greeted.push(hello.report_period);
        }
    };
    device.step(Microseconds(0), Err(Fault::SensorAbsent), &mut hear);
    for command in [Command::Rate { every: 10 }, Command::Info] {
        device.request(Microseconds(1), Request { sequence: 1, command }, &mut hear);
    }
    greeted.try_into().expect("two hellos")
}

/// As the README's table of transducers has them.
#[test]
fn the_hello_has_the_report_period_of_the_transducer() {
    assert_eq!(greeted_periods(0), [1_000, 10_000]);
    assert_eq!(greeted_periods(2), [8_000, 80_000]);
    assert_eq!(greeted_periods(3), [7_000, 70_000]);
    assert_eq!(greeted_periods(4), [14_000, 140_000]);
}

#[test]
fn a_record_that_cannot_serve_qualifies_every_reading() {
    for stored in [Stored::OtherDesign, Stored::Damaged, Stored::Unreadable] {
        let mut bench = Bench::new(&Beginning { stored, ..BEGINNING });
        bench.steps(400, 20_000.0);
        let Some(Message::Report { report, .. }) = bench.emitted.last() else {
            panic!("it reports");
        };
        assert_eq!(report.status().to_string(), "warning: calibration refused");
        assert_eq!(report.outcome.map(|reading| reading.touch), Ok(Touch::Untouched));
    }
}

proptest! {
    #[test]
    fn every_command_is_answered_once(commands in prop::collection::vec((0..7, 0..30_u64, 20_000..20_100_u32), 1..40)) {
        let mut bench = Bench::zeroed();
        let mut asked = 0;
        for (which, ms, pascals) in commands {
            let command = match which {
                0 => Command::Tare,
                1 => Command::Undo,
                2 => Command::Save { gain: None },
                3 => Command::Info,
                4 => Command::SelfTest { indentation: 1 },
                5 => Command::Rate { every: 3 },
                _ => Command::Forget,
            };
            let to_store = bench.ask(command);
            asked += 1;
            bench.steps(ms, f64::from(pascals));
            if to_store.is_some() {
                bench.stored(Ok(()));
            }
        }
        bench.steps(2_500, 20_000.0);
        prop_assert_eq!(bench.answers().len(), asked);
    }
}

/// A motor that stalls in a grasp pulls the battery down, again and again.
#[test]
fn a_supply_that_sags_in_a_grasp_keeps_the_zero_and_ends_with_a_reason() {
    let mut bench = Bench::zeroed();
    let mut zero = bench.device.zero();
    let mut found = Some(CrashRecord {
        design_hash: 1,
        zero,
        ..CrashRecord::default()
    });
    for reset in 1..=6 {
        let start = CrashRecord::start(found, ResetCause::BrownOut, 1);
        let gives_up = reset == 6;
        assert_eq!((start.crash_record.resets, start.give_up), (reset, gives_up));
        bench = Bench::new(&Beginning {
            reset_cause: ResetCause::BrownOut,
            start,
            ..BEGINNING
        });
        // 200 Pa over rest would be near enough for a new zero.
        bench.steps(3, 20_200.0);
        bench.emitted.clear();
        bench.steps(1, 20_200.0);
        let Some(Message::Report { report, .. }) = bench.emitted.last() else {
            panic!("a report each step, and the hello was before")
        };
        match report.outcome {
            Ok(reading) => {
                assert!((reading.pressure_rise.pascals(8) - 200.0).abs() < 1.0);
                assert_eq!(report.status(), Status::Ok);
            }
            Err(fault) => assert_eq!((fault, gives_up), (Fault::ResetLoop, true)),
        }
        zero = bench.device.zero().or(zero);
        found = Some(CrashRecord {
            zero,
            ..start.crash_record
        });
    }
    bench.emitted.clear();
    bench.ask(Command::Info);
    let hello = bench.emitted.iter().find_map(|message| match message {
        Message::Hello(hello) => Some(*hello),
        _ => None,
    });
    let hello = hello.expect("it was asked for");
    assert_eq!(
        (hello.reset_cause, hello.resets_in_a_row),
        (ResetCause::BrownOut, 6)
    );
}

/// A design that is not told what it touches, until it is.
#[derive(Clone, Debug)]
struct Unsure {
    linear: Linear,
    as_designed: bool,
}

const BAND: ChipBand = ChipBand {
    from: PressureRise(1_000),
    count: 1,
    rows: [ChipBandRow::NOTHING; MAX_BAND_ROWS],
};

impl Design for Unsure {
    type Wall = <Linear as Design>::Wall;
    type Around = <Linear as Design>::Around;

    fn parameters(&self) -> &Parameters {
        self.linear.parameters()
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        self.linear.lookup(rise)
    }

    fn touch(&mut self, touched: Touched) -> Result<(), NoSuchObject> {
        self.as_designed = touched == Touched::Plate;
        Ok(())
    }

    fn band(&self) -> Option<&ChipBand> {
        Some(&BAND).filter(|_| self.as_designed)
    }
}

/// The band follows each hello, and no other than the design's object has one.
#[test]
fn a_band_follows_each_hello_while_the_object_is_unknown() {
    let unsure = Unsure {
        linear: Linear::NEW,
        as_designed: true,
    };
    let mut device = Device::new(unsure, &BEGINNING);
    let mut bands = |command: Option<Command>, ms: u64| {
        let mut emitted = vec![];
        let now = Microseconds(1000 * ms);
        if let Some(command) = command {
            let request = Request { sequence: 9, command };
            device.request(now, request, |message| emitted.push(*message));
        }
        let _ = device.step(now, Err(Fault::SensorOpen), |message| emitted.push(*message));
        let kinds: String = emitted
            .iter()
            .map(|message| match message {
                Message::Hello(_) => 'h',
                Message::Band(band) => {
                    assert_eq!((band.time, band.band), (now, BAND));
                    assert_eq!(
                        u32::from(band.pressure_fraction_bits),
                        Linear::PRESSURE_FRACTION_BITS
                    );
                    'b'
                }
                Message::Answer(_) => 'a',
                _ => 'r',
            })
            .collect();
        kinds
    };
    assert_eq!(bands(None, 1), "hbr");
    assert_eq!(bands(None, 2), "r");
    assert_eq!(bands(Some(Command::Info), 3), "hbar");
    assert_eq!(bands(Some(Command::Object(Touched::Ball(8_000))), 4), "ar");
    assert_eq!(bands(Some(Command::Info), 5), "har");
    assert_eq!(bands(Some(Command::Object(Touched::Plate)), 6), "ar");
    assert_eq!(bands(None, 1_002), "hbr");
}

#[test]
fn an_object_is_refused_by_a_design_that_has_none() {
    let mut bench = Bench::zeroed();
    bench.ask(Command::Object(Touched::Ball(8_000)));
    bench.ask(Command::Indentation { known: 1_000_000 });
    let outcomes: Vec<Outcome> = bench
        .emitted
        .iter()
        .filter_map(|message| match message {
            Message::Answer(answer) => Some(answer.outcome),
            _ => None,
        })
        .collect();
    assert_eq!(outcomes, [Outcome::NoSuchObject, Outcome::NoReading]);
}
