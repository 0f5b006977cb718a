//! The unknowns of a step: the velocities of all joints of a tree, or the actuated motions of a closed
//! chain.
//!
//! Formula  joint velocities = M y: of a tree the roots of the joint weights, of a closed chain
//!          `control/servo/loop_motions.rs`
//! Shapes   M: v x u; v = n without loops, otherwise n and the actuated loop joints
//! Units    M: 1; y: roots of the weights times rad/s or m/s
//! Checked  tests/it/servo/closed_tasks.rs, tests/it/servo/tasks.rs

use super::levels::TaskRows;
use super::options::TaskServoOptions;
use crate::closure::ActuationMap;
use crate::control::servo::{JointState, LoopMotions, is_locked, nothing_actuated};
use crate::control::solver::bounds::VelocityBounds;
use crate::control::solver::saturation::Coupling;
use crate::error::Result;
use crate::linalg::{Matrix, norm};
use crate::model::{Limits, Mechanism};
use crate::tolerance::{MIN_ACTUATED_SHARE, UNACTUATED};

/// The joint velocities as they follow from the unknowns.
#[derive(Debug, Clone)]
pub(super) enum Motions {
    /// 1 / root of the weight of each joint; 0 for locked ones.
    Tree(Vec<f64>),
    Loops(Box<Loops>),
}

/// Of a closed chain.
#[derive(Debug, Clone)]
pub(super) struct Loops {
    motions: LoopMotions,
    coupling: Coupling,
    weights: Vec<f64>,
    /// The least acceleration limit of the actuated joints [rad/s^2, or lengths of the mechanism/s^2].
    acceleration: f64,
    /// The smallest actuated share of a motion that moves a task, where it is small.
    weakest: Option<f64>,
}

/// What limits of the jerk permit in a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum JerkBounds<'a> {
    /// Any velocity within the limits of positions and speeds.
    None,
    /// Every velocity from which the limits can be kept.
    All,
    /// Those on the way to these velocities of the joints, at which the accelerations end.
    Towards(&'a [f64]),
}

impl Motions {
    /// For joints with these limits (n coordinates, then actuated loop joints).
    pub(super) fn new(
        mechanism: &Mechanism,
        options: &TaskServoOptions,
        limits: &[Limits],
    ) -> Result<Self> {
        let weight = |i: usize| options.joint_weights.get(i).copied().unwrap_or(1.0);
        if !mechanism.is_closed() {
            let column = |(i, l): (usize, &Limits)| {
                if is_locked(l) { 0.0 } else { 1.0 / weight(i).sqrt() }
            };
            return Ok(Self::Tree(limits.iter().enumerate().map(column).collect()));
        }
        let locked = (0..mechanism.n()).filter(|&i| is_locked(&limits[i])).collect();
        let motions = LoopMotions::new(mechanism, &options.joint_weights, locked)?;
        if motions.actuated == 0 {
            return Err(nothing_actuated(mechanism));
        }
        Ok(Self::Loops(Box::new(Loops {
            coupling: Coupling::new(motions.are_actuated(), motions.actuated),
            weights: (0..limits.len()).map(weight).collect(),
            acceleration: motions.least_acceleration(&motions.are_actuated(), limits),
            weakest: None,
            motions,
        })))
    }

    /// u
    pub(super) fn unknowns(&self) -> usize {
        match self {
            Self::Tree(columns) => columns.len(),
            Self::Loops(loops) => loops.motions.actuated,
        }
    }

    /// Number of inequality rows for the limits of joints: of a tree none, they bound the unknowns.
    pub(super) fn limit_rows(&self) -> usize {
        match self {
            Self::Tree(_) => 0,
            Self::Loops(loops) => loops.motions.velocities(),
        }
    }

    /// The closed configuration nearest to a measured one; of a tree, the measured one.
    pub(super) fn close_measured<'a>(&'a mut self, q: &'a [f64]) -> Result<&'a [f64]> {
        match self {
            Self::Tree(_) => Ok(q),
            Self::Loops(loops) => {
                loops.motions.close_measured(q)?;
                Ok(loops.motions.q())
            }
        }
    }

    /// Closes the loops of a predicted configuration, given with the measured one, see
    /// [`LoopMotions::close_ahead`].
    pub(super) fn close_ahead(&mut self, q: &mut [f64], from: &[f64]) -> Result<()> {
        match self {
            Self::Tree(_) => Ok(()),
            Self::Loops(loops) => loops.motions.close_ahead(q, from),
        }
    }

