//! The conics of a three-system in the plane of its screws: the pencil over the pitch, the
//! principal ones, and the given twists as points.
//!
//! The chart shows homogeneous coordinates (x1, x2, x3) as barycentric ones of a triangle, whose
//! corners are the generators: a projective map, in which conics stay conics and lines lines.

use cylindroid::Twist;
use cylindroid::screws::{ConicKind, PitchConics, Screw, ScrewSystem};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::fine::{Fine, at, px};
use super::labels::{Area as Box, Labels};
use super::{Area, COLOURS, Drawn, FONT, blend, titled};
use crate::output::number;

/// Conics of the pencil between two principal pitches.
const CONICS: u32 = 5;
/// Points of a conic.
const POINTS: usize = 2000;
/// Half the width and height of the chart, over the radius of the triangle.
const HALF: (f64, f64) = (3.0, 2.05);
/// Font size of labels [px].
const SMALL: u32 = 13;

type Point = (f64, f64);
type Chart<'a, 'b> = ChartContext<'a, Fine<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The point of the chart for homogeneous coordinates, and on which side of infinity it lies.
fn chart_point(x: [f64; 3]) -> (Point, f64) {
    let corner = |k: f64| (std::f64::consts::FRAC_PI_2 + k * std::f64::consts::TAU / 3.0).sin_cos();
    let corners = [corner(0.0), corner(1.0), corner(2.0)];
    let sum: f64 = x.iter().sum();
    let along = |of: fn(&(f64, f64)) -> f64| {
        x.iter().zip(&corners).map(|(x, c)| x * of(c)).sum::<f64>() / sum
    };
    ((along(|c| c.1), along(|c| c.0)), sum)
}

/// The pitches drawn: those between neighbours of the principal ones, and beyond them where conics
/// are real.
fn pencil(conics: &PitchConics, system: &ScrewSystem) -> Vec<f64> {
    let mut ends = system.normal_form().pitches.clone();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * system.length());
    let width = match ends[..] {
        [first, .., last] => last - first,
        _ => system.length(),
    };
    let (first, last) = match ends[..] {
        [first, .., last] => (first - width, last + width),
        [h] => (h - width, h + width),
        [] => (-width, width),
    };
    ends.insert(0, first);
    ends.push(last);
    let mut all: Vec<f64> = ends
        .windows(2)
        .flat_map(|pair| {
            let step = (pair[1] - pair[0]) / f64::from(CONICS + 1);
            (1..=CONICS).map(move |k| pair[0] + f64::from(k) * step)
        })
        .collect();
    all.push(0.0);
    all.retain(|h| !matches!(conics.kind(*h), ConicKind::Empty | ConicKind::Plane));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Draws the panel.
pub(super) fn conics(
    area: &Area<'_>,
    system: &ScrewSystem,
    conics: &PitchConics,
    twists: &[(String, Twist)],
) -> Drawn {
    let principal = principal(conics, system);
    let pencil = pencil(conics, system);
    let all = || pencil.iter().chain(principal.iter().map(|(h, _)| h)).copied();
    let (low, high) =
        (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let range = if pencil.is_empty() {
        String::new()
    } else {
        format!("; pitch from {} (blue) to {} (orange) m/rad", clean(low), clean(high))
    };
    let caption = format!("conics of equal pitch in the plane of the screws of the system{range}");
    let area = titled(area, &caption, 15)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(px(12))
        .build_cartesian_2d(-HALF.0..HALF.0, -HALF.1..HALF.1)?;
    let (x, y) = chart.plotting_area().get_pixel_range();
    let side = |r: std::ops::Range<i32>| (f64::from(r.start) / 100.0, f64::from(r.end) / 100.0);
    let mut labels = Labels::new(Box { x: side(x), y: side(y) });
    let share = |h: f64| if high > low { (h - low) / (high - low) } else { 0.5 };
    for h in &pencil {
        for line in lines(&conics.points(*h, POINTS)) {
            chart.draw_series([PathElement::new(line, blend(share(*h)).stroke_width(1))])?;
        }
    }
    for (h, _) in &principal {
        for line in lines(&conics.points(*h, POINTS)) {
            labels.avoid_line(&thin(&chart, &line));
            chart.draw_series([PathElement::new(line, COLOURS[3].stroke_width(3))])?;
        }
    }
    let mut words = Vec::new();
    for (h, kind) in &principal {
        let points = conics.points(*h, 2);
        if let (ConicKind::Point, [curve]) = (kind, &points[..]) {
            let p = chart_point(curve[0]).0;
            chart.draw_series([Circle::new(p, 5, COLOURS[3].filled())])?;
        }
    }
    for (i, generator) in conics.generators.iter().enumerate() {
        let mut x = [0.0; 3];
        x[i] = 1.0;
        let p = chart_point(x).0;
        chart.draw_series([Circle::new(p, 3, BLACK.filled())])?;
        let name = match Screw::of(*generator) {
            Some(s) if s.is_translation() => "translation".to_owned(),
            Some(s) => format!("h = {}", clean(s.pitch)),
            None => String::new(),
        };
        words.push((p, name, COLOURS[3]));
    }
    for (name, twist) in twists {
        let Some(x) = conics.coordinates(*twist) else { continue };
        let p = chart_point(x).0;
        if p.0.abs() < HALF.0 && p.1.abs() < HALF.1 {
            chart.draw_series([Circle::new(p, 4, COLOURS[2].filled())])?;
            words.push((p, name.clone(), COLOURS[2]));
        }
    }
    for (p, ..) in &words {
        labels.avoid_box(Box::around(pixels(&chart, *p), (5.0, 5.0)));
    }
    for (p, text, colour) in words {
        let place = labels.place(&text, pixels(&chart, p), f64::from(SMALL));
        write(&chart, &text, place, colour)?;
    }
    if pencil.is_empty() {
        let text = match conics.kind(system.principal_pitches().first().copied().unwrap_or(0.0)) {
            ConicKind::Plane => "all screws of the system have one pitch, or are translations",
            _ => "no real conics",
        };
        let style = (FONT, 15).into_font().color(&BLACK);
        chart.draw_series([Text::new(text, (-1.4, -1.7), style)])?;
    }
    legend(&area)
}

/// The pitches of the singular conics with their kinds.
fn principal(conics: &PitchConics, system: &ScrewSystem) -> Vec<(f64, ConicKind)> {
    let mut pitches = system.normal_form().pitches.clone();
    pitches.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * system.length());
    let kind = |h: f64| (h, conics.kind(h));
    pitches.into_iter().map(kind).filter(|(_, k)| *k != ConicKind::Plane).collect()
}

