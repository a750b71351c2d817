//! A board of a hand that takes its tips' data, on the host: the firmware's own frames, commands, loader, slots and signal paths of five
//! tips over a simulated flash, in virtual time. Around them is what the tasks of the image do.

use crate::tip_device::Served;
use embassy_futures::block_on;
use embedded_storage_async::nor_flash::NorFlash;
use fingertip::device::hand::{Hand, HandFrame, HandNames, HandTip};
use fingertip::device::logic::{Beginning, Device};
use fingertip::device::task_monitor::{CrashRecord, Start};
use fingertip::device::tip_loader::{FoundTip, LARGEST_BLOCK, TipLoader};
use fingertip::image::{FirmwareDesign, ImageDesign};
use fingertip::link::load;
use fingertip::link::outbox::Outbox;
use fingertip::link::tips::{FrameStart, read_load, read_request};
use fingertip::link::wire::{Deframer, Encoded};
use fingertip::signal::design::Design as _;
use fingertip::signal::report::Report;
use fingertip::signal::tip_design::TipDesign;
use fingertip::signal::zero::Zero;
use fingertip::status::{ResetCause, Stored};
use fingertip::storage::tip_slots::TipSlots;
use fingertip::transducer::driver::Sample;
use fingertip::units::{Microseconds, Millipascals};

/// Tips of the board.
pub const TIPS: usize = 5;

/// Frames that wait for the line, as in the image.
const WAITING: usize = 16;

/// What it and its tips are called.
pub const NAMES: HandNames<TIPS> = HandNames {
    hash: 0x4841_4E44,
    tips: ["thumb", "index", "middle", "ring", "little"],
};

/// The loader of a board whose tips all have the transducer of the default design, two slots of `slot` bytes each, one behind the other.
pub fn loader(slot: u32) -> TipLoader<TIPS> {
    let slots = std::array::from_fn(|tip| TipSlots::new(2 * tip as u32 * slot, slot));
    TipLoader::new(slots, [ImageDesign::CONSTANTS.transducer; TIPS])
}

/// The board.
#[derive(Debug)]
pub struct HandDevice<F> {
    flash: F,
    slot: u32,
    loader: TipLoader<TIPS>,
    tips: [Device<TipDesign<'static, FirmwareDesign>>; TIPS],
    hand: Hand<TIPS>,
    deframer: Deframer,
    outbox: Outbox<'static, WAITING>,
    frame: &'static mut Encoded,
    /// Since its last reset.
    now: Microseconds,
    /// Pressures, one a tip.
    pub pressures: [Millipascals; TIPS],
    buffer: Vec<u8>,
    /// Resets so far.
    pub restarts: u32,
}

impl<F: NorFlash> HandDevice<F> {
    /// A board that is switched on, with slots of `slot` bytes.
    pub fn start(flash: F, slot: u32) -> Self {
        Self::after(flash, slot, ResetCause::PowerOn, [None; TIPS])
    }

    /// A board that was reset, with the zeros that it kept.
    ///
    /// # Panics
    /// Never: there are as many frames as it asks for.
    fn after(mut flash: F, slot: u32, reset_cause: ResetCause, zeros: [Option<Zero>; TIPS]) -> Self {
        let mut loader = loader(slot);
        let mut rests = [Millipascals(0); TIPS];
        let mut tips = std::array::from_fn(|tip| {
            // A board has one for its whole life; a test has few.
            let block: &'static mut [u8] = Box::leak(vec![0; LARGEST_BLOCK].into_boxed_slice());
            let image = TipDesign::Image(FirmwareDesign::start());
            let (design, calibration, stored) = match block_on(loader.start(tip, &mut flash, block)) {
                FoundTip::Image => (image, None, Stored::None),
                FoundTip::Loaded(design, known) => (TipDesign::Loaded(design), known, Stored::None),
                FoundTip::Refused => (image, None, Stored::Damaged),
            };
            rests[tip] = Millipascals(1000 * design.parameters().constants.rest_pressure);
            let beginning = Beginning {
                reset_cause,
                start: Start {
                    kept: zeros[tip],
                    ..CrashRecord::start(None, reset_cause, NAMES.hash)
                },
                stored,
                stored_sequence: 0,
                calibration,
                clock_failed: false,
                firmware: [0, 1, 0],
            };
            Device::new(design, &beginning)
        });
        let hand = Hand::new(NAMES, &mut dynamic(&mut tips), 2);
        let frames = Box::leak(vec![Encoded::NOTHING; WAITING + 1].into_boxed_slice());
        let (first, rest) = frames.split_first_mut().expect("one more than wait");
        let waiting: &'static mut [Encoded; WAITING] = rest.try_into().expect("as many as wait");
        Self {
            flash,
            slot,
            loader,
            tips,
            hand,
            deframer: Deframer::default(),
            outbox: Outbox::new(waiting.each_mut()),
            frame: first,
            now: Microseconds(0),
            pressures: rests,
            buffer: vec![0; LARGEST_BLOCK],
            restarts: 0,
        }
    }

