//! What the crate's documentation states, held to the crate.

use model_tables::press::Press;

const DOCUMENTATION: &str = include_str!("../src/lib.rs");

#[test]
fn the_stated_compiler_is_the_one_cargo_asks_for() {
    let stated = format!("Rust {} or later", env!("CARGO_PKG_RUST_VERSION"));
    assert!(DOCUMENTATION.contains(&stated), "{stated}");
}

#[test]
fn a_press_fits_the_stated_memory() {
    let kilobytes = size_of::<Press>() as f64 / 1e3;
    let stated: f64 = DOCUMENTATION
        .split_once("of less than ")
        .and_then(|(_, rest)| rest.split_once(" kB"))
        .and_then(|(number, _)| number.parse().ok())
        .expect("a number of kB");
    assert!(kilobytes < stated && kilobytes > 0.4 * stated, "{kilobytes} kB");
}

#[test]
fn a_press_may_cross_threads() {
    fn crosses<T: Send + Sync>() {}
    crosses::<Press>();
}

#[test]
fn every_feature_is_documented() {
    let manifest: toml::Table = include_str!("../Cargo.toml").parse().expect("a manifest");
    for name in manifest["features"].as_table().expect("a section").keys() {
        if name != "default" {
            assert!(DOCUMENTATION.contains(&format!("//! | `{name}` |")), "{name}");
        }
    }
}
