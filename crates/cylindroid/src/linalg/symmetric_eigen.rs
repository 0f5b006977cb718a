//! Symmetric eigenproblem of small matrices by cyclic Jacobi rotations.
//!
//! Formula  A = V diag(values) V^T, values descending, V orthonormal
//! Shapes   A: n x n within an N x N array; rows and columns beyond n are ignored
//! Valid    any finite symmetric matrix, also an indefinite one; only the upper triangle is read
//! Why so   pitch forms are indefinite, so a singular value decomposition loses the signs; no
//!          allocation, and for n <= 6 faster than a general solver (ARCHITECTURE.md has the
//!          figures)
//! Source   Golub & Van Loan, Matrix Computations, 4th ed., section 8.5.3 (cyclic by row)
//! Checked  tests/it/symmetric_eigen.rs

/// More sweeps than any matrix needs: the bound that makes the cost finite.
const MAX_SWEEPS: usize = 30;

/// The eigendecomposition `A = V diag(values) V^T` of a symmetric matrix: the leading n x n block
/// of an array. For the Gram matrices of pitch forms, which are indefinite; `benches/peers`
/// compares it with faer.
///
/// Cyclic Jacobi rotations; only the upper triangle is read.
///
/// Source: Golub & Van Loan, Matrix Computations, 4th ed., section 8.5.3.
#[doc(alias = "eigenvalues")]
#[derive(Debug, Clone, Copy)]
pub struct SymmetricEigen<const N: usize> {
    /// Eigenvalues, largest first; entries beyond n are zero.
    pub values: [f64; N],
    /// Eigenvector `i` in `vectors[i]`.
    pub vectors: [[f64; N]; N],
}

impl<const N: usize> SymmetricEigen<N> {
    /// The eigendecomposition of the leading `n x n` block of `a`.
    ///
    /// ```
    /// use cylindroid::linalg::SymmetricEigen;
    ///
    /// let eigen = SymmetricEigen::of([[0.0, 2.0], [2.0, 0.0]], 2);
    /// assert!((eigen.values[0] - 2.0).abs() < 1e-15 && (eigen.values[1] + 2.0).abs() < 1e-15);
    /// ```
    #[must_use]
    #[allow(clippy::needless_range_loop)] // rows and columns of one matrix by index
    pub fn of(mut a: [[f64; N]; N], n: usize) -> Self {
        let n = n.min(N);
        let mut v = [[0.0; N]; N];
        for (i, row) in v.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        for _ in 0..MAX_SWEEPS {
            let mut rotated = false;
            for p in 0..n {
                for q in p + 1..n {
                    let apq = a[p][q];
                    let size = a[p][p].abs() + a[q][q].abs();
                    // Below this a rotation changes no digit of the eigenvalues.
                    if apq.abs() <= 0.25 * f64::EPSILON * size {
                        a[p][q] = 0.0;
                        continue;
                    }
                    rotated = true;
                    let theta = 0.5 * (a[q][q] - a[p][p]) / apq;
                    // A theta whose square overflows gives t = 0, which is right.
                    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                    let c = 1.0 / (t * t + 1.0).sqrt();
                    let s = t * c;
                    a[p][p] -= t * apq;
                    a[q][q] += t * apq;
                    a[p][q] = 0.0;
                    for i in 0..n {
                        if i != p && i != q {
                            let (x, y) = (entry(&a, i, p), entry(&a, i, q));
                            *entry_mut(&mut a, i, p) = c * x - s * y;
                            *entry_mut(&mut a, i, q) = s * x + c * y;
                        }
                        let (x, y) = (v[p][i], v[q][i]);
                        v[p][i] = c * x - s * y;
                        v[q][i] = s * x + c * y;
                    }
                }
            }
            if !rotated {
                break;
            }
        }
        let mut order: [usize; N] = std::array::from_fn(|i| i);
        order[..n].sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
        Self {
            values: std::array::from_fn(|i| if i < n { a[order[i]][order[i]] } else { 0.0 }),
            vectors: std::array::from_fn(|i| v[order[i]]),
        }
    }
}

fn entry<const N: usize>(a: &[[f64; N]; N], i: usize, j: usize) -> f64 {
    a[i.min(j)][i.max(j)]
}

fn entry_mut<const N: usize>(a: &mut [[f64; N]; N], i: usize, j: usize) -> &mut f64 {
    &mut a[i.min(j)][i.max(j)]
}
