//! Joints of SDF.
//!
//! Formula  axis in the joint frame: xyz, or joint_from_frame xyz with `expressed_in`, or xyz in
//!          the model's axes with `use_parent_model_frame` (the rule up to SDF 1.4);
//!          screw: pitch = screw_thread_pitch / 2 pi, or -1 / thread_pitch (rad/m, left-handed)
//! Valid    revolute, continuous, prismatic, screw, universal, revolute2, ball, fixed. A gearbox
//!          couples two joints and is listed in the report
//! Source   sdformat.org, specification of joint; sdformat pull request 1168 (thread pitches)
//! Checked  tests/formats/sdf.rs::joints_*

use roxmltree::Node;

use super::Sdf;
use super::frames::MODEL;
use super::joint_entry::JointEntry;
use crate::error::{Error, Result};
use crate::model::formats::xml::Reader;
use crate::model::{JointKind, Limits, Mimic};
use crate::spatial::Vec3;
use crate::tolerance::ZERO_AXIS;

const TYPES: [&str; 9] = [
    "revolute",
    "continuous",
    "prismatic",
    "screw",
    "universal",
    "revolute2",
    "ball",
    "fixed",
    "gearbox",
];

/// The value that stands for "unlimited" in SDF.
const UNLIMITED: f64 = 1e16;

