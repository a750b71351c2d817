use super::*;
use crate::device::logic::Beginning;
use crate::device::task_monitor::CrashRecord;
use crate::link::command::{CommandKind, Outcome};
use crate::signal::test_design::Linear;
use crate::status::{ResetCause, Stored, Touch};
use crate::units::Millipascals;

const EVERY: u16 = 2;

const NAMES: HandNames<3> = HandNames {
    hash: 77,
    tips: ["thumb", "index", "middle"],
};

/// What a frame was, as a test wants it.
#[derive(Clone, Debug, PartialEq)]
enum Sent {
    Readings(Vec<Report>),
    Board(u64, u32),
    Tip(u8, &'static str, u64),
    Answer(u8, CommandKind, Outcome),
}

fn sent(frame: &HandFrame<'_>) -> Sent {
    match *frame {
        HandFrame::Readings { reports, .. } => Sent::Readings(reports.to_vec()),
        HandFrame::Board(hello, tips) => {
            assert_eq!(tips, 3);
            Sent::Board(hello.design_hash, hello.report_period)
        }
        HandFrame::Tip(tip, name, hello) => Sent::Tip(tip, name, hello.design_hash),
        HandFrame::Answer(tip, answer) => Sent::Answer(tip, answer.command, answer.outcome),
        HandFrame::Band(..) => unreachable!("these tips are told what they touch"),
        #[cfg(feature = "load-tip")]
        HandFrame::Load(..) => unreachable!("no tip makes one"),
    }
}

struct Bench {
    tips: [Device<Linear>; 3],
    hand: Hand<3>,
    ms: u64,
    sent: Vec<Sent>,
    to_store: Vec<(u8, ToStore)>,
}

/// A pressure, pascals, or a broken wire.
fn sample(pascals: Option<f64>) -> Result<Sample, Fault> {
    pascals.ok_or(Fault::SensorOpen).map(|pascals| Sample {
        pressure: Millipascals((pascals * 1000.0) as i32),
        headroom: Millipascals(1),
        age: 500,
        ..Sample::default()
    })
}

impl Bench {
    fn new() -> Self {
        let beginning = Beginning {
            reset_cause: ResetCause::PowerOn,
            start: CrashRecord::start(None, ResetCause::PowerOn, NAMES.hash),
            stored: Stored::None,
            stored_sequence: 0,
            calibration: None,
            clock_failed: false,
            firmware: [0, 1, 0],
        };
        let mut tips = [(); 3].map(|()| Device::new(Linear::NEW, &beginning));
        let hand = Hand::new(NAMES, &mut dynamic(&mut tips), EVERY);
        Self {
            tips,
            hand,
            ms: 0,
            sent: vec![],
            to_store: vec![],
        }
    }

    /// Untouched until every zero is taken.
    fn zeroed() -> Self {
        let mut bench = Self::new();
        bench.steps(400, [Some(20_000.0); 3]);
        bench.sent.clear();
        bench
    }

    /// The last reports of so many steps.
    fn steps(&mut self, times: u64, pascals: [Option<f64>; 3]) -> [Report; 3] {
        let mut last = None;
        for _ in 0..times {
            self.ms += 1;
            let now = Microseconds(self.ms * 1000);
            let samples = pascals.map(sample);
            let all = &mut self.sent;
            let put = |frame: &HandFrame<'_>| all.push(sent(frame));
            self.hand.step(&mut dynamic(&mut self.tips), now, &samples, put);
            last = Some(*self.hand.reports());
        }
        last.expect("a step")
    }

    fn ask(&mut self, tip: u8, command: Command) -> bool {
        let request = Request { sequence: 9, command };
        let now = Microseconds(self.ms * 1000);
        let all = &mut self.sent;
        let put = |frame: &HandFrame<'_>| all.push(sent(frame));
        let kept = &mut self.to_store;
        let store = |tip, to_store| kept.push((tip, to_store));
        self.hand
            .request(&mut dynamic(&mut self.tips), now, (tip, request), put, store)
    }

    fn stored(&mut self, tip: u8, result: Result<(), StoreError>, number: u32) {
        let now = Microseconds(self.ms * 1000);
        let all = &mut self.sent;
        let put = |frame: &HandFrame<'_>| all.push(sent(frame));
        self.hand
            .stored(&mut dynamic(&mut self.tips), now, (tip, result, number), put);
    }

    /// The tips' greetings, when asked for.
    fn greeted(&mut self) -> Vec<Hello> {
        let mut greetings = vec![];
        let request = Request {
            sequence: 9,
            command: Command::Info,
        };
        let put = |frame: &HandFrame<'_>| {
            if let HandFrame::Tip(_, _, hello) = frame {
                greetings.push(*hello);
            }
        };
        let now = Microseconds(self.ms * 1000);
        let asked = (ALL_TIPS, request);
        self.hand
            .request(&mut dynamic(&mut self.tips), now, asked, put, |_, _| {});
        greetings
    }

    fn answers(&self) -> Vec<Sent> {
        let answer = |sent: &&Sent| matches!(sent, Sent::Answer(..));
        self.sent.iter().filter(answer).cloned().collect()
    }
}

fn dynamic(tips: &mut [Device<Linear>; 3]) -> [&mut dyn HandTip; 3] {
    tips.each_mut().map(|tip| tip as &mut dyn HandTip)
}

