//! The classes `CollisionModel` and `Distances`.

mod distances;
pub(crate) mod shape;

use std::path::PathBuf;

use cylindroid::collision::{CollisionModel, CollisionOptions, MeshShape};
use cylindroid::model::formats::srdf;
use cylindroid::{Error, Mechanism, Pose, State};
use pyo3::prelude::*;

pub(crate) use self::distances::PyDistances;
use self::shape::{Sizes, geometry};
use crate::arrays::Numbers;
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument, count};
use crate::mechanism::PyMechanism;

/// The collision shapes of a mechanism and of obstacles, and the pairs of them that are watched.
///
/// Links that a joint connects are not watched against each other, nor pairs that always or never
/// touch (by random configurations and a descent from the nearest of them), nor disabled ones.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
/// disabled : list of tuple of str, optional
///     Pairs of links that are not watched.
/// srdf : path, optional
///     An SRDF, whose `disable_collisions` are such pairs.
/// meshes : {'convex_hull', 'capsule'}
///     The shape that stands for a mesh.
/// samples : int
///     Number of random configurations; 0 keeps all pairs.
/// seed : int
///     Seed of the random configurations.
///
/// Attributes
/// ----------
/// pairs : list of tuple of str
///     The links or obstacles of the pairs that are watched.
/// obstacles : list of str
/// ignored : list of tuple of str
///     Shapes that could not be made (a mesh that is not found) and disabled pairs of unknown
///     links, with the reason.
///
/// Raises
/// ------
/// ModelFileError, MissingFileError
///     For the SRDF.
/// InvalidOptionError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> crane = cy.parse('''
/// ... [[joint]]
/// ... name = "lift"
/// ... type = "prismatic"
/// ... between = ["ground", "hook"]
/// ... axis = [0, 0, 1]
/// ... [[collision]]
/// ... link = "hook"
/// ... shape = "sphere"
/// ... radius = 0.1
/// ... ''', format="toml")
/// >>> model = cy.CollisionModel(crane)
/// >>> model.add_obstacle("floor", "half_space", [0, 0, -1])
/// >>> near = model.near([0.5], margin=2.0)
/// >>> near.pairs, near.distances, near.gradients
/// ([('hook', 'floor')], array([1.4]), array([[1.]]))
#[pyclass(name = "CollisionModel", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyCollisionModel {
    pub(crate) inner: CollisionModel,
    state: State,
}

/// A model by the options of Python.
fn model(
    mechanism: &Mechanism,
    (disabled, srdf): (Option<Vec<[String; 2]>>, Option<PathBuf>),
    meshes: &str,
    (samples, seed): (usize, u64),
) -> Result<CollisionModel> {
    let mut disabled = disabled.unwrap_or_default();
    if let Some(path) = srdf {
        disabled.extend(srdf::load(&path)?.pairs(mechanism));
    }
    let named = MeshShape::NAMES.into_iter().find(|(name, _)| *name == meshes);
    let Some((_, meshes)) = named else {
        let names = MeshShape::NAMES.map(|(name, _)| name);
        return Err(Error::unknown("shape of meshes", meshes, names).into());
    };
    let options =
        CollisionOptions { meshes, disabled, samples, seed, ..CollisionOptions::default() };
    Ok(CollisionModel::new(mechanism, &options)?)
}

/// A pose from a matrix of 4 x 4, or a position.
pub(crate) fn placed(pose: Option<Numbers<'_>>) -> Result<Pose> {
    let Some(numbers) = pose else { return Ok(Pose::IDENTITY) };
    if *numbers.shape() == [3] {
        let position = numbers.entries::<3>("pose")?;
        return Ok(Pose::from_translation(cylindroid::Vec3::from_array(position)));
    }
    numbers.pose("pose")
}

/// The error for a collision model that another call changes.
pub(crate) fn in_use<E>(_: E) -> Failure {
    Failure::InUse("the collision model is in use by a call around this one".to_owned())
}

impl PyCollisionModel {
    /// The pairs nearer than a margin (m) at a configuration.
    pub(crate) fn near_at(&mut self, q: &[f64], margin: f64) -> Result<PyDistances> {
        self.state.set(q)?;
        PyDistances::of(&mut self.inner, &self.state, margin)
    }
}

#[pymethods]
impl PyCollisionModel {
    #[new]
    #[pyo3(signature = (mechanism, *, disabled=None, srdf=None, meshes="convex_hull", samples=200, seed=0))]
    fn new(
        #[pyo3(from_py_with = argument)] mechanism: PyRef<'_, PyMechanism>,
        #[pyo3(from_py_with = argument)] disabled: Option<Vec<[String; 2]>>,
        #[pyo3(from_py_with = argument)] srdf: Option<PathBuf>,
        #[pyo3(from_py_with = argument)] meshes: &str,
        #[pyo3(from_py_with = count)] samples: usize,
        #[pyo3(from_py_with = argument)] seed: u64,
    ) -> Result<Self> {
        let inner = model(&mechanism.inner, (disabled, srdf), meshes, (samples, seed))?;
        let state = mechanism.inner.state(mechanism.inner.home())?;
        Ok(Self { inner, state })
    }

    #[getter]
    fn pairs(slf: &Bound<'_, Self>) -> Result<Vec<(String, String)>> {
        let model = &slf.try_borrow().map_err(in_use)?.inner;
        let names = (0..model.pairs().len()).map(|i| model.names(i));
        Ok(names.map(|[a, b]| (a.to_owned(), b.to_owned())).collect())
    }

