//! What every method does over the cells of a map.

use crate::methods::bisection::{Bisection, PAPER};
use crate::methods::shooting::Shooting;
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::AGILUS30;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::{FULL, Press};
use model_tables::object::Object;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A method on trial: anything that gives a force or a refusal joins here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// This project's, membrane relaxed.
    Collocation,
    /// Shooting with Newton's method.
    Shooting,
    /// The source paper's nested bisection.
    Bisection,
}

pub(super) const METHODS: [Method; 3] = [Method::Collocation, Method::Shooting, Method::Bisection];
/// Tolerance of the shooting.
const SHOOTING: f64 = 1e-8;

impl Method {
    /// For files.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Collocation => "collocation",
            Self::Shooting => "shooting",
            Self::Bisection => "bisection",
        }
    }

    /// For people.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Collocation => "Collocation (this project)",
            Self::Shooting => "Shooting with Newton's method, 1e-8",
            Self::Bisection => "Nested bisection (the paper's way)",
        }
    }

    /// Force and whether compression is declared, or the refusal.
    fn force(self, design: &Design, indentation: f64) -> Result<(f64, bool), String> {
        match self {
            Self::Collocation => {
                let mut press = Press::new(design, TensionField::Relaxed).map_err(|e| e.to_string())?;
                let state = press.at_indentation(indentation).map_err(|e| e.to_string())?;
                Ok((state.force, false))
            }
            Self::Shooting => {
                let mut method = Shooting::new(design, SHOOTING).map_err(|e| e.to_string())?;
                let found = method.at_indentation(indentation).map_err(|e| e.to_string())?;
                Ok((found.force, found.compressed))
            }
            Self::Bisection => {
                let mut method = Bisection::new(design, PAPER).map_err(|e| e.to_string())?;
                let found = method.at_indentation(indentation).map_err(|e| e.to_string())?;
                Ok((found.force, found.compressed))
            }
        }
    }
}

/// What a method did with a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The force within 1e-6 of the truth.
    Exact,
    /// Within 1 %.
    Coarse,
    /// Within 1 % of a membrane that pushes, which it declares, and further off one that wrinkles.
    Declared,
    /// Refused, though there is a state.
    Refused,
    /// Refused, and the model knows of none.
    NoState,
    /// A number more than 1 % off, or one where the model knows of no state, without the refusal it calls for.
    Silent,
}

pub(super) const VERDICTS: [Verdict; 6] = [
    Verdict::Exact,
    Verdict::Coarse,
    Verdict::Declared,
    Verdict::Refused,
    Verdict::NoState,
    Verdict::Silent,
];

impl Verdict {
    /// For files.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Coarse => "coarse",
            Self::Declared => "compressed-and-declared",
            Self::Refused => "refused",
            Self::NoState => "no-state",
            Self::Silent => "silently-wrong",
        }
    }
}

/// Within this of the truth is exact.
const EXACT: f64 = 1e-6;
/// Within this is coarse.
const COARSE: f64 = 1e-2;

/// What a map runs over to the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Across {
    /// Axial over radial semi-axis; pressed to half the limit.
    Aspect,
    /// Indentation over the limit, logarithmic.
    Indentation,
    /// `C2 / C1` of a Mooney-Rivlin law; pressed to half the limit.
    MooneyRatio,
    /// `C2 / C1` of a Yeoh law with `C3 = 0.002 C1`; pressed to half the limit.
    YeohRatio,
}

/// A map: something to the right, pole stretch upward.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    /// For files.
    pub(super) name: &'static str,
    /// For people.
    pub(super) title: &'static str,
    /// The axis to the right.
    pub(super) words: &'static str,
    pub(super) across: Across,
    /// First and last value.
    pub(super) range: [f64; 2],
    pub(super) columns: usize,
}

/// Cells upward.
pub(super) const ROWS: usize = 16;
/// Pole stretch over 1, from bottom to top.
pub(super) const STRETCH: [f64; 2] = [0.002, 2.0];

