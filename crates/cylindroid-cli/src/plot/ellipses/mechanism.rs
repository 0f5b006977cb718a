//! The mechanism in a panel: links, joints, contacts, the held object, and names beside joints.

use cylindroid::Vec3;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::fine::{Fine, at};
use super::super::labels::{Area, Labels, Pixel};
use super::super::skeleton::{Mark, Skeleton};
use super::super::{Drawn, FONT};
use super::chart::{Chart, Point, closed, in_pixels};

const DARK: RGBColor = RGBColor(60, 60, 60);
const LINK: RGBColor = RGBColor(120, 120, 120);
const OBJECT: RGBColor = RGBColor(222, 184, 135);
/// Width of an object around the points where it is held [px].
const BODY: u32 = 20;
/// Font size of names [px].
const NAME: u32 = 13;

pub(super) fn mechanism(
    chart: &mut Chart<'_, '_>,
    skeleton: &Skeleton,
    flat: impl Fn(Vec3) -> Point,
) -> Drawn {
    for object in &skeleton.objects {
        let points: Vec<Point> = hull(object.points.iter().map(|p| flat(*p)).collect());
        for (width, colour) in [(BODY + 3, LINK), (BODY, OBJECT)] {
            // Corners are round: a circle at each.
            for p in &points {
                chart.draw_series([Circle::new(*p, width / 2, colour.filled())])?;
            }
            // One by one: corners of a path would be pointed.
            for (p, q) in points.iter().zip(points.iter().cycle().skip(1)) {
                chart.draw_series([PathElement::new([*p, *q], colour.stroke_width(width))])?;
            }
        }
        if points.len() > 2 {
            chart.draw_series([Polygon::new(points, OBJECT.filled())])?;
        }
    }
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

/// The convex hull of points of the plane, around it.
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup();
    let turn = |o: Point, a: Point, b: Point| (a.0 - o.0) * (b.1 - o.1) - (a.1 - o.1) * (b.0 - o.0);
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., o, a] = chain[..] {
                if turn(o, a, p) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    if points.len() < 3 {
        return points;
    }
    let mut below = chain(&mut points.iter().copied());
    below.extend(chain(&mut points.iter().rev().copied()));
    below
}

/// Names beside the joints and on the object, where they touch neither lines nor one another.
pub(super) fn names(
    chart: &mut Chart<'_, '_>,
    skeleton: &Skeleton,
    flat: impl Fn(Vec3) -> Point,
    rims: &[Vec<Point>],
) -> Drawn {
    let (x, y) = chart.plotting_area().get_pixel_range();
    let side = |r: std::ops::Range<i32>| (f64::from(r.start) / 100.0, f64::from(r.end) / 100.0);
    let mut labels = Labels::new(Area { x: side(x), y: side(y) });
    let pixels =
        |points: &[Point]| -> Vec<Pixel> { points.iter().map(|p| in_pixels(chart, *p)).collect() };
    for link in &skeleton.links {
        let points: Vec<Point> = link.iter().chain(link.first()).map(|p| flat(*p)).collect();
        labels.avoid_line(&pixels(&points));
    }
    for rim in rims {
        let mut line = pixels(rim);
        line.extend(line.first().copied());
        labels.avoid_line(&line);
    }
    let spots: Vec<Pixel> =
        skeleton.spots.iter().map(|s| in_pixels(chart, flat(s.point))).collect();
    for spot in &spots {
        labels.avoid_box(Area::around(*spot, (6.0, 6.0)));
    }
    for base in &skeleton.bases {
        let (x, y) = in_pixels(chart, flat(*base));
        labels.avoid_box(Area { x: (x - 10.0, x + 10.0), y: (y, y + 16.0) });
    }
    let objects: Vec<(&str, Pixel)> = skeleton
        .objects
        .iter()
        .map(|o| (o.name.as_str(), in_pixels(chart, flat(o.middle()))))
        .collect();
    let half = 0.5 * f64::from(BODY);
    objects.iter().for_each(|(_, at)| labels.avoid_box(Area::around(*at, (half, half))));
    let joints = skeleton.spots.iter().zip(&spots).map(|(s, at)| (s.name.as_str(), *at));
    let style = TextStyle::from((FONT, NAME).into_font())
        .color(&DARK)
        .pos(Pos::new(HPos::Center, VPos::Center));
    for (name, point) in joints.chain(objects) {
        let (x, y) = labels.place(name, point, f64::from(NAME));
        let at = ((x * 100.0).round() as i32, (y * 100.0).round() as i32);
        chart.plotting_area().strip_coord_spec().draw(&Text::new(
            name.to_owned(),
            relative(chart, at),
            style.clone(),
        ))?;
    }
    Ok(())
}

/// A position of the whole drawing in the coordinates of the plotting area.
fn relative(chart: &Chart<'_, '_>, at: (i32, i32)) -> (i32, i32) {
    let (x, y) = chart.plotting_area().strip_coord_spec().get_base_pixel();
    (at.0 - x, at.1 - y)
}

/// What the symbols mean, below all panels.
pub(super) fn symbols(area: &DrawingArea<Fine<'_>, Shift>, object: bool) -> Drawn {
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
    if object {
        area.draw(&Rectangle::new([at(540, y - 7), at(566, y + 7)], OBJECT.filled()))?;
        area.draw(&text(574, "held object"))?;
    }
    Ok(())
}
