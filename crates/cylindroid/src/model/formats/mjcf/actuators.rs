//! Actuators and key frames of MJCF: actuated joints, their effort limits, and home.
//!
//! Checked  tests/formats/mjcf.rs::actuators_*, ::home_*

use roxmltree::Node;

use super::Mjcf;
use super::attributes::used;
use super::defaults::Element;
use crate::error::Result;
use crate::model::JointKind;
use crate::spatial::{Quaternion, Rotation};

/// MuJoCo takes a quaternion of a smaller norm for the identity (`mju_normalize4`).
const SMALLEST_QUATERNION: f64 = 1e-15;

/// Elements whose default classes apply to actuators.
const ACTUATORS: [&str; 10] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "dcmotor",
    "adhesion",
];

impl<'d> Mjcf<'d> {
    /// Marks the actuated joints. In a file without actuators, all revolute and prismatic joints
    /// are actuated, as in a URDF.
    pub(super) fn actuators(&mut self) -> Result<()> {
        let actuators = self.files.section("actuator");
        if actuators.is_empty() && self.has_attached_actuators {
            return Ok(());
        }
        if actuators.is_empty() {
            let one = |kind| {
                matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic)
            };
            self.joints.iter_mut().for_each(|j| j.actuated = one(j.kind));
            return Ok(());
        }
        for node in actuators {
            for copy in self.copies_of(node) {
                self.copies.current = copy;
                self.actuator(node)?;
            }
        }
        // A motor at a mimic joint actuates the joint that it follows, if it follows one.
        for i in 0..self.joints.len() {
            let name = &self.joints[i].name;
            if self.joints[i].actuated && self.sums.contains_key(name) {
                let root = self.files.main.root_element();
                let why = "it actuates none of them alone; they count as passive";
                self.reader.note(root, "motor at a joint that follows several", why, name);
                self.joints[i].actuated = false;
            }
            if self.joints[i].actuated {
                let end = self.couplings.end(i);
                self.joints[end].actuated = true;
            }
        }
        Ok(())
    }

    fn actuator(&mut self, node: Node<'d, 'd>) -> Result<()> {
        let tag = node.tag_name().name();
        let name = node.attribute("name").unwrap_or("").to_owned();
        let attribute = ["joint", "jointinparent"].into_iter().find(|a| node.has_attribute(*a));
        let Some(attribute) = attribute else {
            let by = ["tendon", "site", "body", "cranksite"]
                .into_iter()
                .find(|a| node.has_attribute(*a));
            let what = format!("<{tag}> at a {}", by.unwrap_or("thing that is not a joint"));
            self.reader.note(
                node,
                what,
                "it actuates no joint alone; its joints count as passive",
                &name,
            );
            return Ok(());
        };
        self.reader.unread_attributes(node, &used(tag));
        let joint = self.joint_named(node, attribute)?;
        let element: Element<'d> = self.defaults.of(&self.reader, node, 0, &ACTUATORS)?;
        let gears = element.list(&self.reader, "gear", 6)?.unwrap_or_default();
        let gear = gears.first().copied();
        if gears.iter().skip(1).any(|x| *x != 0.0) {
            let why =
                "joints of one coordinate have one gear; efforts of joints of several are not read";
            let place = element.source_element("gear").unwrap_or(node);
            self.reader.note(place, format!("attribute 'gear' of <{tag}>"), why, &name);
        }
        // The control of a motor is its force; the force of other kinds is in forcerange.
        let of_force = ["forcerange", "forcelimited"];
        let mut range = self.compiler.range(&mut self.reader, &element, of_force, &name)?;
        if tag == "motor" {
            let of_control = ["ctrlrange", "ctrllimited"];
            let control = self.compiler.range(&mut self.reader, &element, of_control, &name)?;
            range = range.or(control);
        }
        if let Some([lower, upper]) = range {
            let most = lower.abs().max(upper.abs()) * gear.unwrap_or(1.0).abs();
            let effort = &mut self.joints[joint].limits.effort;
            if most > 0.0 {
                *effort = effort.min(most);
            }
        }
        self.joints[joint].actuated = true;
        Ok(())
    }

    /// The key frame named "home" of the main model becomes home.
    pub(super) fn key_frame(&mut self, is_main: bool) -> Result<()> {
        let keys = self.files.section("keyframe");
        let home = keys.iter().copied().find(|k| is_main && k.attribute("name") == Some("home"));
        for key in keys.into_iter().filter(|k| Some(*k) != home) {
            let name = key.attribute("name").unwrap_or("");
            self.reader.note(key, "<key>", "only the key named 'home' is used", name);
        }
        let Some(home) = home else { return Ok(()) };
        self.reader.unread_attributes(home, &["name", "qpos"]);
        let Some(qpos) = Element::bare(home).list(&self.reader, "qpos", usize::MAX)? else {
            return Ok(());
        };
        let size = |kind: JointKind| match kind {
            JointKind::Free => 7,
            JointKind::Spherical => 4,
            kind => kind.dof(),
        };
        let expected: usize = self.joints.iter().map(|j| size(j.kind)).sum();
        if qpos.len() != expected {
            let message = format!("qpos has {} numbers, the joints have {expected}", qpos.len());
            return Err(self.reader.refuse(home, "qpos", message));
        }
        let mut rest = qpos.as_slice();
        for joint in self.joints.iter().filter(|j| j.kind.dof() > 0) {
            let (own, others) = rest.split_at(size(joint.kind));
            rest = others;
            let position = own.len().saturating_sub(4);
            let q = match *own {
                [.., w, x, y, z] => {
                    let given = Quaternion { w, x, y, z };
                    let is_zero = [w, x, y, z].iter().map(|c| c * c).sum::<f64>().sqrt()
                        < SMALLEST_QUATERNION;
                    let rotation = if is_zero { Ok(Rotation::IDENTITY) } else { given.rotation() };
                    let rotation =
                        rotation.map_err(|e| self.reader.refuse(home, "qpos", e.to_string()))?;
                    [&own[..position], &rotation.log().to_array()].concat()
                }
                _ => own.to_vec(),
            };
            self.starts.push((joint.name.clone(), q));
        }
        Ok(())
    }
}
