//! Small dense linear algebra: matrices, singular values, rank with its gap, the spaces of columns
//! and of kernels, angles between spaces, metrics, hulls of convex bodies.

pub(crate) mod batched;
mod blocks;
mod box_program;
mod column_space;
mod cs;
mod hull;
mod jacobi;
mod matrix;
mod metric;
mod null_space;
mod qr;
mod singular_values;
mod small_gemm;
mod svd;
mod symmetric;
mod vector;

pub use box_program::{BoxProgram, Interval, Pull};
pub use column_space::{ColumnSpace, Cut, Threshold};
pub use cs::{CosineSine, PairKind};
pub use hull::{Facet, Hull, HullGoal, HullOptions};
pub use matrix::Matrix;
pub use metric::Metric;
pub use null_space::RowSpace;
pub use qr::Qr;
pub(crate) use qr::solve_upper;
pub use svd::{Rank, Svd};
pub use symmetric::Eigen;
pub(crate) use vector::{dot, norm};
