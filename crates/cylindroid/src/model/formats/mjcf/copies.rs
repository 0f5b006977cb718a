//! Copies of elements of MJCF, and the names that refer to them.
//!
//! Checked  tests/formats/mjcf_copies.rs

use std::collections::BTreeMap;
use std::rc::Rc;

use roxmltree::Node;

use crate::spatial::Pose;

/// An element of a body, or one of its copies.
#[derive(Clone)]
pub(super) struct Placed<'d> {
    pub(super) node: Node<'d, 'd>,
    /// Its pose by enclosing `<frame>` and `<replicate>` elements.
    pub(super) place: Pose,
    /// The default class of the nearest element above it that has a `childclass`.
    pub(super) class: usize,
    /// The end of its name: empty if it is no copy.
    pub(super) suffix: Rc<str>,
}

impl Placed<'_> {
    /// The name, with the suffix of the copy.
    pub(super) fn name(&self) -> Option<String> {
        let name = self.node.attribute("name").map(str::trim).filter(|n| !n.is_empty())?;
        Some(format!("{name}{}", self.suffix))
    }
}

/// The kinds of names that constraints, actuators and tendons refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Body,
    Joint,
    Site,
}

/// The copies of a model.
#[derive(Default)]
pub(super) struct Copies {
    /// Suffixes of the copies of an element, by its name in the file.
    pub(super) suffixes: BTreeMap<(Kind, String), Rc<[Rc<str>]>>,
    /// The suffix of the copy of a constraint, actuator or tendon that is being read.
    pub(super) current: Rc<str>,
}

impl Copies {
    /// A name that the element that is being read refers to: of an element copied with it, or of
    /// the one in the file.
    pub(super) fn name(&self, kind: Kind, name: &str) -> String {
        let copies = self.suffixes.get(&(kind, name.to_owned()));
        let with_it = |s: &&Rc<str>| self.current.ends_with(&***s);
        let suffix = copies.and_then(|all| all.iter().find(with_it));
        format!("{name}{}", suffix.map_or("", |s| s))
    }

    /// The suffixes of the copies of an element that refers to these names; `None` if they are
    /// `strict` and some are not copied together with the others.
    pub(super) fn of(&self, names: &[(Kind, &str)], strict: bool) -> Option<Vec<Rc<str>>> {
        let copies = |(kind, name): &(Kind, &str)| self.suffixes.get(&(*kind, (*name).to_owned()));
        let all: Vec<_> = names.iter().map(copies).collect();
        let Some(most) = all.iter().flatten().max_by_key(|s| s.first().map_or(0, |s| s.len()))
        else {
            return Some(vec!["".into()]);
        };
        let together = all
            .iter()
            .zip(names)
            .all(|(s, n)| *n == (Kind::Body, "world") || s.is_some_and(|s| s == *most));
        (together || !strict).then(|| most.to_vec())
    }
}
