//! `designer monitor` on the running image, over the socket that `cargo demo --serve` opens.

use crate::{design, firmware};
use emulator::bench;
use emulator::scenario::Scenario;
use emulator::serve::Server;
use fingertip::link::command::Command;
use fingertip::status::Status;
use monitor::link::{Address, Link, LinkEvent};
use monitor::readings::{Connection, LiveReading, Monitor};
use monitor::view::{self, ViewContext};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

/// Longer than any of this takes on any host.
const LONG: Duration = Duration::from_mins(2);
/// The emulated transducer's noise, filtered, moves the force by less.
const CLOSE: f64 = 0.01;

/// The program without its keyboard.
struct Program {
    link: Link,
    monitor: Monitor,
    start: Instant,
    readings: Vec<LiveReading>,
}

impl Program {
    /// Takes what comes until something holds.
    fn until(&mut self, what: &str, mut holds: impl FnMut(&Self) -> bool) {
        while !holds(self) {
            assert!(
                self.start.elapsed() < LONG,
                "{what} did not come:\n{}",
                self.screen()
            );
            match self.link.next(Duration::from_millis(50)) {
                Some(LinkEvent::Connected) => self.monitor.connected(),
                Some(LinkEvent::Lost(reason)) => self.monitor.lost(&reason),
                Some(LinkEvent::Bytes(bytes)) => {
                    for byte in bytes {
                        let heard = self.monitor.hear(byte, self.start.elapsed());
                        self.readings.extend(heard);
                    }
                }
                None => {}
            }
        }
    }

    fn screen(&self) -> String {
        let mut terminal = Terminal::new(TestBackend::new(100, 30)).expect("memory");
        let surroundings = ViewContext::default();
        terminal
            .draw(|frame| view::draw(frame, &self.monitor, &surroundings, self.start.elapsed()))
            .expect("memory");
        terminal.backend().to_string()
    }
}

#[test]
fn the_monitor_shows_the_force_that_presses_and_a_refused_tare() {
    // A grasp of a minute: the board runs ahead of who watches it, and must still be pressed when the command arrives.
    let story = Scenario::named("long-hold").expect("it is shipped");
    let plant = design().plant(story).expect("the default design can be pressed");
    let held = plant.truth(10.0);
    // Built before the clock runs.
    let image = firmware();
    let server = Server::bind("127.0.0.1:0").expect("a port");
    let address = server.address().expect("bound").to_string();
    let ended = server.ended();
    let board = thread::spawn(move || {
        bench::run(image, plant, f64::INFINITY, &[], server).map(|outcome| outcome.gaps)
    });
    let mut program = Program {
        link: Link::start(Address::Tcp(address), None),
        monitor: Monitor::default(),
        start: Instant::now(),
        readings: Vec::new(),
    };
    let near = |reading: &LiveReading| {
        reading
            .ok()
            .is_some_and(|values| (values.force_n[0] / held.force - 1.0).abs() < CLOSE)
    };
    program.until("the held force", |program| {
        program.readings.last().is_some_and(near)
    });
    let reading = *program.readings.last().expect("just seen");
    assert_eq!(reading.status, Status::Ok);
    let indentation = reading.ok().expect("just seen").indentation_mm[0];
    assert!(
        (indentation / (1e3 * held.indentation) - 1.0).abs() < CLOSE,
        "{indentation} mm"
    );
    // Before it: no force while the zero was taken, and the reason.
    assert!(
        program
            .readings
            .iter()
            .any(|reading| reading.ok().is_none() && reading.status.to_string() == "fault: zeroing")
    );
    let screen = program.screen();
    println!("{screen}");
    let shown = format!("{:.4} N", reading.ok().expect("just seen").force_n[0]);
    assert!(
        screen.contains(&shown) && screen.contains("touched"),
        "{shown} in\n{screen}"
    );

    let now = program.start.elapsed();
    let tare = program
        .monitor
        .command(Command::Tare, now)
        .expect("it is connected");
    program.link.send(&tare);
    program.until("the answer", |program| {
        program.monitor.journal().any(|line| line.starts_with("tare 1:"))
    });
    let answered = program
        .monitor
        .journal()
        .any(|line| line == "tare 1: refused: the fingertip is touched, or may be");
    assert!(answered, "{}", program.screen());
    let counts = program.monitor.counts();
    assert_eq!((counts.missing, counts.broken), (0, 0));

    ended.store(true, Ordering::Relaxed);
    let gaps = board.join().expect("it ends").expect("the image runs");
    assert_eq!(gaps, Vec::<String>::new());
    program.until("the end", |program| {
        matches!(program.monitor.connection(), Connection::Lost(_))
    });
    assert!(
        program.screen().contains("not shown: no report"),
        "{}",
        program.screen()
    );
}
