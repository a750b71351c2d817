//! What touches: what a state onto a ball costs, and how far blends of tables are off, as the page `OBJECTS.md` has it.

use compare::campaign::blends::{self, BlendWay, page};
use compare::campaign::object_cost;
use model_tables::design_file::DesignFile;
use std::path::Path;

const PAGE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../OBJECTS.md"));

/// The shipped domes.
const DESIGNS: [&str; 4] = [
    "index-fingertip-elastic",
    "paper-prestretched",
    "skin-analogue",
    "skin-light-touch",
];

/// Newton iterations and factorisations of every ball, of the membrane and of the solid 2 x 60: at most 1.3 times those of the plate, and as
/// the page has them. `cargo campaign cost` adds the time.
#[test]
fn a_state_onto_a_ball_costs_at_most_1_3_times_the_plates() {
    let mut models = 0;
    for name in DESIGNS {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../designs/{name}.toml"));
        let design = DesignFile::read(&file).expect("a shipped design");
        for costs in object_cost::measure_both(&design, 1).expect("presses") {
            models += 1;
            let [iterations, factorisations, _] = costs.largest();
            println!("{name}, {}: {iterations:.2}, {factorisations:.2}", costs.kind);
            assert!(iterations <= 1.3 && factorisations <= 1.3, "{name}: {costs:?}");
            for row in costs.to_string().lines() {
                // Without the times.
                let counted: Vec<&str> = row.split('|').take(5).collect();
                let row = format!("| {name} {}|", counted.join("|"));
                assert!(PAGE.contains(&row), "OBJECTS.md is stale; it should have\n{row}");
            }
        }
    }
    assert_eq!(models, 7);
}

/// The times on the page, as they were measured when it was written.
#[test]
fn the_times_on_the_page_are_within_1_3_of_the_plates() {
    let ratios = PAGE
        .lines()
        .filter(|line| line.contains(" | ball ") && line.starts_with("| ") && line.split('|').count() == 9)
        .filter_map(|line| line.split('|').nth(7)?.trim().parse::<f64>().ok());
    let ratios: Vec<f64> = ratios.collect();
    assert_eq!(ratios.len(), 21);
    assert!(ratios.iter().all(|ratio| *ratio <= 1.3), "{ratios:?}");
}

/// The default dome and a flat one: within 1.5 % and 2.5 % from 5 to 50 mm, and as on the page; better than the other ways with one table of a
/// ball.
#[test]
fn blends_are_as_the_page_has_them() {
    for (place, most) in [(0, 1.5), (6, 2.5)] {
        let (name, size, material) = blends::DOMES[place];
        let dome = blends::measure(name, &blends::dome(size, material).expect("a design")).expect("presses");
        let chip = dome.worst(BlendWay::TwoWeights).0.largest();
        println!("{name}: {chip:.2} %");
        assert!(chip <= most, "{name}: {chip}");
        for way in [
            BlendWay::PlateAlone,
            BlendWay::ScaledByPower,
            BlendWay::NearestOfThree,
            BlendWay::LinearInCurvature,
            BlendWay::OneWeight,
        ] {
            let other = dome.worst(way).0.largest();
            assert!(other > 1.5 * chip, "{name}, {way}: {other}");
        }
        let row = page::row(&dome);
        assert!(PAGE.contains(&row), "OBJECTS.md is stale; it should have\n{row}");
        if place == 0 {
            let ways = page::ways(&dome);
            assert!(
                PAGE.contains(&ways),
                "OBJECTS.md is stale; it should have\n{ways}"
            );
        }
    }
}
