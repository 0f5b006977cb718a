//! The motions of a closed chain: all joint velocities that its actuated joints can command, at the
//! closed configuration nearest to a measured one.
//!
//! Formula  joint velocities = M y, W^(1/2) times the actuated ones of unit length for unit y
//!          (`closure/mobility/coordinate_partitioning.rs`, near singularities `actuation_map.rs`)
//! Shapes   M: (n + e) x a, e the actuated loop joints, columns beyond the independent motions zero
//! Valid    any mechanism. Allocates near type II singularities only, where the loops are analysed
//!          in full, and where passive joints do not move as commanded: loops are assembled there
//! Checked  tests/it/servo/object.rs, tests/it/servo/measured.rs, tests/it/servo/plant.rs

use super::sensor_fit::SensorFit;
use super::stopping::stopping_velocity;
use crate::closure::{ActuationMap, CoordinatePartitioning, LoopClosureError, assemble};
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{Limits, Mechanism};
use crate::tolerance::{MIN_ACTUATED_SHARE, NEARLY_CLOSED};

/// Steps of Newton's method that close a measured configuration: from loops open by
/// `NEARLY_CLOSED` four reach rounding.
const CLOSING_STEPS: usize = 5;

/// The loops of a mechanism at a configuration.
#[derive(Debug, Clone)]
pub(in crate::control) struct LoopMotions {
    mechanism: Mechanism,
    weights: Vec<f64>,
    locked: Vec<usize>,
    /// Number of actuated joints.
    pub(in crate::control) actuated: usize,
    /// Number of independent actuated motions.
    pub(in crate::control) independent: usize,
    partitioning: CoordinatePartitioning,
    /// True if the partitioning is solved at `q`.
    is_regular: bool,
    /// The closed configuration nearest to the measured one.
    q: Vec<f64>,
    /// The change of the measured configuration that closes its loops to first order: of the passive
    /// joints, and of the actuated ones with those that follow them.
    pub(in crate::control) passive_change: Vec<f64>,
    pub(in crate::control) actuated_change: Vec<f64>,
    /// The same in the present step of Newton's method.
    passive_step: Vec<f64>,
    actuated_step: Vec<f64>,
    /// Velocities of a motion of the passive joints alone.
    rates: Vec<f64>,
}

impl LoopMotions {
    /// For a mechanism with loops or contacts; the coordinates `locked` are fixed.
    pub(in crate::control) fn new(
        mechanism: &Mechanism,
        weights: &[f64],
        locked: Vec<usize>,
    ) -> Result<Self> {
        let partitioning = CoordinatePartitioning::new(mechanism, &locked)?;
        let velocities = partitioning.velocities();
        let tree = mechanism.coordinates().iter().filter(|c| c.actuated).count();
        let actuated = tree + velocities - mechanism.n();
        Ok(Self {
            mechanism: mechanism.clone(),
            weights: weights.to_vec(),
            locked,
            actuated,
            independent: actuated,
            partitioning,
            is_regular: false,
            q: mechanism.home().to_vec(),
            passive_change: vec![0.0; velocities],
            actuated_change: vec![0.0; velocities],
            passive_step: vec![0.0; velocities],
            actuated_step: vec![0.0; velocities],
            rates: vec![0.0; velocities],
        })
    }

    /// A copy for other configurations. It is loaded once: a clone alone has no memory of its own, and
    /// its first step would allocate.
    pub(in crate::control) fn loaded_copy(&self) -> Result<Self> {
        let mut copy = self.clone();
        copy.set_closed(self.mechanism.home())?;
        Ok(copy)
    }

    pub(super) fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Number of coordinates and actuated loop joints.
    pub(in crate::control) fn velocities(&self) -> usize {
        self.partitioning.velocities()
    }

    /// True for the actuated ones of them.
    pub(in crate::control) fn are_actuated(&self) -> Vec<bool> {
        let own = self.mechanism.coordinates().iter().map(|c| c.actuated);
        own.chain((self.q.len()..self.velocities()).map(|_| true)).collect()
    }

