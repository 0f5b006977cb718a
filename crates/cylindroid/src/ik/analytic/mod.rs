//! Analytic inverse kinematics: all configurations of six revolute joints for a tool pose, in
//! closed form.
//!
//! Method   the geometry of the axes is determined once; its closed form gives candidates. Each is
//!          wrapped into the joint limits, verified by forward kinematics and, if the geometry
//!          deviates from the ideal one by rounding in the model file, refined by at most two
//!          Newton steps
//! Units    rad, m; position errors are compared relative to the characteristic length
//! Valid    six revolute joints between the ground and the tool, without coupling, besides any
//!          locked joints. Closer to a singular configuration than the square root of the deviation
//!          of the axes, a solution may be missing
//! Why so   solutions are verified by forward kinematics, not by the closed form
//! Source   see [`geometry`] and [`pieper`]
//! Checked  tests/it/analytic/

mod geometry;
mod joints;
mod pieper;
mod solutions;
mod subproblems;

use std::f64::consts::TAU;
use std::fmt;

use self::geometry::{ArmParameters, Three};
use self::joints::{are_revolute, axes, move_tool_only};
use self::pieper::Target;
use self::subproblems::{Angle, Misses};
use crate::error::{Error, Result};
use crate::kinematics::{Chain, EndEffector, ReferenceFrame};
use crate::linalg::{Damped, DampedProblem, Matrix};
use crate::model::Mechanism;
use crate::scalar::{clamp, nearest_turn, uniform};
use crate::spatial::{Pose, Rotation, Twist};
use crate::task::check_target;
use crate::tolerance::{ANALYTIC_AT_LIMIT, ANALYTIC_CONFIRMED, ANALYTIC_EXACT, ANALYTIC_REFINED};

pub use self::geometry::ArmGeometry;
pub use self::solutions::{AnalyticSolution, AnalyticSolutions};

/// Newton steps per candidate.
const STEPS: usize = 2;
/// Damping relative to the squared norm of the Jacobian [-]: with a free joint clamped it is
/// singular, and steps are accurate to four digits.
const DAMPING: f64 = 1e-12;

/// The reason why a chain has no closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NotSolvable {
    /// The number of unlocked coordinates that move the tool is not six, but this.
    Joints(usize),
    /// Loops or contacts couple the joints.
    Loops,
    /// A joint that moves the tool is not an uncoupled revolute joint.
    Kind,
    /// No three axes intersect or are parallel as required.
    Axes,
    /// The frame is one of another mechanism.
    Foreign,
}

impl fmt::Display for NotSolvable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Joints(n) => write!(f, "{n} joints move the tool, the closed form requires six"),
            Self::Loops => f.write_str("loops or contacts couple the joints"),
            Self::Kind => f.write_str("a joint that moves the tool is not an uncoupled revolute joint"),
            Self::Axes => f.write_str(
                "neither the first nor the last three axes intersect in a point, nor are axes 2 to 4 \
                 or 3 to 5 parallel",
            ),
            Self::Foreign => f.write_str("the frame is one of another mechanism"),
        }
    }
}

/// Analytic inverse kinematics of one end effector. [`Analytic::solve`] does not allocate.
#[derive(Debug, Clone)]
#[doc(alias = "closed form")]
#[doc(alias = "Pieper")]
pub struct Analytic {
    chain: Chain,
    structure: ArmGeometry,
    departure: f64,
    geometry: ArmParameters,
    /// Orientation of the tool at zero.
    zero: Rotation,
    /// Indices of the six joints in `q`, and of the locked joints of the chain.
    coordinates: [usize; 6],
    locked: Vec<usize>,
    /// True if the locked joints move the tool alone, none of the six axes.
    moves_tool_only: bool,
    lower: [f64; 6],
    upper: [f64; 6],
    reach: f64,
    /// The complete configuration.
    q: Vec<f64>,
    jacobian: Matrix,
    a: [f64; 36],
    damped: Damped,
}

