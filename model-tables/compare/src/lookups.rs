//! Other ways to look two curves up, as they are commonly written, for comparison with [`model_tables::table`]: nothing here is on the
//! signal path.
//!
//! Each writes force and indentation at one pressure rise, in its own units. Where a way allows it both share the search, as
//! they do in [`model_tables::table`]; the closed-form and the fixed-point ones are functions of a library that gives one output.
//! `designer chart --tables` fits them and measures their errors; the chip's emulator counts the instructions of these very
//! functions.

/// The knots on either side of `x` in 12.20 bits, or the value that holds beyond an end.
#[inline]
fn beside<T: Copy + Default>(knots: &[T], x: i32) -> Result<[T; 2], T> {
    let index = (x >> 20) as usize;
    let (Some(&first), Some(&last)) = (knots.first(), knots.last()) else {
        return Err(T::default());
    };
    if x < 0 {
        return Err(first);
    }
    match (knots.get(index), knots.get(index + 1)) {
        (Some(&low), Some(&high)) => Ok([low, high]),
        _ => Err(last),
    }
}

/// `arm_linear_interp_q31` of CMSIS-DSP, twice: evenly spaced knots, the input as knot and fraction in 12.20 bits.
#[inline]
pub fn uniform_q31(knots: [&[i32]; 2], x: i32, out: &mut [i32; 2]) {
    for (out, knots) in out.iter_mut().zip(knots) {
        *out = one_q31(knots, x);
    }
}

#[inline]
fn one_q31(knots: &[i32], x: i32) -> i32 {
    let [low, high] = match beside(knots, x) {
        Ok(both) => both,
        Err(end) => return end,
    };
    let fraction = (x & 0xf_ffff) << 11;
    let sum = ((i64::from(low) * i64::from(0x7fff_ffff - fraction)) >> 32) as i32;
    let sum = sum + ((i64::from(high) * i64::from(fraction)) >> 32) as i32;
    sum << 1
}

/// `arm_linear_interp_q15` of CMSIS-DSP, twice.
#[inline]
pub fn uniform_q15(knots: [&[i16]; 2], x: i32, out: &mut [i16; 2]) {
    for (out, knots) in out.iter_mut().zip(knots) {
        *out = one_q15(knots, x);
    }
}

#[inline]
fn one_q15(knots: &[i16], x: i32) -> i16 {
    let [low, high] = match beside(knots, x) {
        Ok(both) => both,
        Err(end) => return end,
    };
    let fraction = i64::from(x & 0xf_ffff);
    ((i64::from(low) * (0xf_ffff - fraction) + i64::from(high) * fraction) >> 20) as i16
}

