//! The edge of the workspace: how the task of a step bends, and how fast its joints may approach a
//! pose that is the nearest one.
//!
//! Formula  C_ij = -sum_k e_k r_k (dJ_kj/dq_i + dJ_ki/dq_j) / 2 c_i c_j, with the scales r of rows and
//!          c of columns (`task_space.rs`); in the axes of the tool, with which the error turns, also
//!          J_i . r^2 (w_j x e), w_j the angular columns of J, symmetrised as well
//!          The share of velocities y' from which all joints stop at the nearest pose, w away
//!          (`nearest_pose.rs`), is that of ways t y' (`approach.rs`): t the least of |w+ / a| / |y' / a|,
//!          w+ the parts of w in the directions of y', a the acceleration limits, and of (g w) / (g y'),
//!          g = J^T x, which does not see self-motions
//! Shapes   n x n
//! Valid    trees. One time for all joints: a joint whose way changes its sign does not hold up the
//!          others
//! Checked  tests/it/servo/edge.rs

use super::approach;
use super::task_space::TaskSpace;
use crate::control::solver::saturation::{Curvature, KnownWay};
use crate::kinematics::{Chain, ReferenceFrame};
use crate::linalg::{Matrix, dot};
use crate::model::Limits;
use crate::spatial::Vec3;

/// The present step.
#[derive(Debug)]
pub(super) struct Edge<'a> {
    pub(super) chain: &'a Chain,
    pub(super) space: &'a TaskSpace,
    pub(super) limits: &'a [Limits],
    pub(super) dt: f64,
    /// Memory for the derivatives of the Jacobian, 6 x n for each coordinate.
    pub(super) hessian: &'a mut [Matrix],
    /// The way to the nearest pose, where it is known and the motion ends there.
    pub(super) way: Option<KnownWay<'a>>,
    /// Of a motion that goes straight to the nearest pose.
    pub(super) gain_of_way: Option<f64>,
}

/// C at the configuration of the chain, for what is `left` of the scaled error; `hessian` is memory.
pub(in crate::control) fn curvature_into(
    (chain, space): (&Chain, &TaskSpace),
    hessian: &mut [Matrix],
    left: &[f64],
    out: &mut Matrix,
) {
    chain.hessian_into(space.axes, hessian);
    let columns = &space.columns;
    for (i, h) in hessian.iter().enumerate() {
        for (j, x) in out.column_mut(i).iter_mut().enumerate() {
            let column = h.column(j);
            let parts = left.iter().zip(&space.rows);
            let sum: f64 = parts.map(|(e, &(row, scale))| e * scale * column[row]).sum();
            *x = -sum * columns[i] * columns[j];
        }
    }
    if let (ReferenceFrame::Local, Some(jacobian)) = (space.axes, hessian.first_mut()) {
        chain.jacobian_into(space.axes, jacobian);
        add_turn(space, jacobian, left, out);
    }
    for i in 0..out.rows() {
        for j in 0..i {
            let mean = 0.5 * (out[(i, j)] + out[(j, i)]);
            (out[(i, j)], out[(j, i)]) = (mean, mean);
        }
    }
}

/// Adds the change of an error in axes that turn with the tool.
fn add_turn(space: &TaskSpace, jacobian: &Matrix, left: &[f64], out: &mut Matrix) {
    let mut error = [0.0; 6];
    for (e, &(row, scale)) in left.iter().zip(&space.rows) {
        error[row] = e / scale;
    }
    let [x, y, z, a, b, c] = error;
    let (linear, angular) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
    let columns = &space.columns;
    for (j, scale) in columns.iter().enumerate() {
        let column = jacobian.column(j);
        let w = Vec3::new(column[3], column[4], column[5]);
        let (v, r) = (w.cross(linear).to_array(), w.cross(angular).to_array());
        for (i, own) in columns.iter().enumerate() {
            let column = jacobian.column(i);
            let along = |&(row, scale): &(usize, f64)| {
                let turned = if row < 3 { v[row] } else { r[row - 3] };
                scale * scale * column[row] * turned
            };
            let sum: f64 = space.rows.iter().map(along).sum();
            out[(i, j)] += sum * own * scale;
        }
    }
}

