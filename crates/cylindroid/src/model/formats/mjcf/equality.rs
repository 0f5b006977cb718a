//! `<equality>` of MJCF: loop joints and mimic joints.
//!
//! Formula  connect: a spherical joint at `anchor` of body1 (or of site1 at site2);
//!          weld: a fixed joint, body1_from_body2 = relpose, by default the pose in the file;
//!          joint: q1 = ref1 + c0 + c1 (q2 - ref2), higher coefficients are ignored;
//!          tendon: see `tendon.rs`
//! Why so   a coupled joint is a mimic joint: it needs no loop, and its column is added to that of
//!          the joint that it follows
//! Source   mujoco.readthedocs.io, XML reference, equality
//! Checked  tests/formats/mjcf.rs::equality_*

use roxmltree::Node;

use super::Mjcf;
use super::attributes::used;
use super::copies::Kind;
use super::defaults::Element;
use crate::error::{Error, Result};
use crate::model::{JointKind, LoopJointSpec, Mimic};
use crate::spatial::{Pose, Quaternion, Vec3};

/// Coefficients of a polynomial at most.
pub(super) const POLYNOMIAL: usize = 5;

impl<'d> Mjcf<'d> {
    pub(super) fn equalities(&mut self) -> Result<()> {
        for node in self.files.section("equality") {
            let tag = node.tag_name().name();
            let name = node.attribute("name").unwrap_or(tag);
            let element = self.defaults.of(&self.reader, node, 0, &["equality"])?;
            if element.text("active") == Some("false") {
                self.reader.note(node, format!("<{tag}> that is not active"), "not read", name);
                continue;
            }
            self.reader.unread_attributes(node, &used("equality"));
            for copy in self.copies_of(node) {
                let name = format!("{name}{copy}");
                self.copies.current = copy;
                match tag {
                    "connect" | "weld" => self.close(node, tag, &name)?,
                    "joint" => self.couple(node, &name)?,
                    "tendon" => self.couple_by_tendon(node, &name)?,
                    other => {
                        let what = format!("<{other}> in <equality>");
                        let why =
                            "connect, weld, joint and tendon are read; this holds nothing here";
                        self.reader.note(node, what, why, &name);
                    }
                }
            }
        }
        Ok(())
    }

    fn close(&mut self, node: Node<'d, 'd>, tag: &str, name: &str) -> Result<()> {
        let kind = if tag == "connect" { JointKind::Spherical } else { JointKind::Fixed };
        let ((a, on_a), (b, on_b)) = if node.has_attribute("site1") {
            (self.site(node, "site1")?, self.site(node, "site2")?)
        } else {
            let a = self.body_named(node, "body1", None)?;
            let b = self.body_named(node, "body2", Some("world"))?;
            let place = |link: &String| self.world.get(link).copied().unwrap_or_default();
            let b_from_a = place(&b).inverse() * place(&a);
            let element = Element::bare(node);
            let (on_a, on_b) = if kind == JointKind::Spherical {
                let Some(anchor) = element.vector::<3>(&self.reader, "anchor")? else {
                    let message = format!("connect '{name}' has no anchor");
                    return Err(self.reader.refuse(node, "anchor", message));
                };
                let anchor = Pose::from_translation(Vec3::from_array(anchor));
                (anchor, b_from_a * anchor)
            } else {
                match element.vector::<7>(&self.reader, "relpose")? {
                    Some([x, y, z, quaternion @ ..]) if quaternion != [0.0; 4] => {
                        let [w, i, j, k] = quaternion;
                        let rotation = Quaternion { w, x: i, y: j, z: k }
                            .rotation()
                            .map_err(|e| self.reader.refuse(node, "relpose", e.to_string()))?;
                        (Pose { rotation, translation: Vec3::new(x, y, z) }, Pose::IDENTITY)
                    }
                    _ => (Pose::IDENTITY, b_from_a),
                }
            };
            ((a, on_a), (b, on_b))
        };
        if a == b {
            let message = format!("{tag} '{name}' holds body '{a}' to itself");
            return Err(self.reader.refuse(node, "name", message));
        }
        let name = self.joint_names.unique(name);
        self.loops.push(LoopJointSpec {
            link_a_from_joint: on_a,
            link_b_from_joint: on_b,
            ..LoopJointSpec::new(&name, kind, &a, &b)
        });
        Ok(())
    }

