//! The stages of a servo step, in order: primary task, secondary tasks, bounds, joint velocities.
//!
//! Checked  tests/it/servo/

use super::super::approach;
use super::super::edge::Edge;
use super::super::escape::FOLD;
use super::super::limits::{JointState, acceleration_of};
use super::super::loop_edge::{LoopCurvature, LoopSurroundings};
use super::super::options::SecondaryNullSpace;
use super::super::secondary::Context;
use super::super::stall::BrakingState;
use super::super::step::DesiredMotion;
use super::Servo;
use crate::closure::assemble;
use crate::control::solver::bounds::VelocityBounds;
use crate::control::solver::saturation::{Curvature, Path, Problem, Saturation, brake, solve};
use crate::error::Result;
use crate::linalg::RowSpace;
use crate::spatial::{Pose, Twist};
use crate::tolerance::AT_LIMIT;

/// A joint at a limit would realise more of the task beyond it if its gradient exceeds this share of
/// the largest possible one [-]: the residual along directions cut by the inverse names no joint.
const BLOCKED: f64 = 1e-3;

impl Servo {
    /// Computes the error and the commanded twist, both scaled, and the joint velocities that
    /// realise it.
    pub(super) fn load_task(&mut self, desired: &DesiredMotion) {
        self.twist_follower.is_stalled = false;
        self.space.scale(desired.error, &mut self.error);
        self.projected_error.copy_from_slice(&self.error);
        self.step_projection.apply(&mut self.projected_error);
        self.method = self.options.method;
        let mut twist = desired.feedback;
        let mut solved = None;
        if self.accelerates {
            self.load_twist(twist);
            self.solve();
            solved = Some(twist);
            let gain = self.options.gain;
            if gain.position == gain.orientation {
                let way = |(w, rate): (&mut f64, &f64)| *w = rate / gain.position;
                self.secondary.iter_mut().zip(&self.primary).for_each(way);
            } else if let Some(coupled) = &mut self.coupled {
                self.svd.apply_gains_into(
                    &self.projected_error,
                    &self.gains,
                    &mut coupled.coupling.secondary,
                );
                coupled.coupling.expand(&coupled.coupling.secondary, &mut self.secondary);
            } else {
                self.svd.apply_gains_into(&self.projected_error, &self.gains, &mut self.secondary);
            }
            let dt = self.options.dt;
            let share = approach::scale(
                self.secondary.iter().copied(),
                &self.primary,
                &self.space.columns,
                &self.limits,
                dt,
            );
            twist = twist * share;
            self.method = approach::slowed(self.method, share);
        }
        twist = twist + desired.feed_forward;
        // Scaled as a whole: the direction of the motion is preserved.
        let speed = self.options.speed;
        let excess = (twist.linear.norm() / speed.linear).max(twist.angular.norm() / speed.angular);
        if excess > 1.0 {
            twist = twist * (1.0 / excess);
        }
        // If nothing was changed, the velocities are already solved for.
        if solved != Some(twist) {
            self.load_twist(twist);
            self.solve();
        }
    }

    /// `x = P twist`, scaled.
    pub(super) fn load_twist(&mut self, twist: Twist) {
        self.space.scale(twist, &mut self.x);
        self.step_projection.apply(&mut self.x);
    }

    /// `primary = J+ x`
    pub(super) fn solve(&mut self) {
        if let Some(coupled) = &mut self.coupled {
            solve(&self.svd, &self.method, &mut self.gains, &self.x, &mut coupled.coupling.primary);
            coupled.coupling.expand(&coupled.coupling.primary, &mut self.primary);
        } else {
            solve(&self.svd, &self.method, &mut self.gains, &self.x, &mut self.primary);
        }
    }

    /// Moves to the measured configuration; with loops, to the closed one nearest to it.
    pub(super) fn load_configuration(&mut self, q: &[f64]) -> Result<Pose> {
        Ok(match &mut self.coupled {
            Some(coupled) => {
                coupled.close_measured(q)?;
                self.chain.set(coupled.q())
            }
            None => self.chain.set(q),
        })
    }

