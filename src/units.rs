//! The quantities between the stages, each a type with its unit and range. Pressure rise, force and indentation are those of
//! [`model_tables::units`].

/// Time since reset, microseconds. 64 bits do not wrap in 584 000 years.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Microseconds(pub u64);

/// Pressure, millipascals: 2147 kPa either way. Gauge or absolute as the design's
/// [`Quantity`](model_tables::constants::Quantity) says.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Millipascals(pub i32);

/// Temperature, hundredths of a degree Celsius: 327 degC either way.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Centidegrees(pub i16);

/// Pressure, counts of `1 / 2^k` pascal with the design's `k`; gauge or absolute as the transducer is. Any `i32` is
/// valid.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Pressure(pub i32);

impl Pressure {
    /// The nearest count to a pressure in millipascals, held at the ends of the word.
    pub const fn from_millipascals(millipascals: i64, fraction_bits: u32) -> Self {
        // |millipascals| <= 2^31 * 1000 < 2^41 and k <= 16: below 2^57.
        let scaled = millipascals * (1 << fraction_bits);
        Self(saturate((scaled + if scaled < 0 { -500 } else { 500 }) / 1000))
    }

    /// The nearest count to a pressure in pascals, held at the ends of the word.
    pub const fn from_pascals(pascals: i32, fraction_bits: u32) -> Self {
        Self::from_millipascals(pascals as i64 * 1000, fraction_bits)
    }
}

/// The `i32` nearest to a number.
pub const fn saturate(number: i64) -> i32 {
    if number > i32::MAX as i64 {
        i32::MAX
    } else if number < i32::MIN as i64 {
        i32::MIN
    } else {
        number as i32
    }
}
