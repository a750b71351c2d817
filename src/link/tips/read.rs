//! Decodes bodies of version 3 into messages and requests.

use super::deviation::of_eighths;
use super::{
    ANSWER, BOARD, FAULTY, MAX_TIPS, OBJECT, READING_BYTES, READINGS, TIP, TipHello, TipsFrame, TipsMessage,
};
#[cfg(band)]
use crate::link::band;
use crate::link::command::{self, CommandKind, Outcome, Request};
#[cfg(feature = "load-tip")]
use crate::link::load::{self, LoadKind, LoadRequest};
use crate::link::telemetry::{self, Answer, HEADER};
use crate::link::wire::{DecodeError, HAND_VERSION, PROTOCOL_VERSION, Reader};
use crate::signal::report::{Feedback, Measurement, Report, Sigma};
use crate::status::{Fault, Stored, Touch, Warnings, named_by};
use crate::units::Microseconds;
use heapless::{String, Vec};
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Bytes of an answer to a command that loads a tip, after the tip.
#[cfg(feature = "load-tip")]
const LOAD_ANSWER: usize = 6;

/// The tip and the request of a body.
///
/// # Errors
/// [`DecodeError`] if the body is not a command of version 3.
pub fn read_request(body: &[u8]) -> Result<(u8, Request), DecodeError> {
    let [HAND_VERSION, kind, low, high, tip, payload @ ..] = body else {
        return Err(no_command(body));
    };
    // Version 2 has the same layout without the tip.
    let mut plain: Vec<u8, 16> = Vec::new();
    let head = [PROTOCOL_VERSION, *kind, *low, *high];
    if plain.extend_from_slice(&head).is_err() || plain.extend_from_slice(payload).is_err() {
        return Err(DecodeError::Length);
    }
    let request = command::read_known_body::<OBJECT>(&plain)?;
    Ok((*tip, request))
}

/// The error for a body that is too short for a command, or that has another version.
fn no_command(body: &[u8]) -> DecodeError {
    match body {
        [HAND_VERSION, ..] | [] => DecodeError::Short,
        [version, ..] => DecodeError::Version(*version),
    }
}

/// The tip and the request of a body that loads a tip.
///
/// # Errors
/// [`DecodeError`] if the body is not such a command of version 3.
#[cfg(feature = "load-tip")]
pub fn read_load(body: &[u8]) -> Result<(u8, LoadRequest), DecodeError> {
    let [HAND_VERSION, kind, low, high, tip, payload @ ..] = body else {
        return Err(no_command(body));
    };
    // Version 2 has the same layout, but only `load begin` has a tip.
    let mut plain: Vec<u8, { 8 + load::CHUNK }> = Vec::new();
    let begins = named_by(&LoadKind::CODES, *kind) == Some(LoadKind::Begin);
    let own: &[u8] = if begins { core::slice::from_ref(tip) } else { &[] };
    for part in [&[PROTOCOL_VERSION, *kind, *low, *high], own, payload] {
        plain.extend_from_slice(part).map_err(|_| DecodeError::Length)?;
    }
    Ok((*tip, load::read_body(&plain)?))
}

/// The frame in a body.
///
/// # Errors
/// [`DecodeError`] if the body is not a frame of version 3.
pub fn read_body(body: &[u8]) -> Result<TipsFrame, DecodeError> {
    if body.len() < HEADER {
        return Err(DecodeError::Short);
    }
    let mut fields = Reader(body);
    let [version, kind] = fields.take()?;
    if version != HAND_VERSION {
        return Err(DecodeError::Version(version));
    }
    let sequence = u16::from_le_bytes(fields.take()?);
    let time = Microseconds(u64::from_le_bytes(fields.take()?));
    let dropped = u16::from_le_bytes(fields.take()?);
    let message = match kind {
        READINGS => read_readings(&mut fields, time)?,
        BOARD => {
            let hello = telemetry::read_hello(&mut fields, time)?;
            let [tips] = fields.take()?;
            if !(1..=MAX_TIPS).contains(&usize::from(tips)) {
                return Err(DecodeError::Field(61));
            }
            TipsMessage::Board { hello, tips }
        }
        TIP => TipsMessage::Tip(read_tip(&mut fields, time)?),
        ANSWER => read_answer(&mut fields, time)?,
        #[cfg(band)]
        band::BAND => {
            let [tip] = fields.take()?;
            TipsMessage::Band {
                tip: numbered(tip, 14)?,
                band: band::read(Reader(core::mem::take(&mut fields.0)), time, 15)?,
            }
        }
        #[cfg(feature = "load-tip")]
        load::DATA => {
            let [tip] = fields.take()?;
            TipsMessage::Load {
                tip: numbered(tip, 14)?,
                reply: load::read_data(Reader(core::mem::take(&mut fields.0)), time)?,
            }
        }
        _ => return Err(DecodeError::Kind(kind)),
    };
    if !fields.0.is_empty() {
        return Err(DecodeError::Length);
    }
    Ok(TipsFrame {
        sequence,
        dropped,
        message,
    })
}

