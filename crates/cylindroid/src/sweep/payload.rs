//! The largest force along a direction that actuated joints balance within their effort limits.
//!
//! Formula  arms: min over joints of effort_i / |J_v,i . d|, J_v,i the linear part of a column, d of
//!          length one. Closed chains: the largest force of the relation of the task d^T u, over all
//!          torques within the limits
//! Shapes   a number for each configuration
//! Units    N; efforts N m or N
//! Frame    at the frame's origin, d in world axes
//! Valid    static equilibrium without own weight; efforts bound torques of both signs, so d and -d
//!          are alike. Infinite where no torque is needed
//! Why so   an arm has one torque for a force, closed chains with internal forces have many, of which
//!          the linear program takes the best
//! Source   Yoshikawa 1985 for the force polytope of an arm; Bicchi & Prattichizzo 1998
//! Checked  tests/sweep/payload.rs

use crate::closure::{ClosedChain, MotionSpace};
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::linalg::{Interval, Matrix};
use crate::manipulability::force_range;
use crate::model::Mechanism;
use crate::spatial::Vec3;

/// What a payload needs beside the Jacobian.
#[derive(Debug, Clone)]
pub(super) struct Payload {
    direction: Vec3,
    /// Of the coordinates, where each has one torque.
    efforts: Option<Vec<f64>>,
}

impl Payload {
    pub(super) fn new(
        mechanism: &Mechanism,
        end_effector: EndEffector,
        direction: Vec3,
    ) -> Result<Self> {
        let refuse = |option: &'static str, reason: &str| {
            let value = format!("{},{},{}", direction.x, direction.y, direction.z);
            Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
        };
        let Some(direction) = direction.unit(0.0) else {
            return refuse("direction", "it has no length; give one such as 0,0,-1");
        };
        let of_arm = !mechanism.is_closed() && mechanism.actuated().count() == mechanism.n();
        if of_arm {
            let names = mechanism.coordinates().iter().map(|c| c.name.clone());
            let efforts = efforts(mechanism, &names.collect::<Vec<_>>())?;
            return Ok(Self { direction, efforts: Some(efforts) });
        }
        if end_effector.frame_from_tool != crate::spatial::Pose::IDENTITY {
            let reason =
                "the payload of a closed chain is that of a frame of the model; define one";
            return Err(Error::InvalidOption {
                option: "tool",
                value: String::new(),
                reason: reason.to_owned(),
            });
        }
        let chain =
            ClosedChain::of(&mechanism.state(mechanism.home())?, Some(end_effector.frame), None)?;
        efforts(mechanism, &chain.actuated)?;
        if chain.constraint.object() == 3 && direction.x.hypot(direction.y) == 0.0 {
            return refuse(
                "direction",
                "it must lie in the plane of the mechanism, as 0,-1,0 does",
            );
        }
        Ok(Self { direction, efforts: None })
    }

    /// True if it is computed from the Jacobian alone.
    pub(super) fn of_jacobian(&self) -> bool {
        self.efforts.is_some()
    }

    /// From the Jacobian of an arm, 6 x n.
    pub(super) fn at_jacobian(&self, jacobian: &[f64]) -> f64 {
        let (Vec3 { x, y, z, .. }, n) = (self.direction, jacobian.len() / 6);
        let joint = |(i, effort): (usize, &f64)| {
            let torque = x * jacobian[i] + y * jacobian[n + i] + z * jacobian[2 * n + i];
            effort / torque.abs()
        };
        let efforts = self.efforts.iter().flatten().enumerate();
        efforts.map(joint).fold(f64::INFINITY, f64::min)
    }

    /// At a configuration of any mechanism.
    pub(super) fn at(
        &self,
        mechanism: &Mechanism,
        end_effector: EndEffector,
        q: &[f64],
    ) -> Result<f64> {
        let chain = ClosedChain::of(&mechanism.state(q)?, Some(end_effector.frame), None)?;
        let d = self.direction.to_array();
        let object = chain.constraint.object();
        let linear = if object == 3 { 2 } else { 3 };
        let map = Matrix::from_fn(1, object, |_, j| if j < linear { d[j] } else { 0.0 });
        let relation = MotionSpace::of(&chain.constraint).relation().task(&map)?;
        let efforts = efforts(mechanism, &chain.actuated)?;
        let limits: Vec<Interval> = efforts.into_iter().map(Interval::symmetric).collect();
        // In the plane the map has the length of the direction there.
        let length = d[..linear].iter().map(|x| x * x).sum::<f64>().sqrt();
        let range = force_range(&relation, &limits)?;
        Ok(range.first().map_or(f64::INFINITY, |force| force.upper * length))
    }
}

/// The effort limits of joints, which all must have.
fn efforts(mechanism: &Mechanism, names: &[String]) -> Result<Vec<f64>> {
    let effort = |name: &String| {
        let effort = mechanism.limits_of(name).map(|l| l.effort);
        effort.filter(|e| e.is_finite()).ok_or_else(|| Error::InvalidOption {
            option: "quantities",
            value: "payload".to_owned(),
            reason: format!("joint '{name}' has no effort limit; give it one (`effort`)"),
        })
    };
    names.iter().map(effort).collect()
}
