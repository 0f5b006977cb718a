//! Work at configurations in which a session is not.

use cylindroid::Result;

use super::Session;

impl Session {
    /// Works at this configuration; the session is then where it was.
    pub(in super::super) fn elsewhere<T>(
        &mut self,
        q: &[f64],
        work: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        let here = self.state.q().to_vec();
        self.state.set(q)?;
        let done = work(self);
        self.state.set(&here)?;
        done
    }

    /// Joint velocities of the last step of the servo [rad/s or m/s]; `None` without a servo.
    pub(in super::super) fn joint_velocities(&self) -> Option<&[f64]> {
        match (&self.servo, &self.avoidance) {
            (_, Some((_, Ok(avoidance)))) => Some(avoidance.joint_velocities()),
            (Ok(servo), None) => Some(servo.joint_velocities()),
            _ => None,
        }
    }
}
