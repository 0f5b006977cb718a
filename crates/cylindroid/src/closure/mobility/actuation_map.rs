//! ActuationMap: what the actuated joints of a closed chain can do, and what all other joints do with them.
//!
//! Formula  C s = 0 for the rates s of all joints: held rows of loops and contacts, and for actuated
//!          loop joints the rows that measure their rate; ker C = [X c; Y s] Z^T, actuated rows
//!          above passive ones. Directions with c = 0 are left to themselves, the others are
//!          steered: s = M y + s_0, actuated rates = D y with |D y|_W = |y|;
//!          s_0 = -C^+ residual is the way to where the loops are closed
//! Shapes   C: t x (n + e), n coordinates of the tree, e actuated loop joints; M: (n + e) x p;
//!          D: a x p, orthonormal in the weighted rates of the an actuated joints
//! Units    lengths over the reach for every rank decision; rates in rad/s and m/s outside
//! Valid    any mechanism; for a tree without passive joints M is W^(-1/2). Of the motions that
//!          have the same actuated rates it is the one in which passive joints move least (scaled)
//! Why so   in y the loops are kept whatever y is, and the least y is the least weighted effort of
//!          the actuators, passive joints not counted
//! Source   Bicchi & Prattichizzo 1998, eqs. 2 to 4, in coordinates of the spanning tree
//! Checked  tests/it/closure/actuation_map.rs

use crate::closure::constraint::constraint_rows::{
    ConstraintRow, constraint_rows, for_each_rate, rate_unit,
};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::constraint::velocity_constraint::{Unit, kernel_tolerance};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{ColumnSpace, CsDecomposition, Matrix, Svd, Threshold};
use crate::model::{LoopJoint, Mechanism};
use crate::tolerance::{CLOSURE_RANK, CORRECTION_RANK};

/// The motions of a closed chain by what its actuators do with them.
#[derive(Debug, Clone)]
pub struct ActuationMap {
    /// M: what all joints do for each y, the n coordinates and then the actuated loop joints.
    pub motions: Matrix,
    /// Motions with the actuated joints at rest, a column each, of length one (scaled).
    pub left: Matrix,
    /// The steered motions one by one, of length one (scaled): how much of each belongs to the
    /// actuated joints, rising. 0 would be a motion that they do not steer.
    pub shares: Vec<f64>,
    /// The motions that the shares belong to, a column each.
    pub directions: Matrix,
    /// A change of all joints that closes the loops, to first order (rad or m).
    pub correction: Vec<f64>,
    /// How far the loops are open.
    pub closure_error: LoopClosureError,
    /// Places of the actuated joints among the rows of `motions`, and their weights' roots.
    actuators: Vec<(usize, f64)>,
}

impl ActuationMap {
    /// At the configuration of `state`. `weights`: one for each coordinate of the tree, of which
    /// those of actuated joints count, or none; the coordinates `locked` stand still.
    ///
    /// # Errors
    /// Weights of the wrong number or not positive; a locked place that is no coordinate; an actuated
    /// loop joint of several coordinates.
    pub fn of(state: &State, weights: &[f64], locked: &[usize]) -> Result<Self> {
        let mechanism = state.mechanism();
        let n = mechanism.n();
        if !weights.is_empty() {
            mechanism.check_q("joint weights", weights)?;
            weights.iter().try_for_each(|w| Error::check_positive("joint weight", *w))?;
        }
        if let Some(&place) = locked.iter().find(|&&i| i >= n) {
            return Err(Error::InvalidOption {
                option: "locked",
                value: place.to_string(),
                reason: format!("the mechanism has {n} coordinates"),
            });
        }
        let (all, joints_with_rate, closure_error) = constraint_rows(state)?;
        let rates = RateRows::of(state, all, &joints_with_rate, locked);
        let size = &rates.scale;

        let space =
            ColumnSpace::cut_of(rates.matrix.transpose(), Threshold::Relative(CLOSURE_RANK));
        let kernel = space.complement();
        let actuated = actuated(mechanism, &joints_with_rate, weights);
        let others = (0..size.len()).filter(|i| actuated.iter().all(|(d, _)| d != i));
        let order: Vec<usize> = actuated.iter().map(|(d, _)| *d).chain(others).collect();
        let sorted = Matrix::from_fn(size.len(), kernel.cols(), |i, j| kernel[(order[i], j)]);
        let cs = CsDecomposition::of(&sorted, actuated.len());
        let unscaled = (&kernel * &cs.z).scale_rows(size);
        let free = cs.cosines.iter().take_while(|c| **c <= kernel_tolerance(&space)).count();
        let p = kernel.cols() - free;

        // D = X' S' Z'^T for the actuated rates of unit directions in their weights.
        let unit =
            Matrix::from_fn(size.len(), p, |i, j| unscaled[(i, free + j)] / cs.cosines[free + j]);
        let weighted = Matrix::from_fn(actuated.len(), p, |i, j| {
            let (place, root) = actuated[i];
            root * unit[(place, j)]
        });
        let svd = Svd::of(&weighted);
        let turn = Matrix::from_fn(p, svd.len(), |i, j| svd.v(j)[i] / svd.value(j));
        Ok(Self {
            motions: &unit * &turn,
            left: unscaled.columns_between(0, free),
            shares: cs.cosines[free..].to_vec(),
            directions: unscaled.columns_between(free, kernel.cols()),
            correction: rates.correction(),
            closure_error,
            actuators: actuated,
        })
    }

