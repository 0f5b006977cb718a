//! Small dense linear algebra: matrices, singular values, rank with its gap, null spaces, metrics.

mod matrix;
mod metric;
mod null_space;
mod svd;
mod symmetric;

pub use matrix::Matrix;
pub use metric::Metric;
pub use null_space::RowSpace;
pub use svd::{Rank, Svd};
pub use symmetric::Eigen;
