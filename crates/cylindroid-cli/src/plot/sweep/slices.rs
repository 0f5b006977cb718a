//! Slices of a grid: a panel for each value of a third axis, and the line on which a value is zero.

use plotters::prelude::*;

use super::super::fine::{Fine, px};
use super::super::{Area, Drawn, axes, titled};
use super::plan::{BAR, PANELS, SliceAxis};
use super::shade::Shade;

/// Width of a panel, also of a single one, and height of its title [px].
const WIDE: [u32; 2] = [320, 560];
const TITLE: u32 = 28;
/// Margins of a panel: left, right, top, bottom [px].
const MARGINS: [u32; 4] = [64, 14, 8, 46];
/// Least and largest height of the axes [px].
const HIGH: [f64; 2] = [60.0, 900.0];

/// The numbers of a panel, by the places of both axes, the first slowest.
struct Panel<'a> {
    x: &'a SliceAxis,
    y: &'a SliceAxis,
    numbers: Vec<f64>,
}

pub(super) fn draw(
    svg: &mut String,
    title: &str,
    (axes, data): (&[SliceAxis], &[&[f64]]),
    (shade, numbers): (&Shade, &[f64]),
) -> Drawn {
    let [x, y, ..] = axes else { return Ok(()) };
    let panels = panels(axes, data, numbers);
    let count = panels.len();
    let across = if count == 4 { 2 } else { count.min(3) };
    let down = count.div_ceil(across);
    let [left, right, top, bottom] = MARGINS;
    let width = if count == 1 { WIDE[1] } else { WIDE[0] };
    let wide = width - left - right;
    // Lengths have one scale.
    let high = if x.name.unit == "m" && y.name.unit == "m" {
        let ratio = extent(y) / extent(x);
        (f64::from(wide) * ratio).max(HIGH[0]).min(HIGH[1]).round() as u32
    } else {
        wide
    };
    let panel = high + top + bottom + TITLE;
    let (columns, lines) = (u32::try_from(across)?, u32::try_from(down)?);
    let least = 220;
    let size = (px(width * columns + BAR), px((panel * lines).max(least) + 34));
    let root = Fine::new(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let root = titled(&root, title, 20)?;
    let (all, bar) = root.split_horizontally(px(width * columns));
    let (all, _) = all.split_vertically(px(panel * lines));
    for ((name, own), area) in panels.iter().zip(all.split_evenly((down, across))) {
        slice(own, name, shade, &area)?;
    }
    shade.bar(&bar, panel.min(420).max(least))?;
    all.present()?;
    drop((all, bar, root));
    Ok(())
}

/// Distance of the outer edges of the cells.
fn extent(axis: &SliceAxis) -> f64 {
    let axis = &axis.axis;
    (axis.to - axis.from).abs() * axis.count as f64 / (axis.count - 1) as f64
}

/// The place of a value on an axis.
fn place(axis: &SliceAxis, value: f64) -> Option<usize> {
    let axis = &axis.axis;
    let steps = (axis.count - 1) as f64;
    let place = ((value - axis.from) / (axis.to - axis.from) * steps).round();
    (0.0..=steps).contains(&place).then_some(place as usize)
}

/// The panels with their titles: those of the third axis, at most [`PANELS`] of them.
fn panels<'a>(axes: &'a [SliceAxis], data: &[&[f64]], numbers: &[f64]) -> Vec<(String, Panel<'a>)> {
    let count = |axis: &SliceAxis| usize::try_from(axis.axis.count).unwrap_or(0);
    let (x, y) = (&axes[0], &axes[1]);
    let of_panels = axes.get(2).map_or(1, count);
    let mut all = vec![vec![f64::NAN; count(x) * count(y)]; of_panels];
    for (row, number) in numbers.iter().enumerate() {
        let at = |axis: usize| place(axes.get(axis)?, *data.get(axis)?.get(row)?);
        let panel = if axes.len() > 2 { at(2) } else { Some(0) };
        if let (Some(i), Some(j), Some(panel)) = (at(0), at(1), panel) {
            all[panel][i * count(y) + j] = *number;
        }
    }
    let shown = of_panels.min(PANELS);
    let chosen = |i: usize| if shown > 1 { i * (of_panels - 1) / (shown - 1) } else { 0 };
    let panel = |i: usize| {
        let name = axes.get(2).map_or_else(String::new, |axis| {
            let value = axes::plain(&axis.axis.value(chosen(i) as u64));
            match axis.name.unit.as_str() {
                "" | "1" => format!("{} = {value}", axis.name.name),
                unit => format!("{} = {value} {unit}", axis.name.name),
            }
        });
        (name, Panel { x, y, numbers: std::mem::take(&mut all[chosen(i)]) })
    };
    (0..shown).map(panel).collect()
}

