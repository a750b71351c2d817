//! A fourth image for the same board: looks force and indentation up in the ways of `compare::lookups` and with the
//! tables of the shipped designs, over and over. The host counts the instructions of each.
//!
//! What a way costs hardly depends on the numbers in its table, and those here are of a plain square root.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
mod probe {
    use compare::lookups;
    use core::hint::black_box;
    use defmt_rtt as _;
    use embassy_executor::Spawner;
    use embassy_time::Timer;
    use fingertip::board::Board;
    use fingertip::status::ResetCause;
    use panic_probe as _;
    use probes::lookup_ways::{INPUTS, SIZES};

    /// Cycles, some milliseconds: the emulator counts calls from its first stop on, one millisecond after power-on.
    const HEAD_START: u32 = 1_000_000;
    /// The largest table.
    const MAX_SIZE: usize = SIZES[SIZES.len() - 1];
    /// Octaves that the segments of an octave each span.
    const OCTAVES: usize = 16;

    #[embassy_executor::main]
    async fn main(spawner: Spawner) {
        // One task is all there is.
        let _ = spawner;
        cortex_m::asm::delay(HEAD_START);
        // Before the board: no interrupt takes part in what is counted, and no watchdog has to wait for it.
        fixed_point();
        searched();
        others();
        tables();
        let Board { mut watchdog, .. } = Board::take(false, ResetCause::Unknown);
        loop {
            watchdog.pet();
            Timer::after_millis(10).await;
        }
    }

    /// From 0 to 1, denser towards 0, as a press needs it.
    fn place(i: usize, of: usize) -> f32 {
        let share = i as f32 / of as f32;
        share * share
    }

    fn fixed_point() {
        let mut wide = [0_i32; MAX_SIZE];
        let mut narrow = [0_i16; MAX_SIZE];
        for (i, (wide, narrow)) in wide.iter_mut().zip(&mut narrow).enumerate() {
            *wide = (i as i32) << 21;
            *narrow = (i as i16) << 5;
        }
        let end = (MAX_SIZE as i32 - 1) << 20;
        for i in 0..INPUTS {
            let x = (place(i, INPUTS) * end as f32) as i32;
            uniform_q31(black_box(&wide), x, black_box(&mut [0; 2]));
            uniform_q15(black_box(&narrow), x, black_box(&mut [0; 2]));
        }
    }

    fn searched() {
        let mut lines = [[0.0_f32; 3]; MAX_SIZE];
        let mut cubics = [[0.0_f32; 5]; MAX_SIZE];
        for size in SIZES {
            for i in 0..size {
                let x = place(i, size - 1);
                lines[i] = [x, x, x];
                cubics[i] = [x, x, 1.0, x, 1.0];
            }
            for i in 0..INPUTS {
                let x = place(i, INPUTS);
                linear_f32(black_box(&lines[..size]), x, black_box(&mut [0.0; 2]));
                cubic_f32(black_box(&cubics[..size]), x, black_box(&mut [0.0; 2]));
            }
        }
    }

    fn others() {
        let warped = [[0.5_f32; 2]; 64];
        let segments = [[[1 << 20; 2]; 2], [[1 << 21; 2]; 2]];
        let [lines, squares, cubes] = [
            [segments[0]; OCTAVES],
            [segments[1]; OCTAVES],
            [segments[0]; OCTAVES],
        ];
        let squares = squares.map(|both| both.map(|[a, b]| [a, b, 1 << 18]));
        let cubes = cubes.map(|both| both.map(|[a, b]| [a, b, 1 << 18, 1 << 16]));
        let rational = [[1.0, 0.5, 0.25, 0.5, 0.25]; 2];
        let power = [[1.5, 0.7], [2.5, 0.6]];
        for i in 0..INPUTS {
            let x = place(i, INPUTS);
            let counts = (x * (1 << OCTAVES) as f32) as i32;
            warped_f32(black_box(&warped), x, black_box(&mut [0.0; 2]));
            octave_linear(black_box(&lines), counts, black_box(&mut [0; 2]));
            octave_quadratic(black_box(&squares), counts, black_box(&mut [0; 2]));
            octave_cubic(black_box(&cubes), counts, black_box(&mut [0; 2]));
            rational_f32(black_box(&rational), x, black_box(&mut [0.0; 2]));
            power_libm(black_box(&power), x, black_box(&mut [0.0; 2]));
            power_micromath(black_box(&power), x, black_box(&mut [0.0; 2]));
        }
    }

