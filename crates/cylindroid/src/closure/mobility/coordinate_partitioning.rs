//! Coordinate partitioning: the passive joints of a closed chain as functions of the actuated ones.
//!
//! Formula  C_p s_p + C_a s_a = -r (rows of loops and contacts, r their residuals). C_p P = Q [R; 0]
//!          by Householder reflections, Q^T [C_a r] = [B r_1; S r_2]: S s_a = -r_2 restricts the
//!          actuated joints, s_p = -R^+ (B s_a + r_1) follows. Motions, r = 0: W^(1/2) s_a = D y, D
//!          an orthonormal basis of ker S W^(-1/2). Correction, for these r: the least
//!          |W^(1/2) s_a|, then the least |s_p|
//! Shapes   C_p: t x p, C_a: t x a, D: a x d
//! Units    rows and columns of lengths divided by the characteristic length; rates outside in
//!          rad/s and m/s
//! Valid    where all ranks are clear and the actuated joints take a large share of every motion;
//!          says so elsewhere, where `actuation_map.rs` holds. No allocation
//! Why so   the actuation map of regular configurations, at a tenth of the time
//! Source   Wehage & Haug 1982; least norms: Golub & Van Loan, Matrix Computations, 4th ed., 5.5.6
//! Checked  tests in this file

use crate::closure::constraint::constraint_rows::{
    ConstraintRow, ConstraintRows, for_each_rate, joints_with_rate, rate_unit,
};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::constraint::velocity_constraint::Unit;
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::{Elimination, Matrix, RankGap, dot, norm};
use crate::model::Mechanism;
use crate::tolerance::MIN_ACTUATED_SHARE;

/// Remainders of columns that are roundings of zero, and those that are regular, for columns of
/// length one [-].
const GAP: RankGap = RankGap { zero: 1e-11, regular: 1e-6 };

/// The loop constraints at a configuration, solved for the passive joints.
#[derive(Debug, Clone)]
pub(crate) struct CoordinatePartitioning {
    state: State,
    constraints: ConstraintRows,
    rows: Vec<ConstraintRow>,
    /// The column of each of the n coordinates and e actuated loop joints; `None` if locked.
    columns: Vec<Option<usize>>,
    /// Number of passive columns; they come first.
    passive: usize,
    /// For each column: its place among the coordinates and loop joints, and rate = scale * scaled
    /// rate.
    places: Vec<(usize, f64)>,
    /// The column of each loop joint of one coordinate; `None` if it is passive.
    loop_columns: Vec<Option<usize>>,
    /// [C_p C_a r], then [R B r_1; 0 S r_2]: t x (p + a + 1).
    system: Matrix,
    left: Elimination,
    /// R^T where the passive joints have motions of their own: p x r.
    transposed: Matrix,
    right: Elimination,
    /// -R^+ B: p x a.
    dependence: Matrix,
    /// (S W^(-1/2))^T: a x (t - r).
    restriction: Matrix,
    across: Elimination,
    /// W^(1/2), in scaled rates.
    roots: Vec<f64>,
    passive_rates: Vec<f64>,
    actuated_rates: Vec<f64>,
    right_side: Vec<f64>,
    /// Passive rates in the order of the elimination.
    ordered: Vec<f64>,
    /// Lower bound of the actuated share of a motion at the configuration solved last.
    least_share: f64,
}

