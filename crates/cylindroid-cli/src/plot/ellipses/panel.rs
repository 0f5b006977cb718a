//! One plane of the figure: the mechanism with the shapes at its reference point, or the shapes
//! alone in axes of velocity and force.

use std::f64::consts::TAU;

use cylindroid::Vec3;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::super::fine::{Fine, px};
use super::super::skeleton::Skeleton;
use super::super::{COLOURS, Drawn, FONT, TICK};
use super::chart::{Chart, Point, closed};
use super::mechanism::{mechanism, names};
use super::shapes::{Block, PlaneShapes, Region, Scales, Shape};
use crate::output::number;

/// What a panel shows.
pub(super) struct Panel<'a> {
    pub(super) block: &'a Block<'a>,
    pub(super) plane: &'a PlaneShapes,
    pub(super) skeleton: &'a Skeleton,
    pub(super) reference: Vec3,
    pub(super) scales: Scales,
    /// [px]
    pub(super) size: (u32, u32),
    /// Units of the axes to a pixel.
    pub(super) metre: [f64; 2],
}

type Range = std::ops::Range<f64>;

const MARGIN: u32 = 10;
const LABELS: (u32, u32) = (50, 38);
/// Points of an ellipse.
const POINTS: u32 = 360;
/// Most joints whose names are written.
const NAMED: usize = 10;

pub(super) fn panel(area: &DrawingArea<Fine<'_>, Shift>, shown: &Panel<'_>) -> Drawn {
    let centre = shown.centre();
    let (x, y) = shown.ranges();
    let mut chart = ChartBuilder::on(area)
        .margin(px(MARGIN))
        .x_label_area_size(px(LABELS.1))
        .y_label_area_size(px(LABELS.0))
        .build_cartesian_2d(x.clone(), y.clone())?;
    let wide = shown.size.0 > 400;
    let label =
        |v: &f64, of: &Range| number(if v.abs() < 1e-9 * (of.end - of.start) { 0.0 } else { *v });
    let [x_name, y_name] = shown.axis_names();
    chart
        .configure_mesh()
        .x_desc(x_name)
        .y_desc(y_name)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.08))
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .set_all_tick_mark_size(TICK)
        .x_labels(if wide { 7 } else { 5 })
        .y_labels(if wide { 7 } else { 5 })
        .x_label_formatter(&|v| label(v, &x))
        .y_label_formatter(&|v| label(v, &y))
        .draw()?;

    let colour = shown.block.colour;
    let inside = (&x, &y);
    if let Some(region) = shown.block.region(shown.plane) {
        let corners = shown.stretched(region, inside);
        if corners.len() > 2 {
            chart.draw_series([Polygon::new(corners.clone(), colour.mix(0.13).filled())])?;
        }
        chart.draw_series([closed(&corners, colour.mix(0.6).stroke_width(1))])?;
    }
    let shape = shown.block.shape(shown.plane);
    let resisted = shown.block.resisted(shown.plane);
    let other = if shown.block.force { COLOURS[2] } else { COLOURS[3] };
    let strips = resisted.unwrap_or(shape);
    if let [d] = strips.endless[..] {
        strip(&mut chart, shown, (strips, d), inside, other)?;
    } else if strips.endless.len() > 1 {
        let all = [(x.start, y.start), (x.end, y.start), (x.end, y.end), (x.start, y.end)];
        chart.draw_series([Polygon::new(all.to_vec(), other.mix(0.1).filled())])?;
    }
    if shown.in_world() {
        mechanism(&mut chart, shown.skeleton, |p| shown.flat(p))?;
    }
    let rim = shown.outline(shape);
    if rim.len() > 1 {
        chart.draw_series([closed(&rim, colour.stroke_width(3))])?;
    }
    if let Some(resisted) = resisted.filter(|r| r.endless.is_empty()) {
        // Beside the solid line where both coincide: thin dashes on it.
        dashed(&mut chart, &shown.outline(resisted), shown.metre, other)?;
    }
    chart.draw_series([Circle::new(centre, 4, colour.filled())])?;
    chart.draw_series([Circle::new(centre, 4, WHITE.stroke_width(1))])?;
    if shown.in_world() && wide && shown.skeleton.spots.len() <= NAMED {
        let mut rims = vec![rim];
        rims.extend(shown.block.region(shown.plane).map(|r| shown.stretched(r, inside)));
        names(&mut chart, shown.skeleton, |p| shown.flat(p), &rims)?;
    }
    Ok(())
}

