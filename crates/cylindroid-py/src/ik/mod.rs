//! Inverse kinematics.

mod prepared;
mod search;
mod solution;

use cylindroid::Error;
use cylindroid::collision::CollisionModel;
use cylindroid::ik::{IkOptions, Solver, solve, solve_distinct};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use self::prepared::Kept;
use self::search::Search;
use crate::arrays::{self, Array, Many, Numbers};
use crate::collision::in_use;
use crate::coordinates::{Coordinates, Rows};
use crate::error::{Failure, Result, argument, count};
use crate::mechanism::PyMechanism;
use crate::tasks::{PyCollisionAvoidance, PyHalfSpace, PyMotionTask};

pub(crate) use prepared::Prepared;
pub(crate) use solution::PySolution;

/// The bodies of distances to keep, and the gap.
fn bodies(
    py: Python<'_>,
    collisions: Option<&PyCollisionAvoidance>,
) -> Result<Option<(CollisionModel, f64)>> {
    let bodies = |c: &PyCollisionAvoidance| match c.model.try_borrow(py) {
        Ok(model) => Ok((model.inner.clone(), c.gap)),
        Err(error) => Err(in_use(error)),
    };
    collisions.map(bodies).transpose()
}

/// Distances of bodies are kept by arms without loops only.
fn refuse_bodies(given: bool) -> Result<()> {
    if given {
        let reason = "distances of bodies are kept by arms without loops only";
        return Err(Failure::option("collisions", "with loops", reason));
    }
    Ok(())
}

