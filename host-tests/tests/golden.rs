//! The tables of the shipped designs, as reviewed: whatever changes them shows as a difference of text.
//!
//! After a change that is meant, `UPDATE_EXPECT=1 cargo test --package host-tests --test golden` writes
//! `model-tables/golden` anew, and the rows of MEASURED.md are named by the same test without it.

use expect_test::expect_file;
use fingertip::image::ImageDesign;
use fingertip::image::generated::TABLES;
use fingertip::signal::uncertainty::Uncertainty;
use host_tests::budget::{self, Budget};
use host_tests::real_use::{self, RealUse};
use host_tests::{assert_measured_says, design, workspace};
use model_tables::generate::{self, Generated};
use std::fs;

const SHIPPED: [&str; 6] = [
    "haptic-loop",
    "index-fingertip",
    "index-fingertip-elastic",
    "paper-prestretched",
    "skin-analogue",
    "skin-light-touch",
];

#[test]
fn tables_and_certificates_are_those_that_were_reviewed() {
    let mut names: Vec<String> = fs::read_dir(workspace().join("model-tables/designs"))
        .expect("the designs")
        .filter_map(|entry| {
            let path = entry.expect("a file").path();
            Some(path.file_stem()?.to_str()?.to_owned())
        })
        .collect();
    names.sort_unstable();
    assert_eq!(names, SHIPPED);
    let (mut budgets, mut everything) = (Vec::new(), Vec::new());
    for name in SHIPPED {
        let generated = generate::from_design_file(&design(name)).expect("a shipped design");
        let golden = workspace().join("model-tables/golden").join(name);
        expect_file![golden.join("tables.rs")].assert_eq(&generated.rust_source());
        expect_file![golden.join("certificate.toml")].assert_eq(&generated.certificate());
        readme_says(name, &generated);
        let budget = Budget::of(&generated);
        if ImageDesign::CONSTANTS.hash == generated.hash() {
            the_build_script_wrote_the_same(&generated);
            the_chip_says_what_is_budgeted(&budget);
        }
        budgets.push(budget);
        // What objects and temperature do to a loop is not in the tables of the page.
        if generated.design.disc().is_none() {
            everything.push(RealUse::of(&generated));
        }
    }
    let page = workspace().join("host-tests/BUDGET.md");
    expect_file![page].assert_eq(&budget::markdown(&budgets));
    let page = workspace().join("model-tables/ERROR_BUDGET.md");
    expect_file![page].assert_eq(&real_use::markdown(&everything));
}

fn readme_says(name: &str, generated: &Generated) {
    let (tables, certificate) = (&generated.certified.tables, &generated.certified.certificate);
    assert_measured_says(&format!(
        "| {name} | {} | {} | {} | {:.3} | {:.3} |",
        tables.bytes(),
        tables.instructions(),
        certificate.inputs,
        certificate.force.of_reading.max,
        certificate.indentation.of_reading.max,
    ));
}

/// The design of this build was solved once more, by another program.
fn the_build_script_wrote_the_same(generated: &Generated) {
    assert_eq!(TABLES.segments.as_flattened(), generated.certified.tables.words);
    assert_eq!(TABLES.layout, generated.certified.tables.layout);
    assert_eq!(ImageDesign::CONSTANTS.certificate, generated.certificate_hash());
    assert_eq!(ImageDesign::CONSTANTS.table_version, generate::TABLE_VERSION);
}

/// What the chip says of its uncertainty is what the budget has of noise and resolution; the zero's is not in it.
fn the_chip_says_what_is_budgeted(budget: &Budget) {
    let terms = budget
        .terms
        .iter()
        .filter(|term| !term.bound && !term.name.starts_with("tare"));
    let squares: f64 = terms.map(|term| term.pascals.unwrap_or_default().powi(2)).sum();
    let bits = ImageDesign::PARAMETERS.pressure_fraction_bits;
    let reported = Uncertainty::of(&ImageDesign::CONSTANTS, bits).rise(0, 0);
    assert!(
        (reported.pascals(bits) / squares.sqrt() - 1.0).abs() < 0.01,
        "{reported:?} for {}",
        squares.sqrt()
    );
}
