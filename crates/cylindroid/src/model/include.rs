//! Inclusion of one mechanism in another: its links, joints, loops, contacts and frames, under a
//! prefix.
//!
//! Checked  tests/it/graph.rs::an_included_mechanism_*

use std::collections::BTreeSet;

use super::builder::Builder;
use super::contact::ContactSpec;
use super::elasticity::ElasticKind;
use super::joint::{JointKind, Mimic};
use super::joint_spec::JointSpec;
use super::link::Link;
use super::loop_joint::LoopJointSpec;
use super::mechanism::Mechanism;
use crate::error::Result;
use crate::spatial::Pose;

/// The placement of an included mechanism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inclusion<'a> {
    /// Its name: its parts are called `name/...`. If empty, names stay as they are.
    pub name: &'a str,
    /// The link that carries its root. A root of the same name is identified with this link.
    pub parent: &'a str,
    /// Pose of the root on that link.
    pub parent_from_root: Pose,
    /// True if the root moves freely, as an object does.
    pub free: bool,
    /// The configuration that becomes home.
    pub start: &'a [f64],
}

impl Inclusion<'_> {
    fn prefixed(&self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}/{name}", self.name) }
    }

    /// The name of the joint between the parent and the root: `name/base`, with a number where the
    /// mechanism has a joint of this name.
    fn base(&self, robot: &Mechanism) -> String {
        let base = format!("{}/base", if self.name.is_empty() { self.parent } else { self.name });
        let joints = robot.joints().iter().map(|j| &j.name);
        let loops = robot.loops().iter().map(|l| &l.name);
        let contacts = robot.contacts().iter().map(|c| &c.name);
        let taken: BTreeSet<String> =
            joints.chain(loops).chain(contacts).map(|name| self.prefixed(name)).collect();
        let numbered = (2..).map(|i| format!("{base}.{i}"));
        std::iter::once(base.clone()).chain(numbered).find(|b| !taken.contains(b)).unwrap_or(base)
    }

    /// The name of a link of the included mechanism.
    #[must_use]
    pub fn link(&self, robot: &Mechanism, index: usize) -> String {
        robot.links().get(index).map_or_else(String::new, |l| self.prefixed(&l.name))
    }
}

impl Mechanism {
    /// The link that is no child: the first of the tree.
    pub(crate) fn root(&self) -> usize {
        let mut is_child = vec![false; self.links().len()];
        self.joints().iter().for_each(|j| is_child[j.child] = true);
        is_child.iter().position(|child| !child).unwrap_or(0)
    }
}

impl Builder {
    /// Adds a whole mechanism. Its root is attached to `parent` by a joint `name/base`
    /// (`parent/base` without a name), fixed or free; a number follows where the mechanism has a joint
    /// of this name.
    ///
    /// ```
    /// use cylindroid::model::{Inclusion, Mechanism};
    /// use cylindroid::{Pose, Vec3};
    ///
    /// // Two arms, 1 m apart.
    /// let arm = cylindroid::load("ur5e")?;
    /// let mut builder = Mechanism::builder("two arms");
    /// for (name, y) in [("left", 0.5), ("right", -0.5)] {
    ///     builder.include(&arm, Inclusion {
    ///         name,
    ///         parent: "ground",
    ///         parent_from_root: Pose::from_translation(Vec3::Y * y),
    ///         free: false,
    ///         start: arm.home(),
    ///     })?;
    /// }
    /// let both = builder.build()?;
    /// assert_eq!(both.n(), 12);
    /// assert!(both.limits_of(&format!("left/{}", arm.coordinates()[0].name)).is_some());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A start configuration that does not match the mechanism.
    pub fn include(&mut self, robot: &Mechanism, how: Inclusion<'_>) -> Result<&mut Self> {
        robot.check_q("start", how.start)?;
        let name = |i: usize| how.link(robot, i);
        let root = robot.root();
        for (i, link) in robot.links().iter().enumerate() {
            if name(i) != how.parent {
                self.link(Link { name: name(i), ..link.clone() });
            }
        }
        if name(root) != how.parent {
            let kind = if how.free { JointKind::Free } else { JointKind::Fixed };
            self.joint(JointSpec {
                parent_from_joint: how.parent_from_root,
                actuated: false,
                ..JointSpec::new(&how.base(robot), kind, how.parent, &name(root))
            });
        }
        for joint in robot.joints() {
            let follows = |m: &Mimic| Mimic { joint: how.prefixed(&m.joint), ..m.clone() };
            self.joint(JointSpec {
                name: how.prefixed(&joint.name),
                kind: joint.kind,
                parent: name(joint.parent),
                child: name(joint.child),
                parent_from_joint: joint.parent_from_joint,
                joint_from_child: joint.joint_from_child,
                axis: joint.axis,
                reversed: joint.reversed,
                limits: joint.limits,
                mimic: joint.mimic.as_ref().map(follows),
                actuated: joint.actuated,
                armature: joint.armature,
            });
            if joint.mimic.is_none() && joint.kind.dof() > 0 {
                self.start(&how.prefixed(&joint.name), &how.start[joint.coordinates.clone()]);
            }
        }
        for joint in robot.loops() {
            self.loop_joint(LoopJointSpec {
                name: how.prefixed(&joint.name),
                kind: joint.kind,
                a: name(joint.a),
                b: name(joint.b),
                link_a_from_joint: joint.link_a_from_joint,
                link_b_from_joint: joint.link_b_from_joint,
                axis: joint.axis,
                limits: joint.limits,
                actuated: joint.actuated,
            });
        }
        for &[a, b] in robot.disabled_collisions() {
            self.disable_collision(&name(a), &name(b));
        }
        for name in robot.unassembled() {
            self.assemble_home(&how.prefixed(name));
        }
        for contact in robot.contacts() {
            self.contact(ContactSpec {
                name: how.prefixed(&contact.name),
                kind: contact.kind,
                a: name(contact.a),
                b: name(contact.b),
                link_a_from_contact: contact.link_a_from_contact,
                link_b_from_contact: contact.link_b_from_contact,
                friction: contact.friction,
                curvature: contact.curvature,
            });
        }
        for element in &robot.elasticity().elements {
            let mut element = element.clone();
            element.name = how.prefixed(&element.name);
            if let ElasticKind::Joint(body) | ElasticKind::Link(body) = &mut element.kind
                && let Some((link, _)) = &mut body.frame
            {
                *link = how.prefixed(link);
            }
            self.elasticity.elements.push(element);
        }
        // The frames of the links come with the links.
        for frame in robot.frames().iter().skip(robot.links().len()) {
            self.frame(&how.prefixed(&frame.name), &name(frame.link), frame.link_from_frame);
        }
        for note in &robot.report().ignored {
            let of = if how.name.is_empty() { robot.name() } else { how.name };
            let what = match note.line {
                0 => format!("{of}: {}", note.what),
                line => format!("{of}, line {line}: {}", note.what),
            };
            self.report().ignore(0, what, note.why.clone());
        }
        Ok(self)
    }
}
