use super::*;

const HAND: &str = r#"
name = "left"
[[tip]]
name = "thumb"
design = "index-fingertip-elastic.toml"
channel = 0
[[tip]]
name = "index"
design = "skin-analogue.toml"
channel = 5
"#;

/// A hand beside the shipped designs.
fn beside_the_designs(text: &str) -> Result<HandFile, DesignFileError> {
    HandFile::parse(text, concat!(env!("CARGO_MANIFEST_DIR"), "/designs/hand.toml"))
}

/// The one line that refuses HAND with `from` replaced by `to`, without the folder.
fn error(from: &str, to: &str) -> String {
    assert!(HAND.contains(from), "{from}");
    let text = HAND.replacen(from, to, 1);
    let error = beside_the_designs(&text)
        .and_then(|hand| hand.designs().map(drop))
        .expect_err("must be refused")
        .to_string();
    assert_eq!(error.lines().count(), 1, "{error}");
    error.replace(concat!(env!("CARGO_MANIFEST_DIR"), "/designs/"), "")
}

#[test]
fn a_hand_has_its_tips_in_order_with_their_designs() {
    let hand = beside_the_designs(HAND).expect("the good file");
    assert_eq!(hand.name, "left");
    let tips: Vec<(&str, TransducerPlace)> = hand
        .tips
        .iter()
        .map(|tip| (tip.name.as_str(), tip.place))
        .collect();
    assert_eq!(
        tips,
        [
            ("thumb", TransducerPlace::Channel(0)),
            ("index", TransducerPlace::Channel(5))
        ]
    );
    let designs = hand.designs().expect("they are shipped");
    assert_eq!(
        [&*designs[0].name, &*designs[1].name],
        ["index-fingertip-elastic", "skin-analogue"]
    );
    assert!(is_hand(HAND));
    // Other names, other places or other designs are another hand.
    let swapped = beside_the_designs(&HAND.replace("channel = 5", "channel = 1")).expect("a hand");
    assert_eq!(hand.hash(&designs), hand.clone().hash(&designs));
    assert_ne!(hand.hash(&designs), swapped.hash(&designs));
    assert_ne!(
        hand.hash(&designs),
        hand.hash(&[designs[1].clone(), designs[0].clone()])
    );
}

#[test]
fn a_design_is_no_hand_and_a_hand_no_design() {
    let design = include_str!("../../../designs/skin-analogue.toml");
    assert!(!is_hand(design));
    let refused = DesignFile::parse(HAND, "hand.toml")
        .expect_err("it has no membrane")
        .to_string();
    assert_eq!(
        refused,
        "hand.toml: this is a hand, which has no fingertip of its own: name the design of one of its tips: \
         index-fingertip-elastic.toml, skin-analogue.toml"
    );
    let refused = HandFile::parse(design, "design.toml")
        .expect_err("it has no tips")
        .to_string();
    assert!(refused.contains("`[[tip]]` is missing"), "{refused}");
}

