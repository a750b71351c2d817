//! The serial line, both ways: [`send`] puts frames on it, [`listen`] takes commands from it.

#[cfg(all(hand, feature = "load-tip"))]
use crate::firmware::hand_tips::LOADS;
use crate::firmware::queues::{IDLE, LISTEN, REQUESTS, Waiting, alive, refuse};
#[cfg(all(not(hand), feature = "load-tip"))]
use crate::firmware::tip::LOADS;
use embassy_time::with_timeout;
use fingertip::board::{Clock, Line, SerialRx};
#[cfg(not(hand))]
use fingertip::image;
#[cfg(not(hand))]
use fingertip::link::command;
#[cfg(feature = "load-tip")]
use fingertip::link::load;
#[cfg(all(hand, feature = "load-tip"))]
use fingertip::link::tips::read_load;
#[cfg(hand)]
use fingertip::link::tips::read_request;
use fingertip::link::wire::{Deframer, Encoded};

/// A loaded tip may have an `[object]` where the image's design has none.
#[cfg(not(hand))]
const OBJECT: bool = image::HAS_OBJECT || cfg!(feature = "load-tip");

/// Sends frames. Period: as they come. Deadline: a period on average (a report takes 0.5 ms on the line); when late,
/// the queue drops its oldest, and the signal task is none the later for it.
#[embassy_executor::task]
pub(super) async fn send(mut line: Line, waiting: &'static Waiting, mut frame: &'static mut Encoded) {
    loop {
        waiting.more.wait().await;
        while waiting.frames.borrow_mut().take(&mut frame) {
            // The line has no receiver that could refuse; a failed transfer shows as a gap in the sequence.
            let _ = line.write(frame.as_slice()).await;
        }
    }
}

/// Takes commands. Period: as they come. Deadline: the ring of bytes is full, 2.8 ms of a line that never pauses; when
/// late, bytes are lost, which is counted. Work is bounded by the rate of the line, and other tasks run in between.
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
                continue;
            };
            if !body.is_ok_and(|body| is_taken(&body)) {
                refuse();
            }
        }
        embassy_futures::yield_now().await;
    }
}

/// Hands a command on; whether the body is one, and there is room for it.
#[cfg(not(hand))]
fn is_taken(body: &[u8]) -> bool {
    #[cfg(feature = "load-tip")]
    if load::is_load(body) {
        return load::read_body(body).is_ok_and(|request| LOADS.try_send(request).is_ok());
    }
    command::read_known_body::<OBJECT>(body).is_ok_and(|request| REQUESTS.try_send(request).is_ok())
}

/// The same of a hand, whose commands have a tip.
#[cfg(hand)]
fn is_taken(body: &[u8]) -> bool {
    #[cfg(feature = "load-tip")]
    if load::is_load(body) {
        return read_load(body).is_ok_and(|asked| LOADS.try_send(asked).is_ok());
    }
    read_request(body).is_ok_and(|asked| REQUESTS.try_send(asked).is_ok())
}
