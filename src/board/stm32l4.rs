//! The STM32L4: flags of the last reset, and its converter.

#[cfg(all(transducer = "ratiometric", hand))]
use super::chosen::CHANNELS;
#[cfg(all(transducer = "ratiometric", not(hand)))]
use super::chosen::{OUTPUT, SUPPLY};
pub(super) use super::reset_flags::reset_cause;
#[cfg(transducer = "ratiometric")]
pub(super) use super::ring::{conversions_left, converter_runs, restart_converter};
#[cfg(transducer = "ratiometric")]
use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::pac;
#[cfg(transducer = "ratiometric")]
use embassy_stm32::{Peri, peripherals::ADC1};

/// Start of the region of the calibration, from the start of the flash: this chip has one bank.
pub(super) const REGION: u32 = 0;

/// Start of the bank that a failed read was in, from the start of the flash.
pub(super) fn failed_bank(_register: pac::flash::regs::Eccr) -> u32 {
    0
}

/// Powers and clocks the converter, and calibrates it where the chip needs it.
#[cfg(transducer = "ratiometric")]
pub(super) fn power_converter(adc: Peri<'static, ADC1>) {
    // Dropping the driver would switch the converter off.
    core::mem::forget(Adc::new(adc));
}

/// Sets up ADC1 to run free at 6 MHz, read by channel 1 of DMA1, request 0. 47.5 cycles of sampling (7.9 us, enough for 10
/// kilo-ohm) and 12.5 of conversion take 10 us. 100 conversions take exactly 1 ms.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) fn set_up_converter(supply_measured: bool) {
    OUTPUT.connect();
    // The core's 24 MHz divided by four, synchronous with the core.
    pac::ADC1_COMMON.ccr().modify(|w| w.set_ckmode(0b11));
    let adc = pac::ADC1;
    adc.smpr(0)
        .modify(|w| w.set_smp(usize::from(OUTPUT.channel), SampleTime::CYCLES47_5));
    adc.sqr1().modify(|w| {
        w.set_l(u8::from(supply_measured));
        w.set_sq(0, OUTPUT.channel);
    });
    if supply_measured {
        SUPPLY.connect();
        adc.smpr(0)
            .modify(|w| w.set_smp(usize::from(SUPPLY.channel), SampleTime::CYCLES47_5));
        adc.sqr1().modify(|w| w.set_sq(1, SUPPLY.channel));
    }
    run_free();
}

/// Runs the sequence continuously, with each code to the DMA.
#[cfg(transducer = "ratiometric")]
fn run_free() {
    let adc = pac::ADC1;
    adc.cfgr().modify(|w| {
        w.set_cont(true);
        w.set_dmaen(true);
        w.set_dmacfg(pac::adc::vals::Dmacfg::CIRCULAR);
    });
    adc.isr().write(|w| w.set_adrdy(true));
    adc.cr().modify(|w| w.set_aden(true));
    while !adc.isr().read().adrdy() {}
}

/// Sampling of the internal reference, at least 4 us (DS11451, embedded voltage reference): 7.9 us, as for every channel.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) const IDENTITY_CONVERSION: u32 = 10;

/// Sets up ADC1 as [`set_up_converter`] does, for a scan of these channels and the internal reference after them.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) fn set_up_scan(channels: &[u8]) {
    const REFERENCE: u8 = 0;
    pac::ADC1_COMMON.ccr().modify(|w| {
        w.set_ckmode(0b11);
        w.set_vrefen(true);
    });
    let adc = pac::ADC1;
    let times = |channel: u8| {
        let channel = usize::from(channel);
        adc.smpr(channel / 10)
            .modify(|w| w.set_smp(channel % 10, SampleTime::CYCLES47_5));
    };
    let rank = |rank: usize, channel: u8| match rank {
        0..4 => adc.sqr1().modify(|w| w.set_sq(rank, channel)),
        _ => adc.sqr2().modify(|w| w.set_sq(rank - 4, channel)),
    };
    for (number, input) in channels
        .iter()
        .filter_map(|&channel| CHANNELS.get(usize::from(channel)))
        .enumerate()
    {
        input.connect();
        times(input.channel);
        rank(number, input.channel);
    }
    times(REFERENCE);
    rank(channels.len(), REFERENCE);
    adc.sqr1().modify(|w| w.set_l(channels.len() as u8));
    run_free();
}

/// Connects its channel of the DMA to the converter: request 0.
#[cfg(transducer = "ratiometric")]
pub(super) fn route_converter() {
    pac::DMA1.cselr().modify(|w| w.set_cs(0, 0));
}

/// Requests a stop after the conversion under way.
#[cfg(transducer = "ratiometric")]
pub(super) fn stop_conversions() {
    pac::ADC1.cr().modify(|w| w.set_adstp(true));
}
