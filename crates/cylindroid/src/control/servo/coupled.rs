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

use super::task_space::TaskSpace;
use crate::closure::{ActuationMap, CoordinatePartitioning, LoopClosureError, assemble};
use crate::control::solver::saturation::Coupling;
use crate::error::{Error, Result};
use crate::ik::Task;
use crate::linalg::{Matrix, norm};
use crate::model::Mechanism;
use crate::tolerance::{MIN_ACTUATED_SHARE, NEARLY_CLOSED, UNACTUATED};

/// Steps of Newton's method that close a measured configuration: from loops open by
/// `NEARLY_CLOSED` four reach rounding.
const CLOSING_STEPS: usize = 5;

/// The coupled joints of a servo.
#[derive(Debug, Clone)]
pub(super) struct Coupled {
    mechanism: Mechanism,
    weights: Vec<f64>,
    locked: Vec<usize>,
    actuated: usize,
    partitioning: CoordinatePartitioning,
    /// True if the partitioning is solved at `q`.
    is_regular: bool,
    /// The closed configuration nearest to the measured one.
    q: Vec<f64>,
    /// The change of the measured configuration that closes its loops to first order: of the passive
    /// joints, and of the actuated ones with those that follow them.
    passive_change: Vec<f64>,
    actuated_change: Vec<f64>,
    /// True if the passive joints are tracked: what closes them is no motion.
    pub(super) is_tracked: bool,
    /// Number of independent actuated motions.
    independent: usize,
    /// J in weighted velocities, m x n.
    pub(super) task: Matrix,
    pub(super) coupling: Coupling,
    /// The controlled motion with the smallest actuated share, if that share is small.
    uncontrolled: Option<UncontrolledMotion>,
    /// Steepest descent of the error of the task.
    pub(super) descent: Vec<f64>,
    /// The same in the present step of Newton's method.
    passive_step: Vec<f64>,
    actuated_step: Vec<f64>,
    /// Velocities of all joints, and of the task.
    rates: Vec<f64>,
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
        let partitioning = CoordinatePartitioning::new(mechanism, &locked)?;
        let n = mechanism.n();
        let velocities = partitioning.velocities();
        let tree = mechanism.coordinates().iter().filter(|c| c.actuated).count();
        let actuated = tree + velocities - n;
        let is_actuated = mechanism.coordinates().iter().map(|c| c.actuated);
        let is_actuated = is_actuated.chain((n..velocities).map(|_| true)).collect();
        Ok(Self {
            mechanism: mechanism.clone(),
            weights: weights.to_vec(),
            locked,
            actuated,
            partitioning,
            is_regular: false,
            q: mechanism.home().to_vec(),
            passive_change: vec![0.0; velocities],
            actuated_change: vec![0.0; velocities],
            is_tracked: false,
            passive_step: vec![0.0; velocities],
            actuated_step: vec![0.0; velocities],
            independent: actuated,
            task: Matrix::zeros(m, n),
            coupling: Coupling::new(is_actuated, actuated),
            uncontrolled: None,
            descent: vec![0.0; actuated],
            rates: vec![0.0; velocities],
            twist: vec![0.0; m],
        })
    }

    /// Replaces the weights of all coordinates, before [`Coupled::load`].
    pub(super) fn set_weights(&mut self, weights: impl Iterator<Item = f64>) -> Result<()> {
        self.weights.clear();
        self.weights.extend(weights);
        self.partitioning.load(&self.q)?;
        self.is_regular = self.partitioning.solve(&self.weights);
        Ok(())
    }

    /// Number of actuated joints: the size of y.
    pub(super) fn actuated_joints(&self) -> usize {
        self.actuated
    }

    /// Number of independent actuated motions: the non-zero columns of M.
    pub(super) fn actuated_motions(&self) -> usize {
        self.independent
    }

    /// True if joint i (coordinates, then actuated loop joints) is passive.
    pub(super) fn is_passive(&self, i: usize) -> bool {
        !self.coupling.is_actuated[i]
    }

    /// The closed configuration nearest to the measured one.
    pub(super) fn q(&self) -> &[f64] {
        &self.q
    }

    /// Closes the loops of a measured configuration: Newton's method, on the passive joints alone
    /// if there are no more actuated ones than degrees of freedom.
    ///
    /// # Errors
    /// Loops with a closure error above `NEARLY_CLOSED`.
    pub(super) fn close_measured(&mut self, q: &[f64]) -> Result<()> {
        let length = self.mechanism.reach();
        let mut closure_error = self.partitioning.load(q)?;
        let LoopClosureError { distance, angle } = closure_error;
        if !(distance <= NEARLY_CLOSED * length && angle <= NEARLY_CLOSED) {
            return Err(Error::InvalidOption {
                option: "q",
                value: format!("loops open by {distance:.3e} m, {angle:.3e} rad"),
                reason: format!(
                    "a servo maintains the loops of '{}' but does not close them; assemble it first",
                    self.mechanism.name()
                ),
            });
        }
        self.q.copy_from_slice(q);
        self.passive_change.fill(0.0);
        self.actuated_change.fill(0.0);
        self.is_regular = self.partitioning.solve(&self.weights);
        for step in 0..CLOSING_STEPS {
            if !self.is_regular || closure_error.is_closed(length) {
                break;
            }
            let (passive_step, actuated_step) = (&mut self.passive_step, &mut self.actuated_step);
            self.partitioning.correction_into(passive_step, actuated_step);
            if step == 0 {
                self.passive_change.copy_from_slice(passive_step);
                self.actuated_change.copy_from_slice(actuated_step);
            }
            passive_step.iter_mut().zip(&*actuated_step).for_each(|(f, d)| *f += d);
            self.mechanism.integrate_in_place(&mut self.q, &passive_step[..q.len()], 1.0);
            closure_error = self.partitioning.load(&self.q)?;
            self.is_regular = self.partitioning.solve(&self.weights);
        }
        if !self.is_regular {
            self.q.copy_from_slice(q);
            self.partitioning.load(q)?;
        }
        Ok(())
    }

    /// Computes M and J M at the closed configuration, with `self.task` the task there. `space`
    /// scales the velocities.
    pub(super) fn load(&mut self, space: &TaskSpace, dt: f64, reduced: &mut Matrix) -> Result<()> {
        self.uncontrolled = None;
        if !(self.is_regular && self.load_regular(space)) {
            self.load_any(space)?;
        }
        let Coupling { correction, actuated_correction, .. } = &mut self.coupling;
        for (i, (c, d)) in correction.iter_mut().zip(actuated_correction).enumerate() {
            *c = if self.is_tracked {
                0.0
            } else {
                space.scaled_rate(i, self.passive_change[i] / dt)
            };
            *d = space.scaled_rate(i, self.actuated_change[i] / dt);
        }
        let n = self.mechanism.n();
        for j in 0..self.actuated {
            let rates = &self.coupling.motions.column(j)[..n];
            self.task.mul_vec_into(rates, reduced.column_mut(j));
        }
        Ok(())
    }

    /// M where the actuated joints take a large share of every motion of the task; false elsewhere.
    fn load_regular(&mut self, space: &TaskSpace) -> bool {
        let n = self.mechanism.n();
        for j in 0..self.partitioning.passive_motions() {
            self.partitioning.passive_motion_into(j, &mut self.rates);
            space.scale_rates(&mut self.rates);
            self.task.mul_vec_into(&self.rates[..n], &mut self.twist);
            // A joint that rotates alone does not move the object.
            if !(norm(&self.twist) <= UNACTUATED) {
                return false;
            }
        }
        self.independent = self.partitioning.motions();
        self.coupling.motions.as_mut_slice().fill(0.0);
        for j in 0..self.independent {
            let column = self.coupling.motions.column_mut(j);
            self.partitioning.motion_into(j, column);
            space.scale_rates(column);
        }
        true
    }

    /// M at any configuration.
    fn load_any(&mut self, space: &TaskSpace) -> Result<()> {
        let map = ActuationMap::of(self.partitioning.state(), &self.weights, &self.locked)?;
        if !self.is_regular {
            self.actuated_change.copy_from_slice(&map.correction);
        }
        self.independent = map.motions.cols();
        self.coupling.motions.as_mut_slice().fill(0.0);
        for j in 0..self.independent {
            let column = self.coupling.motions.column_mut(j);
            column.copy_from_slice(map.motions.column(j));
            space.scale_rates(column);
        }
        self.uncontrolled = self.find_uncontrolled(&map, space);
        Ok(())
    }

    /// The motion of the task with the smallest actuated share, if that share is small.
    fn find_uncontrolled(
        &self,
        actuation_map: &ActuationMap,
        space: &TaskSpace,
    ) -> Option<UncontrolledMotion> {
        let n = self.mechanism.n();
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
        let mut next = self.q.clone();
        let rates: Vec<f64> = rates.iter().zip(&space.columns).map(|(r, c)| r * c).collect();
        self.mechanism.integrate_in_place(&mut next, &rates[..self.q.len()], dt);
        let ahead = ActuationMap::of(&self.mechanism.state(&next)?, &self.weights, &self.locked)?;
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
        let mut y = vec![0.0; self.actuated];
        project(&self.coupling.motions, &self.coupling.is_actuated, rates, space, &mut y);
        y
    }

    /// Assembles the loops of `q` after integration: the actuated joints keep their values if the
    /// loops permit it.
    pub(super) fn close(&self, q: &mut [f64]) {
        let coordinates = self.mechanism.coordinates();
        let actuated: Vec<usize> = (0..q.len()).filter(|&i| coordinates[i].actuated).collect();
        for prescribed in [actuated, self.locked.clone()] {
            match assemble(&self.mechanism, q, &prescribed) {
                Ok(found) if found.closed => return q.copy_from_slice(&found.q),
                _ => {}
            }
        }
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
    use crate::control::solver::bounds::{LimitKind, VelocityBounds};
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
        let chain = Chain::new(&panda, panda.tool());
        let space = TaskSpace::new(ServoOptions::new(&panda).scaling(), &chain, &limits);
        let method = Method::Truncated { eps: 1e-9 };
        let (mut kept, mut changed) = (0, 0);
        for _ in 0..300 {
            let q: Vec<f64> = panda.home().iter().map(|x| x + next()).collect();
            let mut coupled = Coupled::new(&panda, &[], Vec::new(), 6).unwrap();
            coupled.task =
                panda.state(&q).unwrap().jacobian(panda.tool(), ReferenceFrame::LocalWorldAligned);
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
            let saturation = saturator.apply_coupled(problem, &mut coupled.coupling, &mut found);
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
