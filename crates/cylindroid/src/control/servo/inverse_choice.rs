//! The inverse of one Jacobian as a servo would use it: method, projection, characteristic length.
//!
//! Formula  orthogonal: (S J)+ S with S = diag(1/L, 1/L, 1/L, 1, 1, 1); otherwise J+h, its damped
//!          forms, or J (K^T J)^-1 K^T, see `inverse`
//!          closed chains: M (J M)+ with M from the actuated joints to all joints (`closure`)
//! Shapes   J: 6 x n, linear first -> n x 6, a row for each coordinate of the mechanism
//! Units    rad/s or m/s of the joints per m/s and rad/s of the twist; L in m
//! Frame    that of the Jacobian; the singular values, rank and dropped directions of an orthogonal
//!          inverse are those of S J, the task [v / L; w]
//! Valid    any rank. In a closed chain joint velocities keep the loops closed to first order, and
//!          the least actuated motion is the smallest one
//! Checked  tests/it/servo/inverse_choice.rs, tests/it/servo/reference_point.rs

use super::projection::TaskProjection;
use crate::closure::ActuationMap;
use crate::error::{Error, Result};
use crate::inverse::{
    HyperbolicDamping, HyperbolicOptions, Inverse, Method, hyperbolic_with, oblique,
    selectively_damped,
};
use crate::kinematics::{EndEffector, ReferenceFrame, State};
use crate::linalg::Matrix;
use crate::screws::ScrewOptions;
use crate::spatial::{Pose, Twist};
use crate::tolerance::{LENGTHS, MAX_MAGNITUDE};

/// An inverse as chosen in [`ServoOptions`](super::ServoOptions): method, projection and length.
#[derive(Debug, Clone, PartialEq)]
pub struct InverseChoice {
    /// The method near singularities.
    pub method: Method,
    /// The part of a motion that is realised; the method is used only if it is orthogonal.
    pub projection: TaskProjection,
    /// Characteristic length (m).
    pub length: f64,
}

impl InverseChoice {
    /// The inverse of the Jacobian of a tool: velocities of the coordinates of `state`'s mechanism
    /// (in a closed chain with the loops kept closed) = matrix * twist.
    ///
    /// ```text
    /// S = diag(1/L, 1/L, 1/L, 1, 1, 1):   J+ = (S J)+ S,   hyperbolic: J+h
    /// closed chain, M from the actuated joints to all joints:   M (J M)+
    /// ```
    ///
    /// The matrix is n x 6, linear columns first, for twists at the point and in the axes of
    /// `reference`. `twist` matters to selectively damped least squares alone, which otherwise
    /// assumes unit motions along each direction. Singular values, rank and dropped directions of
    /// an orthogonal inverse are those of the scaled task [v / L; w]. Where there is no inverse,
    /// `exists` is false with the reason.
    ///
    /// ```
    /// use cylindroid::control::{InverseChoice, TaskProjection};
    /// use cylindroid::{Method, ReferenceFrame};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let state = robot.state(&[0.1, -1.2, 1.4, 0.2, 1.5, 0.3])?;
    /// let choice = InverseChoice {
    ///     method: Method::Truncated { eps: 1e-3 },
    ///     projection: TaskProjection::Orthogonal,
    ///     length: robot.reach(),
    /// };
    /// let inverse = choice.inverse(&state, robot.tool(), ReferenceFrame::Local, None)?;
    /// let jacobian = state.jacobian(robot.tool(), ReferenceFrame::Local)?;
    /// let product = &jacobian * &inverse.matrix;
    /// assert!(product.max_difference(&cylindroid::Matrix::identity(6)) < 1e-12);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// An end effector of another mechanism; values that are non-finite or outside the domain of
    /// the method; as [`ActuationMap::of`] for closed chains.
    pub fn inverse(
        &self,
        state: &State,
        tool: impl Into<EndEffector>,
        reference: ReferenceFrame,
        twist: Option<Twist>,
    ) -> Result<Inverse> {
        let (mechanism, tool) = (state.mechanism(), tool.into());
        mechanism.check_frame(tool.frame)?;
        if let Some(twist) = twist {
            Error::check_within("twist", &twist.to_array(), MAX_MAGNITUDE)?;
        }
        let pose = state.pose_of(tool);
        let seen = |t: Twist, from| seen_from(reference, pose, to_world(from, pose, t));
        let j = state.jacobian(tool, reference)?;
        if !mechanism.is_closed() {
            return self.of_matrix(&j, twist, seen);
        }
        let map = ActuationMap::of(state, &[], &[])?;
        let motions =
            Matrix::from_fn(mechanism.n(), map.motions.cols(), |i, k| map.motions[(i, k)]);
        let found = self.of_matrix(&(&j * &motions), twist, seen)?;
        Ok(Inverse { matrix: &motions * &found.matrix, ..found })
    }

