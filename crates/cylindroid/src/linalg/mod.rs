//! Small dense linear algebra: matrices, singular values, rank with its gap, the spaces of columns
//! and of kernels, angles between spaces, metrics, hulls of convex bodies.

mod basis;
pub(crate) mod batched;
mod blocks;
mod bounded_linear_program;
mod column_space;
mod cs_decomposition;
mod damped_least_squares;
mod elimination;
mod hull;
mod jacobi;
mod matrix;
mod metric;
mod parallel;
mod qr;
mod row_space;
mod singular_values;
mod small_gemm;
mod svd;
mod symmetric_eigen;
#[cfg(test)]
mod test_support;
mod vector;

pub(crate) use basis::{Basis, LowerTriangle};
pub use bounded_linear_program::Interval;
pub(crate) use bounded_linear_program::{BoundedLinearProgram, Objective};
pub use column_space::{ColumnSpace, Cut, Threshold};
pub(crate) use cs_decomposition::{CsDecomposition, PairKind};
pub(crate) use damped_least_squares::{Damped, DampedProblem, damped_by_rows};
pub(crate) use elimination::{Elimination, RankGap};
pub use hull::{Facet, Hull};
pub(crate) use hull::{HullGoal, HullOptions};
pub use matrix::Matrix;
pub use metric::Metric;
pub(crate) use parallel::run_all;
pub use qr::Qr;
pub(crate) use qr::solve_upper;
pub use row_space::RowSpace;
pub(crate) use svd::rank_threshold;
pub use svd::{Rank, Svd};
pub use symmetric_eigen::SymmetricEigen;
pub(crate) use vector::{dot, max_abs, norm};
