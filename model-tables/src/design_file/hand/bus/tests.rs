use super::*;
use std::fmt::Write as _;

/// A design of a kind of part.
fn design(kind: &str) -> DesignFile {
    let text = include_str!("../../../../designs/skin-light-touch.toml");
    let text = text.replace("kind = \"dps310\"", &format!("kind = \"{kind}\""));
    DesignFile::parse(&text, "design.toml").expect("the good file")
}

/// The round of tips, each of a kind and with more keys, on a board that sets a transaction up in 40 us.
fn round(tips: &[(&str, &str)]) -> Result<BusRound, String> {
    round_on(40, tips)
}

/// The same on a board that takes so many microseconds for that.
fn round_on(set_up: u32, tips: &[(&str, &str)]) -> Result<BusRound, String> {
    let mut text = "name = \"h\"\n".to_owned();
    for (number, (_, keys)) in tips.iter().enumerate() {
        let _ = writeln!(
            text,
            "[[tip]]\nname = \"t{number}\"\ndesign = \"design.toml\"\nbus = 1\n{keys}"
        );
    }
    let file = HandFile::parse(&text, "hand.toml").map_err(|error| error.to_string())?;
    let designs: Vec<DesignFile> = tips.iter().map(|(kind, _)| design(kind)).collect();
    BusRound::of(&file, &designs, set_up)
        .map(|round| round.expect("they are on the bus"))
        .map_err(|error| error.to_string())
}

fn refused(tips: &[(&str, &str)]) -> String {
    refused_on(40, tips)
}

fn refused_on(set_up: u32, tips: &[(&str, &str)]) -> String {
    let error = round_on(set_up, tips).expect_err("must be refused");
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

#[test]
fn a_lone_abp2_takes_its_conversion_its_two_transactions_and_room_for_one_that_fails() {
    let round = round(&[("abp2", "")]).expect("a part");
    // 39 bits of four bytes and 75 of eight are 98 and 188 us; each is set up in 40.
    assert_eq!((round.longest, round.transfers), (98 + 40 + 5_000 + 188 + 40, 0));
    assert_eq!(round.period, 7_000);
    assert_eq!((round.instant, round.skew), (138 + 2_500, FAILURE));
    assert_eq!((round.begins, round.halves), (vec![0], vec![2_500]));
    assert_eq!((round.parts[0].address, round.parts[0].branch), (0x28, None));
}

#[test]
fn every_part_of_another_kind_begins_so_that_the_middles_of_the_conversions_come_together() {
    let round =
        round(&[("abp2", ""), ("dps310", "address = 0x77"), ("ms5837-02ba", "")]).expect("three parts");
    for (part, begins) in round.parts.iter().zip(&round.begins) {
        // The commands of the others, before or after it: the instant is in their middle.
        assert!((begins + part.lead()).abs_diff(round.instant) <= round.skew - FAILURE);
    }
    assert_eq!(round.begins[1], 0, "the DPS310 takes the longest");
    assert!(
        round.period > 12_000 && round.period <= 16_000,
        "{}",
        round.period
    );
}

#[test]
fn a_branch_costs_its_opening_its_check_and_its_closing() {
    let near = round(&[("ms5837-02ba", "")]).expect("a part");
    let far = round(&[("ms5837-02ba", "multiplexer = [0x70, 3]")]).expect("a part");
    // Four transactions, each with three more of a byte and its address: 20 bits, set up in 40 us each.
    assert_eq!(far.longest - near.longest, 4 * 3 * (50 + 40));
}

#[test]
fn five_parts_of_one_address_fit_behind_a_multiplexer_and_a_bus_carries_no_more_than_it_can() {
    let branches: Vec<String> = (0..12)
        .map(|branch| format!("multiplexer = [{}, {}]", 0x70 + branch / 8, branch % 8))
        .collect();
    let of = |kind: &'static str, count: usize| -> Vec<(&str, &str)> {
        branches[..count]
            .iter()
            .map(|keys| (kind, keys.as_str()))
            .collect()
    };
    for kind in ["ms5837-02ba", "dps310"] {
        let five = round(&of(kind, 5)).expect("a hand of one kind");
        assert!(five.period <= LONGEST_ROUND, "{kind}: {}", five.period);
    }
    let error = refused_on(190, &of("dps310", 12));
    assert!(
        error.starts_with("hand.toml:")
            && error.contains("`tip.bus of t11` is 1, and with it a round of 12 parts takes "),
        "{error}"
    );
    assert!(error.contains("a round is at most 40 ms"), "{error}");
}

