//! How long a load of 4 KiB takes at full telemetry: the firmware's own loader and the host's, over a line of 921 600 baud both ways, in
//! virtual time.

use fingertip::link::load::{CHUNK, LoadKind, LoadOutcome};
use host_tests::nor_flash::SimulatedFlash;
use host_tests::tip_device::TipDevice;
use model_tables::block::MAGIC;
use monitor::load::{LoadFailure, LoadJob, Loading};
use std::time::Duration;

/// A slot of the default board.
const SLOT: usize = 16 * 1024;

/// Bytes a millisecond: ten bits a byte.
const LINE: usize = 92;

/// A serial port on USB answers in frames of a millisecond (USB 2.0, 5.3): so long do bytes wait on the host's side, each way.
const USB: usize = 1;

/// Erasing a sector of 16 KB, 8 bits at a time, and programming a word, milliseconds at most (DS9405 tables 48 and 49).
const ERASURE: f64 = 0.8e3;
const WORD: f64 = 0.1;

/// One way of the line: what is on its way, millisecond by millisecond.
#[derive(Default)]
struct Way {
    waiting: Vec<u8>,
    late: Vec<Vec<u8>>,
}

impl Way {
    fn carry(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.waiting.extend(bytes);
        let now = self.waiting.drain(..self.waiting.len().min(LINE)).collect();
        self.late.push(now);
        if self.late.len() > USB {
            self.late.remove(0)
        } else {
            Vec::new()
        }
    }
}

#[test]
fn four_kibibytes_are_loaded_in_two_seconds_at_full_telemetry() {
    let mut block = vec![0x55; 4096];
    block[..4].copy_from_slice(&MAGIC);
    block[4..6].copy_from_slice(&[1, 0]);
    block[8..12].copy_from_slice(&4096_u32.to_le_bytes());
    let mut device = TipDevice::start(SimulatedFlash::<SLOT>::erased(1), SLOT as u32);
    let job = LoadJob::Load {
        block,
        hash: 1,
        name: "tip".to_owned(),
    };
    let mut loading = Loading::new(job, None);
    loading.connected();
    // Its first zero is taken: from then on a report has values.
    for _ in 0..1000 {
        device.millisecond(&[]);
    }
    let (mut to, mut from) = (Way::default(), Way::default());
    let (mut milliseconds, mut emitted) = (0, 0);
    while loading.outcome().is_none() {
        milliseconds += 1;
        let now = Duration::from_millis(milliseconds);
        let sent = loading.next(now).unwrap_or_default();
        let heard = to.carry(&sent);
        let report = device.millisecond(&heard);
        emitted += report.len();
        loading.hear(now, &from.carry(&report));
        assert!(milliseconds < 10_000, "it ends");
    }
    // Whole, and no tip: its verification is the last step before activation.
    assert_eq!(
        loading.outcome(),
        Some(&Err(LoadFailure::Refused(
            LoadKind::Verify,
            LoadOutcome::BlockRefused,
            2
        )))
    );
    // A report of 46 bytes each millisecond is the least that went by beside it.
    assert!(emitted as u64 >= 46 * milliseconds);
    let memory = ERASURE + WORD * 1024.0;
    let total = milliseconds as f64 + memory;
    println!(
        "line: {milliseconds} ms for {} chunks; memory, at most: {memory:.0} ms; together {total:.0} ms",
        4096 / CHUNK
    );
    assert!(total <= 2_000.0, "{total} ms");
}
