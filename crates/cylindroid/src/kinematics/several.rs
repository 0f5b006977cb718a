//! Forward kinematics of a whole tree at several configurations side by side.
//!
//! Formula  forward.rs
//! Shapes   q: n numbers of lanes; frames: the ground and one for each node
//! Units    rad, m
//! Checked  tests/it/manipulability/batch.rs

use crate::model::{Motion, Node};
use crate::scalar::{Field, MOST_LANES, sin_cos};
use crate::spatial::{Columns, Padded, Pose, Rotation, Triple, Vec3};

/// `world_from_node` in every lane.
pub(crate) type Frame<R> = Columns<[R; 3]>;

/// Writes the pose of each node into `frames[1..]`, the ground into `frames[0]`.
#[inline(always)]
pub(crate) fn forward<R: Field>(nodes: &[Node], q: &[R], frames: &mut [Frame<R>]) {
    let k = R::splat;
    frames[0] = Frame::load(&Padded::IDENTITY);
    for (i, node) in nodes.iter().enumerate() {
        let base = frames[node.parent].then(&node.placement);
        let c = node.coordinate;
        frames[i + 1] = match node.motion {
            Motion::Fixed => base,
            Motion::Revolute | Motion::Prismatic | Motion::Helical(_) => {
                let x = q[c].times_plus(k(node.multiplier), k(node.offset));
                match node.motion {
                    Motion::Prismatic => base.slid(x),
                    Motion::Helical(pitch) => turned(base, x).slid(x * k(pitch)),
                    _ => turned(base, x),
                }
            }
            Motion::Spherical => moved(base, &[k(0.0); 3], &q[c..c + 3]),
            Motion::Free => moved(base, &q[c..c + 3], &q[c + 3..c + 6]),
        };
    }
}

#[inline(always)]
fn turned<R: Field>(base: Frame<R>, angle: R) -> Frame<R> {
    let (sin, cos) = sin_cos(angle);
    base.turned(sin, cos)
}

/// By a translation and a rotation vector in its own axes.
#[inline(always)]
fn moved<R: Field>(base: Frame<R>, by: &[R], turn: &[R]) -> Frame<R> {
    let turn = exponential(turn);
    Frame {
        x: base.seen_outside(turn.x),
        y: base.seen_outside(turn.y),
        z: base.seen_outside(turn.z),
        p: base.seen_outside([by[0], by[1], by[2]]).times_plus(R::splat(1.0), base.p),
    }
}

/// The rotation of a rotation vector, lane by lane as for one configuration.
#[inline(always)]
fn exponential<R: Field>(turn: &[R]) -> Frame<R> {
    let mut lanes = [[0.0; MOST_LANES]; 3];
    for (lanes, x) in lanes.iter_mut().zip(turn) {
        x.store(lanes);
    }
    let mut all = [Padded::IDENTITY; MOST_LANES];
    for (l, pose) in all.iter_mut().take(R::LANES).enumerate() {
        let vector = Vec3::new(lanes[0][l], lanes[1][l], lanes[2][l]);
        *pose = Pose::from_rotation(Rotation::exp(vector)).into();
    }
    let mut frame = Frame::load(&Padded::IDENTITY);
    for i in 0..3 {
        frame.x[i] = R::from_fn(|l| all[l].x[i]);
        frame.y[i] = R::from_fn(|l| all[l].y[i]);
        frame.z[i] = R::from_fn(|l| all[l].z[i]);
    }
    frame
}
