//! Scaled task coordinates, in which the task Jacobian is inverted: the components of the task,
//! linear ones divided by the characteristic length, joints by the square root of their weight.
//!
//! Formula  J_task = diag(r) S J diag(c), S selects rows, r = 1/L or 1, c = 1/sqrt(weight), 0 for
//!          locked joints; joint velocities = diag(c) (velocities of the scaled problem)
//! Shapes   J: 6 x n, J_task: m x n
//! Checked  tests/it/servo/limits.rs::joint_weights_keep_joints_still

use crate::kinematics::{Chain, ReferenceFrame};
use crate::linalg::Matrix;
use crate::model::Limits;
use crate::spatial::Twist;
use crate::task::Task;

/// The task, and the scales of its rows and columns.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct TaskScaling<'a> {
    pub(in crate::control) task: Task,
    /// Characteristic length (m).
    pub(in crate::control) length: f64,
    /// A weight for each coordinate of the mechanism; empty for none.
    pub(in crate::control) joint_weights: &'a [f64],
}

/// The selected rows and columns, and their scales.
#[derive(Debug, Clone)]
pub(in crate::control) struct TaskSpace {
    pub(super) axes: ReferenceFrame,
    /// Row of the 6 x n Jacobian and its scale, for each of the m components.
    pub(super) rows: Vec<(usize, f64)>,
    /// Scale of each of the n columns, 1 for actuated loop-closure joints; 0 for locked joints.
    pub(super) columns: Vec<f64>,
    /// Scales of the rows if the task has all six components.
    all_rows: Option<[f64; 6]>,
    /// True if all coordinates are angles and lengths.
    pub(super) turns_and_slides: bool,
    /// The unscaled Jacobian, 6 x n.
    jacobian: Matrix,
}

impl TaskSpace {
    /// For the joints of `chain` with these limits, and actuated loop-closure joints with the
    /// remaining ones.
    pub(in crate::control) fn new(
        scaling: TaskScaling<'_>,
        chain: &Chain,
        limits: &[Limits],
    ) -> Self {
        let TaskScaling { task, length, joint_weights } = scaling;
        let scale = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
        let component = |&i: &usize| task.components[i];
        let weight = |c: usize| joint_weights.get(c).map_or(1.0, |w| 1.0 / w.sqrt());
        let column = |(&c, l): (&usize, &Limits)| if is_locked(l) { 0.0 } else { weight(c) };
        Self {
            axes: task.axes,
            rows: (0..6).filter(component).map(|i| (i, scale(i))).collect(),
            all_rows: (0..6).all(|i| component(&i)).then(|| std::array::from_fn(scale)),
            turns_and_slides: chain.turns_and_slides(),
            columns: chain
                .coordinates()
                .iter()
                .zip(limits)
                .map(column)
                .chain(limits[chain.n()..].iter().map(|_| 1.0))
                .collect(),
            jacobian: Matrix::zeros(6, chain.n()),
        }
    }

    /// Computes J_task.
    pub(super) fn load(&mut self, chain: &Chain, task: &mut Matrix) {
        if let Some(scales) = self.all_rows {
            chain.jacobian_into(self.axes, task);
            let (columns, _) = task.as_mut_slice().as_chunks_mut::<6>();
            for (column, weight) in columns.iter_mut().zip(&self.columns) {
                for (t, scale) in column.iter_mut().zip(&scales) {
                    *t *= scale * weight;
                }
            }
            return;
        }
        chain.jacobian_into(self.axes, &mut self.jacobian);
        for (j, &weight) in self.columns.iter().enumerate().take(chain.n()) {
            let column = self.jacobian.column(j);
            for (t, &(row, scale)) in task.column_mut(j).iter_mut().zip(&self.rows) {
                *t = column[row] * scale * weight;
            }
        }
    }

    /// Computes the unscaled Jacobian of all six components, world axes at the tool: [`Self::whole`].
    pub(super) fn load_whole(&mut self, chain: &Chain) {
        chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut self.jacobian);
    }

    /// The unscaled Jacobian, 6 x n.
    pub(super) fn whole(&self) -> &Matrix {
        &self.jacobian
    }

    /// The velocity of joint i in scaled coordinates; 0 if it is locked.
    pub(super) fn scaled_rate(&self, i: usize, rate: f64) -> f64 {
        scaled(rate, self.columns[i])
    }

    /// Scales the velocities of the first joints.
    pub(super) fn scale_rates(&self, rates: &mut [f64]) {
        rates
            .iter_mut()
            .zip(&self.columns)
            .for_each(|(rate, column)| *rate = scaled(*rate, *column));
    }

    /// The scaled velocities of the first joints.
    pub(super) fn scaled_rates(&self, rates: &[f64]) -> Vec<f64> {
        rates.iter().enumerate().map(|(i, rate)| self.scaled_rate(i, *rate)).collect()
    }

    /// Converts a twist to task coordinates.
    pub(super) fn scale(&self, twist: Twist, x: &mut [f64]) {
        let twist = twist.to_array();
        if let (Some(scales), Ok(x)) = (self.all_rows, <&mut [f64; 6]>::try_from(&mut *x)) {
            *x = std::array::from_fn(|i| twist[i] * scales[i]);
            return;
        }
        for (x, &(row, scale)) in x.iter_mut().zip(&self.rows) {
            *x = twist[row] * scale;
        }
    }

    /// The twist of these task coordinates, zero in the other components.
    pub(super) fn twist(&self, x: &[f64]) -> Twist {
        let mut twist = [0.0; 6];
        for (x, &(row, scale)) in x.iter().zip(&self.rows) {
            twist[row] = x / scale;
        }
        Twist::from_array(twist)
    }

    /// True for joints whose limits permit no motion: they are treated as fixed.
    pub(super) fn is_locked(&self, i: usize) -> bool {
        self.columns[i] == 0.0
    }
}

#[inline]
fn scaled(rate: f64, column: f64) -> f64 {
    if column == 0.0 { 0.0 } else { rate / column }
}

/// True for a joint that cannot move.
pub(in crate::control) fn is_locked(limits: &Limits) -> bool {
    limits.lower == limits.upper || limits.velocity == 0.0 || limits.acceleration == 0.0
}
