//! A session whose configuration a program sets: its servo pauses, and the target remains where
//! somebody put it.

use cylindroid::Result;

use super::Session;

impl Session {
    /// Sets the configuration as it is, loops closed or not, and pauses the servo. Until somebody
    /// has placed the target it is at the tool.
    pub(in super::super) fn follow_program(&mut self, q: &[f64]) -> Result<()> {
        self.state.set(q)?;
        if !self.is_target_placed {
            self.target = self.state.pose(self.options.end_effector)?;
        }
        (self.is_playing, self.is_followed) = (false, true);
        self.self_motion = None;
        self.wake();
        Ok(())
    }

    /// True if a program set the configuration last.
    pub(in super::super) fn is_followed(&self) -> bool {
        self.is_followed
    }
}
