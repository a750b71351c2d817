//! Additions to an image by the feature `load-tip`: the tip in use, read at the start, and the task that loads another tip.

use crate::firmware::queues::{IDLE, REMEMBER, STORED, TO_STORE, Waiting, alive};
use crate::firmware::retained;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Timer, with_timeout};
use fingertip::board::{Clock, FlashMemory, TIP_SLOT, TIPS};
use fingertip::device::logic::{Beginning, ToStore};
use fingertip::device::task_monitor::CrashRecord;
use fingertip::device::tip_loader::{FoundTip, LARGEST_BLOCK, TipLoader};
use fingertip::image::{FirmwareDesign, ImageDesign};
use fingertip::link::load::{LoadOutcome, LoadReply, LoadRequest};
use fingertip::link::telemetry::Message;
use fingertip::signal::calibration::Calibration;
use fingertip::signal::tip_design::TipDesign;
use fingertip::status::{LastFault, Stored};
use fingertip::storage::log::StoreError;
use fingertip::storage::store::Store;
use fingertip::storage::tip_slots::TipSlots;
use static_cell::ConstStaticCell;

/// The block in use, and the block being checked.
static IN_USE: ConstStaticCell<[u8; LARGEST_BLOCK]> = ConstStaticCell::new([0; LARGEST_BLOCK]);
static JUDGED: ConstStaticCell<[u8; LARGEST_BLOCK]> = ConstStaticCell::new([0; LARGEST_BLOCK]);

/// Commands for the loader. When the queue is full, the newest command is refused and counted. Its sender repeats it.
pub(super) static LOADS: Channel<ThreadModeRawMutex, LoadRequest, 2> = Channel::new();

/// Time from the answer to the restart. The frames that wait before the answer take 4 ms.
const FAREWELL: Duration = Duration::from_millis(50);

/// Result of reading the tip at a start.
pub(super) struct Tip {
    /// The design in use.
    pub(super) design: TipDesign<'static, FirmwareDesign>,
    /// The loader, with the known content of the slots.
    pub(super) loader: TipLoader<1>,
    /// The calibration of the fingertip in the block; `None` without one.
    pub(super) known: Option<Calibration>,
    /// Whether a loaded tip cannot be used.
    pub(super) is_refused: bool,
}

/// Reads the tip in use. After too many resets in a row, the flash is not read.
pub(super) async fn start(memory: &mut FlashMemory, gave_up: bool) -> Tip {
    let slots = TipSlots::new(0, TIP_SLOT);
    let mut loader = TipLoader::new([slots], [ImageDesign::CONSTANTS.transducer]);
    let found = if gave_up {
        FoundTip::Image
    } else {
        loader.start(0, &mut memory.at(TIPS), IN_USE.take()).await
    };
    let is_refused = matches!(found, FoundTip::Refused);
    let (design, known) = match found {
        FoundTip::Loaded(design, known) => (TipDesign::Loaded(design), known),
        FoundTip::Image | FoundTip::Refused => (TipDesign::Image(FirmwareDesign::start()), None),
    };
    Tip {
        design,
        loader,
        known,
        is_refused,
    }
}

/// Completes `beginning` from the tip's block: a calibration if none is stored, and a state that shows if its tables could not be used.
pub(super) fn beginning(beginning: Beginning, known: Option<Calibration>, is_refused: bool) -> Beginning {
    Beginning {
        stored: if is_refused {
            Stored::Damaged
        } else {
            beginning.stored
        },
        calibration: beginning.calibration.or(known),
        ..beginning
    }
}

/// Stores the calibration, and loads a tip. Period: on request. Deadline: none; other tasks run meanwhile, except while a block
/// is checked. Without a store every command fails.
#[embassy_executor::task]
pub(super) async fn remember(
    mut store: Option<Store<FlashMemory>>,
    mut loader: TipLoader<1>,
    clock: Clock,
    waiting: &'static Waiting,
) {
    let judged = JUDGED.take();
    loop {
        let now = clock.now();
        alive(REMEMBER, now);
        match with_timeout(IDLE, select(TO_STORE.receive(), LOADS.receive())).await {
            Err(_idle) => {}
            Ok(Either::First(ToStore(calibration))) => {
                let result = match &mut store {
                    Some(store) => store.save(now, calibration).await,
                    None => Err(StoreError::Failed),
                };
                let sequence = store.as_ref().map_or(0, Store::sequence);
                STORED.send((result, sequence)).await;
            }
            Ok(Either::Second(request)) => {
                let now = clock.now();
                let reply = match &mut store {
                    Some(store) => {
                        let mut flash = store.flash_mut().at(TIPS);
                        loader.request(now, &mut flash, (0, request), judged).await
                    }
                    None => LoadReply::Answer {
                        time: now,
                        kind: request.command.kind(),
                        sequence: request.sequence,
                        outcome: LoadOutcome::MemoryFailed,
                        findings: 0,
                    },
                };
                waiting.put(&Message::Load(reply));
                if loader.is_restarting() {
                    Timer::after(FAREWELL).await;
                    restart();
                }
            }
        }
    }
}

/// Restarts on purpose, with the other tip and without the zero of the previous one.
fn restart() -> ! {
    let kept = retained::read().unwrap_or_default();
    retained::write(&CrashRecord {
        fault: LastFault::None,
        good: true,
        zero: None,
        ..kept
    });
    cortex_m::peripheral::SCB::sys_reset()
}
