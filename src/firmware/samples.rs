//! Source of the samples of a hand's tips: the converter's scans, or the rounds of the parts on the bus, where each part has
//! its own task. The image contains only the drivers of the kinds in the hand.

#[cfg(transducer = "bus")]
pub(super) use on_the_bus::{Samples, of};
#[cfg(transducer = "ratiometric")]
pub(super) use scanned::{Samples, of};

#[cfg(transducer = "ratiometric")]
mod scanned {
    use embassy_executor::Spawner;
    use fingertip::board::{Clock, Port};
    use fingertip::image::{ROW, ROWS, TIPS, TRANSDUCERS};
    use fingertip::transducer::scan::Scan;

    /// The samples of a block.
    pub(in crate::firmware) type Samples = Scan<Port, TIPS, ROW, ROWS>;

    /// The samples of the board's converter.
    #[allow(clippy::unused_async)] // a bus waits here
    pub(in crate::firmware) async fn of(port: Port, _clock: Clock, _spawner: Spawner) -> Samples {
        Scan::new(TRANSDUCERS, port)
    }
}

#[cfg(transducer = "bus")]
mod on_the_bus {
    use embassy_executor::Spawner;
    use embassy_time::Delay;
    use fingertip::board::{Clock, Port};
    use fingertip::image::{self, ROUNDS, TIPS};
    use fingertip::transducer::rounds::{RoundReader, Rounds, keep};
    use fingertip::transducer::shared_bus::{BusPort, SharedBus};
    use model_tables::constants::TransducerKind;
    use static_cell::StaticCell;

    /// The samples of a round.
    pub(in crate::firmware) type Samples = RoundReader<'static, Clock, TIPS>;

    static BUS: StaticCell<SharedBus<Port, TIPS>> = StaticCell::new();
    static PARTS: StaticCell<Rounds<TIPS>> = StaticCell::new();

    /// The samples of the parts on the board's bus. All branches are closed first, because a reset of the chip leaves them open.
    pub(in crate::firmware) async fn of(port: Port, clock: Clock, spawner: Spawner) -> Samples {
        let bus = BUS.init_with(|| SharedBus::new(port));
        bus.clear().await;
        let rounds = PARTS.init_with(|| Rounds::new(ROUNDS, clock.now().0));
        for tip in 0..TIPS {
            spawner.spawn(measure(tip, rounds, bus, clock).expect("one for each tip"));
        }
        RoundReader::new(rounds, clock)
    }

    /// Takes the samples of the part of a tip. Period: a round. Deadline: the end of the round; when late, the sample is lost, which is
    /// reported. A part that fails is tried less and less often.
    #[embassy_executor::task(pool_size = TIPS)]
    async fn measure(
        tip: usize,
        rounds: &'static Rounds<TIPS>,
        bus: &'static SharedBus<Port, TIPS>,
        clock: Clock,
    ) {
        let port = BusPort::new(bus, image::branch(tip), clock, rounds.commanded(tip));
        let transducer = image::part(tip);
        match transducer.kind {
            #[cfg(part = "abp2")]
            TransducerKind::Abp2 { .. } => {
                let part = fingertip::transducer::abp2::Abp2::new(&transducer, port, Delay);
                keep(rounds, tip, part, clock).await;
            }
            #[cfg(part = "ms5837")]
            TransducerKind::Ms5837 { address } => {
                let part = fingertip::transducer::ms5837::Ms5837::new(address, port, Delay);
                keep(rounds, tip, part, clock).await;
            }
            #[cfg(part = "dps310")]
            TransducerKind::Dps310 { address } => {
                let part = fingertip::transducer::dps310::Dps310::new(address, port, Delay);
                keep(rounds, tip, part, clock).await;
            }
            _ => unreachable!("the build script names the kinds of the hand"),
        }
    }
}
