//! The class `Columns`: numbers by name, for libraries of frames.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchOptions};
use arrow_schema::{DataType, Field, Schema};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyIterator, PyList};

use crate::arrays::{self, Array};
use crate::arrow::Table;
use crate::error::{Failure, Result};

/// Columns of numbers with names and units, for libraries of frames: `polars.DataFrame(columns)`,
/// `pyarrow.table(columns)` and `pandas.DataFrame.from_arrow(columns)` read them, as does whatever
/// else takes Arrow's PyCapsule interface; polars and pyarrow without a copy.
///
/// As a mapping it has an array (N,) for each name, which is new each time. Wherever configurations
/// go in, columns with the names of the coordinates do.
///
/// Attributes
/// ----------
/// units : dict of str to str
///     The unit of each column ('rad', 'm', '1', ...), in Arrow the field's metadata `unit`.
#[pyclass(frozen, mapping, name = "Columns", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyColumns {
    batch: RecordBatch,
}

/// A column on its way out.
#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) values: Vec<f64>,
}

impl PyColumns {
    /// Columns of this many rows.
    pub(crate) fn of(columns: Vec<Column>, rows: usize) -> Result<Self> {
        let (fields, arrays): (Vec<Field>, Vec<ArrayRef>) = columns
            .into_iter()
            .map(|Column { name, unit, values }| {
                let unit = HashMap::from([("unit".to_owned(), unit.to_owned())]);
                let field = Field::new(name, DataType::Float64, false).with_metadata(unit);
                (field, Arc::new(Float64Array::from(values)) as ArrayRef)
            })
            .unzip();
        // A mechanism without joints has no column, but rows.
        let options = RecordBatchOptions::new().with_row_count(Some(rows));
        let batch =
            RecordBatch::try_new_with_options(Arc::new(Schema::new(fields)), arrays, &options)
                .map_err(|error| Failure::kind(error.to_string()))?;
        Ok(Self { batch })
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        self.batch.schema_ref().fields().iter().map(|field| field.name().as_str())
    }
}

/// The columns of rows of `width` numbers.
pub(crate) fn transposed(
    rows: &[f64],
    width: usize,
    about: impl Iterator<Item = (String, &'static str)>,
) -> impl Iterator<Item = Column> {
    about.take(width).enumerate().map(move |(i, (name, unit))| {
        let values = rows.iter().skip(i).step_by(width).copied().collect();
        Column { name, unit, values }
    })
}

#[pymethods]
impl PyColumns {
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for field in self.batch.schema_ref().fields() {
            units.set_item(field.name(), field.metadata().get("unit"))?;
        }
        Ok(units)
    }

    /// The names of the columns, in their order.
    fn keys(&self) -> Vec<&str> {
        self.names().collect()
    }

    fn __len__(&self) -> usize {
        self.batch.num_columns()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, self.keys())?.try_iter()
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.names().any(|n| n == name))
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> Result<Array<'py>> {
        match self.batch.column_by_name(name) {
            Some(column) => Ok(arrays::vector(py, column.as_primitive::<Float64Type>().values())),
            None => Err(cylindroid::Error::unknown("column", name, self.names()).into()),
        }
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface permits to hand out another schema than was asked for: this one is the only.
        let _ = requested_schema;
        Table::new(self.batch.clone()).capsule(py)
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.names().collect();
        format!("<Columns of {} rows: {}>", self.batch.num_rows(), names.join(", "))
    }
}
