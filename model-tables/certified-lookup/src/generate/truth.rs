//! The curve at every count, fast: local polynomials through exact evaluations, with the error they add.

use super::bounds::{Polynomial, Range, compose};
use super::{CurvePair, CurvePoint};

/// Inputs below this many counts are evaluated exactly, one by one.
const EXACT: i32 = 64;
/// Blocks an octave of the input is cut into, beyond that.
const BLOCKS_PER_OCTAVE: i32 = 32;
/// Relative deviation of a polynomial from the curve above which its block is cut in two: around the knots of the curve, whose
/// pieces are smooth.
const CLOSE: f64 = 1e-7;
/// Nodes of a block's polynomial: degree five.
const NODES: usize = 6;
/// Chebyshev points of [-1, 1]: `cos((2 i + 1) pi / 12)`, increasing.
const CHEBYSHEV: [f64; NODES] = [
    -0.965_925_826_289_068_3,
    -0.707_106_781_186_547_5,
    -0.258_819_045_102_520_74,
    0.258_819_045_102_520_74,
    0.707_106_781_186_547_5,
    0.965_925_826_289_068_3,
];

/// Consecutive counts with one polynomial.
pub(super) struct Block {
    /// First count.
    start: i32,
    /// Counts to map: the place of a count is `2 (count - start) / width - 1`.
    width: f64,
    /// Both outputs in their units: powers of the place, constant term first.
    powers: [[f64; NODES]; 2],
}

/// Both outputs in their units at every count of `0..=maximum`.
pub(super) struct Truth {
    exact: Vec<[f64; 2]>,
    blocks: Vec<Block>,
    /// A count is `2^-fraction_bits` of the input's unit.
    pub(super) fraction_bits: u32,
    /// Last count.
    pub(super) maximum: i32,
    /// Both outputs at the end. The last count may be slightly above the end.
    pub(super) full_scale: [f64; 2],
}

impl Truth {
    /// Prepares the curve at counts of `2^-fraction_bits`, up to `maximum`; full scale is at `end`.
    pub(super) fn new(curve: &impl CurvePair, end: CurvePoint, fraction_bits: u32, maximum: i32) -> Self {
        let at = exactly(curve, fraction_bits);
        let exact = (0..EXACT.min(maximum + 1))
            .map(|count| at(f64::from(count)))
            .collect();
        let mut blocks = Vec::new();
        let mut octave = EXACT;
        while octave <= maximum {
            let step = (octave / BLOCKS_PER_OCTAVE).max(1);
            let mut start = octave;
            while start < octave.saturating_mul(2) && start <= maximum {
                Block::cover(start, step.min(maximum - start).max(1), &at, &mut blocks);
                start = start.saturating_add(step);
            }
            octave = octave.saturating_mul(2);
        }
        Self {
            exact,
            blocks,
            fraction_bits,
            maximum,
            full_scale: end.outputs,
        }
    }

    /// Largest deviation of a polynomial from the curve, relative to the curve, at the points farthest from its
    /// nodes.
    pub(super) fn deviation(&self, curve: &impl CurvePair) -> f64 {
        let at = exactly(curve, self.fraction_bits);
        let mut deviation = 0.0_f64;
        for block in &self.blocks {
            deviation = deviation.max(block.deviation(&at));
        }
        deviation
    }

    /// Both outputs in their units at a count.
    pub(super) fn at(&self, count: i32) -> [f64; 2] {
        if let Some(&value) = self.exact.get(count.max(0) as usize) {
            return value;
        }
        let block = self.blocks.partition_point(|block| block.start <= count) - 1;
        self.blocks[block].at(count)
    }

    /// The counts in order: those evaluated exactly, then a range for each polynomial.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (Range, Piece<'_>)> {
        let exact = Range {
            first: 0,
            last: self.exact.len() as i32 - 1,
        };
        let blocks = self.blocks.iter().enumerate().map(|(i, block)| {
            let end = self.blocks.get(i + 1).map_or(self.maximum + 1, |next| next.start);
            let range = Range {
                first: block.start,
                last: end - 1,
            };
            (range, Piece::Polynomial(block))
        });
        std::iter::once((exact, Piece::Exact(&self.exact))).chain(blocks)
    }
}

/// The curve over consecutive counts.
#[derive(Clone, Copy)]
pub(super) enum Piece<'a> {
    /// From zero on, count by count.
    Exact(&'a [[f64; 2]]),
    /// A polynomial.
    Polynomial(&'a Block),
}

impl Piece<'_> {
    /// Both outputs in their units at one of its counts.
    #[inline]
    pub(super) fn at(&self, count: i32) -> [f64; 2] {
        match self {
            Self::Exact(values) => values[count as usize],
            Self::Polynomial(block) => block.at(count),
        }
    }
}

impl Block {
    /// Blocks that are [`CLOSE`] over `counts` inputs from `start` on.
    fn cover(start: i32, counts: i32, at: &impl Fn(f64) -> [f64; 2], blocks: &mut Vec<Self>) {
        let width = f64::from(counts);
        let values = CHEBYSHEV.map(|z| at(f64::from(start) + 0.5 * width * (z + 1.0)));
        let block = Self {
            start,
            width,
            powers: [0, 1].map(|output| powers(values.map(|value| value[output]))),
        };
        if counts > 1 && block.deviation(at) > CLOSE {
            let half = counts / 2;
            Self::cover(start, half, at, blocks);
            Self::cover(start + half, counts - half, at, blocks);
        } else {
            blocks.push(block);
        }
    }

    /// Largest relative deviation at the points farthest from the nodes.
    fn deviation(&self, at: &impl Fn(f64) -> [f64; 2]) -> f64 {
        let mut deviation = 0.0_f64;
        for z in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let truth = at(f64::from(self.start) + 0.5 * self.width * (z + 1.0));
            for (powers, value) in self.powers.iter().zip(truth) {
                deviation = deviation.max((evaluate(powers, z) / value - 1.0).abs());
            }
        }
        deviation
    }

    /// An output over a range of its counts, in the place within that range.
    pub(super) fn over(&self, output: usize, range: Range) -> Polynomial {
        let place = |count: i32| 2.0 * f64::from(count - self.start) / self.width - 1.0;
        let first = place(range.first);
        compose(&self.powers[output], first, place(range.last) - first)
    }

    #[inline]
    fn at(&self, count: i32) -> [f64; 2] {
        let z = 2.0 * f64::from(count - self.start) / self.width - 1.0;
        [evaluate(&self.powers[0], z), evaluate(&self.powers[1], z)]
    }
}

/// The curve itself at a count.
fn exactly(curve: &impl CurvePair, fraction_bits: u32) -> impl Fn(f64) -> [f64; 2] {
    let unit = libm::ldexp(1.0, -(fraction_bits as i32));
    move |count| curve.at(count * unit)
}

#[inline]
fn evaluate(powers: &[f64; NODES], z: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, &power| sum * z + power)
}

/// Coefficients of the polynomial through `values` at [`CHEBYSHEV`]: Newton's divided differences, expanded.
fn powers(values: [f64; NODES]) -> [f64; NODES] {
    let mut differences = values;
    for level in 1..NODES {
        for i in (level..NODES).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (CHEBYSHEV[i] - CHEBYSHEV[i - level]);
        }
    }
    let mut powers = [0.0; NODES];
    for i in (0..NODES).rev() {
        // powers := powers (z - node) + difference
        for j in (1..NODES).rev() {
            powers[j] = powers[j - 1] - CHEBYSHEV[i] * powers[j];
        }
        powers[0] = differences[i] - CHEBYSHEV[i] * powers[0];
    }
    powers
}
