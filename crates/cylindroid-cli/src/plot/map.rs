//! A map over two axes: a panel for each working mode with its cells and its curves; over three axes
//! slices of the first modes, with the sections of their surfaces.

use std::path::Path;

use cylindroid::sweep::{Locus, LocusKind, Map};
use cylindroid::{Error, Result};
use plotters::prelude::*;

use super::fine::{Fine, at, px};
use super::{Area, COLOURS, Drawn, FONT, axes, save, titled};
use crate::output;

/// Most panels that are drawn.
const PANELS: usize = 12;
/// Most modes of which slices are drawn.
const SLICED: usize = 3;
/// Width of a panel and height of its title and of the legend [px].
const WIDE: u32 = 420;
const TITLE: u32 = 28;
const LEGEND: u32 = 40;
/// Margins of a panel: left, right, top, bottom [px].
const MARGINS: [u32; 4] = [64, 18, 8, 46];
/// The cells that a mode reaches, by the sign of their distance to type II.
const CELLS: [RGBColor; 2] = [RGBColor(222, 235, 247), RGBColor(253, 230, 206)];

/// Rejects numbers of axes that cannot be drawn.
pub(crate) fn check(axes: usize) -> Result<()> {
    if matches!(axes, 2 | 3) {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "--plot",
        value: format!("{axes} {}", if axes == 1 { "axis" } else { "axes" }),
        reason: "a map of two or three axes can be drawn; name --over twice or three times"
            .to_owned(),
    })
}

/// What a panel shows: a mode, and of three axes the place on the third one.
#[derive(Debug, Clone, Copy)]
struct Shown {
    mode: usize,
    slice: Option<u64>,
}

/// The panels, a row or some rows for each mode, and how many are beside each other. Of three axes they
/// are slices, spread over the third one, of the first modes.
fn arrangement(map: &Map) -> (Vec<Shown>, usize) {
    let Some(third) = map.axes.get(2) else {
        let count = map.modes.len().min(PANELS);
        let across = if count == 4 { 2 } else { count.clamp(1, 3) };
        return ((0..count).map(|mode| Shown { mode, slice: None }).collect(), across);
    };
    let modes = map.modes.len().clamp(1, SLICED);
    let slices = third.count.min((PANELS / modes) as u64).max(1);
    let place =
        |i: u64| if slices == 1 { third.count / 2 } else { i * (third.count - 1) / (slices - 1) };
    let of = |mode: usize| (0..slices).map(move |i| Shown { mode, slice: Some(place(i)) });
    let across = if slices > 5 { if modes == 1 { 4 } else { 3 } } else { slices as usize };
    ((0..modes.min(map.modes.len())).flat_map(of).collect(), across)
}

const fn colour(kind: LocusKind) -> RGBColor {
    match kind {
        LocusKind::TypeOne => COLOURS[0],
        LocusKind::TypeTwo => COLOURS[3],
        LocusKind::Passive => COLOURS[7],
        _ => COLOURS[2],
    }
}

/// Draws the map.
pub(crate) fn draw(map: &Map, title: &str, path: &Path) -> Result<()> {
    save(path, |svg| panels(map, title, svg))
}

