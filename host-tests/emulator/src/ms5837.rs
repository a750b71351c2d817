//! A TE MS5837-02BA on a bus, as its datasheet has it (09/2017), with the calibration words of its example.

use rigless::chip::Timeline;
use rigless::time::VirtualNanos;

/// The example's C1 to C6 behind the word of the CRC, which is AN520's for them (computed apart), and version 02BA01.
const PROM: [u16; 7] = [0x8000, 46372, 43981, 29059, 27842, 31553, 28165];
/// The example's temperature word, and what follows of it: dT = 68, OFF and SENS at 20 degC.
const TEMPERATURE: u32 = 8_077_636;
const DT: f64 = 68.0;
/// Longest conversions at 256 to 8192 samples, microseconds.
const CONVERSIONS: [u64; 6] = [600, 1_200, 2_300, 4_600, 9_100, 18_100];

/// The part.
#[derive(Debug)]
pub(crate) struct Ms5837 {
    /// The absolute pressure on it, pascals.
    pub(crate) pascals: f64,
    /// Added to the time of a conversion; `None`: it never ends.
    pub(crate) late: Option<VirtualNanos>,
    command: u8,
    /// A word and when it is there.
    converting: Option<(u32, VirtualNanos)>,
    answer: Vec<u8>,
}

impl Ms5837 {
    /// The part powered up.
    pub(crate) fn new() -> Self {
        Self {
            pascals: 0.0,
            late: Some(VirtualNanos(0)),
            command: 0,
            converting: None,
            answer: vec![],
        }
    }

    /// The conversion under way is lost.
    pub(crate) fn reset(&mut self) {
        self.converting = None;
    }

    /// The word that the datasheet's first-order formula turns into the pressure.
    fn pressure_word(&self) -> u32 {
        let [_, c1, c2, c3, c4, ..] = PROM.map(f64::from);
        let offset = c2 * 131_072.0 + c4 * DT / 64.0;
        let sensitivity = c1 * 65_536.0 + c3 * DT / 128.0;
        ((self.pascals * 32_768.0 + offset) * 2_097_152.0 / sensitivity).round() as u32
    }

    pub(crate) fn start(&mut self, read: bool, context: &Timeline<'_, '_>) {
        if !read {
            return;
        }
        self.answer = match self.command {
            // Read from the end.
            0x00 => {
                let word = self
                    .converting
                    .take_if(|(_, done)| context.now() >= *done)
                    .map_or(0, |(word, _)| word);
                word.to_le_bytes()[..3].to_vec()
            }
            command @ 0xA0..=0xAC => PROM[usize::from(command - 0xA0) / 2].to_le_bytes().to_vec(),
            _ => vec![],
        };
    }

    pub(crate) fn write(&mut self, byte: u8, context: &Timeline<'_, '_>) {
        self.command = byte;
        let word = match byte & 0xF0 {
            0x40 => self.pressure_word(),
            0x50 => TEMPERATURE,
            _ if byte == 0x1E => return self.reset(),
            _ => return,
        };
        let microseconds = CONVERSIONS[usize::from(byte & 0x0F) / 2 % CONVERSIONS.len()];
        let late = self.late.map_or(u64::MAX / 2, |late| late.0);
        let done = VirtualNanos(context.now().0 + microseconds * 1000 + late);
        self.converting = Some((word, done));
    }

    pub(crate) fn read(&mut self) -> u8 {
        self.answer.pop().unwrap_or(0xFF)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_pressure_is_the_examples_word() {
        let part = Ms5837 {
            pascals: 110_002.0,
            ..Ms5837::new()
        };
        // The example rounds down to a pascal, which is 23 counts.
        assert!(
            part.pressure_word().abs_diff(6_465_444) < 23,
            "{}",
            part.pressure_word()
        );
    }
}
