//! One plane of the figure: the mechanism, and shapes at its reference point.

use std::f64::consts::TAU;

use cylindroid::Vec3;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::fine::{Fine, at, px};
use super::super::skeleton::{Mark, Skeleton};
use super::super::{COLOURS, Drawn, FONT, TICK};
use super::shapes::{Block, Ellipse, Scales, View};
use crate::output::number;

/// What a panel shows.
pub(super) struct Panel<'a> {
    pub(super) block: &'a Block<'a>,
    pub(super) view: &'a View,
    pub(super) skeleton: &'a Skeleton,
    pub(super) reference: Vec3,
    pub(super) scales: Scales,
    /// [px]
    pub(super) size: (u32, u32),
    /// Metres to a pixel.
    pub(super) metre: f64,
}

type Chart<'a, 'b> = ChartContext<'a, Fine<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Point = (f64, f64);

const MARGIN: u32 = 10;
const LABELS: (u32, u32) = (50, 38);
/// Points of an ellipse.
const POINTS: u32 = 360;
const DARK: RGBColor = RGBColor(60, 60, 60);
const LINK: RGBColor = RGBColor(120, 120, 120);
/// Most joints whose names are written.
const NAMED: usize = 10;
const NAMES: [&str; 3] = ["x [m]", "y [m]", "z [m]"];

pub(super) fn panel(area: &DrawingArea<Fine<'_>, Shift>, shown: &Panel<'_>) -> Drawn {
    let [i, j] = shown.view.plane;
    let flat = |p: Vec3| shown.flat(p);
    let centre = flat(shown.reference);
    let (ellipse, polygon) = (shown.ellipse(), shown.polygon());
    let (x, y) = shown.ranges();

    let mut chart = ChartBuilder::on(area)
        .margin(px(MARGIN))
        .x_label_area_size(px(LABELS.1))
        .y_label_area_size(px(LABELS.0))
        .build_cartesian_2d(x.clone(), y.clone())?;
    let wide = shown.size.0 > 400;
    let width = x.end - x.start;
    let label = |v: &f64| number(if v.abs() < 1e-9 * width { 0.0 } else { *v });
    chart
        .configure_mesh()
        .x_desc(NAMES[i])
        .y_desc(NAMES[j])
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.08))
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .set_all_tick_mark_size(TICK)
        .x_labels(if wide { 7 } else { 5 })
        .y_labels(if wide { 7 } else { 5 })
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .draw()?;

    let colour = shown.block.colour;
    if let Some(corners) = &polygon {
        if corners.len() > 2 {
            chart.draw_series([Polygon::new(corners.clone(), colour.mix(0.13).filled())])?;
        }
        chart.draw_series([closed(corners, colour.mix(0.6).stroke_width(1))])?;
    }
    let other = if shown.block.force { COLOURS[2] } else { COLOURS[3] };
    for d in &shown.view.ellipse.endless {
        strip(&mut chart, shown, *d, (&x, &y), other)?;
    }
    mechanism(&mut chart, shown.skeleton, flat)?;
    if ellipse.len() > 1 {
        chart.draw_series([closed(&ellipse, colour.stroke_width(3))])?;
        if shown.block.force && shown.view.ellipse.endless.is_empty() {
            dashed(&mut chart, &ellipse, shown.metre, other)?;
        }
    }
    chart.draw_series([Circle::new(centre, 4, colour.filled())])?;
    chart.draw_series([Circle::new(centre, 4, WHITE.stroke_width(1))])?;
    if shown.skeleton.spots.len() <= NAMED && wide {
        names(&mut chart, shown)?;
    }
    Ok(())
}

