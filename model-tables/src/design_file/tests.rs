use super::*;
use crate::constants::ZeroAssumptions;
use crate::object::{Friction, Shape};

/// A complete file; the tests break one thing in it at a time.
const GOOD: &str = r#"
name = "bench-tip"
[membrane]
radial_semi_axis_mm = 4.5
axial_semi_axis_mm = 2.7
thickness_mm = 1
[material]
law = "mooney-rivlin"
c1_pa = 160_355.0
c2_pa = 46559
[rest]
pole_stretch = 2.3
[press]
max_indentation_mm = 2.5
[transducer]
kind = "ratiometric"
range_kpa = [0, 400.0]
resolution_pa = 10.0
[accuracy]
force_percent_of_reading = 0.1
indentation_percent_of_reading = 0.2
from_percent_of_full_scale = 1.0
"#;

fn good() -> DesignFile {
    DesignFile::parse(GOOD, "good.toml").expect("the good file")
}

/// The error of GOOD with `from` replaced by `to`.
fn error(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from} is not in the good file");
    let text = DesignFile::parse(&GOOD.replacen(from, to, 1), "bad.toml")
        .expect_err("must be refused")
        .to_string();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

#[test]
fn reads_every_section_and_fills_in_the_defaults() {
    let file = good();
    assert_eq!(file.name, "bench-tip");
    assert_eq!(
        file.material,
        Law::MooneyRivlin {
            c1: 160_355.0,
            c2: 46_559.0
        }
    );
    assert_eq!(file.rest, RestSection::PoleStretch(2.3));
    assert!(file.compliance_mm3_per_kpa.abs() < 1e-300);
    assert_eq!(file.max_indentation_mm, Some(2.5));
    let transducer = file.transducer.expect("the transducer");
    assert!(transducer.range_kpa[0].abs() < 1e-300 && (transducer.range_kpa[1] - 400.0).abs() < 1e-12);
    assert!((transducer.noise_pa - 10.0).abs() < 1e-12);
    assert_eq!(
        transducer.kind,
        TransducerKindSection::Ratiometric {
            output_fraction_at_range: [0.1, 0.9],
            supply: Supply::Reference,
            source: SourceResistance::IDEAL,
        }
    );
    assert_eq!(file.actuator, None);
}

#[test]
fn converts_to_si() {
    let design = good().design();
    assert!((design.membrane.radial_semi_axis - 4.5e-3).abs() < 1e-17);
    assert!((design.membrane.axial_semi_axis - 2.7e-3).abs() < 1e-17);
    assert!((design.membrane.thickness - 1e-3).abs() < 1e-17);
    let compliant = GOOD.replace("[press]", "[fluid]\ncompliance_mm3_per_kpa = 2.0\n[press]");
    let design = DesignFile::parse(&compliant, "c").expect("compliance").design();
    // 2 mm^3/kPa = 2e-9 m^3 / 1e3 Pa.
    assert!((design.compliance - 2e-12).abs() < 1e-26);
}

#[test]
fn takes_each_kind_of_rest() {
    let with = |rest: &str| {
        DesignFile::parse(&GOOD.replace("pole_stretch = 2.3", rest), "rest.toml")
            .expect(rest)
            .design()
            .rest
    };
    assert_eq!(with("pole_stretch = 1.02"), RestBy::PoleStretch(1.02));
    assert_eq!(with("pressure_kpa = 12"), RestBy::Pressure(12_000.0));
    assert_eq!(with("equator_radius_mm = 5.0"), RestBy::EquatorRadius(0.005));
    assert_eq!(with("height_mm = 4.0"), RestBy::Height(0.004));
}

#[test]
fn takes_each_law() {
    let with = |law: &str| {
        let text = GOOD.replace("law = \"mooney-rivlin\"\nc1_pa = 160_355.0\nc2_pa = 46559\n", law);
        DesignFile::parse(&text, "law.toml").expect(law).material
    };
    assert_eq!(
        with("law = \"neo-hookean\"\nc1_pa = 5e4\n"),
        Law::NeoHookean { c1: 5e4 }
    );
    assert_eq!(
        with("law = \"yeoh\"\nc1_pa = 5e4\nc2_pa = -1e3\nc3_pa = 20\n"),
        Law::Yeoh {
            c1: 5e4,
            c2: -1e3,
            c3: 20.0
        }
    );
}

#[test]
fn takes_each_kind_of_transducer() {
    let with = |kind: &str| {
        let text = GOOD
            .replace("kind = \"ratiometric\"", kind)
            .replace("[0, 400.0]", "[0, 12.0]");
        DesignFile::parse(&text, "kind.toml")
            .expect(kind)
            .transducer
            .expect("there")
            .kind
    };
    assert_eq!(
        with("kind = \"ratiometric\"\nsupply = \"measured\""),
        TransducerKindSection::Ratiometric {
            output_fraction_at_range: [0.1, 0.9],
            supply: Supply::Measured,
            source: SourceResistance::IDEAL,
        }
    );
    assert_eq!(
        with("kind = \"abp2\""),
        TransducerKindSection::Abp2 {
            address: 0x28,
            transfer: Transfer::A
        }
    );
    assert_eq!(
        with("kind = \"abp2\"\naddress = 0x38\ntransfer = \"B\""),
        TransducerKindSection::Abp2 {
            address: 0x38,
            transfer: Transfer::B
        }
    );
    assert_eq!(with("kind = \"ms5837-02ba\""), TransducerKindSection::Ms5837);
    assert_eq!(
        with("kind = \"dps310\"\naddress = 0x76"),
        TransducerKindSection::Dps310 { address: 0x76 }
    );
}

