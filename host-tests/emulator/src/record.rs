//! What the firmware reported, each report beside the truth of the instant it refers to.

use crate::bench::{Listener, Moment};
use crate::plant::Plant;
use fingertip::link::band::BandMessage;
use fingertip::link::telemetry::{Answer, Decoder, Frame, Hello, Message};
use fingertip::link::wire::DecodeError;
use fingertip::signal::report::Report;
use fingertip::status::{Status, Touch};
use model_tables::curve::{Contact, Curve};
use std::io::Write;
use std::ops::ControlFlow;

/// The image's clock counts with a 16-bit timer at 1 MHz, seconds from one overflow to the next. Its driver counts
/// the overflows from a flag that the start of the timer already sets, so its time may be whole overflows ahead.
const OVERFLOW: f64 = 65_536e-6;

/// The instant that the image calls `device_time`, for a report that has come within an overflow of it.
pub(crate) fn instant(device_time: f64, moment: Moment) -> f64 {
    let time = moment.clock_zero + device_time;
    time - OVERFLOW * ((time - moment.time) / OVERFLOW).ceil().max(0.0)
}

/// One report and the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The instant the report refers to, seconds since power-on.
    pub time: f64,
    /// The contact at that instant.
    pub truth: Contact,
    /// How far the firmware believes itself.
    pub status: Status,
    /// What it reports; `None` where it reports a fault.
    pub reported: Option<Contact>,
    /// One standard deviation of each, as it reports it; `None` where it reports a fault.
    pub sigma: Option<Contact>,
    /// Whether it feels a touch.
    pub touch: Touch,
    /// What the actuator presses the wearer with.
    pub feedback: FeedbackPair,
}

/// A force of the feedback actuator, newtons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeedbackPair {
    /// The truth, newtons; `None` without an actuator.
    pub truth: Option<f64>,
    /// What the firmware reports, newtons; `None` without an actuator, and where it reports a fault.
    pub reported: Option<f64>,
}

/// Everything that came over the wire in one run.
#[derive(Debug, Default)]
pub struct Recording {
    /// The reports in order.
    pub rows: Vec<Row>,
    /// From the instant of each report to the end of its last byte on the line, seconds, in order.
    pub latencies: Vec<f64>,
    /// The greetings in order.
    pub hellos: Vec<Hello>,
    /// What came of commands, in order.
    pub answers: Vec<Answer>,
    /// Bands of an unknown object, in order.
    pub bands: Vec<BandMessage>,
    /// What did not read as a frame.
    pub broken: Vec<DecodeError>,
    /// Frames that the sequence numbers say are missing.
    pub lost: u64,
}

/// Listens to the firmware's telemetry and keeps the record of it.
pub struct Recorder<F> {
    decoder: Decoder,
    sequence: Option<u16>,
    record: Recording,
    on_row: F,
}

impl<F: FnMut(&Row) + Send + 'static> Recorder<F> {
    /// A recorder that shows each row to `on_row` as it comes.
    pub fn new(on_row: F) -> Self {
        Self {
            decoder: Decoder::default(),
            sequence: None,
            record: Recording::default(),
            on_row,
        }
    }

    /// The record.
    pub fn into_record(self) -> Recording {
        self.record
    }

    fn take(&mut self, frame: &Frame, moment: Moment, plant: &Plant) {
        if let Some(before) = self.sequence.replace(frame.sequence) {
            self.record.lost += u64::from(frame.sequence.wrapping_sub(before).wrapping_sub(1));
        }
        match &frame.message {
            Message::Report {
                report,
                pressure_fraction_bits,
            } => {
                let time = instant(report.time.0 as f64 * 1e-6, moment);
                let row = Row {
                    time,
                    truth: plant.truth(time),
                    status: report.status(),
                    reported: contact(report, *pressure_fraction_bits),
                    sigma: sigma(report, *pressure_fraction_bits),
                    touch: report
                        .outcome
                        .map_or(Touch::Unknown, |measurement| measurement.touch),
                    feedback: FeedbackPair {
                        truth: plant.feedback_truth(time),
                        reported: feedback(report),
                    },
                };
                (self.on_row)(&row);
                self.record.latencies.push(moment.time - time);
                self.record.rows.push(row);
            }
            Message::Hello(hello) => self.record.hellos.push(*hello),
            Message::Answer(answer) => self.record.answers.push(*answer),
            Message::Band(band) => self.record.bands.push(*band),
            // Nothing is loaded onto an emulated board: its flash keeps nothing.
            Message::Load(_) => {}
        }
    }
}

