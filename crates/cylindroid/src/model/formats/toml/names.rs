//! Names that every mechanism file knows.

/// The root of every mechanism file.
pub(super) const GROUND: &str = "ground";

/// The name of the frame that the reference point makes.
pub(super) const REFERENCE: &str = "reference";
