//! A campaign of random designs: does every state come out right, or is it refused for a reason that holds?
//!
//! [`draw`](draw::case) a design -> [`judge`](judge::judge) its states by virtual work and by a second discretisation
//! -> [`Tally`].

pub mod blends;
pub mod draw;
pub mod grasps;
pub mod judge;
pub mod lives;
pub mod object_cost;
pub mod objects;
pub mod scaling;
pub mod solids;
pub mod walls;

use draw::Case;
use judge::{Judged, Verdict};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// Judges `count` designs drawn from `seed` on every core; `progress` is called with the number done.
///
/// The result does not depend on the number of cores.
pub fn run(seed: u64, count: u64, progress: impl Fn(u64) + Sync) -> Vec<(Case, Vec<Judged>)> {
    let next = AtomicU64::new(0);
    let done = AtomicU64::new(0);
    let cores = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
    let work = || {
        let mut results = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break results;
            }
            let case = draw::case(seed, index);
            let judged = judge::judge(&case);
            results.push((case, judged));
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        }
    };
    let mut results: Vec<(Case, Vec<Judged>)> = std::thread::scope(|scope| {
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
    results.sort_by_key(|(case, _)| case.index);
    results
}

/// How many states came to what.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// States that converged and passed both judges.
    pub converged: u64,
    /// States given with a warning: their law is not stable at their stretches.
    pub warned: u64,
    /// Those among them that fail a judge.
    pub contradicted: u64,
    /// States refused, by reason.
    pub refused: BTreeMap<&'static str, u64>,
    /// States that failed a judge, by judge.
    pub wrong: BTreeMap<&'static str, u64>,
    /// Largest error by virtual work among the states that passed, over the force.
    pub worst_work: f64,
    /// Largest difference from the second discretisation among them, relative.
    pub worst_second: f64,
}

impl Tally {
    /// Counts the verdicts.
    pub fn of<'a>(verdicts: impl IntoIterator<Item = &'a Judged>) -> Self {
        let mut tally = Self::default();
        for judged in verdicts {
            match judged.verdict {
                Verdict::Warned(contradicted) => {
                    tally.warned += 1;
                    tally.contradicted += u64::from(contradicted.is_some());
                }
                Verdict::Converged => {
                    tally.converged += 1;
                    tally.worst_work = tally.worst_work.max(judged.work_error);
                    tally.worst_second = tally.worst_second.max(judged.second_error);
                }
                Verdict::Refused(reason) => *tally.refused.entry(reason).or_default() += 1,
                Verdict::Wrong(judge) => *tally.wrong.entry(judge).or_default() += 1,
            }
        }
        tally
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let refused: u64 = self.refused.values().sum();
        let wrong: u64 = self.wrong.values().sum();
        writeln!(f, "states     {}", self.converged + self.warned + refused + wrong)?;
        writeln!(
            f,
            "converged  {} (virtual work within {:.1e}, second discretisation within {:.1e})",
            self.converged, self.worst_work, self.worst_second
        )?;
        writeln!(
            f,
            "warned     {}: their law is not stable at their stretches (a judge contradicts {})",
            self.warned, self.contradicted
        )?;
        writeln!(f, "refused    {refused}")?;
        for (reason, count) in &self.refused {
            writeln!(f, "  {count:>6}  {reason}")?;
        }
        writeln!(f, "wrong      {wrong}")?;
        for (judge, count) in &self.wrong {
            writeln!(f, "  {count:>6}  {judge}")?;
        }
        Ok(())
    }
}