impl<F: FnMut(&Row) + Send + 'static> Listener for Recorder<F> {
    fn hear(&mut self, byte: u8, moment: Moment, plant: &Plant) -> ControlFlow<()> {
        match self.decoder.push(byte) {
            Some(Ok(frame)) => self.take(&frame, moment, plant),
            Some(Err(error)) => self.record.broken.push(error),
            None => {}
        }
        ControlFlow::Continue(())
    }
}

/// The values of a report in SI units.
fn contact(report: &Report, pressure_fraction_bits: u8) -> Option<Contact> {
    let measurement = report.outcome.ok()?;
    Some(Contact {
        pressure_rise: measurement
            .pressure_rise
            .pascals(u32::from(pressure_fraction_bits)),
        force: measurement.force.newtons(),
        indentation: measurement.indentation.metres(),
    })
}

/// One standard deviation of those values.
fn sigma(report: &Report, pressure_fraction_bits: u8) -> Option<Contact> {
    let sigma = report.outcome.ok()?.sigma;
    Some(Contact {
        pressure_rise: sigma.pressure_rise.pascals(u32::from(pressure_fraction_bits)),
        force: sigma.force.newtons(),
        indentation: sigma.indentation.metres(),
    })
}

/// The force of the feedback actuator, newtons.
fn feedback(report: &Report) -> Option<f64> {
    let feedback = report.outcome.ok()?.feedback.force()?;
    Some(feedback.force.newtons())
}

/// The columns of the CSV file: a contract with scripts.
pub const COLUMNS: [&str; 8] = [
    "time_ms",
    "true_pressure_rise_pa",
    "true_force_n",
    "true_indentation_mm",
    "status",
    "pressure_rise_pa",
    "force_n",
    "indentation_mm",
];

/// What follows them where there is a feedback actuator.
pub const FEEDBACK_COLUMNS: [&str; 2] = ["true_feedback_force_n", "feedback_force_n"];

/// What follows them where static tables are compared: what they give for the pressure reported.
pub const STATIC_COLUMNS: [&str; 2] = ["static_force_n", "static_indentation_mm"];