impl CoordinatePartitioning {
    /// For the loops and contacts of a mechanism; the coordinates `locked` are fixed.
    pub(crate) fn new(mechanism: &Mechanism, locked: &[usize]) -> Result<Self> {
        let (n, length) = (mechanism.n(), mechanism.reach());
        let constraints = ConstraintRows::of(mechanism)?;
        let own = mechanism.coordinates().iter().enumerate();
        let own = own.map(|(i, c)| {
            (!locked.contains(&i)).then(|| (c.actuated, Unit::of(c.kind).size(length)))
        });
        let loops = joints_with_rate(mechanism);
        let actuated = loops.iter().filter(|l| l.actuated);
        let velocities: Vec<Option<(bool, f64)>> =
            own.chain(actuated.map(|l| Some((true, rate_unit(l).size(length))))).collect();
        let mut columns = vec![None; velocities.len()];
        let mut places = Vec::new();
        for is_actuated in [false, true] {
            for (i, v) in velocities.iter().enumerate() {
                if let Some((actuated, scale)) = *v
                    && actuated == is_actuated
                {
                    columns[i] = Some(places.len());
                    places.push((i, scale));
                }
            }
        }
        let p = velocities.iter().flatten().filter(|v| !v.0).count();
        let a = places.len() - p;
        let mut next = n;
        let loop_columns = loops
            .iter()
            .map(|l| {
                next += usize::from(l.actuated);
                if l.actuated { columns[next - 1] } else { None }
            })
            .collect();
        let t = constraints.most_rows();
        Ok(Self {
            state: mechanism.state(mechanism.home())?,
            constraints,
            rows: Vec::with_capacity(t),
            columns,
            passive: p,
            places,
            loop_columns,
            system: Matrix::zeros(t, p + a + 1),
            left: Elimination::workspace(p),
            transposed: Matrix::zeros(p, t.min(p)),
            right: Elimination::workspace(t.min(p)),
            dependence: Matrix::zeros(p, a),
            restriction: Matrix::zeros(a, t),
            across: Elimination::workspace(t),
            roots: vec![1.0; a],
            passive_rates: vec![0.0; p],
            actuated_rates: vec![0.0; a],
            right_side: vec![0.0; t.max(p)],
            ordered: vec![0.0; p],
            least_share: 0.0,
        })
    }

    /// Number of coordinates and actuated loop joints.
    pub(crate) fn velocities(&self) -> usize {
        self.columns.len()
    }

    /// Lower bound of the actuated share of all motions at the configuration solved last [-].
    pub(crate) fn least_share(&self) -> f64 {
        self.least_share
    }

    /// Number of actuated joints that are not locked.
    pub(crate) fn actuated(&self) -> usize {
        self.places.len() - self.passive
    }

    /// The mechanism at the configuration loaded last.
    pub(crate) fn state(&self) -> &State {
        &self.state
    }

    /// Computes the constraint rows at `q`.
    ///
    /// # Errors
    /// A `q` of the wrong size or with a non-finite entry.
    pub(crate) fn load(&mut self, q: &[f64]) -> Result<LoopClosureError> {
        self.state.set(q)?;
        let closure_error = self.constraints.load(&self.state, &mut self.rows);
        let length = self.state.mechanism().reach();
        let Self { system, columns, places, loop_columns, .. } = self;
        // Rates of passive loop joints add no constraint.
        self.rows.retain(|row| row.rate_of.is_none_or(|k| loop_columns[k].is_some()));
        system.as_mut_slice().fill(0.0);
        for_each_rate(&self.state, &self.rows, |i, coordinate, rate| {
            if let Some(j) = columns[coordinate] {
                system[(i, j)] += rate * places[j].1 / self.rows[i].unit.size(length);
            }
        });
        let last = system.cols() - 1;
        for (i, row) in self.rows.iter().enumerate() {
            if let Some(j) = row.rate_of.and_then(|k| loop_columns[k]) {
                system[(i, j)] -= places[j].1 / row.unit.size(length);
            }
            system[(i, last)] = row.scaled_residual(length);
        }
        Ok(closure_error)
    }

    /// Solves the loaded rows for the passive joints, `weights` for the actuated ones of the n + e
    /// (or none); false where a rank is not clear, or where the actuated joints may take a small
    /// share of a motion.
    pub(crate) fn solve(&mut self, weights: &[f64]) -> bool {
        let (p, a) = (self.passive, self.actuated());
        let size = (0..p + a).map(|j| norm(self.system.column(j))).fold(0.0, f64::max);
        if !size.is_finite() || !self.left.eliminate(&mut self.system, p, GAP.times(size)) {
            return false;
        }
        let rank = self.left.rank();
        if rank < p {
            for i in 0..rank {
                let column = self.transposed.column_mut(i);
                column[..i].fill(0.0);
                for (j, x) in column.iter_mut().enumerate().skip(i) {
                    *x = self.system[(i, j)];
                }
            }
            if !self.right.eliminate(&mut self.transposed, rank, GAP.times(size)) {
                return false;
            }
        }
        let mut square = 0.0;
        for k in 0..a {
            self.right_side[..rank].copy_from_slice(&self.system.column(p + k)[..rank]);
            self.follow();
            for (x, rate) in self.dependence.column_mut(k).iter_mut().zip(&self.passive_rates) {
                *x = -rate;
            }
            square += dot(&self.passive_rates, &self.passive_rates);
        }
        // The actuated share of a motion is at least 1 / sqrt(1 + |T|^2).
        self.least_share = (1.0 + square).sqrt().recip();
        if !((1.0 + square) * MIN_ACTUATED_SHARE * MIN_ACTUATED_SHARE < 1.0) {
            return false;
        }
        for (root, &(place, scale)) in self.roots.iter_mut().zip(&self.places[p..]) {
            *root = scale * weights.get(place).map_or(1.0, |w| w.sqrt());
        }
        self.restrict(rank, size)
    }

