//! Fixed tendons in `<equality>` of MJCF: joints whose weighted sum is constant.
//!
//! Formula  sum of a_i (q_i - ref_i) = c0 over all joints, a_i the coefficients of tendon1; with
//!          tendon2 also - c1 b_i, b_i its coefficients. One joint f follows the others:
//!          q_f = ref_f + c0 / a_f - sum of (a_i / a_f) (q_i - ref_i)
//! Valid    joints of one coordinate, linear polycoef; limits and armature of a joint that follows
//!          several are left out
//! Why so   a joint that follows several becomes several joints on one axis, each of which follows
//!          one: motions along one axis add up, and every mimic joint has one leader
//! Source   mujoco.readthedocs.io, XML reference, equality/tendon, tendon/fixed
//! Checked  tests/formats/mujoco.rs::tendons_*, ::couplings_*

use std::collections::BTreeMap;

use roxmltree::Node;

use super::Mjcf;
use super::defaults::Element;
use super::equality::POLYNOMIAL;
use crate::error::{Error, Result};
use crate::model::{JointKind, JointSpec, Mimic};
use crate::spatial::Pose;

/// Joints and their coefficients.
type Terms = Vec<(usize, f64)>;

impl<'d> Mjcf<'d> {
    /// A tendon of constant length couples its joints, two tendons those of both.
    pub(super) fn couple_by_tendon(&mut self, node: Node<'d, 'd>, name: &str) -> Result<()> {
        let polynomial = Element::bare(node).list(&self.reader, "polycoef", POLYNOMIAL)?;
        let mut c = [0.0, 1.0, 0.0, 0.0, 0.0];
        for (slot, value) in c.iter_mut().zip(polynomial.unwrap_or_default()) {
            *slot = value;
        }
        let mut all = self.fixed_tendon(node, "tendon1")?;
        let mut linear = true;
        if node.has_attribute("tendon2") {
            linear = c[2..] == [0.0; 3];
            let second = self.fixed_tendon(node, "tendon2")?;
            all = all.zip(second).map(|((mut names, mut terms), (more, others))| {
                names.extend(more);
                terms.extend(others.into_iter().map(|(joint, b)| (joint, -c[1] * b)));
                (names, terms)
            });
        }
        let why = match all {
            _ if !linear => {
                Some("only linear couplings are read: polycoef beyond the second is not zero")
            }
            None => Some("only a fixed tendon over two joints or more ties them together here"),
            Some((names, terms)) => {
                let terms = merged(terms);
                let why = match terms[..] {
                    [] | [_] => {
                        Some("only a fixed tendon over two joints or more ties them together here")
                    }
                    [(first, a), (second, b)] => {
                        // The second joint follows the first; otherwise the first the second.
                        let second_follows = self.tie(second, first, -a / b, c[0] / b);
                        let first_follows = |it: &mut Self, why| {
                            it.tie(first, second, -b / a, c[0] / a).and(Some(why))
                        };
                        second_follows.and_then(|why| first_follows(self, why))
                    }
                    _ => self.tie_to_all(node, &terms, c[0]),
                };
                if terms.len() > 1 {
                    self.tied.extend(names);
                }
                why
            }
        };
        self.reader.check_links(node, self.links.len() + self.made_links)?;
        if let Some(why) = why {
            self.reader.note(node, "<tendon> in <equality>", why, name);
        }
        Ok(())
    }

    /// The joints of a fixed tendon, with its name; none if it is a spatial one.
    fn fixed_tendon(
        &mut self,
        node: Node<'d, 'd>,
        attribute: &str,
    ) -> Result<Option<(Vec<String>, Terms)>> {
        let name = self.reader.required(node, attribute)?.trim();
        let Some(tendon) = self.couplings.tendon(name) else {
            let unknown = Error::unknown("tendon", name, self.couplings.tendon_names());
            return Err(self.reader.refuse(node, attribute, unknown.to_string()));
        };
        self.reader.unread_attributes(tendon, &["name"]);
        let mut terms = Vec::new();
        for joint in self.files.children(tendon).into_iter().filter(|n| n.has_tag_name("joint")) {
            self.reader.unread_attributes(joint, &["joint", "coef"]);
            let coefficient = Element::bare(joint).number(&self.reader, "coef")?.unwrap_or(0.0);
            terms.push((self.joint_named(joint, "joint")?, coefficient));
        }
        Ok(tendon.has_tag_name("fixed").then(|| (vec![name.to_owned()], terms)))
    }

