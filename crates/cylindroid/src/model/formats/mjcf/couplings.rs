//! Joints, tendons and motors by name, and the joints that follow others, for constraints and
//! actuators of MJCF.
//!
//! Why so   files have as many constraints as joints: none must search or follow a chain through
//!          all others
//! Checked  tests/formats/large_models.rs::long_*

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use crate::model::formats::graph::Groups;
use crate::model::{JointSpec, Mimic};

/// The couplings of the joints read so far, by their indices.
pub(super) struct Couplings<'d> {
    /// Indices of the joints.
    pub(super) index: BTreeMap<String, usize>,
    /// The joint at the end of the chain of joints that a joint follows.
    ends: Groups,
    /// True for joints that another one follows.
    followed: Vec<bool>,
    /// The first coordinate at qpos0.
    references: Vec<f64>,
    tendons: BTreeMap<&'d str, Node<'d, 'd>>,
    motors: BTreeSet<&'d str>,
}

impl<'d> Couplings<'d> {
    /// Of joints with their positions at qpos0 by name, and what else those follow that follow several;
    /// of the elements of `<tendon>` and `<actuator>`.
    pub(super) fn of(
        joints: &[JointSpec],
        starts: &[(String, Vec<f64>)],
        sums: &BTreeMap<String, Vec<Mimic>>,
        [tendons, motors]: [Vec<Node<'d, 'd>>; 2],
    ) -> Self {
        let names = joints.iter().enumerate().map(|(i, j)| (j.name.clone(), i));
        let mut it = Self {
            index: names.collect(),
            ends: Groups::new(joints.len()),
            followed: vec![false; joints.len()],
            references: vec![0.0; joints.len()],
            tendons: BTreeMap::new(),
            motors: BTreeSet::new(),
        };
        // The first value of several is that at qpos0, and the first tendon of several counts.
        for (name, q) in starts.iter().rev() {
            if let Some(&i) = it.index.get(name) {
                it.references[i] = q.first().copied().unwrap_or(0.0);
            }
        }
        for tendon in tendons.into_iter().rev() {
            it.tendons.extend(tendon.attribute("name").map(|name| (name, tendon)));
        }
        it.motors = motors.iter().filter_map(|n| n.attribute("joint")).map(str::trim).collect();
        for (i, joint) in joints.iter().enumerate() {
            let others = sums.get(&joint.name).into_iter().flatten();
            for (k, mimic) in joint.mimic.iter().chain(others).enumerate() {
                if let Some(&leader) = it.index.get(&mimic.joint) {
                    it.followed[leader] = true;
                    if k == 0 {
                        it.ends.join(i, leader);
                    }
                }
            }
        }
        it
    }

    /// The joint that a joint follows, through any number of joints; itself if it follows none.
    pub(super) fn end(&mut self, joint: usize) -> usize {
        self.ends.of(joint)
    }

    /// Records that a joint, which followed none, follows others, the first of them in its chain.
    pub(super) fn follow(&mut self, follower: usize, leaders: &[usize]) {
        if let Some(&first) = leaders.first() {
            self.ends.join(follower, first);
        }
        leaders.iter().for_each(|&leader| self.followed[leader] = true);
    }

    pub(super) fn is_followed(&self, joint: usize) -> bool {
        self.followed[joint]
    }

    /// The position of a joint of one coordinate at qpos0.
    pub(super) fn reference(&self, joint: usize) -> f64 {
        self.references[joint]
    }

    pub(super) fn tendon(&self, name: &str) -> Option<Node<'d, 'd>> {
        self.tendons.get(name).copied()
    }

    pub(super) fn tendon_names(&self) -> impl Iterator<Item = &'d str> {
        self.tendons.keys().copied()
    }

    /// True if an actuator names this joint.
    pub(super) fn has_motor(&self, joint: &str) -> bool {
        self.motors.contains(joint)
    }
}

impl Default for Couplings<'_> {
    fn default() -> Self {
        Self {
            index: BTreeMap::new(),
            ends: Groups::new(0),
            followed: Vec::new(),
            references: Vec::new(),
            tendons: BTreeMap::new(),
            motors: BTreeSet::new(),
        }
    }
}
