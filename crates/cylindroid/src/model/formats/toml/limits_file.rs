//! Files of limits: a TOML table for each joint, `[wrist_1_joint]`, with the limits that replace
//! those of the model: lower, upper, velocity, acceleration, effort.
//!
//! Units    rad, m, s, N m, N
//! Checked  tests/formats/joint_limits.rs

use std::path::Path;

use ::toml::de::{DeTable, DeValue};

use super::limit;
use super::value::Table;
use crate::error::{Error, Result};
use crate::model::formats::span::Source;
use crate::model::formats::text_file;
use crate::model::{JointLimits, Mechanism};

/// A mechanism with the limits of a file.
///
/// # Errors
/// A file that cannot be read; [`Error::File`] with line and column for broken TOML, unknown joints
/// with the nearest names, unknown limits, and limits that [`Mechanism::with_limits`] rejects.
pub fn with_limits_of_file(mechanism: &Mechanism, path: &Path) -> Result<Mechanism> {
    with_limits_of_text(mechanism, &text_file::read(path)?.utf8("file of limits", path)?, path)
}

/// A mechanism with the limits of a text; `path` is for messages.
///
/// ```
/// use cylindroid::model::formats::toml::with_limits_of_text;
///
/// let text = "
///     [wrist_1_joint]
///     velocity = 0.5      # rad/s
///     acceleration = 5.0  # rad/s^2
/// ";
/// let path = std::path::Path::new("slow.toml");
/// let ur5e = with_limits_of_text(&cylindroid::load("ur5e")?, text, path)?;
/// assert_eq!(ur5e.limits_of("wrist_1_joint").unwrap().velocity, 0.5);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`with_limits_of_file`].
pub fn with_limits_of_text(mechanism: &Mechanism, text: &str, path: &Path) -> Result<Mechanism> {
    let source = Source { format: "limits", path, text };
    limit::check(&source)?;
    let document = DeTable::parse(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        source.error(span, format!("broken TOML: {}", e.message()), "")
    })?;
    let mut limited = mechanism.clone();
    for (name, value) in document.get_ref() {
        let DeValue::Table(map) = value.get_ref() else {
            let help = format!("write [{}], and its limits below", name.get_ref());
            return Err(source.error(value.span(), "this is no table of limits", help));
        };
        let table = Table::new(source, "limits", map, value.span(), &JointLimits::NAMES)?;
        let mut limits = JointLimits::default();
        for key in JointLimits::NAMES {
            if let Some(value) = table.bound(key)? {
                limits = limits.with(key, value)?;
            }
        }
        let joint = name.get_ref().as_ref();
        limited = limited.with_limits(&[(joint, limits)]).map_err(|error| {
            let message = match error {
                Error::InvalidOption { reason, .. } => format!("{joint}: {reason}"),
                other => other.to_string(),
            };
            source.error(name.span(), message, "")
        })?;
    }
    Ok(limited)
}
