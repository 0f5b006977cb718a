//! A mechanism at one configuration.
//!
//! Checked  tests/it/kinematics.rs, tests/it/relative_jacobian.rs,
//!          tests/it/magnitudes.rs::frames_of_other_mechanisms_are_errors

use super::analytical::{AnalyticalJacobian, OrientationRates, analytical};
use super::forward::forward;
use super::jacobian::{ReferenceFrame, Tip};
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{FrameId, Joint, Mechanism};
use crate::spatial::{AlignedPose, Pose, Twist, Vec3};

/// A frame of a mechanism and a tool point fixed to it.
///
/// Functions that take one return an error if the frame is of another mechanism
/// ([`Mechanism::check_frame`] tells beforehand). A tool that is not finite gives numbers that are not
/// finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndEffector {
    /// The frame.
    pub frame: FrameId,
    /// The pose of the tool relative to the frame.
    pub frame_from_tool: Pose,
}

impl From<FrameId> for EndEffector {
    fn from(frame: FrameId) -> Self {
        Self { frame, frame_from_tool: Pose::IDENTITY }
    }
}

/// All frames of a mechanism at one configuration `q`; its existence proves that forward kinematics
/// ran.
#[doc(alias = "forward kinematics")]
#[doc(alias = "fk")]
#[derive(Debug, Clone)]
pub struct State {
    mechanism: Mechanism,
    q: Vec<f64>,
    slots: Vec<AlignedPose>,
}

impl Mechanism {
    /// The mechanism at `q`.
    ///
    /// ```
    /// let robot = cylindroid::load("panda")?;
    /// let state = robot.state(robot.home())?;
    /// println!("{:?}", state.pose(robot.tool())?.translation);
    /// assert!(robot.state(&[0.0]).is_err()); // one entry for seven joints
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A `q` of the wrong size or with a non-finite entry.
    pub fn state(&self, q: &[f64]) -> Result<State> {
        let mut state = State {
            mechanism: self.clone(),
            q: vec![0.0; self.n()],
            slots: vec![AlignedPose::IDENTITY; self.nodes().len() + 1],
        };
        state.set(q)?;
        Ok(state)
    }
}

impl State {
    /// Moves to another `q`, without allocation; on an error the state stays as it was.
    ///
    /// ```
    /// let robot = cylindroid::load("ur5e")?;
    /// let mut state = robot.state(robot.home())?;
    /// let before = state.pose(robot.tool())?;
    /// state.set(&[0.1, -1.0, 1.2, 0.3, 0.4, 0.5])?;
    /// assert!((state.pose(robot.tool())?.translation - before.translation).norm() > 0.1);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A `q` of the wrong size or with a non-finite entry.
    pub fn set(&mut self, q: &[f64]) -> Result<()> {
        self.mechanism.check_q("q", q)?;
        self.q.copy_from_slice(q);
        forward(self.mechanism.nodes(), &self.q, &mut self.slots);
        Ok(())
    }

    /// The configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// `world_from_tool`.
    ///
    /// ```
    /// use cylindroid::{EndEffector, Pose, Vec3};
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let state = robot.state(robot.home())?;
    /// let flange = state.pose(robot.tool())?;
    /// // A tool tip 0.1 m beyond the frame, along its z axis.
    /// let tip = EndEffector {
    ///     frame: robot.tool(),
    ///     frame_from_tool: Pose::from_translation(Vec3::new(0.0, 0.0, 0.1)),
    /// };
    /// assert!((state.pose(tip)?.translation - flange.translation).norm() - 0.1 < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism.
    #[doc(alias = "forward kinematics")]
    pub fn pose(&self, of: impl Into<EndEffector>) -> Result<Pose> {
        Ok(self.checked_tip(of)?.world_from_tip)
    }

    /// The geometric Jacobian, 6 x n: twist of the tool = J * joint velocities.
    ///
    /// ```text
    /// column of a revolute joint [z x (p - t); z],   of a prismatic joint [z; 0],
    /// of a helical joint [z x (p - t) + h z; z]
    /// ```
    ///
    /// z is the joint's axis and t its origin, p the reference point; linear rows first, m/s and
    /// rad/s for each unit of joint velocity.
    ///
    /// ```
    /// use cylindroid::ReferenceFrame;
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let state = robot.state(robot.home())?;
    /// let jacobian = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)?;
    /// let velocities = [0.1; 7];
    /// let twist = state.twist(&velocities, robot.tool(), ReferenceFrame::LocalWorldAligned)?;
    /// let product = jacobian.mul_vec(&velocities);
    /// assert!(product.iter().zip(twist.to_array()).all(|(a, b)| (a - b).abs() < 1e-14));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism.
    #[doc(alias = "geometric Jacobian")]
    pub fn jacobian(
        &self,
        of: impl Into<EndEffector>,
        reference: ReferenceFrame,
    ) -> Result<Matrix> {
        Ok(self.checked_tip(of)?.jacobian(reference, self.mechanism.n()))
    }

