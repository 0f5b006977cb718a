//! Screws, screw systems, lines in involution.

use cylindroid::screws::{
    self, Along, Existence, Involution, Line, Projector, Screw, ScrewSystem, Transversals,
};
use cylindroid::{Error, Pose, Twist, Vec3};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result};
use crate::inverse::scale_of;
use crate::table::{self, Table};

/// A line with a pitch and an amplitude: a twist in the words of geometry.
///
/// Parameters
/// ----------
/// twist : array_like, (6,)
///     Linear part first, not zero [m/s, rad/s].
///
/// Attributes
/// ----------
/// point : ndarray, (3,)
///     The point of the axis nearest to the origin (m); zero for a translation.
/// direction : ndarray, (3,)
///     Unit vector.
/// pitch : float
///     Advance by angle [m/rad]; infinite for a translation.
/// amplitude : float
///     [rad/s], of a translation [m/s].
/// twist : ndarray, (6,)
/// is_translation : bool
///
/// Raises
/// ------
/// NotFiniteError, DimensionError
/// InvalidOptionError
///     For the zero twist, which has no axis.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.Screw([0, -1, 0.1, 0, 0, 1])
/// Screw(point=[1, 0, 0], direction=[0, 0, 1], pitch=0.1, amplitude=1)
#[pyclass(frozen, name = "Screw", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyScrew {
    inner: Screw,
}

impl From<&Screw> for PyScrew {
    fn from(screw: &Screw) -> Self {
        Self { inner: *screw }
    }
}

pub(crate) fn screw_list(screws: &[Screw]) -> Vec<PyScrew> {
    screws.iter().map(PyScrew::from).collect()
}

#[pymethods]
impl PyScrew {
    #[new]
    #[pyo3(signature = (twist))]
    fn new(twist: Numbers<'_>) -> Result<Self> {
        let entries = twist.entries::<6>("twist")?;
        Error::check_finite("twist", &entries)?;
        match Screw::of(Twist::from_array(entries)) {
            Some(inner) => Ok(Self { inner }),
            None => Err(Failure::option("twist", table::list(&entries), "it has no axis")),
        }
    }

    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.axis.point.to_array())
    }

    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.axis.direction.to_array())
    }

    #[getter]
    fn pitch(&self) -> f64 {
        self.inner.pitch
    }

    #[getter]
    fn amplitude(&self) -> f64 {
        self.inner.amplitude
    }

    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.twist().to_array())
    }

    #[getter]
    fn is_translation(&self) -> bool {
        self.inner.is_translation()
    }

    fn __repr__(&self) -> String {
        format!(
            "Screw(point={}, direction={}, pitch={}, amplitude={})",
            table::list(&self.inner.axis.point.to_array()),
            table::list(&self.inner.axis.direction.to_array()),
            table::number(self.inner.pitch),
            table::number(self.inner.amplitude)
        )
    }
}

/// Whether a hyperbolic pseudoinverse exists, and how clearly.
///
/// Attributes
/// ----------
/// exists : bool
/// margin, threshold : float
///     Smallest singular value of the Gram matrix of the pitch form; at or below the threshold
///     there is none.
/// reason : str or None
#[pyclass(frozen, get_all, name = "Existence", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyExistence {
    exists: bool,
    margin: f64,
    threshold: f64,
    reason: Option<String>,
}

impl From<Existence> for PyExistence {
    fn from(e: Existence) -> Self {
        let reason = e.reason.map(|r| r.to_string());
        Self { exists: e.exists, margin: e.margin, threshold: e.threshold, reason }
    }
}

#[pymethods]
impl PyExistence {
    fn __bool__(&self) -> bool {
        self.exists
    }

    fn __repr__(&self) -> String {
        match &self.reason {
            None => format!("<exists, margin {}>", table::number(self.margin)),
            Some(reason) => format!("<does not exist: {reason}>"),
        }
    }
}

/// A quantity that the class of a screw system hangs on.
///
/// Attributes
/// ----------
/// quantity : str
/// value, threshold : float
///     Without unit; at or below the threshold it counts as zero.
#[pyclass(frozen, get_all, name = "Margin", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyMargin {
    quantity: &'static str,
    value: f64,
    threshold: f64,
}

