//! Gas trapped in the fluid's circuit: a bubble in the line between fingertip and actuator.

/// Standard atmosphere, pascals: ISO 2533.
pub const STANDARD_ATMOSPHERE: f64 = 101_325.0;

/// An amount of gas that keeps its temperature: Boyle's law, `(P + ambient) V = const`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrappedGas {
    /// Its volume at ambient pressure, cubic metres, >= 0.
    pub volume: f64,
    /// Absolute pressure outside, pascals, > 0.
    pub ambient: f64,
}

impl TrappedGas {
    /// No gas.
    pub const NONE: Self = Self {
        volume: 0.0,
        ambient: STANDARD_ATMOSPHERE,
    };

    /// Decrease of the gas volume from no gauge pressure to this gauge pressure in pascals, > -ambient: cubic metres.
    pub fn compressed(&self, pressure: f64) -> f64 {
        self.volume * pressure / (self.ambient + pressure)
    }

    /// Derivative of this decrease by the pressure, cubic metres per pascal.
    pub fn compliance(&self, pressure: f64) -> f64 {
        let absolute = self.ambient + pressure;
        self.volume * self.ambient / (absolute * absolute)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At twice the absolute pressure half the volume is left; the slope there is a quarter of `volume / ambient`.
    #[test]
    fn gas_follows_boyles_law() {
        let gas = TrappedGas {
            volume: 8e-9,
            ambient: STANDARD_ATMOSPHERE,
        };
        assert!((gas.compressed(STANDARD_ATMOSPHERE) - 4e-9).abs() < 1e-22);
        assert!((gas.compliance(STANDARD_ATMOSPHERE) * STANDARD_ATMOSPHERE / 2e-9 - 1.0).abs() < 1e-14);
        assert!(gas.compressed(0.0) == 0.0 && gas.compressed(-1e3) < 0.0);
    }
}
