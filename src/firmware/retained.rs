//! Memory that survives a reset, the handlers that leave a crash record in it, and the paint of the stack. This is the only file of
//! the firmware with unsafe code. Unsafe are the section, which start-up does not clear, so that it may have any bits, the
//! signature of the handlers, and the words of the stack.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use fingertip::board::ecc;
#[cfg(hand)]
use fingertip::device::kept_zeros::ZeroWords;
use fingertip::device::task_monitor::{CrashRecord, Stage, WORDS};
#[cfg(hand)]
use fingertip::image::TIPS;
use fingertip::status::LastFault;

struct Words<T = [u32; WORDS]>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: one core; written by the signal task, and by handlers that do not return to it.
unsafe impl<T> Sync for Words<T> {}

#[unsafe(link_section = ".uninit.crash_record")]
static WORDS_KEPT: Words = Words(UnsafeCell::new(MaybeUninit::uninit()));

/// The zeros of a hand's tips.
#[cfg(hand)]
#[unsafe(link_section = ".uninit.tip_zeros")]
static ZEROS_KEPT: Words<ZeroWords<TIPS>> = Words(UnsafeCell::new(MaybeUninit::uninit()));

/// The zeros that the run before left, or whatever lies there.
#[cfg(hand)]
pub(super) fn read_zeros() -> ZeroWords<TIPS> {
    // SAFETY: plain words in RAM, for which any bits are a value; their check tells whether they mean something.
    unsafe { ZEROS_KEPT.0.get().cast::<ZeroWords<TIPS>>().read_volatile() }
}

/// Leaves these for the next run.
#[cfg(hand)]
pub(super) fn write_zeros(zeros: ZeroWords<TIPS>) {
    // SAFETY: as above; nothing holds a reference into it, and the signal task alone writes it.
    unsafe { ZEROS_KEPT.0.get().cast::<ZeroWords<TIPS>>().write_volatile(zeros) }
}

/// What the unused stack is filled with, as by the feature `paint-stack` of `cortex-m-rt`.
const PAINT: u32 = 0xCCCC_CCCC;
/// Words at the stack's end that are never used, or it overflowed: below them lies no memory, which is a fault of the bus.
const GUARD: usize = 16;

unsafe extern "C" {
    /// The lowest word of the stack (`memory.x`).
    static mut _stack_end: u32;
}

/// Paints the unused stack; whether the run before used its last [`GUARD`] words.
fn repaint_stack() -> bool {
    let end = &raw mut _stack_end;
    // The stack is below the statics: from here down to its end nothing is in use.
    let unused = (cortex_m::register::msp::read() as usize - end as usize) / size_of::<u32>();
    let mut reached = false;
    for place in 0..unused {
        // SAFETY: words of the stack below its pointer; an interrupt meanwhile leaves nothing there that it reads again.
        unsafe {
            let word = end.add(place);
            reached |= place < GUARD && word.read_volatile() != PAINT;
            word.write_volatile(PAINT);
        }
    }
    reached
}

/// What the run before left, at a start.
pub(super) fn begin() -> Option<CrashRecord> {
    let overflowed = repaint_stack();
    // Without a record the run before painted nothing.
    let left = read()?;
    Some(CrashRecord {
        fault: if overflowed {
            LastFault::StackOverflow
        } else {
            left.fault
        },
        ..left
    })
}

/// What the run before left, or this one so far.
pub(crate) fn read() -> Option<CrashRecord> {
    // SAFETY: plain words in RAM, for which any bits are a value; their check says whether they mean something.
    let words = unsafe { WORDS_KEPT.0.get().cast::<[u32; WORDS]>().read_volatile() };
    CrashRecord::from_words(&words)
}

/// Leaves this for the next run.
pub(crate) fn write(crash_record: &CrashRecord) {
    // SAFETY: as above; nothing holds a reference into it.
    unsafe {
        WORDS_KEPT
            .0
            .get()
            .cast::<[u32; WORDS]>()
            .write_volatile(crash_record.to_words());
    }
}

/// Adds what goes wrong to what is kept.
pub(crate) fn record_fault(fault: LastFault, detail: u32) {
    let so_far = read().unwrap_or_default();
    write(&CrashRecord {
        fault,
        detail,
        ..so_far
    });
}

/// Leaves how far the start has come, for a reset that finds nothing else.
pub(crate) fn enter(stage: Stage) {
    record_fault(LastFault::None, stage as u32);
}

#[panic_handler]
fn panicked(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    record_fault(
        LastFault::Panic,
        info.location().map_or(0, core::panic::Location::line),
    );
    cortex_m::peripheral::SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    record_fault(LastFault::HardFault, frame.pc());
    cortex_m::peripheral::SCB::sys_reset()
}

#[exception]
unsafe fn NonMaskableInt() {
    // A place of the calibration that cannot be read is its reader's matter; nothing else is foreseen.
    if let Err(address) = ecc::take_failure() {
        record_fault(LastFault::NonMaskable, address);
        cortex_m::peripheral::SCB::sys_reset()
    }
}
