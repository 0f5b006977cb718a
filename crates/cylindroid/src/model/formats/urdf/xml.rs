//! Reads elements and attributes of a URDF: every number checked, every error at its place, every
//! thing that is not used noted.

use std::ops::Range;

use roxmltree::Node;

use super::XACRO_HELP;
use crate::error::{Error, Result};
use crate::model::formats::place::{Notes, Source};
use crate::spatial::{Pose, Quaternion, Rotation, Rpy, Vec3};

/// What all parts of the URDF reader share.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    pub(super) source: Source<'a>,
    pub(super) notes: Notes,
    /// The namespace of the root: elements of another one are extensions.
    pub(super) namespace: Option<&'a str>,
}

impl Reader<'_> {
    /// True for an element of this name in the namespace of the root.
    pub(super) fn is(&self, node: Node<'_, '_>, name: &str) -> bool {
        node.is_element()
            && node.tag_name().name() == name
            && node.tag_name().namespace() == self.namespace
    }

    /// The byte range of `<name`, prefix included.
    pub(super) fn tag(node: Node<'_, '_>) -> Range<usize> {
        let start = node.range().start;
        let text = node.document().input_text().get(start..).unwrap_or("");
        let length = text.find(|c: char| c.is_whitespace() || c == '/' || c == '>');
        start..start + length.unwrap_or(text.len())
    }

    /// The byte range of an attribute's value; of the tag where there is no such attribute.
    pub(super) fn value(node: Node<'_, '_>, attribute: &str) -> Range<usize> {
        node.attribute_node(attribute).map_or_else(|| Self::tag(node), |a| a.range_value())
    }

    pub(super) fn required<'d>(&self, node: Node<'d, '_>, attribute: &str) -> Result<&'d str> {
        node.attribute(attribute).filter(|v| !v.trim().is_empty()).ok_or_else(|| {
            let tag = node.tag_name().name();
            self.source.error(
                Self::value(node, attribute),
                format!("<{tag}> has no {attribute}"),
                format!("write <{tag} {attribute}=\"...\">"),
            )
        })
    }

    /// The numbers of an attribute; infinite ones pass, NaN does not.
    fn numbers<const N: usize>(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
    ) -> Result<Option<[f64; N]>> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        let tag = node.tag_name().name();
        let refuse = |message: String| {
            let help = if text.contains("${") || text.contains("$(") {
                XACRO_HELP.to_owned()
            } else {
                format!("{attribute} takes {N} number{}", if N == 1 { "" } else { "s" })
            };
            Err(self.source.error(Self::value(node, attribute), message, help))
        };
        let mut values = [0.0; N];
        let mut count = 0;
        for word in text.split_whitespace() {
            let value: f64 = match word.parse() {
                Ok(value) if !f64::is_nan(value) => value,
                _ => return refuse(format!("{attribute} of <{tag}>: '{word}' is not a number")),
            };
            if let Some(slot) = values.get_mut(count) {
                *slot = value;
            }
            count += 1;
        }
        if count != N {
            return refuse(format!("{attribute} of <{tag}> has {count} numbers, expected {N}"));
        }
        Ok(Some(values))
    }

    /// A vector of finite numbers.
    pub(super) fn vector<const N: usize>(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
    ) -> Result<Option<[f64; N]>> {
        let values = self.numbers::<N>(node, attribute)?;
        if values.is_some_and(|v| v.iter().any(|x| !x.is_finite())) {
            return Err(self.source.error(
                Self::value(node, attribute),
                format!("{attribute} of <{}> is not finite", node.tag_name().name()),
                "give finite numbers",
            ));
        }
        Ok(values)
    }

    /// A finite number.
    pub(super) fn number(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<f64>> {
        Ok(self.vector::<1>(node, attribute)?.map(|[x]| x))
    }

    /// A limit: a number that may be infinite.
    pub(super) fn bound(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<f64>> {
        Ok(self.numbers::<1>(node, attribute)?.map(|[x]| x))
    }

    /// The first child element of this name; further ones are noted.
    pub(super) fn child<'d, 'i>(&mut self, node: Node<'d, 'i>, name: &str) -> Option<Node<'d, 'i>> {
        let mut all = node.children().filter(|c| self.is(*c, name));
        let first = all.next()?;
        if let Some(second) = all.next() {
            let what = format!("second <{name}> in <{}>", node.tag_name().name());
            let owner = node.attribute("name").unwrap_or("");
            self.notes.add(second.range().start, what, "the first one counts", owner);
        }
        Some(first)
    }

    /// The pose of the `<origin>` of an element; the identity without one.
    pub(super) fn origin(&mut self, node: Node<'_, '_>) -> Result<Pose> {
        let Some(origin) = self.child(node, "origin") else { return Ok(Pose::IDENTITY) };
        self.leftovers(origin, &["xyz", "rpy", "quat_xyzw"], &[]);
        let translation = self.vector::<3>(origin, "xyz")?.map_or(Vec3::ZERO, Vec3::from_array);
        let rpy = self.vector::<3>(origin, "rpy")?;
        let quaternion = self.vector::<4>(origin, "quat_xyzw")?;
        let rotation = match (rpy, quaternion) {
            (None, None) => Rotation::IDENTITY,
            (Some([roll, pitch, yaw]), None) => Rpy { roll, pitch, yaw }.rotation(),
            (None, Some([x, y, z, w])) => Quaternion { w, x, y, z }
                .rotation()
                .map_err(|e| self.refuse(origin, "quat_xyzw", e.to_string()))?,
            (Some(_), Some(_)) => {
                let message = "<origin> has both rpy and quat_xyzw";
                return Err(self.refuse(origin, "quat_xyzw", message));
            }
        };
        Ok(Pose { rotation, translation })
    }

    /// An error at the value of an attribute, where the message says it all.
    pub(super) fn refuse(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
        message: impl Into<String>,
    ) -> Error {
        self.source.error(Self::value(node, attribute), message, "")
    }

    /// Notes attributes and children that are not among those read.
    pub(super) fn leftovers(&mut self, node: Node<'_, '_>, attributes: &[&str], children: &[&str]) {
        let tag = node.tag_name().name();
        let owner = owner(node);
        for attribute in node.attributes() {
            if attribute.namespace().is_some() || !attributes.contains(&attribute.name()) {
                let what = format!("attribute '{}' of <{tag}>", attribute.name());
                self.notes.add(attribute.range().start, what, "not known to this reader", owner);
            }
        }
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            let known = child.tag_name().namespace() == self.namespace && children.contains(&name);
            if !known {
                let owner = if tag == "robot" { "" } else { owner };
                self.notes.add(child.range().start, format!("<{name}>"), why_unused(name), owner);
            }
        }
    }
}

/// The name of the link or joint that an element stands in.
pub(super) fn owner<'d>(node: Node<'d, '_>) -> &'d str {
    node.ancestors()
        .find(|n| ["link", "joint"].contains(&n.tag_name().name()))
        .and_then(|n| n.attribute("name"))
        .unwrap_or("")
}

fn why_unused(element: &str) -> &'static str {
    match element {
        "dynamics" => "friction and damping do not enter the kinematics",
        "safety_controller" => "soft limits are not used; those of <limit> hold",
        "calibration" => "encoder references do not enter the kinematics",
        "texture" => "textures are not drawn; the colour is",
        "gazebo" | "transmission" | "sensor" | "ros2_control" | "plugin" => {
            "settings of simulators and controllers are not used"
        }
        _ => "not known to this reader",
    }
}
