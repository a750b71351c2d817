//! The fingertip of a report: alone, or with the actuator that shares its fluid.

use model_tables::design::Design;
use model_tables::design_file::DesignFile;
use model_tables::model::feedback::{Loop, LoopError, LoopState};
use model_tables::model::{Fingertip, Kind, ModelError};
use model_tables::solid::disc::{DISC, Disc};

/// A fingertip at any depth. The actuator of a loop is a compliance that differs from depth to depth.
pub(super) struct Tips {
    /// Of the latest depth.
    pub(super) tip: Fingertip,
    /// Its compliance, cubic metres per pascal.
    pub(super) compliance: f64,
    /// `None`: no actuator shares the fluid, or there is no such state at the deepest.
    pub(super) haptic: Option<Loop>,
}

impl Tips {
    pub(super) fn of(file: &DesignFile, kind: Kind, design: &Design, tip: Fingertip, deepest: f64) -> Self {
        let haptic = || -> Result<Option<Loop>, LoopError> {
            let Some(disc) = file.disc() else {
                return Ok(None);
            };
            let disc = Disc::new(&disc, DISC).map_err(LoopError::Actuator)?;
            let mut haptic = Loop::new(kind, design, disc)?.with_gas(file.trapped_gas());
            haptic.at_indentation(deepest)?;
            Ok(Some(haptic))
        };
        Self {
            tip,
            compliance: design.compliance,
            // The section of the loop says why there is none.
            haptic: haptic().unwrap_or_default(),
        }
    }

    /// The fingertip of a depth, metres.
    ///
    /// # Errors
    /// [`ModelError`]; where only the loop has no state, the fingertip of the depth before is given.
    pub(super) fn at(&mut self, indentation: f64) -> Result<&mut Fingertip, ModelError> {
        if let Some(haptic) = &mut self.haptic {
            let state: Option<LoopState> = match haptic.at_indentation(indentation) {
                Ok(state) => Some(state),
                Err(LoopError::Fingertip(error)) => return Err(error),
                Err(_) => None,
            };
            if let Some(state) = state {
                self.tip = haptic.fingertip_of(&state)?;
                self.compliance = state.compliance;
            }
        }
        Ok(&mut self.tip)
    }
}