/// A pull-up of 1 megohm on a source of 10 kilo-ohm costs 0.99 % of the gain and adds 1.1 kPa to a part of 100 kPa; on 3.4 kilo-ohm 0.34 %
/// and 381 Pa: worked out by hand from the divider.
#[test]
fn what_a_source_and_its_pull_up_do_to_an_output_is_taken_out() {
    for (ohm, gain_percent, zero_pa) in [(10_000, -0.99, 1_114.0), (3_400, -0.339, 381.0)] {
        let file = with_transducer(&format!(
            "kind = \"ratiometric\"\nrange_kpa = [0, 100]\noutput_fraction_at_range = [0.1, 0.9]\nsource_ohm = {ohm}"
        ))
        .expect("it is good");
        let TransducerKindSection::Ratiometric {
            output_fraction_at_range: [low, high],
            source,
            ..
        } = file.transducer.expect("there").kind
        else {
            panic!("it is analogue");
        };
        let [zero, end] = [low, high].map(|fraction| source.at_converter(fraction));
        assert!(
            (100.0 * ((end - zero) / (high - low) - 1.0) - gain_percent).abs() < 0.002,
            "{zero} {end}"
        );
        assert!(
            ((zero - low) / (high - low) * 100e3 - zero_pa).abs() < 1.0,
            "{zero}"
        );
        // It stands in the file that is printed, and in no other.
        let printed = file.canonical();
        assert_eq!(
            DesignFile::parse(&printed, "printed.toml").expect("it is good"),
            file
        );
    }
    assert!(
        !with_transducer("kind = \"ratiometric\"\nrange_kpa = [0, 100]")
            .expect("it is good")
            .canonical()
            .contains("ohm")
    );
}

/// The good file with another `[transducer]`.
fn with_transducer(keys: &str) -> Result<DesignFile, DesignFileError> {
    let (before, after) = GOOD.split_once("[transducer]").expect("it has one");
    let (_, after) = after.split_once("[accuracy]").expect("it follows");
    let text = format!("{before}[transducer]\n{keys}\nresolution_pa = 10.0\n[accuracy]{after}");
    DesignFile::parse(&text, "quantity.toml")
}

fn same([a, b]: [f64; 2], [c, d]: [f64; 2]) -> bool {
    (a - c).abs() < 1e-9 && (b - d).abs() < 1e-9
}

#[test]
fn an_absolute_analogue_part_is_described_as_its_datasheet_has_it() {
    // NXP MPX4250A: 20 to 250 kPa, Vs (0.004 P - 0.04).
    let file = with_transducer(
        "kind = \"ratiometric\"\nquantity = \"absolute\"\nrange_kpa = [20, 250]\n\
         output_fraction_at_range = [0.04, 0.96]",
    )
    .expect("the part");
    let transducer = file.transducer.expect("there");
    assert_eq!(transducer.quantity, Quantity::Absolute);
    assert!(same(transducer.own_range_kpa(), [20.0, 250.0]));
    // In 60 kPa of air it reads 40 kPa below it, in 108 kPa 142 above.
    assert!(same(transducer.gauge_range_kpa(), [-40.0, 142.0]));
    let gauge = with_transducer(
        "kind = \"ratiometric\"\nrange_kpa = [20, 250]\noutput_fraction_at_range = [0.04, 0.96]",
    )
    .expect("a gauge part");
    assert_ne!(file.hash(), gauge.hash());
    assert!(file.canonical().contains("\nquantity = \"absolute\"\n"));
    let again = DesignFile::parse(&file.canonical(), "again.toml").expect("its canonical text");
    assert_eq!(file, again);
}

#[test]
fn a_gauge_range_for_an_absolute_analogue_part_is_refused_with_what_it_should_be() {
    let error = with_transducer("kind = \"ratiometric\"\nquantity = \"absolute\"\nrange_kpa = [0, 100]")
        .expect_err("no air fits")
        .to_string();
    assert!(
        error.contains("`transducer.range_kpa` is [0, 100]")
            && error.contains("the two ends that the datasheet gives, kPa absolute")
            && error.contains("the air is 60 to 108 kPa"),
        "{error}"
    );
}

#[test]
fn a_part_on_a_bus_knows_what_it_measures_against() {
    for (kind, own, [wrong, right], own_range) in [
        ("abp2", Quantity::Gauge, ["absolute", "gauge"], [0.0, 12.0]),
        (
            "ms5837-02ba",
            Quantity::Absolute,
            ["gauge", "absolute"],
            [1.0, 200.0],
        ),
        ("dps310", Quantity::Absolute, ["gauge", "absolute"], [30.0, 120.0]),
    ] {
        let with =
            |quantity: &str| with_transducer(&format!("kind = \"{kind}\"\nrange_kpa = [0, 12]\n{quantity}"));
        let silent = with("").expect(kind);
        let stated = with(&format!("quantity = \"{right}\"")).expect(kind);
        assert_eq!(silent, stated);
        let transducer = silent.transducer.expect("there");
        assert_eq!(transducer.quantity, own);
        // Wanted of it, whatever the air; and what it has.
        assert!(same(transducer.gauge_range_kpa(), [0.0, 12.0]));
        assert!(same(transducer.own_range_kpa(), own_range));
        let error = with(&format!("quantity = \"{wrong}\""))
            .expect_err(kind)
            .to_string();
        assert!(
            error.contains(&format!("`transducer.quantity` is \"{wrong}\""))
                && error.contains(&format!("\"{right}\", as every part")),
            "{error}"
        );
    }
}

/// Of 120 kPa the densest air leaves 12, of 30 kPa the thinnest leaves -30.
#[test]
fn the_range_of_an_absolute_part_on_a_bus_is_judged_in_any_air() {
    for (kind, [lowest, highest]) in [("dps310", [-30, 12]), ("ms5837-02ba", [-59, 92])] {
        let with = |low: f64, high: f64| {
            with_transducer(&format!("kind = \"{kind}\"\nrange_kpa = [{low:?}, {high:?}]"))
        };
        let (low, high) = (f64::from(lowest), f64::from(highest));
        assert!(with(low, high).is_ok());
        for outside in [with(low - 0.1, high), with(low, high + 0.1)] {
            let error = outside.expect_err(kind).to_string();
            assert!(
                error.contains("`transducer.range_kpa` is")
                    && error.contains(&format!("within [{lowest}, {highest}]"))
                    && error.contains("the air is 60 to 108 kPa"),
                "{error}"
            );
        }
    }
}