    /// Replaces the weights of all coordinates, before [`LoopMotions::load`].
    pub(in crate::control) fn set_weights(
        &mut self,
        weights: impl Iterator<Item = f64>,
    ) -> Result<()> {
        self.weights.clear();
        self.weights.extend(weights);
        self.partitioning.load(&self.q)?;
        self.is_regular = self.partitioning.solve(&self.weights);
        Ok(())
    }

    /// The closed configuration nearest to the measured one.
    pub(in crate::control) fn q(&self) -> &[f64] {
        &self.q
    }

    /// Closes the loops of a measured configuration: Newton's method, on the passive joints alone
    /// if there are no more actuated ones than degrees of freedom.
    ///
    /// # Errors
    /// Loops with a closure error above `NEARLY_CLOSED`.
    pub(in crate::control) fn close_measured(&mut self, q: &[f64]) -> Result<()> {
        self.close_regular(q).map(|_| ())
    }

    /// [`LoopMotions::close_measured`]; false, and then at `q`, if Newton's method does not close them.
    fn close_regular(&mut self, q: &[f64]) -> Result<bool> {
        let length = self.mechanism.reach();
        let mut closure_error = self.partitioning.load(q)?;
        if !is_nearly_closed(closure_error, length) {
            let LoopClosureError { distance, angle } = closure_error;
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
        self.close_present(&mut closure_error)?;
        if !self.is_regular {
            self.q.copy_from_slice(q);
            self.partitioning.load(q)?;
        }
        Ok(self.is_regular && closure_error.is_closed(length))
    }

    /// [`LoopMotions::close_measured`] for passive joints that are tracked: near type II singularities,
    /// where they turn fast, and where they did not move as predicted, the loops are assembled.
    ///
    /// # Errors
    /// Loops with a closure error above `NEARLY_CLOSED` that the passive joints cannot close nearby.
    pub(super) fn close_tracked(&mut self, q: &[f64]) -> Result<()> {
        let closed = self.close_regular(q);
        if matches!(closed, Ok(true)) {
            return Ok(());
        }
        let near = |(i, (x, q)): (usize, (&f64, &f64))| {
            (x - q).abs() <= NEARLY_CLOSED.sqrt() * self.mechanism.unit_of(i)
        };
        let is_near = |x: &Vec<f64>| x.iter().zip(q).enumerate().all(near);
        let found = self.assembled(q, &self.actuated_coordinates()).filter(is_near);
        let found = match (found, closed) {
            (None, Err(open)) => return Err(open),
            // Nearly closed: drives beside a fold yield by the errors of their positions.
            (None, Ok(_)) => self.assembled(q, &self.locked).filter(is_near),
            (found, _) => found,
        };
        if let Some(found) = found {
            self.set_closed(&found)?;
            self.passive_change.fill(0.0);
            self.actuated_change.fill(0.0);
        }
        Ok(())
    }

    /// Closes the loops of a configuration `q` to which commands lead from a closed one, `from`, where
    /// they open on the way by more than [`LoopMotions::close_measured`] permits: the passive joints do
    /// not follow commands, and drives that cannot reach it stop before. It is `from` if that fails.
    pub(in crate::control) fn close_ahead(&mut self, q: &mut [f64], from: &[f64]) -> Result<()> {
        let length = self.mechanism.reach();
        if !is_nearly_closed(self.partitioning.load(q)?, length) {
            self.close(q);
            if !is_nearly_closed(self.partitioning.load(q)?, length) {
                q.copy_from_slice(from);
            }
        }
        Ok(())
    }

    /// Closes the loops of `q`, which is loaded.
    fn close_present(&mut self, closure_error: &mut LoopClosureError) -> Result<()> {
        let length = self.mechanism.reach();
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
            let n = self.q.len();
            self.mechanism.integrate_in_place(&mut self.q, &passive_step[..n], 1.0);
            *closure_error = self.partitioning.load(&self.q)?;
            self.is_regular = self.partitioning.solve(&self.weights);
        }
        Ok(())
    }

