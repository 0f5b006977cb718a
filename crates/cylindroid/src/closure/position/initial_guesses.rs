//! Initial guesses: random restarts for assembly, reproducible on every run.
//!
//! Units    distances have none: lengths are divided by the characteristic length
//! Valid    any mechanism; guesses respect position limits, their loops are open. Random numbers
//!          belong to the names of the coordinates, and rotations to axes of the mechanism, so that
//!          neither the order of the joints nor the frame changes them
//! Source   Shoemake 1992 for rotations
//! Checked  tests/it/closure/modes.rs, tests/it/closure/diagnosis.rs

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use super::coordinates::{moved, within_limits};
use crate::model::{CoordinateKind, JointKind, Mechanism};
use crate::scalar::{fnv1a, uniform};
use crate::spatial::{Mat3, Pose, Quaternion, Rotation, Vec3};
use crate::tolerance::COMMON_POINT;

/// Sine of the angle between two directions that define axes [-].
const NOT_PARALLEL: f64 = 0.1;

/// `q` with a random perturbation of every coordinate by up to `amplitude`.
pub(crate) fn perturbed(mechanism: &Mechanism, q: &[f64], amplitude: f64, number: u64) -> Vec<f64> {
    let all: Vec<usize> = (0..mechanism.n()).collect();
    let names = mechanism.coordinates().iter().map(|c| &c.name);
    let change: Vec<f64> = names.map(|name| amplitude * by_name(name, number)).collect();
    within_limits(mechanism, moved(mechanism, q, &all, &change), &all)
}

/// A random configuration within the limits: angles uniform in (-pi, pi], lengths up to the
/// characteristic length, rotations uniform. The random numbers belong to the names of the
/// coordinates, and rotations and positions are drawn in axes of the mechanism's own. `restart`:
/// the seed of the search and the number of the restart.
pub(crate) fn random(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    restart: [u64; 2],
) -> Vec<f64> {
    let number = restart[0].wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(restart[1]);
    let coordinates = mechanism.coordinates();
    let share = |i: usize| 0.5 + 0.5 * by_name(&coordinates[i].name, number);
    let mut q = guess.to_vec();
    for &i in free {
        let coordinate = &coordinates[i];
        let span = match coordinate.kind {
            CoordinateKind::Angle => PI,
            CoordinateKind::Length | CoordinateKind::Position => mechanism.reach(),
            CoordinateKind::RotationVector => continue,
        };
        // Limits wider than one turn are cut to one turn.
        let l = &coordinate.limits;
        let lower = l.lower.max((-span).min(l.upper - 2.0 * span));
        let upper = l.upper.min(span.max(l.lower + 2.0 * span));
        q[i] = upper - (upper - lower) * share(i);
    }
    let links = mechanism.link_poses(mechanism.home());
    let own = own_axes(mechanism, &links);
    for joint in mechanism.joints().iter().filter(|j| j.mimic.is_none()) {
        let from = joint.coordinates.start;
        let (position, rotation) = match joint.kind {
            JointKind::Spherical => (None, from),
            JointKind::Free => (Some(from), from + 3),
            _ => continue,
        };
        let world_from_joint = (links[joint.parent] * joint.parent_from_joint).rotation;
        let joint_from_own = world_from_joint.inverse() * own;
        if let Some(at) = position.filter(|at| free.contains(at)) {
            let drawn = joint_from_own * Vec3::new(q[at], q[at + 1], q[at + 2]);
            q[at..at + 3].copy_from_slice(&drawn.to_array());
        }
        if free.contains(&rotation) {
            let drawn = uniform_rotation([0, 1, 2].map(|k| share(rotation + k)));
            q[rotation..rotation + 3].copy_from_slice(&(joint_from_own * drawn).to_array());
        }
    }
    q
}

/// Axes that move with the mechanism: the first two directions, by the names of the joints, that
/// are not parallel; of axes, or, if all are parallel, of the lines between the joints.
fn own_axes(mechanism: &Mechanism, links: &[Pose]) -> Rotation {
    use JointKind::{Fixed, Free, Spherical, Universal};
    let tree = mechanism.joints().iter().map(|j| {
        let frame = links[j.parent] * j.parent_from_joint;
        (&j.name, (frame, j.kind, j.axis))
    });
    let loops = mechanism.loops().iter().map(|l| {
        let frame = links[l.a] * l.link_a_from_joint;
        (&l.name, (frame, l.kind, l.axis))
    });
    let joints: BTreeMap<&String, (Pose, JointKind, Vec3)> = tree.chain(loops).collect();
    let first = joints.values().next().map_or(Vec3::ZERO, |(frame, ..)| frame.translation);
    let axes = joints
        .values()
        .filter(|(_, kind, _)| !matches!(kind, Spherical | Universal { .. } | Free | Fixed))
        .map(|(frame, _, axis)| frame.rotation * *axis);
    let lines = joints.values().filter_map(|(frame, ..)| {
        (frame.translation - first).unit(COMMON_POINT * mechanism.reach())
    });
    let mut z = None;
    for direction in axes.chain(lines) {
        let Some(z) = z else {
            z = Some(direction);
            continue;
        };
        if let Some(y) = z.cross(direction).unit(NOT_PARALLEL) {
            let x = y.cross(z);
            return Rotation::assume(Mat3::from_cols(x, y, z));
        }
    }
    z.and_then(Rotation::z_to).unwrap_or(Rotation::IDENTITY)
}

/// A uniformly distributed rotation, as a rotation vector, from three numbers uniform in
/// (0, 1) (Shoemake 1992).
fn uniform_rotation([share, a, b]: [f64; 3]) -> Vec3 {
    let (a, b) = (TAU * a, TAU * b);
    let (first, second) = ((1.0 - share).sqrt(), share.sqrt());
    let quaternion = Quaternion {
        w: first * a.cos(),
        x: first * a.sin(),
        y: second * b.cos(),
        z: second * b.sin(),
    };
    quaternion.rotation().map_or(Vec3::ZERO, Rotation::log)
}

/// A random number in (-1, 1) that belongs to a name.
pub(crate) fn by_name(name: &str, number: u64) -> f64 {
    let mut seed = fnv1a(name.bytes()) ^ number.wrapping_mul(0x9e37);
    2.0 * uniform(&mut seed) - 1.0
}