    /// Makes one of three or more joints follow the others; otherwise returns the reason.
    fn tie_to_all(
        &mut self,
        node: Node<'d, 'd>,
        terms: &[(usize, f64)],
        constant: f64,
    ) -> Option<&'static str> {
        if terms.iter().any(|&(j, _)| self.joints[j].kind.dof() != 1) {
            return Some("only joints of one coordinate can follow");
        }
        let Some(place) = self.follower(terms) else {
            return Some("each of its joints follows another one, or is followed already");
        };
        let mut others = terms.to_vec();
        let (follower, own) = others.remove(place);
        if others.iter().any(|(j, _)| self.sums.contains_key(&self.joints[*j].name)) {
            return Some("it would follow a joint that follows several");
        }
        let mut offset = self.couplings.reference(follower) + constant / own;
        let leaders: Vec<usize> = others.iter().map(|(joint, _)| *joint).collect();
        let mut mimics = Vec::new();
        for (joint, a) in others {
            let multiplier = -a / own;
            offset -= multiplier * self.couplings.reference(joint);
            let joint = self.joints[joint].name.clone();
            mimics.push(Mimic { joint, multiplier, offset: 0.0 });
        }
        let multipliers = mimics.iter().map(|m| m.multiplier);
        if !multipliers.chain([offset]).all(f64::is_finite) {
            return Some("its coefficients are out of range");
        }
        mimics[0].offset = offset;
        self.couplings.follow(follower, &leaders);
        self.made_links += leaders.len() - 1;
        let joint = &mut self.joints[follower];
        let left_out = [("range", is_limited(joint)), ("armature", joint.armature != 0.0)];
        (joint.limits.lower, joint.limits.upper) = (f64::NEG_INFINITY, f64::INFINITY);
        joint.armature = 0.0;
        if joint.kind == JointKind::Revolute {
            joint.kind = JointKind::Continuous;
        }
        let name = joint.name.clone();
        let mut mimics = mimics.into_iter();
        joint.mimic = mimics.next();
        self.sums.insert(name.clone(), mimics.collect());
        for (what, _) in left_out.into_iter().filter(|(_, is_given)| *is_given) {
            let why = "that of a joint that follows several is left out";
            self.reader.note(node, what, why, &name);
        }
        None
    }

    /// The place of the joint that follows the others: without a motor, armature and limits, and the
    /// last, in this order.
    fn follower(&self, terms: &[(usize, f64)]) -> Option<usize> {
        let is_free = |j: usize| self.joints[j].mimic.is_none() && !self.couplings.is_followed(j);
        let free = terms.iter().enumerate().filter(|(_, (j, _))| is_free(*j));
        let rank = |&(place, &(j, _)): &(usize, &(usize, f64))| {
            let joint = &self.joints[j];
            (
                !self.couplings.has_motor(&joint.name),
                joint.armature == 0.0,
                !is_limited(joint),
                place,
            )
        };
        free.max_by_key(rank).map(|(place, _)| place)
    }

    /// The joints of a joint that follows several: the first has its name.
    pub(super) fn parts_of(&mut self, joint: JointSpec) -> Vec<JointSpec> {
        let Some(others) = self.sums.remove(&joint.name) else { return vec![joint] };
        self.disabled_collisions.push([joint.parent.clone(), joint.child.clone()]);
        let mut parts = vec![joint.clone()];
        for mimic in others {
            let between = self.link_names.unique(&format!("{}.{}", joint.child, joint.name));
            let name = format!("{}+{}", joint.name, mimic.joint);
            if let Some(last) = parts.last_mut() {
                last.child.clone_from(&between);
                last.joint_from_child = Pose::IDENTITY;
            }
            parts.push(JointSpec {
                name: self.joint_names.unique(&name),
                parent: between,
                parent_from_joint: Pose::IDENTITY,
                mimic: Some(mimic),
                ..joint.clone()
            });
        }
        parts
    }
}

fn is_limited(joint: &JointSpec) -> bool {
    joint.limits.lower > f64::NEG_INFINITY || joint.limits.upper < f64::INFINITY
}

/// Every joint once, without those whose coefficients are or cancel to zero.
fn merged(terms: Terms) -> Terms {
    let mut all: Terms = Vec::new();
    let mut places: BTreeMap<usize, usize> = BTreeMap::new();
    for (joint, a) in terms {
        match places.get(&joint) {
            Some(&place) => all[place].1 += a,
            None => {
                places.insert(joint, all.len());
                all.push((joint, a));
            }
        }
    }
    all.retain(|(_, a)| *a != 0.0);
    all
}
