//! What the paper says: Shi, Shariati, Eames and Wurdemann, Soft Matter 18 (2022) 9076.

/// Indentations of the published forces, metres.
pub(in crate::commands) const INDENTATIONS: [f64; 3] = [0.5e-3, 1.5e-3, 2e-3];
/// Published forces there, newtons.
pub(in crate::commands) const FORCES: [f64; 3] = [0.38, 1.6, 2.11];
/// Published pressure of the rest state, pascals.
pub(super) const REST_PRESSURE: f64 = 2.1e3;
/// Published radius of the inflated equator, metres.
pub(super) const EQUATOR_RADIUS: f64 = 9e-3;
/// Published height over radius of the inflated dome.
pub(super) const ASPECT: f64 = 0.78;
/// Published hoop stretch of the equator.
pub(super) const HOOP_STRETCH: f64 = 2.0;
/// Published blocked force of the actuator by its formula, newtons.
pub(super) const BLOCKED_FORCE: f64 = 1.98;
/// Measured there, newtons.
pub(super) const MEASURED_BLOCKED_FORCE: f64 = 1.68;
/// The pressure of both, pascals.
pub(super) const BLOCKED_PRESSURE: f64 = 17.9e3;
/// Published volume change of the actuator, cubic metres.
pub(super) const VOLUME_CHANGE: f64 = 1.38e-9;
/// The pressure it belongs to, pascals.
pub(super) const VOLUME_CHANGE_PRESSURE: f64 = 17.935e3;
/// The fluid's volume, cubic metres: this is 0.432 % of it.
pub(super) const VOLUME: f64 = VOLUME_CHANGE / 0.432e-2;
