//! Limits the rate of saves: [`AT_ONCE`] saves at once, then one in each [`SLOWEST`]. The time is longer if the memory holds
//! fewer records. The memory then lasts ten years, whatever a client sends.
//!
//! There are two slots. A slot of `n` records endures [`ENDURANCE`] erasures. This gives `2 x 10 000 x n` saves. The
//! NUCLEO-L432KC has pages of 2 KB with 42 records each, thus 840 000 saves; ten years at one in 390 s are 809 024. The record
//! of a hand of five tips has 192 bytes, so a page holds 10, and a save of any of its tips is possible once in 26 minutes.
//!
//! Each record stores the debt at the time of its write. A start continues with that debt, after a reset and after a power cut.
//! A board that saves at every start therefore reaches the limit too. Only running time reduces the debt. The length of a run
//! that ends without a save is unknown, so such a run does not reduce it.

use crate::units::Microseconds;

/// Erasures that a slot endures: the specified minimum of flash (DS9405 table 49: 10 000 cycles).
pub const ENDURANCE: u32 = 10_000;

/// Number of saves that are possible at once.
pub const AT_ONCE: u32 = 20;

/// The budget's unit of time is `2^UNIT` microseconds: 2.1 s.
const UNIT: u32 = 21;

/// Time from one save to the next after the saves at once, microseconds, if a slot holds 39 records or more: 390 s.
pub const SLOWEST: u64 = 390_000_000;

/// Ten years of 365.25 days, in units.
const TEN_YEARS: u32 = (315_576_000_000_000_u64 >> UNIT) as u32;

/// Time from one save to the next after the saves at once, in units, for slots of `places` records.
const fn pause(places: u32) -> u32 {
    let lasting = TEN_YEARS / (2 * ENDURANCE * places - AT_ONCE) + 1;
    let slowest = (SLOWEST >> UNIT) as u32 + 1;
    if lasting > slowest { lasting } else { slowest }
}

/// The debt of saves, as time.
#[derive(Clone, Copy, Debug)]
pub(super) struct SaveBudget {
    pause: u32,
    /// Time until nothing is owed, in units.
    owed: u32,
    /// Time of the last update of `owed`, in units.
    at: u32,
}

impl SaveBudget {
    /// A budget for slots of `places` records, without debt.
    pub(super) const fn new(places: u32) -> Self {
        Self {
            pause: pause(places),
            owed: 0,
            at: 0,
        }
    }

    /// Starts at time 0 with the debt stored in the last record, and adds `cut` saves that were interrupted after it.
    pub(super) fn start(&mut self, owed: u32, cut: u32) {
        self.owed = (owed + cut * self.pause).min(AT_ONCE * self.pause);
    }

    /// Takes one save. Returns whether the budget allows it.
    pub(super) fn take(&mut self, now: Microseconds) -> bool {
        let now = (now.0 >> UNIT) as u32;
        self.owed = self.owed.saturating_sub(now.saturating_sub(self.at));
        self.at = now;
        if self.owed > (AT_ONCE - 1) * self.pause {
            return false;
        }
        self.owed += self.pause;
        true
    }

    /// The debt in units, to be stored in a record: at most 65 535.
    pub(super) const fn owed(&self) -> u32 {
        self.owed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fewest records in a slot: those of twelve tips, of 416 bytes, in a page of 2 KB.
    const FEWEST: u32 = 4;

    #[test]
    fn a_page_lasts_ten_years_of_saves_as_fast_as_they_are_taken() {
        for places in FEWEST..=400 {
            let saves = AT_ONCE + TEN_YEARS / pause(places);
            assert!(saves <= 2 * ENDURANCE * places, "{places}: {saves}");
            assert!(AT_ONCE * pause(places) <= 0xFFFF, "{places}");
        }
        // Typed: 2 x 10 000 x 42 = 840 000 of the L432KC, ten years / 390.07 s = 809 023.
        assert_eq!(TEN_YEARS / pause(42), 809_023);
    }

    #[test]
    fn twenty_at_once_then_one_in_six_and_a_half_minutes() {
        let mut budget = SaveBudget::new(42);
        assert_eq!((0..100).filter(|_| budget.take(Microseconds(0))).count(), 20);
        let hour = (0..3_600).filter(|second| budget.take(Microseconds(second * 1_000_000)));
        assert_eq!(hour.count(), 9);
        // Long afterwards there are twenty again, and no more.
        let late = Microseconds(1 << 50);
        assert_eq!((0..100).filter(|_| budget.take(late)).count(), 20);
    }

    #[test]
    fn a_start_owes_what_was_owed_and_every_save_that_was_cut() {
        let mut budget = SaveBudget::new(42);
        for _ in 0..3 {
            assert!(budget.take(Microseconds(0)));
        }
        let mut again = SaveBudget::new(42);
        again.start(budget.owed(), 2);
        assert_eq!((0..100).filter(|_| again.take(Microseconds(0))).count(), 15);
        let mut cut = SaveBudget::new(42);
        cut.start(0, 1000);
        assert!(!cut.take(Microseconds(389_000_000)));
        assert!(cut.take(Microseconds(392_000_000)));
    }
}
