//! Additions to a hand's image by the feature `load-tip`: the tips in use, read at the start, and the task that loads another
//! tip while all tips are measured.

use crate::firmware::queues::{IDLE, REMEMBER, STORED, TO_STORE, Waiting, alive};
use crate::firmware::retained;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Timer, with_timeout};
use fingertip::board::{Clock, FlashMemory, TIP_SLOTS, TIPS as BASE};
use fingertip::device::hand::HandFrame;
use fingertip::device::kept_zeros::ZeroWords;
use fingertip::device::logic::ToStore;
use fingertip::device::task_monitor::CrashRecord;
use fingertip::device::tip_loader::{FoundTip, LARGEST_BLOCK, TipLoader};
use fingertip::image::{DESIGN_HASHES, IDENTITIES, NAMES, PERIOD, RECORD, SCANS, TIPS, TRANSDUCERS};
use fingertip::link::load::{LoadOutcome, LoadReply, LoadRequest};
use fingertip::signal::calibration::Calibration;
use fingertip::signal::design::Design as _;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::status::{LastFault, Stored};
use fingertip::storage::hand_store::{HandStore, StoredTip, TipIdentity};
use fingertip::storage::log::StoreError;
use fingertip::storage::tip_slots::TipSlots;
use static_cell::{ConstStaticCell, StaticCell};

/// The blocks in use, and the block being checked.
static IN_USE: [ConstStaticCell<[u8; LARGEST_BLOCK]>; TIPS] =
    [const { ConstStaticCell::new([0; LARGEST_BLOCK]) }; TIPS];
static JUDGED: ConstStaticCell<[u8; LARGEST_BLOCK]> = ConstStaticCell::new([0; LARGEST_BLOCK]);

/// The designs in the blocks in use.
static LOADED: [StaticCell<LoadedDesign<'static>>; TIPS] = [const { StaticCell::new() }; TIPS];

/// Commands for the loader, with their tips. When the queue is full, the newest command is refused and counted. Its sender repeats it.
pub(super) static LOADS: Channel<ThreadModeRawMutex, (u8, LoadRequest), 2> = Channel::new();

/// Time from the answer to the restart. The frames that wait before the answer take 4 ms.
const FAREWELL: Duration = Duration::from_millis(50);

const _: () = assert!(2 * TIPS <= TIP_SLOTS.len(), "each tip has two slots");

/// Result of reading the tips at a start.
pub(super) struct FoundTips {
    /// The loaded designs in use. `None` if the image's own design is in use.
    pub(super) loaded: [Option<&'static LoadedDesign<'static>>; TIPS],
    /// The calibration of each fingertip in its block; `None` without one.
    known: [Option<Calibration>; TIPS],
    /// Whether a loaded tip cannot be used.
    is_refused: [bool; TIPS],
    /// Identities of the tips to which the stored calibrations must belong.
    pub(super) identities: [TipIdentity; TIPS],
}

impl FoundTips {
    /// The stored data of a tip, completed from its block: a calibration if none is stored, and a state that shows if its tables could not be used.
    pub(super) fn complete(&self, tip: usize, stored: StoredTip) -> StoredTip {
        StoredTip {
            state: if self.is_refused[tip] {
                Stored::Damaged
            } else {
                stored.state
            },
            calibration: stored.calibration.or(self.known[tip]),
            ..stored
        }
    }
}

/// Reads the tips in use. After too many resets in a row, the flash is not read.
pub(super) async fn start(memory: &mut FlashMemory, gave_up: bool) -> (FoundTips, TipLoader<TIPS>) {
    let slots = core::array::from_fn(|tip| TipSlots::of([TIP_SLOTS[2 * tip], TIP_SLOTS[2 * tip + 1]]));
    let mut loader = TipLoader::new(slots, TRANSDUCERS);
    let mut found = FoundTips {
        loaded: [None; TIPS],
        known: [None; TIPS],
        is_refused: [false; TIPS],
        identities: IDENTITIES,
    };
    for tip in (0..TIPS).filter(|_| !gave_up) {
        match loader.start(tip, &mut memory.at(BASE), IN_USE[tip].take()).await {
            FoundTip::Image => {}
            FoundTip::Refused => found.is_refused[tip] = true,
            FoundTip::Loaded(design, known) => {
                let design = design.of_scan([PERIOD, SCANS as u32]);
                let constants = &design.parameters().constants;
                found.identities[tip] = found.identities[tip].with_design(DESIGN_HASHES[tip], constants);
                found.known[tip] = known;
                found.loaded[tip] = Some(LOADED[tip].init(design));
            }
        }
    }
    (found, loader)
}

/// Stores the calibrations and loads tips, one at a time. Period: on request. Deadline: none; other tasks run meanwhile, except
/// while a block is checked. Without a store every command fails.
#[embassy_executor::task]
pub(super) async fn remember(
    mut store: Option<HandStore<FlashMemory, TIPS, RECORD>>,
    mut loader: TipLoader<TIPS>,
    clock: Clock,
    waiting: &'static Waiting,
) {
    let judged = JUDGED.take();
    loop {
        let now = clock.now();
        alive(REMEMBER, now);
        match with_timeout(IDLE, select(TO_STORE.receive(), LOADS.receive())).await {
            Err(_idle) => {}
            Ok(Either::First((tip, ToStore(calibration)))) => {
                let (result, number) = match &mut store {
                    Some(store) => {
                        let result = store.save(now, usize::from(tip), calibration).await;
                        (result, store.stored(usize::from(tip)).number)
                    }
                    None => (Err(StoreError::Failed), 0),
                };
                STORED.send((tip, result, number)).await;
            }
            Ok(Either::Second((tip, request))) => {
                let now = clock.now();
                let reply = match &mut store {
                    Some(store) => {
                        let mut flash = store.flash_mut().at(BASE);
                        loader.request(now, &mut flash, (tip, request), judged).await
                    }
                    None => LoadReply::Answer {
                        time: now,
                        kind: request.command.kind(),
                        sequence: request.sequence,
                        outcome: LoadOutcome::MemoryFailed,
                        findings: 0,
                    },
                };
                waiting.put_frame(&HandFrame::Load(tip, reply));
                if loader.is_restarting() {
                    Timer::after(FAREWELL).await;
                    restart(loader.changed());
                }
            }
        }
    }
}

/// Restarts on purpose, with another design of one tip. That tip loses its zero; the others keep theirs.
fn restart(changed: usize) -> ! {
    let mut zeros = retained::read_zeros().zeros(NAMES.hash);
    if let Some(zero) = zeros.get_mut(changed) {
        *zero = None;
    }
    retained::write_zeros(ZeroWords::of(NAMES.hash, zeros));
    let kept = retained::read().unwrap_or_default();
    retained::write(&CrashRecord {
        fault: LastFault::None,
        good: true,
        zero: None,
        ..kept
    });
    cortex_m::peripheral::SCB::sys_reset()
}
