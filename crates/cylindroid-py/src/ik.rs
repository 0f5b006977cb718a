//! Inverse kinematics.

use cylindroid::Pose;
use cylindroid::control::Task;
use cylindroid::ik::{Budget, Goal, IkOptions, Solution, Solver};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Many, Numbers, Rows};
use crate::error::{Failure, Result};
use crate::mechanism::PyMechanism;
use crate::options;
use crate::table::{self, Table};

/// What came of a search for a configuration; of several targets everything has their axis first.
///
/// Attributes
/// ----------
/// success : bool or ndarray of bool, (N,)
///     True if the target is reached within tolerance, checked by forward kinematics.
/// q : ndarray, (n,) or (N, n)
///     The configuration, within the limits; without success the nearest that was found.
/// position_error, orientation_error : float or ndarray, (N,)
///     Of the components that matter (m, rad).
/// iterations, attempts : int or ndarray of int, (N,)
/// out_of_reach : bool or ndarray of bool, (N,)
///     True where it is proved that nothing reaches: the target is farther from the first joint
///     than the chain is long. No success alone proves nothing.
#[pyclass(frozen, name = "Solution", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySolution {
    inner: Many<Solution>,
    n: usize,
}

table::shown!(PySolution);

impl PySolution {
    fn table(&self) -> Table {
        let Many::One(s) = &self.inner else {
            let all = self.inner.as_slice();
            let mut table = Table::new(&format!("Solutions for {} targets", all.len()));
            table.row("reached", all.iter().filter(|s| s.success).count().to_string());
            return table;
        };
        let mut table = Table::new("Solution");
        table.row("success", if s.success { "yes" } else { "no" });
        if let Some((distance, length)) = s.out_of_reach {
            let (distance, length) = (table::number(distance), table::number(length));
            table.row("out of reach", format!("{distance} m away, the arm is {length} m long"));
        }
        let errors = format!("{:.1e} m, {:.1e} rad", s.position_error, s.orientation_error);
        table.row("errors", errors);
        table.row("iterations", format!("{} in {} attempts", s.iterations, s.attempts));
        table.row("q", table::list(&s.q));
        table
    }
}

#[pymethods]
impl PySolution {
    #[getter]
    fn success<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.success)
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all = self.inner.as_slice().iter().map(|s| &s.q);
        arrays::rows(py, self.inner.count(), self.n, all)
    }

    #[getter]
    fn position_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.position_error)
    }

    #[getter]
    fn orientation_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.orientation_error)
    }

    #[getter]
    fn iterations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.iterations as i64)
    }

    #[getter]
    fn attempts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.attempts as i64)
    }

    #[getter]
    fn out_of_reach<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.out_of_reach.is_some())
    }
}

/// One pose or a stack of them.
fn poses(target: &Numbers<'_>) -> Result<Many<Pose>> {
    let [_, 4, 4] = *target.shape() else { return Ok(Many::One(target.pose("target")?)) };
    let rows = target.values().as_chunks::<4>().0;
    let one = |[a, b, c, d]: &[[f64; 4]; 4]| Pose::from_matrix([*a, *b, *c, *d]);
    let all = rows.as_chunks::<4>().0.iter().map(one);
    Ok(Many::All(all.collect::<cylindroid::Result<_>>()?))
}

/// What both searches are told.
struct Search<'a, 'py> {
    frame: Option<&'a str>,
    tool: Option<Numbers<'py>>,
    task: Option<&'a str>,
    task_axes: Option<&'a str>,
    fixed: Option<Vec<String>>,
    tolerance_position: f64,
    tolerance_orientation: f64,
    seed: u64,
    iterations: usize,
}

impl Search<'_, '_> {
    /// Options, and a goal whose target is still to come.
    fn apply(&self, mechanism: &PyMechanism) -> Result<(IkOptions, Goal)> {
        let options = IkOptions {
            position_tolerance: self.tolerance_position,
            orientation_tolerance: self.tolerance_orientation,
            fixed: mechanism.places(self.fixed.as_deref().unwrap_or_default())?,
            seed: self.seed,
            budget: Budget { iterations: self.iterations, time: None },
            ..IkOptions::default()
        };
        let goal = Goal {
            end_effector: mechanism.end_effector(self.frame, self.tool.as_ref())?,
            target: Pose::IDENTITY,
            task: options::task(&mechanism.inner, self.task, self.task_axes, Task::POSE)?,
        };
        Ok((options, goal))
    }
}

