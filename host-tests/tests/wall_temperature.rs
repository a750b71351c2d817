//! What two kelvin of a wall whose temperature nothing measures cost, beside the 1-sigma that the chip states for them: pressed, held, let go,
//! and pressed again, on solids in time.

use fingertip::signal::design::{Design, Rise, Wall};
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::Relaxing;
use fingertip::signal::report::Contact;
use fingertip::signal::wall::Memory;
use fingertip::status::Warnings;
use fingertip::units::Microseconds;
use model_tables::design_file::DesignFile;
use model_tables::generate;
use model_tables::material::relaxation::{MAX_TERMS, Relaxation};
use model_tables::material::series::{SeriesStep, WALL_TEMPERATURE, WallSeries};
use model_tables::solid::history::{Drive, History};
use model_tables::solid::mesh::Elements;
use model_tables::units::PressureRise;

/// Of the solid, and of the chip, seconds.
const STEP: f64 = 0.01;
const PERIOD: f64 = 1e-3;
/// What a stated 1-sigma may be over what two kelvin cost, and what they cost over it.
const MOST: f64 = 1.3;
const ELEMENTS: Elements = Elements {
    through: 2,
    along: 24,
};

/// A dome of these outer semi-axes and this thickness, millimetres.
fn dome([radial, axial, wall]: [f64; 3], series: &str) -> DesignFile {
    let text = format!(
        "name = \"warm\"\n[membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
         [material]\nlaw = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0\n[material.relaxation]\n{series}\n\
         [model]\nkind = \"solid\"\n[press]\nmax_indentation_mm = {:?}\n[transducer]\nkind = \"ratiometric\"\n\
         range_kpa = [-50.0, 1500.0]\nresolution_pa = 10.0\n[accuracy]\nforce_percent_of_reading = 0.1\n\
         indentation_percent_of_reading = 0.1\nfrom_percent_of_full_scale = 1.0\n",
        0.36 * axial
    );
    DesignFile::parse(&text, "warm.toml").expect("a design")
}

/// Pressed to a depth in so many seconds, held for 3 s, let go as fast, and after 10 s pressed as before.
fn path(deep: f64, ramp: f64) -> [[f64; 2]; 7] {
    let let_go = 2.0 * ramp + 3.0;
    [
        [0.0, 0.0],
        [ramp, deep],
        [ramp + 3.0, deep],
        [let_go, 0.0],
        [let_go + 10.0, 0.0],
        [let_go + 10.0 + ramp, deep],
        [let_go + 13.0 + ramp, deep],
    ]
}

/// What the solid has at each step: seconds, pressure in pascals, newtons, metres.
fn solid(file: &DesignFile, relaxation: &Relaxation, path: &[[f64; 2]]) -> Vec<[f64; 4]> {
    let mut history = History::new(&file.design(), relaxation, ELEMENTS, 0.0, 0.0).expect("at rest");
    let mut instants = vec![[0.0; 4]];
    for pair in path.windows(2) {
        let steps = ((pair[1][0] - pair[0][0]) / STEP).round();
        for i in 1..=steps as u32 {
            let share = f64::from(i) / steps;
            let at = |axis: usize| pair[0][axis] + share * (pair[1][axis] - pair[0][axis]);
            let now = history
                .advance(at(0), Drive::Indentation(at(1)))
                .expect("a press");
            instants.push([at(0), now.pressure_rise, now.force, now.indentation]);
        }
    }
    instants
}

/// Sums of squares of the stated 1-sigma and of the cost, and the largest of the former over the latter.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    sigma: f64,
    cost: f64,
    ratio: f64,
}

impl Sums {
    fn add(&mut self, sigma: i32, [colder, warmer]: [i32; 2]) {
        let half = 0.5 * (f64::from(warmer) - f64::from(colder)).abs();
        self.sigma += f64::from(sigma) * f64::from(sigma);
        self.cost += half * half;
        self.ratio = self.ratio.max(f64::from(sigma) / half);
    }

    /// Root mean square of the one over that of the other.
    fn overall(&self) -> f64 {
        (self.sigma / self.cost).sqrt()
    }
}

/// Of force and indentation, pressed and held the first time, and the second time: what is stated beside what a colder and a warmer wall would
/// have read at the same pressures, from a twentieth of the largest force on.
fn stated(file: DesignFile, relaxation: &Relaxation, path: &[[f64; 2]]) -> [[Sums; 2]; 2] {
    let truth = solid(&file, relaxation, path);
    let block = generate::from_design(file).expect("it has tables").binary();
    let (design, _) = LoadedDesign::read(&block).expect("it was just written");
    let wall = *design.series().expect("it relaxes");
    let apart = [-WALL_TEMPERATURE, WALL_TEMPERATURE].map(|apart| WallSeries {
        step: SeriesStep::over(&relaxation.at(relaxation.temperature + apart), PERIOD),
        ..wall
    });
    let bits = design.parameters().pressure_fraction_bits;
    let mut memory = Memory::<MAX_TERMS>::NEW;
    let mut walls = [Relaxing::<MAX_TERMS>::NEW; 2];
    let whole = truth.iter().map(|instant| instant[2]).fold(0.0, f64::max);
    let mut sums = [[Sums::default(); 2]; 2];
    let per_step = (STEP / PERIOD).round() as usize;
    for millisecond in 0..(truth.len() - 1) * per_step {
        let (before, after) = (truth[millisecond / per_step], truth[millisecond / per_step + 1]);
        let share = (millisecond % per_step) as f64 / per_step as f64;
        let [seconds, pascals, force, _] = [0, 1, 2, 3].map(|i| before[i] + share * (after[i] - before[i]));
        let rise = PressureRise::from_pascals(pascals, bits);
        let (read, sigma) = memory.read(
            &design,
            Rise {
                time: Microseconds(1000 * millisecond as u64),
                rise,
                sigma: PressureRise(1),
                warnings: Warnings::NONE,
            },
        );
        let mut others = [Contact::default(); 2];
        for ((other, wall), series) in others.iter_mut().zip(&mut walls).zip(&apart) {
            *other = wall.step(&design, series, rise).contact;
        }
        let pressed = if seconds < path[2][0] {
            0
        } else if seconds > path[4][0] {
            1
        } else {
            continue;
        };
        if force > 0.05 * whole && read.warnings == Warnings::NONE {
            sums[pressed][0].add(sigma.force.0, others.map(|other| other.force.0));
            sums[pressed][1].add(sigma.indentation.0, others.map(|other| other.indentation.0));
        }
    }
    sums
}