impl<'d> Sdf<'d> {
    /// A joint of the model `scope`; `None` (and a note) for kinds that are not modelled.
    pub(super) fn joint(
        &mut self,
        node: Node<'d, 'd>,
        scope: &str,
    ) -> Result<Option<JointEntry<'d>>> {
        let reader = &mut self.reader;
        let own = reader.required(node, "name")?;
        let name = super::scoped(scope, own);
        let known =
            ["pose", "parent", "child", "axis", "axis2", "thread_pitch", "screw_thread_pitch"];
        let word = reader.required(node, "type")?.trim();
        if word == "gearbox" {
            let why =
                "it couples two joints by a ratio, which is not modelled; they move apart here";
            reader.note(node, "<joint> of type gearbox", why, own);
            return Ok(None);
        }
        reader.leftovers(node, &["name", "type"], &known);
        let between = [self.end(node, scope, "parent")?, self.end(node, scope, "child")?];
        if between[0] == between[1] {
            let message = format!("joint '{name}' connects link '{}' with itself", between[0]);
            return Err(self.reader.refuse(node, "name", message));
        }
        let model_from_joint = self.frames.pose(&self.reader, &name)?;
        let rotation = model_from_joint.rotation;
        let axis = |it: &mut Self, which: &str| -> Result<Option<Vec3>> {
            let Some(element) = it.reader.child(node, which) else { return Ok(None) };
            it.axis(element, scope, &name).map(|v| Some(rotation.inverse() * v))
        };
        let first = axis(self, "axis")?;
        let second = axis(self, "axis2")?;
        let kind = match word {
            "revolute" => JointKind::Revolute,
            "continuous" => JointKind::Continuous,
            "prismatic" => JointKind::Prismatic,
            "fixed" => JointKind::Fixed,
            "ball" => JointKind::Spherical,
            "universal" | "revolute2" => JointKind::Universal { second: second.unwrap_or(Vec3::Z) },
            "screw" => JointKind::Helical { pitch: self.pitch(node, &name)? },
            other => {
                let unknown = Error::unknown("joint type", other, TYPES);
                return Err(self.reader.refuse(node, "type", unknown.to_string()));
            }
        };
        if !matches!(kind, JointKind::Universal { .. }) && second.is_some() {
            let why = "only universal joints have a second axis";
            self.reader.note(node, "<axis2>", why, own);
        }
        if let Some(axis) = self.reader.child(node, "axis") {
            let why = match kind {
                JointKind::Fixed => Some("a fixed joint does not move"),
                JointKind::Spherical => Some("a ball joint turns about every axis"),
                _ => None,
            };
            if let Some(why) = why {
                self.reader.note(axis, "<axis>", why, own);
            }
        }
        let (limits, mimic) = self.axis_settings(node, kind, scope, own)?;
        let axis = first.unwrap_or(Vec3::Z);
        Ok(Some(JointEntry { node, name, kind, between, model_from_joint, axis, limits, mimic }))
    }

    /// The link at one end: the named link, or the link to which the named frame is attached.
    fn end(&mut self, joint: Node<'d, 'd>, scope: &str, which: &'static str) -> Result<String> {
        let name = joint.attribute("name").unwrap_or("").to_owned();
        let Some(node) = self.reader.child(joint, which) else {
            let message = format!("joint '{name}' has no <{which}>");
            let help = format!("add <{which}>LINK</{which}>");
            return Err(self.reader.error(joint, Reader::tag(joint), message, help));
        };
        self.reader.value_of(node);
        let text = self.reader.text_of(node).trim();
        if text == "world" {
            return Ok(text.to_owned());
        }
        let full = super::scoped(scope, text);
        if self.frames.get(&full).is_none() {
            let unknown = self.frames.unknown(&full).to_string();
            return Err(self.reader.refuse_text(node, unknown));
        }
        self.frames.link(&self.reader, &full)
    }

    /// An axis in the axes of the outermost model.
    fn axis(&mut self, element: Node<'d, 'd>, scope: &str, joint: &str) -> Result<Vec3> {
        let known = ["xyz", "use_parent_model_frame", "limit", "dynamics", "mimic"];
        self.reader.leftovers(element, &[], &known);
        if let Some(dynamics) = self.reader.child(element, "dynamics") {
            let why = "friction and damping do not enter the kinematics";
            let owner = self.reader.owner(element).to_owned();
            self.reader.note(dynamics, "<dynamics>", why, &owner);
        }
        let Some(node) = self.reader.child(element, "xyz") else {
            return Ok(self.frames.pose(&self.reader, joint)?.rotation * Vec3::Z);
        };
        self.reader.leftovers(node, &["expressed_in"], &[]);
        let xyz = Vec3::from_array(self.reader.finite::<3>(node)?);
        if xyz.unit(ZERO_AXIS).is_none() {
            let message = format!("the axis of joint '{joint}' has no direction");
            return Err(self.reader.refuse_text(node, message));
        }
        let in_model = match self.reader.child_text(element, "use_parent_model_frame") {
            Some(text) => super::is_true(text),
            None => super::version(&self.reader, element)? < 1.5,
        };
        let frame = match node.attribute("expressed_in").map(str::trim) {
            Some(name) if !name.is_empty() => super::scoped(scope, name),
            _ if in_model => super::scoped(scope, MODEL),
            _ => joint.to_owned(),
        };
        if frame != MODEL && self.frames.get(&frame).is_none() {
            let unknown = self.frames.unknown(&frame).to_string();
            return Err(self.reader.refuse(node, "expressed_in", unknown));
        }
        Ok(self.frames.pose(&self.reader, &frame)?.rotation * xyz)
    }

    /// The advance of a screw [m/rad].
    fn pitch(&mut self, node: Node<'d, 'd>, name: &str) -> Result<f64> {
        let turn = 2.0 * std::f64::consts::PI;
        if let Some(advance) = self.reader.child_number(node, "screw_thread_pitch")? {
            return Ok(advance / turn);
        }
        match self.reader.child_number(node, "thread_pitch")? {
            Some(slope) if slope != 0.0 => Ok(-1.0 / slope),
            Some(_) => {
                let message = format!("the thread_pitch of screw joint '{name}' is 0 rad/m");
                Err(self.reader.refuse(node, "name", message))
            }
            None => {
                let why = "1 m a turn is taken, the default of the format";
                self.reader.note(node, "screw joint without a thread pitch", why, name);
                Ok(1.0 / turn)
            }
        }
    }

    /// Limits, and the joint that a mimic joint follows.
    fn axis_settings(
        &mut self,
        joint: Node<'d, 'd>,
        kind: JointKind,
        scope: &str,
        name: &str,
    ) -> Result<(Limits, Option<Mimic>)> {
        let reader = &mut self.reader;
        let mut limits = Limits::NONE;
        let Some(axis) = reader.child(joint, "axis") else { return Ok((limits, None)) };
        let mut mimic = None;
        if let Some(node) = reader.child(axis, "mimic") {
            reader.leftovers(node, &["joint"], &["multiplier", "offset", "reference"]);
            let leader = super::scoped(scope, reader.required(node, "joint")?.trim());
            let multiplier = reader.child_number(node, "multiplier")?.unwrap_or(1.0);
            let offset = reader.child_number(node, "offset")?.unwrap_or(0.0);
            let reference = reader.child_number(node, "reference")?.unwrap_or(0.0);
            if kind.dof() == 1 {
                let offset = offset - multiplier * reference;
                mimic = Some(Mimic { joint: leader, multiplier, offset });
            } else {
                reader.note(node, "<mimic>", "only joints of one coordinate can follow", name);
            }
        }
        let Some(node) = reader.child(axis, "limit") else { return Ok((limits, mimic)) };
        reader.leftovers(node, &[], &["lower", "upper", "effort", "velocity"]);
        if kind.dof() != 1 {
            reader.note(node, "<limit>", "used only for joints of one coordinate", name);
            return Ok((limits, mimic));
        }
        let bound = |reader: &mut Reader<'_>, which: &str| -> Result<Option<f64>> {
            let Some(child) = reader.child(node, which) else { return Ok(None) };
            reader.value_of(child);
            reader.content::<1>(child).map(|[x]| Some(x).filter(|x| x.abs() < UNLIMITED))
        };
        if kind != JointKind::Continuous {
            limits.lower = bound(reader, "lower")?.unwrap_or(f64::NEG_INFINITY);
            limits.upper = bound(reader, "upper")?.unwrap_or(f64::INFINITY);
        }
        if limits.lower > limits.upper {
            let (lower, upper) = (limits.lower, limits.upper);
            let message =
                format!("joint '{name}' has lower limit {lower} above its upper limit {upper}");
            return Err(reader.error(node, Reader::tag(node), message, "exchange them"));
        }
        for (which, slot) in [("effort", &mut limits.effort), ("velocity", &mut limits.velocity)] {
            match bound(reader, which)? {
                Some(x) if x > 0.0 => *slot = x,
                Some(0.0) => {
                    reader.note(node, format!("{which} limit 0"), "read as unlimited", name);
                }
                _ => {}
            }
        }
        Ok((limits, mimic))
    }
}
