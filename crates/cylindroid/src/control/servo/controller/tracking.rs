//! Steps from the actuated joints alone: the passive ones are tracked from step to step.
//!
//! Formula  predicted: the closed configuration of the last step, moved by its velocities; measured
//!          values for the actuated coordinates; then Newton's method on the loop equations, or where
//!          that fails their assembly nearby, the actuated coordinates held (`loop_motions.rs`)
//! Valid    while the actuated joints determine the passive ones: the assembly mode is the one of
//!          the last step. Near a type II singularity, where two meet, the servo stops
//! Checked  tests/it/servo/measured.rs, tests/it/servo/measured_twist.rs

use super::super::step::{Step, Target};
use super::super::twist_step::TwistStep;
use super::Servo;
use crate::error::{Error, Result};
use crate::model::CoordinateKind;
use crate::spatial::Twist;

impl Servo {
    /// One step from the positions of the actuated coordinates alone, in ascending order of their
    /// indices ([`Mechanism::actuated`](crate::model::Mechanism::actuated)) [rad or m]: parallel
    /// robots measure no others. The passive coordinates follow from the loops, near those of the
    /// last step; before the first one, from [`Servo::start_from`] or the home configuration.
    ///
    /// ```
    /// use cylindroid::{Servo, ServoOptions, Vec3};
    ///
    /// let stewart = cylindroid::load("stewart")?;
    /// let mut servo = Servo::new(&stewart, ServoOptions::new(&stewart))?;
    /// let mut legs: Vec<f64> = stewart.actuated().map(|i| stewart.home()[i]).collect();
    /// let mut target = stewart.state(stewart.home())?.pose(stewart.reference())?;
    /// target.translation = target.translation + Vec3::Z * 0.02;
    /// for _ in 0..1000 {
    ///     servo.step_actuated(&legs, target)?;
    ///     let dt = servo.options().dt;
    ///     for (leg, i) in legs.iter_mut().zip(stewart.actuated()) {
    ///         *leg += servo.joint_velocities()[i] * dt;
    ///     }
    /// }
    /// let here = stewart.state(servo.configuration())?.pose(stewart.reference())?;
    /// assert!((here.translation - target.translation).norm() < 1e-3);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// The wrong number of positions or non-finite ones; loops that cannot be closed with them near
    /// the last configuration. The servo is unchanged.
    #[doc(alias = "encoders")]
    pub fn step_actuated(&mut self, actuated: &[f64], target: impl Into<Target>) -> Result<Step> {
        self.step_measured(actuated, &[], target)
    }

    /// [`Servo::step_actuated`] with redundant sensors: positions of passive coordinates that are
    /// measured too, by index [rad or m]. The configuration is the closed one nearest to all measured
    /// positions (least squares, lengths divided by the reach of the mechanism).
    ///
    /// # Errors
    /// As [`Servo::step_actuated`], and for an index that is no angle or length of a passive
    /// coordinate.
    pub fn step_measured(
        &mut self,
        actuated: &[f64],
        sensors: &[(usize, f64)],
        target: impl Into<Target>,
    ) -> Result<Step> {
        self.step_tracked(actuated, sensors, |servo, q| servo.step(q, target))
    }

    /// [`Servo::step_twist`] from the positions of the actuated coordinates alone, as
    /// [`Servo::step_actuated`] takes them: the drives of a parallel robot follow a twist.
    ///
    /// # Errors
    /// As [`Servo::step_actuated`] and [`Servo::step_twist`]. The servo is unchanged: the command is
    /// not taken, and the last one grows no older.
    pub fn step_twist_actuated(
        &mut self,
        actuated: &[f64],
        command: Option<Twist>,
    ) -> Result<TwistStep> {
        self.step_twist_measured(actuated, &[], command)
    }

    /// [`Servo::step_twist_actuated`] with redundant sensors, as [`Servo::step_measured`] has them.
    ///
    /// # Errors
    /// As [`Servo::step_measured`] and [`Servo::step_twist`].
    pub fn step_twist_measured(
        &mut self,
        actuated: &[f64],
        sensors: &[(usize, f64)],
        command: Option<Twist>,
    ) -> Result<TwistStep> {
        self.step_tracked(actuated, sensors, |servo, q| servo.step_twist(q, command))
    }

