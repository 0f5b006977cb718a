//! The motions that a constraint allows: the kernel of its matrix.
//!
//! Formula  K = ker M', M' = D_r [J_a J_p -G^T] D_c; parts of it: the combinations of columns of K
//!          whose entries vanish in some rows
//! Shapes   K: (q_a + q_p + d) x k, orthonormal; k is the number of degrees of freedom
//! Units    scaled by the characteristic length inside, as given outside
//! Valid    any constraint. One relative threshold decides the rank of M'; every part is decided
//!          by an absolute one, since K has columns of length one: relative to a block that only
//!          rounding filled, rounding would have full rank.
//! Why so   of the six groups of rows that the mobility report asks for three are the others of the
//!          other three: what a motion has at most in one group it has not in the others
//! Source   Bicchi & Prattichizzo 1998, eqs. 3 and 4, whose bases these are
//! Checked  tests/it/closure/reference.rs (31 mechanisms), tests/it/closure/mobility.rs

use super::relation::{ObjectScale, Relation};
use crate::closure::constraint::velocity_constraint::{Constraint, kernel_tolerance};
use crate::linalg::{ColumnSpace, Cut, Matrix, Rank, Threshold};
use crate::tolerance::{CLEAR_SHARE, CLOSURE_RANK};

/// Groups of rows of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RowSelection {
    /// The actuated joints.
    pub actuated: bool,
    /// The passive joints and the other objects.
    pub passive: bool,
    /// The reference object.
    pub object: bool,
}

/// All motions of a constraint.
#[derive(Debug, Clone)]
pub struct MotionSpace {
    actuated: usize,
    passive: usize,
    object: usize,
    constraint_rows: usize,
    scale: Vec<f64>,
    kernel: Matrix,
    cut: Cut,
    largest: f64,
    threshold: f64,
    tolerance: f64,
}

impl MotionSpace {
    /// With the default threshold [`CLOSURE_RANK`].
    #[must_use]
    pub fn of(constraint: &Constraint) -> Self {
        Self::with_threshold(constraint, CLOSURE_RANK)
    }

    /// With singular values at or below `threshold` times the largest taken as zero.
    #[must_use]
    pub fn with_threshold(constraint: &Constraint, threshold: f64) -> Self {
        let space =
            ColumnSpace::cut_of(constraint.scaled_transpose(), Threshold::Relative(threshold));
        Self {
            actuated: constraint.actuated(),
            passive: constraint.passive(),
            object: constraint.object(),
            constraint_rows: constraint.rows(),
            scale: constraint.column_scale().to_vec(),
            kernel: space.complement(),
            cut: space.cut(),
            largest: space.largest(),
            threshold,
            tolerance: kernel_tolerance(&space),
        }
    }

