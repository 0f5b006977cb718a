//! The class `Constraint`: the velocity constraint of a closed chain.

use cylindroid::closure::{
    ClosedChain, Constraint, ConstraintBlocks, LoopClosureError, MotionSpace, Relation, Unit, Units,
};
use cylindroid::kinematics::State;
use cylindroid::{Error, FrameId, Matrix, Mechanism};
use pyo3::prelude::*;

use super::PyLoopClosureError;
use super::object::object;
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument, entry};
use crate::mechanism::PyMechanism;
use crate::table::{self, Table};

/// The velocity constraint of a closed chain: `Ja qa + Jp qp - G^T u = 0`.
///
/// Created by `Mechanism.constraint`, or from matrices.
///
/// Parameters
/// ----------
/// Ja : array_like, (t, a)
///     Contact velocities per velocity of the actuated joints.
/// Jp : array_like, (t, p), optional
///     Contact velocities per velocity of the passive joints, and of objects other than the
///     reference. Default: none.
/// G : array_like, (d, t), optional
///     Grasp matrix: the wrench on the object per contact force. Default: the identity, as for a
///     serial arm.
/// length : float, optional
///     Characteristic length of rank decisions (m); requires `units`. Default: 1.
/// units : tuple of four str, optional
///     Units of rows, actuated joints, passive columns and the object's components, one letter for
///     each, 'm' or 'r': for example ('mmr', 'rr', 'rr', 'mmr'). Default: all 'r', unscaled.
///
/// Attributes
/// ----------
/// actuated, passive, components : list of str
///     Names of the actuated joints, the passive columns, the components of the object's twist.
/// Ja, Jp, G : ndarray
///     (t, a), (t, p) and (d, t).
/// matrix : ndarray, (t, a + p + d)
///     `[Ja Jp -G^T]`.
/// length : float
///     Characteristic length (m).
/// closure_error : LoopClosureError or None
///     The loop-closure error of the configuration; None for a constraint from matrices.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
///     For blocks of inconsistent shapes, non-finite values, unknown units.
///
/// Notes
/// -----
/// Bicchi and Prattichizzo 1998, eq. 2.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> lever = cy.Constraint([[2.0]], G=[[1.0]])
/// >>> lever.mobility().dof
/// 1
#[pyclass(frozen, name = "Constraint", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyConstraint {
    pub(super) inner: Constraint,
    pub(super) actuated: Vec<String>,
    pub(super) passive: Vec<String>,
    pub(super) units: Units,
    pub(super) origin: Option<Origin>,
}

/// The mechanism, configuration and reference frame of a constraint.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    pub(super) state: State,
    pub(super) reference: FrameId,
    pub(super) closure_error: LoopClosureError,
}

fn units_of(of: Option<&(String, String, String, String)>, c: &Constraint) -> Result<Units> {
    let all = |n: usize| vec![Unit::Angle; n];
    let Some((rows, actuated, passive, object)) = of else {
        return Ok(Units {
            rows: all(c.rows()),
            actuated: all(c.actuated()),
            passive: all(c.passive()),
            object: all(c.object()),
        });
    };
    let letters = |text: &String| {
        let one = |letter: char| match letter {
            'm' => Ok(Unit::Length),
            'r' => Ok(Unit::Angle),
            _ => Err(Failure::option("units", letter, "the letters are 'm' and 'r'")),
        };
        text.chars().map(one).collect::<Result<Vec<Unit>>>()
    };
    Ok(Units {
        rows: letters(rows)?,
        actuated: letters(actuated)?,
        passive: letters(passive)?,
        object: letters(object)?,
    })
}

impl PyConstraint {
    pub(super) fn of(
        mechanism: &Mechanism,
        q: &[f64],
        reference: Option<&str>,
        length: Option<f64>,
    ) -> Result<Self> {
        let frame = reference.map(|name| mechanism.frame(name)).transpose()?;
        let state = mechanism.state(q)?;
        let chain = ClosedChain::of(&state, frame, length)?;
        Ok(Self {
            inner: chain.constraint,
            actuated: chain.actuated,
            passive: chain.passive,
            units: chain.units,
            origin: Some(Origin {
                state,
                reference: chain.reference,
                closure_error: chain.closure_error,
            }),
        })
    }

    /// The mechanism or the shape, for a title.
    pub(super) fn name(&self) -> String {
        match &self.origin {
            Some(origin) => format!("'{}'", origin.state.mechanism().name()),
            None => format!(
                "a constraint of {} actuated and {} passive columns",
                self.inner.actuated(),
                self.inner.passive()
            ),
        }
    }

    pub(super) fn component_names(&self) -> Vec<String> {
        let names: &[&str] = match self.inner.object() {
            3 => &["x", "y", "rz"],
            6 => &["x", "y", "z", "rx", "ry", "rz"],
            _ => &[],
        };
        if names.is_empty() {
            return (1..=self.inner.object()).map(|i| format!("u{i}")).collect();
        }
        names.iter().map(ToString::to_string).collect()
    }

