//! Bodies at their poses in the world, and the distances of pairs of them.
//!
//! Checked  tests/collision/laws.rs, tests/allocation/main.rs

use super::body::Body;
use super::convex::Placed;
use super::distance::separation;
use super::gjk::Gjk;
use crate::kinematics::State;
use crate::spatial::{Pose, Vec3};

/// Two shapes whose distance is watched: indices into
/// [`CollisionModel::bodies`](super::CollisionModel::bodies).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The first shape, always one of a link.
    pub a: usize,
    /// The second shape, of another link or an obstacle.
    pub b: usize,
}

/// A pair that is nearer than the margin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearPair {
    /// Its index in [`CollisionModel::pairs`](super::CollisionModel::pairs).
    pub pair: usize,
    /// Distance (m); negative: penetration depth.
    pub distance: f64,
    /// Closest point of a, in the world; in penetration the deepest one.
    pub point_a: Vec3,
    /// Closest point of b, in the world.
    pub point_b: Vec3,
    /// Unit normal from a to b, in the world: `point_b - point_a = distance * normal`.
    pub normal: Vec3,
    /// Index of the link of a.
    pub link_a: Option<usize>,
    /// Index of the link of b; `None` for an obstacle.
    pub link_b: Option<usize>,
}

/// Bodies, their pairs, and scratch memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Scene {
    pub(super) bodies: Vec<Body>,
    pub(super) pairs: Vec<Pair>,
    world_from_body: Vec<Pose>,
    bounds: Vec<f64>,
    gjk: Gjk,
}

impl Scene {
    pub(super) fn add(&mut self, body: Body) {
        self.bounds.push(body.bound());
        self.world_from_body.push(body.slot_from_body);
        self.bodies.push(body);
    }

    /// Removes a body and its pairs.
    pub(super) fn remove(&mut self, index: usize) {
        self.bodies.remove(index);
        self.bounds.remove(index);
        self.world_from_body.remove(index);
        self.pairs.retain(|p| p.a != index && p.b != index);
        for end in self.pairs.iter_mut().flat_map(|p| [&mut p.a, &mut p.b]) {
            *end -= usize::from(*end > index);
        }
    }

    /// Moves all bodies to a configuration.
    pub(super) fn place(&mut self, state: &State) {
        for (body, pose) in self.bodies.iter().zip(&mut self.world_from_body) {
            *pose = state.slots()[body.slot].pose() * body.slot_from_body;
        }
    }

    /// A lower bound of the distance of a pair, from the balls around its bodies.
    #[inline]
    pub(super) fn gap_between_bounds(&self, pair: usize) -> f64 {
        let Pair { a, b } = self.pairs[pair];
        let apart = self.world_from_body[b].translation - self.world_from_body[a].translation;
        apart.norm() - self.bounds[a] - self.bounds[b]
    }

    /// The distance of a pair; `None` where it is beyond what numbers can represent.
    #[inline]
    pub(super) fn evaluate(&mut self, pair: usize) -> Option<NearPair> {
        let Pair { a, b } = self.pairs[pair];
        let placed = |i: usize| Placed {
            shape: &self.bodies[i].convex,
            world_from_shape: &self.world_from_body[i],
        };
        let (first, second) = (placed(a), placed(b));
        let apart = second.world_from_shape.translation - first.world_from_shape.translation;
        if !apart.norm().is_finite() {
            return None;
        }
        let found = separation(first, second, &mut self.gjk);
        Some(NearPair {
            pair,
            distance: found.distance,
            point_a: found.point_a,
            point_b: found.point_b,
            normal: found.normal,
            link_a: self.bodies[a].link,
            link_b: self.bodies[b].link,
        })
    }
}
