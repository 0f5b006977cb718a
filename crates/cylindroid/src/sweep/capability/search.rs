//! Inverse kinematics for all orientations of the tool at one point.
//!
//! Method   arms with a closed form: all solutions of each orientation; of seven joints for values of
//!          the locked joint, evenly spread over its range; where any roll will do, for [`ROLLS`] of
//!          them. Then the numerical solver, from the
//!          solutions of orientations nearby, again from those that it finds. Without a closed form it
//!          begins at random configurations, if one of them leads to the point with any orientation
//! Units    m, rad; tolerances of inverse kinematics, that of positions times the characteristic length
//! Valid    what is reached is verified by forward kinematics, within the limits. What is not reached
//!          is proven by an exact closed form of six joints and by the length of the chain; of seven
//!          joints branches of solutions shorter than [`STEP`] may be missed, and without a closed
//!          form any
//! Why so   the configurations of other points would be good initial guesses too, but then a point
//!          would depend on those before it, and no part could be computed alone
//! Checked  tests/sweep/capability.rs

use std::f64::consts::{PI, TAU};

use super::grid::{VoxelGrid, Voxels};
use super::orientations::Orientations;
use crate::error::Result;
use crate::ik::{Analytic, Goal, IkOptions, Solver};
use crate::kinematics::EndEffector;
use crate::model::{CoordinateKind, Dimension, Mechanism};
use crate::spatial::{Pose, Rotation, Vec3};
use crate::task::Task;
use crate::tolerance::IK_POSITION;

/// Step of the locked joint of seven (rad; of a slide, lengths).
const STEP: f64 = 0.1;
/// Random configurations for an orientation, without a closed form: as many for all together, but so
/// many at least and at most for each.
const STARTS: usize = 512;
const STARTS_OF_EACH: [usize; 2] = [8, 64];
/// The same for a point with any orientation.
const STARTS_OF_POINT: usize = 64;
/// Rolls of the closed form where any will do.
const ROLLS: usize = 36;
/// Between the seeds of two points: any odd number but the step of the generator.
const SEEDS: u64 = 0xf2fe_942b_f81f_3c6f;
/// Initial guesses from other orientations for each.
const TRIES: u8 = 3;

/// The solvers of a map, for one thread.
#[derive(Debug, Clone)]
pub(in super::super) struct Search {
    pub(super) voxels: Voxels,
    pub(super) orientations: Orientations,
    end_effector: EndEffector,
    task: Task,
    closed_form: Option<ClosedForm>,
    solver: Solver,
    /// For the point alone.
    of_point: Solver,
    position: Task,
    n: usize,
}

/// The closed form, with the values of its locked joint.
#[derive(Debug, Clone)]
struct ClosedForm {
    analytic: Analytic,
    /// The middle of all limits: of full turns, solutions have those nearest.
    start: Vec<f64>,
    locked: Option<(usize, Vec<f64>)>,
    /// Rotations about the approach direction, the first of which is none.
    rolls: Vec<Rotation>,
}

/// What is reached at a point.
#[derive(Debug, Clone)]
pub(super) struct Reached {
    /// Of each orientation.
    pub(super) is_reached: Vec<bool>,
    /// A solution of each that is reached, n numbers.
    first: Vec<f64>,
    /// True for those that have no other solutions than the ones found.
    is_decided: Vec<bool>,
}

impl Search {
    pub(in super::super) fn new(
        mechanism: &Mechanism,
        end_effector: EndEffector,
        (voxels, length): (Voxels, f64),
    ) -> Result<Self> {
        let task = voxels.task(mechanism, end_effector)?;
        let count = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
        let (directions, rolls) = (count(voxels.grid.directions), count(voxels.grid.rolls));
        let is_planar = mechanism.dimension() == Dimension::Planar;
        let orientations = match is_planar {
            true => Orientations::in_plane(directions),
            false => Orientations::in_space(directions, rolls),
        };
        let mut position = Task::POSITION;
        position.components[2] = !is_planar;
        let start = middle(mechanism);
        let options = IkOptions {
            position_tolerance: IK_POSITION * length,
            initial_guess: Some(start.clone()),
            length: Some(length),
            ..IkOptions::default()
        };
        let of_task = |task: Task| {
            let goal = Goal::frame(end_effector, task, Pose::IDENTITY);
            Solver::new(mechanism, &[goal], &options)
        };
        let (solver, of_point) = (of_task(task)?, of_task(position)?);
        let rolls = if task == Task::POINTING { ROLLS } else { 1 };
        let closed_form = match task == Task::POINTING {
            true => ClosedForm::of(mechanism, &of_task(Task::POSE)?, start, (length, rolls)),
            false => ClosedForm::of(mechanism, &solver, start, (length, rolls)),
        };
        let n = mechanism.n();
        Ok(Self {
            voxels,
            orientations,
            end_effector,
            task,
            closed_form,
            solver,
            of_point,
            position,
            n,
        })
    }

