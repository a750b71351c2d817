use super::*;
use crate::signal::test_design::Linear;

#[test]
fn an_elastic_wall_reads_as_the_tables_do() {
    let rise = Rise {
        time: Microseconds(1_000),
        rise: PressureRise(4_000),
        sigma: PressureRise(700),
        warnings: Warnings::ZERO_AGED,
    };
    let at = contact(&Linear::NEW, rise.rise, rise.warnings);
    let sigma = through_tables(&Linear::NEW, rise.rise, &at, rise.sigma);
    assert_eq!(Elastic.read(&Linear::NEW, rise), (at, sigma));
    // What is loaded has room for a memory, and none without a series.
    let mut memory = Memory::<8>::NEW;
    assert_eq!(memory.read(&Linear::NEW, rise), (at, sigma));
}
