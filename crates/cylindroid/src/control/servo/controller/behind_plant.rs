//! A servo step for a robot that lags: from the configuration to which its commands lead.
//!
//! Checked  tests/it/servo/plant.rs

use super::super::limits::BrakingMargin;
use super::super::plant::Predictor;
use super::super::step::{Aim, Status, Step};
use super::Servo;
use crate::error::Result;

impl Servo {
    /// [`Servo::step_with`] for checked input, towards a target or along a twist.
    pub(super) fn step_towards(
        &mut self,
        q: &[f64],
        aim: Aim,
        secondary_velocities: &[f64],
    ) -> Result<Step> {
        let Some(mut predictor) = self.predictor.take() else {
            return self.step_ideal(q, aim, secondary_velocities);
        };
        let result = self.step_behind(&mut predictor, q, aim, secondary_velocities);
        self.predictor = Some(predictor);
        result
    }

    fn step_behind(
        &mut self,
        predictor: &mut Predictor,
        q: &[f64],
        aim: Aim,
        secondary_velocities: &[f64],
    ) -> Result<Step> {
        let measured = self.load_configuration(q)?;
        predictor.note(self.coupled.as_ref().map_or(q, |c| c.q()));
        let ahead = aim.after(predictor.plant().lag());
        predictor.predict(&self.mechanism, |q, measured| match &mut self.coupled {
            Some(coupled) => coupled.close_ahead(q, measured),
            None => Ok(()),
        })?;
        self.keep_off_limits(predictor);
        let mut step = self.step_ideal(predictor.q(), ahead, secondary_velocities)?;
        predictor.record(&self.mechanism, &self.rates[..self.mechanism.n()]);
        // The verdict is on the robot, which has not arrived yet.
        self.configuration.copy_from_slice(predictor.measured());
        step.pose = measured;
        if let Aim::Target(target) = aim {
            let error = target.desired(measured, &self.options)?.error;
            (step.position_error, step.orientation_error) =
                (error.linear.norm(), error.angular.norm());
            if step.status == Status::Reached && !self.is_near(step) {
                step.status = Status::Moving;
            }
        }
        Ok(step)
    }

    /// Adapts the position limits to what the predicted configuration may be off.
    fn keep_off_limits(&mut self, predictor: &Predictor) {
        if predictor.plant().noise == 0.0 {
            return;
        }
        let coordinates = self.chain.coordinates().iter().copied();
        predictor.keep_off(&self.mechanism, coordinates, &mut self.limits);
        let (space, dt) = (&self.space, self.options.dt);
        for (i, (margin, limits)) in self.braking_margins.iter_mut().zip(&self.limits).enumerate() {
            *margin = BrakingMargin::new(limits, dt, space.is_locked(i));
        }
    }

    /// True if the errors are within tolerance.
    pub(super) fn is_near(&self, step: Step) -> bool {
        let tolerance = self.options.tolerance;
        step.position_error <= tolerance.position && step.orientation_error <= tolerance.orientation
    }
}
