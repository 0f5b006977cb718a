//! Actuation map: from the actuated joints of a closed chain to the motion of all joints.
//!
//! Formula  C s = 0 for the velocities s of all joints: constraint rows of loops and contacts, and
//!          rate rows of actuated loop joints; ker C = [X c; Y s] Z^T (CS decomposition), actuated
//!          rows above passive ones. Directions with c = 0 are uncontrolled, the others controlled:
//!          s = M y + s_0, actuated velocities = D y with |D y|_W = |y|; s_0 = -C^+ residual closes
//!          the loops to first order
//! Shapes   C: t x (n + e), n coordinates of the tree, e actuated loop joints; M: (n + e) x p; D: a
//!          x p, orthonormal in the weighted velocities of the a actuated joints
//! Units    lengths are divided by the characteristic length for every rank decision; rates in
//!          rad/s and m/s outside
//! Valid    any mechanism; for a tree without passive joints M is W^(-1/2). Of all motions with the
//!          same actuated rates, M y is the one with the least (scaled) passive motion
//! Why so   every y satisfies the loop constraints, and the least |y| is the least weighted
//!          actuated motion, passive joints not counted
//! Source   Bicchi & Prattichizzo 1998, eqs. 2 to 4, in coordinates of the spanning tree
//! Checked  tests/it/closure/actuation_map.rs

use crate::closure::constraint::constraint_rows::{
    ConstraintRow, constraint_rows, for_each_rate, rate_unit,
};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::constraint::rate_rank::{rate_rank, rate_space};
use crate::closure::constraint::velocity_constraint::{Unit, kernel_tolerance};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{CsDecomposition, Matrix, Svd};
use crate::model::{LoopJoint, Mechanism};
use crate::tolerance::{CLOSURE_RANK, CORRECTION_RANK};

/// The map from actuated motions to the motions of all joints of a closed chain.
///
/// ```text
/// C s = 0,   s = M y + s_0,   actuated joint velocities D y with |D y|_W = |y|
/// ```
///
/// s are the velocities of the n coordinates and the e actuated loop joints [rad/s or m/s], C the
/// rows of loops and contacts, M (n + e) x p. Of all motions with the same actuated velocities, M y
/// has the least passive motion; s_0 ([`ActuationMap::correction`]) closes the loops to first
/// order.
///
/// Source: Bicchi & Prattichizzo 1998, eqs. 2 to 4, in coordinates of the spanning tree.
#[derive(Debug, Clone)]
pub struct ActuationMap {
    /// M: the velocities of all joints per unit of y: of the n coordinates, then of the actuated
    /// loop joints.
    pub motions: Matrix,
    /// Uncontrolled motions, with the actuated joints at rest: one column each, of unit norm
    /// (scaled).
    pub uncontrolled: Matrix,
    /// For each controlled motion of unit norm (scaled), the norm of its actuated part, in
    /// ascending order. 0 would be an uncontrolled motion.
    pub shares: Vec<f64>,
    /// The controlled motions to which `shares` belongs, one column each.
    pub directions: Matrix,
    /// A change of all joints that closes the loops to first order (rad or m).
    pub correction: Vec<f64>,
    /// The loop-closure error of the configuration.
    pub closure_error: LoopClosureError,
    /// Rows of `motions` that belong to actuated joints, with the square roots of their weights.
    actuators: Vec<(usize, f64)>,
}

impl ActuationMap {
    /// At the configuration of `state`. `weights`: one for each coordinate of the tree, of which
    /// those of actuated joints count, or none; the coordinates `locked` are fixed.
    ///
    /// ```
    /// use cylindroid::closure::ActuationMap;
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let map = ActuationMap::of(&five_bar.state(five_bar.home())?, &[], &[])?;
    /// // Two actuated joints move four coordinates of the tree.
    /// assert_eq!((map.motions.rows(), map.motions.cols()), (4, 2));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// The wrong number of weights, or weights that are not positive; a locked index that is no
    /// coordinate; an actuated loop joint of several coordinates.
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

        let space = rate_space(&rates.matrix, CLOSURE_RANK);
        let kernel = space.complement();
        let actuated = actuated(mechanism, &joints_with_rate, weights);
        let others = (0..size.len()).filter(|i| actuated.iter().all(|(d, _)| d != i));
        let order: Vec<usize> = actuated.iter().map(|(d, _)| *d).chain(others).collect();
        let sorted = Matrix::from_fn(size.len(), kernel.cols(), |i, j| kernel[(order[i], j)]);
        let cs = CsDecomposition::of(&sorted, actuated.len());
        let unscaled = (&kernel * &cs.z).scale_rows(size);
        let free = cs.cosines.iter().take_while(|c| **c <= kernel_tolerance(&space)).count();
        let p = kernel.cols() - free;

        // D = X' S' Z'^T: weighted actuated rates of unit directions.
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
            uncontrolled: unscaled.columns_between(0, free),
            shares: cs.cosines[free..].to_vec(),
            directions: unscaled.columns_between(free, kernel.cols()),
            correction: rates.correction(),
            closure_error,
            actuators: actuated,
        })
    }

    /// y for desired velocities of all joints (n + e): the weighted projection of the actuated ones
    /// onto the motions permitted by the loops.
    ///
    /// ```
    /// use cylindroid::closure::ActuationMap;
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let map = ActuationMap::of(&five_bar.state(five_bar.home())?, &[], &[])?;
    /// // A motion that satisfies the loop constraints is its own projection.
    /// let y = [0.3, -0.2];
    /// let again = map.project(&map.joint_velocities(&y));
    /// assert!(again.iter().zip(y).all(|(a, b)| (a - b).abs() < 1e-12));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `desired` has fewer entries than the motions have rows.
    #[must_use]
    pub fn project(&self, desired: &[f64]) -> Vec<f64> {
        let along = |j: usize| {
            let column = self.motions.column(j);
            self.actuators.iter().map(|&(i, root)| root * root * column[i] * desired[i]).sum()
        };
        (0..self.motions.cols()).map(along).collect()
    }

    /// D: the velocities of the actuated joints (tree, then loop joints) per unit of y, weighted.
    pub(crate) fn actuated_rows(&self) -> Matrix {
        Matrix::from_fn(self.actuators.len(), self.motions.cols(), |i, j| {
            let (place, root) = self.actuators[i];
            root * self.motions[(place, j)]
        })
    }

    /// The joint velocities `M y`: those of the n coordinates, then of the e actuated loop joints
    /// [rad/s or m/s]; they satisfy the loop constraints.
    #[must_use]
    pub fn joint_velocities(&self, y: &[f64]) -> Vec<f64> {
        self.motions.mul_vec(y)
    }
}

/// Indices among coordinates and actuated loop joints, and the square roots of the weights.
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

/// C in scaled units, with the residuals.
struct RateRows {
    matrix: Matrix,
    residuals: Vec<f64>,
    /// For each column: rate = scale * scaled rate.
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
        // Rates of passive loop joints add no constraint.
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

    /// -C^+ residual, truncated to directions in which the loops can be closed well.
    fn correction(&self) -> Vec<f64> {
        if self.residuals.iter().all(|r| *r == 0.0) {
            return vec![0.0; self.scale.len()];
        }
        let svd = Svd::of(&self.matrix);
        let mut change = svd.solve(&self.residuals, rate_rank(&svd, CORRECTION_RANK));
        change.iter_mut().zip(&self.scale).for_each(|(c, s)| *c *= -s);
        change
    }
}