    /// Computes the task Jacobian with respect to the joints, or to the actuated motions of a
    /// closed chain.
    pub(super) fn load_jacobian(&mut self, q: &[f64]) -> Result<()> {
        if let Some(inertia) = &mut self.inertia {
            inertia.weigh(q, &self.chain, &mut self.space, self.coupled.as_deref_mut())?;
        }
        let Some(coupled) = &mut self.coupled else {
            self.space.load(&self.chain, &mut self.task);
            return Ok(());
        };
        self.space.load(&self.chain, &mut coupled.task);
        coupled.load(&self.space, self.options.dt, &mut self.task)
    }

    /// A configuration near home in which the loops are closed; the first is the closest to home.
    pub(super) fn nearby_configuration(&self, sample: usize) -> Result<Option<Vec<f64>>> {
        let spread = if sample == 0 { 0.0 } else { 0.2 };
        let n = self.mechanism.n();
        let guess: Vec<f64> = (0..n)
            .map(|i| {
                let turn = ((sample * n + i) as f64 * 0.618_034).fract() - 0.5;
                self.mechanism.home()[i] + spread * turn
            })
            .collect();
        let found = assemble(&self.mechanism, &guess, &[])?;
        Ok(found.closed.then_some(found.q))
    }

    /// Bounds the primary and secondary velocities of a step; where nothing is commanded, all joints brake,
    /// those of self-motions too.
    pub(super) fn saturate(&mut self, brakes: bool) -> Result<Saturation> {
        for i in 0..self.last.len() {
            self.last[i] = self.space.scaled_rate(i, self.rates[self.place(i)]);
        }
        let gain = self.options.gain.least();
        let (gain, error) = match self.edge_aim {
            Some(aim) => (aim.gain, &self.edge_error),
            _ => (gain, &self.projected_error),
        };
        let problem =
            Problem { j: &self.task, bounds: &self.bounds, last: &self.last, gain, error };
        if brakes {
            let coupling = self.coupled.as_mut().map(|coupled| {
                coupled.load_last(&self.rates, &self.space);
                &mut coupled.coupling
            });
            return Ok(self.saturator.brake(&problem, coupling, &mut self.primary));
        }
        let path = if self.edge_aim.is_some() { Path::Curved } else { Path::Straight };
        let patience = self.stall_detector.patience();
        let gain_of_way = self.edge_aim.and_then(|aim| aim.gain_of_way(self.options.dt));
        let gain_of_way = gain_of_way.map(|gain| patience * gain);
        let Some(coupled) = &mut self.coupled else {
            // Arms without self-motions do not swing, and come back to targets less often from this way.
            let nearest = self.nearest_pose.as_ref().filter(|_| self.edge_aim.is_some());
            let has_self_motions = self.has_self_motions();
            let mut edge = Edge {
                chain: &self.chain,
                space: &self.space,
                limits: &self.limits,
                dt: self.options.dt,
                hessian: &mut self.hessian,
                way: nearest.and_then(|nearest| nearest.known_way()),
                gain_of_way: gain_of_way.filter(|_| has_self_motions),
            };
            let (secondary, rates) = (&self.secondary, &mut self.primary);
            return Ok(self.saturator.apply(problem, secondary, Some((&mut edge, path)), rates));
        };
        coupled.load_last(&self.rates, &self.space);
        let around =
            LoopSurroundings { task: self.options.task, limits: &self.limits, dt: self.options.dt };
        let mut edge = match &mut self.loop_edge {
            Some(edge) if self.edge_aim.is_some() => {
                Some(LoopCurvature { edge, around, gain_of_way })
            }
            _ => None,
        };
        let curvature = edge.as_mut().map(|edge| (edge as &mut dyn Curvature, path));
        let mut saturation = self.saturator.apply_coupled(
            problem,
            &mut coupled.coupling,
            curvature,
            &mut self.primary,
        );
        self.approaches_type_ii =
            coupled.approaches_type_ii(&self.primary, &self.space, self.options.dt)?;
        if self.approaches_type_ii {
            brake(&self.last, &self.bounds, &mut self.primary);
            coupled.coupling.actuation.fill(0.0);
            saturation = Saturation { scale: 0.0, direction_lost: false };
        }
        Ok(saturation)
    }