impl Panel<'_> {
    fn in_world(&self) -> bool {
        self.block.drawing.in_world()
    }

    fn axis_names(&self) -> [String; 2] {
        self.plane.components.map(|c| {
            let name = &self.block.drawing.components[c];
            match (self.in_world(), self.block.unit(c)) {
                (true, _) => format!("{name} [m]"),
                (false, "") => name.clone(),
                (false, unit) => format!("{name} [{unit}]"),
            }
        })
    }

    /// A point of the world in the plane.
    pub(super) fn flat(&self, p: Vec3) -> Point {
        let axis = |c: usize| self.block.drawing.world_axis(c).map_or(0.0, |i| p.to_array()[i]);
        let [i, j] = self.plane.components;
        (axis(i), axis(j))
    }

    fn centre(&self) -> Point {
        if self.in_world() { self.flat(self.reference) } else { (0.0, 0.0) }
    }

    fn place(&self, v: [f64; 2], scale: Option<f64>) -> Point {
        let (centre, scale) = (self.centre(), scale.unwrap_or(f64::INFINITY));
        (centre.0 + v[0] / scale, centre.1 + v[1] / scale)
    }

    /// The rim of an ellipse, the two ends of a line, or nothing.
    fn outline(&self, shape: &Shape) -> Vec<Point> {
        let place = |v| self.place(v, self.scales.ellipse);
        match shape.axes.as_slice() {
            [] => Vec::new(),
            [a] => vec![place(*a), place([-a[0], -a[1]])],
            [a, b, ..] => (0..POINTS)
                .map(|k| {
                    let (s, c) = (TAU * f64::from(k) / f64::from(POINTS)).sin_cos();
                    place([a[0] * c + b[0] * s, a[1] * c + b[1] * s])
                })
                .collect(),
        }
    }

    fn polygon(&self, region: &Region) -> Vec<Point> {
        region.corners.iter().map(|c| self.place(*c, self.scales.polygon)).collect()
    }

    /// The polygon, continued to the rim of the panel where it has no end.
    fn stretched(&self, region: &Region, (x, y): (&Range, &Range)) -> Vec<Point> {
        let mut corners = self.polygon(region);
        let [d] = region.endless[..] else { return corners };
        let far = 2.0 * ((x.end - x.start) + (y.end - y.start));
        let across = |p: &Point| d[0] * p.1 - d[1] * p.0;
        corners.sort_by(|a, b| across(a).total_cmp(&across(b)));
        let (Some(a), Some(b)) = (corners.first(), corners.last()) else { return corners };
        let at = |p: &Point, t: f64| (p.0 + t * d[0], p.1 + t * d[1]);
        clipped(vec![at(a, -far), at(b, -far), at(b, far), at(a, far)], x, y)
    }

    /// From the smallest to the largest of both coordinates of all that is drawn.
    fn extent(&self) -> [(f64, f64); 2] {
        let mut points = vec![self.centre()];
        if self.in_world() {
            points.extend(self.skeleton.points().map(|p| self.flat(p)));
        }
        points.extend(self.outline(self.block.shape(self.plane)));
        if let Some(resisted) = self.block.resisted(self.plane) {
            points.extend(self.outline(resisted));
        }
        if let Some(region) = self.block.region(self.plane) {
            points.extend(self.polygon(region));
        }
        points.into_iter().fold([(f64::INFINITY, f64::NEG_INFINITY); 2], |[x, y], p| {
            [(x.0.min(p.0), x.1.max(p.0)), (y.0.min(p.1), y.1.max(p.1))]
        })
    }

    fn pixels(&self) -> (f64, f64) {
        let all = |all: u32, labels: u32| f64::from(all.saturating_sub(labels + 2 * MARGIN).max(1));
        (all(self.size.0, LABELS.0), all(self.size.1, LABELS.1))
    }

    /// Units to a pixel at least, with room for symbols and names around; the same on both axes
    /// where they have one unit.
    pub(super) fn needs(&self) -> [f64; 2] {
        let (w, h) = self.pixels();
        let room = 1.0 - 56.0 / w.min(h);
        let [x, y] = self.extent();
        let own = [(x.1 - x.0) / (w * room), (y.1 - y.0) / (h * room)];
        let most = own[0].max(own[1]).max(1e-9);
        let [i, j] = self.plane.components.map(|c| self.block.unit(c));
        if self.in_world() || i == j {
            return [most; 2];
        }
        own.map(|n| if n > 0.0 { n } else { most })
    }

    fn ranges(&self) -> (Range, Range) {
        let (w, h) = self.pixels();
        let [x, y] = self.extent();
        let range = |(low, high): (f64, f64), half: f64| {
            let middle = 0.5 * (low + high);
            middle - half..middle + half
        };
        (range(x, 0.5 * w * self.metre[0]), range(y, 0.5 * h * self.metre[1]))
    }
}

