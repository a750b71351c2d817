//! What the tasks hand to each other: frames to be sent, commands, what is to be stored; and who reported when.

use core::cell::RefCell;
use core::sync::atomic::AtomicU32;
use embassy_sync::blocking_mutex::ThreadModeMutex;
use embassy_sync::blocking_mutex::raw::{NoopRawMutex, ThreadModeRawMutex};
use embassy_sync::channel::Channel;
use embassy_sync::signal::Signal;
use embassy_time::Duration;
use fingertip::board::Clock;
use fingertip::device::logic::ToStore;
use fingertip::device::task_monitor::TaskMonitor;
use fingertip::image;
use fingertip::link::command::Request;
use fingertip::link::outbox::Outbox;
use fingertip::link::telemetry::Message;
use fingertip::link::wire::Encoded;
use fingertip::storage::store::StoreError;
use fingertip::units::Microseconds;
use static_cell::{ConstStaticCell, StaticCell};

/// Tasks that wait for the host wake so often to report, and may be late by as much again; who sends frames is known by
/// leaving none. The memory is given the time of an erasure.
pub(super) const IDLE: Duration = Duration::from_millis(50);
const ALLOWED: [u64; 3] = [150_000, 150_000, 5_000_000];
pub(super) const SEND: usize = 0;
pub(super) const LISTEN: usize = 1;
pub(super) const REMEMBER: usize = 2;

/// 8 ms of reports.
pub(super) const WAITING: usize = 8;

/// Frames waiting for the line.
pub(super) struct Waiting {
    pub(super) frames: RefCell<Outbox<'static, WAITING, { image::HAS_OBJECT }>>,
    pub(super) more: Signal<NoopRawMutex, ()>,
}

/// The frames themselves, and the one on the line.
pub(super) static FRAMES: ConstStaticCell<[Encoded; WAITING]> =
    ConstStaticCell::new([Encoded::NOTHING; WAITING]);
pub(super) static SENT: ConstStaticCell<Encoded> = ConstStaticCell::new(Encoded::NOTHING);
pub(super) static OUTBOX: StaticCell<Waiting> = StaticCell::new();

impl Waiting {
    pub(super) fn put(&self, message: &Message) {
        self.frames.borrow_mut().put(message);
        self.more.signal(());
    }
}

/// Commands waiting for the next report. When full the newest is refused, and counted.
pub(super) static REQUESTS: Channel<ThreadModeRawMutex, Request, 2> = Channel::new();

/// What came over the line and was no command.
pub(super) static REFUSED: AtomicU32 = AtomicU32::new(0);

/// To be stored, and what came of it.
pub(super) static TO_STORE: Channel<ThreadModeRawMutex, ToStore, 1> = Channel::new();
pub(super) static STORED: Channel<ThreadModeRawMutex, (Result<(), StoreError>, u32), 1> = Channel::new();

/// Who reported when.
pub(super) static TASK_MONITOR: ThreadModeMutex<RefCell<TaskMonitor<3>>> =
    ThreadModeMutex::new(RefCell::new(TaskMonitor::new(ALLOWED, Microseconds(0))));

pub(super) fn alive(task: usize, clock: Clock) {
    TASK_MONITOR.lock(|task_monitor| task_monitor.borrow_mut().report(task, clock.now()));
}
