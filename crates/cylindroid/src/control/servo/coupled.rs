//! Closed chains in the servo: joints coupled by loops and contacts, hands with an object, two arms
//! holding one object.
//!
//! Formula  joint velocities = M y + s_0 (`closure/mobility/coordinate_partitioning.rs`, near
//!          singularities `actuation_map.rs`), s_0 the correction of a measured configuration as
//!          far as the limits leave room beside the motion; the task is J M y = x, its minimum-norm solution
//!          y the least weighted effort of the actuated joints; limits apply to all joints
//!          (`solver/saturation.rs`)
//! Shapes   M: (n + e) x a, columns beyond p zero; J: m x n; y: a
//! Units    velocities over the roots of the joint weights internally, as in `task_space.rs`
//! Valid    any mechanism whose actuated joints control its object. Measured configurations are
//!          closed first, so that noise neither moves the object nor competes with its motion.
//!          Allocates near type II singularities only, where the loops are analysed in full
//! Stops    before a type II singularity, where the object would gain an uncontrolled motion
//! Checked  tests/it/servo/object.rs

use super::limits::JointState;
use super::loop_motions::LoopMotions;
use super::sensor_fit::SensorFit;
use super::task_space::TaskSpace;
use crate::closure::ActuationMap;
use crate::control::solver::bounds::VelocityBounds;
use crate::control::solver::saturation::Coupling;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, norm};
use crate::model::{Limits, Mechanism};
use crate::task::Task;
use crate::tolerance::{MIN_ACTUATED_SHARE, UNACTUATED};

/// The coupled joints of a servo.
#[derive(Debug, Clone)]
pub(super) struct Coupled {
    loops: LoopMotions,
    /// True if the passive joints are tracked: what closes them is no motion.
    pub(super) is_tracked: bool,
    /// J in weighted velocities, m x n.
    pub(super) task: Matrix,
    pub(super) coupling: Coupling,
    /// The controlled motion with the smallest actuated share, if that share is small.
    uncontrolled: Option<UncontrolledMotion>,
    /// Steepest descent of the error of the task.
    pub(super) descent: Vec<f64>,
    /// The velocity of the task.
    twist: Vec<f64>,
}

/// A motion with a small actuated share.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct UncontrolledMotion {
    pub(super) share: f64,
    /// Its twist in the task (scaled), of unit length.
    pub(super) direction: Vec<f64>,
}

impl Coupled {
    /// For a mechanism with loops or contacts and a task of m components.
    pub(super) fn new(
        mechanism: &Mechanism,
        weights: &[f64],
        locked: Vec<usize>,
        m: usize,
    ) -> Result<Self> {
        let loops = LoopMotions::new(mechanism, weights, locked)?;
        let actuated = loops.actuated;
        Ok(Self {
            is_tracked: false,
            task: Matrix::zeros(m, mechanism.n()),
            coupling: Coupling::new(loops.are_actuated(), actuated),
            uncontrolled: None,
            descent: vec![0.0; actuated],
            twist: vec![0.0; m],
            loops,
        })
    }

    /// Replaces the weights of all coordinates, before [`Coupled::load`].
    pub(super) fn set_weights(&mut self, weights: impl Iterator<Item = f64>) -> Result<()> {
        self.loops.set_weights(weights)
    }

    /// The loops.
    pub(super) fn loops(&self) -> &LoopMotions {
        &self.loops
    }

    /// Number of actuated joints: the size of y.
    pub(super) fn actuated_joints(&self) -> usize {
        self.loops.actuated
    }

    /// Number of independent actuated motions: the non-zero columns of M.
    pub(super) fn actuated_motions(&self) -> usize {
        self.loops.independent
    }

    /// The bounds of joint i (coordinates, then actuated loop joints); `acceleration` is the least of
    /// the actuated joints.
    pub(super) fn bounds(
        &self,
        i: usize,
        (limits, acceleration): (&Limits, f64),
        now: JointState,
        dt: f64,
    ) -> VelocityBounds {
        if self.coupling.is_actuated[i] {
            return VelocityBounds::next(limits, now, dt);
        }
        let mut bounds = VelocityBounds::passive(limits, now, dt);
        self.loops.bound_passive(i, acceleration, dt, &mut bounds);
        bounds
    }