    /// What the host counts: a function each, from its first instruction to its return.
    macro_rules! measured {
        ($($name:ident($($argument:ident: $kind:ty),*) $body:block)*) => {
            $(
                #[inline(never)]
                fn $name($($argument: $kind),*) $body
            )*
        };
    }

    measured! {
        uniform_q31(knots: &[i32; MAX_SIZE], x: i32, out: &mut [i32; 2]) {
            lookups::uniform_q31([knots, knots], x, out);
        }
        uniform_q15(knots: &[i16; MAX_SIZE], x: i32, out: &mut [i16; 2]) {
            lookups::uniform_q15([knots, knots], x, out);
        }
        linear_f32(knots: &[[f32; 3]], x: f32, out: &mut [f32; 2]) {
            lookups::linear_f32(knots, x, out);
        }
        cubic_f32(knots: &[[f32; 5]], x: f32, out: &mut [f32; 2]) {
            lookups::cubic_f32(knots, x, out);
        }
        warped_f32(knots: &[[f32; 2]; 64], x: f32, out: &mut [f32; 2]) {
            lookups::warped_f32(knots, 63.0, x, out);
        }
        octave_linear(segments: &[[[i32; 2]; 2]; OCTAVES], x: i32, out: &mut [i32; 2]) {
            lookups::octave_i32(segments, 1, 15, x, out);
        }
        octave_quadratic(segments: &[[[i32; 3]; 2]; OCTAVES], x: i32, out: &mut [i32; 2]) {
            lookups::octave_i32(segments, 1, 15, x, out);
        }
        octave_cubic(segments: &[[[i32; 4]; 2]; OCTAVES], x: i32, out: &mut [i32; 2]) {
            lookups::octave_i32(segments, 1, 15, x, out);
        }
        rational_f32(both: &[[f32; 5]; 2], x: f32, out: &mut [f32; 2]) {
            lookups::rational_f32(both, x, out);
        }
        power_libm(both: &[[f32; 2]; 2], x: f32, out: &mut [f32; 2]) {
            lookups::power_f32(both, libm::powf, x, out);
        }
        power_micromath(both: &[[f32; 2]; 2], x: f32, out: &mut [f32; 2]) {
            lookups::power_f32(both, micromath::F32Ext::powf, x, out);
        }
    }

    /// The tables of a shipped design, as reviewed, and their lookup.
    macro_rules! shipped {
        ($($module:ident $lookup:ident $path:literal)*) => {
            $(
                #[allow(clippy::unreadable_literal, dead_code, unreachable_pub)] // written by a program
                mod $module {
                    include!(concat!("../../../../model-tables/golden/", $path, "/tables.rs"));
                    use core::hint::black_box;
                    use model_tables::table::Outputs;

                    #[inline(never)]
                    pub(super) fn $lookup(rise: i32, out: &mut Outputs) {
                        *out = TABLES.lookup(rise);
                    }

                    pub(super) fn run(share: f32) {
                        let rise = (share * TABLES.layout.maximum as f32) as i32;
                        $lookup(rise, black_box(&mut Outputs::default()));
                    }
                }
            )*

            fn tables() {
                for i in 0..INPUTS {
                    let share = place(i, INPUTS);
                    $($module::run(share);)*
                }
            }
        };
    }

    shipped! {
        index_fingertip_elastic index_fingertip_elastic_tables "index-fingertip-elastic"
        paper_prestretched paper_prestretched_tables "paper-prestretched"
        skin_analogue skin_analogue_tables "skin-analogue"
        skin_light_touch skin_light_touch_tables "skin-light-touch"
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This is an image for a board: what its lookups cost is counted by `cargo test-all`.");
    std::process::exit(1);
}
