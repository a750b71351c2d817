//! What frames tell beside their message: their order, how late they came, and which command an answer belongs to.

pub(crate) mod clock;
pub(crate) mod order;
pub(crate) mod pending;
pub(crate) mod tip;
