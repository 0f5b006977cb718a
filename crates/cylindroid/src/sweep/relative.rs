//! The frame of a sweep as seen from another one that moves: two arms together.
//!
//! Formula  base_from_tool; J = R_b^T (J_t - J_b at the tool's origin), t the tool and b the base
//! Shapes   poses: N x 16, Jacobians: N x 6 x n; row-major, as of `KinematicsBatch`
//! Units    m, rad; m/s and rad/s for each unit of joint velocity
//! Frame    point: the tool's origin; axes: those of the base
//! Valid    any mechanism; quantities of Jacobians, as others of them, without loops. In the plane
//!          measures need a base with its z axis along the normal
//! Why so   the kinematics are those of `State`, one configuration after the other: joints that carry
//!          both frames have exact zeros, which the difference of two batches would round
//! Checked  tests/sweep/relative.rs

use super::options::SweepOptions;
use super::poses::POSE;
use super::source::Source;
use crate::error::{Error, Result};
use crate::kinematics::{EndEffector, State};
use crate::linalg::Matrix;
use crate::model::{Dimension, FrameId, Mechanism};

/// Difference from 1 of the cosine between a z axis and the normal of the plane, by rounding.
const UPRIGHT: f64 = 1e-12;

/// Two frames, and a state of the mechanism.
#[derive(Debug, Clone)]
pub(super) struct Relative {
    tool: EndEffector,
    pub(super) base: FrameId,
    state: State,
    jacobian: Matrix,
}

impl Relative {
    /// `None` if the options name no base.
    pub(super) fn new(
        mechanism: &Mechanism,
        options: &SweepOptions,
        tool: EndEffector,
    ) -> Result<Option<Self>> {
        let Some(base) = options.relative_to else { return Ok(None) };
        mechanism.check_frame(base)?;
        let name = &mechanism.frame_of(base).name;
        let refuse = |reason: String| {
            Err(Error::InvalidOption { option: "relative_to", value: name.clone(), reason })
        };
        if let Some(quantity) = options.quantities.iter().find(|q| !q.is_relative()) {
            return refuse(format!(
                "{} has no frame that moves as its base; name other quantities, or leave this \
                 option out",
                quantity.name()
            ));
        }
        match &options.source {
            Source::Voxels(_) => {
                return refuse("the points of a capability map are in the world".to_owned());
            }
            Source::Poses { .. } => {
                return refuse(
                    "poses that inverse kinematics reaches are in the world; sweep the \
                     configurations that it finds"
                        .to_owned(),
                );
            }
            _ => {}
        }
        let state = mechanism.state(mechanism.home())?;
        let sees_task = options.quantities.iter().any(|q| q.sees_task());
        let is_tilted = state.pose(base)?.rotation.z_axis().z.abs() < 1.0 - UPRIGHT;
        if mechanism.dimension() == Dimension::Planar && sees_task && is_tilted {
            return refuse(
                "in the plane the components of the twist are those of a frame with its z axis along \
                 the normal"
                    .to_owned(),
            );
        }
        let jacobian = Matrix::zeros(6, mechanism.n());
        Ok(Some(Self { tool, base, state, jacobian }))
    }

    /// Poses and Jacobians of these configurations, each only where there is room for them.
    pub(super) fn run(
        &mut self,
        q: &[f64],
        poses: &mut [f64],
        jacobians: &mut [f64],
    ) -> Result<()> {
        let n = self.state.q().len();
        let (mut poses, mut jacobians) =
            (poses.chunks_exact_mut(POSE), jacobians.chunks_exact_mut(6 * n));
        for q in q.chunks_exact(n) {
            self.state.set(q)?;
            let (base, tip) = (self.state.tip(self.base), self.state.tip(self.tool));
            if let Some(pose) = poses.next() {
                let seen = base.world_from_tip.inverse() * tip.world_from_tip;
                pose.copy_from_slice(seen.to_matrix().as_flattened());
            }
            if let Some(rows) = jacobians.next() {
                tip.relative_jacobian_into(&base, &mut self.jacobian);
                for (c, column) in (0..n).map(|c| (c, self.jacobian.column(c))) {
                    column.iter().enumerate().for_each(|(row, x)| rows[row * n + c] = *x);
                }
            }
        }
        Ok(())
    }
}
