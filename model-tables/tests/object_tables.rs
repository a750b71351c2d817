//! Tables blended for what touches: cups, a cylinder, domes of other shapes.

use model_tables::design::Design;
use model_tables::design_file::{Axes, DesignFile};
use model_tables::generate::from_design;
use model_tables::model::Fingertip;
use model_tables::object::{Friction, Object, Shape};
use model_tables::table::ContactLookup as _;
use model_tables::table::law::Touched;
use model_tables::units::PressureRise;

const DEFAULT: &str = include_str!("../designs/index-fingertip-elastic.toml");

/// The default design against an object.
fn against(object: &str) -> DesignFile {
    DesignFile::parse(&format!("{DEFAULT}\n[object]\n{object}\n"), "object.toml").expect("a design")
}

/// What tables of a plate are off on a cup of 20 mm radius by an independent finite-element solution: kilopascals, percent of the force,
/// millimetres of indentation, as quoted, with the digits that they are quoted with.
const IN_A_CUP: [[f64; 5]; 4] = [
    // The solid has -6.05 % there, 2 x 60 and 3 x 96 alike.
    [1.0, -6.5, 0.070, 0.5, 0.003],
    [5.0, -21.0, 0.26, 0.6, 0.01],
    [20.0, -24.5, 0.53, 0.3, 0.01],
    [50.0, -21.0, 0.78, 0.6, 0.01],
];

/// A design that states a cup has that cup's own tables beside the plate's.
#[test]
fn tables_of_a_stated_cup_give_its_force_and_indentation() {
    let generated = from_design(against("radius_mm = -20.0")).expect("tables");
    let object = generated.certified.object.as_ref().expect("of a cup");
    assert_eq!(
        (object.start, object.reference),
        (Touched::Cup(20_000), Touched::Cup(20_000))
    );
    let plate = &generated.certified.tables;
    let bits = plate.layout.fraction_bits;
    let cup = object.blended(plate, object.start).expect("it begins with it");
    for [kilopascals, percent, millimetres, off, by] in IN_A_CUP {
        let rise = PressureRise::from_pascals(1e3 * kilopascals, bits);
        let (flat, hollow) = (plate.contact_at(rise), cup.contact_at(rise));
        let by_force = 100.0 * (flat.force.newtons() / hollow.force.newtons() - 1.0);
        let by_depth = 1e3 * (flat.indentation.metres() - hollow.indentation.metres());
        println!("{kilopascals}: {by_force:+.2} % ({percent:+}), {by_depth:+.3} mm ({millimetres:+})");
        // The reference's own error beside its last digit.
        assert!(
            (by_force - percent).abs() < off + 0.3,
            "{kilopascals}: {by_force}"
        );
        assert!(
            (by_depth - millimetres).abs() < by + 0.004,
            "{kilopascals}: {by_depth}"
        );
    }
    let mut cups = 0;
    for error in &object.errors {
        println!("{error:?}");
        let errors = error.pressed;
        let most = errors.force_percent.max(errors.indentation_percent);
        if error.radius_mm < 0.0 {
            cups += 1;
            assert!(most < 1.5, "{error:?}");
        } else {
            assert!(most < 6.0, "{error:?}");
        }
    }
    assert_eq!(cups, 4);
    // The set of objects has the cup, and the band that much more room.
    let band = generated.band.as_ref().expect("its balls have presses");
    assert_eq!(band.cup_mm, Some(20.0));
    let row = band.widest();
    let width = |[least, most]: [f64; 2]| (100.0 + most) / (100.0 + least);
    // Without cups no wider than -35 to +25 and -5 to +65 %.
    assert!(width(row.force_percent) > 125.0 / 65.0, "{row:?}");
    assert!(width(row.indentation_percent) > 165.0 / 95.0, "{row:?}");
}

/// `auto` looks at the depths that a cup lets it be pressed to. An independent solution has 1.553 mm and 2.24 N of a plate at 20 kPa, and in
/// the cup 0.53 mm less and a force of which that is 24.5 % less.
#[test]
fn auto_presses_into_a_cup_as_deep_as_that_lets_it() {
    let mut tip = Fingertip::new(&against("radius_mm = -20.0")).expect("a model");
    let state = tip.contact_at(1.023e-3).expect("a state");
    assert!((state.pressure_rise / 20e3 - 1.0).abs() < 0.02, "{state:?}");
    assert!((state.force / (2.24 / 0.755) - 1.0).abs() < 0.02, "{state:?}");
    let error = tip
        .contact_at(2.5e-3)
        .expect_err("the cup lies against the rim before")
        .to_string();
    assert!(error.contains("is beyond the limit of 1."), "{error}");
}