    pub(in super::super) const fn grid(&self) -> &VoxelGrid {
        &self.voxels.grid
    }

    /// Memory for the results of a point.
    pub(super) fn memory(&self) -> Reached {
        let count = self.orientations.all.len();
        Reached {
            is_reached: vec![false; count],
            first: vec![0.0; count * self.n],
            is_decided: vec![false; count],
        }
    }

    /// The pose of an orientation at a point, in world axes.
    fn pose(&self, point: Vec3, orientation: usize) -> Pose {
        let rotation = self.orientations.all[orientation];
        self.voxels.grid.world_from_grid * Pose { rotation, translation: point }
    }

    fn goal(&self, point: Vec3, orientation: usize) -> [Goal; 1] {
        [Goal::frame(self.end_effector, self.task, self.pose(point, orientation))]
    }

    /// The orientations that are reached at the point of a row. With `all`, `each` sees every solution
    /// found, otherwise the search goes on to the next orientation after the first.
    pub(super) fn run(
        &mut self,
        row: u64,
        all: bool,
        found: &mut Reached,
        mut each: impl FnMut(&[f64]) -> Result<()>,
    ) -> Result<()> {
        let point = self.voxels.point(row);
        found.is_reached.fill(false);
        found.is_decided.fill(false);
        let goals = self.goal(point, 0);
        if self.solver.is_out_of_reach(&goals)? {
            return Ok(());
        }
        let mut q = self.start().to_vec();
        if self.closed_form.is_some() {
            self.run_closed_form(point, all, found, &mut each)?;
        } else if !self.run_point(row, &mut q)? {
            return Ok(());
        }
        let mut tries = vec![0; found.is_reached.len()];
        let mut next: Vec<usize> =
            (0..found.is_reached.len()).filter(|&k| found.is_reached[k]).collect();
        self.spread(point, &mut next, (found, &mut tries), &mut each)?;
        if self.closed_form.is_some() {
            return Ok(());
        }
        let of_point = q.clone();
        let [least, most] = STARTS_OF_EACH;
        let starts = (STARTS / found.is_reached.len()).clamp(least, most);
        for k in 0..found.is_reached.len() {
            if found.is_reached[k] && !all {
                continue;
            }
            let goals = self.goal(point, k);
            // Other starts at each point: none is missed in a whole region.
            let mut random = row.wrapping_mul(SEEDS).wrapping_add(k as u64);
            for i in 0..=starts {
                q.copy_from_slice(&of_point);
                if i > 0 {
                    self.solver.random_configuration(&mut q, &mut random);
                }
                if self.solver.attempt(&goals, &mut q)? {
                    each(&q)?;
                    if !found.is_reached[k] {
                        found.set(k, &q);
                        next.push(k);
                    }
                    if !all {
                        break;
                    }
                }
            }
            self.spread(point, &mut next, (found, &mut tries), &mut each)?;
        }
        Ok(())
    }

    fn run_closed_form(
        &mut self,
        point: Vec3,
        all: bool,
        found: &mut Reached,
        each: &mut impl FnMut(&[f64]) -> Result<()>,
    ) -> Result<()> {
        let Some(mut own) = self.closed_form.take() else { return Ok(()) };
        let places = own.analytic.coordinates();
        let values = match &own.locked {
            None => vec![None],
            Some((c, values)) => values.iter().map(|x| Some((*c, *x))).collect(),
        };
        let mut q = own.start.clone();
        for value in values {
            if let Some((c, x)) = value {
                own.start[c] = x;
                q[c] = x;
            }
            for k in 0..found.is_reached.len() {
                if found.is_reached[k] && !all {
                    continue;
                }
                let pose = self.pose(point, k);
                let mut is_open =
                    value.is_some() || own.rolls.len() > 1 || !own.analytic.is_exact();
                for roll in &own.rolls {
                    let target = Pose { rotation: pose.rotation * *roll, ..pose };
                    let solutions = own.analytic.solve(target, &own.start)?;
                    for solution in solutions.iter() {
                        for (c, x) in places.into_iter().zip(solution.q) {
                            q[c] = x;
                        }
                        if all {
                            each(&q)?;
                        }
                        if !found.is_reached[k] {
                            found.set(k, &q);
                        }
                    }
                    is_open |= solutions.is_open();
                    if found.is_reached[k] && !all {
                        break;
                    }
                }
                found.is_decided[k] = !is_open;
            }
        }
        self.closed_form = Some(own);
        Ok(())
    }

