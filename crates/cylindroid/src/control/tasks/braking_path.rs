//! The way on which all joints, each braking at its own limit, come to rest after a step, and whether
//! bodies touch on it.
//!
//! Formula  configuration after k steps  q_k = q + dt sum v_j, v_0 = v, v_(j+1) = v_j reduced by A dt;
//!          all pairs apart at q_1, q_2, ... Steps are left out while no pair moves further than its
//!          distance:  sum_c l_c |q_k - q_h|_c < d(q_h), l_c the lever of coordinate c
//!          With a jerk limit v_j of `servo/jerk_limited_stop.rs`
//! Units    m, rad or m of the coordinates, s
//! Valid    trees among obstacles that rest; levers are those of the present configuration
//! Cost     a sum over the joints while all pairs are further apart than they move; otherwise at
//!          most `LOOKS` configurations. No allocation
//! Source   Fraichard & Asama, Inevitable collision states, Advanced Robotics 18 (2004), 1001-1024
//! Checked  tests/it/servo/braking_path.rs, tests/allocation/main.rs

use super::options::{CollisionAvoidance, MOST_PAIRS};
use crate::collision::{CollisionModel, NearPair};
use crate::control::servo::JerkLimitedStop;
use crate::error::Result;
use crate::kinematics::State;
use crate::model::{Limits, Mechanism};

/// Configurations of a path at which distances are evaluated, at most; a path with more of them
/// counts as not clear.
const LOOKS: usize = 32;

/// Steps of a path at most: joints without deceleration never rest.
const MOST_STEPS: f64 = 1e6;

/// Memory of the paths, and what is known of the last one.
#[derive(Debug, Clone)]
pub(super) struct BrakingPath {
    /// True if the path of the last velocities is clear, after a step that ends at `expected`.
    pub(super) is_clear: bool,
    pub(super) expected: Vec<f64>,
    /// Of the obstacles.
    pub(super) revision: u64,
    /// A configuration of the path, and changes of the coordinates up to it and to a later one.
    state: State,
    q: Vec<f64>,
    change: Vec<f64>,
    later: Vec<f64>,
    /// Pairs that the path may bring together, with distances, and a row of levers for each.
    doubtful: Vec<(usize, f64)>,
    levers: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    pub(super) accelerations: Vec<f64>,
    far: Vec<NearPair>,
}

/// What a path starts from: the state, its near pairs, and the distance of all others at least.
#[derive(Clone, Copy)]
pub(super) struct Start<'a> {
    pub(super) state: &'a State,
    pub(super) near: &'a [NearPair],
    pub(super) margin: f64,
}

/// Velocities of the first step and what brakes them.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub(super) velocities: &'a [f64],
    /// Changes of the velocities in the first step, divided by its duration.
    pub(super) accelerations: &'a [f64],
    pub(super) limits: &'a [Limits],
    pub(super) dt: f64,
}

impl Motion<'_> {
    /// Steps until all joints rest.
    fn steps(self) -> f64 {
        let steps = |((v, a), limits): ((&f64, &f64), &Limits)| -> f64 {
            if limits.jerk < f64::INFINITY {
                1.0 + JerkLimitedStop::new(limits, *v, *a, self.dt).steps()
            } else if *v == 0.0 {
                0.0
            } else {
                (v.abs() / (limits.acceleration * self.dt)).floor() + 1.0
            }
        };
        let all = self.velocities.iter().zip(self.accelerations).zip(self.limits);
        all.map(steps).fold(0.0, f64::max).min(MOST_STEPS)
    }

    /// Changes of the coordinates after some steps.
    fn change_after(self, steps: f64, change: &mut [f64]) {
        let all = change.iter_mut().zip(self.velocities).zip(self.accelerations).zip(self.limits);
        for (((change, v), a), limits) in all {
            if limits.jerk < f64::INFINITY {
                let stop = JerkLimitedStop::new(limits, *v, *a, self.dt);
                *change = if steps > 0.0 { self.dt * v + stop.way(steps - 1.0) } else { 0.0 };
                continue;
            }
            let (speed, less) = (v.abs(), limits.acceleration * self.dt);
            // Without an acceleration limit the first step is the last.
            let own = steps.min((speed / less).floor() + 1.0);
            let lost = if own > 1.0 { 0.5 * less * own * (own - 1.0) } else { 0.0 };
            *change = if speed > 0.0 { self.dt * v.signum() * (own * speed - lost) } else { 0.0 };
        }
    }
}

