//! Batched forward kinematics of a whole tree, with one configuration in each SIMD lane.
//!
//! Formula  forward.rs
//! Shapes   q: n numbers of lanes; frames: the ground and one for each node
//! Units    rad, m
//! Checked  tests/it/manipulability/batch.rs

use crate::model::{Node, NodeKind};
use crate::scalar::{MAX_LANES, SimdFloat, sin_cos};
use crate::spatial::{AlignedPose, Columns, Pose, Rotation, Vec3, Vector3Like};

/// `world_from_node` in every lane.
pub(crate) type Frame<R> = Columns<[R; 3]>;

/// Writes the pose of each node into `frames[1..]`, the ground into `frames[0]`.
#[inline(always)]
pub(crate) fn forward<R: SimdFloat>(nodes: &[Node], q: &[R], frames: &mut [Frame<R>]) {
    let k = R::splat;
    frames[0] = Frame::load(&AlignedPose::IDENTITY);
    for (i, node) in nodes.iter().enumerate() {
        let base = frames[node.parent].then(&node.placement);
        let c = node.coordinate;
        frames[i + 1] = match node.kind {
            NodeKind::Fixed => base,
            NodeKind::Revolute | NodeKind::Prismatic | NodeKind::Helical(_) => {
                let x = q[c].mul_add(k(node.multiplier), k(node.offset));
                match node.kind {
                    NodeKind::Prismatic => base.translated_z(x),
                    NodeKind::Helical(pitch) => turned(base, x).translated_z(x * k(pitch)),
                    _ => turned(base, x),
                }
            }
            NodeKind::Spherical => {
                let vector = [0, 1, 2].map(|i| q[c + i] * k(node.multiplier));
                moved(base, &[k(0.0); 3], &vector)
            }
            NodeKind::Free => moved(base, &q[c..c + 3], &q[c + 3..c + 6]),
        };
    }
}

#[inline(always)]
fn turned<R: SimdFloat>(base: Frame<R>, angle: R) -> Frame<R> {
    let (sin, cos) = sin_cos(angle);
    base.rotated_z(sin, cos)
}

/// By a translation and a rotation vector in its own axes.
#[inline(always)]
fn moved<R: SimdFloat>(base: Frame<R>, by: &[R], turn: &[R]) -> Frame<R> {
    let turn = exponential(turn);
    Frame {
        x: base.transform_vector(turn.x),
        y: base.transform_vector(turn.y),
        z: base.transform_vector(turn.z),
        p: base.transform_vector([by[0], by[1], by[2]]).mul_add(R::splat(1.0), base.p),
    }
}

/// The rotation of a rotation vector, lane by lane as for one configuration.
#[inline(always)]
fn exponential<R: SimdFloat>(turn: &[R]) -> Frame<R> {
    let mut lanes = [[0.0; MAX_LANES]; 3];
    for (lanes, x) in lanes.iter_mut().zip(turn) {
        x.store(lanes);
    }
    let mut all = [AlignedPose::IDENTITY; MAX_LANES];
    for (l, pose) in all.iter_mut().take(R::LANES).enumerate() {
        let vector = Vec3::new(lanes[0][l], lanes[1][l], lanes[2][l]);
        *pose = Pose::from_rotation(Rotation::exp(vector)).into();
    }
    let mut frame = Frame::load(&AlignedPose::IDENTITY);
    for i in 0..3 {
        frame.x[i] = R::from_fn(|l| all[l].x[i]);
        frame.y[i] = R::from_fn(|l| all[l].y[i]);
        frame.z[i] = R::from_fn(|l| all[l].z[i]);
    }
    frame
}
