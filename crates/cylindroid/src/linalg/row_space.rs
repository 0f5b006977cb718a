//! Row space and null space of a matrix, from its singular value decomposition.
//!
//! Formula  P = V_r V_r^T projects on the row space, 1 - P on the null space ker A
//! Shapes   A: m x n, V_r: n x r, vectors of n entries
//! Why so   a projection needs only the r kept right vectors, which every decomposition has;
//!          subtracting twice ("twice is enough", Kahan) makes A (1 - P) x zero to rounding
//! Checked  tests/it/svd.rs::null_space_*

use super::blocks::reorthogonalise;
use super::matrix::Matrix;
use super::svd::Svd;
use super::vector::{dot, norm};

/// The row space of a matrix: the span of right singular vectors. Its complement is the null space:
/// for a Jacobian the joint velocities that leave the end effector at rest, onto which secondary
/// tasks are projected.
///
/// ```text
/// A = U S V^T (m x n):   row space V_r V_r^T,   null space projector 1 - V_r V_r^T
/// ```
#[doc(alias = "null space")]
#[derive(Debug, Clone, Copy)]
pub struct RowSpace<'a> {
    svd: &'a Svd,
    kept: Kept<'a>,
}

/// Which of them.
#[derive(Debug, Clone, Copy)]
enum Kept<'a> {
    First(usize),
    Flags(&'a [bool]),
}

impl<'a> RowSpace<'a> {
    /// The row space at machine precision: its complement is exactly ker A.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::{RowSpace, Svd};
    ///
    /// let svd = Svd::of(&Matrix::from_rows(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap());
    /// let mut x = [1.0, 2.0, 3.0];
    /// RowSpace::exact(&svd).project_out(&mut x); // onto the null space
    /// assert!(x[0].abs() < 1e-15 && x[1].abs() < 1e-15 && (x[2] - 3.0).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn exact(svd: &'a Svd) -> Self {
        Self { svd, kept: Kept::First(svd.machine_rank().rank) }
    }

    /// The span of the right singular vectors of the `rank` largest singular values.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::{RowSpace, Svd};
    ///
    /// // At rank 1, the direction of the small singular value belongs to the null space.
    /// let svd = Svd::of(&Matrix::from_rows(&[[1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]]).unwrap());
    /// let rows = RowSpace::first(&svd, svd.rank(1e-6).rank);
    /// assert_eq!((rows.rank(), rows.null_space_basis().cols()), (1, 2));
    /// ```
    #[must_use]
    pub fn first(svd: &'a Svd, rank: usize) -> Self {
        Self { svd, kept: Kept::First(rank.min(svd.len())) }
    }

    /// The span of the directions that an inverse retained: a flag for each; directions without a
    /// flag are not retained. They need not be the first ones.
    #[must_use]
    pub fn from_kept(svd: &'a Svd, kept: &'a [bool]) -> Self {
        Self { svd, kept: Kept::Flags(&kept[..kept.len().min(svd.len())]) }
    }

    fn keeps(&self, i: usize) -> bool {
        match self.kept {
            Kept::First(rank) => i < rank,
            Kept::Flags(flags) => flags.get(i).is_some_and(|kept| *kept),
        }
    }

    /// Dimension of the row space.
    #[must_use]
    pub fn rank(&self) -> usize {
        match self.kept {
            Kept::First(rank) => rank,
            Kept::Flags(flags) => flags.iter().filter(|kept| **kept).count(),
        }
    }

    /// `x <- (1 - V_r V_r^T) x`, without allocation.
    pub fn project_out(&self, x: &mut [f64]) {
        let factor = |i| if self.keeps(i) { 1.0 } else { 0.0 };
        reorthogonalise(self.svd.right(), factor, x);
    }

    /// An orthonormal basis of the null space, one column each (n x (n - r)).
    #[doc(alias = "kernel")]
    #[must_use]
    pub fn null_space_basis(&self) -> Matrix {
        let n = self.svd.cols();
        let missing = n - self.rank();
        let mut basis = Matrix::zeros(n, missing);
        // For a tall matrix V is complete: the dropped columns are the basis. Otherwise complete
        // the kept columns from unit vectors.
        let mut found = 0;
        if self.svd.rows() > n {
            for i in (0..n).filter(|&i| !self.keeps(i)) {
                basis.column_mut(found).copy_from_slice(self.svd.v(i));
                found += 1;
            }
            return basis;
        }
        while found < missing {
            let mut best = (0.0, vec![0.0; n]);
            for unit in 0..n {
                let mut x = vec![0.0; n];
                x[unit] = 1.0;
                for _ in 0..2 {
                    self.project_out(&mut x);
                    for l in 0..found {
                        let b = basis.column(l);
                        let along = dot(b, &x);
                        x.iter_mut().zip(b).for_each(|(xj, bj)| *xj -= along * bj);
                    }
                }
                let size = norm(&x);
                if size > best.0 {
                    x.iter_mut().for_each(|a| *a /= size);
                    best = (size, x);
                }
            }
            basis.column_mut(found).copy_from_slice(&best.1);
            found += 1;
        }
        basis
    }
}
