//! Braking without contact: velocities are commanded only if braking from them ends with all bodies
//! apart.
//!
//! Formula  v, then its mean with braking b from the last step, then b: the first of them whose
//!          braking path is clear (`braking_path.rs`). That of b is the rest of one that was looked
//!          at a step before
//! Valid    robots that move as commanded, from a start at rest with all bodies apart, among obstacles
//!          that rest; closed chains away from type II singularities. Where no path is clear, the
//!          velocities of the solver stand
//! Source   Fraichard & Asama, Inevitable collision states, Advanced Robotics 18 (2004), 1001-1024
//! Checked  tests/it/servo/braking_path.rs, tests/limits/main.rs

use super::braking_path::{Motion, Start};
use super::options::StoppedBy;
use super::task_servo::TaskServo;
use crate::control::servo::{JerkLimitedStop, JointState, acceleration_of};
use crate::error::Result;

/// Shares of the velocities of the solver, the rest braking, that are tried in turn [-].
const SHARES: [f64; 3] = [1.0, 0.5, 0.0];

impl TaskServo {
    /// Replaces the joint velocities of this step, if no braking after them is clear.
    pub(super) fn keep_braking_clear(&mut self) -> Result<()> {
        let Some(collisions) = &mut self.options.collisions else { return Ok(()) };
        let (dt, path, state) = (self.options.dt, &mut self.braking, &self.state);
        if state.q().is_empty() {
            return Ok(());
        }
        let start = Start { state, near: &self.near, margin: collisions.margin };
        let (mut accepted, mut contact) = (None, None);
        for share in SHARES {
            let mut velocities = std::mem::take(&mut path.velocities);
            let mut accelerations = std::mem::take(&mut path.accelerations);
            for (i, v) in velocities.iter_mut().enumerate() {
                let (before, solved, limits) = (self.before[i], self.rates[i], &self.limits[i]);
                if share == 1.0 {
                    *v = solved;
                    continue;
                }
                let bounds = &mut path.bounds[i];
                let slower = if limits.jerk < f64::INFINITY {
                    // `self.bounds` are cut to the velocities that the tasks ask for: not here.
                    let position = state.q().get(i).copied().unwrap_or(0.0);
                    let acceleration = self.accelerations[i];
                    let now = JointState { position, velocity: before, acceleration };
                    *bounds = self.motions.bounds(i, limits, now, dt);
                    JerkLimitedStop::new(limits, before, acceleration, dt).next()
                } else {
                    *bounds = self.bounds[i];
                    (before.abs() - limits.acceleration * dt).max(0.0).copysign(before)
                };
                let braking = bounds.clamp(slower);
                *v = braking + share * (solved - braking);
            }
            if share < 1.0 && self.motions.loops().is_some() {
                // The actuated joints brake, the others follow.
                self.motions.unknowns_of(&velocities, &mut path.unknowns);
                self.motions.velocities(&path.unknowns, &path.bounds, &mut velocities);
            }
            for (i, acceleration) in accelerations.iter_mut().enumerate() {
                let change = velocities[i] - self.before[i];
                *acceleration = acceleration_of(&self.limits[i], self.accelerations[i], change, dt);
            }
            let motion = Motion {
                velocities: &velocities,
                accelerations: &accelerations,
                limits: &self.limits,
                dt,
            };
            let found = if share == 0.0 && path.is_continued(state, collisions) {
                Ok(None)
            } else {
                path.contact(start, &mut collisions.model, motion)
            };
            (path.velocities, path.accelerations) = (velocities, accelerations);
            match found? {
                None => {
                    accepted = Some(share);
                    break;
                }
                Some(pair) => contact = contact.or(Some(pair)),
            }
        }
        path.is_clear = accepted.is_some();
        let solved = &mut self.rates[..path.velocities.len()];
        if let (Some(share), Some(pair)) = (accepted, contact) {
            solved.copy_from_slice(&path.velocities);
            let stop = Some(StoppedBy::Distance { pair });
            for member in self.stacks.iter_mut().flat_map(|s| &mut s.members) {
                member.scale *= share;
                member.stopped_by = member.stopped_by.or(stop);
            }
            self.lowest_stopped_by = self.lowest_stopped_by.or(stop);
            self.motions.unknowns_of(&self.rates, &mut self.last);
        }
        path.revision = collisions.model.revision();
        path.expected.copy_from_slice(state.q());
        let commanded = &self.rates[..path.expected.len()];
        state.mechanism().integrate_in_place(&mut path.expected, commanded, dt);
        Ok(())
    }
}
