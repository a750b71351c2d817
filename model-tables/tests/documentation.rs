//! What the crate's documentation states, held to the crate.

use model_tables::membrane::press::Press;
use toml::de::DeTable;

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
    let manifest = DeTable::parse(include_str!("../Cargo.toml")).expect("a manifest");
    let features = manifest.get_ref()["features"].get_ref();
    for name in features.as_table().expect("a section").keys() {
        let name = name.get_ref();
        if name != "default" {
            assert!(DOCUMENTATION.contains(&format!("//! | `{name}` |")), "{name}");
        }
    }
}