#[pymethods]
impl PyMargin {
    fn __repr__(&self) -> String {
        let (value, threshold) = (table::number(self.value), table::number(self.threshold));
        format!("Margin('{}', value={value}, threshold={threshold})", self.quantity)
    }
}

/// The subspace of twists that a set of twists spans, with its class, principal screws and frame.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first, of one frame.
/// length : float, optional
///     Characteristic length L (m): the reach of an arm. Default: 1.
/// center : array_like, (3,), optional
///     The point at which lengths are judged (m). Default: the one nearest to all axes.
/// noise : float, optional
///     Error of the twists relative to their size. Default: rounding.
///
/// Attributes
/// ----------
/// rank : int
///     Order of the system, 0 to 6.
/// gibson_hunt : str
///     Its class: 'IA', 'IA1', 'IB0', ...; 'h' or 'inf' for orders 1 and 5, '0' and '6'; systems of
///     order 4 and 5 carry the class of their reciprocal system.
/// meaning : str
///     What a system of this class consists of.
/// principal_pitches : ndarray
///     Pitches at which the hyperbolic pseudoinverse ceases to exist, largest first [m/rad].
/// principal_screws : list of Screw
/// canonical_pose : ndarray, (4, 4)
///     The frame of the normal form, seen from the frame of the twists.
/// pitches : ndarray
///     Those of the normal form [m/rad].
/// slope : float or None
///     The p of classes IB, IB0 and IC.
/// residual : float
///     Sine of the angle between the system and its normal form.
/// margins : list of Margin
///     The quantities that the class hangs on.
/// ambiguous : bool
///     True if one of them lies so near to its threshold that the verdict is a matter of taste.
/// basis : ndarray, (6, rank)
///     Twists that span the system.
/// gap, threshold : float
///     Of the rank.
/// length : float
/// center : ndarray, (3,)
/// tolerance : float
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
///
/// Notes
/// -----
/// Gibson and Hunt 1990; Donelan and Selig, Hyperbolic pseudoinverses.
///
/// Examples
/// --------
/// Two axes at right angles, 0.2 m apart: the cylindroid between pitches -0.1 and 0.1.
///
/// >>> import cylindroid as cy
/// >>> system = cy.ScrewSystem([[0, 0], [0, 0], [0, -0.2], [0, 1], [0, 0], [1, 0]])
/// >>> system.gibson_hunt
/// 'IA'
/// >>> system.principal_pitches.round(12)
/// array([ 0.1, -0.1])
#[pyclass(frozen, name = "ScrewSystem", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyScrewSystem {
    pub(crate) inner: ScrewSystem,
}

#[pymethods]
impl PyScrewSystem {
    #[new]
    #[pyo3(signature = (J, length = None, center = None, noise = None))]
    #[expect(non_snake_case, reason = "the field's name")]
    fn new(
        J: Numbers<'_>,
        length: Option<f64>,
        center: Option<Numbers<'_>>,
        noise: Option<f64>,
    ) -> Result<Self> {
        let options = scale_of(length, center.as_ref(), noise)?;
        Ok(Self { inner: ScrewSystem::of_columns(&J.matrix("J")?, &options)? })
    }

    #[getter]
    fn rank(&self) -> usize {
        self.inner.order()
    }

    #[getter]
    fn gap(&self) -> f64 {
        self.inner.rank().gap
    }

    #[getter]
    fn threshold(&self) -> f64 {
        self.inner.rank().threshold
    }

