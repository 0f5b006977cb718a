//! Frames of SDF: the frame that each pose is relative to, and the link that each frame is
//! attached to.
//!
//! Formula  model_from_x = model_from_(relative_to of x) pose of x, along the chain of relative_to
//! Valid    `relative_to` of SDF 1.7 on and `frame` of 1.5 and 1.6; defaults: the model for a link,
//!          the child for a joint, the `attached_to` frame for a frame. Cycles are rejected
//! Source   sdformat.org, pose frame semantics
//! Checked  tests/formats/sdf.rs::poses_*

use std::cell::RefCell;
use std::collections::BTreeMap;

use roxmltree::Node;

use crate::error::{Error, Result};
use crate::model::formats::xml::Reader;
use crate::spatial::Pose;

/// The frame of a model.
pub(super) const MODEL: &str = "__model__";

/// A link, joint, frame or model.
#[derive(Debug, Clone)]
pub(super) struct PosedFrame<'d> {
    /// Its place in the file.
    pub(super) node: Node<'d, 'd>,
    /// The frame that its pose is relative to.
    pub(super) relative_to: String,
    pub(super) pose: Pose,
    /// The frame that it is attached to: itself for a link.
    pub(super) attached_to: String,
}

/// All frames by their full name (`model::frame` in nested models).
#[derive(Debug, Default)]
pub(super) struct Frames<'d> {
    all: BTreeMap<String, PosedFrame<'d>>,
    /// Poses in the outermost model, of the frames asked for and those that they are relative to.
    poses: RefCell<BTreeMap<String, Pose>>,
    /// Links to which frames are attached.
    links: RefCell<BTreeMap<String, String>>,
}

impl<'d> Frames<'d> {
    pub(super) fn insert(
        &mut self,
        reader: &Reader<'_>,
        name: String,
        placed: PosedFrame<'d>,
    ) -> Result<()> {
        let node = placed.node;
        if self.all.contains_key(&name) {
            let message = format!("two links, joints or frames are named '{name}'");
            return Err(reader.refuse(node, "name", message));
        }
        self.all.insert(name, placed);
        Ok(())
    }

    pub(super) fn get(&self, name: &str) -> Option<&PosedFrame<'d>> {
        self.all.get(name)
    }

    fn known(&self) -> impl Iterator<Item = &String> {
        self.all.keys().filter(|k| !k.ends_with(MODEL))
    }

    /// An error about an unknown name.
    pub(super) fn unknown(&self, name: &str) -> Error {
        Error::unknown("link, joint or frame", name, self.known())
    }

    /// The pose of a frame in the outermost model.
    pub(super) fn pose(&self, reader: &Reader<'_>, name: &str) -> Result<Pose> {
        let mut known = self.poses.borrow_mut();
        let mut chain = Vec::new();
        let mut at = name;
        let mut pose = loop {
            if at == MODEL {
                break Pose::IDENTITY;
            }
            if let Some(pose) = known.get(at) {
                break *pose;
            }
            let Some(placed) = self.all.get(at) else {
                let unknown = self.unknown(at).to_string();
                return Err(self.blame(reader, name, unknown));
            };
            if chain.len() > self.all.len() {
                let message = format!("'{name}' is placed relative to itself in a ring");
                return Err(self.blame(reader, name, message));
            }
            chain.push((at, placed.pose));
            at = &placed.relative_to;
        };
        for (at, own) in chain.into_iter().rev() {
            pose = pose * own;
            known.insert(at.to_owned(), pose);
        }
        Ok(pose)
    }

    /// The link to which a frame is attached.
    pub(super) fn link(&self, reader: &Reader<'_>, name: &str) -> Result<String> {
        let mut known = self.links.borrow_mut();
        let mut chain = Vec::new();
        let mut at = name;
        let link = loop {
            if let Some(link) = known.get(at) {
                break link.clone();
            }
            let Some(placed) = self.all.get(at) else {
                let unknown = self.unknown(at).to_string();
                return Err(self.blame(reader, name, unknown));
            };
            if placed.attached_to == *at {
                break at.to_owned();
            }
            if chain.len() > self.all.len() {
                let message = format!("'{name}' is attached to itself in a ring");
                return Err(self.blame(reader, name, message));
            }
            chain.push(at);
            at = &placed.attached_to;
        };
        known.extend(chain.into_iter().map(|at| (at.to_owned(), link.clone())));
        Ok(link)
    }

    fn blame(&self, reader: &Reader<'_>, name: &str, message: String) -> Error {
        match self.all.get(name) {
            Some(placed) => {
                let pose = placed.node.children().find(|c| c.has_tag_name("pose"));
                let at = pose.filter(|p| p.has_attribute("relative_to"));
                match at {
                    Some(pose) => reader.refuse(pose, "relative_to", message),
                    None => reader.refuse(placed.node, "name", message),
                }
            }
            None => reader.source.error(0..0, message, ""),
        }
    }
}
