//! The gauge of a lying cylindrical tank: pressure at the bottom -> litres of fuel, and free surface.
//!
//! Radius 0.4 m, length 1.5 m, density 840 kg/m^3, filled from a sump of 20 mm on (below it a gauge shows nothing), to 0.38 m: the
//! surface grows to the middle and no further.

use certified_lookup::generate::{AccuracyGoal, CurvePair, CurvePoint, NoTables, tables};

/// Metres.
const RADIUS: f64 = 0.4;
/// Metres.
const LENGTH: f64 = 1.5;
/// Height where the gauge begins, metres.
const SUMP: f64 = 0.02;
/// Height where it ends, metres.
const FULL: f64 = 0.38;
/// Pascals a metre: density times gravity.
const PASCALS_PER_METRE: f64 = 840.0 * 9.80665;

struct Tank;

/// Volume below a height, cubic metres: a segment of a circle times the length.
fn volume(height: f64) -> f64 {
    let above = RADIUS - height;
    let half_width = (RADIUS * RADIUS - above * above).sqrt();
    LENGTH * (RADIUS * RADIUS * (above / RADIUS).acos() - above * half_width)
}

/// Free surface at a height, square metres.
fn surface(height: f64) -> f64 {
    let above = RADIUS - height;
    2.0 * LENGTH * (RADIUS * RADIUS - above * above).sqrt()
}

impl CurvePair for Tank {
    /// Pascals above the sump -> millilitres and square millimetres above the sump.
    fn at(&self, pascals: f64) -> [f64; 2] {
        let height = SUMP + pascals / PASCALS_PER_METRE;
        [
            1e6 * (volume(height) - volume(SUMP)),
            1e6 * (surface(height) - surface(SUMP)),
        ]
    }

    fn points(&self) -> Vec<CurvePoint> {
        let last = (FULL - SUMP) * PASCALS_PER_METRE;
        let place = |input| CurvePoint {
            input,
            outputs: self.at(input),
        };
        (1..=200).map(|i| place(last * f64::from(i) / 200.0)).collect()
    }
}

fn main() -> Result<(), NoTables> {
    let points = Tank.points();
    let end = points[points.len() - 1];
    println!("percent asked  bytes  instructions  litres: proven %  falls  surface: proven %  falls");
    for percent in [1.0, 0.3, 0.1] {
        let goal = AccuracyGoal {
            percent_of_reading: [percent; 2],
            from_percent_of_full_scale: 1.0,
        };
        // A gauge that tells 2 Pa apart.
        let made = tables(&Tank, end, &goal, 2.0)?;
        let [litres, surface] = &made.proof.outputs;
        println!(
            "{percent:13} {:6} {:13} {:17.4} {:6} {:18.4} {:6}",
            made.tables.bytes(),
            made.tables.instructions(),
            litres.of_reading.max,
            litres.falling_steps,
            surface.of_reading.max,
            surface.falling_steps
        );
    }
    Ok(())
}
