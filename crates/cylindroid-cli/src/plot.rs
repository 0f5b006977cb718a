//! The motion of `move` as an SVG: joints, pose error and singular value ratio over time.

mod axes;
mod conics;
pub(crate) mod ellipses;
mod fine;
mod labels;
pub(crate) mod map;
pub(crate) mod screws;
mod skeleton;
pub(crate) mod sweep;
pub(crate) mod tasks;

use std::ops::Range;
use std::path::Path;

use cylindroid::{Error, Result};
use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use self::fine::{Fine, at, in_pixels, px};
use crate::output_file;
use crate::trajectory::{Row, Trajectory, cannot_write};

const SIZE: (u32, u32) = (px(960), px(900));
/// Width of the legend.
const LEGEND: u32 = px(190);
/// Maximum number of points of a line; more are not visible.
const POINTS: usize = 1200;
/// Smaller errors are drawn at this value [m, rad].
const SMALLEST_ERROR: f64 = 1e-9;
/// Length of a tick of an axis.
const TICK: u32 = px(5);
const FONT: &str = "sans-serif";
/// Dark enough on white, and distinguishable for most colour-blind readers.
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

type Area<'a> = DrawingArea<Fine<'a>, Shift>;
type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;

/// A line of a panel.
struct Line {
    name: String,
    colour: RGBColor,
    points: Vec<(f64, f64)>,
}

/// Rejects names that do not end in .svg.
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

/// Writes a drawing.
fn save(path: &Path, draw: impl FnOnce(&mut String) -> Drawn) -> Result<()> {
    let mut svg = String::new();
    draw(&mut svg).map_err(|error| cannot_write(path, &error))?;
    output_file::write(path, in_pixels(&svg)).map_err(|error| cannot_write(path, &error))
}

fn panels(trajectory: &Trajectory, svg: &mut String) -> Drawn {
    let root = Fine::new(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!("{}: motion of {}", trajectory.model, trajectory.frame);
    let root = titled(&root, &title, 20)?;
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

    // Components left free have no error.
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

/// Writes a centred title of this font size [px]; returns the area below it.
fn titled<'a>(
    area: &Area<'a>,
    title: &str,
    size: u32,
) -> std::result::Result<Area<'a>, Box<dyn std::error::Error>> {
    let (top, rest) = area.split_vertically(px(size + 14));
    let middle = i32::try_from(top.dim_in_pixel().0 / 2)?;
    let style = (FONT, size).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
    top.draw(&Text::new(title, (middle, at(0, 6).1), style))?;
    Ok(rest)
}

/// At most about `POINTS` rows, the last among them.
fn thinned<R>(rows: &[R]) -> Vec<&R> {
    let stride = rows.len().div_ceil(POINTS).max(1);
    let mut kept: Vec<&R> = rows.iter().step_by(stride).collect();
    if !rows.len().saturating_sub(1).is_multiple_of(stride) {
        kept.extend(rows.last());
    }
    kept
}

fn linear_panel(area: &Area<'_>, lines: &[Line], time: &Range<f64>, label: &str) -> Drawn {
    let (low, high) = extent(lines);
    let margin = 0.06 * (high - low).max(1e-3);
    // The axis of a non-negative quantity starts at zero.
    let low = if low >= 0.0 { 0.0 } else { low - margin };
    let (chart_area, legend_area) = area.split_horizontally(SIZE.0 - LEGEND);
    let mut chart = builder(&chart_area).build_cartesian_2d(time.clone(), low..high + margin)?;
    finish(&mut chart, lines, label, Numbers { most: 6, form: None })?;
    legend(&legend_area, lines)
}

fn log_panel(area: &Area<'_>, lines: &[Line], time: &Range<f64>, label: &str) -> Drawn {
    let (low, high) = extent(lines);
    // Without values the extent is 0 to 1.
    let low = low.max(SMALLEST_ERROR);
    let (low, high) = (0.5 * low, 2.0 * high.max(10.0 * low));
    let (chart_area, legend_area) = area.split_horizontally(SIZE.0 - LEGEND);
    let mut chart =
        builder(&chart_area).build_cartesian_2d(time.clone(), (low..high).log_scale())?;
    let form: Option<&dyn Fn(&f64) -> String> = Some(&|y| format!("{y:.0e}"));
    finish(&mut chart, lines, label, Numbers { most: 8, form })?;
    legend(&legend_area, lines)
}

/// Tick labels of the vertical axis: maximum count and format.
struct Numbers<'a> {
    most: usize,
    form: Option<&'a dyn Fn(&f64) -> String>,
}

/// Draws axes and lines.
fn finish<Y>(
    chart: &mut ChartContext<'_, Fine<'_>, Cartesian2d<RangedCoordf64, Y>>,
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
        .set_all_tick_mark_size(TICK)
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

fn builder<'a, 'b>(area: &'a Area<'b>) -> ChartBuilder<'a, 'b, Fine<'b>> {
    let mut builder = ChartBuilder::on(area);
    builder.margin(px(8)).x_label_area_size(px(40)).y_label_area_size(px(72));
    builder
}

fn legend(area: &Area<'_>, lines: &[Line]) -> Drawn {
    /// Preferred height of an entry, and height of the whole legend [px].
    const HEIGHT: (usize, usize) = (20, 250);
    /// Maximum number of characters of a name.
    const NAME: usize = 22;
    let height = HEIGHT.0.min(HEIGHT.1 / lines.len().max(1)).max(4);
    let size = i32::try_from(height.min(14)).unwrap_or(14);
    for (line, y) in lines.iter().zip((20..).step_by(height)) {
        let mut name: String = line.name.chars().take(NAME).collect();
        if name.len() < line.name.len() {
            name.push('…');
        }
        let line_ends = [at(4, y), at(26, y)];
        area.draw(&PathElement::new(line_ends, line.colour.stroke_width(3)))?;
        area.draw(&Text::new(name, at(34, y - size / 2), (FONT, size)))?;
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

/// From blue over grey to orange.
fn blend(share: f64) -> RGBColor {
    let stops = [(31.0, 119.0, 180.0), (150.0, 150.0, 150.0), (214.0, 95.0, 0.0)];
    let (i, t) = if share < 0.5 { (0, 2.0 * share) } else { (1, 2.0 * share - 1.0) };
    let (a, b) = (stops[i], stops[i + 1]);
    let mix = |x: f64, y: f64| (x + t * (y - x)).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}
