//! Bodies, joints and sites of MJCF.
//!
//! Formula  parent_from_body(q) = pose product_i [Trans(p_i) motion_i(q_i - ref_i) Trans(-p_i)]
//!          with p_i, axis_i in the axes of the body, moved by enclosing frames; free: parent_from_body(q) = motion(q)
//! Why so   every body keeps its own frame, so poses equal MuJoCo's; q has the zero of qpos, and
//!          home is qpos0 (or the key frame named "home")
//! Source   mujoco.readthedocs.io, XML reference, body, joint; mj_kinematics
//! Checked  tests/formats/mjcf.rs (against poses that MuJoCo computed)

use std::rc::Rc;

use roxmltree::Node;

use super::Mjcf;
use super::attributes::used;
use super::copies::Placed;
use super::defaults::Element;
use crate::error::{Error, Result};
use crate::model::{JointKind, JointSpec, Limits, Link};
use crate::spatial::{Pose, Vec3};

/// A body that has not been read yet.
struct Pending<'d> {
    placed: Placed<'d>,
    parent: String,
    /// True for a child of the world, which may be free.
    top: bool,
}

/// The contents of a body, with `<frame>` elements resolved.
#[derive(Default)]
struct Inside<'d> {
    bodies: Vec<Placed<'d>>,
    joints: Vec<Placed<'d>>,
    geoms: Vec<Placed<'d>>,
    sites: Vec<Placed<'d>>,
    inertial: Option<(Node<'d, 'd>, Pose)>,
}

impl<'d> Mjcf<'d> {
    /// The world and all bodies, depth-first in the order of the file.
    pub(super) fn bodies(&mut self) -> Result<()> {
        self.links.push(Link::named("world"));
        self.link_names.insert("world");
        self.world.insert("world".to_owned(), Pose::IDENTITY);
        self.reserve_names()?;
        let roots = self.files.children(self.files.main.root_element());
        let mut worlds = Vec::new();
        for root in roots.into_iter().filter(|n| n.has_tag_name("worldbody")) {
            let class = self.defaults.class(&self.reader, root, "childclass")?.unwrap_or(0);
            let inside = self.inside(root, class, &"".into())?;
            self.furnish(0, &inside)?;
            for joint in &inside.joints {
                self.reader.note(joint.node, "<joint> of the world", "the world does not move", "");
            }
            worlds.push(inside.bodies);
        }
        let mut stack: Vec<Pending<'d>> = Vec::new();
        for bodies in worlds.into_iter().rev() {
            push(&mut stack, "world", bodies, true);
        }
        while let Some(body) = stack.pop() {
            self.body(body, &mut stack)?;
        }
        Ok(())
    }

    fn body(&mut self, body: Pending<'d>, stack: &mut Vec<Pending<'d>>) -> Result<()> {
        let Pending { placed, parent, top } = body;
        let node = placed.node;
        if node.has_tag_name("attach") {
            return self.attach(&placed, &parent);
        }
        self.reader.check_links(node, self.links.len() + 1)?;
        self.reader.unread_attributes(node, &used("body"));
        if node.attribute("mocap").is_some_and(|m| m.trim() == "true") {
            let name = node.attribute("name").unwrap_or("");
            self.reader.note(node, "mocap body", "it stays where the file puts it", name);
        }
        let name = match placed.name() {
            Some(name) => {
                if name == "world" || !self.given_bodies.insert(name.clone()) {
                    let message = format!("two bodies are named '{name}'");
                    return Err(self.reader.refuse(node, "name", message));
                }
                name
            }
            None => self.link_names.unique(&format!("body{}", self.links.len())),
        };
        let childclass =
            self.defaults.class(&self.reader, node, "childclass")?.unwrap_or(placed.class);
        let inside = self.inside(node, childclass, &placed.suffix)?;
        let pose = placed.place * self.compiler.pose(&self.reader, &Element::bare(node))?;
        self.joints_of(&parent, &name, pose, &inside.joints, top)?;
        self.note_motions_of(node, &name, inside.joints.len());
        let world = self.world.get(&parent).copied().unwrap_or_default() * pose;
        self.world.insert(name.clone(), world);
        self.link_index.insert(name.clone(), self.links.len());
        self.links.push(Link::named(&name));
        self.furnish(self.links.len() - 1, &inside)?;
        push(stack, &name, inside.bodies, false);
        Ok(())
    }

