//! The figures of the README that the host can compute.

use host_tests::real_use::force_in_real_use;
use host_tests::{assert_readme_says, measured_figure};
use micromath::F32Ext;

/// Largest relative error of `of` against `truth` over 1/1000 ..= 1, percent.
fn largest_error(of: impl Fn(f32) -> f32, truth: impl Fn(f64) -> f64) -> f64 {
    (1..=1000_u16)
        .map(|i| f32::from(i) / 1000.0)
        .map(|x| (f64::from(of(x)) / truth(f64::from(x)) - 1.0).abs() * 100.0)
        .fold(0.0, f64::max)
}

/// A closed form `H ~ dP^n` would need a power; over the press of a fingertip n goes from 0.9 to 0.5.
#[test]
fn micromath_is_too_coarse() {
    let power = largest_error(|x| F32Ext::powf(x, 0.7), |x| x.powf(0.7));
    let root = largest_error(F32Ext::sqrt, f64::sqrt);
    assert_readme_says(&format!(
        "its `powf` is off by up to {power:.1} % and its `sqrt` by up to {root:.1} %, where the tables keep 0.1 %"
    ));
}

/// The README rounds figures of the page of measured ones.
#[test]
fn its_figures_are_the_measured_ones() {
    let flash = measured_figure("flash, bytes") / 1000.0;
    let ram = measured_figure("RAM without the stack, bytes") / 1000.0;
    let report = measured_figure("instructions from averaged counts to both results");
    let relaxing = measured_figure("instructions from averaged counts to both results of index-fingertip");
    let relaxing_flash = measured_figure("flash of index-fingertip without folders, bytes") / 1000.0;
    assert_readme_says(&format!(
        "{relaxing} instructions, {relaxing_flash:.0} kB flash (elastic: {report} instructions; {flash:.0} kB flash, {ram:.0} kB RAM \
         in all)"
    ));
}

/// The headline is what the campaign of grasps printed, as the error budget has it.
#[test]
fn the_headline_is_of_the_campaign_of_grasps() {
    let force = |design: &str| force_in_real_use(design, "not told").expect("a chapter of the campaign");
    let ([median, most], [elastic, elastic_most]) =
        (force("index-fingertip"), force("index-fingertip-elastic"));
    assert_readme_says(&format!(
        "{median:.1} % median error, {most:.1} % at 95 % (of an elastic wall {elastic:.1} % and {elastic_most:.1} %)"
    ));
}