    /// The least acceleration limit of the actuated joints [rad/s^2, or lengths of the mechanism/s^2].
    pub(super) fn least_acceleration(&self, limits: &[Limits]) -> f64 {
        self.loops.least_acceleration(&self.coupling.is_actuated, limits)
    }

    /// The closed configuration nearest to the measured one.
    pub(super) fn q(&self) -> &[f64] {
        self.loops.q()
    }

    /// Memory for [`Coupled::fit`].
    pub(super) fn sensor_fit(&self) -> SensorFit {
        self.loops.sensor_fit()
    }

    /// Moves the closed configuration to the one nearest to all measured positions.
    pub(super) fn fit(&mut self, fit: &mut SensorFit) -> Result<()> {
        self.loops.fit(fit)
    }

    /// Closes the loops of a measured configuration, see [`LoopMotions::close_measured`] and
    /// [`LoopMotions::close_tracked`].
    pub(super) fn close_measured(&mut self, q: &[f64]) -> Result<()> {
        match self.is_tracked {
            true => self.loops.close_tracked(q),
            false => self.loops.close_measured(q),
        }
    }

    /// Closes the loops of a predicted configuration, see [`LoopMotions::close_ahead`].
    pub(super) fn close_ahead(&mut self, q: &mut [f64], from: &[f64]) -> Result<()> {
        self.loops.close_ahead(q, from)
    }

    /// Computes M and J M at the closed configuration, with `self.task` the task there. `space`
    /// scales the velocities.
    pub(super) fn load(&mut self, space: &TaskSpace, dt: f64, reduced: &mut Matrix) -> Result<()> {
        let n = self.loops.q().len();
        let Self { loops, task, twist, coupling, .. } = self;
        let map = loops.load(&mut coupling.motions, |rates| {
            space.scale_rates(rates);
            task.mul_vec_into(&rates[..n], twist);
            // A joint that rotates alone does not move the object; NaN does.
            !(norm(twist) <= UNACTUATED)
        })?;
        for j in 0..loops.independent {
            space.scale_rates(coupling.motions.column_mut(j));
        }
        let Coupling { correction, actuated_correction, .. } = coupling;
        for (i, (c, d)) in correction.iter_mut().zip(actuated_correction).enumerate() {
            *c = if self.is_tracked {
                0.0
            } else {
                space.scaled_rate(i, loops.passive_change[i] / dt)
            };
            *d = space.scaled_rate(i, loops.actuated_change[i] / dt);
        }
        for j in 0..loops.actuated {
            task.mul_vec_into(&coupling.motions.column(j)[..n], reduced.column_mut(j));
        }
        self.uncontrolled = map.and_then(|map| self.find_uncontrolled(&map, space));
        Ok(())
    }

    /// The motion of the task with the smallest actuated share, if that share is small.
    fn find_uncontrolled(
        &self,
        actuation_map: &ActuationMap,
        space: &TaskSpace,
    ) -> Option<UncontrolledMotion> {
        let n = self.loops.q().len();
        let in_task = |motion: &[f64]| self.task.mul_vec(&space.scaled_rates(&motion[..n]));
        let left = (0..actuation_map.uncontrolled.cols())
            .map(|j| (0.0, actuation_map.uncontrolled.column(j)));
        let weak = actuation_map.shares.iter().enumerate();
        let weak = weak.map(|(j, share)| (*share, actuation_map.directions.column(j)));
        left.chain(weak).take_while(|(share, _)| *share < MIN_ACTUATED_SHARE).find_map(
            |(share, motion)| {
                let mut direction = in_task(motion);
                let size = norm(&direction);
                // A joint that rotates alone does not move the object.
                (size > UNACTUATED).then(|| {
                    direction.iter_mut().for_each(|x| *x /= size);
                    UncontrolledMotion { share, direction }
                })
            },
        )
    }

