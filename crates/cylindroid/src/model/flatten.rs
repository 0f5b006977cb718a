//! Flattening: the joints of a mechanism become nodes, coordinates and frames.
//!
//! Checked  tests/it/graph.rs, tests/it/pinocchio.rs

use std::collections::BTreeMap;

use super::joint::{JointKind, Limits};
use super::joint_spec::JointSpec;
use super::mechanism::{Coordinate, CoordinateKind, Frame};
use super::node::{Node, NodeKind};
use crate::spatial::{Pose, Rotation, Vec3};

/// The nodes and coordinates written so far, and the links placed on them.
pub(super) struct FlatMechanism {
    pub(super) nodes: Vec<Node>,
    pub(super) coordinates: Vec<Coordinate>,
    /// Coordinates of each joint (index of the specification).
    pub(super) ranges: BTreeMap<usize, std::ops::Range<usize>>,
    /// Slot of each link, and its pose in the slot.
    slots: Vec<(usize, Pose)>,
}

impl FlatMechanism {
    pub(super) fn new(links: usize) -> Self {
        Self {
            nodes: Vec::new(),
            coordinates: Vec::new(),
            ranges: BTreeMap::new(),
            slots: vec![(0, Pose::IDENTITY); links],
        }
    }

    pub(super) fn place(&mut self, link: usize, slot: usize, slot_from_link: Pose) {
        self.slots[link] = (slot, slot_from_link);
    }

    pub(super) fn frame(&self, name: String, link: usize, link_from_frame: Pose) -> Frame {
        let (slot, slot_from_link) = self.slots[link];
        Frame {
            name,
            link,
            link_from_frame,
            slot,
            slot_from_frame: slot_from_link * link_from_frame,
        }
    }

    pub(super) fn allocate(&mut self, j: usize, spec: &JointSpec) {
        use CoordinateKind::{Angle, Length, Position, RotationVector};
        let start = self.coordinates.len();
        let position = if spec.reversed { Length } else { Position };
        let free = [
            (".x", position),
            (".y", position),
            (".z", position),
            (".rx", RotationVector),
            (".ry", RotationVector),
            (".rz", RotationVector),
        ];
        let parts: &[(&str, CoordinateKind)] = match spec.kind {
            JointKind::Fixed => &[],
            JointKind::Revolute | JointKind::Continuous | JointKind::Helical { .. } => {
                &[("", Angle)]
            }
            JointKind::Prismatic => &[("", Length)],
            JointKind::Cylindrical => &[(".slide", Length), (".turn", Angle)],
            JointKind::Universal { .. } => &[(".first", Angle), (".second", Angle)],
            JointKind::Spherical => {
                &[(".rx", RotationVector), (".ry", RotationVector), (".rz", RotationVector)]
            }
            JointKind::Planar => &[(".x", Length), (".y", Length), (".angle", Angle)],
            JointKind::Free => &free,
        };
        for (suffix, kind) in parts {
            self.coordinates.push(Coordinate {
                name: format!("{}{suffix}", spec.name),
                joint: j,
                kind: *kind,
                limits: spec.limits,
                actuated: spec.actuated,
            });
        }
        self.ranges.insert(j, start..self.coordinates.len());
    }

    /// Narrows the limits of coordinate `c` by those of a joint that follows it; true (and nothing
    /// narrowed) if no position would be left.
    pub(super) fn count_mimic_limits(
        &mut self,
        c: usize,
        spec: &JointSpec,
        multiplier: f64,
        offset: f64,
    ) -> bool {
        if multiplier == 0.0 {
            return false;
        }
        let own = &mut self.coordinates[c].limits;
        let (a, b) =
            ((spec.limits.lower - offset) / multiplier, (spec.limits.upper - offset) / multiplier);
        let narrowed =
            Limits { lower: own.lower.max(a.min(b)), upper: own.upper.min(a.max(b)), ..*own };
        let clash = !narrowed.permit_a_position();
        if !clash {
            *own = narrowed;
        }
        own.velocity = own.velocity.min(spec.limits.velocity / multiplier.abs());
        own.acceleration = own.acceleration.min(spec.limits.acceleration / multiplier.abs());
        own.jerk = own.jerk.min(spec.limits.jerk / multiplier.abs());
        clash
    }