    fn body_named(
        &self,
        node: Node<'d, 'd>,
        attribute: &str,
        missing: Option<&str>,
    ) -> Result<String> {
        let name = match (node.attribute(attribute), missing) {
            (None, Some(name)) => name,
            _ => self.reader.required(node, attribute)?.trim(),
        };
        let name = self.copies.name(Kind::Body, name);
        if self.world.contains_key(&name) {
            return Ok(name);
        }
        let unknown = Error::unknown("body", &name, self.world.keys());
        Err(self.reader.refuse(node, attribute, unknown.to_string()))
    }

    /// The body of a site and its pose on it.
    fn site(&self, node: Node<'d, 'd>, attribute: &str) -> Result<(String, Pose)> {
        let name = self.copies.name(Kind::Site, self.reader.required(node, attribute)?.trim());
        match self.sites.iter().find(|s| s.0 == name) {
            Some((_, link, pose)) => Ok((link.clone(), *pose)),
            None => {
                let unknown = Error::unknown("site", &name, self.sites.iter().map(|s| &s.0));
                Err(self.reader.refuse(node, attribute, unknown.to_string()))
            }
        }
    }

    /// The index of a joint that an attribute names.
    pub(super) fn joint_named(&self, node: Node<'d, 'd>, attribute: &str) -> Result<usize> {
        let name = self.copies.name(Kind::Joint, self.reader.required(node, attribute)?.trim());
        self.couplings.index.get(&name).copied().ok_or_else(|| {
            let unknown = Error::unknown("joint", &name, self.joints.iter().map(|j| &j.name));
            self.reader.refuse(node, attribute, unknown.to_string())
        })
    }

    fn couple(&mut self, node: Node<'d, 'd>, name: &str) -> Result<()> {
        let follower = self.joint_named(node, "joint1")?;
        if !node.has_attribute("joint2") {
            let why = "a joint fixed at one position keeps its coordinate here";
            self.reader.note(node, "<joint> of <equality> without joint2", why, name);
            return Ok(());
        }
        let leader = self.joint_named(node, "joint2")?;
        let polynomial = Element::bare(node).list(&self.reader, "polycoef", POLYNOMIAL)?;
        let mut c = [0.0, 1.0, 0.0, 0.0, 0.0];
        for (slot, value) in c.iter_mut().zip(polynomial.unwrap_or_default()) {
            *slot = value;
        }
        if c[2..] != [0.0; 3] {
            let why = "only linear couplings are read: polycoef beyond the second is not zero";
            self.reader.note(node, "<joint> in <equality>", why, name);
        } else if let Some(why) = self.tie(follower, leader, c[1], c[0]) {
            self.reader.note(node, "<joint> in <equality>", why, name);
        }
        Ok(())
    }

    /// Makes a joint follow another, `q - ref = constant + slope (q' - ref')`; otherwise returns
    /// the reason.
    pub(super) fn tie(
        &mut self,
        follower: usize,
        leader: usize,
        slope: f64,
        constant: f64,
    ) -> Option<&'static str> {
        if [follower, leader].iter().any(|&j| self.joints[j].kind.dof() != 1) {
            return Some("only joints of one coordinate can follow");
        }
        if self.joints[follower].mimic.is_some() {
            return Some("its first joint follows another one already");
        }
        if self.sums.contains_key(&self.joints[leader].name) {
            return Some("it would follow a joint that follows several");
        }
        if self.couplings.end(leader) == follower {
            return Some("the two joints would follow one another");
        }
        let reference = |joint| self.couplings.reference(joint);
        let offset = reference(follower) + constant - slope * reference(leader);
        if !(slope.is_finite() && offset.is_finite()) {
            return Some("its coefficients are out of range");
        }
        let joint = self.joints[leader].name.clone();
        self.joints[follower].mimic = Some(Mimic { joint, multiplier: slope, offset });
        self.couplings.follow(follower, &[leader]);
        None
    }
}
