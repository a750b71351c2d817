//! The serial line, both ways: [`send`] sends frames, [`listen`] receives commands.

#[cfg(all(hand, feature = "load-tip"))]
use crate::firmware::hand_tips::LOADS;
use crate::firmware::queues::{IDLE, LISTEN, REQUESTS, Waiting, alive, refuse};
#[cfg(all(not(hand), feature = "load-tip"))]
use crate::firmware::tip::LOADS;
#[cfg(feature = "rs485")]
use core::cell::RefCell;
use embassy_stm32::usart::Error;
#[cfg(feature = "rs485")]
use embassy_sync::blocking_mutex::ThreadModeMutex;
#[cfg(feature = "rs485")]
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
#[cfg(feature = "rs485")]
use embassy_sync::signal::Signal;
use embassy_time::with_timeout;
use fingertip::board::{Clock, Line, SerialRx};
#[cfg(not(hand))]
use fingertip::image;
#[cfg(not(hand))]
use fingertip::link::command;
#[cfg(feature = "load-tip")]
use fingertip::link::load;
use fingertip::link::sink::FrameSink;
#[cfg(feature = "rs485")]
use fingertip::link::sink::Turn;
#[cfg(all(hand, feature = "load-tip"))]
use fingertip::link::tips::read_load;
#[cfg(hand)]
use fingertip::link::tips::read_request;
use fingertip::link::wire::{Deframer, Encoded};

/// Whether a design may have an `[object]`: the image's design, or a loaded one.
#[cfg(not(hand))]
const OBJECT: bool = image::HAS_OBJECT || cfg!(feature = "load-tip");

/// The turn on a shared line, and a signal that the board got it.
#[cfg(feature = "rs485")]
static TURN: ThreadModeMutex<RefCell<Turn>> = ThreadModeMutex::new(RefCell::new(Turn::HOSTS));
#[cfg(feature = "rs485")]
static GIVEN: Signal<ThreadModeRawMutex, ()> = Signal::new();

/// Takes a byte of the host; it may give the board the turn.
#[cfg(feature = "rs485")]
fn hear(byte: u8, ends_command: bool, clock: Clock) {
    if TURN.lock(|turn| turn.borrow_mut().hear(byte, ends_command, clock.now())) {
        GIVEN.signal(());
    }
}

/// A dedicated line.
#[cfg(not(feature = "rs485"))]
struct Way(Line);

#[cfg(not(feature = "rs485"))]
impl FrameSink for Way {
    type Outcome = Result<(), Error>;

    fn send(&mut self, frame: &[u8]) -> impl Future<Output = Self::Outcome> {
        self.0.write(frame)
    }
}

/// A shared line: the serial port drives it while it sends, and listens at other times.
#[cfg(feature = "rs485")]
struct Way(Line, Clock);

#[cfg(feature = "rs485")]
impl FrameSink for Way {
    type Outcome = Result<(), Error>;

    fn has_turn(&mut self) -> bool {
        TURN.lock(|turn| turn.borrow().is_boards(self.1.now()))
    }

    async fn send(&mut self, frame: &[u8]) -> Self::Outcome {
        let sent = self.0.write(frame).await;
        TURN.lock(|turn| turn.borrow_mut().sent(self.1.now()));
        sent
    }

    fn end_turn(&mut self) {
        TURN.lock(|turn| turn.borrow_mut().end());
    }
}

/// Sends frames. Period: as frames arrive; on a shared line, as the host gives the turn. Deadline: a period on average (a
/// report takes 0.5 ms on the line); when late, the queue drops its oldest frame, and the signal task is not delayed.
#[embassy_executor::task]
pub(super) async fn send(
    line: Line,
    waiting: &'static Waiting,
    #[cfg(feature = "rs485")] clock: Clock,
    mut frame: &'static mut Encoded,
) {
    #[cfg(not(feature = "rs485"))]
    let mut way = Way(line);
    #[cfg(feature = "rs485")]
    let mut way = Way(line, clock);
    loop {
        #[cfg(not(feature = "rs485"))]
        waiting.more.wait().await;
        #[cfg(feature = "rs485")]
        GIVEN.wait().await;
        while way.has_turn() && waiting.frames.borrow_mut().take(&mut frame) {
            let _ = way.send(frame.as_slice()).await;
        }
        way.end_turn();
    }
}

/// Receives commands. Period: as they arrive. Deadline: when the ring of bytes is full, after 2.8 ms on a line without pauses;
/// when late, bytes are lost, which is counted. Work is bounded by the rate of the line, and other tasks run in between.
#[embassy_executor::task]
pub(super) async fn listen(mut serial_rx: SerialRx, clock: Clock) {
    let mut deframer = Deframer::default();
    let mut bytes = [0; 32];
    loop {
        alive(LISTEN, clock.now());
        let received = match with_timeout(IDLE, serial_rx.read(&mut bytes)).await {
            Ok(Ok(length)) => bytes.get(..length).unwrap_or(&[]),
            Ok(Err(_lost)) => {
                refuse();
                &[]
            }
            Err(_idle) => continue,
        };
        for &byte in received {
            let Some(body) = deframer.push(byte) else {
                #[cfg(feature = "rs485")]
                hear(byte, false, clock);
                continue;
            };
            let is_command = body.is_ok_and(|body| is_taken(&body));
            if !is_command {
                refuse();
            }
            #[cfg(feature = "rs485")]
            hear(byte, is_command, clock);
        }
        embassy_futures::yield_now().await;
    }
}

/// Passes on a command. Returns whether the body is a command and there is room for it.
#[cfg(not(hand))]
fn is_taken(body: &[u8]) -> bool {
    #[cfg(feature = "load-tip")]
    if load::is_load(body) {
        return load::read_body(body).is_ok_and(|request| LOADS.try_send(request).is_ok());
    }
    command::read_known_body::<OBJECT>(body).is_ok_and(|request| REQUESTS.try_send(request).is_ok())
}

/// The same for a hand, whose commands have a tip.
#[cfg(hand)]
fn is_taken(body: &[u8]) -> bool {
    #[cfg(feature = "load-tip")]
    if load::is_load(body) {
        return read_load(body).is_ok_and(|asked| LOADS.try_send(asked).is_ok());
    }
    read_request(body).is_ok_and(|asked| REQUESTS.try_send(asked).is_ok())
}
