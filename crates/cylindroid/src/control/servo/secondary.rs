//! Secondary tasks: joint velocities executed in the null space of the primary task.
//!
//! Formula  posture: k (q_0 - q), of rotation vectors and free bodies k log(R^T R_0) and
//!          k R^T (p_0 - p), which are rates in the axes of the child;
//!          centring: the posture of the middle of the limits;
//!          limit avoidance: k (1 - room / margin) away from a limit nearer than the margin;
//!          manipulability: k dw/dq, w = s_1 ... s_m, dw/dq_k = w sum_i u_i^T (dJ/dq_k) v_i / s_i
//! Units    gains in 1/s; for manipulability rad/s for each unit of dw/dq
//! Shapes   rates of the n coordinates that move the end effector
//! Valid    coordinates without limits (and rotation vectors) are left alone by centring and limit
//!          avoidance; the gradient is zero where w is zero up to rounding.
//!          The manipulability is that of the scaled task: linear rows over L, and with joint
//!          weights that of J W^(-1/2), so that joints which are kept still count less. Joints
//!          without weights climb the plain one
//! Source   Liegeois 1977; Yoshikawa 1985; analytic gradient through the Hessian
//! Checked  tests/it/servo/secondary.rs::secondary_*

use super::task_space::TaskSpace;
use crate::error::{Error, Result};
use crate::kinematics::Chain;
use crate::linalg::{Matrix, Svd};
use crate::manipulability::log_volume_slope;
use crate::model::{CoordinateKind, Mechanism};
use crate::scalar::clamp;
use crate::spatial::{Rotation, Vec3};

/// A secondary task, projected onto the null space of the end-effector task.
#[derive(Debug, Clone, PartialEq)]
pub enum SecondaryTask {
    /// Towards this configuration (all n coordinates of the mechanism).
    Posture {
        /// The configuration.
        q: Vec<f64>,
        /// Gain [1/s].
        gain: f64,
    },
    /// Towards the middle of the limits.
    Centring {
        /// Gain [1/s].
        gain: f64,
    },
    /// Away from limits that are near.
    LimitAvoidance {
        /// Rate at the limit [rad/s or m/s].
        gain: f64,
        /// Distance at which it sets in, as a share of the range [-].
        margin: f64,
    },
    /// Towards larger manipulability of the task, in the metric of the joint weights.
    Manipulability {
        /// Gain.
        gain: f64,
    },
}

/// Memory for the gradient of the manipulability.
#[derive(Debug, Clone)]
pub(super) struct Gradient {
    pub(super) hessian: Vec<Matrix>,
}

impl SecondaryTask {
    /// The names of the tasks.
    pub const NAMES: [&'static str; 4] =
        ["posture", "centring", "limit-avoidance", "manipulability"];

    /// The task of this name with its default numbers: gain 1/s, limit avoidance with 1 rad/s at
    /// the limit from a tenth of the range on. `posture` is where the task "posture" goes.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str, posture: &[f64]) -> Result<Self> {
        match name {
            "posture" => Ok(Self::Posture { q: posture.to_vec(), gain: 1.0 }),
            "centring" => Ok(Self::Centring { gain: 1.0 }),
            "limit-avoidance" => Ok(Self::LimitAvoidance { gain: 1.0, margin: 0.1 }),
            "manipulability" => Ok(Self::Manipulability { gain: 1.0 }),
            _ => Err(Error::unknown("secondary task", name, Self::NAMES)),
        }
    }

    /// The same task with another gain.
    #[must_use]
    pub fn with_gain(mut self, value: f64) -> Self {
        match &mut self {
            Self::Posture { gain, .. }
            | Self::Centring { gain }
            | Self::LimitAvoidance { gain, .. }
            | Self::Manipulability { gain } => *gain = value,
        }
        self
    }

