//! The links of a mechanism file and their poses at home, while the model is written.
//!
//! Checked  tests/formats/mechanism_file.rs::frames_*, tests/formats/closed_file.rs

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::names::GROUND;
use super::value::Table;
use crate::error::{Error, Result};
use crate::model::builder::Builder;
use crate::model::formats::span::{IgnoredLog, Source};
use crate::model::{CloseHome, Dimension, JointKind, JointSpec, Mechanism};
use crate::spatial::{Pose, Vec3};

/// The model while it is written.
pub(super) struct World<'t> {
    source: Source<'t>,
    pub(super) builder: Builder,
    pub(super) dimension: Dimension,
    /// The root first, then in the order in which they were placed.
    links: Vec<(String, Pose)>,
    index: BTreeMap<String, usize>,
    /// The places of names in the file, for errors of the builder.
    places: Vec<(String, Range<usize>)>,
    notes: IgnoredLog,
    /// Links of robots.
    brought: BTreeSet<String>,
}

impl<'t> World<'t> {
    pub(super) fn new(source: Source<'t>, name: &str, dimension: Dimension) -> Self {
        let mut builder = Mechanism::builder(name);
        builder.dimension(dimension);
        let (links, index, places) = (Vec::new(), BTreeMap::new(), Vec::new());
        let (notes, brought) = (IgnoredLog::default(), BTreeSet::new());
        Self { source, builder, dimension, links, index, places, notes, brought }
    }

    /// Places a link; it counts as connected to the root.
    pub(super) fn place(&mut self, link: &str, world_from_link: Pose) {
        if let Some(&i) = self.index.get(link) {
            self.links[i].1 = world_from_link;
        } else {
            self.index.insert(link.to_owned(), self.links.len());
            self.links.push((link.to_owned(), world_from_link));
        }
    }

    /// Places a link of a robot.
    pub(super) fn bring(&mut self, link: &str, world_from_link: Pose) {
        self.place(link, world_from_link);
        self.brought.insert(link.to_owned());
    }

    /// True for links of robots, which have frames of their own.
    pub(super) fn is_brought(&self, link: &str) -> bool {
        self.brought.contains(link)
    }

    /// The links that are placed, the root first.
    pub(super) fn placed(&self) -> Vec<String> {
        self.links.iter().map(|l| l.0.clone()).collect()
    }

    pub(super) fn has(&self, link: &str) -> bool {
        self.index.contains_key(link)
    }

    /// The pose of a link; the world origin for an unknown one.
    pub(super) fn pose(&self, link: &str) -> Pose {
        self.index.get(link).map_or(Pose::IDENTITY, |&i| self.links[i].1)
    }

    /// The joints of a serial arm, parents first, at q = 0.
    pub(super) fn arm(&mut self, joints: Vec<JointSpec>) {
        for joint in joints {
            let parent = self.pose(&joint.parent);
            if !self.has(&joint.parent) {
                self.place(&joint.parent, parent);
            }
            self.place(&joint.child, parent * joint.parent_from_joint);
            self.joint(joint);
        }
    }

    /// Writes a joint; position limits that its kind does not support are dropped with a note.
    pub(super) fn joint(&mut self, mut joint: JointSpec) {
        let l = &mut joint.limits;
        let bounded = l.lower > f64::NEG_INFINITY || l.upper < f64::INFINITY;
        if bounded && !joint.kind.takes_position_limits() {
            (l.lower, l.upper) = (f64::NEG_INFINITY, f64::INFINITY);
            let at = self.places.iter().find(|p| p.0 == joint.name).map_or(0, |p| p.1.start);
            let why = "dropped: its rates are not the derivative of q, nothing could keep them";
            let what = format!("position limits of {} joints", joint.kind.name());
            self.notes.add(at, what, why, &joint.name);
        }
        self.builder.joint(joint);
    }

    /// The free (or planar) joint of an unconnected link. It must be written after those of the
    /// file, so that their coordinates come first.
    pub(super) fn free(&mut self, link: &str, world_from_link: Pose) -> JointSpec {
        let root = self.links.first().map_or(GROUND, |l| l.0.as_str()).to_owned();
        let kind = match self.dimension {
            Dimension::Planar => JointKind::Planar,
            Dimension::Spatial => JointKind::Free,
        };
        let parent_from_joint = self.pose(&root).inverse() * world_from_link;
        self.place(link, world_from_link);
        let joint = JointSpec::new(link, kind, &root, link);
        JointSpec { parent_from_joint, axis: Vec3::Z, actuated: false, ..joint }
    }

    /// Rejects the value of a key that is not the name of a link.
    pub(super) fn check_link(&self, table: &Table<'_>, key: &str, link: &str) -> Result<()> {
        if self.has(link) {
            return Ok(());
        }
        let unknown = Error::unknown("link", link, self.index.keys());
        Err(table.refuse(key, unknown.to_string(), ""))
    }

    /// Returns an error for a reference that is no link, with the nearest links and frames.
    pub(super) fn check_reference(&self, table: &Table<'_>, name: &str) -> Result<()> {
        if self.has(name) {
            return Ok(());
        }
        let frames = self.builder.frames.iter().map(|(frame, ..)| frame);
        let unknown = Error::unknown("link or frame", name, self.index.keys().chain(frames));
        Err(table.refuse("reference", unknown.to_string(), ""))
    }

    /// Logs a part of the file, at a byte offset, that the model does not contain.
    pub(super) fn note(&mut self, at: usize, what: &str, why: &'static str, name: &str) {
        self.notes.add(at, what, why, name);
    }

    /// Records the place of a joint, contact, robot or frame in the file, for the builder's errors.
    pub(super) fn note_place(&mut self, name: &str, span: Range<usize>) {
        self.places.push((name.to_owned(), span));
    }

    /// The mechanism, home assembled by `close`; errors carry line and column.
    pub(super) fn build(mut self, close: CloseHome<'_>) -> Result<Mechanism> {
        std::mem::take(&mut self.notes).write(&[self.source], self.builder.report());
        let assembled = |m: Mechanism| if m.unassembled().is_empty() { Ok(m) } else { close(m) };
        self.builder.build().and_then(assembled).map_err(|error| {
            let Error::Model { culprit, message, .. } = error else { return error };
            let robot = culprit.split('/').next().unwrap_or("");
            let of = |name: &str| self.places.iter().rev().find(|p| p.0 == name);
            let span = of(&culprit).or_else(|| of(robot)).map_or(0..0, |p| p.1.clone());
            self.source.error(span, message, "")
        })
    }
}
