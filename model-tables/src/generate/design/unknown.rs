//! The band of force and indentation for an unknown object, for the tables of a design.

use super::super::object::{Band, TableError, Unknown};
use super::super::{Certificate, Certified};
use crate::table::law::Touched;

/// The band of what the chip reads to begin with.
pub(super) fn band(unknown: &Unknown, certified: &Certified) -> Option<Band> {
    let Certificate {
        force, indentation, ..
    } = &certified.certificate;
    let error = [(force, 1e-6), (indentation, 1e-9)].map(|(errors, unit)| TableError {
        percent: errors.of_reading.max.max(errors.below_percent_of_from),
        from: unit * errors.from,
    });
    let tables = &certified.tables;
    match &certified.object {
        None => unknown.band(tables, Touched::Plate, error),
        Some(object) => unknown.band(&object.blended(tables, object.start)?, object.start, error),
    }
}