    /// A step from the configuration that is tracked with these positions.
    fn step_tracked<T>(
        &mut self,
        actuated: &[f64],
        sensors: &[(usize, f64)],
        step: impl FnOnce(&mut Self, &[f64]) -> Result<T>,
    ) -> Result<T> {
        let expected = self.mechanism.actuated().count();
        Error::check_len("actuated positions", expected, actuated.len())?;
        Error::check_finite("actuated positions", actuated)?;
        if let Some(joint) = self.mechanism.loops().iter().find(|l| l.actuated) {
            return Err(Error::Model {
                model: self.mechanism.name().to_owned(),
                culprit: joint.name.clone(),
                message: format!(
                    "loop joint '{}' is actuated and has no coordinate to be measured; cut the loop \
                     at a passive joint",
                    joint.name
                ),
            });
        }
        // Moved by the velocities of the last step.
        let mut q = std::mem::take(&mut self.predicted);
        q.copy_from_slice(&self.configuration);
        self.mechanism.integrate_in_place(&mut q, self.joint_velocities(), self.options.dt);
        for (i, x) in self.mechanism.actuated().zip(actuated) {
            q[i] = *x;
        }
        self.track(true);
        let done = match self.fit(&mut q, sensors) {
            Ok(()) => step(self, &q),
            Err(error) => Err(error),
        };
        let done = done.map_err(|error| self.lost(&q, error));
        self.track(false);
        self.predicted = q;
        done
    }

    /// The error of a step from `q`: of loops that are open, in words of the actuated joints, since the
    /// user gave no `q`.
    #[cold]
    fn lost(&self, q: &[f64], error: Error) -> Error {
        let Error::InvalidOption { option: "q", value: open, .. } = error else { return error };
        let change =
            |i: &usize| (q[*i] - self.configuration[*i]).abs() / self.mechanism.unit_of(*i);
        let farthest = self.mechanism.actuated().max_by(|a, b| change(a).total_cmp(&change(b)));
        let value = farthest.map_or_else(String::new, |i| {
            let (name, unit) = (self.name_of(i), self.mechanism.coordinates()[i].kind.unit());
            let before = self.configuration[i];
            format!("{name} at {:.6} {unit} ({before:.6} {unit} in the last configuration)", q[i])
        });
        Error::InvalidOption {
            option: "actuated positions",
            value,
            reason: format!(
                "{open} nearby, too far to track the passive joints of '{}'; measure again, or select \
                 a configuration with these positions by `start_from`",
                self.mechanism.name()
            ),
        }
    }

    /// The name of a coordinate for messages; its index if there is none.
    fn name_of(&self, i: usize) -> String {
        let coordinate = self.mechanism.coordinates().get(i);
        coordinate.map_or_else(|| i.to_string(), |c| format!("'{}'", c.name))
    }

    /// Replaces `q` by the closed configuration nearest to its actuated positions and the sensors.
    fn fit(&mut self, q: &mut [f64], sensors: &[(usize, f64)]) -> Result<()> {
        if sensors.is_empty() {
            return Ok(());
        }
        let coordinates = self.mechanism.coordinates();
        for &(i, position) in sensors {
            if !position.is_finite() {
                let what = format!("position of the sensor of {}", self.name_of(i));
                return Err(Error::NotFinite { what, value: position });
            }
            let reason = match coordinates.get(i) {
                None => "there is no such coordinate",
                Some(c) if c.actuated => {
                    "it is actuated, and among the actuated positions; omit it"
                }
                Some(c) if matches!(c.kind, CoordinateKind::Angle | CoordinateKind::Length) => {
                    continue;
                }
                Some(_) => "it is no angle or length; omit it",
            };
            return Err(Error::InvalidOption {
                option: "sensors",
                value: self.name_of(i),
                reason: format!("{reason}; sensors measure passive angles and lengths"),
            });
        }
        let Some(coupled) = &mut self.coupled else { return Ok(()) };
        let fit = self.sensor_fit.get_or_insert_with(|| Box::new(coupled.sensor_fit()));
        fit.measured.fill(f64::NAN);
        for i in self.mechanism.actuated() {
            fit.measured[i] = q[i];
        }
        for &(i, position) in sensors {
            fit.measured[i] = position;
        }
        coupled.close_measured(q)?;
        coupled.fit(fit)?;
        q.copy_from_slice(coupled.q());
        Ok(())
    }

    fn track(&mut self, is_tracked: bool) {
        if let Some(coupled) = &mut self.coupled {
            coupled.is_tracked = is_tracked;
        }
    }

    /// The configuration from which [`Servo::step_actuated`] tracks the passive joints next; it
    /// selects the assembly mode.
    ///
    /// # Errors
    /// A `q` of the wrong size or non-finite; loops that are open.
    pub fn start_from(&mut self, q: &[f64]) -> Result<()> {
        self.mechanism.check_q("q", q)?;
        self.load_configuration(q)?;
        self.reset();
        self.note_configuration(q);
        Ok(())
    }

    /// Stores the configuration of this step: the measured one, its loops closed.
    pub(super) fn note_configuration(&mut self, q: &[f64]) {
        self.configuration.copy_from_slice(self.coupled.as_ref().map_or(q, |c| c.q()));
    }

    /// The configuration of the last step: the measured one, its loops closed.
    #[must_use]
    pub fn configuration(&self) -> &[f64] {
        &self.configuration
    }
}
