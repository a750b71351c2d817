//! What the design tool says the chip would say, and what the signal path says.

use fingertip::image::ImageDesign;
use fingertip::signal::contact::contact;
use fingertip::signal::design::Design;
use fingertip::status::Warnings;
use host_tests::design;
use model_tables::generate;
use model_tables::units::PressureRise;

#[test]
fn tables_of_the_tool_and_of_the_build_are_the_same() {
    let generated = generate::from_design_file(&design("index-fingertip")).expect("the default design");
    let tables = &generated.certified.tables;
    let bits = tables.layout.pressure_fraction_bits;
    if ImageDesign::CONSTANTS.hash != generated.hash() {
        return; // built for another design
    }
    assert_eq!(bits, ImageDesign::PRESSURE_FRACTION_BITS);
    let lowest_rest = generated.transducer().lowest_rest(bits);
    let beyond = [i64::MIN, -i64::from(i32::MAX), i64::MAX].map(PressureRise::held);
    let around = (-2_000..tables.layout.maximum + 2_000)
        .step_by(97)
        .map(PressureRise);
    for rise in around.chain(beyond) {
        let count = rise.0;
        let (tool, chip) = (tables.lookup(rise), contact::<ImageDesign>(rise, Warnings::NONE));
        assert_eq!(
            (tool.force, tool.indentation),
            (chip.force, chip.indentation),
            "{count}"
        );
        let expected = if tool.saturated {
            Warnings::SATURATED
        } else if rise < lowest_rest {
            Warnings::BELOW_ZERO
        } else {
            Warnings::NONE
        };
        assert_eq!(chip.warnings, expected, "{count}");
    }
}