#[test]
fn reading_what_was_printed_gives_the_same_design() {
    let kinds = [
        "kind = \"ratiometric\"\noutput_fraction_at_range = [0.04, 0.94]",
        "kind = \"ratiometric\"\nsupply = \"measured\"",
        "kind = \"abp2\"\ntransfer = \"B\"",
        "kind = \"ms5837-02ba\"",
        "kind = \"dps310\"",
    ];
    let rests = [
        "pole_stretch = 1.0000000000000002",
        "pressure_kpa = 1e-7",
        "equator_radius_mm = 8.3",
        "height_mm = 0.1",
    ];
    for kind in kinds {
        for rest in rests {
            let text = GOOD
                .replace("kind = \"ratiometric\"", kind)
                .replace("[0, 400.0]", "[0, 12.0]")
                .replace("pole_stretch = 2.3", rest)
                + "[actuator]\ndiameter_mm = 9\n[fluid]\ncompliance_mm3_per_kpa = 0.3333333333333333\n";
            let file = DesignFile::parse(&text, "a.toml").expect("a good file");
            let again = DesignFile::parse(&file.canonical(), "b.toml").expect("its canonical text");
            assert_eq!(file, again);
            assert_eq!(file.canonical(), again.canonical());
        }
    }
}

#[test]
fn the_hash_follows_the_values_and_not_the_layout() {
    let commented = GOOD.replace("[rest]", "# how it rests\n\n[rest]");
    let same = DesignFile::parse(&commented, "other-name.toml").expect("a comment more");
    assert_eq!(good().hash(), same.hash());
    let other = DesignFile::parse(&GOOD.replace("2.3", "2.31"), "good.toml").expect("another stretch");
    assert_ne!(good().hash(), other.hash());
}

#[test]
fn names_a_missing_section() {
    assert_eq!(
        error("[rest]\npole_stretch = 2.3\n", ""),
        "bad.toml: `[rest]` is missing: needs a section with exactly one of pole_stretch, pressure_kpa, \
         equator_radius_mm, height_mm; a fingertip that is not stretched at rest has none, and is no membrane: give \
         [model] kind = \"auto\" or \"solid\""
    );
}

#[test]
fn names_a_missing_key_and_the_line_of_its_section() {
    assert_eq!(
        error("thickness_mm = 1\n", ""),
        "bad.toml:3: `membrane.thickness_mm` is missing: needs a number above 0 and at most 1000 mm"
    );
    assert!(error("name = \"bench-tip\"\n", "").starts_with("bad.toml: `name` is missing: needs 1 to 64 "));
    assert!(error("c2_pa = 46559\n", "").contains("`material.c2_pa` is missing"));
    assert!(error("resolution_pa = 10.0\n", "").contains("`transducer.resolution_pa` is missing"));
    assert!(
        error("from_percent_of_full_scale = 1.0\n", "").contains("`accuracy.from_percent_of_full_scale` is")
    );
    assert!(error("max_indentation_mm = 2.5\n", "").contains("`press.max_indentation_mm` is missing"));
}

#[test]
fn names_an_unknown_key_and_its_line() {
    assert_eq!(
        error("thickness_mm = 1\n", "thickness_mm = 1\nwall_mm = 1\n"),
        "bad.toml:7: `membrane.wall_mm` is not a known key: allowed are radial_semi_axis_mm, \
         axial_semi_axis_mm, thickness_mm"
    );
    assert!(
        error("[press]", "[pres]")
            .starts_with("bad.toml:13: `pres` is not a known key, did you mean `press`?: allowed are name")
    );
    assert!(
        error("pole_stretch", "pole_strech")
            .contains("`rest.pole_strech` is not a known key, did you mean `pole_stretch`?")
    );
    assert!(
        error("law = \"mooney-rivlin\"", "law = \"neo-hookean\"").contains("`material.c2_pa` is not a known")
    );
    assert!(
        error("resolution_pa", "address = 0x28\nresolution_pa")
            .contains("`transducer.address` is not a known key")
    );
}

