//! The present step, as a secondary task reads it.

use super::super::approach::share_of_gain;
use super::super::task_space::TaskSpace;
use crate::kinematics::Chain;
use crate::linalg::{Matrix, Svd};
use crate::model::{Coordinate, CoordinateKind, Limits, Mechanism};

/// Configuration, decomposition and scaling of the present step.
#[derive(Debug)]
pub(in super::super) struct Context<'a> {
    pub(in super::super) mechanism: &'a Mechanism,
    pub(in super::super) chain: &'a Chain,
    /// Of the scaled task Jacobian.
    pub(in super::super) svd: &'a Svd,
    pub(in super::super) task: &'a TaskSpace,
    /// Memory for the derivatives of the Jacobian, 6 x n for each coordinate.
    pub(in super::super) hessian: &'a mut [Matrix],
    /// Of the coordinates of the chain; empty where nothing is known about them.
    pub(in super::super) limits: &'a [Limits],
    /// Time between steps (s).
    pub(in super::super) dt: f64,
}

impl Context<'_> {
    /// Coordinate `i` of the chain.
    pub(super) fn coordinate(&self, i: usize) -> &Coordinate {
        &self.mechanism.coordinates()[self.chain.coordinates()[i]]
    }

    /// True if the joint of coordinate `i` of the chain is reversed.
    pub(super) fn is_reversed(&self, i: usize) -> bool {
        self.mechanism.joints()[self.coordinate(i).joint].reversed
    }

    /// True for an angle or a length: coordinates that may have limits.
    pub(super) fn is_scalar(&self, i: usize) -> bool {
        matches!(self.coordinate(i).kind, CoordinateKind::Angle | CoordinateKind::Length)
    }

    /// The share of a gain at which coordinate `i` of the chain stops at a goal that it is `way` off. In a
    /// closed chain the joints with drives do, and the others follow.
    pub(super) fn share_of_gain(&self, i: usize, way: f64, gain: f64) -> f64 {
        match self.limits.get(i) {
            Some(limits) if !self.mechanism.is_closed() || self.coordinate(i).actuated => {
                share_of_gain(way, gain, limits, self.dt)
            }
            _ => 1.0,
        }
    }
}
