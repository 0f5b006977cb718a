//! The mobility report: degrees of freedom, redundancy, idle motions, hyperstatic forces.

use std::sync::OnceLock;

use cylindroid::closure::{
    Diagnosis, LimbScrews, Mobility, Subspace, Transmission, internal_forces,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::object::object;
use super::{
    PyConstraint, PyFiniteMobility, PyLimb, PyLoopClosureError, PySingularity, PyTransmission,
};
use crate::arrays::{self, Array};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument};
use crate::mechanism::PyMechanism;
use crate::table::{self, Table};

/// The motions of a mechanism and the wrenches that its structure resists: every kind counted, with
/// a basis.
///
/// Attributes
/// ----------
/// dof : int
///     Degrees of freedom to first order, idle ones included.
/// redundancy : int
///     Motions of actuated joints that leave the reference frame at rest.
/// indeterminacy : int
///     Motions of the reference frame with actuated joints at rest.
/// coordinate : int
///     Motions of the reference frame that the actuated joints control.
/// internal : int
///     Torques of actuated joints that balance each other.
/// zero_torque : int
///     Wrenches on the reference frame resisted without torque.
/// internal_forces : int
///     dim ker G: forces in loops and contacts without a wrench on the reference frame. Depends on
///     which joints are written as contacts; `internal` does not.
/// hyperstatic : int
///     Forces in loops and contacts that equilibrium does not determine.
/// idle : int
///     Motions of passive joints alone.
/// gruebler_kutzbach : int
///     Grubler's count, for comparison.
/// rank_gap : float
///     Smallest singular value kept over the largest dropped: near 1 the counts are numerically
///     ambiguous.
/// dof_basis : ndarray, (a + p + d, dof)
///     Motions: actuated joints, passive ones, components of the reference frame.
/// idle_basis : ndarray, (a + p + d, idle)
/// internal_basis : ndarray, (a, internal)
///     Torques.
/// zero_torque_basis : ndarray, (d, zero_torque)
///     Wrenches, force first.
/// hyperstatic_basis : ndarray, (t, hyperstatic)
/// blocks : dict of str to ndarray, (a + p + d, k)
///     The motions by what moves, rows as of `dof_basis` (equations 3 to 5 of the paper):
///     'redundancy' (Gamma_r), 'idle' (Gamma_p,i), 'mixed' (Gamma_pu,i over Gamma_up,i),
///     'uncontrollable' (Gamma_u,i), 'coordinate_passive' (Gamma_ap,c over Gamma_pa,c),
///     'coordinate_both' (Gamma_apu,c, Gamma_pua,c, Gamma_upa,c), 'coordinate_object' (Gamma_au,c
///     over Gamma_ua,c). The numbers of their columns add up to `dof` and `coordinate_overlap`.
/// coordinate_overlap : int
///     Motions that are in 'coordinate_passive' and in 'coordinate_object'.
/// internal_forces_basis : ndarray, (t, internal_forces)
/// joints : list of JointMobility
/// ambiguous_ranks : list of str
///     Numerically ambiguous counts, in words.
/// singularity : Singularity or None
///     The singularities of the configuration; None for bare matrices. Computed on first access.
/// finite : FiniteMobility or None
///     The motions beyond first order.
/// finite_dof : int or None
///     Degrees of freedom of finite motion; None if unknown.
/// limbs : list of Limb or None
///     The limbs between ground and reference link; None for bare matrices.
/// transmission : Transmission or None
///     Transmission indices; None for bare matrices and where they are not defined: fewer than two
///     limbs, structures, or another number of actuated joints than of freedoms of the platform.
/// actuated, passive, components : list of str
/// closure_error : LoopClosureError or None
///     Loop-closure error: the report is valid where the loops are closed.
/// length : float
///     Characteristic length of the rank decisions (m).
#[pyclass(frozen, name = "Mobility", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyMobility {
    inner: Mobility,
    constraint: PyConstraint,
    diagnosis: OnceLock<Diagnosis>,
}

/// Mobility of a joint.
///
/// Attributes
/// ----------
/// name : str
/// moves : bool
///     False if the geometry locks it.
/// share : float
///     Its largest share in a motion of unit length (scaled), between 0 and 1.
/// free : bool
///     True if it can move with all actuated joints at rest.
/// idle : bool
///     True if it can move with the actuated joints and the reference frame at rest.
#[pyclass(frozen, get_all, name = "JointMobility", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyJointMobility {
    name: String,
    moves: bool,
    share: f64,
    free: bool,
    idle: bool,
}

