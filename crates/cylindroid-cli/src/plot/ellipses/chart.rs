//! A chart in two components, and shapes in it.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::super::fine::Fine;
use super::super::labels::Pixel;

pub(super) type Chart<'a, 'b> =
    ChartContext<'a, Fine<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub(super) type Point = (f64, f64);

/// A point of the chart in the whole drawing [px].
pub(super) fn in_pixels(chart: &Chart<'_, '_>, p: Point) -> Pixel {
    let (x, y) = chart.backend_coord(&p);
    (f64::from(x) / 100.0, f64::from(y) / 100.0)
}

pub(super) fn closed(points: &[Point], style: ShapeStyle) -> PathElement<Point> {
    let rim: Vec<Point> = points.iter().chain(points.first()).copied().collect();
    PathElement::new(rim, style)
}
