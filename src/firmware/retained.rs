//! Memory that survives a reset, the handlers that write a crash record to it, and the paint of the stack. This is the only
//! file of the firmware with unsafe code. The unsafe parts are the section that start-up does not clear, so that it may have
//! any bits; the signature of the handlers; and the words of the stack.
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

/// The zeros from the previous run, or arbitrary bits.
#[cfg(hand)]
pub(super) fn read_zeros() -> ZeroWords<TIPS> {
    // SAFETY: plain words in RAM, for which any bits are a value; their check shows whether they are valid.
    unsafe { ZEROS_KEPT.0.get().cast::<ZeroWords<TIPS>>().read_volatile() }
}

/// Stores these zeros for the next run.
#[cfg(hand)]
pub(super) fn write_zeros(zeros: ZeroWords<TIPS>) {
    // SAFETY: as above; nothing holds a reference into it, and the signal task alone writes it.
    unsafe { ZEROS_KEPT.0.get().cast::<ZeroWords<TIPS>>().write_volatile(zeros) }
}

/// Value that fills the unused stack, as with the feature `paint-stack` of `cortex-m-rt`.
const PAINT: u32 = 0xCCCC_CCCC;
/// Words at the end of the stack. If they were used, the stack overflowed. Below them is no memory, and an access there is a bus fault.
const GUARD: usize = 16;

unsafe extern "C" {
    /// The lowest word of the stack (`memory.x`).
    static mut _stack_end: u32;
}

/// Paints the unused stack. Returns whether the previous run used the last [`GUARD`] words.
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

/// At a start: the record of the previous run, with a stack overflow if there was one.
pub(super) fn begin() -> Option<CrashRecord> {
    let overflowed = repaint_stack();
    // Without a record, the stack was not painted before.
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

/// The record of the previous run, or of this run so far.
pub(crate) fn read() -> Option<CrashRecord> {
    // SAFETY: plain words in RAM, for which any bits are a value; their check shows whether they are valid.
    let words = unsafe { WORDS_KEPT.0.get().cast::<[u32; WORDS]>().read_volatile() };
    CrashRecord::from_words(&words)
}

/// Stores this record for the next run.
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

/// Adds a fault to the stored record.
pub(crate) fn record_fault(fault: LastFault, detail: u32) {
    let so_far = read().unwrap_or_default();
    write(&CrashRecord {
        fault,
        detail,
        ..so_far
    });
}

/// Stores the progress of the start, for a reset without another trace.
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
    // An unreadable place of the calibration is handled by its reader. Every other cause is a fault.
    if let Err(address) = ecc::take_failure() {
        record_fault(LastFault::NonMaskable, address);
        cortex_m::peripheral::SCB::sys_reset()
    }
}
