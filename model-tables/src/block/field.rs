//! The values of a section: each has a fixed length in bytes and a spelling in Rust source. A section describes its fields once, in
//! order, to a [`Visit`]: the reader, the writer or a printer.

use crate::constants::{AirReference, Quantity, TransducerKind};
use crate::material::series::{Factor, TermStep};
use crate::table::law::Touched;
use crate::table::{Constant, Powers};
#[cfg(feature = "std")]
use std::fmt::{self, Write};

/// A value of fixed length; numbers are little-endian.
pub trait Field: Copy {
    /// Bytes.
    const LENGTH: usize;

    /// The value of so many bytes, if they are one.
    fn get(bytes: &[u8]) -> Option<Self>;

    /// Adds the bytes.
    #[cfg(feature = "std")]
    fn put(&self, out: &mut Vec<u8>);

    /// Adds the value as Rust source.
    ///
    /// # Errors
    /// Those of `out`.
    #[cfg(feature = "std")]
    fn spell(&self, out: &mut String) -> fmt::Result;
}

/// Goes over the fields of a section.
pub trait Visit {
    /// Why it stops.
    type Stop;

    /// The next field.
    ///
    /// # Errors
    /// The reason to stop.
    fn field<T: Field>(&mut self, name: &'static str, value: &mut T) -> Result<(), Self::Stop>;
}

macro_rules! integer {
    ($($type:ty, $spelling:literal;)*) => {$(
        impl Field for $type {
            const LENGTH: usize = size_of::<$type>();

            fn get(bytes: &[u8]) -> Option<Self> {
                bytes.try_into().ok().map(<$type>::from_le_bytes)
            }

            #[cfg(feature = "std")]
            fn put(&self, out: &mut Vec<u8>) {
                out.extend(self.to_le_bytes());
            }

            #[cfg(feature = "std")]
            fn spell(&self, out: &mut String) -> fmt::Result {
                write!(out, $spelling, self)
            }
        }
    )*};
}

integer! {
    u8, "{}";
    u16, "{}";
    i32, "{}";
    u32, "{}";
    u64, "{:#018x}"; // hashes
}

impl<T: Field, const N: usize> Field for [T; N] {
    const LENGTH: usize = N * T::LENGTH;

    fn get(bytes: &[u8]) -> Option<Self> {
        let mut values = [T::get(bytes.get(..T::LENGTH)?)?; N];
        for (value, own) in values.iter_mut().zip(bytes.chunks_exact(T::LENGTH)) {
            *value = T::get(own)?;
        }
        Some(values)
    }

    #[cfg(feature = "std")]
    fn put(&self, out: &mut Vec<u8>) {
        for value in self {
            value.put(out);
        }
    }

    #[cfg(feature = "std")]
    fn spell(&self, out: &mut String) -> fmt::Result {
        out.push('[');
        for (at, value) in self.iter().enumerate() {
            if at > 0 {
                out.push_str(", ");
            }
            value.spell(out)?;
        }
        out.push(']');
        Ok(())
    }
}

/// Mantissa and shift.
impl Field for Factor {
    const LENGTH: usize = <[u32; 2]>::LENGTH;

    fn get(bytes: &[u8]) -> Option<Self> {
        let [mantissa, shift] = <[u32; 2]>::get(bytes)?;
        (shift <= Self::MAX_SHIFT).then_some(Self { mantissa, shift })
    }

    #[cfg(feature = "std")]
    fn put(&self, out: &mut Vec<u8>) {
        [self.mantissa, self.shift].put(out);
    }

    #[cfg(feature = "std")]
    fn spell(&self, out: &mut String) -> fmt::Result {
        write!(out, "model_tables::material::series::{self:?}")
    }
}

/// What is lost, and its share.
impl Field for TermStep {
    const LENGTH: usize = 2 * Factor::LENGTH;

    fn get(bytes: &[u8]) -> Option<Self> {
        let (lost, share) = bytes.split_at_checked(Factor::LENGTH)?;
        Some(Self {
            lost: Factor::get(lost)?,
            share: Factor::get(share)?,
        })
    }

    #[cfg(feature = "std")]
    fn put(&self, out: &mut Vec<u8>) {
        self.lost.put(out);
        self.share.put(out);
    }

