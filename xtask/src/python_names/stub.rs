//! The names of the stub: functions, classes and their members.

use std::collections::{BTreeMap, BTreeSet};

use super::library::Function;

/// What the package has.
#[derive(Debug, Default)]
pub(super) struct Names {
    functions: BTreeSet<String>,
    /// Members by class.
    classes: BTreeMap<String, BTreeSet<String>>,
}

impl Names {
    /// Reads the lines `class Name:`, `def name(` and, indented, the `def name(` of members.
    pub(super) fn parse(text: &str) -> Self {
        let mut names = Self::default();
        let mut class = String::new();
        for line in text.lines() {
            let name = |rest: &str| {
                let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
                rest[..end.unwrap_or(rest.len())].to_owned()
            };
            if let Some(rest) = line.strip_prefix("class ") {
                class = name(rest);
                names.classes.entry(class.clone()).or_default();
            } else if let Some(rest) = line.strip_prefix("def ") {
                names.functions.insert(name(rest));
            } else if let Some(rest) = line.strip_prefix("    def ") {
                names.classes.entry(class.clone()).or_default().insert(name(rest));
            }
        }
        names
    }

    /// Whether a function of the library has its own name here.
    pub(super) fn has_namesake(&self, function: &Function) -> bool {
        match &function.of {
            None => {
                self.functions.contains(&function.name)
                    || self.classes.values().any(|members| members.contains(&function.name))
            }
            Some(class) => match self.classes.get(class) {
                Some(members) => {
                    let constructs = ["new", "of"].contains(&function.name.as_str());
                    members.contains(&function.name) || constructs && members.contains("__new__")
                }
                None => self.functions.contains(&function.name),
            },
        }
    }

    /// Whether `Class.member`, `Class` or `function` exists.
    pub(super) fn contains(&self, name: &str) -> bool {
        match name.split_once('.') {
            Some((class, member)) => self.classes.get(class).is_some_and(|m| m.contains(member)),
            None => self.functions.contains(name) || self.classes.contains_key(name),
        }
    }
}
