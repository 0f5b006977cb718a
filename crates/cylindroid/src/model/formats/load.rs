//! Loading by name or path: the catalogue, or a file whose format is recognised.
//!
//! Checked  tests/formats/load.rs

use std::path::Path;

use super::span::Source;
use super::text_file::{self, TextFile};
use super::{mjcf, sdf, toml, urdf, xacro, xml_limits};
use crate::error::{Error, Result, shown};
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
    let TextFile { text, replaced } = text_file::read(path)?;
    let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
    let mechanism = match extension(path).as_deref() {
        Some("toml") => {
            if let Some(at) = replaced {
                let source = Source { format: "mechanism file", path, text: &text };
                let message = "this is not UTF-8, which a mechanism file must be";
                return Err(source.error(at..at + 1, message, "save it as UTF-8"));
            }
            let loader = |from: &Path, name: &str, depth| load_from(from, name, depth, close);
            toml::describe(&text, path, "mechanism file", (depth, &loader), close)?.0
        }
        Some("mjcf") => mjcf::parse(&text, path)?,
        Some("xacro") => match xacro::expand(path)? {
            Some(urdf) => urdf::parse_expanded(&urdf, path)?,
            None => urdf::parse(&text, path)?,
        },
        Some("urdf" | "xml" | "sdf") => read_xml(&text, path)?,
        _ if is_xml => read_xml(&text, path)?,
        _ => {
            return Err(Error::InvalidOption {
                option: "model file",
                value: shown(path),
                reason: "its format cannot be told; name a .urdf, .xml, .sdf or .toml file"
                    .to_owned(),
            });
        }
    };
    Ok(match replaced {
        None => mechanism,
        Some(at) => {
            let line = text[..at].matches('\n').count() + 1;
            let why = "names and texts have \u{fffd} for them; save the file as UTF-8";
            mechanism.noting(line, "bytes that are not UTF-8", why)
        }
    })
}

/// Reads XML by its root element; unknown ones go to the URDF reader, which reports the element.
fn read_xml(text: &str, path: &Path) -> Result<Mechanism> {
    match xml_limits::root(text) {
        Some("mujoco" | "mujocoinclude") => mjcf::parse(text, path),
        Some("sdf" | "gazebo") => sdf::parse(text, path),
        _ => urdf::parse(text, path),
    }
}

fn extension(path: &Path) -> Option<String> {
    path.extension().map(|e| e.to_string_lossy().to_lowercase())
}
