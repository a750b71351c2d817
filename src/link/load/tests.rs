use super::*;
use crate::link::telemetry::{self, Frame, Message};
use proptest::prelude::*;

/// Bodies by the page, CRC by Python's `binascii.crc_hqx(body, 0xFFFF)`, stuffed by a script of its own.
const GOLDEN: [(LoadCommand, &[u8]); 4] = [
    (
        LoadCommand::Arm,
        &[
            0x04, 0x02, 0x90, 0x05, 0x07, 0x4C, 0x4F, 0x41, 0x44, 0x94, 0x47, 0x00,
        ],
    ),
    (
        LoadCommand::Begin {
            tip: 0,
            length: 516,
            check: 0x0123_4567,
        },
        &[
            0x04, 0x02, 0x91, 0x05, 0x01, 0x03, 0x04, 0x02, 0x01, 0x07, 0x67, 0x45, 0x23, 0x01, 0xF8, 0x67,
            0x00,
        ],
    ),
    (
        LoadCommand::Activate {
            hash: 0x0123_4567_89AB_CDEF,
        },
        &[
            0x04, 0x02, 0x94, 0x05, 0x0B, 0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01, 0x47, 0xED, 0x00,
        ],
    ),
    (
        LoadCommand::ReadBack {
            offset: 448,
            length: 56,
        },
        &[
            0x04, 0x02, 0x96, 0x05, 0x03, 0xC0, 0x01, 0x01, 0x04, 0x38, 0x1B, 0x15, 0x00,
        ],
    ),
];

#[test]
fn requests_are_the_documented_bytes() {
    for (command, bytes) in GOLDEN {
        let request = LoadRequest { sequence: 5, command };
        assert_eq!(encode(&request).as_slice(), bytes, "{request:?}");
        assert_eq!(decode(&bytes[..bytes.len() - 1]), Ok(request));
    }
}

#[test]
fn what_the_layout_does_not_allow_is_refused() {
    for (body, error) in [
        (&[2_u8, 0x90, 0][..], DecodeError::Short),
        (&[1, 0x93, 0, 0], DecodeError::Version(1)),
        (&[2, 0x97, 0, 0], DecodeError::Kind(0x97)),
        (&[2, 0x81, 0, 0], DecodeError::Kind(0x81)),
        // Armed by another word, with one byte more, a chunk off the grid, without a byte, with one too many.
        (&[2, 0x90, 0, 0, b'L', b'O', b'A', b'F'], DecodeError::Field(4)),
        (&[2, 0x93, 0, 0, 0], DecodeError::Length),
        (&[2, 0x92, 0, 0, 32, 0, 0, 0, 1], DecodeError::Field(4)),
        (&[2, 0x92, 0, 0, 64, 0, 0, 0], DecodeError::Length),
        (
            &[[2, 0x92, 0, 0, 0, 0, 0, 0].as_slice(), &[7; CHUNK + 1]].concat(),
            DecodeError::Length,
        ),
        (&[2, 0x96, 0, 0, 0, 0, 0, 0, 0], DecodeError::Field(8)),
        (&[2, 0x96, 0, 0, 0, 0, 0, 0, 57], DecodeError::Field(8)),
    ] {
        assert_eq!(read_body(body), Err(error), "{body:?}");
    }
}

fn any_command() -> impl Strategy<Value = LoadCommand> {
    let chunk = (any::<u16>(), prop::collection::vec(any::<u8>(), 1..=CHUNK)).prop_map(|(at, bytes)| {
        LoadCommand::Chunk {
            offset: u32::from(at) * CHUNK as u32,
            bytes: Piece::of(&bytes).expect("of that length"),
        }
    });
    prop_oneof![
        Just(LoadCommand::Arm),
        (0..16_u8, any::<[u32; 2]>()).prop_map(|(tip, [length, check])| LoadCommand::Begin {
            tip,
            length,
            check
        }),
        chunk,
        Just(LoadCommand::Verify),
        any::<u64>().prop_map(|hash| LoadCommand::Activate { hash }),
        Just(LoadCommand::RollBack),
        (any::<u32>(), 1..=READ_BACK as u8)
            .prop_map(|(offset, length)| LoadCommand::ReadBack { offset, length }),
    ]
}

proptest! {
    #[test]
    fn a_request_survives_the_wire(sequence in any::<u16>(), command in any_command()) {
        let request = LoadRequest { sequence, command };
        let encoded = encode(&request);
        let (_, stuffed) = encoded.split_last().expect("never empty");
        prop_assert_eq!(decode(stuffed), Ok(request));
    }

    #[test]
    fn a_reply_survives_the_wire(
        numbers in any::<(u64, u16, u16, u32)>(), kind in 0..LoadKind::CODES.len(), outcome in 0..LoadOutcome::CODES.len(),
        data in prop::collection::vec(any::<u8>(), 0..=READ_BACK),
    ) {
        let (time, sequence, findings, offset) = numbers;
        let time = Microseconds(time);
        let reply = match Piece::of(&data) {
            Some(bytes) => LoadReply::Data { time, sequence, offset, bytes },
            None => LoadReply::Answer {
                time, sequence, findings, kind: LoadKind::CODES[kind].0, outcome: LoadOutcome::CODES[outcome].0,
            },
        };
        let frame = Frame { sequence, dropped: findings, message: Message::Load(reply) };
        let encoded = telemetry::encode(&frame);
        let (_, stuffed) = encoded.split_last().expect("never empty");
        prop_assert_eq!(telemetry::decode(stuffed), Ok(frame));
    }

    #[test]
    fn no_body_makes_the_reader_panic(mut body in prop::collection::vec(any::<u8>(), 0..80), kind in 0x8F_u8..0x98) {
        if let Some([a, b]) = body.first_chunk_mut() {
            *a = PROTOCOL_VERSION;
            *b = kind;
        }
        if let Ok(request) = read_body(&body) {
            let encoded = encode(&request);
            let (_, stuffed) = encoded.split_last().expect("never empty");
            prop_assert_eq!(decode(stuffed), Ok(request));
        }
    }
}