#[pymethods]
impl PyMechanism {
    /// A configuration that puts a frame at a target, or reaches several goals, within all limits.
    ///
    /// For six revolute joints of which three axes intersect or are parallel, all solutions are
    /// computed in closed form and the one closest to `q0` is returned. Otherwise a numerical
    /// solver starts at `q0` and then at random configurations within the limits, until one reaches
    /// the target. The same seed gives the same solution.
    ///
    /// The loops of a closed chain are closed together with the target: one frame, of whose
    /// orientation all, two or no components are given; `ik_all` returns its working modes.
    ///
    /// Parameters
    /// ----------
    /// target : array_like, (4, 4) or (N, 4, 4), or dict of them by frame, optional
    ///     Desired `world_from_tool` (m); a dict gives several frames that must be reached
    ///     simultaneously. Optional with `tasks`.
    /// frame : str, optional
    ///     Default: `tool`, of a closed chain its reference.
    /// q0 : array_like, (n,) or (N, n), optional
    ///     Initial guess. Default: home.
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    /// task : str or dict of str to str, optional
    ///     The components that matter, as of `Servo`; a dict gives those of each frame. Default: the
    ///     pose.
    /// task_axes : str, optional
    ///     As of `Servo`.
    /// nearest : bool
    ///     Prefer the solution closest to `q0` over the one found first.
    /// weights : dict of str to float, optional
    ///     Factors of the errors of frames, for the configuration that is returned where not all can
    ///     be reached. Default: 1.
    /// tasks : sequence of MotionTask, optional
    ///     Further goals that a solution reaches: `FrameTask`, `RelativeFrameTask`,
    ///     `CenterOfMassTask`, `GazeTask`, with their weights; a `PostureTask` is a `posture`, a
    ///     `ManipulabilityTask` or `LimitAvoidanceTask` what is made largest. Gains, levels,
    ///     velocities and tolerances of tasks do not count.
    /// half_spaces : sequence of HalfSpace, optional
    ///     Half-spaces that tool points of a solution do not leave, to within `tolerance_position`;
    ///     see also `HalfSpace.inside_box`.
    /// posture : array_like, (n,), optional
    ///     Prefer the solution closest to this configuration. Default: no preference.
    /// maximise : str, optional
    ///     'manipulability' (Yoshikawa's measure of the frame and its task, lengths over the
    ///     characteristic length) or 'limit-avoidance' (joints towards the middles of their ranges):
    ///     the best of the maxima to which random restarts lead, by what the goals leave free. Default:
    ///     none. Serial arms only.
    /// collisions : CollisionAvoidance, optional
    ///     A solution keeps the gap between all watched bodies. Default: bodies do not count.
    /// fixed : list of str, optional
    ///     Coordinates that keep the values of `q0`.
    /// tolerance_position, tolerance_orientation : float
    ///     Tolerances of a solution (m, rad).
    /// seed : int
    ///     Seed for the random restarts.
    /// iterations : int
    ///     Iteration limit, over all restarts.
    ///
    /// Returns
    /// -------
    /// Solution
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///     Also for several goals of a closed chain.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> arm = cy.load("ur5e")
    /// >>> target = arm.fk([0.3, -1.2, 1.1, -0.4, 0.9, 0.2])
    /// >>> found = arm.ik(target)
    /// >>> found.success, bool(abs(arm.fk(found.q) - target).max() < 1e-5)
    /// (True, True)
    ///
    /// Two frames simultaneously, here the positions of a link and of the tool:
    ///
    /// >>> q = [0.3, -1.2, 1.1, -0.4, 0.9, 0.2]
    /// >>> both = {"link3": arm.fk(q, "link3"), arm.tool: arm.fk(q)}
    /// >>> arm.ik(both, task="position").success
    /// True
    /// >>> arm.ik(both, task={"link3": "z", arm.tool: "pose"}).success
    /// True
    ///
    /// The tool looks at a point, above a table:
    ///
    /// >>> table = cy.HalfSpace(arm.tool, point=[0, 0, 0.2], normal=[0, 0, 1])
    /// >>> arm.ik(tasks=[cy.GazeTask(arm.tool, [0.6, 0.2, 0.0])], half_spaces=[table]).success
    /// True
    ///
    /// The elbow where manipulability is largest:
    ///
    /// >>> panda = cy.load("panda")
    /// >>> target = panda.fk(panda.home)
    /// >>> best = panda.ik(target, maximise="manipulability")
    /// >>> best.success, best.criterion > 0.0
    /// (True, True)
    ///
    /// The working modes of a parallel robot, for a point of its platform:
    ///
    /// >>> import numpy as np
    /// >>> five_bar, target = cy.load("five-bar"), np.eye(4)
    /// >>> target[:2, 3] = 1.0, 1.5
    /// >>> five_bar.ik_all(target, task="x,y").shape
    /// (4, 4)
    #[pyo3(signature = (target = None, frame = None, q0 = None, *, tool = None, task = None,
        task_axes = None, nearest = false, weights = None, tasks = None, half_spaces = None,
        posture = None, maximise = None, collisions = None, fixed = None,
        tolerance_position = 1e-6, tolerance_orientation = 1e-6, seed = 0, iterations = 20000))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn ik(
        &self,
        py: Python<'_>,
        target: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        q0: Option<Coordinates<'_>>,
        tool: Option<Numbers<'_>>,
        task: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] task_axes: Option<&str>,
        #[pyo3(from_py_with = argument)] nearest: bool,
        #[pyo3(from_py_with = argument)] weights: Option<Bound<'_, PyDict>>,
        #[pyo3(from_py_with = argument)] tasks: Option<Vec<Py<PyMotionTask>>>,
        #[pyo3(from_py_with = argument)] half_spaces: Option<Vec<Py<PyHalfSpace>>>,
        posture: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] maximise: Option<&str>,
        #[pyo3(from_py_with = argument)] collisions: Option<PyRef<'_, PyCollisionAvoidance>>,
        #[pyo3(from_py_with = argument)] fixed: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] tolerance_position: f64,
        #[pyo3(from_py_with = argument)] tolerance_orientation: f64,
        #[pyo3(from_py_with = argument)] seed: u64,
        #[pyo3(from_py_with = count)] iterations: usize,
    ) -> Result<PySolution> {
        let robot = &self.inner;
        let search = Search {
            frame,
            tool,
            task,
            weights,
            task_axes,
            fixed,
            tasks,
            half_spaces,
            posture,
            maximise,
            tolerance_position,
            tolerance_orientation,
            seed,
            iterations,
        };
        let options = IkOptions { nearest, ..search.options(self)? };
        let bodies = bodies(py, collisions.as_deref())?;
        let starts = q0.as_ref().map(|q0| Rows::of(robot, "q0", q0)).transpose()?;
        let targets = search.targets(self, target.as_ref())?;
        if let Some(count) = starts.and_then(|s| s.count)
            && targets.count() != Some(count)
        {
            let reason = "give one, or as many as targets";
            return Err(Failure::option("q0", format!("{count} starts"), reason));
        }
        if robot.is_closed() {
            refuse_bodies(bodies.is_some())?;
            let solve_at = |i: usize| {
                let start = starts.as_ref().map(|s| s.row(if s.count.is_some() { i } else { 0 }));
                let initial_guess = start.map(<[f64]>::to_vec);
                solve(robot, &targets.at(i), &IkOptions { initial_guess, ..options.clone() })
            };
            let inner = py.detach(|| match targets.count() {
                None => solve_at(0).map(Many::One),
                Some(count) => {
                    (0..count).map(solve_at).collect::<cylindroid::Result<_>>().map(Many::All)
                }
            })?;
            return Ok(PySolution { inner, n: robot.n() });
        }
        let inner = py.detach(|| {
            let goals = &targets.goals;
            // Bodies may have moved since the last call.
            let is_kept = bodies.is_none();
            let mut own = match bodies {
                None => self.prepared.take(robot, goals, &options)?,
                Some((model, gap)) => {
                    let mut own = Kept::new(robot, goals, &options)?;
                    own.solver.avoid(model, gap)?;
                    own
                }
            };
            let mut solve = |i: usize| {
                if let Some(starts) = &starts {
                    let place = if starts.count.is_some() { i } else { 0 };
                    own.solver.set_initial_guess(starts.row(place))?;
                }
                own.solver.solve(&targets.at(i))
            };
            let found = match targets.count() {
                None => Many::One(solve(0)?),
                Some(count) => Many::All((0..count).map(solve).collect::<cylindroid::Result<_>>()?),
            };
            if is_kept {
                self.prepared.keep(own);
            }
            Ok::<_, Error>(found)
        })?;
        Ok(PySolution { inner, n: robot.n() })
    }

    /// Several configurations that put a frame at a target, the closest to `q0` first.
    ///
    /// Parameters
    /// ----------
    /// target : array_like, (4, 4), or dict of them by frame, optional
    ///     Optional with `tasks`.
    /// count : int
    ///     Maximum number of solutions. A redundant arm has infinitely many, of which some are
    ///     returned.
    /// frame, q0, tool, task, task_axes, weights, tasks, half_spaces, collisions, fixed
    ///     As `ik`.
    /// posture, maximise
    ///     As `ik`: the solution closest to the posture comes first, or the best one.
    /// tolerance_position, tolerance_orientation, seed, iterations
    ///     As `ik`.
    ///
    /// Returns
    /// -------
    /// ndarray, (K, n)
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///     As `ik`.
    #[pyo3(signature = (target = None, count = 8, frame = None, q0 = None, *, tool = None,
        task = None, task_axes = None, weights = None, tasks = None, half_spaces = None,
        posture = None, maximise = None, collisions = None, fixed = None,
        tolerance_position = 1e-6, tolerance_orientation = 1e-6, seed = 0, iterations = 20000))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn ik_all<'py>(
        &self,
        py: Python<'py>,
        target: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = count)] count: usize,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        q0: Option<Coordinates<'py>>,
        tool: Option<Numbers<'py>>,
        task: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = argument)] task_axes: Option<&str>,
        #[pyo3(from_py_with = argument)] weights: Option<Bound<'py, PyDict>>,
        #[pyo3(from_py_with = argument)] tasks: Option<Vec<Py<PyMotionTask>>>,
        #[pyo3(from_py_with = argument)] half_spaces: Option<Vec<Py<PyHalfSpace>>>,
        posture: Option<Coordinates<'py>>,
        #[pyo3(from_py_with = argument)] maximise: Option<&str>,
        #[pyo3(from_py_with = argument)] collisions: Option<PyRef<'py, PyCollisionAvoidance>>,
        #[pyo3(from_py_with = argument)] fixed: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] tolerance_position: f64,
        #[pyo3(from_py_with = argument)] tolerance_orientation: f64,
        #[pyo3(from_py_with = argument)] seed: u64,
        #[pyo3(from_py_with = count)] iterations: usize,
    ) -> Result<Array<'py>> {
        let robot = &self.inner;
        let search = Search {
            frame,
            tool,
            task,
            weights,
            task_axes,
            fixed,
            tasks,
            half_spaces,
            posture,
            maximise,
            tolerance_position,
            tolerance_orientation,
            seed,
            iterations,
        };
        let mut options = search.options(self)?;
        let bodies = bodies(py, collisions.as_deref())?;
        if let Some(q0) = &q0 {
            let q0 = q0.vector(robot, "q0")?;
            robot.check_q("q0", q0)?;
            options.initial_guess = Some(q0.to_vec());
        }
        let targets = search.targets(self, target.as_ref())?;
        if targets.count().is_some() {
            return Err(Failure::option("target", "a batch", "give one pose, (4, 4)"));
        }
        let goals = targets.at(0);
        if robot.is_closed() {
            refuse_bodies(bodies.is_some())?;
        }
        let found = py.detach(|| {
            if robot.is_closed() {
                return solve_distinct(robot, &goals, &options, count.max(1));
            }
            let mut solver = Solver::new(robot, &goals, &options)?;
            if let Some((model, gap)) = bodies {
                solver.avoid(model, gap)?;
            }
            solver.solve_distinct(&goals, count.max(1))
        })?;
        arrays::rows(py, Some(found.len()), robot.n(), found.iter().map(|s| &s.q))
    }
}