#[test]
fn a_press_and_a_broken_wire_are_each_one_tips() {
    let mut bench = Bench::zeroed();
    // 3 kPa over rest is 3 000 * 256 uN by the design's line.
    let [pressed, open, rest] = bench.steps(50, [Some(23_000.0), None, Some(20_000.0)]);
    let pressed = pressed.outcome.expect("a reading");
    assert_eq!((pressed.force.0, pressed.touch), (3_000 << 8, Touch::Touched));
    assert_eq!(open.outcome, Err(Fault::SensorOpen));
    let rest = rest.outcome.expect("a reading");
    assert_eq!((rest.force.0, rest.touch), (0, Touch::Untouched));
}

#[test]
fn reports_of_one_instant_share_one_time() {
    let mut bench = Bench::zeroed();
    for pascals in [[Some(20_000.0); 3], [Some(21_000.0), None, Some(20_000.0)]] {
        let reports = bench.steps(20, pascals);
        // Also that of the fault.
        assert!(
            reports.iter().all(|report| report.time == reports[0].time),
            "{reports:?}"
        );
    }
}

#[test]
fn one_of_two_reports_is_sent_and_a_change_at_once() {
    let mut bench = Bench::zeroed();
    bench.steps(100, [Some(20_000.0); 3]);
    let readings = |bench: &Bench| {
        bench
            .sent
            .iter()
            .filter(|sent| matches!(sent, Sent::Readings(_)))
            .count()
    };
    assert_eq!(readings(&bench), 50);
    bench.sent.clear();
    // A wire breaks and heals, each in the middle of a pair: both are sent at once, all tips with them.
    bench.steps(1, [Some(20_000.0); 3]);
    bench.sent.clear();
    for _ in 0..3 {
        bench.steps(1, [Some(20_000.0), None, Some(20_000.0)]);
        let before = readings(&bench);
        bench.steps(1, [Some(20_000.0); 3]);
        assert_eq!((before, readings(&bench)), (1, 2));
        bench.sent.clear();
    }
    bench.ask(1, Command::Rate { every: 10 });
    bench.steps(200, [Some(20_000.0); 3]);
    bench.sent.clear();
    bench.steps(100, [Some(20_000.0); 3]);
    assert_eq!(readings(&bench), 10);
}

#[test]
fn a_command_is_answered_by_its_tip_or_by_all() {
    let mut bench = Bench::zeroed();
    assert!(bench.ask(1, Command::Undo));
    assert_eq!(
        bench.answers(),
        [Sent::Answer(1, CommandKind::Undo, Outcome::NothingToUndo)]
    );
    bench.sent.clear();
    assert!(bench.ask(ALL_TIPS, Command::Tare));
    bench.steps(2_500, [Some(20_000.0), Some(20_000.0), Some(26_000.0)]);
    let mut answers = bench.answers();
    answers.sort_by_key(|answer| format!("{answer:?}"));
    // Something presses the third.
    assert_eq!(
        answers[..2],
        [0, 1].map(|tip| Sent::Answer(tip, CommandKind::Tare, Outcome::Done))
    );
    assert!(
        matches!(answers[2], Sent::Answer(2, CommandKind::Tare, outcome) if outcome != Outcome::Done),
        "{answers:?}"
    );
    bench.sent.clear();
    assert!(!bench.ask(3, Command::Undo));
}

#[test]
fn each_tip_stores_its_own_calibration_and_answers_when_it_is_stored() {
    let mut bench = Bench::new();
    // Each rests at another pressure.
    bench.steps(400, [Some(20_000.0), Some(20_010.0), Some(20_020.0)]);
    bench.sent.clear();
    assert!(bench.ask(ALL_TIPS, Command::Save { gain: Some(5_000) }));
    let zeros: Vec<(u8, i32, i32)> = bench
        .to_store
        .iter()
        .map(|(tip, ToStore(calibration))| {
            let calibration = calibration.expect("a zero that holds");
            let zero = calibration.zero.expect("it was found").0;
            (*tip, (zero + 500) / 1000, calibration.gain)
        })
        .collect();
    assert_eq!(
        zeros,
        [(0, 20_000, 5_000), (1, 20_010, 5_000), (2, 20_020, 5_000)]
    );
    // Nothing is done before the flash has it; a tip that waits is busy.
    assert_eq!(bench.answers(), []);
    assert!(bench.ask(1, Command::Forget));
    assert_eq!(
        bench.answers(),
        [Sent::Answer(1, CommandKind::Forget, Outcome::Busy)]
    );
    bench.sent.clear();
    bench.stored(2, Ok(()), 3);
    bench.stored(0, Err(StoreError::Failed), 0);
    // There is no such tip.
    bench.stored(3, Ok(()), 9);
    let answer = |tip, outcome| Sent::Answer(tip, CommandKind::Save, outcome);
    assert_eq!(
        bench.answers(),
        [answer(2, Outcome::Done), answer(0, Outcome::MemoryFailed)]
    );
    bench.sent.clear();
    let numbers: Vec<(Stored, u32)> = bench
        .greeted()
        .iter()
        .map(|hello| (hello.stored, hello.stored_sequence))
        .collect();
    assert_eq!(
        numbers,
        [(Stored::None, 0), (Stored::None, 0), (Stored::InUse, 3)]
    );
}

#[test]
fn the_board_and_each_tip_greet_once_a_second() {
    let mut bench = Bench::new();
    bench.steps(1_000, [Some(20_000.0); 3]);
    let greetings: Vec<Sent> = bench
        .sent
        .iter()
        .filter(|sent| matches!(sent, Sent::Board(..) | Sent::Tip(..)))
        .cloned()
        .collect();
    // The design's hash is 1.
    assert_eq!(
        greetings,
        [
            Sent::Board(77, 2_000),
            Sent::Tip(0, "thumb", 1),
            Sent::Tip(1, "index", 1),
            Sent::Tip(2, "middle", 1)
        ]
    );
}
