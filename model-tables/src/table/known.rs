//! Results from pressure and a known indentation: the force without knowing the curvature, and the curvature of the object.
//!
//! For the same pressure, a ball needs less force and a larger indentation than a plate, by nearly the same factor. Therefore
//! `force = F_t H_t / H` holds without knowing the object: `F_t` and `H_t` are the readings of the tables, `H` is the indentation
//! measured by the hand. On balls of 5 mm radius or more it is 1 to 5 % low from 8 kPa on (a dome of 9 x 7 mm with a wall of 1 mm),
//! and 6 to 17 % low at a light touch. On a plate tilted by 20 degrees it is 23 % low; pressure and indentation cannot distinguish
//! such a plate from a ball.

use super::Reading;
use super::law::{BlendLaw, Touched, WEIGHT_BITS};
use crate::units::{Micronewtons, Nanometres, PressureRise};

/// Uncertainty of the law `F H = F_t H_t`: one standard deviation is the force divided by this.
const PRODUCT: i32 = 16;
/// Uncertainty of a blend: one standard deviation is the indentation divided by this.
const BLEND: i32 = 64;
/// Below this part of the tables' last rise, the differences between objects are smaller than the errors of the tables. As a shift.
const LIGHT: u32 = 7;
/// Largest radius that can be distinguished from a plate, micrometres.
const LARGEST: i32 = 1_000_000;
/// Curvature times radius: 1/km times micrometres.
const PER_KILOMETRE: i32 = 1_000_000_000;

/// Cases in which the result is not valid, one bit each.
pub mod doubts {
    /// The touch is light: force up to 17 % low, curvature unknown.
    pub const LIGHT: u16 = 1;
    /// The indentation is less than that of a plate by more than its standard deviation: a cup, friction, or a wrong indentation.
    pub const SHALLOW: u16 = 2;
    /// Curved more than the tightest ball that was solved: the curvature is a lower bound.
    pub const TIGHT: u16 = 4;
}

/// A reading at one pressure.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct ReadPair {
    /// Force.
    pub force: Micronewtons,
    /// Its 1-sigma.
    pub force_sigma: Micronewtons,
    /// Indentation.
    pub indentation: Nanometres,
    /// Its 1-sigma.
    pub indentation_sigma: Nanometres,
}

/// The contact from a known indentation.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct KnownContact {
    /// Force without any curvature.
    pub force: Micronewtons,
    /// Its 1-sigma, from the reading and the law. The hand must add the error of the known indentation, percent for percent.
    pub force_sigma: Micronewtons,
    /// Curvature of the touched object, 1/km: 1e9 over the radius in micrometres; 0: flat.
    pub curvature: i32,
    /// Its 1-sigma.
    pub curvature_sigma: i32,
    /// [`doubts`].
    pub doubts: u16,
}

/// `F_t H_t / H`, and its 1-sigma; `known` above 0.
fn force(read: &ReadPair, known: i32) -> [i32; 2] {
    let known = i64::from(known.max(1));
    // Below 2^62 each.
    let scaled =
        |force: i32, indentation: i32| held(i64::from(force).saturating_mul(i64::from(indentation)) / known);
    let force = scaled(read.force.0, read.indentation.0);
    // Pressure moves both the same way.
    let sigma = scaled(read.force_sigma.0, read.indentation.0)
        .saturating_add(scaled(read.force.0, read.indentation_sigma.0));
    [force, hypotenuse(sigma, force / PRODUCT).max(1)]
}

