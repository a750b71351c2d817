//! The boards: one short file for each board, with its pins, clocks and interrupts and their reasons; one file for each family
//! of chips; and the parts that all boards share.

mod common;
#[cfg(all(transducer = "ratiometric", not(hand)))]
mod converter;
#[cfg(not(transducer = "ratiometric"))]
mod i2c;
mod memory;
#[cfg(not(feature = "board-nucleo-f429zi"))]
mod reset_flags;
#[macro_use]
mod pins;
#[cfg(all(transducer = "ratiometric", not(feature = "board-nucleo-f429zi")))]
mod ring;
#[cfg(all(transducer = "ratiometric", hand))]
mod scan;

#[cfg(feature = "board-nucleo-f429zi")]
#[path = "stm32f4.rs"]
mod chip;
#[cfg(feature = "board-nucleo-f429zi")]
#[path = "nucleo_f429zi.rs"]
mod chosen;
#[cfg(feature = "board-nucleo-f429zi")]
#[path = "ecc_none.rs"]
pub mod ecc;

#[cfg(feature = "board-nucleo-l432kc")]
#[path = "stm32l4.rs"]
mod chip;
#[cfg(feature = "board-nucleo-l432kc")]
#[path = "nucleo_l432kc.rs"]
mod chosen;
#[cfg(feature = "board-nucleo-l432kc")]
#[path = "ecc_double_word.rs"]
pub mod ecc;

#[cfg(feature = "board-nucleo-g474re")]
#[path = "stm32g4.rs"]
mod chip;
#[cfg(feature = "board-nucleo-g474re")]
#[path = "nucleo_g474re.rs"]
mod chosen;
#[cfg(feature = "board-nucleo-g474re")]
#[path = "ecc_double_word.rs"]
pub mod ecc;

pub use chosen::{CLOCK, SLOT};
#[cfg(all(not(hand), feature = "load-tip"))]
pub use chosen::{TIP_SLOT, TIPS};
#[cfg(all(hand, feature = "load-tip"))]
pub use chosen::{TIP_SLOTS, TIPS};
pub use common::{Board, Clock, FlashMemory, Line, Port, SerialRx, Watchdog, begin};

#[cfg(all(feature = "rs485", feature = "board-nucleo-f429zi"))]
compile_error!(
    "the STM32F4's serial ports have no driver enable: rs485 is for board-nucleo-l432kc and board-nucleo-g474re"
);

#[cfg(not(any(
    feature = "board-nucleo-f429zi",
    feature = "board-nucleo-l432kc",
    feature = "board-nucleo-g474re"
)))]
compile_error!("choose a board: --no-default-features --features board-nucleo-l432kc");
