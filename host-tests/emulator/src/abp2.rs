//! A Honeywell ABP2 on a bus, as its datasheet has it (32350268, sections 5 and 6).

use rigless::chip::Timeline;
use rigless::time::VirtualNanos;

/// What starts a measurement.
const MEASURE: [u8; 3] = [0xAA, 0x00, 0x00];
/// How long it takes.
const CONVERSION: VirtualNanos = VirtualNanos(5_000_000);
/// The status byte: powered, busy, arithmetic at its end.
const POWERED: u8 = 0x40;
const BUSY: u8 = 0x20;
const SATURATED: u8 = 0x01;
/// 24 bits.
const FULL_SCALE: f64 = 16_777_215.0;
/// 25 degC: 75 of the 200 K from -50 degC on.
const TEMPERATURE: u32 = 6_291_456;

/// The part.
#[derive(Debug)]
pub(crate) struct Abp2Chip {
    /// Counts at the ends of the range.
    pub(crate) counts: [f64; 2],
    /// The range, gauge pressures in pascals.
    pub(crate) range: [f64; 2],
    /// The gauge pressure on it, pascals.
    pub(crate) pascals: f64,
    /// Added to the time of a measurement; `None`: it never ends.
    pub(crate) late: Option<VirtualNanos>,
    written: Vec<u8>,
    done: Option<VirtualNanos>,
    answer: Vec<u8>,
}

impl Abp2Chip {
    /// The part powered up, with nothing measured.
    pub(crate) fn new(counts: [f64; 2], range: [f64; 2]) -> Self {
        Self {
            counts,
            range,
            pascals: 0.0,
            late: Some(VirtualNanos(0)),
            written: vec![],
            done: None,
            answer: vec![],
        }
    }

    /// The measurement under way is lost.
    pub(crate) fn reset(&mut self) {
        self.done = None;
    }

    pub(crate) fn start(&mut self, read: bool, context: &Timeline<'_, '_>) {
        self.written.clear();
        self.answer.clear();
        if !read {
            return;
        }
        let busy = self.done.is_some_and(|done| context.now() < done);
        let ([low, high], [start, end]) = (self.counts, self.range);
        let exact = low + (self.pascals - start) / (end - start) * (high - low);
        let counts = exact.round().clamp(0.0, FULL_SCALE);
        let status = match (busy, self.done) {
            (true, _) => POWERED | BUSY,
            (false, Some(_)) if (counts - exact).abs() > 1.0 => POWERED | SATURATED,
            (false, _) => POWERED,
        };
        let [_, pressure @ ..] = if self.done.is_some() { counts as u32 } else { 0 }.to_be_bytes();
        let [_, temperature @ ..] = TEMPERATURE.to_be_bytes();
        // Read from the end.
        self.answer.extend(temperature.iter().rev());
        self.answer.extend(pressure.iter().rev());
        self.answer.push(status);
    }

    pub(crate) fn write(&mut self, byte: u8) {
        self.written.push(byte);
    }

    pub(crate) fn read(&mut self) -> u8 {
        self.answer.pop().unwrap_or(0xFF)
    }

    pub(crate) fn stop(&mut self, context: &Timeline<'_, '_>) {
        if self.written == MEASURE {
            let late = self.late.map_or(u64::MAX / 2, |late| late.0);
            self.done = Some(VirtualNanos(context.now().0 + CONVERSION.0 + late));
        }
        self.written.clear();
    }
}
