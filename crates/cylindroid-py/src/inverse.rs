//! Inverses of Jacobians, one or a stack of them, each with its report.

use cylindroid::inverse::{
    self, HyperbolicDamping, HyperbolicOptions, Inverse, Method, Weights,
    point_direction as all_rates,
};
use cylindroid::linalg::Metric;
use cylindroid::screws::ScrewOptions;
use cylindroid::{Error, Matrix, Vec3};
use numpy::IntoPyArray;
use pyo3::prelude::*;

use crate::arrays::{self, Array, Many, Numbers};
use crate::error::{Failure, Result};
use crate::table::{self, Table};

/// An inverse and what was done to get it; of a stack of Jacobians everything has its axis first.
///
/// Attributes
/// ----------
/// matrix : ndarray, (n, m) or (N, n, m)
///     The inverse: rates = matrix @ task. NaN where none exists.
/// rank : int or ndarray of int, (N,)
///     Directions of which at least one half is realised.
/// singular_values : ndarray, (k,) or (N, k)
///     Of the (weighted) Jacobian, largest first.
/// threshold : float or ndarray, (N,)
///     The singular value below which a direction counts as dropped.
/// gap : float or ndarray, (N,)
///     Smallest singular value kept over the largest dropped: near 1 the rank is a matter of taste.
/// dropped : list of Dropped, or list of such lists
///     The directions that the inverse gives up.
/// exists : bool or ndarray of bool, (N,)
///     False where the method has no inverse for this Jacobian.
/// reason : str or None, or list of them
///     Why there is none.
#[pyclass(frozen, name = "Inverse", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInverse {
    inner: Many<Inverse>,
    /// Rows and columns of the Jacobian.
    shape: (usize, usize),
}

/// A task direction that an inverse gives up, wholly or by more than half.
///
/// Attributes
/// ----------
/// singular_value : float
/// direction : ndarray, (m,)
///     Unit vector in the (weighted) task space.
/// realised : float
///     The share of a motion along it that is realised, in [0, 1/2).
#[pyclass(frozen, name = "Dropped", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyDropped {
    #[pyo3(get)]
    singular_value: f64,
    direction: Vec<f64>,
    #[pyo3(get)]
    realised: f64,
}

#[pymethods]
impl PyDropped {
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.direction)
    }

    fn __repr__(&self) -> String {
        format!(
            "Dropped(singular_value={}, realised={}, direction={})",
            table::number(self.singular_value),
            table::number(self.realised),
            table::list(&self.direction)
        )
    }
}

fn dropped(inverse: &Inverse) -> Vec<PyDropped> {
    let one = |d: &inverse::Dropped| PyDropped {
        singular_value: d.singular_value,
        direction: d.direction.clone(),
        realised: d.realised,
    };
    inverse.dropped.iter().map(one).collect()
}

fn reason(inverse: &Inverse) -> Option<String> {
    inverse.reason.map(|r| r.to_string())
}

#[pymethods]
impl PyInverse {
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let (m, n) = self.shape;
        arrays::written(py, self.inner.count(), &[n, m], |out| {
            for (inverse, out) in
                self.inner.as_slice().iter().zip(out.chunks_exact_mut((n * m).max(1)))
            {
                arrays::put_rows(&inverse.matrix, out);
            }
        })
    }

    #[getter]
    fn rank<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.inner {
            Many::One(inverse) => inverse.rank.into_pyobject(py)?.into_any(),
            Many::All(all) => {
                let ranks: Vec<i64> = all.iter().map(|i| i.rank as i64).collect();
                ranks.into_pyarray(py).into_any()
            }
        })
    }

    #[getter]
    fn singular_values<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let k = match self.inner.as_slice().first() {
            Some(first) => first.singular_values.len(),
            None => self.shape.0.min(self.shape.1),
        };
        arrays::written(py, self.inner.count(), &[k], |out| {
            for (inverse, out) in self.inner.as_slice().iter().zip(out.chunks_exact_mut(k.max(1))) {
                out.copy_from_slice(&inverse.singular_values);
            }
        })
    }

    #[getter]
    fn threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::numbers(py, &self.inner, |i| i.threshold)
    }

    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::numbers(py, &self.inner, |i| i.gap)
    }

    #[getter]
    fn dropped<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Many::One(inverse) => dropped(inverse).into_pyobject(py),
            Many::All(all) => all.iter().map(dropped).collect::<Vec<_>>().into_pyobject(py),
        }
    }

    #[getter]
    fn exists<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.inner {
            Many::One(inverse) => inverse.exists.into_pyobject(py)?.to_owned().into_any(),
            Many::All(all) => {
                all.iter().map(|i| i.exists).collect::<Vec<bool>>().into_pyarray(py).into_any()
            }
        })
    }

    #[getter]
    fn reason<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Many::One(inverse) => Ok(reason(inverse).into_pyobject(py)?),
            Many::All(all) => all.iter().map(reason).collect::<Vec<_>>().into_pyobject(py),
        }
    }

    fn __repr__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }
}

