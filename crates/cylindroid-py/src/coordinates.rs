//! Configurations and joint velocities as arguments: numbers in the order of the coordinates, or
//! columns with their names in any order.
//!
//! Arrays and lists have places; whatever has names (dicts, frames and rows of pandas, frames of
//! polars, tables of pyarrow and of whatever else hands out Arrow) is read by them and never by
//! place. Labels 0, 1, 2, ... of pandas are places. No library of frames is imported: they are known
//! by their methods.

use std::cell::OnceCell;

use cylindroid::model::Mechanism;
use numpy::{PyArrayDyn, PyUntypedArray};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};

use crate::arrays::{Numbers, is_foreign};
use crate::arrow::Table;
use crate::error::{Failure, Result, unfit};

/// An argument with a number for each coordinate of a mechanism, of one configuration or of many.
#[derive(Debug)]
pub(crate) struct Coordinates<'py>(Kind<'py>);

#[derive(Debug)]
enum Kind<'py> {
    Places(Numbers<'py>),
    Names { columns: Columns<'py>, ordered: OnceCell<Ordered> },
}

/// Columns with labels.
#[derive(Debug)]
enum Columns<'py> {
    Python { object: Bound<'py, PyAny>, labels: Vec<Bound<'py, PyAny>> },
    Arrow(Table),
}

impl<'py> Columns<'py> {
    /// The labels that are text.
    fn texts(&self) -> Vec<Option<String>> {
        match self {
            Self::Python { labels, .. } => {
                let text = |label: &Bound<'_, PyAny>| label.cast::<PyString>().ok()?.extract().ok();
                labels.iter().map(text).collect()
            }
            Self::Arrow(table) => table.names().map(|name| Some(name.to_owned())).collect(),
        }
    }

    /// A label as a message shows it.
    fn label(&self, place: usize) -> String {
        match self {
            Self::Python { labels, .. } => labels[place].to_string(),
            Self::Arrow(table) => table.names().nth(place).unwrap_or_default().to_owned(),
        }
    }

    fn read(&self, place: usize) -> Result<Numbers<'py>> {
        Ok(match self {
            Self::Python { object, labels } => object.get_item(&labels[place])?.extract()?,
            Self::Arrow(table) => table.column(place)?.into(),
        })
    }
}

/// Rows in the order of the coordinates; `count` of many configurations.
#[derive(Debug)]
struct Ordered {
    values: Vec<f64>,
    count: Option<usize>,
}

impl<'a, 'py> FromPyObject<'a, 'py> for Coordinates<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if object.cast::<PyArrayDyn<f64>>().is_ok() {
            return Ok(Self(Kind::Places(object.extract()?)));
        }
        Ok(Self(match columns(&object).map_err(|error| unfit(object.py(), error))? {
            None => Kind::Places(object.extract()?),
            Some(columns) => Kind::Names { columns, ordered: OnceCell::new() },
        }))
    }
}

/// The columns of an object that has names.
fn columns<'py>(object: &Bound<'py, PyAny>) -> PyResult<Option<Columns<'py>>> {
    let py = object.py();
    let has_places = object.cast::<PyList>().is_ok()
        || object.cast::<PyTuple>().is_ok()
        || object.cast::<PyUntypedArray>().is_ok();
    if has_places {
        return Ok(None);
    }
    if is_foreign(object)?
        && let Some(table) = Table::of(object)?
    {
        return Ok(Some(Columns::Arrow(table)));
    }
    if !object.hasattr(intern!(py, "__getitem__"))? {
        return Ok(None);
    }
    // pyarrow; mappings and pandas, of which a row has its labels as keys too; polars.
    let found = if let Ok(names) = object.getattr(intern!(py, "column_names")) {
        names
    } else if let Ok(keys) = object.getattr(intern!(py, "keys")) {
        keys.call0()?
    } else if let Ok(names) = object.getattr(intern!(py, "columns")) {
        names
    } else {
        return Ok(None);
    };
    let mut labels = Vec::new();
    for label in found.try_iter()? {
        labels.push(label?);
    }
    let is_place =
        |(i, label): (usize, &Bound<'py, PyAny>)| label.extract().is_ok_and(|k: usize| k == i);
    let has_places = object.cast::<PyDict>().is_err() && labels.iter().enumerate().all(is_place);
    Ok(if has_places { None } else { Some(Columns::Python { object: object.clone(), labels }) })
}

impl Coordinates<'_> {
    /// One configuration.
    pub(crate) fn vector(&self, mechanism: &Mechanism, name: &'static str) -> Result<&[f64]> {
        match &self.0 {
            Kind::Places(numbers) => numbers.vector(name),
            Kind::Names { .. } => match self.ordered(mechanism, name)? {
                Ordered { values, count: None } => Ok(values),
                Ordered { count: Some(count), .. } => {
                    let reason = "one configuration is needed: one number of each coordinate";
                    Err(Failure::option(name, format!("columns of {count} rows"), reason))
                }
            },
        }
    }

    /// One configuration of a mechanism that is not known yet: names cannot be read.
    pub(crate) fn places(&self, name: &'static str) -> Result<&[f64]> {
        match &self.0 {
            Kind::Places(numbers) => numbers.vector(name),
            Kind::Names { .. } => {
                let reason = "there is no mechanism here that has these names; give an array in the \
                              order of its joint_names";
                Err(Failure::option(name, "columns with names", reason))
            }
        }
    }

    fn ordered(&self, mechanism: &Mechanism, name: &'static str) -> Result<&Ordered> {
        let Kind::Names { columns, ordered } = &self.0 else {
            return Err(Failure::kind(format!("{name}: columns with names are needed")));
        };
        match ordered.get() {
            Some(ordered) => Ok(ordered),
            None => {
                let found = by_name(mechanism, name, columns)?;
                Ok(ordered.get_or_init(|| found))
            }
        }
    }
}

