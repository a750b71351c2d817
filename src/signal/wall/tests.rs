use super::*;
use crate::signal::design::Parameters;
use crate::signal::test_design::Linear;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::material::relaxation::{Relaxation, Term};
use model_tables::material::series::SeriesStep;
use model_tables::table::Reading;

/// The straight lines with a wall that relaxes a tenth in 2 s, or as Agilus30.
struct InTime(Linear, WallSeries);

impl InTime {
    fn of(series: &Relaxation) -> Self {
        let wall = WallSeries {
            step: SeriesStep::over(series, 1e-3),
            remaining_permille: 30,
            fluid_least: 0,
            fluid_half: 4_000 << 8,
            weight_gain: 1 << 16,
            weight_half: 1_000 << 8,
            retouch: 0,
            temperature_gain: 0,
        };
        Self(Linear::NEW, wall)
    }

    fn mild() -> Self {
        let term = |time, weight| Term { time, weight };
        Self::of(&Relaxation::new(
            &[term(0.05, 0.04), term(0.5, 0.06), term(5.0, 0.05)],
            20.0,
            0.0,
        ))
    }

    fn agilus30() -> Self {
        Self::of(&model_tables::material::relaxation::AGILUS30_RELAXATION)
    }
}

impl Design for InTime {
    type Wall = Memory<8>;
    type Around = [Surroundings; 1];

    fn parameters(&self) -> &Parameters {
        self.0.parameters()
    }

    fn series(&self) -> Option<&WallSeries> {
        Some(&self.1)
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        self.0.lookup(rise)
    }
}

/// A rise of so many pascals.
fn rise(millisecond: u64, pascals: i32) -> Rise {
    Rise {
        time: Microseconds(millisecond * 1000),
        rise: PressureRise(pascals << 8),
        sigma: PressureRise(700),
        warnings: Warnings::NONE,
    }
}

/// Pressed at an even rate to 20 kPa in 1 s, held to 11 s, and released to 500 Pa below rest.
fn grasp(millisecond: u64) -> i32 {
    match millisecond {
        0..1_000 => 20 * millisecond as i32,
        1_000..11_000 => 20_000,
        11_000..12_000 => 20_000 - 20 * (millisecond as i32 - 11_000),
        _ => -500,
    }
}

#[test]
fn an_elastic_wall_reads_as_the_tables_do() {
    let rise = Rise {
        warnings: Warnings::ZERO_AGED,
        ..rise(1, 4_000)
    };
    let at = contact(&Linear::NEW, rise.rise, rise.warnings);
    let sigma = through_tables(&Linear::NEW, rise.rise, &at, rise.sigma);
    assert_eq!(Elastic.read(&Linear::NEW, rise), (at, sigma));
    // What is loaded has room for a memory, and none without a series.
    let mut memory = Memory::<8>::NEW;
    assert_eq!(memory.read(&Linear::NEW, rise), (at, sigma));
}

#[test]
fn from_untouched_rest_on_the_past_is_known() {
    let design = InTime::agilus30();
    let mut memory = Memory::<8>::NEW;
    let mut stage = Relaxing::<8>::NEW;
    for millisecond in 0..12_000 {
        let rise = rise(millisecond, grasp(millisecond));
        let (read, _) = memory.read(&design, rise);
        let alone = stage.step(&design, &design.1, rise.rise);
        assert_eq!(read, alone.contact, "{millisecond} ms");
        assert!(!memory.open);
    }
}

/// A reset in a hold: what the wall really reads stays within what is reported, and that narrows.
#[test]
fn after_a_reset_in_a_grasp_two_states_bracket_the_wall() {
    for design in [InTime::mild(), InTime::agilus30()] {
        let (mut sound, mut reset) = (Memory::<8>::NEW, Memory::<8>::NEW);
        let mut first = None;
        let mut last = 0;
        for millisecond in 0..11_000 {
            let rise = rise(millisecond, grasp(millisecond));
            let (truth, _) = sound.read(&design, rise);
            if millisecond < 7_000 {
                continue;
            }
            let (read, sigma) = reset.read(&design, rise);
            let error = (i64::from(read.indentation.0) - i64::from(truth.indentation.0)).abs();
            assert!(
                error <= i64::from(sigma.indentation.0) * 11 / 10,
                "{millisecond} ms: {error} nm with {sigma:?}"
            );
            if first.is_none() {
                assert!(read.warnings.contains(Warnings::PAST_UNKNOWN), "{read:?}");
            }
            first = first.or(Some(sigma.indentation.0));
            last = sigma.indentation.0;
        }
        assert!(
            first.is_some_and(|first| last < first / 2 * 19 / 10),
            "{first:?} {last}"
        );
    }
}

