//! Order of the spanning tree.
//!
//! Checked  tests/it/model.rs

/// The root link and the joints, depth-first.
pub(super) struct TreeOrder {
    pub(super) root: usize,
    pub(super) joints: Vec<usize>,
}
