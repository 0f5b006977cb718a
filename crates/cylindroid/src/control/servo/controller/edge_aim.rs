//! The pose towards which a motion ends, where the joints must stop if it is out of reach.
//!
//! Formula  the target; of a twist v, the tool moved by s T v, T = 1 / gain + max |v_i| / A_i, in which
//!          all joints stop, s the share of v within the speeds of the joints
//! Units    s, scaled task coordinates
//! Valid    of trees a target is out of reach where the length of the chain proves it, or the search has
//!          found the nearest pose and no other configuration that reaches it (`elsewhere.rs`)
//! Why so   a twist has no end. Joints with small acceleration limits must brake before the edge of
//!          the workspace, or they swing through it
//! Checked  tests/it/servo/edge.rs, tests/it/servo/just_beyond.rs, tests/it/servo/closed_edges.rs,
//!          tests/it/servo/twist.rs

use super::super::loop_edge::LoopSurroundings;
use super::super::nearest_pose::{EdgeAim, Surroundings};
use super::super::projection::TaskProjection;
use super::super::step::{Aim, Target};
use super::Servo;
use crate::control::solver::saturation::FED_FORWARD;
use crate::error::Result;
use crate::kinematics::ReferenceFrame;
use crate::linalg::{dot, norm};
use crate::spatial::Pose;

/// A pose is out of reach if a larger share of its error is left at the nearest one [-]: more than
/// where the search of one in reach has nearly arrived.
const LEFT: f64 = 0.1;

/// Errors below this are those of poses in reach (scaled) [-].
const NONE_LEFT: f64 = 1e-5;

/// Errors up to this are those of targets that are tracked, of arms where no singularity is near (scaled)
/// [-]: joints that follow them at the usual gain stop within a hundredth of a radian at 0.5 rad/s^2.
pub(super) const TRACKED: f64 = 0.02;

/// Velocities of joints this many times as large as that of the task approach an edge (scaled) [-].
const AMPLIFIED: f64 = 3.0;

impl Servo {
    /// True if the components of the task turn with the tool.
    pub(super) fn has_turning_axes(&self) -> bool {
        self.options.task.axes == ReferenceFrame::Local
    }

    /// Finds the pose towards which the motion of this step ends, if joints must brake before it.
    pub(super) fn load_edge_aim(&mut self, target: &Target, pose: Pose) {
        self.edge_aim = None;
        let is_out_of_reach = self.coupled.is_none() && self.is_out_of_reach();
        let is_coupled = self.coupled.is_some();
        if is_coupled && self.loop_edge.is_none() {
            return;
        }
        let gain = self.options.gain.least();
        let is_fed_forward = norm(&self.x) > FED_FORWARD * gain * norm(&self.projected_error);
        let is_weak = self.size_of_rates() > AMPLIFIED * norm(&self.x);
        let is_near = is_weak || self.kept.iter().any(|kept| !kept);
        // Closed chains swing at the edge without acceleration limits too. Where they only track a
        // target they pay for no search.
        let is_close = !is_fed_forward && norm(&self.projected_error) <= TRACKED;
        // A target beyond reach stays so where the tool comes near to it.
        let is_the_end = self.elsewhere.as_ref().is_some_and(|elsewhere| elsewhere.is_the_end());
        let is_beyond = is_out_of_reach || is_the_end;
        let is_tracked = is_close && (is_coupled || !is_near && !is_beyond);
        if let Some(elsewhere) = self.elsewhere.as_mut().filter(|_| is_tracked) {
            elsewhere.note_in_reach();
        }
        if is_tracked || !(self.accelerates || is_coupled && is_near) {
            return;
        }
        if is_fed_forward {
            // Tasks beyond the motions of an arm have no edge.
            if self.generic_rank < self.x.len() || !is_near {
                return;
            }
            let stops = self.rates.iter().zip(0..).fold(0.0_f64, |most, (rate, i)| {
                let limits = self.chain.coordinates().iter().position(|c| *c == i);
                let a = limits.map_or(f64::INFINITY, |i| self.limits[i].acceleration);
                most.max(rate.abs() / a)
            });
            let time = 1.0 / gain + stops;
            let slowed = self.share_within_speeds(is_coupled);
            let aim = Aim::Target(Target { pose, ..*target });
            let Aim::Target(ahead) = aim.after(slowed * time) else {
                return;
            };
            let error = self.options.task.seen(pose, pose.error_to(ahead.pose));
            self.space.scale(error, &mut self.edge_error);
            self.step_projection.apply(&mut self.edge_error);
            self.edge_aim = Some(EdgeAim {
                pose: ahead.pose,
                gain: 1.0 / time,
                is_out_of_reach: false,
                is_ahead: true,
            });
        } else if is_out_of_reach || is_coupled || self.elsewhere.is_some() {
            self.edge_error.copy_from_slice(&self.projected_error);
            self.edge_aim =
                Some(EdgeAim { pose: target.pose, gain, is_out_of_reach, is_ahead: false });
        }
    }

