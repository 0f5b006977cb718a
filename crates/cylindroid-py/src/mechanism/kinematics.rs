//! Kinematics: poses, Jacobians and their derivatives, of one configuration or many.

use cylindroid::kinematics::{Chain, KinematicsBatch, OrientationRates};
use cylindroid::{Error, Matrix};
use pyo3::prelude::*;

use super::PyMechanism;
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::{Coordinates, Rows};
use crate::error::{Failure, Result, argument};
use crate::options;
use crate::options::reference_of;
use crate::threads;

/// The columns of a Jacobian of a chain, among those of the whole mechanism, row by row.
fn scatter(local: &Matrix, coordinates: &[usize], n: usize, out: &mut [f64]) {
    for (column, &c) in local.as_slice().as_chunks::<6>().0.iter().zip(coordinates) {
        for (i, x) in column.iter().enumerate() {
            out[i * n + c] = *x;
        }
    }
}

/// True if there are rows that [`KinematicsBatch`] can tell apart.
fn is_batch(rows: &Rows<'_>) -> bool {
    rows.count.is_some() && rows.width > 0
}

impl PyMechanism {
    fn pair<'a>(
        &self,
        q: &'a Coordinates<'_>,
        qd: &'a Coordinates<'_>,
    ) -> Result<(Rows<'a>, Rows<'a>)> {
        let rows = Rows::of(&self.inner, "q", q)?;
        let rates = Rows::of(&self.inner, "qd", qd)?;
        if rows.count != rates.count {
            let words = |r: &Rows<'_>| r.count.map_or("one".to_owned(), |n| n.to_string());
            return Err(Failure::option(
                "qd",
                format!("{} for {} of q", words(&rates), words(&rows)),
                "give as many joint velocities as configurations",
            ));
        }
        Ok((rows, rates))
    }
}

