//! The inequalities of a step: limits of all joints, pairs of bodies, half-spaces; and the velocities
//! that its lowest level approaches.
//!
//! Formula  limits `control/servo/limits.rs`; of pairs and half-spaces g q' >= -v(d - c), v the velocity
//!          from which the joints stop within half of d - c, c = (dt sum |q'|)^2 L / 2 a bound of the
//!          second-order change in a step; g q' >= (c - d) / dt where d < c
//! Checked  tests/it/servo/tasks.rs, tests/it/servo/task_kinds.rs

use super::motions::JerkBounds;
use super::options::{MOST_PAIRS, MotionTask};
use super::task_servo::TaskServo;
use crate::control::servo::{
    JointState, jerk_limited_stopping_velocity, largest_approach, share_of_gain,
};
use crate::error::Result;
use crate::linalg::dot;
use crate::model::{Coordinate, Limits};

/// Share of the acceleration limits that brakes a pair of bodies [-]; the rest follows the other
/// tasks.
const BRAKING: f64 = 0.5;

/// Distances outside below this share of the reach come from roundings [-].
const ROUNDING: f64 = 1e-6;

impl TaskServo {
    /// Solves for the joint velocities by `solve`. With limits of the jerk twice: for those that the tasks ask for,
    /// then for those of this step on the way to them.
    pub(super) fn solve_within_limits(&mut self, solve: fn(&mut Self)) {
        if let Some(mut desired) = self.desired_rates.take() {
            self.load_bounds(JerkBounds::None);
            solve(self);
            desired.copy_from_slice(&self.rates);
            self.motions.velocities(&self.last, &self.bounds, &mut desired);
            self.load_bounds(JerkBounds::Towards(&desired));
            self.desired_rates = Some(desired);
        }
        solve(self);
    }

    /// Limits of the joints, and the unknowns of the last velocities.
    pub(super) fn load_bounds(&mut self, jerks: JerkBounds<'_>) {
        let are_units = self.motions.limit_rows() == 0;
        for (i, limits) in self.limits.iter().enumerate() {
            let position = self.state.q().get(i).copied().unwrap_or(0.0);
            let (velocity, acceleration) = (self.rates[i], self.accelerations[i]);
            let now = JointState { position, velocity, acceleration };
            let has_jerk = limits.jerk < f64::INFINITY && self.motions.is_actuated(i);
            let dt = self.options.dt;
            let bound = match jerks {
                JerkBounds::None if has_jerk => {
                    let (acceleration, jerk) = (f64::INFINITY, f64::INFINITY);
                    let wide = Limits { acceleration, jerk, ..*limits };
                    self.motions.bounds(i, &wide, now, dt)
                }
                JerkBounds::Towards(desired) if has_jerk => {
                    let bound = self.motions.bounds(i, limits, now, dt);
                    bound.towards(desired[i], limits, now, dt)
                }
                _ => self.motions.bounds(i, limits, now, dt),
            };
            self.bounds[i] = bound;
            let inequalities = &mut self.set.inequalities;
            if are_units {
                let column = self.motions.motion(i, i);
                let scaled = |v: f64| if column == 0.0 { 0.0 } else { v / column };
                inequalities.lower[i] = scaled(bound.lower);
                inequalities.upper[i] = scaled(bound.upper);
            } else {
                let motions = &self.motions;
                inequalities.set_row(i, |j| motions.motion(i, j));
                let moves = (0..motions.unknowns()).any(|j| motions.motion(i, j) != 0.0);
                let (lower, upper) = if moves {
                    (bound.lower, bound.upper)
                } else {
                    (f64::NEG_INFINITY, f64::INFINITY)
                };
                (inequalities.lower[i], inequalities.upper[i]) = (lower, upper);
            }
        }
        self.motions.unknowns_of(&self.rates, &mut self.last);
    }

