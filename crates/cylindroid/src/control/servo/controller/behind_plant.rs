//! A servo step for a robot that lags: from the configuration to which its commands lead.
//!
//! Checked  tests/it/servo/plant.rs

use super::super::plant::Predictor;
use super::super::step::{Status, Step, Target};
use super::Servo;
use crate::error::Result;
use crate::spatial::{Pose, Rotation};

/// The error of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// To a pose, which moves on while the robot lags.
    Pose,
    /// None: the twist alone counts.
    Twist,
}

impl Servo {
    /// [`Servo::step_with`] for checked input.
    pub(super) fn step_to_pose(
        &mut self,
        q: &[f64],
        target: &Target,
        secondary_velocities: &[f64],
    ) -> Result<Step> {
        self.step_towards(q, target, secondary_velocities, Aim::Pose)
    }

    /// The same for either aim.
    pub(super) fn step_towards(
        &mut self,
        q: &[f64],
        target: &Target,
        secondary_velocities: &[f64],
        aim: Aim,
    ) -> Result<Step> {
        let Some(mut predictor) = self.predictor.take() else {
            return self.step_ideal(q, target, secondary_velocities);
        };
        let result = self.step_behind(&mut predictor, q, target, secondary_velocities, aim);
        self.predictor = Some(predictor);
        result
    }

    fn step_behind(
        &mut self,
        predictor: &mut Predictor,
        q: &[f64],
        target: &Target,
        secondary_velocities: &[f64],
        aim: Aim,
    ) -> Result<Step> {
        let measured = self.load_configuration(q)?;
        predictor.note(self.coupled.as_ref().map_or(q, |c| c.q()));
        let ahead = match aim {
            Aim::Pose => moved(target, predictor.plant().lag()),
            Aim::Twist => *target,
        };
        let predicted = predictor.predict(&self.mechanism);
        let mut step = self.step_ideal(predicted, &ahead, secondary_velocities)?;
        predictor.record(&self.mechanism, &self.rates[..self.mechanism.n()]);
        // The verdict is on the robot, which has not arrived yet.
        self.configuration.copy_from_slice(predictor.measured());
        step.pose = measured;
        if aim == Aim::Pose {
            let error = target.desired(measured, &self.options)?.error;
            (step.position_error, step.orientation_error) =
                (error.linear.norm(), error.angular.norm());
            if step.status == Status::Reached && !self.is_near(step) {
                step.status = Status::Moving;
            }
        }
        Ok(step)
    }

    /// The pose of the tool to which the commands given so far lead.
    pub(super) fn predicted_pose(&mut self, q: &[f64]) -> Result<Pose> {
        let Some(mut predictor) = self.predictor.take() else {
            return self.load_configuration(q);
        };
        let result = self.load_configuration(q).and_then(|_| {
            predictor.note(self.coupled.as_ref().map_or(q, |c| c.q()));
            self.load_configuration(predictor.predict(&self.mechanism))
        });
        self.predictor = Some(predictor);
        result
    }

    /// True if the errors are within tolerance.
    pub(super) fn is_near(&self, step: Step) -> bool {
        let tolerance = self.options.tolerance;
        step.position_error <= tolerance.position && step.orientation_error <= tolerance.orientation
    }
}

/// A target moved by its twist for some time (s).
fn moved(target: &Target, time: f64) -> Target {
    let Target { pose, feed_forward } = *target;
    Target {
        pose: Pose {
            rotation: (Rotation::exp(feed_forward.angular * time) * pose.rotation).renormalised(),
            translation: pose.translation + feed_forward.linear * time,
        },
        feed_forward,
    }
}
