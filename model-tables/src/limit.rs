//! Where a press ends, and the error of an indentation that has no state.

use core::fmt;

/// Cause of the end of a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndsBy {
    /// The bulge becomes tangent to the base plane.
    BulgeTouchesBase,
    /// All fluid has been pressed into the compliance: the membrane lies flat.
    FluidDrained,
    /// The inner surface of a solid wall reaches the base plane.
    WallTouchesBase,
    /// The material law softens at strains that the wall reaches, and nothing more is in balance.
    MaterialSoftens,
    /// A solid wall folds onto itself.
    WallFolds,
    /// The path of a solid from rest ends: the next state in balance lies elsewhere, and the wall would snap there.
    NoFurtherState,
}

impl EndsBy {
    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::BulgeTouchesBase => "bulge-touches-base",
            Self::FluidDrained => "fluid-drained",
            Self::WallTouchesBase => "wall-touches-base",
            Self::MaterialSoftens => "material-softens",
            Self::WallFolds => "wall-folds",
            Self::NoFurtherState => "no-further-state",
        }
    }
}

/// The end of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Largest indentation, metres.
    pub indentation: f64,
    /// Pressure there, pascals.
    pub pressure: f64,
    /// Force there, newtons.
    pub force: f64,
    /// Why it ends.
    pub ends_by: EndsBy,
}

impl Limit {
    /// The same with its indentation as `read` has it.
    #[must_use]
    pub fn read_by(self, read: impl Fn(f64) -> f64) -> Self {
        Self {
            indentation: read(self.indentation),
            ..self
        }
    }

    /// That `asked`, metres, lies beyond it.
    pub(crate) fn refuse(&self, f: &mut fmt::Formatter<'_>, asked: f64) -> fmt::Result {
        write!(
            f,
            "indentation {} mm is beyond the limit of {:.6} mm, where the press ends ({}); ask for less",
            asked * 1e3,
            self.indentation * 1e3,
            self.ends_by.word()
        )
    }
}

/// That `asked`, metres, is no indentation.
pub(crate) fn refuse_indentation(f: &mut fmt::Formatter<'_>, asked: f64) -> fmt::Result {
    write!(
        f,
        "indentation {} mm is not possible: it must be a number of at least 0",
        asked * 1e3
    )
}

/// That the state at `asked` was not found, on the way from `reached`; metres.
pub(crate) fn refuse_unsolved(
    f: &mut fmt::Formatter<'_>,
    asked: f64,
    reached: f64,
    failure: &dyn fmt::Display,
) -> fmt::Result {
    write!(
        f,
        "the state at indentation {} mm was not found ({failure}); the last one found is at {:.6} mm",
        asked * 1e3,
        reached * 1e3
    )
}

/// That a cup is so tight that it touches beside the pole first; metres.
pub(crate) fn refuse_cup(f: &mut fmt::Formatter<'_>, radius: f64, least: f64) -> fmt::Result {
    write!(
        f,
        "a cup of radius {:.6} mm touches the tip beside its pole first: object.radius_mm has to be below -{:.6}",
        radius * 1e3,
        least * 1e3
    )
}

/// That a cylinder is no body of revolution on the axis.
pub(crate) fn refuse_cylinder(f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str(
        "object.shape = \"cylinder\" has no axial symmetry, as the model has: give a ball, a cup or a punch",
    )
}
