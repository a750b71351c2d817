//! Quoted results of objects that are not solved here: tilted plates, and friction.
//!
//! Finite elements of a dome of 9 x 7 mm with a wall of 1 mm of Agilus30, unstretched, full of incompressible fluid: 27-node
//! elements for tilts, axisymmetric ones for friction. The same figures are used for other domes; for friction, at the same ratio
//! of depth to height.

/// Largest tilt of a band, degrees.
pub const MAX_TILT: f64 = 20.0;

/// Tilts of a plate, degrees, with what a plate's table reads over the true normal force, less one: least and most over depths of
/// 0.5 to 2.5 mm.
const TILTS: [(f64, [f64; 2]); 4] = [
    (0.0, [0.0, 0.0]),
    (5.0, [-0.013, -0.003]),
    (10.0, [-0.049, -0.015]),
    (MAX_TILT, [-0.18, -0.07]),
];
/// True force times true indentation over the table's, at the largest tilt.
const TILTED_PRODUCT: f64 = 1.3;

/// True force over a plate table's at the same pressure, by depth over the dome's height, with a friction coefficient of 0.3: at 5,
/// 10, 30, 50 and 80 kPa. The largest found of any friction is the last.
const FRICTION: [(f64, f64); 6] = [
    (0.124, 1.0 / 0.970),
    (0.167, 1.0 / 0.972),
    (0.254, 1.0 / 1.006),
    (0.303, 1.0 / 1.037),
    (0.353, 1.0 / 1.071),
    (0.43, 0.90),
];
/// Pressure at one depth over that without friction, less one, at this depth over the height; and how it grows with the depth: 13 % at
/// 2.5 mm, 26 % at 3 mm.
const STIFFENED: f64 = 0.13;
const STIFFENED_AT: f64 = 2.5 / 7.0;
const STIFFENED_POWER: f64 = 3.8;
/// At a light touch: the product's own solid that sticks to a plate, of that dome.
const STIFFENED_LIGHT: f64 = 0.011;

/// Linear between the rows of a table, held at its ends.
fn between(rows: &[(f64, f64)], at: f64) -> f64 {
    let after = rows.partition_point(|row| row.0 < at);
    match (after.checked_sub(1).and_then(|i| rows.get(i)), rows.get(after)) {
        (Some(low), Some(high)) => low.1 + (high.1 - low.1) * (at - low.0) / (high.0 - low.0),
        (Some(only), None) | (None, Some(only)) => only.1,
        (None, None) => f64::NAN,
    }
}

/// True normal force of a tilted plate over that of the plate's table at the same pressure: least and most. `degrees` 0 to
/// [`MAX_TILT`].
pub fn tilted_force(degrees: f64) -> [f64; 2] {
    [1, 0].map(|end| 1.0 / (1.0 + between(&TILTS.map(|(tilt, errors)| (tilt, errors[end])), degrees)))
}

/// True force times true indentation of a tilted plate over the table's: by the square of the tilt, as its force.
pub fn tilted_product(degrees: f64) -> f64 {
    1.0 + (TILTED_PRODUCT - 1.0) * (degrees / MAX_TILT) * (degrees / MAX_TILT)
}

/// True force of a plate with friction over that of the table at the same pressure, at a depth over the dome's height.
pub fn rubbed_force(depth: f64) -> f64 {
    between(&FRICTION, depth)
}

/// Pressure of a plate with friction over that of one without, at a depth over the dome's height.
pub fn rubbed_pressure(depth: f64) -> f64 {
    let deep = STIFFENED * libm::pow(depth / STIFFENED_AT, STIFFENED_POWER);
    1.0 + deep.max(STIFFENED_LIGHT)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The figures as they are quoted.
    #[test]
    fn figures_are_those_quoted() {
        let hundredths = |ratio: f64| libm::round(1e4 * (1.0 / ratio - 1.0)) as i32;
        assert_eq!(tilted_force(20.0).map(hundredths), [-700, -1_800]);
        assert_eq!(tilted_force(5.0).map(hundredths), [-30, -130]);
        assert_eq!(tilted_force(0.0).map(hundredths), [0, 0]);
        assert!((tilted_product(20.0) - 1.3).abs() < 1e-12);
        assert_eq!(hundredths(rubbed_force(0.353)), 710);
        assert_eq!(hundredths(rubbed_force(0.01)), -300);
        // 26 % at 3 mm of 7.
        assert!((rubbed_pressure(3.0 / 7.0) - 1.26).abs() < 0.005);
    }
}
