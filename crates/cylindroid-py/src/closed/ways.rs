//! All ways in which loops close, and the way from one configuration to another.

use cylindroid::closure::{FollowOptions, Followed, ModeOptions, PathEnd, assembly_modes, follow};
use pyo3::prelude::*;

use super::PyAssembly;
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;
use crate::mechanism::PyMechanism;
use crate::screws::PyScrew;
use crate::table;

/// The ways in which loops close that were found; there may be others.
///
/// Attributes
/// ----------
/// modes : list of Assembly
///     Nearest to the guess first.
/// found : list of int
///     How many starts led to each.
/// continuum : list of int
///     Degrees of freedom that the held coordinates leave at each: 0 for an isolated assembly.
/// starts, closed : int
///     Starts, and those from which the loops closed.
/// chance_of_more : float
///     Estimate of the chance that another start which closes finds a new mode.
#[pyclass(frozen, name = "AssemblyModes", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyAssemblyModes {
    inner: cylindroid::closure::AssemblyModes,
    names: Vec<String>,
}

#[pymethods]
impl PyAssemblyModes {
    #[getter]
    fn modes(&self) -> Vec<PyAssembly> {
        self.inner.modes.iter().map(|m| PyAssembly::new(&m.assembly, &self.names)).collect()
    }

    #[getter]
    fn found(&self) -> Vec<usize> {
        self.inner.modes.iter().map(|m| m.found).collect()
    }

    #[getter]
    fn continuum(&self) -> Vec<usize> {
        self.inner.modes.iter().map(|m| m.continuum).collect()
    }

    #[getter]
    fn starts(&self) -> usize {
        self.inner.starts
    }

    #[getter]
    fn closed(&self) -> usize {
        self.inner.closed
    }

    #[getter]
    fn chance_of_more(&self) -> f64 {
        self.inner.chance_of_more()
    }

    fn __len__(&self) -> usize {
        self.inner.modes.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<AssemblyModes: {} found from {} starts, chance of more {}>",
            self.inner.modes.len(),
            self.inner.starts,
            table::number(self.inner.chance_of_more())
        )
    }
}

/// A way of a mechanism with loops, all of them closed on it.
///
/// Attributes
/// ----------
/// reached : bool
/// end : str
///     'reached', 'singular', 'limit', 'open', 'contradiction' or 'lost'.
/// q : ndarray, (n,)
///     The last configuration.
/// share : float
///     How far it got, 0 to 1.
/// path : ndarray, (S, n)
///     All configurations on the way.
/// shares, distances : ndarray, (S,)
///     Of the way, and to the next singularity.
/// screw : Screw or None
///     The motion of the reference frame that a singularity would gain.
#[pyclass(frozen, name = "Followed", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyFollowed {
    inner: Followed,
}

#[pymethods]
impl PyFollowed {
    #[getter]
    fn reached(&self) -> bool {
        self.inner.end == PathEnd::Reached
    }

    #[getter]
    fn end(&self) -> String {
        self.inner.end.to_string()
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.q)
    }

    #[getter]
    fn share(&self) -> f64 {
        self.inner.share
    }

    #[getter]
    fn path<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let n = self.inner.q.len();
        arrays::written(py, Some(self.inner.path.len()), &[n], |out| {
            for (p, out) in self.inner.path.iter().zip(out.chunks_exact_mut(n.max(1))) {
                out.copy_from_slice(&p.q);
            }
        })
    }

    #[getter]
    fn shares<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.inner.path.iter().map(|p| p.share).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.inner.path.iter().map(|p| p.distance).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn screw(&self) -> Option<PyScrew> {
        match &self.inner.end {
            PathEnd::Singular(singular) => singular.screw.as_ref().map(PyScrew::from),
            _ => None,
        }
    }

    fn __repr__(&self) -> String {
        let share = table::number(100.0 * self.inner.share);
        format!("<Followed: {}, {share} % of the way>", self.inner.end)
    }
}

#[pymethods]
impl PyMechanism {
    /// The ways in which loops close with some coordinates held, from many starts.
    ///
    /// Parameters
    /// ----------
    /// guess : array_like, (n,), optional
    ///     Default: home.
    /// hold : list of str, optional
    ///     Coordinates that keep the values of the guess.
    /// starts : int
    /// seed : int
    ///     The same seed gives the same starts.
    ///
    /// Returns
    /// -------
    /// AssemblyModes
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> linkage = cy.load("four-bar")
    /// >>> len(linkage.assembly_modes([0.3, 0, 0], hold=linkage.joint_names[:1]))
    /// 2
    #[pyo3(signature = (guess = None, hold = None, starts = 64, seed = 0))]
    fn assembly_modes(
        &self,
        py: Python<'_>,
        guess: Option<Numbers<'_>>,
        hold: Option<Vec<String>>,
        starts: usize,
        seed: u64,
    ) -> Result<PyAssemblyModes> {
        let m = &self.inner;
        let guess = match &guess {
            None => m.home(),
            Some(guess) => guess.vector("guess")?,
        };
        let held = self.places(&hold.unwrap_or_default())?;
        let options = ModeOptions { starts, seed };
        let inner = py.detach(|| assembly_modes(m, guess, &held, options))?;
        let names = m.coordinates().iter().map(|c| c.name.clone()).collect();
        Ok(PyAssemblyModes { inner, names })
    }

    /// Moves some coordinates to their goal on one branch, the others following the loops, and
    /// stops before singularities and limits.
    ///
    /// Parameters
    /// ----------
    /// start : array_like, (n,)
    /// goal : dict of float by str
    ///     Coordinates and where they go [rad or m].
    /// step : float
    ///     Largest change of any coordinate in a step [rad, or reaches].
    /// least_distance : float, optional
    ///     Least distance to a singularity, from 1e-5 to below 1.
    ///
    /// Returns
    /// -------
    /// Followed
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> linkage = cy.load("four-bar")
    /// >>> linkage.follow(linkage.home, {linkage.joint_names[0]: 0.2}).reached
    /// True
    #[pyo3(signature = (start, goal, step = 0.1, least_distance = None))]
    fn follow(
        &self,
        py: Python<'_>,
        start: Numbers<'_>,
        goal: std::collections::BTreeMap<String, f64>,
        step: f64,
        least_distance: Option<f64>,
    ) -> Result<PyFollowed> {
        let names: Vec<String> = goal.keys().cloned().collect();
        let held = self.places(&names)?;
        let goals: Vec<f64> = goal.values().copied().collect();
        let mut options = FollowOptions { step, ..FollowOptions::default() };
        options.least_distance = least_distance.unwrap_or(options.least_distance);
        let start = start.vector("start")?;
        let inner = py.detach(|| follow(&self.inner, start, &held, &goals, options))?;
        Ok(PyFollowed { inner })
    }
}