    /// True if the point is reached with any orientation; `q` reaches it then.
    fn run_point(&mut self, row: u64, q: &mut [f64]) -> Result<bool> {
        let point = self.voxels.point(row);
        let goals = [Goal::frame(self.end_effector, self.position, self.pose(point, 0))];
        let mut random = row.wrapping_mul(SEEDS);
        for i in 0..STARTS_OF_POINT {
            if i > 0 {
                q.copy_from_slice(self.start());
                self.of_point.random_configuration(q, &mut random);
            }
            if self.of_point.attempt(&goals, q)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Goes on from the solutions of `next` to orientations nearby, and from theirs.
    fn spread(
        &mut self,
        point: Vec3,
        next: &mut Vec<usize>,
        (found, tries): (&mut Reached, &mut [u8]),
        each: &mut impl FnMut(&[f64]) -> Result<()>,
    ) -> Result<()> {
        let mut q = vec![0.0; self.n];
        let mut done = 0;
        while let Some(&from) = next.get(done) {
            done += 1;
            for i in 0..self.orientations.neighbours[from].len() {
                let k = self.orientations.neighbours[from][i];
                if found.is_reached[k] || found.is_decided[k] || tries[k] == TRIES {
                    continue;
                }
                tries[k] += 1;
                q.copy_from_slice(found.solution(from, self.n));
                let goals = self.goal(point, k);
                if self.solver.attempt(&goals, &mut q)? {
                    each(&q)?;
                    found.set(k, &q);
                    next.push(k);
                }
            }
        }
        next.clear();
        Ok(())
    }

    fn start(&self) -> &[f64] {
        self.solver.initial_guess()
    }
}

impl Reached {
    fn set(&mut self, orientation: usize, q: &[f64]) {
        self.is_reached[orientation] = true;
        self.first[orientation * q.len()..][..q.len()].copy_from_slice(q);
    }

    fn solution(&self, orientation: usize, n: usize) -> &[f64] {
        &self.first[orientation * n..][..n]
    }
}

impl ClosedForm {
    fn of(
        mechanism: &Mechanism,
        solver: &Solver,
        start: Vec<f64>,
        (length, rolls): (f64, usize),
    ) -> Option<Self> {
        let analytic = solver.analytic()?.clone();
        let locked = match analytic.locked() {
            [] => None,
            [c] => Some((*c, values(mechanism, *c, length)?)),
            _ => return None,
        };
        let roll = |r: usize| Rotation::about_z(TAU * r as f64 / rolls as f64);
        Some(Self { analytic, start, locked, rolls: (0..rolls).map(roll).collect() })
    }
}

/// Values of a joint over its range, each far from those before it; `None` for a slide without limits.
fn values(mechanism: &Mechanism, c: usize, length: f64) -> Option<Vec<f64>> {
    let coordinate = &mechanism.coordinates()[c];
    let (lower, upper) = (coordinate.limits.lower, coordinate.limits.upper);
    let (from, width, step) = match coordinate.kind {
        CoordinateKind::Angle if upper - lower < TAU => (lower, upper - lower, STEP),
        CoordinateKind::Angle => {
            let middle = 0.5 * (lower + upper);
            (if middle.is_finite() { middle - PI } else { -PI }, TAU, STEP)
        }
        CoordinateKind::Length if (upper - lower).is_finite() => {
            (lower, upper - lower, STEP * length)
        }
        _ => return None,
    };
    let steps = (width / step).ceil().max(1.0).min(1e4);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 10 000")]
    let count = steps as usize;
    // The golden ratio of all steps, which leaves none out.
    let mut stride = (count * 5 / 8).max(1);
    while greatest_common_divisor(stride, count) > 1 {
        stride += 1;
    }
    let value = |i: usize| from + width * ((i * stride % count) as f64 + 0.5) / steps;
    Some((0..count).map(value).collect())
}

fn greatest_common_divisor(mut a: usize, mut b: usize) -> usize {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The middle of the limits; home where there are none.
fn middle(mechanism: &Mechanism) -> Vec<f64> {
    let middle = |(c, home): (&crate::model::Coordinate, &f64)| {
        let middle = 0.5 * (c.limits.lower + c.limits.upper);
        if middle.is_finite() { middle } else { *home }
    };
    mechanism.coordinates().iter().zip(mechanism.home()).map(middle).collect()
}
