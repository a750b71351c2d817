//! A third image for the same board: solves [`probes::solver_states`] with the full model, in `f64` without an
//! allocation, and sends what came out. The host compares the bits and counts the instructions.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
mod probe {
    use defmt_rtt as _;
    use embassy_executor::Spawner;
    use embassy_time::Timer;
    use fingertip::board::Board;
    use fingertip::status::ResetCause;
    use panic_probe as _;
    use probes::solver_states::{self, DESIGN, INDENTATIONS, LENGTH, Room, SolverState};
    use static_cell::ConstStaticCell;

    /// All that a press needs, where it stays: the stack holds no second one.
    static ROOM: ConstStaticCell<Room> = ConstStaticCell::new(Room::new(DESIGN.law));

    /// Cycles, some milliseconds: the emulator counts calls from its first stop on, one millisecond after power-on.
    const HEAD_START: u32 = 1_000_000;

    #[embassy_executor::main]
    async fn main(spawner: Spawner) {
        // One task is all there is.
        let _ = spawner;
        cortex_m::asm::delay(HEAD_START);
        // Before the board: no interrupt takes part in what is counted, and no watchdog has to wait for it.
        let states = states(ROOM.take());
        let Board {
            mut line,
            mut watchdog,
            ..
        } = Board::take(false, ResetCause::Unknown);
        for state in states {
            // The line has no receiver that could refuse.
            let _ = line.write(&state.to_bytes()).await;
        }
        loop {
            watchdog.pet();
            Timer::after_millis(10).await;
        }
    }

    /// A state that is not found ends the probe: its bytes never come.
    fn states(room: &mut Room) -> [SolverState; LENGTH] {
        let mut states = [const { None }; LENGTH];
        let mut room = Some(room);
        let mut press = None;
        for (i, state) in states.iter_mut().enumerate() {
            *state = measured(&mut || match (room.take(), &mut press) {
                (Some(room), _) => {
                    let (state, at_rest) = solver_states::rest(room).ok()?;
                    press = Some(at_rest);
                    Some(state)
                }
                (None, Some(press)) => solver_states::pressed(press, INDENTATIONS[i - 1]).ok(),
                (None, None) => None,
            });
        }
        states.map(|state| state.expect("the model has these states"))
    }

    /// What the host counts, by its name.
    #[inline(never)]
    fn measured(solve: &mut dyn FnMut() -> Option<SolverState>) -> Option<SolverState> {
        solve()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This is an image for a board: its answers are compared with the host's by `cargo test-all`.");
    std::process::exit(1);
}