#[pymethods]
impl PyJointMobility {
    fn __repr__(&self) -> String {
        format!("<{}: {}>", self.name, self.words())
    }
}

impl PyJointMobility {
    fn words(&self) -> &'static str {
        match (self.moves, self.idle, self.free) {
            (false, ..) => "locked",
            (true, true, _) => "moves, spins alone",
            (true, false, true) => "moves, also with the actuators at rest",
            (true, false, false) => "moves",
        }
    }
}

table::shown!(PyMobility);

impl PyMobility {
    pub(super) fn of(constraint: &PyConstraint) -> Self {
        Self {
            inner: Mobility::of(&constraint.inner),
            constraint: constraint.clone(),
            diagnosis: OnceLock::new(),
        }
    }

    fn diagnosis(&self, py: Python<'_>) -> Result<Option<&Diagnosis>> {
        let Some(origin) = &self.constraint.origin else { return Ok(None) };
        if let Some(known) = self.diagnosis.get() {
            return Ok(Some(known));
        }
        let length = self.constraint.inner.length();
        let found =
            py.detach(|| Diagnosis::of(&origin.state, Some(origin.reference), Some(length)))?;
        Ok(Some(self.diagnosis.get_or_init(|| found)))
    }

    fn screws(&self, py: Python<'_>) -> Result<Option<LimbScrews>> {
        let Some(origin) = &self.constraint.origin else { return Ok(None) };
        let length = self.constraint.inner.length();
        Ok(Some(py.detach(|| LimbScrews::of(&origin.state, Some(origin.reference), Some(length)))?))
    }

    fn basis<'py>(py: Python<'py>, of: &Subspace) -> Result<Array<'py>> {
        arrays::matrix(py, &of.basis)
    }

    fn table(&self) -> Table {
        let m = &self.inner;
        let mut table = Table::new(&format!("Mobility of {}", self.constraint.name()));
        self.constraint.head(&mut table);
        let gap = m.dof.cut.rank.gap;
        let gap = if gap.is_infinite() {
            "a clear rank".to_owned()
        } else {
            format!("rank gap {}", table::number(gap))
        };
        table.row("dof", format!("{} to first order ({gap})", m.dof.dimension()));
        for (name, count) in [
            ("coordinate", m.relation.coordinate),
            ("redundancy", m.relation.redundancy),
            ("indeterminacy", m.relation.indeterminacy),
            ("idle", m.idle.dimension()),
            ("internal", m.internal.dimension()),
            ("zero_torque", m.zero_torque.dimension()),
            ("internal_forces", self.internal_forces()),
            ("hyperstatic", m.hyperstatic.dimension()),
        ] {
            table.row(name, count.to_string());
        }
        for block in m.blocks() {
            let name = format!("block {}", block.name);
            table.row(&name, format!("{} ({})", block.motions.dimension(), block.symbol));
        }
        table.row("gruebler_kutzbach", m.gruebler_kutzbach.to_string());
        for joint in self.joints() {
            table.row(&joint.name, joint.words());
        }
        for doubt in &m.ambiguous_ranks {
            table.row("doubtful", doubt.to_string());
        }
        table
    }
}

#[pymethods]
impl PyMobility {
    #[getter]
    fn dof(&self) -> usize {
        self.inner.dof.dimension()
    }

    #[getter]
    fn redundancy(&self) -> usize {
        self.inner.relation.redundancy
    }

    #[getter]
    fn indeterminacy(&self) -> usize {
        self.inner.relation.indeterminacy
    }

    #[getter]
    fn coordinate(&self) -> usize {
        self.inner.relation.coordinate
    }

    #[getter]
    fn internal(&self) -> usize {
        self.inner.internal.dimension()
    }

    #[getter]
    fn zero_torque(&self) -> usize {
        self.inner.zero_torque.dimension()
    }

    #[getter]
    fn hyperstatic(&self) -> usize {
        self.inner.hyperstatic.dimension()
    }

    #[getter]
    fn idle(&self) -> usize {
        self.inner.idle.dimension()
    }

    #[getter]
    fn gruebler_kutzbach(&self) -> i64 {
        self.inner.gruebler_kutzbach
    }

    #[getter]
    fn rank_gap(&self) -> f64 {
        self.inner.dof.cut.rank.gap
    }

