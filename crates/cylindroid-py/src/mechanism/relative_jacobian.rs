//! The Jacobian of one frame relative to another.

use pyo3::prelude::*;

use super::PyMechanism;
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::{Coordinates, Rows};
use crate::error::{Result, argument};

#[pymethods]
impl PyMechanism {
    /// The Jacobian of a tool relative to another frame, which may move: `twist = J @ qd` of the tool
    /// as seen from `base`, its point the tool's origin, its axes those of `base`.
    ///
    /// Joints that carry both have zeros, unless a joint between them follows such a joint.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// base : str
    ///     One of `frames`.
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, n) or (N, 6, n)
    ///     Linear rows first; m/s and rad/s for each unit of joint velocity.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    /// UnknownNameError
    ///     For a name that there is not, with the nearest names.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> panda = cy.load("panda")
    /// >>> bool(panda.relative_jacobian(panda.home, "link4")[:, :4].any())
    /// False
    #[pyo3(signature = (q, base, frame = None, tool = None))]
    fn relative_jacobian<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] base: &str,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let (of, base) = (self.end_effector(frame, tool.as_ref())?, self.inner.frame(base)?);
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        arrays::written_rows(py, rows.count, &[6, self.inner.n()], |i, out| {
            state.set(rows.row(i))?;
            arrays::put_rows(&state.relative_jacobian(of, base)?, out);
            Ok(())
        })
    }
}
