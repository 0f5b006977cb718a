//! Configurations and poses as arguments: arrays, columns with names, and files, whose columns are
//! found by their names and never by place.

use std::path::PathBuf;

use cylindroid::control::Task;
use cylindroid::sweep::Source;
use cylindroid_cli::numbers;
use pyo3::prelude::*;

use crate::arrays::Numbers;
use crate::coordinates::{Coordinates, Rows};
use crate::error::{Result, entry};
use crate::mechanism::PyMechanism;

/// Configurations one after the other, of an array, of columns with names, or of a file.
pub(super) fn configurations(robot: &PyMechanism, given: &Bound<'_, PyAny>) -> Result<Vec<f64>> {
    let Ok(path) = given.extract::<PathBuf>() else { return of_columns(robot, given) };
    if numbers::is_arrow(&path) {
        let module = given.py().import("cylindroid._arrow")?;
        return of_columns(robot, &module.call_method1("table", (path,))?);
    }
    let coordinates = robot.inner.coordinates();
    let names: Vec<&str> = coordinates.iter().map(|c| c.name.as_str()).collect();
    Ok(given.py().detach(|| numbers::named_configurations(&path, &names))?)
}

fn of_columns(robot: &PyMechanism, given: &Bound<'_, PyAny>) -> Result<Vec<f64>> {
    let given: Coordinates<'_> = entry("configurations", given)?;
    Ok(Rows::of(&robot.inner, "configurations", &given)?.values.to_vec())
}

/// Poses of an array or of a file.
pub(super) fn poses(given: &Bound<'_, PyAny>, task: Task) -> Result<Source> {
    if let Ok(path) = given.extract::<PathBuf>() {
        let columns = Source::pose_columns(task);
        let rows = given.py().detach(|| numbers::named_columns(&path, columns))?;
        return Ok(Source::poses(&rows, task)?);
    }
    let poses: Numbers<'_> = entry("poses", given)?;
    Ok(Source::Poses { targets: poses.poses("poses")?, task })
}
