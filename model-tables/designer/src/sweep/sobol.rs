//! The Sobol sequence, in the order of its numbers (no Gray code): any point without those before it.

/// Coordinates that there are direction numbers for.
pub const MAX_DIMENSIONS: usize = 21;

/// Bits of a coordinate.
const BITS: usize = 32;

/// Degree, coefficients and first direction numbers of the coordinates from the second on: S. Joe and F. Y. Kuo, SIAM J.
/// Sci. Comput. 30 (2008) 2635, table `new-joe-kuo-6`.
const DIRECTIONS: [(usize, u32, [u32; 7]); MAX_DIMENSIONS - 1] = [
    (1, 0, [1, 0, 0, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0, 0, 0]),
    (4, 4, [1, 3, 5, 13, 0, 0, 0]),
    (5, 2, [1, 1, 5, 5, 17, 0, 0]),
    (5, 4, [1, 1, 5, 5, 5, 0, 0]),
    (5, 7, [1, 1, 7, 11, 19, 0, 0]),
    (5, 11, [1, 1, 5, 1, 1, 0, 0]),
    (5, 13, [1, 1, 1, 3, 11, 0, 0]),
    (5, 14, [1, 3, 5, 5, 31, 0, 0]),
    (6, 1, [1, 3, 3, 9, 7, 49, 0]),
    (6, 13, [1, 1, 1, 15, 21, 21, 0]),
    (6, 16, [1, 3, 1, 13, 27, 49, 0]),
    (6, 19, [1, 1, 1, 15, 7, 5, 0]),
    (6, 22, [1, 3, 1, 15, 13, 25, 0]),
    (6, 25, [1, 1, 5, 5, 19, 61, 0]),
    (7, 1, [1, 3, 7, 11, 23, 15, 103]),
    (7, 4, [1, 3, 7, 13, 13, 15, 69]),
];

/// Direction numbers of every coordinate, the first bit's highest.
const MATRICES: [[u32; BITS]; MAX_DIMENSIONS] = {
    let mut matrices = [[0_u32; BITS]; MAX_DIMENSIONS];
    let mut bit = 0;
    while bit < BITS {
        matrices[0][bit] = 1 << (BITS - 1 - bit);
        bit += 1;
    }
    let mut dimension = 1;
    while dimension < MAX_DIMENSIONS {
        let (degree, coefficients, first) = DIRECTIONS[dimension - 1];
        let mut bit = 0;
        while bit < BITS {
            matrices[dimension][bit] = if bit < degree {
                first[bit] << (BITS - 1 - bit)
            } else {
                let before = matrices[dimension][bit - degree];
                let mut direction = before ^ (before >> degree);
                let mut k = 1;
                while k < degree {
                    if coefficients >> (degree - 1 - k) & 1 == 1 {
                        direction ^= matrices[dimension][bit - k];
                    }
                    k += 1;
                }
                direction
            };
            bit += 1;
        }
        dimension += 1;
    }
    matrices
};

/// Coordinate `dimension` (0 to 20) of point `number`, in units of 2^-32.
pub fn coordinate(number: u32, dimension: usize) -> u32 {
    MATRICES[dimension]
        .iter()
        .enumerate()
        .filter(|(bit, _)| number >> bit & 1 == 1)
        .fold(0, |sum, (_, direction)| sum ^ direction)
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Points of `scipy.stats.qmc.Sobol(21, scramble=False, bits=32)` (`SciPy` 1.17.1), which goes in Gray code: its points
    /// 100 and 777 are 86 and 653 here.
    #[test]
    fn points_are_those_of_scipy() {
        let reference: [(u32, [u32; MAX_DIMENSIONS]); 2] = [
            (
                86,
                [
                    1_778_384_896,
                    1_107_296_256,
                    3_321_888_768,
                    3_120_562_176,
                    3_791_650_816,
                    3_187_671_040,
                    100_663_296,
                    2_046_820_352,
                    2_717_908_992,
                    2_986_344_448,
                    1_979_711_488,
                    2_919_235_584,
                    2_046_820_352,
                    3_657_433_088,
                    1_375_731_712,
                    2_113_929_216,
                    2_919_235_584,
                    3_187_671_040,
                    3_590_324_224,
                    1_442_840_576,
                    3_254_779_904,
                ],
            ),
            (
                653,
                [
                    2_973_761_536,
                    4_022_337_536,
                    700_448_768,
                    1_178_599_424,
                    2_730_491_904,
                    1_530_920_960,
                    817_889_280,
                    3_275_751_424,
                    1_497_366_528,
                    1_388_314_624,
                    3_200_253_952,
                    2_990_538_752,
                    1_648_361_472,
                    2_034_237_440,
                    2_445_279_232,
                    2_210_398_208,
                    1_732_247_552,
                    3_711_959_040,
                    1_589_641_216,
                    3_233_808_384,
                    1_019_215_872,
                ],
            ),
        ];
        for (number, point) in reference {
            for (dimension, expected) in point.into_iter().enumerate() {
                assert_eq!(
                    coordinate(number, dimension),
                    expected,
                    "point {number}, coordinate {dimension}"
                );
            }
        }
    }
}
