//! One plane of the figure: the mechanism, and shapes at its reference point.

use std::f64::consts::TAU;

use cylindroid::Vec3;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::skeleton::{Mark, Skeleton, Spot};
use super::super::{COLOURS, Drawn, FONT};
use super::{Block, Ellipse, Scales, View};

/// What a panel shows.
pub(super) struct Panel<'a> {
    pub(super) block: &'a Block<'a>,
    pub(super) view: &'a View,
    pub(super) skeleton: &'a Skeleton,
    pub(super) reference: Vec3,
    pub(super) scales: Scales,
    /// [px]
    pub(super) size: (u32, u32),
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Point = (f64, f64);

const MARGIN: u32 = 10;
const LABELS: (u32, u32) = (50, 38);
/// Points of an ellipse.
const POINTS: u32 = 180;
const DARK: RGBColor = RGBColor(60, 60, 60);
const LINK: RGBColor = RGBColor(120, 120, 120);
/// Most joints whose names are written.
const NAMED: usize = 10;
const NAMES: [&str; 3] = ["x [m]", "y [m]", "z [m]"];

pub(super) fn panel(area: &DrawingArea<SVGBackend<'_>, Shift>, shown: &Panel<'_>) -> Drawn {
    let [i, j] = shown.view.plane;
    let flat = |p: Vec3| -> Point { (p.to_array()[i], p.to_array()[j]) };
    let centre = flat(shown.reference);
    let place = |v: [f64; 2], scale: f64| (centre.0 + v[0] / scale, centre.1 + v[1] / scale);
    let ellipse = outline(&shown.view.ellipse, |v| place(v, shown.scales.ellipse));
    let polygon: Option<Vec<Point>> = shown
        .view
        .polygon
        .as_ref()
        .map(|corners| corners.iter().map(|c| place(*c, shown.scales.polygon)).collect());
    let seen = shown.skeleton.points().map(flat).chain([centre]).chain(ellipse.iter().copied());
    let seen: Vec<Point> = seen.chain(polygon.iter().flatten().copied()).collect();
    let (x, y) = ranges(&seen, shown.size);

    let mut chart = ChartBuilder::on(area)
        .margin(MARGIN)
        .x_label_area_size(LABELS.1)
        .y_label_area_size(LABELS.0)
        .build_cartesian_2d(x.clone(), y.clone())?;
    let wide = shown.size.0 > 400;
    let width = x.end - x.start;
    let label = |v: &f64| super::number(if v.abs() < 1e-9 * width { 0.0 } else { *v });
    chart
        .configure_mesh()
        .x_desc(NAMES[i])
        .y_desc(NAMES[j])
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.08))
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
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
            dashed(&mut chart, &ellipse, other)?;
        }
    }
    chart.draw_series([Circle::new(centre, 4, colour.filled())])?;
    chart.draw_series([Circle::new(centre, 4, WHITE.stroke_width(1))])?;
    if shown.skeleton.spots.len() <= NAMED && wide {
        names(&mut chart, &shown.skeleton.spots, flat, width / f64::from(shown.size.0))?;
    }
    Ok(())
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

/// Ranges of both axes around all points, a metre as long on one as on the other.
fn ranges(points: &[Point], size: (u32, u32)) -> (std::ops::Range<f64>, std::ops::Range<f64>) {
    let side = |of: fn(&Point) -> f64| {
        points
            .iter()
            .map(of)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    let (x, y) = (side(|p| p.0), side(|p| p.1));
    let pixels = |all: u32, labels: u32| f64::from(all.saturating_sub(labels + 2 * MARGIN).max(1));
    let (w, h) = (pixels(size.0, LABELS.0), pixels(size.1, LABELS.1));
    // Room for symbols and names around.
    let room = 1.0 - 56.0 / w.min(h);
    let metre = ((x.1 - x.0) / (w * room)).max((y.1 - y.0) / (h * room)).max(1e-9);
    let range = |(low, high): (f64, f64), pixels: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * pixels * metre);
        middle - half..middle + half
    };
    (range(x, w), range(y, h))
}

fn closed(points: &[Point], style: ShapeStyle) -> PathElement<Point> {
    let rim: Vec<Point> = points.iter().chain(points.first()).copied().collect();
    PathElement::new(rim, style)
}

