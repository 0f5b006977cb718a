//! The rows of a goal: its scaled error and Jacobian.
//!
//! Formula  frame: kinematics of its chain; relative frame and gaze: `task/relative_frame.rs`,
//!          `task/gaze.rs`, of the gaze the components across the z axis, in the axes of the frame;
//!          centre of mass: e = c_d - c, J = sum m_i J_i / m
//! Shapes   error: [p; r], of which some components are rows; Jacobian: 6 x k, k coordinates that
//!          move it
//! Units    m, rad; rows of lengths are divided by the characteristic length, times the weight
//! Why so   a frame alone is the common case: its chain costs less than the state of the whole tree,
//!          which the other goals need
//! Checked  tests/it/ik.rs, tests in this file (finite differences)

use super::goal::{Goal, Objective};
use crate::kinematics::{Chain, MassMatrix, State};
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::spatial::{Pose, Twist, Vec3};
use crate::task::{Gaze, RelativeFrame, Task};

/// A goal with its memory.
#[derive(Debug, Clone)]
pub(super) struct GoalRows {
    pub(super) goal: Goal,
    source: Source,
    /// 6 x the coordinates of its chain, or n.
    jacobian: Matrix,
    /// Columns of the Jacobian, and their places among the coordinates of the problem.
    columns: Vec<(usize, usize)>,
    /// Components of the error, and the scale of their rows.
    pub(super) rows: Vec<(usize, f64)>,
}

/// The kinematics of a goal.
#[derive(Debug, Clone)]
enum Source {
    Frame(Chain),
    Relative,
    CenterOfMass(MassMatrix),
    Gaze { memory: Matrix, world: Matrix },
}

impl GoalRows {
    /// `length` is the characteristic length; [`GoalRows::place`] follows.
    pub(super) fn new(mechanism: &Mechanism, goal: &Goal, length: f64) -> Self {
        let n = mechanism.n();
        let chain_of = |end_effector| Chain::of(mechanism, end_effector);
        let mut own = Vec::new();
        let (source, jacobian) = match goal.objective {
            Objective::Frame { end_effector, .. } => {
                let chain = chain_of(end_effector);
                own.extend_from_slice(chain.coordinates());
                let jacobian = Matrix::zeros(6, chain.n());
                (Source::Frame(chain), jacobian)
            }
            Objective::RelativeFrame { end_effector, reference, .. } => {
                own.extend_from_slice(chain_of(end_effector).coordinates());
                own.extend_from_slice(chain_of(reference).coordinates());
                own.sort_unstable();
                own.dedup();
                (Source::Relative, Matrix::zeros(6, n))
            }
            Objective::CenterOfMass { .. } => {
                own.extend(0..n);
                (Source::CenterOfMass(MassMatrix::new(mechanism)), Matrix::zeros(3, n))
            }
            Objective::Gaze { end_effector, .. } => {
                own.extend_from_slice(chain_of(end_effector).coordinates());
                let (memory, world) = (Matrix::zeros(6, n), Matrix::zeros(3, n));
                (Source::Gaze { memory, world }, Matrix::zeros(6, n))
            }
        };
        let is_narrow = matches!(source, Source::Frame(_));
        let column = |(i, c): (usize, usize)| (if is_narrow { i } else { c }, c);
        let scale = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
        let rows = (0..6).filter(|&i| components(&goal.objective)[i]);
        let rows = rows.map(|i| (i, goal.weight * scale(i))).collect();
        let columns = own.into_iter().enumerate().map(column).collect();
        Self { goal: *goal, source, jacobian, columns, rows }
    }

