//! The converter of the STM32L4 and the STM32G4, read by channel 1 of DMA1 into a ring. The two families have the same peripherals,
//! but route the converter's requests to the DMA differently.

use super::chip::{route_converter, stop_conversions};
use embassy_stm32::pac;

/// Starts the converter at the front of the ring, from any state.
pub(super) fn restart_converter(ring: u32, length: u16) {
    use pac::bdma::vals::{Dir, Pl, Size};
    let (adc, dma, channel) = (pac::ADC1, pac::DMA1, pac::DMA1.ch(0));
    if adc.cr().read().adstart() {
        stop_conversions();
        // The conversion under way ends first, 10 us.
        while adc.cr().read().adstart() {}
    }
    channel.cr().write(|_| {});
    dma.ifcr().write(|w| w.set_gif(0, true));
    route_converter();
    channel.par().write_value(adc.dr().as_ptr() as u32);
    channel.mar().write_value(ring);
    channel.ndtr().write(|w| w.set_ndt(length));
    channel.cr().write(|w| {
        w.set_dir(Dir::FROM_PERIPHERAL);
        w.set_pl(Pl::VERY_HIGH);
        w.set_msize(Size::BITS16);
        w.set_psize(Size::BITS16);
        w.set_minc(true);
        w.set_circ(true);
        w.set_en(true);
    });
    adc.isr().write(|w| w.set_ovr(true));
    adc.cr().modify(|w| w.set_adstart(true));
}

/// Whether the converter runs. It stops if a code was not fetched in time.
pub(super) fn converter_runs() -> bool {
    !pac::ADC1.isr().read().ovr()
}

/// Number of conversions until the DMA is at the front of the ring again.
pub(super) fn conversions_left() -> u16 {
    pac::DMA1.ch(0).ndtr().read().ndt()
}
