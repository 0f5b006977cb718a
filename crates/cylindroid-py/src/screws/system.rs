//! The class `ScrewSystem`: class, frame, principal screws, sums and intersections.

use cylindroid::closure::frame_twists;
use cylindroid::screws::{self, ScrewSystem};
use cylindroid::{Error, Twist};
use pyo3::prelude::*;

use super::pitch::check_pitch;
use super::{PyScrew, scale_of, screw_list};
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count};
use crate::mechanism::PyMechanism;
use crate::table::{self, Table};

/// A screw system: the subspace spanned by twists, with its Gibson-Hunt class, principal screws and
/// canonical frame.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first, of one frame.
/// length : float, optional
///     Characteristic length L (m): the reach of an arm. Default: 1.
/// center : array_like, (3,), optional
///     The reference point of rank decisions (m). Default: the point nearest to all axes.
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
///     A description of systems of this class.
/// principal_pitches : ndarray
///     Pitches at which the hyperbolic pseudoinverse ceases to exist, largest first [m/rad].
/// principal_screws : list of Screw
/// canonical_pose : ndarray, (4, 4)
///     The frame of the normal form, in the frame of the twists (m).
/// pitches : ndarray
///     Pitches of the normal form [m/rad].
/// slope : float or None
///     The p of classes IB, IB0 and IC.
/// residual : float
///     Sine of the angle between the system and its normal form.
/// margins : list of Margin
///     The quantities that decide the class.
/// ambiguous : bool
///     True if one of them is so near to its threshold that the class is numerically ambiguous.
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

#[pymethods]
impl PyScrewSystem {
    #[new]
    #[pyo3(signature = (J, length = None, center = None, noise = None))]
    #[expect(non_snake_case, reason = "the field's name")]
    fn new(
        J: Numbers<'_>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        center: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] noise: Option<f64>,
    ) -> Result<Self> {
        let options = scale_of(length, center.as_ref(), noise)?;
        Ok(Self { inner: ScrewSystem::of_columns(&J.twist_columns("J")?, &options)? })
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
        self.inner.normal_form().meaning()
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
        arrays::twists(py, &self.inner.basis())
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

    /// The reciprocal screw system: the screws of all wrenches that do no work on this system.
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
    ///     [m/rad], or infinite for the form at infinity.
    ///
    /// Returns
    /// -------
    /// ScrewSystem
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a NaN.
    #[pyo3(signature = (h))]
    fn h_reciprocal(&self, #[pyo3(from_py_with = argument)] h: f64) -> Result<Self> {
        check_pitch(h)?;
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
    fn sum(&self, #[pyo3(from_py_with = argument)] other: PyRef<'_, Self>) -> Self {
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
    fn intersection(&self, #[pyo3(from_py_with = argument)] other: PyRef<'_, Self>) -> Self {
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

    /// The sine of the largest angle between a twist of this system and another system.
    ///
    /// Parameters
    /// ----------
    /// other : ScrewSystem
    ///
    /// Returns
    /// -------
    /// float
    ///     Zero if this system lies in the other.
    #[pyo3(signature = (other))]
    fn sine_to_system(&self, #[pyo3(from_py_with = argument)] other: PyRef<'_, Self>) -> f64 {
        self.inner.sine_to_system(&other.inner)
    }

    /// The screws of a two-system (of the reciprocal system for order four): its cylindroid.
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///
    /// Returns
    /// -------
    /// list of Screw
    ///     `count` screws, from one generator of the normal form to the other and on to the first;
    ///     empty for systems of other orders.
    ///
    /// Notes
    /// -----
    /// Ball 1900, chapter II.
    #[pyo3(signature = (count))]
    fn pencil(&self, #[pyo3(from_py_with = count)] count: usize) -> Vec<PyScrew> {
        screw_list(&self.inner.pencil(count))
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
}

table::shown!(PyScrewSystem);

impl PyScrewSystem {
    fn table(&self) -> Table {
        let s = &self.inner;
        let mut table = Table::new(&format!("ScrewSystem of order {}", s.order()));
        let of = if matches!(s.order(), 4 | 5) { "reciprocal system: " } else { "" };
        table.row("class", format!("{}, {of}{}", s.class(), s.normal_form().meaning()));
        table.row("principal pitches", table::list(&s.principal_pitches()));
        table.row("origin", table::list(&s.canonical_pose().translation.to_array()));
        if s.is_ambiguous() {
            table.row("ambiguous", "a quantity lies near its threshold, see margins");
        }
        table
    }
}

#[pymethods]
impl PyMechanism {
    /// The screw system of a frame: of the joints that move it, in a closed chain of the motions
    /// that its loops permit.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,), optional
    ///     Configuration [rad or m]. Default: home.
    /// frame : str, optional
    ///     Default: the tool.
    /// length, center, noise
    ///     As `ScrewSystem`; the length is that of the mechanism by default.
    ///
    /// Returns
    /// -------
    /// ScrewSystem
    ///     In the world frame.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///
    /// Examples
    /// --------
    /// The platform of a delta robot only translates.
    ///
    /// >>> import cylindroid as cy
    /// >>> system = cy.load("delta").screw_system()
    /// >>> system.rank, system.meaning
    /// (3, 'all translations')
    #[pyo3(signature = (q = None, frame = None, length = None, center = None, noise = None))]
    fn screw_system(
        &self,
        q: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        center: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] noise: Option<f64>,
    ) -> Result<PyScrewSystem> {
        let mechanism = &self.inner;
        let length = length.unwrap_or(mechanism.reach());
        let options = scale_of(Some(length), center.as_ref(), noise)?;
        let q = match &q {
            Some(q) => q.vector(mechanism, "q")?.to_vec(),
            None => mechanism.home().to_vec(),
        };
        let of = self.end_effector(frame, None)?;
        let twists = frame_twists(&mechanism.state(&q)?, of)?;
        Ok(PyScrewSystem { inner: ScrewSystem::of(&twists, &options)? })
    }
}
