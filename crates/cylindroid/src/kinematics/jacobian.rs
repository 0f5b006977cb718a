//! The geometric Jacobian of a frame, assembled by velocity conversion, and its time derivative.
//!
//! Formula  twist of the frame = J * joint velocities. Joint j moves its own frame by a constant
//!          twist S_j (rotation about z, translation along z, both); column j is S_j converted to
//!          the reference frame: [z x (p - t); z] for the rotation, [z; 0] for the translation,
//!          [z x (p - t) + h z; z] for a helix,
//!          z and t the joint's axis and origin in world, p the reference point
//!          dJ/dt: J_i(world) is carried by its body, so dJ_i = ad(V_i) J_i with V_i the twist of
//!          that body; moving the point p adds w_i x dp/dt; the local frame adds -ad(V_tool) J_i
//! Shapes   6 x n, linear rows first
//! Units    m/s and rad/s for each unit of joint velocity
//! Frame    [`ReferenceFrame`] names point and axes;
//!          relative to a frame that moves: the difference of both at one point
//! Why so   one pass from the tip to the root, only over the joints that move the frame; a mimic
//!          joint adds its multiplier times its column to the joint that it follows
//! Source   velocity conversion matrices of Cartesian control (columns 6 and 3 of V_j)
//! Checked  tests/it/pinocchio.rs, tests/it/kinematics.rs::jacobian_is_assembled_by_conversion,
//!          ::jacobian_dot_*, tests/it/relative_jacobian.rs

use crate::linalg::Matrix;
use crate::model::{Node, NodeKind};
use crate::spatial::{AlignedPose, Pose, Twist, Vec3};

/// The reference frame of a twist or a Jacobian: its point and its axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReferenceFrame {
    /// Point: the frame's origin. Axes: the frame's.
    Local,
    /// Point: the world's origin (of the moving body, extended). Axes: the world's.
    World,
    /// Point: the frame's origin. Axes: the world's.
    LocalWorldAligned,
}

impl ReferenceFrame {
    /// All of them, with the names used in files and on the command line.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("local", Self::Local),
        ("world", Self::World),
        ("local_world_aligned", Self::LocalWorldAligned),
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::World => "world",
            Self::LocalWorldAligned => "local_world_aligned",
        }
    }
}

/// A frame at the end of a tree of nodes whose poses are known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tip<'a> {
    pub(crate) nodes: &'a [Node],
    pub(crate) slots: &'a [AlignedPose],
    pub(crate) slot: usize,
    pub(crate) world_from_tip: Pose,
}