    /// The rows that restrict the actuated joints; false where their rank is not clear.
    fn restrict(&mut self, rank: usize, size: f64) -> bool {
        let (p, a, t) = (self.passive, self.actuated(), self.system.rows());
        let mut most = 0.0_f64;
        for i in rank..t {
            let column = self.restriction.column_mut(i - rank);
            for (k, x) in column.iter_mut().enumerate() {
                *x = self.system[(i, p + k)];
                most = most.max(x.abs());
            }
        }
        if most <= GAP.zero * size {
            self.restriction.as_mut_slice().fill(0.0);
        }
        for j in 0..t - rank {
            let column = self.restriction.column_mut(j);
            column.iter_mut().zip(&self.roots).for_each(|(x, root)| *x /= root);
        }
        let size = (0..t - rank).map(|j| norm(self.restriction.column(j))).fold(0.0, f64::max);
        self.across.eliminate(&mut self.restriction, t - rank, GAP.times(size))
            && self.across.rank() <= a
    }

    /// The least s_p with `R P^T s_p = right_side`, into the passive rates.
    fn follow(&mut self) {
        let (p, rank) = (self.passive, self.left.rank());
        let ordered = &mut self.ordered[..p];
        if rank < p {
            self.right.least_solution(&self.transposed, &self.right_side[..rank], ordered);
        } else {
            ordered.copy_from_slice(&self.right_side[..p]);
            self.left.solve(&self.system, ordered);
        }
        self.restore_order();
    }

    /// Passive rates in the order of their columns.
    fn restore_order(&mut self) {
        for (x, &i) in self.ordered.iter().zip(self.left.order()) {
            self.passive_rates[i] = *x;
        }
    }

    /// d: number of independent actuated motions.
    pub(crate) fn motions(&self) -> usize {
        self.actuated() - self.across.rank()
    }

    /// Motion `j` of the d: the rates of the n coordinates and e loop joints for y = e_j.
    pub(crate) fn motion_into(&mut self, j: usize, rates: &mut [f64]) {
        self.actuated_rates.fill(0.0);
        self.actuated_rates[self.across.rank() + j] = 1.0;
        self.across.apply(&self.restriction, &mut self.actuated_rates);
        self.actuated_rates.iter_mut().zip(&self.roots).for_each(|(x, root)| *x /= root);
        self.dependence.mul_vec_into(&self.actuated_rates, &mut self.passive_rates);
        self.store(rates);
    }

    /// Number of motions of the passive joints alone.
    pub(crate) fn passive_motions(&self) -> usize {
        self.passive - self.left.rank()
    }

    /// Motion `j` of them, of unit norm (scaled).
    pub(crate) fn passive_motion_into(&mut self, j: usize, rates: &mut [f64]) {
        self.ordered.fill(0.0);
        self.ordered[self.left.rank() + j] = 1.0;
        self.right.apply(&self.transposed, &mut self.ordered);
        self.restore_order();
        self.actuated_rates.fill(0.0);
        self.store(rates);
    }

    /// The change of the n coordinates and e loop joints that closes the loops to first order, in two
    /// parts: that of the passive joints alone, `passive_step`, and that of the actuated ones with
    /// the passive ones that follow them, `actuated_step`; zero without more actuated joints than degrees
    /// of freedom.
    pub(crate) fn correction_into(&mut self, passive_step: &mut [f64], actuated_step: &mut [f64]) {
        let (rank, last) = (self.left.rank(), self.system.cols() - 1);
        let residuals = self.system.column(last);
        self.right_side[..rank].copy_from_slice(&residuals[..rank]);
        self.across.least_solution(&self.restriction, &residuals[rank..], &mut self.actuated_rates);
        self.actuated_rates.iter_mut().zip(&self.roots).for_each(|(x, root)| *x /= -root);
        self.dependence.mul_vec_into(&self.actuated_rates, &mut self.passive_rates);
        self.store(actuated_step);
        self.follow();
        self.passive_rates.iter_mut().for_each(|x| *x = -*x);
        self.actuated_rates.fill(0.0);
        self.store(passive_step);
    }

