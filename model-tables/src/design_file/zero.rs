//! `[zero]` and `[air]`: effects other than a press that move the zero, and the source of the air pressure.

use super::bounds::Bounds;
use super::section::{KeyFault, Section};
use super::{TransducerKindSection, TransducerSection};
use crate::constants::{AirReference, Quantity, UNSEEN_KELVINS, ZeroAssumptions};
use std::fmt::{self, Write};

/// `[zero]`, in the units of its keys. What is not stated moves nothing, but for drift and bound, whose defaults are the firmware's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZeroSection {
    /// `drift_pa_per_hour`, pascals per hour, > 0: of the transducer's offset at a steady temperature, without the
    /// weather; `None`: the kind's default.
    pub drift_pa_per_hour: Option<f64>,
    /// `per_kelvin_pa`, pascals per kelvin: how far a kelvin moves the offset that is left after compensation; `None`:
    /// the kind's default.
    pub per_kelvin_pa: Option<f64>,
    /// `fluid_head_pa`, pascals: from one attitude of the hand to another; `None`: 0.
    pub fluid_head_pa: Option<f64>,
    /// `hysteresis_pa`, pascals: permanent offset after a press; `None`: 0.
    pub hysteresis_pa: Option<f64>,
    /// `creep_pa`, pascals: offset after a press until the wall has crept back; `None`: 0.
    pub creep_pa: Option<f64>,
    /// `bound_pa`, pascals, > 0: largest bound of the zero of an ok reading; `None`: six noise floors.
    pub bound_pa: Option<f64>,
}

/// A millipascal, the finest step that the chip counts, to 100 kPa.
const STATED: Bounds = Bounds::within(0.0, 1e5, "Pa");
const SOME: Bounds = Bounds::within(1e-3, 1e5, "Pa");

/// Noise floors of the largest bound where a design states none; the first half of one is the level of a quiet window.
const BOUND_FLOORS: f64 = 6.0;
const LEVEL_FLOORS: f64 = 0.5;

impl ZeroSection {
    /// The section of a file. Of a transducer on which no reading could ever be ok it is refused.
    pub(super) fn parse(
        mut section: Section<'_>,
        transducer: Option<&TransducerSection>,
    ) -> Result<Self, KeyFault> {
        let zero = Self {
            drift_pa_per_hour: section
                .number("drift_pa_per_hour", Bounds::within(1e-3, 1e5, "Pa an hour"))?,
            per_kelvin_pa: section.number("per_kelvin_pa", Bounds::within(0.0, 1e4, "Pa a kelvin"))?,
            fluid_head_pa: section.number("fluid_head_pa", STATED)?,
            hysteresis_pa: section.number("hysteresis_pa", STATED)?,
            creep_pa: section.number("creep_pa", STATED)?,
            bound_pa: section.number("bound_pa", SOME)?,
        };
        if let Some(transducer) = transducer {
            let floor = transducer.noise_pa.max(transducer.resolution_pa);
            let bound = zero.bound_pa.unwrap_or(BOUND_FLOORS * floor);
            let least = LEVEL_FLOORS * floor + zero.always(transducer.kind);
            if least >= bound {
                let allowed = format!(
                    "more than {least} Pa, or no reading is ever ok: half a noise floor, and what [zero] states beside drift{}",
                    if matches!(transducer.kind, TransducerKindSection::Ratiometric { .. }) {
                        ", ten kelvins of per_kelvin_pa included, as this part does not tell its temperature"
                    } else {
                        ""
                    }
                );
                return Err(if section.has("bound_pa") {
                    section.refuse("bound_pa", &allowed)
                } else {
                    let default = format!("{allowed}; without the key it is six noise floors, {bound} Pa");
                    section.missing("bound_pa", &default)
                });
            }
        }
        section.finish()?;
        Ok(zero)
    }

    /// What may move the zero of a part of this kind at any time, pascals.
    fn always(&self, kind: TransducerKindSection) -> f64 {
        let blind = matches!(kind, TransducerKindSection::Ratiometric { .. });
        let kelvins = if blind { f64::from(UNSEEN_KELVINS) } else { 0.0 };
        let stated = [self.fluid_head_pa, self.hysteresis_pa, self.creep_pa];
        stated.into_iter().flatten().sum::<f64>() + kelvins * self.per_kelvin_pa.unwrap_or(0.0)
    }

    /// As the firmware knows it.
    pub fn assumptions(&self, air: AirReference) -> ZeroAssumptions {
        let millipascals = |pascals: Option<f64>| libm::round(pascals.unwrap_or(0.0) * 1e3) as i32;
        ZeroAssumptions {
            drift: millipascals(self.drift_pa_per_hour),
            per_kelvin: millipascals(self.per_kelvin_pa),
            fluid_head: millipascals(self.fluid_head_pa),
            hysteresis: millipascals(self.hysteresis_pa),
            creep: millipascals(self.creep_pa),
            bound: millipascals(self.bound_pa),
            air,
        }
    }

    /// The section in a design's canonical text; nothing where nothing is stated: the hashes of older designs stay.
    pub(super) fn print(&self, out: &mut String) -> fmt::Result {
        if *self == Self::default() {
            return Ok(());
        }
        writeln!(out, "\n[zero]")?;
        let keys = [
            ("drift_pa_per_hour", self.drift_pa_per_hour),
            ("per_kelvin_pa", self.per_kelvin_pa),
            ("fluid_head_pa", self.fluid_head_pa),
            ("hysteresis_pa", self.hysteresis_pa),
            ("creep_pa", self.creep_pa),
            ("bound_pa", self.bound_pa),
        ];
        for (key, value) in keys {
            if let Some(value) = value {
                writeln!(out, "{key} = {value:?}")?;
            }
        }
        Ok(())
    }
}

/// `[air]` of a file. A gauge part has no air in its zero.
pub(super) fn air(
    mut section: Section<'_>,
    transducer: Option<&TransducerSection>,
) -> Result<AirReference, KeyFault> {
    const REFERENCES: &str = "\"none\", \"host\" or \"part\"";
    let reference = match section.needed_text("reference", REFERENCES)? {
        "none" => AirReference::None,
        "host" => AirReference::Host,
        "part" => AirReference::Part,
        _ => return Err(section.refuse("reference", REFERENCES)),
    };
    let gauge = transducer.is_some_and(|transducer| transducer.quantity == Quantity::Gauge);
    if gauge && reference != AirReference::None {
        return Err(section.refuse(
            "reference",
            "\"none\", or [air] left out: the transducer is gauge, and the air is not in its zero",
        ));
    }
    section.finish()?;
    Ok(reference)
}

/// `[air]` in a design's canonical text.
pub(super) fn print_air(reference: AirReference, out: &mut String) -> fmt::Result {
    let word = match reference {
        AirReference::None => return Ok(()),
        AirReference::Host => "host",
        AirReference::Part => "part",
    };
    writeln!(out, "\n[air]\nreference = \"{word}\"")
}
