//! Sweeps: quantities of many configurations and designs, computed here or part by part.

mod files;
mod own_columns;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use cylindroid::control::Task;
use cylindroid::sweep::{
    Axis, AxisKinds, DesignSpace, ParameterRange, Part, Quantity, SharedFolder, Source, Summary,
    Sweep, SweepOptions, Table, Values, VelocityMetric, VoxelGrid, WriteOptions,
};
use cylindroid::{Pose, Vec3};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use self::files::{configurations, poses};
use self::own_columns::{Given, OwnColumns};
use crate::arrays::Numbers;
use crate::collision::PyCollisionModel;
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument, entry};
use crate::mechanism::PyMechanism;

/// A sweep in a folder.
///
/// Attributes
/// ----------
/// folder : Path or str
///     `part-*.parquet` and `manifest.json`, with the recipe, the columns with their units and the
///     XXH3 checksum (128 bits) of each part; a URI as it was given.
/// rows : int
///     Rows of the sweep.
/// computed : int
///     Rows that this call computed; the others were there.
/// parts : int
///     Number of files.
/// bytes : int
///     Their size.
#[pyclass(frozen, get_all, module = "cylindroid", name = "SweepSummary")]
#[derive(Debug)]
pub(crate) struct PySweepSummary {
    folder: Py<PyAny>,
    rows: u64,
    computed: u64,
    parts: usize,
    bytes: u64,
}

#[pymethods]
impl PySweepSummary {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let folder = self.folder.bind(py).str()?;
        let Self { rows, parts, .. } = self;
        Ok(format!("SweepSummary({rows} rows in {parts} parts, {:?})", folder.to_string_lossy()))
    }
}

/// Size and checksum of a part, as Python has them.
type Listed = (u64, String);

fn to_part(listed: Listed) -> Part {
    Part { bytes: listed.0, checksum: listed.1 }
}

fn of_part(part: Part) -> Listed {
    (part.bytes, part.checksum)
}

/// A folder of parts that several processes write, locked until `close`.
#[pyclass(module = "cylindroid", name = "SweepFolder")]
#[derive(Debug)]
pub(crate) struct PySweepFolder {
    inner: Option<SharedFolder>,
}

#[pymethods]
impl PySweepFolder {
    /// Size and XXH3 checksum of the parts that the manifest lists.
    fn listed(&self) -> Vec<Option<Listed>> {
        let listed = self.inner.iter().flat_map(|folder| folder.listed.iter());
        listed.map(|part| part.clone().map(of_part)).collect()
    }

    /// Writes the manifest with these finished parts.
    #[pyo3(signature = (plan, parts))]
    fn write_manifest(&self, plan: &PySweepPlan, parts: Vec<Option<Listed>>) -> Result<()> {
        let parts: Vec<Option<Part>> = parts.into_iter().map(|part| part.map(to_part)).collect();
        match &self.inner {
            Some(folder) => Ok(folder.write_manifest(&plan.sweep, &parts)?),
            None => Err(Failure::kind("the folder is closed")),
        }
    }

    /// Opens the lock.
    fn close(&mut self) {
        self.inner = None;
    }
}

/// A checked sweep, of which any part can be computed; made by `sweep`.
#[pyclass(frozen, module = "cylindroid", name = "SweepPlan")]
#[derive(Debug)]
pub(crate) struct PySweepPlan {
    sweep: Sweep,
    own: OwnColumns,
}

