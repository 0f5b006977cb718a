//! The class `Mechanism`: a model and its kinematics.

use std::path::{Path, PathBuf};

use cylindroid::kinematics::{Chain, OrientationRates};
use cylindroid::model::{Dimension, formats};
use cylindroid::{EndEffector, Error, Matrix, Mechanism, Pose, Reference};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers, Rows};
use crate::error::{Failure, Result};
use crate::table::{self, Table};

/// A robot or mechanism, immutable; from `load` or `parse`.
///
/// Attributes
/// ----------
/// name : str
/// n : int
///     Number of coordinates: entries of q and of the rates.
/// joint_names : list of str
///     Names of the coordinates, in the order of q.
/// units : list of str
///     'rad' or 'm' for each coordinate.
/// frames : list of str
///     Those of the links first, then named ones.
/// links : list of str
/// joints : list of Joint
/// contacts : list of str
/// actuated : list of str
///     The coordinates (and joints that close loops) that motors drive.
/// lower, upper, velocity_limit, acceleration_limit, effort_limit : ndarray, (n,)
///     Infinite where the file gives none [rad or m, /s, /s^2, N m or N].
/// home : ndarray, (n,)
///     The file's home configuration, else zero, and the middle of limits that exclude zero.
/// tool : str
///     The frame that is meant where none is named.
/// reference : str
///     The frame whose motion is the goal of a closed chain.
/// reach : float
///     Characteristic length (m): the longest way from the base to a frame along the links.
/// is_closed : bool
///     True if loops or contacts constrain q.
/// dimension : int
///     2 in the plane x-y, else 3.
/// report : LoadReport
///     What was read and what was not used.
#[pyclass(frozen, name = "Mechanism", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyMechanism {
    pub(crate) inner: Mechanism,
}

/// A joint of a mechanism.
///
/// Attributes
/// ----------
/// name, kind, parent, child : str
///     `kind` is 'revolute', 'prismatic', ...; parent and child are links.
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
    actuated: bool,
    /// The names of its coordinates; none for fixed joints and those that close loops.
    coordinates: Vec<String>,
    /// The joint that it follows.
    mimic: Option<String>,
    /// True if it closes a loop of the spanning tree.
    closes_loop: bool,
}

/// What a loader read and what it did not use.
///
/// Attributes
/// ----------
/// format, source : str
/// ignored : list of (int, str, str)
///     Line (0 where it has none), what, and why.
#[pyclass(frozen, get_all, name = "LoadReport", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyLoadReport {
    format: &'static str,
    source: String,
    /// Line, what, why.
    ignored: Vec<(usize, String, String)>,
}

#[pymethods]
impl PyLoadReport {
    fn __repr__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }
}

impl PyLoadReport {
    fn table(&self) -> Table {
        let mut table = Table::new("LoadReport");
        table.row("format", self.format);
        table.row("source", &self.source);
        table.row("ignored", self.ignored.len().to_string());
        for (line, what, why) in &self.ignored {
            table.row(&format!("line {line}"), format!("{what}: {why}"));
        }
        table
    }
}

/// Loads a model.
///
/// Parameters
/// ----------
/// model : str or os.PathLike
///     The name of a catalogue model (see `catalogue`), or the path of a file: URDF, MJCF, SDF, or a
///     mechanism file in TOML.
///
/// Returns
/// -------
/// Mechanism
///
/// Raises
/// ------
/// UnknownNameError
///     For a name that is neither, with the nearest names.
/// MissingFileError, UnreadableFileError
/// ModelFileError
///     For a file that cannot be understood, with line and column.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.load("panda")
/// <Mechanism 'panda': 7 coordinates, tool 'hand_tcp'>
/// >>> cy.load("pnda")
/// Traceback (most recent call last):
///     ...
/// cylindroid._errors.UnknownNameError: no catalogue model or file named 'pnda'; nearest: panda, ...
#[pyfunction]
#[pyo3(signature = (model))]
pub(crate) fn load(py: Python<'_>, model: PathBuf) -> Result<PyMechanism> {
    let name = model.to_string_lossy().into_owned();
    let inner = py.detach(|| cylindroid::load(&name))?;
    Ok(PyMechanism { inner })
}

