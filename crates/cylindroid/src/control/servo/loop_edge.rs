//! The edge of the workspace of a closed chain: how the task bends along its actuated motions, and the
//! configuration of the nearest pose, where the drives must stop.
//!
//! Formula  C_ij = -e . dJ_j/dy_i, J = J_task M by differences along the columns of M: a motion y there is
//!          the one there with the nearest velocities of the actuated joints. q <- q + M y with y the
//!          least of |J y - e|^2 + y^T P(C) y within the position limits (`nearest_pose.rs`), loops
//!          closed after each step; halved while |e| grows
//! Shapes   M: rates x a, J: m x a, C: a x a
//! Units    scaled as in `task_space.rs`
//! Valid    components along world axes; drives with coordinates. There is no way where the search meets
//!          a type II singularity
//! Checked  tests/it/servo/closed_edges.rs

use super::approach;
use super::edge::time_to_nearest;
use super::loop_motions::LoopMotions;
use super::nearest_pose::{ARRIVED, HALVINGS, LONGEST, SHORT, STEPS};
use super::task_space::TaskSpace;
use crate::control::solver::active_set::{ActiveSet, Level, Precision};
use crate::control::solver::inequalities::Inequalities;
use crate::control::solver::saturation::{Curvature, KnownWay, NewtonStep};
use crate::error::Result;
use crate::kinematics::Chain;
use crate::linalg::{Matrix, dot};
use crate::model::{Limits, Mechanism};
use crate::spatial::Pose;
use crate::task::Task;

/// Largest change of a joint in a difference [rad, or lengths of the mechanism].
const DIFFERENCE: f64 = 1e-5;

/// The task and its limits.
#[derive(Clone, Copy)]
pub(super) struct LoopSurroundings<'a> {
    pub(super) task: Task,
    pub(super) limits: &'a [Limits],
    pub(super) dt: f64,
}

/// M and J at a configuration.
#[derive(Debug, Clone)]
struct Motions {
    all: Matrix,
    reduced: Matrix,
}

/// The configuration of the nearest pose, and workspace.
#[derive(Debug, Clone)]
pub(super) struct LoopEdge {
    loops: LoopMotions,
    chain: Chain,
    space: TaskSpace,
    /// Unit of the steps of each joint: 1 for angles, the length of the mechanism.
    sizes: Vec<f64>,
    is_actuated: Vec<bool>,
    /// At the present configuration of the servo, at that of the search, and beside one of them.
    present: Motions,
    searched: Motions,
    beside: Motions,
    task: Matrix,
    slopes: Vec<Matrix>,
    error: Vec<f64>,
    newton: NewtonStep,
    set: ActiveSet,
    level: Level,
    rest: Vec<f64>,
    change: Vec<f64>,
    moved: Vec<f64>,
    /// All coordinates: at the present configuration, of the nearest pose, and beside one of them.
    here: Vec<f64>,
    nearest: Vec<f64>,
    q: Vec<f64>,
    is_known: bool,
    /// True where the search met a type II singularity.
    is_blocked: bool,
    /// Squared error at the nearest pose.
    far: f64,
    /// Velocities of the drives and their ways to the nearest pose (scaled); zero for other joints.
    rates: Vec<f64>,
    way: Vec<f64>,
    way_of_motions: Vec<f64>,
    has_way: bool,
}

impl LoopEdge {
    /// For a task of m components.
    pub(super) fn new(
        mechanism: &Mechanism,
        loops: LoopMotions,
        chain: Chain,
        space: TaskSpace,
    ) -> Result<Self> {
        let (n, rates, a, m) =
            (mechanism.n(), loops.velocities(), loops.actuated, space.rows.len());
        let motions = || Motions { all: Matrix::zeros(rates, a), reduced: Matrix::zeros(m, a) };
        Ok(Self {
            sizes: (0..rates).map(|i| mechanism.unit_of(i)).collect(),
            is_actuated: loops.are_actuated(),
            present: motions(),
            searched: motions(),
            beside: motions(),
            task: Matrix::zeros(m, n),
            slopes: vec![Matrix::zeros(m, a); a],
            error: vec![0.0; m],
            newton: NewtonStep::new(m, a),
            set: ActiveSet::new(a, Inequalities::new(a, false, rates)),
            level: Level::new(a, a),
            rest: vec![0.0; a],
            change: vec![0.0; rates],
            moved: vec![0.0; rates],
            here: vec![0.0; n],
            nearest: vec![0.0; n],
            q: vec![0.0; n],
            is_known: false,
            is_blocked: false,
            far: 0.0,
            rates: vec![0.0; rates],
            way: vec![0.0; rates],
            way_of_motions: vec![0.0; a],
            has_way: false,
            loops,
            chain,
            space,
        })
    }

    /// True for a joint with a drive.
    pub(super) fn is_actuated(&self, rate: usize) -> bool {
        self.is_actuated[rate]
    }

    /// Forgets the last result.
    pub(super) const fn reset(&mut self) {
        self.is_known = false;
    }

    /// The error that is left at the nearest pose.
    pub(super) fn left(&self) -> f64 {
        self.far.sqrt()
    }