    #[getter]
    fn obstacles(slf: &Bound<'_, Self>) -> Result<Vec<String>> {
        let model = &slf.try_borrow().map_err(in_use)?.inner;
        Ok(model.obstacles().map(str::to_owned).collect())
    }

    #[getter]
    fn ignored(slf: &Bound<'_, Self>) -> Result<Vec<(String, String)>> {
        let model = &slf.try_borrow().map_err(in_use)?.inner;
        Ok(model.ignored().iter().map(|i| (i.what.clone(), i.why.clone())).collect())
    }

    /// The pairs nearer than a margin, nearest first.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// margin : float
    ///     Pairs farther apart are left out [m]; `inf` for all.
    ///
    /// Returns
    /// -------
    /// Distances
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    /// InUseError
    ///     While another call changes the model, as during a step of a `TaskServo`.
    #[pyo3(signature = (q, margin=0.1))]
    fn near(
        slf: &Bound<'_, Self>,
        q: Coordinates<'_>,
        #[pyo3(from_py_with = argument)] margin: f64,
    ) -> Result<PyDistances> {
        let own = &mut *slf.try_borrow_mut().map_err(in_use)?;
        let q = q.vector(own.inner.mechanism(), "q")?;
        own.near_at(q, margin)
    }

    /// Adds an obstacle, which is watched against all links that can move.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// shape : {'sphere', 'capsule', 'cylinder', 'box', 'ellipsoid', 'half_space', 'convex_hull', 'mesh'}
    ///     Capsules and cylinders are along z, a half-space is z <= 0.
    /// pose : array_like, (4, 4) or (3,), optional
    ///     Its pose in the world, or its position [m].
    /// radius : float, optional
    ///     Of a sphere, capsule or cylinder [m].
    /// length : float, optional
    ///     Of a capsule, without its ends, or a cylinder [m].
    /// size : array_like, (3,), optional
    ///     Edges of a box, or semi-axes of an ellipsoid [m].
    /// points : array_like, (k, 3), optional
    ///     Of a convex hull [m].
    /// file : path, optional
    ///     Of a mesh (STL, OBJ, Collada), whose convex hull is taken.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     For a name that is taken, or a shape that cannot be made.
    /// UnknownNameError
    ///     For an unknown shape.
    #[pyo3(signature = (name, shape, pose=None, *, radius=None, length=None, size=None, points=None, file=None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn add_obstacle(
        slf: &Bound<'_, Self>,
        #[pyo3(from_py_with = argument)] name: &str,
        #[pyo3(from_py_with = argument)] shape: &str,
        pose: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] radius: Option<f64>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        size: Option<Numbers<'_>>,
        points: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] file: Option<PathBuf>,
    ) -> Result<()> {
        let shape = geometry(shape, Sizes { radius, length, size, points, file })?;
        let mut model = slf.try_borrow_mut().map_err(in_use)?;
        Ok(model.inner.add_obstacle(name, &shape, placed(pose)?)?)
    }

    /// Moves an obstacle.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// pose : array_like, (4, 4) or (3,)
    ///     Its pose in the world, or its position [m].
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    #[pyo3(signature = (name, pose))]
    fn move_obstacle(
        slf: &Bound<'_, Self>,
        #[pyo3(from_py_with = argument)] name: &str,
        pose: Numbers<'_>,
    ) -> Result<()> {
        let mut model = slf.try_borrow_mut().map_err(in_use)?;
        Ok(model.inner.move_obstacle(name, placed(Some(pose))?)?)
    }

    /// Removes an obstacle.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    #[pyo3(signature = (name))]
    fn remove_obstacle(
        slf: &Bound<'_, Self>,
        #[pyo3(from_py_with = argument)] name: &str,
    ) -> Result<()> {
        Ok(slf.try_borrow_mut().map_err(in_use)?.inner.remove_obstacle(name)?)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> Result<String> {
        let model = &slf.try_borrow().map_err(in_use)?.inner;
        Ok(format!(
            "<CollisionModel of '{}': {} shapes, {} pairs, {} obstacles>",
            model.mechanism().name(),
            model.bodies().len(),
            model.pairs().len(),
            model.obstacles().count()
        ))
    }
}

#[pymethods]
impl PyMechanism {
    /// Distances between all links that no joint connects, nearest first.
    ///
    /// For obstacles, or many configurations, see `CollisionModel`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// margin : float
    ///     Pairs farther apart are left out [m].
    /// srdf : path, optional
    ///     An SRDF, whose `disable_collisions` are left out.
    /// meshes : {'convex_hull', 'capsule'}
    ///     The shape that stands for a mesh.
    ///
    /// Returns
    /// -------
    /// Distances
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    /// ModelFileError, MissingFileError
    ///     For the SRDF.
    #[pyo3(signature = (q, margin=f64::INFINITY, *, srdf=None, meshes="convex_hull"))]
    fn distances(
        &self,
        q: Coordinates<'_>,
        #[pyo3(from_py_with = argument)] margin: f64,
        #[pyo3(from_py_with = argument)] srdf: Option<PathBuf>,
        #[pyo3(from_py_with = argument)] meshes: &str,
    ) -> Result<PyDistances> {
        let mut model = model(&self.inner, (None, srdf), meshes, (0, 0))?;
        let state = self.inner.state(q.vector(&self.inner, "q")?)?;
        PyDistances::of(&mut model, &state, margin)
    }
}