#[test]
fn an_address_is_one_that_the_part_can_have() {
    for (kind, keys, allowed) in [
        (
            "dps310",
            "address = 0x28",
            "is 0x28: must be 0x76 (SDO to ground) or 0x77, as the part has no other",
        ),
        (
            "ms5837-02ba",
            "address = 0x77",
            "is 0x77: must be 0x76, the one address of the part, or left out",
        ),
    ] {
        let error = refused(&[(kind, keys)]);
        assert!(
            error.ends_with(&format!("`tip.address of t0` {allowed}")),
            "{error}"
        );
    }
    let other = round(&[("abp2", "address = 0x18"), ("abp2", "address = 0x28")]).expect("two variants");
    assert_eq!(
        other.parts.iter().map(|part| part.address).collect::<Vec<_>>(),
        [0x18, 0x28]
    );
}

#[test]
fn no_two_parts_answer_to_one_address() {
    let branch = "multiplexer = [0x70, 2]";
    let same = refused(&[
        ("ms5837-02ba", branch),
        ("dps310", "multiplexer = [0x70, 2]\naddress = 0x76"),
    ]);
    assert!(
        same.ends_with(
            "`tip.address of t1` is 0x76: must be another one than that of tip t0 on this branch of the bus: give one of them another branch \
             of a multiplexer"
        ),
        "{same}"
    );
    for tips in [
        [("dps310", branch), ("dps310", "")],
        [("dps310", ""), ("dps310", branch)],
    ] {
        let beside = refused(&tips);
        assert!(
            beside.ends_with(
                "is 0x77: must be another one than that of tip t0: a part that is behind no multiplexer answers beside every branch"
            ),
            "{beside}"
        );
    }
    // A branch of its own, be it of another multiplexer.
    for other in ["multiplexer = [0x70, 3]", "multiplexer = [0x71, 2]"] {
        assert!(round(&[("dps310", branch), ("dps310", other)]).is_ok());
    }
}

#[test]
fn no_part_has_the_address_of_a_multiplexer() {
    for tips in [
        [("dps310", "multiplexer = [0x77, 0]"), ("abp2", "")],
        [("abp2", "multiplexer = [0x77, 0]"), ("dps310", "")],
    ] {
        let error = refused(&tips);
        assert!(
            error.contains(
                "is 0x77: must be another one than that of a multiplexer, and tip t0 is behind one"
            ),
            "{error}"
        );
    }
}

#[test]
fn a_multiplexer_has_eight_addresses_and_eight_branches() {
    for keys in [
        "multiplexer = [0x6F, 0]",
        "multiplexer = [0x78, 0]",
        "multiplexer = [0x70, 8]",
    ] {
        let error = refused(&[("dps310", keys)]);
        assert!(
            error.ends_with("must be [address, branch] of a TCA9548A: 0x70 to 0x77, and 0 to 7"),
            "{error}"
        );
    }
}

/// The table of the guide.
#[test]
fn the_guide_has_the_rounds_of_four_hands() {
    let guide = include_str!("../../../../../host-tests/guides/a-hand.md");
    let behind = [0, 1, 2, 3, 4].map(|branch| format!("multiplexer = [0x70, {branch}]"));
    let addresses = [0x08, 0x18, 0x28, 0x38, 0x48].map(|address| format!("address = {address}"));
    let all = |kind, keys: &[String; 5]| keys.clone().map(|keys| (kind, keys));
    let mixed = [
        ("ms5837-02ba", behind[0].clone()),
        ("ms5837-02ba", behind[1].clone()),
        ("dps310", behind[2].clone()),
        ("abp2", String::new()),
        ("abp2", addresses[1].clone()),
    ];
    let on = |set_up, tips: &[(&str, String); 5]| {
        round_on(
            set_up,
            &tips.each_ref().map(|(kind, keys)| (*kind, keys.as_str())),
        )
        .expect("it fits")
    };
    for (hand, tips) in [
        ("five ABP2 at five addresses", &all("abp2", &addresses)),
        (
            "two MS5837-02BA and a DPS310 behind a multiplexer, two ABP2 beside it",
            &mixed,
        ),
        (
            "five MS5837-02BA behind a multiplexer",
            &all("ms5837-02ba", &behind),
        ),
        ("five DPS310 behind a multiplexer", &all("dps310", &behind)),
    ] {
        // The second is that of the NUCLEO-L432KC, in `build.rs`.
        let [fast, slow] = [SET_UP, 190].map(|set_up| on(set_up, tips).period / 1000);
        let row = format!("| {hand} | {fast} ms | {slow} ms |");
        assert!(guide.contains(&row), "{row}");
    }
    let skew = f64::from(on(SET_UP, &mixed).skew) / 1e3;
    assert!(
        guide.contains(&format!("{skew:.1} ms with the second hand")),
        "{skew}"
    );
}