    /// The twist realised by the joint velocities of this step.
    pub(super) fn load_achieved_twist(&mut self) {
        let rates =
            self.coupled.as_ref().map_or(&self.primary, |coupled| &coupled.coupling.actuation);
        self.task.mul_vec_into(rates, &mut self.achieved_twist);
    }

    /// True if the tool moves so slowly relative to the target that an error within tolerance stays
    /// within it.
    pub(super) fn settled(&mut self, feed_forward: Twist) -> bool {
        self.load_achieved_twist();
        let speed = self.space.twist(&self.achieved_twist) - feed_forward;
        let (gain, most) = (self.options.gain, self.options.tolerance);
        speed.linear.norm() <= gain.position * most.position
            && speed.angular.norm() <= gain.orientation * most.orientation
    }

    /// Velocities of the secondary tasks in weighted coordinates, projected onto the null space.
    pub(super) fn load_secondary(&mut self, secondary_velocities: &[f64]) {
        self.secondary.fill(0.0);
        if !secondary_velocities.is_empty() {
            for (w, &c) in self.secondary.iter_mut().zip(self.chain.coordinates()) {
                *w = secondary_velocities[c];
            }
        }
        let mut context = Context {
            mechanism: &self.mechanism,
            chain: &self.chain,
            svd: &self.svd,
            task: &self.space,
            hessian: &mut self.hessian,
            limits: &self.limits,
            dt: self.options.dt,
        };
        for secondary in &self.options.secondary {
            secondary.add_velocities(&mut context, &mut self.secondary[..self.chain.n()]);
        }
        if let Some(coupled) = &mut self.coupled {
            coupled.load_secondary(&self.secondary, &self.space);
        } else {
            if self.secondary.iter().all(|w| *w == 0.0) {
                return;
            }
            self.space.scale_rates(&mut self.secondary);
        }
        let space = match self.options.null_space {
            SecondaryNullSpace::Exact => RowSpace::exact(&self.svd),
            SecondaryNullSpace::Retained => RowSpace::from_kept(&self.svd, &self.kept),
        };
        space.project_out(match &mut self.coupled {
            Some(coupled) => &mut coupled.coupling.secondary,
            None => &mut self.secondary,
        });
    }

    /// Stores the joint velocities of a step in which no joint meets a limit; `None`, without any
    /// effect, if one may, or if not all directions are kept.
    pub(super) fn store_unlimited_rates(&mut self, q: &[f64], rank: usize) -> Option<BrakingState> {
        let is_regular = rank == self.kept.len() && self.svd.singular_ratio() >= FOLD;
        if !is_regular || self.coupled.is_some() || self.edge_aim.is_some() {
            return None;
        }
        let scaled = self.primary.iter().zip(&self.secondary).zip(&self.space.columns);
        let places = self.chain.coordinates().iter().zip(&self.braking_margins);
        let mut clear = true;
        for (((primary, secondary), column), (&c, margin)) in scaled.zip(places) {
            let now = JointState { position: q[c], velocity: self.rates[c], acceleration: 0.0 };
            clear &= margin.allows(now, (primary + secondary) * column);
        }
        if !clear || self.will_turn_back(q) || self.exceeds_speed() {
            return None;
        }
        let scaled = self.primary.iter_mut().zip(&self.secondary).zip(&self.space.columns);
        let places = self.chain.coordinates().iter().zip(&self.braking_margins);
        let mut braking = BrakingState::default();
        for (((primary, secondary), column), (&c, margin)) in scaled.zip(places) {
            *primary += secondary;
            // Accelerations count for joints with jerk limits, which do not come here.
            self.rates[c] = *primary * column;
            if self.accelerates {
                let time = self.rates[c].abs() * margin.slowness;
                braking.stopping_time = braking.stopping_time.max(time);
            }
        }
        if let Some(escape) = &mut self.escape {
            escape.reset();
        }
        self.active.fill(None);
        self.at_limit.clear();
        Some(braking)
    }

    /// True where the joints can move without the tool.
    pub(super) fn has_self_motions(&self) -> bool {
        self.task.rows() < self.task.cols()
    }

    /// True where no configuration reaches the target.
    pub(super) fn is_out_of_reach(&self) -> bool {
        self.distance > self.length + self.offset_of_free_position()
    }

