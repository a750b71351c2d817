//! Queues between the tasks: frames to send, commands, and calibrations to store; and the time of each task's last report.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_sync::blocking_mutex::ThreadModeMutex;
use embassy_sync::blocking_mutex::raw::{NoopRawMutex, ThreadModeRawMutex};
use embassy_sync::channel::Channel;
use embassy_sync::signal::Signal;
use embassy_time::Duration;
#[cfg(hand)]
use fingertip::device::hand::HandFrame;
use fingertip::device::logic::ToStore;
use fingertip::device::task_monitor::TaskMonitor;
use fingertip::image;
use fingertip::link::command::Request;
use fingertip::link::outbox::Outbox;
#[cfg(not(hand))]
use fingertip::link::telemetry::Message;
#[cfg(hand)]
use fingertip::link::tips::FrameStart;
use fingertip::link::wire::Encoded;
use fingertip::storage::log::StoreError;
use fingertip::units::Microseconds;
use static_cell::{ConstStaticCell, StaticCell};

/// Tasks that wait for the host wake this often to report. They may be late by twice this time. The send task is alive if no
/// frames are left waiting. The limit of the memory task allows for an erasure.
pub(super) const IDLE: Duration = Duration::from_millis(50);
const ALLOWED: [u64; 3] = [150_000, 150_000, 5_000_000];
pub(super) const SEND: usize = 0;
pub(super) const LISTEN: usize = 1;
pub(super) const REMEMBER: usize = 2;

/// Length of the queue: 8 ms of reports; for a hand, also the hellos of all its tips.
pub(super) const WAITING: usize = if cfg!(hand) { 16 } else { 8 };

/// Frames waiting for the line.
pub(super) struct Waiting {
    pub(super) frames: RefCell<Outbox<'static, WAITING, { image::HAS_OBJECT }>>,
    pub(super) more: Signal<NoopRawMutex, ()>,
}

/// Buffers of the waiting frames, and of the frame on the line.
static FRAMES: ConstStaticCell<[Encoded; WAITING]> = ConstStaticCell::new([Encoded::NOTHING; WAITING]);
pub(super) static SENT: ConstStaticCell<Encoded> = ConstStaticCell::new(Encoded::NOTHING);
static OUTBOX: StaticCell<Waiting> = StaticCell::new();

/// The empty queue of frames. Called once.
pub(super) fn outbox() -> &'static Waiting {
    OUTBOX.init_with(|| Waiting {
        frames: RefCell::new(Outbox::new(FRAMES.take().each_mut())),
        more: Signal::new(),
    })
}

impl Waiting {
    #[cfg(not(hand))]
    pub(super) fn put(&self, message: &Message) {
        self.frames.borrow_mut().put(message);
        self.more.signal(());
    }

    #[cfg(hand)]
    #[inline(never)] // several places put frames; one copy of the encoders is enough
    pub(super) fn put_frame(&self, frame: &HandFrame<'_>) {
        self.frames.borrow_mut().put_by(|body, sequence, dropped| {
            frame.write(FrameStart {
                body,
                sequence,
                dropped,
            });
        });
        self.more.signal(());
    }
}

/// A command; for a hand, with its tip.
#[cfg(not(hand))]
pub(super) type Asked = Request;
#[cfg(hand)]
pub(super) type Asked = (u8, Request);

/// Commands waiting for the next report. When the queue is full, the newest command is refused and counted.
pub(super) static REQUESTS: Channel<ThreadModeRawMutex, Asked, 2> = Channel::new();

/// Count of received data that were not a command.
pub(super) static REFUSED: AtomicU32 = AtomicU32::new(0);

/// Calibrations to store, and the outcomes.
#[cfg(not(hand))]
pub(super) static TO_STORE: Channel<ThreadModeRawMutex, ToStore, 1> = Channel::new();
#[cfg(not(hand))]
pub(super) static STORED: Channel<ThreadModeRawMutex, (Result<(), StoreError>, u32), 1> = Channel::new();

/// The same for a hand, with the tip. Each tip has at most one under way.
#[cfg(hand)]
pub(super) static TO_STORE: Channel<ThreadModeRawMutex, (u8, ToStore), { image::TIPS }> = Channel::new();
#[cfg(hand)]
pub(super) static STORED: Channel<ThreadModeRawMutex, (u8, Result<(), StoreError>, u32), { image::TIPS }> =
    Channel::new();

/// Time of the last report of each task.
pub(super) static TASK_MONITOR: ThreadModeMutex<RefCell<TaskMonitor<3>>> =
    ThreadModeMutex::new(RefCell::new(TaskMonitor::new(ALLOWED, Microseconds(0))));

/// Reports that a task is alive.
#[inline(never)] // three tasks report; one copy is enough
pub(super) fn alive(task: usize, now: Microseconds) {
    TASK_MONITOR.lock(|task_monitor| task_monitor.borrow_mut().report(task, now));
}

/// Counts received data that were not a command.
pub(super) fn refuse() {
    // Only this task counts, on one core, so load and store need not be one atomic step.
    REFUSED.store(
        REFUSED.load(Ordering::Relaxed).saturating_add(1),
        Ordering::Relaxed,
    );
}