/// The columns of the coordinates, as rows.
fn by_name(
    mechanism: &Mechanism,
    argument: &'static str,
    columns: &Columns<'_>,
) -> Result<Ordered> {
    // As in the motions of `move`, which have q and qd side by side.
    let prefix = if argument == "qd" { "qd." } else { "q." };
    let texts = columns.texts();
    let bare = |text: &str| text.strip_prefix(prefix).unwrap_or(text).to_owned();
    let coordinates = mechanism.coordinates();
    let mut read: Vec<Numbers<'_>> = Vec::with_capacity(coordinates.len());
    for c in coordinates {
        let is_it = |text: &Option<String>| {
            text.as_ref().is_some_and(|text| *text == c.name || bare(text) == c.name)
        };
        let mut places = texts.iter().enumerate().filter(|(_, text)| is_it(text)).map(|(i, _)| i);
        let place = match (places.next(), places.next()) {
            (Some(place), None) => place,
            (Some(_), Some(_)) => {
                let reason = format!("several columns are '{}'", c.name);
                return Err(Failure::option(argument, "the columns", reason));
            }
            (None, _) => return Err(missing(mechanism, argument, &c.name, columns, &texts)),
        };
        let numbers = columns.read(place).map_err(|failure| {
            let error = PyErr::from(failure);
            Failure::option(argument, format!("column '{}'", c.name), error.to_string())
        })?;
        read.push(numbers);
    }
    let one = |numbers: &Numbers<'_>| match *numbers.shape() {
        [] => Some(None),
        [count] => Some(Some(count)),
        _ => None,
    };
    let count = read.first().and_then(one).unwrap_or(None);
    if let Some(i) = read.iter().position(|numbers| one(numbers) != Some(count)) {
        let value = format!("column '{}', {}", coordinates[i].name, read[i].shape_text());
        let reason = match count {
            None => "others are one number".to_owned(),
            Some(count) => format!("others have {count} rows"),
        };
        return Err(Failure::option(argument, value, reason));
    }
    let read: Vec<&[f64]> = read.iter().map(Numbers::values).collect();
    let rows = count.unwrap_or(1);
    let values = (0..rows).flat_map(|i| read.iter().map(move |column| column[i])).collect();
    Ok(Ordered { values, count })
}

/// The error about a coordinate without a column, with the columns that are no coordinates.
fn missing(
    mechanism: &Mechanism,
    argument: &'static str,
    name: &str,
    columns: &Columns<'_>,
    texts: &[Option<String>],
) -> Failure {
    let known: Vec<&str> = mechanism.coordinates().iter().map(|c| c.name.as_str()).collect();
    let others = texts.iter().enumerate().filter(|(_, text)| {
        !text.as_ref().is_some_and(|text| {
            known.iter().any(|k| k == text || text.split_once('.').is_some_and(|(_, b)| b == *k))
        })
    });
    let others: Vec<String> = others.take(8).map(|(i, _)| columns.label(i)).collect();
    let others = match others.is_empty() {
        true => String::new(),
        false => format!("; columns that are no coordinates: {}", others.join(", ")),
    };
    let reason =
        format!("it has no column '{name}'; the coordinates are {}{others}", known.join(", "));
    Failure::option(argument, "the columns", reason)
}

/// Configurations (or joint velocities) of a mechanism: `(n,)` or `(N, n)`, all finite.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) width: usize,
    /// Of a batch; `None` for one configuration.
    pub(crate) count: Option<usize>,
}

impl<'a> Rows<'a> {
    pub(crate) fn of(
        mechanism: &Mechanism,
        name: &'static str,
        given: &'a Coordinates<'_>,
    ) -> Result<Self> {
        let n = mechanism.n();
        let rows = match &given.0 {
            Kind::Places(numbers) => {
                let (width, count) = match *numbers.shape() {
                    [width] => (width, None),
                    [count, width] => (width, Some(count)),
                    _ => {
                        let reason =
                            format!("give ({n},) for one configuration or (N, {n}) for many");
                        return Err(Failure::option(name, numbers.shape_text(), reason));
                    }
                };
                Self { values: numbers.values(), width, count }
            }
            Kind::Names { .. } => {
                let Ordered { values, count } = given.ordered(mechanism, name)?;
                Self { values, width: n, count: *count }
            }
        };
        if rows.width != n {
            mechanism.check_q(name, &vec![0.0; rows.width])?;
        }
        match rows.count {
            None => mechanism.check_q(name, rows.values)?,
            Some(_) => mechanism.check_rows(name, rows.values)?,
        }
        Ok(rows)
    }

    pub(crate) fn row(&self, i: usize) -> &'a [f64] {
        &self.values[i * self.width..(i + 1) * self.width]
    }
}