    /// The bounds of the next joint velocities, in weighted coordinates.
    pub(super) fn load_bounds(&mut self) {
        let coupled = self.coupled.as_ref();
        let least =
            coupled.map_or(f64::INFINITY, |coupled| coupled.least_acceleration(&self.limits));
        for i in 0..self.bounds.len() {
            let c = self.place(i);
            let position = self.chain.q().get(i).copied().unwrap_or(0.0);
            let (velocity, acceleration) = (self.rates[c], self.accelerations[c]);
            let now = JointState { position, velocity, acceleration };
            let (limits, dt) = (&self.limits[i], self.options.dt);
            let mut bound = match &self.coupled {
                Some(coupled) => coupled.bounds(i, (limits, least), now, dt),
                None => VelocityBounds::next(limits, now, dt),
            };
            if self.coupled.as_ref().is_none_or(|coupled| coupled.coupling.is_actuated[i]) {
                let desired = (self.primary[i] + self.secondary[i]) * self.space.columns[i];
                bound = bound.towards(desired, limits, now, dt);
            }
            self.own_bounds[i] = bound;
            bound.lower = self.space.scaled_rate(i, bound.lower);
            bound.upper = self.space.scaled_rate(i, bound.upper);
            self.bounds[i] = bound;
        }
    }

    /// Index of the velocity of the i-th joint of the servo among those of all joints.
    pub(super) fn place(&self, i: usize) -> usize {
        self.chain.coordinates().get(i).copied().unwrap_or(i)
    }

    pub(super) fn store_rates(&mut self) -> BrakingState {
        let mut braking = BrakingState::default();
        for i in 0..self.primary.len() {
            let c = self.place(i);
            let (rate, bound) = (self.primary[i], self.bounds[i]);
            self.active[i] = if self.space.is_locked(i) { None } else { bound.met(rate) };
            // Again: scaling leaves a rounding error.
            let own = match self.space.is_locked(i) {
                true => 0.0,
                false => self.own_bounds[i].clamp(rate * self.space.columns[i]),
            };
            let before = std::mem::replace(&mut self.rates[c], own);
            let acceleration = &mut self.accelerations[c];
            let (change, dt) = (own - before, self.options.dt);
            *acceleration = acceleration_of(&self.limits[i], *acceleration, change, dt);
            braking.add(&self.limits[i], self.active[i], [before, own]);
        }
        braking
    }

    /// Records the joints at a position limit that would realise more of the task beyond it.
    pub(super) fn note_limits(&mut self) {
        self.at_limit.clear();
        let left = |(x, done): (&f64, &f64)| x - done;
        let size =
            self.x.iter().zip(&self.achieved_twist).map(left).map(|r| r * r).sum::<f64>().sqrt();
        let least = BLOCKED * self.svd.value(0) * size;
        // For closed chains in actuated coordinates: the direction of steepest descent of the
        // error.
        if let Some(coupled) = &mut self.coupled {
            for (j, x) in coupled.descent.iter_mut().enumerate() {
                let rest = self.x.iter().zip(&self.achieved_twist).map(left);
                *x = self.task.column(j).iter().zip(rest).map(|(a, r)| a * r).sum();
            }
        }
        for (i, &c) in self.chain.coordinates().iter().enumerate() {
            let (rate, bound) = (self.primary[i], self.bounds[i]);
            let (q, l) = (self.chain.q()[i], self.limits[i]);
            // A motion below rounding is scaled to zero, short of its bound.
            let step = self.options.dt * self.space.columns[i];
            let pull: f64 = match &self.coupled {
                Some(coupled) => coupled.coupling.along(i, &coupled.descent),
                None => {
                    let rest = self.x.iter().zip(&self.achieved_twist).map(left);
                    self.task.column(i).iter().zip(rest).map(|(a, r)| a * r).sum()
                }
            };
            let near = AT_LIMIT * self.mechanism.unit_of(c);
            let above = l.upper - q < near && (bound.upper - rate) * step < near && pull > least;
            let below = q - l.lower < near && (rate - bound.lower) * step < near && pull < -least;
            if !self.space.is_locked(i) && (above || below) {
                self.at_limit.push(c);
            }
        }
    }
}