    #[getter]
    fn gibson_hunt(&self) -> &'static str {
        self.inner.class().name()
    }

    #[getter]
    fn meaning(&self) -> &'static str {
        self.inner.class().meaning()
    }

    #[getter]
    fn principal_pitches<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.principal_pitches())
    }

    #[getter]
    fn principal_screws(&self) -> Vec<PyScrew> {
        screw_list(self.inner.principal_screws())
    }

    #[getter]
    fn canonical_pose<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::pose(py, self.inner.canonical_pose())
    }

    #[getter]
    fn pitches<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.normal_form().pitches)
    }

    #[getter]
    fn slope(&self) -> Option<f64> {
        self.inner.normal_form().slope
    }

    #[getter]
    fn residual(&self) -> f64 {
        self.inner.residual()
    }

    #[getter]
    fn margins(&self) -> Vec<PyMargin> {
        let one = |m: &screws::Margin| PyMargin {
            quantity: m.quantity,
            value: m.value,
            threshold: m.threshold,
        };
        self.inner.margins().iter().map(one).collect()
    }

    #[getter]
    fn ambiguous(&self) -> bool {
        self.inner.is_ambiguous()
    }

    #[getter]
    fn basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let basis = self.inner.basis();
        arrays::written(py, None, &[6, basis.len()], |out| {
            for (j, twist) in basis.iter().enumerate() {
                for (i, x) in twist.to_array().into_iter().enumerate() {
                    out[i * basis.len() + j] = x;
                }
            }
        })
    }

    #[getter]
    fn length(&self) -> f64 {
        self.inner.length()
    }

    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.center().to_array())
    }

    #[getter]
    fn tolerance(&self) -> f64 {
        self.inner.tolerance()
    }

    /// The twists reciprocal to all of this system: what contacts along them do not hinder.
    ///
    /// Returns
    /// -------
    /// ScrewSystem
    fn reciprocal(&self) -> Self {
        Self { inner: self.inner.reciprocal() }
    }

    /// The twists reciprocal to all of this system in the form of pitch h.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad]
    ///
    /// Returns
    /// -------
    /// ScrewSystem
    #[pyo3(signature = (h))]
    fn h_reciprocal(&self, h: f64) -> Result<Self> {
        Error::check_finite("h", &[h])?;
        Ok(Self { inner: self.inner.h_reciprocal(h) })
    }

    /// The sums of twists of both systems.
    ///
    /// Parameters
    /// ----------
    /// other : ScrewSystem
    ///
    /// Returns
    /// -------
    /// ScrewSystem
    #[pyo3(signature = (other))]
    fn sum(&self, other: PyRef<'_, Self>) -> Self {
        Self { inner: self.inner.sum(&other.inner) }
    }

    /// The twists that belong to both systems.
    ///
    /// Parameters
    /// ----------
    /// other : ScrewSystem
    ///
    /// Returns
    /// -------
    /// ScrewSystem
    #[pyo3(signature = (other))]
    fn intersection(&self, other: PyRef<'_, Self>) -> Self {
        Self { inner: self.inner.intersection(&other.inner) }
    }

    /// The sine of the angle by which a twist leaves the system.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///
    /// Returns
    /// -------
    /// float
    ///     Zero for a member, one for a twist across all of them.
    #[pyo3(signature = (twist))]
    fn sine_to(&self, twist: Numbers<'_>) -> Result<f64> {
        let entries = twist.entries::<6>("twist")?;
        Error::check_finite("twist", &entries)?;
        Ok(self.inner.sine_to(Twist::from_array(entries)))
    }

    /// Whether a twist belongs to the system, to the tolerance of its class.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///
    /// Returns
    /// -------
    /// bool
    #[pyo3(signature = (twist))]
    fn contains(&self, twist: Numbers<'_>) -> Result<bool> {
        Ok(self.sine_to(twist)? <= self.inner.tolerance())
    }

    /// Whether the hyperbolic pseudoinverse of pitch h exists.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad], or infinite for the limit.
    ///
    /// Returns
    /// -------
    /// Existence
    #[pyo3(signature = (h))]
    fn existence(&self, h: f64) -> Result<PyExistence> {
        check_pitch(h)?;
        Ok(self.inner.existence(h).into())
    }

    /// The projector on this system along its h-reciprocal one: no change of frame or unit alters
    /// what it does.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad], or infinite for the limit.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, 6), or None
    ///     On twists, linear part first; None where `existence(h)` says that there is none. On
    ///     wrenches `1 - P.T` keeps what does no work on the system.
    #[pyo3(signature = (h))]
    fn projector<'py>(&self, py: Python<'py>, h: f64) -> Result<Option<Array<'py>>> {
        check_pitch(h)?;
        self.inner.projector(h).map(|p| arrays::matrix(py, &p.matrix())).transpose()
    }

    /// The projector on this system along another; None where the two do not split the space.
    ///
    /// Parameters
    /// ----------
    /// other : ScrewSystem
    ///     Twists that may be given up.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, 6), or None
    #[pyo3(signature = (other))]
    fn projector_along<'py>(
        &self,
        py: Python<'py>,
        other: PyRef<'_, Self>,
    ) -> Result<Option<Array<'py>>> {
        let projector = self.inner.projector_along(&other.inner);
        projector.map(|p| arrays::matrix(py, &p.matrix())).transpose()
    }

    /// The largest factor by which the projector of pitch h enlarges a twist; infinite where there
    /// is none.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///
    /// Returns
    /// -------
    /// float
    #[pyo3(signature = (h))]
    fn projector_norm(&self, h: f64) -> Result<f64> {
        check_pitch(h)?;
        Ok(self.inner.projector_norm(h))
    }

    /// The pitch at which the projector is smallest: advice for `h`.
    ///
    /// Returns
    /// -------
    /// (float or None, float)
    ///     The pitch [m/rad], infinite where the limit is best, None where no pitch has an
    ///     inverse; and the size of the projector there.
    fn choose_pitch(&self, py: Python<'_>) -> (Option<f64>, f64) {
        let choice = py.detach(|| self.inner.choose_pitch());
        (choice.pitch, choice.norm)
    }

    fn __repr__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }
}