/// The part of a convex polygon within the panel.
fn clipped(mut points: Vec<Point>, x: &Range, y: &Range) -> Vec<Point> {
    // How far inside each side a point is.
    let sides: [&dyn Fn(&Point) -> f64; 4] =
        [&|p| p.0 - x.start, &|p| x.end - p.0, &|p| p.1 - y.start, &|p| y.end - p.1];
    for depth in sides {
        let mut kept = Vec::new();
        for i in 0..points.len() {
            let (p, q) = (points[i], points[(i + 1) % points.len()]);
            let (a, b) = (depth(&p), depth(&q));
            if a >= 0.0 {
                kept.push(p);
            }
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                kept.push((p.0 + t * (q.0 - p.0), p.1 + t * (q.1 - p.1)));
            }
        }
        points = kept;
    }
    points
}

/// Dashes of equal length along a closed rim.
fn dashed(chart: &mut Chart<'_, '_>, rim: &[Point], metre: [f64; 2], colour: RGBColor) -> Drawn {
    const DASH: f64 = 9.0;
    /// Steps between two points of a rim, which may be a line.
    const STEPS: u32 = 48;
    let steps = if rim.len() > 2 { 1 } else { STEPS };
    let mut points = Vec::new();
    for pair in rim.windows(2) {
        for k in 0..steps {
            let t = f64::from(k) / f64::from(steps);
            let along = |a: f64, b: f64| a + t * (b - a);
            points.push((along(pair[0].0, pair[1].0), along(pair[0].1, pair[1].1)));
        }
    }
    points.extend(rim.last());
    if rim.len() > 2 {
        points.extend(rim.first());
    }
    let (mut length, mut dash, mut dashes) = (0.0, Vec::<Point>::new(), Vec::new());
    for pair in points.windows(2) {
        let step = ((pair[1].0 - pair[0].0) / metre[0]).hypot((pair[1].1 - pair[0].1) / metre[1]);
        length += step;
        if (length / DASH) % 2.0 < 1.0 {
            if dash.is_empty() {
                dash.push(pair[0]);
            }
            dash.push(pair[1]);
        } else if !dash.is_empty() {
            dashes.push(std::mem::take(&mut dash));
        }
    }
    dashes.push(dash);
    for dash in dashes.into_iter().filter(|d| d.len() > 1) {
        chart.draw_series([PathElement::new(dash, colour.stroke_width(2))])?;
    }
    Ok(())
}

/// What has no end along `d`: a filled strip between two lines, or one line where nothing extends
/// across.
fn strip(
    chart: &mut Chart<'_, '_>,
    shown: &Panel<'_>,
    (shape, d): (&Shape, [f64; 2]),
    (x, y): (&Range, &Range),
    colour: RGBColor,
) -> Drawn {
    let far = 2.0 * ((x.end - x.start) + (y.end - y.start));
    let across = shape.axes.first().map_or([0.0, 0.0], |a| {
        let along = a[0] * d[0] + a[1] * d[1];
        [a[0] - along * d[0], a[1] - along * d[1]]
    });
    let at = |sign: f64, t: f64| {
        let side = shown.place(across.map(|a| sign * a), shown.scales.ellipse);
        (side.0 + t * d[0], side.1 + t * d[1])
    };
    let band = clipped(vec![at(1.0, -far), at(1.0, far), at(-1.0, far), at(-1.0, -far)], x, y);
    if band.len() > 2 && shape.axes.len() == 1 {
        chart.draw_series([Polygon::new(band, colour.mix(0.15).filled())])?;
    }
    for sign in if shape.axes.is_empty() { vec![1.0] } else { vec![1.0, -1.0] } {
        // A thin polygon, so that the ends are cut at the rim.
        let line = clipped(vec![at(sign, -far), at(sign, far)], x, y);
        let width = if shape.axes.is_empty() { 4 } else { 2 };
        if line.len() > 1 {
            chart.draw_series([closed(&line, colour.stroke_width(width))])?;
        }
    }
    Ok(())
}