/// The two knots around `x`, by bisection of their first numbers.
#[inline]
fn around<const N: usize>(knots: &[[f32; N]], x: f32) -> Option<[&[f32; N]; 2]> {
    let (mut low, mut high) = (0, knots.len().checked_sub(1)?);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if knots.get(middle)?[0] <= x {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some([knots.get(low)?, knots.get(high)?])
}

/// Straight lines between knots anywhere: `[x, force, indentation]`.
#[inline]
pub fn linear_f32(knots: &[[f32; 3]], x: f32, out: &mut [f32; 2]) {
    if let Some([a, b]) = around(knots, x) {
        let t = (x - a[0]) / (b[0] - a[0]);
        *out = [a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t];
    }
}

/// Cubics between knots anywhere, as PCHIP evaluates them: `[x, force, its slope, indentation, its slope]`.
#[inline]
pub fn cubic_f32(knots: &[[f32; 5]], x: f32, out: &mut [f32; 2]) {
    if let Some([a, b]) = around(knots, x) {
        let (width, along) = (b[0] - a[0], x - a[0]);
        let t = along / width;
        for (out, at) in out.iter_mut().zip([1, 3]) {
            let secant = (b[at] - a[at]) / width;
            let third = a[at + 1] + b[at + 1] - 2.0 * secant;
            let second = secant - a[at + 1] - third;
            *out = a[at] + along * (a[at + 1] + t * (second + t * third));
        }
    }
}

/// Straight lines between knots `[force, indentation]` evenly spaced in the square root of `x`, `scale` a unit of it.
#[inline]
pub fn warped_f32(knots: &[[f32; 2]], scale: f32, x: f32, out: &mut [f32; 2]) {
    let place = scale * libm::sqrtf(x);
    let index = (place as usize).min(knots.len().saturating_sub(2));
    if let (Some(a), Some(b)) = (knots.get(index), knots.get(index + 1)) {
        let t = place - index as f32;
        *out = [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
    }
}

/// Polynomials an octave of `x + bias`, of degree `N - 1` in the mantissa (a fraction of 2^31, 1 to 2 stands for 0 to 1), the
/// constant terms first; `first` is the number of leading zeros of the first segment.
#[inline]
pub fn octave_i32<const N: usize>(
    segments: &[[[i32; N]; 2]],
    bias: u32,
    first: u32,
    x: i32,
    out: &mut [i32; 2],
) {
    let y = (x.max(0) as u32).wrapping_add(bias);
    let zeros = y.leading_zeros();
    // The leading one shifted out, the rest a fraction of 2^31.
    let place = (y.wrapping_shl(zeros) & 0x7fff_ffff) as i32;
    let index = (zeros.wrapping_sub(first) as usize).min(segments.len().saturating_sub(1));
    if let Some(segment) = segments.get(index) {
        for (out, coefficients) in out.iter_mut().zip(segment) {
            let mut sum = 0;
            for &coefficient in coefficients.iter().rev() {
                sum = coefficient.wrapping_add(((i64::from(sum) * i64::from(place)) >> 31) as i32);
            }
            *out = sum;
        }
    }
}

/// `z (a + b z + c z^2) / (1 + d z + e z^2)` with `z = sqrt(x)`, twice with one root.
#[inline]
pub fn rational_f32(both: &[[f32; 5]; 2], x: f32, out: &mut [f32; 2]) {
    let z = libm::sqrtf(x);
    for (out, [a, b, c, d, e]) in out.iter_mut().zip(both) {
        *out = z * (a + z * (b + z * c)) / (1.0 + z * (d + z * e));
    }
}

/// `factor x^power`, twice, with the power function of a library.
#[inline]
pub fn power_f32(both: &[[f32; 2]; 2], power: impl Fn(f32, f32) -> f32, x: f32, out: &mut [f32; 2]) {
    for (out, &[factor, exponent]) in out.iter_mut().zip(both) {
        *out = factor * power(x, exponent);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fixed_point_ones_are_lines_between_their_knots() {
        let knots = [0, 1 << 30, 1 << 29];
        let mut out = [0; 2];
        for (x, expected) in [
            (1 << 19, 1 << 29),
            ((1 << 20) + (1 << 18), 7 * (1 << 27)),
            (5 << 20, 1 << 29),
            (-1, 0),
        ] {
            uniform_q31([&knots, &knots], x, &mut out);
            assert!(
                out.iter().all(|&found: &i32| (found - expected).abs() <= 4),
                "{x}: {out:?}"
            );
        }
        let knots = [0, 1 << 14, 1 << 13];
        let mut out = [0; 2];
        uniform_q15([&knots, &knots], 1 << 19, &mut out);
        assert!(out.iter().all(|&found: &i16| (found - (1 << 13)).abs() <= 1));
    }

    #[test]
    fn the_others_give_back_what_they_can_hold() {
        let mut out = [0.0; 2];
        let near = |found: f32, truth: f32| assert!((found - truth).abs() < 1e-5, "{found} for {truth}");
        linear_f32(
            &[[0.0, 0.0, 1.0], [1.0, 2.0, 1.0], [4.0, 5.0, 7.0]],
            2.5,
            &mut out,
        );
        near(out[0], 3.5);
        near(out[1], 4.0);
        // x^3 and 2 x^3 with their own slopes.
        let cube = |x: f32| [x, x * x * x, 3.0 * x * x, 2.0 * x * x * x, 6.0 * x * x];
        cubic_f32(&[cube(0.0), cube(1.0), cube(2.0)], 1.5, &mut out);
        near(out[0], 3.375);
        near(out[1], 6.75);
        // The root itself and twice it.
        warped_f32(&[[0.0, 0.0], [1.0, 2.0], [2.0, 4.0]], 1.0, 2.25, &mut out);
        near(out[0], 1.5);
        near(out[1], 3.0);
        rational_f32(
            &[[1.0, 2.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.5, 0.0]],
            4.0,
            &mut out,
        );
        near(out[0], 10.0);
        near(out[1], 1.0);
        power_f32(&[[2.0, 1.5], [1.0, 0.5]], libm::powf, 4.0, &mut out);
        near(out[0], 16.0);
        near(out[1], 2.0);
    }

    /// Force `= x` and indentation `= 2 x`, on 0 ..= 11 in two octaves of `x + 4`: 4 + 4 t and 8 + 8 t less 4.
    #[test]
    fn an_octave_is_a_segment() {
        let segments = [[[4, 8], [8, 16]], [[0, 4], [0, 8]]];
        let mut out = [0; 2];
        for x in 0..12 {
            octave_i32(&segments, 4, 28, x, &mut out);
            assert_eq!(out, [x, 2 * x]);
        }
    }
}
