//! Manipulability: efficiencies of motion and force, polytopes.

use cylindroid::closure::{Motions, Unit, Units};
use cylindroid::linalg::{Hull, Interval};
use cylindroid::manipulability::{
    Direction, Goal, Gradient, Index, Manipulability, Measure, Metrics, Polytope, Spectrum,
    force_polytope, gradient, velocity_polytope,
};
use cylindroid::{Error, Matrix};
use pyo3::prelude::*;

use super::{PyConstraint, metric_of};
use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result};
use crate::table::{self, Table};

/// How well motion and force go from the driven joints to the object.
///
/// Attributes
/// ----------
/// kinematic : Spectrum
///     Motions of the object for rates of the driven joints: zeros are redundant motions, infinite
///     ones motions that the drives do not hold.
/// active_force : Spectrum
///     Forces exerted: wrenches for torques; zeros are internal torques.
/// passive_force : Spectrum
///     Forces resisted: infinite ones are wrenches that the structure holds.
/// metric : str
/// actuated, components : list of str
///     Names of the entries of directions.
#[pyclass(frozen, name = "Manipulability", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyManipulability {
    inner: Manipulability,
    name: String,
    metric: String,
    actuated: Vec<String>,
    components: Vec<String>,
}

/// The efficiencies of a kind.
///
/// Attributes
/// ----------
/// finite : ndarray, (k,)
///     Largest first: squares of output over input.
/// zeros, infinite : int
///     How many are zero and infinite, by kind, never by size.
/// directions : list of Direction
///     Of the finite ones.
/// zero_directions : ndarray, (zeros, a)
///     Rates (torques) that do nothing, as rows.
/// infinite_directions : ndarray, (infinite, d)
///     Twists (wrenches) without input, as rows.
/// semi_axes : ndarray, (d, k)
///     Of the ellipsoid of what comes out for an input of length one, longest first.
/// volume : float
///     Product of the roots of the finite efficiencies; of a serial arm Yoshikawa's index.
/// anisotropy : float or None
///     Largest over smallest finite efficiency.
#[pyclass(frozen, name = "Spectrum", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySpectrum {
    inner: Spectrum,
    what: &'static str,
}

/// A principal direction: together its parts have length one in the metrics.
///
/// Attributes
/// ----------
/// efficiency : float
/// joint : ndarray, (a,)
///     Rates (torques) of the driven joints.
/// object : ndarray, (d,)
///     The twist (wrench) that goes with them.
#[pyclass(frozen, name = "Direction", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyDirection {
    inner: Direction,
}

#[pymethods]
impl PyDirection {
    #[getter]
    fn efficiency(&self) -> f64 {
        self.inner.pair.efficiency()
    }

    #[getter]
    fn joint<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.joint)
    }

    #[getter]
    fn object<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.object)
    }

    fn __repr__(&self) -> String {
        format!(
            "Direction(efficiency={}, joint={}, object={})",
            table::number(self.inner.pair.efficiency()),
            table::list(&self.inner.joint),
            table::list(&self.inner.object)
        )
    }
}

#[pymethods]
impl PySpectrum {
    #[getter]
    fn finite<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.values())
    }

    #[getter]
    fn zeros(&self) -> usize {
        self.inner.zeros.cols()
    }

    #[getter]
    fn infinite(&self) -> usize {
        self.inner.infinite.cols()
    }

    #[getter]
    fn directions(&self) -> Vec<PyDirection> {
        self.inner.finite.iter().map(|d| PyDirection { inner: d.clone() }).collect()
    }

    #[getter]
    fn zero_directions<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.zeros)
    }

    #[getter]
    fn infinite_directions<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.infinite)
    }

    #[getter]
    fn semi_axes<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.semi_axes())
    }

    #[getter]
    fn volume(&self) -> f64 {
        self.inner.volume()
    }

    #[getter]
    fn anisotropy(&self) -> Option<f64> {
        self.inner.anisotropy()
    }

    fn __repr__(&self) -> String {
        format!("<{}: {}>", self.what, self.words())
    }
}

impl PySpectrum {
    fn words(&self) -> String {
        format!(
            "finite {}, {} zero, {} infinite",
            table::list(&self.inner.values()),
            self.inner.zeros.cols(),
            self.inner.infinite.cols()
        )
    }
}