    #[cfg(feature = "std")]
    fn spell(&self, out: &mut String) -> fmt::Result {
        out.push_str("model_tables::material::series::TermStep { lost: ");
        self.lost.spell(out)?;
        out.push_str(", share: ");
        self.share.spell(out)?;
        out.push_str(" }");
        Ok(())
    }
}

/// Values that are one of few, as a word with their code.
macro_rules! choice {
    ($type:ty, $path:literal: $($code:literal => $value:path),*) => {
        impl Field for $type {
            const LENGTH: usize = 4;

            fn get(bytes: &[u8]) -> Option<Self> {
                match u32::get(bytes)? {
                    $($code => Some($value),)*
                    _ => None,
                }
            }

            #[cfg(feature = "std")]
            fn put(&self, out: &mut Vec<u8>) {
                let code: u32 = match self {
                    $($value => $code,)*
                };
                code.put(out);
            }

            #[cfg(feature = "std")]
            fn spell(&self, out: &mut String) -> fmt::Result {
                write!(out, concat!("model_tables::", $path, "::{:?}"), self)
            }
        }
    };
}

choice!(Powers, "table::Powers": 2 => Powers::Two, 4 => Powers::Four, 6 => Powers::Six, 8 => Powers::Eight);
choice!(Constant, "table::Constant": 0 => Constant::Half, 1 => Constant::Whole);
choice!(Quantity, "constants::Quantity": 0 => Quantity::Gauge, 1 => Quantity::Absolute);
choice!(AirReference, "constants::AirReference": 0 => AirReference::None, 1 => AirReference::Host, 2 => AirReference::Part);

/// A code, an address, whether the supply is measured, a zero; then two numbers. What a kind has not is 0.
impl Field for TransducerKind {
    const LENGTH: usize = 4 + <[u32; 2]>::LENGTH;

    fn get(bytes: &[u8]) -> Option<Self> {
        let (head, pair) = bytes.split_at_checked(4)?;
        let pair = <[u32; 2]>::get(pair)?;
        let (rises, none) = (pair[0] < pair[1], pair == [0; 2]);
        match *head {
            [0, 0, supply @ 0..=1, 0] if rises && pair[1] <= 65_536 => Some(Self::Ratiometric {
                output: pair,
                supply_measured: supply == 1,
            }),
            [1, address @ 0..=0x7F, 0, 0] if rises && pair[1] < 1 << 24 => Some(Self::Abp2 {
                address,
                counts: pair,
            }),
            [2, address @ 0..=0x7F, 0, 0] if none => Some(Self::Ms5837 { address }),
            [3, address @ 0..=0x7F, 0, 0] if none => Some(Self::Dps310 { address }),
            _ => None,
        }
    }

    #[cfg(feature = "std")]
    fn put(&self, out: &mut Vec<u8>) {
        let (head, pair) = match *self {
            Self::Ratiometric {
                output,
                supply_measured,
            } => ([0, 0, u8::from(supply_measured), 0], output),
            Self::Abp2 { address, counts } => ([1, address, 0, 0], counts),
            Self::Ms5837 { address } => ([2, address, 0, 0], [0; 2]),
            Self::Dps310 { address } => ([3, address, 0, 0], [0; 2]),
        };
        out.extend(head);
        pair.put(out);
    }

    #[cfg(feature = "std")]
    fn spell(&self, out: &mut String) -> fmt::Result {
        write!(out, "model_tables::constants::TransducerKind::{self:?}")
    }
}

/// A code, then the radius in micrometres, 0 of a plate.
impl Field for Touched {
    const LENGTH: usize = 8;

    fn get(bytes: &[u8]) -> Option<Self> {
        let (code, radius) = bytes.split_at_checked(4)?;
        Self::of(u8::try_from(u32::get(code)?).ok()?, i32::get(radius)?)
    }

    #[cfg(feature = "std")]
    fn put(&self, out: &mut Vec<u8>) {
        let (code, radius) = self.code();
        u32::from(code).put(out);
        radius.put(out);
    }

    #[cfg(feature = "std")]
    fn spell(&self, out: &mut String) -> fmt::Result {
        write!(out, "model_tables::table::law::Touched::{self:?}")
    }
}
