//! Unique names: MJCF has a namespace for each kind of element, a mechanism one for all frames.

use std::collections::{BTreeMap, BTreeSet};

/// The names that elements of one kind have.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: BTreeSet<String>,
    /// The last number that followed a name.
    last: BTreeMap<String, usize>,
}

impl Names {
    /// Takes a name; false if it was taken already.
    pub(super) fn insert(&mut self, name: &str) -> bool {
        self.taken.insert(name.to_owned())
    }

    pub(super) fn contains(&self, name: &str) -> bool {
        self.taken.contains(name)
    }

    /// Takes this name, or the first free one of those with a number from 2 after it.
    pub(super) fn unique(&mut self, preferred: &str) -> String {
        if self.insert(preferred) {
            return preferred.to_owned();
        }
        let last = self.last.entry(preferred.to_owned()).or_insert(1);
        loop {
            *last += 1;
            let name = format!("{preferred}.{last}");
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}
