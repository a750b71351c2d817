use super::*;
use crate::link::command::{Command, CommandKind};
use crate::signal::report::{Feedback, Measurement, Sigma};
use crate::status::{LastFault, ResetCause, Warnings};
use model_tables::table::known::KnownContact;
use model_tables::table::law::Touched;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};
use proptest::prelude::*;

// Bodies by the page, the CRC by Python's `binascii.crc_hqx(body, 0xFFFF)`, COBS by a script of its own.

const READINGS: &[u8] = &[
    0x08, 0x03, 0x05, 0x02, 0x01, 0xb4, 0xc8, 0x2d, 0x01, 0x01, 0x01, 0x01, 0x02, 0x03, 0x05, 0x02, 0x08,
    0x20, 0x01, 0x01, 0x03, 0x82, 0x02, 0x04, 0x60, 0xe3, 0x16, 0x04, 0xa0, 0x25, 0x26, 0x06, 0x4c, 0x64,
    0x69, 0x81, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01,
    0x01, 0x03, 0xde, 0x01, 0x00,
];
const BOARD: &[u8] = &[
    0x04, 0x03, 0x03, 0x07, 0x04, 0x40, 0x42, 0x0f, 0x01, 0x01, 0x01, 0x01, 0x03, 0x03, 0x01, 0x02, 0x01,
    0x0b, 0x04, 0xef, 0xcd, 0xab, 0x89, 0x67, 0x45, 0x23, 0x01, 0x01, 0x01, 0x01, 0x03, 0xda, 0x07, 0x01,
    0x05, 0x01, 0x01, 0x02, 0x03, 0x01, 0x01, 0x02, 0x11, 0x01, 0x01, 0x02, 0x02, 0x01, 0x01, 0x02, 0x06,
    0x01, 0x01, 0x03, 0x03, 0x01, 0x01, 0x02, 0x04, 0x01, 0x01, 0x04, 0x05, 0x65, 0xe8, 0x00,
];
const TIP: &[u8] = &[
    0x04, 0x03, 0x06, 0x08, 0x04, 0x40, 0x42, 0x0f, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x0b, 0x04, 0xef,
    0xcd, 0xab, 0x89, 0x67, 0x45, 0x23, 0x01, 0x05, 0x01, 0x01, 0x03, 0xda, 0x07, 0x01, 0x01, 0x01, 0x01,
    0x01, 0x01, 0x02, 0x06, 0x01, 0x01, 0x09, 0x05, 0x69, 0x6e, 0x64, 0x65, 0x78, 0xe6, 0xf6, 0x00,
];
const ANSWER: &[u8] = &[
    0x04, 0x03, 0x04, 0x09, 0x04, 0x80, 0x84, 0x1e, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x06, 0x04, 0x81,
    0x04, 0x03, 0x01, 0x01, 0x03, 0xac, 0x73, 0x00,
];
#[cfg(feature = "load-tip")]
const LOAD_ANSWER: &[u8] = &[
    0x04, 0x03, 0x04, 0x08, 0x04, 0x80, 0x84, 0x1e, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x04, 0x03, 0x93,
    0x05, 0x03, 0x0c, 0x08, 0x03, 0x46, 0xdf, 0x00,
];
#[cfg(feature = "load-tip")]
const DATA: &[u8] = &[
    0x04, 0x03, 0x07, 0x08, 0x04, 0x80, 0x84, 0x1e, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x03, 0x03, 0x05,
    0x01, 0x01, 0x01, 0x01, 0x07, 0x46, 0x54, 0x49, 0x50, 0xb7, 0x87, 0x00,
];
#[cfg(feature = "load-tip")]
const BEGIN: &[u8] = &[
    0x04, 0x03, 0x91, 0x05, 0x04, 0x03, 0x04, 0x02, 0x01, 0x07, 0x67, 0x45, 0x23, 0x01, 0xdf, 0x0f, 0x00,
];
#[cfg(feature = "load-tip")]
const ACTIVATE: &[u8] = &[
    0x04, 0x03, 0x94, 0x05, 0x0c, 0x03, 0xef, 0xcd, 0xab, 0x89, 0x67, 0x45, 0x23, 0x01, 0x32, 0xf3, 0x00,
];
const KNOWN: &[u8] = &[
    0x04, 0x03, 0x04, 0x09, 0x04, 0x80, 0x84, 0x1e, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x04, 0x01, 0x89,
    0x05, 0x01, 0x02, 0x01, 0x04, 0x60, 0xe3, 0x16, 0x04, 0x90, 0x5f, 0x01, 0x04, 0x48, 0xe8, 0x01, 0x03,
    0xa0, 0x0f, 0x01, 0x03, 0x68, 0xe1, 0x00,
];
const OBJECT_COMMAND: &[u8] = &[
    0x04, 0x03, 0x88, 0x06, 0x05, 0x01, 0x01, 0x40, 0x1f, 0x01, 0x03, 0x4f, 0xa8, 0x00,
];
const RATE: &[u8] = &[0x04, 0x03, 0x86, 0x01, 0x03, 0xff, 0x04, 0x03, 0x7b, 0xd9, 0x00];
const TARE: &[u8] = &[0x08, 0x03, 0x81, 0x02, 0x01, 0x04, 0x87, 0x49, 0x00];

