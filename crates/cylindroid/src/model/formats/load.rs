//! Loading by name or path: the catalogue, or a file whose format is recognised.
//!
//! Checked  tests/formats/load.rs

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::text_file;
use super::toml::Nesting;
use super::{mjcf, sdf, toml, urdf, xacro, xml_limits};
use crate::error::{Error, Result, shown};
use crate::model::{CloseHome, Mechanism, ParameterValues, catalogue};

/// Extensions that mark a word as a missing file, not as a misspelt name.
const EXTENSIONS: [&str; 6] = ["urdf", "xml", "xacro", "sdf", "toml", "mjcf"];

/// Loads a model: the name of a catalogue model, or the path of a file.
///
/// # Errors
/// A name that is neither, a file that cannot be read or parsed, a loop that cannot be closed.
pub(crate) fn load(
    name_or_path: &str,
    given: ParameterValues<'_>,
    close: CloseHome<'_>,
) -> Result<Mechanism> {
    load_from(Path::new(""), name_or_path, given, Nesting::default(), close)
}

/// [`load`] for a file in `folder`, which others may include.
pub(super) fn load_from(
    folder: &Path,
    name_or_path: &str,
    given: ParameterValues<'_>,
    nesting: Nesting,
    close: CloseHome<'_>,
) -> Result<Mechanism> {
    match found(folder, name_or_path)? {
        None => catalogue::load_with(name_or_path, given),
        Some(path) => read_file(&path, given, nesting, close),
    }
}

/// The path of a file; `None` for a name of the catalogue.
fn found(folder: &Path, name_or_path: &str) -> Result<Option<PathBuf>> {
    if catalogue::names().contains(&name_or_path) {
        return Ok(None);
    }
    let path = folder.join(name_or_path);
    let (file, _) = file_and_model(&path);
    let looks_like_a_path = name_or_path.contains(['/', '\\'])
        || extension(&file).is_some_and(|e| EXTENSIONS.contains(&e.as_str()));
    if looks_like_a_path || file.exists() {
        return Ok(Some(path));
    }
    let names = catalogue::names().iter().copied();
    Err(Error::unknown("catalogue model or file", name_or_path, names))
}

/// The file of a path, and the name of the model in it that a path such as `world.sdf#arm` asks for;
/// a `#` may belong to the name of a file.
fn file_and_model(path: &Path) -> (Cow<'_, Path>, Option<&str>) {
    let parts = path.to_str().and_then(|text| text.rsplit_once('#'));
    match parts {
        Some((file, model)) if !path.exists() && Path::new(file).exists() => {
            (Path::new(file).into(), Some(model))
        }
        _ => (path.into(), None),
    }
}

/// Loads a model file, by its extension and content.
///
/// # Errors
/// As [`load`].
pub(crate) fn load_file(
    path: &Path,
    given: ParameterValues<'_>,
    close: CloseHome<'_>,
) -> Result<Mechanism> {
    read_file(path, given, Nesting::default(), close)
}

/// The text of a mechanism file, by name or path, and its path.
pub(crate) fn mechanism_text(name_or_path: &str) -> Result<(Cow<'static, str>, PathBuf)> {
    let path = found(Path::new(""), name_or_path)?;
    let Some(path) = path else {
        let text = catalogue::text(name_or_path).unwrap_or_default();
        return Ok((text.into(), catalogue::path(name_or_path)));
    };
    if !is_mechanism_file(&path) {
        return Err(Error::InvalidOption {
            option: "model",
            value: shown(&path),
            reason: "only mechanism files (.toml) have parameters".to_owned(),
        });
    }
    let text = text_file::read(&path)?.utf8("mechanism file", &path)?;
    Ok((text.into(), path))
}

fn is_mechanism_file(path: &Path) -> bool {
    extension(path).as_deref() == Some("toml")
}

fn read_file(
    path: &Path,
    given: ParameterValues<'_>,
    nesting: Nesting,
    close: CloseHome<'_>,
) -> Result<Mechanism> {
    let given_path = path;
    let (path, model) = file_and_model(given_path);
    let path = &*path;
    let file = text_file::read(path)?;
    if let Some(model) = model {
        return match xml_limits::root(&file.text) {
            Some("sdf" | "gazebo") => {
                if let Some((name, _)) = given.first() {
                    return Err(toml::none(name, &shown(path)));
                }
                let mechanism = sdf::parse_model(&file.text, path, Some(model))?;
                Ok(noted(mechanism, file.note()))
            }
            _ => Err(Error::InvalidOption {
                option: "model file",
                value: shown(given_path),
                reason: "#NAME names a model of an SDF file, and this file is none".to_owned(),
            }),
        };
    }
    if is_mechanism_file(path) {
        let loader = |from: &Path, name: &str, nesting, values: ParameterValues<'_>| {
            load_from(from, name, values, nesting, close)
        };
        let text = file.utf8("mechanism file", path)?;
        let nesting = (nesting, &loader as toml::Loader<'_>);
        return Ok(toml::describe(&text, path, "mechanism file", given, nesting, close)?.0);
    }
    if let Some((name, _)) = given.first() {
        return Err(toml::none(name, &shown(path)));
    }
    let note = file.note();
    let text = file.text;
    let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
    let mechanism = match extension(path).as_deref() {
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
    Ok(noted(mechanism, note))
}

/// With the note of how a text was read.
fn noted(mechanism: Mechanism, note: Option<(usize, &'static str, &'static str)>) -> Mechanism {
    match note {
        None => mechanism,
        Some((line, what, why)) => mechanism.noting(line, what, why),
    }
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