    /// Computes M, with the rows of the tasks at the closed configuration.
    pub(super) fn load(&mut self, tasks: &[TaskRows], length: f64, dt: f64) -> Result<()> {
        let Self::Loops(loops) = self else { return Ok(()) };
        let Loops { motions, coupling, weakest, .. } = &mut **loops;
        let moves = |rates: &[f64]| tasks.iter().any(|task| moves(task, rates, length));
        let map = motions.load(&mut coupling.motions, |rates| moves(rates))?;
        *weakest = map.and_then(|map| weakest_share(&map, moves));
        for (i, (c, d)) in
            coupling.correction.iter_mut().zip(&mut coupling.actuated_correction).enumerate()
        {
            *c = motions.passive_change[i] / dt;
            *d = motions.actuated_change[i] / dt;
        }
        Ok(())
    }

    /// Entry `j` of `g M`, g a row over the n coordinates.
    pub(super) fn entry(&self, g: impl Fn(usize) -> f64, j: usize) -> f64 {
        match self {
            Self::Tree(columns) => columns[j] * g(j),
            Self::Loops(loops) => {
                let n = loops.motions.q().len();
                let column = &loops.coupling.motions.column(j)[..n];
                column.iter().enumerate().map(|(i, m)| if *m == 0.0 { 0.0 } else { g(i) * m }).sum()
            }
        }
    }

    /// Writes column `j` of `J M`.
    pub(super) fn load_column(&self, jacobian: &Matrix, j: usize, out: &mut [f64]) {
        match self {
            Self::Tree(columns) => {
                let column = out.iter_mut().zip(jacobian.column(j));
                column.for_each(|(x, a)| *x = columns[j] * a);
            }
            Self::Loops(loops) => {
                out.fill(0.0);
                let motions = loops.coupling.motions.column(j);
                for i in (0..jacobian.cols()).filter(|&i| motions[i] != 0.0) {
                    out.iter_mut().zip(jacobian.column(i)).for_each(|(x, a)| *x += a * motions[i]);
                }
            }
        }
    }

    /// Row `i` of M at column `j`.
    pub(super) fn motion(&self, i: usize, j: usize) -> f64 {
        match self {
            Self::Tree(columns) => {
                if i == j {
                    columns[j]
                } else {
                    0.0
                }
            }
            Self::Loops(loops) => loops.coupling.motions[(i, j)],
        }
    }

    /// The unknowns nearest to these joint velocities.
    pub(super) fn unknowns_of(&self, rates: &[f64], y: &mut [f64]) {
        match self {
            Self::Tree(columns) => {
                for ((y, rate), column) in y.iter_mut().zip(rates).zip(columns) {
                    *y = if *column == 0.0 { 0.0 } else { rate / column };
                }
            }
            Self::Loops(loops) => {
                let Coupling { motions, is_actuated, .. } = &loops.coupling;
                for (j, y) in y.iter_mut().enumerate() {
                    let parts = motions.column(j).iter().zip(rates).zip(&loops.weights);
                    let actuated = parts.zip(is_actuated).filter(|(_, is_actuated)| **is_actuated);
                    *y = actuated.map(|(((m, rate), weight), _)| m * rate * weight).sum();
                }
            }
        }
    }

    /// The joint velocities for y alone.
    pub(super) fn rates_of(&self, y: &[f64], rates: &mut [f64]) {
        match self {
            Self::Tree(columns) => {
                let all = rates.iter_mut().zip(y).zip(columns);
                all.for_each(|((rate, y), column)| *rate = y * column);
            }
            Self::Loops(loops) => loops.coupling.expand(y, rates),
        }
    }

    /// The joint velocities for y, within the bounds to the last bit; `rates` are those before.
    pub(super) fn velocities(&mut self, y: &[f64], bounds: &[VelocityBounds], rates: &mut [f64]) {
        match self {
            Self::Tree(columns) => {
                for (((rate, y), column), bound) in rates.iter_mut().zip(y).zip(columns).zip(bounds)
                {
                    *rate = if *column == 0.0 { 0.0 } else { bound.clamp(y * *column) };
                }
            }
            Self::Loops(loops) => {
                loops.coupling.expand(y, rates);
                loops.coupling.correct(bounds, rates);
            }
        }
    }

    /// Of a closed chain.
    pub(super) fn loops(&self) -> Option<&LoopMotions> {
        match self {
            Self::Tree(_) => None,
            Self::Loops(loops) => Some(&loops.motions),
        }
    }

    /// False for the passive joints of a closed chain.
    pub(super) fn is_actuated(&self, i: usize) -> bool {
        match self {
            Self::Tree(_) => true,
            Self::Loops(loops) => loops.coupling.is_actuated[i],
        }
    }

    /// True for a joint that the servo commands: neither locked in a tree nor passive in a closed chain.
    pub(super) fn is_driven(&self, i: usize) -> bool {
        match self {
            Self::Tree(columns) => columns[i] != 0.0,
            Self::Loops(_) => self.is_actuated(i),
        }
    }