    /// [`State::jacobian`] without allocation.
    ///
    /// ```
    /// use cylindroid::{Matrix, ReferenceFrame};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let mut state = robot.state(robot.home())?;
    /// let mut jacobian = Matrix::zeros(6, robot.n());
    /// for step in 0..10 {
    ///     state.set(&[0.1 * f64::from(step); 6])?;
    ///     state.jacobian_into(robot.tool(), ReferenceFrame::World, &mut jacobian)?;
    /// }
    /// assert_eq!(jacobian, state.jacobian(robot.tool(), ReferenceFrame::World)?);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// An `out` that is not 6 x n; a frame of another mechanism.
    pub fn jacobian_into(
        &self,
        of: impl Into<EndEffector>,
        reference: ReferenceFrame,
        out: &mut Matrix,
    ) -> Result<()> {
        let tip = self.checked_tip(of)?;
        self.check_shape("the Jacobian", out)?;
        tip.jacobian_into(reference, out);
        Ok(())
    }

    /// The Jacobian of a tool relative to another frame, which may move, 6 x n: the twist of the tool
    /// as seen from `base`, its point the tool's origin, its axes those of `base`. Joints that carry
    /// both have zeros, unless a joint between them follows such a joint.
    ///
    /// ```
    /// // The hand of a panda seen from its elbow: four joints carry the elbow.
    /// let robot = cylindroid::load("panda")?;
    /// let state = robot.state(robot.home())?;
    /// let jacobian = state.relative_jacobian(robot.tool(), robot.frame("link4")?)?;
    /// assert!((0..4).all(|joint| jacobian.column(joint).iter().all(|x| *x == 0.0)));
    /// assert!((4..7).all(|joint| jacobian.column(joint).iter().any(|x| *x != 0.0)));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Frames of another mechanism.
    pub fn relative_jacobian(
        &self,
        of: impl Into<EndEffector>,
        base: impl Into<EndEffector>,
    ) -> Result<Matrix> {
        let mut out = Matrix::zeros(6, self.mechanism.n());
        self.checked_tip(of)?.relative_jacobian_into(&self.checked_tip(base)?, &mut out);
        Ok(out)
    }

    /// All joints at once, into `out` (6 x n): the twist that a unit rate of each coordinate gives
    /// the links behind its joint, in world axes at the world's origin. The Jacobian of any frame
    /// with [`ReferenceFrame::World`] has these columns where the coordinate moves the frame and
    /// zeros elsewhere; joints that mimic another come on top, each with its own twist, and are not
    /// in here.
    ///
    /// ```
    /// use cylindroid::{Matrix, ReferenceFrame};
    ///
    /// // In a serial arm every joint moves the tool.
    /// let robot = cylindroid::load("ur5e")?;
    /// let state = robot.state(robot.home())?;
    /// let mut twists = Matrix::zeros(6, 6);
    /// state.joint_twists_into(&mut twists)?;
    /// let jacobian = state.jacobian(robot.tool(), ReferenceFrame::World)?;
    /// assert!(twists.max_difference(&jacobian) < 1e-12);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// An `out` that is not 6 x n.
    pub fn joint_twists_into(&self, out: &mut Matrix) -> Result<()> {
        self.check_shape("the joint twists", out)?;
        for joint in self.mechanism.joints().iter().filter(|j| j.mimic.is_none()) {
            self.for_each_twist_of(joint, |c, twist| {
                out.column_mut(c).copy_from_slice(&twist.to_array());
            });
        }
        Ok(())
    }

    /// Calls `f(coordinate, twist)` for the twist of the child of one joint relative to its parent
    /// at a unit rate of each coordinate, in world axes at the world's origin, the last coordinate
    /// first.
    pub(super) fn for_each_twist_of(&self, joint: &Joint, mut f: impl FnMut(usize, Twist)) {
        let slot = |link: usize| self.mechanism.frames()[link].slot; // frames of links come first
        let tip = Tip {
            nodes: self.mechanism.nodes(),
            slots: &self.slots,
            slot: slot(joint.child),
            world_from_tip: Pose::IDENTITY,
        };
        tip.for_each_column_above(slot(joint.parent), Vec3::ZERO, |_, c, twist| f(c, twist));
    }

    /// The time derivative of the Jacobian at the joint velocities `velocities`, 6 x n.
    ///
    /// ```text
    /// dJ_i/dt = ad(V_i) J_i   in world, V_i the twist of the body that carries joint i
    /// ```
    ///
    /// ```
    /// use cylindroid::ReferenceFrame;
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let state = robot.state(robot.home())?;
    /// let rate = state.jacobian_dot(&[0.2; 6], robot.tool(), ReferenceFrame::World)?;
    /// assert_eq!((rate.rows(), rate.cols()), (6, 6));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Joint velocities of the wrong size, non-finite or out of range; a frame of another mechanism.
    pub fn jacobian_dot(
        &self,
        velocities: &[f64],
        of: impl Into<EndEffector>,
        reference: ReferenceFrame,
    ) -> Result<Matrix> {
        let tip = self.checked_tip(of)?;
        self.mechanism.check_q("velocities", velocities)?;
        let mut out = Matrix::zeros(6, self.mechanism.n());
        tip.jacobian_dot_into(velocities, reference, &mut out);
        Ok(out)
    }