    /// Moves on towards the nearest pose from the present configuration `q`, at which M, J and the
    /// squared error are these; true once its way is found. Errors up to `met` are those of poses in
    /// reach: there it ends at once.
    pub(super) fn search(
        &mut self,
        (q, motions, reduced): (&[f64], &Matrix, &Matrix),
        target: Pose,
        (present, met): (f64, f64),
        around: LoopSurroundings<'_>,
    ) -> Result<bool> {
        self.here.copy_from_slice(q);
        self.present.all.as_mut_slice().copy_from_slice(motions.as_slice());
        self.present.reduced.as_mut_slice().copy_from_slice(reduced.as_slice());
        self.has_way = false;
        let mut far = f64::INFINITY;
        if self.is_known && self.loops.set_closed(&self.nearest)? {
            far = self.load_error(target, around.task);
        }
        // The servo has found a better one.
        if !(far <= present) {
            self.nearest.copy_from_slice(q);
            if !self.loops.set_closed(q)? {
                self.is_known = false;
                return Ok(false);
            }
            far = self.load_error(target, around.task);
        }
        self.is_known = true;
        self.is_blocked = false;
        let mut moved = f64::INFINITY;
        for _ in 0..STEPS {
            if moved <= SHORT || far <= met * met {
                break;
            }
            moved = self.advance(target, &mut far, around)?;
        }
        self.far = far;
        let mut left = 0.0_f64;
        self.way.fill(0.0);
        for (i, way) in self.way.iter_mut().enumerate().take(q.len()) {
            if self.is_actuated[i] {
                let change = self.nearest[i] - q[i];
                left = left.max(change.abs() / self.sizes[i]);
                *way = self.space.scaled_rate(i, change);
            }
        }
        for (j, y) in self.way_of_motions.iter_mut().enumerate() {
            *y = dot(self.present.all.column(j), &self.way);
        }
        self.has_way = !self.is_blocked && moved <= SHORT.max(ARRIVED * left);
        Ok(self.has_way)
    }

    /// One step; the largest change of a joint.
    fn advance(
        &mut self,
        target: Pose,
        far: &mut f64,
        around: LoopSurroundings<'_>,
    ) -> Result<f64> {
        let Self { loops, chain, space, task, searched, .. } = self;
        load(loops, (chain, space), task, searched)?;
        let error = std::mem::take(&mut self.error);
        self.load_slopes(false)?;
        self.curve(&error);
        self.error = error;
        self.newton.decompose(&self.searched.reduced, &[&self.error]);
        self.newton.rows_into(&mut self.level.rows);
        self.level.target.copy_from_slice(self.newton.right_side(0));
        for (i, limits) in around.limits.iter().enumerate() {
            let q = self.nearest.get(i).copied().unwrap_or(0.0);
            let scaled = |room: f64| match self.space.columns[i] {
                0.0 => 0.0,
                column => room / column,
            };
            let (motions, inequalities) = (&self.searched.all, &mut self.set.inequalities);
            inequalities.set_row(i, |j| motions[(i, j)]);
            inequalities.lower[i] = scaled((limits.lower - q).min(0.0));
            inequalities.upper[i] = scaled((limits.upper - q).max(0.0));
        }
        if !self.set.start(&self.rest) {
            return Ok(0.0);
        }
        self.set.least_residual(&mut self.level, Precision::STRAIGHT);
        self.searched.all.mul_vec_into(self.set.point(), &mut self.change);
        let mut most = 0.0_f64;
        for ((x, column), size) in self.change.iter_mut().zip(&self.space.columns).zip(&self.sizes)
        {
            *x *= column;
            most = most.max(x.abs() / size);
        }
        let mut share = if most > LONGEST { LONGEST / most } else { 1.0 };
        let mut is_regular = false;
        for _ in 0..HALVINGS {
            let all = self.rates.iter_mut().zip(&self.change).zip(&self.is_actuated);
            for ((out, x), is_actuated) in all {
                *out = if *is_actuated { share * x } else { 0.0 };
            }
            if self.loops.set_closed(&self.nearest)?
                && self.loops.follow(&self.rates, &mut self.moved)?
            {
                is_regular = true;
                let then = self.load_error(target, around.task);
                if then <= *far {
                    *far = then;
                    self.nearest.copy_from_slice(self.loops.q());
                    return Ok(share * most);
                }
            }
            share *= 0.5;
        }
        self.is_blocked |= !is_regular;
        self.loops.set_closed(&self.nearest)?;
        *far = self.load_error(target, around.task);
        Ok(0.0)
    }

    /// Evaluates the error at the configuration of the loops; its square.
    fn load_error(&mut self, target: Pose, task: Task) -> f64 {
        let pose = self.chain.set(self.loops.q());
        self.space.scale(task.seen(pose, pose.error_to(target)), &mut self.error);
        dot(&self.error, &self.error)
    }