    /// Rates of all joints from the scaled ones.
    fn store(&self, rates: &mut [f64]) {
        rates.fill(0.0);
        let scaled = self.passive_rates.iter().chain(&self.actuated_rates);
        for (s, &(place, scale)) in scaled.zip(&self.places) {
            rates[place] = s * scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::ActuationMap;
    use crate::closure::assemble;
    use crate::linalg::Svd;
    use crate::model::catalogue;
    use crate::scalar::uniform;

    /// Columns of both span the same space: each is its projection on the other.
    fn same_span(a: &Matrix, b: &Matrix, tolerance: f64, of: &str) {
        assert_eq!(a.cols(), b.cols(), "{of}");
        let both = Svd::of(&Matrix::hstack(a.rows(), &[a, b]));
        let own = Svd::of(a);
        for j in 0..a.cols() {
            assert!(own.value(j) > 1e-3 * own.value(0), "{of}");
        }
        for j in a.cols()..both.len() {
            assert!(both.value(j) < tolerance * both.value(0), "{of}: {}", both.value(j));
        }
    }

    /// The motions are those of the actuation map, unit y has actuated rates of weighted length
    /// one, and the correction closes the loops to second order.
    #[test]
    fn it_is_the_actuation_map_of_regular_configurations() {
        let mut state = 7_u64;
        let mut next = move || 2.0 * uniform(&mut state) - 1.0;
        let mut solved = 0;
        for name in catalogue::names() {
            let mechanism = catalogue::load(name).unwrap();
            if !mechanism.is_closed() {
                continue;
            }
            let n = mechanism.n();
            let mut partitioning = CoordinatePartitioning::new(&mechanism, &[]).unwrap();
            let m = partitioning.velocities();
            for round in 0..20 {
                let guess: Vec<f64> = mechanism.home().iter().map(|x| x + 0.2 * next()).collect();
                let Ok(found) = assemble(&mechanism, &guess, &[]) else { continue };
                let weights: Vec<f64> = match round % 2 {
                    0 => Vec::new(),
                    _ => (0..n).map(|_| 1.0 + 0.8 * next()).collect(),
                };
                let at = mechanism.state(&found.q).unwrap();
                let map = ActuationMap::of(&at, &weights, &[]).unwrap();
                partitioning.load(&found.q).unwrap();
                if !partitioning.solve(&weights) {
                    continue;
                }
                solved += 1;
                let d = partitioning.motions();
                let mut motions = Matrix::zeros(m, d);
                for j in 0..d {
                    partitioning.motion_into(j, motions.column_mut(j));
                    // W^(1/2) times the actuated rates has length one.
                    let y = map.project(motions.column(j));
                    assert!((norm(&y) - 1.0).abs() < 1e-9, "{name}: {}", norm(&y));
                }
                let k = partitioning.passive_motions();
                let mut idle = Matrix::zeros(m, k);
                for j in 0..k {
                    partitioning.passive_motion_into(j, idle.column_mut(j));
                }
                same_span(&motions, &map.motions, 1e-8, name);
                if k > 0 {
                    same_span(&idle, &map.uncontrolled, 1e-8, name);
                } else {
                    assert_eq!(map.uncontrolled.cols(), 0, "{name}");
                }
                assert!(map.shares.iter().all(|s| *s >= MIN_ACTUATED_SHARE), "{name}");

                let open: Vec<f64> = found.q.iter().map(|x| x + 1e-5 * next()).collect();
                let gap =
                    |error: LoopClosureError| error.distance / mechanism.reach() + error.angle;
                let before = gap(partitioning.load(&open).unwrap());
                assert!(partitioning.solve(&weights), "{name}");
                let (mut change, mut actuated_step) = (vec![0.0; m], vec![0.0; m]);
                partitioning.correction_into(&mut change, &mut actuated_step);
                change.iter_mut().zip(&actuated_step).for_each(|(c, d)| *c += d);
                let closer = mechanism.integrate(&open, &change[..n], 1.0).unwrap();
                let after = gap(partitioning.load(&closer).unwrap());
                assert!(after < 1e-3 * before + 1e-13, "{name}: {before:e} to {after:e}");
            }
        }
        assert_eq!(solved, 7 * 20);
    }
}
