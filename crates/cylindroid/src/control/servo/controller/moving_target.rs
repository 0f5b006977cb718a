//! The stages of a step for a moving target.
//!
//! Checked  tests/it/servo/moving.rs

use super::super::stall::{BrakingState, StallDetector};
use super::super::step::{DesiredMotion, Target};
use super::Servo;
use crate::linalg::norm;
use crate::spatial::{Pose, Twist};

impl Servo {
    /// Records the motion of the target and of the tool; true if the tool no longer follows.
    pub(super) fn follow(
        &mut self,
        target: &Target,
        desired: &DesiredMotion,
        pose: Pose,
        braking: BrakingState,
    ) -> bool {
        let last = self.last_target.replace(target.pose);
        if last != Some(target.pose) {
            self.stall_detector = StallDetector::new();
        }
        let is_fed_forward = target.feed_forward != Twist::ZERO;
        let moved = is_fed_forward || last.is_some_and(|last| last != target.pose);
        if !moved && !self.follower.is_moving() {
            return false;
        }
        let dt = self.options.dt;
        let twist = match last {
            _ if is_fed_forward => desired.feed_forward,
            Some(last) => self.options.task.seen(pose, last.error_to(target.pose) * (1.0 / dt)),
            None => Twist::ZERO,
        };
        self.space.scale(twist, &mut self.follower.twist);
        let moves = |last: Pose| self.options.task.seen(pose, last.error_to(pose) * (1.0 / dt));
        let tool = self.follower.last_pose.replace(pose).map_or(Twist::ZERO, moves);
        self.space.scale(tool, &mut self.follower.tool_twist);
        self.follower.record(moved, &self.error, dt);
        let is_stalled = self.follower.is_stalled(braking, dt);
        if is_stalled && is_fed_forward && norm(&self.error) < norm(&self.x) * dt {
            // Classified by the twist, in place of an error.
            self.twist_follower.is_stalled = true;
            self.space.scale(twist, &mut self.error);
            self.projected_error.copy_from_slice(&self.error);
            self.step_projection.apply(&mut self.projected_error);
        }
        is_stalled
    }
}
