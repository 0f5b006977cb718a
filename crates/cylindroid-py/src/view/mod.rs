//! The class `View`: a page in the browser that follows the program.

mod callbacks;
pub(crate) mod start;

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cylindroid::Mechanism;
use cylindroid_cli::show::{Drawing, DrawnShape, Viewer};
use pyo3::prelude::*;

use self::callbacks::{Callbacks, Moved};
use crate::arrays::{self, Array, Numbers};
use crate::collision::placed;
use crate::collision::shape::{Sizes, geometry};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument};

/// Views stay open until they are closed, whoever holds them.
static OPEN: Mutex<Vec<Arc<Viewer>>> = Mutex::new(Vec::new());

/// Time between looks at the pages while one waits.
const LOOK: Duration = Duration::from_millis(50);

/// A page in the browser that shows a robot and follows this program; created by `show`.
///
/// It may be used from every thread. As a context manager it is closed at the end of the block,
/// otherwise by `close` or with the program.
///
/// Attributes
/// ----------
/// q : ndarray, (n,)
///     The configuration that is shown [rad or m]. To set it shows it as it is, loops closed or not,
///     and pauses the servo of the page; the target then moves with the tool until somebody has
///     placed it.
/// target : ndarray, (4, 4)
///     `world_from_target`, which is dragged on the page. While the servo of the page plays, the
///     robot moves there.
/// playing : bool
///     True if the servo of the page moves the robot to the target.
/// url : str
///     The address of the page. It contains a secret: who knows it may drive the robot on the page.
/// url_for_others : str or None
///     The same for other machines; None if only this one reaches the page, see `host` of `show`.
/// pages : int
///     Number of pages that show it at this moment.
/// closed : bool
#[pyclass(frozen, name = "View", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyView {
    viewer: Mutex<Option<Arc<Viewer>>>,
    callbacks: Arc<Callbacks>,
    mechanism: Mechanism,
    url: String,
    url_for_others: Option<String>,
    /// Pages that there had been when the last wait for them ended.
    waited_for: AtomicU64,
}

impl PyView {
    fn new(mechanism: Mechanism, viewer: Viewer) -> Self {
        let url = viewer.url().to_owned();
        let url_for_others = viewer.url_for_others().map(str::to_owned);
        let viewer = Arc::new(viewer);
        OPEN.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&viewer));
        let viewer = Mutex::new(Some(viewer));
        let (callbacks, waited_for) = (Arc::default(), AtomicU64::new(0));
        Self { viewer, callbacks, mechanism, url, url_for_others, waited_for }
    }

    fn open_viewer(&self) -> Option<Arc<Viewer>> {
        self.viewer.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn viewer(&self) -> Result<Arc<Viewer>> {
        self.open_viewer().ok_or_else(|| {
            let name = self.mechanism.name();
            Failure::InUse(format!("the view of '{name}' is closed; show the mechanism again"))
        })
    }

    fn draw(&self, name: &str, shape: DrawnShape, rgba: Option<Numbers<'_>>) -> Result<()> {
        let rgba = rgba.map(|rgba| rgba.entries::<4>("rgba")).transpose()?;
        Ok(self.viewer()?.draw(name, Drawing { shape, rgba })?)
    }

    fn call(slf: &Bound<'_, Self>, moved: Moved, function: Py<PyAny>) -> Result<Py<PyAny>> {
        let py = slf.py();
        if !function.bind(py).is_callable() {
            let what = function.bind(py).get_type();
            return Err(Failure::kind(format!("function: {what} cannot be called")));
        }
        let own = slf.get();
        own.callbacks.add(py, &own.viewer()?, moved, function.clone_ref(py))?;
        Ok(function)
    }
}

/// Points of a line or a cloud.
fn points_of(points: &Numbers<'_>) -> Result<Vec<[f64; 3]>> {
    let found = points.matrix("points")?;
    if found.cols() != 3 {
        let reason = "give an array (k, 3) of positions in the world";
        return Err(Failure::option("points", points.shape_text(), reason));
    }
    Ok((0..found.rows()).map(|i| [found[(i, 0)], found[(i, 1)], found[(i, 2)]]).collect())
}