impl PyInverse {
    fn new(j: &Many<Matrix>, inner: Many<Inverse>, stacked: (usize, usize)) -> Self {
        let shape = j.as_slice().first().map_or(stacked, |m| (m.rows(), m.cols()));
        Self { inner, shape }
    }

    fn table(&self) -> Table {
        let (m, n) = self.shape;
        let Many::One(inverse) = &self.inner else {
            let count = self.inner.count().unwrap_or(0);
            let mut table = Table::new(&format!("Inverses of {count} Jacobians of {m} x {n}"));
            let none = self.inner.as_slice().iter().filter(|i| !i.exists).count();
            table.row("without inverse", none.to_string());
            return table;
        };
        let mut table = Table::new(&format!("Inverse of a Jacobian of {m} x {n}"));
        table.row("exists", if inverse.exists { "yes" } else { "no" });
        if let Some(reason) = inverse.reason {
            table.row("reason", reason.to_string());
        }
        table.row("rank", inverse.rank.to_string());
        table.row("singular values", table::list(&inverse.singular_values));
        table.row("threshold", table::number(inverse.threshold));
        for d in &inverse.dropped {
            table.row("dropped", d_text(d));
        }
        table
    }
}

fn d_text(d: &inverse::Dropped) -> String {
    format!("{} (realised {})", table::list(&d.direction), table::number(d.realised))
}

/// The inverse of each matrix by `f`.
fn of_each(
    py: Python<'_>,
    j: &Numbers<'_>,
    f: impl Fn(&Matrix) -> cylindroid::Result<Inverse> + Send,
) -> Result<PyInverse> {
    let matrices = j.matrices("J")?;
    let inner = match &matrices {
        Many::One(one) => Many::One(f(one)?),
        Many::All(_) => py.detach(|| matrices.try_map(f))?,
    };
    let stacked = match *j.shape() {
        [.., m, n] => (m, n),
        _ => (0, 0),
    };
    Ok(PyInverse::new(&matrices, inner, stacked))
}

/// The truncated pseudoinverse: singular values at or below `eps` times the largest are cut.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them. To compare lengths with angles divide the linear rows by a
///     characteristic length first.
/// eps : float
///     Relative threshold, in [0, 1).
///
/// Returns
/// -------
/// Inverse
///     Its `matrix` is `numpy.linalg.pinv(J, eps)`.
///
/// Raises
/// ------
/// NotFiniteError
///     For entries that are NaN or infinite.
/// InvalidOptionError
///     For an `eps` outside of its interval or a J that is no matrix.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> inverse = cy.pinv([[1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]], eps=1e-3)
/// >>> inverse.rank
/// 1
/// >>> inverse.dropped[0].direction
/// array([0., 1.])
#[pyfunction]
#[pyo3(signature = (J, eps = 1e-3))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn pinv(py: Python<'_>, J: Numbers<'_>, eps: f64) -> Result<PyInverse> {
    of_each(py, &J, |j| inverse::truncated(j, eps))
}