    /// The motion with a small actuated share, if any.
    pub(super) fn uncontrolled(&self) -> Option<&UncontrolledMotion> {
        self.uncontrolled.as_ref()
    }

    /// True if the actuated share of that motion decreases in a step with these weighted
    /// velocities.
    pub(super) fn approaches_type_ii(
        &self,
        rates: &[f64],
        space: &TaskSpace,
        dt: f64,
    ) -> Result<bool> {
        let Some(now) = &self.uncontrolled else { return Ok(false) };
        let rates: Vec<f64> = rates.iter().zip(&space.columns).map(|(r, c)| r * c).collect();
        let ahead = self.loops.map_after(&rates, dt)?;
        Ok(self.find_uncontrolled(&ahead, space).is_some_and(|then| then.share <= now.share))
    }

    /// Projects the velocities of the secondary tasks (all joints, unweighted) onto the actuated
    /// motions.
    pub(super) fn load_secondary(&mut self, velocities: &[f64], space: &TaskSpace) {
        let Coupling { motions, is_actuated, secondary, .. } = &mut self.coupling;
        project(motions, is_actuated, velocities, space, secondary);
    }

    /// Projects the velocities of the last step (all joints, unweighted) likewise.
    pub(super) fn load_last(&mut self, rates: &[f64], space: &TaskSpace) {
        let Coupling { motions, is_actuated, last, .. } = &mut self.coupling;
        project(motions, is_actuated, rates, space, last);
    }

    /// The actuation y of velocities of all joints (unweighted).
    pub(super) fn actuation_of(&self, rates: &[f64], space: &TaskSpace) -> Vec<f64> {
        let mut y = vec![0.0; self.loops.actuated];
        project(&self.coupling.motions, &self.coupling.is_actuated, rates, space, &mut y);
        y
    }

    /// Assembles the loops of `q` after integration, see [`LoopMotions::close`].
    pub(super) fn close(&self, q: &mut [f64]) {
        self.loops.close(q);
    }
}

/// The actuation y nearest to these velocities of all joints (unweighted), in the weights of the
/// actuated ones.
fn project(
    motions: &Matrix,
    is_actuated: &[bool],
    rates: &[f64],
    space: &TaskSpace,
    y: &mut [f64],
) {
    for (j, y) in y.iter_mut().enumerate() {
        let column = motions.column(j).iter().zip(is_actuated).zip(rates).enumerate();
        let actuated = column.filter(|(_, ((_, is_actuated), _))| **is_actuated);
        *y = actuated.map(|(i, ((m, _), rate))| m * space.scaled_rate(i, *rate)).sum();
    }
}

/// The error for loops that cannot be closed.
pub(super) fn not_assembled(mechanism: &Mechanism) -> Error {
    Error::Model {
        model: mechanism.name().to_owned(),
        culprit: String::new(),
        message: format!(
            "the loops of '{}' cannot be closed near its home configuration; see `assemble`",
            mechanism.name()
        ),
    }
}

