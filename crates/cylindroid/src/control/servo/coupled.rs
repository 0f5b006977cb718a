//! Closed chains in the servo: joints coupled by loops and contacts, hands with an object, two arms
//! holding one object.
//!
//! Formula  joint velocities = M y + s_0 (`closure/mobility/actuation_map.rs`), s_0 the correction
//!          that closes the loops within one step; the task is J M y = x, its minimum-norm solution
//!          y the least weighted effort of the actuated joints; limits apply to all joints
//!          (`solver/saturation.rs`)
//! Shapes   M: (n + e) x a, columns beyond p zero; J: m x n; y: a
//! Units    velocities over the roots of the joint weights internally, as in `task_space.rs`
//! Valid    any mechanism whose actuated joints control its object. Allocates: the loops are
//!          analysed again in every step
//! Stops    before a type II singularity, where the object would gain an uncontrolled motion
//! Checked  tests/it/servo/object.rs

use super::task_space::TaskSpace;
use crate::closure::{ActuationMap, LoopClosureError, assemble};
use crate::control::solver::saturation::Coupling;
use crate::error::{Error, Result};
use crate::ik::Task;
use crate::linalg::{Matrix, norm};
use crate::model::Mechanism;
use crate::tolerance::{MIN_ACTUATED_SHARE, NEARLY_CLOSED, UNACTUATED};