#[pymethods]
impl PySweepPlan {
    #[new]
    #[pyo3(signature = (mechanism, samples = None, seed = 0, over = None, q = None,
        configurations = None, quantities = None, frame = None, tool = None, task = None,
        metric = "unit", length = None, vary = None, designs = 0, columns = Vec::new(),
        direction = None, reach = None, directions = VoxelGrid::DIRECTIONS,
        rolls = VoxelGrid::ROLLS, reach_from = None, poses = None,
        collision = None, relative_to = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        #[pyo3(from_py_with = argument)] mechanism: PyRef<'_, PyMechanism>,
        #[pyo3(from_py_with = argument)] samples: Option<u64>,
        #[pyo3(from_py_with = argument)] seed: u64,
        #[pyo3(from_py_with = argument)] over: Option<Bound<'_, PyDict>>,
        q: Option<Coordinates<'_>>,
        configurations: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] quantities: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] task: Option<&str>,
        #[pyo3(from_py_with = argument)] metric: &str,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        #[pyo3(from_py_with = argument)] vary: Option<Bound<'_, PyDict>>,
        #[pyo3(from_py_with = argument)] designs: u64,
        #[pyo3(from_py_with = argument)] columns: Vec<Given>,
        direction: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] reach: Option<Bound<'_, PyDict>>,
        #[pyo3(from_py_with = argument)] directions: u64,
        #[pyo3(from_py_with = argument)] rolls: u64,
        reach_from: Option<Numbers<'_>>,
        poses: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] collision: Option<PyRef<'_, PyCollisionModel>>,
        #[pyo3(from_py_with = argument)] relative_to: Option<&str>,
    ) -> Result<Self> {
        let robot = &*mechanism;
        let mechanism = robot.inner.clone();
        let ranges = vary.as_ref().map_or(Ok(Vec::new()), ranges)?;
        let sampled = !ranges.is_empty();
        let (over, q) = (over.as_ref(), q.as_ref());
        let reach = match &reach {
            None => None,
            Some(reach) => Some(VoxelGrid {
                axes: axes(reach)?,
                world_from_grid: match &reach_from {
                    None => Pose::IDENTITY,
                    Some(from) => from.pose("reach_from")?,
                },
                directions,
                rolls,
            }),
        };
        let is_map = reach.is_some();
        let task = task.map(|name| Task::named(name, &mechanism)).transpose()?;
        let chosen =
            Chosen { samples, seed, over, q, configurations, designs: sampled, reach, poses, task };
        let (source, parameters) = chosen.source(robot)?;
        let space = match (parameters.is_empty(), sampled) {
            (true, false) => None,
            (false, false) => Some(DesignSpace::Grid(parameters)),
            (true, true) => Some(DesignSpace::Samples { ranges, count: designs, seed }),
            (false, true) => {
                let reason = "designs are a grid or samples: give parameters in over or in vary";
                return Err(Failure::option("vary", "a dict", reason));
            }
        };
        let quantities = match quantities {
            None if is_map => Vec::new(),
            None => Quantity::usual(&mechanism).to_vec(),
            Some(named) => {
                named.iter().map(|name| Quantity::named(name)).collect::<cylindroid::Result<_>>()?
            }
        };
        let chosen = frame.is_some() || tool.is_some();
        let end_effector =
            if chosen { Some(robot.end_effector(frame, tool.as_ref())?) } else { None };
        let relative_to = relative_to.map(|name| mechanism.frame(name)).transpose()?;
        let own = OwnColumns::new(columns);
        let part_rows = Sweep::usual_part_rows(&mechanism, &source, space.is_some());
        let options = SweepOptions {
            source,
            quantities,
            columns: own.columns(&mechanism),
            end_effector,
            relative_to,
            task,
            metric: VelocityMetric::named(metric)?,
            length,
            direction: match &direction {
                Some(direction) => Vec3::from_array(direction.entries("direction")?),
                None => SweepOptions::default().direction,
            },
            collision: collision.map(|model| model.inner.clone()),
            part_rows,
        };
        let sweep = match space {
            None => Sweep::new(&mechanism, options)?,
            Some(space) => Sweep::of_designs(&robot.parametric()?, space, options)?,
        };
        Ok(Self { sweep, own })
    }

    /// Number of parts.
    #[getter]
    fn parts(&self) -> usize {
        self.sweep.parts()
    }

    /// The recipe as JSON.
    #[getter]
    fn recipe(&self) -> String {
        self.sweep.recipe()
    }

    /// The first entry in which another recipe differs.
    #[pyo3(signature = (recipe))]
    fn difference(&self, recipe: &str) -> Result<Option<String>> {
        Ok(self.sweep.recipe_difference(recipe)?)
    }

    /// All columns, computed by threads of this process.
    #[pyo3(signature = (threads = None))]
    fn collect<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] threads: Option<usize>,
    ) -> Result<Bound<'py, PyDict>> {
        let threads = count_of(threads)?;
        let mut raised = None;
        let found = py.detach(|| self.sweep.collect(threads, |_| go_on(&mut raised)));
        if let Some(error) = raised {
            return Err(error.into());
        }
        match self.own.checked(py, found)? {
            Some(table) => columns_of(py, table),
            None => Ok(PyDict::new(py)),
        }
    }

    /// Writes all parts, by threads of this process.
    #[pyo3(signature = (out, resume = false, threads = None))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = argument)] out: PathBuf,
        #[pyo3(from_py_with = argument)] resume: bool,
        #[pyo3(from_py_with = argument)] threads: Option<usize>,
    ) -> Result<PySweepSummary> {
        let options = WriteOptions { threads: count_of(threads)?, resume };
        let mut raised = None;
        let found = py.detach(|| self.sweep.write(&out, &options, |_| go_on(&mut raised)));
        if let Some(error) = raised {
            return Err(error.into());
        }
        let Summary { rows, computed, parts, bytes, .. } = self.own.checked(py, found)?;
        let folder = out.into_pyobject(py)?.into_any().unbind();
        Ok(PySweepSummary { folder, rows, computed, parts, bytes })
    }

    /// Returns an error for more numbers than fit into memory.
    fn check_memory(&self) -> Result<()> {
        Ok(self.sweep.check_memory()?)
    }

    /// The columns of a part.
    #[pyo3(signature = (part))]
    fn part<'py>(&self, py: Python<'py>, part: usize) -> Result<Bound<'py, PyDict>> {
        let found = py.detach(|| self.sweep.part(part));
        columns_of(py, self.own.checked(py, found)?)
    }

    /// The file of a part: its bytes, their number and their checksum.
    #[pyo3(signature = (part))]
    fn part_file<'py>(
        &self,
        py: Python<'py>,
        part: usize,
    ) -> Result<(Bound<'py, PyBytes>, Listed)> {
        let found = py.detach(|| self.sweep.part_file(part));
        let (part, bytes) = self.own.checked(py, found)?;
        Ok((PyBytes::new(py, &bytes), of_part(part)))
    }

    /// Size and checksum of a file that was read.
    #[staticmethod]
    fn listed(content: &[u8]) -> Listed {
        of_part(Part::of(content))
    }

    /// Writes the file of a part, unless it is the one of `listed`; true if it was computed.
    #[pyo3(signature = (out, part, listed = None))]
    fn write_part(
        &self,
        py: Python<'_>,
        out: PathBuf,
        part: usize,
        listed: Option<Listed>,
    ) -> Result<(Listed, bool)> {
        let listed = listed.map(to_part);
        let found = py.detach(|| self.sweep.write_part(&out, part, listed.as_ref()));
        let (part, computed) = self.own.checked(py, found)?;
        Ok((of_part(part), computed))
    }

    /// Creates or opens a folder for parts.
    #[pyo3(signature = (out, resume = false))]
    fn open_folder(
        &self,
        #[pyo3(from_py_with = argument)] out: PathBuf,
        #[pyo3(from_py_with = argument)] resume: bool,
    ) -> Result<PySweepFolder> {
        let inner = Some(SharedFolder::open(&self.sweep, &out, resume)?);
        Ok(PySweepFolder { inner })
    }

    /// The text of the manifest with these finished parts.
    #[pyo3(signature = (parts))]
    fn manifest(&self, parts: Vec<Option<Listed>>) -> Result<String> {
        let parts: Vec<Option<Part>> = parts.into_iter().map(|part| part.map(to_part)).collect();
        Ok(self.sweep.manifest(&parts)?)
    }

    /// The parts that the text of a manifest lists, which was read at a place.
    #[pyo3(signature = (place, manifest, resume = false))]
    fn listed_parts(
        &self,
        place: &str,
        manifest: &str,
        #[pyo3(from_py_with = argument)] resume: bool,
    ) -> Result<Vec<Option<Listed>>> {
        let parts = self.sweep.listed_parts(place, manifest, resume)?;
        Ok(parts.into_iter().map(|part| part.map(of_part)).collect())
    }

    /// The name of the file of a part.
    #[pyo3(signature = (part))]
    #[staticmethod]
    fn part_name(part: usize) -> String {
        Sweep::part_name(part)
    }

    /// The result of a sweep whose parts others wrote: those parts, and how many of them were
    /// computed.
    #[pyo3(signature = (folder, parts, computed))]
    fn summary(
        &self,
        folder: Py<PyAny>,
        parts: Vec<Listed>,
        computed: Vec<usize>,
    ) -> PySweepSummary {
        PySweepSummary {
            folder,
            rows: self.sweep.rows(),
            computed: computed.iter().map(|part| self.sweep.rows_in(*part)).sum(),
            parts: parts.len(),
            bytes: parts.iter().map(|part| part.0).sum(),
        }
    }
}