fn panels(map: &Map, title: &str, svg: &mut String) -> Drawn {
    let (shown, across) = arrangement(map);
    let down = shown.len().div_ceil(across).max(1);
    let [left, right, top, bottom] = MARGINS;
    let [x, y] = [&map.axes[0], &map.axes[1]];
    let wide = WIDE - left - right;
    // Equal scales for equal units.
    let high = if Map::unit(&x.name) == Map::unit(&y.name) && x.to > x.from {
        let high = f64::from(wide) * (y.to - y.from) / (x.to - x.from);
        high.max(80.0).min(1200.0).round() as u32
    } else {
        wide
    };
    let tall = high + top + bottom + TITLE;
    let (columns, lines) = (u32::try_from(across)?, u32::try_from(down)?);
    let size = (px(WIDE * columns.max(2)), px(tall * lines + 34 + LEGEND));
    let root = Fine::new(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let root = titled(&root, title, 20)?;
    let (all, legend_area) = root.split_vertically(px(tall * lines));
    for (one, area) in shown.iter().zip(all.split_evenly((down, across))) {
        panel(map, *one, &area)?;
    }
    legend(map, &legend_area)?;
    all.present()?;
    drop((all, legend_area, root));
    Ok(())
}

fn panel(map: &Map, shown: Shown, area: &Area<'_>) -> Drawn {
    let mode = &map.modes[shown.mode];
    let number = shown.mode + 1;
    let title = match shown.slice {
        None => {
            let share = 100.0 * mode.cells() as f64 / map.cells() as f64;
            format!("mode {number}: {share:.1} % of the cells")
        }
        Some(place) => {
            let third = &map.axes[2];
            let value = output::number(third.value(place));
            format!("mode {number}: {} = {value} {}", third.name, Map::unit(&third.name))
        }
    };
    let area = titled(area, &title, 14)?;
    let [x, y] = [&map.axes[0], &map.axes[1]];
    // The cell in a column and a row.
    let (places, place) = match shown.slice {
        None => (1, 0),
        Some(place) => (usize::try_from(map.axes[2].count)?, usize::try_from(place)?),
    };
    let half = |axis: &cylindroid::sweep::Axis| match axis.count {
        0 | 1 => 0.5,
        count => 0.5 * (axis.to - axis.from) / (count - 1) as f64,
    };
    let (dx, dy) = (half(x), half(y));
    let range = |from: f64, to: f64, by: f64| if to > from { from..to } else { from - by..to + by };
    let ranges = [range(x.from, x.to, dx), range(y.from, y.to, dy)];
    let mut chart = axes::panel(&area, MARGINS, ranges)?;
    // Cells of a column with one colour are one rectangle.
    let rows = usize::try_from(y.count)?;
    for column in 0..usize::try_from(x.count)? {
        let cell = |row: usize| (column * rows + row) * places + place;
        let colour_of = |row: usize| {
            let cell = cell(row);
            let side = usize::from(mode.type_two[cell] < 0.0);
            mode.reached[cell].then_some(CELLS[side])
        };
        let mut from = 0;
        while from < rows {
            let mut to = from + 1;
            while to < rows && colour_of(to) == colour_of(from) {
                to += 1;
            }
            if let Some(colour) = colour_of(from) {
                let (a, b) = (map.values(cell(from)), map.values(cell(to - 1)));
                let clip = |v: f64, from: f64, to: f64| v.max(from).min(to);
                let corners = [
                    (clip(a[0] - dx, x.from, x.to), clip(a[1] - dy, y.from, y.to)),
                    (clip(b[0] + 1.1 * dx, x.from, x.to), clip(b[1] + dy, y.from, y.to)),
                ];
                chart.draw_series([Rectangle::new(corners, colour.filled())])?;
            }
            from = to;
        }
    }
    let names = [x, y].map(|axis| format!("{} [{}]", axis.name, Map::unit(&axis.name)));
    axes::draw(&mut chart, names, [6, 6], &axes::plain)?;
    let own = |locus: &&Locus| locus.modes.contains(&shown.mode);
    for locus in map.loci.iter().filter(own) {
        let points = locus.points.iter().map(|p| (p[0], p[1]));
        chart.draw_series(LineSeries::new(points, colour(locus.kind).stroke_width(2)))?;
    }
    if let Some(place) = shown.slice {
        for (kind, ends) in map.section(shown.mode, place)? {
            let ends = ends.map(|[x, y]| (x, y));
            chart.draw_series(LineSeries::new(ends, colour(kind).stroke_width(2)))?;
        }
    }
    Ok(())
}

/// The kinds that occur, and the colours of cells.
fn legend(map: &Map, area: &Area<'_>) -> Drawn {
    const WIDTH: i32 = 100;
    let mut x = 24;
    for kind in LocusKind::ALL {
        let curves = map.loci.iter().map(|locus| locus.kind);
        if curves.chain(map.surfaces.iter().map(|surface| surface.kind)).any(|own| own == kind) {
            let ends = [at(x, 20), at(x + 24, 20)];
            area.draw(&PathElement::new(ends, colour(kind).stroke_width(3)))?;
            area.draw(&Text::new(kind.name(), at(x + 30, 13), (FONT, 14)))?;
            x += WIDTH;
        }
    }
    let words = if map.signed[1] {
        ["reached, type II > 0", "reached, type II < 0"]
    } else {
        ["reached", ""]
    };
    for (colour, word) in CELLS.into_iter().zip(words).filter(|(_, word)| !word.is_empty()) {
        area.draw(&Rectangle::new([at(x, 12), at(x + 24, 28)], colour.filled()))?;
        area.draw(&Text::new(word, at(x + 30, 13), (FONT, 14)))?;
        x += 190;
    }
    Ok(())
}