/// The solid itself two kelvin colder and two warmer, read by the chip that takes it to be at the series' temperature: pressed and held, what force
/// and indentation are off is what their 1-sigma states.
#[test]
fn a_colder_and_a_warmer_solid_are_read_within_their_sigma() {
    let file = dome([9.0, 7.0, 1.0], "preset = \"agilus30\"");
    let relaxation = file.relaxation.expect("it relaxes");
    let block = generate::from_design(file.clone())
        .expect("it has tables")
        .binary();
    let (design, _) = LoadedDesign::read(&block).expect("it was just written");
    let bits = design.parameters().pressure_fraction_bits;
    for apart in [-WALL_TEMPERATURE, WALL_TEMPERATURE] {
        let other = relaxation.at(relaxation.temperature + apart);
        let truth = solid(&file, &other, &path(1.75e-3, 1.0)[..3]);
        let mut memory = Memory::<MAX_TERMS>::NEW;
        let [mut force, mut indentation] = [[0.0; 2]; 2];
        for (k, pair) in truth.windows(2).enumerate() {
            for i in 0..10_u32 {
                let share = f64::from(i) / 10.0;
                let [_, pascals, newtons, metres] =
                    [0, 1, 2, 3].map(|i| pair[0][i] + share * (pair[1][i] - pair[0][i]));
                let (read, sigma) = memory.read(
                    &design,
                    Rise {
                        time: Microseconds(1000 * (10 * k as u64 + u64::from(i))),
                        rise: PressureRise::from_pascals(pascals, bits),
                        sigma: PressureRise(1),
                        warnings: Warnings::NONE,
                    },
                );
                for (sums, off, sigma) in [
                    (&mut force, read.force.newtons() - newtons, sigma.force.newtons()),
                    (
                        &mut indentation,
                        read.indentation.metres() - metres,
                        sigma.indentation.metres(),
                    ),
                ] {
                    sums[0] += sigma * sigma;
                    sums[1] += off * off;
                }
            }
        }
        let [force, indentation] = [force, indentation].map(|[sigma, off]| (sigma / off).sqrt());
        println!("a solid {apart:+} K: stated over error: force {force:.2}, indentation {indentation:.2}");
        for ratio in [force, indentation] {
            assert!((1.0 / MOST..MOST).contains(&ratio), "{apart} K: {ratio}");
        }
    }
}

/// On dome A and others, for a wall as Agilus30 and one that a second stiffens by a third, pressed fast and slowly.
#[test]
fn the_sigma_of_an_unmeasured_wall_is_what_two_kelvin_cost() {
    const AGILUS: &str = "preset = \"agilus30\"";
    const MIDDLE: &str = "tau_s = [0.03, 0.3, 3.0, 30.0]\ng = [0.6, 0.4, 0.3, 0.2]\ntemperature_c = 25.0\nshift_per_kelvin = 0.1";
    for (size, series, ramp, largest) in [
        ([9.0, 7.0, 1.0], AGILUS, 1.0, MOST),
        ([9.0, 7.0, 1.0], AGILUS, 10.0, MOST),
        ([8.0, 8.0, 0.8], AGILUS, 1.0, MOST),
        // Four terms are no even spread of relaxation times.
        ([9.0, 7.0, 1.0], MIDDLE, 1.0, 1.4),
    ] {
        let file = dome(size, series);
        let relaxation = file.relaxation.expect("it relaxes");
        let found = stated(file, &relaxation, &path(0.25e-3 * size[1], ramp));
        for (sums, pressed) in found.iter().zip(["first press", "second press"]) {
            let [force, indentation] = sums;
            println!(
                "{size:?} in {ramp} s, {series}, {pressed}: stated over cost: force {:.2}, indentation {:.2}, at most {:.2}",
                force.overall(),
                indentation.overall(),
                indentation.ratio
            );
            for sums in sums {
                assert!((1.0 / MOST..MOST).contains(&sums.overall()), "{sums:?}");
            }
        }
        // At every instant too. What two kelvin do to the force changes its sign where the area does not change, and as a wall touches again what they
        // did to the first press cancels what they do to the second one: there is no ratio.
        let [_, indentation] = &found[0];
        assert!(indentation.ratio < largest, "{indentation:?}");
    }
}
