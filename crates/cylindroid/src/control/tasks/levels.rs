//! Memory of a stack of tasks: the rows of each task, and the levels that they form.
//!
//! Shapes   of a task: rows x n; of a level: the sum of the rows of its tasks x n
//! Checked  tests/it/servo/tasks.rs

use super::options::StoppedBy;
use crate::control::solver::hierarchy::ScaledLevel;
use crate::linalg::Matrix;

/// A level of the stack.
#[derive(Debug, Clone)]
pub(super) struct Stack {
    /// Indices of tasks, and their first rows.
    pub(super) members: Vec<(usize, usize)>,
    pub(super) level: ScaledLevel,
    pub(super) direction_changed: bool,
    pub(super) scale: f64,
    pub(super) left_out: f64,
    pub(super) stopped_by: Option<StoppedBy>,
}

/// Rows of one task.
#[derive(Debug, Clone)]
pub(super) struct TaskRows {
    pub(super) error: Vec<f64>,
    pub(super) feed_forward: Vec<f64>,
    pub(super) jacobian: Matrix,
    /// True for rows that are lengths.
    pub(super) is_length: Vec<bool>,
}
