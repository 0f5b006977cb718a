//! Joints of a URDF.
//!
//! Defaults  axis x; origin the parent's; if one position limit is given, the missing one is 0. A
//!           revolute or prismatic joint without position limits is unlimited (reported), and so is
//!           one whose four limits are all 0, which exporters write for "not filled in". Speeds
//!           and efforts that are 0 or missing are unlimited (reported).
//! Checked  tests/formats/urdf.rs, tests/formats/lax.rs

use std::collections::BTreeSet;

use roxmltree::Node;

use crate::error::{Error, Result};
use crate::model::formats::xml::Reader;
use crate::model::{JointKind, JointSpec, Limits, Mimic};
use crate::spatial::Vec3;
use crate::tolerance::ZERO_AXIS;

const TYPES: [&str; 6] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar"];

impl Reader<'_> {
    pub(super) fn joint(
        &mut self,
        node: Node<'_, '_>,
        links: &BTreeSet<&str>,
    ) -> Result<JointSpec> {
        let name = self.required(node, "name")?;
        let kind = self.joint_kind(node)?;
        self.leftovers(
            node,
            &["name", "type"],
            &["origin", "parent", "child", "axis", "limit", "mimic"],
        );
        let parent = self.end(node, "parent", links)?;
        let child = self.end(node, "child", links)?;
        let mut spec = JointSpec::new(name, kind, parent, child);
        spec.parent_from_joint = self.origin(node)?;
        // Exporters write zero axes and empty limits for fixed joints, which are noted only.
        if kind != JointKind::Fixed {
            spec.axis = self.axis(node, kind)?;
            spec.limits = self.limits(node, kind)?;
            spec.mimic = self.mimic(node)?;
        } else {
            for (tag, why) in [
                ("axis", "a fixed joint does not move"),
                ("limit", "a fixed joint does not move"),
                ("mimic", "a fixed joint follows nothing"),
            ] {
                if let Some(child) = self.child(node, tag) {
                    self.note(child, format!("<{tag}>"), why, name);
                }
            }
        }
        Ok(spec)
    }

    fn joint_kind(&self, node: Node<'_, '_>) -> Result<JointKind> {
        Ok(match self.required(node, "type")?.trim() {
            "revolute" => JointKind::Revolute,
            "continuous" => JointKind::Continuous,
            "prismatic" => JointKind::Prismatic,
            "fixed" => JointKind::Fixed,
            "floating" => JointKind::Free,
            "planar" => JointKind::Planar,
            "spherical" | "ball" => JointKind::Spherical,
            // As in Drake, about x of the parent and y of the child.
            "universal" => JointKind::Universal { second: Vec3::Y },
            other => {
                let unknown = Error::unknown("joint type", other, TYPES);
                return Err(self.refuse(node, "type", unknown.to_string()));
            }
        })
    }

    /// The link of `<parent>` or `<child>`.
    fn end<'d>(
        &mut self,
        joint: Node<'d, '_>,
        which: &'static str,
        links: &BTreeSet<&str>,
    ) -> Result<&'d str> {
        let Some(node) = self.child(joint, which) else {
            let name = joint.attribute("name").unwrap_or("");
            return Err(self.source.error(
                Self::tag(joint),
                format!("joint '{name}' has no <{which}>"),
                format!("add <{which} link=\"...\"/>"),
            ));
        };
        self.leftovers(node, &["link"], &[]);
        let link = self.required(node, "link")?;
        if !links.contains(link) {
            let unknown = Error::unknown("link", link, links.iter().copied());
            return Err(self.refuse(node, "link", unknown.to_string()));
        }
        Ok(link)
    }

    fn axis(&mut self, joint: Node<'_, '_>, kind: JointKind) -> Result<Vec3> {
        let Some(node) = self.child(joint, "axis") else { return Ok(Vec3::X) };
        self.leftovers(node, &["xyz"], &[]);
        let axis = self.vector::<3>(node, "xyz")?.map_or(Vec3::X, Vec3::from_array);
        if matches!(kind, JointKind::Universal { .. }) {
            let name = joint.attribute("name").unwrap_or("");
            self.note(node, "<axis>", "the axes of a universal joint are x and y", name);
            return Ok(Vec3::X);
        }
        if matches!(kind, JointKind::Free | JointKind::Spherical) {
            let name = joint.attribute("name").unwrap_or("");
            self.note(node, "<axis>", "the joint turns about every axis", name);
            return Ok(Vec3::X);
        }
        if axis.unit(ZERO_AXIS).is_none() {
            let name = joint.attribute("name").unwrap_or("");
            return Err(self.source.error(
                Self::value(node, "xyz"),
                format!("the axis of joint '{name}' has no direction"),
                "give a vector that is not zero; the URDF default is 1 0 0",
            ));
        }
        Ok(axis)
    }

    fn limits(&mut self, joint: Node<'_, '_>, kind: JointKind) -> Result<Limits> {
        let name = joint.attribute("name").unwrap_or("");
        let bounded = matches!(kind, JointKind::Revolute | JointKind::Prismatic);
        let mut limits = Limits::NONE;
        let Some(node) = self.child(joint, "limit") else {
            if bounded {
                let why = "read as unlimited in position, speed and effort";
                self.notes.add(joint.range().start, "<limit> missing", why, name);
            }
            return Ok(limits);
        };
        let at = node.range().start;
        self.leftovers(
            node,
            &["lower", "upper", "velocity", "acceleration", "jerk", "effort"],
            &[],
        );
        let (lower, upper) = (self.bound(node, "lower")?, self.bound(node, "upper")?);
        let velocity = self.largest(node, "velocity", name)?;
        let effort = self.largest(node, "effort", name)?;
        let positive = |x: Option<f64>| x.filter(|x| *x > 0.0).unwrap_or(f64::INFINITY);
        limits.acceleration = positive(self.bound(node, "acceleration")?);
        limits.jerk = positive(self.bound(node, "jerk")?);
        if kind.dof() > 1 {
            self.notes.add(at, "<limit>", "not used for joints of several coordinates", name);
            return Ok(Limits::NONE);
        }
        limits.velocity = velocity;
        limits.effort = effort;
        let empty = [lower, upper].iter().all(|x| x.is_none_or(|x| x == 0.0))
            && velocity == f64::INFINITY
            && effort == f64::INFINITY;
        match (lower, upper) {
            (None, None) if bounded => {
                let why = "read as unlimited in position";
                self.notes.add(at, "<limit> without lower and upper", why, name);
            }
            (None, None) => {}
            _ if !bounded => {
                let why = "a continuous joint has none";
                self.notes.add(at, "position limits of continuous joints", why, name);
            }
            _ if empty => {
                let why = "they hold no positive number: taken as not filled in, so unlimited";
                self.notes.add(at, "<limit> of zeros", why, name);
            }
            (lower, upper) => {
                (limits.lower, limits.upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
            }
        }
        if limits.lower > limits.upper {
            let (lower, upper) = (limits.lower, limits.upper);
            let attribute = if node.has_attribute("lower") { "lower" } else { "upper" };
            return Err(self.source.error(
                Self::value(node, attribute),
                format!("joint '{name}' has lower limit {lower} above its upper limit {upper}"),
                "exchange them; a limit that is missing is 0",
            ));
        }
        Ok(limits)
    }

    /// A limit of speed or effort: unlimited if it is 0 or missing.
    fn largest(
        &mut self,
        limit: Node<'_, '_>,
        attribute: &'static str,
        joint: &str,
    ) -> Result<f64> {
        match self.bound(limit, attribute)? {
            Some(x) if x > 0.0 => Ok(x),
            Some(x) if x < 0.0 => Err(self.refuse(
                limit,
                attribute,
                format!("joint '{joint}' has {attribute} limit {x}; it must not be negative"),
            )),
            _ => {
                let what = format!("{attribute} limit 0 or missing");
                self.notes.add(limit.range().start, what, "read as unlimited", joint);
                Ok(f64::INFINITY)
            }
        }
    }

    fn mimic(&mut self, joint: Node<'_, '_>) -> Result<Option<Mimic>> {
        let Some(node) = self.child(joint, "mimic") else { return Ok(None) };
        self.leftovers(node, &["joint", "multiplier", "offset"], &[]);
        Ok(Some(Mimic {
            joint: self.required(node, "joint")?.to_owned(),
            multiplier: self.number(node, "multiplier")?.unwrap_or(1.0),
            offset: self.number(node, "offset")?.unwrap_or(0.0),
        }))
    }
}
