use super::*;
use proptest::prelude::*;

// Bodies by the page, the CRC by Python's `binascii.crc_hqx(body, 0xFFFF)`, COBS by a script of its own.

/// Sequence 0x0102, 3 000 500 us, 3 dropped; saturated, k = 8, touched; 642 Pa = 164 352 counts, 1.5 N, 2.5 mm; 1-sigma 742
/// counts, 6 mN, 9 um.
const READING_FRAME: &[u8] = &[
    0x08, 0x02, 0x01, 0x02, 0x01, 0xB4, 0xC8, 0x2D, 0x01, 0x01, 0x01, 0x01, 0x02, 0x03, 0x02, 0x01, 0x03,
    0x08, 0x02, 0x03, 0x82, 0x02, 0x04, 0x60, 0xE3, 0x16, 0x04, 0xA0, 0x25, 0x26, 0x03, 0xE6, 0x02, 0x01,
    0x03, 0x70, 0x17, 0x01, 0x03, 0x28, 0x23, 0x01, 0x03, 0xB2, 0xB6, 0x00,
];
/// The same of a design with a feedback actuator: 0.445 N, 1-sigma 1.8 mN.
#[cfg(feedback)]
const FEEDBACK_FRAME: &[u8] = &[
    0x08, 0x02, 0x01, 0x02, 0x01, 0xB4, 0xC8, 0x2D, 0x01, 0x01, 0x01, 0x01, 0x02, 0x03, 0x02, 0x01, 0x03,
    0x08, 0x02, 0x03, 0x82, 0x02, 0x04, 0x60, 0xE3, 0x16, 0x04, 0xA0, 0x25, 0x26, 0x03, 0xE6, 0x02, 0x01,
    0x03, 0x70, 0x17, 0x01, 0x03, 0x28, 0x23, 0x01, 0x04, 0x48, 0xCA, 0x06, 0x03, 0x08, 0x07, 0x01, 0x03,
    0xE2, 0x49, 0x00,
];
/// Sequence 65535, time 0, sensor open.
const FAULT_FRAME: &[u8] = &[
    0x05, 0x02, 0x02, 0xFF, 0xFF, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x04, 0x01, 0xF5,
    0xCD, 0x00,
];
/// Sequence 7, 1 s, 259 dropped; version 0.1.0, watchdog, hash 0x0123456789ABCDEF, tables 1, 1000 us; record 17 in use,
/// task 3 was late, 2 resets in a row; 2 samples lost, 6 rejected, 259 frames dropped, 4 commands refused.
const HELLO_FRAME: &[u8] = &[
    0x04, 0x02, 0x03, 0x07, 0x04, 0x40, 0x42, 0x0F, 0x01, 0x01, 0x01, 0x01, 0x03, 0x03, 0x01, 0x02, 0x01,
    0x0B, 0x04, 0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01, 0x01, 0x01, 0x01, 0x03, 0xE8, 0x03, 0x01,
    0x05, 0x01, 0x01, 0x02, 0x03, 0x01, 0x01, 0x02, 0x11, 0x01, 0x01, 0x02, 0x02, 0x01, 0x01, 0x02, 0x06,
    0x01, 0x01, 0x03, 0x03, 0x01, 0x01, 0x02, 0x04, 0x01, 0x01, 0x03, 0xB7, 0x19, 0x00,
];
/// Sequence 8, 2 s; self-test 0x0304 is done and found 0x12.
const ANSWER_FRAME: &[u8] = &[
    0x04, 0x02, 0x04, 0x08, 0x04, 0x80, 0x84, 0x1E, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x04, 0x85, 0x04,
    0x03, 0x02, 0x12, 0x03, 0x6E, 0x25, 0x00,
];

fn reading() -> Frame {
    Frame {
        sequence: 0x0102,
        dropped: 3,
        message: Message::Report {
            report: Report {
                time: Microseconds(3_000_500),
                outcome: Ok(Measurement {
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
                }),
            },
            pressure_fraction_bits: 8,
        },
    }
}

fn fault() -> Frame {
    Frame {
        sequence: 65535,
        dropped: 0,
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
        dropped: 259,
        message: Message::Hello(Hello {
            time: Microseconds(1_000_000),
            firmware: [0, 1, 0],
            reset_cause: ResetCause::Watchdog,
            design_hash: 0x0123_4567_89AB_CDEF,
            table_version: 1,
            report_period: 1000,
            stored: Stored::InUse,
            last_fault: LastFault::Late,
            resets_in_a_row: 2,
            last_fault_detail: 3,
            stored_sequence: 17,
            samples_lost: 2,
            samples_rejected: 6,
            frames_dropped: 259,
            commands_refused: 4,
        }),
    }
}

