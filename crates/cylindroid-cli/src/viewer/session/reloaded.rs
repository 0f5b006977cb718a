//! A session of another version of its model, with everything of this one that fits it.

use std::sync::Arc;

use cylindroid::{Mechanism, Result};

use super::super::inverse_parameters::invert_by;
use super::super::reaching::assembled;
use super::super::start::Start;
use super::Session;

impl Session {
    /// True if it began from this start.
    pub(in super::super) fn is_of(&self, start: &Arc<Start>) -> bool {
        Arc::ptr_eq(&self.start, start)
    }

    /// A session of this start that goes on where this one is. Joints keep their values by their
    /// names where the limits permit them and the loops close; frame, task, inverse, actuated
    /// joints, obstacles and avoidance are kept as far as the model permits, and so are the models
    /// beside it. The target is at the tool.
    pub(in super::super) fn reloaded(&self, start: &Arc<Start>) -> Result<Self> {
        let mut new = Self::new(Arc::clone(start))?;
        new.take_choices(self);
        let kept = self.q_for(start).map(|q| assembled(&new.mechanism, &q));
        let q = kept.and_then(Result::ok).unwrap_or_else(|| start.q.clone());
        new.stand(&q)?;
        new.take_method(self);
        new.take_obstacles(self);
        new.beside.clone_from(&self.beside);
        if new.avoided() != self.avoided() {
            let _ = new.avoid(self.avoided());
        }
        new.stand(&q)?;
        (new.is_playing, new.is_followed) = (self.is_playing, self.is_followed);
        Ok(new)
    }

    /// The configuration for another version of the model; `None` at the initial configuration,
    /// which is then that of the other version.
    fn q_for(&self, start: &Start) -> Option<Vec<f64>> {
        if self.state.q() == self.start.q {
            return None;
        }
        let mut q = start.q.clone();
        for (value, new) in q.iter_mut().zip(start.mechanism.coordinates()) {
            let mut own = self.mechanism.coordinates().iter().zip(self.state.q());
            let same = own.find(|(c, _)| c.name == new.name && c.kind == new.kind);
            if let Some((_, x)) = same
                && (new.limits.lower..=new.limits.upper).contains(x)
            {
                *value = *x;
            }
        }
        Some(q)
    }

    /// What the user chose in place of the start's; a choice that the model refuses is left out.
    fn take_choices(&mut self, old: &Self) {
        let actuated = actuated(&old.mechanism);
        if self.mechanism.is_closed() && actuated != self::actuated(&old.start.mechanism) {
            let _ = self.drive_by(&actuated);
        }
        if old.options.end_effector.frame != old.start.end_effector.frame
            && let Ok(frame) = self.mechanism.frame(old.frame())
        {
            let _ = self.choose_frame(frame);
        }
        if old.task != self.task {
            let _ = self.choose_task(old.task.clone());
        }
    }

    fn take_method(&mut self, old: &Self) {
        let (choice, options) = (old.method.choice(), self.options.clone());
        if let Ok((method, options)) = invert_by(choice, &self.state, options, || self.best_pitch())
        {
            let _ = self.choose_method(method, options);
        }
    }

    fn take_obstacles(&mut self, old: &Self) {
        if self.obstacles() == old.obstacles() {
            return;
        }
        for obstacle in self.obstacles().to_vec() {
            let _ = self.remove_obstacle(&obstacle.name);
        }
        for obstacle in old.obstacles() {
            let _ = self.add_obstacle(obstacle.clone());
        }
    }
}

/// The names of the actuated joints, those of loops as well.
fn actuated(mechanism: &Mechanism) -> Vec<String> {
    let joints = mechanism.joints().iter().filter(|j| j.actuated).map(|j| &j.name);
    let loops = mechanism.loops().iter().filter(|l| l.actuated).map(|l| &l.name);
    joints.chain(loops).cloned().collect()
}
