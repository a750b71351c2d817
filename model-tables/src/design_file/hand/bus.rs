//! The parts of a hand on an I2C bus: the address of each, and the time that a round of them takes.
//!
//! A round has one sample of each part. The parts convert at the same time; their transactions follow one another. Each part begins so
//! that the middles of all pressure conversions come together: the instant of the round.

use super::{HandFile, MultiplexerBranch, TipSection, TransducerPlace};
use crate::constants::conversion;
use crate::constants::hand_bus::FAILURE;
use crate::design_file::{DesignFile, DesignFileError, TransducerKindSection};

/// A bit on the bus, nanoseconds: 400 kHz.
const BIT_NS: u32 = 2_500;
/// What the firmware of the default board does for a transaction beside its bits, microseconds: at most 3500 instructions were
/// counted for each, all that runs beside them among them, at 1.3 cycles of 128 MHz.
pub const SET_UP: u32 = 40;
/// The longest round, microseconds: 25 reports a second.
pub const LONGEST_ROUND: u32 = 40_000;

/// A part on the bus.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BusPart {
    /// Its seven-bit address.
    pub address: u8,
    /// The branch of a multiplexer that it is on; `None`: the bus itself.
    pub branch: Option<MultiplexerBranch>,
    steps: &'static [Step],
    /// What the firmware does for a transaction beside its bits, microseconds.
    set_up: u32,
}

/// A step of one sample.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Step {
    /// A transaction of so many bytes, addresses among them.
    Transfer(u32),
    /// A conversion, microseconds; the last one is that of the pressure.
    Convert(u32),
}

use Step::{Convert, Transfer};

/// What the drivers do for a sample: an ABP2's command and its answer, ...
const ABP2: [Step; 3] = [Transfer(4), Convert(conversion::ABP2), Transfer(8)];
/// ... the two conversions of an MS5837 with a command before and a word after each, ...
const MS5837: [Step; 6] = [
    Transfer(2),
    Convert(conversion::MS5837[0]),
    Transfer(6),
    Transfer(2),
    Convert(conversion::MS5837[1]),
    Transfer(6),
];
/// ... and those of a DPS310, whose flags are read after each, and its words and settings at last.
const DPS310: [Step; 7] = [
    Transfer(3),
    Convert(conversion::DPS310[0]),
    Transfer(4),
    Transfer(3),
    Convert(conversion::DPS310[1]),
    Transfer(4),
    Transfer(11),
];

/// TE, datasheet of 09/2017: the one address that an MS5837 has.
const MS5837_ADDRESS: u8 = 0x76;

impl BusPart {
    /// The part of a tip, and the addresses that it can have; nothing if it is on no bus.
    fn of(tip: &TipSection, design: &DesignFile, set_up: u32) -> Option<(Self, [u8; 2])> {
        let TransducerPlace::Bus { branch, address, .. } = tip.place else {
            return None;
        };
        let (own, possible, steps) = match design.transducer.as_ref()?.kind {
            TransducerKindSection::Ratiometric { .. } => return None,
            TransducerKindSection::Abp2 { address, .. } => (address, [0x08, 0x77], &ABP2[..]),
            TransducerKindSection::Dps310 { address } => (address, [0x76, 0x77], &DPS310[..]),
            TransducerKindSection::Ms5837 => (MS5837_ADDRESS, [MS5837_ADDRESS; 2], &MS5837[..]),
        };
        let part = Self {
            address: address.unwrap_or(own),
            branch,
            steps,
            set_up,
        };
        Some((part, possible))
    }

    /// A transaction with it, microseconds: on a branch with that being opened, read back and closed.
    fn transfer(&self, bytes: u32) -> u32 {
        let one = |bytes: u32, starts: u32| self.set_up + ((9 * bytes + starts + 1) * BIT_NS).div_ceil(1000);
        let branch = self.branch.map_or(0, |_| 3 * one(2, 1));
        one(bytes, 2) + branch
    }

    fn step(&self, step: Step) -> u32 {
        match step {
            Transfer(bytes) => self.transfer(bytes),
            Convert(microseconds) => microseconds,
        }
    }

    /// Which step converts the pressure, and how long that takes, microseconds.
    fn pressure(&self) -> (usize, u32) {
        let steps = self.steps.iter().enumerate().rev();
        let mut conversions = steps.filter_map(|(at, step)| match step {
            Convert(microseconds) => Some((at, *microseconds)),
            Transfer(_) => None,
        });
        conversions.next().expect("every part converts")
    }

    /// From its beginning to the middle of the pressure's conversion, microseconds.
    fn lead(&self) -> u32 {
        let (at, conversion) = self.pressure();
        let before: u32 = self.steps[..at].iter().map(|&step| self.step(step)).sum();
        before + conversion / 2
    }

    /// All steps, microseconds.
    fn duration(&self) -> u32 {
        self.steps.iter().map(|&step| self.step(step)).sum()
    }

    /// Its transactions, microseconds.
    fn transfers(&self) -> u32 {
        let transfers = self.steps.iter().filter(|step| matches!(step, Transfer(_)));
        transfers.map(|&step| self.step(step)).sum()
    }

    /// The command that starts the pressure's conversion, microseconds.
    fn command(&self) -> u32 {
        self.step(self.steps[self.pressure().0 - 1])
    }
}

