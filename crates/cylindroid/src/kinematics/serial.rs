//! Serial chains of revolute, prismatic and helical joints, in joint frames chosen for the least
//! arithmetic.
//!
//! Formula  world_from_tool = first * [Rz(turn q + angle) Tz(slide q) T(by) Rx(tilt)]_j ...
//!          Rz(last); columns [turn z x (p - o) + slide z; turn z], z and o an axis and a point on
//!          it
//! Shapes   one joint for each node but the last, which is the tool
//! Units    rad, m
//! Valid    any axes: common normals are not used, so nearly parallel axes are as accurate as
//!          others; fixed angles are added to joint angles, which costs the rounding of the sum:
//!          1e-11 at 1e5 rad
//! Why so   a joint frame may be rotated about its own axis. Each is rotated so that the next axis
//!          is tilted about x alone: 33 products for a joint instead of 48, fewer where the next
//!          axis is parallel; sine and cosine do not depend on the previous joint
//! Source   the ZXZ angles of each fixed placement; the outer two belong to the adjacent joints
//! Checked  tests/it/batch.rs::chains_agree_with_trees, tests/it/pinocchio.rs

use std::array::from_fn;

use super::forward::CHUNK;
use crate::model::{Node, NodeKind};
use crate::scalar::Simd;
use crate::spatial::{AlignedPose, Columns, Pose, Rotation, Vec3, Vector3Like};

/// A joint and the transform to the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SerialJoint {
    /// Place of its coordinate in the chain.
    pub(crate) coordinate: usize,
    /// Angle and length for each unit of the coordinate, and the angle at zero.
    turn: f64,
    slide: f64,
    angle: f64,
    by: [f64; 4],
    tilt: Tilt,
    /// Flags for the loops of kernels: the joint translates; the offset to the next joint has a y
    /// component; the angle is not the coordinate itself.
    slides: bool,
    aside: bool,
    scaled: bool,
}

/// The angles of [`CHUNK`] joints, 0 for missing ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Angles {
    coordinates: [usize; CHUNK],
    turns: [f64; CHUNK],
    angles: [f64; CHUNK],
}

impl Angles {
    fn of(joints: &[SerialJoint]) -> Self {
        let of = |k: usize, f: fn(&SerialJoint) -> f64| joints.get(k).map_or(0.0, f);
        Self {
            coordinates: from_fn(|k| joints.get(k).map_or(0, |j| j.coordinate)),
            turns: from_fn(|k| of(k, |j| j.turn)),
            angles: from_fn(|k| of(k, |j| j.angle)),
        }
    }

    /// Of joint k.
    #[inline(always)]
    pub(crate) fn at(&self, k: usize, q: &[f64]) -> f64 {
        q[self.coordinates[k]] * self.turns[k] + self.angles[k]
    }
}

/// The rotation about x from one joint axis to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tilt {
    /// Axes are parallel.
    None,
    /// By a right angle.
    RightAngle,
    By {
        sin: f64,
        cos: f64,
    },
}

/// The chain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Serial {
    first: AlignedPose,
    joints: Vec<SerialJoint>,
    angles: Vec<Angles>,
    /// Sine and cosine of the rotation of the tool about its own z axis; `None` where the angle of
    /// the last joint includes it.
    last: Option<[f64; 2]>,
    /// True if two joints have one coordinate.
    shared: bool,
}

impl Serial {
    /// The chain of these nodes, the tool last; `None` if it has other kinds of joints.
    pub(crate) fn of(nodes: &[Node]) -> Option<Self> {
        let (tool, moving) = nodes.split_last()?;
        // The tool is the last transform.
        if tool.kind != NodeKind::Fixed {
            return None;
        }
        let first = moving.first()?.placement;
        let mut joints: Vec<SerialJoint> = Vec::new();
        let mut carried = 0.0;
        for (i, node) in moving.iter().enumerate() {
            let m = node.multiplier;
            let (turn, slide, pitch) = match node.kind {
                NodeKind::Revolute => (m, 0.0, 0.0),
                NodeKind::Prismatic => (0.0, m, 1.0),
                NodeKind::Helical(pitch) => (m, pitch * m, pitch),
                NodeKind::Fixed | NodeKind::Spherical | NodeKind::Free => return None,
            };
            let turned = if turn == 0.0 { 0.0 } else { node.offset };
            let mut way = LinkTransform::of(nodes[i + 1].placement.pose());
            if i + 1 == moving.len() && way.tilt == Tilt::None {
                way.turn_before(); // no joint comes after
            }
            joints.push(SerialJoint {
                coordinate: node.coordinate,
                turn,
                slide,
                angle: turned + carried + way.before,
                by: [way.by.x, way.by.y, way.by.z + pitch * node.offset, 0.0],
                tilt: way.tilt,
                slides: slide != 0.0,
                aside: way.by.y != 0.0,
                scaled: turn != 1.0,
            });
            carried = way.after;
        }
        let mut coordinates: Vec<usize> = joints.iter().map(|j| j.coordinate).collect();
        coordinates.sort_unstable();
        let shared = coordinates.windows(2).any(|w| w[0] == w[1]);
        let angles = joints.chunks(CHUNK).map(Angles::of).collect();
        let last = (carried.abs() > f64::EPSILON).then(|| carried.sin_cos().into());
        Some(Self { first, joints, angles, last, shared })
    }

