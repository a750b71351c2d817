//! Numbers of several elements side by side, which the compiler keeps in vector registers.

use core::ops::{Add, AddAssign, Mul, Sub};

/// Elements side by side.
pub const LANES: usize = 4;

/// Runs a calculation with the vector instructions that the processor has. They round as scalar ones do, and none joins a product and a sum:
/// every host gets the same bits. Only what is inlined into the calculation gains.
#[inline(always)]
pub fn vectorised<R>(calculation: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(calculation)
}

/// What the mechanics of a point is written in: one number, or one of each of several elements.
pub trait Real:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
{
}

impl Real for f64 {}

/// One number of each of [`LANES`] elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    /// Zeros.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// The sum over the elements.
    pub fn sum(self) -> f64 {
        self.0.into_iter().sum()
    }

    /// The largest absolute value of the elements; not a number if one of them is none.
    pub fn largest(self) -> f64 {
        self.0.into_iter().fold(
            0.0,
            |largest: f64, x| {
                if x.is_nan() { x } else { largest.max(x.abs()) }
            },
        )
    }
}

impl Real for Lanes {}

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self([x; LANES])
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([a + e, b + f, c + g, d + h])
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([a - e, b - f, c - g, d - h])
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([a * e, b * f, c * g, d * h])
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * Self::from(other)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
