//! A press in time against an independent finite-element code.

mod domes;

use domes::dome;
use model_tables::material::Law;
use model_tables::material::relaxation::{Relaxation, Term};
use model_tables::solid::history::{Drive, History, Instant};
use model_tables::solid::mesh::Elements;
use serde::Deserialize;
use std::f64::consts::TAU;

#[derive(Deserialize)]
struct Cases {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the names in the file")]
struct Case {
    id: String,
    design: CaseDesign,
    prony: Prony,
    t_s: Vec<f64>,
    H_mm: Vec<f64>,
    P_kPa: Vec<f64>,
    F_N: Vec<f64>,
    apex_depression_mm: Vec<f64>,
    H_breakpoints_t_s_H_mm: Option<Vec<[f64; 2]>>,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the names in the file")]
struct CaseDesign {
    outer_a_mm: f64,
    outer_b_mm: f64,
    wall_mm: f64,
    C1_relaxed_Pa: f64,
    C2_relaxed_Pa: f64,
}

#[derive(Deserialize)]
struct Prony {
    g: Vec<f64>,
    tau_s: Vec<f64>,
}

fn cases() -> Vec<Case> {
    let Cases { cases } =
        serde_json::from_str(include_str!("reference/relaxation.json")).expect("the file's form");
    assert!(cases.len() >= 10);
    cases
}

impl Case {
    fn history(&self, elements: Elements) -> History {
        let terms: Vec<Term> = self
            .prony
            .tau_s
            .iter()
            .zip(&self.prony.g)
            .map(|(&time, &weight)| Term { time, weight })
            .collect();
        let d = &self.design;
        let law = Law::MooneyRivlin {
            c1: d.C1_relaxed_Pa,
            c2: d.C2_relaxed_Pa,
        };
        History::new(
            &dome(d.outer_a_mm, d.outer_b_mm, d.wall_mm, law),
            &Relaxation::new(&terms, 20.0, 0.0),
            elements,
            self.t_s[0],
            0.0,
        )
        .expect("a wall at rest")
    }

    /// Where the plate turns between two times, the later one included.
    fn turns(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let mut turns: Vec<[f64; 2]> = match &self.H_breakpoints_t_s_H_mm {
            Some(points) => points
                .iter()
                .copied()
                .filter(|[t, _]| *t > from && *t < to)
                .collect(),
            // 1.2 mm in 1 s, then 0.5 mm about it at 1 Hz, in steps of 1/48 s.
            None => (1..=240)
                .map(|i| f64::from(i) / 48.0)
                .filter(|t| *t > from + 1e-6 && *t < to - 1e-6)
                .map(|t| {
                    [
                        t,
                        if t <= 1.0 {
                            1.2 * t
                        } else {
                            1.2 + 0.5 * (TAU * (t - 1.0)).sin()
                        },
                    ]
                })
                .collect(),
        };
        turns.push([to, f64::NAN]);
        turns
    }

    fn play(&self, elements: Elements) -> (Vec<Instant>, History) {
        let mut history = self.history(elements);
        let mut found = vec![history.now()];
        for i in 1..self.t_s.len() {
            for [t, h] in self.turns(self.t_s[i - 1], self.t_s[i]) {
                let h = if h.is_nan() { self.H_mm[i] } else { h };
                history.advance(t, Drive::Indentation(1e-3 * h)).expect("a state");
            }
            found.push(history.now());
        }
        (found, history)
    }
}

#[test]
fn compare() {
    let only = std::env::var("CASE").unwrap_or_default();
    for case in cases() {
        if !case.id.contains(&only) {
            continue;
        }
        let begin = std::time::Instant::now();
        let (found, history) = case.play(Elements {
            through: std::env::var("THROUGH")
                .ok()
                .and_then(|x| x.parse().ok())
                .unwrap_or(2),
            along: std::env::var("ALONG")
                .ok()
                .and_then(|x| x.parse().ok())
                .unwrap_or(24),
        });
        let spent = begin.elapsed().as_secs_f64();
        let largest = |x: &[f64]| x.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let (p, f) = (largest(&case.P_kPa), largest(&case.F_N));
        let mut worst = [(0.0, 0); 3];
        let mut lost = vec![];
        for (i, now) in found.iter().enumerate() {
            let errors = [
                (1e-3 * now.pressure_rise - case.P_kPa[i]) / p * 100.0,
                (now.force - case.F_N[i]) / f * 100.0,
                1e3 * now.apex_depression - case.apex_depression_mm[i],
            ];
            for k in 0..3 {
                if errors[k].abs() > f64::abs(worst[k].0) {
                    worst[k] = (errors[k], i);
                }
            }
            if i > 0 && now.in_contact() != (case.F_N[i] > 0.0) {
                lost.push((case.t_s[i], now.force, case.F_N[i]));
            }
            if std::env::var("ROWS").is_ok() {
                println!(
                    "{:.5} {:.4} | {:.4} {:.4} | {:.5} {:.5} | {:.4} {:.4}",
                    case.t_s[i],
                    case.H_mm[i],
                    1e-3 * now.pressure_rise,
                    case.P_kPa[i],
                    now.force,
                    case.F_N[i],
                    1e3 * now.apex_depression,
                    case.apex_depression_mm[i]
                );
            }
        }
        println!(
            "{} steps {} it {} fac {} {:.2} s: P {:+.3} % @{:.4} F {:+.3} % @{:.4} apex {:+.4} mm @{:.4}; contact {:?}",
            case.id,
            history.steps(),
            history.iterations(),
            history.factorisations(),
            spent,
            worst[0].0,
            case.t_s[worst[0].1],
            worst[1].0,
            case.t_s[worst[1].1],
            worst[2].0,
            case.t_s[worst[2].1],
            lost
        );
    }
}
