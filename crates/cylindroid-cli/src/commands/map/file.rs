//! A map in a file: cells as rows of CSV, or all of it as JSON.

use std::path::Path;

use cylindroid::sweep::Map;
use cylindroid::{Error, Mechanism, Result};
use serde::Serialize;

use super::report::MapJson;
use crate::output_file;

#[derive(Debug, Serialize)]
struct FileJson<'a> {
    #[serde(flatten)]
    report: &'a MapJson<'a>,
    /// Of `rows`.
    columns: Vec<String>,
    /// A row for each mode and cell that it reaches.
    rows: Vec<Vec<f64>>,
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Rejects names that end neither in .csv nor in .json.
pub(super) fn check(path: &Path) -> Result<()> {
    if ["csv", "json"].contains(&extension(path).as_str()) {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "--out",
        value: path.display().to_string(),
        reason: "the name must end in .csv or .json".to_owned(),
    })
}

/// The names of the columns.
fn columns(robot: &Mechanism, map: &Map) -> Vec<String> {
    let axes = map.axes.iter().map(|axis| axis.name.clone());
    let joints = robot.coordinates().iter().map(|c| c.name.clone());
    let measures = ["type_one", "type_two", "limit_distance"].map(str::to_owned);
    std::iter::once("mode".to_owned()).chain(axes).chain(joints).chain(measures).collect()
}

/// The rows of one mode after another, numbered from 1.
fn rows(robot: &Mechanism, map: &Map) -> Vec<Vec<f64>> {
    let n = robot.n();
    let mut rows = Vec::new();
    for (number, mode) in map.modes.iter().enumerate() {
        for cell in (0..map.cells()).filter(|&cell| mode.reached[cell]) {
            let mut row = vec![(number + 1) as f64];
            row.extend(map.values(cell));
            row.extend(&mode.q[cell * n..(cell + 1) * n]);
            row.extend([mode.type_one[cell], mode.type_two[cell], mode.limit_distance[cell]]);
            rows.push(row);
        }
    }
    rows
}

/// Writes the file.
pub(super) fn write(robot: &Mechanism, map: &Map, report: &MapJson<'_>, path: &Path) -> Result<()> {
    let cannot = |message: String| Error::Io { path: path.to_owned(), action: "write", message };
    let (columns, rows) = (columns(robot, map), rows(robot, map));
    if extension(path) == "json" {
        let text = serde_json::to_string(&FileJson { report, columns, rows });
        let text = text.map_err(|e| cannot(e.to_string()))?;
        return output_file::write(path, text + "\n").map_err(|e| cannot(e.to_string()));
    }
    let failed = |e: csv::Error| cannot(e.to_string());
    let mut writer =
        csv::Writer::from_writer(output_file::create(path).map_err(|e| cannot(e.to_string()))?);
    writer.write_record(&columns).map_err(failed)?;
    for row in rows {
        writer.write_record(row.iter().map(ToString::to_string)).map_err(failed)?;
    }
    let file = writer.into_inner().map_err(|e| cannot(e.error().to_string()))?;
    file.finish().map(drop).map_err(|e| cannot(e.to_string()))
}