fn slice(panel: &Panel<'_>, name: &str, shade: &Shade, area: &Area<'_>) -> Drawn {
    let area = titled(area, name, 14)?;
    let (x, y) = (&panel.x.axis, &panel.y.axis);
    let half = |axis: &SliceAxis| 0.5 * extent(axis) / axis.axis.count as f64;
    let (dx, dy) = (half(panel.x), half(panel.y));
    let range = |from: f64, to: f64, by: f64| from.min(to) - by..from.max(to) + by;
    let ranges = [range(x.from, x.to, dx), range(y.from, y.to, dy)];
    let mut chart = axes::panel(&area, MARGINS, ranges)?;
    let rows = usize::try_from(y.count)?;
    for (i, column) in panel.numbers.chunks(rows).enumerate() {
        let center = x.value(i as u64);
        let mut first = 0;
        // Cells of a column with one colour are one rectangle.
        for run in column.chunk_by(|a, b| shade.level(*a) == shade.level(*b)) {
            let last = first + run.len() - 1;
            if let Some(colour) = shade.colour(run[0]) {
                let ends = [y.value(first as u64), y.value(last as u64)];
                // A little over the next cells, which are drawn later: no seams.
                let corners = [
                    (center - dx, ends[0].min(ends[1]) - dy),
                    (center + 1.1 * dx, ends[0].max(ends[1]) + 1.1 * dy),
                ];
                chart.draw_series([Rectangle::new(corners, colour.filled())])?;
            }
            first = last + 1;
        }
    }
    axes::draw(&mut chart, [panel.x, panel.y].map(|axis| axis.name.label()), [5, 6], &axes::plain)?;
    for ends in zero_line(panel) {
        chart.draw_series(LineSeries::new(ends, BLACK.stroke_width(1)))?;
    }
    Ok(())
}

/// Where the numbers, linear between the points of the grid, are zero: a segment for each square in
/// which they change their sign.
fn zero_line(panel: &Panel<'_>) -> Vec<[(f64, f64); 2]> {
    let rows = panel.y.axis.count as usize;
    let columns = panel.numbers.len() / rows.max(1);
    let point = |i: usize, j: usize| {
        let at = (panel.x.axis.value(i as u64), panel.y.axis.value(j as u64));
        (at, panel.numbers[i * rows + j])
    };
    let mut segments = Vec::new();
    for i in 1..columns {
        for j in 1..rows {
            let corners = [point(i - 1, j - 1), point(i, j - 1), point(i, j), point(i - 1, j)];
            if corners.iter().any(|corner| !corner.1.is_finite()) {
                continue;
            }
            let mut crossed = Vec::new();
            for k in 0..4 {
                let (((ax, ay), a), ((bx, by), b)) = (corners[k], corners[(k + 1) % 4]);
                if (a < 0.0) != (b < 0.0) {
                    let t = a / (a - b);
                    crossed.push((ax + t * (bx - ax), ay + t * (by - ay)));
                }
            }
            segments.extend(crossed.as_chunks::<2>().0.iter().copied());
        }
    }
    segments
}
