//! The STM32G4: flags of the last reset, and its converter.
//!
//! The converter is powered, calibrated and clocked by the driver of embassy-stm32. The driver's `RingBufferedAdc` is not used.
//! It interrupts twice a ring and returns copies without a time. The time of a block, and the detection of a stalled converter,
//! need the position of the DMA.

#[cfg(all(transducer = "ratiometric", hand))]
use super::chosen::CHANNELS;
#[cfg(all(transducer = "ratiometric", not(hand)))]
use super::chosen::{OUTPUT, SUPPLY};
#[cfg(transducer = "ratiometric")]
use super::pins::Input;
pub(super) use super::reset_flags::reset_cause;
#[cfg(transducer = "ratiometric")]
pub(super) use super::ring::{conversions_left, converter_runs, restart_converter};
#[cfg(transducer = "ratiometric")]
use embassy_stm32::adc::{Adc, AdcConfig, SampleTime};
use embassy_stm32::pac;
#[cfg(transducer = "ratiometric")]
use embassy_stm32::{Peri, peripherals::ADC1};

/// Start of the region of the calibration, from the start of the flash: its second bank.
pub(super) const REGION: u32 = 256 * 1024;

/// Start of the bank that a failed read was in, from the start of the flash.
pub(super) fn failed_bank(register: pac::flash::regs::Eccr) -> u32 {
    if register.bk_ecc() { REGION } else { 0 }
}

/// Powers, clocks and calibrates the converter.
#[cfg(transducer = "ratiometric")]
pub(super) fn power_converter(adc: Peri<'static, ADC1>) {
    // The driver leaves the converter on.
    Adc::new(adc, AdcConfig::default());
}

/// Sampling of every channel: 247.5 cycles of 26 MHz, 9.5 us, enough for 10 kilo-ohm. With 12.5 cycles of conversion this takes
/// 10 us. 100 conversions take exactly 1 ms.
#[cfg(transducer = "ratiometric")]
const SAMPLING: SampleTime = SampleTime::CYCLES247_5;

/// Sets the sampling time of a channel.
#[cfg(transducer = "ratiometric")]
fn sample(channel: u8) {
    let channel = usize::from(channel);
    match channel {
        0..10 => pac::ADC1.smpr().modify(|w| w.set_smp(channel, SAMPLING)),
        _ => pac::ADC1.smpr2().modify(|w| w.set_smp(channel - 10, SAMPLING)),
    }
}

/// Puts this pin at a rank of the sequence.
#[cfg(transducer = "ratiometric")]
fn convert(rank: usize, input: &Input) {
    input.connect();
    sample(input.channel);
    place(rank, input.channel);
}

/// Puts this channel at a rank of the sequence.
#[cfg(transducer = "ratiometric")]
fn place(rank: usize, channel: u8) {
    match rank {
        0..4 => pac::ADC1.sqr1().modify(|w| w.set_sq(rank, channel)),
        _ => pac::ADC1.sqr2().modify(|w| w.set_sq(rank - 4, channel)),
    }
}

/// Runs a sequence of `ranks` ranks continuously, with each code to the DMA.
#[cfg(transducer = "ratiometric")]
fn run_free(ranks: u8) {
    use pac::adc::vals::{Dmacfg, Dmaen};
    pac::ADC1.sqr1().modify(|w| w.set_l(ranks - 1));
    pac::ADC1.cfgr().modify(|w| {
        w.set_cont(true);
        w.set_dmaen(Dmaen::ENABLE);
        w.set_dmacfg(Dmacfg::CIRCULAR);
    });
}

/// Sets up ADC1, which the driver has enabled, to run free.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) fn set_up_converter(supply_measured: bool) {
    convert(0, &OUTPUT);
    if supply_measured {
        convert(1, &SUPPLY);
    }
    run_free(1 + u8::from(supply_measured));
}

/// Sampling of the internal reference, at least 4 us (DS12288, embedded voltage reference): 9.5 us, as for every channel.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) const IDENTITY_CONVERSION: u32 = 10;

/// Sets up ADC1 for a scan of these channels and the internal reference after them.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) fn set_up_scan(channels: &[u8]) {
    /// `ADC1_IN18` (RM0440 table 163).
    const REFERENCE: u8 = 18;
    pac::ADC12_COMMON.ccr().modify(|w| w.set_vrefen(true));
    for (rank, input) in channels
        .iter()
        .filter_map(|&channel| CHANNELS.get(usize::from(channel)))
        .enumerate()
    {
        convert(rank, input);
    }
    sample(REFERENCE);
    place(channels.len(), REFERENCE);
    run_free(channels.len() as u8 + 1);
}

/// Connects its channel of the DMA to the converter: request 5 of the multiplexer (RM0440 table 91).
#[cfg(transducer = "ratiometric")]
pub(super) fn route_converter() {
    pac::DMAMUX1.ccr(0).write(|w| w.set_dmareq_id(5));
}

/// Requests a stop after the conversion under way.
#[cfg(transducer = "ratiometric")]
pub(super) fn stop_conversions() {
    pac::ADC1
        .cr()
        .modify(|w| w.set_adstp(pac::adc::vals::Adstp::STOP));
}