    /// The coordinates that can change the error, ascending, before they are placed.
    pub(super) fn coordinates(&self) -> impl Iterator<Item = usize> + '_ {
        self.columns.iter().map(|(_, c)| *c)
    }

    /// Replaces them by their places among the coordinates of the problem, ascending.
    pub(super) fn place(&mut self, coordinates: &[usize]) {
        for (_, c) in &mut self.columns {
            *c = coordinates.partition_point(|x| x < c);
        }
    }

    /// True if it needs the state of the whole tree.
    pub(super) fn needs_state(&self) -> bool {
        !matches!(self.source, Source::Frame(_))
    }

    /// The chain of a frame with the components and the target of its task.
    pub(super) fn frame(&self) -> Option<(&Chain, Task, Pose)> {
        match (&self.source, self.goal.objective) {
            (Source::Frame(chain), Objective::Frame { components, target, .. }) => {
                Some((chain, components, target))
            }
            _ => None,
        }
    }

    /// Sets another target and weight of the same objective.
    pub(super) fn set(&mut self, goal: &Goal) {
        for (_, scale) in &mut self.rows {
            *scale *= goal.weight / self.goal.weight;
        }
        self.goal = *goal;
    }

    /// The error at `q`, or at `state` of it; zero in components that are no rows.
    #[inline]
    pub(super) fn error(&mut self, q: &[f64], state: Option<&State>) -> Twist {
        match (&mut self.source, self.goal.objective, state) {
            (Source::Frame(chain), Objective::Frame { components, target, .. }, _) => {
                components.error(chain.set(q), target)
            }
            (_, objective, Some(state)) => self.error_at(&objective, state),
            _ => Twist::ZERO,
        }
    }

    fn error_at(&mut self, objective: &Objective, state: &State) -> Twist {
        match (&mut self.source, *objective) {
            (
                Source::Relative,
                Objective::RelativeFrame { end_effector, reference, components, target },
            ) => RelativeFrame { end_effector, reference, components, target }.error(state),
            (Source::CenterOfMass(masses), Objective::CenterOfMass { axes, target }) => {
                // The mechanism is that of the masses.
                let found = masses.center_of_mass(state, &mut self.jacobian);
                let mut error = found.map_or([f64::NAN; 3], |(_, c)| (target - c).to_array());
                for (x, counts) in error.iter_mut().zip(axes) {
                    *x *= f64::from(u8::from(counts));
                }
                Twist { linear: Vec3::from_array(error), angular: Vec3::ZERO }
            }
            (Source::Gaze { .. }, Objective::Gaze { end_effector, point }) => {
                let error = Gaze { end_effector, point }.error(state);
                let axes = state.pose_of(end_effector).rotation.matrix();
                let Vec3 { x, y, .. } = axes.tr_mul(error);
                Twist { linear: Vec3::ZERO, angular: Vec3::new(x, y, 0.0) }
            }
            _ => Twist::ZERO,
        }
    }

    /// Writes the scaled Jacobian at the configuration evaluated last to the rows of `a` (m x n, by
    /// columns) that begin with `first`.
    pub(super) fn load_jacobian(
        &mut self,
        state: Option<&State>,
        (m, first): (usize, usize),
        a: &mut [f64],
    ) {
        if let (Source::Frame(chain), Objective::Frame { components, .. }) =
            (&self.source, self.goal.objective)
        {
            chain.jacobian_into(components.axes, &mut self.jacobian);
        } else if let Some(state) = state {
            self.load_jacobian_at(state);
        }
        for &(j, place) in &self.columns {
            let column = self.jacobian.column(j);
            let out = &mut a[place * m + first..][..self.rows.len()];
            for (x, &(i, scale)) in out.iter_mut().zip(&self.rows) {
                *x = column[i] * scale;
            }
        }
    }

    fn load_jacobian_at(&mut self, state: &State) {
        match (&mut self.source, self.goal.objective) {
            (
                Source::Relative,
                Objective::RelativeFrame { end_effector, reference, components, target },
            ) => RelativeFrame { end_effector, reference, components, target }
                .jacobian_into(state, &mut self.jacobian),
            (Source::Gaze { memory, world }, Objective::Gaze { end_effector, point }) => {
                Gaze { end_effector, point }.jacobian_into(state, memory, world);
                let axes = state.pose_of(end_effector).rotation.matrix();
                for j in 0..world.cols() {
                    let column = world.column(j);
                    let own = axes.tr_mul(Vec3::new(column[0], column[1], column[2]));
                    self.jacobian.column_mut(j)[3..].copy_from_slice(&own.to_array());
                }
            }
            // The centre of mass came with its Jacobian.
            _ => {}
        }
    }

    /// A frame that is farther from the first joint of its chain than the length of the chain: both
    /// (m).
    pub(super) fn out_of_reach(&self, mechanism: &Mechanism) -> Option<(f64, f64)> {
        let (chain, components, target) = self.frame()?;
        let whole = components.components[..3] == [true; 3];
        let far = (target.translation - chain.first_origin()).norm();
        let length = chain.length_after_first_joint(mechanism);
        (whole && far > length * (1.0 + 1e-12)).then_some((far, length))
    }
}