impl Tip<'_> {
    /// Calls `f(depth, coordinate, twist)` for each unit coordinate rate that moves the tip, from
    /// the tip to the root; the twist in world axes at the point `p`. Coordinates of one node
    /// share a depth; a larger depth is nearer the root.
    #[inline]
    pub(crate) fn for_each_column(&self, p: Vec3, f: impl FnMut(usize, usize, Twist)) {
        self.for_each_column_above(0, p, f);
    }

    /// [`Tip::for_each_column`] up to the slot `end` on the way to the root, whose own joints are
    /// left out.
    #[inline]
    pub(crate) fn for_each_column_above(
        &self,
        end: usize,
        p: Vec3,
        mut f: impl FnMut(usize, usize, Twist),
    ) {
        let mut slot = self.slot;
        let mut depth = 0;
        while slot > end {
            let node = &self.nodes[slot - 1];
            let here = &self.slots[slot];
            let z = here.z_axis();
            let arm = p - here.translation();
            let turn = |axis: Vec3| Twist { linear: axis.cross(arm), angular: axis };
            let slide = |axis: Vec3| Twist { linear: axis, angular: Vec3::ZERO };
            let c = node.coordinate;
            match node.kind {
                NodeKind::Fixed => {}
                NodeKind::Revolute => f(depth, c, turn(z) * node.multiplier),
                NodeKind::Prismatic => f(depth, c, slide(z) * node.multiplier),
                NodeKind::Helical(pitch) => {
                    f(depth, c, (turn(z) + slide(z * pitch)) * node.multiplier);
                }
                NodeKind::Spherical => {
                    let turn = |axis| turn(axis) * node.multiplier;
                    here.axes().iter().enumerate().for_each(|(k, &a)| f(depth, c + k, turn(a)));
                }
                NodeKind::Free => {
                    here.axes().iter().enumerate().for_each(|(k, &a)| f(depth, c + k, slide(a)));
                    here.axes().iter().enumerate().for_each(|(k, &a)| f(depth, c + 3 + k, turn(a)));
                }
            }
            slot = node.parent;
            depth += 1;
        }
    }

    /// The last slot that the paths of two tips to the root share.
    pub(crate) fn common_slot(&self, other: &Self) -> usize {
        let (mut a, mut b) = (self.slot, other.slot);
        while a != b {
            // A parent has a smaller slot than its children.
            let later = if a > b { &mut a } else { &mut b };
            *later = self.nodes[*later - 1].parent;
        }
        a
    }

    /// The Jacobian over n coordinates, 6 x n.
    pub(crate) fn jacobian(&self, reference: ReferenceFrame, n: usize) -> Matrix {
        let mut out = Matrix::zeros(6, n);
        self.jacobian_into(reference, &mut out);
        out
    }

    /// The Jacobian, into `out` (6 x n).
    #[inline]
    pub(crate) fn jacobian_into(&self, reference: ReferenceFrame, out: &mut Matrix) {
        out.as_mut_slice().fill(0.0);
        let p = match reference {
            ReferenceFrame::World => Vec3::ZERO,
            ReferenceFrame::Local | ReferenceFrame::LocalWorldAligned => {
                self.world_from_tip.translation
            }
        };
        let rotation = self.world_from_tip.rotation.matrix();
        if reference == ReferenceFrame::Local {
            self.for_each_column(p, |_, c, t| {
                let local = Twist {
                    linear: rotation.tr_mul(t.linear),
                    angular: rotation.tr_mul(t.angular),
                };
                add(out.column_mut(c), local);
            });
        } else {
            self.for_each_column(p, |_, c, t| add(out.column_mut(c), t));
        }
    }

    /// The Jacobian of this tip relative to another frame of the same tree, which may move: the twist
    /// of the tip as seen from `base`, its point the tip's origin, its axes those of `base`.
    ///
    /// ```text
    /// J = R_base^T (J_tip - J_base, both at the point of the tip)
    /// ```
    pub(crate) fn relative_jacobian_into(&self, base: &Self, out: &mut Matrix) {
        out.as_mut_slice().fill(0.0);
        let (p, axes) = (self.world_from_tip.translation, base.world_from_tip.rotation.matrix());
        let seen =
            |t: Twist| Twist { linear: axes.tr_mul(t.linear), angular: axes.tr_mul(t.angular) };
        // Joints that carry both do not count.
        let shared = self.common_slot(base);
        self.for_each_column_above(shared, p, |_, c, t| add(out.column_mut(c), seen(t)));
        base.for_each_column_above(shared, p, |_, c, t| add(out.column_mut(c), seen(-t)));
    }

    /// The twist of the tip at these joint velocities, in world axes at the world's origin.
    pub(crate) fn world_twist(&self, velocities: &[f64]) -> Twist {
        let mut twist = Twist::ZERO;
        self.for_each_column(Vec3::ZERO, |_, c, t| twist = twist + t * velocities[c]);
        twist
    }

    /// The derivative of the Jacobian in time at the joint velocities `velocities`.
    pub(crate) fn jacobian_dot_into(
        &self,
        velocities: &[f64],
        reference: ReferenceFrame,
        out: &mut Matrix,
    ) {
        out.as_mut_slice().fill(0.0);
        let tip_twist = self.world_twist(velocities);
        let frame = MovingFrame { tip: self.world_from_tip, twist: tip_twist };
        // The twist of the body that carries the current column: that of the tip without the joints
        // nearer the tip.
        let mut carrier = tip_twist;
        let mut at = (0, Twist::ZERO);
        self.for_each_column(Vec3::ZERO, |depth, c, column| {
            if depth != at.0 {
                carrier = carrier - at.1;
                at = (depth, Twist::ZERO);
            }
            at.1 = at.1 + column * velocities[c];
            let rate = carrier.bracket(column);
            add(out.column_mut(c), frame.rate_in(reference, column, rate));
        });
    }
}

/// A moving frame: converts the reference frame of a column and of its rate together.
pub(crate) struct MovingFrame {
    pub(crate) tip: Pose,
    /// World axes, world origin.
    pub(crate) twist: Twist,
}

impl MovingFrame {
    /// The rate of `column` in `reference`; `column` and its rate in world axes at the
    /// world's origin.
    #[inline]
    pub(crate) fn rate_in(&self, reference: ReferenceFrame, column: Twist, rate: Twist) -> Twist {
        let p = self.tip.translation;
        match reference {
            ReferenceFrame::World => rate,
            ReferenceFrame::LocalWorldAligned => {
                let dp = self.twist.at_point(p).linear;
                let moved = rate.at_point(p);
                Twist { linear: moved.linear + column.angular.cross(dp), ..moved }
            }
            ReferenceFrame::Local => {
                let relative = (rate - self.twist.bracket(column)).at_point(p);
                let rotation = self.tip.rotation.matrix();
                Twist {
                    linear: rotation.tr_mul(relative.linear),
                    angular: rotation.tr_mul(relative.angular),
                }
            }
        }
    }
}

#[inline]
pub(crate) fn add(column: &mut [f64], t: Twist) {
    for (x, y) in column.iter_mut().zip(t.to_array()) {
        *x += y;
    }
}
