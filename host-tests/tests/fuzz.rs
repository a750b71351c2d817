//! Everything that reads bytes from outside, on bytes from outside: random ones, and whole ones changed a little.

use fingertip::device::task_monitor::{CrashRecord, WORDS};
use fingertip::link::command::{self, Command, Request};
use fingertip::link::telemetry::{self, Frame, Message};
use fingertip::link::wire::Deframer;
use fingertip::signal::report::Report;
use fingertip::status::Fault;
use fingertip::storage::log;
use fingertip::storage::record::{self, Record};
use fingertip::units::Microseconds;
use host_tests::assert_faults_says;
use model_tables::random::Random;

/// Executions of each reader.
const EXECUTIONS: u64 = 250_000;

/// A whole frame of either direction, changed in up to three places, cut or lengthened; now and then random bytes.
fn nearly_a_frame(random: &mut Random) -> Vec<u8> {
    let number = random.bits();
    let mut bytes = match number % 4 {
        0 => (0..random.below(100)).map(|_| random.bits() as u8).collect(),
        1 => command::encode(&Request {
            sequence: number as u16,
            command: Command::Rate { every: 7 },
        })
        .to_vec(),
        2 => telemetry::encode(&Frame {
            sequence: number as u16,
            dropped: 0,
            message: Message::Report {
                report: Report {
                    time: Microseconds(number),
                    outcome: Err(Fault::SensorOpen),
                },
                pressure_fraction_bits: 0,
            },
        })
        .to_vec(),
        _ => command::encode(&Request {
            sequence: number as u16,
            command: Command::SelfTest { indentation: 250_000 },
        })
        .to_vec(),
    };
    for _ in 0..random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len() as u64) as usize;
        match random.below(4) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.bits() as u8,
            2 => drop(bytes.remove(at)),
            _ => bytes.insert(at, random.bits() as u8),
        }
    }
    bytes
}

#[test]
fn readers_of_the_line_take_anything() {
    let mut random = Random(1);
    let mut deframer = Deframer::default();
    let (mut commands, mut frames) = (0_u64, 0_u64);
    for _ in 0..EXECUTIONS {
        let bytes = nearly_a_frame(&mut random);
        if let Ok(request) = command::decode(&bytes) {
            let again = command::encode(&request);
            assert_eq!(command::decode(&again[..again.len() - 1]), Ok(request));
        }
        if let Ok(frame) = telemetry::decode(&bytes) {
            let again = telemetry::encode(&frame);
            assert_eq!(telemetry::decode(&again[..again.len() - 1]), Ok(frame));
        }
        for byte in bytes {
            if let Some(Ok(body)) = deframer.push(byte) {
                commands += u64::from(command::read_body(&body).is_ok());
                frames += 1;
            }
        }
    }
    // Whole frames are met too, and most are not.
    assert!(
        commands > EXECUTIONS / 20 && frames < EXECUTIONS,
        "{commands}, {frames}"
    );
    assert_faults_says(&format!("{} readings of frames", 3 * EXECUTIONS));
}

#[test]
fn readers_of_the_memory_take_anything() {
    let mut random = Random(2);
    let (mut records, mut crash_records) = (0_u64, 0_u64);
    for _ in 0..EXECUTIONS {
        let mut bytes = record::encode(&Record {
            sequence: random.bits() as u32,
            design_hash: random.bits(),
            table_version: 1,
            firmware: [0, 1, 0],
            calibration: None,
            wear: 0,
        });
        let mut words = CrashRecord {
            detail: random.bits() as u32,
            ..CrashRecord::default()
        }
        .to_words();
        let changes = random.below(5);
        for _ in 0..changes {
            let (at, bit) = (
                random.below(bytes.len() as u64 * 8),
                random.below(WORDS as u64 * 32),
            );
            bytes[at as usize / 8] ^= 1 << (at % 8);
            words[bit as usize / 32] ^= 1 << (bit % 32);
        }
        let record = matches!(record::decode(&bytes), log::Found::Record(_));
        let crash_record = CrashRecord::from_words(&words).is_some();
        records += u64::from(record);
        crash_records += u64::from(crash_record);
        // One change is always seen; several may cancel out.
        assert!(changes != 1 || !record && !crash_record);
        assert!(changes != 0 || record && crash_record);
    }
    assert!(records > EXECUTIONS / 6 && records < EXECUTIONS / 4 && crash_records < EXECUTIONS / 4);
    assert_faults_says(&format!(
        "{} readings of records and crash records",
        2 * EXECUTIONS
    ));
}