#[pymethods]
impl PyMechanism {
    /// The pose of a frame: `world_from_frame`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    /// out : ndarray, optional
    ///     An array of float64 of the shape of the result, to be written and returned: new memory
    ///     is up to half of the cost of a long batch.
    ///
    /// Returns
    /// -------
    /// ndarray, (4, 4) or (N, 4, 4)
    ///     m.
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
    /// >>> arm = cy.load("3r")
    /// >>> arm.fk([0.0, 0.0, 0.0])[:3, 3]
    /// array([0.8, 0. , 0.4])
    #[pyo3(signature = (q, frame = None, tool = None, out = None))]
    fn fk<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        tool: Option<Numbers<'py>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> Result<Array<'py>> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        let of = self.end_effector(frame, tool.as_ref())?;
        if is_batch(&rows) {
            let batch = KinematicsBatch::new(&self.inner, of)?;
            return threads::written_to(py, out, rows.count, &[4, 4], |out| {
                batch.poses_into(rows.values, out)
            });
        }
        // For one configuration the whole tree costs less than what a chain prepares.
        let mut state = self.inner.state(self.inner.home())?;
        arrays::written_rows_to(py, out, rows.count, &[4, 4], |i, out| {
            state.set(rows.row(i))?;
            arrays::put_pose(state.pose(of)?, out);
            Ok(())
        })
    }

    /// The poses of all frames, in the order of `frames`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    ///
    /// Returns
    /// -------
    /// ndarray, (F, 4, 4) or (N, F, 4, 4)
    ///     `world_from_frame` (m).
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     As `fk`.
    #[pyo3(signature = (q))]
    fn fk_all<'py>(&self, py: Python<'py>, q: Coordinates<'py>) -> Result<Array<'py>> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        let frames = self.inner.frames().len();
        arrays::written_rows(py, rows.count, &[frames, 4, 4], |i, out| {
            state.set(rows.row(i))?;
            for (frame, out) in self.inner.frame_ids().zip(out.chunks_exact_mut(16)) {
                arrays::put_pose(state.pose(frame)?, out);
            }
            Ok(())
        })
    }

    /// The axes of all joints in the world, loop joints included, in the order of `joints`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// side : str
    ///     'parent' or 'child': the link that carries the joint frame. The two differ along the axis
    ///     of a joint that slides, and by the closure error of a loop joint.
    ///
    /// Returns
    /// -------
    /// ndarray, (J, 2, 3) or (N, J, 2, 3)
    ///     The origin of the joint frame (m) and the unit direction of the axis.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite.
    /// UnknownNameError
    ///     For another side.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> r = cy.load("five-bar")
    /// >>> r.joints[-1].name, r.joints[-1].closes_loop
    /// ('q5', True)
    /// >>> r.joint_axes(r.home)[-1, 0]
    /// array([2., 0., 0.])
    #[pyo3(signature = (q, side = "parent"))]
    fn joint_axes<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] side: &str,
    ) -> Result<Array<'py>> {
        let on_parent = match side {
            "parent" => true,
            "child" => false,
            _ => return Err(Error::unknown("side", side, ["parent", "child"]).into()),
        };
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        let count = self.inner.joints().len() + self.inner.loops().len();
        arrays::written_rows(py, rows.count, &[count, 2, 3], |i, out| {
            state.set(rows.row(i))?;
            let axes = state.joint_axes().into_iter().chain(state.loop_joint_axes());
            for (axis, out) in axes.zip(out.chunks_exact_mut(6)) {
                let line = if on_parent { axis.on_parent } else { axis.on_child };
                out[..3].copy_from_slice(&line.point.to_array());
                out[3..].copy_from_slice(&line.direction.to_array());
            }
            Ok(())
        })
    }

    /// The points of all contacts in the world, in the order of `contacts`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    ///
    /// Returns
    /// -------
    /// ndarray, (c, 2, 3) or (N, c, 2, 3)
    ///     The point on the first and on the second link of `contact_links` (m); the two differ by
    ///     the closure error.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> r = cy.load("two-arm")
    /// >>> r.contact_links
    /// [('left/flange', 'box'), ('right/flange', 'box')]
    /// >>> r.contact_points(r.home)[:, 1].mean(0).round(3)
    /// array([0.64 , 0.092, 0.437])
    #[pyo3(signature = (q))]
    fn contact_points<'py>(&self, py: Python<'py>, q: Coordinates<'py>) -> Result<Array<'py>> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        arrays::written_rows(py, rows.count, &[self.inner.contacts().len(), 2, 3], |i, out| {
            state.set(rows.row(i))?;
            for (points, out) in state.contact_points().iter().zip(out.chunks_exact_mut(6)) {
                out[..3].copy_from_slice(&points[0].to_array());
                out[3..].copy_from_slice(&points[1].to_array());
            }
            Ok(())
        })
    }

    /// The Jacobian: twist of the frame = J @ qd, linear rows first.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// reference : str
    ///     'local' (the frame's origin and axes), 'world' (the world's origin and axes) or
    ///     'local_world_aligned' (the frame's origin, the world's axes).
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    /// out : ndarray, optional
    ///     An array of float64 of the shape of the result, to be written and returned: new memory
    ///     is up to half of the cost of a long batch.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, n) or (N, 6, n)
    ///     m/s and rad/s for each unit of rate; columns of joints that do not move the frame are zero.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    /// UnknownNameError
    ///     For a name that there is not, with the nearest names.
    ///
    /// Notes
    /// -----
    /// The words for the references are Pinocchio's. With loops it is the Jacobian of the spanning tree.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> panda = cy.load("panda")
    /// >>> panda.jacobian([panda.home] * 5, reference="local").shape
    /// (5, 6, 7)
    #[pyo3(signature = (q, frame = None, reference = "local_world_aligned", tool = None, out = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        #[pyo3(from_py_with = argument)] reference: &str,
        tool: Option<Numbers<'py>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> Result<Array<'py>> {
        let (n, reference) = (self.inner.n(), reference_of(reference)?);
        let rows = Rows::of(&self.inner, "q", &q)?;
        let of = self.end_effector(frame, tool.as_ref())?;
        if is_batch(&rows) {
            let batch = KinematicsBatch::new(&self.inner, of)?;
            return threads::written_to(py, out, rows.count, &[6, n], |out| {
                batch.jacobians_into(rows.values, reference, out)
            });
        }
        let mut state = self.inner.state(self.inner.home())?;
        let mut whole = Matrix::zeros(6, n);
        arrays::written_rows_to(py, out, rows.count, &[6, n], |i, out| {
            state.set(rows.row(i))?;
            state.jacobian_into(of, reference, &mut whole)?;
            arrays::put_rows(&whole, out);
            Ok(())
        })
    }

    /// The derivative of the Jacobian by every coordinate: `hessian[k]` is dJ/dq_k.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// reference : str
    ///     'local' (the frame's origin and axes), 'world' (the world's origin and axes) or
    ///     'local_world_aligned' (the frame's origin, the world's axes).
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    ///
    /// Returns
    /// -------
    /// ndarray, (n, 6, n) or (N, n, 6, n)
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    /// UnknownNameError
    ///     For a name that there is not, with the nearest names.
    ///
    /// Notes
    /// -----
    /// Haviland and Corke 2020 (arXiv 2010.08686), in screw form. Spherical and free joints: the
    /// derivative along their unit velocities.
    #[pyo3(signature = (q, frame = None, reference = "local_world_aligned", tool = None))]
    fn hessian<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        #[pyo3(from_py_with = argument)] reference: &str,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let (n, reference) = (self.inner.n(), reference_of(reference)?);
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut chain = Chain::new(&self.inner, self.end_effector(frame, tool.as_ref())?)?;
        let mut local = vec![Matrix::zeros(6, chain.n()); chain.n()];
        arrays::written_rows(py, rows.count, &[n, 6, n], |i, out| {
            chain.set(rows.row(i));
            chain.hessian_into(reference, &mut local);
            for (matrix, &k) in local.iter().zip(chain.coordinates()) {
                let out = &mut out[6 * n * k..6 * n * (k + 1)];
                scatter(matrix, chain.coordinates(), n, out);
            }
            Ok(())
        })
    }

    /// The derivative of the Jacobian in time while the coordinates move with `qd`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// qd : array_like, (n,) or (N, n)
    ///     Rates, as many as configurations [rad/s or m/s].
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// reference : str
    ///     'local' (the frame's origin and axes), 'world' (the world's origin and axes) or
    ///     'local_world_aligned' (the frame's origin, the world's axes).
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, n) or (N, 6, n)
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    /// UnknownNameError
    ///     For a name that there is not, with the nearest names.
    #[pyo3(signature = (q, qd, frame = None, reference = "local_world_aligned", tool = None))]
    fn jacobian_dot<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        qd: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        #[pyo3(from_py_with = argument)] reference: &str,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let (n, reference) = (self.inner.n(), reference_of(reference)?);
        let (rows, rates) = self.pair(&q, &qd)?;
        let of = self.end_effector(frame, tool.as_ref())?;
        let mut state = self.inner.state(self.inner.home())?;
        arrays::written_rows(py, rows.count, &[6, n], |i, out| {
            state.set(rows.row(i))?;
            arrays::put_rows(&state.jacobian_dot(rates.row(i), of, reference)?, out);
            Ok(())
        })
    }

    /// The Jacobian of position and angles instead of position and angular velocity, world axes.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// angles : str
    ///     'rpy' (about fixed x, y, z), 'zyz' or 'xyz' (Euler angles) or 'rotation_vector'.
    /// frame : str, optional
    ///     One of `frames`. Default: `tool`.
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, n) or (N, 6, n)
    ///     Where the angles are singular (gimbal lock) the angle rows hold the least-squares rates.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     For a q of the wrong size or with an entry that is not finite, naming the joint.
    /// UnknownNameError
    ///     For a name that there is not, with the nearest names.
    #[pyo3(signature = (q, angles = "rpy", frame = None, tool = None))]
    fn analytical_jacobian<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] angles: &str,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        const ANGLES: [(&str, OrientationRates); 4] = [
            ("rpy", OrientationRates::Rpy),
            ("zyz", OrientationRates::Zyz),
            ("xyz", OrientationRates::Xyz),
            ("rotation_vector", OrientationRates::RotationVector),
        ];
        let n = self.inner.n();
        let rates = options::named("angles", angles, &ANGLES)?;
        let rows = Rows::of(&self.inner, "q", &q)?;
        let of = self.end_effector(frame, tool.as_ref())?;
        let mut state = self.inner.state(self.inner.home())?;
        arrays::written_rows(py, rows.count, &[6, n], |i, out| {
            state.set(rows.row(i))?;
            arrays::put_rows(&state.analytical_jacobian(of, rates)?.matrix, out);
            Ok(())
        })
    }

    /// `q` moved by constant joint velocities for `dt` seconds.
    ///
    /// `q + dt * qd`, with rotation vectors and free bodies moved on their group.
    ///
    /// Parameters
    /// ----------
    /// q, qd : array_like, (n,) or (N, n)
    ///     Coordinates and as many velocities.
    /// dt : float
    ///     Time (s).
    ///
    /// Returns
    /// -------
    /// ndarray, (n,) or (N, n)
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (q, qd, dt))]
    fn integrate<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        qd: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] dt: f64,
    ) -> Result<Array<'py>> {
        let n = self.inner.n();
        let (rows, rates) = self.pair(&q, &qd)?;
        Error::check_finite("dt", &[dt])?;
        arrays::written_rows(py, rows.count, &[n], |i, out| {
            out.copy_from_slice(&self.inner.integrate(rows.row(i), rates.row(i), dt)?);
            Ok(())
        })
    }
}