pub(super) const MAPS: [Chart; 4] = [
    Chart {
        name: "aspect",
        title: "Agilus30, 9 mm radius, 1 mm wall, pressed to half its limit",
        words: "axial over radial semi-axis",
        across: Across::Aspect,
        range: [0.3, 2.0],
        columns: 18,
    },
    Chart {
        name: "indentation",
        title: "Agilus30, 9 x 7 mm, 1 mm wall",
        words: "indentation over the limit (beyond 1 there is no state)",
        across: Across::Indentation,
        range: [1e-4, 1.6],
        columns: 18,
    },
    Chart {
        name: "mooney-rivlin",
        title: "Mooney-Rivlin, 6 x 9 mm, 0.5 mm wall, pressed to half its limit",
        words: "C2 / C1",
        across: Across::MooneyRatio,
        range: [-0.25, 0.6],
        columns: 18,
    },
    Chart {
        name: "yeoh",
        title: "Yeoh with C3 = 0.002 C1, 6 x 6 mm, 0.5 mm wall, pressed to half its limit",
        words: "C2 / C1",
        across: Across::YeohRatio,
        range: [-0.12, 0.08],
        columns: 18,
    },
];

impl Chart {
    /// The value at the middle of a column.
    pub(super) fn value(&self, column: usize) -> f64 {
        let part = (column as f64 + 0.5) / self.columns as f64;
        let [low, high] = self.range;
        match self.across {
            Across::Indentation => low * libm::pow(high / low, part),
            _ => low + (high - low) * part,
        }
    }

    /// The design of a cell, and its indentation over the limit.
    fn design(&self, value: f64, stretch: f64) -> (Design, f64) {
        let c1 = 100e3;
        let (radial, axial, thickness, law, part) = match self.across {
            Across::Aspect => (9e-3, 9e-3 * value, 1e-3, AGILUS30, 0.5),
            Across::Indentation => (9e-3, 7e-3, 1e-3, AGILUS30, value),
            Across::MooneyRatio => (6e-3, 9e-3, 0.5e-3, Law::MooneyRivlin { c1, c2: c1 * value }, 0.5),
            Across::YeohRatio => {
                let law = Law::Yeoh {
                    c1,
                    c2: c1 * value,
                    c3: 2e-3 * c1,
                };
                (6e-3, 6e-3, 0.5e-3, law, 0.5)
            }
        };
        let design = Design {
            membrane: Membrane {
                radial_semi_axis: radial,
                axial_semi_axis: axial,
                thickness,
            },
            law,
            rest: RestBy::PoleStretch(stretch),
            compliance: 0.0,
            object: Object::PLATE,
        };
        (design, part)
    }
}

/// Pole stretch at the middle of a row.
pub(super) fn stretch(row: usize) -> f64 {
    let part = (row as f64 + 0.5) / ROWS as f64;
    1.0 + STRETCH[0] * libm::pow(STRETCH[1] / STRETCH[0], part)
}

/// A cell: where it is and what became of it.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) column: usize,
    pub(super) row: usize,
    indentation: f64,
    /// Force of the wrinkling and of the pushing membrane, where there are such states.
    truth: [Option<f64>; 2],
    pub(super) verdicts: [Verdict; METHODS.len()],
    forces: [Option<f64>; METHODS.len()],
    messages: [String; METHODS.len()],
}

/// A surveyed map.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    pub(super) chart: Chart,
    pub(super) stride: usize,
    pub(super) cells: Vec<Cell>,
}

/// The truth: other Gauss points on twice the mesh.
const TRUTH: Resolution = Resolution {
    density: 2.0 * FULL.density,
    contact_elements: 2 * FULL.contact_elements,
    tolerance: FULL.tolerance,
    last_term: FULL.last_term,
};
/// Indentation over the axial semi-axis at which methods are tried where the design has no state.
const TRIAL: f64 = 0.3;