    /// The joints.
    pub(crate) fn joints(&self) -> &[SerialJoint] {
        &self.joints
    }

    /// The joints, [`CHUNK`] at a time, and their angles.
    #[inline(always)]
    pub(crate) fn chunks(&self) -> impl Iterator<Item = (&[SerialJoint], &Angles)> {
        self.joints.chunks(CHUNK).zip(&self.angles)
    }

    /// True if each of n coordinates has one joint: none where columns are zero or add.
    #[inline]
    pub(crate) fn has_one_for_each(&self, n: usize) -> bool {
        !self.shared && self.joints.len() == n
    }

    /// The frame of the first joint before it moves.
    #[inline(always)]
    pub(crate) fn start<T: Vector3Like>(&self) -> Columns<T> {
        Columns::load(&self.first)
    }

    /// The tool, from the frame after the last joint.
    #[inline(always)]
    pub(crate) fn end<T: Vector3Like>(&self, frame: Columns<T>) -> Columns<T> {
        let k = T::Scalar::splat;
        match self.last {
            Some([sin, cos]) => frame.rotated_z(k(sin), k(cos)),
            None => frame,
        }
    }
}

impl SerialJoint {
    /// Its angle at a coordinate.
    #[inline(always)]
    pub(crate) fn angle<R: Simd>(&self, q: R) -> R {
        // Rounded twice, as in `Angles::at`.
        q * R::splat(self.turn) + R::splat(self.angle)
    }

    /// Its frame after it has moved, its coordinate being q.
    #[inline(always)]
    pub(crate) fn after_joint<T: Vector3Like>(
        &self,
        frame: Columns<T>,
        sin: T::Scalar,
        cos: T::Scalar,
        q: T::Scalar,
    ) -> Columns<T> {
        let turned = frame.rotated_z(sin, cos);
        if self.slides { turned.translated_z(q * T::Scalar::splat(self.slide)) } else { turned }
    }

    /// The frame of the next joint before it moves.
    #[inline(always)]
    pub(crate) fn next_joint_frame<T: Vector3Like>(&self, frame: Columns<T>) -> Columns<T> {
        let there =
            if self.aside { frame.translated(&self.by) } else { frame.translated_xz(&self.by) };
        self.next_axis_frame(there)
    }

    /// The same frame with z along the axis of the next joint.
    #[inline(always)]
    pub(crate) fn next_axis_frame<T: Vector3Like>(&self, frame: Columns<T>) -> Columns<T> {
        let k = T::Scalar::splat;
        match self.tilt {
            Tilt::None => frame,
            Tilt::RightAngle => frame.rotated_x_90(),
            Tilt::By { sin, cos } => frame.rotated_x(k(sin), k(cos)),
        }
    }

    /// From its origin, before it translates, to that of the next joint; x and z are its axes after
    /// its rotation.
    #[inline(always)]
    pub(crate) fn link_offset<T: Vector3Like>(&self, x: T, z: T, q: T::Scalar) -> T {
        let k = T::Scalar::splat;
        let along = k(self.by[2]);
        let along = if self.slides { q.mul_add(k(self.slide), along) } else { along };
        let way = x.mul_add(k(self.by[0]), z.times(along));
        if self.aside { z.cross(x).mul_add(k(self.by[1]), way) } else { way }
    }

    /// Its Jacobian column: linear and angular part, for its axis and the lever from any point of
    /// the axis.
    #[inline(always)]
    pub(crate) fn column<T: Vector3Like>(&self, axis: T, lever: T) -> (T, T) {
        let k = T::Scalar::splat;
        let angular = if self.scaled { axis.times(k(self.turn)) } else { axis };
        let linear = angular.cross(lever);
        if self.slides { (axis.mul_add(k(self.slide), linear), angular) } else { (linear, angular) }
    }
}

/// A placement as Rz(before) T(by) Rx(tilt) Rz(after).
struct LinkTransform {
    before: f64,
    by: Vec3,
    tilt: Tilt,
    after: f64,
}

impl LinkTransform {
    fn of(placement: Pose) -> Self {
        let z = placement.rotation.matrix().cols[2];
        // Values below rounding are zero: parallel and perpendicular axes are intended.
        let clean = |x: f64| if x.abs() <= f64::EPSILON { 0.0 } else { x };
        let (sin, cos) = (clean(z.x.hypot(z.y)), clean(z.z));
        let before = if sin == 0.0 { 0.0 } else { z.x.atan2(-z.y) };
        let turn = Rotation::exp(Vec3::new(0.0, 0.0, before));
        let tilt = Rotation::exp(Vec3::new(sin.atan2(cos), 0.0, 0.0));
        let rest = ((turn * tilt).inverse() * placement.rotation).matrix().cols[0];
        Self {
            before,
            by: turn.inverse() * placement.translation,
            tilt: match (sin, cos) {
                (_, 0.0) => Tilt::RightAngle,
                (0.0, c) if c > 0.0 => Tilt::None,
                _ => Tilt::By { sin, cos },
            },
            after: rest.y.atan2(rest.x),
        }
    }

    /// Rotates before instead of after: the same where there is no tilt.
    fn turn_before(&mut self) {
        let turn = Rotation::exp(Vec3::new(0.0, 0.0, self.after));
        self.by = turn.inverse() * self.by;
        self.before += self.after;
        self.after = 0.0;
    }
}