/// The damped least-squares inverse `J^T (J J^T + damping^2)^-1`.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them.
/// damping : float
///     Positive, in the unit of the singular values. At rank loss `|qd| <= |v| / (2 damping)`.
///
/// Returns
/// -------
/// Inverse
///
/// Raises
/// ------
/// NotFiniteError, InvalidOptionError
///     As `pinv`.
///
/// Notes
/// -----
/// Nakamura and Hanafusa 1986.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.damped([[1.0, 0.0], [0.0, 0.1]], damping=0.1).matrix.round(3)
/// array([[0.99, 0.  ],
///        [0.  , 5.  ]])
#[pyfunction]
#[pyo3(signature = (J, damping))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn damped(py: Python<'_>, J: Numbers<'_>, damping: f64) -> Result<PyInverse> {
    of_each(py, &J, |j| inverse::damped(j, damping))
}

/// The numbers of an inverse, as they are named on the command line.
#[derive(Debug, Default)]
pub(crate) struct MethodNumbers {
    pub(crate) eps: Option<f64>,
    pub(crate) damping: Option<f64>,
    pub(crate) onset: Option<f64>,
    pub(crate) filter: Option<f64>,
    pub(crate) max_rate: Option<f64>,
    pub(crate) shape: Option<f64>,
    pub(crate) floor: Option<f64>,
}

impl MethodNumbers {
    /// The method of this name with the numbers that were given; others are refused.
    pub(crate) fn apply(&self, mut method: Method) -> Result<Method> {
        let name = method.name();
        let mut own = match &mut method {
            Method::Truncated { eps } => vec![("eps", eps)],
            Method::Damped { damping } => vec![("damping", damping)],
            Method::VariableDamping { onset, damping } => {
                vec![("onset", onset), ("damping", damping)]
            }
            Method::NumericalFiltering { onset, damping, filter } => {
                vec![("onset", onset), ("damping", damping), ("filter", filter)]
            }
            Method::SelectivelyDamped { max_rate } => vec![("max_rate", max_rate)],
            Method::SingularValueFiltering { shape, floor } => {
                vec![("shape", shape), ("floor", floor)]
            }
        };
        let given = [
            ("eps", self.eps),
            ("damping", self.damping),
            ("onset", self.onset),
            ("filter", self.filter),
            ("max_rate", self.max_rate),
            ("shape", self.shape),
            ("floor", self.floor),
        ];
        for (option, value) in given.into_iter().filter_map(|(o, v)| Some((o, v?))) {
            let Some((_, number)) = own.iter_mut().find(|(o, _)| *o == option) else {
                let names: Vec<&str> = own.iter().map(|(o, _)| *o).collect();
                let reason =
                    format!("the inverse '{name}' has no such number but {}", names.join(", "));
                return Err(Failure::option(option, value.to_string(), reason));
            };
            **number = value;
        }
        Ok(method)
    }
}

fn metric(name: &'static str, of: Option<&Numbers<'_>>) -> Result<Option<Metric>> {
    let Some(of) = of else { return Ok(None) };
    Ok(Some(match of.shape() {
        [_] => Metric::diagonal(name, of.values())?,
        _ => Metric::new(name, &of.matrix(name)?)?,
    }))
}

/// An inverse by name, in the metrics of joints and task.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them.
/// method : str
///     'truncated' (eps), 'damped' (damping), 'variable-damping' (onset, damping),
///     'numerical-filtering' (onset, damping, filter), 'selectively-damped' (max_rate),
///     'singular-value-filtering' (shape, floor).
/// joint_weights, task_weights : array_like, (n,), (n, n) and (m,), (m, m), optional
///     Symmetric and positive definite: a large joint weight keeps a joint still, a large task
///     weight a direction exact.
/// eps, damping, onset, filter, max_rate, shape, floor : float, optional
///     The numbers of the method, else their defaults.
///
/// Returns
/// -------
/// Inverse
///
/// Raises
/// ------
/// UnknownNameError
///     For a method that there is not, with the nearest names.
/// InvalidOptionError
///     For a number that the method has not, or outside of its interval.
/// NotFiniteError, DimensionError
///     For entries that are not finite, weights of the wrong size.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.inverse([[1.0, 0.0], [0.0, 1e-3]], 'variable-damping').rank
/// 1
#[pyfunction]
#[pyo3(name = "inverse")]
#[pyo3(signature = (J, method = "truncated", *, joint_weights = None, task_weights = None,
    eps = None, damping = None, onset = None, filter = None, max_rate = None, shape = None,
    floor = None))]
