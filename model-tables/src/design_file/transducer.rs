//! `[transducer]`, read key by key.

use super::bounds::Bounds;
use super::section::{KeyFault, Section};
use super::{
    SourceResistance, Supply, TransducerKindSection, TransducerSection, Transfer, air_kpa, in_any_air,
};
use crate::constants::Quantity;

pub(super) fn transducer(mut section: Section<'_>) -> Result<TransducerSection, KeyFault> {
    const KINDS: &str = "\"ratiometric\", \"abp2\", \"ms5837-02ba\" or \"dps310\"";
    // No gauge pressure lies below a vacuum; the firmware counts millipascals in 31 bits.
    const RANGE: Bounds = Bounds::within(-101.325, 2_000.0, "kPa");
    const WIDEST_KPA: f64 = 2_000.0;
    const FINENESS: Bounds = Bounds::above(0.0, 1e6, "Pa");
    let kind = match section.needed_text("kind", KINDS)? {
        "ratiometric" => ratiometric(&mut section)?,
        "abp2" => TransducerKindSection::Abp2 {
            address: address(&mut section, 0x08, 0x77)?.unwrap_or(0x28),
            transfer: match section.text("transfer", TRANSFERS)? {
                None | Some("A") => Transfer::A,
                Some("B") => Transfer::B,
                Some(_) => return Err(section.refuse("transfer", TRANSFERS)),
            },
        },
        "ms5837-02ba" => TransducerKindSection::Ms5837,
        "dps310" => TransducerKindSection::Dps310 {
            address: address(&mut section, 0x76, 0x77)?.unwrap_or(0x77),
        },
        _ => return Err(section.refuse("kind", KINDS)),
    };
    let quantity = quantity(&mut section, &kind)?;
    let range_kpa = section.needed_pair("range_kpa", RANGE)?;
    if quantity == Quantity::Absolute {
        fits_the_air(&section, &kind, range_kpa)?;
    }
    if range_kpa[1] - range_kpa[0] > WIDEST_KPA {
        return Err(section.refuse("range_kpa", "two increasing numbers at most 2000 kPa apart"));
    }
    let resolution_pa = section.needed_number("resolution_pa", FINENESS)?;
    if resolution_pa >= 1e3 * (range_kpa[1] - range_kpa[0]) {
        return Err(section.refuse("resolution_pa", "less than the width of range_kpa"));
    }
    let noise_pa = section.number("noise_pa", Bounds::within(0.0, 1e6, "Pa"))?;
    section.finish()?;
    Ok(TransducerSection {
        range_kpa,
        resolution_pa,
        noise_pa: noise_pa.unwrap_or(resolution_pa),
        quantity,
        kind,
    })
}

/// The keys of an analogue part.
fn ratiometric(section: &mut Section<'_>) -> Result<TransducerKindSection, KeyFault> {
    const PULL_UP: Bounds = Bounds::within(SourceResistance::MIN_PULL_UP_OHM, 1e9, "ohm");
    let output_fraction_at_range = section
        .pair(
            "output_fraction_at_range",
            Bounds::within(0.0, 1.0, "of the supply"),
        )?
        .unwrap_or([0.1, 0.9]);
    let supply = match section.text("supply", SUPPLIES)? {
        None | Some("reference") => Supply::Reference,
        Some("measured") => Supply::Measured,
        Some(_) => return Err(section.refuse("supply", SUPPLIES)),
    };
    let ohm = section.number("source_ohm", Bounds::within(0.0, 1e9, "ohm"))?;
    if ohm.is_some_and(|ohm| ohm > SourceResistance::MAX_OHM) {
        return Err(section.refuse(
            "source_ohm",
            &format!(
                "at most {} ohm, from which the converter still settles: put an amplifier behind the output, or a divider of less",
                SourceResistance::MAX_OHM
            ),
        ));
    }
    if ohm.is_some() && supply == Supply::Measured {
        return Err(section.refuse(
            "source_ohm",
            "left out where transducer.supply is \"measured\": the pull-up goes to the converter's reference, and what it adds changes \
             with the supply; leave the pull-up away there",
        ));
    }
    let pull_up = section.number("pull_up_ohm", PULL_UP)?;
    if pull_up.is_some() && ohm.is_none() {
        return Err(section.refuse(
            "pull_up_ohm",
            "given together with transducer.source_ohm, as it divides with that",
        ));
    }
    Ok(TransducerKindSection::Ratiometric {
        output_fraction_at_range,
        supply,
        source: SourceResistance {
            ohm: ohm.unwrap_or(SourceResistance::IDEAL.ohm),
            pull_up_ohm: pull_up.unwrap_or(SourceResistance::IDEAL.pull_up_ohm),
        },
    })
}

/// What the part measures against: parts on a bus know theirs, an analogue one is gauge unless it says otherwise.
fn quantity(section: &mut Section<'_>, kind: &TransducerKindSection) -> Result<Quantity, KeyFault> {
    const QUANTITIES: &str = "\"gauge\" or \"absolute\"";
    let given = match section.text("quantity", QUANTITIES)? {
        None => None,
        Some("gauge") => Some(Quantity::Gauge),
        Some("absolute") => Some(Quantity::Absolute),
        Some(_) => return Err(section.refuse("quantity", QUANTITIES)),
    };
    match (kind.own_quantity(), given) {
        (Some(own), Some(given)) if own != given => {
            let own = match own {
                Quantity::Gauge => "gauge",
                Quantity::Absolute => "absolute",
            };
            Err(section.refuse(
                "quantity",
                &format!("\"{own}\", as every part of this transducer.kind is, or left out"),
            ))
        }
        (Some(own), _) => Ok(own),
        (None, given) => Ok(given.unwrap_or(Quantity::Gauge)),
    }
}

/// Whether an absolute part reads the range in any air. Of a part on a bus the range is gauge; of an analogue one it is the
/// part's own, which has to hold the air itself.
fn fits_the_air(
    section: &Section<'_>,
    kind: &TransducerKindSection,
    range_kpa: [f64; 2],
) -> Result<(), KeyFault> {
    let [thinnest, densest] = air_kpa();
    let air = format!("the air is {thinnest} to {densest} kPa");
    let [low, high] = range_kpa;
    let allowed = if let Some(own) = kind.absolute_range_kpa() {
        let [lowest, highest] = in_any_air(own);
        if low >= lowest && high <= highest {
            return Ok(());
        }
        format!(
            "gauge pressures within [{lowest}, {highest}]: the part measures {} to {} kPa absolute, and {air}",
            own[0], own[1]
        )
    } else {
        if low >= 0.0 && low <= thinnest && high > densest {
            return Ok(());
        }
        format!(
            "the two ends that the datasheet gives, kPa absolute as transducer.quantity says, from at most {thinnest} to \
             above {densest}: {air}"
        )
    };
    Err(section.refuse("range_kpa", &allowed))
}

const SUPPLIES: &str = "\"reference\" (of the converter) or \"measured\" (beside the output)";
const TRANSFERS: &str = "\"A\" (10 % to 90 % of the counts) or \"B\" (30 % to 70 %)";

fn address(section: &mut Section<'_>, low: u8, high: u8) -> Result<Option<u8>, KeyFault> {
    let bounds = Bounds::within(f64::from(low), f64::from(high), "(a seven-bit address)");
    let address = section.number("address", bounds)?;
    match address {
        Some(number) if libm::fmod(number, 1.0) > 0.0 => Err(section.refuse("address", "a whole number")),
        other => Ok(other.map(|number| number as u8)),
    }
}
