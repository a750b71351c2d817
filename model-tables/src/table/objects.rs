//! Tables of objects other than a plate, loaded at run time.

use super::blend::BlendedTables;
use super::known::{KnownContact, Lookups, ReadPair};
use super::law::{BlendLaw, Touched};
use super::{ContactLookup as _, LoadedTables, Reading, TablesError};
use crate::units::{Nanometres, PressureRise};

/// The tables of the plate and of the reference ball, and the law of the weights.
#[derive(Clone, Copy, Debug)]
pub struct LoadedObjects<'a> {
    /// The object that is touched at the start.
    pub start: Touched,
    law: BlendLaw,
    plate: LoadedTables<'a>,
    ball: LoadedTables<'a>,
}

impl<'a> LoadedObjects<'a> {
    /// Of the plate's tables, and the words of the ball's.
    ///
    /// # Errors
    /// [`TablesError`] if the tables may give wrong values.
    pub fn new(
        start: Touched,
        law: BlendLaw,
        plate: LoadedTables<'a>,
        ball: &'a [[u8; 4]],
    ) -> Result<Self, TablesError> {
        let layout = *plate.layout();
        if layout.halvings > 0 {
            return Err(TablesError::Layout("halvings"));
        }
        let ball = LoadedTables::new(layout, ball)?;
        let lowest = |tables: &LoadedTables<'a>| tables.words().rchunks(layout.words()).next();
        if lowest(&plate) != lowest(&ball) {
            return Err(TablesError::Zero);
        }
        Ok(Self {
            start,
            law,
            plate,
            ball,
        })
    }

    /// The tables of an object. `None` if the law does not cover it, or if its blend may give wrong values.
    pub fn blended(&self, touched: Touched) -> Option<BlendedTables> {
        let weights = self.law.weights(touched)?;
        let (plate, ball) = (self.plate.words(), self.ball.words());
        BlendedTables::new(self.plate.layout(), plate, ball, &weights).ok()
    }

    /// The contact from a known indentation, above 0, and a reading through tables that end at `last`.
    pub fn tell(
        &self,
        touched: impl Fn(PressureRise) -> Reading,
        last: PressureRise,
        read: &ReadPair,
        known: Nanometres,
    ) -> KnownContact {
        let lookups = Lookups {
            touched,
            last: [last, PressureRise(self.plate.layout().maximum)],
            plate: |rise| self.plate.contact_at(rise),
            ball: |rise| self.ball.contact_at(rise),
        };
        lookups.tell(&self.law, read, known)
    }
}