#[expect(non_snake_case, reason = "the field's name")]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn inverse_by_name(
    py: Python<'_>,
    J: Numbers<'_>,
    method: &str,
    joint_weights: Option<Numbers<'_>>,
    task_weights: Option<Numbers<'_>>,
    eps: Option<f64>,
    damping: Option<f64>,
    onset: Option<f64>,
    filter: Option<f64>,
    max_rate: Option<f64>,
    shape: Option<f64>,
    floor: Option<f64>,
) -> Result<PyInverse> {
    let numbers = MethodNumbers { eps, damping, onset, filter, max_rate, shape, floor };
    let method = numbers.apply(Method::named(method)?)?;
    let weights = Weights {
        joint: metric("joint_weights", joint_weights.as_ref())?,
        task: metric("task_weights", task_weights.as_ref())?,
    };
    of_each(py, &J, |j| inverse::weighted(j, method, &weights))
}

/// The selectively damped inverse for one motion.
///
/// Parameters
/// ----------
/// J : array_like, (m, n)
/// task : array_like, (m,)
///     The motion to be realised.
/// max_rate : float
///     Largest rate of any joint [rad/s or m/s].
///
/// Returns
/// -------
/// Inverse
///     `matrix @ task` has no entry above `max_rate`.
///
/// Raises
/// ------
/// NotFiniteError, DimensionError, InvalidOptionError
///
/// Notes
/// -----
/// Buss and Kim 2005.
#[pyfunction]
#[pyo3(signature = (J, task, max_rate = std::f64::consts::FRAC_PI_4))]
#[pyo3(text_signature = "(J, task, max_rate=0.7853981633974483)")]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn selectively_damped(
    J: Numbers<'_>,
    task: Numbers<'_>,
    max_rate: f64,
) -> Result<PyInverse> {
    let j = J.matrix("J")?;
    let inner = inverse::selectively_damped(&j, task.vector("task")?, max_rate)?;
    Ok(PyInverse { shape: (j.rows(), j.cols()), inner: Many::One(inner) })
}

/// Scale and noise of twists.
pub(crate) fn scale_of(
    length: Option<f64>,
    center: Option<&Numbers<'_>>,
    noise: Option<f64>,
) -> Result<ScrewOptions> {
    let default = ScrewOptions::default();
    Ok(ScrewOptions {
        length: length.unwrap_or(default.length),
        center: center.map(|c| c.entries::<3>("center")).transpose()?.map(Vec3::from_array),
        noise: noise.unwrap_or(default.noise),
    })
}

/// The damping of hyperbolic inverses that two optional numbers mean.
pub(crate) fn damping_of(mu: Option<f64>, lam: Option<f64>) -> Result<HyperbolicDamping> {
    match (mu, lam) {
        (None, None) => Ok(HyperbolicDamping::None),
        (Some(mu), None) => Ok(HyperbolicDamping::Invariant { mu }),
        (None, Some(lambda)) => Ok(HyperbolicDamping::Gram { lambda }),
        (Some(mu), Some(_)) => {
            let reason =
                "give mu (invariant damping) or lam (damping of the Gram matrix), not both";
            Err(Failure::option("mu", mu.to_string(), reason))
        }
    }
}

/// The hyperbolic pseudoinverse of pitch h: joint rates that no change of frame or unit alters.
///
/// Parameters
/// ----------
/// J : array_like, (6, m) or (N, 6, m)
///     Twists as columns, linear part first (the literature writes angular first).
/// h : float
///     Pitch of the form [m/rad], or `inf` for the limit.
/// joint_metric : array_like, (m,) or (m, m), optional
///     Matters for dependent columns and for damping. Default: the identity.
/// length : float, optional
///     Characteristic length (m) of the verdict on existence, not of the inverse. Default: 1.
/// center : array_like, (3,), optional
///     The point at which lengths are judged. Default: the one nearest to all axes.
/// noise : float, optional
///     Error of the twists relative to their size.
/// mu : float, optional
///     Invariant damping [m/rad]: exists for every J.
/// lam : float, optional
///     Damping of the Gram matrix [m/rad].
///
/// Returns
/// -------
/// Inverse
///     Where `exists` is false, `reason` says why and `matrix` is NaN.
///
/// Raises
/// ------
/// DimensionError
///     For a J that has not six rows.
/// NotFiniteError, InvalidOptionError
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group.
///
/// Examples
/// --------
/// A rotation about z through (1, 0, 0); the pitch of the joint itself has no inverse.
///
/// >>> import cylindroid as cy
/// >>> J = [[0.0], [-1.0], [0.0], [0.0], [0.0], [1.0]]
/// >>> cy.hyperbolic(J, 0.1).exists
/// True
/// >>> cy.hyperbolic(J, 0.0).exists
/// False
#[pyfunction]
#[pyo3(signature = (J, h, joint_metric = None, length = None, center = None, noise = None, *,
    mu = None, lam = None))]
