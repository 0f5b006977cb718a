//! Numbers between numpy and the library: borrowed on the way in where the layout allows it, one
//! allocation on the way out.
//!
//! Batches have the axis of the configurations first: `(N, n)` in, `(N, ...)` out.

use cylindroid::linalg::Metric;
use cylindroid::tolerance::MAX_MAGNITUDE;
use cylindroid::{Error, Matrix, Pose, Twist, Wrench};
use numpy::{
    Element, IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use pyo3::{IntoPyObjectExt, intern};

use crate::arrow::Shaped;
use crate::error::{Failure, Result, unfit};

/// An array on its way out.
pub(crate) type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// More numbers than this are asked of numpy itself, which has an exception for memory that there
/// is not.
const MANY: usize = 1 << 20;
/// Configurations from which on the interpreter is free for other threads.
const LONG: usize = 4;

/// Numbers of an argument: C-contiguous, aligned, f64. Borrowed where the array is that already.
#[derive(Debug)]
pub(crate) struct Numbers<'py>(Memory<'py>);

/// Whose memory it is.
#[derive(Debug)]
enum Memory<'py> {
    Numpy(PyReadonlyArrayDyn<'py, f64>),
    Arrow(Shaped),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Self::of(&object).map_err(|error| unfit(object.py(), error))
    }
}

impl<'py> Numbers<'py> {
    fn of(object: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>()
            && array.is_c_contiguous()
            && array.is_aligned()
        {
            return Ok(Self(Memory::Numpy(array.try_readonly()?)));
        }
        let py = object.py();
        let numpy = py.import(intern!(py, "numpy"))?;
        // What numpy does not know as an array may hand its memory out.
        let foreign = is_foreign(object)?;
        if foreign && let Some(numbers) = Shaped::from_python(object)? {
            return Ok(Self(Memory::Arrow(numbers)));
        }
        let take = match foreign && object.hasattr(intern!(py, "__dlpack__"))? {
            true => intern!(py, "from_dlpack"),
            false => intern!(py, "asarray"),
        };
        let array = numpy.call_method1(take, (object,))?;
        let kind: String =
            array.getattr(intern!(py, "dtype"))?.getattr(intern!(py, "kind"))?.extract()?;
        // Rows of Arrow, which numpy takes for objects.
        if kind == "O"
            && !foreign
            && let Some(numbers) = Shaped::from_python(object)?
        {
            return Ok(Self(Memory::Arrow(numbers)));
        }
        // Lists that are empty, and numbers: what becomes f64 without losing a part.
        if !matches!(kind.as_str(), "b" | "i" | "u" | "f") {
            let dtype = array.getattr(intern!(py, "dtype"))?;
            return Err(Failure::kind(format!("real numbers are needed, not dtype {dtype}")).into());
        }
        let options = PyDict::new(py);
        options.set_item(intern!(py, "dtype"), intern!(py, "float64"))?;
        options.set_item(intern!(py, "requirements"), ["C", "A"])?;
        let array = numpy.call_method(intern!(py, "require"), (array,), Some(&options))?;
        Ok(Self(Memory::Numpy(array.cast::<PyArrayDyn<f64>>()?.try_readonly()?)))
    }
}

/// True of objects that numpy reads as a sequence of objects, or not at all.
pub(crate) fn is_foreign(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    if object.cast::<PyList>().is_ok() || object.cast::<PyTuple>().is_ok() {
        return Ok(false);
    }
    Ok(!object.hasattr(intern!(object.py(), "__array__"))?)
}

impl From<Shaped> for Numbers<'_> {
    fn from(numbers: Shaped) -> Self {
        Self(Memory::Arrow(numbers))
    }
}

