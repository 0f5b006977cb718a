//! Forward kinematics: the pose of every moving frame, parents first.
//!
//! Formula  world_from_node = world_from_parent * placement * motion(multiplier q + offset),
//!          motion: Rz(x); translation x along z; both (helical); exp of a rotation vector; free
//! Shapes   `slots` holds the ground and one pose for each node
//! Units    rad, m
//! Why so   joints turn about their own z axis, so a turn mixes two columns (12 products) where a
//!          general rotation would take 27
//! Checked  tests/it/pinocchio.rs, tests/it/kinematics.rs

use crate::model::{Motion, Node};
use crate::scalar::sin_cos;
use crate::spatial::{Mat3, Pose, Rotation, Vec3};

/// Writes the pose of each node into `slots[1..]`; `slots[0]` is the ground and stays.
#[inline]
pub(crate) fn forward(nodes: &[Node], q: &[f64], slots: &mut [Pose]) {
    for (i, node) in nodes.iter().enumerate() {
        let base = slots[node.parent] * node.placement;
        let x = q[node.coordinate] * node.multiplier + node.offset;
        slots[i + 1] = match node.motion {
            Motion::Revolute => turned(base, x),
            Motion::Prismatic => slid(base, x),
            Motion::Helical(pitch) => slid(turned(base, x), pitch * x),
            Motion::Spherical => {
                base * Pose::from_rotation(Rotation::exp(three(q, node.coordinate)))
            }
            Motion::Free => {
                base * Pose {
                    rotation: Rotation::exp(three(q, node.coordinate + 3)),
                    translation: three(q, node.coordinate),
                }
            }
        };
    }
}

#[inline]
fn turned(base: Pose, angle: f64) -> Pose {
    let (s, c) = sin_cos(angle);
    let [x, y, z] = base.rotation.matrix().cols;
    Pose {
        rotation: Rotation::assume(Mat3::from_cols(x * c + y * s, y * c - x * s, z)),
        translation: base.translation,
    }
}

#[inline]
fn slid(base: Pose, length: f64) -> Pose {
    Pose { translation: base.translation + base.rotation.z_axis() * length, ..base }
}

fn three(q: &[f64], i: usize) -> Vec3 {
    Vec3::new(q[i], q[i + 1], q[i + 2])
}
