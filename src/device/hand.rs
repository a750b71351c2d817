//! The tips of a hand between their samples and the line: the counterpart of [`Device`] for several fingertips. Each tip has its
//! own zero, faults, answers and stored calibration. The reports of one instant share a frame and a time.

use crate::device::logic::{Counters, Device, ToStore};
#[cfg(band)]
use crate::link::band::BandMessage;
use crate::link::command::{Command, Request};
#[cfg(feature = "load-tip")]
use crate::link::load::LoadReply;
use crate::link::telemetry::{Answer, Hello, Message};
use crate::link::tips::{ALL_TIPS, FrameStart};
use crate::signal::design::Design;
use crate::signal::report::Report;
use crate::signal::zero::Zero;
use crate::status::{Fault, Status};
use crate::storage::log::StoreError;
use crate::transducer::driver::Sample;
use crate::units::Microseconds;

/// A tip of any design.
pub trait HandTip {
    /// [`Device::step`].
    fn step(
        &mut self,
        now: Microseconds,
        sample: Result<Sample, Fault>,
        put: &mut dyn FnMut(&Message),
    ) -> Report;

    /// [`Device::request`].
    fn request(
        &mut self,
        now: Microseconds,
        request: Request,
        put: &mut dyn FnMut(&Message),
    ) -> Option<ToStore>;

    /// [`Device::stored`].
    fn stored(
        &mut self,
        now: Microseconds,
        result: Result<(), StoreError>,
        number: u32,
        put: &mut dyn FnMut(&Message),
    );

    /// [`Device::zero`].
    fn zero(&self) -> Option<Zero>;

    /// Counters that other parts of the firmware update.
    fn counters(&mut self) -> &mut Counters;

    /// `k`: the unit of its pressures is `1 / 2^k` pascal.
    fn pressure_fraction_bits(&self) -> u32;
}

impl<D: Design> HandTip for Device<D> {
    fn step(
        &mut self,
        now: Microseconds,
        sample: Result<Sample, Fault>,
        put: &mut dyn FnMut(&Message),
    ) -> Report {
        Device::step(self, now, sample, put)
    }

    fn request(
        &mut self,
        now: Microseconds,
        request: Request,
        put: &mut dyn FnMut(&Message),
    ) -> Option<ToStore> {
        Device::request(self, now, request, put)
    }

    fn stored(
        &mut self,
        now: Microseconds,
        result: Result<(), StoreError>,
        number: u32,
        put: &mut dyn FnMut(&Message),
    ) {
        Device::stored(self, now, result, number, put);
    }

    fn zero(&self) -> Option<Zero> {
        Device::zero(self)
    }

    fn counters(&mut self) -> &mut Counters {
        &mut self.counters
    }

    fn pressure_fraction_bits(&self) -> u32 {
        self.parameters().pressure_fraction_bits
    }
}

/// A frame of a hand.
#[derive(Clone, Copy, Debug)]
pub enum HandFrame<'a> {
    /// The reports of all tips.
    Readings {
        /// The reports, in the order of the tips.
        reports: &'a [Report],
        /// Fraction bits of the frame, and the additional fraction bits of each tip.
        fraction_bits: (u8, &'a [u32]),
    },
    /// The hello of the board, and its number of tips.
    Board(Hello, u8),
    /// The hello of a tip, with its number and name.
    Tip(u8, &'static str, Hello),
    /// A tip's answer, with its number.
    Answer(u8, Answer),
    /// The band of a tip, with its number.
    #[cfg(band)]
    Band(u8, BandMessage),
    /// Answer to a command that loads a tip, with its number.
    #[cfg(feature = "load-tip")]
    Load(u8, LoadReply),
}

impl HandFrame<'_> {
    /// Writes the bytes of the frame.
    pub fn write(&self, start: FrameStart<'_>) {
        match *self {
            Self::Readings {
                reports,
                fraction_bits: (bits, shifts),
            } => {
                // All reports belong to one instant. A tip without a reading does not know the delay of its filter, so a tip
                // with a reading gives the time.
                let read = reports.iter().find(|report| report.outcome.is_ok());
                let time = read
                    .or(reports.first())
                    .map_or(Microseconds(0), |report| report.time);
                start.readings(time, bits, reports.iter().zip(shifts.iter().copied()));
            }
            Self::Board(ref hello, tips) => start.board(hello, tips),
            Self::Tip(tip, name, ref hello) => start.tip(tip, name, hello),
            Self::Answer(tip, ref answer) => start.answer(tip, answer),
            #[cfg(band)]
            Self::Band(tip, ref band) => start.band(tip, band),
            #[cfg(feature = "load-tip")]
            Self::Load(tip, ref reply) => start.load(tip, reply),
        }
    }
}

/// The report before the first sample.
const NO_REPORT: Report = Report {
    time: Microseconds(0),
    outcome: Err(Fault::Zeroing),
};