impl Numbers<'_> {
    pub(crate) fn shape(&self) -> &[usize] {
        match &self.0 {
            Memory::Numpy(array) => array.shape(),
            Memory::Arrow(numbers) => &numbers.shape,
        }
    }

    pub(crate) fn values(&self) -> &[f64] {
        match &self.0 {
            // Contiguous by construction.
            Memory::Numpy(array) => array.as_slice().unwrap_or_default(),
            Memory::Arrow(numbers) => &numbers.values,
        }
    }

    pub(crate) fn shape_text(&self) -> String {
        format!("an array of shape {}", shape_text(self.shape()))
    }

    /// The numbers of a vector.
    pub(crate) fn vector(&self, name: &'static str) -> Result<&[f64]> {
        match self.shape() {
            [_] => Ok(self.values()),
            _ => Err(Failure::option(name, self.shape_text(), "a vector has one axis")),
        }
    }

    /// The numbers of a vector of `N` entries.
    pub(crate) fn entries<const N: usize>(&self, name: &'static str) -> Result<[f64; N]> {
        let vector = self.vector(name)?;
        <[f64; N]>::try_from(vector).map_err(|_| {
            let (expected, got) = (N, vector.len());
            Error::Dimension { what: name.to_owned(), expected, got, hint: String::new() }.into()
        })
    }

    /// Six entries whose products are finite.
    fn moderate(&self, name: &'static str) -> Result<[f64; 6]> {
        let entries = self.entries(name)?;
        Error::check_within(name, &entries, MAX_MAGNITUDE)?;
        Ok(entries)
    }

    /// A matrix.
    pub(crate) fn matrix(&self, name: &'static str) -> Result<Matrix> {
        match *self.shape() {
            [rows, cols] => Ok(matrix_of(self.values(), rows, cols)),
            _ => Err(Failure::option(name, self.shape_text(), "a matrix has two axes")),
        }
    }

    /// Twists as columns, linear part first.
    pub(crate) fn twist_columns(&self, name: &'static str) -> Result<Matrix> {
        let m = self.matrix(name)?;
        check_twists(name, &m)?;
        Error::check_finite(name, m.as_slice())?;
        Ok(m)
    }

    /// A twist, linear part first.
    pub(crate) fn twist(&self, name: &'static str) -> Result<Twist> {
        Ok(Twist::from_array(self.moderate(name)?))
    }

    /// A wrench, force first.
    pub(crate) fn wrench(&self, name: &'static str) -> Result<Wrench> {
        Ok(Wrench::from_array(self.moderate(name)?))
    }

    /// A metric from a matrix, or from its diagonal.
    pub(crate) fn metric(&self, name: &'static str) -> Result<Metric> {
        Ok(match self.shape() {
            [_] => Metric::diagonal(name, self.values())?,
            _ => Metric::new(name, &self.matrix(name)?)?,
        })
    }

    /// One matrix or a stack of them.
    pub(crate) fn matrices(&self, name: &'static str) -> Result<Many<Matrix>> {
        match *self.shape() {
            [rows, cols] => Ok(Many::One(matrix_of(self.values(), rows, cols))),
            [n, rows, cols] => {
                let size = rows * cols;
                let at = |i: usize| matrix_of(&self.values()[i * size..(i + 1) * size], rows, cols);
                Ok(Many::All((0..n).map(at).collect()))
            }
            _ => {
                let reason = "a matrix has two axes, a stack of matrices three, the first of them \
                              that of the stack";
                Err(Failure::option(name, self.shape_text(), reason))
            }
        }
    }

    /// Poses from a stack of 4 x 4 matrices.
    pub(crate) fn poses(&self, name: &'static str) -> Result<Vec<Pose>> {
        let [_, 4, 4] = *self.shape() else {
            return Err(Failure::option(name, self.shape_text(), "poses are an array (N, 4, 4)"));
        };
        let matrices = self.values().as_chunks::<4>().0.as_chunks::<4>().0;
        matrices.iter().map(|rows| pose_of(name, *rows)).collect()
    }

    /// A pose from a 4 x 4 matrix.
    pub(crate) fn pose(&self, name: &'static str) -> Result<Pose> {
        match (self.shape(), self.values().as_chunks().0) {
            ([4, 4], [a, b, c, d]) => pose_of(name, [*a, *b, *c, *d]),
            _ => Err(Failure::option(name, self.shape_text(), "a pose is a matrix of 4 x 4")),
        }
    }
}

/// A pose from its rows; an error names the argument.
pub(crate) fn pose_of(name: &'static str, rows: [[f64; 4]; 4]) -> Result<Pose> {
    Pose::from_matrix(rows).map_err(|error| match error {
        Error::InvalidOption { value, reason, .. } => Failure::option(name, value, reason),
        other => entries_of(name, other),
    })
}