    /// Adds the joint velocities of the task for the chain's coordinates to `out`.
    pub(super) fn add_rates(
        &self,
        mechanism: &Mechanism,
        chain: &Chain,
        svd: &Svd,
        task: &TaskSpace,
        gradient: &mut Gradient,
        out: &mut [f64],
    ) {
        let coordinate = |i: usize| &mechanism.coordinates()[chain.coordinates()[i]];
        let ordinary =
            |i: usize| matches!(coordinate(i).kind, CoordinateKind::Angle | CoordinateKind::Length);
        match self {
            Self::Posture { q, gain } if task.turns_and_slides => {
                let here = chain.coordinates().iter().zip(chain.q());
                for (rate, (&c, here)) in out.iter_mut().zip(here) {
                    *rate += gain * (q[c] - here);
                }
            }
            Self::Posture { q, gain } => {
                let mut i = 0;
                while i < out.len() {
                    let kind = coordinate(i).kind;
                    let (here, there) = (&chain.q()[i..], &q[chain.coordinates()[i]..]);
                    i += add_posture(kind, here, there, *gain, &mut out[i..]);
                }
            }
            Self::Centring { gain } => {
                for (i, rate) in out.iter_mut().enumerate() {
                    let l = &coordinate(i).limits;
                    let middle = 0.5 * (l.lower + l.upper);
                    if middle.is_finite() && ordinary(i) {
                        *rate += gain * (middle - chain.q()[i]);
                    }
                }
            }
            Self::LimitAvoidance { gain, margin } => {
                for (i, rate) in out.iter_mut().enumerate() {
                    let l = &coordinate(i).limits;
                    let near = margin * (l.upper - l.lower);
                    if !(near.is_finite() && near > 0.0 && ordinary(i)) {
                        continue;
                    }
                    let q = chain.q()[i];
                    let push = |distance: f64| clamp(1.0 - distance / near, 0.0, 1.0);
                    *rate += gain * (push(q - l.lower) - push(l.upper - q));
                }
            }
            Self::Manipulability { gain } => {
                chain.hessian_into(task.axes, &mut gradient.hessian);
                let rank = svd.machine_rank().rank;
                if rank < svd.len() || rank == 0 {
                    return;
                }
                let w: f64 = svd.values().product();
                for (k, rate) in out.iter_mut().enumerate() {
                    let h = &gradient.hessian[k];
                    let entry = |i: usize, j: usize| {
                        let (row, scale) = task.rows[i];
                        scale * h[(row, j)] * task.columns[j]
                    };
                    *rate += gain * w * log_volume_slope(svd, rank, entry);
                }
            }
        }
    }

    /// The name of the task.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Posture { .. } => "posture",
            Self::Centring { .. } => "centring",
            Self::LimitAvoidance { .. } => "limit-avoidance",
            Self::Manipulability { .. } => "manipulability",
        }
    }

    /// The gain of the task.
    #[must_use]
    pub const fn gain(&self) -> f64 {
        match self {
            Self::Posture { gain, .. }
            | Self::Centring { gain }
            | Self::LimitAvoidance { gain, .. }
            | Self::Manipulability { gain } => *gain,
        }
    }
}

/// Adds the rates from one posture to another of the coordinates that belong to the first one;
/// returns how many they are.
fn add_posture(
    kind: CoordinateKind,
    here: &[f64],
    there: &[f64],
    gain: f64,
    out: &mut [f64],
) -> usize {
    let vector = |x: &[f64], i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
    let mut add = |i: usize, v: Vec3| {
        out[i..].iter_mut().zip(v.to_array()).for_each(|(rate, x)| *rate += gain * x);
    };
    let turn = |i: usize| {
        let back = Rotation::exp(vector(here, i)).inverse();
        (back, (back * Rotation::exp(vector(there, i))).log())
    };
    match kind {
        CoordinateKind::Angle | CoordinateKind::Length => {
            out[0] += gain * (there[0] - here[0]);
            1
        }
        CoordinateKind::RotationVector => {
            add(0, turn(0).1);
            3
        }
        // A free body: its position, then its rotation vector.
        CoordinateKind::Position => {
            let (back, rotation) = turn(3);
            add(0, back * (vector(there, 0) - vector(here, 0)));
            add(3, rotation);
            6
        }
    }
}