impl Panel<'_> {
    fn flat(&self, p: Vec3) -> Point {
        let [i, j] = self.view.plane;
        (p.to_array()[i], p.to_array()[j])
    }

    fn place(&self, v: [f64; 2], scale: Option<f64>) -> Point {
        let (centre, scale) = (self.flat(self.reference), scale.unwrap_or(f64::INFINITY));
        (centre.0 + v[0] / scale, centre.1 + v[1] / scale)
    }

    fn ellipse(&self) -> Vec<Point> {
        outline(&self.view.ellipse, |v| self.place(v, self.scales.ellipse))
    }

    fn polygon(&self) -> Option<Vec<Point>> {
        let corners = self.view.polygon.as_ref()?;
        Some(corners.iter().map(|c| self.place(*c, self.scales.polygon)).collect())
    }

    /// From the smallest to the largest of both coordinates of all that is drawn.
    fn extent(&self) -> [(f64, f64); 2] {
        let points = self.skeleton.points().map(|p| self.flat(p));
        let centre = self.flat(self.reference);
        points
            .chain([centre])
            .chain(self.ellipse())
            .chain(self.polygon().unwrap_or_default())
            .fold([(f64::INFINITY, f64::NEG_INFINITY); 2], |[x, y], p| {
                [(x.0.min(p.0), x.1.max(p.0)), (y.0.min(p.1), y.1.max(p.1))]
            })
    }

    fn pixels(&self) -> (f64, f64) {
        let all = |all: u32, labels: u32| f64::from(all.saturating_sub(labels + 2 * MARGIN).max(1));
        (all(self.size.0, LABELS.0), all(self.size.1, LABELS.1))
    }

    /// Metres to a pixel at least, with room for symbols and names around.
    pub(super) fn needs(&self) -> f64 {
        let (w, h) = self.pixels();
        let room = 1.0 - 56.0 / w.min(h);
        let [x, y] = self.extent();
        ((x.1 - x.0) / (w * room)).max((y.1 - y.0) / (h * room)).max(1e-9)
    }

    /// Of both axes, a metre as long on one as on the other.
    fn ranges(&self) -> (std::ops::Range<f64>, std::ops::Range<f64>) {
        let (w, h) = self.pixels();
        let [x, y] = self.extent();
        let range = |(low, high): (f64, f64), pixels: f64| {
            let (middle, half) = (0.5 * (low + high), 0.5 * pixels * self.metre);
            middle - half..middle + half
        };
        (range(x, w), range(y, h))
    }

    /// How far what is drawn at the reference point reaches from it along `d` [px].
    fn reach(&self, d: Point) -> f64 {
        let centre = self.flat(self.reference);
        let along = |p: &Point| ((p.0 - centre.0) * d.0 + (p.1 - centre.1) * d.1) / self.metre;
        let rim = self.ellipse().into_iter().chain(self.polygon().unwrap_or_default());
        rim.map(|p| along(&p)).fold(0.0, f64::max)
    }
}

