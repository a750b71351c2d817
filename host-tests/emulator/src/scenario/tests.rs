use super::*;

const TRAPEZIUM: &str = r#"
        about = "up, stay, down"
        [[phase]]
        name = "rest"
        duration_ms = 100
        [[phase]]
        name = "press"
        duration_ms = 200
        to_percent = 50
        [[phase]]
        name = "hold"
        duration_ms = 100
        [[phase]]
        name = "release"
        duration_ms = 100
        to_percent = 0
        [[wire]]
        is = "open"
        from_ms = 150
        until_ms = 160
    "#;

fn parsed(text: &str) -> Result<Scenario, String> {
    let scenario: Scenario = toml::from_str(text).map_err(|error| error.message().to_owned())?;
    scenario.check().map_err(|error| error.to_string())?;
    Ok(scenario)
}

#[test]
fn the_plate_follows_the_phases() {
    let scenario = parsed(TRAPEZIUM).expect("it is well formed");
    for (time, share, phase) in [
        (0.05, 0.0, "rest"),
        (0.2, 0.25, "press"),
        (0.35, 0.5, "hold"),
        (0.475, 0.125, "release"),
        (9.0, 0.0, "release"),
    ] {
        assert!(
            (scenario.indentation_share(time) - share).abs() < 1e-12,
            "at {time} s"
        );
        assert_eq!(scenario.phase_at(time), phase);
    }
    assert!((scenario.duration() - 0.5).abs() < 1e-12);
}

#[test]
fn the_air_is_that_of_the_file_or_the_standard_atmosphere() {
    let air = |words: &str| {
        let scenario = parsed(&format!("{words}\n{TRAPEZIUM}")).expect("it is well formed");
        scenario.air_kpa
    };
    assert!((air("") - 101.325).abs() < 1e-12);
    assert!((air("air_kpa = 80") - 80.0).abs() < 1e-12);
}

#[test]
fn the_wire_is_faulty_in_its_window_alone() {
    let scenario = parsed(TRAPEZIUM).expect("it is well formed");
    assert_eq!(scenario.wiring(0.149), Wiring::Sound);
    assert_eq!(scenario.wiring(0.155), Wiring::Open);
    assert_eq!(scenario.wiring(0.160), Wiring::Sound);
}

#[test]
fn unknown_keys_and_impossible_values_are_named() {
    let with = |from: &str, to: &str| parsed(&TRAPEZIUM.replacen(from, to, 1)).expect_err("it is wrong");
    assert!(with("duration_ms = 100", "duration_s = 100").contains("duration_s"));
    assert_eq!(
        with("to_percent = 50", "to_percent = 101"),
        "phase[1].to_percent = 101, but it must be from 0 to 100"
    );
    let air = |kpa: &str| parsed(&format!("air_kpa = {kpa}\n{TRAPEZIUM}"));
    for kpa in ["29.9", "120.1", "nan"] {
        let error = air(kpa).expect_err("no place has such air");
        assert!(
            error.starts_with("air_kpa = ") && error.ends_with("it must be from 30 to 120"),
            "{error}"
        );
    }
    assert!(with("duration_ms = 200", "duration_ms = -1").contains("phase[1].duration_ms = -1"));
    assert!(with("until_ms = 160", "until_ms = 150").contains("above from_ms"));
    assert!(with("\"open\"", "\"loose\"").contains("loose"));
    let event = |words: &str| {
        let text = format!("{TRAPEZIUM}\n[[event]]\nat_ms = 10\n{words}");
        parsed(&text)
    };
    assert!(event("is = \"hang\"").is_err_and(|error| error.contains("event[0].for_ms")));
    assert!(event("is = \"tare\"\nfor_ms = 1").is_err_and(|error| error.contains("left out")));
    assert!(event("is = \"flood\"\nfor_ms = 1").is_ok());
}

