//! Columns of numbers as histograms.

use plotters::prelude::*;

use super::super::fine::{Fine, px};
use super::super::{Area, COLOURS, Drawn, axes, titled};
use super::plan::Name;
use super::shade::{finite_range, is_logarithmic};
use crate::output::number;

/// Bins at most.
const BINS: usize = 60;
/// Width of a panel, also of a single one, and height [px].
const WIDE: [u32; 2] = [330, 560];
const HIGH: u32 = 260;
/// Margins of a panel: left, right, top, bottom [px].
const MARGINS: [u32; 4] = [64, 16, 8, 46];

pub(super) fn draw(svg: &mut String, title: &str, names: &[Name], data: &[&[f64]]) -> Drawn {
    let count = names.len();
    let across = if count == 4 { 2 } else { count.clamp(1, 3) };
    let down = count.div_ceil(across);
    let width = if count == 1 { WIDE[1] } else { WIDE[0] };
    let (columns, lines) = (u32::try_from(across)?, u32::try_from(down)?);
    let root = Fine::new(svg, (px(width * columns), px(HIGH * lines + 34))).into_drawing_area();
    root.fill(&WHITE)?;
    let root = titled(&root, title, 20)?;
    let areas = root.split_evenly((down, across));
    for ((name, numbers), area) in names.iter().zip(data).zip(&areas) {
        panel(area, name, numbers)?;
    }
    root.present()?;
    drop((areas, root));
    Ok(())
}

fn panel(area: &Area<'_>, name: &Name, numbers: &[f64]) -> Drawn {
    let finite = || numbers.iter().copied().filter(|x| x.is_finite());
    let range = finite_range(numbers);
    let is_logarithmic = range.is_some_and(is_logarithmic);
    let own = |x: f64| if is_logarithmic { x.log10() } else { x };
    let [low, high] = range.map_or([0.0, 1.0], |ends| ends.map(own));
    // Numbers that are all the same have one bin.
    let (low, high) = if high > low { (low, high) } else { (low - 0.5, high + 0.5) };
    let bins = ((finite().count() as f64).sqrt() as usize).clamp(1, BINS);
    let mut counts = vec![0_u64; bins];
    for x in finite() {
        let bin = ((own(x) - low) / (high - low) * bins as f64) as usize;
        counts[bin.min(bins - 1)] += 1;
    }
    let most = counts.iter().max().copied().unwrap_or(0).max(1) as f64;
    let mut chart = axes::panel(area, MARGINS, [low..high, 0.0..1.05 * most])?;
    let form = |x: &f64| match is_logarithmic {
        true => number(format!("{:.2e}", 10.0_f64.powf(*x)).parse().unwrap_or(0.0)),
        false => axes::plain(x),
    };
    axes::draw(&mut chart, [name.label(), "rows".to_owned()], [6, 5], &form)?;
    let edge = |i: usize| low + (high - low) * i as f64 / bins as f64;
    let bars = counts.iter().enumerate().filter(|(_, count)| **count > 0).map(|(i, count)| {
        Rectangle::new([(edge(i), 0.0), (edge(i + 1), *count as f64)], COLOURS[0].mix(0.8).filled())
    });
    chart.draw_series(bars)?;
    Ok(())
}
