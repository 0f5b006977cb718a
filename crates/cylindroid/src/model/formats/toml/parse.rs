//! Parses mechanism files from text, with the files that they include.

use std::path::Path;

use super::{Nesting, describe};
use crate::error::Result;
use crate::model::formats::load::load_from;
use crate::model::{CloseHome, Mechanism, ParameterValues};

/// Reads the text of a mechanism file without assembling home: loops closed by `[[closure]]` frames
/// may be open there ([`Mechanism::unassembled`]). `cylindroid::load_text` closes them.
///
/// # Errors
/// [`Error::File`](crate::Error::File) with line and column for broken TOML, unknown keys, values
/// of a wrong type, and everything that the builder rejects; the errors of included files.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    read(text, path, &[], &Ok)
}

/// Reads the text of a mechanism file with these values of parameters; `close` assembles home.
pub(crate) fn read(
    text: &str,
    path: &Path,
    given: ParameterValues<'_>,
    close: CloseHome<'_>,
) -> Result<Mechanism> {
    let loader = |from: &Path, name: &str, nesting, values: ParameterValues<'_>| {
        load_from(from, name, values, nesting, close)
    };
    Ok(describe(text, path, "mechanism file", given, (Nesting::default(), &loader), close)?.0)
}