    /// The derivatives of J along each motion, at the present configuration or at that of the search.
    fn load_slopes(&mut self, at_present: bool) -> Result<()> {
        let Self { loops, chain, space, task, present, searched, beside, q, is_actuated, .. } =
            self;
        let (base, from) =
            if at_present { (&*present, &self.here) } else { (&*searched, &self.nearest) };
        for (i, slope) in self.slopes.iter_mut().enumerate() {
            slope.as_mut_slice().fill(0.0);
            let change = &mut self.change;
            let mut most = 0.0_f64;
            for (x, ((motion, column), size)) in change
                .iter_mut()
                .zip(base.all.column(i).iter().zip(&space.columns).zip(&self.sizes))
            {
                *x = motion * column;
                most = most.max(x.abs() / size);
            }
            if most == 0.0 {
                continue;
            }
            let h = DIFFERENCE / most;
            q.copy_from_slice(from);
            let n = q.len();
            loops.mechanism().integrate_in_place(q, &change[..n], h);
            if !loops.set_closed(q)? {
                continue;
            }
            load(loops, (chain, space), task, beside)?;
            for j in 0..slope.cols() {
                let motion = base.all.column(j);
                for k in 0..slope.cols() {
                    let there = beside.all.column(k).iter().zip(&*is_actuated);
                    let along: f64 = there
                        .zip(motion)
                        .filter(|((_, is_actuated), _)| **is_actuated)
                        .map(|((a, _), b)| a * b)
                        .sum();
                    let column = beside.reduced.column(k);
                    slope.column_mut(j).iter_mut().zip(column).for_each(|(s, x)| *s += along * x);
                }
                let own = base.reduced.column(j);
                slope.column_mut(j).iter_mut().zip(own).for_each(|(s, x)| *s = (*s - x) / h);
            }
        }
        Ok(())
    }

    /// C of the derivatives for an error.
    fn curve(&mut self, left: &[f64]) {
        let Self { slopes, newton, .. } = self;
        curvature(slopes, left, &mut newton.curvature);
    }
}

/// `C_ij = - left . slope_ij`, symmetrised.
fn curvature(slopes: &[Matrix], left: &[f64], out: &mut Matrix) {
    for (i, slope) in slopes.iter().enumerate() {
        for j in 0..slope.cols() {
            out[(i, j)] = -dot(slope.column(j), left);
        }
    }
    for i in 0..out.rows() {
        for j in 0..i {
            let mean = 0.5 * (out[(i, j)] + out[(j, i)]);
            (out[(i, j)], out[(j, i)]) = (mean, mean);
        }
    }
}

/// M and J at the configuration of the loops, which is regular.
fn load(
    loops: &mut LoopMotions,
    (chain, space): (&mut Chain, &mut TaskSpace),
    task: &mut Matrix,
    out: &mut Motions,
) -> Result<()> {
    chain.set(loops.q());
    space.load(chain, task);
    loops.load(&mut out.all, |_| false)?;
    let n = loops.q().len();
    for j in 0..out.all.cols() {
        space.scale_rates(out.all.column_mut(j));
        task.mul_vec_into(&out.all.column(j)[..n], out.reduced.column_mut(j));
    }
    Ok(())
}

/// The curvature at the present configuration, once the way is found.
pub(super) struct LoopCurvature<'a> {
    pub(super) edge: &'a mut LoopEdge,
    pub(super) around: LoopSurroundings<'a>,
    /// Of a motion that goes straight to the nearest pose.
    pub(super) gain_of_way: Option<f64>,
}

impl Curvature for LoopCurvature<'_> {
    fn load(&mut self, left: &[f64], out: &mut Matrix) {
        match self.edge.load_slopes(true) {
            Ok(()) => curvature(&self.edge.slopes, left, out),
            Err(_) => out.as_mut_slice().fill(0.0),
        }
    }

    fn known_way(&self) -> Option<KnownWay<'_>> {
        let LoopEdge { has_way, way_of_motions: way, far, .. } = &*self.edge;
        has_way.then_some(KnownWay { way, far: *far })
    }

    fn gain_of_way(&self) -> Option<f64> {
        self.gain_of_way
    }

    fn share(&mut self, way: &[f64], motions: &[f64], gradient: &[f64]) -> f64 {
        let LoopSurroundings { limits, dt, .. } = self.around;
        let edge = &mut *self.edge;
        let (columns, is_actuated) = (&edge.space.columns, &edge.is_actuated);
        let drives_alone = |rates: &mut [f64]| {
            rates.iter_mut().zip(is_actuated).filter(|(_, a)| !**a).for_each(|(x, _)| *x = 0.0);
        };
        edge.present.all.mul_vec_into(motions, &mut edge.rates);
        drives_alone(&mut edge.rates);
        if edge.has_way {
            let along = (dot(gradient, &edge.way_of_motions), dot(gradient, motions));
            if let Some(time) = time_to_nearest((&edge.way, &edge.rates), along, columns, limits) {
                let way = edge.rates.iter().map(|r| time * r);
                return approach::scale(way, &edge.rates, columns, limits, dt);
            }
        }
        edge.present.all.mul_vec_into(way, &mut edge.way);
        drives_alone(&mut edge.way);
        approach::scale(edge.way.iter().copied(), &edge.rates, columns, limits, dt)
    }
}