    /// One row for each half-space and each of the nearest pairs.
    pub(super) fn load_distances(&mut self) -> Result<()> {
        for i in 0..self.options.half_spaces.len() {
            let half_space = &self.options.half_spaces[i];
            half_space.gradient_into(&self.state, &mut self.jacobian, &mut self.gradient);
            let room = half_space.room(&self.state);
            for (j, moving) in self.moving.iter_mut().enumerate() {
                *moving = self.jacobian.column(j).iter().any(|x| *x != 0.0);
            }
            self.load_distance(i, room, true);
        }
        let first = self.options.half_spaces.len();
        let Some(collisions) = &mut self.options.collisions else { return Ok(()) };
        let gap = collisions.gap;
        collisions.model.near(&self.state, collisions.margin, &mut self.near)?;
        if self.near.len() > MOST_PAIRS {
            self.near.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance));
        }
        self.near.truncate(MOST_PAIRS);
        for place in 0..MOST_PAIRS {
            let Some(near) = self.near.get(place) else {
                self.clear_distance(first + place);
                continue;
            };
            let Some(collisions) = &mut self.options.collisions else { return Ok(()) };
            let (gradient, moving) = (&mut self.gradient, &mut self.moving);
            collisions.model.gradient_and_moving_into(&self.state, near, gradient, moving);
            let room = near.distance - gap;
            self.load_distance(first + place, room, false);
        }
        Ok(())
    }

    /// The row of a distance whose gradient and moving coordinates are loaded. With limits of the jerk
    /// joints that speed up go on doing so for a while: where no braking path is looked at (`is_alone`),
    /// the bound takes the last velocity of the distance into account.
    fn load_distance(&mut self, place: usize, room: f64, is_alone: bool) {
        let (motions, gradient) = (&self.motions, &self.gradient);
        for (j, entry) in self.entries.iter_mut().enumerate() {
            *entry = motions.entry(|i| gradient[i], j);
        }
        let entries = &self.entries;
        let dt = self.options.dt;
        let most = |of: fn(&Limits) -> f64| {
            BRAKING * motions.largest_change(|j| entries[j], &self.limits, of)
        };
        let (acceleration, jerk) = (most(|l| l.acceleration), most(|l| l.jerk));
        let (second_order, reach) = (self.second_order(), self.state.mechanism().reach());
        let row = self.motions.limit_rows() + place;
        let inequalities = &mut self.set.inequalities;
        inequalities.set_row(row, |j| entries[j]);
        inequalities.lower[self.limits.len() + place] = if room > second_order {
            // Half of the way in a step at most.
            let way = 0.5 * (room - second_order);
            let most = jerk_limited_stopping_velocity(way, acceleration, jerk, dt);
            if is_alone && jerk < f64::INFINITY && jerk > 0.0 {
                let limits = Limits { acceleration, jerk, ..Limits::NONE };
                -largest_approach(&limits, (-dot(entries, &self.last), way), most, dt)
            } else {
                -most
            }
        } else {
            // What roundings of steps add up to is taken back; a start further outside is not.
            let own = if room < -ROUNDING * reach { 0.0 } else { room };
            ((second_order - own) / dt).min(acceleration * dt).min(jerk * dt * dt)
        };
    }

    /// Bound of the second-order change of a distance in a step with the last velocities (m): its
    /// row is its tangent.
    fn second_order(&self) -> f64 {
        let reach = self.state.mechanism().reach();
        let coordinates = self.state.mechanism().coordinates().iter();
        // Also those along the distance: what they turn bends it.
        let moving = coordinates.zip(&self.rates).zip(&self.moving).filter(|(_, moving)| **moving);
        let turn = |((c, rate), _): ((&Coordinate, &f64), &bool)| {
            if c.kind.is_length() { rate.abs() / reach } else { rate.abs() }
        };
        let angle = self.options.dt * moving.map(turn).sum::<f64>();
        0.5 * reach * angle * angle
    }

    /// A row without a distance.
    fn clear_distance(&mut self, place: usize) {
        let row = self.motions.limit_rows() + place;
        self.set.inequalities.set_row(row, |_| 0.0);
        self.set.inequalities.lower[self.limits.len() + place] = f64::NEG_INFINITY;
    }

    /// The unknowns of desired velocities of the lowest level.
    pub(super) fn load_desired(&mut self) {
        self.lowest_velocities.fill(0.0);
        let lowest = |task: &MotionTask| task.objective.is_of_lowest_level();
        let sum: f64 = self.tasks.iter().filter(|t| lowest(t)).map(|task| task.weight).sum();
        let (motions, limits, dt) = (&self.motions, &self.limits, self.options.dt);
        let stops = |i: usize, way: f64, gain: f64| {
            if motions.is_driven(i) { share_of_gain(way, gain, &limits[i], dt) } else { 1.0 }
        };
        let all = self.tasks.iter().zip(&mut self.gradients);
        for (task, gradient) in all.filter(|(task, _)| lowest(task)) {
            let (share, out) = ((task.gain, task.weight / sum), &mut self.lowest_velocities);
            task.objective.add_velocities(&self.state, gradient.as_mut(), share, stops, out);
        }
        self.motions.unknowns_of(&self.lowest_velocities, &mut self.desired);
    }
}
