//! The velocities of a step in which joints may meet limits: those of the linearised task within its
//! bounds, or of an escape where it makes no progress.
//!
//! Checked  tests/it/servo/limits.rs, tests/it/servo/escape.rs, tests/it/servo/just_beyond.rs

use super::super::edge::Edge;
use super::super::escape::Linearised;
use super::super::projection::TaskProjection;
use super::super::saddle::AT_REST;
use super::super::stall::BrakingState;
use super::Servo;
use crate::control::solver::saturation::{FED_FORWARD, Saturation};
use crate::error::{Error, Result};
use crate::linalg::{dot, norm};

impl Servo {
    /// Bounds, computes and stores the joint velocities; where nothing is commanded, all joints brake.
    pub(super) fn store_limited_rates(
        &mut self,
        q: &[f64],
        brakes: bool,
    ) -> Result<(Saturation, BrakingState)> {
        self.load_bounds();
        let mut saturation = self.saturate(brakes)?;
        Error::check_finite("joint velocities", &self.primary)?;
        let share = self.progress();
        let mut slows = false;
        if share.is_some() && self.escape() {
            saturation = Saturation { scale: 0.0, direction_lost: true };
        } else {
            slows = self.brake_in_time(q);
        }
        self.keep_speed();
        let braking = self.store_rates();
        if let Some(escape) = &mut self.escape {
            match share {
                Some(share) if !braking.accelerating && !slows => {
                    escape.progress.record(share, self.options.dt)
                }
                Some(_) => {}
                None => escape.reset(),
            }
        }
        self.load_achieved_twist();
        self.note_limits();
        Ok((saturation, braking))
    }

    /// The share of the desired motion that the linearised task achieves; `None` if nothing is left to
    /// do, no configuration can do it, or joints head for the nearest pose: on their way the task makes
    /// little progress too. Those without self-motions may rest before it, at a saddle of the error.
    fn progress(&mut self) -> Option<f64> {
        let escapes = self.escape.as_ref().is_some_and(|escape| escape.progress.is_lost);
        let rests = norm(&self.last) < AT_REST;
        let may_be_lost = !self.has_self_motions() && (rests || escapes);
        let is_whole = self.options.projection == TaskProjection::Orthogonal;
        if self.edge_aim.is_some() && !may_be_lost || self.is_out_of_reach() || !is_whole {
            return None;
        }
        self.load_achieved_twist();
        let gain = self.options.gain.least();
        let escape = self.escape.as_mut()?;
        if norm(&self.x) > FED_FORWARD * gain * norm(&self.projected_error) {
            escape.error.iter_mut().zip(&self.x).for_each(|(e, x)| *e = x / gain);
        } else {
            escape.error.copy_from_slice(&self.projected_error);
        }
        let size = dot(&escape.error, &escape.error);
        let tolerance = self.options.tolerance;
        let negligible = tolerance.position / self.options.length + tolerance.orientation;
        (size.sqrt() > negligible).then(|| dot(&self.achieved_twist, &escape.error) / (gain * size))
    }

    /// Replaces the velocities of a task that makes no progress, if a motion of the joints opens a
    /// way.
    fn escape(&mut self) -> bool {
        let Some(escape) = &mut self.escape else { return false };
        let task = Linearised {
            j: &self.task,
            svd: &self.svd,
            bounds: &self.bounds,
            last: &self.last,
            gain: self.options.gain.least(),
            method: self.method,
            size: norm(&self.x),
        };
        let mut edge = Edge {
            chain: &self.chain,
            space: &self.space,
            limits: &self.limits,
            dt: self.options.dt,
            hessian: &mut self.hessian,
            way: None,
            gain_of_way: None,
        };
        // Joints that brake for the nearest pose stretch the arm; nothing leads it back inside.
        let folds = self.edge_aim.is_none() && escape.folds_at_limit(task, &mut edge);
        if !(folds || escape.progress.is_lost) || !escape.solve(task, &mut edge, folds) {
            return false;
        }
        for ((out, rate), bound) in
            self.primary.iter_mut().zip(&escape.saddle.rates).zip(&self.bounds)
        {
            *out = bound.clamp(*rate);
        }
        true
    }
}
