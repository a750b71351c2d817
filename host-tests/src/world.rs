//! A fingertip of the image's design in virtual time: true pressures in, what the firmware says out.

use fingertip::device::logic::{Beginning, Device, ToStore};
use fingertip::device::task_monitor::CrashRecord;
use fingertip::image::ImageDesign;
use fingertip::link::command::{Command, Request};
use fingertip::link::telemetry::Message;
use fingertip::signal::calibration::Calibration;
use fingertip::signal::design::{Design, Parameters};
use fingertip::signal::report::Report;
use fingertip::signal::zero::surroundings::Surroundings;
use fingertip::status::{Fault, ResetCause, Stored};
use fingertip::transducer::driver::Sample;
use fingertip::units::{Microseconds, Millipascals};
use model_tables::constants::{Quantity, TransducerKind};
use model_tables::table::Reading;
use model_tables::units::PressureRise;

/// The design of the image, with an absolute transducer in place of its own.
#[derive(Clone, Copy, Debug)]
pub struct WithAbsolutePart;

impl WithAbsolutePart {
    const PARAMETERS: Parameters = {
        let mut constants = ImageDesign::CONSTANTS;
        constants.transducer.kind = TransducerKind::Ms5837 { address: 0x76 };
        constants.transducer.quantity = Quantity::Absolute;
        constants.transducer.range = [1_000, 200_000];
        let image = ImageDesign::PARAMETERS;
        Parameters::of(constants, image.pressure_fraction_bits, image.last_rise)
    };
}

impl Design for WithAbsolutePart {
    type Wall = <ImageDesign as Design>::Wall;
    type Around = [Surroundings; 1];

    fn parameters(&self) -> &Parameters {
        const { &Self::PARAMETERS }
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        ImageDesign.lookup(rise)
    }
}

/// One fingertip and the firmware that reads it.
#[derive(Debug)]
pub struct World<D: Design> {
    design: D,
    device: Device<D>,
    /// Microseconds since reset.
    pub now: u64,
    /// What went on the line besides reports.
    pub emitted: Vec<Message>,
}

/// A beginning after a reset by `cause`, with a stored calibration or none, and what the run before left.
pub fn beginning(
    design: &impl Design,
    cause: ResetCause,
    calibration: Option<Calibration>,
    left: Option<CrashRecord>,
) -> Beginning {
    Beginning {
        reset_cause: cause,
        start: CrashRecord::start(left, cause, design.parameters().constants.hash),
        stored: if calibration.is_some() {
            Stored::InUse
        } else {
            Stored::None
        },
        stored_sequence: u32::from(calibration.is_some()),
        calibration,
        clock_failed: false,
        firmware: [0, 1, 0],
    }
}

/// The air around the fingertip, pascals.
const AIR: f64 = 101_325.0;

/// Pascals at rest, as the transducer reads them: with the air where it is absolute.
pub fn rest(design: &impl Design) -> f64 {
    let constants = &design.parameters().constants;
    let air = match constants.transducer.quantity {
        Quantity::Gauge => 0.0,
        Quantity::Absolute => AIR,
    };
    f64::from(constants.rest_pressure) + air
}

/// Pascals from rest to the end of the tables.
pub fn full_scale(design: &impl Design) -> f64 {
    let constants = &design.parameters().constants;
    f64::from(constants.maximum_pressure - constants.rest_pressure)
}

/// A sample of a pressure in pascals, measured half a period before it is given.
pub fn sample(design: &impl Design, pascals: f64) -> Sample {
    let millipascals = (pascals * 1000.0).round() as i32;
    Sample {
        pressure: Millipascals(millipascals),
        headroom: Millipascals(
            design.parameters().constants.transducer.range[1]
                .saturating_mul(1000)
                .saturating_sub(millipascals),
        ),
        age: 500,
        ..Sample::default()
    }
}

impl<D: Design + Clone> World<D> {
    /// A world that begins.
    pub fn new(design: D, beginning: &Beginning) -> Self {
        Self {
            device: Device::new(design.clone(), beginning),
            design,
            now: 0,
            emitted: vec![],
        }
    }

    /// Switched on, nothing stored, 400 ms untouched at `rest` pascals.
    pub fn zeroed(design: D, rest: f64) -> Self {
        let begins = beginning(&design, ResetCause::PowerOn, None, None);
        let sample = sample(&design, rest);
        let mut world = Self::new(design, &begins);
        for _ in 0..400 {
            world.step(1000, Ok(sample));
        }
        world
    }

    /// The report of what came `later` microseconds later.
    pub fn step(&mut self, later: u64, sample: Result<Sample, Fault>) -> Report {
        self.now += later;
        let emitted = &mut self.emitted;
        self.device.step(Microseconds(self.now), sample, |message| {
            if !matches!(message, Message::Report { .. }) {
                emitted.push(*message);
            }
        })
    }

    /// Asks for something.
    pub fn ask(&mut self, command: Command) -> Option<ToStore> {
        let emitted = &mut self.emitted;
        let request = Request { sequence: 0, command };
        self.device
            .request(Microseconds(self.now), request, |message| emitted.push(*message))
    }

    /// The zero in use, pascals.
    pub fn zero(&self) -> Option<f64> {
        let counts = self.device.zero()?.pressure.0;
        Some(f64::from(counts) / f64::from(1_u32 << self.design.parameters().pressure_fraction_bits))
    }
}

/// The reported rise, pascals.
pub fn rise(design: &impl Design, report: &Report) -> Option<f64> {
    let rise = report.outcome.ok()?.pressure_rise;
    Some(rise.pascals(design.parameters().pressure_fraction_bits))
}
