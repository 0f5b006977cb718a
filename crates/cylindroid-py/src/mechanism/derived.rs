//! Mechanisms derived from another one: some joints fixed, another tool.

use pyo3::prelude::*;

use super::{Origin, PyMechanism};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};

#[pymethods]
impl PyMechanism {
    /// The same mechanism with some joints fixed, and with them those that follow them.
    ///
    /// Parameters
    /// ----------
    /// names : sequence of str
    ///     Joints of the tree.
    /// q : array_like, (n,), optional
    ///     Where they are fixed; the other positions become home [rad or m]. Default: home.
    ///
    /// Returns
    /// -------
    /// Mechanism
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     With the nearest names.
    /// InvalidOptionError
    ///     For a joint that follows another or closes a loop.
    /// DimensionError, NotFiniteError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> cy.load("panda").with_fixed_joints(["panda_joint3"]).n
    /// 6
    #[pyo3(signature = (names, q = None))]
    fn with_fixed_joints(
        &self,
        #[pyo3(from_py_with = argument)] names: Vec<String>,
        q: Option<Coordinates<'_>>,
    ) -> Result<Self> {
        let q = self.or_home("q", q.as_ref())?.to_vec();
        let inner = self.inner.with_fixed_joints(&names, &q)?;
        Ok(Self::new(inner, Origin::Fixed { of: Box::new(self.clone()), names, q }))
    }

    /// The same mechanism with another default frame.
    ///
    /// Parameters
    /// ----------
    /// frame : str
    ///     One of `frames`.
    ///
    /// Returns
    /// -------
    /// Mechanism
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     With the nearest names.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> cy.load("panda").with_tool("link4").tool
    /// 'link4'
    #[pyo3(signature = (frame))]
    fn with_tool(&self, #[pyo3(from_py_with = argument)] frame: String) -> Result<Self> {
        let inner = self.inner.with_tool(&frame)?;
        Ok(Self::new(inner, Origin::Tool { of: Box::new(self.clone()), frame }))
    }
}
