//! Unique names: MJCF has a namespace for each kind of element, a mechanism one for all frames.

use std::collections::BTreeSet;

/// A name that is unique among elements of its kind.
pub(super) fn unique(taken: &mut BTreeSet<String>, preferred: &str) -> String {
    let mut name = preferred.to_owned();
    let mut count = 1;
    while !taken.insert(name.clone()) {
        count += 1;
        name = format!("{preferred}.{count}");
    }
    name
}