fn answer() -> Frame {
    Frame {
        sequence: 8,
        dropped: 0,
        message: Message::Answer(Answer {
            time: Microseconds(2_000_000),
            command: CommandKind::SelfTest,
            command_sequence: 0x0304,
            outcome: Outcome::Done,
            findings: 0x12,
            known: None,
        }),
    }
}

/// Sequence 9, 2 s; indentation 5 is done, found 1; 1.5 N and 0.09 N, 125 000 and 4 000 / km. By Python, as above.
const KNOWN_FRAME: &[u8] = &[
    0x04, 0x02, 0x04, 0x09, 0x04, 0x80, 0x84, 0x1E, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x03, 0x89, 0x05,
    0x01, 0x02, 0x01, 0x04, 0x60, 0xE3, 0x16, 0x04, 0x90, 0x5F, 0x01, 0x04, 0x48, 0xE8, 0x01, 0x03, 0xA0,
    0x0F, 0x01, 0x03, 0xF2, 0xBB, 0x00,
];

fn known() -> Frame {
    Frame {
        sequence: 9,
        dropped: 0,
        message: Message::Answer(Answer {
            time: Microseconds(2_000_000),
            command: CommandKind::Indentation,
            command_sequence: 5,
            outcome: Outcome::Done,
            findings: 1,
            known: Some(KnownContact {
                force: Micronewtons(1_500_000),
                force_sigma: Micronewtons(90_000),
                curvature: 125_000,
                curvature_sigma: 4_000,
                doubts: 1,
            }),
        }),
    }
}

#[test]
fn frames_are_the_documented_bytes() {
    for (frame, bytes) in [
        (reading(), READING_FRAME),
        (fault(), FAULT_FRAME),
        (hello(), HELLO_FRAME),
        (answer(), ANSWER_FRAME),
        (known(), KNOWN_FRAME),
    ] {
        assert_eq!(encode(&frame).as_slice(), bytes);
        assert_eq!(decode(&bytes[..bytes.len() - 1]), Ok(frame));
    }
}

/// A body with its CRC, stuffed: what only a broken or newer sender would write.
fn stuffed(body: &[u8]) -> std::vec::Vec<u8> {
    let check = crc::Crc::<u16>::new(&crc::CRC_16_IBM_3740).checksum(body);
    let mut plain = body.to_vec();
    plain.extend(check.to_le_bytes());
    cobs::encode_vec(&plain)
}