#[expect(non_snake_case, reason = "the field's name")]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn hyperbolic(
    py: Python<'_>,
    J: Numbers<'_>,
    h: f64,
    joint_metric: Option<Numbers<'_>>,
    length: Option<f64>,
    center: Option<Numbers<'_>>,
    noise: Option<f64>,
    mu: Option<f64>,
    lam: Option<f64>,
) -> Result<PyInverse> {
    let options = HyperbolicOptions {
        scale: scale_of(length, center.as_ref(), noise)?,
        joint_metric: metric("joint_metric", joint_metric.as_ref())?,
        damping: damping_of(mu, lam)?,
    };
    of_each(py, &J, |j| inverse::hyperbolic_with(j, h, &options))
}

/// The inverse that leaves out sums of chosen twists.
///
/// Parameters
/// ----------
/// J : array_like, (6, m) or (N, 6, m)
///     Twists as columns, linear part first.
/// complement : array_like, (6, 6 - rank)
///     Twists, in the frame of J, that the task may give up.
/// joint_metric, length, center, noise
///     As `hyperbolic`.
///
/// Returns
/// -------
/// Inverse
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
#[pyfunction]
#[pyo3(signature = (J, complement, joint_metric = None, length = None, center = None,
    noise = None))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn oblique(
    py: Python<'_>,
    J: Numbers<'_>,
    complement: Numbers<'_>,
    joint_metric: Option<Numbers<'_>>,
    length: Option<f64>,
    center: Option<Numbers<'_>>,
    noise: Option<f64>,
) -> Result<PyInverse> {
    let options = HyperbolicOptions {
        scale: scale_of(length, center.as_ref(), noise)?,
        joint_metric: metric("joint_metric", joint_metric.as_ref())?,
        damping: HyperbolicDamping::None,
    };
    let complement = complement.matrix("complement")?;
    of_each(py, &J, |j| inverse::oblique(j, &complement, &options))
}

/// The joint rates that move a point along a line.
///
/// Attributes
/// ----------
/// along : ndarray, (m,), or None
///     The smallest rates that move the point at 1 m/s along the direction; None if none do.
/// still : ndarray, (m, d)
///     Rates that keep the point at rest: an orthonormal basis.
#[pyclass(frozen, name = "PointDirection", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyPointDirection {
    along: Option<Vec<f64>>,
    still: Matrix,
}

#[pymethods]
impl PyPointDirection {
    #[getter]
    fn along<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.along.as_ref().map(|a| arrays::vector(py, a))
    }

    #[getter]
    fn still<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.still)
    }

    fn __repr__(&self) -> String {
        let along = self.along.as_ref().map_or_else(|| "None".to_owned(), |a| table::list(a));
        format!("PointDirection(along={along}, still of {} rates)", self.still.cols())
    }
}

/// All joint rates that move a point of the end effector along a direction.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first.
/// point : array_like, (3,)
///     In the frame of J (m).
/// direction : array_like, (3,)
///     Of any length but zero.
///
/// Returns
/// -------
/// PointDirection
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
#[pyfunction]
#[pyo3(signature = (J, point, direction))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn point_direction(
    J: Numbers<'_>,
    point: Numbers<'_>,
    direction: Numbers<'_>,
) -> Result<PyPointDirection> {
    let (point, direction) = (point.entries("point")?, direction.entries("direction")?);
    Error::check_finite("direction", &direction)?;
    let found = all_rates(&J.matrix("J")?, Vec3::from_array(point), Vec3::from_array(direction))?;
    Ok(PyPointDirection { along: found.along, still: found.still })
}