impl PyManipulability {
    pub(super) fn of(
        py: Python<'_>,
        constraint: &PyConstraint,
        task: Option<&Bound<'_, PyAny>>,
        weights: [Option<&Numbers<'_>>; 4],
        metric: &str,
    ) -> Result<Self> {
        let (map, components) = match task {
            None => (None, constraint.component_names()),
            Some(task) => {
                let (map, names) = constraint.task(task)?;
                (Some(map), names)
            }
        };
        let metrics = metrics(constraint, map.as_ref(), weights, metric)?;
        let inner = py.detach(|| {
            let relation = Motions::of(&constraint.inner).relation();
            let relation = match &map {
                None => relation,
                Some(map) => relation.task(map)?,
            };
            Manipulability::of(&relation, &metrics)
        })?;
        Ok(Self {
            inner,
            name: constraint.name(),
            metric: metric.to_owned(),
            actuated: constraint.actuated.clone(),
            components,
        })
    }

    fn spectra(&self) -> [PySpectrum; 3] {
        [
            PySpectrum { inner: self.inner.kinematic.clone(), what: "kinematic" },
            PySpectrum { inner: self.inner.active_force(), what: "active force" },
            PySpectrum { inner: self.inner.passive_force(), what: "passive force" },
        ]
    }
}

/// The metrics of a preset, and those that were given in its place.
fn metrics(
    constraint: &PyConstraint,
    map: Option<&Matrix>,
    weights: [Option<&Numbers<'_>>; 4],
    metric: &str,
) -> Result<Metrics> {
    const PRESETS: [&str; 3] = ["unit", "length", "limits"];
    let mut metrics = Metrics::UNIT;
    if !PRESETS.contains(&metric) {
        return Err(Error::unknown("metric", metric, PRESETS).into());
    }
    if metric != "unit" {
        let units = task_units(constraint, map)?;
        metrics = Metrics::characteristic_length(&units, constraint.inner.length())?;
        if metric == "limits" {
            metrics = metrics.with_rate_limits(&limits(constraint, false)?)?;
        }
    }
    let [object, joint, wrench, torque] = weights;
    let set = |to: &mut Option<_>, name: &'static str, given: Option<&Numbers<'_>>| {
        if let Some(given) = given {
            *to = Some(metric_of(name, given)?);
        }
        Ok::<(), Failure>(())
    };
    set(&mut metrics.object, "Wu", object)?;
    set(&mut metrics.joint, "Wq", joint)?;
    set(&mut metrics.wrench, "Ww", wrench)?;
    set(&mut metrics.torque, "Wtau", torque)?;
    Ok(metrics)
}

/// Units with those of the task in place of the object's: each of its rows is of one kind.
fn task_units(constraint: &PyConstraint, map: Option<&Matrix>) -> Result<Units> {
    let Some(map) = map else { return Ok(constraint.units.clone()) };
    let row = |i: usize| {
        let mut used = (0..map.cols()).filter(|&j| map[(i, j)] != 0.0);
        let first = used.next().map_or(Unit::Angle, |j| constraint.units.object[j]);
        if used.all(|j| constraint.units.object[j] == first) {
            return Ok(first);
        }
        let reason = "a row of the task mixes lengths and angles; give Wu and Wq";
        Err(Failure::option("metric", "length", reason))
    };
    let object = (0..map.rows()).map(row).collect::<Result<Vec<Unit>>>()?;
    Ok(Units { object, ..constraint.units.clone() })
}

/// The limits of the driven joints, of rates or torques, all finite.
fn limits(constraint: &PyConstraint, torque: bool) -> Result<Vec<f64>> {
    let what = if torque { "effort" } else { "velocity" };
    let Some(origin) = &constraint.origin else {
        return Err(Failure::option("limits", "missing", "bare matrices have none; give them"));
    };
    let mechanism = origin.state.mechanism();
    let limit = |name: &String| {
        let tree = mechanism.coordinates().iter().find(|c| c.name == *name).map(|c| c.limits);
        let closing = mechanism.loops().iter().find(|l| l.name == *name).map(|l| l.limits);
        let limit = tree.or(closing).map(|l| if torque { l.effort } else { l.velocity });
        limit.filter(|v| v.is_finite() && *v > 0.0).ok_or_else(|| {
            Failure::option("limits", name, format!("the joint has no {what} limit; give limits"))
        })
    };
    constraint.actuated.iter().map(limit).collect()
}

#[pymethods]
impl PyManipulability {
    #[getter]
    fn kinematic(&self) -> PySpectrum {
        let [kinematic, ..] = self.spectra();
        kinematic
    }

    #[getter]
    fn active_force(&self) -> PySpectrum {
        let [_, active, _] = self.spectra();
        active
    }

    #[getter]
    fn passive_force(&self) -> PySpectrum {
        let [.., passive] = self.spectra();
        passive
    }

    #[getter]
    fn metric(&self) -> &str {
        &self.metric
    }

    #[getter]
    fn actuated(&self) -> Vec<String> {
        self.actuated.clone()
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.components.clone()
    }

    /// The efficiencies that count for an index, largest first, infinities and zeros included.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     'kinematic', 'active-kinematic' (rates given), 'passive-kinematic' (twist given),
    ///     'force', 'active-force' (torques given) or 'passive-force' (wrench given).
    ///
    /// Returns
    /// -------
    /// ndarray, (k,)
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    #[pyo3(signature = (name))]
    fn index<'py>(&self, py: Python<'py>, name: &str) -> Result<Array<'py>> {
        let Some(index) = Index::ALL.iter().find(|i| i.name() == name) else {
            let known = Index::ALL.iter().map(Index::name);
            return Err(Error::unknown("index", name, known).into());
        };
        Ok(arrays::vector(py, &index.values(&self.inner)))
    }