    pub(super) fn connect(
        &mut self,
        j: usize,
        spec: &JointSpec,
        parent: usize,
        child: usize,
        mimic: Option<(usize, f64, f64)>,
    ) {
        let (slot, slot_from_parent) = self.slots[parent];
        let base = slot_from_parent * spec.parent_from_joint;
        let (of, multiplier, offset) = mimic.unwrap_or((j, 1.0, 0.0));
        let range = self.ranges.get(&of).cloned().unwrap_or(0..0);
        if mimic.is_some() {
            self.ranges.insert(j, range.clone());
        }
        let mut chain = NodeChain {
            nodes: &mut self.nodes,
            slot,
            pending: base,
            first: range.start,
            multiplier,
            offset,
        };
        chain.joint(spec);
        let (slot, slot_from_child) = (chain.slot, chain.pending);
        self.place(child, slot, slot_from_child * spec.joint_from_child);
    }
}

/// Writes the nodes of one joint in sequence.
struct NodeChain<'a> {
    nodes: &'a mut Vec<Node>,
    slot: usize,
    /// The joint frame at zero, in the slot.
    pending: Pose,
    /// The first coordinate of the joint.
    first: usize,
    multiplier: f64,
    offset: f64,
}

impl NodeChain<'_> {
    /// The inverse of a product of motions is the product of their inverses, in reverse order, each
    /// about (or along) the opposite axis.
    fn joint(&mut self, spec: &JointSpec) {
        use NodeKind::{Helical, Prismatic, Revolute, Spherical};
        let along = if spec.reversed { -1.0 } else { 1.0 };
        // Axes have been validated.
        let z_to = |axis: Vec3| Rotation::z_to(axis * along).unwrap_or(Rotation::IDENTITY);
        let axis = z_to(spec.axis);
        let plane = Rotation::z_to(spec.axis).unwrap_or(Rotation::IDENTITY);
        let in_plane = |direction: Vec3| plane * z_to(direction);
        let motions = match spec.kind {
            JointKind::Fixed => vec![],
            JointKind::Revolute | JointKind::Continuous => vec![(axis, Revolute)],
            JointKind::Prismatic => vec![(axis, Prismatic)],
            JointKind::Helical { pitch } => vec![(axis, Helical(pitch))],
            JointKind::Cylindrical => vec![(axis, Prismatic), (axis, Revolute)],
            JointKind::Universal { second } => vec![(axis, Revolute), (z_to(second), Revolute)],
            JointKind::Planar => vec![
                (in_plane(Vec3::X), Prismatic),
                (in_plane(Vec3::Y), Prismatic),
                (axis, Revolute),
            ],
            JointKind::Spherical => vec![(Rotation::IDENTITY, Spherical)],
            JointKind::Free if spec.reversed => vec![
                (z_to(Vec3::X), Prismatic),
                (z_to(Vec3::Y), Prismatic),
                (z_to(Vec3::Z), Prismatic),
                (Rotation::IDENTITY, Spherical),
            ],
            JointKind::Free => vec![(Rotation::IDENTITY, NodeKind::Free)],
        };
        let mut next = self.first;
        let mut numbered = Vec::with_capacity(motions.len());
        for (joint_from_z, kind) in motions {
            numbered.push((joint_from_z, kind, next));
            next += kind.dof();
        }
        if spec.reversed {
            numbered.reverse();
        }
        for (joint_from_z, kind, coordinate) in numbered {
            // A rotation vector has no axis that could be reversed.
            let sign = if kind == Spherical { along } else { 1.0 };
            self.push(joint_from_z, kind, coordinate, sign);
        }
    }

    /// Adds a node whose z axis is `joint_from_z * z` in the joint frame.
    fn push(&mut self, joint_from_z: Rotation, kind: NodeKind, coordinate: usize, sign: f64) {
        let turn = Pose::from_rotation(joint_from_z);
        self.nodes.push(Node {
            parent: self.slot,
            placement: (self.pending * turn).into(),
            kind,
            coordinate,
            multiplier: sign * self.multiplier,
            offset: self.offset,
        });
        self.slot = self.nodes.len();
        self.pending = turn.inverse();
    }
}
