//! The closed configuration nearest to all measured positions, where more joints are measured than
//! actuated.
//!
//! Formula  min_y |W (m - q - M y)|^2 over the measured coordinates, q the closed configuration of the
//!          actuated ones, M its motions, W = 1/L for lengths; then q + M y, its loops closed
//! Shapes   m, q: n, NaN where nothing is measured; y: a
//! Valid    errors so small that the loops are linear in them; away from type II singularities. No
//!          allocation
//! Checked  tests/it/servo/measured.rs::redundant_sensors_lower_the_noise

use crate::linalg::{Matrix, Svd};

/// Memory of a fit, and the positions to fit.
#[derive(Debug, Clone)]
pub(super) struct SensorFit {
    /// Measured positions of all coordinates [rad or m]; NaN where nothing is measured.
    pub(super) measured: Vec<f64>,
    /// 1 for angles, 1/L for lengths.
    scales: Vec<f64>,
    rows: Matrix,
    svd: Svd,
    residual: Vec<f64>,
    gains: Vec<f64>,
    y: Vec<f64>,
    motion: Vec<f64>,
    /// The change of all coordinates.
    pub(super) step: Vec<f64>,
}

impl SensorFit {
    /// For coordinates with these scales and `a` actuated joints, `e` of them in loops.
    pub(super) fn new(scales: Vec<f64>, a: usize, e: usize) -> Self {
        let n = scales.len();
        Self {
            measured: vec![f64::NAN; n],
            scales,
            rows: Matrix::zeros(n, a),
            svd: Svd::workspace(n, a),
            residual: vec![0.0; n],
            gains: vec![0.0; n.min(a)],
            y: vec![0.0; a],
            motion: vec![0.0; n + e],
            step: vec![0.0; n],
        }
    }

    /// Computes `step` at `q`; `motion_into` writes the velocities of each of the independent motions.
    pub(super) fn solve(
        &mut self,
        q: &[f64],
        independent: usize,
        mut motion_into: impl FnMut(usize, &mut [f64]),
    ) {
        self.rows.as_mut_slice().fill(0.0);
        for (i, residual) in self.residual.iter_mut().enumerate() {
            let off = self.measured[i] - q[i];
            *residual = if off.is_nan() { 0.0 } else { off * self.scales[i] };
        }
        for j in 0..independent {
            motion_into(j, &mut self.motion);
            for i in (0..q.len()).filter(|&i| !self.measured[i].is_nan()) {
                self.rows[(i, j)] = self.motion[i] * self.scales[i];
            }
        }
        self.svd.decompose(&self.rows);
        let rank = self.svd.rank(crate::tolerance::TRUNCATION).rank;
        for (i, gain) in self.gains.iter_mut().enumerate() {
            *gain = if i < rank { 1.0 / self.svd.value(i) } else { 0.0 };
        }
        self.svd.apply_gains_into(&self.residual, &self.gains, &mut self.y);
        self.step.fill(0.0);
        for j in 0..independent {
            motion_into(j, &mut self.motion);
            self.step.iter_mut().zip(&self.motion).for_each(|(s, m)| *s += self.y[j] * m);
        }
    }
}