/// What is wrong with the two keys of objects and with the force, one line each, with the key, the value found and what is allowed.
#[test]
fn wrong_objects_and_forces_are_named_in_one_line() {
    let refusal = |text: &str| {
        let error = parsed(text).expect_err(text);
        assert!(!error.contains('\n') && !error.is_empty(), "{error}");
        error
    };
    let radius = "it must be from 1 to 1000, or from -1000 to -1 for a cup";
    // Of a phase: an untouched rest, then a press onto it.
    let phase = |words: &str| {
        refusal(&format!(
            "about = \"a\"\n[[phase]]\nname = \"rest\"\nduration_ms = 500\n[[phase]]\nname = \"press\"\nduration_ms = 100\n{words}"
        ))
    };
    for (value, found) in [
        ("0", "0"),
        ("0.9", "0.9"),
        ("-0.5", "-0.5"),
        ("1001", "1001"),
        ("-1000.5", "-1000.5"),
        ("inf", "inf"),
        ("nan", "NaN"),
    ] {
        assert_eq!(
            phase(&format!("radius_mm = {value}")),
            format!("phase[1].radius_mm = {found}, but {radius}")
        );
    }
    for (value, found) in [("-0.1", "-0.1"), ("100.1", "100.1"), ("nan", "NaN")] {
        assert_eq!(
            phase(&format!("to_force_n = {value}")),
            format!("phase[1].to_force_n = {found}, but it must be from 0 to 100")
        );
    }
    assert_eq!(
        phase("to_force_n = 1\nto_percent = 10"),
        "phase[1].to_force_n = 1, but it must be left out where there is to_percent"
    );
    assert!(phase("radius_mm = \"ball\"").contains("invalid type: string \"ball\", expected f64"));
    assert!(phase("to_force_n = true").contains("invalid type: boolean `true`, expected f64"));
    for unknown in ["radius = 8", "object = \"ball\"", "force_n = 1", "told = true"] {
        let key = unknown.split(' ').next().expect("a key");
        assert!(
            phase(unknown).contains(&format!("unknown field `{key}`")),
            "{unknown}"
        );
    }
    // An object changes only after the last one left.
    let changed = |first: &str, second: &str| {
        refusal(&format!(
            "about = \"a\"\n[[phase]]\nname = \"a\"\nduration_ms = 500\n{first}\n[[phase]]\nname = \"b\"\nduration_ms = 100\n{second}"
        ))
    };
    let until = "it must be that of the phase before, until it ends at 0";
    assert_eq!(
        changed("to_force_n = 1", "radius_mm = 8"),
        format!("phase[1].radius_mm = 8, but {until}")
    );
    assert_eq!(
        changed(
            "to_percent = 40\nradius_mm = 8",
            "to_percent = 0\nradius_mm = -80"
        ),
        format!("phase[1].radius_mm = -80, but {until}")
    );
    assert_eq!(
        changed("to_force_n = 1\nradius_mm = 8", "to_force_n = 0"),
        format!("phase[1].radius_mm = inf, but {until}")
    );
    // What the chip is told.
    let event = |words: &str| refusal(&format!("{TRAPEZIUM}\n[[event]]\nat_ms = 10\n{words}"));
    for (value, found) in [("0", "0"), ("0.5", "0.5"), ("-2000", "-2000"), ("nan", "NaN")] {
        assert_eq!(
            event(&format!("is = \"object\"\nradius_mm = {value}")),
            format!("event[0].radius_mm = {found}, but {radius}")
        );
    }
    assert_eq!(
        event("is = \"tare\"\nradius_mm = 8"),
        "event[0].radius_mm = 8, but it must be left out but for object"
    );
    assert_eq!(
        event("is = \"object\"\nradius_mm = 8\nfor_ms = 5"),
        "event[0].for_ms = 5, but it must be left out for what does not last"
    );
    assert!(event("is = \"objects\"").contains("unknown variant `objects`"));
    assert!(event("is = \"object\"\nshape = \"cup\"").contains("unknown field `shape`"));
    for told in ["", "radius_mm = 8", "radius_mm = -80"] {
        assert!(
            parsed(&format!(
                "{TRAPEZIUM}\n[[event]]\nat_ms = 10\nis = \"object\"\n{told}"
            ))
            .is_ok()
        );
    }
}

#[test]
fn every_shipped_scenario_is_well_formed() {
    let names = names();
    assert!(names.contains(&"press-hold-release".to_owned()));
    for name in names {
        Scenario::named(&name).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn a_name_that_is_none_lists_those_there_are() {
    let error = Scenario::named("no-such")
        .expect_err("there is no such scenario")
        .to_string();
    assert!(
        error.contains("no-such") && error.contains("press-hold-release"),
        "{error}"
    );
}
