//! Output of the commands: aligned tables with six significant digits, or one JSON object.

use std::io::{self, Write};

use comfy_table::{CellAlignment, Table, TableComponent, presets};
use cylindroid::model::Mimic;
use cylindroid::screws::Screw;
use cylindroid::spatial::{Quaternion, Rpy};
use cylindroid::{Matrix, Mechanism, Pose};
use serde::Serialize;

/// Writes one JSON object with full precision; infinite values become `null`.
pub(crate) fn json(out: &mut dyn Write, value: &impl Serialize) -> anyhow::Result<()> {
    // Via a string, so that the error of a closed pipe remains an `io::Error`.
    writeln!(out, "{}", serde_json::to_string_pretty(value)?)?;
    Ok(())
}

/// Six significant digits; "-" for infinite or unknown values.
pub(crate) fn number(x: f64) -> String {
    if x.is_infinite() {
        return "-".to_owned();
    }
    if x == 0.0 || x.is_nan() {
        return x.abs().to_string();
    }
    let scientific = format!("{x:.5e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(5 - exponent).unwrap_or(0);
        return trim_zeros(&format!("{x:.decimals$}")).to_owned();
    }
    format!("{}e{exponent}", trim_zeros(mantissa))
}

fn trim_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// The columns of a matrix as lists.
pub(crate) fn columns(m: &Matrix) -> Vec<Vec<f64>> {
    (0..m.cols()).map(|j| m.column(j).to_vec()).collect()
}

/// A configuration or a quaternion, as [`list`], with rounding errors shown as 0.
pub(crate) fn entries(values: &[f64]) -> String {
    values.iter().map(|x| quiet(*x)).collect::<Vec<_>>().join(", ")
}

/// Numbers of [`number`], separated by commas.
pub(crate) fn list(values: &[f64]) -> String {
    values.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ")
}

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

/// A table without borders; column titles include the units.
pub(crate) fn table(
    out: &mut dyn Write,
    columns: &[(&str, Align)],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> io::Result<()> {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING);
    table.set_header(columns.iter().map(|(name, _)| *name));
    table.set_style(TableComponent::HeaderLines, '-');
    table.set_style(TableComponent::MiddleHeaderIntersections, ' ');
    table.set_style(TableComponent::VerticalLines, ' ');
    table.add_rows(rows);
    for ((_, align), column) in columns.iter().zip(table.column_iter_mut()) {
        column.set_padding((0, 1));
        if *align == Align::Right {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    writeln!(out, "{}", table.trim_fmt())
}

/// Names and values, one pair per line; values are aligned, and wrapped at `WIDTH`.
pub(crate) fn pairs(
    out: &mut dyn Write,
    rows: impl IntoIterator<Item = (&'static str, String)>,
) -> io::Result<()> {
    let rows: Vec<_> = rows.into_iter().filter(|(_, value)| !value.is_empty()).collect();
    let names = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in rows {
        let mut label = name;
        for line in wrap(&value, WIDTH.saturating_sub(names + 2)) {
            writeln!(out, "{label:names$}  {line}")?;
            label = "";
        }
    }
    Ok(())
}

/// Maximum width of running text.
const WIDTH: usize = 98;

/// Wraps running text to this width [characters].
pub(crate) fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        if !lines[last].is_empty() && lines[last].chars().count() + 1 + word.chars().count() > width
        {
            lines.push(word.to_owned());
        } else {
            if !lines[last].is_empty() {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        }
    }
    lines
}

/// A screw in the world frame.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Screw"))]
pub(crate) struct ScrewJson {
    /// Point of the axis closest to the origin; null for a translation.
    point: Option<[f64; 3]>,
    direction: [f64; 3],
    /// [m/rad]; null for a translation.
    #[cfg_attr(test, ts(type = "number | null"))]
    pitch: f64,
    /// [rad/s]; for a translation [m/s].
    amplitude: f64,
}

impl From<&Screw> for ScrewJson {
    fn from(s: &Screw) -> Self {
        Self {
            point: (!s.is_translation()).then(|| s.axis.point.to_array()),
            direction: s.axis.direction.to_array(),
            pitch: s.pitch,
            amplitude: s.amplitude,
        }
    }
}

/// A matrix with names for its rows and columns.
pub(crate) fn matrix(
    out: &mut dyn Write,
    row_names: &[&str],
    column_names: &[&str],
    rows: &[Vec<f64>],
) -> io::Result<()> {
    let columns: Vec<(&str, Align)> = std::iter::once(("", Align::Left))
        .chain(column_names.iter().map(|name| (*name, Align::Right)))
        .collect();
    let cells = row_names.iter().zip(rows).map(|(name, row)| {
        std::iter::once((*name).to_owned()).chain(row.iter().map(|x| quiet(*x))).collect()
    });
    table(out, &columns, cells)
}

/// The columns of [`pose_cells`].
pub(crate) const POSE_COLUMNS: [(&str, Align); 6] = [
    ("x [m]", Align::Right),
    ("y [m]", Align::Right),
    ("z [m]", Align::Right),
    ("roll [rad]", Align::Right),
    ("pitch [rad]", Align::Right),
    ("yaw [rad]", Align::Right),
];

/// Position and roll, pitch, yaw.
pub(crate) fn pose_cells(pose: Pose) -> Vec<String> {
    let Rpy { roll, pitch, yaw } = Rpy::of(pose.rotation);
    let p = pose.translation;
    [p.x, p.y, p.z, roll, pitch, yaw].map(quiet).to_vec()
}

/// [`number`] for entries of poses and matrices of order 1: rounding errors are shown as 0 (JSON
/// has the full value).
fn quiet(x: f64) -> String {
    number(without_rounding(x))
}

/// Replaces rounding errors of quantities of order 1 by zero.
pub(crate) fn without_rounding(x: f64) -> f64 {
    if x.abs() < ROUNDING { 0.0 } else { x }
}

/// Smaller entries are rounding errors [m, rad].
const ROUNDING: f64 = 1e-12;

/// The joint followed by a mimic joint, in JSON.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Mimic"))]
pub(crate) struct MimicJson<'a> {
    joint: &'a str,
    multiplier: f64,
    offset: f64,
}

impl<'a> From<&'a Mimic> for MimicJson<'a> {
    fn from(mimic: &'a Mimic) -> Self {
        let Mimic { joint, multiplier, offset } = mimic;
        Self { joint, multiplier: *multiplier, offset: *offset }
    }
}