#[test]
fn what_a_hand_cannot_be_is_one_line_with_the_remedy() {
    for (from, to, line) in [
        (
            "channel = 5",
            "chanel = 5",
            "hand.toml:7: `tip.channel` is missing: needs an analogue input, 0 to 5, or bus for a part on a bus",
        ),
        (
            "channel = 5",
            "channel = 5\npin = 3",
            "hand.toml:11: `tip.pin` is not a known key: allowed are name, design, channel, bus, address, multiplexer",
        ),
        (
            "\"left\"",
            "\"left\"\ncolour = 1",
            "hand.toml:3: `colour` is not a known key: allowed are name, tip",
        ),
        (
            "\"index\"",
            "\"thumb\"",
            "hand.toml:8: `tip.name` is \"thumb\": must be another one than every other tip's of the hand",
        ),
        (
            "channel = 5",
            "channel = 0",
            "hand.toml:10: `tip.channel` is 0: must be another one than that of tip thumb",
        ),
        (
            "channel = 5",
            "channel = 6",
            "hand.toml:10: `tip.channel` is 6: must be a number at least 0 and at most 5 (an analogue input of the board)",
        ),
        (
            "channel = 5",
            "channel = 1.5",
            "hand.toml:10: `tip.channel` is 1.5: must be a whole number",
        ),
        (
            "channel = 5",
            "channel = 5\nbus = 1",
            "hand.toml:11: `tip.bus` is 1: must be left out, as channel is given",
        ),
        (
            "channel = 5",
            "channel = 5\naddress = 40",
            "hand.toml:11: `tip.address` is 40: must be left out, as channel is given",
        ),
        (
            "channel = 5",
            "bus = 2",
            "hand.toml:10: `tip.bus` is 2: must be a number at least 1 and at most 1 (the board's I2C bus)",
        ),
        (
            "channel = 5",
            "bus = 1\nmultiplexer = [0x28, 1]",
            "hand.toml:11: `tip.multiplexer` is [0x28, 1]: must be [address, branch] of a TCA9548A: 0x70 to 0x77, and 0 to 7",
        ),
        (
            "channel = 5",
            "bus = 1",
            "hand.toml:9: `tip.design of index` is skin-analogue.toml: must be one whose transducer is on a bus, as the tip has `bus`; give `channel` for a ratiometric one",
        ),
        (
            "skin-analogue",
            "skin-light-touch",
            "hand.toml:9: `tip.design of index` is skin-light-touch.toml: must be one whose transducer.kind is \"ratiometric\", as the tip has `channel`; give `bus` for a part on a bus",
        ),
        (
            "skin-analogue",
            "missing",
            "missing.toml: the design file cannot be read: No such file or directory (os error 2)",
        ),
    ] {
        let error = error(from, to);
        assert_eq!(error, line, "{from} -> {to}");
    }
}

/// A hand of so many analogue tips.
fn analogue(tips: u8) -> String {
    let tip = |i| {
        format!(
            "[[tip]]\nname = \"t{i}\"\ndesign = \"skin-analogue.toml\"\nchannel = {}\n",
            i % CHANNELS
        )
    };
    format!("name = \"h\"\n{}", (0..tips).map(tip).collect::<String>())
}

#[test]
fn six_analogue_tips_are_the_most() {
    assert_eq!(beside_the_designs(&analogue(6)).expect("six").tips.len(), 6);
    let error = beside_the_designs(&analogue(7)).expect_err("seven").to_string();
    assert!(
        error.ends_with(
            "`tip.channel` is 0: must be left out: a board reads 6 analogue tips, and all are taken"
        ),
        "{error}"
    );
}

/// Two DPS310, whose design has the address 0x77.
fn on_a_bus(first: &str, second: &str) -> Result<(), String> {
    let tip = |name: &str, place: &str| {
        format!("[[tip]]\nname = \"{name}\"\ndesign = \"skin-light-touch.toml\"\nbus = 1\n{place}\n")
    };
    let text = format!("name = \"h\"\n{}{}", tip("a", first), tip("b", second));
    beside_the_designs(&text)
        .and_then(|hand| hand.designs().map(drop))
        .map_err(|error| error.to_string())
}

#[test]
fn two_parts_of_one_address_need_two_branches() {
    for (first, second) in [
        ("address = 0x76", ""),
        ("multiplexer = [0x70, 0]", "multiplexer = [0x70, 1]"),
        ("multiplexer = [0x70, 0]", "multiplexer = [0x71, 0]"),
    ] {
        assert_eq!(on_a_bus(first, second), Ok(()), "{first} {second}");
    }
    for (first, second) in [
        ("", ""),
        ("address = 0x77", ""),
        (
            "multiplexer = [0x70, 3]",
            "multiplexer = [0x70, 3]\naddress = 0x77",
        ),
    ] {
        let error = on_a_bus(first, second).expect_err("they answer at once");
        assert!(
            error.contains(
                "`tip.address of b` is 0x77: must be another one than that of tip a on this branch of the bus"
            ),
            "{error}"
        );
    }
}

#[test]
fn a_hand_is_on_the_converter_or_on_the_bus() {
    let text = format!("{HAND}[[tip]]\nname = \"ring\"\ndesign = \"skin-light-touch.toml\"\nbus = 1\n");
    let error = beside_the_designs(&text)
        .and_then(|hand| hand.designs().map(drop))
        .expect_err("its tips have two periods")
        .to_string();
    assert!(
        error.contains(
            "`tip.place of ring` is on the bus, and that of thumb on the converter: must be on the same as all others"
        ),
        "{error}"
    );
}
