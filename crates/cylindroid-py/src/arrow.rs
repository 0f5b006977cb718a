//! Tables and arrays of Arrow, from any library and to any, by its PyCapsule interface.
//!
//! No library of Arrow is imported in Python. Numbers of 64 bits without gaps, in one piece, are
//! read where they lie; what is handed out is shared, not copied.

#![allow(unsafe_code)] // Arrow's C interface hands structures over as pointers

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi::{self, FFI_ArrowArray, FFI_ArrowSchema};
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type,
    UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{
    Array, ArrayRef, RecordBatch, RecordBatchIterator, RecordBatchReader, StructArray, make_array,
};
use arrow_buffer::ScalarBuffer;
use arrow_schema::{ArrowError, DataType, SchemaRef};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyTuple};

use crate::error::{Failure, Result};

/// Columns with names, in one or more pieces.
#[derive(Debug)]
pub(crate) struct Table {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

/// Numbers with a shape, row-major.
#[derive(Debug)]
pub(crate) struct Shaped {
    pub(crate) values: ScalarBuffer<f64>,
    pub(crate) shape: Vec<usize>,
}

impl Table {
    /// The columns that an object hands out; `None` of one that hands out none.
    pub(crate) fn of(object: &Bound<'_, PyAny>) -> Result<Option<Self>> {
        let py = object.py();
        if let Some(export) = object.getattr_opt(intern!(py, "__arrow_c_stream__"))? {
            let capsule = export.call0()?.cast_into::<PyCapsule>().map_err(PyErr::from)?;
            let at = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
            // SAFETY: a capsule of this name holds a stream, which is moved out of it, as Arrow's
            // interface demands: the capsule is left with an empty one.
            let stream = unsafe { FFI_ArrowArrayStream::from_raw(at.cast().as_ptr()) };
            // An array's stream has no columns.
            if let Ok(reader) = RecordBatchStreamReader::try_new(stream) {
                let schema = reader.schema();
                let batches = reader.collect::<std::result::Result<_, _>>().map_err(broken)?;
                return Ok(Some(Self { schema, batches }));
            }
        }
        Ok(array(object)?.and_then(|array| {
            let columns: &StructArray = array.as_struct_opt()?;
            let batch = RecordBatch::from(columns.clone());
            Some(Self { schema: batch.schema(), batches: vec![batch] })
        }))
    }

    /// A table to hand out.
    pub(crate) fn new(batch: RecordBatch) -> Self {
        Self { schema: batch.schema(), batches: vec![batch] }
    }

    /// The names of the columns.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.schema.fields().iter().map(|field| field.name().as_str())
    }

    /// The numbers of a column.
    pub(crate) fn column(&self, place: usize) -> Result<Shaped> {
        let mut pieces = self.batches.iter().map(|batch| Shaped::of(batch.column(place)));
        let first = match pieces.next() {
            Some(first) => first?,
            None => return Ok(Shaped { values: ScalarBuffer::default(), shape: vec![0] }),
        };
        let mut rest = pieces.peekable();
        if rest.peek().is_none() {
            return Ok(first);
        }
        let (mut values, mut shape) = (first.values.to_vec(), first.shape);
        for piece in rest {
            let piece = piece?;
            values.extend_from_slice(&piece.values);
            shape[0] += piece.shape[0];
        }
        Ok(Shaped { values: values.into(), shape })
    }

    /// The capsule of a stream of all batches, which share their memory with these.
    pub(crate) fn capsule<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let batches = self.batches.clone().into_iter().map(Ok::<_, ArrowError>);
        let reader = RecordBatchIterator::new(batches, Arc::clone(&self.schema));
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}

impl Shaped {
    /// The numbers that an object hands out; `None` of one that hands out none.
    pub(crate) fn from_python(object: &Bound<'_, PyAny>) -> Result<Option<Self>> {
        array(object)?.map(|array| Self::of(&array)).transpose()
    }

    fn of(array: &ArrayRef) -> Result<Self> {
        let length = array.len();
        let values = match array.data_type() {
            DataType::Float64 if array.null_count() == 0 => {
                array.as_primitive::<Float64Type>().values().clone()
            }
            DataType::Float64 => converted::<Float64Type>(array, |x| x),
            DataType::Float32 => converted::<Float32Type>(array, f64::from),
            DataType::Int8 => converted::<Int8Type>(array, f64::from),
            DataType::Int16 => converted::<Int16Type>(array, f64::from),
            DataType::Int32 => converted::<Int32Type>(array, f64::from),
            DataType::Int64 => converted::<Int64Type>(array, |x| x as f64),
            DataType::UInt8 => converted::<UInt8Type>(array, f64::from),
            DataType::UInt16 => converted::<UInt16Type>(array, f64::from),
            DataType::UInt32 => converted::<UInt32Type>(array, f64::from),
            DataType::UInt64 => converted::<UInt64Type>(array, |x| x as f64),
            // Rows of one length are an array of more axes.
            DataType::FixedSizeList(_, size) if array.null_count() == 0 => {
                let inner = Self::of(array.as_fixed_size_list().values())?;
                let width = usize::try_from(*size).unwrap_or(0);
                let shape = [&[length, width], inner.shape.get(1..).unwrap_or_default()].concat();
                return Ok(Self { values: inner.values, shape });
            }
            other => {
                let gaps = if array.null_count() > 0 { " with rows that are null" } else { "" };
                let message = format!("real numbers are needed, not Arrow's {other}{gaps}");
                return Err(Failure::kind(message));
            }
        };
        Ok(Self { values, shape: vec![length] })
    }
}

/// Numbers of another type; those that are missing are not numbers, as in numpy.
fn converted<T: ArrowPrimitiveType>(
    array: &ArrayRef,
    number: impl Fn(T::Native) -> f64,
) -> ScalarBuffer<f64> {
    let all = array.as_primitive::<T>().iter();
    all.map(|x| x.map_or(f64::NAN, &number)).collect::<Vec<f64>>().into()
}

/// The array that an object hands out.
fn array(object: &Bound<'_, PyAny>) -> Result<Option<ArrayRef>> {
    let Some(export) = object.getattr_opt(intern!(object.py(), "__arrow_c_array__"))? else {
        return Ok(None);
    };
    let pair = export.call0()?.cast_into::<PyTuple>().map_err(PyErr::from)?;
    let [schema, array] = [0, 1].map(|i| -> PyResult<Bound<'_, PyCapsule>> {
        Ok(pair.get_item(i)?.cast_into::<PyCapsule>()?)
    });
    let (schema, array) = (schema?, array?);
    let (of_schema, of_array) = (
        schema.pointer_checked(Some(c"arrow_schema"))?,
        array.pointer_checked(Some(c"arrow_array"))?,
    );
    // SAFETY: capsules of these names hold a schema, which is read while it is alive, and an array,
    // which is moved out: the capsule is left with an empty one.
    let data = unsafe {
        let array = FFI_ArrowArray::from_raw(of_array.cast().as_ptr());
        ffi::from_ffi(array, of_schema.cast::<FFI_ArrowSchema>().as_ref())
    };
    Ok(Some(make_array(data.map_err(broken)?)))
}

fn broken(error: ArrowError) -> Failure {
    Failure::kind(format!("its Arrow interface fails: {error}"))
}
