//! What each stage adds to the error of a reading, one budget a design: `host-tests/BUDGET.md`.
//!
//! Bounds (model, table, conversion) are largest errors; the others are standard deviations. The sum is that of the bounds and
//! the root of the sum of the others' squares.

use fingertip::signal::uncertainty::averaged;
use fingertip::signal::zero::estimator::WINDOW;
use model_tables::generate::Generated;
use model_tables::table::ContactLookup as _;
use model_tables::table::Reading;
use model_tables::units::PressureRise;
use std::fmt::Write as _;

/// Shares of the full indentation at which a reading's errors are stated.
pub const PLACES: [f64; 3] = [0.05, 0.25, 1.0];

/// What one stage adds.
#[derive(Clone, Debug)]
pub struct BudgetTerm {
    /// The stage.
    pub name: &'static str,
    /// Where the figure comes from.
    pub source: &'static str,
    /// Error of the pressure, pascals; `None` where it is not an error of the pressure.
    pub pascals: Option<f64>,
    /// A largest error; else a standard deviation.
    pub bound: bool,
    /// Percent of reading of force and indentation at the [`PLACES`].
    pub percent: [[f64; 2]; PLACES.len()],
}

/// The terms of a design.
#[derive(Clone, Debug)]
pub struct Budget {
    /// The design.
    pub name: String,
    /// The stages in the order of the signal path, the model first.
    pub terms: Vec<BudgetTerm>,
}

impl Budget {
    /// The budget of a design, with its zero measured on the untouched fingertip and no drift since.
    pub fn of(generated: &Generated) -> Self {
        let rises = PLACES.map(|place| {
            let wanted = place * generated.end.indentation * 1e9;
            rise_where(generated, |reading| f64::from(reading.indentation.0) >= wanted)
        });
        Self::at(generated, rises)
    }

    /// The same at other rises, counts.
    pub fn at(generated: &Generated, rises: [i32; PLACES.len()]) -> Self {
        let tables = &generated.certified.tables;
        let transducer = &generated.transducer;
        let constants = generated.transducer();
        let bits = tables.layout.fraction_bits;
        // Percent of reading that a pascal is worth, from the tables over a hundredth of the rise on either side.
        let sensitivity = rises.map(|rise| {
            let near = (rise / 100).max(1);
            let read = |rise: i32| {
                let reading = tables.contact_at(PressureRise(rise));
                [f64::from(reading.force.0), f64::from(reading.indentation.0)]
            };
            let above = (rise + near).min(tables.layout.maximum);
            let (low, middle, high) = (read(rise - near), read(rise), read(above));
            let pascals = PressureRise(above - rise + near).pascals(bits);
            [0, 1].map(|output| 100.0 * (high[output] - low[output]) / pascals / middle[output])
        });
        let of_pressure = |name, source, bound, pascals: f64| BudgetTerm {
            name,
            source,
            pascals: Some(pascals),
            bound,
            percent: sensitivity.map(|both| both.map(|percent| percent * pascals)),
        };
        let of_reading = |name, source, force: f64, indentation: f64| BudgetTerm {
            name,
            source,
            pascals: None,
            bound: true,
            percent: [[force, indentation]; PLACES.len()],
        };
        let averaged = f64::from(averaged(&constants.kind));
        let window = (WINDOW / u64::from(constants.kind.period())) as f64;
        // Steps are uniform: 1 / sqrt 12 of one.
        let step = transducer.resolution_pa / 12.0_f64.sqrt();
        let sample = transducer.noise_pa / averaged.sqrt();
        let certificate = &generated.certified.certificate;
        let mut terms = Vec::new();
        if let Some(model) = &generated.model_error {
            terms.push(of_reading(
                "model, against a finer mesh",
                "measured",
                model.force_percent,
                model.indentation_percent,
            ));
        }
        terms.push(of_reading(
            "table",
            "measured, every input",
            certificate.force.of_reading.max,
            certificate.indentation.of_reading.max,
        ));
        terms.push(of_pressure("resolution", "design file", false, step));
        // The kernel 1-2-1 over 4 leaves 6/16 of the variance.
        terms.push(of_pressure(
            "noise, averaged and filtered",
            "design file, derived",
            false,
            sample * 6.0_f64.sqrt() / 4.0,
        ));
        let count = PressureRise(1).pascals(bits);
        terms.push(of_pressure(
            "conversion to counts",
            "derived",
            true,
            0.5e-3 + 0.5 * count,
        ));
        terms.push(of_pressure(
            "tare: its noise and step",
            "derived",
            false,
            (sample / window.sqrt()).hypot(step),
        ));
        Self {
            name: generated.design.name.clone(),
            terms,
        }
    }

    /// One standard deviation of the pressure rise that is read, pascals: what is no bound.
    pub fn pressure(&self) -> f64 {
        let squares = self.terms.iter().filter(|term| !term.bound);
        squares
            .filter_map(|term| Some(term.pascals?.powi(2)))
            .sum::<f64>()
            .sqrt()
    }

    /// The sum for force and indentation at a place, percent of reading: the bounds and one standard deviation.
    pub fn sum(&self, place: usize) -> [f64; 2] {
        [0, 1].map(|output| {
            let of = |bound: bool| {
                let terms = self.terms.iter().filter(move |term| term.bound == bound);
                terms.map(move |term| term.percent[place][output])
            };
            of(true).sum::<f64>() + of(false).map(|percent| percent * percent).sum::<f64>().sqrt()
        })
    }
}

/// The count at which the tables reach something, by bisection: they never fall.
pub(crate) fn rise_where(generated: &Generated, reached: impl Fn(Reading) -> bool) -> i32 {
    let tables = &generated.certified.tables;
    let (mut low, mut high) = (0, tables.layout.maximum);
    while low < high {
        let middle = low + (high - low) / 2;
        if reached(tables.contact_at(PressureRise(middle))) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// The page.
pub fn markdown(budgets: &[Budget]) -> String {
    let mut text = "# Error budgets\n\
         \n\
         The tables list the error of each stage of a reading, in percent of the force (F) and the indentation (H), at 5, 25 and\n\
         100 % of the full indentation. `UPDATE_EXPECT=1 cargo test --package host-tests --test golden` writes this page; the same\n\
         test fails when it is stale. *max* is a largest error, *sd* one standard deviation. The sum adds the largest errors and the\n\
         root of the sum of the squares of the others. The zero was measured untouched, without drift or change of temperature since.\n\
         The difference between model and real dome is not included; a calibration corrects for it.\n"
        .to_owned();
    for budget in budgets {
        let _ = write!(
            text,
            "\n## {}\n\n| stage | from | | Pa | F at 5 % | H | F at 25 % | H | F at 100 % | H |\n|---|---|---|---|---|---|---|---|---|---|\n",
            budget.name
        );
        let cells = |percent: &[f64; 2]| format!("{:.4} | {:.4}", percent[0], percent[1]);
        for term in &budget.terms {
            let percent: Vec<String> = term.percent.iter().map(cells).collect();
            let pascals = term
                .pascals
                .map_or(String::new(), |pascals| format!("{pascals:.3}"));
            let _ = writeln!(
                text,
                "| {} | {} | {} | {pascals} | {} |",
                term.name,
                term.source,
                if term.bound { "max" } else { "sd" },
                percent.join(" | ")
            );
        }
        let sums: Vec<String> = (0..PLACES.len()).map(|place| cells(&budget.sum(place))).collect();
        let _ = writeln!(
            text,
            "| **sum** | | | {:.3} | {} |",
            budget.pressure(),
            sums.join(" | ")
        );
    }
    text
}
