//! Small dense linear algebra: matrices, singular values, rank with its gap, the spaces of columns
//! and of kernels, angles between spaces, metrics.

mod column_space;
mod cs;
mod matrix;
mod metric;
mod null_space;
mod qr;
mod svd;
mod symmetric;

pub use column_space::{ColumnSpace, Cut, Threshold};
pub use cs::{CosineSine, PairKind};
pub use matrix::Matrix;
pub use metric::Metric;
pub use null_space::RowSpace;
pub use qr::Qr;
pub use svd::{Rank, Svd};
pub use symmetric::Eigen;
