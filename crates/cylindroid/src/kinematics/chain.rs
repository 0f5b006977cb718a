//! The kinematic chain of one end effector: forward kinematics and geometric Jacobian in one pass.
//!
//! It holds only what a control loop needs of a mechanism: an arm of a humanoid costs as much as an
//! arm alone. Nothing here allocates after construction.
//!
//! Checked  tests/it/batch.rs::chains_agree_with_trees, tests/allocation/main.rs

use super::forward::forward;
use super::jacobian::{ReferenceFrame, Tip};
use super::serial::Serial;
use super::serial_single;
use super::state::EndEffector;
use crate::error::Result;
use crate::linalg::Matrix;
use crate::model::{Mechanism, Node, NodeKind};
use crate::spatial::{AlignedPose, Pose, Vec3};

/// The kinematic chain of a mechanism from the ground to one end effector.
#[doc(alias = "forward kinematics")]
#[derive(Debug, Clone)]
pub struct Chain {
    nodes: Vec<Node>,
    /// The same where joints turn and slide. Boxed, as it is aligned for registers: allocators of
    /// other languages that take in what holds a chain know 16 bytes at most.
    serial: Option<Box<Serial>>,
    /// The ground, the nodes, the tool.
    slots: Vec<AlignedPose>,
    coordinates: Vec<usize>,
    local: Vec<f64>,
}

impl Chain {
    /// The chain to an end effector, at q = 0 of its coordinates.
    ///
    /// ```
    /// use cylindroid::kinematics::Chain;
    /// use cylindroid::{Matrix, ReferenceFrame};
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let mut chain = Chain::new(&robot, robot.tool())?;
    /// let mut jacobian = Matrix::zeros(6, chain.n());
    /// // In a control loop, without allocation:
    /// let world_from_tool = chain.set(robot.home());
    /// chain.jacobian_into(ReferenceFrame::Local, &mut jacobian);
    /// # let _ = world_from_tool;
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism.
    pub fn new(mechanism: &Mechanism, of: impl Into<EndEffector>) -> Result<Self> {
        let of = of.into();
        mechanism.check_frame(of.frame)?;
        Ok(Self::of(mechanism, of))
    }

    /// The chain to an end effector that was checked to be one of this mechanism.
    #[must_use]
    pub(crate) fn of(mechanism: &Mechanism, of: impl Into<EndEffector>) -> Self {
        let (path, slot_from_tool) = path(mechanism, of.into());
        let mut coordinates: Vec<usize> =
            path.iter().flat_map(|n| n.coordinate..n.coordinate + n.kind.dof()).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        Self::over(coordinates, path, slot_from_tool)
    }

    /// The same over all coordinates of the mechanism, also those that do not move the end
    /// effector: where loops couple them.
    #[must_use]
    pub(crate) fn whole(mechanism: &Mechanism, of: impl Into<EndEffector>) -> Self {
        let (path, slot_from_tool) = path(mechanism, of.into());
        Self::over((0..mechanism.n()).collect(), path, slot_from_tool)
    }

    fn over(coordinates: Vec<usize>, path: Vec<Node>, slot_from_tool: Pose) -> Self {
        let mut nodes: Vec<Node> = path
            .into_iter()
            .enumerate()
            .map(|(i, node)| Node {
                parent: i,
                coordinate: coordinates.partition_point(|&c| c < node.coordinate),
                ..node
            })
            .collect();
        if !coordinates.is_empty() {
            nodes.push(Node {
                parent: nodes.len(),
                placement: slot_from_tool.into(),
                kind: NodeKind::Fixed,
                coordinate: 0,
                multiplier: 0.0,
                offset: 0.0,
            });
        }
        let mut chain = Self {
            slots: vec![AlignedPose::IDENTITY; nodes.len() + 1],
            local: vec![0.0; coordinates.len()],
            serial: Serial::of(&nodes).map(Box::new),
            nodes,
            coordinates,
        };
        if chain.nodes.is_empty() {
            chain.slots = vec![slot_from_tool.into()]; // it stays there
        }
        chain.run();
        chain
    }

    /// Number of coordinates that move the end effector.
    #[must_use]
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Their places in the mechanism's `q`, ascending.
    #[must_use]
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// Moves to the mechanism's configuration `q` (all n entries of it) and returns
    /// `world_from_tool`.
    ///
    /// # Panics
    /// If `q` is shorter than the mechanism's.
    #[inline]
    pub fn set(&mut self, q: &[f64]) -> Pose {
        for (x, &c) in self.local.iter_mut().zip(&self.coordinates) {
            *x = q[c];
        }
        self.run();
        self.pose()
    }