    fn __repr__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }
}

impl PyManipulability {
    fn table(&self) -> Table {
        let mut table = Table::new(&format!("Manipulability of {}", self.name));
        table.row("metric", &self.metric);
        table.row("driven", table::names(&self.actuated));
        table.row("object", table::names(&self.components));
        for spectrum in self.spectra() {
            table.row(spectrum.what, spectrum.words());
        }
        table
    }
}

/// The derivative of a measure of the kinematic efficiencies by the configuration.
///
/// Attributes
/// ----------
/// exists : bool
///     False where efficiencies are equal and the measure has a kink, or there is none.
/// value : float or None
///     The measure; None where no efficiency is finite.
/// gradient : ndarray, (n,), or None
///     An entry for each coordinate; of a mechanism with loops it lies along their motions.
/// error : float
///     Estimate from above of the error of a slope: zero for trees, where rounding is left.
/// multiplicity : int
///     How many efficiencies meet: 1 where the gradient exists.
#[pyclass(frozen, name = "Gradient", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyGradient {
    inner: Gradient,
}

#[pymethods]
impl PyGradient {
    #[getter]
    fn exists(&self) -> bool {
        matches!(self.inner, Gradient::Exists { .. })
    }

    #[getter]
    fn value(&self) -> Option<f64> {
        match self.inner {
            Gradient::Exists { value, .. } | Gradient::Repeated { value, .. } => Some(value),
            Gradient::Nothing => None,
        }
    }

    #[getter]
    fn gradient<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        match &self.inner {
            Gradient::Exists { gradient, .. } => Some(arrays::vector(py, gradient)),
            _ => None,
        }
    }

    #[getter]
    fn error(&self) -> f64 {
        if let Gradient::Exists { error, .. } = self.inner { error } else { f64::NAN }
    }

    #[getter]
    fn multiplicity(&self) -> usize {
        match self.inner {
            Gradient::Exists { .. } => 1,
            Gradient::Repeated { multiplicity, .. } => multiplicity,
            Gradient::Nothing => 0,
        }
    }

    fn __repr__(&self) -> String {
        match &self.inner {
            Gradient::Exists { value, gradient, .. } => format!(
                "Gradient(value={}, gradient={})",
                table::number(*value),
                table::list(gradient)
            ),
            Gradient::Repeated { value, multiplicity } => format!(
                "<Gradient: none, {multiplicity} efficiencies meet at {}>",
                table::number(*value)
            ),
            Gradient::Nothing => "<Gradient: none, no finite efficiency>".to_owned(),
        }
    }
}