/// A round of the parts of a hand, in the order of its tips; times in microseconds.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct BusRound {
    /// The parts.
    pub parts: Vec<BusPart>,
    /// From one round to the next: whole milliseconds.
    pub period: u32,
    /// Of the longest part alone, all its steps.
    pub longest: u32,
    /// All transactions of the others.
    pub transfers: u32,
    /// From the beginning of the round to its instant.
    pub instant: u32,
    /// How far the middle of a part's conversion may lie from that: the commands follow one another, and one part may fail before.
    pub skew: u32,
    /// From the beginning of the round to that of each part.
    pub begins: Vec<u32>,
    /// Half of each part's conversion of the pressure.
    pub halves: Vec<u32>,
}

impl BusRound {
    /// The round of a hand on a board whose firmware takes `set_up` microseconds for a transaction beside its bits; `None` where no tip is
    /// on the bus.
    ///
    /// # Errors
    /// [`DesignFileError`] of the first tip whose address is none of its part, or is taken, and of the last one where a round would take
    /// longer than [`LONGEST_ROUND`].
    pub fn of(file: &HandFile, designs: &[DesignFile], set_up: u32) -> Result<Option<Self>, DesignFileError> {
        let tips = file.tips.iter().zip(designs);
        let mut parts: Vec<(&TipSection, BusPart)> = Vec::new();
        for (tip, design) in tips {
            let Some((part, possible)) = BusPart::of(tip, design, set_up) else {
                continue;
            };
            check(file, &parts, (tip, part), possible)?;
            parts.push((tip, part));
        }
        check_multiplexers(file, &parts)?;
        let Some(&(last, _)) = parts.last() else {
            return Ok(None);
        };
        let round = Self::timed(parts.iter().map(|&(_, part)| part).collect());
        if round.period <= LONGEST_ROUND {
            return Ok(Some(round));
        }
        Err(file.refuse(
            last,
            "bus",
            format!(
                "1, and with it a round of {} parts takes {:.1} ms: {:.1} for the longest part, {:.1} for the transactions of the others at \
                 400 kHz, {:.1} for one that fails",
                parts.len(),
                milliseconds(round.longest + round.transfers + FAILURE),
                milliseconds(round.longest),
                milliseconds(round.transfers),
                milliseconds(FAILURE)
            ),
            &format!(
                "left out, or faster: a round is at most {:.0} ms; an ABP2 is the fastest part, and one without a multiplexer takes less than half",
                milliseconds(LONGEST_ROUND)
            ),
        ))
    }

    /// The times of these parts, one at least.
    fn timed(parts: Vec<BusPart>) -> Self {
        let most = |times: &dyn Fn(&BusPart) -> u32| parts.iter().map(times).max().unwrap_or(0);
        let lead = most(&BusPart::lead);
        let all: u32 = parts.iter().map(BusPart::transfers).sum();
        // Each part waits for every transaction of the others at the worst.
        let end = |part: &BusPart| lead - part.lead() + part.duration();
        let waits = |part: &BusPart| all - part.transfers();
        let last = parts.iter().max_by_key(|part| end(part) + waits(part));
        let (longest, transfers) = last.map_or((0, 0), |part| (end(part), waits(part)));
        let commands: u32 = parts.iter().map(BusPart::command).sum();
        let least = parts.iter().map(BusPart::command).min().unwrap_or(0);
        let spread = commands - least;
        Self {
            period: (longest + transfers + FAILURE).next_multiple_of(1_000),
            longest,
            transfers,
            instant: lead + spread / 2,
            skew: spread / 2 + FAILURE,
            begins: parts.iter().map(|part| lead - part.lead()).collect(),
            halves: parts.iter().map(|part| part.pressure().1 / 2).collect(),
            parts,
        }
    }
}

fn milliseconds(microseconds: u32) -> f64 {
    f64::from(microseconds) / 1e3
}

/// A part beside those before it.
fn check(
    file: &HandFile,
    before: &[(&TipSection, BusPart)],
    (tip, part): (&TipSection, BusPart),
    [lowest, highest]: [u8; 2],
) -> Result<(), DesignFileError> {
    let refuse = |allowed: &str| Err(file.refuse(tip, "address", format!("{:#04x}", part.address), allowed));
    if !(lowest..=highest).contains(&part.address) {
        return refuse(&match (lowest, highest) {
            (lowest, highest) if lowest == highest => {
                format!("{lowest:#04x}, the one address of the part, or left out")
            }
            (0x76, 0x77) => "0x76 (SDO to ground) or 0x77, as the part has no other".to_owned(),
            _ => format!("an address that the part can have, {lowest:#04x} to {highest:#04x}"),
        });
    }
    // What is on the bus itself answers beside every branch.
    let answers_too = |other: &BusPart| {
        other.address == part.address
            && (other.branch == part.branch || other.branch.is_none() || part.branch.is_none())
    };
    match before.iter().find(|(_, other)| answers_too(other)) {
        None => Ok(()),
        Some((other, of)) if of.branch == part.branch => refuse(&format!(
            "another one than that of tip {} on this branch of the bus: give one of them another branch of a multiplexer",
            other.name
        )),
        Some((other, _)) => refuse(&format!(
            "another one than that of tip {}: a part that is behind no multiplexer answers beside every branch",
            other.name
        )),
    }
}

/// No part answers to a multiplexer's address, and neither does a part of another branch.
fn check_multiplexers(file: &HandFile, parts: &[(&TipSection, BusPart)]) -> Result<(), DesignFileError> {
    for (tip, part) in parts {
        let clash = parts.iter().find(|(_, other)| {
            other
                .branch
                .is_some_and(|branch| branch.multiplexer == part.address)
        });
        if let Some((other, _)) = clash {
            return Err(file.refuse(
                tip,
                "address",
                format!("{:#04x}", part.address),
                &format!(
                    "another one than that of a multiplexer, and tip {} is behind one at this address: set the multiplexer's pins A0 to A2 \
                     to another",
                    other.name
                ),
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