fn measurement() -> Measurement {
    Measurement {
        pressure_rise: PressureRise(164_352),
        force: Micronewtons(1_500_000),
        indentation: Nanometres(2_500_000),
        sigma: Sigma {
            pressure_rise: PressureRise(742),
            force: Micronewtons(6_000),
            indentation: Nanometres(9_000),
        },
        touch: Touch::Touched,
        warnings: Warnings::SATURATED,
        feedback: Feedback::NONE,
    }
}

fn hello() -> Hello {
    Hello {
        time: Microseconds(1_000_000),
        firmware: [0, 1, 0],
        reset_cause: ResetCause::Watchdog,
        design_hash: 0x0123_4567_89AB_CDEF,
        table_version: 1,
        report_period: 2010,
        stored: Stored::InUse,
        last_fault: LastFault::Late,
        resets_in_a_row: 2,
        last_fault_detail: 3,
        stored_sequence: 17,
        samples_lost: 2,
        samples_rejected: 6,
        frames_dropped: 259,
        commands_refused: 4,
    }
}

/// The bytes that are written.
fn written([sequence, dropped]: [u16; 2], write: impl FnOnce(FrameStart<'_>)) -> Encoded {
    let mut body = Encoded::NOTHING;
    write(FrameStart {
        body: &mut body,
        sequence,
        dropped,
    });
    body
}

fn read(bytes: &[u8]) -> TipsFrame {
    let (_, stuffed) = bytes.split_last().expect("never empty");
    read_body(&unstuff(stuffed).expect("it is a frame")).expect("it is of version 3")
}

#[test]
fn readings_are_the_documented_bytes() {
    let reports = [
        Report {
            time: Microseconds(3_000_500),
            outcome: Ok(measurement()),
        },
        Report {
            time: Microseconds(3_000_500),
            outcome: Err(Fault::SensorOpen),
        },
    ];
    let frame = written([0x0102, 3], |start| {
        start.readings(
            Microseconds(3_000_500),
            8,
            reports.iter().map(|report| (report, 0)),
        );
    });
    assert_eq!(frame.as_slice(), READINGS);
    let TipsFrame {
        sequence: 0x0102,
        dropped: 3,
        message:
            TipsMessage::Readings {
                time,
                pressure_fraction_bits: 8,
                reports: found,
            },
    } = read(READINGS)
    else {
        panic!("{:?}", read(READINGS))
    };
    assert_eq!(time, Microseconds(3_000_500));
    // 2^(76 / 8), 2^(100 / 8), 2^(105 / 8) by the page.
    let sigma = Sigma {
        pressure_rise: PressureRise(724),
        force: Micronewtons(5_793),
        indentation: Nanometres(8_933),
    };
    let measured = found[0].outcome.expect("a reading");
    assert_eq!(
        measured,
        Measurement {
            sigma,
            ..measurement()
        }
    );
    assert_eq!(found[1].outcome, Err(Fault::SensorOpen));
}

#[test]
fn pressures_of_a_finer_unit_are_taken_to_the_frames() {
    let report = Report {
        time: Microseconds(0),
        outcome: Ok(measurement()),
    };
    let frame = written([0, 0], |start| {
        start.readings(Microseconds(0), 6, [(&report, 2)].into_iter());
    });
    let TipsMessage::Readings { reports, .. } = read(&frame).message else {
        panic!("readings")
    };
    let measured = reports[0].outcome.expect("a reading");
    // 642 Pa in quarters of a count.
    assert_eq!(measured.pressure_rise, PressureRise(41_088));
    assert_eq!(measured.force, Micronewtons(1_500_000));
}

#[test]
fn greetings_and_answers_are_the_documented_bytes() {
    assert_eq!(
        written([7, 259], |start| start.board(&hello(), 5)).as_slice(),
        BOARD
    );
    assert_eq!(
        read(BOARD).message,
        TipsMessage::Board {
            hello: hello(),
            tips: 5
        }
    );
    let of_tip = Hello {
        table_version: 5,
        stored: Stored::None,
        stored_sequence: 0,
        ..hello()
    };
    assert_eq!(
        written([8, 0], |start| start.tip(4, "index", &of_tip)).as_slice(),
        TIP
    );
    let TipsMessage::Tip(tip) = read(TIP).message else {
        panic!("a tip")
    };
    assert_eq!(
        (tip.tip, tip.name.as_str(), tip.design_hash),
        (4, "index", 0x0123_4567_89AB_CDEF)
    );
    assert_eq!(
        (tip.report_period, tip.samples_rejected, tip.table_version),
        (2010, 6, 5)
    );
    let answer = Answer {
        time: Microseconds(2_000_000),
        command: CommandKind::Tare,
        command_sequence: 0x0304,
        outcome: Outcome::Touched,
        findings: 0,
        known: None,
    };
    assert_eq!(
        written([9, 0], |start| start.answer(4, &answer)).as_slice(),
        ANSWER
    );
    assert_eq!(read(ANSWER).message, TipsMessage::Answer { tip: 4, answer });
}

/// What a known indentation told of a tip.
#[test]
fn what_an_indentation_told_is_the_documented_bytes() {
    let known = KnownContact {
        force: Micronewtons(1_500_000),
        force_sigma: Micronewtons(90_000),
        curvature: 125_000,
        curvature_sigma: 4_000,
        doubts: 1,
    };
    let answer = Answer {
        time: Microseconds(2_000_000),
        command: CommandKind::Indentation,
        command_sequence: 5,
        outcome: Outcome::Done,
        findings: 1,
        known: Some(known),
    };
    let frame = written([9, 0], |start| start.answer(1, &answer));
    assert_eq!(frame.as_slice(), KNOWN);
    assert_eq!(read(KNOWN).message, TipsMessage::Answer { tip: 1, answer });
}

#[cfg(feature = "load-tip")]
#[test]
fn a_load_is_the_documented_bytes() {
    use crate::link::load::{LoadCommand, LoadKind, LoadOutcome, Piece, READ_BACK};

    let time = Microseconds(2_000_000);
    let refused = LoadReply::Answer {
        time,
        kind: LoadKind::Verify,
        sequence: 5,
        outcome: LoadOutcome::BlockRefused,
        findings: 8,
    };
    let data = LoadReply::Data {
        time,
        sequence: 5,
        offset: 0,
        bytes: Piece::of(b"FTIP").expect("not empty"),
    };
    for (reply, bytes) in [(refused, LOAD_ANSWER), (data, DATA)] {
        let frame = written([8, 0], |start| start.load(3, &reply));
        assert_eq!(frame.as_slice(), bytes);
        assert_eq!(read(bytes).message, TipsMessage::Load { tip: 3, reply });
    }
    let begin = LoadCommand::Begin {
        tip: 3,
        length: 516,
        check: 0x0123_4567,
    };
    let activate = LoadCommand::Activate {
        hash: 0x0123_4567_89AB_CDEF,
    };
    for (command, bytes) in [(begin, BEGIN), (activate, ACTIVATE)] {
        let request = LoadRequest { sequence: 5, command };
        assert_eq!(encode_load(3, &request).as_slice(), bytes);
        let body = unstuff(&bytes[..bytes.len() - 1]).expect("it is a frame");
        assert_eq!(read_load(&body), Ok((3, request)));
        // No other command resembles it.
        assert!(read_request(&body).is_err());
    }
    // The longest one fits, a longer one is none.
    let chunk = LoadCommand::Chunk {
        offset: 64,
        bytes: Piece::of(&[7; load::CHUNK]).expect("as many"),
    };
    let request = LoadRequest {
        sequence: 9,
        command: chunk,
    };
    let frame = encode_load(11, &request);
    let body = unstuff(&frame[..frame.len() - 1]).expect("it is a frame");
    assert_eq!(read_load(&body), Ok((11, request)));
    let longer = [&body[..], &[0]].concat();
    assert_eq!(read_load(&longer), Err(DecodeError::Length));
    let piece: Piece<READ_BACK> = Piece::of(&[1; READ_BACK]).expect("as many");
    let data = LoadReply::Data {
        time,
        sequence: 1,
        offset: 448,
        bytes: piece,
    };
    let frame = written([8, 0], |start| start.load(11, &data));
    assert_eq!(read(&frame).message, TipsMessage::Load { tip: 11, reply: data });
}

#[test]
fn commands_are_the_documented_bytes() {
    for (tip, sequence, command, bytes) in [
        (1, 6, Command::Object(Touched::Ball(8_000)), OBJECT_COMMAND),
        (4, 0x0102, Command::Tare, TARE),
        (ALL_TIPS, 1, Command::Rate { every: 4 }, RATE),
    ] {
        let request = Request { sequence, command };
        assert_eq!(encode_request(tip, &request).as_slice(), bytes);
        let (_, stuffed) = bytes.split_last().expect("never empty");
        let body = unstuff(stuffed).expect("it is a frame");
        assert_eq!(read_request(&body), Ok((tip, request)));
    }
}

#[test]
fn six_tips_are_a_frame_and_version_2_is_none() {
    let report = Report {
        time: Microseconds(0),
        outcome: Ok(measurement()),
    };
    let frame = written([0, 0], |start| {
        start.readings(Microseconds(0), 8, [(&report, 0); MAX_TIPS].into_iter());
    });
    assert_eq!(frame.len(), 16 + MAX_TIPS * 18 + 4);
    assert!(
        matches!(read(&frame).message, TipsMessage::Readings { reports, .. } if reports.len() == MAX_TIPS)
    );
    assert_eq!(read_body(&[2; 40]), Err(DecodeError::Version(2)));
    assert_eq!(read_request(&[2, 0x81, 0, 0, 0]), Err(DecodeError::Version(2)));
}

#[test]
fn a_decoder_takes_either_version() {
    let one = telemetry::encode(&Frame {
        sequence: 1,
        dropped: 0,
        message: telemetry::Message::Hello(hello()),
    });
    let mut decoder = AnyDecoder::default();
    let mut frames = Vec::<AnyFrame, 4>::new();
    for &byte in one.iter().chain(BOARD) {
        if let Some(frame) = decoder.push(byte) {
            frames.push(frame.expect("it is one")).expect("two");
        }
    }
    assert!(
        matches!(&frames[..], [AnyFrame::One(_), AnyFrame::Tips(_)]),
        "{frames:?}"
    );
}

proptest! {
    #[test]
    fn no_body_makes_the_readers_panic(body in prop::collection::vec(any::<u8>(), 0..240), kind in 1_u8..9) {
        let mut body = body;
        if let Some([version, of]) = body.first_chunk_mut() {
            *version = HAND_VERSION;
            *of = kind;
        }
        let _ = read_body(&body);
        let _ = read_request(&body);
        #[cfg(feature = "load-tip")]
        let _ = read_load(&body);
    }
}