    /// y for wanted rates of all joints (n + e): the weighted projection of those of the actuators on
    /// what the loops let them do.
    #[must_use]
    pub fn project(&self, wanted: &[f64]) -> Vec<f64> {
        let along = |j: usize| {
            let column = self.motions.column(j);
            self.actuators.iter().map(|&(i, root)| root * root * column[i] * wanted[i]).sum()
        };
        (0..self.motions.cols()).map(along).collect()
    }

    /// The rates of all joints for `y`, loops kept.
    #[must_use]
    pub fn rates(&self, y: &[f64]) -> Vec<f64> {
        self.motions.mul_vec(y)
    }
}

/// Places among coordinates and actuated loop joints, and the roots of the weights.
fn actuated(
    mechanism: &Mechanism,
    joints_with_rate: &[&LoopJoint],
    weights: &[f64],
) -> Vec<(usize, f64)> {
    let n = mechanism.n();
    let root = |i: usize| weights.get(i).map_or(1.0, |w: &f64| w.sqrt());
    let tree = mechanism.coordinates().iter().enumerate().filter(|(_, c)| c.actuated);
    let closing = joints_with_rate.iter().filter(|l| l.actuated).count();
    tree.map(|(i, _)| (i, root(i))).chain((n..n + closing).map(|i| (i, 1.0))).collect()
}

/// C in scaled units, with what is open.
struct RateRows {
    matrix: Matrix,
    residuals: Vec<f64>,
    /// Of each column: rate = scale * scaled rate.
    scale: Vec<f64>,
}

impl RateRows {
    fn of(
        state: &State,
        all: Vec<ConstraintRow>,
        joints_with_rate: &[&LoopJoint],
        locked: &[usize],
    ) -> Self {
        let mechanism = state.mechanism();
        let (n, length) = (mechanism.n(), mechanism.reach());
        let measured: Vec<usize> =
            (0..joints_with_rate.len()).filter(|&k| joints_with_rate[k].actuated).collect();
        let coordinates = mechanism.coordinates().iter().map(|c| Unit::of(c.kind));
        let units = coordinates.chain(measured.iter().map(|&k| rate_unit(joints_with_rate[k])));
        let scale: Vec<f64> = units.map(|unit| unit.size(length)).collect();
        // Rates of passive loop joints say nothing.
        let column = |k: usize| measured.iter().position(|&m| m == k).map(|e| n + e);
        let kept: Vec<ConstraintRow> =
            all.into_iter().filter(|row| row.rate_of.is_none_or(|k| column(k).is_some())).collect();
        let mut matrix = Matrix::zeros(kept.len() + locked.len(), scale.len());
        let mut add = |i: usize, j: usize, rate| {
            matrix[(i, j)] += rate * scale[j] / kept[i].unit.size(length)
        };
        for_each_rate(state, &kept, &mut add);
        for (i, row) in kept.iter().enumerate() {
            if let Some(j) = row.rate_of.and_then(column) {
                add(i, j, -1.0);
            }
        }
        for (i, &place) in locked.iter().enumerate() {
            matrix[(kept.len() + i, place)] = 1.0;
        }
        let residuals = kept.iter().map(|row| row.scaled_residual(length));
        let residuals = residuals.chain(locked.iter().map(|_| 0.0)).collect();
        Self { matrix, residuals, scale }
    }

    /// -C^+ residual, without directions in which loops can hardly be closed.
    fn correction(&self) -> Vec<f64> {
        if self.residuals.iter().all(|r| *r == 0.0) {
            return vec![0.0; self.scale.len()];
        }
        let svd = Svd::of(&self.matrix);
        let mut change = svd.solve(&self.residuals, svd.rank(CORRECTION_RANK).rank);
        change.iter_mut().zip(&self.scale).for_each(|(c, s)| *c *= -s);
        change
    }
}