/// Reads a model from text.
///
/// Parameters
/// ----------
/// text : str
/// format : str
///     'urdf', 'mjcf', 'sdf' or 'toml' (a mechanism file).
/// path : str or os.PathLike, optional
///     For messages, and to find meshes and files that the text includes.
///
/// Returns
/// -------
/// Mechanism
///
/// Raises
/// ------
/// UnknownNameError
///     For another format.
/// ModelFileError
///     With line and column.
#[pyfunction]
#[pyo3(signature = (text, format = "urdf", path = None))]
pub(crate) fn parse(
    py: Python<'_>,
    text: &str,
    format: &str,
    path: Option<PathBuf>,
) -> Result<PyMechanism> {
    let path = path.unwrap_or_else(|| PathBuf::from("<text>"));
    type Reader = fn(&str, &Path) -> cylindroid::Result<Mechanism>;
    let readers: [(&str, Reader); 4] = [
        ("urdf", formats::urdf::parse),
        ("mjcf", formats::mjcf::parse),
        ("sdf", formats::sdf::parse),
        ("toml", formats::toml::parse),
    ];
    let Some((_, read)) = readers.iter().find(|(name, _)| *name == format) else {
        return Err(Error::unknown("format", format, readers.iter().map(|r| r.0)).into());
    };
    Ok(PyMechanism { inner: py.detach(|| read(text, &path))? })
}

/// The models inside the package.
///
/// Returns
/// -------
/// list of (str, str, str)
///     Name, what it is, where its numbers come from.
#[pyfunction]
pub(crate) fn catalogue() -> Vec<(&'static str, String, String)> {
    let entries = cylindroid::catalogue::entries();
    entries.into_iter().map(|e| (e.name, e.description, e.source)).collect()
}

pub(crate) fn reference_of(name: &str) -> Result<Reference> {
    match Reference::NAMES.iter().find(|(known, _)| *known == name) {
        Some((_, reference)) => Ok(*reference),
        None => {
            let known = Reference::NAMES.iter().map(|(name, _)| *name);
            Err(Error::unknown("reference", name, known).into())
        }
    }
}

impl PyMechanism {
    pub(crate) fn end_effector(
        &self,
        frame: Option<&str>,
        tool: Option<&Numbers<'_>>,
    ) -> Result<EndEffector> {
        let frame = match frame {
            None => self.inner.tool(),
            Some(name) => self.inner.frame(name)?,
        };
        let frame_from_tool = match tool {
            None => Pose::IDENTITY,
            Some(tool) => tool.pose("tool")?,
        };
        Ok(EndEffector { frame, frame_from_tool })
    }

    /// The places of coordinates by their names.
    pub(crate) fn places(&self, names: &[String]) -> Result<Vec<usize>> {
        let known: Vec<&str> = self.inner.coordinates().iter().map(|c| c.name.as_str()).collect();
        let place = |name: &String| {
            let place = known.iter().position(|k| k == name);
            place.ok_or_else(|| Error::unknown("coordinate", name, &known).into())
        };
        names.iter().map(place).collect()
    }

    fn limits<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&cylindroid::model::Limits) -> f64,
    ) -> Array<'py> {
        let all: Vec<f64> = self.inner.coordinates().iter().map(|c| of(&c.limits)).collect();
        arrays::vector(py, &all)
    }

    fn frame_name(&self, id: cylindroid::FrameId) -> &str {
        &self.inner.frame_of(id).name
    }
}

