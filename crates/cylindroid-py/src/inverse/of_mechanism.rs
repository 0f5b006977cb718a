//! The inverse of the Jacobian of a frame, by name.

use cylindroid::control::InverseSelection;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyInverse, parameters_of};
use crate::arrays::{Many, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::options;

#[pymethods]
impl PyMechanism {
    /// The inverse of the Jacobian of a frame: joint velocities = `matrix @ twist`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     Configuration [rad or m].
    /// method : str
    ///     A name of `inverse_methods()`.
    /// twist : array_like, (6,), optional
    ///     The twist to be inverted, linear part first [m/s, rad/s]; it matters to
    ///     'selectively-damped' alone.
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// reference : str
    ///     'local' (the frame's origin and axes), 'world' (the world's origin and axes) or
    ///     'local_world_aligned' (the frame's origin, the world's axes).
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    /// length : float, optional
    ///     Characteristic length that divides the linear rows (m); of hyperbolic inverses it decides
    ///     the existence alone. Default: `reach`.
    /// give_up : list of str or array_like, (k, 6), optional
    ///     Motions of the tool, in its axes, that may be given up ('oblique').
    /// **parameters : float
    ///     Parameters of the method; the others keep their defaults.
    ///
    /// Returns
    /// -------
    /// Inverse
    ///     Its matrix is (n, 6). In a closed chain the joint velocities keep the loops closed to
    ///     first order, with the least motion of the actuated joints. Singular values, rank and
    ///     truncated directions are those of the scaled task [v / length; w].
    ///
    /// Raises
    /// ------
    /// UnknownNameError, InvalidOptionError, DimensionError, NotFiniteError
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np
    /// >>> import cylindroid as cy
    /// >>> arm = cy.load("ur5e")
    /// >>> q = arm.home + 0.2
    /// >>> inverse = arm.inverse(q, eps=1e-6)
    /// >>> np.allclose(arm.jacobian(q) @ inverse.matrix, np.eye(6))
    /// True
    #[pyo3(signature = (q, method = "truncated", *, twist = None, frame = None,
        reference = "local_world_aligned", tool = None, length = None, give_up = None,
        **parameters))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn inverse(
        &self,
        q: Coordinates<'_>,
        #[pyo3(from_py_with = argument)] method: &str,
        twist: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        #[pyo3(from_py_with = argument)] reference: &str,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        give_up: Option<Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> Result<PyInverse> {
        let parameters = parameters_of("inverse", parameters)?;
        let complement = give_up.map(|g| options::twists("give_up", &g)).transpose()?;
        let complement = complement.unwrap_or_default();
        let selection = InverseSelection { name: method, parameters, complement, fallback: None };
        let choice = selection.choice(length.unwrap_or(self.inner.reach()))?;
        let of = self.end_effector(frame, tool.as_ref())?;
        let reference = options::reference_of(reference)?;
        let twist = twist.map(|t| t.twist("twist")).transpose()?;
        let state = self.inner.state(q.vector(&self.inner, "q")?)?;
        let inverse = choice.inverse(&state, of, reference, twist)?;
        let jacobian = state.jacobian(of, reference)?;
        Ok(PyInverse::new(&Many::One(jacobian), Many::One(inverse), (6, self.inner.n())))
    }
}
