//! Walls that are touched again before they have recovered: the chip's force beside the solid's, in time, on taps and on a press that is faster
//! than the one before.

use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::Relaxing;
use model_tables::design_file::DesignFile;
use model_tables::generate;
use model_tables::material::relaxation::MAX_TERMS;
use model_tables::material::series::WallSeries;
use model_tables::object::{Friction, Object, Shape};
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
/// What the indentation may be off in contact from the first release on, millimetres: below and above.
const INDENTATION: [f64; 2] = [-0.02, 0.4];
/// A series between Agilus30 and a wall that hardly relaxes.
const BETWEEN: &str =
    "tau_s = [0.03, 0.3, 3.0, 30.0]\ng = [3.0, 1.5, 0.8, 0.4]\ntemperature_c = 20.0\nshift_per_kelvin = 0.0";
const AGILUS: &str = "preset = \"agilus30\"";

/// A dome that is touched by a plate, or a ball of a radius in millimetres.
fn dome([radial, axial, wall]: [f64; 3], series: &str, ball: Option<f64>) -> DesignFile {
    let object = ball.map_or(String::new(), |radius| {
        format!("[object]\nradius_mm = {radius:?}\n")
    });
    let text = format!(
        "name = \"again\"\n[membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
         [material]\nlaw = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0\n[material.relaxation]\n{series}\n\
         [model]\nkind = \"solid\"\n{object}[press]\nmax_indentation_mm = {:?}\n[transducer]\nkind = \"ratiometric\"\n\
         range_kpa = [-100.0, 1500.0]\nresolution_pa = 10.0\n[accuracy]\nforce_percent_of_reading = 0.1\n\
         indentation_percent_of_reading = 0.1\nfrom_percent_of_full_scale = 1.0\n",
        0.3 * axial
    );
    DesignFile::parse(&text, "again.toml").expect("a design")
}

/// What is off from the first release on.
struct Off {
    /// The force, percent of the peak before.
    of_peak: f64,
    /// The force at the end, percent of it.
    last: f64,
    /// The force without the share that a wall touched again bears less, percent of the peak before.
    without: f64,
    /// The indentation in contact, millimetres, least and most.
    indentation: [f64; 2],
}

fn off(file: &DesignFile, design: &impl Design, deep: f64, ways: &[Way], ball: Option<f64>) -> Off {
    let relaxation = file.relaxation.expect("it relaxes");
    let mut touching = file.design();
    if let Some(radius_mm) = ball {
        touching.object = Object {
            shape: Shape::Ball {
                radius: 1e-3 * radius_mm,
            },
            friction: Friction::NONE,
        };
    }
    let mut history = History::new(&touching, &relaxation, ELEMENTS, 0.0, 0.0).expect("at rest");
    let series = design.series().expect("it relaxes");
    let bits = design.parameters().pressure_fraction_bits;
    let without = WallSeries {
        retouch: 0,
        ..*series
    };
    let (mut wall, mut plain) = (Relaxing::<MAX_TERMS>::NEW, Relaxing::<MAX_TERMS>::NEW);
    let (mut largest_without, mut indentation) = (0.0_f64, [0.0_f64; 2]);
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
            let (mut force, mut force_without, mut depth_read) = (0.0, 0.0, 0.0);
            // Steps of the solid are of whole reports.
            for report in 1..=reports as u32 {
                let between = pascals + f64::from(report) / reports * (now.pressure_rise - pascals);
                let rise = PressureRise::from_pascals(between, bits);
                let contact = wall.step(design, series, rise).contact;
                force = contact.force.newtons();
                depth_read = contact.indentation.metres();
                force_without = plain.step(design, &without, rise).contact.force.newtons();
            }
            pascals = now.pressure_rise;
            peak = peak.max(now.force);
            if released {
                let off = 100.0 * (force - now.force).abs();
                largest = largest.max(off / peak);
                last = off / now.force;
                largest_without = largest_without.max(100.0 * (force_without - now.force).abs() / peak);
                if now.in_contact() {
                    let off = 1e3 * (depth_read - now.indentation);
                    indentation = [indentation[0].min(off), indentation[1].max(off)];
                }
            }
        }
        (time, depth) = (until, part * deep);
    }
    Off {
        of_peak: largest,
        last,
        without: largest_without,
        indentation,
    }
}

fn assert_indentation(of: &str, found: &[Off]) {
    let off = found.iter().fold([0.0_f64; 2], |[least, most], found| {
        [least.min(found.indentation[0]), most.max(found.indentation[1])]
    });
    println!("{of}: indentation in contact after the first release {off:.3?} mm off");
    assert!(
        off[0] > INDENTATION[0] && off[1] < INDENTATION[1],
        "{of}: {off:?}"
    );
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
        let file = dome(size, AGILUS, None);
        let block = generate::from_design(file.clone())
            .expect("it has tables")
            .binary();
        let (design, _) = LoadedDesign::read(&block).expect("it was just written");
        let found = [&TAPS[..], &FASTER, &SLOWER, &AFTER_A_GRASP, &HELD]
            .map(|ways| off(&file, &design, 0.25e-3 * size[1], ways, None));
        let of_peak = [0, 1, 2, 3, 4].map(|i| found[i].of_peak);
        println!(
            "{size:?}: three taps, faster, slower, a tap after a grasp, a hold after a grasp: {of_peak:.1?} % of the peak"
        );
        let without = [0, 1, 2, 3, 4].map(|i| found[i].without);
        println!("without the share: {without:.1?} % of the peak");
        assert!(without[1] > 2.0 * of_peak[1] && without[3] > 2.0 * of_peak[3]);
        for (found, most) in of_peak.into_iter().zip(most) {
            assert!(found < most, "{size:?}: {found}");
        }
        // What is left of the old contact is forgotten while the new one is held.
        let held = found[4].last;
        println!("at the end of the hold: {held:.1} % of the force");
        assert!(held < LAST, "{size:?}: {held}");
        assert_indentation(&format!("{size:?}"), &found);
    }
}

/// Tables of a ball that touches, other series, and a dome of none of the other tests.
#[test]
fn the_indentation_of_a_wall_touched_again_is_an_upper_bound_within_0_4_mm() {
    for (size, name, series, ball) in [
        ([9.0, 7.0, 1.0], "Agilus30", AGILUS, Some(8.0)),
        ([7.0, 9.0, 1.2], "Agilus30", AGILUS, Some(20.0)),
        ([7.0, 9.0, 1.2], "between", BETWEEN, None),
        ([9.0, 9.0, 1.0], "Agilus30", AGILUS, None),
    ] {
        let file = dome(size, series, ball);
        let block = generate::from_design(file.clone())
            .expect("it has tables")
            .binary();
        let (design, _) = LoadedDesign::read(&block).expect("it was just written");
        let found = [&TAPS[..], &FASTER, &SLOWER, &HELD]
            .map(|ways| off(&file, &design, 0.25e-3 * size[1], ways, ball));
        assert_indentation(&format!("{size:?}, {name}, ball {ball:?}"), &found);
    }
}