/// An error about entries of an argument, with the argument's name.
pub(crate) fn entries_of(name: &str, error: Error) -> Failure {
    Failure::Core(match error {
        Error::NotFinite { what, value } => {
            Error::NotFinite { what: format!("{name}: {what}"), value }
        }
        Error::OutOfRange { what, value, range } => {
            Error::OutOfRange { what: format!("{name}: {what}"), value, range }
        }
        other => other,
    })
}

/// A shape as Python writes it.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({}{})", sizes.join(", "), if sizes.len() == 1 { "," } else { "" })
}

/// Checks a matrix of twists as columns.
pub(crate) fn check_twists(name: &str, m: &Matrix) -> cylindroid::Result<()> {
    Error::check_len(&format!("{name} (its rows)"), 6, m.rows())
}

pub(crate) fn matrix_of(values: &[f64], rows: usize, cols: usize) -> Matrix {
    Matrix::from_fn(rows, cols, |i, j| values[i * cols + j])
}

/// One thing, or a batch.
#[derive(Debug, Clone)]
pub(crate) enum Many<T> {
    One(T),
    All(Vec<T>),
}

impl<T> Many<T> {
    pub(crate) fn as_slice(&self) -> &[T] {
        match self {
            Self::One(x) => std::slice::from_ref(x),
            Self::All(all) => all,
        }
    }

    /// Number of things in a batch.
    pub(crate) fn count(&self) -> Option<usize> {
        match self {
            Self::One(_) => None,
            Self::All(all) => Some(all.len()),
        }
    }

    pub(crate) fn try_map<U, E>(
        &self,
        mut f: impl FnMut(&T) -> std::result::Result<U, E>,
    ) -> std::result::Result<Many<U>, E> {
        Ok(match self {
            Self::One(x) => Many::One(f(x)?),
            Self::All(all) => Many::All(all.iter().map(f).collect::<std::result::Result<_, E>>()?),
        })
    }
}

/// An array of `shape`, with the axis of a batch in front, written by `write`; while that is long
/// other threads of Python run.
pub(crate) fn written<'py>(
    py: Python<'py>,
    count: Option<usize>,
    shape: &[usize],
    write: impl FnOnce(&mut [f64]) + Send,
) -> Result<Array<'py>> {
    written_to(py, None, count, shape, write)
}

/// [`written`] to an array of the caller, the argument `out`, if there is one.
pub(crate) fn written_to<'py>(
    py: Python<'py>,
    out: Option<Bound<'py, PyAny>>,
    count: Option<usize>,
    shape: &[usize],
    write: impl FnOnce(&mut [f64]) + Send,
) -> Result<Array<'py>> {
    let mut sizes = [0; 4];
    let lead = usize::from(count.is_some());
    sizes[0] = count.unwrap_or(0);
    sizes[lead..lead + shape.len()].copy_from_slice(shape);
    let sizes = &sizes[..lead + shape.len()];
    let array = match out {
        None => zeros(py, sizes)?,
        Some(out) => place_of(out, sizes)?,
    };
    let mut out = array.try_readwrite().map_err(|error| {
        let reason = "it is written while another argument, or another call, reads it";
        Failure::option("out", error.to_string(), reason)
    })?;
    let values = out.as_slice_mut().map_err(PyErr::from)?;
    if count.is_some_and(|n| n >= LONG) {
        py.detach(|| write(values));
    } else {
        write(values);
    }
    drop(out);
    Ok(array)
}

/// [`written`] row by row, for one configuration or many: `write` is told which.
pub(crate) fn written_rows<'py>(
    py: Python<'py>,
    count: Option<usize>,
    shape: &[usize],
    write: impl FnMut(usize, &mut [f64]) -> cylindroid::Result<()> + Send,
) -> Result<Array<'py>> {
    written_rows_to(py, None, count, shape, write)
}

/// [`written_to`] row by row.
pub(crate) fn written_rows_to<'py>(
    py: Python<'py>,
    out: Option<Bound<'py, PyAny>>,
    count: Option<usize>,
    shape: &[usize],
    mut write: impl FnMut(usize, &mut [f64]) -> cylindroid::Result<()> + Send,
) -> Result<Array<'py>> {
    let width = shape.iter().product::<usize>().max(1);
    let mut result = Ok(());
    let array = written_to(py, out, count, shape, |out| {
        let mut rows = out.chunks_exact_mut(width).enumerate();
        result = rows.try_for_each(|(i, out)| write(i, out));
    })?;
    result?;
    Ok(array)
}

