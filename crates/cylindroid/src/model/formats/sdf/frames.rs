//! Frames of SDF: the frame that each pose is relative to, and the link that each frame is
//! attached to.
//!
//! Formula  model_from_x = model_from_(relative_to of x) pose of x, along the chain of relative_to
//! Valid    `relative_to` of SDF 1.7 on and `frame` of 1.5 and 1.6; defaults: the model for a link,
//!          the child for a joint, the `attached_to` frame for a frame. Cycles are rejected
//! Source   sdformat.org, pose frame semantics
//! Checked  tests/formats/sdf.rs::poses_*

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
        let mut pose = Pose::IDENTITY;
        let mut at = name;
        for _ in 0..=self.all.len() {
            if at == MODEL {
                return Ok(pose);
            }
            let Some(placed) = self.all.get(at) else {
                let unknown = self.unknown(at).to_string();
                return Err(self.blame(reader, name, unknown));
            };
            pose = placed.pose * pose;
            at = &placed.relative_to;
        }
        Err(self.blame(reader, name, format!("'{name}' is placed relative to itself in a ring")))
    }

    /// The link to which a frame is attached.
    pub(super) fn link(&self, reader: &Reader<'_>, name: &str) -> Result<String> {
        let mut at = name;
        for _ in 0..=self.all.len() {
            let Some(placed) = self.all.get(at) else {
                let unknown = self.unknown(at).to_string();
                return Err(self.blame(reader, name, unknown));
            };
            if placed.attached_to == *at {
                return Ok(at.to_owned());
            }
            at = &placed.attached_to;
        }
        Err(self.blame(reader, name, format!("'{name}' is attached to itself in a ring")))
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