/// The curvature of the ball that has this indentation at the pressure where a plate and the reference object have those, 1/km, and
/// whether it is a lower bound. Flat where the indentation is that of a plate or less.
fn curvature(law: &BlendLaw, plate: i32, reference: i32, known: i32) -> (i32, bool) {
    let apart = i64::from(reference) - i64::from(plate);
    if apart == 0 || law.least[0] <= 0 {
        return (0, false);
    }
    // Of a reference that is a cup the weights of balls are below 0.
    let sign = apart.signum();
    let weight = sign * (((i64::from(known) - i64::from(plate)) << WEIGHT_BITS) / apart);
    let weight_of = |radius: i32| {
        law.weights(Touched::Ball(radius))
            .map_or(0, |weights| sign * i64::from(weights.indentation))
    };
    let least = law.least[0].clamp(1, LARGEST);
    if weight > weight_of(least) {
        return (PER_KILOMETRE / least, true);
    }
    if weight <= weight_of(LARGEST) {
        return (0, false);
    }
    // Weights do not grow with the radius.
    let (mut tighter, mut wider) = (least, LARGEST);
    while wider - tighter > 1 {
        let middle = i32::midpoint(tighter, wider);
        if weight_of(middle) >= weight {
            tighter = middle;
        } else {
            wider = middle;
        }
    }
    (PER_KILOMETRE / tighter, false)
}

/// The rise up to `last` at which a lookup, which never falls, reads an indentation: that of a settled wall.
fn rise_at(
    lookup: impl Fn(PressureRise) -> Reading,
    last: PressureRise,
    indentation: Nanometres,
) -> PressureRise {
    let (mut below, mut above) = (0, last.0.max(0));
    while below < above {
        let middle = i32::midpoint(below, above);
        if lookup(PressureRise(middle)).indentation < indentation {
            below = middle + 1;
        } else {
            above = middle;
        }
    }
    PressureRise(below)
}

/// Tables of one design, for what a known indentation tells: each reads a pressure rise.
#[derive(Clone, Copy, Debug)]
pub struct Lookups<T, P, B> {
    /// Lookup of the object that is touched now.
    pub touched: T,
    /// Its last rise, and that of the plate's tables.
    pub last: [PressureRise; 2],
    /// The plate.
    pub plate: P,
    /// The reference ball.
    pub ball: B,
}

impl<T, P, B> Lookups<T, P, B>
where
    T: Fn(PressureRise) -> Reading,
    P: Fn(PressureRise) -> Reading,
    B: Fn(PressureRise) -> Reading,
{
    /// The contact from a known indentation, above 0, and a reading through the touched object's tables.
    pub fn tell(&self, law: &BlendLaw, read: &ReadPair, known: Nanometres) -> KnownContact {
        let [force, force_sigma] = force(read, known.0);
        let rise = rise_at(&self.touched, self.last[0], read.indentation);
        let [plate, ball] = [(self.plate)(rise), (self.ball)(rise)].map(|reading| reading.indentation.0);
        let sigma = hypotenuse(read.indentation_sigma.0, known.0 / BLEND).max(1);
        let of = |known: i32| curvature(law, plate, ball, known);
        let (middle, tight) = of(known.0);
        let [less, more] =
            [known.0.saturating_sub(sigma), known.0.saturating_add(sigma)].map(|known| of(known).0);
        KnownContact {
            force: Micronewtons(force),
            force_sigma: Micronewtons(force_sigma),
            curvature: middle,
            curvature_sigma: (more - middle).max(middle - less).max(1),
            doubts: bit(doubts::LIGHT, rise.0 < self.last[1].0 >> LIGHT)
                | bit(doubts::SHALLOW, known.0 < plate.saturating_sub(sigma))
                | bit(doubts::TIGHT, tight),
        }
    }
}

const fn bit(bit: u16, set: bool) -> u16 {
    if set { bit } else { 0 }
}

fn held(value: i64) -> i32 {
    value.clamp(0, i64::from(i32::MAX)) as i32
}