    /// The contents of a body; `<frame>` and `<replicate>` elements only displace their contents.
    fn inside(
        &mut self,
        body: Node<'d, 'd>,
        childclass: usize,
        suffix: &Rc<str>,
    ) -> Result<Inside<'d>> {
        let mut inside = Inside::default();
        let place = Pose::IDENTITY;
        let body = Placed { node: body, place, class: childclass, suffix: Rc::clone(suffix) };
        let mut stack = self.under(&body);
        let mut unread = Vec::new();
        while let Some(placed) = stack.pop() {
            let child = placed.node;
            match child.tag_name().name() {
                "body" | "attach" => inside.bodies.push(placed),
                "joint" | "freejoint" => inside.joints.push(placed),
                "geom" => inside.geoms.push(placed),
                "site" => inside.sites.push(placed),
                "inertial" => {
                    if inside.inertial.replace((child, placed.place)).is_some() {
                        let owner = self.reader.owner(child).to_owned();
                        let message = format!("body '{owner}' has two <inertial>");
                        let tag = crate::model::formats::xml::Reader::tag(child);
                        return Err(self.reader.error(child, tag, message, "leave one of them"));
                    }
                }
                "replicate" => {
                    let copies = self.replicas(&placed)?;
                    stack.extend(copies.iter().rev().flat_map(|copy| self.under(copy)));
                }
                "frame" => {
                    self.reader.unread_attributes(child, &used("frame"));
                    let own = self.compiler.pose(&self.reader, &Element::bare(child))?;
                    let class_of = self.defaults.class(&self.reader, child, "childclass")?;
                    let place = placed.place * own;
                    let class = class_of.unwrap_or(placed.class);
                    stack.extend(self.under(&Placed { place, class, ..placed }));
                }
                _ => unread.push(child),
            }
        }
        for child in unread {
            let name = child.tag_name().name();
            let owner = self.reader.owner(child).to_owned();
            self.reader.note(child, format!("<{name}>"), (self.reader.why)(name), &owner);
        }
        Ok(inside)
    }

    /// The children of an element, last first.
    fn under(&self, of: &Placed<'d>) -> Vec<Placed<'d>> {
        let children = self.files.children(of.node).into_iter().rev();
        children.map(|node| Placed { node, ..of.clone() }).collect()
    }

    /// Shapes, masses and sites of a link.
    fn furnish(&mut self, index: usize, inside: &Inside<'d>) -> Result<()> {
        let mut link = self.links[index].clone();
        // The world does not move.
        if index > 0 {
            link.inertial = self.mass_of(inside.inertial, &inside.geoms, &link.name)?;
        }
        for placed in &inside.geoms {
            self.geom(&mut link, placed)?;
        }
        for placed in &inside.sites {
            let Placed { node, place, class, .. } = placed;
            let element = self.defaults.of(&self.reader, *node, *class, &["site"])?;
            self.reader.unread_attributes(*node, &used("site"));
            let Some(name) = placed.name() else {
                let why = "without a name there is no way to speak of it";
                self.reader.note(*node, "<site> without a name", why, &link.name);
                continue;
            };
            let mut on_frame = self.compiler.pose(&self.reader, &element)?;
            let kind = element.text("type").unwrap_or("sphere");
            if let Some((between, _)) = element.between(&self.reader, kind)? {
                on_frame = between;
            }
            self.sites.push((name, link.name.clone(), *place * on_frame));
        }
        self.links[index] = link;
        Ok(())
    }

    /// The joints between two bodies: one after the other, with a link between each two.
    fn joints_of(
        &mut self,
        parent: &str,
        body: &str,
        pose: Pose,
        joints: &[Placed<'d>],
        top: bool,
    ) -> Result<()> {
        self.first_joint.insert(body.to_owned(), self.joints.len());
        if joints.is_empty() {
            let name = self.joint_names.unique(body);
            let fixed = JointSpec::new(&name, JointKind::Fixed, parent, body);
            self.joints.push(JointSpec { parent_from_joint: pose, actuated: false, ..fixed });
            return Ok(());
        }
        let mut near = parent.to_owned();
        let mut pending = pose;
        for (i, placed) in joints.iter().enumerate() {
            let node = placed.node;
            let last = i + 1 == joints.len();
            let (mut spec, reference) = self.joint(placed, body)?;
            if spec.kind == JointKind::Free && !(top && joints.len() == 1) {
                let message =
                    format!("body '{body}' has a free joint and a second joint or a parent");
                return Err(self.reader.error(
                    node,
                    crate::model::formats::xml::Reader::tag(node),
                    message,
                    "a free joint is the only one of a body of the world",
                ));
            }
            let far = if last {
                body.to_owned()
            } else {
                self.link_names.unique(&format!("{body}.{}", spec.name))
            };
            if spec.kind == JointKind::Free {
                let turn = pose.rotation.log().to_array();
                let q = [pose.translation.to_array(), turn].concat();
                self.starts.push((spec.name.clone(), q));
            } else {
                let anchor = spec.parent_from_joint;
                let back = spec.kind.transform(spec.axis, &reference).inverse();
                spec.parent_from_joint = pending * anchor * back;
                spec.joint_from_child = anchor.inverse();
                self.starts.push((spec.name.clone(), reference));
            }
            (spec.parent, spec.child) = (near, far.clone());
            if !last {
                self.reader.check_links(node, self.links.len() + 2)?;
                let base = self.world.get(parent).copied().unwrap_or_default();
                self.world.insert(far.clone(), base * pose);
                self.links.push(Link::named(&far));
            }
            self.joints.push(spec);
            (near, pending) = (far, Pose::IDENTITY);
        }
        Ok(())
    }

    /// A joint at its anchor in the body, and its coordinates at `ref`.
    fn joint(&mut self, placed: &Placed<'d>, body: &str) -> Result<(JointSpec, Vec<f64>)> {
        let &Placed { node, place: body_from_frame, class, .. } = placed;
        let reader = &mut self.reader;
        let is_free = node.has_tag_name("freejoint");
        let element = if is_free {
            Element::bare(node)
        } else {
            self.defaults.of(reader, node, class, &["joint"])?
        };
        reader.unread_attributes(node, &used("joint"));
        let kind = match (is_free, element.text("type").unwrap_or("hinge")) {
            (true, _) | (_, "free") => JointKind::Free,
            (_, "hinge") => JointKind::Revolute,
            (_, "slide") => JointKind::Prismatic,
            (_, "ball") => JointKind::Spherical,
            (_, other) => {
                let unknown =
                    Error::unknown("joint type", other, ["hinge", "slide", "ball", "free"]);
                return Err(element.refuse(reader, "type", unknown.to_string()));
            }
        };
        let name = match placed.name() {
            Some(name) if !self.given_joints.insert(name.clone()) => {
                let message = format!("two joints are named '{name}'");
                return Err(reader.refuse(node, "name", message));
            }
            Some(name) => name,
            None => self.joint_names.unique(body),
        };
        let mut spec = JointSpec::new(&name, kind, "", "");
        spec.actuated = false;
        let one = matches!(kind, JointKind::Revolute | JointKind::Prismatic);
        let unit = if kind == JointKind::Prismatic { 1.0 } else { self.compiler.unit };
        if kind != JointKind::Free {
            let anchor = element.vector::<3>(reader, "pos")?.map_or(Vec3::ZERO, Vec3::from_array);
            spec.parent_from_joint = Pose::from_translation(body_from_frame * anchor);
        }
        spec.axis = body_from_frame.rotation * spec.axis;
        if one && let Some(axis) = element.vector::<3>(reader, "axis")? {
            spec.axis = body_from_frame.rotation * Vec3::from_array(axis);
            if spec.axis.unit(crate::tolerance::ZERO_AXIS).is_none() {
                let message = format!("the axis of joint '{name}' has no direction");
                return Err(element.refuse(reader, "axis", message));
            }
        }
        if kind != JointKind::Free {
            let range = self.compiler.range(reader, &element, ["range", "limited"], &name)?;
            match range {
                None => {}
                Some([lower, upper]) if one => {
                    (spec.limits.lower, spec.limits.upper) = (lower * unit, upper * unit);
                }
                Some(_) => {
                    reader.note(node, "range of a ball joint", "cones are not limits here", &name);
                }
            }
            let of_force = ["actuatorfrcrange", "actuatorfrclimited"];
            if let Some([lower, upper]) = self.compiler.range(reader, &element, of_force, &name)? {
                spec.limits.effort = lower.abs().max(upper.abs());
            }
        }
        if kind == JointKind::Revolute && spec.limits.lower == f64::NEG_INFINITY {
            spec.kind = JointKind::Continuous;
            spec.limits = Limits { effort: spec.limits.effort, ..Limits::NONE };
        }
        spec.armature = element.number(reader, "armature")?.unwrap_or(0.0);
        let reference = match element.number(reader, "ref")? {
            Some(x) if one => vec![x * unit],
            _ if one => vec![0.0],
            _ => vec![0.0; kind.dof()],
        };
        Ok((spec, reference))
    }
}

fn push<'d>(stack: &mut Vec<Pending<'d>>, parent: &str, bodies: Vec<Placed<'d>>, top: bool) {
    let pending = |placed| Pending { placed, parent: parent.to_owned(), top };
    stack.extend(bodies.into_iter().rev().map(pending));
}