/// Writes the rows as CSV with [`COLUMNS`], with [`FEEDBACK_COLUMNS`] where there is an actuator, and with [`STATIC_COLUMNS`] where there are static
/// tables; what is reported is empty where there is no reading.
///
/// # Errors
/// What the writer answers.
pub fn write_csv(rows: &[Row], static_tables: Option<&Curve>, to: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(to);
    let feels = rows.iter().any(|row| row.feedback.truth.is_some());
    let beside = if feels { &FEEDBACK_COLUMNS[..] } else { &[] };
    let compared = if static_tables.is_some() {
        &STATIC_COLUMNS[..]
    } else {
        &[]
    };
    writer.write_record(COLUMNS.iter().chain(beside).chain(compared))?;
    for row in rows {
        let reported = row.reported.map_or([const { String::new() }; 3], |reported| {
            [
                format!("{:.6}", reported.pressure_rise),
                format!("{:.6}", reported.force),
                format!("{:.6}", reported.indentation * 1e3),
            ]
        });
        let truth = [
            format!("{:.3}", row.time * 1e3),
            format!("{:.9}", row.truth.pressure_rise),
            format!("{:.12}", row.truth.force),
            format!("{:.12}", row.truth.indentation * 1e3),
            row.status.to_string(),
        ];
        let FeedbackPair {
            truth: force,
            reported: felt,
        } = row.feedback;
        let feedback = [(force, 12), (felt, 6)]
            .map(|(value, decimals)| value.map_or_else(String::new, |value| format!("{value:.decimals$}")));
        let beside = if feels { &feedback[..] } else { &[] };
        let of_static = static_tables.map(|tables| {
            row.reported.map_or([const { String::new() }; 2], |reported| {
                let contact = tables.at_pressure_rise(reported.pressure_rise);
                [contact.force, contact.indentation * 1e3].map(|value| format!("{value:.6}"))
            })
        });
        let compared = of_static.as_ref().map_or(&[][..], |values| &values[..]);
        writer.write_record(truth.iter().chain(&reported).chain(beside).chain(compared))?;
    }
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::tests::{press, ramp};
    use fingertip::link::telemetry::encode;
    use fingertip::signal::report::{Feedback, Measurement, Sigma};
    use fingertip::status::{Fault, Touch, Warnings};
    use fingertip::units::Microseconds;
    use model_tables::units::{Micronewtons, Nanometres, PressureRise};

    fn frame(sequence: u16, time: u64, outcome: Result<Measurement, Fault>) -> Frame {
        Frame {
            sequence,
            dropped: 0,
            message: Message::Report {
                report: Report {
                    time: Microseconds(time),
                    outcome,
                },
                pressure_fraction_bits: 8,
            },
        }
    }

    fn recorded(frames: &[Frame]) -> Recording {
        let plant = press(8e3, ramp());
        let mut recorder = Recorder::new(|_| {});
        let moment = Moment {
            time: 9.0,
            clock_zero: 0.01,
        };
        for frame in frames {
            for &byte in encode(frame).iter() {
                assert!(recorder.hear(byte, moment, &plant).is_continue());
            }
        }
        recorder.into_record()
    }

    const READING: Measurement = Measurement {
        pressure_rise: PressureRise(256_128),
        force: Micronewtons(1_234_567),
        indentation: Nanometres(1_500_001),
        sigma: Sigma {
            pressure_rise: PressureRise(742),
            force: Micronewtons(900),
            indentation: Nanometres(1_200),
        },
        touch: Touch::Touched,
        warnings: Warnings::NONE,
        feedback: Feedback::NONE,
    };

    #[test]
    fn a_report_stands_beside_the_truth_of_its_own_instant() {
        let record = recorded(&[frame(0, 290_000, Ok(READING))]);
        // 10 ms to the zero of its clock, 290 ms on it: the plate is half way down its ramp.
        let row = record.rows[0];
        assert!((row.time - 0.3).abs() < 1e-12);
        assert_eq!(row.truth, press(8e3, ramp()).truth(row.time));
        let reported = row.reported.expect("it is a reading");
        assert!((reported.pressure_rise - 1000.5).abs() < 1e-9);
        assert!((reported.force - 1.234_567).abs() < 1e-12);
        assert!((reported.indentation - 1.500_001e-3).abs() < 1e-15);
    }

    #[test]
    fn a_clock_that_is_an_overflow_ahead_is_taken_back() {
        let moment = |time| Moment {
            time,
            clock_zero: 0.001,
        };
        for ahead in [0.0, OVERFLOW, 3.0 * OVERFLOW] {
            // It refers to 0.501 s and comes 2 ms later.
            assert!((instant(0.5 + ahead, moment(0.503)) - 0.501).abs() < 1e-12);
        }
    }

    #[test]
    fn missing_frames_are_counted_across_the_wrap() {
        let record = recorded(&[65_534, 65_535, 2, 3].map(|sequence| frame(sequence, 0, Ok(READING))));
        assert_eq!(record.lost, 2);
        assert_eq!(record.rows.len(), 4);
    }

    #[test]
    fn the_file_has_the_columns_of_the_contract_and_no_number_with_a_fault() {
        let record = recorded(&[
            frame(0, 290_000, Ok(READING)),
            frame(1, 90_000, Err(Fault::SensorOpen)),
        ]);
        let mut file = vec![];
        write_csv(&record.rows, None, &mut file).expect("a vector takes everything");
        let text = String::from_utf8(file).expect("it is text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "time_ms,true_pressure_rise_pa,true_force_n,true_indentation_mm,status,pressure_rise_pa,force_n,indentation_mm"
        );
        assert!(lines[1].starts_with("300.000,"), "{}", lines[1]);
        assert!(
            lines[1].ends_with(",ok,1000.500000,1.234567,1.500001"),
            "{}",
            lines[1]
        );
        assert_eq!(
            lines[2],
            "100.000,0.000000000,0.000000000000,0.000000000000,fault: sensor open,,,"
        );
        assert_eq!(lines.len(), 3);
    }
}