    /// Memory to fit positions of more coordinates than the actuated ones.
    pub(super) fn sensor_fit(&self) -> SensorFit {
        let scales = (0..self.q.len()).map(|i| 1.0 / self.mechanism.unit_of(i)).collect();
        SensorFit::new(scales, self.actuated, self.velocities() - self.q.len())
    }

    /// Moves the closed configuration to the one nearest to all measured positions; away from type II
    /// singularities.
    pub(super) fn fit(&mut self, fit: &mut SensorFit) -> Result<()> {
        if !self.is_regular {
            return Ok(());
        }
        let (partitioning, q) = (&mut self.partitioning, &mut self.q);
        fit.solve(q, partitioning.motions(), |j, motion| partitioning.motion_into(j, motion));
        self.mechanism.integrate_in_place(q, &fit.step, 1.0);
        let mut closure_error = self.partitioning.load(&self.q)?;
        self.close_present(&mut closure_error)
    }

    /// Moves the closed configuration by these changes of the actuated joints (n + e entries), the
    /// passive ones follow; writes the changes of all. False, and then at no place in particular, if
    /// the loops cannot be followed so far or are near a type II singularity.
    pub(in crate::control) fn follow(&mut self, change: &[f64], moved: &mut [f64]) -> Result<bool> {
        moved.fill(0.0);
        self.add_following(change, moved);
        let n = self.q.len();
        self.mechanism.integrate_in_place(&mut self.q, &moved[..n], 1.0);
        let mut closure_error = self.partitioning.load(&self.q)?;
        self.close_present(&mut closure_error)?;
        let corrections = self.passive_change.iter().zip(&self.actuated_change);
        moved.iter_mut().zip(corrections).for_each(|(moved, (p, a))| *moved += p + a);
        Ok(self.is_regular && closure_error.is_closed(self.mechanism.reach()))
    }

    /// Goes back to a closed configuration; false near a type II singularity.
    pub(in crate::control) fn set_closed(&mut self, q: &[f64]) -> Result<bool> {
        self.q.copy_from_slice(q);
        self.partitioning.load(q)?;
        self.is_regular = self.partitioning.solve(&self.weights);
        Ok(self.is_regular)
    }

    /// Adds the changes of all joints, to first order, for those of the actuated ones.
    pub(in crate::control) fn add_following(&mut self, change: &[f64], moved: &mut [f64]) {
        for j in 0..self.partitioning.motions() {
            self.partitioning.motion_into(j, &mut self.rates);
            let weight = |i: usize| self.weights.get(i).copied().unwrap_or(1.0);
            let all = self.rates.iter().zip(change).enumerate();
            // Changes of passive joints are zero.
            let along: f64 = all.map(|(i, (m, change))| weight(i) * m * change).sum();
            moved.iter_mut().zip(&self.rates).for_each(|(moved, m)| *moved += along * m);
        }
    }

    /// Writes M at the closed configuration. `moves` says whether velocities of the n + e (which it
    /// may change) move what is controlled: where the passive joints alone can do that, or where the
    /// actuated ones may take a small share of a motion, the map of all motions is returned.
    pub(in crate::control) fn load(
        &mut self,
        motions: &mut Matrix,
        mut moves: impl FnMut(&mut [f64]) -> bool,
    ) -> Result<Option<ActuationMap>> {
        motions.as_mut_slice().fill(0.0);
        let passive = self.partitioning.passive_motions();
        let is_controlled = self.is_regular
            && (0..passive).all(|j| {
                self.partitioning.passive_motion_into(j, &mut self.rates);
                !moves(&mut self.rates)
            });
        if is_controlled {
            self.independent = self.partitioning.motions();
            for j in 0..self.independent {
                self.partitioning.motion_into(j, motions.column_mut(j));
            }
            return Ok(None);
        }
        let map = ActuationMap::of(self.partitioning.state(), &self.weights, &self.locked)?;
        if !self.is_regular {
            self.actuated_change.copy_from_slice(&map.correction);
        }
        self.independent = map.motions.cols();
        for j in 0..self.independent {
            motions.column_mut(j).copy_from_slice(map.motions.column(j));
        }
        Ok(Some(map))
    }

