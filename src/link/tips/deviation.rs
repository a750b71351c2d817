//! Standard deviations, encoded as one byte each.

/// `2^((2 j + 1) / 16)` with 16 fraction bits. Above the `j`-th value, the next eighth of an octave is nearer.
const NEARER: [u32; 8] = [68_438, 74_632, 81_386, 88_752, 96_785, 105_545, 115_098, 125_515];

/// For each thirty-second of an octave: the number of these values below its start.
const BELOW: [u8; 32] = {
    let mut below = [0; 32];
    let mut part = 0;
    while part < 32 {
        let mut j = 0;
        while j < 8 && NEARER[j] < (32 + part as u32) << 11 {
            j += 1;
        }
        below[part] = j as u8;
        part += 1;
    }
    below
};

/// `2^(j / 8)` with 30 fraction bits.
const EIGHTHS: [u32; 8] = [
    1_073_741_824,
    1_170_923_762,
    1_276_901_417,
    1_392_470_869,
    1_518_500_250,
    1_655_936_265,
    1_805_811_301,
    1_969_251_188,
];

/// A standard deviation as its binary logarithm in eighths: `2^(c / 8)`, as a whole number, is within 4.5 % and half a unit of
/// it. 255 means the largest value of the word, or more. 0 and 1 give 0.
pub(super) fn eighths(deviation: i32) -> u8 {
    if deviation == i32::MAX {
        return 255;
    }
    let value = deviation.max(1).unsigned_abs();
    let octave = value.ilog2();
    // 2^16 to 2^17.
    let mantissa = (value << (31 - octave)) >> 15;
    // Number of values below the mantissa: those below the start of its thirty-second of an octave, and at most one within it.
    let mut above = usize::from(BELOW[(mantissa >> 11) as usize % 32]);
    above += usize::from(above < 8 && mantissa > NEARER[above % 8]);
    // At most 8 * 30 + 8.
    (octave * 8) as u8 + above as u8
}

/// The deviation that a byte encodes.
pub(super) fn of_eighths(eighths: u8) -> i32 {
    if eighths == 255 {
        return i32::MAX;
    }
    let (octave, place) = (u32::from(eighths / 8), usize::from(eighths % 8));
    let value = ((u64::from(EIGHTHS[place]) << octave) + (1 << 29)) >> 30;
    value.min(i32::MAX as u64) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_stands_for_a_deviation_within_4_5_percent() {
        let mut last = 0;
        for value in (1..2_000).chain((2_000..i32::MAX - 1).step_by(999_983)) {
            let byte = eighths(value);
            assert!(byte >= last && byte < 255, "{value}: {byte}");
            last = byte;
            let (exact, read) = (f64::from(value), f64::from(of_eighths(byte)));
            assert!((read - exact).abs() <= 0.045 * exact + 0.5, "{value}: {read}");
        }
        assert_eq!((eighths(i32::MAX), of_eighths(255)), (255, i32::MAX));
        assert_eq!(eighths(0), 0);
    }

    #[test]
    fn the_constants_are_powers_of_two() {
        for j in 0..8 {
            assert!((f64::from(EIGHTHS[j]) / 2_f64.powi(30) - (j as f64 / 8.0).exp2()).abs() < 1e-9);
            assert!((f64::from(NEARER[j]) / 65_536.0 - ((2 * j + 1) as f64 / 16.0).exp2()).abs() < 1e-5);
        }
    }
}
