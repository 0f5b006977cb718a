//! The catalogue: robots inside the library, each a mechanism file with its source.

use std::path::Path;

use super::Mechanism;
use super::formats::toml;
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
}

const NAMES: [&str; 6] = ["panda", "ur5e", "puma560", "iiwa14", "youbot", "3r"];

const TEXTS: [&str; 6] = [
    include_str!("catalogue/panda.toml"),
    include_str!("catalogue/ur5e.toml"),
    include_str!("catalogue/puma560.toml"),
    include_str!("catalogue/iiwa14.toml"),
    include_str!("catalogue/youbot.toml"),
    include_str!("catalogue/3r.toml"),
];

/// The names of the models.
#[must_use]
pub const fn names() -> &'static [&'static str] {
    &NAMES
}

/// All models, with what they are and where their numbers come from.
#[must_use]
pub fn entries() -> Vec<Entry> {
    let read = |(name, text): (&&'static str, &&str)| {
        let (mechanism, description) = read(name, text).ok()?;
        let (source, dof) = (mechanism.report().source.clone(), mechanism.n());
        Some(Entry { name, description, source, dof })
    };
    NAMES.iter().zip(&TEXTS).filter_map(read).collect()
}

/// A model by name.
///
/// # Errors
/// [`Error::UnknownName`] with the nearest names.
pub fn load(name: &str) -> Result<Mechanism> {
    match NAMES.iter().position(|n| *n == name) {
        Some(i) => Ok(read(name, TEXTS[i])?.0),
        None => Err(Error::unknown("catalogue model", name, NAMES)),
    }
}

fn read(name: &str, text: &str) -> Result<(Mechanism, String)> {
    toml::describe(text, Path::new(&format!("catalogue/{name}.toml")), "catalogue", 0)
}
