//! Loading by name or path: the catalogue, or a file whose format is recognised.
//!
//! Checked  tests/formats/load.rs

use std::path::Path;

use super::span::Source;
use super::{mjcf, sdf, toml, urdf, xml};
use crate::error::{Error, Result};
use crate::model::{CloseHome, Mechanism, catalogue};

/// Extensions that mark a word as a missing file, not as a misspelt name.
const EXTENSIONS: [&str; 6] = ["urdf", "xml", "xacro", "sdf", "toml", "mjcf"];

/// Loads a model: the name of a catalogue model, or the path of a file.
///
/// # Errors
/// A name that is neither, a file that cannot be read or parsed, a loop that cannot be closed.
pub(crate) fn load(name_or_path: &str, close: CloseHome<'_>) -> Result<Mechanism> {
    load_from(Path::new(""), name_or_path, 0, close)
}

/// [`load`] for a file in `folder`, at a nesting depth of `depth` inclusions.
pub(super) fn load_from(
    folder: &Path,
    name_or_path: &str,
    depth: usize,
    close: CloseHome<'_>,
) -> Result<Mechanism> {
    if catalogue::names().contains(&name_or_path) {
        return catalogue::load(name_or_path);
    }
    let path = Path::new(name_or_path);
    let looks_like_a_path = name_or_path.contains(['/', '\\'])
        || extension(path).is_some_and(|e| EXTENSIONS.contains(&e.as_str()));
    let path = folder.join(path);
    if looks_like_a_path || path.exists() {
        return read_file(&path, depth, close);
    }
    let names = catalogue::names().iter().copied();
    Err(Error::unknown("catalogue model or file", name_or_path, names))
}

/// Loads a model file, by its extension and content.
///
/// # Errors
/// As [`load`].
pub(crate) fn load_file(path: &Path, close: CloseHome<'_>) -> Result<Mechanism> {
    read_file(path, 0, close)
}

fn read_file(path: &Path, depth: usize, close: CloseHome<'_>) -> Result<Mechanism> {
    let bytes = std::fs::read(path).map_err(|e| Error::Io {
        path: path.to_owned(),
        action: "read",
        message: e.to_string(),
    })?;
    // Old files have names and comments in other encodings; the numbers are ASCII in all of them.
    let text = String::from_utf8_lossy(&bytes);
    let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
    match extension(path).as_deref() {
        Some("toml") => {
            let loader = |from: &Path, name: &str, depth| load_from(from, name, depth, close);
            Ok(toml::describe(&text, path, "mechanism file", (depth, &loader), close)?.0)
        }
        Some("mjcf") => mjcf::parse(&text, path),
        Some("urdf" | "xml" | "xacro" | "sdf") => read_xml(&text, path),
        _ if is_xml => read_xml(&text, path),
        _ => Err(Error::InvalidOption {
            option: "model file",
            value: path.display().to_string(),
            reason: "its format cannot be told; name a .urdf, .xml, .sdf or .toml file".to_owned(),
        }),
    }
}

/// Reads XML by its root element; unknown ones go to the URDF reader, which reports the element.
fn read_xml(text: &str, path: &Path) -> Result<Mechanism> {
    let source = Source { format: "XML", path, text };
    let root = xml::document(&source).ok().map(|d| d.root_element().tag_name().name().to_owned());
    match root.as_deref() {
        Some("mujoco" | "mujocoinclude") => mjcf::parse(text, path),
        Some("sdf" | "gazebo") => sdf::parse(text, path),
        _ => urdf::parse(text, path),
    }
}

fn extension(path: &Path) -> Option<String> {
    path.extension().map(|e| e.to_string_lossy().to_lowercase())
}
