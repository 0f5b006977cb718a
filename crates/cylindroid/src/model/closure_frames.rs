//! Closures by frames: loops that may be open where a file places the links, and are closed by an
//! assembly of home.
//!
//! Why so   the assembly needs kinematics, which comes after the model: the model only remembers
//!          which loops are to be closed
//! Checked  tests/formats/closures.rs

use std::sync::Arc;

use super::builder::Builder;
use super::mechanism::{Data, Mechanism};
use crate::error::Result;
use crate::spatial::Pose;

/// Closes the loops that a file closes by frames: the mechanism with an assembled home.
pub(crate) type CloseHome<'a> = &'a dyn Fn(Mechanism) -> Result<Mechanism>;

impl Builder {
    /// The link of a frame and its pose there: of a link, a named frame, a joint (on the link that
    /// it moves; on the second link if it closes a loop).
    pub(super) fn placed_frame(&self, name: &str) -> Option<(String, Pose)> {
        let links = self.joints.iter().flat_map(|j| [&j.parent, &j.child]);
        let mut links = self.links.iter().map(|l| &l.name).chain(links);
        let joint = |name: &str| {
            let tree = self.joints.iter().find(|j| j.name == name);
            let loops = || self.loops.iter().find(|l| l.name == name);
            tree.map(|j| (j.child.clone(), j.joint_from_child.inverse()))
                .or_else(|| loops().map(|l| (l.b.clone(), l.link_b_from_joint)))
        };
        let frame = || self.frames.iter().find(|f| f.0 == name).map(|f| (f.1.clone(), f.2));
        if links.any(|link| link == name) {
            return Some((name.to_owned(), Pose::IDENTITY));
        }
        frame().or_else(|| joint(name))
    }

    /// The names of these frames.
    pub(super) fn placed_frame_names(&self) -> Vec<String> {
        let links = self.joints.iter().flat_map(|j| [&j.parent, &j.child]);
        let links = self.links.iter().map(|l| &l.name).chain(links);
        let joints = self.joints.iter().map(|j| &j.name).chain(self.loops.iter().map(|l| &l.name));
        let mut names: Vec<String> =
            links.chain(self.frames.iter().map(|f| &f.0)).chain(joints).cloned().collect();
        names.sort();
        names.dedup();
        names
    }
}

impl Mechanism {
    /// The same mechanism with one more entry in its report.
    pub(super) fn noting(mut self, line: usize, what: &str, why: &str) -> Self {
        Arc::make_mut(&mut self.data).report.ignore(line, what, why);
        self
    }

    /// The same mechanism with a home configuration in which all loops are closed.
    pub(crate) fn with_assembled_home(&self, home: Vec<f64>) -> Self {
        let unassembled = Vec::new();
        Self { data: Arc::new(Data { home, unassembled, ..Data::clone(&self.data) }) }.measured()
    }
}
