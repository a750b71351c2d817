//! Walls that are touched again before they have recovered: the chip's force beside the solid's, in time, on taps and on a press that is faster
//! than the one before.

use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::Relaxing;
use model_tables::design_file::DesignFile;
use model_tables::generate;
use model_tables::material::relaxation::MAX_TERMS;
use model_tables::material::series::WallSeries;
use model_tables::solid::history::{Drive, History};
use model_tables::solid::mesh::Elements;
use model_tables::units::PressureRise;

/// Of the chip, seconds.
const PERIOD: f64 = 1e-3;
const ELEMENTS: Elements = Elements {
    through: 2,
    along: 24,
};

/// A way there: until so many seconds, to so much of the depth, in steps of the solid of so many seconds.
type Way = [f64; 3];

/// Three taps of 0.15 s, twice a second.
const TAPS: [Way; 9] = [
    [0.075, 1.0, 3e-3],
    [0.15, 0.0, 3e-3],
    [0.5, 0.0, 0.01],
    [0.575, 1.0, 3e-3],
    [0.65, 0.0, 3e-3],
    [1.0, 0.0, 0.01],
    [1.075, 1.0, 3e-3],
    [1.15, 0.0, 3e-3],
    [1.5, 0.0, 0.01],
];
/// Pressed in 1 s, held, let go, and after 5 s pressed five times as fast.
const FASTER: [Way; 6] = [
    [1.0, 1.0, 0.01],
    [4.0, 1.0, 0.01],
    [4.3, 0.0, 5e-3],
    [9.0, 0.0, 0.02],
    [9.2, 1.0, 2e-3],
    [10.0, 1.0, 0.01],
];
/// Pressed and let go in 10 s, and after 7 s pressed in 1 s.
const SLOWER: [Way; 6] = [
    [10.0, 1.0, 0.1],
    [13.0, 1.0, 0.1],
    [23.0, 0.0, 0.1],
    [30.0, 0.0, 0.1],
    [31.0, 1.0, 0.01],
    [32.0, 1.0, 0.02],
];
/// After a grasp, tapped lightly.
const AFTER_A_GRASP: [Way; 7] = [
    [1.0, 1.0, 0.01],
    [3.0, 1.0, 0.01],
    [4.0, 0.0, 0.01],
    [6.0, 0.0, 0.02],
    [6.075, 0.7, 3e-3],
    [6.15, 0.0, 3e-3],
    [6.5, 0.0, 0.01],
];
/// After a grasp, touched lightly and held.
const HELD: [Way; 7] = [
    [1.0, 1.0, 0.01],
    [4.0, 1.0, 0.01],
    [5.0, 0.0, 0.01],
    [15.0, 0.0, 0.05],
    [15.5, 0.6, 0.01],
    [25.0, 0.6, 0.1],
    [200.0, 0.6, 1.0],
];

/// Most that the force may be off, percent of the peak before, of the five; the same of a tall dome whose wall is a sixth of its radius; and
/// at the end of the hold, percent of the force.
const MOST: [f64; 5] = [6.0, 6.0, 10.0, 8.0, 6.0];
const TALL: [f64; 5] = [6.0, 8.0, 10.0, 8.0, 6.0];
const LAST: f64 = 1.0;

fn dome([radial, axial, wall]: [f64; 3]) -> DesignFile {
    let text = format!(
        "name = \"again\"\n[membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
         [material]\nlaw = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0\n[material.relaxation]\npreset = \"agilus30\"\n\
         [model]\nkind = \"solid\"\n[press]\nmax_indentation_mm = {:?}\n[transducer]\nkind = \"ratiometric\"\n\
         range_kpa = [-100.0, 1500.0]\nresolution_pa = 10.0\n[accuracy]\nforce_percent_of_reading = 0.1\n\
         indentation_percent_of_reading = 0.1\nfrom_percent_of_full_scale = 1.0\n",
        0.3 * axial
    );
    DesignFile::parse(&text, "again.toml").expect("a design")
}

