//! Sweeps: quantities of many configurations and designs, as arrays or in a folder.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use cylindroid::control::Task;
use cylindroid::sweep::{
    Axis, AxisKinds, DesignSpace, ParameterRange, Progress, Quantity, Source, Summary, Sweep,
    SweepOptions, Values, VelocityMetric, WriteOptions, parquet_configurations,
};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Numbers, Rows};
use crate::error::{Failure, Result, argument, entry};
use crate::mechanism::PyMechanism;

/// A sweep in a folder.
///
/// Attributes
/// ----------
/// folder : Path
///     `part-*.parquet` and `manifest.json`, with the recipe, the columns with their units and the
///     SHA-256 of each part.
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
    folder: PathBuf,
    rows: u64,
    computed: u64,
    parts: usize,
    bytes: u64,
}

#[pymethods]
impl PySweepSummary {
    fn __repr__(&self) -> String {
        let Self { rows, parts, .. } = self;
        format!(
            "SweepSummary({rows} rows in {parts} parts, {:?})",
            self.folder.display().to_string()
        )
    }
}

/// Quantities of many configurations: samples within the limits, a grid, or configurations.
///
/// Sample i is a function of `seed` and i alone, and results do not depend on the number of threads.
/// At most one of `samples`, coordinates in `over`, and `configurations` is given. With parameters of
/// the mechanism file in `over`, or with `vary`, all of it is computed for each design.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
///     Samples and grids need one without loops.
/// samples : int, optional
///     Number of points of a scrambled Sobol' sequence within the position limits; joints without
///     limits rotate through [-pi, pi).
/// seed : int
///     Selects one of the sequences.
/// over : dict of str to (float, float, int), optional
///     A grid: of a coordinate its first and last value [rad or m] and the number of values; the
///     last one changes fastest. Parameters of the mechanism file are axes of a grid of designs; of
///     designs alone, the configuration is home, or `q`.
/// q : array_like, (n,), optional
///     The other coordinates of a grid [rad or m]. Default: home.
/// configurations : array_like, (N, n), mapping, DataFrame or path of a Parquet file, optional
///     Configurations [rad or m]; where columns have names, those of the coordinates are taken, in
///     any order.
/// quantities : sequence of str
///     Of 'pose', 'jacobian', 'singular_values', 'smallest_singular_value', 'condition',
///     'yoshikawa', 'limit_distance', 'gibson_hunt', 'measures'; of closed chains 'pose',
///     'limit_distance' and 'measures'.
/// frame : str, optional
///     One of `frames`. Default: the tool, of a closed chain its reference.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// task : str, optional
///     The components that the measures of the Jacobian see, world axes: 'pose', 'position',
///     'orientation', or some of 'x,y,z,rx,ry,rz'. Default: 'pose'.
/// metric : str
///     Of 'yoshikawa' and 'measures': 'unit', 'length' or 'limits', as for `manipulability`.
/// length : float, optional
///     Characteristic length (m). Default: that of the mechanism, `reach`.
/// out : path, optional
///     Folder for Parquet files, which is created.
/// resume : bool
///     Continue a folder that was interrupted; its finished parts are verified.
/// threads : int, optional
///     Default: as many as the machine has.
/// vary : dict of str to (float, float), optional
///     Ranges of parameters for sampled designs, a Sobol' sequence too.
/// designs : int
///     Their number.
///
/// Returns
/// -------
/// dict of str to ndarray, (N,), or SweepSummary
///     The columns: 'index', the coordinates by name, then those of the quantities. Of designs,
///     'design', 'design_valid' and the parameters precede the coordinates; a design whose file
///     cannot be loaded with its values has 'design_valid' 0 and NaN. With `out` the summary of the
///     folder.
///
/// Raises
/// ------
/// InvalidOptionError
///     Also for a folder of another recipe, with the difference, and for samples of sliders without
///     limits.
/// UnknownNameError, DimensionError, NotFiniteError, UnreadableFileError
///
/// Notes
/// -----
/// An interrupt (Ctrl-C) leaves a folder that `resume` continues to the same bytes.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> panda = cy.load("panda")
/// >>> found = cy.sweep(panda, samples=1000, quantities=["pose", "yoshikawa"])
/// >>> found["yoshikawa"].shape
/// (1000,)
/// >>> list(found)[-3:]
/// ['qy', 'qz', 'yoshikawa']
#[pyfunction]
#[pyo3(signature = (mechanism, samples = None, seed = 0, over = None, q = None,
    configurations = None, quantities = None, frame = None, tool = None, task = None, metric = "unit", length = None,
    out = None, resume = false, threads = None,
    vary = None, designs = 0))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = argument)] mechanism: PyRef<'py, PyMechanism>,
    #[pyo3(from_py_with = argument)] samples: Option<u64>,
    #[pyo3(from_py_with = argument)] seed: u64,
    #[pyo3(from_py_with = argument)] over: Option<Bound<'py, PyDict>>,
    q: Option<Numbers<'py>>,
    configurations: Option<Bound<'py, PyAny>>,
    #[pyo3(from_py_with = argument)] quantities: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] frame: Option<&str>,
    tool: Option<Numbers<'py>>,
    #[pyo3(from_py_with = argument)] task: Option<&str>,
    #[pyo3(from_py_with = argument)] metric: &str,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    #[pyo3(from_py_with = argument)] out: Option<PathBuf>,
    #[pyo3(from_py_with = argument)] resume: bool,
    #[pyo3(from_py_with = argument)] threads: Option<usize>,
    #[pyo3(from_py_with = argument)] vary: Option<Bound<'py, PyDict>>,
    #[pyo3(from_py_with = argument)] designs: u64,
) -> Result<Bound<'py, PyAny>> {
    let robot = &*mechanism;
    let mechanism = robot.inner.clone();
    let over = over.as_ref().map_or(Ok(Vec::new()), axes)?;
    let ranges = vary.as_ref().map_or(Ok(Vec::new()), ranges)?;
    let split = AxisKinds::of(over, &mechanism)?;
    let space = match (split.parameters.is_empty(), ranges.is_empty()) {
        (true, true) => None,
        (false, true) => Some(DesignSpace::Grid(split.parameters)),
        (true, false) => Some(DesignSpace::Samples { ranges, count: designs, seed }),
        (false, false) => {
            let reason = "designs are a grid or samples: give parameters in over or in vary";
            return Err(Failure::option("vary", "a dict", reason));
        }
    };
    let rest = match &q {
        None => Vec::new(),
        Some(q) => q.vector("q")?.to_vec(),
    };
    let grid = !split.coordinates.is_empty();
    let source = match (samples, grid, configurations) {
        (Some(count), false, None) => Source::Samples { count, seed },
        (None, true, None) => Source::Grid { axes: split.coordinates, rest },
        (None, false, Some(configurations)) => {
            Source::Configurations(rows(robot, &configurations)?)
        }
        (None, false, None) if space.is_some() && rest.is_empty() => Source::Home,
        (None, false, None) if space.is_some() => Source::Configurations(rest),
        _ => {
            let reason = "give one of samples, over and configurations";
            return Err(Failure::option("samples", "", reason));
        }
    };
    let quantities = match quantities {
        None => Quantity::usual(&mechanism).to_vec(),
        Some(named) => {
            named.iter().map(|name| Quantity::named(name)).collect::<cylindroid::Result<_>>()?
        }
    };
    let chosen = frame.is_some() || tool.is_some();
    let end_effector = if chosen { Some(robot.end_effector(frame, tool.as_ref())?) } else { None };
    let options = SweepOptions {
        source,
        quantities,
        end_effector,
        task: task.map(|name| Task::named(name, &mechanism)).transpose()?,
        metric: VelocityMetric::named(metric)?,
        length,
        part_rows: if space.is_some() { Sweep::DESIGN_PART_ROWS } else { Sweep::PART_ROWS },
    };
    let threads = match threads {
        None => None,
        Some(count) => match NonZeroUsize::new(count) {
            Some(count) => Some(count),
            None => return Err(Failure::option("threads", "0", "one at least")),
        },
    };
    if resume && out.is_none() {
        return Err(Failure::option("resume", "True", "name the folder with out"));
    }
    let sweep = match space {
        None => Sweep::new(&mechanism, options)?,
        Some(space) => Sweep::of_designs(&robot.parametric()?, space, options)?,
    };
    // Signals, Ctrl-C among them, are looked for a few times a second.
    let mut raised = None;
    let observe = |_: &Progress| {
        let signals = Python::attach(|py| py.check_signals());
        raised = signals.err();
        raised.is_none()
    };
    if let Some(folder) = out {
        let options = WriteOptions { threads, resume };
        let found = py.detach(|| sweep.write(&folder, &options, observe));
        if let Some(error) = raised {
            return Err(error.into());
        }
        let Summary { rows, computed, parts, bytes, .. } = found?;
        let summary = PySweepSummary { folder, rows, computed, parts, bytes };
        return Ok(Bound::new(py, summary)?.into_any());
    }
    let found = py.detach(|| sweep.collect(threads, observe));
    if let Some(error) = raised {
        return Err(error.into());
    }
    let columns = PyDict::new(py);
    let Some(table) = found? else { return Ok(columns.into_any()) };
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
    Ok(columns.into_any())
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