#[test]
fn what_the_layout_does_not_allow_is_refused() {
    let mut body = [2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1];
    assert!(decode(&stuffed(&body)).is_ok());
    assert_eq!(decode(&stuffed(&body[..14])), Err(DecodeError::Length));
    assert_eq!(decode(&stuffed(&body[..13])), Err(DecodeError::Short));
    body[14] = 99;
    assert_eq!(decode(&stuffed(&body)), Err(DecodeError::Field(14)));
    // A deviation below 0 is no number.
    let mut reading = [0; 42];
    reading[..2].copy_from_slice(&[2, 1]);
    assert!(decode(&stuffed(&reading)).is_ok());
    for offset in [30, 34, 38] {
        let mut wrong = reading;
        wrong[offset + 3] = 0x80;
        assert_eq!(decode(&stuffed(&wrong)), Err(DecodeError::Field(offset as u8)));
    }
    body[1] = 9;
    assert_eq!(decode(&stuffed(&body)), Err(DecodeError::Kind(9)));
    body[0] = 1;
    assert_eq!(decode(&stuffed(&body)), Err(DecodeError::Version(1)));
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

/// A frame is as long as what its design has: the others keep their bytes, and half a force is no frame.
#[cfg(feedback)]
#[test]
fn a_feedback_force_stands_behind_the_reading() {
    let force = FeedbackForce {
        force: Micronewtons(445_000),
        sigma: Micronewtons(1_800),
    };
    let with = |force: FeedbackForce| {
        let mut frame = reading();
        let Message::Report { report, .. } = &mut frame.message else {
            panic!("a report")
        };
        report.outcome = report.outcome.map(|measurement| Measurement {
            feedback: Feedback::of(force),
            ..measurement
        });
        frame
    };
    assert_eq!(encode(&with(force)).as_slice(), FEEDBACK_FRAME);
    assert_eq!(
        decode(&FEEDBACK_FRAME[..FEEDBACK_FRAME.len() - 1]),
        Ok(with(force))
    );
    let mut body = unstuff(&FEEDBACK_FRAME[..FEEDBACK_FRAME.len() - 1]).expect("a frame");
    assert_eq!(body.len(), FEEDBACK);
    body.truncate(READING + 4);
    assert_eq!(read_body(&body), Err(DecodeError::Length));
    for (below, field) in [
        (
            FeedbackForce {
                force: Micronewtons(-1),
                ..force
            },
            42,
        ),
        (
            FeedbackForce {
                sigma: Micronewtons(-1),
                ..force
            },
            46,
        ),
    ] {
        let sent = encode(&with(below));
        let stuffed = sent
            .as_slice()
            .split_last()
            .map_or(&[][..], |(_, stuffed)| stuffed);
        assert_eq!(decode(stuffed), Err(DecodeError::Field(field)));
    }
}

fn any_frame() -> impl Strategy<Value = Frame> {
    let measurement =
        (any::<[i32; 6]>(), 0..3_usize, 0_u16..512).prop_map(|(numbers, touch, bits)| Measurement {
            pressure_rise: PressureRise(numbers[0]),
            force: Micronewtons(numbers[1]),
            indentation: Nanometres(numbers[2]),
            sigma: Sigma {
                pressure_rise: PressureRise(numbers[3] & i32::MAX),
                force: Micronewtons(numbers[4] & i32::MAX),
                indentation: Nanometres(numbers[5] & i32::MAX),
            },
            touch: Touch::CODES[touch].0,
            warnings: Warnings::from_bits(bits).expect("nine bits are known"),
            feedback: Feedback::NONE,
        });
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
        any::<[u8; 4]>(),
        0..ResetCause::CODES.len(),
        (0..Stored::CODES.len(), 0..LastFault::CODES.len()),
        any::<u64>(),
        any::<[u32; 8]>(),
    )
        .prop_map(|(time, bytes, cause, (stored, last_fault), design_hash, words)| {
            Message::Hello(Hello {
                time: Microseconds(time),
                firmware: [bytes[0], bytes[1], bytes[2]],
                reset_cause: ResetCause::CODES[cause].0,
                design_hash,
                table_version: words[0],
                report_period: words[1],
                stored: Stored::CODES[stored].0,
                last_fault: LastFault::CODES[last_fault].0,
                resets_in_a_row: bytes[3],
                last_fault_detail: words[2],
                stored_sequence: words[3],
                samples_lost: words[4],
                samples_rejected: words[5],
                frames_dropped: words[6],
                commands_refused: words[7],
            })
        });
    let answer = (
        any::<u64>(),
        0..CommandKind::CODES.len(),
        any::<[u16; 2]>(),
        0..Outcome::CODES.len(),
    )
        .prop_map(|(time, command, words, outcome)| {
            Message::Answer(Answer {
                time: Microseconds(time),
                command: CommandKind::CODES[command].0,
                command_sequence: words[0],
                outcome: Outcome::CODES[outcome].0,
                findings: words[1],
                known: None,
            })
        });
    let known = (any::<u64>(), any::<[u16; 2]>(), any::<[i32; 4]>()).prop_map(|(time, words, numbers)| {
        Message::Answer(Answer {
            time: Microseconds(time),
            command: CommandKind::Indentation,
            command_sequence: words[0],
            outcome: Outcome::Done,
            findings: words[1],
            known: Some(KnownContact {
                force: Micronewtons(numbers[0]),
                force_sigma: Micronewtons(numbers[1]),
                curvature: numbers[2],
                curvature_sigma: numbers[3],
                doubts: words[1],
            }),
        })
    });
    (any::<[u16; 2]>(), prop_oneof![report, hello, answer, known]).prop_map(
        |([sequence, dropped], message)| Frame {
            sequence,
            dropped,
            message,
        },
    )
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
    fn no_body_with_a_good_check_makes_the_reader_panic(
        body in prop::collection::vec(any::<u8>(), 0..80), version in 1_u8..3, kind in 0_u8..6,
    ) {
        let mut body = body;
        if let Some([a, b]) = body.first_chunk_mut() {
            *a = version;
            *b = kind;
        }
        if let Ok(frame) = decode(&stuffed(&body)) {
            let encoded = encode(&frame);
            let (_, again) = encoded.as_slice().split_last().expect("never empty");
            prop_assert_eq!(decode(again), Ok(frame));
        }
    }
}
