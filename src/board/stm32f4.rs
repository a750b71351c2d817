//! The STM32F4: flags of the last reset, and its converter.

#[cfg(all(transducer = "ratiometric", hand))]
use super::chosen::CHANNELS;
#[cfg(all(transducer = "ratiometric", not(hand)))]
use super::chosen::{OUTPUT, SUPPLY};
use crate::status::ResetCause;
#[cfg(transducer = "ratiometric")]
use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::pac;
#[cfg(transducer = "ratiometric")]
use embassy_stm32::{Peri, peripherals::ADC1};
#[cfg(transducer = "ratiometric")]
use embassy_time::Duration;

/// Why the chip was reset; clears the flags. Every internal reset also sets the flag of the pin, so that flag is checked last
/// (RM0090 6.1.1).
pub(super) fn reset_cause() -> ResetCause {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|register| register.set_rmvf(true));
    if flags.wdgrstf() || flags.wwdgrstf() {
        ResetCause::Watchdog
    } else if flags.lpwrrstf() {
        ResetCause::LowPower
    } else if flags.sftrstf() {
        ResetCause::Software
    } else if flags.porrstf() {
        ResetCause::PowerOn
    } else if flags.borrstf() {
        ResetCause::BrownOut
    } else if flags.padrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}

/// Powers and clocks the converter, and calibrates it where the chip needs it.
#[cfg(transducer = "ratiometric")]
pub(super) fn power_converter(adc: Peri<'static, ADC1>) {
    // Dropping the driver would switch the converter off.
    core::mem::forget(Adc::new(adc));
}

/// Makes the next erasure work on words, in half of the time for bytes: 128 KB in 2 s at most (DS9405 table 48). The driver
/// does not set the width, which is a byte after reset. Words need a supply of at least 2.7 V (RM0090 table 13).
#[cfg(all(hand, feature = "load-tip"))]
pub(super) fn erase_by_words() {
    let control = pac::FLASH.cr();
    if control.read().lock() {
        // RM0090 3.6.1.
        pac::FLASH.keyr().write_value(0x4567_0123);
        pac::FLASH.keyr().write_value(0xCDEF_89AB);
    }
    control.modify(|w| w.set_psize(pac::flash::vals::Psize::PSIZE32));
}

/// Sets up ADC1 to run free at 4 MHz, read by stream 0 of DMA2, channel 0. 28 cycles of sampling (7 us, enough for 10 kilo-ohm)
/// and 12 of conversion take 10 us. 100 conversions take exactly 1 ms.
#[cfg(all(transducer = "ratiometric", not(hand)))]
pub(super) fn set_up_converter(supply_measured: bool) {
    OUTPUT.connect();
    let adc = pac::ADC1;
    adc.smpr2()
        .modify(|w| w.set_smp(usize::from(OUTPUT.channel), SampleTime::CYCLES28));
    adc.sqr1().modify(|w| w.set_l(u8::from(supply_measured)));
    adc.sqr3().modify(|w| w.set_sq(0, OUTPUT.channel));
    if supply_measured {
        SUPPLY.connect();
        // The channels from 10 on have their own register.
        adc.smpr1()
            .modify(|w| w.set_smp(usize::from(SUPPLY.channel) - 10, SampleTime::CYCLES28));
        adc.sqr3().modify(|w| w.set_sq(1, SUPPLY.channel));
        adc.cr1().modify(|w| w.set_scan(true));
    }
}

/// Sampling of the internal reference, at least 10 us (DS9405 table 84): 56 cycles at 4 MHz take 14 us, and with 12 cycles of conversion 17 us.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) const IDENTITY_CONVERSION: u32 = 17;

/// Sets up ADC1 as [`set_up_converter`] does, for a scan of these channels and the internal reference after them.
#[cfg(all(transducer = "ratiometric", hand))]
pub(super) fn set_up_scan(channels: &[u8]) {
    const REFERENCE: u8 = 17;
    let adc = pac::ADC1;
    pac::ADC123_COMMON.ccr().modify(|w| w.set_tsvrefe(true));
    let times = |channel: u8, time: SampleTime| match usize::from(channel) {
        channel @ 0..10 => adc.smpr2().modify(|w| w.set_smp(channel, time)),
        channel => adc.smpr1().modify(|w| w.set_smp(channel - 10, time)),
    };
    let rank = |rank: usize, channel: u8| match rank {
        0..6 => adc.sqr3().modify(|w| w.set_sq(rank, channel)),
        _ => adc.sqr2().modify(|w| w.set_sq(rank - 6, channel)),
    };
    for (number, input) in channels
        .iter()
        .filter_map(|&channel| CHANNELS.get(usize::from(channel)))
        .enumerate()
    {
        input.connect();
        times(input.channel, SampleTime::CYCLES28);
        rank(number, input.channel);
    }
    times(REFERENCE, SampleTime::CYCLES56);
    rank(channels.len(), REFERENCE);
    adc.sqr1().modify(|w| w.set_l(channels.len() as u8));
    adc.cr1().modify(|w| w.set_scan(true));
}

/// Starts the converter at the front of the ring, from any state.
#[cfg(transducer = "ratiometric")]
pub(super) fn restart_converter(ring: u32, length: u16) {
    use pac::dma::vals::{Dir, Pl, Size};
    let (adc, dma, stream) = (pac::ADC1, pac::DMA2, pac::DMA2.st(0));
    adc.cr2().write(|_| {});
    stream.cr().write(|_| {});
    // The transfer under way ends first, in a few cycles.
    while stream.cr().read().en() {}
    dma.ifcr(0).write(|w| {
        w.set_tcif(0, true);
        w.set_htif(0, true);
        w.set_teif(0, true);
        w.set_dmeif(0, true);
        w.set_feif(0, true);
    });
    stream.par().write_value(adc.dr().as_ptr() as u32);
    stream.m0ar().write_value(ring);
    stream.ndtr().write(|w| w.set_ndt(length));
    stream.cr().write(|w| {
        w.set_chsel(0);
        w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
        w.set_pl(Pl::VERY_HIGH);
        w.set_msize(Size::BITS16);
        w.set_psize(Size::BITS16);
        w.set_minc(true);
        w.set_circ(true);
        w.set_en(true);
    });
    adc.sr().write(|_| {});
    adc.cr2().write(|w| {
        w.set_dma(true);
        w.set_dds(pac::adc::vals::Dds::CONTINUOUS);
        w.set_cont(true);
        w.set_adon(true);
    });
    // The converter needs 3 us to start (DS9405 table 74).
    embassy_time::block_for(Duration::from_micros(3));
    adc.cr2().modify(|w| w.set_swstart(true));
}

/// Whether the converter runs. It stops if a code was not fetched in time.
#[cfg(transducer = "ratiometric")]
pub(super) fn converter_runs() -> bool {
    !pac::ADC1.sr().read().ovr()
}

/// Number of conversions until the DMA is at the front of the ring again.
#[cfg(transducer = "ratiometric")]
pub(super) fn conversions_left() -> u16 {
    pac::DMA2.st(0).ndtr().read().ndt()
}