/// The columns of a Jacobian of a chain, among those of the whole mechanism, row by row.
#[inline]
fn scatter(local: &Matrix, coordinates: &[usize], n: usize, out: &mut [f64]) {
    let columns = local.as_slice().as_chunks::<6>().0;
    if columns.len() == n {
        for i in 0..6 {
            for (x, column) in out[i * n..(i + 1) * n].iter_mut().zip(columns) {
                *x = column[i];
            }
        }
        return;
    }
    for (column, &c) in columns.iter().zip(coordinates) {
        for (i, x) in column.iter().enumerate() {
            out[i * n + c] = *x;
        }
    }
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    #[getter]
    fn n(&self) -> usize {
        self.inner.n()
    }

    #[getter]
    fn joint_names(&self) -> Vec<&str> {
        self.inner.coordinates().iter().map(|c| c.name.as_str()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.inner.coordinates().iter().map(|c| c.kind.unit()).collect()
    }

    #[getter]
    fn frames(&self) -> Vec<&str> {
        self.inner.frames().iter().map(|f| f.name.as_str()).collect()
    }

    #[getter]
    fn links(&self) -> Vec<&str> {
        self.inner.links().iter().map(|l| l.name.as_str()).collect()
    }

    #[getter]
    fn joints(&self) -> Vec<PyJoint> {
        let m = &self.inner;
        let link = |i: usize| m.links()[i].name.clone();
        let tree = m.joints().iter().map(|j| PyJoint {
            name: j.name.clone(),
            kind: j.kind.name(),
            parent: link(j.parent),
            child: link(j.child),
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
            actuated: l.actuated,
            coordinates: Vec::new(),
            mimic: None,
            closes_loop: true,
        });
        tree.chain(closing).collect()
    }

    #[getter]
    fn contacts(&self) -> Vec<&str> {
        self.inner.contacts().iter().map(|c| c.name.as_str()).collect()
    }

    #[getter]
    fn actuated(&self) -> Vec<&str> {
        let tree = self.inner.actuated().map(|i| self.inner.coordinates()[i].name.as_str());
        let closing = self.inner.loops().iter().filter(|l| l.actuated).map(|l| l.name.as_str());
        tree.chain(closing).collect()
    }

    #[getter]
    fn is_closed(&self) -> bool {
        self.inner.is_closed()
    }

    #[getter]
    fn dimension(&self) -> u8 {
        match self.inner.dimension() {
            Dimension::Planar => 2,
            Dimension::Spatial => 3,
        }
    }

    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.lower)
    }

    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.upper)
    }

    #[getter]
    fn velocity_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.velocity)
    }

    #[getter]
    fn acceleration_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.acceleration)
    }

    #[getter]
    fn effort_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.effort)
    }

    #[getter]
    fn home<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.inner.home())
    }

    #[getter]
    fn tool(&self) -> &str {
        self.frame_name(self.inner.tool())
    }

    #[getter]
    fn reference(&self) -> &str {
        self.frame_name(self.inner.reference())
    }

    #[getter]
    fn reach(&self) -> f64 {
        self.inner.reach()
    }

    #[getter]
    fn report(&self) -> PyLoadReport {
        let report = self.inner.report();
        PyLoadReport {
            format: report.format,
            source: report.source.clone(),
            ignored: report
                .ignored
                .iter()
                .map(|i| (i.line, i.what.clone(), i.why.clone()))
                .collect(),
        }
    }

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
    #[pyo3(signature = (q, frame = None, tool = None))]
    fn fk<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        frame: Option<&str>,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut chain = Chain::new(&self.inner, self.end_effector(frame, tool.as_ref())?);
        arrays::written(py, rows.count, &[4, 4], move |out| {
            for (i, out) in out.chunks_exact_mut(16).enumerate() {
                arrays::put_pose(chain.set(rows.row(i)), out);
            }
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
    fn fk_all<'py>(&self, py: Python<'py>, q: Numbers<'py>) -> Result<Array<'py>> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut state = self.inner.state(self.inner.home())?;
        let names = self.inner.frames().iter().map(|f| self.inner.frame(&f.name));
        let frames = names.collect::<cylindroid::Result<Vec<_>>>()?;
        let mut result = Ok(());
        let array = arrays::written(py, rows.count, &[frames.len(), 4, 4], |out| {
            for (i, out) in out.chunks_exact_mut(16 * frames.len().max(1)).enumerate() {
                result = state.set(rows.row(i));
                for (frame, out) in frames.iter().zip(out.chunks_exact_mut(16)) {
                    arrays::put_pose(state.pose(*frame), out);
                }
            }
        })?;
        result?;
        Ok(array)
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
    #[pyo3(signature = (q, frame = None, reference = "local_world_aligned", tool = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        frame: Option<&str>,
        reference: &str,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let (n, reference) = (self.inner.n(), reference_of(reference)?);
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut chain = Chain::new(&self.inner, self.end_effector(frame, tool.as_ref())?);
        let mut local = Matrix::zeros(6, chain.n());
        arrays::written(py, rows.count, &[6, n], move |out| {
            for (i, out) in out.chunks_exact_mut((6 * n).max(1)).enumerate() {
                chain.set(rows.row(i));
                chain.jacobian_into(reference, &mut local);
                scatter(&local, chain.coordinates(), n, out);
            }
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
    /// derivative along their unit rates.
    #[pyo3(signature = (q, frame = None, reference = "local_world_aligned", tool = None))]
    fn hessian<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        frame: Option<&str>,
        reference: &str,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let (n, reference) = (self.inner.n(), reference_of(reference)?);
        let rows = Rows::of(&self.inner, "q", &q)?;
        let mut chain = Chain::new(&self.inner, self.end_effector(frame, tool.as_ref())?);
        let mut local = vec![Matrix::zeros(6, chain.n()); chain.n()];
        arrays::written(py, rows.count, &[n, 6, n], move |out| {
            for (i, out) in out.chunks_exact_mut((6 * n * n).max(1)).enumerate() {
                chain.set(rows.row(i));
                chain.hessian_into(reference, &mut local);
                for (matrix, &k) in local.iter().zip(chain.coordinates()) {
                    let out = &mut out[6 * n * k..6 * n * (k + 1)];
                    scatter(matrix, chain.coordinates(), n, out);
                }
            }
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
        q: Numbers<'py>,
        qd: Numbers<'py>,
        frame: Option<&str>,
        reference: &str,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let (n, reference) = (self.inner.n(), reference_of(reference)?);
        let (rows, rates) = self.pair(&q, &qd)?;
        let of = self.end_effector(frame, tool.as_ref())?;
        let mut state = self.inner.state(self.inner.home())?;
        let mut result = Ok(());
        let array = arrays::written(py, rows.count, &[6, n], |out| {
            let mut one = |i: usize, out: &mut [f64]| -> cylindroid::Result<()> {
                state.set(rows.row(i))?;
                arrays::put_rows(&state.jacobian_dot(rates.row(i), of, reference)?, out);
                Ok(())
            };
            result = out
                .chunks_exact_mut((6 * n).max(1))
                .enumerate()
                .try_for_each(|(i, out)| one(i, out));
        })?;
        result?;
        Ok(array)
    }

    /// The Jacobian of position and angles instead of position and angular velocity, world axes.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// angles : str
    ///     'rpy' (about fixed x, y, z), 'zyz' (Euler angles) or 'rotation_vector'.
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
        q: Numbers<'py>,
        angles: &str,
        frame: Option<&str>,
        tool: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        const ANGLES: [(&str, OrientationRates); 3] = [
            ("rpy", OrientationRates::Rpy),
            ("zyz", OrientationRates::Zyz),
            ("rotation_vector", OrientationRates::RotationVector),
        ];
        let n = self.inner.n();
        let Some((_, rates)) = ANGLES.into_iter().find(|(name, _)| *name == angles) else {
            return Err(Error::unknown("angles", angles, ANGLES.map(|a| a.0)).into());
        };
        let rows = Rows::of(&self.inner, "q", &q)?;
        let of = self.end_effector(frame, tool.as_ref())?;
        let mut state = self.inner.state(self.inner.home())?;
        let mut result = Ok(());
        let array = arrays::written(py, rows.count, &[6, n], |out| {
            for (i, out) in out.chunks_exact_mut((6 * n).max(1)).enumerate() {
                result = state.set(rows.row(i));
                arrays::put_rows(&state.analytical_jacobian(of, rates).matrix, out);
            }
        })?;
        result?;
        Ok(array)
    }

    /// `q` moved by constant rates for `dt` seconds.
    ///
    /// `q + dt * qd`, with rotation vectors and free bodies moved on their group.
    ///
    /// Parameters
    /// ----------
    /// q, qd : array_like, (n,) or (N, n)
    ///     Coordinates and as many rates.
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
        q: Numbers<'py>,
        qd: Numbers<'py>,
        dt: f64,
    ) -> Result<Array<'py>> {
        let n = self.inner.n();
        let (rows, rates) = self.pair(&q, &qd)?;
        Error::check_finite("dt", &[dt])?;
        let mut result = Ok(());
        let array = arrays::written(py, rows.count, &[n], |out| {
            result = out.chunks_exact_mut(n.max(1)).enumerate().try_for_each(|(i, out)| {
                let next = self.inner.integrate(rows.row(i), rates.row(i), dt)?;
                out.copy_from_slice(&next);
                Ok::<(), Error>(())
            });
        })?;
        result?;
        Ok(array)
    }

    /// The names of coordinates outside their position limits.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///
    /// Returns
    /// -------
    /// list of str
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (q))]
    fn outside_limits(&self, q: Numbers<'_>) -> Result<Vec<&str>> {
        let q = q.vector("q")?;
        self.inner.check_q("q", q)?;
        let outside = self.inner.outside_limits(q);
        Ok(outside.map(|i| self.inner.coordinates()[i].name.as_str()).collect())
    }

    /// The same mechanism driven by these joints and no others.
    ///
    /// Parameters
    /// ----------
    /// names : sequence of str
    ///     Joints of the tree, their coordinates, or joints that close loops.
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
    ///     For a joint that does not move or follows another.
    #[pyo3(signature = (names))]
    fn with_actuated(&self, names: Vec<String>) -> Result<Self> {
        Ok(Self { inner: self.inner.with_actuated(&names)? })
    }

    fn __repr__(&self) -> String {
        let m = &self.inner;
        let mut text = format!("<Mechanism '{}': {} coordinates", m.name(), m.n());
        for (count, what) in [(m.loops().len(), "loops"), (m.contacts().len(), "contacts")] {
            if count > 0 {
                text.push_str(&format!(", {count} {what}"));
            }
        }
        text.push_str(&format!(", tool '{}'>", self.tool()));
        text
    }

    fn __str__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }

    fn __copy__(&self) -> Self {
        Self { inner: self.inner.clone() }
    }

    fn __deepcopy__(&self, _memo: Bound<'_, PyAny>) -> Self {
        Self { inner: self.inner.clone() }
    }
}