fn clean(h: f64) -> String {
    number(if h.abs() < 1e-9 { 0.0 } else { (h * 1e6).round() / 1e6 })
}

fn pixels(chart: &Chart<'_, '_>, p: Point) -> Point {
    let (x, y) = chart.backend_coord(&p);
    (f64::from(x) / 100.0, f64::from(y) / 100.0)
}

/// Every tenth point of a line.
fn thin(chart: &Chart<'_, '_>, line: &[Point]) -> Vec<Point> {
    line.iter().step_by(10).chain(line.last()).map(|p| pixels(chart, *p)).collect()
}

fn write(chart: &Chart<'_, '_>, text: &str, place: Point, colour: RGBColor) -> Drawn {
    let area = chart.plotting_area().strip_coord_spec();
    let (x, y) = area.get_base_pixel();
    let place = ((place.0 * 100.0).round() as i32 - x, (place.1 * 100.0).round() as i32 - y);
    let style = TextStyle::from((FONT, SMALL).into_font())
        .color(&colour)
        .pos(Pos::new(HPos::Center, VPos::Center));
    area.draw(&Text::new(text.to_owned(), place, style))?;
    Ok(())
}

/// The curves in the chart, cut at infinity and at the frame.
fn lines(curves: &[Vec<[f64; 3]>]) -> Vec<Vec<Point>> {
    let mut lines = Vec::new();
    for curve in curves.iter().filter(|c| c.len() > 1) {
        let mut line: Vec<Point> = Vec::new();
        let mut side = 0.0;
        for x in curve {
            let (p, now) = chart_point(*x);
            let inside = p.0.abs() <= HALF.0 && p.1.abs() <= HALF.1;
            if !inside || (side * now < 0.0) {
                lines.push(std::mem::take(&mut line));
            }
            if inside {
                line.push(p);
            }
            side = now;
        }
        lines.push(line);
    }
    lines.retain(|l| l.len() > 1);
    lines
}

fn legend(area: &Area<'_>) -> Drawn {
    let text = |x: i32, words: &'static str| Text::new(words, at(x, 2), (FONT, SMALL));
    area.draw(&PathElement::new([at(20, 9), at(44, 9)], COLOURS[0].stroke_width(1)))?;
    area.draw(&text(52, "conic of one pitch"))?;
    area.draw(&PathElement::new([at(190, 9), at(214, 9)], COLOURS[3].stroke_width(3)))?;
    area.draw(&Circle::new(at(202, 9), 5, COLOURS[3].filled()))?;
    area.draw(&text(222, "of a principal pitch: point, line pair"))?;
    area.draw(&Circle::new(at(470, 9), 3, BLACK.filled()))?;
    area.draw(&text(480, "generator, with its pitch"))?;
    area.draw(&Circle::new(at(660, 9), 4, COLOURS[2].filled()))?;
    area.draw(&text(670, "given twist"))?;
    Ok(())
}