/// A pose in JSON: `world_from_frame` in four notations.
#[derive(Debug, Serialize)]
pub(crate) struct PoseJson {
    /// Rows of the 4 x 4 matrix.
    matrix: [[f64; 4]; 4],
    /// Position [m].
    position: [f64; 3],
    quaternion: QuaternionJson,
    /// Roll, pitch, yaw about the fixed x, y, z [rad].
    rpy: [f64; 3],
}

#[derive(Debug, Serialize)]
struct QuaternionJson {
    w: f64,
    x: f64,
    y: f64,
    z: f64,
}

impl From<Pose> for PoseJson {
    fn from(pose: Pose) -> Self {
        let Rpy { roll, pitch, yaw } = Rpy::of(pose.rotation);
        let Quaternion { w, x, y, z } = pose.rotation.to_quaternion();
        Self {
            matrix: pose.to_matrix(),
            position: pose.translation.to_array(),
            quaternion: QuaternionJson { w, x, y, z },
            rpy: [roll, pitch, yaw],
        }
    }
}

/// The names of the coordinates, in the order of `q`.
pub(crate) fn joint_names(robot: &Mechanism) -> Vec<&str> {
    robot.coordinates().iter().map(|c| c.name.as_str()).collect()
}

/// The names of the coordinates outside their position limits.
pub(crate) fn outside_limits<'a>(robot: &'a Mechanism, q: &'a [f64]) -> Vec<&'a str> {
    robot.outside_limits(q).map(|i| robot.coordinates()[i].name.as_str()).collect()
}

/// A note for tables if a configuration is outside the limits, otherwise empty.
pub(crate) fn outside_note(names: &[&str]) -> String {
    if names.is_empty() {
        return String::new();
    }
    format!("outside the position limits: {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits() {
        let printed =
            [0.0, -0.0, 1.0, -0.987_654_321, 123_456.7, 1_234_567.0, 1.5e-7, 0.000_012_345_678];
        assert_eq!(
            printed.map(number),
            ["0", "0", "1", "-0.987654", "123457", "1.23457e6", "1.5e-7", "1.23457e-5"]
        );
        assert_eq!(number(f64::NEG_INFINITY), "-");
    }
}