    #[getter]
    fn dof_basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Self::basis(py, &self.inner.dof)
    }

    #[getter]
    fn idle_basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Self::basis(py, &self.inner.idle)
    }

    #[getter]
    fn internal_basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Self::basis(py, &self.inner.internal)
    }

    #[getter]
    fn zero_torque_basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Self::basis(py, &self.inner.zero_torque)
    }

    #[getter]
    fn hyperstatic_basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Self::basis(py, &self.inner.hyperstatic)
    }

    #[getter]
    fn internal_forces(&self) -> usize {
        internal_forces(&self.constraint.inner).dimension()
    }

    #[getter]
    fn internal_forces_basis<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Self::basis(py, &internal_forces(&self.constraint.inner))
    }

    #[getter]
    fn blocks<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for block in self.inner.blocks() {
            all.set_item(block.name, Self::basis(py, block.motions)?)?;
        }
        Ok(all)
    }

    #[getter]
    fn coordinate_overlap(&self) -> usize {
        self.inner.coordinate_kinds.overlap
    }

    #[getter]
    fn joints(&self) -> Vec<PyJointMobility> {
        let names = self.constraint.actuated.iter().chain(&self.constraint.passive);
        let one = |(name, j): (&String, &cylindroid::closure::JointMobility)| PyJointMobility {
            name: name.clone(),
            moves: j.moves,
            share: j.share,
            free: j.free_of_actuators,
            idle: j.idle,
        };
        names.zip(&self.inner.joints).map(one).collect()
    }

    #[getter]
    fn ambiguous_ranks(&self) -> Vec<String> {
        self.inner.ambiguous_ranks.iter().map(ToString::to_string).collect()
    }

    #[getter]
    fn singularity(&self, py: Python<'_>) -> Result<Option<PySingularity>> {
        Ok(self.diagnosis(py)?.map(PySingularity::from))
    }

    #[getter]
    fn finite(&self, py: Python<'_>) -> Result<Option<PyFiniteMobility>> {
        Ok(self.diagnosis(py)?.map(|d| PyFiniteMobility::from(&d.finite)))
    }

    #[getter]
    fn finite_dof(&self, py: Python<'_>) -> Result<Option<usize>> {
        Ok(self.diagnosis(py)?.and_then(|d| d.finite.finite))
    }

    #[getter]
    fn limbs(&self, py: Python<'_>) -> Result<Option<Vec<PyLimb>>> {
        Ok(self.screws(py)?.map(|s| s.limbs.iter().map(PyLimb::from).collect()))
    }

    #[getter]
    fn transmission(&self, py: Python<'_>) -> Result<Option<PyTransmission>> {
        let (Some(screws), Some(found)) = (self.screws(py)?, self.diagnosis(py)?) else {
            return Ok(None);
        };
        Ok(Transmission::of(&screws, &found.generic).map(PyTransmission::from))
    }

    #[getter]
    fn actuated(&self) -> Vec<String> {
        self.constraint.actuated.clone()
    }

    #[getter]
    fn passive(&self) -> Vec<String> {
        self.constraint.passive.clone()
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.constraint.component_names()
    }

    #[getter]
    fn closure_error(&self) -> Option<PyLoopClosureError> {
        self.constraint.origin.as_ref().map(|o| o.closure_error.into())
    }

    #[getter]
    fn length(&self) -> f64 {
        self.constraint.inner.length()
    }
}

#[pymethods]
impl PyConstraint {
    /// Its motions, and the wrenches that its structure resists.
    ///
    /// Returns
    /// -------
    /// Mobility
    fn mobility(&self, py: Python<'_>) -> PyMobility {
        py.detach(|| PyMobility::of(self))
    }
}

#[pymethods]
impl PyMechanism {
    /// The motions of the mechanism: redundant, idle and overconstrained joints.
    ///
    /// Parameters
    /// ----------
    /// q, actuated, reference, length
    ///     As `constraint`.
    ///
    /// Returns
    /// -------
    /// Mobility, or list of Mobility
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///
    /// Notes
    /// -----
    /// Bicchi and Prattichizzo 1998. Counts come from ranks, never from Grubler's formula.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> report = cy.load("five-bar").mobility()
    /// >>> report.dof, report.redundancy, report.hyperstatic
    /// (2, 0, 0)
    #[pyo3(signature = (q = None, actuated = None, reference = None, length = None))]
    fn mobility<'py>(
        &self,
        py: Python<'py>,
        q: Option<Coordinates<'py>>,
        #[pyo3(from_py_with = argument)] actuated: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
    ) -> Result<Bound<'py, PyAny>> {
        let all = self.constraints(py, q.as_ref(), actuated.as_deref(), reference, length)?;
        let reports = py.detach(|| all.try_map(|c| Ok::<_, Failure>(PyMobility::of(c))))?;
        Ok(object(py, reports)?)
    }
}
