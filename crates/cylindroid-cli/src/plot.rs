//! The motion of `move` as an SVG: joints, errors and singular value ratio over time.

pub(crate) mod ellipses;
pub(crate) mod screws;
mod skeleton;

use std::ops::Range;
use std::path::Path;

use cylindroid::{Error, Result};
use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::trajectory::{Row, Trajectory, cannot_write};

const SIZE: (u32, u32) = (960, 900);
/// Width of the legend [px].
const LEGEND: u32 = 190;
/// Most points of a line: more cannot be seen.
const POINTS: usize = 1200;
/// Errors below this are drawn here [m, rad].
const SMALLEST_ERROR: f64 = 1e-9;
const FONT: &str = "sans-serif";
/// Dark enough on white, told apart also by most colour-blind readers.
const COLOURS: [RGBColor; 9] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 95, 0),
    RGBColor(0, 140, 105),
    RGBColor(190, 35, 45),
    RGBColor(125, 80, 170),
    RGBColor(125, 85, 65),
    RGBColor(215, 75, 165),
    RGBColor(95, 95, 95),
    RGBColor(150, 140, 0),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;

/// A line of a panel.
struct Line {
    name: String,
    colour: RGBColor,
    points: Vec<(f64, f64)>,
}

/// Refuses names that do not end in .svg.
pub(crate) fn check(path: &Path) -> Result<()> {
    if path.extension().is_some_and(|e| e == "svg") {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "--plot",
        value: path.display().to_string(),
        reason: "the name must end in .svg".to_owned(),
    })
}

/// Draws a motion.
pub(crate) fn draw(trajectory: &Trajectory, path: &Path) -> Result<()> {
    save(path, |svg| panels(trajectory, svg))
}

/// Writes what is drawn.
fn save(path: &Path, draw: impl FnOnce(&mut String) -> Drawn) -> Result<()> {
    let mut svg = String::new();
    draw(&mut svg).map_err(|error| cannot_write(path, &error))?;
    std::fs::write(path, svg).map_err(|error| cannot_write(path, &error))
}

fn panels(trajectory: &Trajectory, svg: &mut String) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!("{}: motion of {}", trajectory.model, trajectory.frame);
    let root = root.titled(&title, (FONT, 20))?;
    let areas = root.split_evenly((3, 1));
    let rows = thinned(&trajectory.samples);
    let end = rows.last().map_or(1.0, |row| row.time);
    let time = 0.0..if end > 0.0 { end } else { 1.0 };
    let line = |name: &str, i: usize, value: &dyn Fn(&Row) -> f64| Line {
        name: name.to_owned(),
        colour: COLOURS[i % COLOURS.len()],
        points: rows.iter().map(|row| (row.time, value(row))).collect(),
    };

    let joints: Vec<Line> = trajectory
        .joint_names
        .iter()
        .enumerate()
        .map(|(i, name)| line(name, i, &|row| row.q[i]))
        .collect();
    let mut units = trajectory.units.clone();
    units.sort_unstable();
    units.dedup();
    linear_panel(&areas[0], &joints, &time, &format!("joints [{}]", units.join(", ")))?;

    // What is not driven has no error at any time.
    let mut errors = Vec::new();
    if rows.iter().any(|row| row.position_error > 0.0) {
        errors.push(line("position [m]", 0, &|row| row.position_error.max(SMALLEST_ERROR)));
    }
    if rows.iter().any(|row| row.orientation_error > 0.0) {
        errors.push(line("orientation [rad]", 1, &|row| row.orientation_error.max(SMALLEST_ERROR)));
    }
    log_panel(&areas[1], &errors, &time, "error [m, rad]")?;

    let ratio = [line("smallest / largest", 2, &|row| row.singular_ratio)];
    linear_panel(&areas[2], &ratio, &time, "singular value ratio [-]")?;
    root.present()?;
    drop((areas, root));
    Ok(())
}