/// Force of the truth at an indentation, if there is a state.
fn truth(design: &Design, field: TensionField, indentation: f64) -> Option<f64> {
    let mut press = Press::<Law, 4>::with_resolution(design, field, TRUTH).ok()?;
    press.contact_at(indentation).ok().map(|contact| contact.force)
}

fn judge(chart: &Chart, column: usize, row: usize) -> Cell {
    let (design, part) = chart.design(chart.value(column), stretch(row));
    let limit = Press::new(&design, TensionField::Relaxed)
        .and_then(|mut press| press.limit())
        .map_or(TRIAL * design.membrane.axial_semi_axis, |limit| limit.indentation);
    let indentation = part * limit;
    let truth = [TensionField::Relaxed, TensionField::Plain].map(|field| truth(&design, field, indentation));
    let answers = METHODS.map(|method| method.force(&design, indentation));
    let verdicts = core::array::from_fn(|i| {
        let near = |force: f64, truth: Option<f64>, tolerance: f64| {
            truth.is_some_and(|truth| (force / truth - 1.0).abs() < tolerance)
        };
        match answers[i] {
            Err(_) if truth[0].is_some() => Verdict::Refused,
            Err(_) => Verdict::NoState,
            Ok((force, _)) if near(force, truth[0], EXACT) => Verdict::Exact,
            Ok((force, _)) if near(force, truth[0], COARSE) => Verdict::Coarse,
            Ok((force, true)) if near(force, truth[1], COARSE) => Verdict::Declared,
            Ok(_) => Verdict::Silent,
        }
    });
    Cell {
        column,
        row,
        indentation,
        truth,
        verdicts,
        forces: core::array::from_fn(|i| answers[i].as_ref().ok().map(|answer| answer.0)),
        messages: core::array::from_fn(|i| answers[i].as_ref().err().cloned().unwrap_or_default()),
    }
}

impl Survey {
    /// Surveys a map on every core.
    pub(super) fn new(chart: &Chart, stride: usize, progress: impl Fn(usize, usize) + Sync) -> Self {
        let places: Vec<(usize, usize)> = (0..ROWS)
            .step_by(stride)
            .flat_map(|row| {
                (0..chart.columns)
                    .step_by(stride)
                    .map(move |column| (column, row))
            })
            .collect();
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let work = || {
            let mut cells = Vec::new();
            while let Some(&(column, row)) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
                cells.push(judge(chart, column, row));
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, places.len());
            }
            cells
        };
        let cores = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
        let mut cells: Vec<Cell> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
            threads
                .into_iter()
                .flat_map(|thread| {
                    thread
                        .join()
                        .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
                })
                .collect()
        });
        cells.sort_by_key(|cell| (cell.row, cell.column));
        Self {
            chart: *chart,
            stride,
            cells,
        }
    }

    /// Cells of each verdict, by method.
    pub(super) fn counts(&self) -> [[usize; VERDICTS.len()]; METHODS.len()] {
        core::array::from_fn(|method| {
            VERDICTS.map(|verdict| {
                self.cells
                    .iter()
                    .filter(|c| c.verdicts[method] == verdict)
                    .count()
            })
        })
    }

    /// A row a cell and method.
    pub(super) fn csv(&self) -> String {
        let mut text = String::from(
            "x,pole_stretch,indentation_mm,true_force_n,true_force_if_pushing_n,method,verdict,force_n,refusal\n",
        );
        let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.12e}"));
        for cell in &self.cells {
            for (i, method) in METHODS.iter().enumerate() {
                let _ = writeln!(
                    text,
                    "{},{},{:.12e},{},{},{},{},{},\"{}\"",
                    self.chart.value(cell.column),
                    stretch(cell.row),
                    cell.indentation * 1e3,
                    number(cell.truth[0]),
                    number(cell.truth[1]),
                    method.name(),
                    cell.verdicts[i].word(),
                    number(cell.forces[i]),
                    cell.messages[i].replace('"', "'")
                );
            }
        }
        text
    }
}
