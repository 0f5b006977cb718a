//! Moving targets: how far the tool is behind, and whether it still follows.
//!
//! Formula  v, a: the twists of the target and of the tool, means over the last `WINDOW` seconds,
//!          exponentially weighted; v is fed forward, or the difference of successive targets.
//!          lag = <e, v> / |v| s, s the largest |v| of the last second or so, and at most the time since the
//!          target began to move; stalled where a is below `FOLLOWED` |v| along v and along e for
//!          `PATIENCE` seconds in which no joint accelerates at its limit
//! Shapes   e, v, a: m            Units    scaled task coordinates, s
//! Why so   over the present speed, the lag of a target that comes to rest would grow beyond bounds. The
//!          tool's motion is that between steps: at a singularity J q' points outwards while the arm
//!          swings to and fro. The error of a target that moves away says nothing about progress, and a
//!          tool at the edge of its workspace that moves along with the target is as near as it can be
//! Checked  tests/it/servo/moving.rs

use super::stall::{BrakingState, TURN_ROUND};
use crate::linalg::{dot, norm};
use crate::spatial::Pose;

/// Time constant of the means (s), and time at rest from which a target is fixed.
const WINDOW: f64 = 0.25;
/// Time constant with which the largest speed is forgotten (s).
const MEMORY: f64 = 1.0;
/// Share of the target's speed below which the tool neither follows nor approaches [-].
pub(super) const FOLLOWED: f64 = 0.1;
/// Scaled errors below this are rounding, without a direction [-].
const ROUNDING: f64 = 1e-9;
/// Time without progress until the stall is named (s), beside that in which joints reverse.
const PATIENCE: f64 = 1.0;

/// The motions of a target and of the tool.
#[derive(Debug, Clone)]
pub(super) struct TargetFollower {
    /// The twists of the target and of the tool in this step, scaled.
    pub(super) twist: Vec<f64>,
    pub(super) tool_twist: Vec<f64>,
    /// The pose of the last step.
    pub(super) last_pose: Option<Pose>,
    target: Vec<f64>,
    tool: Vec<f64>,
    /// Time since the target moved (s).
    at_rest: f64,
    /// Time since it began to move (s), and its largest speed (scaled) [1/s].
    moving: f64,
    fastest: f64,
    /// The tool's speed along the target's motion or towards the target, the larger (scaled) [1/s].
    progress: f64,
    blocked: f64,
    /// Time that the tool is behind the target (s); zero for fixed targets.
    pub(super) lag: f64,
}

impl TargetFollower {
    /// For tasks of m components.
    pub(super) fn new(m: usize) -> Self {
        let zero = vec![0.0; m];
        let at_rest = f64::INFINITY;
        Self {
            twist: zero.clone(),
            tool_twist: zero.clone(),
            last_pose: None,
            target: zero.clone(),
            tool: zero,
            at_rest,
            moving: 0.0,
            fastest: 0.0,
            progress: 0.0,
            blocked: 0.0,
            lag: 0.0,
        }
    }

    /// No target.
    pub(super) fn reset(&mut self) {
        (self.at_rest, self.blocked, self.lag) = (f64::INFINITY, 0.0, 0.0);
        (self.moving, self.fastest) = (0.0, 0.0);
        self.last_pose = None;
        self.target.fill(0.0);
        self.tool.fill(0.0);
    }

    /// True while the target moves, or did a short while ago.
    pub(super) fn is_moving(&self) -> bool {
        self.at_rest <= WINDOW
    }

    /// Records a step of `dt` seconds: whether the target moved by `twist`, and the error.
    pub(super) fn record(&mut self, moved: bool, error: &[f64], dt: f64) {
        if moved {
            self.at_rest = 0.0;
        } else {
            self.at_rest += dt;
            self.twist.fill(0.0);
            if !self.is_moving() {
                self.reset();
                return;
            }
        }
        let share = dt / (WINDOW + dt);
        let mean = |mean: &mut [f64], now: &[f64]| {
            mean.iter_mut().zip(now).for_each(|(m, x)| *m += (x - *m) * share);
        };
        mean(&mut self.target, &self.twist);
        mean(&mut self.tool, &self.tool_twist);
        let (speed, size) = (norm(&self.target), norm(error));
        let along = |way: &[f64], length: f64| {
            if length > ROUNDING { dot(&self.tool, way) / length } else { 0.0 }
        };
        self.progress = along(&self.target, speed).max(along(error, size));
        self.moving += dt;
        self.fastest = speed.max(self.fastest * MEMORY / (MEMORY + dt));
        let behind =
            if speed > 0.0 { dot(error, &self.target) / speed / self.fastest } else { 0.0 };
        self.lag = behind.max(0.0).min(self.moving);
    }

    /// Records the acceleration of the joints; true if the tool does not follow.
    pub(super) fn is_stalled(&mut self, braking: BrakingState, dt: f64) -> bool {
        if !self.is_moving() {
            return false;
        }
        if self.progress >= FOLLOWED * norm(&self.target) {
            self.blocked = 0.0;
        } else if !braking.accelerating {
            self.blocked += dt;
        }
        self.blocked > PATIENCE + TURN_ROUND * braking.stopping_time
    }
}
