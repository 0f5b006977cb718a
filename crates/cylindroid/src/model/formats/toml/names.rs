//! Names that are predefined in every mechanism file.

/// The root of every mechanism file.
pub(super) const GROUND: &str = "ground";

/// The name of the frame at the reference point.
pub(super) const REFERENCE: &str = "reference";
