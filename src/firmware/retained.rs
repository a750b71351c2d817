//! Memory that a reset keeps, and the handlers that leave a breadcrumb in it: the one file of the firmware with unsafe
//! code. Unsafe are the section, which no start-up clears, so that any bits may lie there, and the handler's signature.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use fingertip::board::ecc;
use fingertip::device::supervisor::{Breadcrumb, Stage, WORDS};
use fingertip::status::LastFault;

struct Words(UnsafeCell<MaybeUninit<[u32; WORDS]>>);

// SAFETY: one core; written by the signal task, and by handlers that do not return to it.
unsafe impl Sync for Words {}

#[unsafe(link_section = ".uninit.breadcrumb")]
static WORDS_KEPT: Words = Words(UnsafeCell::new(MaybeUninit::uninit()));

/// What the run before left, or this one so far.
pub(crate) fn read() -> Option<Breadcrumb> {
    // SAFETY: plain words in RAM, for which any bits are a value; their check says whether they mean something.
    let words = unsafe { WORDS_KEPT.0.get().cast::<[u32; WORDS]>().read_volatile() };
    Breadcrumb::from_words(&words)
}

/// Leaves this for the next run.
pub(crate) fn write(breadcrumb: &Breadcrumb) {
    // SAFETY: as above; nothing holds a reference into it.
    unsafe {
        WORDS_KEPT
            .0
            .get()
            .cast::<[u32; WORDS]>()
            .write_volatile(breadcrumb.to_words());
    }
}

/// Adds what goes wrong to what is kept.
pub(crate) fn blame(fault: LastFault, detail: u32) {
    let so_far = read().unwrap_or_default();
    write(&Breadcrumb {
        fault,
        detail,
        ..so_far
    });
}

/// Leaves how far the start has come, for a reset that finds nothing else.
pub(crate) fn enter(stage: Stage) {
    blame(LastFault::None, stage as u32);
}

#[panic_handler]
fn panicked(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    blame(
        LastFault::Panic,
        info.location().map_or(0, core::panic::Location::line),
    );
    cortex_m::peripheral::SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    blame(LastFault::HardFault, frame.pc());
    cortex_m::peripheral::SCB::sys_reset()
}

#[exception]
unsafe fn NonMaskableInt() {
    // A place of the calibration that cannot be read is its reader's matter; nothing else is foreseen.
    if let Err(address) = ecc::take_failure() {
        blame(LastFault::NonMaskable, address);
        cortex_m::peripheral::SCB::sys_reset()
    }
}
