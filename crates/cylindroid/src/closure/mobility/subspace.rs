//! A basis of motions or forces with the rank decision behind its dimension.

use crate::linalg::{Cut, Matrix};

/// A space of motions or forces with the rank decision behind its dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct Subspace {
    /// A basis, one element per column.
    pub basis: Matrix,
    /// The rank decision that determines the dimension.
    pub cut: Cut,
}

impl Subspace {
    /// Number of independent elements.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.basis.cols()
    }
}
