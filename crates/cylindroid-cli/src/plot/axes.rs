//! Panels of numbers: margins, grid and numbers of their axes.

use std::ops::Range;

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::fine::{Fine, px};
use super::{Area, Drawn, FONT, TICK};
use crate::output::{number, without_rounding};

pub(super) type Chart<'a, 'b> =
    ChartContext<'a, Fine<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A panel with these margins: left, right, top, bottom [px].
pub(super) fn panel<'a, 'b>(
    area: &'a Area<'b>,
    [left, right, top, bottom]: [u32; 4],
    [across, up]: [Range<f64>; 2],
) -> std::result::Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
    let mut builder = ChartBuilder::on(area);
    builder.margin_right(px(right)).margin_top(px(top));
    builder.x_label_area_size(px(bottom)).y_label_area_size(px(left));
    Ok(builder.build_cartesian_2d(across, up)?)
}

/// The numbers of an axis.
pub(super) fn plain(x: &f64) -> String {
    number(without_rounding(*x))
}

/// Draws the axes with their names and at most so many numbers, those of the horizontal one by
/// `form`.
pub(super) fn draw(
    chart: &mut Chart<'_, '_>,
    [across, up]: [String; 2],
    most: [usize; 2],
    form: &dyn Fn(&f64) -> String,
) -> Drawn {
    chart
        .configure_mesh()
        .x_desc(across)
        .y_desc(up)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .set_all_tick_mark_size(TICK)
        .x_labels(most[0])
        .y_labels(most[1])
        .x_label_formatter(&form)
        .y_label_formatter(&plain)
        .draw()?;
    Ok(())
}
