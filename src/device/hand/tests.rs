use super::*;
use crate::device::logic::Beginning;
use crate::device::task_monitor::CrashRecord;
use crate::link::command::CommandKind;
use crate::signal::test_design::Linear;
use crate::status::{ResetCause, Stored, Touch};
use crate::units::Millipascals;

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
    }
}

struct Bench {
    tips: [Device<Linear>; 3],
    hand: Hand<3>,
    ms: u64,
    sent: Vec<Sent>,
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
        let hand = Hand::new(NAMES, &mut dynamic(&mut tips));
        Self {
            tips,
            hand,
            ms: 0,
            sent: vec![],
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
            last = Some(self.hand.step(&mut dynamic(&mut self.tips), now, &samples, put));
        }
        last.expect("a step")
    }

    fn ask(&mut self, tip: u8, command: Command) -> bool {
        let request = Request { sequence: 9, command };
        let now = Microseconds(self.ms * 1000);
        let all = &mut self.sent;
        let put = |frame: &HandFrame<'_>| all.push(sent(frame));
        self.hand
            .request(&mut dynamic(&mut self.tips), now, (tip, request), put)
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
    assert!(bench.ask(2, Command::Save { gain: None }) && bench.ask(0, Command::Forget));
    assert_eq!(
        bench.answers(),
        [
            Sent::Answer(2, CommandKind::Save, Outcome::NotInImage),
            Sent::Answer(0, CommandKind::Forget, Outcome::NotInImage)
        ]
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
