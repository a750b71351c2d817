//! A report in units that people read.

use fingertip::link::band::BandMessage;
use fingertip::signal::report::Report;
use fingertip::status::{Status, Touch, Warnings};
use fingertip::units::Microseconds;
use model_tables::units::PressureRise;
use std::time::Duration;

/// A report as people read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveReading {
    /// The board's clock, since its reset.
    pub time: Microseconds,
    /// When it was measured on the host's clock, since the watch began: when it came, less what the line held it back.
    pub measured: Duration,
    /// Frames that are missing right before it.
    pub missing_before: u64,
    /// Hash of the design in the image; `None` until a hello gave it.
    pub design: Option<u64>,
    /// How far to believe it.
    pub status: Status,
    /// Its values; `None` of a fault.
    pub values: Option<LiveValues>,
    /// Whether something presses.
    pub touch: Touch,
    /// Where the truth lies, for an object that the board does not know; `None` of another board, of a fault or a bound, and below and above
    /// the pressures of its band.
    pub band: Option<LiveBand>,
}

/// The least and the largest that force and indentation may truly be: the band of an unknown object, without the standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveBand {
    /// Force, newtons.
    pub force_n: [f64; 2],
    /// Indentation, millimetres.
    pub indentation_mm: [f64; 2],
}

impl LiveBand {
    /// Of a report, by the band that its board sent; nothing where that states nothing of it.
    pub fn of(report: &Report, pressure_fraction_bits: u8, message: &BandMessage) -> Option<Self> {
        let measurement = report.outcome.ok()?;
        let bounds = [Warnings::SATURATED, Warnings::BELOW_ZERO, Warnings::RECOVERING];
        if bounds.iter().any(|bound| measurement.warnings.contains(*bound)) {
            return None;
        }
        // A frame of a hand may have fewer fraction bits than its tips.
        let shift = u32::from(
            message
                .pressure_fraction_bits
                .saturating_sub(pressure_fraction_bits),
        );
        let rise = i64::from(measurement.pressure_rise.0) << shift;
        let row = message.band.at(PressureRise(i32::try_from(rise).ok()?))?;
        let ends =
            |value: f64, tenths: [i16; 2]| tenths.map(|tenths| value * (1.0 + 1e-3 * f64::from(tenths)));
        Some(Self {
            force_n: ends(measurement.force.newtons(), row.force),
            indentation_mm: ends(1e3 * measurement.indentation.metres(), row.indentation),
        })
    }
}

/// The values of a report. A number at the end of what a frame can carry is infinite: it is a bound, not a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveValues {
    /// Pressure over the zero, pascals, and its standard deviation.
    pub pressure_rise_pa: [f64; 2],
    /// Force, newtons, and its standard deviation.
    pub force_n: [f64; 2],
    /// Indentation, millimetres, and its standard deviation.
    pub indentation_mm: [f64; 2],
    /// Force of the feedback actuator, newtons, and its standard deviation; `None` of a design without one.
    pub feedback_force_n: Option<[f64; 2]>,
}

impl LiveReading {
    pub(super) fn of(report: &Report, pressure_fraction_bits: u8) -> Self {
        let bits = u32::from(pressure_fraction_bits);
        let values = report.outcome.ok().map(|measurement| {
            let sigma = measurement.sigma;
            LiveValues {
                pressure_rise_pa: [measurement.pressure_rise, sigma.pressure_rise]
                    .map(|pressure| bounded(pressure.0, pressure.pascals(bits))),
                force_n: [measurement.force, sigma.force].map(|force| bounded(force.0, force.newtons())),
                indentation_mm: [measurement.indentation, sigma.indentation]
                    .map(|length| bounded(length.0, 1e3 * length.metres())),
                feedback_force_n: measurement.feedback.force().map(|feedback| {
                    [feedback.force, feedback.sigma].map(|force| bounded(force.0, force.newtons()))
                }),
            }
        });
        Self {
            time: report.time,
            measured: Duration::ZERO,
            missing_before: 0,
            design: None,
            status: report.status(),
            values,
            band: None,
            touch: report
                .outcome
                .map_or(Touch::Unknown, |measurement| measurement.touch),
        }
    }

    /// Its values if they hold as they stand, else nothing: what is qualified or missing is not for showing.
    pub fn ok(&self) -> Option<LiveValues> {
        self.values
            .filter(|_| self.status == Status::Ok)
            .filter(LiveValues::is_finite)
    }
}

impl LiveValues {
    fn is_finite(&self) -> bool {
        [self.pressure_rise_pa, self.force_n, self.indentation_mm]
            .iter()
            .chain(&self.feedback_force_n)
            .flatten()
            .all(|value| value.is_finite())
    }
}

/// A number of the wire; infinite where it stands at the end of its range.
fn bounded(number: i32, value: f64) -> f64 {
    if number.saturating_abs() == i32::MAX {
        f64::INFINITY.copysign(value)
    } else {
        value
    }
}