    /// The inverse of `j`, 6 x m; `seen` takes a twist of the complement from its frame to that of
    /// `j`.
    pub(super) fn of_matrix(
        &self,
        j: &Matrix,
        twist: Option<Twist>,
        seen: impl Fn(Twist, ReferenceFrame) -> Twist,
    ) -> Result<Inverse> {
        Error::check_range("length", self.length, &LENGTHS)?;
        self.projection.check()?;
        let options = |damping| HyperbolicOptions {
            scale: ScrewOptions::with_length(self.length),
            damping,
            ..HyperbolicOptions::default()
        };
        match &self.projection {
            TaskProjection::Orthogonal => self.orthogonal(j, twist),
            TaskProjection::Hyperbolic { h } => {
                hyperbolic_with(j, *h, &options(HyperbolicDamping::None))
            }
            TaskProjection::DampedHyperbolic { h, damping } => {
                hyperbolic_with(j, *h, &options(*damping))
            }
            TaskProjection::Oblique { complement, reference } => {
                let given_up: Vec<[f64; 6]> =
                    complement.iter().map(|t| seen(*t, *reference).to_array()).collect();
                let complement = Matrix::from_fn(6, given_up.len(), |i, k| given_up[k][i]);
                oblique(j, &complement, &options(HyperbolicDamping::None))
            }
        }
    }

    fn orthogonal(&self, j: &Matrix, twist: Option<Twist>) -> Result<Inverse> {
        let scale: [f64; 6] = std::array::from_fn(|i| if i < 3 { 1.0 / self.length } else { 1.0 });
        let scaled = j.clone().scale_rows(&scale);
        let mut found = match (self.method, twist) {
            (Method::SelectivelyDamped { max_joint_velocity }, Some(twist)) => {
                let twist = twist.to_array();
                let twist: [f64; 6] = std::array::from_fn(|i| twist[i] * scale[i]);
                selectively_damped(&scaled, &twist, max_joint_velocity)?
            }
            (method, _) => method.inverse(&scaled)?,
        };
        for (column, s) in scale.into_iter().enumerate() {
            found.matrix.column_mut(column).iter_mut().for_each(|x| *x *= s);
        }
        Ok(found)
    }
}

/// A twist of a tool at `pose`, given in one reference frame, at the origin of the world.
fn to_world(from: ReferenceFrame, pose: Pose, twist: Twist) -> Twist {
    match from {
        ReferenceFrame::Local => pose.adjoint(twist),
        ReferenceFrame::World => twist,
        ReferenceFrame::LocalWorldAligned => twist.at_point(-pose.translation),
    }
}

/// A twist at the origin of the world, in a reference frame of a tool at `pose`.
fn seen_from(reference: ReferenceFrame, pose: Pose, twist: Twist) -> Twist {
    match reference {
        ReferenceFrame::Local => pose.inverse().adjoint(twist),
        ReferenceFrame::World => twist,
        ReferenceFrame::LocalWorldAligned => twist.at_point(pose.translation),
    }
}
