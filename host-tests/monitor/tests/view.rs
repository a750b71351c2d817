//! The view on a terminal of memory: frames of the firmware's own encoder in, the screen out.

use fingertip::link::band::BandMessage;
use fingertip::link::command::{Command, CommandKind, Outcome};
use fingertip::link::telemetry::{Answer, Frame, Hello, Message, encode};
use fingertip::signal::report::{Measurement, Report, Sigma};
use fingertip::status::{Fault, Touch, Warnings};
use fingertip::units::Microseconds;
use model_tables::table::band::{ChipBand, ChipBandRow, MAX_BAND_ROWS};
use model_tables::units::PressureRise;
use monitor::readings::{Monitor, STALE};
use monitor::view::{self, ViewContext};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use std::time::Duration;

/// A measurement of 1.2345 N, without naming units that another crate owns.
fn measurement(warnings: Warnings) -> Measurement {
    let mut measurement = Measurement {
        touch: Touch::Touched,
        warnings,
        ..Measurement::default()
    };
    measurement.force.0 = 1_234_500;
    measurement.indentation.0 = 750_000;
    measurement.pressure_rise.0 = 16_008;
    let mut sigma = Sigma::default();
    sigma.force.0 = 1_000;
    measurement.sigma = sigma;
    measurement
}

fn report(milliseconds: u64, outcome: Result<Measurement, Fault>) -> Message {
    Message::Report {
        report: Report {
            time: Microseconds(1000 * milliseconds),
            outcome,
        },
        pressure_fraction_bits: 4,
    }
}

/// Hears messages, numbered from `sequence` on, all at one instant.
fn hear(monitor: &mut Monitor, sequence: u16, now: Duration, messages: &[Message]) {
    for (i, message) in (0..).zip(messages) {
        let frame = Frame {
            sequence: sequence + i,
            dropped: 0,
            message: *message,
        };
        for &byte in encode(&frame).iter() {
            monitor.hear(byte, now);
        }
    }
}

fn screen(monitor: &Monitor, now: Duration) -> String {
    let mut terminal = Terminal::new(TestBackend::new(100, 30)).expect("memory");
    let surroundings = ViewContext {
        address: "/dev/ttyACM0".to_owned(),
        ..ViewContext::default()
    };
    terminal
        .draw(|frame| view::draw(frame, monitor, &surroundings, now))
        .expect("memory");
    terminal.backend().to_string()
}

const NOW: Duration = Duration::from_secs(3);

fn connected() -> Monitor {
    let mut monitor = Monitor::default();
    monitor.connected();
    monitor
}

/// The band of a hello is beside each reading in it, until the next hello or the answer to an object.
#[test]
fn an_unknown_object_has_lower_and_upper_beside_each_reading() {
    let mut rows = [ChipBandRow::NOTHING; MAX_BAND_ROWS];
    rows[0] = ChipBandRow {
        to: PressureRise(2_000 << 8),
        force: [-200, 250],
        indentation: [-40, 400],
    };
    let hello = Message::Hello(Hello::default());
    let band = Message::Band(BandMessage {
        time: Microseconds(0),
        // More than the reading has.
        pressure_fraction_bits: 8,
        band: ChipBand {
            from: PressureRise(1_000 << 8),
            count: 1,
            rows,
        },
    });
    let told = Message::Answer(Answer {
        time: Microseconds(4_000),
        command: CommandKind::Object,
        command_sequence: 1,
        outcome: Outcome::Done,
        findings: 0,
        known: None,
    });
    let read = |milliseconds| report(milliseconds, Ok(measurement(Warnings::NONE)));
    let mut monitor = connected();
    hear(&mut monitor, 1, NOW, &[hello, band, read(2)]);
    let shown = screen(&monitor, NOW);
    // 1.2345 N and 0.75 mm at 1000.5 Pa.
    assert!(shown.contains("object unknown: 0.988 to 1.543"), "{shown}");
    assert!(shown.contains("object unknown: 0.720 to 1.050"), "{shown}");
    let saturated = report(3, Ok(measurement(Warnings::SATURATED)));
    for last in [vec![saturated], vec![told, read(5)], vec![hello, read(5)]] {
        let mut monitor = connected();
        hear(&mut monitor, 1, NOW, &[hello, band, read(2)]);
        hear(&mut monitor, 4, NOW, &last);
        let shown = screen(&monitor, NOW);
        assert!(!shown.contains("object unknown"), "{last:?}: {shown}");
    }
}

#[test]
fn an_ok_report_is_shown_with_its_units() {
    let mut monitor = connected();
    let hello = Message::Hello(Hello {
        firmware: [0, 1, 0],
        design_hash: 0x0123_4567_89ab_cdef,
        ..Hello::default()
    });
    hear(
        &mut monitor,
        7,
        NOW,
        &[hello, report(0, Ok(measurement(Warnings::NONE)))],
    );
    let screen = screen(&monitor, NOW);
    for words in [
        "1.2345 N ",
        "1-sigma 0.0010 N",
        "0.7500 mm",
        "1000.5 Pa",
        "touched",
        " ok",
        "connected",
        "firmware 0.1.0  design 0123456789abcdef",
        "1 reports, 0 missing, 0 broken",
    ] {
        assert!(screen.contains(words), "{words} in\n{screen}");
    }
}

/// The line of the screen that begins with a name.
fn line<'a>(screen: &'a str, name: &str) -> &'a str {
    screen
        .lines()
        .find(|line| line.contains(&format!(" {name} ")))
        .unwrap_or_else(|| panic!("{name} in\n{screen}"))
}