/// How far the force is off from the first release on, percent of the peak before, and at the end, percent of the force; and how far
/// at most without the share that a wall touched again bears less.
fn off(file: &DesignFile, design: &impl Design, deep: f64, ways: &[Way]) -> [f64; 3] {
    let relaxation = file.relaxation.expect("it relaxes");
    let mut history = History::new(&file.design(), &relaxation, ELEMENTS, 0.0, 0.0).expect("at rest");
    let series = design.series().expect("it relaxes");
    let bits = design.parameters().pressure_fraction_bits;
    let without = WallSeries {
        retouch: 0,
        ..*series
    };
    let (mut wall, mut plain) = (Relaxing::<MAX_TERMS>::NEW, Relaxing::<MAX_TERMS>::NEW);
    let mut largest_without = 0.0_f64;
    let (mut time, mut depth, mut pascals) = (0.0, 0.0, 0.0);
    let (mut peak, mut largest, mut last, mut released) = (0.0_f64, 0.0_f64, 0.0, false);
    for &[until, part, step] in ways {
        released |= part * deep < depth;
        let steps = ((until - time) / step).round();
        for i in 1..=steps as u32 {
            let share = f64::from(i) / steps;
            let now = history
                .advance(
                    time + share * (until - time),
                    Drive::Indentation(depth + share * (part * deep - depth)),
                )
                .expect("a press");
            let reports = ((until - time) / steps / PERIOD).round();
            let (mut force, mut force_without) = (0.0, 0.0);
            // Steps of the solid are of whole reports.
            for report in 1..=reports as u32 {
                let between = pascals + f64::from(report) / reports * (now.pressure_rise - pascals);
                let rise = PressureRise::from_pascals(between, bits);
                force = wall.step(design, series, rise).contact.force.newtons();
                force_without = plain.step(design, &without, rise).contact.force.newtons();
            }
            pascals = now.pressure_rise;
            peak = peak.max(now.force);
            if released {
                let off = 100.0 * (force - now.force).abs();
                largest = largest.max(off / peak);
                last = off / now.force;
                largest_without = largest_without.max(100.0 * (force_without - now.force).abs() / peak);
            }
        }
        (time, depth) = (until, part * deep);
    }
    [largest, last, largest_without]
}

#[test]
fn a_wall_touched_again_is_read_within_a_few_percent_of_the_peak() {
    for (size, most) in [
        ([9.0, 7.0, 1.0], MOST),
        ([8.0, 8.0, 0.8], MOST),
        ([10.0, 6.0, 1.0], MOST),
        ([6.0, 5.0, 0.6], MOST),
        ([8.0, 8.0, 1.5], MOST),
        ([7.0, 9.0, 1.2], TALL),
    ] {
        let file = dome(size);
        let block = generate::from_design(file.clone())
            .expect("it has tables")
            .binary();
        let (design, _) = LoadedDesign::read(&block).expect("it was just written");
        let found = [&TAPS[..], &FASTER, &SLOWER, &AFTER_A_GRASP, &HELD]
            .map(|ways| off(&file, &design, 0.25e-3 * size[1], ways));
        let of_peak = found.map(|[largest, ..]| largest);
        println!(
            "{size:?}: three taps, faster, slower, a tap after a grasp, a hold after a grasp: {of_peak:.1?} % of the peak"
        );
        let without = found.map(|[.., without]| without);
        println!("without the share: {without:.1?} % of the peak");
        assert!(without[1] > 2.0 * of_peak[1] && without[3] > 2.0 * of_peak[3]);
        for (found, most) in of_peak.into_iter().zip(most) {
            assert!(found < most, "{size:?}: {found}");
        }
        // What is left of the old contact is forgotten while the new one is held.
        let [_, held, _] = found[4];
        println!("at the end of the hold: {held:.1} % of the force");
        assert!(held < LAST, "{size:?}: {held}");
    }
}
