//! A TE MS5837 on a bus, as the datasheets of its two sisters have it (02BA: 09/2017, 30BA: 2019), with the calibration words
//! of their examples.

use rigless::chip::Timeline;
use rigless::time::VirtualNanos;

/// One of the sisters.
#[derive(Debug)]
pub(crate) struct Model {
    /// The example's C1 to C6 behind the word of the CRC, which is AN520's for them (computed apart), and the version.
    prom: [u16; 7],
    /// What OFF is scaled with: C2 times the first and C4 dT over the second; SENS likewise with C1 and C3.
    offset: [f64; 2],
    sensitivity: [f64; 2],
    /// Of the difference between D1 SENS / 2^21 and OFF, so many are a pascal.
    per_pascal: f64,
}

/// 2 bar; version 02BA01.
pub(crate) const TWO_BAR: Model = Model {
    prom: [0x8000, 46372, 43981, 29059, 27842, 31553, 28165],
    offset: [131_072.0, 64.0],
    sensitivity: [65_536.0, 128.0],
    per_pascal: 32_768.0,
};
/// 30 bar, of those that carry the version 02BA01. Its pressures are in tenths of a millibar.
pub(crate) const THIRTY_BAR: Model = Model {
    prom: [0x2000, 34982, 36352, 20328, 22354, 26646, 26146],
    offset: [65_536.0, 128.0],
    sensitivity: [32_768.0, 256.0],
    per_pascal: 819.2,
};
/// The temperature of the 02BA's example: dT = D2 - C5 2^8, so that it is 20 degC.
const DT: u32 = 68;
/// Longest conversions at 256 to 8192 samples, microseconds.
const CONVERSIONS: [u64; 6] = [600, 1_200, 2_300, 4_600, 9_100, 18_100];

/// The part.
#[derive(Debug)]
pub(crate) struct Ms5837Chip {
    model: Model,
    /// The absolute pressure on it, pascals.
    pub(crate) pascals: f64,
    /// Added to the time of a conversion; `None`: it never ends.
    pub(crate) late: Option<VirtualNanos>,
    command: u8,
    /// A word and when it is there.
    converting: Option<(u32, VirtualNanos)>,
    answer: Vec<u8>,
}

impl Ms5837Chip {
    /// The part powered up.
    pub(crate) fn new(model: Model) -> Self {
        Self {
            model,
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
        let Model {
            prom,
            offset,
            sensitivity,
            per_pascal,
        } = &self.model;
        let [_, c1, c2, c3, c4, ..] = prom.map(f64::from);
        let dt = f64::from(DT);
        let offset = c2 * offset[0] + c4 * dt / offset[1];
        let sensitivity = c1 * sensitivity[0] + c3 * dt / sensitivity[1];
        ((self.pascals * per_pascal + offset) * 2_097_152.0 / sensitivity).round() as u32
    }

    fn temperature_word(&self) -> u32 {
        (u32::from(self.model.prom[5]) << 8) + DT
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
            command @ 0xA0..=0xAC => self.model.prom[usize::from(command - 0xA0) / 2]
                .to_le_bytes()
                .to_vec(),
            _ => vec![],
        };
    }

    pub(crate) fn write(&mut self, byte: u8, context: &Timeline<'_, '_>) {
        self.command = byte;
        let word = match byte & 0xF0 {
            0x40 => self.pressure_word(),
            0x50 => self.temperature_word(),
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
        let part = Ms5837Chip {
            pascals: 110_002.0,
            ..Ms5837Chip::new(TWO_BAR)
        };
        assert_eq!(part.temperature_word(), 8_077_636);
        // The example rounds down to a pascal, which is 23 counts.
        assert!(
            part.pressure_word().abs_diff(6_465_444) < 23,
            "{}",
            part.pressure_word()
        );
    }

    #[test]
    fn the_thirty_bar_part_reads_a_twentieth_by_the_two_bar_parts_formula() {
        let part = Ms5837Chip {
            pascals: 101_325.0,
            ..Ms5837Chip::new(THIRTY_BAR)
        };
        let word = f64::from(part.pressure_word());
        let [_, c1, c2, ..] = THIRTY_BAR.prom.map(f64::from);
        // dT of 68 counts is nothing here.
        let own = (word * c1 * 32_768.0 / 2_097_152.0 - c2 * 65_536.0) / 8_192.0 * 10.0;
        let other = (word * c1 * 65_536.0 / 2_097_152.0 - c2 * 131_072.0) / 32_768.0;
        assert!((own - 101_325.0).abs() < 60.0, "{own}");
        assert!((other - 101_325.0 / 20.0).abs() < 10.0, "{other}");
    }
}
