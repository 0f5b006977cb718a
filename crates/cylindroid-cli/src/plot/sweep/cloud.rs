//! Positions as points, seen along the axes of the world.

use plotters::prelude::*;

use super::super::fine::{Fine, px};
use super::super::{Area, COLOURS, Drawn, axes, titled};
use super::plan::{BAR, Name};
use super::shade::{Shade, finite_range};

/// Points at most.
const POINTS: usize = 4000;
/// Up to so many are larger.
const FEW: usize = 1500;
/// Width of a panel [px], also of a single one.
const WIDE: [u32; 2] = [360, 560];
/// Margins of a panel: left, right, top, bottom [px].
const MARGINS: [u32; 4] = [64, 14, 8, 46];

pub(super) fn draw(
    svg: &mut String,
    title: &str,
    (pairs, data): (&[[usize; 2]], &[&[f64]]),
    color: Option<(&Shade, &[f64])>,
) -> Drawn {
    let [left, right, top, bottom] = MARGINS;
    let width = if pairs.len() == 1 { WIDE[1] } else { WIDE[0] };
    let wide = width - left - right;
    let ranges: Vec<[f64; 2]> =
        data.iter().map(|column| finite_range(column).unwrap_or([0.0, 1.0])).collect();
    // One scale for all, so that an axis is as long in each panel.
    let largest = ranges.iter().map(|[a, b]| b - a).fold(0.0, f64::max);
    let high = wide + top + bottom;
    let count = u32::try_from(pairs.len())?;
    let bar = if color.is_some() { BAR } else { 0 };
    let size = (px(width * count + bar), px(high + 34));
    let root = Fine::new(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let root = titled(&root, title, 20)?;
    let (all, bar_area) = root.split_horizontally(px(width * count));
    let rows = data.first().map_or(0, |column| column.len());
    let stride = if rows > POINTS { rows / POINTS } else { 1 };
    let mut shown: Vec<usize> = (0..rows).step_by(stride).take(POINTS).collect();
    if let Some((_, numbers)) = color {
        shown.retain(|&row| numbers.get(row).is_some_and(|x| x.is_finite()));
        // Large values lie on top.
        shown.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
    }
    let radius = if shown.len() > FEW { 1 } else { 2 };
    for (pair, area) in pairs.iter().zip(all.split_evenly((1, pairs.len()))) {
        let names =
            pair.map(|place| Name { name: ["x", "y", "z"][place].into(), unit: "m".into() });
        let spans = pair.map(|place| {
            let [a, b] = ranges[place];
            let middle = 0.5 * (a + b);
            let half = 0.53 * if largest > 0.0 { largest } else { 1.0 };
            middle - half..middle + half
        });
        let points = shown.iter().map(|&row| {
            let colour = match color {
                Some((shade, numbers)) => shade.colour(numbers[row]).unwrap_or(COLOURS[0]),
                None => COLOURS[0],
            };
            ((data[pair[0]][row], data[pair[1]][row]), colour)
        });
        panel(&area, &names, spans, (points, radius))?;
    }
    if let Some((shade, _)) = color {
        shade.bar(&bar_area, high)?;
    }
    all.present()?;
    drop((all, bar_area, root));
    Ok(())
}

fn panel(
    area: &Area<'_>,
    names: &[Name; 2],
    ranges: [std::ops::Range<f64>; 2],
    (points, radius): (impl Iterator<Item = ((f64, f64), RGBColor)>, u32),
) -> Drawn {
    let mut chart = axes::panel(area, MARGINS, ranges)?;
    axes::draw(&mut chart, names.each_ref().map(Name::label), [6, 6], &axes::plain)?;
    chart.draw_series(points.map(|(at, colour)| Circle::new(at, radius, colour.filled())))?;
    Ok(())
}
