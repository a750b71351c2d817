//! What a state onto a ball costs beside one onto a plate: the shipped domes, by the membrane and by the solid 2 x 60.
//!
//! Plate and balls are pressed to the same depths in turn, in one process; of the time that the thread ran, the fastest sweep counts.

use model_tables::design::Design;
use model_tables::design_file::{Axes, DesignFile};
use model_tables::model::choice::FINE;
use model_tables::model::{Fingertip, Kind, ModelError};
use model_tables::object::{Friction, Object, Shape};
use std::fmt;
use std::time::Instant;

/// Radii of the balls, millimetres.
pub const BALLS: [f64; 3] = [5.0, 8.0, 20.0];
/// Head of the table of [`ObjectCosts`], whose rows follow the name of the design.
pub const HEAD: &str = "| design | model | object | Newton iterations | factorisations | a state, ms | over the plate |\n|---|---|---|---|---|---|---|\n";
/// States of a sweep, evenly spaced, and the deepest over the design's largest indentation.
const STATES: usize = 25;

/// The states of one sweep.
#[derive(Clone, Copy, Debug)]
pub struct StateCost {
    /// Radius of the ball, millimetres; `None` for the plate.
    pub radius_mm: Option<f64>,
    /// Newton iterations per state.
    pub iterations: f64,
    /// Factorisations per state; of a membrane as many as iterations.
    pub factorisations: f64,
    /// Time of a state, seconds.
    pub seconds: f64,
}

/// Plate and balls of one design and model, the plate first.
#[derive(Clone, Debug)]
pub struct ObjectCosts {
    /// The model.
    pub kind: Kind,
    /// Each object.
    pub costs: Vec<StateCost>,
}

impl ObjectCosts {
    /// Iterations, factorisations and time of the ball that costs most, over those of the plate.
    pub fn largest(&self) -> [f64; 3] {
        let of = |cost: &StateCost| [cost.iterations, cost.factorisations, cost.seconds];
        let plate = of(&self.costs[0]);
        self.costs.iter().skip(1).map(of).fold([0.0; 3], |most, cost| {
            core::array::from_fn(|i| most[i].max(cost[i] / plate[i]))
        })
    }
}

/// Time that this thread ran, seconds: of the scheduler where it has that, or else of the clock.
fn seconds_of_thread(since: Instant) -> f64 {
    // Brings the scheduler's figure up to date.
    std::thread::yield_now();
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| since.elapsed().as_secs_f64(), |nanoseconds| 1e-9 * nanoseconds)
}

fn spent(tip: &Fingertip) -> [u64; 2] {
    match tip {
        Fingertip::Membrane(press) => [press.iterations(); 2],
        Fingertip::Solid(press) => [press.iterations(), press.factorisations()],
    }
}

/// A design by one model, `sweeps` times; nothing where the model has no rest state for it.
///
/// # Errors
/// [`ModelError`] of a state.
pub fn measure(design: &DesignFile, kind: Kind, sweeps: usize) -> Result<Option<ObjectCosts>, ModelError> {
    let outer = design.design_to(Axes::Outer);
    if !kind.applies(&outer) {
        return Ok(None);
    }
    let deepest = 1e-3 * design.max_indentation_mm.unwrap_or(2.0);
    let radii = std::iter::once(None).chain(BALLS.map(Some));
    let mut objects = Vec::new();
    for radius_mm in radii {
        let shape = radius_mm.map_or(Shape::Plate, |radius: f64| Shape::Ball {
            radius: 1e-3 * radius,
        });
        let object = Object {
            shape,
            friction: Friction::NONE,
        };
        let rest = Fingertip::of(kind, &Design { object, ..outer })?;
        let cost = StateCost {
            radius_mm,
            iterations: 0.0,
            factorisations: 0.0,
            seconds: f64::INFINITY,
        };
        objects.push((rest, cost));
    }
    let clock = Instant::now();
    for _ in 0..sweeps {
        for (rest, cost) in &mut objects {
            let mut tip = rest.clone();
            let before = seconds_of_thread(clock);
            for k in 1..=STATES {
                tip.contact_at(deepest * k as f64 / STATES as f64)?;
            }
            let seconds = seconds_of_thread(clock) - before;
            cost.seconds = cost.seconds.min(seconds / STATES as f64);
            let [from, to] = [spent(rest), spent(&tip)];
            let each = |i: usize| (to[i] - from[i]) as f64 / STATES as f64;
            (cost.iterations, cost.factorisations) = (each(0), each(1));
        }
    }
    Ok(Some(ObjectCosts {
        kind,
        costs: objects.into_iter().map(|(_, cost)| cost).collect(),
    }))
}

/// A design by the membrane and by the solid 2 x 60.
///
/// # Errors
/// [`ModelError`] of a state.
pub fn measure_both(design: &DesignFile, sweeps: usize) -> Result<Vec<ObjectCosts>, ModelError> {
    let mut found = Vec::new();
    for kind in [Kind::Membrane, Kind::Solid(FINE)] {
        found.extend(measure(design, kind, sweeps)?);
    }
    Ok(found)
}

/// Rows of a table: iterations, factorisations and time of each object, the last over the plate's.
impl fmt::Display for ObjectCosts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plate = self.costs[0];
        for cost in &self.costs {
            let object = cost
                .radius_mm
                .map_or_else(|| "plate".to_owned(), |radius| format!("ball {radius} mm"));
            writeln!(
                f,
                "| {} | {object} | {:.1} | {:.1} | {:.2} | {:.2} |",
                self.kind,
                cost.iterations,
                cost.factorisations,
                1e3 * cost.seconds,
                cost.seconds / plate.seconds
            )?;
        }
        Ok(())
    }
}