/// The rim of an ellipse, the two ends of a line, or nothing.
fn outline(ellipse: &Ellipse, place: impl Fn([f64; 2]) -> Point) -> Vec<Point> {
    match ellipse.axes.as_slice() {
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

fn closed(points: &[Point], style: ShapeStyle) -> PathElement<Point> {
    let rim: Vec<Point> = points.iter().chain(points.first()).copied().collect();
    PathElement::new(rim, style)
}

/// Dashes of equal length along a rim.
fn dashed(chart: &mut Chart<'_, '_>, rim: &[Point], metre: f64, colour: RGBColor) -> Drawn {
    const DASH: f64 = 12.0;
    let mut way = 0.0;
    let mut dash: Vec<Point> = Vec::new();
    let mut dashes: Vec<Vec<Point>> = Vec::new();
    for pair in rim.windows(2) {
        let length = (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1) / metre;
        way += length;
        if (way / DASH) % 2.0 < 1.0 {
            if dash.is_empty() {
                dash.push(pair[0]);
            }
            dash.push(pair[1]);
        } else if !dash.is_empty() {
            dashes.push(std::mem::take(&mut dash));
        }
    }
    dashes.push(dash);
    for dash in dashes {
        chart.draw_series([PathElement::new(dash, colour.stroke_width(3))])?;
    }
    Ok(())
}

/// What has no end along `d`: two dashed lines, or one where nothing extends across.
fn strip(
    chart: &mut Chart<'_, '_>,
    shown: &Panel<'_>,
    d: [f64; 2],
    (x, y): (&std::ops::Range<f64>, &std::ops::Range<f64>),
    colour: RGBColor,
) -> Drawn {
    let centre = shown.flat(shown.reference);
    let across = match shown.view.ellipse.axes.first() {
        None => [0.0, 0.0],
        Some(a) => {
            let along = a[0] * d[0] + a[1] * d[1];
            [(a[0] - along * d[0]), (a[1] - along * d[1])]
                .map(|v| v / shown.scales.ellipse.unwrap_or(f64::INFINITY))
        }
    };
    for sign in [1.0, -1.0] {
        let start = (centre.0 + sign * across[0], centre.1 + sign * across[1]);
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for (p, step, range) in [(start.0, d[0], x), (start.1, d[1], y)] {
            if step.abs() > 1e-12 {
                let ends = [(range.start - p) / step, (range.end - p) / step];
                from = from.max(ends[0].min(ends[1]));
                to = to.min(ends[0].max(ends[1]));
            }
        }
        const DASHES: u32 = 24;
        let at = |k: u32| {
            let t = from + (to - from) * f64::from(k) / f64::from(2 * DASHES);
            (start.0 + t * d[0], start.1 + t * d[1])
        };
        if from < to {
            for k in 0..DASHES {
                let dash = vec![at(2 * k), at(2 * k + 1)];
                chart.draw_series([PathElement::new(dash, colour.stroke_width(2))])?;
            }
        }
    }
    Ok(())
}

fn mechanism(
    chart: &mut Chart<'_, '_>,
    skeleton: &Skeleton,
    flat: impl Fn(Vec3) -> Point,
) -> Drawn {
    for link in &skeleton.links {
        let mut points: Vec<Point> = link.iter().map(|p| flat(*p)).collect();
        if points.len() > 2 {
            let n = points.len() as f64;
            let middle = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
            let angle = |p: &Point| (p.1 - middle.1).atan2(p.0 - middle.0);
            points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            chart.draw_series([Polygon::new(points.clone(), LINK.mix(0.18).filled())])?;
            chart.draw_series([closed(&points, LINK.stroke_width(2))])?;
        } else {
            chart.draw_series([PathElement::new(points, LINK.stroke_width(4))])?;
        }
    }
    for slide in &skeleton.slides {
        let line = slide.map(&flat).to_vec();
        chart.draw_series([PathElement::new(line, LINK.stroke_width(2))])?;
    }
    for base in &skeleton.bases {
        chart.draw_series([EmptyElement::at(flat(*base)) + ground()])?;
    }
    for spot in &skeleton.spots {
        let fill = if spot.actuated { DARK } else { WHITE };
        let here = flat(spot.point);
        match spot.mark {
            Mark::Turning => {
                chart.draw_series([Circle::new(here, 5, fill.filled())])?;
                chart.draw_series([Circle::new(here, 5, DARK.stroke_width(2))])?;
            }
            Mark::Sliding => {
                let square = [at(-5, -5), at(5, 5)];
                let inside = EmptyElement::at(here) + Rectangle::new(square, fill.filled());
                chart.draw_series([inside + Rectangle::new(square, DARK.stroke_width(2))])?;
            }
            Mark::Contact => {
                let diamond = vec![at(0, -6), at(6, 0), at(0, 6), at(-6, 0)];
                let inside = EmptyElement::at(here) + Polygon::new(diamond.clone(), fill.filled());
                let rim: Vec<(i32, i32)> = diamond.iter().chain(diamond.first()).copied().collect();
                chart.draw_series([inside + PathElement::new(rim, DARK.stroke_width(2))])?;
            }
        }
    }
    Ok(())
}

/// A triangle under a joint of the ground.
fn ground() -> Polygon<(i32, i32)> {
    Polygon::new(vec![at(0, 2), at(-9, 15), at(9, 15)], LINK.mix(0.8).filled())
}

/// Names next to the joints, away from the middle of the mechanism and from the shapes.
fn names(chart: &mut Chart<'_, '_>, shown: &Panel<'_>) -> Drawn {
    const AWAY: f64 = 17.0;
    let spots = &shown.skeleton.spots;
    let n = spots.len().max(1) as f64;
    let points: Vec<Point> = spots.iter().map(|s| shown.flat(s.point)).collect();
    let middle = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let centre = shown.flat(shown.reference);
    for (spot, point) in spots.iter().zip(&points) {
        let (mut x, mut y) = (point.0 - middle.0, point.1 - middle.1);
        let size = x.hypot(y);
        (x, y) = if size > shown.metre { (x / size, y / size) } else { (0.0, 1.0) };
        let mut away = AWAY;
        if (point.0 - centre.0).hypot(point.1 - centre.1) < 8.0 * shown.metre {
            // Where the shapes are narrow, rather outwards.
            let far = |d: Point| shown.reach(d) - 20.0 * (d.0 * x + d.1 * y);
            let around = (0..24).map(|k| (TAU * f64::from(k) / 24.0).sin_cos());
            let best = around.min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or((0.0, 1.0));
            (x, y) = best;
            away += shown.reach(best);
        } else if y < 0.0 && shown.skeleton.bases.contains(&spot.point) {
            // A ground symbol stands below.
            (x, y) = (x.signum(), 0.0);
        }
        let shift = at((x * away).round() as i32, (-y * away).round() as i32);
        let style = TextStyle::from((FONT, 13).into_font())
            .color(&DARK)
            .pos(Pos::new(HPos::Center, VPos::Center));
        let text = Text::new(spot.name.clone(), shift, style);
        chart.draw_series([EmptyElement::at(*point) + text])?;
    }
    Ok(())
}

/// What the symbols mean, below all panels.
pub(super) fn symbols(area: &DrawingArea<Fine<'_>, Shift>) -> Drawn {
    let y = 14;
    let text = |x: i32, words: &'static str| Text::new(words, at(x, y - 6), (FONT, 12));
    area.draw(&Circle::new(at(26, y), 5, DARK.filled()))?;
    area.draw(&text(38, "actuated joint"))?;
    area.draw(&Circle::new(at(146, y), 5, WHITE.filled()))?;
    area.draw(&Circle::new(at(146, y), 5, DARK.stroke_width(2)))?;
    area.draw(&text(158, "passive joint"))?;
    area.draw(&Rectangle::new([at(249, y - 5), at(259, y + 5)], DARK.stroke_width(2)))?;
    area.draw(&text(267, "prismatic joint"))?;
    let diamond = vec![at(366, y - 6), at(372, y), at(366, y + 6), at(360, y), at(366, y - 6)];
    area.draw(&PathElement::new(diamond, DARK.stroke_width(2)))?;
    area.draw(&text(380, "contact"))?;
    let triangle = vec![at(456, y - 6), at(447, y + 7), at(465, y + 7)];
    area.draw(&Polygon::new(triangle, LINK.mix(0.8).filled()))?;
    area.draw(&text(472, "ground"))?;
    Ok(())
}