/// The error for actuated joints that leave the object an uncontrolled motion everywhere.
pub(super) fn not_actuated(
    mechanism: &Mechanism,
    motion: &UncontrolledMotion,
    task: Task,
) -> Error {
    let names = Task::COMPONENTS.iter().zip(task.components).filter(|(_, on)| *on);
    let parts = names.zip(&motion.direction).filter(|(_, share)| share.abs() > 0.1);
    let parts: Vec<String> = parts.map(|((name, _), share)| format!("{share:.2} {name}")).collect();
    Error::Model {
        model: mechanism.name().to_owned(),
        culprit: String::new(),
        message: format!(
            "with the actuated joints at rest the end effector of '{}' can still move ({}); actuate \
             more joints, or leave these components out of the task",
            mechanism.name(),
            parts.join(", ")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::ServoOptions;
    use crate::control::solver::bounds::LimitKind;
    use crate::control::solver::saturation::{Problem, Saturator, solve};
    use crate::inverse::Method;
    use crate::kinematics::{Chain, ReferenceFrame};
    use crate::linalg::Svd;
    use crate::scalar::uniform;

    /// Without loops it is the solver for trees: the same scale and velocities if the direction is
    /// kept; otherwise velocities that are as good.
    #[test]
    fn without_loops_it_is_the_saturation_of_a_tree() {
        let mut state = 5_u64;
        let mut next = move || 2.0 * uniform(&mut state) - 1.0;
        let panda = crate::model::catalogue::load("panda").unwrap();
        let actuated = (0..panda.n()).filter(|&i| panda.coordinates()[i].actuated).count();
        let limits: Vec<_> = panda.coordinates().iter().map(|c| c.limits).collect();
        let chain = Chain::of(&panda, panda.tool());
        let space = TaskSpace::new(ServoOptions::new(&panda).scaling(&[]), &chain, &limits);
        let method = Method::Truncated { eps: 1e-9 };
        let (mut kept, mut changed) = (0, 0);
        for _ in 0..300 {
            let q: Vec<f64> = panda.home().iter().map(|x| x + next()).collect();
            let mut coupled = Coupled::new(&panda, &[], Vec::new(), 6).unwrap();
            coupled.task = panda
                .state(&q)
                .unwrap()
                .jacobian(panda.tool(), ReferenceFrame::LocalWorldAligned)
                .unwrap();
            let mut reduced = Matrix::zeros(6, actuated);
            coupled.close_measured(&q).unwrap();
            coupled.load(&space, 1e-3, &mut reduced).unwrap();
            let x: Vec<f64> = (0..6).map(|_| next()).collect();
            let bounds: Vec<VelocityBounds> = (0..panda.n())
                .map(|_| VelocityBounds {
                    lower: -0.7 * next().abs(),
                    upper: 0.7 * next().abs(),
                    lower_cause: LimitKind::Position,
                    upper_cause: LimitKind::Position,
                })
                .collect();
            let solved = |j: &Matrix, n: usize| {
                let svd = Svd::of(j);
                let mut y = vec![0.0; n];
                solve(&svd, &method, &mut vec![0.0; svd.len()], &x, &mut y);
                y
            };
            let task = coupled.task.clone();
            let mut rates = solved(&task, panda.n());
            let last = vec![0.0; panda.n()];

            let problem = Problem { j: &task, bounds: &bounds, last: &last, gain: 1.0, error: &x };
            let mut saturator = Saturator::new(6, panda.n(), None);
            let expected = saturator.apply(problem, &last, None, &mut rates);

            coupled.coupling.primary = solved(&reduced, actuated);
            let mut found = vec![0.0; panda.n()];
            coupled.coupling.expand(&coupled.coupling.primary, &mut found);
            let problem = Problem { j: &reduced, ..problem };
            let mut saturator = Saturator::new(6, actuated, Some(panda.n()));
            let saturation =
                saturator.apply_coupled(problem, &mut coupled.coupling, None, &mut found);
            assert_eq!(saturation.direction_lost, expected.direction_lost);
            assert!(found.iter().zip(&bounds).all(|(r, b)| b.contains(*r)));
            let left = |rates: &[f64]| -> f64 {
                let done = task.mul_vec(rates);
                done.iter().zip(&x).map(|(d, x)| (d - x) * (d - x)).sum()
            };
            if saturation.direction_lost {
                changed += 1;
                // Both are the optimum of one problem.
                assert!((left(&found) - left(&rates)).abs() <= 1e-9, "{found:?} {rates:?}");
                assert!(left(&found) <= left(&last) + 1e-9);
            } else {
                kept += 1;
                assert!((saturation.scale - expected.scale).abs() < 1e-9);
                for (a, b) in found.iter().zip(&rates) {
                    assert!((a - b).abs() < 1e-8, "{found:?} {rates:?}");
                }
            }
        }
        assert!(kept > 50 && changed > 5, "{kept} kept, {changed} changed");
    }
}