impl PyMechanism {
    fn pair<'a>(&self, q: &'a Numbers<'_>, qd: &'a Numbers<'_>) -> Result<(Rows<'a>, Rows<'a>)> {
        let rows = Rows::of(&self.inner, "q", q)?;
        let rates = Rows::of(&self.inner, "qd", qd)?;
        if rows.count != rates.count {
            let words = |r: &Rows<'_>| r.count.map_or("one".to_owned(), |n| n.to_string());
            return Err(Failure::option(
                "qd",
                format!("{} for {} of q", words(&rates), words(&rows)),
                "give as many rates as configurations",
            ));
        }
        Ok((rows, rates))
    }

    fn table(&self) -> Table {
        let m = &self.inner;
        let mut table = Table::new(&format!("Mechanism '{}'", m.name()));
        table.row("format", m.report().format);
        table.row("tool", self.tool());
        if m.is_closed() {
            table.row("reference", self.reference());
            table.row("loops", m.loops().len().to_string());
            table.row("contacts", m.contacts().len().to_string());
        }
        table.row("reach", format!("{} m", table::number(m.reach())));
        for c in m.coordinates() {
            let unit = c.kind.unit();
            let limits = format!(
                "{} to {} {unit}, {} {unit}/s{}",
                table::number(c.limits.lower),
                table::number(c.limits.upper),
                table::number(c.limits.velocity),
                if c.actuated { "" } else { ", passive" }
            );
            table.row(&c.name, limits);
        }
        if !m.report().ignored.is_empty() {
            table.row("ignored", format!("{} things, see report", m.report().ignored.len()));
        }
        table
    }
}