/// A pen of 5 mm radius across the tip: what a plate's tables read too much of its force, percent, by indentation in millimetres; of a
/// three-dimensional finite-element solution, as quoted.
const PEN: [[f64; 2]; 4] = [[0.5, 1.5], [1.0, 8.5], [1.5, 14.8], [2.0, 18.0]];

/// A cylinder takes half the weights of a ball. Quoted of that law: force -5 to +0.6 %; its indentation, -2 to +4 %, is quoted alone.
#[test]
fn a_cylinder_reads_as_quoted() {
    let generated = from_design(against("shape = \"cylinder\"\nradius_mm = 5.0")).expect("tables");
    let object = generated.certified.object.as_ref().expect("of balls");
    let plate = &generated.certified.tables;
    let bits = plate.layout.fraction_bits;
    let pen = object
        .blended(plate, Touched::Cylinder(5_000))
        .expect("it begins with it");
    for [millimetres, percent] in PEN {
        // The pressure at which it is so deep, by its own tables.
        let (mut low, mut high) = (0, pen.layout.maximum);
        while high - low > 1 {
            let middle = i32::midpoint(low, high);
            if pen.contact_at(PressureRise(middle)).indentation.metres() < 1e-3 * millimetres {
                low = middle;
            } else {
                high = middle;
            }
        }
        let [read, flat] = [&pen, plate].map(|tables| tables.contact_at(PressureRise(low)).force.newtons());
        let truth = flat / (1.0 + percent / 100.0);
        let found = 100.0 * (read / truth - 1.0);
        println!(
            "{millimetres} mm, {:.0} Pa: {found:+.1} %",
            PressureRise(low).pascals(bits)
        );
        // A point to either side: the depth is the tables' own, and the figures have two digits.
        assert!((-6.0..1.6).contains(&found), "{millimetres}: {found}");
    }
}

/// Domes of other shapes, walls and laws: balls of 5 mm or more as deep as a third of the height, and one of 6 mm that no law was fitted
/// to, against the solid's own presses.
#[test]
fn blends_hold_on_other_domes() {
    for (name, [radial, axial, wall], law) in [
        ("tall", [8.0, 8.0, 0.8], "law = \"neo-hookean\"\nc1_pa = 100000.0"),
        ("flat", [10.0, 6.0, 1.0], "preset = \"agilus30\""),
    ] {
        let text = format!(
            "name = \"{name}\"\n[membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
             [material]\n{law}\n[model]\nkind = \"solid\"\n[object]\n[press]\nmax_indentation_mm = {:?}\n\
             [transducer]\nkind = \"ratiometric\"\nrange_kpa = [-10.0, 300.0]\nresolution_pa = 10.0\n[accuracy]\n\
             force_percent_of_reading = 0.1\nindentation_percent_of_reading = 0.1\nfrom_percent_of_full_scale = 1.0\n",
            axial / 3.0
        );
        let file = DesignFile::parse(&text, "dome.toml").expect("a design");
        let generated = from_design(file.clone()).expect("tables");
        let object = generated.certified.object.as_ref().expect("of balls");
        let mut most = [0.0_f64; 2];
        for error in object.errors.iter().filter(|error| error.radius_mm > 5.0) {
            println!("{name}: {error:?}");
            most = [
                most[0].max(error.pressed.force_percent),
                most[1].max(error.pressed.indentation_percent),
            ];
        }
        let plate = &generated.certified.tables;
        let bits = plate.layout.fraction_bits;
        let tables = object
            .blended(plate, Touched::Ball(6_000))
            .expect("a ball that it has");
        let onto = Design {
            object: Object {
                shape: Shape::Ball { radius: 6e-3 },
                friction: Friction::NONE,
            },
            ..file.design_to(Axes::Outer)
        };
        let mut press = Fingertip::of(generated.kind.expect("a solid"), &onto).expect("a ball");
        for part in [0.2, 0.35, 0.5, 0.75, 1.0] {
            let indentation = part * 1e-3 * axial / 3.0;
            let truth = press.contact_at(indentation).expect("a state");
            if truth.pressure_rise < object.from {
                continue;
            }
            let read = tables.contact_at(PressureRise::from_pascals(truth.pressure_rise, bits));
            let percent = |read: f64, truth: f64| 100.0 * (read / truth - 1.0).abs();
            let own = [
                percent(read.force.newtons(), truth.force),
                percent(read.indentation.metres(), indentation),
            ];
            println!("{name}, 6 mm, {part}: {own:.2?} %");
            most = [most[0].max(own[0]), most[1].max(own[1])];
        }
        println!("{name}: {most:.2?} %");
        assert!(most[0] < 2.5 && most[1] < 2.5, "{name}: {most:?}");
    }
}
