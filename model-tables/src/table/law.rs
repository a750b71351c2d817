//! The law of a blend: the weights of the reference object's tables over the radius of an object.

/// Fraction bits of a weight.
pub const WEIGHT_BITS: u32 = 10;

/// The touched object, as stated by a hand. Radii are in micrometres, > 0.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Touched {
    /// A flat plate.
    Plate,
    /// A ball.
    Ball(i32),
    /// A hollow that is part of a sphere.
    Cup(i32),
    /// A cylinder across the tip: half the weights of a ball of its radius.
    Cylinder(i32),
}

impl Touched {
    /// Whether it is hollow.
    pub const fn is_cup(self) -> bool {
        matches!(self, Self::Cup(_))
    }

    /// Code and radius. The radius of a plate is 0.
    pub const fn code(self) -> (u8, i32) {
        match self {
            Self::Plate => (0, 0),
            Self::Ball(radius) => (1, radius),
            Self::Cup(radius) => (2, radius),
            Self::Cylinder(radius) => (3, radius),
        }
    }

    /// The object with this code and radius.
    pub const fn of(code: u8, radius: i32) -> Option<Self> {
        match code {
            0 if radius == 0 => Some(Self::Plate),
            1 if radius > 0 => Some(Self::Ball(radius)),
            2 if radius > 0 => Some(Self::Cup(radius)),
            3 if radius > 0 => Some(Self::Cylinder(radius)),
            _ => None,
        }
    }
}

impl core::fmt::Display for Touched {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let millimetres = |radius: i32| f64::from(radius) * 1e-3;
        match *self {
            Self::Plate => f.write_str("plate"),
            Self::Ball(radius) => write!(f, "ball of {} mm", millimetres(radius)),
            Self::Cup(radius) => write!(f, "cup of {} mm", millimetres(radius)),
            Self::Cylinder(radius) => write!(f, "cylinder of {} mm", millimetres(radius)),
        }
    }
}

/// Weights of the reference object in units of `2^-10`, and the last input for which they are valid.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Weights {
    /// Weight of the force.
    pub force: i32,
    /// Weight of the indentation.
    pub indentation: i32,
    /// Last input covered, counts: that of the tables or less.
    pub maximum: i32,
}

impl Weights {
    /// The weights of the plate.
    pub const PLATE: Self = Self {
        force: 0,
        indentation: 0,
        maximum: i32::MAX,
    };
    /// The weights of the reference object.
    pub const REFERENCE: Self = Self {
        force: 1 << WEIGHT_BITS,
        indentation: 1 << WEIGHT_BITS,
        maximum: i32::MAX,
    };
}

/// Weights over the radius, of one design: with `t = (reference + offset) / (R + offset)`, for a cup of `-R`,
/// `w = t (c1 + c2 t + c3 t^2)`. Fitted to solved objects.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BlendLaw {
    /// Radius of the reference ball, micrometres; where the reference is a cup, a length like it.
    pub reference: i32,
    /// Added to radii: twice the wall, micrometres.
    pub offset: i32,
    /// The smallest radius of a ball, and of a cup, micrometres; 0: none.
    pub least: [i32; 2],
    /// Last input that all balls, and all cups, answer: counts.
    pub last: [i32; 2],
    /// Coefficients of the force, of balls and of cups, in units of `2^-12`.
    pub force: [[i32; 3]; 2],
    /// Coefficients of the indentation.
    pub indentation: [[i32; 3]; 2],
}

/// Fraction bits of `t` and of the coefficients.
pub(crate) const LAW_BITS: u32 = 12;

/// Largest length in a law, micrometres. For a larger ball, the host states a plate.
const LONGEST: i32 = 1_000_000;
/// Largest coefficient of a loaded law: 64.
const LARGEST: i32 = 64 << LAW_BITS;

impl BlendLaw {
    /// The first invalid field of the law, for tables that end at `maximum`. `None` if all are valid.
    pub fn out_of_range(&self, maximum: i32) -> Option<&'static str> {
        let length = |length: i32| (1..=LONGEST).contains(&length);
        let small = |law: &[[i32; 3]; 2]| {
            law.as_flattened()
                .iter()
                .all(|coefficient| (-LARGEST..=LARGEST).contains(coefficient))
        };
        let [ball, cup] = self.least;
        [
            ("reference", length(self.reference)),
            ("offset", length(self.offset)),
            // The divisor of a cup is below 0.
            (
                "least",
                (ball == 0 || length(ball))
                    && (cup == 0 || length(cup) && cup > self.offset)
                    && (ball > 0 || cup > 0),
            ),
            ("last", self.last.iter().all(|last| (1..=maximum).contains(last))),
            ("force", small(&self.force)),
            ("indentation", small(&self.indentation)),
        ]
        .into_iter()
        .find_map(|(field, holds)| (!holds).then_some(field))
    }

    /// The weights of an object. `None` for a radius outside the range of the solved objects.
    pub const fn weights(&self, touched: Touched) -> Option<Weights> {
        let (radius, of, divisor) = match touched {
            Touched::Plate => return Some(Weights::PLATE),
            Touched::Ball(radius) => (radius, 0, 1),
            Touched::Cup(radius) => (radius, 1, 1),
            Touched::Cylinder(radius) => (radius, 0, 2),
        };
        let least = self.least[of];
        if least <= 0 || radius < least || radius > LONGEST {
            return None;
        }
        let signed = if of == 1 { -(radius as i64) } else { radius as i64 };
        let t =
            (((self.reference as i64) + (self.offset as i64)) << LAW_BITS) / (signed + self.offset as i64);
        Some(Weights {
            force: weight(&self.force[of], t) / divisor,
            indentation: weight(&self.indentation[of], t) / divisor,
            maximum: self.last[of],
        })
    }
}

/// A law's value at `t`, in units of a weight.
const fn weight(coefficients: &[i32; 3], t: i64) -> i32 {
    let [first, second, third] = *coefficients;
    // Coefficients are below 2^18 and |t| below 2^33: sums below 2^40, products below 2^63 with the limits below.
    let sum = (third as i64 * t) >> LAW_BITS;
    let sum = ((second as i64 + sum) * t) >> LAW_BITS;
    let sum = ((first as i64 + sum) * t) >> LAW_BITS;
    let (units, limit) = (LAW_BITS - WEIGHT_BITS, 1 << 20);
    let rounded = (sum + (1 << (units - 1))) >> units;
    if rounded > limit {
        limit as i32
    } else if rounded < -limit {
        -limit as i32
    } else {
        rounded as i32
    }
}
