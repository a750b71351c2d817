use super::*;
use proptest::prelude::*;

/// Sequence 0x0102, 3 000 500 us, saturated, k = 8, 642 Pa = 164352 counts, 1.5 N, 2.5 mm; the CRC by
/// Python's `binascii.crc_hqx`, COBS by hand.
const READING_FRAME: &[u8] = &[
    0x08, 0x01, 0x01, 0x02, 0x01, 0xB4, 0xC8, 0x2D, 0x01, 0x01, 0x01, 0x01, 0x02, 0x01, 0x02, 0x08, 0x03,
    0x82, 0x02, 0x04, 0x60, 0xE3, 0x16, 0x04, 0xA0, 0x25, 0x26, 0x03, 0x5C, 0xD8, 0x00,
];

/// Sequence 65535, time 0, sensor open.
const FAULT_FRAME: &[u8] = &[
    0x05, 0x01, 0x02, 0xFF, 0xFF, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x04, 0x01, 0xAB, 0xAF, 0x00,
];

/// Sequence 7, 1 s, version 0.1.0, watchdog, hash 0x0123456789ABCDEF, 1000 us, 2 blocks, 259 frames.
const HELLO_FRAME: &[u8] = &[
    0x04, 0x01, 0x03, 0x07, 0x04, 0x40, 0x42, 0x0F, 0x01, 0x01, 0x01, 0x01, 0x01, 0x02, 0x01, 0x0C, 0x04,
    0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01, 0xE8, 0x03, 0x01, 0x02, 0x02, 0x01, 0x01, 0x03, 0x03,
    0x01, 0x01, 0x03, 0x65, 0x75, 0x00,
];

fn reading() -> Frame {
    Frame {
        sequence: 0x0102,
        message: Message::Report {
            report: Report {
                time: Microseconds(3_000_500),
                outcome: Ok(Measurement {
                    pressure_rise: PressureRise(164_352),
                    force: Micronewtons(1_500_000),
                    indentation: Nanometres(2_500_000),
                    warnings: Warnings::SATURATED,
                }),
            },
            pressure_fraction_bits: 8,
        },
    }
}

fn fault() -> Frame {
    Frame {
        sequence: 65535,
        message: Message::Report {
            report: Report {
                time: Microseconds(0),
                outcome: Err(Fault::SensorOpen),
            },
            pressure_fraction_bits: 0,
        },
    }
}

fn hello() -> Frame {
    Frame {
        sequence: 7,
        message: Message::Hello(Hello {
            time: Microseconds(1_000_000),
            firmware: [0, 1, 0],
            reset_cause: ResetCause::Watchdog,
            design_hash: 0x0123_4567_89AB_CDEF,
            report_period: 1000,
            blocks_lost: 2,
            frames_dropped: 259,
        }),
    }
}

#[test]
fn the_check_is_the_catalogues() {
    assert_eq!(CHECK.checksum(b"123456789"), 0x29B1);
}

#[test]
fn frames_are_the_documented_bytes() {
    for (frame, bytes) in [
        (reading(), READING_FRAME),
        (fault(), FAULT_FRAME),
        (hello(), HELLO_FRAME),
    ] {
        assert_eq!(encode(&frame).as_slice(), bytes);
        assert_eq!(decode(&bytes[..bytes.len() - 1]), Ok(frame));
    }
}

/// A body with its CRC, stuffed: what only a broken or newer sender would write.
fn stuffed(body: &[u8]) -> std::vec::Vec<u8> {
    let mut plain = body.to_vec();
    plain.extend(CHECK.checksum(body).to_le_bytes());
    cobs::encode_vec(&plain)
}

#[test]
fn what_the_layout_does_not_allow_is_refused() {
    let mut body = [1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1];
    assert!(decode(&stuffed(&body)).is_ok());
    assert_eq!(decode(&stuffed(&body[..12])), Err(DecodeError::Length));
    assert_eq!(decode(&stuffed(&body[..11])), Err(DecodeError::Short));
    body[12] = 99;
    assert_eq!(decode(&stuffed(&body)), Err(DecodeError::Field(12)));
    body[1] = 9;
    assert_eq!(decode(&stuffed(&body)), Err(DecodeError::Kind(9)));
    body[0] = 2;
    assert_eq!(decode(&stuffed(&body)), Err(DecodeError::Version(2)));
    assert_eq!(decode(&[]), Err(DecodeError::Stuffing));
    assert_eq!(decode(&[200, 1]), Err(DecodeError::Stuffing));
}

