//! The class `Joint`.

use pyo3::prelude::*;

use super::PyMechanism;

/// A joint of a mechanism.
///
/// Attributes
/// ----------
/// name, kind, parent, child : str
///     `kind` is 'revolute', 'prismatic', ...; parent and child are links.
/// reversed : bool
///     True if q describes the motion of the parent relative to the child.
/// actuated : bool
/// coordinates : list of str
///     Its entries of q; none for fixed joints, those that follow another or close a loop.
/// mimic : str or None
///     The joint that it follows.
/// closes_loop : bool
#[pyclass(frozen, get_all, name = "Joint", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyJoint {
    name: String,
    kind: &'static str,
    parent: String,
    child: String,
    reversed: bool,
    actuated: bool,
    /// The names of its coordinates; none for fixed joints and those that close loops.
    coordinates: Vec<String>,
    /// The joint that it follows.
    mimic: Option<String>,
    /// True if it closes a loop of the spanning tree.
    closes_loop: bool,
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn joints(&self) -> Vec<PyJoint> {
        let m = &self.inner;
        let link = |i: usize| m.links()[i].name.clone();
        let tree = m.joints().iter().map(|j| PyJoint {
            name: j.name.clone(),
            kind: j.kind.name(),
            parent: link(j.parent),
            child: link(j.child),
            reversed: j.reversed,
            actuated: j.actuated,
            coordinates: match j.mimic {
                Some(_) => Vec::new(),
                None => {
                    m.coordinates()[j.coordinates.clone()].iter().map(|c| c.name.clone()).collect()
                }
            },
            mimic: j.mimic.as_ref().map(|m| m.joint.clone()),
            closes_loop: false,
        });
        let closing = m.loops().iter().map(|l| PyJoint {
            name: l.name.clone(),
            kind: l.kind.name(),
            parent: link(l.a),
            child: link(l.b),
            reversed: false,
            actuated: l.actuated,
            coordinates: Vec::new(),
            mimic: None,
            closes_loop: true,
        });
        tree.chain(closing).collect()
    }
}