#[pymethods]
impl PyMechanism {
    /// A configuration that puts a frame at a target, within all limits.
    ///
    /// Attempts start at `q0`, then at postures drawn within the limits, until one reaches. The
    /// same seed gives the same answer.
    ///
    /// Parameters
    /// ----------
    /// target : array_like, (4, 4) or (N, 4, 4)
    ///     `world_from_tool` as it should be (m).
    /// frame : str, optional
    ///     Default: `tool`.
    /// q0 : array_like, (n,) or (N, n), optional
    ///     Where to start. Default: home.
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    /// task, task_axes : str, optional
    ///     The components that matter, as of `Servo`. Default: the pose.
    /// nearest : bool
    ///     Prefer the answer nearest to `q0` over the one found first.
    /// fixed : list of str, optional
    ///     Coordinates that keep the values of `q0`.
    /// tolerance_position, tolerance_orientation : float
    ///     Largest errors of an answer (m, rad).
    /// seed : int
    ///     Of the postures that are drawn.
    /// iterations : int
    ///     Steps of all attempts, when to give up.
    ///
    /// Returns
    /// -------
    /// Solution
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    /// ModelError
    ///     For a mechanism with loops.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> arm = cy.load("ur5e")
    /// >>> target = arm.fk([0.3, -1.2, 1.1, -0.4, 0.9, 0.2])
    /// >>> found = arm.ik(target)
    /// >>> found.success, bool(abs(arm.fk(found.q) - target).max() < 1e-5)
    /// (True, True)
    #[pyo3(signature = (target, frame = None, q0 = None, *, tool = None, task = None,
        task_axes = None, nearest = false, fixed = None, tolerance_position = 1e-6,
        tolerance_orientation = 1e-6, seed = 0, iterations = 20000))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn ik(
        &self,
        py: Python<'_>,
        target: Numbers<'_>,
        frame: Option<&str>,
        q0: Option<Numbers<'_>>,
        tool: Option<Numbers<'_>>,
        task: Option<&str>,
        task_axes: Option<&str>,
        nearest: bool,
        fixed: Option<Vec<String>>,
        tolerance_position: f64,
        tolerance_orientation: f64,
        seed: u64,
        iterations: usize,
    ) -> Result<PySolution> {
        let robot = &self.inner;
        let search = Search {
            frame,
            tool,
            task,
            task_axes,
            fixed,
            tolerance_position,
            tolerance_orientation,
            seed,
            iterations,
        };
        let (mut options, goal) = search.apply(self)?;
        options.nearest = nearest;
        let starts = q0.as_ref().map(|q0| Rows::of(robot, "q0", q0)).transpose()?;
        let targets = poses(&target)?;
        if let (Some(count), targets) = (starts.and_then(|s| s.count), targets.count())
            && targets != Some(count)
        {
            let reason = "give one, or as many as targets";
            return Err(Failure::option("q0", format!("{count} starts"), reason));
        }
        let inner = py.detach(|| {
            let mut solver = Solver::new(robot, &[goal], &options)?;
            let mut i = 0;
            targets.try_map(|&target| {
                if let Some(starts) = &starts {
                    solver.start_at(starts.row(if starts.count.is_some() { i } else { 0 }))?;
                }
                i += 1;
                solver.solve(&[Goal { target, ..goal }])
            })
        })?;
        Ok(PySolution { inner, n: robot.n() })
    }

    /// Several configurations that put a frame at a target, the nearest to `q0` first.
    ///
    /// Parameters
    /// ----------
    /// target : array_like, (4, 4)
    /// count : int
    ///     At most so many. Of arms with more joints than the task needs there are infinitely
    ///     many: these are some.
    /// frame, q0, tool, task, task_axes, fixed, tolerance_position, tolerance_orientation
    ///     As `ik`.
    /// seed, iterations
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
    #[pyo3(signature = (target, count = 8, frame = None, q0 = None, *, tool = None, task = None,
        task_axes = None, fixed = None, tolerance_position = 1e-6, tolerance_orientation = 1e-6,
        seed = 0, iterations = 20000))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn ik_all<'py>(
        &self,
        py: Python<'py>,
        target: Numbers<'py>,
        count: usize,
        frame: Option<&str>,
        q0: Option<Numbers<'py>>,
        tool: Option<Numbers<'py>>,
        task: Option<&str>,
        task_axes: Option<&str>,
        fixed: Option<Vec<String>>,
        tolerance_position: f64,
        tolerance_orientation: f64,
        seed: u64,
        iterations: usize,
    ) -> Result<Array<'py>> {
        let robot = &self.inner;
        let search = Search {
            frame,
            tool,
            task,
            task_axes,
            fixed,
            tolerance_position,
            tolerance_orientation,
            seed,
            iterations,
        };
        let (mut options, goal) = search.apply(self)?;
        options.start = q0.as_ref().map(|q| q.vector("q0").map(<[f64]>::to_vec)).transpose()?;
        let goals = [Goal { target: target.pose("target")?, ..goal }];
        let found =
            py.detach(|| cylindroid::ik::solve_several(robot, &goals, &options, count.max(1)))?;
        arrays::rows(py, Some(found.len()), robot.n(), found.iter().map(|s| &s.q))
    }
}
