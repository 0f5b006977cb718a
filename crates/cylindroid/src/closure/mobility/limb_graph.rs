//! The limbs of a mechanism: its graph of bodies and joints without ground and platform.
//!
//! Formula  edges are joints, loop joints and contacts; two belong to the same limb if they share a
//!          body that is neither ground nor platform, or a coordinate (mimic joints). A limb reaches
//!          from ground to platform; components at one of them only are none, nor is a passive free
//!          joint between ground and platform, which constrains nothing
//! Units    m
//! Frame    world
//! Valid    any mechanism; none if the platform is fixed to the ground
//! Source   Tsai 1999, section 1.6 (limbs of parallel manipulators)
//! Checked  tests/it/closure/limbs.rs

use std::collections::VecDeque;

use crate::kinematics::State;
use crate::model::{FrameId, JointKind, JointLocus, Mechanism};
use crate::spatial::{Pose, Vec3};

/// What an edge of the graph is, by its index in the mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EdgeKind {
    Joint(usize),
    Loop(usize),
    Contact(usize),
}

/// A joint or contact between two bodies, numbered by their moving frames (0: ground).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge {
    pub(crate) kind: EdgeKind,
    pub(crate) bodies: [usize; 2],
}

/// The edges of a limb.
#[derive(Debug, Clone)]
pub(crate) struct LimbEdges {
    pub(crate) edges: Vec<Edge>,
    pub(crate) platform: usize,
    /// True if the edges form a path.
    pub(crate) serial: bool,
}

fn body(mechanism: &Mechanism, link: usize) -> usize {
    mechanism.frame_of(mechanism.link_frame(link)).slot
}

/// All edges but joints without motion, which the bodies contain.
fn edges(mechanism: &Mechanism) -> Vec<Edge> {
    let edge = |kind, a, b| Edge { kind, bodies: [body(mechanism, a), body(mechanism, b)] };
    let joints = mechanism.joints().iter().enumerate();
    let loops = mechanism.loops().iter().enumerate();
    let contacts = mechanism.contacts().iter().enumerate();
    joints
        .map(|(i, j)| edge(EdgeKind::Joint(i), j.parent, j.child))
        .chain(loops.map(|(i, l)| edge(EdgeKind::Loop(i), l.a, l.b)))
        .chain(contacts.map(|(i, c)| edge(EdgeKind::Contact(i), c.a, c.b)))
        .filter(|e| e.bodies[0] != e.bodies[1])
        .collect()
}

/// Sets that are merged: the index of each element's representative.
pub(super) struct Sets(Vec<usize>);

impl Sets {
    /// Each of `n` elements by itself.
    pub(super) fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    pub(super) fn of(&self, mut i: usize) -> usize {
        while self.0[i] != i {
            i = self.0[i];
        }
        i
    }

    pub(super) fn merge(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b);
    }
}

/// The limbs between the ground and the link of `platform`, in the order of their first joints.
pub(crate) fn limbs(mechanism: &Mechanism, platform: FrameId) -> Vec<LimbEdges> {
    let platform = mechanism.frame_of(platform).slot;
    if platform == 0 {
        return Vec::new();
    }
    let edges = edges(mechanism);
    let mut sets = Sets::new(edges.len());
    let mut first_at = vec![None; mechanism.nodes().len() + 1];
    let mut first_of = vec![None; mechanism.n()];
    for (i, edge) in edges.iter().enumerate() {
        let interior = edge.bodies.iter().filter(|b| **b != 0 && **b != platform);
        for &b in interior {
            sets.merge(i, *first_at[b].get_or_insert(i));
        }
        if let EdgeKind::Joint(j) = edge.kind {
            for c in mechanism.joints()[j].coordinates.clone() {
                sets.merge(i, *first_of[c].get_or_insert(i));
            }
        }
    }
    let mut all: Vec<LimbEdges> = Vec::new();
    for root in (0..edges.len()).filter(|&i| sets.of(i) == i) {
        let own: Vec<Edge> =
            (root..edges.len()).filter(|&i| sets.of(i) == root).map(|i| edges[i]).collect();
        let limb = LimbEdges::of(own, platform);
        if limb.touches(0) && limb.touches(platform) && !limb.is_free(mechanism) {
            all.push(limb);
        }
    }
    all
}

impl LimbEdges {
    fn of(mut edges: Vec<Edge>, platform: usize) -> Self {
        // A path is walked from the ground: each body has one way on.
        let mut at = 0;
        let mut path = Vec::new();
        let mut left = edges.clone();
        while at != platform {
            let mut on = left.iter().enumerate().filter(|(_, e)| e.bodies.contains(&at));
            let (Some((i, edge)), None) = (on.next(), on.next()) else { break };
            at = edge.bodies[usize::from(edge.bodies[0] == at)];
            path.push(*edge);
            left.remove(i);
        }
        let serial = at == platform && left.is_empty();
        if serial {
            edges = path;
        }
        Self { edges, platform, serial }
    }

    fn touches(&self, body: usize) -> bool {
        self.edges.iter().any(|e| e.bodies.contains(&body))
    }