/// `sqrt(a^2 + b^2)` for `a, b >= 0`.
fn hypotenuse(a: i32, b: i32) -> i32 {
    let (a, b) = (a.unsigned_abs(), b.unsigned_abs());
    // Below 2^63.
    let squares = u64::from(a) * u64::from(a) + u64::from(b) * u64::from(b);
    squares.isqrt().min(i32::MAX as u64) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Weights `w = t = (8 + 2) / (R + 2)` of balls from 3 mm.
    const LAW: BlendLaw = BlendLaw {
        reference: 8_000,
        offset: 2_000,
        least: [3_000, 0],
        last: [1 << 20; 2],
        force: [[1 << 12, 0, 0]; 2],
        indentation: [[1 << 12, 0, 0]; 2],
    };
    const LAST: i32 = 1 << 20;

    /// Straight tables: a plate of 1 nm a count, a reference ball of 1.5.
    fn straight(times: i32) -> impl Fn(PressureRise) -> Reading {
        move |rise: PressureRise| Reading {
            force: Micronewtons(rise.0.clamp(0, LAST)),
            indentation: Nanometres(rise.0.clamp(0, LAST) / 2 * times),
            ..Reading::default()
        }
    }

    fn tell(read: &ReadPair, known: i32) -> KnownContact {
        let lookups = Lookups {
            touched: straight(2),
            last: [PressureRise(LAST); 2],
            plate: straight(2),
            ball: straight(3),
        };
        lookups.tell(&LAW, read, Nanometres(known))
    }

    const READ: ReadPair = ReadPair {
        force: Micronewtons(400_000),
        force_sigma: Micronewtons(4_000),
        indentation: Nanometres(400_000),
        indentation_sigma: Nanometres(400),
    };

    #[test]
    fn the_force_is_that_of_the_product_and_the_curvature_that_of_the_law() {
        // At 400 000 counts: plate 0.4 mm, reference ball of 8 mm 0.6 mm.
        let plate = tell(&READ, 400_000);
        assert_eq!((plate.force.0, plate.curvature, plate.doubts), (400_000, 0, 0));
        // 1 % and 0.1 % of the reading, 1/16 of the law.
        assert!((plate.force_sigma.0 - 25_384).abs() < 10, "{plate:?}");
        let ball = tell(&READ, 600_000);
        assert_eq!((ball.force.0, ball.doubts), (266_666, 0));
        // 8 mm: 125 000 / km, to a weight of 1/1024.
        assert!((ball.curvature - 125_000).abs() < 300, "{ball:?}");
        assert!(
            ball.curvature_sigma > 3_000 && ball.curvature_sigma < 9_000,
            "{ball:?}"
        );
        // t = 10 / 14.5.
        let wide = tell(&READ, 400_000 + 137_931);
        assert!((wide.curvature - 80_000).abs() < 300, "{wide:?}");
    }

    #[test]
    fn what_does_not_hold_is_marked() {
        assert_eq!(tell(&READ, 380_000).doubts, doubts::SHALLOW);
        let tight = tell(&READ, 900_000);
        assert_eq!((tight.doubts, tight.curvature), (doubts::TIGHT, 333_333));
        let light = ReadPair {
            force: Micronewtons(8_000),
            indentation: Nanometres(8_000),
            ..READ
        };
        assert_eq!(tell(&light, 8_000).doubts & doubts::LIGHT, doubts::LIGHT);
    }

    proptest! {
        #[test]
        fn nothing_overflows(numbers in prop::array::uniform4(0..=i32::MAX), known in 1..=i32::MAX) {
            let [force, force_sigma, indentation, indentation_sigma] = numbers;
            let told = tell(&ReadPair {
                force: Micronewtons(force),
                force_sigma: Micronewtons(force_sigma),
                indentation: Nanometres(indentation),
                indentation_sigma: Nanometres(indentation_sigma),
            }, known);
            prop_assert!(told.force.0 >= 0 && told.force_sigma.0 > 0);
            prop_assert!(told.curvature >= 0 && told.curvature_sigma > 0);
        }

        /// A deeper press for the same pressure is a tighter ball and less force.
        #[test]
        fn deeper_is_tighter(known in 400_000..800_000_i32, more in 0..100_000_i32) {
            let (one, other) = (tell(&READ, known), tell(&READ, known + more));
            prop_assert!(other.curvature >= one.curvature && other.force <= one.force);
        }
    }
}