/// What to replace in the good file, by what, and the key that the error must name.
const IMPOSSIBLE: &[(&str, &str, &str)] = &[
    (
        "thickness_mm = 1\n",
        "thickness_mm = 2.7\n",
        "membrane.thickness_mm",
    ),
    (
        "thickness_mm = 1\n",
        "thickness_mm = nan\n",
        "membrane.thickness_mm",
    ),
    (
        "thickness_mm = 1\n",
        "thickness_mm = \"1\"\n",
        "membrane.thickness_mm",
    ),
    ("= 4.5", "= inf", "membrane.radial_semi_axis_mm"),
    ("160_355.0", "0", "material.c1_pa"),
    ("c2_pa = 46559", "c2_pa = -160355", "material.c2_pa"),
    ("c2_pa = 46559", "c2_pa = -2e5", "material.c2_pa"),
    ("mooney-rivlin", "ogden", "material.law"),
    ("\"mooney-rivlin\"", "3", "material.law"),
    ("= 2.3", "= 1.0", "rest.pole_stretch"),
    ("bench-tip", "../tip", "name"),
    ("bench-tip", "", "name"),
    (
        "max_indentation_mm = 2.5",
        "max_indentation_mm = 0",
        "press.max_indentation_mm",
    ),
    ("[0, 400.0]", "[400, 0]", "transducer.range_kpa"),
    ("[0, 400.0]", "[0, 400.0, 1]", "transducer.range_kpa"),
    ("[0, 400.0]", "[-200, 400.0]", "transducer.range_kpa"),
    ("[0, 400.0]", "400.0", "transducer.range_kpa"),
    (
        "resolution_pa = 10.0",
        "resolution_pa = 0",
        "transducer.resolution_pa",
    ),
    (
        "resolution_pa = 10.0",
        "resolution_pa = 5e5",
        "transducer.resolution_pa",
    ),
    (
        "resolution_pa = 10.0",
        "resolution_pa = 1\nnoise_pa = -1",
        "transducer.noise_pa",
    ),
    (
        "resolution_pa",
        "output_fraction_at_range = [0.9, 0.1]\nresolution_pa",
        "transducer.output_fraction_at_range",
    ),
    (
        "resolution_pa",
        "output_fraction_at_range = [0.1, 1.1]\nresolution_pa",
        "transducer.output_fraction_at_range",
    ),
    (
        "resolution_pa",
        "supply = \"battery\"\nresolution_pa",
        "transducer.supply",
    ),
    (
        "resolution_pa",
        "source_ohm = 10001\nresolution_pa",
        "transducer.source_ohm",
    ),
    (
        "resolution_pa",
        "source_ohm = -1\nresolution_pa",
        "transducer.source_ohm",
    ),
    (
        "resolution_pa",
        "supply = \"measured\"\nsource_ohm = 3400\nresolution_pa",
        "transducer.source_ohm",
    ),
    (
        "resolution_pa",
        "source_ohm = 3400\npull_up_ohm = 1000\nresolution_pa",
        "transducer.pull_up_ohm",
    ),
    (
        "resolution_pa",
        "pull_up_ohm = 1e6\nresolution_pa",
        "transducer.pull_up_ohm",
    ),
    ("\"ratiometric\"", "\"bmp280\"", "transducer.kind"),
    ("\"ratiometric\"", "\"dps310\"", "transducer.range_kpa"),
    ("\"ratiometric\"", "\"ms5837-02ba\"", "transducer.range_kpa"),
    ("[0, 400.0]", "[0, 2500.0]", "transducer.range_kpa"),
    ("[0, 400.0]", "[-20, 1999.0]", "transducer.range_kpa"),
    (
        "resolution_pa",
        "quantity = \"differential\"\nresolution_pa",
        "transducer.quantity",
    ),
    (
        "\"ratiometric\"",
        "\"abp2\"\nquantity = \"absolute\"",
        "transducer.quantity",
    ),
    (
        "\"ratiometric\"",
        "\"dps310\"\nquantity = \"gauge\"",
        "transducer.quantity",
    ),
    // Ends that leave out the air that the part stands in.
    (
        "[0, 400.0]",
        "[0, 100.0]\nquantity = \"absolute\"",
        "transducer.range_kpa",
    ),
    (
        "[0, 400.0]",
        "[-80, 150.0]\nquantity = \"absolute\"",
        "transducer.range_kpa",
    ),
    (
        "[0, 400.0]",
        "[70, 250.0]\nquantity = \"absolute\"",
        "transducer.range_kpa",
    ),
    (
        "\"ratiometric\"",
        "\"abp2\"\naddress = 0x80",
        "transducer.address",
    ),
    (
        "\"ratiometric\"",
        "\"abp2\"\naddress = 40.5",
        "transducer.address",
    ),
    (
        "\"ratiometric\"",
        "\"abp2\"\ntransfer = \"C\"",
        "transducer.transfer",
    ),
    (
        "\"ratiometric\"",
        "\"dps310\"\naddress = 0x28",
        "transducer.address",
    ),
    ("= 0.1", "= 0", "accuracy.force_percent_of_reading"),
    (
        "[press]",
        "[fluid]\ncompliance_mm3_per_kpa = -1\n[press]",
        "fluid.compliance_mm3_per_kpa",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 0\n[press]",
        "actuator.diameter_mm",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 9\nthickness_mm = 9\n[press]",
        "actuator.thickness_mm",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 9\nthickness_mm = 1\ngap_mm = -0.1\n[press]",
        "actuator.gap_mm",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 9\ngap_mm = 0.1\n[press]",
        "actuator.gap_mm",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 9\nthickness_mm = 1\nfoundation_kpa_per_mm = 0\n[press]",
        "actuator.foundation_kpa_per_mm",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 9\n[actuator.material]\npreset = \"rubber\"\n[press]",
        "actuator.material.preset",
    ),
    (
        "[press]",
        "[actuator]\ndiameter_mm = 9\n[actuator.material]\npreset = \"agilus30\"\n[actuator.material.relaxation]\n\
         preset = \"agilus30\"\n[press]",
        "actuator.material",
    ),
    ("[press]", "[model]\nkind = \"beam\"\n[press]", "model.kind"),
    (
        "[press]",
        "[calibration]\npressure_gain = 0\n[press]",
        "calibration.pressure_gain",
    ),
    (
        "[press]",
        "[calibration]\nthickness_factor = 2.7\n[press]",
        "calibration.thickness_factor",
    ),
    (
        "[press]",
        "[zero]\ndrift_pa_per_hour = 0\n[press]",
        "zero.drift_pa_per_hour",
    ),
    (
        "[press]",
        "[zero]\nper_kelvin_pa = \"small\"\n[press]",
        "zero.per_kelvin_pa",
    ),
    (
        "[press]",
        "[zero]\nfluid_head_pa = -70\n[press]",
        "zero.fluid_head_pa",
    ),
    (
        "[press]",
        "[zero]\nhysteresis_pa = 1e6\n[press]",
        "zero.hysteresis_pa",
    ),
    ("[press]", "[zero]\ncreep_pa = true\n[press]", "zero.creep_pa"),
    ("[press]", "[zero]\nbound_pa = 0\n[press]", "zero.bound_pa"),
    (
        "[press]",
        "[zero]\nfluid_head_pa = 70\nbound_pa = 75\n[press]",
        "zero.bound_pa",
    ),
    ("[press]", "[air]\nreference = \"gps\"\n[press]", "air.reference"),
    ("[press]", "[air]\nreference = \"host\"\n[press]", "air.reference"),
    (
        "law = \"mooney-rivlin\"\nc1_pa = 160_355.0\nc2_pa = 46559\n",
        "preset = \"rubber\"\n",
        "material.preset",
    ),
    (
        "law = \"mooney-rivlin\"",
        "preset = \"agilus30\"\nlaw = \"mooney-rivlin\"",
        "material.law",
    ),
];

