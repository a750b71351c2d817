//! The logic between a sample and the line, without hardware and clock: reports at the requested rate, hellos, commands and their
//! outcomes.

use crate::device::task_monitor::Start;
#[cfg(band)]
use crate::link::band::BandMessage;
use crate::link::command::{Command, CommandKind, Outcome, Request};
use crate::link::telemetry::{Answer, Hello, Message};
use crate::signal::calibration::Calibration;
use crate::signal::design::{Design, Parameters};
use crate::signal::pipeline::Pipeline;
use crate::signal::report::Report;
use crate::signal::zero::{StartUp, Zero};
use crate::status::{Fault, LastFault, ResetCause, Status, Stored, Warnings};
use crate::storage::log::StoreError;
use crate::transducer::driver::Sample;
use crate::units::Microseconds;
use model_tables::constants::DesignConstants;
use model_tables::units::Nanometres;

/// Time from one hello to the next, microseconds.
const HELLO_PERIOD: u64 = 1_000_000;

/// Findings of a self-test, one bit each. No bit is set if the test found nothing.
pub mod findings {
    /// There are no readings.
    pub const NO_READING: u16 = 1;
    /// The zero is not verified.
    pub const ZERO_UNVERIFIED: u16 = 2;
    /// No stored calibration is in use.
    pub const NOT_STORED: u16 = 4;
    /// A leak or a bubble is suspected.
    pub const FLUID: u16 = 8;
    /// At the given indentation, the fingertip is softer than its model.
    pub const SOFT: u16 = 16;
    /// The run before this one ended in a fault.
    pub const LAST_FAULT: u16 = 32;
    /// Samples were lost since the last reset.
    pub const SAMPLES_LOST: u16 = 64;
    /// The crystal does not run.
    pub const CLOCK: u16 = 128;
}

/// Counters that other parts of the firmware update.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counters {
    /// Samples lost.
    pub samples_lost: u32,
    /// Frames dropped.
    pub frames_dropped: u32,
    /// Received frames and stretches of bytes that were not a command.
    pub commands_refused: u32,
}

/// State of a board at its start.
#[derive(Clone, Copy, Debug)]
pub struct Beginning {
    /// Cause of the reset.
    pub reset_cause: ResetCause,
    /// Record of the previous run.
    pub start: Start,
    /// State of the stored calibration.
    pub stored: Stored,
    /// Number of the stored calibration.
    pub stored_sequence: u32,
    /// The calibration in use. `None` if the design's own values are in use.
    pub calibration: Option<Calibration>,
    /// Whether the crystal has failed.
    pub clock_failed: bool,
    /// The firmware: major, minor, patch.
    pub firmware: [u8; 3],
}

/// A calibration to be stored in the flash; `None` clears the stored one. The caller reports the outcome to [`Device::stored`].
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ToStore(pub Option<Calibration>);

/// A command whose answer is not known yet.
#[derive(Clone, Copy, Debug)]
struct Pending {
    command: CommandKind,
    sequence: u16,
}

/// One fingertip and its line.
#[derive(Clone, Debug)]
pub struct Device<D: Design> {
    /// Counters that other parts of the firmware update.
    pub counters: Counters,
    pipeline: Pipeline<D>,
    hello: Hello,
    /// Whether the board stopped measuring after too many resets in a row.
    gave_up: bool,
    next_hello: u64,
    /// One report out of this many is sent.
    every: u16,
    passed: u16,
    status: Option<Status>,
    /// The last reading, for a self-test.
    last: Option<(Nanometres, Warnings)>,
    tare: Option<Pending>,
    save: Option<(Pending, ToStore)>,
}

