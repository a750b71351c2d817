//! The rule by which `kind = "auto"` chooses a model, against the refined solid.

use compare::campaign::walls;
use compare::ladder::objects;
use model_tables::model::choice::LADDER;
use std::collections::BTreeMap;

/// The page about the ladder quotes what the rule lets through, and of which wall: computed again, it is that.
#[test]
fn the_page_of_the_ladder_is_what_the_rule_does() {
    let page = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../LADDER.md"));
    let rows: Vec<Vec<&str>> = page
        .split("## What `kind = \"auto\"` takes")
        .nth(1)
        .expect("the last chapter")
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| allowed"))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    assert_eq!(rows.len(), walls::ASKED.len());
    let mut measured = BTreeMap::new();
    for (row, asked) in rows.iter().zip(walls::ASKED) {
        let number = |column: usize| row[column].parse::<f64>().expect("a number");
        assert!((number(1) - 100.0 * asked).abs() < 1e-9, "{row:?}");
        let designs: f64 = (2..2 + LADDER.len()).map(number).sum();
        assert!(designs >= 200.0, "{row:?}");
        let (through, index) = (number(row.len() - 3), number(row.len() - 2) as u64);
        assert!(through <= 100.0 * asked, "{row:?}");
        let wall = measured
            .entry(index)
            .or_insert_with(|| walls::draw(index).measure());
        let taken = wall.take(asked);
        assert!((100.0 * taken.error - through).abs() < 0.02, "{row:?} {taken:?}");
    }
}

/// What the rule lets through on walls it was not made on: never more than was allowed. `designer ladder` does the same at
/// length.
#[test]
fn auto_lets_no_more_error_through_than_allowed() {
    for index in 900..906 {
        let wall = walls::draw(index).measure();
        assert!(wall.has_truth(), "{:?}", wall.case);
        for asked in walls::ASKED {
            let taken = wall.take(asked);
            assert!(taken.error <= asked, "{:?}: {asked} {taken:?}", wall.case);
        }
        assert_eq!(wall.take(1e-9).fidelity, LADDER.len() - 1);
    }
}

/// The page's rows of one wall under balls and a rough plate, computed again, are those on the page.
#[test]
fn the_page_has_the_objects_as_they_are_computed() {
    let page = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../LADDER.md"));
    let scenes = objects::measure(1.0).expect("its presses");
    let chapter = objects::markdown(&scenes);
    let rows: Vec<&str> = chapter.lines().filter(|line| line.starts_with("| 1 |")).collect();
    assert_eq!(rows.len(), 6);
    for row in rows {
        assert!(page.contains(row), "LADDER.md is stale; it should have\n{row}");
    }
    // A blend never is further off than the plate's tables where those are off.
    for scene in scenes
        .iter()
        .filter(|scene| scene.radius.is_some_and(|radius| radius < 30.0))
    {
        let (plate, in_band, blend) = scene.states.last().expect("three depths");
        assert!(
            blend.largest() < 2.5 && plate.largest() > 4.0 * blend.largest(),
            "{scene:?}"
        );
        assert!(*in_band || scene.radius < Some(5.0), "{scene:?}");
    }
}
