//! Values of SDF elements, written as text: numbers, vectors, poses, truth values.
//!
//! Checked  tests/formats/sdf.rs::what_is_broken_*

use std::ops::Range;

use roxmltree::Node;

use super::{degrees, is_true};
use crate::error::{Error, Result};
use crate::model::formats::xml::{Reader, numbers_in};
use crate::model::magnitude;
use crate::spatial::{Pose, Quaternion, Rpy, Vec3};

impl Reader<'_> {
    /// The place of the text of an element, without blanks around it; its tag where it has none.
    pub(super) fn text_place(node: Node<'_, '_>) -> Range<usize> {
        let Some(child) = node.first_child().filter(Node::is_text) else { return Self::tag(node) };
        let range = child.range();
        let Some(text) = node.document().input_text().get(range.clone()) else { return range };
        let start = range.start + text.len() - text.trim_start().len();
        start..(start + text.trim().len()).max(start)
    }

    /// An error at the text of an element.
    pub(super) fn refuse_text(&self, node: Node<'_, '_>, message: impl Into<String>) -> Error {
        self.error(node, Self::text_place(node), message, "")
    }

    /// Marks an element that holds a value as text and nothing else.
    pub(super) fn value_of(&mut self, node: Node<'_, '_>) {
        self.leftovers(node, &[], &[]);
    }

    /// The text of an element, which counts as read.
    pub(super) fn text_of<'d>(&self, node: Node<'d, '_>) -> &'d str {
        if let Some(text) = node.first_child().filter(Node::is_text) {
            self.mark(text);
        }
        node.text().unwrap_or("")
    }

    /// The text of the first child element of this name.
    pub(super) fn child_text<'d>(&mut self, node: Node<'d, '_>, name: &str) -> Option<&'d str> {
        let child = self.child(node, name)?;
        self.value_of(child);
        Some(self.text_of(child).trim())
    }

    /// The truth value of a child element; false if it is missing.
    pub(super) fn child_flag(&mut self, node: Node<'_, '_>, name: &str) -> bool {
        self.child_text(node, name).is_some_and(is_true)
    }

    /// The numbers of an element; infinite ones are accepted.
    pub(super) fn content<const N: usize>(&self, node: Node<'_, '_>) -> Result<[f64; N]> {
        let tag = node.tag_name().name();
        let values = numbers_in(self.text_of(node))
            .map_err(|word| self.refuse_text(node, format!("<{tag}>: '{word}' is not a number")))?;
        let count = values.len();
        <[f64; N]>::try_from(values).map_err(|_| {
            self.refuse_text(node, format!("<{tag}> has {count} numbers, expected {N}"))
        })
    }

    /// The finite numbers of an element.
    pub(super) fn finite<const N: usize>(&self, node: Node<'_, '_>) -> Result<[f64; N]> {
        let values = self.content::<N>(node)?;
        let Some(fault) = magnitude::fault(&values) else { return Ok(values) };
        Err(self.refuse_text(node, format!("<{}> {fault}", node.tag_name().name())))
    }

    /// The finite number in the first child element of this name.
    pub(super) fn child_number(&mut self, node: Node<'_, '_>, name: &str) -> Result<Option<f64>> {
        let Some(child) = self.child(node, name) else { return Ok(None) };
        self.value_of(child);
        self.finite::<1>(child).map(|[x]| Some(x))
    }

    /// The vector in the first child element of this name.
    pub(super) fn child_vector(&mut self, node: Node<'_, '_>, name: &str) -> Result<Option<Vec3>> {
        let Some(child) = self.child(node, name) else { return Ok(None) };
        self.value_of(child);
        self.finite::<3>(child).map(|v| Some(Vec3::from_array(v)))
    }

    /// The pose of an element of the kind `<pose>`; the identity if it is empty.
    pub(super) fn pose_in(&self, node: Node<'_, '_>) -> Result<Pose> {
        if self.text_of(node).trim().is_empty() {
            return Ok(Pose::IDENTITY);
        }
        match node.attribute("rotation_format").map(str::trim) {
            Some("quat_xyzw") => {
                let [x, y, z, i, j, k, w] = self.finite::<7>(node)?;
                let rotation = Quaternion { w, x: i, y: j, z: k }
                    .rotation()
                    .map_err(|e| self.refuse_text(node, e.to_string()))?;
                Ok(Pose { rotation, translation: Vec3::new(x, y, z) })
            }
            None | Some("euler_rpy") => {
                let [x, y, z, roll, pitch, yaw] = self.finite::<6>(node)?;
                let unit =
                    if node.attribute("degrees").is_some_and(is_true) { degrees() } else { 1.0 };
                let rpy = Rpy { roll: roll * unit, pitch: pitch * unit, yaw: yaw * unit };
                Ok(Pose { rotation: rpy.rotation(), translation: Vec3::new(x, y, z) })
            }
            Some(other) => {
                let known = ["euler_rpy", "quat_xyzw"];
                let unknown = Error::unknown("rotation format", other, known);
                Err(self.refuse(node, "rotation_format", unknown.to_string()))
            }
        }
    }
}
