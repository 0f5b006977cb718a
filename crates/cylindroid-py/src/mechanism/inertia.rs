//! The inertia of joints: mass matrix, and what the actuated joints of a closed chain move.

use cylindroid::Matrix;
use cylindroid::kinematics::MassMatrix;
use cylindroid::manipulability::actuated_inertia;
use pyo3::prelude::*;

use super::PyMechanism;
use crate::arrays::{self, Array};
use crate::coordinates::{Coordinates, Rows};
use crate::error::Result;

#[pymethods]
impl PyMechanism {
    /// The mass matrix of the joints: `qd @ M @ qd` is twice the kinetic energy.
    ///
    /// From the masses of the model (composite-rigid-body algorithm); loops are open. As a metric of
    /// joint velocities: `hyperbolic(J, h, joint_metric=M)`, `inverse(J, joint_weights=M)`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    ///
    /// Returns
    /// -------
    /// ndarray, (n, n) or (N, n, n)
    ///     In kg, kg m and kg m^2.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     For moving links without mass, naming them.
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    #[pyo3(signature = (q))]
    fn mass_matrix<'py>(&self, py: Python<'py>, q: Coordinates<'py>) -> Result<Array<'py>> {
        self.inner.check_masses()?;
        let n = self.inner.n();
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        let (mut evaluator, mut mass) = (MassMatrix::new(&self.inner), Matrix::zeros(n, n));
        arrays::written_rows(py, rows.count, &[n, n], |i, out| {
            state.set(rows.row(i))?;
            evaluator.evaluate(&state, &mut mass)?;
            arrays::put_rows(&mass, out);
            Ok(())
        })
    }

    /// The inertia of the whole mechanism as its actuated joints see it: `qd @ W @ qd` is twice the
    /// least kinetic energy with velocities qd of the actuated joints.
    ///
    /// For a serial arm the mass matrix. In closed chains that of the tree on the motions that the
    /// loops permit; motions that the actuated joints do not control follow with the least energy.
    /// Velocities that the loops forbid have the mean of the others.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Closed configurations, in the order of `joint_names` [rad or m].
    ///
    /// Returns
    /// -------
    /// ndarray, (a, a) or (N, a, a)
    ///     In the order of `constraint().actuated`.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     For moving links without mass, naming them.
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    #[pyo3(signature = (q))]
    fn actuated_inertia<'py>(&self, py: Python<'py>, q: Coordinates<'py>) -> Result<Array<'py>> {
        let loops = self.inner.loops().iter().filter(|l| l.actuated).count();
        let a = self.inner.actuated().count() + loops;
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        arrays::written_rows(py, rows.count, &[a, a], |i, out| {
            state.set(rows.row(i))?;
            arrays::put_rows(&actuated_inertia(&state)?, out);
            Ok(())
        })
    }
}