/// Dashes along a rim.
fn dashed(chart: &mut Chart<'_, '_>, rim: &[Point], colour: RGBColor) -> Drawn {
    const DASH: usize = 6;
    if rim.len() < 2 * DASH {
        chart.draw_series([PathElement::new(rim.to_vec(), colour.stroke_width(1))])?;
        return Ok(());
    }
    for part in rim.chunks(2 * DASH) {
        let dash = part[..part.len().min(DASH)].to_vec();
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
    let [i, j] = shown.view.plane;
    let centre = (shown.reference.to_array()[i], shown.reference.to_array()[j]);
    let across = match shown.view.ellipse.axes.first() {
        None => [0.0, 0.0],
        Some(a) => {
            let along = a[0] * d[0] + a[1] * d[1];
            [(a[0] - along * d[0]), (a[1] - along * d[1])].map(|v| v / shown.scales.ellipse)
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
    for spot in skeleton.spots.iter().filter(|s| s.grounded) {
        chart.draw_series([EmptyElement::at(flat(spot.point)) + ground()])?;
    }
    for spot in &skeleton.spots {
        let fill = if spot.driven { DARK } else { WHITE };
        let at = flat(spot.point);
        match spot.mark {
            Mark::Turning => {
                chart.draw_series([Circle::new(at, 5, fill.filled())])?;
                chart.draw_series([Circle::new(at, 5, DARK.stroke_width(2))])?;
            }
            Mark::Sliding => {
                let square = [(-5, -5), (5, 5)];
                let inside = EmptyElement::at(at) + Rectangle::new(square, fill.filled());
                chart.draw_series([inside + Rectangle::new(square, DARK.stroke_width(2))])?;
            }
            Mark::Contact => {
                let diamond = vec![(0, -6), (6, 0), (0, 6), (-6, 0)];
                let inside = EmptyElement::at(at) + Polygon::new(diamond.clone(), fill.filled());
                let rim: Vec<(i32, i32)> = diamond.iter().chain(diamond.first()).copied().collect();
                chart.draw_series([inside + PathElement::new(rim, DARK.stroke_width(2))])?;
            }
        }
    }
    Ok(())
}

/// A triangle under a joint of the ground.
fn ground() -> Polygon<(i32, i32)> {
    Polygon::new(vec![(0, 2), (-9, 15), (9, 15)], LINK.mix(0.8).filled())
}

/// Names beside the joints, away from the middle of the mechanism.
fn names(
    chart: &mut Chart<'_, '_>,
    spots: &[Spot],
    flat: impl Fn(Vec3) -> Point,
    pixel: f64,
) -> Drawn {
    let n = spots.len().max(1) as f64;
    let points: Vec<Point> = spots.iter().map(|s| flat(s.point)).collect();
    let middle = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    for (spot, point) in spots.iter().zip(&points) {
        let (mut x, mut y) = (point.0 - middle.0, point.1 - middle.1);
        let size = x.hypot(y);
        if size > pixel {
            (x, y) = (x / size, y / size);
        } else {
            (x, y) = (0.0, 1.0);
        }
        // A ground symbol stands below.
        if spot.grounded && y < 0.0 {
            (x, y) = (x.signum(), 0.0);
        }
        let shift = ((x * 17.0).round() as i32, (-y * 17.0).round() as i32);
        let style = TextStyle::from((FONT, 13).into_font())
            .color(&DARK)
            .pos(Pos::new(HPos::Center, VPos::Center));
        let text = Text::new(spot.name.clone(), shift, style);
        chart.draw_series([EmptyElement::at(*point) + text])?;
    }
    Ok(())
}

/// What the symbols mean, below all panels.
pub(super) fn symbols(area: &DrawingArea<SVGBackend<'_>, Shift>) -> Drawn {
    let y = 14;
    let text = |x: i32, words: &'static str| Text::new(words, (x, y - 6), (FONT, 12));
    area.draw(&Circle::new((26, y), 5, DARK.filled()))?;
    area.draw(&text(38, "driven joint"))?;
    area.draw(&Circle::new((136, y), 5, WHITE.filled()))?;
    area.draw(&Circle::new((136, y), 5, DARK.stroke_width(2)))?;
    area.draw(&text(148, "passive joint"))?;
    area.draw(&Rectangle::new([(249, y - 5), (259, y + 5)], DARK.stroke_width(2)))?;
    area.draw(&text(267, "sliding joint"))?;
    let diamond = vec![(366, y - 6), (372, y), (366, y + 6), (360, y), (366, y - 6)];
    area.draw(&PathElement::new(diamond, DARK.stroke_width(2)))?;
    area.draw(&text(380, "contact"))?;
    let triangle = vec![(456, y - 6), (447, y + 7), (465, y + 7)];
    area.draw(&Polygon::new(triangle, LINK.mix(0.8).filled()))?;
    area.draw(&text(472, "ground"))?;
    Ok(())
}