#[test]
fn a_force_that_is_not_ok_is_refused_with_its_reason() {
    let refused: [(Result<Measurement, Fault>, &str); 3] = [
        (
            Ok(measurement(Warnings::ZERO_UNVERIFIED)),
            "warning: zero unverified",
        ),
        (Ok(measurement(Warnings::SATURATED)), "warning: saturated"),
        (Err(Fault::SensorOpen), "fault: sensor open"),
    ];
    for (outcome, reason) in refused {
        let mut monitor = connected();
        // A good report before it must not shine through.
        hear(
            &mut monitor,
            0,
            NOW,
            &[report(0, Ok(measurement(Warnings::NONE))), report(1, outcome)],
        );
        let screen = screen(&monitor, NOW);
        for name in ["force", "indentation"] {
            let line = line(&screen, name);
            assert!(
                line.contains(&format!("not shown: {reason}")) && !line.contains("1.2345"),
                "{screen}"
            );
        }
        assert!(line(&screen, "status").contains(reason), "{screen}");
    }
}

/// Every hundredth report of a DPS310.
#[test]
fn a_report_of_a_board_that_sends_few_is_shown_until_three_are_missing() {
    let mut monitor = connected();
    let hello = Message::Hello(Hello {
        report_period: 1_400_000,
        ..Hello::default()
    });
    hear(
        &mut monitor,
        0,
        NOW,
        &[hello, report(0, Ok(measurement(Warnings::NONE)))],
    );
    let force = |milliseconds| {
        let screen = screen(&monitor, NOW + Duration::from_millis(milliseconds));
        line(&screen, "force").to_owned()
    };
    assert!(force(4_199).contains("1.2345 N"));
    assert!(force(4_200).contains("not shown: no report"));
}

#[test]
fn a_report_that_is_old_or_of_a_lost_board_is_not_shown() {
    let mut monitor = connected();
    hear(
        &mut monitor,
        0,
        NOW,
        &[report(0, Ok(measurement(Warnings::NONE)))],
    );
    assert!(line(&screen(&monitor, NOW + STALE), "force").contains("not shown: no report"));
    monitor.lost("unplugged");
    let screen = screen(&monitor, NOW);
    assert!(
        line(&screen, "force").contains("not shown: no report"),
        "{screen}"
    );
    assert!(
        screen.contains("no connection, trying again: unplugged"),
        "{screen}"
    );
}

#[test]
fn the_history_has_gaps_where_the_force_is_not_ok_and_ends_with_a_reset() {
    let mut monitor = connected();
    let ok = Ok(measurement(Warnings::NONE));
    let messages = [
        report(0, ok),
        report(5, ok),
        report(100, ok),
        report(110, Err(Fault::Jump)),
        report(120, ok),
    ];
    hear(&mut monitor, 0, NOW, &messages);
    let history: Vec<Option<f64>> = monitor
        .history()
        .iter()
        .map(|point| point.values.map(|[force, _]| force))
        .collect();
    // The second is too soon after the first to be a point of its own.
    assert_eq!(history, [Some(1.2345), Some(1.2345), None, Some(1.2345)]);
    hear(&mut monitor, 5, NOW, &[report(50, ok)]);
    assert_eq!(monitor.history().len(), 1);
}

#[test]
fn what_is_lost_or_broken_is_counted_and_answers_are_told() {
    let mut monitor = connected();
    let ok = Ok(measurement(Warnings::NONE));
    hear(&mut monitor, u16::MAX - 1, NOW, &[report(0, ok), report(1, ok)]);
    // 65535 was the last: 0 and 1 are missing.
    hear(&mut monitor, 2, NOW, &[report(4, ok)]);
    for byte in [9, 9, 9, 0] {
        monitor.hear(byte, NOW);
    }
    let counts = monitor.counts();
    assert_eq!((counts.reports, counts.missing, counts.broken), (3, 2, 1));
    let sent = monitor.command(Command::Tare, NOW).expect("it is connected");
    assert_eq!(
        fingertip::link::command::decode(&sent[..sent.len() - 1])
            .map(|request| (request.sequence, request.command)),
        Ok((1, Command::Tare))
    );
    let answer = Message::Answer(Answer {
        time: Microseconds(0),
        command: CommandKind::Tare,
        command_sequence: 1,
        outcome: Outcome::Touched,
        findings: 0,
        known: None,
    });
    hear(&mut monitor, 3, NOW, &[answer]);
    let screen = screen(&monitor, NOW);
    assert!(
        screen.contains("tare 1 sent") && screen.contains("tare 1: refused: the fingertip is touched"),
        "{screen}"
    );
}

/// Every key is explained on a screen of any size that shows values at all, and nothing of a line is cut.
#[test]
fn every_key_is_explained_on_a_small_screen_too() {
    let keys = [
        "t", "u", "s", "g", "f", "i", "x", "r", "a", "o", "d", "c", "p", "k", "?", "Esc", "q",
    ];
    for (width, height) in [(30, 8), (40, 12), (80, 24)] {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("memory");
        let context = ViewContext {
            help: true,
            ..ViewContext::default()
        };
        let monitor = connected();
        terminal
            .draw(|frame| view::draw(frame, &monitor, &context, Duration::ZERO))
            .expect("drawn");
        let text = terminal.backend().to_string();
        for key in keys {
            assert!(
                text.split_whitespace().any(|word| word.trim_matches('"') == key),
                "{key} at {width} x {height}: {text}"
            );
        }
        assert!(text.contains("forget") && text.contains("quit"), "{text}");
    }
}