fn ranges(vary: &Bound<'_, PyDict>) -> Result<Vec<ParameterRange>> {
    vary.iter()
        .map(|(name, values)| {
            let name: String = entry("vary", &name)?;
            let (from, to) = entry("vary", &values)?;
            Ok(ParameterRange { name, from, to })
        })
        .collect()
}

/// Configurations one after the other, of an array, of columns with names, or of a file.
fn rows(robot: &PyMechanism, given: &Bound<'_, PyAny>) -> Result<Vec<f64>> {
    let mechanism = &robot.inner;
    let names: Vec<&str> = mechanism.coordinates().iter().map(|c| c.name.as_str()).collect();
    if let Ok(path) = given.extract::<PathBuf>() {
        return Ok(parquet_configurations(&path, &names)?);
    }
    // Mappings, data frames and tables of pyarrow.
    let known = ["columns", "keys"].iter().find(|name| given.hasattr(**name).unwrap_or(false));
    let has_names = known.is_some() && given.hasattr("__getitem__")?;
    if !has_names {
        let numbers: Numbers<'_> = entry("configurations", given)?;
        let rows = Rows::of(mechanism, "configurations", &numbers)?;
        return Ok(rows.values.to_vec());
    }
    let mut columns: Vec<Numbers<'_>> = Vec::with_capacity(names.len());
    for name in &names {
        let column = given.get_item(name).map_err(|_| {
            let reason =
                format!("it has no column '{name}'; the coordinates are {}", names.join(", "));
            Failure::option("configurations", "the columns", reason)
        })?;
        columns.push(entry("configurations", &column)?);
    }
    let columns: Vec<&[f64]> =
        columns.iter().map(|c| c.vector("configurations")).collect::<Result<_>>()?;
    let count = columns.first().map_or(0, |c| c.len());
    if let Some(i) = columns.iter().position(|c| c.len() != count) {
        let value = format!("column '{}' of {} rows", names[i], columns[i].len());
        return Err(Failure::option("configurations", value, format!("others have {count}")));
    }
    Ok((0..count).flat_map(|i| columns.iter().map(move |c| c[i])).collect())
}