impl<D: Design> Device<D> {
    /// A device of a design, without any sample yet.
    pub fn new(design: D, beginning: &Beginning) -> Self {
        let &Parameters {
            constants:
                DesignConstants {
                    hash,
                    table_version,
                    ref transducer,
                    ..
                },
            period,
            ..
        } = design.parameters();
        let Beginning {
            reset_cause,
            start,
            stored,
            ..
        } = *beginning;
        let refused = matches!(stored, Stored::OtherDesign | Stored::Damaged | Stored::Unreadable);
        let standing = Warnings::CALIBRATION_REFUSED
            .when(refused)
            .and(Warnings::CLOCK.when(beginning.clock_failed));
        let calibration = beginning.calibration.unwrap_or_default();
        let start_up = StartUp::after(reset_cause, start.kept, transducer.quantity);
        Self {
            counters: Counters::default(),
            pipeline: Pipeline::new(design, start_up, calibration, standing),
            hello: Hello {
                firmware: beginning.firmware,
                reset_cause,
                design_hash: hash,
                table_version,
                report_period: period,
                stored,
                last_fault: start.fault,
                last_fault_detail: start.detail,
                resets_in_a_row: start.crash_record.resets,
                stored_sequence: beginning.stored_sequence,
                ..Hello::default()
            },
            gave_up: start.give_up,
            next_hello: 0,
            every: 1,
            passed: 0,
            status: None,
            last: None,
            tare: None,
            save: None,
        }
    }

    /// Makes the report of one sample, or of its absence. `say` gets the messages for the line.
    #[inline]
    pub fn step(
        &mut self,
        now: Microseconds,
        sample: Result<Sample, Fault>,
        mut say: impl FnMut(&Message),
    ) -> Report {
        let report = if self.gave_up {
            Report {
                time: now,
                outcome: Err(Fault::ResetLoop),
            }
        } else {
            self.pipeline.step(now, sample)
        };
        if now.0 >= self.next_hello {
            self.next_hello = now.0.saturating_add(HELLO_PERIOD);
            self.greet(now, &mut say);
        }
        self.last = report
            .outcome
            .as_ref()
            .ok()
            .map(|reading| (reading.indentation, reading.warnings));
        if self.tare.is_some()
            && let Some(answer) = self.pipeline.take_tare_answer()
            && let Some(pending) = self.tare.take()
        {
            let outcome = answer.map_or_else(Outcome::from, |()| Outcome::Done);
            say(&answered(now, pending, outcome, 0));
        }
        self.passed = self.passed.saturating_add(1);
        let status = Some(report.status());
        // A change of status is sent at once, at any rate.
        if self.passed >= self.every || status != self.status {
            self.passed = 0;
            self.status = status;
            say(&Message::Report {
                report,
                pressure_fraction_bits: self.pipeline.parameters().pressure_fraction_bits as u8,
            });
        }
        report
    }

    /// Executes a command, or begins it. `say` gets the answer, as soon as there is one. The caller stores the calibration that
    /// this returns.
    pub fn request(
        &mut self,
        now: Microseconds,
        request: Request,
        mut say: impl FnMut(&Message),
    ) -> Option<ToStore> {
        let pending = Pending {
            command: request.command.kind(),
            sequence: request.sequence,
        };
        let (mut found, mut told) = (0, None);
        let outcome = match request.command {
            // No sample reaches the signal path. It could not finish a tare, and nothing would show whether its zero is still valid.
            Command::Tare | Command::Save { .. } if self.gave_up => Outcome::NoReading,
            Command::Tare => match self.pipeline.tare() {
                Ok(()) => {
                    self.tare = Some(pending);
                    return None;
                }
                Err(refusal) => refusal.into(),
            },
            Command::Undo => self
                .pipeline
                .undo_tare()
                .map_or_else(Outcome::from, |()| Outcome::Done),
            Command::Save { gain } => match self.pipeline.calibration_to_store() {
                None => Outcome::ZeroUnverified,
                Some(calibration) => {
                    let gain = gain.unwrap_or(calibration.gain);
                    return self.store(now, pending, Some(Calibration { gain, ..calibration }), say);
                }
            },
            Command::Forget => return self.store(now, pending, None, say),
            Command::Air { pascals } => self
                .pipeline
                .air(now, pascals)
                .map_or_else(Outcome::from, |()| Outcome::Done),
            Command::Info => {
                self.greet(now, &mut say);
                Outcome::Done
            }
            Command::SelfTest { indentation } => {
                found = self.self_test(indentation);
                Outcome::Done
            }
            Command::Object(touched) => self
                .pipeline
                .touch_object(touched)
                .map_or_else(Outcome::from, |()| Outcome::Done),
            Command::Indentation { known } => {
                told = self.pipeline.tell(Nanometres(known));
                found = told.map_or(0, |told| told.doubts);
                told.map_or(Outcome::NoReading, |_| Outcome::Done)
            }
            Command::Rate { every } => {
                self.every = every;
                self.hello.report_period = u32::from(every) * self.pipeline.parameters().period;
                Outcome::Done
            }
        };
        let mut answer = answered(now, pending, outcome, found);
        if let Message::Answer(answer) = &mut answer {
            answer.known = told;
        }
        say(&answer);
        None
    }