impl PyScrewSystem {
    fn table(&self) -> Table {
        let s = &self.inner;
        let mut table = Table::new(&format!("ScrewSystem of order {}", s.order()));
        let of = if matches!(s.order(), 4 | 5) { "reciprocal system: " } else { "" };
        table.row("class", format!("{}, {of}{}", s.class(), s.class().meaning()));
        table.row("principal pitches", table::list(&s.principal_pitches()));
        table.row("origin", table::list(&s.canonical_pose().translation.to_array()));
        if s.is_ambiguous() {
            table.row("ambiguous", "a quantity lies near its threshold, see margins");
        }
        table
    }
}

fn check_pitch(h: f64) -> Result<()> {
    if h.is_nan() {
        return Err(Error::NotFinite { what: "pitch h".into(), value: h }.into());
    }
    Ok(())
}

/// Lines: twists of pitch zero as columns, or pairs of point and direction.
fn lines_of(lines: &Numbers<'_>) -> Result<Vec<Line>> {
    let refuse = |i: usize, why: &str| Failure::option("lines", format!("number {i}"), why);
    match *lines.shape() {
        [6, _] => {
            let m = lines.matrix("lines")?;
            let one = |j: usize| {
                let entries: [f64; 6] = std::array::from_fn(|i| m[(i, j)]);
                Error::check_finite("line", &entries)?;
                let twist = Twist::from_array(entries);
                let not_a_line = "a line is a twist of pitch zero: direction d (entries 4 to 6) and \
                                  p x d for a point p (entries 1 to 3)";
                let screw = Screw::of(twist).filter(|s| !s.is_translation());
                let screw = screw.ok_or_else(|| refuse(j, not_a_line))?;
                let size = screw.axis.point.norm().max(1.0);
                if screw.pitch.abs() > 1e-6 * size {
                    return Err(refuse(j, not_a_line));
                }
                Ok(screw.axis)
            };
            (0..m.cols()).map(one).collect()
        }
        [count, 2, 3] => {
            let rows = lines.values().as_chunks::<6>().0;
            let one = |i: usize| {
                Error::check_finite("line", &rows[i])?;
                let [px, py, pz, dx, dy, dz] = rows[i];
                let line = Line::through(Vec3::new(px, py, pz), Vec3::new(dx, dy, dz));
                line.ok_or_else(|| refuse(i, "its direction has no length"))
            };
            (0..count).map(one).collect()
        }
        _ => Err(Failure::option(
            "lines",
            format!("{} numbers", lines.values().len()),
            "give (6, m) twists of pitch zero as columns, or (m, 2, 3) points and directions",
        )),
    }
}

/// The lines that meet all of a set of lines.
///
/// Attributes
/// ----------
/// infinitely_many : bool
///     True if there are; then `lines` is empty.
/// lines : ndarray, (k, 2, 3)
///     Points and directions of the transversals.
/// at_infinity : ndarray, (k, 3)
///     Transversals at infinity, as normals of the planes that hold them.
/// double : bool
///     True if the one transversal counts twice.
#[pyclass(frozen, name = "Transversals", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyTransversals {
    inner: Transversals,
}