    /// The bounds of joint `i` for the next step.
    pub(super) fn bounds(
        &self,
        i: usize,
        limits: &Limits,
        now: JointState,
        dt: f64,
    ) -> VelocityBounds {
        match self {
            Self::Loops(loops) if !self.is_actuated(i) => {
                let mut bounds = VelocityBounds::passive(limits, now, dt);
                loops.motions.bound_passive(i, loops.acceleration, dt, &mut bounds);
                bounds
            }
            _ => VelocityBounds::next(limits, now, dt),
        }
    }

    /// The largest rate of change of `c y`, for those of the actuated joints within one of their
    /// limits: accelerations of velocities, jerks of accelerations.
    pub(super) fn largest_change(
        &self,
        c: impl Fn(usize) -> f64,
        limits: &[Limits],
        of: fn(&Limits) -> f64,
    ) -> f64 {
        let part = |coefficient: f64, limits: &Limits| {
            if coefficient == 0.0 { 0.0 } else { coefficient.abs() * of(limits) }
        };
        match self {
            Self::Tree(columns) => {
                let all = columns.iter().zip(limits).enumerate();
                let free = all.filter(|(_, (column, _))| **column != 0.0);
                free.map(|(i, (column, limits))| part(c(i) / column, limits)).sum()
            }
            Self::Loops(loops) => {
                let Coupling { motions, is_actuated, .. } = &loops.coupling;
                let actuated = (0..limits.len()).filter(|&i| is_actuated[i]);
                let coefficient = |i: usize| -> f64 {
                    let columns = 0..motions.cols();
                    loops.weights[i] * columns.map(|j| c(j) * motions[(i, j)]).sum::<f64>()
                };
                actuated.map(|i| part(coefficient(i), &limits[i])).sum()
            }
        }
    }

    /// True if these joint velocities approach a type II singularity that is near.
    pub(super) fn approaches_type_ii(
        &self,
        rates: &[f64],
        tasks: &[TaskRows],
        length: f64,
        dt: f64,
    ) -> Result<bool> {
        let Self::Loops(loops) = self else { return Ok(false) };
        let Some(now) = loops.weakest else { return Ok(false) };
        let ahead = loops.motions.map_after(rates, dt)?;
        let then = weakest_share(&ahead, |rates| tasks.iter().any(|t| moves(t, rates, length)));
        Ok(then.is_some_and(|then| then <= now))
    }

    /// Closes the loops of `q` after integration.
    pub(super) fn close(&self, q: &mut [f64]) {
        if let Self::Loops(loops) = self {
            loops.motions.close(q);
        }
    }
}

/// True if these joint velocities change the error of a task.
fn moves(task: &TaskRows, rates: &[f64], length: f64) -> bool {
    let jacobian = &task.jacobian;
    (0..jacobian.rows()).any(|r| {
        let own = rates.iter().take(jacobian.cols()).enumerate();
        let rate: f64 = own.map(|(j, rate)| jacobian[(r, j)] * rate).sum();
        let size = if task.is_length[r] { length } else { 1.0 };
        // NaN does.
        !(rate.abs() <= UNACTUATED * size)
    })
}

/// The smallest actuated share of a motion that moves a task, if it is small.
fn weakest_share(map: &ActuationMap, moves: impl Fn(&[f64]) -> bool) -> Option<f64> {
    let left = (0..map.uncontrolled.cols()).map(|j| (0.0, map.uncontrolled.column(j)));
    let weak = map.shares.iter().enumerate().map(|(j, s)| (*s, map.directions.column(j)));
    let mut small = left.chain(weak).take_while(|(share, _)| *share < MIN_ACTUATED_SHARE);
    small.find(|(_, motion)| norm(motion) > 0.0 && moves(motion)).map(|(share, _)| share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a row of lengths and one of angles, that feel the second and the third of three joints.
    #[test]
    fn a_task_moves_by_its_own_joints_alone() {
        let mut jacobian = Matrix::zeros(2, 3);
        (jacobian[(0, 1)], jacobian[(1, 2)]) = (0.5, 2.0);
        let task = TaskRows {
            measured_error: vec![0.0; 2],
            error: vec![0.0; 2],
            feed_forward: vec![0.0; 2],
            jacobian,
            is_length: vec![true, false],
        };
        for (rates, expected) in [
            ([1.0, 0.0, 0.0], false),
            ([0.0, 1.0, 0.0], true),
            ([0.0, 0.0, -1.0], true),
            ([0.0, 1e-6, 0.0], false),
            ([0.0, 0.0, 1e-6], true),
            ([f64::NAN, 0.0, 0.0], true),
        ] {
            assert_eq!(moves(&task, &rates, 1e4), expected, "{rates:?}");
        }
    }
}