impl PyGradient {
    pub(super) fn of(
        py: Python<'_>,
        constraint: &PyConstraint,
        measure: &str,
        task: Option<&Bound<'_, PyAny>>,
        weights: [Option<&Numbers<'_>>; 4],
        metric: &str,
    ) -> Result<Self> {
        let Some(measure) = Measure::ALL.into_iter().find(|m| m.name() == measure) else {
            let known = Measure::ALL.iter().map(|m| m.name());
            return Err(Error::unknown("measure", measure, known).into());
        };
        let Some(origin) = &constraint.origin else {
            return Err(Failure::option("measure", measure.name(), "bare matrices do not move"));
        };
        let map = task.map(|t| constraint.task(t)).transpose()?.map(|(map, _)| map);
        let metrics = metrics(constraint, map.as_ref(), weights, metric)?;
        let goal = Goal { reference: Some(origin.reference), task: map.as_ref() };
        let inner = py.detach(|| gradient(&origin.state, goal, &metrics, measure))?;
        Ok(Self { inner })
    }
}

/// All velocities or forces that the limits of the driven joints allow, about zero.
///
/// Attributes
/// ----------
/// vertices : ndarray, (V, d)
/// facets : list of list of int
///     Simplices of the boundary, as numbers of vertices.
/// normals : ndarray, (F, d)
/// offsets : ndarray, (F,)
///     `normals @ x <= offsets` within.
/// span : ndarray, (d, k)
///     The directions in which it extends.
/// unbounded : ndarray, (d, k)
///     Directions without limit.
/// complete : bool
///     False where there were too many facets.
#[pyclass(frozen, name = "Polytope", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyPolytope {
    inner: Polytope,
    dimension: usize,
}

impl PyPolytope {
    pub(super) fn of(
        py: Python<'_>,
        constraint: &PyConstraint,
        given: Option<&Numbers<'_>>,
        task: Option<&Bound<'_, PyAny>>,
        force: bool,
    ) -> Result<Self> {
        let symmetric = |all: &[f64]| all.iter().map(|l| Interval::symmetric(*l)).collect();
        let limits: Vec<Interval> = match given {
            None => symmetric(&limits(constraint, force)?),
            Some(given) => match given.values().as_chunks().0 {
                pairs if given.shape() == [pairs.len(), 2] => pairs
                    .iter()
                    .map(|[lower, upper]| Interval { lower: *lower, upper: *upper })
                    .collect(),
                _ => symmetric(given.vector("limits")?),
            },
        };
        let relation = constraint.relation(task)?;
        let dimension = relation.object();
        let inner = py.detach(|| {
            if force {
                force_polytope(&relation, &limits)
            } else {
                velocity_polytope(&relation, &limits)
            }
        })?;
        Ok(Self { inner, dimension })
    }

    fn hull(&self) -> &Hull {
        &self.inner.hull
    }
}

#[pymethods]
impl PyPolytope {
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let d = self.dimension;
        arrays::written(py, Some(self.hull().vertices.len()), &[d], |out| {
            for (v, out) in self.hull().vertices.iter().zip(out.chunks_exact_mut(d.max(1))) {
                out.copy_from_slice(v);
            }
        })
    }

    #[getter]
    fn facets(&self) -> Vec<Vec<usize>> {
        self.hull().facets.iter().map(|f| f.vertices.clone()).collect()
    }

    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let d = self.dimension;
        arrays::written(py, Some(self.hull().facets.len()), &[d], |out| {
            for (f, out) in self.hull().facets.iter().zip(out.chunks_exact_mut(d.max(1))) {
                out.copy_from_slice(&f.normal);
            }
        })
    }

    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.hull().facets.iter().map(|f| f.offset).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn span<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.hull().span)
    }

    #[getter]
    fn unbounded<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.unbounded)
    }

    #[getter]
    fn complete(&self) -> bool {
        self.hull().complete
    }

    fn __repr__(&self) -> String {
        format!(
            "<Polytope of {} vertices, {} facets, {} directions without limit>",
            self.hull().vertices.len(),
            self.hull().facets.len(),
            self.inner.unbounded.cols()
        )
    }
}