impl Curvature for Edge<'_> {
    fn load(&mut self, left: &[f64], out: &mut Matrix) {
        curvature_into((self.chain, self.space), self.hessian, left, out);
    }

    fn known_way(&self) -> Option<KnownWay<'_>> {
        self.way
    }

    fn gain_of_way(&self) -> Option<f64> {
        self.gain_of_way
    }

    fn share(&mut self, way: &[f64], rates: &[f64], gradient: &[f64]) -> f64 {
        let (columns, limits, dt) = (&self.space.columns, self.limits, self.dt);
        let time = |KnownWay { way, .. }: KnownWay<'_>| {
            let along = (dot(gradient, way), dot(gradient, rates));
            time_to_nearest((way, rates), along, columns, limits)
        };
        match self.way.and_then(time) {
            Some(time) => {
                approach::scale(rates.iter().map(|r| time * r), rates, columns, limits, dt)
            }
            None => approach::scale(way.iter().copied(), rates, columns, limits, dt),
        }
    }
}

/// The time t at these velocities until the nearest pose, where one of its ways leads on; `along` are
/// g w and g y'.
pub(super) fn time_to_nearest(
    (way, rates): (&[f64], &[f64]),
    (along, of_all): (f64, f64),
    columns: &[f64],
    limits: &[Limits],
) -> Option<f64> {
    let (mut ahead, mut all) = (0.0, 0.0);
    for (((way, rate), column), limits) in way.iter().zip(rates).zip(columns).zip(limits) {
        // A joint that stops at once has no share.
        let weight = if *column == 0.0 { 0.0 } else { column / limits.acceleration };
        let (way, rate) = (weight * way, weight * rate);
        ahead += if way * rate > 0.0 { way * way } else { 0.0 };
        all += rate * rate;
    }
    let of_task = if along > 0.0 && of_all > 0.0 { along / of_all } else { f64::INFINITY };
    let time = of_task.min((ahead / all).sqrt());
    (time > 0.0 && time < f64::INFINITY).then_some(time)
}

#[cfg(test)]
mod tests {
    use super::super::task_space::TaskScaling;
    use super::*;
    use crate::model::catalogue;
    use crate::task::Task;

    /// In the axes of the tool, J^T J + C is the second derivative of half of the squared error of the
    /// position: by central differences of its gradient - J^T e. With weights of joints, one of them
    /// locked.
    #[test]
    fn curvatures_in_axes_of_the_tool_are_those_of_differences() {
        let robot = catalogue::load("panda").unwrap();
        let mut chain = Chain::of(&robot, robot.tool());
        let (n, length, step) = (chain.n(), 0.7, 1e-6);
        let weights: Vec<f64> = (0..n).map(|j| 1.0 + 0.5 * j as f64).collect();
        let mut limits = vec![Limits::NONE; n];
        limits[2] = Limits { velocity: 0.0, ..Limits::NONE };
        let scale = |j: usize| if j == 2 { 0.0 } else { 1.0 / weights[j].sqrt() };
        let task = Task { axes: ReferenceFrame::Local, ..Task::POSITION };
        let scaling = TaskScaling { task, length, joint_weights: &weights };
        let space = TaskSpace::new(scaling, &chain, &limits);
        let q: Vec<f64> = robot.home().iter().map(|x| x + 0.2).collect();
        let away = Vec3::new(0.2, -0.3, 0.15);
        let target = chain.set(&q) * away;
        let mut jacobian = Matrix::zeros(6, n);
        let mut gradient = |chain: &mut Chain, q: &[f64]| -> Vec<f64> {
            let left = chain.set(q).inverse() * target;
            chain.jacobian_into(ReferenceFrame::Local, &mut jacobian);
            let column = |j: usize| Vec3::new(jacobian[(0, j)], jacobian[(1, j)], jacobian[(2, j)]);
            (0..n).map(|j| -scale(j) * column(j).dot(left) / (length * length)).collect()
        };
        let mut slopes = Vec::new();
        for i in 0..n {
            let (mut ahead, mut behind) = (q.clone(), q.clone());
            ahead[i] += step;
            behind[i] -= step;
            let pairs = gradient(&mut chain, &ahead).into_iter().zip(gradient(&mut chain, &behind));
            slopes.push(pairs.map(|(a, b)| scale(i) * (a - b) / (2.0 * step)).collect::<Vec<_>>());
        }
        chain.set(&q);
        let mut hessian = vec![Matrix::zeros(6, n); n];
        let mut found = Matrix::zeros(n, n);
        let left = away.to_array().map(|e| e / length);
        curvature_into((&chain, &space), &mut hessian, &left, &mut found);
        chain.jacobian_into(ReferenceFrame::Local, &mut jacobian);
        for i in 0..n {
            for j in 0..n {
                let both: f64 = (0..3).map(|k| jacobian[(k, i)] * jacobian[(k, j)]).sum();
                let expected = slopes[i][j] - scale(i) * scale(j) * both / (length * length);
                assert!(
                    (found[(i, j)] - expected).abs() < 1e-8,
                    "{i}, {j}: {} {expected}",
                    found[(i, j)]
                );
            }
        }
    }
}