fn read_answer(fields: &mut Reader<'_>, time: Microseconds) -> Result<TipsMessage, DecodeError> {
    let [tip] = fields.take()?;
    let tip = numbered(tip, 14)?;
    #[cfg(feature = "load-tip")]
    if fields.0.len() == LOAD_ANSWER
        && let Some(reply) = load::read_answer(Reader(fields.0), time)
    {
        fields.0 = &[];
        return Ok(TipsMessage::Load { tip, reply: reply? });
    }
    let [command] = fields.take()?;
    let command_sequence = u16::from_le_bytes(fields.take()?);
    let [outcome] = fields.take()?;
    let findings = u16::from_le_bytes(fields.take()?);
    let command = CommandKind::from_code(command).ok_or(DecodeError::Field(15))?;
    // The contact from a known indentation, if the answer has one.
    let known = match fields.0 {
        [] => None,
        _ if command == CommandKind::Indentation => Some(telemetry::read_known(fields, findings)?),
        _ => return Err(DecodeError::Length),
    };
    let answer = Answer {
        time,
        command,
        command_sequence,
        outcome: named_by(&Outcome::CODES, outcome).ok_or(DecodeError::Field(18))?,
        findings,
        known,
    };
    Ok(TipsMessage::Answer { tip, answer })
}

fn numbered(tip: u8, offset: u8) -> Result<u8, DecodeError> {
    if usize::from(tip) < MAX_TIPS {
        Ok(tip)
    } else {
        Err(DecodeError::Field(offset))
    }
}

fn read_readings(fields: &mut Reader<'_>, time: Microseconds) -> Result<TipsMessage, DecodeError> {
    let [tips, pressure_fraction_bits] = fields.take()?;
    if !(1..=MAX_TIPS).contains(&usize::from(tips)) {
        return Err(DecodeError::Field(14));
    }
    if pressure_fraction_bits > 31 {
        return Err(DecodeError::Field(15));
    }
    if fields.0.len() != usize::from(tips) * READING_BYTES {
        return Err(DecodeError::Length);
    }
    let mut reports = Vec::new();
    for tip in 0..tips {
        let outcome = read_reading(fields, tip)?;
        // Cannot fail: the number of tips was checked above.
        let _ = reports.push(Report { time, outcome });
    }
    Ok(TipsMessage::Readings {
        time,
        pressure_fraction_bits,
        reports,
    })
}

fn read_reading(fields: &mut Reader<'_>, tip: u8) -> Result<Result<Measurement, Fault>, DecodeError> {
    // Twelve tips of 18 bytes behind 16: below 233.
    let at = 16 + tip * READING_BYTES as u8;
    let [first, low, high] = fields.take()?;
    let mut number = || fields.take().map(i32::from_le_bytes);
    let (rise, force, indentation) = (number()?, number()?, number()?);
    let deviations: [u8; 3] = fields.take()?;
    if first & 0x0F != tip || first & 0x40 != 0 {
        return Err(DecodeError::Field(at));
    }
    if first & FAULTY != 0 {
        let fault = named_by(&Fault::CODES, low).ok_or(DecodeError::Field(at + 1))?;
        let blank =
            first & 0x30 == 0 && high == 0 && [rise, force, indentation] == [0; 3] && deviations == [0; 3];
        return if blank {
            Ok(Err(fault))
        } else {
            Err(DecodeError::Field(at + 2))
        };
    }
    let warnings = Warnings::from_bits(u16::from_le_bytes([low, high])).ok_or(DecodeError::Field(at + 1))?;
    let touch = named_by(&Touch::CODES, first >> 4 & 3).ok_or(DecodeError::Field(at))?;
    let [rise_sigma, force_sigma, indentation_sigma] = deviations.map(of_eighths);
    Ok(Ok(Measurement {
        pressure_rise: PressureRise(rise),
        force: Micronewtons(force),
        indentation: Nanometres(indentation),
        sigma: Sigma {
            pressure_rise: PressureRise(rise_sigma),
            force: Micronewtons(force_sigma),
            indentation: Nanometres(indentation_sigma),
        },
        touch,
        warnings,
        feedback: Feedback::NONE,
    }))
}

fn read_tip(fields: &mut Reader<'_>, time: Microseconds) -> Result<TipHello, DecodeError> {
    let [tip] = fields.take()?;
    let design_hash = u64::from_le_bytes(fields.take()?);
    let mut number = || fields.take().map(u32::from_le_bytes);
    let (table_version, report_period) = (number()?, number()?);
    let [stored] = fields.take()?;
    let mut number = || fields.take().map(u32::from_le_bytes);
    let (stored_sequence, samples_rejected) = (number()?, number()?);
    let [length] = fields.take()?;
    let name = fields.0.get(..usize::from(length)).ok_or(DecodeError::Length)?;
    fields.0 = fields.0.get(usize::from(length)..).unwrap_or_default();
    let name = core::str::from_utf8(name)
        .ok()
        .and_then(|name| String::try_from(name).ok())
        .ok_or(DecodeError::Field(41))?;
    Ok(TipHello {
        time,
        tip: numbered(tip, 14)?,
        design_hash,
        table_version,
        report_period,
        stored: named_by(&Stored::CODES, stored).ok_or(DecodeError::Field(31))?,
        stored_sequence,
        samples_rejected,
        name,
    })
}