#[test]
fn of_a_wall_that_hardly_relaxes_the_bracket_closes() {
    let design = InTime::mild();
    let mut memory = Memory::<8>::NEW;
    for millisecond in 7_000..90_000 {
        memory.read(&design, rise(millisecond, 20_000));
    }
    assert!(!memory.open);
}

/// Up to twenty missing reports lie on a line; more are a past that is not known.
#[test]
fn a_short_gap_is_crossed_and_a_long_one_is_not() {
    let design = InTime::agilus30();
    let (mut sound, mut gappy) = (Memory::<8>::NEW, Memory::<8>::NEW);
    for millisecond in 0..2_000 {
        let rise = rise(millisecond, grasp(millisecond));
        let (truth, _) = sound.read(&design, rise);
        if (501..520).contains(&millisecond) {
            continue;
        }
        let (read, _) = gappy.read(&design, rise);
        assert_eq!(read, truth, "{millisecond} ms");
    }
    let (read, sigma) = gappy.read(&design, rise(2_021, 20_000));
    assert!(gappy.open && read.warnings.contains(Warnings::PAST_UNKNOWN));
    assert!(sigma.indentation.0 > 1_000_000, "{sigma:?}");
}

#[test]
fn what_was_clipped_is_not_known() {
    let design = InTime::agilus30();
    let mut memory = Memory::<8>::NEW;
    memory.read(&design, rise(1, 10_000));
    assert!(memory.open);
    memory.read(&design, rise(2, 0));
    let mut memory = Memory::<8>::NEW;
    memory.read(&design, rise(1, 0));
    assert!(!memory.open);
    memory.lose_track();
    memory.read(&design, rise(2, 10_000));
    assert!(memory.open);
}

/// Left below its rest, it bears nothing, within three hundredths of what it bore, and says nothing of the zero.
#[test]
fn a_wall_that_recovers_bears_nothing_within_a_share_of_its_peak() {
    let design = InTime::agilus30();
    let mut memory = Memory::<8>::NEW;
    let mut peak = 0;
    for millisecond in 0..13_000 {
        let (read, sigma) = memory.read(&design, rise(millisecond, grasp(millisecond)));
        peak = peak.max(read.force.0);
        if millisecond > 12_000 {
            assert_eq!((read.force.0, read.warnings), (0, Warnings::RECOVERING));
            let share = f64::from(sigma.force.0) / f64::from(peak);
            assert!((0.029..0.032).contains(&share), "{share}");
            assert!(memory.lowers_the_pressure() && read.indentation.0 > 0);
        } else if millisecond < 11_000 {
            assert!(!memory.lowers_the_pressure());
        }
    }
}

/// The zero moved: the memory of the press stays, and the pressure it is measured by moves.
#[test]
fn a_zero_that_moves_is_no_press() {
    let design = InTime::agilus30();
    let (mut sound, mut shifted) = (Memory::<8>::NEW, Memory::<8>::NEW);
    for millisecond in 0..3_000 {
        let pascals = grasp(millisecond);
        let (truth, _) = sound.read(&design, rise(millisecond, pascals));
        let moved = if millisecond < 500 { 0 } else { -40 };
        if millisecond == 500 {
            shifted.shift(&design, PressureRise(-40 << 8));
        }
        let (read, _) = shifted.read(&design, rise(millisecond, pascals + moved));
        // 40 Pa are 10 240 nm of these tables.
        let apart = truth.indentation.0 - read.indentation.0;
        assert!((0..=10_240).contains(&apart), "{millisecond} ms: {apart} nm");
    }
}
