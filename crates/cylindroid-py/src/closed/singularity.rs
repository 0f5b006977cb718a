//! The class `Singularity`: the singularities of a configuration (type I, II, III).

use cylindroid::closure::{Diagnosis, MobilityCounts};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::screws::{PyScrew, screw_list};
use crate::table::{self, Table};

/// The singularities of a configuration, with the motions lost and gained as screws (world frame).
///
/// Attributes
/// ----------
/// regular : bool
/// kinds : list of str
///     'type-i' (the object loses motion), 'type-ii' (it gains motion that the actuators do not
///     control), 'type-iii' (both), 'configuration-space' (the mechanism gains a motion), 'passive'
///     (passive joints gain one of their own).
/// descriptions : list of str
///     The same in words.
/// everywhere : list of str
///     The kinds that every configuration of the branch has (architecture singularities); empty
///     where the singularity is one of this configuration.
/// zlatanov : list of str
///     Zlatanov's types: 'RI', 'RO' (redundant input, output), 'II', 'IO' (impossible input,
///     output), 'RPM' (redundant passive motion), 'IIM' (increased instantaneous mobility).
/// structure : str
///     The closed configurations around this one: 'regular', 'bifurcation', 'cone', 'shaky',
///     'shaky-rigid', 'rigid' or 'unknown'.
/// distances : dict
///     Distance to each kind: 0 at a singularity, at most 1 elsewhere, infinite if there is nothing
///     to lose. Keys 'type_i', 'type_ii', 'configuration_space', 'passive'.
/// generic : dict
///     Counts at regular configurations of its branch.
/// compared_with : int
///     Number of other configurations of the branch from which these were computed.
/// blocked : list of Screw
///     Wrenches resisted without torque, beyond the generic ones.
/// lost, gained : list of Screw
///     Motions of the reference frame.
/// redundant : list of str
///     Actuated joints that move with the reference frame at rest, beyond the generic ones.
/// idle : list of str
///     Passive coordinates that move alone, beyond the generic ones.
/// separated : bool
///     False if the generic part could not be separated from the excess.
#[pyclass(frozen, name = "Singularity", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySingularity {
    inner: Diagnosis,
}

impl From<&Diagnosis> for PySingularity {
    fn from(inner: &Diagnosis) -> Self {
        Self { inner: inner.clone() }
    }
}

/// Counts by name.
pub(super) fn counts_of<'py>(
    py: Python<'py>,
    counts: MobilityCounts,
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("rank", counts.rank)?;
    all.set_item("idle", counts.idle)?;
    all.set_item("redundancy", counts.redundancy)?;
    all.set_item("indeterminacy", counts.indeterminacy)?;
    all.set_item("zero_torque", counts.zero_torque)?;
    Ok(all)
}

#[pymethods]
impl PySingularity {
    #[getter]
    fn regular(&self) -> bool {
        self.inner.verdict.is_regular()
    }

    #[getter]
    fn kinds(&self) -> Vec<&'static str> {
        self.inner.verdict.kinds().iter().map(|k| k.name()).collect()
    }

    #[getter]
    fn everywhere(&self) -> Vec<&'static str> {
        self.inner.verdict.everywhere().iter().map(|k| k.name()).collect()
    }

    #[getter]
    fn zlatanov(&self) -> Vec<&'static str> {
        self.inner.verdict.zlatanov().iter().map(|t| t.name()).collect()
    }

    #[getter]
    fn structure(&self) -> &'static str {
        self.inner.verdict.structure().name()
    }

    #[getter]
    fn descriptions(&self) -> Vec<String> {
        self.inner.verdict.kinds().iter().map(ToString::to_string).collect()
    }

    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let d = &self.inner.distances;
        let all = PyDict::new(py);
        all.set_item("type_i", d.type_i)?;
        all.set_item("type_ii", d.type_ii)?;
        all.set_item("configuration_space", d.configuration_space)?;
        all.set_item("passive", d.passive)?;
        Ok(all)
    }

    #[getter]
    fn generic<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        counts_of(py, self.inner.generic.counts)
    }

    #[getter]
    fn compared_with(&self) -> usize {
        self.inner.generic.others
    }

    #[getter]
    fn blocked(&self) -> Vec<PyScrew> {
        screw_list(&self.inner.blocked)
    }

    #[getter]
    fn lost(&self) -> Vec<PyScrew> {
        screw_list(&self.inner.lost)
    }

    #[getter]
    fn gained(&self) -> Vec<PyScrew> {
        screw_list(&self.inner.gained)
    }

    #[getter]
    fn redundant(&self) -> Vec<String> {
        self.inner.redundant.clone()
    }

    #[getter]
    fn idle(&self) -> Vec<String> {
        self.inner.idle.clone()
    }

    #[getter]
    fn separated(&self) -> bool {
        self.inner.separated
    }

    /// True for a singular configuration.
    fn __bool__(&self) -> bool {
        !self.regular()
    }
}

table::shown!(PySingularity);

impl PySingularity {
    fn table(&self) -> Table {
        let mut table = Table::new(if self.regular() {
            "Regular configuration"
        } else {
            "Singular configuration"
        });
        for description in self.descriptions() {
            table.row("kind", description);
        }
        let d = &self.inner.distances;
        for (name, distance) in [
            ("to type I", d.type_i),
            ("to type II", d.type_ii),
            ("to configuration space", d.configuration_space),
            ("to passive", d.passive),
        ] {
            table.row(name, table::number(distance));
        }
        let screws = |screws: &[cylindroid::Screw]| -> Vec<String> {
            let text = |s: &cylindroid::Screw| {
                format!(
                    "along {} through {}, pitch {}",
                    table::list(&s.axis.direction.to_array()),
                    table::list(&s.axis.point.to_array()),
                    table::number(s.pitch)
                )
            };
            screws.iter().map(text).collect()
        };
        for (name, all) in [
            ("blocked wrench", &self.inner.blocked),
            ("lost motion", &self.inner.lost),
            ("gained motion", &self.inner.gained),
        ] {
            for text in screws(all) {
                table.row(name, text);
            }
        }
        if !self.inner.redundant.is_empty() {
            table.row("redundant", table::names(&self.inner.redundant));
        }
        if !self.inner.idle.is_empty() {
            table.row("idle", table::names(&self.inner.idle));
        }
        table
    }
}
