//! Twists that frames follow beside other tasks: velocity mode of a servo of many tasks.
//!
//! Formula  J q' = t: the target is the present pose, so that there is no error, and t the
//!          feed-forward
//! Watchdog a command holds for `timeout` seconds, then t is zero, as of `Servo::step_twist`
//! Units    m/s, rad/s; world axes, at the tool
//! Why so   the task keeps its level, its weight and its components, and the others go on. A task with
//!          a gain of zero has the velocity of its target too, but nothing ends it
//! Checked  tests/it/servo/task_twist.rs

use super::objective::TaskObjective;
use super::task_servo::TaskServo;
use super::twist_command::TwistCommand;
use crate::control::servo::Target;
use crate::error::{Error, Result};
use crate::spatial::Twist;
use crate::tolerance::MAX_MAGNITUDE;

impl TaskServo {
    /// Lets the frame of the task of this name follow a twist (world axes, at its tool) from the next
    /// step on, instead of its target; the other tasks go on. Without a new command it holds for
    /// `timeout` (s; infinite: always), then the frame comes to rest: a lost connection stops it.
    /// [`TaskServo::objective_mut`] of the task ends it, [`TaskServo::reset`] of all tasks.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names; a task that is not [`TaskObjective::Frame`]; a
    /// twist that is not finite, a timeout that is not positive.
    pub fn command_twist(&mut self, name: &str, twist: Twist, timeout: f64) -> Result<()> {
        Error::check_within("commanded twist", &twist.to_array(), MAX_MAGNITUDE)?;
        let refuse = |option, value: String, reason: &str| {
            Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
        };
        if timeout.is_nan() || timeout <= 0.0 {
            let reason = "it must be positive; infinity means that a command holds always";
            return refuse("timeout", timeout.to_string(), reason);
        }
        let place = self.place(name)?;
        if !matches!(self.tasks[place].objective, TaskObjective::Frame { .. }) {
            let reason = "it is no task of a frame in the world, which alone follows a twist";
            return refuse("task", name.to_owned(), reason);
        }
        self.twists[place] = Some(TwistCommand { twist, timeout, age: 0.0 });
        Ok(())
    }

    /// The twist that the next step of a task follows: zero after the timeout; none without a command.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn commanded_twist(&self, name: &str) -> Result<Option<Twist>> {
        Ok(self.twists[self.place(name)?].as_ref().map(TwistCommand::desired))
    }

    /// The place of a task among all.
    pub(super) fn place(&self, name: &str) -> Result<usize> {
        let names = || self.tasks.iter().map(|task| task.name.as_str());
        names().position(|own| own == name).ok_or_else(|| Error::unknown("task", name, names()))
    }

    /// Targets of the tasks that follow twists, at the configuration of the state.
    pub(super) fn load_twists(&mut self) {
        for (task, command) in self.tasks.iter_mut().zip(&self.twists) {
            if let (Some(command), TaskObjective::Frame { end_effector, target, .. }) =
                (command, &mut task.objective)
            {
                let pose = self.state.pose_of(*end_effector);
                *target = Target { pose, feed_forward: command.desired() };
            }
        }
    }

    /// Another step of the commands.
    pub(super) fn age_twists(&mut self) {
        for command in self.twists.iter_mut().flatten() {
            command.age += self.options.dt;
        }
    }
}