/// The coupled joints of a servo.
#[derive(Debug, Clone)]
pub(super) struct Coupled {
    mechanism: Mechanism,
    weights: Vec<f64>,
    locked: Vec<usize>,
    actuated: usize,
    actuation_map: ActuationMap,
    /// J in weighted velocities, m x n.
    pub(super) task: Matrix,
    pub(super) coupling: Coupling,
    /// The controlled motion with the smallest actuated share, if that share is small.
    uncontrolled: Option<UncontrolledMotion>,
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
        let actuation_map =
            ActuationMap::of(&mechanism.state(mechanism.home())?, weights, &locked)?;
        let tree = mechanism.coordinates().iter().filter(|c| c.actuated).count();
        let actuated = tree + actuation_map.correction.len() - mechanism.n();
        Ok(Self {
            mechanism: mechanism.clone(),
            weights: weights.to_vec(),
            locked,
            actuated,
            coupling: Coupling::new(actuation_map.correction.len(), actuated),
            actuation_map,
            task: Matrix::zeros(m, mechanism.n()),
            uncontrolled: None,
        })
    }

    /// Replaces the weights of all coordinates.
    pub(super) fn set_weights(&mut self, weights: impl Iterator<Item = f64>) {
        self.weights.clear();
        self.weights.extend(weights);
    }

    /// Number of actuated joints: the size of y.
    pub(super) fn actuated_joints(&self) -> usize {
        self.actuated
    }

    /// Number of independent actuated motions: the non-zero columns of M.
    pub(super) fn actuated_motions(&self) -> usize {
        self.actuation_map.motions.cols()
    }

    /// Analyses the loops at `q`, with `self.task` the task there, and computes J M. `space` scales
    /// the velocities.
    ///
    /// # Errors
    /// Loops with a closure error above `NEARLY_CLOSED`.
    pub(super) fn load(
        &mut self,
        q: &[f64],
        space: &TaskSpace,
        dt: f64,
        reduced: &mut Matrix,
    ) -> Result<()> {
        let state = self.mechanism.state(q)?;
        self.actuation_map = ActuationMap::of(&state, &self.weights, &self.locked)?;
        let LoopClosureError { distance, angle } = self.actuation_map.closure_error;
        if !(distance <= NEARLY_CLOSED * self.mechanism.reach() && angle <= NEARLY_CLOSED) {
            return Err(Error::InvalidOption {
                option: "q",
                value: format!("loops open by {distance:.3e} m, {angle:.3e} rad"),
                reason: format!(
                    "a servo maintains the loops of '{}' but does not close them; assemble it first",
                    self.mechanism.name()
                ),
            });
        }
        self.coupling.motions.as_mut_slice().fill(0.0);
        for j in 0..self.actuation_map.motions.cols() {
            let from = self.actuation_map.motions.column(j);
            for (i, x) in self.coupling.motions.column_mut(j).iter_mut().enumerate() {
                *x = space.scaled_rate(i, from[i]);
            }
        }
        for (i, x) in self.coupling.correction.iter_mut().enumerate() {
            *x = space.scaled_rate(i, self.actuation_map.correction[i] / dt);
        }
        let n = self.mechanism.n();
        for j in 0..self.actuated {
            let rates = &self.coupling.motions.column(j)[..n];
            self.task.mul_vec_into(rates, reduced.column_mut(j));
        }
        self.uncontrolled = self.find_uncontrolled(&self.actuation_map, space);
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
        q: &[f64],
        rates: &[f64],
        space: &TaskSpace,
        dt: f64,
    ) -> Result<bool> {
        let Some(now) = &self.uncontrolled else { return Ok(false) };
        let mut next = q.to_vec();
        let rates: Vec<f64> = rates.iter().zip(&space.columns).map(|(r, c)| r * c).collect();
        self.mechanism.integrate_in_place(&mut next, &rates[..q.len()], dt);
        let ahead = ActuationMap::of(&self.mechanism.state(&next)?, &self.weights, &self.locked)?;
        Ok(self.find_uncontrolled(&ahead, space).is_some_and(|then| then.share <= now.share))
    }

    /// Projects the velocities of the secondary tasks (all joints, unweighted) onto the actuated
    /// motions.
    pub(super) fn load_secondary(&mut self, velocities: &[f64]) {
        self.coupling.secondary = self.actuation_of(velocities);
    }

    /// Projects the velocities of the last step (all joints, unweighted) likewise.
    pub(super) fn load_last(&mut self, rates: &[f64]) {
        self.coupling.last = self.actuation_of(rates);
    }

    /// The actuation y of velocities of all joints (unweighted).
    pub(super) fn actuation_of(&self, rates: &[f64]) -> Vec<f64> {
        let mut y = self.actuation_map.project(rates);
        y.resize(self.actuated, 0.0);
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
    use crate::control::solver::saturation::{Problem, RELEASE, Saturator, solve};
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
        let (mut kept, mut bent) = (0, 0);
        for _ in 0..300 {
            let q: Vec<f64> = panda.home().iter().map(|x| x + next()).collect();
            let mut coupled = Coupled::new(&panda, &[], Vec::new(), 6).unwrap();
            coupled.task =
                panda.state(&q).unwrap().jacobian(panda.tool(), ReferenceFrame::LocalWorldAligned);
            let mut reduced = Matrix::zeros(6, actuated);
            coupled.load(&q, &space, 1e-3, &mut reduced).unwrap();
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

            let problem = Problem { j: &task, bounds: &bounds, last: &last, gain: 1.0, error: 1.0 };
            let mut saturator = Saturator::new(6, panda.n(), None);
            let expected = saturator.apply(problem, &last, &mut rates);

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
                bent += 1;
                // The optimum, except for joints whose gradient is below `RELEASE`: by convexity
                // they are worth at most this much.
                let apart: f64 = found.iter().zip(&rates).map(|(a, b)| (a - b).abs()).sum();
                let pull = RELEASE * Svd::of(&task).value(0) * left(&rates).sqrt();
                assert!((left(&found) - left(&rates)).abs() <= 2.0 * pull * apart + 1e-9);
                assert!(left(&found) <= left(&last) + 1e-9);
            } else {
                kept += 1;
                assert!((saturation.scale - expected.scale).abs() < 1e-9);
                for (a, b) in found.iter().zip(&rates) {
                    assert!((a - b).abs() < 1e-8, "{found:?} {rates:?}");
                }
            }
        }
        assert!(kept > 50 && bent > 5, "{kept} kept, {bent} bent");
    }
}