#[pymethods]
impl PyTransversals {
    #[getter]
    fn infinitely_many(&self) -> bool {
        self.inner.infinitely_many
    }

    #[getter]
    fn lines<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::written(py, Some(self.inner.lines.len()), &[2, 3], |out| {
            for (line, out) in self.inner.lines.iter().zip(out.chunks_exact_mut(6)) {
                out[..3].copy_from_slice(&line.point.to_array());
                out[3..].copy_from_slice(&line.direction.to_array());
            }
        })
    }

    #[getter]
    fn at_infinity<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::written(py, Some(self.inner.at_infinity.len()), &[3], |out| {
            for (normal, out) in self.inner.at_infinity.iter().zip(out.chunks_exact_mut(3)) {
                out.copy_from_slice(&normal.to_array());
            }
        })
    }

    #[getter]
    fn double(&self) -> bool {
        self.inner.double
    }

    fn __repr__(&self) -> String {
        let t = &self.inner;
        match (t.infinitely_many, t.lines.len()) {
            (true, _) => "<Transversals: infinitely many>".to_owned(),
            (false, n) => format!("<Transversals: {n}, {} at infinity>", t.at_infinity.len()),
        }
    }
}

/// What a set of lines has in common.
///
/// Attributes
/// ----------
/// in_involution : bool
///     True if the lines let a load through without feeling it, or are dependent.
/// independent : bool
///     True if none of them is spanned by the others.
/// null_twist : ndarray, (6,), or None
///     A twist of their span that is reciprocal to all of it.
/// null_twists : ndarray, (6, k)
/// null_screw : Screw or None
/// wrench : ndarray, (6,), or None
///     The wrench on it, force first, which no joint on the lines feels.
/// transversals : Transversals
/// margin, threshold : float
/// system : ScrewSystem
#[pyclass(frozen, name = "Involution", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInvolution {
    inner: Involution,
}

#[pymethods]
impl PyInvolution {
    #[getter]
    fn in_involution(&self) -> bool {
        self.inner.in_involution
    }

    #[getter]
    fn independent(&self) -> bool {
        self.inner.independent
    }

    #[getter]
    fn null_twist<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.inner.null_twists.first().map(|t| arrays::vector(py, &t.to_array()))
    }

    #[getter]
    fn null_twists<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all = &self.inner.null_twists;
        arrays::written(py, None, &[6, all.len()], |out| {
            for (j, twist) in all.iter().enumerate() {
                for (i, x) in twist.to_array().into_iter().enumerate() {
                    out[i * all.len() + j] = x;
                }
            }
        })
    }

    #[getter]
    fn null_screw(&self) -> Option<PyScrew> {
        self.inner.null_screw.as_ref().map(PyScrew::from)
    }

    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.inner.wrench.map(|w| arrays::vector(py, &w.to_array()))
    }

    #[getter]
    fn transversals(&self) -> PyTransversals {
        PyTransversals { inner: self.inner.transversals.clone() }
    }

    #[getter]
    fn margin(&self) -> f64 {
        self.inner.margin
    }

    #[getter]
    fn threshold(&self) -> f64 {
        self.inner.threshold
    }

    #[getter]
    fn system(&self) -> PyScrewSystem {
        PyScrewSystem { inner: self.inner.system.clone() }
    }

    fn __repr__(&self) -> String {
        format!(
            "<Involution of {} lines: {}in involution, {}independent>",
            self.inner.lines,
            if self.inner.in_involution { "" } else { "not " },
            if self.inner.independent { "" } else { "not " }
        )
    }
}