#[pymethods]
impl PyView {
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let viewer = self.viewer()?;
        let q = py.detach(|| viewer.q());
        Ok(arrays::vector(py, &q))
    }

    #[setter]
    fn set_q(&self, py: Python<'_>, q: Coordinates<'_>) -> Result<()> {
        let (viewer, q) = (self.viewer()?, q.vector(&self.mechanism, "q")?);
        Ok(py.detach(|| viewer.set_q(q))?)
    }

    #[getter]
    fn target<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let viewer = self.viewer()?;
        let pose = py.detach(|| viewer.target());
        arrays::pose(py, pose)
    }

    #[setter]
    fn set_target(&self, py: Python<'_>, target: Numbers<'_>) -> Result<()> {
        let (viewer, target) = (self.viewer()?, target.pose("target")?);
        py.detach(|| viewer.set_target(target));
        Ok(())
    }

    #[getter]
    fn playing(&self, py: Python<'_>) -> Result<bool> {
        let viewer = self.viewer()?;
        Ok(py.detach(|| viewer.is_playing()))
    }

    #[setter]
    fn set_playing(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = argument)] playing: bool,
    ) -> Result<()> {
        let viewer = self.viewer()?;
        py.detach(|| viewer.play(playing));
        Ok(())
    }

    #[getter]
    fn url(&self) -> &str {
        &self.url
    }

    #[getter]
    fn url_for_others(&self) -> Option<&str> {
        self.url_for_others.as_deref()
    }

    #[getter]
    fn pages(&self, py: Python<'_>) -> usize {
        self.open_viewer().map_or(0, |viewer| py.detach(|| viewer.clients()))
    }

    #[getter]
    fn closed(&self) -> bool {
        self.open_viewer().is_none()
    }

    /// Draws three axes; a frame of this name moves there.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     It is written beside the frame.
    /// pose : array_like, (4, 4) or (3,)
    ///     `world_from_frame`, or its position [m].
    /// size : float, optional
    ///     Length of the axes [m]; by default one that suits the robot.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError, NotFiniteError
    #[pyo3(signature = (name, pose, size=None))]
    fn add_frame(
        &self,
        #[pyo3(from_py_with = argument)] name: &str,
        pose: Numbers<'_>,
        #[pyo3(from_py_with = argument)] size: Option<f64>,
    ) -> Result<()> {
        self.draw(name, DrawnShape::Frame { pose: placed(Some(pose))?, size }, None)
    }

    /// Draws a line; a line of this name is replaced.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// points : array_like, (k, 3)
    ///     Positions in the world [m].
    /// rgba : array_like, (4,), optional
    ///     Red, green, blue and opacity, from 0 to 1.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError, DimensionError, NotFiniteError
    #[pyo3(signature = (name, points, rgba=None))]
    fn add_line(
        &self,
        #[pyo3(from_py_with = argument)] name: &str,
        points: Numbers<'_>,
        rgba: Option<Numbers<'_>>,
    ) -> Result<()> {
        self.draw(name, DrawnShape::Line(points_of(&points)?), rgba)
    }

    /// Draws separate points; those of this name are replaced.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// points : array_like, (k, 3)
    ///     Positions in the world [m].
    /// rgba : array_like, (4,), optional
    ///     Red, green, blue and opacity, from 0 to 1.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError, DimensionError, NotFiniteError
    #[pyo3(signature = (name, points, rgba=None))]
    fn add_points(
        &self,
        #[pyo3(from_py_with = argument)] name: &str,
        points: Numbers<'_>,
        rgba: Option<Numbers<'_>>,
    ) -> Result<()> {
        self.draw(name, DrawnShape::Points(points_of(&points)?), rgba)
    }

    /// Adds an obstacle, which can be dragged on the page.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// shape : {'sphere', 'capsule', 'cylinder', 'box', 'ellipsoid', 'half_space', 'mesh'}
    ///     Capsules and cylinders are along z, a half-space is z <= 0.
    /// pose : array_like, (4, 4) or (3,), optional
    ///     Its pose in the world, or its position [m].
    /// radius : float, optional
    ///     Of a sphere, capsule or cylinder [m].
    /// length : float, optional
    ///     Of a capsule, without its ends, or a cylinder [m].
    /// size : array_like, (3,), optional
    ///     Edges of a box, or semi-axes of an ellipsoid [m].
    /// file : path, optional
    ///     Of a mesh (STL, OBJ, Collada) in a folder of the model.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     For a name that is taken, or a shape that cannot be made.
    /// UnknownNameError
    ///     For an unknown shape.
    #[pyo3(signature = (name, shape, pose=None, *, radius=None, length=None, size=None, file=None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn add_obstacle(
        &self,
        #[pyo3(from_py_with = argument)] name: &str,
        #[pyo3(from_py_with = argument)] shape: &str,
        pose: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] radius: Option<f64>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        size: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] file: Option<PathBuf>,
    ) -> Result<()> {
        let shape = geometry(shape, Sizes { radius, length, size, points: None, file })?;
        Ok(self.viewer()?.add_obstacle(name, shape, placed(pose)?)?)
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
        &self,
        #[pyo3(from_py_with = argument)] name: &str,
        pose: Numbers<'_>,
    ) -> Result<()> {
        Ok(self.viewer()?.move_obstacle(name, placed(Some(pose))?)?)
    }

    /// Removes the frame, line, points or obstacle of this name.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    #[pyo3(signature = (name))]
    fn remove(&self, #[pyo3(from_py_with = argument)] name: &str) -> Result<()> {
        Ok(self.viewer()?.remove(name)?)
    }

    /// Calls a function when somebody drags the target on a page, or moves it with the tool by
    /// *Hold to move*; may be used as a decorator.
    ///
    /// Parameters
    /// ----------
    /// function : callable
    ///     Is called with `world_from_target`, (4, 4), in a thread of its own. Of poses that come
    ///     faster than it returns it gets the newest.
    ///
    /// Returns
    /// -------
    /// callable
    ///     The function.
    #[pyo3(signature = (function))]
    fn on_target(slf: &Bound<'_, Self>, function: Py<PyAny>) -> Result<Py<PyAny>> {
        Self::call(slf, Moved::Target, function)
    }

    /// Calls a function when somebody moves joints on a page, by a self-motion as well; may be used
    /// as a decorator.
    ///
    /// Parameters
    /// ----------
    /// function : callable
    ///     Is called with the configuration, (n,), as `on_target` does.
    ///
    /// Returns
    /// -------
    /// callable
    ///     The function.
    #[pyo3(signature = (function))]
    fn on_configuration(slf: &Bound<'_, Self>, function: Py<PyAny>) -> Result<Py<PyAny>> {
        Self::call(slf, Moved::Configuration, function)
    }

    /// Calls a function when somebody drags an obstacle on a page; may be used as a decorator.
    ///
    /// Parameters
    /// ----------
    /// function : callable
    ///     Is called with the name and the pose in the world, (4, 4), as `on_target` does.
    ///
    /// Returns
    /// -------
    /// callable
    ///     The function.
    #[pyo3(signature = (function))]
    fn on_obstacle(slf: &Bound<'_, Self>, function: Py<PyAny>) -> Result<Py<PyAny>> {
        Self::call(slf, Moved::Obstacle, function)
    }

    /// Opens the page: in a notebook below the cell, otherwise in the browser.
    ///
    /// Parameters
    /// ----------
    /// height : int
    ///     Of the page below a cell (pixels).
    #[pyo3(signature = (height=600))]
    fn open(&self, py: Python<'_>, #[pyo3(from_py_with = argument)] height: u32) -> Result<()> {
        self.viewer()?;
        py.import("cylindroid._show")?.call_method1("open_page", (&self.url, height))?;
        Ok(())
    }

    /// Waits until all pages are closed, at least one having been open since the last such wait,
    /// or the view is.
    ///
    /// Parameters
    /// ----------
    /// timeout : float
    ///     Longest wait [s].
    ///
    /// Returns
    /// -------
    /// bool
    ///     False after the longest wait.
    #[pyo3(signature = (timeout=f64::INFINITY))]
    fn wait(&self, py: Python<'_>, #[pyo3(from_py_with = argument)] timeout: f64) -> Result<bool> {
        if !(timeout >= 0.0) {
            let reason = "give a time that is not negative [s], or inf";
            return Err(Failure::option("timeout", timeout.to_string(), reason));
        }
        let begin = Instant::now();
        while let Some(viewer) = self.open_viewer() {
            let (visits, pages) = py.detach(|| (viewer.visits(), viewer.clients()));
            drop(viewer);
            if pages == 0 && visits > self.waited_for.load(Ordering::Relaxed) {
                self.waited_for.store(visits, Ordering::Relaxed);
                return Ok(true);
            }
            if begin.elapsed().as_secs_f64() >= timeout {
                return Ok(false);
            }
            py.detach(|| sleep(LOOK));
            py.check_signals()?;
        }
        Ok(true)
    }

    /// Stops the server; pages keep the last picture. Nothing happens if it is closed.
    fn close(&self, py: Python<'_>) {
        let viewer = self.viewer.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(viewer) = viewer else { return };
        py.detach(|| {
            viewer.close();
            let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
            open.retain(|other| !Arc::ptr_eq(other, &viewer));
            drop(open);
            drop(viewer);
        });
    }

    fn __enter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, PyAny>) {
        self.close(py);
    }

    fn __repr__(&self) -> String {
        let name = self.mechanism.name();
        match self.open_viewer() {
            Some(_) => format!("<View of '{name}' at {}>", self.url),
            None => format!("<View of '{name}', closed>"),
        }
    }
}