impl Analytic {
    /// For the six joints that move an end effector.
    ///
    /// ```
    /// use cylindroid::ik::Analytic;
    ///
    /// let arm = cylindroid::load("ur5e")?;
    /// let mut ik = Analytic::of(&arm, arm.tool()).expect("three axes are parallel");
    /// assert_eq!(ik.geometry().to_string(), "parallel axes 2, 3 and 4, axes 5 and 6 meet");
    /// let q = [0.3, -1.1, 1.4, 0.2, 1.0, 0.4];
    /// let answers = ik.solve(arm.state(&q)?.pose(arm.tool())?, &q)?;
    /// assert_eq!(answers.len(), 8);
    /// assert!(answers.iter().any(|a| a.q.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-9)));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// The reason why there is no closed form.
    pub fn of(
        mechanism: &Mechanism,
        end_effector: impl Into<EndEffector>,
    ) -> std::result::Result<Self, NotSolvable> {
        Self::with_locked(mechanism, end_effector, &[])
    }

    /// The same with some coordinates locked: they keep the values of the initial guess in each
    /// call. An arm with seven joints has a closed form for any value of a suitable locked joint.
    ///
    /// ```
    /// use cylindroid::ik::Analytic;
    ///
    /// let arm = cylindroid::load("panda")?;
    /// let q = arm.home();
    /// let mut ik = Analytic::with_locked(&arm, arm.tool(), &[6]).expect("a closed form");
    /// assert!(ik.solve(arm.state(q)?.pose(arm.tool())?, q)?.len() > 0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// The reason why there is no closed form.
    pub fn with_locked(
        mechanism: &Mechanism,
        end_effector: impl Into<EndEffector>,
        locked: &[usize],
    ) -> std::result::Result<Self, NotSolvable> {
        if mechanism.is_closed() {
            return Err(NotSolvable::Loops);
        }
        let end_effector = end_effector.into();
        mechanism.check_frame(end_effector.frame).map_err(|_| NotSolvable::Foreign)?;
        let mut chain = Chain::of(mechanism, end_effector);
        let (locked, free): (Vec<usize>, Vec<usize>) =
            chain.coordinates().iter().partition(|c| locked.contains(c));
        let coordinates: [usize; 6] =
            free.as_slice().try_into().map_err(|_| NotSolvable::Joints(free.len()))?;
        if !are_revolute(mechanism, end_effector, &coordinates) {
            return Err(NotSolvable::Kind);
        }
        let mut jacobian = Matrix::zeros(6, chain.n());
        // A property at random values of the locked joints is generic.
        let mut state = 1;
        let mut q = vec![0.0; mechanism.n()];
        locked.iter().for_each(|&c| q[c] = 2.0 * uniform(&mut state) - 1.0);
        let reach = mechanism.reach();
        let axes = axes(&mut chain, &coordinates, &q, &mut jacobian).ok_or(NotSolvable::Kind)?;
        let (structure, departure) = axes.structure(reach).ok_or(NotSolvable::Axes)?;
        let limits = coordinates.map(|c| mechanism.coordinates()[c].limits);
        Ok(Self {
            geometry: axes.geometry(structure, reach),
            zero: chain.pose().rotation,
            chain,
            structure,
            departure,
            coordinates,
            moves_tool_only: move_tool_only(mechanism, end_effector, &coordinates, &locked),
            locked,
            lower: limits.map(|l| l.lower),
            upper: limits.map(|l| l.upper),
            reach,
            q,
            jacobian,
            a: [0.0; 36],
            damped: Damped::new(6, 6),
        })
    }

    /// The geometry on which the closed form rests.
    #[must_use]
    pub fn geometry(&self) -> ArmGeometry {
        self.structure
    }

