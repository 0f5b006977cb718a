//! Forward kinematics of a tree: the pose of every moving frame, parents first.
//!
//! Formula  world_from_node = world_from_parent * placement * motion(multiplier q + offset),
//!          motion: Rz(x); translation x along z; both (helical); exp of a rotation vector (times
//!          the multiplier); free
//! Shapes   `slots` holds the ground and one pose for each node
//! Units    rad, m
//! Why so   joints rotate about their own z axis, so a rotation mixes two columns (12 products)
//!          where a general one would take 27; columns are padded to four numbers, one register of
//!          today's processors, and compiled twice: baseline and AVX2 with fused multiplication
//! Checked  tests::fused_and_plain_agree, tests/it/pinocchio.rs, tests/it/kinematics.rs

use crate::model::{Node, NodeKind};
#[cfg(target_arch = "x86_64")]
use crate::scalar::Avx2;
use crate::scalar::{Simd, sin_cos};
#[cfg(target_arch = "x86_64")]
use crate::spatial::PackedVec3;
use crate::spatial::{AlignedPose, Columns, Pose, Rotation, SingleVector3, Vec3};

/// Number of angles processed at once.
pub(super) const CHUNK: usize = 8;

/// Sines and cosines of several angles, one in each lane.
#[inline(always)]
pub(super) fn sines<W: Simd>(angle: impl Fn(usize) -> f64) -> ([f64; CHUNK], [f64; CHUNK]) {
    let (mut sin, mut cos) = ([0.0; CHUNK], [0.0; CHUNK]);
    for i in (0..CHUNK).step_by(W::LANES) {
        let (s, c) = sin_cos(W::from_fn(|l| angle(i + l)));
        s.store(&mut sin[i..]);
        c.store(&mut cos[i..]);
    }
    (sin, cos)
}

/// Writes the pose of each node into `slots[1..]`; `slots[0]` is the ground and stays.
#[inline]
pub(crate) fn forward(nodes: &[Node], q: &[f64], slots: &mut [AlignedPose]) {
    #[cfg(target_arch = "x86_64")]
    if let Some(cpu) = Avx2::detect() {
        #[allow(unsafe_code)] // the one way to call a function compiled for more than the baseline
        // SAFETY: the token proves that the processor has both features.
        unsafe {
            forward_avx2(cpu, nodes, q, slots);
        }
        return;
    }
    forward_with::<[f64; 3]>((), nodes, q, slots);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn forward_avx2(cpu: Avx2, nodes: &[Node], q: &[f64], slots: &mut [AlignedPose]) {
    forward_with::<PackedVec3>(cpu, nodes, q, slots);
}

/// The kernel; with fused products results differ in the last digits.
#[inline(always)]
fn forward_with<T: SingleVector3>(_: T::Cpu, nodes: &[Node], q: &[f64], slots: &mut [AlignedPose]) {
    for (chunk, nodes) in nodes.chunks(CHUNK).enumerate() {
        // All angles first: they are independent, four to a register.
        let mut x = [0.0; CHUNK];
        for (x, node) in x.iter_mut().zip(nodes) {
            *x = q[node.coordinate] * node.multiplier + node.offset;
        }
        let (sin, cos) = sines::<T::Wide>(|k| x[k]);
        for (k, node) in nodes.iter().enumerate() {
            let base = Columns::<T>::load(&slots[node.parent]).then(&node.placement);
            let moved = match node.kind {
                NodeKind::Revolute => base.rotated_z(sin[k], cos[k]),
                NodeKind::Prismatic => base.translated_z(x[k]),
                NodeKind::Fixed => base,
                NodeKind::Helical(pitch) => {
                    base.rotated_z(sin[k], cos[k]).translated_z(pitch * x[k])
                }
                NodeKind::Spherical => {
                    let vector = three(q, node.coordinate) * node.multiplier;
                    base.then(&Pose::from_rotation(Rotation::exp(vector)).into())
                }
                NodeKind::Free => {
                    let free = Pose {
                        rotation: Rotation::exp(three(q, node.coordinate + 3)),
                        translation: three(q, node.coordinate),
                    };
                    base.then(&free.into())
                }
            };
            moved.store(&mut slots[chunk * CHUNK + k + 1]);
        }
    }
}

fn three(q: &[f64], i: usize) -> Vec3 {
    Vec3::new(q[i], q[i + 1], q[i + 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two forms of the kernel agree to rounding: the plain one is the specification.
    #[test]
    fn fused_and_plain_agree() {
        let mut nodes = Vec::new();
        for (i, kind) in [
            NodeKind::Revolute,
            NodeKind::Prismatic,
            NodeKind::Helical(0.1),
            NodeKind::Spherical,
            NodeKind::Free,
            NodeKind::Revolute,
            NodeKind::Fixed,
            NodeKind::Revolute,
            NodeKind::Revolute,
        ]
        .into_iter()
        .enumerate()
        {
            let x = 0.3 + i as f64;
            let placement = Pose {
                rotation: Rotation::exp(Vec3::new(x, -0.2 * x, 1.0)),
                translation: Vec3::new(0.1, x, -0.4),
            };
            nodes.push(Node {
                parent: i,
                placement: placement.into(),
                kind,
                coordinate: [0, 1, 2, 3, 6, 12, 0, 11, 0][i],
                multiplier: 1.5,
                offset: 0.1,
            });
        }
        let q: Vec<f64> = (0..13).map(|i| 0.17 * f64::from(i) - 0.9).collect();
        let mut plain = vec![AlignedPose::IDENTITY; 10];
        let mut fused = plain.clone();
        forward_with::<[f64; 3]>((), &nodes, &q, &mut plain);
        forward(&nodes, &q, &mut fused);
        for (a, b) in plain.iter().zip(&fused) {
            let (a, b) = (a.pose().to_matrix(), b.pose().to_matrix());
            for (x, y) in a.as_flattened().iter().zip(b.as_flattened()) {
                assert!((x - y).abs() < 1e-14, "{a:?} and {b:?}");
            }
        }
    }
}
