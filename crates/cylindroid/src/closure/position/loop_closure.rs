//! The loop-closure equations at a configuration: residuals and their Jacobian, scaled.
//!
//! Formula  r(q) = 0, a residual for each constraint row (`constraint_rows.rs`); J = dr/dq
//! Shapes   r: t rows, J: t x free coordinates
//! Units    none: rows and columns of lengths are divided by the characteristic length
//! Valid    any configuration
//! Checked  tests/it/closure/assembly.rs, tests/it/closure/continuation.rs

use super::coordinates::column_scale;
use crate::closure::constraint::constraint_rows::{ConstraintRow, constraint_rows, for_each_rate};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::constraint::velocity_constraint::check_entries;
use crate::error::Result;
use crate::linalg::{Matrix, norm};
use crate::model::Mechanism;

/// A configuration with the residuals of its loops and contacts and their Jacobian, scaled.
#[derive(Debug)]
pub(crate) struct LoopClosure {
    pub(crate) q: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: Matrix,
    /// Euclidean norm of the residuals.
    pub(crate) residual_norm: f64,
    pub(crate) closure_error: LoopClosureError,
}

impl LoopClosure {
    /// At `q`, with a column of the Jacobian for each of the coordinates `free`.
    pub(crate) fn at(
        mechanism: &Mechanism,
        q: &[f64],
        free: &[usize],
        length: f64,
    ) -> Result<Self> {
        let state = mechanism.state(q)?;
        let (all, _, closure_error) = constraint_rows(&state)?;
        let rows: Vec<ConstraintRow> =
            all.into_iter().filter(|row| row.rate_of.is_none()).collect();
        check_entries(rows.len(), free.len())?;
        let residuals: Vec<f64> = rows.iter().map(|row| row.scaled_residual(length)).collect();
        let mut columns = vec![None; mechanism.n()];
        for (j, &i) in free.iter().enumerate() {
            columns[i] = Some((j, column_scale(mechanism, i, length)));
        }
        let mut jacobian = Matrix::zeros(rows.len(), free.len());
        for_each_rate(&state, &rows, |i, coordinate, rate| {
            if let Some((j, scale)) = columns[coordinate] {
                jacobian[(i, j)] += rate * scale / rows[i].unit.size(length);
            }
        });
        let residual_norm = norm(&residuals);
        Ok(Self { q: q.to_vec(), residuals, jacobian, residual_norm, closure_error })
    }

    /// At `q`, with a column for each coordinate and the characteristic length of the mechanism.
    pub(crate) fn of(mechanism: &Mechanism, q: &[f64]) -> Result<Self> {
        let all: Vec<usize> = (0..mechanism.n()).collect();
        Self::at(mechanism, q, &all, mechanism.reach())
    }

    pub(crate) fn is_closed(&self, length: f64) -> bool {
        self.closure_error.is_closed(length)
    }
}