/// A curve from data with one of its lines replaced.
fn with_curve(from: &str, to: &str) -> Result<DesignFile, DesignFileError> {
    const CURVE: &str = "[calibration]\nrest_pressure_kpa = 0.5\n\
        curve_pressure_rise_kpa = [0.1, 0.3, 0.6, 1.0, 1.5, 2.1]\n\
        curve_force_n = [0.05, 0.2, 0.5, 0.9, 1.4, 2.0]\n\
        curve_indentation_mm = [0.2, 0.5, 0.9, 1.3, 1.7, 2.0]\n";
    assert!(CURVE.contains(from), "{from}");
    DesignFile::parse(&(GOOD.to_owned() + &CURVE.replacen(from, to, 1)), "c.toml")
}

#[test]
fn what_may_move_the_zero_is_stated_in_its_own_sections() {
    let unstated = DesignFile::parse(GOOD, "z.toml").expect("a design");
    assert_eq!(unstated.zero.assumptions(unstated.air), ZeroAssumptions::NONE);
    assert!(!unstated.canonical().contains("[zero]") && !unstated.canonical().contains("[air]"));

    let zero = "[zero]\ndrift_pa_per_hour = 4\nper_kelvin_pa = 2.5\nfluid_head_pa = 70\nhysteresis_pa = 40\ncreep_pa = 30\n\
                bound_pa = 250\n[air]\nreference = \"host\"\n";
    let absolute = GOOD.replacen(
        "[transducer]\nkind = \"ratiometric\"\nrange_kpa = [0, 400.0]",
        "[transducer]\nkind = \"dps310\"\nrange_kpa = [0, 12.0]",
        1,
    );
    let file = DesignFile::parse(&(absolute + zero), "z.toml").expect("a design");
    let stated = ZeroAssumptions {
        drift: 4_000,
        per_kelvin: 2_500,
        fluid_head: 70_000,
        hysteresis: 40_000,
        creep: 30_000,
        bound: 250_000,
        air: AirReference::Host,
    };
    assert_eq!(file.zero.assumptions(file.air), stated);
    let again = DesignFile::parse(&file.canonical(), "again.toml").expect("it was printed");
    assert_eq!((again.zero, again.air), (file.zero, file.air));
    assert_ne!(
        file.hash(),
        DesignFile {
            zero: ZeroSection::default(),
            ..file
        }
        .hash()
    );
}

/// 10 Pa of noise: half of it and 70 Pa of head are above the 60 Pa that a bound is by default.
#[test]
fn a_zero_of_which_no_reading_is_ever_ok_is_refused_with_the_bound_that_it_needs() {
    let error = |keys: &str| {
        DesignFile::parse(&(GOOD.to_owned() + keys), "z.toml")
            .expect_err("never ok")
            .to_string()
    };
    let head = error("[zero]\nfluid_head_pa = 70\n");
    assert!(
        head.contains("`zero.bound_pa` is missing: needs more than 75 Pa") && head.contains("60 Pa"),
        "{head}"
    );
    // This part does not tell its temperature: ten kelvins.
    let warm = error("[zero]\nper_kelvin_pa = 8\nbound_pa = 80\n");
    assert!(
        warm.contains("`zero.bound_pa` is 80: must be more than 85 Pa"),
        "{warm}"
    );
}

#[test]
fn a_calibration_scales_the_design_and_leaves_its_text() {
    let text = GOOD.to_owned()
        + "[calibration]\nmaterial_factor = 2\nthickness_factor = 0.5\npole_stretch = 1.5\n\
           compliance_mm3_per_kpa = 3\npressure_gain = 1.1\npressure_offset_kpa = 0.2\nindentation_offset_mm = 0.1\n";
    let file = DesignFile::parse(&text, "c.toml").expect("a calibration");
    let design = file.design();
    assert_eq!(
        design.law,
        Law::MooneyRivlin {
            c1: 320_710.0,
            c2: 93_118.0
        }
    );
    assert!((design.membrane.thickness - 0.5e-3).abs() < 1e-17);
    assert_eq!(design.rest, RestBy::PoleStretch(1.5));
    assert!((design.compliance - 3e-12).abs() < 1e-24);
    assert_eq!(file.membrane, good().membrane);
    // 1.1 times 10 kPa and 0.2 kPa.
    assert!((file.calibration.pressure_read(10e3) - 11_200.0).abs() < 1e-9);
    assert!((file.calibration.indentation_of(0.5e-3) - 0.4e-3).abs() < 1e-15);
    let again = DesignFile::parse(&file.canonical(), "again.toml").expect("its canonical text");
    assert_eq!(file, again);
    assert_ne!(file.hash(), good().hash());
}

#[test]
fn an_empty_calibration_is_none() {
    let file = DesignFile::parse(&(GOOD.to_owned() + "[calibration]\n"), "c.toml").expect("empty");
    assert_eq!(file.hash(), good().hash());
}

#[test]
fn a_material_by_name_is_its_constants() {
    let law = "law = \"mooney-rivlin\"\nc1_pa = 160_355.0\nc2_pa = 46559\n";
    let named = DesignFile::parse(&GOOD.replace(law, "preset = \"agilus30\"\n"), "n.toml").expect("a preset");
    assert_eq!(named, good());
    assert!(
        error("law = \"mooney-rivlin\"", "preset = \"skin\"").contains("`material.c1_pa` is not a known")
    );
}

#[test]
fn a_curve_from_data_is_read_back_and_runs_through_its_knots() {
    let file = with_curve("0.5", "0.5").expect("a curve");
    assert_eq!(
        DesignFile::parse(&file.canonical(), "again.toml").expect("its canonical text"),
        file
    );
    let curve = file.calibration.curve.expect("given");
    let points = curve.points(1.3e-3);
    let end = points.last().expect("points");
    assert!((end.pressure_rise - 1000.0).abs() < 1e-6 && (end.force - 0.9).abs() < 1e-9);
    assert!(points.windows(2).all(|pair| pair[0].force < pair[1].force));
}

#[test]
fn a_curve_from_data_grows_and_is_whole() {
    let text = |from: &str, to: &str| with_curve(from, to).expect_err("must be refused").to_string();
    assert!(text("0.9, 1.4", "0.9, 0.8").contains("`calibration.curve_force_n` is [0.05"));
    assert!(text("rest_pressure_kpa = 0.5\n", "").contains("`calibration.rest_pressure_kpa` is missing"));
    assert!(
        text("[0.2, 0.5, ", "[0.1, 0.2, 0.5, ").contains("as many numbers as curve_pressure_rise_kpa has, 6")
    );
    assert!(text("[0.1, 0.3,", "[0.3,").contains("6 to 1000 strictly increasing numbers"));
}