    /// The map of all motions after `dt` at these velocities.
    pub(in crate::control) fn map_after(
        &self,
        velocities: &[f64],
        dt: f64,
    ) -> Result<ActuationMap> {
        let mut next = self.q.clone();
        self.mechanism.integrate_in_place(&mut next, &velocities[..self.q.len()], dt);
        ActuationMap::of(&self.mechanism.state(&next)?, &self.weights, &self.locked)
    }

    /// The least acceleration limit of the actuated joints [rad/s^2, or lengths of the mechanism/s^2].
    pub(in crate::control) fn least_acceleration(
        &self,
        is_actuated: &[bool],
        limits: &[Limits],
    ) -> f64 {
        let actuated = limits.iter().zip(is_actuated).enumerate().filter(|(_, (_, is))| **is);
        actuated
            .map(|(i, (limits, _))| limits.acceleration / self.mechanism.unit_of(i))
            .fold(f64::INFINITY, f64::min)
    }

    /// Bounds the velocity of a passive joint such that no step, nor the way to rest, passes a type II
    /// singularity unseen: the actuated share of motions falls by at most a half in it.
    pub(in crate::control) fn bound_passive(
        &self,
        i: usize,
        acceleration: f64,
        dt: f64,
        bounds: &mut VelocityBounds,
    ) {
        let share = if self.is_regular { self.partitioning.least_share() } else { 0.0 };
        let share = share.max(MIN_ACTUATED_SHARE);
        let size = self.mechanism.unit_of(i);
        // The share is about the angle to the singularity; passive joints are 1 / share times as fast
        // as actuated ones.
        let way = 0.5 * share;
        let most = size * stopping_velocity(way, acceleration / share, dt);
        if most < bounds.upper {
            (bounds.upper, bounds.upper_cause) = (most.max(bounds.lower), LimitKind::Velocity);
        }
        if -most > bounds.lower {
            (bounds.lower, bounds.lower_cause) = ((-most).min(bounds.upper), LimitKind::Velocity);
        }
    }

    /// Assembles the loops of `q` after integration: the actuated joints keep their values if the
    /// loops permit it.
    pub(in crate::control) fn close(&self, q: &mut [f64]) {
        let q = &mut q[..self.mechanism.n()];
        let held = self.assembled(q, &self.actuated_coordinates());
        if let Some(found) = held.or_else(|| self.assembled(q, &self.locked)) {
            q.copy_from_slice(&found);
        }
    }

    /// The assembled configuration near `q` in which the prescribed coordinates have its values.
    fn assembled(&self, q: &[f64], prescribed: &[usize]) -> Option<Vec<f64>> {
        let found = assemble(&self.mechanism, q, prescribed).ok()?;
        found.closed.then_some(found.q)
    }

    fn actuated_coordinates(&self) -> Vec<usize> {
        self.mechanism.actuated().collect()
    }
}

/// True for loops that a servo closes as it moves.
fn is_nearly_closed(error: LoopClosureError, length: f64) -> bool {
    error.distance <= NEARLY_CLOSED * length && error.angle <= NEARLY_CLOSED
}

/// The error for mechanisms in which no joint is actuated.
pub(in crate::control) fn nothing_actuated(mechanism: &Mechanism) -> Error {
    Error::Model {
        model: mechanism.name().to_owned(),
        culprit: String::new(),
        message: format!(
            "no joint of '{}' is actuated, so nothing can drive it: mark joints with `actuated = \
             true`, or choose them (--actuated, `with_actuated`)",
            mechanism.name()
        ),
    }
}