    /// Bytes that came over the line since the last call, and the reports of the next instant; gives the bytes of what it says.
    pub fn millisecond(&mut self, heard: &[u8]) -> Vec<u8> {
        self.now.0 += 1000;
        let outbox = &mut self.outbox;
        let mut put = |frame: &HandFrame<'_>| {
            outbox.put_by(|body, sequence, dropped| {
                frame.write(FrameStart {
                    body,
                    sequence,
                    dropped,
                });
            });
        };
        let samples = self.pressures.map(|pressure| {
            Ok(Sample {
                pressure,
                headroom: Millipascals(1),
                age: 500,
                ..Sample::default()
            })
        });
        self.hand
            .step(&mut dynamic(&mut self.tips), self.now, &samples, &mut put);
        for &byte in heard {
            let Some(Ok(body)) = self.deframer.push(byte) else {
                continue;
            };
            if load::is_load(&body) {
                if let Ok((tip, request)) = read_load(&body) {
                    let asked = (tip, request);
                    let reply =
                        block_on(
                            self.loader
                                .request(self.now, &mut self.flash, asked, &mut self.buffer),
                        );
                    put(&HandFrame::Load(tip, reply));
                }
            } else if let Ok(asked) = read_request(&body) {
                // Nothing is saved: the flash is the tips' alone.
                let tips = &mut dynamic(&mut self.tips);
                self.hand.request(tips, self.now, asked, &mut put, |_, _| {});
            }
        }
        let mut emitted = Vec::new();
        while self.outbox.take(&mut self.frame) {
            emitted.extend_from_slice(self.frame.as_slice());
        }
        emitted
    }

    /// The reports of the last instant.
    pub fn reports(&self) -> &[Report; TIPS] {
        self.hand.reports()
    }

    /// Hashes of the designs in use.
    pub fn designs(&self) -> [u64; TIPS] {
        self.tips.each_ref().map(|tip| tip.parameters().constants.hash)
    }

    /// The same board, reset if it asked for that: each tip keeps its zero, but the one that has another design.
    #[must_use]
    pub fn settled(self) -> Self {
        if !self.loader.is_restarting() {
            return self;
        }
        let changed = self.loader.changed();
        let mut zeros = self.tips.each_ref().map(Device::zero);
        zeros[changed] = None;
        let restarts = self.restarts + 1;
        Self {
            restarts,
            ..Self::after(self.flash, self.slot, ResetCause::Software, zeros)
        }
    }

    /// The same board, its power off and on.
    #[must_use]
    pub fn reset(self) -> Self {
        let restarts = self.restarts + 1;
        Self {
            restarts,
            ..Self::start(self.flash, self.slot)
        }
    }
}

impl<F: NorFlash + Send + 'static> Served for HandDevice<F> {
    fn millisecond(&mut self, heard: &[u8]) -> Vec<u8> {
        HandDevice::millisecond(self, heard)
    }

    fn settled(self) -> Self {
        HandDevice::settled(self)
    }

    fn reset(self) -> Self {
        HandDevice::reset(self)
    }

    fn restarts(&self) -> u32 {
        self.restarts
    }
}

fn dynamic<T: HandTip>(tips: &mut [T; TIPS]) -> [&mut dyn HandTip; TIPS] {
    tips.each_mut().map(|tip| tip as &mut dyn HandTip)
}
