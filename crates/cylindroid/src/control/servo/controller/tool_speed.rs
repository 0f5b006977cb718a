//! The largest speeds of the tool, kept by what a step commands: the commanded twist keeps them, but an
//! escape, a projection and joints that brake late do not.
//!
//! Formula  joints that move with velocities v and brake together, within T, have the velocities (1 - u) v
//!          and are w v further, w = u dt + (u - u^2 / 2) T, at the share u of that time. The tool then has
//!          the twist (1 - u) (J v + w v . dJ/dq v), at most the largest speeds at each of `SHARES`. If not,
//!          v is divided by the excess of J v; if that is not enough, or exceeds the bounds of the joints,
//!          v lies between the braked velocities of the last step and these, as near to these as it may.
//!          A joint with the acceleration a of its velocity and a jerk limit J comes to v + a |a| / 2 J
//!          first, after |a| / J
//! Shapes   J: 6 x n of the tool, dJ/dq: n of 6 x n       Units    m/s, rad/s
//! Valid    trees; finite speeds only: otherwise no velocity is changed. With limits of the jerk to within a
//!          tenth, near singularities half
//! Why so   near a stretched arm the tool hardly moves, however fast the joints are, and then moves faster
//!          than weak joints can brake
//! Checked  tests/it/servo/tool_speed.rs

use super::super::stopping::stopping_time;
use super::Servo;
use crate::control::solver::saturation::brake;
use crate::kinematics::ReferenceFrame;
use crate::linalg::Matrix;
use crate::scalar::largest;
use crate::spatial::Twist;

/// Shares of the time of braking at which the speed is checked [-].
const SHARES: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// Halvings of the interval in which the share of the velocities lies.
const HALVINGS: usize = 12;

/// Share of a largest speed by which it counts as kept although it is exceeded [-].
const ROUNDING: f64 = 1e-9;

impl Servo {
    /// Slows the velocities of the step (`primary`) such that the tool keeps its largest speeds.
    pub(super) fn keep_speed(&mut self) {
        let speed = self.options.speed;
        let is_bounded = speed.linear < f64::INFINITY || speed.angular < f64::INFINITY;
        if !is_bounded || self.coupled.is_some() {
            return;
        }
        self.space.load_whole(&self.chain);
        self.chain.hessian_into(ReferenceFrame::LocalWorldAligned, &mut self.hessian);
        if self.speed_excess(&self.primary, &SHARES) <= 1.0 + ROUNDING {
            return;
        }
        let mut rates = std::mem::take(&mut self.primary);
        let scale = self.speed_excess(&rates, &[0.0]).max(1.0);
        for (rate, bound) in rates.iter_mut().zip(&self.bounds) {
            *rate = bound.clamp(*rate / scale);
        }
        let mut braked = std::mem::take(&mut self.secondary);
        let mut trial = std::mem::take(&mut self.trial);
        brake(&self.last, &self.bounds, &mut braked);
        let mut keeps = |share: f64| {
            for ((t, b), rate) in trial.iter_mut().zip(&braked).zip(&rates) {
                *t = b + share * (rate - b);
            }
            self.speed_excess(&trial, &SHARES) <= 1.0 + ROUNDING
        };
        if !keeps(1.0) {
            let share = largest(0.0, 1.0, HALVINGS, &mut keeps);
            keeps(share);
            rates.copy_from_slice(&trial);
        }
        (self.primary, self.secondary, self.trial) = (rates, braked, trial);
    }

    /// True if these velocities (scaled) exceed the largest speeds of the tool now.
    pub(super) fn exceeds_speed(&mut self) -> bool {
        let speed = self.options.speed;
        if speed.linear == f64::INFINITY && speed.angular == f64::INFINITY {
            return false;
        }
        self.space.load_whole(&self.chain);
        let mut trial = std::mem::take(&mut self.trial);
        let both = self.primary.iter().zip(&self.secondary);
        trial.iter_mut().zip(both).for_each(|(t, (a, b))| *t = a + b);
        let exceeds = self.speed_excess(&trial, &[0.0]) > 1.0 + ROUNDING;
        self.trial = trial;
        exceeds
    }

    /// The largest speeds of the tool, over those that it may have [-], while joints brake from these
    /// velocities (scaled), at these shares of the time of braking.
    fn speed_excess(&self, rates: &[f64], shares: &[f64]) -> f64 {
        let most = self.options.speed;
        let is_now = shares.iter().all(|share| *share == 0.0);
        // Velocities that joints come to, and the time until they rest.
        let all = || rates.iter().zip(&self.last).zip(&self.space.columns).zip(&self.limits);
        let stops = || {
            all().map(|(((rate, last), column), limits)| {
                let (velocity, acceleration) =
                    (rate * column, (rate - last) * column / self.options.dt);
                if is_now || limits.jerk == f64::INFINITY || acceleration * velocity <= 0.0 {
                    return (velocity, stopping_time(velocity.abs(), limits));
                }
                let ramp = acceleration.abs() / limits.jerk;
                let peak = velocity + 0.5 * acceleration * ramp;
                (peak, ramp + stopping_time(peak.abs(), limits))
            })
        };
        let joints = || stops().map(|(velocity, _)| velocity);
        let time = stops().fold(0.0, |most: f64, (_, time)| most.max(time));
        let twist = twist_of(self.space.whole(), joints());
        let mut change = Twist::ZERO;
        if !is_now {
            for (rate, derivative) in joints().zip(&self.hessian) {
                change = change + twist_of(derivative, joints()) * rate;
            }
        }
        let has_jerks = self.limits.iter().any(|l| l.jerk < f64::INFINITY);
        let excess = |share: f64| {
            let (left, way) = if has_jerks && share < 0.5 {
                // Ramps take half of the time.
                (1.0 - 2.0 * share * share, share * (1.0 - share * share / 1.5))
            } else {
                (1.0 - share, share * (1.0 - 0.5 * share))
            };
            let then = (twist + change * (share * self.options.dt + way * time)) * left;
            (then.linear.norm() / most.linear).max(then.angular.norm() / most.angular)
        };
        shares.iter().fold(0.0, |most, share| most.max(excess(*share)))
    }
}

/// The columns of `j` (6 x n) times these rates, as a twist.
fn twist_of(j: &Matrix, rates: impl Iterator<Item = f64>) -> Twist {
    let mut sum = [0.0; 6];
    for (k, rate) in rates.enumerate() {
        sum.iter_mut().zip(j.column(k)).for_each(|(sum, x)| *sum += x * rate);
    }
    Twist::from_array(sum)
}
