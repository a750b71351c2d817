//! A second image for the same board: answers every input of [`probes::lookup_sweep`] with a reading frame, in order,
//! then says hello for ever. What arrives is compared bit for bit with the host's answers.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
mod probe {
    use defmt_rtt as _;
    use embassy_executor::Spawner;
    use embassy_time::Timer;
    use fingertip::board::{self, Board};
    use fingertip::image::ImageDesign;
    use fingertip::link::telemetry::{Frame, Hello, Message, encode};
    use fingertip::signal::report::Report;
    use fingertip::transducer::counts::PERIOD;
    use panic_probe as _;
    use probes::lookup_sweep;

    #[embassy_executor::main]
    async fn main(spawner: Spawner) {
        // One task is all there is.
        let _ = spawner;
        let reset_cause = board::begin();
        let Board {
            clock,
            mut line,
            mut watchdog,
            ..
        } = Board::take(false, reset_cause);
        let mut sequence = 0_u16;
        for rise in lookup_sweep::inputs(&ImageDesign::PARAMETERS) {
            let report = Report {
                time: clock.now(),
                outcome: Ok(lookup_sweep::answer(&ImageDesign, rise)),
            };
            let message = Message::Report {
                report,
                pressure_fraction_bits: ImageDesign::PARAMETERS.pressure_fraction_bits as u8,
            };
            // The line has no receiver that could refuse; a failed transfer shows as a gap in the sequence.
            let frame = Frame {
                sequence,
                dropped: 0,
                message,
            };
            let _ = line.write(&encode(&frame)).await;
            sequence = sequence.wrapping_add(1);
            watchdog.pet();
        }
        loop {
            let message = Message::Hello(Hello {
                time: clock.now(),
                reset_cause,
                design_hash: ImageDesign::CONSTANTS.hash,
                report_period: PERIOD,
                ..Hello::default()
            });
            let frame = Frame {
                sequence,
                dropped: 0,
                message,
            };
            let _ = line.write(&encode(&frame)).await;
            sequence = sequence.wrapping_add(1);
            watchdog.pet();
            Timer::after_millis(10).await;
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This is an image for a board: its answers are compared with the host's by `cargo test-all`.");
    std::process::exit(1);
}
