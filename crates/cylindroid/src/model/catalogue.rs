//! The catalogue: robots and mechanisms inside the library, each a mechanism file with its source.

use std::path::PathBuf;

use super::formats::toml;
use super::{Mechanism, ParameterValues};
use crate::error::{Error, Result};

/// A model of the catalogue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The name to load it by.
    pub name: &'static str,
    /// What it is, in one line.
    pub description: String,
    /// Where its numbers come from.
    pub source: String,
    /// Number of coordinates.
    pub dof: usize,
    /// Number of joints that close loops.
    pub loops: usize,
    /// Number of contacts.
    pub contacts: usize,
}

const NAMES: [&str; 14] = [
    "panda", "ur5e", "puma560", "iiwa14", "youbot", "3r", "four-bar", "five-bar", "3rrr", "3rps",
    "stewart", "delta", "watt", "two-arm",
];

const TEXTS: [&str; 14] = [
    include_str!("catalogue/panda.toml"),
    include_str!("catalogue/ur5e.toml"),
    include_str!("catalogue/puma560.toml"),
    include_str!("catalogue/iiwa14.toml"),
    include_str!("catalogue/youbot.toml"),
    include_str!("catalogue/3r.toml"),
    include_str!("catalogue/four-bar.toml"),
    include_str!("catalogue/five-bar.toml"),
    include_str!("catalogue/3rrr.toml"),
    include_str!("catalogue/3rps.toml"),
    include_str!("catalogue/stewart.toml"),
    include_str!("catalogue/delta.toml"),
    include_str!("catalogue/watt.toml"),
    include_str!("catalogue/two-arm.toml"),
];

/// The names of the models.
#[must_use]
pub const fn names() -> &'static [&'static str] {
    &NAMES
}

/// All models, with what they are and where their numbers come from.
///
/// ```
/// let entries = cylindroid::catalogue::entries();
/// let delta = entries.iter().find(|entry| entry.name == "delta").unwrap();
/// assert!(delta.loops > 0 && !delta.source.is_empty());
/// ```
#[must_use]
pub fn entries() -> Vec<Entry> {
    let read = |(name, text): (&&'static str, &&str)| {
        let (mechanism, description) = read(name, text, &[]).ok()?;
        Some(Entry {
            name,
            description,
            source: mechanism.report().source.clone(),
            dof: mechanism.n(),
            loops: mechanism.loops().len(),
            contacts: mechanism.contacts().len(),
        })
    };
    NAMES.iter().zip(&TEXTS).filter_map(read).collect()
}

/// A model by name.
///
/// ```
/// let stewart = cylindroid::catalogue::load("stewart")?;
/// assert!(stewart.is_closed());
/// // A misspelt name is answered with the nearest ones.
/// let error = cylindroid::catalogue::load("stuart").unwrap_err();
/// assert!(error.to_string().contains("stewart"));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::UnknownName`] with the nearest names.
pub fn load(name: &str) -> Result<Mechanism> {
    load_with(name, &[])
}

/// [`load`] with these values of parameters.
pub(super) fn load_with(name: &str, given: ParameterValues<'_>) -> Result<Mechanism> {
    match text(name) {
        Some(text) => Ok(read(name, text, given)?.0),
        None => Err(Error::unknown("catalogue model", name, NAMES)),
    }
}

/// The mechanism file of a model.
pub(crate) fn text(name: &str) -> Option<&'static str> {
    NAMES.iter().position(|n| *n == name).map(|i| TEXTS[i])
}

/// The path of a model in messages.
pub(crate) fn path(name: &str) -> PathBuf {
    PathBuf::from(format!("catalogue/{name}.toml"))
}

fn read(name: &str, text: &str, given: ParameterValues<'_>) -> Result<(Mechanism, String)> {
    toml::describe(
        text,
        &path(name),
        "catalogue",
        given,
        (toml::Nesting::default(), &|_, name, _, values| load_with(name, values)),
        &Ok,
    )
}