/// At most about `POINTS` rows, the last among them.
fn thinned(rows: &[Row]) -> Vec<&Row> {
    let stride = rows.len().div_ceil(POINTS).max(1);
    let mut kept: Vec<&Row> = rows.iter().step_by(stride).collect();
    if !rows.len().saturating_sub(1).is_multiple_of(stride) {
        kept.extend(rows.last());
    }
    kept
}

fn linear_panel(area: &Area<'_>, lines: &[Line], time: &Range<f64>, label: &str) -> Drawn {
    let (low, high) = extent(lines);
    let margin = 0.06 * (high - low).max(1e-3);
    // A quantity that is never negative is drawn from zero.
    let low = if low >= 0.0 { 0.0 } else { low - margin };
    let (chart_area, legend_area) = area.split_horizontally(SIZE.0 - LEGEND);
    let mut chart = builder(&chart_area).build_cartesian_2d(time.clone(), low..high + margin)?;
    finish(&mut chart, lines, label, Numbers { most: 6, form: None })?;
    legend(&legend_area, lines)
}

fn log_panel(area: &Area<'_>, lines: &[Line], time: &Range<f64>, label: &str) -> Drawn {
    let (low, high) = extent(lines);
    // Nothing to draw leaves 0 and 1.
    let low = low.max(SMALLEST_ERROR);
    let (low, high) = (0.5 * low, 2.0 * high.max(10.0 * low));
    let (chart_area, legend_area) = area.split_horizontally(SIZE.0 - LEGEND);
    let mut chart =
        builder(&chart_area).build_cartesian_2d(time.clone(), (low..high).log_scale())?;
    let form: Option<&dyn Fn(&f64) -> String> = Some(&|y| format!("{y:.0e}"));
    finish(&mut chart, lines, label, Numbers { most: 8, form })?;
    legend(&legend_area, lines)
}

/// The numbers of the vertical axis: how many at most, and how they are written.
struct Numbers<'a> {
    most: usize,
    form: Option<&'a dyn Fn(&f64) -> String>,
}

/// Draws axes and lines.
fn finish<Y>(
    chart: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<RangedCoordf64, Y>>,
    lines: &[Line],
    label: &str,
    numbers: Numbers<'_>,
) -> Drawn
where
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut mesh = chart.configure_mesh();
    mesh.x_desc("time [s]")
        .y_desc(label)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .y_labels(numbers.most);
    if let Some(form) = numbers.form {
        mesh.y_label_formatter(form);
    }
    mesh.draw()?;
    for line in lines {
        chart.draw_series(LineSeries::new(
            line.points.iter().copied(),
            line.colour.stroke_width(2),
        ))?;
    }
    Ok(())
}

fn builder<'a, 'b>(area: &'a Area<'b>) -> ChartBuilder<'a, 'b, SVGBackend<'b>> {
    let mut builder = ChartBuilder::on(area);
    builder.margin(8).x_label_area_size(40).y_label_area_size(72);
    builder
}

fn legend(area: &Area<'_>, lines: &[Line]) -> Drawn {
    /// Height of a line of the legend where there is room, and of all of it [px].
    const HEIGHT: (usize, usize) = (20, 250);
    /// Most characters of a name.
    const NAME: usize = 22;
    let height = HEIGHT.0.min(HEIGHT.1 / lines.len().max(1)).max(4);
    let size = i32::try_from(height.min(14)).unwrap_or(14);
    for (line, y) in lines.iter().zip((20..).step_by(height)) {
        let mut name: String = line.name.chars().take(NAME).collect();
        if name.len() < line.name.len() {
            name.push('…');
        }
        area.draw(&PathElement::new([(4, y), (26, y)], line.colour.stroke_width(3)))?;
        area.draw(&Text::new(name, (34, y - size / 2), (FONT, size)))?;
    }
    Ok(())
}

/// Smallest and largest value of all lines.
fn extent(lines: &[Line]) -> (f64, f64) {
    let values = || lines.iter().flat_map(|line| line.points.iter().map(|p| p.1));
    let (low, high) =
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 1.0) }
}
