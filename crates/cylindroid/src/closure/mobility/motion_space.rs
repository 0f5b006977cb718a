//! Motion space: all motions that a constraint allows, the kernel of its matrix.
//!
//! Formula  K = ker M', M' = D_r [J_a J_p -G^T] D_c; its subspaces: combinations of columns of K
//!          that vanish in selected rows
//! Shapes   K: (q_a + q_p + d) x k, orthonormal; k is the number of degrees of freedom
//! Units    scaled by the characteristic length inside, those of the constraint outside
//! Valid    any constraint. The rank of M' is decided by a relative threshold, all subspaces by an
//!          absolute one: the columns of K are unit vectors, and relative to a block of rounding
//!          errors, rounding would have full rank
//! Why so   the mobility report needs six row groups, which form three complementary pairs: entries
//!          close to 1 in one group leave nothing for the other
//! Source   Bicchi & Prattichizzo 1998, eqs. 3 and 4, whose bases these are
//! Checked  tests/it/closure/reference.rs, tests/it/closure/mobility.rs

use super::relation::{ObjectScale, Relation};
use crate::closure::constraint::velocity_constraint::{Constraint, kernel_tolerance};
use crate::linalg::{ColumnSpace, Cut, Matrix, Rank, Threshold};
use crate::tolerance::{CLEAR_SHARE, CLOSURE_RANK};

/// Selected groups of rows of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RowSelection {
    /// The actuated joints.
    pub actuated: bool,
    /// The passive joints and the other objects.
    pub passive: bool,
    /// The reference object.
    pub object: bool,
}

/// The space of all motions of a constraint.
///
/// ```text
/// K = ker M',   M' = D_r [J_a J_p -G^T] D_c,   (q_a + q_p + d) x k, orthonormal
/// ```
///
/// D_r and D_c scale lengths by the characteristic length; k is the number of degrees of freedom.
/// The rank of M' is decided by a relative threshold.
///
/// Source: Bicchi & Prattichizzo 1998, eqs. 3 and 4.
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
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, MotionSpace, RowSelection};
    ///
    /// let four_bar = cylindroid::load("four-bar")?;
    /// let chain = ClosedChain::of(&four_bar.state(four_bar.home())?, None, None)?;
    /// let motions = MotionSpace::of(&chain.constraint);
    /// assert_eq!(motions.dof(), 1);
    /// // With the actuated joint at rest nothing moves.
    /// let rows = RowSelection { actuated: true, ..RowSelection::default() };
    /// assert_eq!(motions.vanishing_on(rows).cols(), 0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn of(constraint: &Constraint) -> Self {
        Self::with_threshold(constraint, CLOSURE_RANK)
    }

    /// With singular values at or below `threshold` times the largest one counted as zero.
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

    /// Number k of degrees of freedom, idle motions included.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.kernel.cols()
    }

    /// Rank of the scaled constraint matrix, with the singular values next to the cut.
    #[must_use]
    pub fn cut(&self) -> Cut {
        self.cut
    }

    /// Smallest singular value kept over the largest: the distance to a configuration where the
    /// constraint loses rank [-].
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

    /// The Gruebler-Kutzbach count: columns minus rows, negative for many mechanisms that move. The
    /// degrees of freedom exceed it by the degree of hyperstaticity.
    #[must_use]
    pub fn gruebler_kutzbach(&self) -> i64 {
        self.scale.len() as i64 - self.constraint_rows as i64
    }

    /// Degree of hyperstaticity, t - rank: number of independent contact forces that equilibrium
    /// does not determine.
    #[must_use]
    pub fn hyperstatic(&self) -> usize {
        self.constraint_rows - self.cut.rank.rank
    }

    /// A basis of all motions, one column `(q_a, q_p, u)` each: orthonormal in scaled units,
    /// returned in those of the constraint.
    #[must_use]
    pub fn basis(&self) -> Matrix {
        self.unscaled(&self.kernel)
    }

    /// The relation between actuated joints and object: the projection of the motions on both.
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

    /// Coefficients (k entries each) of the combinations of kernel columns that vanish on `rows`,
    /// and the rank of the kernel in these rows.
    pub(crate) fn vanishing_coefficients(&self, rows: RowSelection) -> (Matrix, Cut) {
        let space = self.space_of(rows);
        (space.complement(), space.cut())
    }

    /// The same for `rows` and for their complement. The columns of the kernel are unit vectors: if
    /// s is the largest singular value in `rows`, every motion has a norm of at least `sqrt(1 -
    /// s^2)` in the complement, so that none vanishes there unless s is close to 1.
    pub(crate) fn vanishing_on_rows_and_complement(
        &self,
        rows: RowSelection,
    ) -> [(Matrix, Cut); 2] {
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
            self.vanishing_coefficients(RowSelection {
                actuated: !actuated,
                passive: !passive,
                object: !object,
            })
        };
        [(space.complement(), space.cut()), others]
    }

    /// The column space of the selected rows of the kernel, in k dimensions.
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

    /// The motions that vanish on `rows`: a basis, one column `(q_a, q_p, u)` each.
    #[must_use]
    pub fn vanishing_on(&self, rows: RowSelection) -> Matrix {
        self.unscaled(&(&self.kernel * &self.vanishing_coefficients(rows).0))
    }

    /// The kernel in scaled coordinates.
    pub(crate) fn kernel(&self) -> &Matrix {
        &self.kernel
    }

    /// From scaled coordinates.
    pub(crate) fn unscaled(&self, motions: &Matrix) -> Matrix {
        motions.clone().scale_rows(&self.scale)
    }

    /// Number of actuated joints, and of all columns of the constraint.
    pub(crate) fn sizes(&self) -> [usize; 2] {
        [self.actuated, self.scale.len()]
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