impl BrakingPath {
    /// For a robot at rest, with this number of pairs.
    pub(super) fn new(mechanism: &Mechanism, pairs: usize) -> Result<Self> {
        let n = mechanism.n();
        Ok(Self {
            is_clear: false,
            expected: vec![0.0; n],
            revision: 0,
            state: mechanism.state(mechanism.home())?,
            q: vec![0.0; n],
            change: vec![0.0; n],
            later: vec![0.0; n],
            doubtful: Vec::with_capacity(MOST_PAIRS),
            levers: vec![0.0; MOST_PAIRS * n],
            velocities: vec![0.0; n],
            accelerations: vec![0.0; n],
            far: Vec::with_capacity(pairs),
        })
    }

    /// Forgets the last path.
    pub(super) const fn reset(&mut self) {
        self.is_clear = false;
    }

    /// True if the last path was clear, the obstacles are the same, and the robot is where it was to
    /// be: no body is off by more than half of the gap.
    pub(super) fn is_continued(&mut self, state: &State, collisions: &CollisionAvoidance) -> bool {
        let model = &collisions.model;
        let off = self.change.iter_mut().zip(&self.expected).zip(state.q());
        off.for_each(|((off, expected), q)| *off = q - expected);
        let mut ways = (0..model.bodies().len()).map(|b| model.way(state, b, &self.change));
        let is_same = self.is_clear && self.revision == model.revision();
        is_same && ways.all(|way| way <= 0.5 * collisions.gap)
    }

    /// The pair that the path of these velocities may bring together.
    pub(super) fn contact(
        &mut self,
        start: Start<'_>,
        model: &mut CollisionModel,
        motion: Motion<'_>,
    ) -> Result<Option<usize>> {
        let steps = motion.steps();
        if let Some(pair) = self.load_doubtful(start, model, motion, steps)? {
            return Ok(Some(pair));
        }
        if self.doubtful.is_empty() {
            return Ok(None);
        }
        let mut now = 0.0;
        for _ in 0..LOOKS {
            let clear = self.clear_until(now, steps, motion);
            if clear >= steps {
                return Ok(None);
            }
            now = clear.max(now + 1.0);
            motion.change_after(now, &mut self.change);
            self.q.copy_from_slice(start.state.q());
            start.state.mechanism().integrate_in_place(&mut self.q, &self.change, 1.0);
            self.state.set(&self.q)?;
            model.place(&self.state);
            for (pair, distance) in &mut self.doubtful {
                *distance = model.distance_of(*pair);
                // Nor is NaN a distance.
                if !(*distance > 0.0) {
                    return Ok(Some(*pair));
                }
            }
            if now >= steps {
                return Ok(None);
            }
        }
        let nearest = self.doubtful.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        Ok(nearest.map(|(pair, _)| *pair))
    }

    /// The pairs that are apart and may come together on the way, with their levers; one of them if
    /// there are too many.
    fn load_doubtful(
        &mut self,
        start: Start<'_>,
        model: &mut CollisionModel,
        motion: Motion<'_>,
        steps: f64,
    ) -> Result<Option<usize>> {
        let n = self.change.len();
        motion.change_after(steps, &mut self.change);
        let ways = (0..model.bodies().len()).map(|b| model.way(start.state, b, &self.change));
        let furthest = 2.0 * ways.fold(0.0, f64::max);
        self.doubtful.clear();
        let near = if furthest < start.margin && start.near.len() < MOST_PAIRS {
            start.near
        } else {
            model.near(start.state, furthest, &mut self.far)?;
            &self.far
        };
        for near in near.iter().filter(|near| near.distance > 0.0 && near.distance <= furthest) {
            let place = self.doubtful.len();
            if place == MOST_PAIRS {
                return Ok(Some(near.pair));
            }
            let row = &mut self.levers[place * n..][..n];
            model.levers_into(start.state, near.pair, row);
            if near.distance <= way_with(row, &self.change) {
                self.doubtful.push((near.pair, near.distance));
            }
        }
        Ok(None)
    }

    /// The last step up to which no pair can move by its distance since that of the last look.
    fn clear_until(&mut self, now: f64, steps: f64, motion: Motion<'_>) -> f64 {
        motion.change_after(now, &mut self.change);
        let (mut clear, mut beyond) = (now, steps);
        let n = self.change.len();
        while clear < beyond {
            let middle = (0.5 * (clear + beyond)).ceil();
            motion.change_after(middle, &mut self.later);
            self.later.iter_mut().zip(&self.change).for_each(|(later, now)| *later -= now);
            let mut pairs = self.doubtful.iter().zip(self.levers.chunks_exact(n));
            if pairs.all(|((_, distance), row)| way_with(row, &self.later) < *distance) {
                clear = middle;
            } else {
                beyond = middle - 1.0;
            }
        }
        clear
    }
}

/// The way of a pair with these levers.
fn way_with(levers: &[f64], change: &[f64]) -> f64 {
    let parts = levers.iter().zip(change).filter(|(_, change)| **change != 0.0);
    parts.map(|(lever, change)| lever * change.abs()).sum()
}