    /// True if the axes have this geometry to rounding: then no solution is missing.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.departure <= ANALYTIC_EXACT
    }

    /// Indices of the six joints in `q`, from the ground.
    #[must_use]
    pub fn coordinates(&self) -> [usize; 6] {
        self.coordinates
    }

    /// Indices of the joints of the chain that keep the values of the initial guess.
    #[must_use]
    pub fn locked(&self) -> &[usize] {
        &self.locked
    }

    /// All solutions within the limits for `world_from_tool`, verified by forward kinematics to
    /// 1e-10 (rad, and reaches). Angles are wrapped to the value closest to `start` (all n
    /// coordinates), which also gives the values of locked and free joints.
    ///
    /// # Errors
    /// A `start` of the wrong size, non-finite values.
    pub fn solve(&mut self, target: Pose, start: &[f64]) -> Result<AnalyticSolutions> {
        self.check(target, start)?;
        let near = self.coordinates.map(|c| start[c]);
        let mut solutions = AnalyticSolutions::NONE;
        self.candidates(target, start, |analytic, q, (free, _)| {
            solutions.note_free(&free);
            let solution = analytic.confirmed(q, free, &target, &near);
            solution.is_some_and(|solution| {
                solutions.insert(solution);
                true
            })
        });
        Ok(solutions)
    }

    /// Calls `visit` with the candidates of the closed form for input that was checked, neither
    /// wrapped nor verified, each with the joints that the pose leaves free and its branch, whose
    /// bits are the signs of roots by joint; `visit` answers whether the candidate counts as a
    /// solution. Returns by how much the conditions of the closed form miss their solutions, beyond
    /// -1 or 1; 0 of those that have one or are not reached.
    pub(super) fn candidates(
        &mut self,
        target: Pose,
        start: &[f64],
        mut visit: impl FnMut(&mut Self, [f64; 6], ([bool; 6], u8)) -> bool,
    ) -> [f64; 7] {
        if self.locked.iter().any(|&c| self.q[c] != start[c]) {
            self.lock(start);
        }
        self.q.copy_from_slice(start);
        let rotation = target.rotation.matrix() * self.zero.inverse().matrix();
        let ArmGeometry { three, reversed, .. } = self.structure;
        let mut angles = self.coordinates.map(|c| start[c]);
        let mut aim = Target { rotation, position: target.translation, start: angles };
        if reversed {
            angles.reverse();
            let back = rotation.transpose();
            (aim.rotation, aim.position) = (back, -(back * target.translation));
        }
        let geometry = self.geometry;
        for (angle, sign) in angles.iter_mut().zip(geometry.sign) {
            *angle *= sign;
        }
        aim.start = angles;
        let found = |turns: &[Angle; 6]| {
            let mut q = [0.0; 6];
            let (mut free, mut branch) = ([false; 6], 0);
            for (i, turn) in turns.iter().enumerate() {
                let place = if reversed { 5 - i } else { i };
                q[place] = turn.angle * geometry.sign[i];
                free[place] = turn.free;
                branch |= u8::from(turn.is_second) << i;
            }
            visit(self, q, (free, branch))
        };
        let misses = Misses::default();
        match three {
            Three::Meet => pieper::meeting(&geometry, &aim, &misses, found),
            Three::Parallel => pieper::parallel(&geometry, &aim, &misses, found),
        }
        misses.to_array()
    }

    /// The angles wrapped to the values closest to `near`, or to the limits where no full turn
    /// takes them within; the same clamped to the limits; and the largest displacement (rad).
    pub(super) fn wrapped(&self, angles: [f64; 6], near: &[f64; 6]) -> ([f64; 6], [f64; 6], f64) {
        let (mut wrapped, mut q, mut most) = (angles, angles, 0.0_f64);
        for i in 0..6 {
            let (lower, upper) = (self.lower[i], self.upper[i]);
            let within = turned(angles[i], near[i], lower, upper);
            wrapped[i] = within.unwrap_or_else(|| nearest_turn(angles[i], 0.5 * (lower + upper)));
            q[i] = clamp(wrapped[i], lower, upper);
            if within.is_none() {
                most = most.max((q[i] - wrapped[i]).abs());
            }
        }
        (wrapped, q, most)
    }

    /// A solution with all full turns that the limits permit, itself included; joints without
    /// limits keep their angle.
    #[must_use]
    pub fn with_full_turns(&self, solution: &AnalyticSolution) -> Vec<[f64; 6]> {
        let mut all = vec![solution.q];
        for i in 0..6 {
            let (lower, upper) = (self.lower[i], self.upper[i]);
            if !(lower.is_finite() && upper.is_finite()) {
                continue;
            }
            let first = ((lower - solution.q[i]) / TAU).ceil();
            let turns = ((upper - solution.q[i]) / TAU).floor() - first;
            let turned = |q: &[f64; 6], k: usize| {
                let mut q = *q;
                // The solution itself may be at a limit to the last bit.
                q[i] = clamp(q[i] + TAU * (first + k as f64), lower, upper);
                q
            };
            all = all
                .iter()
                .flat_map(|q| (0..=turns.max(0.0) as usize).map(|k| turned(q, k)))
                .collect();
        }
        all
    }

    pub(super) fn check(&self, target: Pose, start: &[f64]) -> Result<()> {
        Error::check_len("start", self.q.len(), start.len())?;
        Error::check_finite("start", start)?;
        check_target(&target)
    }

    /// The closed form for other values of the locked joints.
    fn lock(&mut self, start: &[f64]) {
        self.q.copy_from_slice(start);
        self.coordinates.iter().for_each(|&c| self.q[c] = 0.0);
        if self.moves_tool_only {
            let Pose { rotation, translation } = self.chain.set(&self.q);
            self.zero = rotation;
            self.geometry.set_tool(translation, self.structure.reversed);
            return;
        }
        let axes = axes(&mut self.chain, &self.coordinates, &self.q, &mut self.jacobian);
        if let Some(axes) = axes {
            self.zero = self.chain.pose().rotation;
            self.geometry = axes.geometry(self.structure, self.reach);
        }
    }

    /// The verified solution within the limits, if there is one.
    pub(super) fn confirmed(
        &mut self,
        mut q: [f64; 6],
        free: [bool; 6],
        target: &Pose,
        near: &[f64; 6],
    ) -> Option<AnalyticSolution> {
        for i in 0..6 {
            q[i] = turned(q[i], near[i], self.lower[i], self.upper[i])?;
        }
        let mut errors = self.errors(&mut q, target);
        for _ in 0..STEPS {
            let size = self.larger(errors);
            if size <= ANALYTIC_REFINED || size > 1.0 {
                break;
            }
            let before = (q, errors);
            self.refine(&mut q, &free, target);
            errors = self.errors(&mut q, target);
            if self.larger(errors) >= size {
                (q, errors) = before;
                break;
            }
        }
        let (position_error, orientation_error) = errors;
        (self.larger(errors) <= ANALYTIC_CONFIRMED).then_some(AnalyticSolution {
            q,
            free,
            position_error,
            orientation_error,
        })
    }

    /// The larger of the errors (rad, characteristic lengths).
    fn larger(&self, (position, orientation): (f64, f64)) -> f64 {
        (position / self.reach).max(orientation)
    }

    /// Errors of a configuration, which is clamped to the limits (m, rad).
    fn errors(&mut self, q: &mut [f64; 6], target: &Pose) -> (f64, f64) {
        for (i, &c) in self.coordinates.iter().enumerate() {
            q[i] = clamp(q[i], self.lower[i], self.upper[i]);
            self.q[c] = q[i];
        }
        let pose = self.chain.set(&self.q);
        let turned = pose.rotation.matrix() - target.rotation.matrix();
        let square: f64 = turned.cols.iter().map(|c| c.dot(*c)).sum();
        // |R - 1| = 2 sqrt 2 sin(angle / 2)
        let half = (square / 8.0).sqrt().min(1.0);
        let half = if half < 1e-6 { half } else { half.asin() };
        ((pose.translation - target.translation).norm(), 2.0 * half)
    }

    /// One Newton step from the configuration evaluated last; free joints are clamped.
    fn refine(&mut self, q: &mut [f64; 6], free: &[bool; 6], target: &Pose) {
        self.chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut self.jacobian);
        let scaled =
            |twist: Twist| Twist { linear: twist.linear * (1.0 / self.reach), ..twist }.to_array();
        let of_chain = self.chain.coordinates();
        for (i, c) in self.coordinates.iter().enumerate() {
            let column = self.jacobian.column(of_chain.partition_point(|x| x < c));
            let mut six = [0.0; 6];
            six.copy_from_slice(&column[..6]);
            self.a[6 * i..6 * i + 6].copy_from_slice(&scaled(Twist::from_array(six)));
        }
        let e = scaled(self.chain.pose().error_to(*target));
        let size: f64 = self.a.iter().map(|x| x * x).sum();
        let mut d = [0.0; 6];
        let problem = DampedProblem { a: &self.a, e: &e, clamped: free, damping: DAMPING * size };
        if self.damped.solve(problem, &mut d) {
            q.iter_mut().zip(d).for_each(|(q, d)| *q += d);
        }
    }
}

/// The angle wrapped by full turns to the value closest to `near` within the limits; clamped if it
/// exceeds a limit by rounding. `None` outside.
fn turned(angle: f64, near: f64, lower: f64, upper: f64) -> Option<f64> {
    let mut q = nearest_turn(angle, near);
    if q > upper {
        q -= TAU * ((q - upper - ANALYTIC_AT_LIMIT) / TAU).ceil();
    } else if q < lower {
        q += TAU * ((lower - q - ANALYTIC_AT_LIMIT) / TAU).ceil();
    }
    (q >= lower - ANALYTIC_AT_LIMIT && q <= upper + ANALYTIC_AT_LIMIT).then_some(q)
}