#[test]
fn names_an_impossible_value_the_line_and_what_is_allowed() {
    assert_eq!(
        error("thickness_mm = 1\n", "thickness_mm = -1\n"),
        "bad.toml:6: `membrane.thickness_mm` is -1: must be a number above 0 and at most 1000 mm"
    );
    for (from, to, key) in IMPOSSIBLE {
        let text = error(from, to);
        assert!(
            text.contains(&format!("`{key}` is ")) && text.contains(": must be "),
            "{text}"
        );
        assert!(text.starts_with("bad.toml:"), "{text}");
    }
}

#[test]
fn names_a_slip_of_the_unit() {
    for (from, to, meant) in [
        ("160_355.0", "0.16", "in Pa: 160000 Pa if 0.16 is in MPa"),
        ("160_355.0", "160", "in Pa: 160000 Pa if 160 is in kPa"),
        ("160_355.0", "1.6e-4", "in Pa: 160000 Pa if 0.00016 is in GPa"),
        ("= 4.5", "= 0.0045", "in mm: 4.5 mm if 0.0045 is in m"),
        ("= 4.5", "= 4500", "in mm: 4.5 mm if 4500 is in um"),
        (
            "thickness_mm = 1\n",
            "thickness_mm = 0.001\n",
            "in mm: 1 mm if 0.001 is in m",
        ),
        (
            "max_indentation_mm = 2.5",
            "max_indentation_mm = 0.0025",
            "in mm: 2.5 mm if 0.0025 is in m",
        ),
    ] {
        let text = error(from, to);
        assert!(text.contains(meant), "{text}");
    }
}

#[test]
fn wants_exactly_one_kind_of_rest() {
    let text = error("pole_stretch = 2.3", "pole_stretch = 2.3\nheight_mm = 4");
    assert!(
        text.contains("`rest.height_mm` is 4: must be left out, as pole_stretch is given"),
        "{text}"
    );
    let text = error("pole_stretch = 2.3\n", "");
    assert!(
        text.contains("`rest.pole_stretch` is missing: needs exactly one of"),
        "{text}"
    );
}

#[test]
fn a_solid_rests_unstretched_or_at_a_pressure() {
    let solid = |rest: &str, keys: &str| {
        let text = GOOD.replacen("[rest]\npole_stretch = 2.3\n", rest, 1);
        DesignFile::parse(&format!("{text}[model]\nkind = \"solid\"\n{keys}"), "solid.toml")
    };
    let file = solid("", "").expect("an unstretched solid");
    assert_eq!(file.rest, RestSection::Unstretched);
    assert_eq!(
        file.model,
        ModelSection::Solid {
            through: 2,
            along: 60
        }
    );
    let finer = solid("[rest]\npressure_kpa = 20\n", "through = 1\nalong = 60\n").expect("an inflated solid");
    assert_eq!(finer.rest, RestSection::PressureKpa(20.0));
    assert_eq!(
        finer.model,
        ModelSection::Solid {
            through: 1,
            along: 60
        }
    );
    for file in [file, finer] {
        assert_eq!(DesignFile::parse(&file.canonical(), "canonical.toml"), Ok(file));
    }
    for (rest, keys, says) in [
        (
            "[rest]\npole_stretch = 2.3\n",
            "",
            "`rest.pole_stretch` is 2.3: must be left out: with this model.kind [rest] takes pressure_kpa, or no",
        ),
        (
            "[rest]\n",
            "",
            "`rest.pressure_kpa` is missing: needs pressure_kpa, or no [rest]",
        ),
        (
            "",
            "through = 1.5\n",
            "`model.through` is 1.5: must be a whole number",
        ),
        (
            "",
            "along = 0\n",
            "`model.along` is 0: must be a number at least 4",
        ),
        (
            "",
            "layers = 2\n",
            "`model.layers` is not a known key: allowed are kind, through, along",
        ),
    ] {
        let text = solid(rest, keys).expect_err(says).to_string();
        assert!(text.contains(says), "{text}");
    }
}

/// The object of the good file with an `[object]` of these lines.
fn object(lines: &str) -> Result<Option<ObjectSection>, String> {
    let file = DesignFile::parse(&format!("{GOOD}[object]\n{lines}"), "object.toml");
    let file = file.map_err(|error| error.to_string())?;
    let again = DesignFile::parse(&file.canonical(), "again.toml").expect("its canonical text");
    assert_eq!(again, file);
    Ok(file.object)
}

#[test]
fn an_object_is_a_plate_a_ball_a_cup_a_cylinder_or_a_punch() {
    assert_eq!(good().object, None);
    assert_eq!(good().design().object, Object::PLATE);
    let mm = |millimetres: f64| millimetres * 1e-3;
    for (lines, shape, friction) in [
        ("", Shape::Plate, Friction::NONE),
        ("friction = 0.3\n", Shape::Plate, Friction::Coulomb(0.3)),
        ("radius_mm = 8\n", Shape::Ball { radius: mm(8.0) }, Friction::NONE),
        (
            "shape = \"ball\"\nradius_mm = -20.0\nfriction = \"stick\"\n",
            Shape::Cup { radius: mm(20.0) },
            Friction::Stick,
        ),
        (
            "shape = \"cylinder\"\nradius_mm = 5.0\n",
            Shape::Cylinder { radius: mm(5.0) },
            Friction::NONE,
        ),
        (
            "shape = \"punch\"\nradius_mm = 3.0\nrim_mm = 0.2\nunknown = false\n",
            Shape::Punch {
                radius: mm(3.0),
                rim: mm(0.2),
            },
            Friction::NONE,
        ),
    ] {
        let found = object(lines).expect(lines).expect("an object");
        assert_eq!(found.object(), Object { shape, friction }, "{lines}");
        assert!(!found.unknown);
    }
    assert!(
        object("unknown = true\n")
            .expect("unknown")
            .expect("an object")
            .unknown
    );
}