/// Whether lines are in involution: whether joints on them let a load through without feeling it.
///
/// Parameters
/// ----------
/// lines : array_like, (6, m) or (m, 2, 3)
///     Twists of pitch zero as columns, linear part first, or points and directions (m).
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// Involution
///
/// Raises
/// ------
/// NotFiniteError, InvalidOptionError
///     Also for a column that is no line.
///
/// Examples
/// --------
/// Three parallel lines in a plane, and one that meets them:
///
/// >>> import cylindroid as cy
/// >>> lines = [[[x, 0, 0], [0, 0, 1]] for x in (0.0, 1.0, 2.0)]
/// >>> cy.involution(lines).independent
/// False
#[pyfunction]
#[pyo3(signature = (lines, length = None, center = None, noise = None))]
pub(crate) fn involution(
    lines: Numbers<'_>,
    length: Option<f64>,
    center: Option<Numbers<'_>>,
    noise: Option<f64>,
) -> Result<PyInvolution> {
    let options = scale_of(length, center.as_ref(), noise)?;
    Ok(PyInvolution { inner: screws::involution(&lines_of(&lines)?, &options)? })
}

/// The lines that meet all of a set of lines.
///
/// Parameters
/// ----------
/// lines : array_like, (6, m) or (m, 2, 3)
///     As `involution`.
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// Transversals
///
/// Raises
/// ------
/// NotFiniteError, InvalidOptionError
#[pyfunction]
#[pyo3(signature = (lines, length = None, center = None, noise = None))]
pub(crate) fn transversals(
    lines: Numbers<'_>,
    length: Option<f64>,
    center: Option<Numbers<'_>>,
    noise: Option<f64>,
) -> Result<PyTransversals> {
    let options = scale_of(length, center.as_ref(), noise)?;
    Ok(PyTransversals { inner: screws::transversals(&lines_of(&lines)?, &options)? })
}

/// The projector on the motions controlled in position, for hybrid and shared control.
///
/// Parameters
/// ----------
/// motions : array_like, (6, k)
///     Twists that span them, as columns, linear part first.
/// along : float or array_like, (6, 6 - k)
///     A pitch h [m/rad]: what is left out is h-reciprocal to all of them; or the twists that are
///     left out.
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     P on twists; `1 - P.T` on wrenches keeps those that do no work on the motions.
///
/// Raises
/// ------
/// InvalidOptionError
///     Where there is no such projector, with the reason.
/// DimensionError, NotFiniteError
#[pyfunction]
#[pyo3(signature = (motions, along, length = None, center = None, noise = None))]
pub(crate) fn projector<'py>(
    py: Python<'py>,
    motions: Numbers<'py>,
    along: Numbers<'py>,
    length: Option<f64>,
    center: Option<Numbers<'py>>,
    noise: Option<f64>,
) -> Result<Array<'py>> {
    let columns = |name: &'static str, of: &Numbers<'_>| -> Result<Vec<Twist>> {
        let m = of.matrix(name)?;
        Error::check_len("rows of the matrix of twists", 6, m.rows())?;
        Ok((0..m.cols()).map(|j| Twist::from_array(std::array::from_fn(|i| m[(i, j)]))).collect())
    };
    let motions = columns("motions", &motions)?;
    let twists = if along.shape().is_empty() { vec![] } else { columns("along", &along)? };
    let way = match (along.shape(), along.values()) {
        ([], [h]) => Along::Reciprocal { h: *h },
        _ => Along::Twists(&twists),
    };
    match Projector::of(&motions, way, &scale_of(length, center.as_ref(), noise)?)? {
        Ok(projector) => arrays::matrix(py, &projector.matrix()),
        Err(reason) => Err(Failure::option("along", "no projector", reason.to_string())),
    }
}

/// The adjoint of a pose: twists in frame b, seen from frame a; its inverse transpose moves
/// wrenches.
///
/// Parameters
/// ----------
/// a_from_b : array_like, (4, 4)
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     Linear part first.
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> bool((cy.adjoint(np.eye(4)) == np.eye(6)).all())
/// True
#[pyfunction]
#[pyo3(signature = (a_from_b))]
pub(crate) fn adjoint<'py>(py: Python<'py>, a_from_b: Numbers<'py>) -> Result<Array<'py>> {
    let pose: Pose = a_from_b.pose("a_from_b")?;
    arrays::written(py, None, &[6, 6], |out| {
        for j in 0..6 {
            let unit = Twist::from_array(std::array::from_fn(|i| f64::from(u8::from(i == j))));
            for (i, x) in pose.adjoint(unit).to_array().into_iter().enumerate() {
                out[6 * i + j] = x;
            }
        }
    })
}
