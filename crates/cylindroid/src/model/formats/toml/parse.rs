//! Mechanism files from text, with the files that they include.

use std::path::Path;

use super::describe;
use crate::error::Result;
use crate::model::Mechanism;
use crate::model::formats::load::load_from;

/// Reads the text of a mechanism file. The path is used in errors, and to find the files of
/// `[[robot]]` tables, which are read.
///
/// ```
/// use cylindroid::model::formats::toml;
/// use std::path::Path;
///
/// let text = r#"
///     name = "lever"
///     [[joint]]
///     name = "hinge"
///     type = "revolute"
///     between = ["ground", "lever"]
///     origin = [0.0, 0.0, 0.0]
///     axis = [0.0, 0.0, 1.0]
/// "#;
/// let robot = toml::parse(text, Path::new("lever.toml"))?;
/// assert_eq!((robot.name(), robot.n()), ("lever", 1));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`](crate::Error::File) with line and column for broken TOML, unknown keys, values of a wrong type,
/// and all that the builder refuses; the errors of included files.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    Ok(describe(text, path, "mechanism file", 0, &load_from)?.0)
}