    fn store(
        &mut self,
        now: Microseconds,
        pending: Pending,
        calibration: Option<Calibration>,
        mut say: impl FnMut(&Message),
    ) -> Option<ToStore> {
        if self.save.is_some() {
            say(&answered(now, pending, Outcome::Busy, 0));
            return None;
        }
        let to_store = ToStore(calibration);
        self.save = Some((pending, to_store));
        Some(to_store)
    }

    /// Takes the outcome of a store, and the number of the record now in use.
    pub fn stored(
        &mut self,
        now: Microseconds,
        result: Result<(), StoreError>,
        sequence: u32,
        mut say: impl FnMut(&Message),
    ) {
        let Some((pending, ToStore(calibration))) = self.save.take() else {
            return;
        };
        let outcome = match result {
            Ok(()) => {
                self.hello.stored = calibration.map_or(Stored::None, |_| Stored::InUse);
                self.hello.stored_sequence = sequence;
                self.pipeline.calibrated(calibration);
                Outcome::Done
            }
            Err(StoreError::Failed | StoreError::WornOut) => Outcome::MemoryFailed,
            Err(StoreError::TooSoon) => Outcome::SavedTooOften,
        };
        say(&answered(now, pending, outcome, 0));
    }

    fn self_test(&mut self, indentation: i32) -> u16 {
        let mut found = 0;
        let mut add = |finding: u16, holds: bool| {
            if holds {
                found |= finding;
            }
        };
        match self.last {
            None => add(findings::NO_READING, true),
            Some((read, warnings)) => {
                let warned = |warning| warnings.contains(warning);
                add(findings::ZERO_UNVERIFIED, warned(Warnings::ZERO_UNVERIFIED));
                add(
                    findings::FLUID,
                    warned(Warnings::LEAK_SUSPECTED) || warned(Warnings::BUBBLE_SUSPECTED),
                );
                add(findings::CLOCK, warned(Warnings::CLOCK));
                let soft = indentation > 0 && !self.pipeline.compare(read, Nanometres(indentation));
                add(findings::SOFT, soft);
            }
        }
        add(findings::NOT_STORED, self.hello.stored != Stored::InUse);
        add(findings::LAST_FAULT, self.hello.last_fault != LastFault::None);
        add(findings::SAMPLES_LOST, self.counters.samples_lost > 0);
        found
    }

    /// Sends a hello, and the band of an unknown object.
    #[inline]
    fn greet(&self, now: Microseconds, mut say: impl FnMut(&Message)) {
        say(&Message::Hello(self.hello(now)));
        #[cfg(band)]
        if let Some(band) = self.pipeline.band() {
            say(&Message::Band(BandMessage {
                time: now,
                pressure_fraction_bits: self.pipeline.parameters().pressure_fraction_bits as u8,
                band: *band,
            }));
        }
    }

    fn hello(&self, now: Microseconds) -> Hello {
        Hello {
            time: now,
            samples_lost: self.counters.samples_lost,
            samples_rejected: self.pipeline.rejected(),
            frames_dropped: self.counters.frames_dropped,
            commands_refused: self.counters.commands_refused,
            ..self.hello
        }
    }

    /// The parameters of the design that the signal path needs.
    #[inline]
    pub fn parameters(&self) -> &Parameters {
        self.pipeline.parameters()
    }

    /// The zero in use, to keep across an unrequested reset.
    pub fn zero(&self) -> Option<Zero> {
        self.pipeline.zero()
    }
}

fn answered(time: Microseconds, pending: Pending, outcome: Outcome, findings: u16) -> Message {
    Message::Answer(Answer {
        time,
        command: pending.command,
        command_sequence: pending.sequence,
        outcome,
        findings,
        known: None,
    })
}

#[cfg(test)]
mod tests;