/// The components of the error that are rows.
fn components(objective: &Objective) -> [bool; 6] {
    match objective {
        Objective::Frame { components, .. } | Objective::RelativeFrame { components, .. } => {
            components.components
        }
        Objective::CenterOfMass { axes: [x, y, z], .. } => [*x, *y, *z, false, false, false],
        Objective::Gaze { .. } => [false, false, false, true, true, false],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ik::HalfSpace;
    use crate::ik::half_space_rows::HalfSpaceRows;
    use crate::model::{Inertial, JointKind, JointSpec, Link};
    use crate::scalar::uniform;
    use crate::spatial::Mat3;

    /// Two branches on one turning base, with masses.
    fn forked() -> Mechanism {
        let mut builder = Mechanism::builder("forked");
        let inertial = |mass: f64| Inertial {
            mass,
            link_from_inertia: Pose::from_translation(Vec3::new(0.05, -0.02, 0.1)),
            inertia: Mat3::ZERO,
        };
        for (i, (parent, link)) in [
            ("world", "base"),
            ("base", "left"),
            ("left", "left tip"),
            ("base", "right"),
            ("right", "right tip"),
        ]
        .into_iter()
        .enumerate()
        {
            let mass = 1.0 + i as f64;
            builder.link(Link { inertial: Some(inertial(mass)), ..Link::named(link) });
            let kind = if i == 4 { JointKind::Prismatic } else { JointKind::Revolute };
            let mut joint = JointSpec::new(&format!("q{i}"), kind, parent, link);
            joint.axis = [Vec3::Z, Vec3::X, Vec3::Y, Vec3::Y, Vec3::X][i];
            joint.parent_from_joint = Pose::from_translation(Vec3::new(0.1, 0.2, 0.3));
            builder.joint(joint);
        }
        builder.build().unwrap()
    }

    /// Without an error, its derivative is minus the Jacobian; so is that of the distance of a
    /// half-space its gradient.
    #[test]
    fn jacobians_are_derivatives() {
        let robot = forked();
        let (n, mut random) = (robot.n(), 5);
        let [left, right] = ["left tip", "right tip"].map(|name| robot.frame(name).unwrap());
        let coordinates: Vec<usize> = (0..n).collect();
        for _ in 0..10 {
            let q: Vec<f64> = (0..n).map(|_| 2.0 * uniform(&mut random) - 1.0).collect();
            let mut state = robot.state(&q).unwrap();
            let mut masses = MassMatrix::new(&robot);
            let center = masses.center_of_mass(&state, &mut Matrix::zeros(3, n)).unwrap().1;
            let (a, b) = (state.pose_of(left), state.pose_of(right));
            for goal in [
                Goal::pose(left, a),
                Goal::relative(right, left, a.inverse() * b),
                Goal::center_of_mass(center),
                Goal::gaze(right, b * (Vec3::Z * 0.8)),
            ] {
                let mut rows = GoalRows::new(&robot, &goal.with_weight(2.0), 0.5);
                rows.place(&coordinates);
                let m = rows.rows.len();
                let mut jacobian = vec![0.0; m * n];
                rows.error(&q, Some(&state));
                rows.load_jacobian(Some(&state), (m, 0), &mut jacobian);
                let mut scaled = |q: &[f64]| -> Vec<f64> {
                    let state = robot.state(q).unwrap();
                    let error = rows.error(q, Some(&state)).to_array();
                    rows.rows.iter().map(|&(i, scale)| scale * error[i]).collect()
                };
                for j in 0..n {
                    let at = |h: f64| {
                        let mut q = q.clone();
                        q[j] += h;
                        q
                    };
                    let (more, less) = (scaled(&at(1e-5)), scaled(&at(-1e-5)));
                    for i in 0..m {
                        let slope = (more[i] - less[i]) / 2e-5;
                        let own = jacobian[j * m + i];
                        assert!((slope + own).abs() < 1e-8, "{slope} {own} of {goal:?}");
                    }
                }
            }
            let half_space = HalfSpace {
                name: "plane".to_owned(),
                end_effector: right.into(),
                point: Vec3::new(0.1, 0.2, 0.3),
                normal: Vec3::new(1.0, -2.0, 0.5),
            };
            let mut all = HalfSpaceRows::new(&robot, &[half_space]);
            let gradient = all.gradient(0, &state).to_vec();
            for (j, own) in gradient.into_iter().enumerate() {
                let mut room = |h: f64| {
                    let mut q = q.clone();
                    q[j] += h;
                    state.set(&q).unwrap();
                    all.evaluate(&state);
                    all.rooms[0]
                };
                assert!(((room(1e-5) - room(-1e-5)) / 2e-5 - own).abs() < 1e-8);
            }
        }
    }
}