    /// A task map and the names of its rows, from a matrix or from names of components.
    pub(super) fn task(&self, task: &Bound<'_, PyAny>) -> Result<(Matrix, Vec<String>)> {
        let names: Vec<String> = if let Ok(text) = task.extract::<String>() {
            text.split(',').map(|s| s.trim().to_owned()).collect()
        } else if let Ok(names) = task.extract::<Vec<String>>() {
            names
        } else {
            let map = entry::<Numbers<'_>>("task", task)?.matrix("task")?;
            let names = (1..=map.rows()).map(|i| format!("task {i}")).collect();
            return Ok((map, names));
        };
        let known = self.component_names();
        let mut map = Matrix::zeros(names.len(), known.len());
        for (row, name) in names.iter().enumerate() {
            let Some(i) = known.iter().position(|k| k == name) else {
                return Err(Error::unknown("component", name, &known).into());
            };
            map[(row, i)] = 1.0;
        }
        Ok((map, names))
    }

    /// The relation between the actuated joints and the object, or the task `map` of its twist.
    pub(crate) fn relation(&self, map: Option<&Matrix>) -> cylindroid::Result<Relation> {
        let relation = MotionSpace::of(&self.inner).relation();
        match map {
            None => Ok(relation),
            Some(map) => relation.task(map),
        }
    }

    pub(super) fn head(&self, table: &mut Table) {
        table.row("actuated", table::names(&self.actuated));
        table.row("passive", table::names(&self.passive));
        if let Some(origin) = &self.origin {
            let frame = origin.state.mechanism().frame_of(origin.reference);
            table.row("reference", &frame.name);
            let LoopClosureError { distance, angle } = origin.closure_error;
            if !origin.closure_error.is_closed(origin.state.mechanism().reach()) {
                table.row("loops open by", format!("{distance:.1e} m, {angle:.1e} rad"));
            }
        }
    }
}

#[pymethods]
impl PyConstraint {
    #[new]
    #[pyo3(signature = (Ja, Jp = None, G = None, length = None, units = None))]
    #[expect(non_snake_case, reason = "the field's names")]
    fn new(
        Ja: Numbers<'_>,
        Jp: Option<Numbers<'_>>,
        G: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        #[pyo3(from_py_with = argument)] units: Option<(String, String, String, String)>,
    ) -> Result<Self> {
        let actuated = Ja.matrix("Ja")?;
        let passive = match &Jp {
            None => Matrix::zeros(actuated.rows(), 0),
            Some(Jp) => Jp.matrix("Jp")?,
        };
        let grasp = match &G {
            None => Matrix::identity(actuated.rows()),
            Some(G) => G.matrix("G")?,
        };
        let mut inner = Constraint::new(ConstraintBlocks { actuated, passive, grasp })?;
        if length.is_some() && units.is_none() {
            let reason = "a length needs units, to know which rows and columns are lengths";
            return Err(Failure::option("length", "without units", reason));
        }
        let given = units_of(units.as_ref(), &inner)?;
        if units.is_some() {
            inner = inner.with_length(&given, length.unwrap_or(1.0))?;
        }
        let named = |n: usize, letter: &str| (1..=n).map(|i| format!("{letter}{i}")).collect();
        Ok(Self {
            actuated: named(inner.actuated(), "qa"),
            passive: named(inner.passive(), "qp"),
            units: given,
            inner,
            origin: None,
        })
    }

    #[getter]
    fn actuated(&self) -> Vec<String> {
        self.actuated.clone()
    }

    #[getter]
    fn passive(&self) -> Vec<String> {
        self.passive.clone()
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.component_names()
    }

    #[getter]
    #[pyo3(name = "Ja")]
    fn actuated_block<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.blocks().actuated)
    }

    #[getter]
    #[pyo3(name = "Jp")]
    fn passive_block<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.blocks().passive)
    }

    #[getter]
    #[pyo3(name = "G")]
    fn grasp_block<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.blocks().grasp)
    }

    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.matrix())
    }

    #[getter]
    fn length(&self) -> f64 {
        self.inner.length()
    }

    #[getter]
    fn closure_error(&self) -> Option<PyLoopClosureError> {
        self.origin.as_ref().map(|o| o.closure_error.into())
    }
}

table::shown!(PyConstraint);

impl PyConstraint {
    fn table(&self) -> Table {
        let mut table = Table::new(&format!("Constraint of {}", self.name()));
        self.head(&mut table);
        table.row("rows", self.inner.rows().to_string());
        table.row("length", format!("{} m", table::number(self.inner.length())));
        table
    }
}

#[pymethods]
impl PyMechanism {
    /// The velocity constraint of a closed chain (loops, contacts and reference frame):
    /// `Ja qa + Jp qp - G^T u = 0`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n), optional
    ///     Configurations [rad or m]. Default: home.
    /// actuated : list of str, optional
    ///     The actuated joints. Default: those of the file.
    /// reference : str, optional
    ///     The reference frame: its twist is u. Default: that of the file, otherwise the tool.
    /// length : float, optional
    ///     Characteristic length (m). Default: that of the mechanism, `reach`.
    ///
    /// Returns
    /// -------
    /// Constraint, or list of Constraint
    ///     Loops are assumed to be closed; `closure_error` is their loop-closure error.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    #[pyo3(signature = (q = None, actuated = None, reference = None, length = None))]
    fn constraint<'py>(
        &self,
        py: Python<'py>,
        q: Option<Coordinates<'py>>,
        #[pyo3(from_py_with = argument)] actuated: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
    ) -> Result<Bound<'py, PyAny>> {
        let all = self.constraints(py, q.as_ref(), actuated.as_deref(), reference, length)?;
        Ok(object(py, all)?)
    }
}