#[test]
fn a_stream_is_in_step_again_after_noise() {
    let mut decoder = Decoder::default();
    let mut stream = vec![0x55; 300];
    stream.extend([0, 0]);
    stream.extend(READING_FRAME);
    stream.extend(&FAULT_FRAME[3..]);
    stream.extend(HELLO_FRAME);
    let answers: std::vec::Vec<_> = stream.iter().filter_map(|&byte| decoder.push(byte)).collect();
    assert_eq!(answers.len(), 4);
    assert_eq!(answers[0], Err(DecodeError::Stuffing));
    assert_eq!(answers[1], Ok(reading()));
    assert!(answers[2].is_err());
    assert_eq!(answers[3], Ok(hello()));
}

fn any_frame() -> impl Strategy<Value = Frame> {
    let measurement = (any::<i32>(), any::<i32>(), any::<i32>(), 0_u16..8).prop_map(
        |(pressure_rise, force, indentation, bits)| Measurement {
            pressure_rise: PressureRise(pressure_rise),
            force: Micronewtons(force),
            indentation: Nanometres(indentation),
            warnings: Warnings::from_bits(bits).expect("three bits are known"),
        },
    );
    let outcome = prop_oneof![
        measurement.prop_map(Ok),
        (0..Fault::CODES.len()).prop_map(|i| Err(Fault::CODES[i].0)),
    ];
    let report = (any::<u64>(), outcome, 0_u8..32).prop_map(|(time, outcome, bits)| Message::Report {
        report: Report {
            time: Microseconds(time),
            outcome,
        },
        pressure_fraction_bits: if outcome.is_ok() { bits } else { 0 },
    });
    let hello = (
        any::<u64>(),
        any::<[u8; 3]>(),
        0..ResetCause::CODES.len(),
        any::<u64>(),
        any::<[u32; 3]>(),
    )
        .prop_map(|(time, firmware, cause, design_hash, counters)| {
            Message::Hello(Hello {
                time: Microseconds(time),
                firmware,
                reset_cause: ResetCause::CODES[cause].0,
                design_hash,
                report_period: counters[0],
                blocks_lost: counters[1],
                frames_dropped: counters[2],
            })
        });
    (any::<u16>(), prop_oneof![report, hello]).prop_map(|(sequence, message)| Frame { sequence, message })
}

proptest! {
    #[test]
    fn a_frame_survives_the_wire(frame in any_frame()) {
        let encoded = encode(&frame);
        let (last, stuffed) = encoded.as_slice().split_last().expect("never empty");
        prop_assert_eq!(*last, 0);
        prop_assert!(!stuffed.contains(&0));
        prop_assert_eq!(decode(stuffed), Ok(frame));
    }

    #[test]
    fn one_flipped_bit_is_never_a_frame(frame in any_frame(), place in any::<prop::sample::Index>(), bit in 0..8) {
        let mut bytes = encode(&frame).as_slice().to_vec();
        bytes.pop();
        let index = place.index(bytes.len());
        bytes[index] ^= 1_u8 << bit;
        prop_assert!(decode(&bytes).is_err());
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = decode(&bytes);
        let mut decoder = Decoder::default();
        for byte in bytes {
            let _ = decoder.push(byte);
        }
    }

    #[test]
    fn no_body_with_a_good_check_makes_the_reader_panic(
        body in prop::collection::vec(any::<u8>(), 0..80), version in 0_u8..3, kind in 0_u8..5,
    ) {
        let mut body = body;
        if let Some([a, b]) = body.first_chunk_mut() {
            *a = version;
            *b = kind;
        }
        let _ = decode(&stuffed(&body));
    }
}