/// Names of a hand and of its tips.
#[derive(Clone, Copy, Debug)]
pub struct HandNames<const TIPS: usize> {
    /// Hash of the hand: its tips, where they are, and their designs.
    pub hash: u64,
    /// The tips.
    pub tips: [&'static str; TIPS],
}

/// A hand and its line.
#[derive(Clone, Debug)]
pub struct Hand<const TIPS: usize> {
    names: HandNames<TIPS>,
    bits: u8,
    shifts: [u32; TIPS],
    every: u16,
    passed: u16,
    statuses: [Option<Status>; TIPS],
    reports: [Report; TIPS],
}

impl<const TIPS: usize> Hand<TIPS> {
    /// A hand whose tips have no sample yet. One of `every` reports is sent, until a command changes this.
    pub fn new(names: HandNames<TIPS>, tips: &mut [&mut dyn HandTip; TIPS], every: u16) -> Self {
        let bits = tips.each_ref().map(|tip| tip.pressure_fraction_bits());
        let least = bits.iter().copied().min().unwrap_or(0);
        let mut hand = Self {
            names,
            bits: least as u8,
            shifts: bits.map(|bits| bits - least),
            every,
            passed: 0,
            statuses: [None; TIPS],
            reports: [NO_REPORT; TIPS],
        };
        hand.slow_down(tips, every);
        hand
    }

    /// Sends one of `every` reports from now on. The hello of each tip states this rate.
    fn slow_down(&mut self, tips: &mut [&mut dyn HandTip; TIPS], every: u16) {
        self.every = every;
        let request = Request {
            sequence: 0,
            command: Command::Rate { every },
        };
        for tip in tips {
            // The command `rate` stores nothing.
            let _ = tip.request(Microseconds(0), request, &mut |_| {});
        }
    }

    /// Makes the [reports](Self::reports) of one instant. `put` gets the frames for the line. Returns whether a tip's status
    /// changed.
    pub fn step(
        &mut self,
        tips: &mut [&mut dyn HandTip; TIPS],
        now: Microseconds,
        samples: &[Result<Sample, Fault>; TIPS],
        mut put: impl FnMut(&HandFrame<'_>),
    ) -> bool {
        let names = &self.names;
        let mut changed = false;
        for (number, tip) in tips.iter_mut().enumerate() {
            let report = tip.step(now, samples[number], &mut |message| {
                tell(names, number, message, &mut put);
            });
            let status = Some(report.status());
            changed |= status != self.statuses[number];
            self.statuses[number] = status;
            self.reports[number] = report;
        }
        self.passed = self.passed.saturating_add(1);
        // A change of status is sent at once, at any rate.
        if self.passed >= self.every || changed {
            self.passed = 0;
            put(&HandFrame::Readings {
                reports: &self.reports,
                fraction_bits: (self.bits, &self.shifts),
            });
        }
        changed
    }

    /// The reports of the last instant, in the order of the tips.
    pub const fn reports(&self) -> &[Report; TIPS] {
        &self.reports
    }

    /// Executes a command for a tip, or for all. Returns whether there is such a tip. `store` gets each calibration to store, with
    /// the number of its tip.
    pub fn request(
        &mut self,
        tips: &mut [&mut dyn HandTip; TIPS],
        now: Microseconds,
        (tip, request): (u8, Request),
        mut put: impl FnMut(&HandFrame<'_>),
        mut store: impl FnMut(u8, ToStore),
    ) -> bool {
        let which = match usize::from(tip) {
            tip if tip < TIPS => tip..tip + 1,
            _ if tip == ALL_TIPS => 0..TIPS,
            _ => return false,
        };
        if let Command::Rate { every } = request.command {
            self.slow_down(tips, every);
        }
        let names = self.names;
        for (number, tip) in tips
            .iter_mut()
            .enumerate()
            .filter(|(number, _)| which.contains(number))
        {
            let to_store = tip.request(now, request, &mut |message| {
                tell(&names, number, message, &mut put);
            });
            if let Some(to_store) = to_store {
                store(number as u8, to_store);
            }
        }
        true
    }

    /// Takes the outcome of storing a tip's calibration, and the number of its record.
    pub fn stored(
        &self,
        tips: &mut [&mut dyn HandTip; TIPS],
        now: Microseconds,
        (tip, result, number): (u8, Result<(), StoreError>, u32),
        mut put: impl FnMut(&HandFrame<'_>),
    ) {
        let which = usize::from(tip);
        if let Some(tip) = tips.get_mut(which) {
            tip.stored(now, result, number, &mut |message| {
                tell(&self.names, which, message, &mut put);
            });
        }
    }
}

/// Passes on the messages of a tip other than reports.
fn tell<const TIPS: usize>(
    names: &HandNames<TIPS>,
    number: usize,
    message: &Message,
    put: &mut impl FnMut(&HandFrame<'_>),
) {
    let tip = number as u8;
    match message {
        Message::Hello(hello) => {
            if tip == 0 {
                let of_the_hand = Hello {
                    design_hash: names.hash,
                    ..*hello
                };
                put(&HandFrame::Board(of_the_hand, TIPS as u8));
            }
            put(&HandFrame::Tip(
                tip,
                names.tips.get(number).copied().unwrap_or_default(),
                *hello,
            ));
        }
        Message::Answer(answer) => put(&HandFrame::Answer(tip, *answer)),
        #[cfg(band)]
        Message::Band(band) => put(&HandFrame::Band(tip, *band)),
        // The reports of all tips share a frame.
        Message::Report { .. } => {}
        // Only the loader makes these messages.
        #[cfg(feature = "load-tip")]
        Message::Load(_) => {}
    }
}

#[cfg(test)]
mod tests;