    /// The norm of the unbounded velocities of the joints, of closed chains of those with drives, lengths
    /// over that of the mechanism: passive joints turn fast without an edge.
    fn size_of_rates(&self) -> f64 {
        let edge = self.loop_edge.as_ref();
        let counts = |i: usize| edge.is_none_or(|edge| edge.is_actuated(i));
        let unit = |i: usize| self.mechanism.unit_of(self.place(i));
        let rates = self.primary.iter().zip(&self.space.columns).enumerate();
        let squares = rates
            .filter(|(i, _)| counts(*i))
            .map(|(i, (rate, column))| (rate * column / unit(i)).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// The share of the task within the speeds of the joints: of closed chains as fast as where the task
    /// is no more weak, of arms, whose self-motions swing on longer ways, as fast as here.
    fn share_within_speeds(&self, is_coupled: bool) -> f64 {
        let most = AMPLIFIED * norm(&self.x);
        let scaled = self.primary.iter().zip(&self.space.columns).zip(&self.limits).enumerate();
        scaled.fold(1.0, |share, (i, ((rate, column), limits))| {
            let unit = self.mechanism.unit_of(self.place(i));
            let speed = if is_coupled { most * unit } else { column * rate.abs() };
            if speed > 0.0 { f64::min(share, limits.velocity / speed) } else { share }
        })
    }

    /// Searches the nearest pose; where it is not the end of the motion, joints need not brake for it.
    pub(super) fn search_edge(&mut self, q: &[f64]) -> Result<()> {
        if !self.ends_at_the_edge(q)? {
            self.edge_aim = None;
        }
        Ok(())
    }

    /// True if the motion ends at the nearest pose, as far as the search has come.
    fn ends_at_the_edge(&mut self, q: &[f64]) -> Result<bool> {
        let Some(aim) = self.edge_aim else { return Ok(false) };
        let is_whole = self.options.projection == TaskProjection::Orthogonal;
        let present = dot(&self.edge_error, &self.edge_error);
        let least = NONE_LEFT.max(LEFT * present.sqrt());
        match (&self.coupled, &mut self.loop_edge, &mut self.nearest_pose) {
            (Some(coupled), Some(edge), _) if is_whole => {
                let around = LoopSurroundings {
                    task: self.options.task,
                    limits: &self.limits,
                    dt: self.options.dt,
                };
                let here = (coupled.q(), &coupled.coupling.motions, &self.task);
                let present = (present, NONE_LEFT);
                Ok(edge.search(here, aim.pose, present, around)? && edge.left() > least)
            }
            (None, _, Some(nearest_pose)) if is_whole => {
                let mut around = Surroundings {
                    task: self.options.task,
                    space: &mut self.space,
                    limits: &self.limits,
                    hessian: &mut self.hessian,
                };
                nearest_pose.search(q, aim.pose, (present, NONE_LEFT), &mut around);
                let least = if nearest_pose.has_arrived() { NONE_LEFT } else { least };
                let is_found = nearest_pose.known_way().is_some() && nearest_pose.left() > least;
                let is_open = !aim.is_ahead && !aim.is_out_of_reach;
                let Some(elsewhere) = self.elsewhere.as_mut().filter(|_| is_open) else {
                    return Ok(aim.is_out_of_reach || is_found);
                };
                if nearest_pose.left() <= NONE_LEFT {
                    elsewhere.note_in_reach();
                } else if is_found {
                    elsewhere.move_on(aim.pose, NONE_LEFT, &mut around);
                    let is_overrun = nearest_pose.is_overrun(q, &self.rates, &self.limits);
                    elsewhere.note_out_of_reach(is_overrun);
                }
                Ok(elsewhere.is_the_end())
            }
            _ => Ok(aim.is_out_of_reach),
        }
    }
}