/// An array of the caller that can hold a result.
fn place_of<'py>(out: Bound<'py, PyAny>, sizes: &[usize]) -> Result<Array<'py>> {
    let array = out.cast_into::<PyArrayDyn<f64>>().map_err(|error| {
        let what = error.into_inner();
        let kind = what.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
        Failure::kind(format!("out: a numpy array of float64 is needed, not {kind}"))
    })?;
    if array.shape() != sizes {
        let reason = format!("the result has shape {}", shape_text(sizes));
        return Err(Failure::option("out", shape_text(array.shape()), reason));
    }
    if !array.is_c_contiguous() || !array.is_aligned() {
        let reason = "its numbers must lie in C order without gaps (numpy.ascontiguousarray)";
        return Err(Failure::option("out", "a view of another array", reason));
    }
    Ok(array)
}

fn zeros<'py>(py: Python<'py>, sizes: &[usize]) -> Result<Array<'py>> {
    let total = sizes.iter().try_fold(1_usize, |a, b| a.checked_mul(*b));
    if total.is_some_and(|t| t <= MANY) {
        return Ok(PyArrayDyn::zeros(py, sizes, false));
    }
    let shape = PyTuple::new(py, sizes)?;
    let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "zeros"), (shape,))?;
    Ok(array.cast_into().map_err(PyErr::from)?)
}

/// A vector.
pub(crate) fn vector<'py>(py: Python<'py>, values: &[f64]) -> Array<'py> {
    numpy::PyArray1::from_slice(py, values).to_dyn().clone()
}

/// A vector of a number (or truth) for each thing, or that number.
pub(crate) fn each<'py, T, X: Element + IntoPyObject<'py>>(
    py: Python<'py>,
    all: &Many<T>,
    f: impl Fn(&T) -> X,
) -> PyResult<Bound<'py, PyAny>> {
    match all {
        Many::One(x) => f(x).into_bound_py_any(py),
        Many::All(all) => Ok(all.iter().map(f).collect::<Vec<X>>().into_pyarray(py).into_any()),
    }
}

/// Rows of `width` numbers: `(K, width)`, or `(width,)` of one thing that is no batch.
pub(crate) fn rows<'py, R: AsRef<[f64]>>(
    py: Python<'py>,
    count: Option<usize>,
    width: usize,
    rows: impl Iterator<Item = R> + Send,
) -> Result<Array<'py>> {
    written(py, count, &[width], |out| {
        for (row, out) in rows.zip(out.chunks_exact_mut(width.max(1))) {
            out.copy_from_slice(row.as_ref());
        }
    })
}

/// Twists as columns, linear part first: `(6, k)`.
pub(crate) fn twists<'py>(py: Python<'py>, all: &[Twist]) -> Result<Array<'py>> {
    let columns: Vec<[f64; 6]> = all.iter().map(|t| t.to_array()).collect();
    matrix(py, &Matrix::from_fn(6, columns.len(), |i, j| columns[j][i]))
}

/// A matrix as rows.
pub(crate) fn matrix<'py>(py: Python<'py>, m: &Matrix) -> Result<Array<'py>> {
    written(py, None, &[m.rows(), m.cols()], |out| put_rows(m, out))
}

/// The columns of a matrix, each a row: a list of vectors as one array.
pub(crate) fn columns<'py>(py: Python<'py>, m: &Matrix) -> Result<Array<'py>> {
    written(py, None, &[m.cols(), m.rows()], |out| out.copy_from_slice(m.as_slice()))
}

/// A pose as a matrix of 4 x 4.
pub(crate) fn pose<'py>(py: Python<'py>, pose: Pose) -> Result<Array<'py>> {
    written(py, None, &[4, 4], |out| put_pose(pose, out))
}

pub(crate) fn put_rows(m: &Matrix, out: &mut [f64]) {
    let cols = m.cols();
    for j in 0..cols {
        for (i, x) in m.column(j).iter().enumerate() {
            out[i * cols + j] = *x;
        }
    }
}

pub(crate) fn put_pose(pose: Pose, out: &mut [f64]) {
    out.copy_from_slice(pose.to_matrix().as_flattened());
}