    /// The coordinates of this chain at the last [`Chain::set`].
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.local
    }

    /// `world_from_tool` at the last [`Chain::set`].
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.tool().pose()
    }

    #[inline]
    fn tool(&self) -> &AlignedPose {
        &self.slots[self.nodes.len()]
    }

    /// The Jacobian for this chain's coordinates at the last [`Chain::set`], into `out` (6 x n).
    ///
    /// ```
    /// use cylindroid::kinematics::Chain;
    /// use cylindroid::{Matrix, ReferenceFrame};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let mut chain = Chain::new(&robot, robot.tool())?;
    /// let mut jacobian = Matrix::zeros(6, chain.n());
    /// let pose = chain.set(robot.home());
    /// chain.jacobian_into(ReferenceFrame::Local, &mut jacobian);
    /// let state = robot.state(robot.home())?;
    /// let expected = state.jacobian(robot.tool(), ReferenceFrame::Local)?;
    /// assert!(jacobian.max_difference(&expected) < 1e-12);
    /// assert!((pose.translation - state.pose(robot.tool())?.translation).norm() < 1e-12);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `out` is not 6 x n.
    #[inline]
    pub fn jacobian_into(&self, reference: ReferenceFrame, out: &mut Matrix) {
        assert_eq!((out.rows(), out.cols()), (6, self.n()), "shape of the Jacobian");
        let point = match reference {
            ReferenceFrame::World => Some(&[0.0; 4]),
            ReferenceFrame::LocalWorldAligned => Some(&self.tool().p),
            ReferenceFrame::Local => None,
        };
        match (&self.serial, point) {
            (Some(serial), Some(p)) if serial.has_one_for_each(self.n()) => {
                serial_single::jacobian(serial, &self.slots, p, out);
            }
            _ => self.tip().jacobian_into(reference, out),
        }
    }

    /// The Hessian for this chain's coordinates, into `out` (n matrices of 6 x n).
    ///
    /// ```
    /// use cylindroid::kinematics::Chain;
    /// use cylindroid::{Matrix, ReferenceFrame};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let mut chain = Chain::new(&robot, robot.tool())?;
    /// chain.set(robot.home());
    /// let mut hessian = vec![Matrix::zeros(6, chain.n()); chain.n()];
    /// chain.hessian_into(ReferenceFrame::World, &mut hessian);
    /// // The last joint carries no other: only its own column depends on it.
    /// assert_eq!(hessian[5].column(0), [0.0; 6]);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `out` has other sizes.
    pub fn hessian_into(&self, reference: ReferenceFrame, out: &mut [Matrix]) {
        assert!(
            out.len() == self.n() && out.iter().all(|m| (m.rows(), m.cols()) == (6, self.n())),
            "shape of the Hessian"
        );
        self.tip().hessian_into(reference, out);
    }

    /// Origin of the first moving joint in world; it does not depend on q (m).
    pub(crate) fn first_origin(&self) -> Vec3 {
        self.nodes.first().map_or(self.pose().translation, |n| n.placement.translation())
    }

    /// The farthest that the tool can be from the origin of the first joint (m): infinite where a
    /// joint slides without limits.
    pub(crate) fn length_after_first_joint(&self, mechanism: &Mechanism) -> f64 {
        let fixed: f64 = self.nodes.iter().skip(1).map(|n| n.placement.translation().norm()).sum();
        let slides: f64 = self
            .nodes
            .iter()
            .filter(|node| node.kind != NodeKind::Fixed)
            .map(|node| {
                let limits = mechanism.coordinates()[self.coordinates[node.coordinate]].limits;
                // Zero times an infinite limit is zero.
                let times = |q: f64, factor: f64| if factor == 0.0 { 0.0 } else { q * factor };
                let end = |q: f64| (times(q, node.multiplier) + node.offset).abs();
                let most = end(limits.lower).max(end(limits.upper));
                match node.kind {
                    NodeKind::Fixed | NodeKind::Revolute | NodeKind::Spherical => 0.0,
                    NodeKind::Prismatic => most,
                    NodeKind::Helical(pitch) => times(most, pitch.abs()),
                    NodeKind::Free => f64::INFINITY,
                }
            })
            .sum();
        fixed + slides
    }

    /// True where all coordinates are angles and lengths.
    pub(crate) fn turns_and_slides(&self) -> bool {
        self.nodes.iter().all(|node| node.kind.dof() <= 1)
    }

    /// The chain as joints that turn and slide, where it is nothing else.
    pub(crate) fn serial(&self) -> Option<&Serial> {
        self.serial.as_deref()
    }

    fn run(&mut self) {
        match &self.serial {
            Some(serial) => serial_single::forward(serial, &self.local, &mut self.slots),
            None => forward(&self.nodes, &self.local, &mut self.slots),
        }
    }

    fn tip(&self) -> Tip<'_> {
        Tip {
            nodes: &self.nodes,
            slots: &self.slots,
            slot: self.nodes.len(),
            world_from_tip: self.pose(),
        }
    }
}

/// The nodes from the ground to an end effector, and where it sits in the last one.
fn path(mechanism: &Mechanism, of: EndEffector) -> (Vec<Node>, Pose) {
    let frame = mechanism.frame_of(of.frame);
    let mut path = Vec::new();
    let mut slot = frame.slot;
    while slot > 0 {
        path.push(mechanism.nodes()[slot - 1]);
        slot = mechanism.nodes()[slot - 1].parent;
    }
    path.reverse();
    (path, frame.slot_from_frame * of.frame_from_tool)
}

const _: () = assert!(align_of::<Chain>() <= 16, "see `Chain::serial`");
