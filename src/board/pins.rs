//! The macro and the types of a board's table of pins and peripherals.

/// A pin that the converter reads.
#[cfg(transducer = "ratiometric")]
pub(super) struct Input {
    /// Its channel of ADC1.
    pub(super) channel: u8,
    /// Its port.
    pub(super) port: embassy_stm32::pac::gpio::Gpio,
    /// Number of the pin in the port.
    pub(super) pin: usize,
}

#[cfg(transducer = "ratiometric")]
impl Input {
    /// Pin `pin` of `port`, channel `channel` of ADC1.
    pub(super) const fn new(channel: u8, port: embassy_stm32::pac::gpio::Gpio, pin: usize) -> Self {
        Self { channel, port, pin }
    }

    /// Connects the pin to the converter.
    pub(super) fn connect(&self) {
        use embassy_stm32::pac::gpio::vals::Moder;
        self.port.moder().modify(|w| w.set_moder(self.pin, Moder::ANALOG));
    }
}

/// The peripherals that a board uses, named by their use: `Pins`, and `BusPins` for a transducer on a bus.
macro_rules! pins {
    (board { $($(#[$when:meta])? $name:ident: $peripheral:ident,)* } bus { $($(#[$bus_when:meta])? $bus_name:ident: $bus_peripheral:ident,)* }) => {
        /// What is used whatever the transducer is.
        pub(super) struct Pins {
            $($(#[$when])? pub(super) $name: embassy_stm32::Peri<'static, embassy_stm32::peripherals::$peripheral>,)*
            /// A transducer on a bus.
            #[cfg(not(transducer = "ratiometric"))]
            pub(super) bus: BusPins,
        }

        /// What a transducer on a bus is on.
        #[cfg(not(transducer = "ratiometric"))]
        pub(super) struct BusPins {
            $($(#[$bus_when])? pub(super) $bus_name:
                embassy_stm32::Peri<'static, embassy_stm32::peripherals::$bus_peripheral>,)*
        }

        impl Pins {
            /// Out of all that the chip has.
            pub(super) fn of(peripherals: embassy_stm32::Peripherals) -> Self {
                Self {
                    $($(#[$when])? $name: peripherals.$peripheral,)*
                    #[cfg(not(transducer = "ratiometric"))]
                    bus: BusPins { $($(#[$bus_when])? $bus_name: peripherals.$bus_peripheral,)* },
                }
            }
        }
    };
}