    fn is_free(&self, mechanism: &Mechanism) -> bool {
        let [Edge { kind: EdgeKind::Joint(j), .. }] = self.edges[..] else { return false };
        let joint = &mechanism.joints()[j];
        joint.kind == JointKind::Free && !joint.actuated
    }

    /// The bodies of the limb, those that fixed loop joints connect as one: a weld is no place where
    /// motion is passed on.
    fn welded(&self, mechanism: &Mechanism) -> Sets {
        let mut welded = Sets::new(mechanism.nodes().len() + 1);
        for edge in self.edges.iter().filter(|e| e.is_fixed(mechanism)) {
            welded.merge(edge.bodies[0], edge.bodies[1]);
        }
        welded
    }

    /// Number of edges from the ground to a body, within the limb and not through the platform.
    fn distance(&self, welded: &Sets, body: usize) -> Option<usize> {
        let mut seen = vec![0];
        let mut next = VecDeque::from([(0, 0)]);
        while let Some((at, far)) = next.pop_front() {
            if at == body {
                return Some(far);
            }
            if at == welded.of(self.platform) {
                continue;
            }
            for edge in &self.edges {
                let bodies = edge.bodies.map(|b| welded.of(b));
                if !bodies.contains(&at) {
                    continue;
                }
                let other = bodies[usize::from(bodies[0] == at)];
                if !seen.contains(&other) {
                    seen.push(other);
                    next.push_back((other, far + 1));
                }
            }
        }
        None
    }

    /// The centre of the joints of the limb at the platform: the mean of their points.
    pub(crate) fn platform_point(&self, state: &State, near: Vec3) -> Vec3 {
        let welded = self.welded(state.mechanism());
        let at = welded.of(self.platform);
        self.mean_point(state, near, (&welded, at), None).unwrap_or(near)
    }

    /// The centre of the other joints of the link that the edge `of` moves: where it passes its
    /// motion on. `None` if the two links of the edge are equally far from the ground.
    pub(crate) fn transmission_point(
        &self,
        state: &State,
        near: Vec3,
        of: EdgeKind,
    ) -> Option<Vec3> {
        let welded = self.welded(state.mechanism());
        let edge = self.edges.iter().find(|e| e.kind == of)?;
        let [a, b] = edge.bodies.map(|b| welded.of(b));
        let (close, far) = match (self.distance(&welded, a)?, self.distance(&welded, b)?) {
            (x, y) if x < y => (a, b),
            (x, y) if x > y => (b, a),
            _ => return None,
        };
        let at = if far == welded.of(self.platform) { close } else { far };
        if at == 0 {
            return Some(edge.point(state, near, usize::from(far == b)));
        }
        self.mean_point(state, near, (&welded, at), Some(of))
    }

    fn mean_point(
        &self,
        state: &State,
        near: Vec3,
        (welded, body): (&Sets, usize),
        without: Option<EdgeKind>,
    ) -> Option<Vec3> {
        let point = |e: &Edge| {
            let side = e.bodies.iter().position(|&b| welded.of(b) == body)?;
            let other = Some(e.kind) != without && !e.is_fixed(state.mechanism());
            other.then(|| e.point(state, near, side))
        };
        let points: Vec<Vec3> = self.edges.iter().filter_map(point).collect();
        let sum = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        (!points.is_empty()).then(|| sum * (1.0 / points.len() as f64))
    }
}

impl Edge {
    /// True for a loop joint that is fixed; fixed joints of the tree are no edges.
    fn is_fixed(&self, mechanism: &Mechanism) -> bool {
        matches!(self.kind, EdgeKind::Loop(i) if mechanism.loops()[i].kind == JointKind::Fixed)
    }

    /// The point of a joint, on the side of its first body (0) or its second one: its centre; on an
    /// axis the point nearest to `near`; `near` itself for joints without either.
    fn point(&self, state: &State, near: Vec3, side: usize) -> Vec3 {
        let mechanism = state.mechanism();
        let first = side == 0;
        let pose = |link| state.link_pose(link);
        let sides = |a: Pose, b: Pose| if first { a } else { b };
        let (frame, kind, axis) = match self.kind {
            EdgeKind::Joint(i) => {
                let j = &mechanism.joints()[i];
                let child = pose(j.child) * j.joint_from_child.inverse();
                (sides(pose(j.parent) * j.parent_from_joint, child), j.kind, j.axis)
            }
            EdgeKind::Loop(i) => {
                let l = &mechanism.loops()[i];
                let (a, b) = (pose(l.a) * l.link_a_from_joint, pose(l.b) * l.link_b_from_joint);
                (sides(a, b), l.kind, l.axis)
            }
            EdgeKind::Contact(i) => {
                let c = &mechanism.contacts()[i];
                let (a, b) = (pose(c.a) * c.link_a_from_contact, pose(c.b) * c.link_b_from_contact);
                return sides(a, b).translation;
            }
        };
        let origin = frame.translation;
        match kind.locus() {
            JointLocus::Center => origin,
            JointLocus::Axis => {
                let axis = frame.rotation * axis;
                origin + axis * (axis.dot(near - origin) / axis.dot(axis))
            }
            JointLocus::Nowhere => near,
        }
    }
}