    /// The Hessian: entry k is the derivative of the Jacobian with respect to coordinate k (6 x n
    /// each).
    ///
    /// ```text
    /// dJ_i/dq_k = ad(J_k) J_i   in world, if joint k carries joint i or is i; otherwise 0
    /// ```
    ///
    /// Source: Haviland & Corke 2020, in screw form.
    ///
    /// ```
    /// use cylindroid::ReferenceFrame;
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let hessian = robot.state(robot.home())?.hessian(robot.tool(), ReferenceFrame::World)?;
    /// assert_eq!(hessian.len(), robot.n()); // dJ/dq_k for each coordinate k
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism.
    pub fn hessian(
        &self,
        of: impl Into<EndEffector>,
        reference: ReferenceFrame,
    ) -> Result<Vec<Matrix>> {
        Ok(self.checked_tip(of)?.hessian(reference, self.mechanism.n()))
    }

    /// The analytical Jacobian: rates of position and of orientation angles.
    ///
    /// ```
    /// use cylindroid::kinematics::OrientationRates;
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let state = robot.state(robot.home())?;
    /// let analytical = state.analytical_jacobian(robot.tool(), OrientationRates::RotationVector)?;
    /// assert!(analytical.exists);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism.
    pub fn analytical_jacobian(
        &self,
        of: impl Into<EndEffector>,
        rates: OrientationRates,
    ) -> Result<AnalyticalJacobian> {
        let tip = self.checked_tip(of)?;
        let jacobian = tip.jacobian(ReferenceFrame::LocalWorldAligned, self.mechanism.n());
        Ok(analytical(tip.world_from_tip, &jacobian, rates))
    }

    /// The twist of the tool at the joint velocities `velocities`.
    ///
    /// ```
    /// use cylindroid::{ReferenceFrame, Vec3};
    ///
    /// // The base joint rotates the tool about the vertical at 0.5 rad/s.
    /// let robot = cylindroid::load("ur5e")?;
    /// let state = robot.state(robot.home())?;
    /// let velocities = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
    /// let twist = state.twist(&velocities, robot.tool(), ReferenceFrame::LocalWorldAligned)?;
    /// assert!((twist.angular - Vec3::Z * 0.5).norm() < 1e-12);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Joint velocities of the wrong size, non-finite or out of range; a frame of another mechanism.
    pub fn twist(
        &self,
        velocities: &[f64],
        of: impl Into<EndEffector>,
        reference: ReferenceFrame,
    ) -> Result<Twist> {
        let tip = self.checked_tip(of)?;
        self.mechanism.check_q("velocities", velocities)?;
        let world = tip.world_twist(velocities);
        let pose = tip.world_from_tip;
        Ok(match reference {
            ReferenceFrame::World => world,
            ReferenceFrame::LocalWorldAligned => world.at_point(pose.translation),
            ReferenceFrame::Local => pose.inverse().adjoint(world),
        })
    }

    /// The poses of all moving frames, the ground first.
    pub(crate) fn slots(&self) -> &[AlignedPose] {
        &self.slots
    }

    fn check_shape(&self, what: &str, out: &Matrix) -> Result<()> {
        if (out.rows(), out.cols()) == (6, self.mechanism.n()) {
            return Ok(());
        }
        Error::check_len(&format!("rows of {what}"), 6, out.rows())?;
        Error::check_len(&format!("columns of {what}"), self.mechanism.n(), out.cols())
    }

    fn checked_tip(&self, of: impl Into<EndEffector>) -> Result<Tip<'_>> {
        let of = of.into();
        self.mechanism.check_frame(of.frame)?;
        Ok(self.tip(of))
    }

    /// [`State::pose`] of an end effector that was checked to be one of this mechanism.
    pub(crate) fn pose_of(&self, of: impl Into<EndEffector>) -> Pose {
        self.tip(of).world_from_tip
    }

    /// The tip of an end effector that was checked to be one of this mechanism.
    pub(crate) fn tip(&self, of: impl Into<EndEffector>) -> Tip<'_> {
        let of = of.into();
        let frame = self.mechanism.frame_of(of.frame);
        Tip {
            nodes: self.mechanism.nodes(),
            slots: &self.slots,
            slot: frame.slot,
            world_from_tip: self.slots[frame.slot].pose()
                * frame.slot_from_frame
                * of.frame_from_tool,
        }
    }
}