/// Each object has tables of its own: designs that differ in it alone have different hashes, and none has that of the plain one.
#[test]
fn an_object_belongs_to_the_hash() {
    let hash = |lines: &str| {
        DesignFile::parse(&format!("{GOOD}{lines}"), "object.toml")
            .expect(lines)
            .hash()
    };
    let hashes = [
        "",
        "[object]\n",
        "[object]\nradius_mm = 8\n",
        "[object]\nfriction = 0.3\n",
    ]
    .map(hash);
    for (i, one) in hashes.iter().enumerate() {
        assert!(!hashes[..i].contains(one));
    }
}

#[test]
fn an_impossible_object_is_refused_with_its_key() {
    for (lines, says) in [
        (
            "radius_mm = 0\n",
            "`object.radius_mm` is 0: must be a ball's radius above 0, a cup's below 0",
        ),
        (
            "shape = \"cone\"\n",
            "`object.shape` is \"cone\": must be \"ball\", \"cylinder\" or \"punch\"",
        ),
        (
            "shape = \"cylinder\"\n",
            "`object.radius_mm` is missing: needs a number above 0",
        ),
        (
            "shape = \"cylinder\"\nradius_mm = -5\n",
            "`object.radius_mm` is -5: must be a number above 0",
        ),
        (
            "shape = \"punch\"\nradius_mm = 3\n",
            "`object.rim_mm` is missing: needs a number above 0",
        ),
        (
            "shape = \"punch\"\nradius_mm = 3\nrim_mm = 4\n",
            "`object.rim_mm` is 4: must be at most radius_mm, 3 mm",
        ),
        (
            "radius_mm = 3\nrim_mm = 1\n",
            "`object.rim_mm` is 1: must be left out: only shape = \"punch\"",
        ),
        (
            "friction = -0.1\n",
            "`object.friction` is -0.1: must be a number at least 0 and at most 10, or \"stick\"",
        ),
        (
            "friction = \"glue\"\n",
            "`object.friction` is \"glue\": must be a number at least 0",
        ),
        ("unknown = 1\n", "`object.unknown` is 1: must be true or false"),
        (
            "unknown = true\nradius_mm = 8\n",
            "`object.unknown` is true: must be false or left out",
        ),
        (
            "diameter_mm = 8\n",
            "`object.diameter_mm` is not a known key: allowed are shape, radius_mm, rim_mm, friction, unknown",
        ),
    ] {
        let text = object(lines).expect_err(says);
        assert!(text.contains(says), "{text}");
        assert_eq!(text.lines().count(), 1, "{text}");
    }
}

#[test]
fn auto_takes_a_wall_in_any_rest_that_a_solid_can_have() {
    let auto = |rest: &str| {
        let text = GOOD.replacen("[rest]\npole_stretch = 2.3\n", rest, 1);
        DesignFile::parse(&format!("{text}[model]\nkind = \"auto\"\n"), "auto.toml")
    };
    for (rest, expected) in [
        ("", RestSection::Unstretched),
        ("[rest]\npressure_kpa = 20\n", RestSection::PressureKpa(20.0)),
        ("[rest]\npole_stretch = 1.3\n", RestSection::PoleStretch(1.3)),
    ] {
        let file = auto(rest).expect("a design");
        assert_eq!((file.rest, file.model), (expected, ModelSection::Auto));
        assert_eq!(DesignFile::parse(&file.canonical(), "canonical.toml"), Ok(file));
    }
    let text = auto("[rest]\nheight_mm = 4\n")
        .expect_err("no such rest")
        .to_string();
    assert!(text.contains("`rest.height_mm` is 4: must be left out"), "{text}");
}

#[test]
fn a_membrane_has_no_elements_to_choose() {
    let text = error("[press]", "[model]\nthrough = 2\n[press]");
    assert!(
        text.contains("`model.through` is not a known key: allowed are kind"),
        "{text}"
    );
}

#[test]
fn reports_broken_toml_with_its_line() {
    let text = error("thickness_mm = 1\n", "thickness_mm = \n");
    assert!(text.starts_with("bad.toml:6: not valid TOML: "), "{text}");
}

#[test]
fn reports_a_file_that_cannot_be_read() {
    let text = DesignFile::read(Path::new("no/such/design.toml"))
        .expect_err("there is no such file")
        .to_string();
    assert!(
        text.starts_with("no/such/design.toml: the design file cannot be read: "),
        "{text}"
    );
    assert_eq!(text.lines().count(), 1);
}

#[test]
fn the_shipped_designs_are_complete() {
    for name in ["index-fingertip-elastic", "paper-prestretched", "skin-analogue"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("designs")
            .join(name)
            .with_extension("toml");
        let file = DesignFile::read(&path).expect("a shipped design");
        assert_eq!(file.name, name);
        assert!(file.max_indentation_mm.is_some() && file.transducer.is_some() && file.accuracy.is_some());
    }
}

const RELAXATION: &str = "[material.relaxation]\ntau_s = [0.1, 1.0, 10]\ng = [18.78, 4.459, 0]\n\
                          temperature_c = 21.5\nshift_per_kelvin = 0.31\n[rest]";

/// GOOD with a series, in which `from` is replaced by `to`.
fn with_series(from: &str, to: &str) -> Result<DesignFile, DesignFileError> {
    assert!(RELAXATION.contains(from), "{from}");
    let text = GOOD.replace("[rest]", &RELAXATION.replacen(from, to, 1));
    DesignFile::parse(&text, "r.toml")
}