    /// Number k of degrees of freedom, idle ones included.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.kernel.cols()
    }

    /// Rank of the constraint matrix and what it was cut between (scaled).
    #[must_use]
    pub fn cut(&self) -> Cut {
        self.cut
    }

    /// Smallest singular value kept over the largest: the distance to a pose where the constraint
    /// loses rank [-].
    #[must_use]
    pub fn regularity(&self) -> f64 {
        if self.cut.rank.rank == 0 { 0.0 } else { self.cut.kept / self.largest }
    }

    /// The relative threshold of the constraint matrix [-].
    pub(crate) fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The absolute threshold for blocks of motions [-].
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Grubler's count: columns less rows, negative for many mechanisms that move. The degrees of
    /// freedom exceed it by the hyperstatic degree.
    #[must_use]
    pub fn gruebler_kutzbach(&self) -> i64 {
        self.scale.len() as i64 - self.constraint_rows as i64
    }

    /// Number t - rank of forces at the contacts that nothing determines.
    #[must_use]
    pub fn hyperstatic(&self) -> usize {
        self.constraint_rows - self.cut.rank.rank
    }

    /// A basis of all motions, a column `(q_a, q_p, u)` each: orthonormal in scaled units, given
    /// in those of the constraint.
    #[must_use]
    pub fn basis(&self) -> Matrix {
        self.unscaled(&self.kernel)
    }

    /// Relation between actuated joints and object: what is left when passive joints are forgotten.
    #[must_use]
    pub fn relation(&self) -> Relation {
        let a = self.actuated;
        let mut span = Matrix::zeros(a + self.object, self.kernel.cols());
        for j in 0..span.cols() {
            let (from, to) = (self.kernel.column(j), span.column_mut(j));
            to[..a].copy_from_slice(&from[..a]);
            to[a..].copy_from_slice(&from[a + self.passive..]);
        }
        Relation::from_scaled(
            span,
            self.scale[..a].to_vec(),
            ObjectScale::diagonal(&self.scale[a + self.passive..]),
            self.tolerance,
        )
    }

    /// The combinations of kernel columns (k entries each) whose entries in `rows` vanish, and the
    /// rank of the kernel in these rows.
    pub(crate) fn still(&self, rows: RowSelection) -> (Matrix, Cut) {
        let space = self.space_of(rows);
        (space.complement(), space.cut())
    }

    /// The same for `rows` and for all others. The columns of the kernel have length one, so that
    /// what a motion has in `rows` at most leaves it `sqrt(1 - s^2)` at least in the others: where
    /// that is far from nothing, none of them is still in the others.
    pub(crate) fn still_and_others(&self, rows: RowSelection) -> [(Matrix, Cut); 2] {
        let space = self.space_of(rows);
        let k = self.dof();
        let s = space.largest().min(1.0);
        let least = ((1.0 - s) * (1.0 + s)).sqrt();
        let others = if k > 0 && least > CLEAR_SHARE.max(self.tolerance) {
            let threshold = self.tolerance;
            let rank = Rank { rank: k, threshold, gap: f64::INFINITY };
            (Matrix::zeros(k, 0), Cut { rank, kept: least, dropped: 0.0 })
        } else {
            let RowSelection { actuated, passive, object } = rows;
            self.still(RowSelection { actuated: !actuated, passive: !passive, object: !object })
        };
        [(space.complement(), space.cut()), others]
    }

    /// What the chosen rows of the kernel span, in k dimensions.
    fn space_of(&self, rows: RowSelection) -> ColumnSpace {
        let (a, n) = (self.actuated, self.kernel.rows());
        let ranges = [
            (rows.actuated, 0..a),
            (rows.passive, a..a + self.passive),
            (rows.object, a + self.passive..n),
        ];
        let chosen = || ranges.iter().filter(|r| r.0).flat_map(|r| r.1.clone());
        let mut block = Matrix::zeros(self.kernel.cols(), chosen().count());
        for (j, i) in chosen().enumerate() {
            for (l, x) in block.column_mut(j).iter_mut().enumerate() {
                *x = self.kernel[(i, l)];
            }
        }
        ColumnSpace::cut_of(block, Threshold::Absolute(self.tolerance))
    }

    /// The motions in which `rows` stand still: a basis, a column `(q_a, q_p, u)` each.
    #[must_use]
    pub fn standing(&self, rows: RowSelection) -> Matrix {
        self.unscaled(&(&self.kernel * &self.still(rows).0))
    }

    /// The kernel in scaled coordinates.
    pub(crate) fn kernel(&self) -> &Matrix {
        &self.kernel
    }

    /// From scaled coordinates.
    pub(crate) fn unscaled(&self, motions: &Matrix) -> Matrix {
        motions.clone().scale_rows(&self.scale)
    }

    /// Number of actuated joints.
    #[must_use]
    pub fn actuated(&self) -> usize {
        self.actuated
    }

    /// Number of passive columns.
    #[must_use]
    pub fn passive(&self) -> usize {
        self.passive
    }

    /// Size of the object's twist.
    #[must_use]
    pub fn object(&self) -> usize {
        self.object
    }
}