/// Signals, Ctrl-C among them, are looked for a few times a second: false after one.
pub(crate) fn go_on(raised: &mut Option<PyErr>) -> bool {
    let signals = Python::attach(|py| py.check_signals());
    *raised = signals.err();
    raised.is_none()
}

pub(crate) fn count_of(threads: Option<usize>) -> Result<Option<NonZeroUsize>> {
    match threads.map(NonZeroUsize::new) {
        None => Ok(None),
        Some(Some(count)) => Ok(Some(count)),
        Some(None) => Err(Failure::option("threads", "0", "one at least")),
    }
}

fn columns_of(py: Python<'_>, table: Table) -> Result<Bound<'_, PyDict>> {
    let columns = PyDict::new(py);
    for (column, values) in table.columns.iter().zip(table.values) {
        match values {
            Values::Numbers(numbers) => columns.set_item(&column.name, numbers.into_pyarray(py)),
            Values::Counts(counts) => columns.set_item(&column.name, counts.into_pyarray(py)),
            Values::Texts(texts) => {
                let array = py.import("numpy")?.call_method1("array", (texts,))?;
                columns.set_item(&column.name, array)
            }
            _ => Ok(()),
        }?;
    }
    Ok(columns)
}

/// The arguments that choose configurations.
pub(crate) struct Chosen<'a, 'py> {
    pub(crate) samples: Option<u64>,
    pub(crate) seed: u64,
    pub(crate) over: Option<&'a Bound<'py, PyDict>>,
    pub(crate) q: Option<&'a Coordinates<'py>>,
    pub(crate) configurations: Option<Bound<'py, PyAny>>,
    /// Designs without other configurations have home, or `q`.
    pub(crate) designs: bool,
    /// The points of a capability map.
    pub(crate) reach: Option<VoxelGrid>,
    /// Poses that inverse kinematics reaches, and the components that count.
    pub(crate) poses: Option<Bound<'py, PyAny>>,
    pub(crate) task: Option<Task>,
}

impl Chosen<'_, '_> {
    /// The configurations, and the axes of parameters.
    pub(crate) fn source(self, robot: &PyMechanism) -> Result<(Source, Vec<Axis>)> {
        let over = self.over.map_or(Ok(Vec::new()), axes)?;
        let split = AxisKinds::of(over, &robot.inner)?;
        let rest = match self.q {
            None => Vec::new(),
            Some(q) => q.vector(&robot.inner, "q")?.to_vec(),
        };
        let designs = self.designs || !split.parameters.is_empty();
        let grid = !split.coordinates.is_empty();
        let others = [
            ("samples", self.samples.is_some()),
            ("over", grid),
            ("configurations", self.configurations.is_some()),
            ("q", self.q.is_some()),
        ];
        let other = others.iter().find(|(_, is_given)| *is_given).map(|(name, _)| *name);
        if let Some(given) = self.poses {
            if let Some(other) = other.or(self.reach.as_ref().map(|_| "reach")) {
                let reason = "poses have configurations of their own; leave it out";
                return Err(Failure::option(other, "given beside poses", reason));
            }
            let task = self.task.map_or_else(|| Task::named("pose", &robot.inner), Ok)?;
            return Ok((poses(&given, task)?, split.parameters));
        }
        if let Some(reach) = self.reach {
            if other.is_some() {
                let reason = "points have no configurations: leave out samples, over and others";
                return Err(Failure::option("reach", "a dict", reason));
            }
            return Ok((Source::Voxels(reach), split.parameters));
        }
        let source = match (self.samples, grid, self.configurations) {
            (Some(count), false, None) => Source::Samples { count, seed: self.seed },
            (None, true, None) => Source::Grid { axes: split.coordinates, rest },
            (None, false, Some(given)) => Source::Configurations(configurations(robot, &given)?),
            (None, false, None) if designs && rest.is_empty() => Source::Home,
            (None, false, None) if designs => Source::Configurations(rest),
            _ => {
                let reason = "give one of samples, over, configurations, poses and reach";
                return Err(Failure::option("samples", "", reason));
            }
        };
        Ok((source, split.parameters))
    }
}

pub(crate) fn axes(over: &Bound<'_, PyDict>) -> Result<Vec<Axis>> {
    over.iter()
        .map(|(name, values)| {
            let name: String = entry("over", &name)?;
            let (from, to, count) = entry("over", &values)?;
            Ok(Axis { name, from, to, count })
        })
        .collect()
}

pub(crate) fn ranges(vary: &Bound<'_, PyDict>) -> Result<Vec<ParameterRange>> {
    vary.iter()
        .map(|(name, values)| {
            let name: String = entry("vary", &name)?;
            let (from, to) = entry("vary", &values)?;
            Ok(ParameterRange { name, from, to })
        })
        .collect()
}