#[test]
fn a_series_is_kept_with_and_without_a_calibration() {
    let file = with_series("", "").expect("a series");
    let series = file.relaxation.expect("given");
    let terms: Vec<[f64; 2]> = series
        .terms()
        .iter()
        .map(|term| [term.time, term.weight])
        .collect();
    assert_eq!(terms, [[0.1, 18.78], [1.0, 4.459], [10.0, 0.0]]);
    assert!((series.temperature - 21.5).abs() < 1e-12 && (series.shift - 0.31).abs() < 1e-12);
    assert_ne!(file.hash(), good().hash());
    assert_eq!(good().relaxation, None);
    for calibration in ["", "[calibration]\nmaterial_factor = 2\n"] {
        let text = GOOD.replace("[rest]", RELAXATION) + calibration;
        let file = DesignFile::parse(&text, "r.toml").expect("a series");
        assert_eq!(file.relaxation, Some(series));
        let again = DesignFile::parse(&file.canonical(), "again.toml").expect("its canonical text");
        assert_eq!(file, again);
    }
}

#[test]
fn a_series_by_name_is_the_materials_own() {
    let all = &RELAXATION[RELAXATION.find("tau_s").expect("tau")..RELAXATION.find("[rest]").expect("rest")];
    let named = with_series(all, "preset = \"agilus30\"\n").expect("a series");
    assert_eq!(
        named.relaxation,
        Some(crate::material::relaxation::AGILUS30_RELAXATION)
    );
    let error = with_series(all, "preset = \"skin\"\n")
        .expect_err("no series")
        .to_string();
    assert!(error.contains("`material.relaxation.preset` is \"skin\"") && error.contains("\"agilus30\""));
}

#[test]
fn refuses_a_series_that_cannot_be() {
    for (from, to, wanted) in [
        (
            "[0.1, 1.0, 10]",
            "[0.1, 1.0, 1.0]",
            "`material.relaxation.tau_s` is [0.1, 1.0, 1.0]",
        ),
        (
            "[0.1, 1.0, 10]",
            "[5e-5, 1.0, 10]",
            "at least 0.0001 and at most 10000 s",
        ),
        (
            "[0.1, 1.0, 10]",
            "[1, 2, 3, 4, 5, 6, 7, 8, 9]",
            "1 to 8 strictly increasing numbers",
        ),
        (
            "4.459, 0]",
            "4.459]",
            "`material.relaxation.g` is [18.78, 4.459]: must be 3 numbers",
        ),
        ("4.459", "-1", "`material.relaxation.g` is [18.78, -1, 0]"),
        (
            "g = [18.78, 4.459, 0]\n",
            "",
            "`material.relaxation.g` is missing",
        ),
        (
            "temperature_c = 21.5\n",
            "",
            "`material.relaxation.temperature_c` is missing",
        ),
        ("21.5", "300", "degrees Celsius"),
        ("0.31", "-0.31", "`material.relaxation.shift_per_kelvin` is -0.31"),
        (
            "temperature_c",
            "temperature",
            "`material.relaxation.temperature_c` is missing",
        ),
        (
            "[rest]",
            "ln_g = 1\n[rest]",
            "`material.relaxation.ln_g` is not a known key",
        ),
    ] {
        let text = with_series(from, to).expect_err(to).to_string();
        assert!(text.contains(wanted), "{text}");
        assert_eq!(text.lines().count(), 1, "{text}");
    }
}

/// Half a wall of 1 mm, worked by hand: 4.5 and 2.7 mm to the outer surface are 4.0 and 2.2 mm to the middle of it.
#[test]
fn semi_axes_are_converted_to_what_the_model_is_solved_with() {
    let read = |model: &str| {
        let text = GOOD.replacen("[press]", &format!("[model]\n{model}[press]"), 1);
        DesignFile::parse(&text, "axes.toml").expect("a design")
    };
    for (model, radial, axial) in [
        ("kind = \"membrane\"\n", 4.5, 2.7),
        ("kind = \"membrane\"\naxes = \"mid\"\n", 4.5, 2.7),
        ("kind = \"membrane\"\naxes = \"outer\"\n", 4.0, 2.2),
        ("axes = \"outer\"\n", 4.0, 2.2),
        ("kind = \"auto\"\n", 4.5, 2.7),
        ("kind = \"auto\"\naxes = \"outer\"\n", 4.5, 2.7),
        ("kind = \"auto\"\naxes = \"mid\"\n", 5.0, 3.2),
    ] {
        let file = read(model);
        let membrane = file.design().membrane;
        for (got, expected) in [
            (membrane.radial_semi_axis, radial),
            (membrane.axial_semi_axis, axial),
        ] {
            assert!((1e3 * got - expected).abs() < 1e-12, "{model}: {got} m");
        }
        assert!((1e3 * membrane.thickness - 1.0).abs() < 1e-12);
        let printed = DesignFile::parse(&file.canonical(), "printed.toml").expect("as printed");
        assert_eq!(printed, file, "{model}");
    }
    // What goes without saying changes no hash.
    assert_eq!(
        read("kind = \"membrane\"\naxes = \"mid\"\n").hash(),
        good().hash()
    );
    let text = GOOD.replacen("[press]", "[model]\naxes = \"inner\"\n[press]", 1);
    let error = DesignFile::parse(&text, "bad.toml")
        .expect_err("must be refused")
        .to_string();
    assert!(error.contains("`model.axes` is \"inner\""), "{error}");
}

#[test]
fn the_error_of_the_model_is_any_positive_percentage() {
    let key = "from_percent_of_full_scale = 1.0";
    let read = |percent: &str| {
        let text = GOOD.replacen(key, &format!("{key}\nmodel_percent = {percent}"), 1);
        DesignFile::parse(&text, "percent.toml")
    };
    let percent = |file: &DesignFile| file.accuracy.expect("the section").model_percent;
    assert!((percent(&good()) - DEFAULT_MODEL_PERCENT).abs() < 1e-12);
    assert_eq!(read("5.0").expect("the default").hash(), good().hash());
    for given in ["1e-6", "250.0"] {
        let file = read(given).expect("a positive number");
        assert!((percent(&file) - given.parse::<f64>().expect("a number")).abs() < 1e-12);
        let printed = DesignFile::parse(&file.canonical(), "printed.toml").expect("as printed");
        assert_eq!(printed, file);
    }
    for refused in ["0.0", "-1.0", "nan", "inf"] {
        let error = read(refused).expect_err("must be refused").to_string();
        assert!(error.contains("`accuracy.model_percent`"), "{error}");
    }
}
