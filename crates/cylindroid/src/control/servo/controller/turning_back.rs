//! The end of a motion: joints that accelerate slowly brake before the tool turns back.
//!
//! Formula  all joints brake together: from velocities v they rest at q + w v, w = T / 2 + dt, T the
//!          longest of their stopping times. The motion along x, what is left of the error or the twist,
//!          is g = x . J v, now and where they rest. If it changes its sign on the way, the tool comes
//!          back by about w g_rest^2 / (2 (g - g_rest) |x|), in scaled task coordinates. Where this is more
//!          than `NEGLIGIBLE_WAY_BACK`, v lies between the braked velocities of the last step and those
//!          that were to follow, as near to these as it may; where the tool moves back already, whichever
//!          of the two moves it back less
//! Valid    trees of joints with one coordinate and with acceleration limits
//! Why so   a step knows the task where it is. Joints that cannot stop there pass the place where the
//!          tool no longer moves along its twist or towards its target, and it swings
//! Checked  tests/it/servo/twist.rs, tests/it/servo/edge.rs, tests/it/servo/just_beyond.rs

use super::super::projection::TaskProjection;
use super::super::step::{Aim, Target};
use super::super::stopping::{NEGLIGIBLE_WAY_BACK, SHARE_HALVINGS, stopping_time};
use super::Servo;
use super::edge_aim::TRACKED;
use crate::control::solver::saturation::brake;
use crate::linalg::{dot, norm};
use crate::scalar::largest;
use crate::spatial::{Pose, Twist};

impl Servo {
    /// What the joints of this step follow to its end, if they must brake before it.
    pub(super) fn load_ending(&mut self, aim: Aim) {
        let is_whole = self.options.projection == TaskProjection::Orthogonal;
        let counts = self.accelerates && self.nearest_pose.is_some() && is_whole;
        self.ending = match (aim, self.edge_aim) {
            _ if !counts => None,
            (Aim::Twist(twist), _) => (twist != Twist::ZERO).then_some(aim),
            (Aim::Target(target), Some(edge)) if edge.is_ahead => {
                Some(Aim::Twist(target.feed_forward))
            }
            (Aim::Target(target), Some(edge)) => {
                Some(Aim::Target(Target { pose: edge.pose, ..target }))
            }
            (Aim::Target(target), None) => {
                let is_close = norm(&self.projected_error) <= TRACKED;
                let rests = target.feed_forward == Twist::ZERO;
                (rests && !is_close).then_some(aim)
            }
        };
    }

    /// The motion of a tool at this pose that is asked for, scaled, into `edge_error`.
    fn load_asked(&mut self, aim: Aim, pose: Pose) {
        let twist = match aim {
            Aim::Twist(twist) => twist,
            Aim::Target(target) => pose.error_to(target.pose),
        };
        self.space.scale(self.options.task.seen(pose, twist), &mut self.edge_error);
    }

    /// True if the primary and secondary velocities would carry the tool along its twist and back.
    pub(super) fn will_turn_back(&mut self, q: &[f64]) -> bool {
        let Some(aim @ Aim::Twist(_)) = self.ending else { return false };
        let mut trial = std::mem::take(&mut self.trial);
        let both = self.primary.iter().zip(&self.secondary);
        trial.iter_mut().zip(both).for_each(|(t, (a, b))| *t = a + b);
        let now = self.along(aim, &trial);
        let turns = self.turns_back(aim, q, (&trial, now));
        self.trial = trial;
        turns
    }

    /// The part of the motion with these velocities (scaled) along what is asked.
    fn along(&mut self, aim: Aim, rates: &[f64]) -> f64 {
        self.load_asked(aim, self.chain.pose());
        self.task.mul_vec_into(rates, &mut self.achieved_twist);
        dot(&self.achieved_twist, &self.edge_error)
    }

    /// True if the joints, braked from these velocities (scaled), which move the tool `now` along what is
    /// asked, would carry it back.
    fn turns_back(&mut self, aim: Aim, q: &[f64], (rates, now): (&[f64], f64)) -> bool {
        if now <= 0.0 {
            return false;
        }
        let joints = rates.iter().zip(&self.space.columns);
        let stops = joints.clone().zip(&self.limits);
        let time = stops.fold(0.0_f64, |most, ((rate, column), limits)| {
            most.max(stopping_time((rate * column).abs(), limits))
        });
        let way = 0.5 * time + self.options.dt;
        self.rest_q.copy_from_slice(q);
        for ((rate, column), &c) in joints.zip(self.chain.coordinates()) {
            self.rest_q[c] += rate * column * way;
        }
        let pose = self.rest.set(&self.rest_q);
        self.space.load(&self.rest, &mut self.rest_task);
        self.load_asked(aim, pose);
        self.rest_task.mul_vec_into(rates, &mut self.achieved_twist);
        let then = dot(&self.achieved_twist, &self.edge_error);
        // The way back, of a part of the motion that falls evenly.
        let back = 0.5 * then * then / (now - then) * way;
        then < 0.0 && back > NEGLIGIBLE_WAY_BACK * norm(&self.edge_error)
    }

    /// Slows the velocities of the step (`primary`) such that the joints can stop in time. True if they
    /// had to be slowed or move the tool back: they say nothing about a singularity then.
    pub(super) fn brake_in_time(&mut self, q: &[f64]) -> bool {
        let Some(aim) = self.ending else { return false };
        let mut rates = std::mem::take(&mut self.primary);
        let now = self.along(aim, &rates);
        let slows = now < 0.0 || self.turns_back(aim, q, (&rates, now));
        if slows {
            let mut braked = std::mem::take(&mut self.secondary);
            brake(&self.last, &self.bounds, &mut braked);
            let then = self.along(aim, &braked);
            let mix = |share: f64, out: &mut [f64], rates: &[f64]| {
                for ((out, b), r) in out.iter_mut().zip(&braked).zip(rates) {
                    *out = b + share * (r - b);
                }
            };
            let mut trial = std::mem::take(&mut self.trial);
            let share = if now < 0.0 {
                f64::from(u8::from(then <= now))
            } else {
                largest(0.0, 1.0, SHARE_HALVINGS, |share| {
                    mix(share, &mut trial, &rates);
                    !self.turns_back(aim, q, (&trial, then + share * (now - then)))
                })
            };
            mix(share, &mut trial, &rates);
            rates.copy_from_slice(&trial);
            (self.trial, self.secondary) = (trial, braked);
        }
        self.primary = rates;
        slows
    }
}
