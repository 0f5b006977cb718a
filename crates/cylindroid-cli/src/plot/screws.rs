//! A screw system as an SVG: Gram determinant and projector norm over the pitch, the cylindroid of
//! a two-system, and the conics of a three-system.

use std::ops::Range;
use std::path::Path;

use cylindroid::screws::{Line, Screw, ScrewSystem, gram_determinant};
use cylindroid::{Matrix, Pose, Result, Twist, Vec3};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::conics::conics;
use super::fine::{Fine, px};
use super::labels::{Area as Box, Labels};
use super::{Area, COLOURS, Drawn, FONT, TICK, blend, builder, save, titled};
use crate::output::number;

/// Width, and height of a panel.
const WIDTH: u32 = px(820);
const HEIGHT: u32 = px(300);
/// Height of the cylindroid.
const TALL: u32 = px(560);
/// Number of pitches of a curve.
const POINTS: i32 = 1200;
/// Larger projector norms are drawn at this value.
const LARGEST: f64 = 1e3;
/// Number of screws of a cylindroid.
const SCREWS: usize = 72;

/// Draws a system spanned by the columns of `jacobian`, which have these names.
pub(crate) fn draw(
    title: &str,
    (names, jacobian): (&[String], &Matrix),
    system: &ScrewSystem,
    path: &Path,
) -> Result<()> {
    save(path, |svg| panels(title, (names, jacobian), system, svg))
}

fn panels(
    title: &str,
    (names, jacobian): (&[String], &Matrix),
    system: &ScrewSystem,
    svg: &mut String,
) -> Drawn {
    let pencil = system.pencil(SCREWS);
    let plane = system.pitch_conics();
    let tall = if pencil.is_empty() && plane.is_none() { 0 } else { TALL };
    let root = Fine::new(svg, (WIDTH, px(40) + 2 * HEIGHT + tall)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = titled(&root, title, 20)?;
    let (top, bottom) = root.split_vertically(HEIGHT);
    let (middle, rest) = bottom.split_vertically(HEIGHT);
    let range = pitches(system);
    determinant(&top, jacobian, system, &range)?;
    size(&middle, system, &range)?;
    if !pencil.is_empty() {
        cylindroid(&rest, system, &pencil)?;
    }
    if let Some(plane) = plane {
        let twist = |j: usize| Twist::from_array(std::array::from_fn(|i| jacobian[(i, j)]));
        let twists: Vec<(String, Twist)> =
            names.iter().cloned().enumerate().map(|(j, name)| (name, twist(j))).collect();
        conics(&rest, system, &plane, &twists)?;
    }
    root.present()?;
    drop((top, bottom, middle, rest, root));
    Ok(())
}

/// The range of the principal pitches with a margin; plus or minus the characteristic length if
/// they vanish.
fn pitches(system: &ScrewSystem) -> Range<f64> {
    let most = system.principal_pitches().iter().fold(0.0, |m: f64, h| m.max(h.abs()));
    let most = if most > 1e-3 * system.length() { 2.5 * most } else { system.length() };
    -most..most
}

/// A tick label of an axis of this width; rounding errors are shown as zero.
fn label(x: f64, width: f64) -> String {
    number(if x.abs() < 1e-9 * width { 0.0 } else { x })
}

fn samples(range: &Range<f64>) -> impl Iterator<Item = f64> + use<> {
    let (from, width) = (range.start, range.end - range.start);
    (0..=POINTS).map(move |i| from + width * f64::from(i) / f64::from(POINTS))
}

fn determinant(
    area: &Area<'_>,
    jacobian: &Matrix,
    system: &ScrewSystem,
    range: &Range<f64>,
) -> Drawn {
    // For dependent twists the determinant vanishes at every pitch; that of a basis is drawn.
    let independent = jacobian.cols() == system.order();
    let basis = system.basis();
    let of = if independent {
        jacobian.clone()
    } else {
        Matrix::from_fn(6, basis.len(), |i, j| basis[j].to_array()[i])
    };
    let name = if independent { "det(J^T Q_h J)" } else { "det(B^T Q_h B), B a basis" };
    let values: Vec<(f64, f64)> =
        samples(range).map(|h| Ok((h, gram_determinant(&of, h)?))).collect::<Result<_>>()?;
    let low = values.iter().fold(0.0, |m: f64, v| m.min(v.1));
    let high = values.iter().fold(0.0, |m: f64, v| m.max(v.1));
    let height = if high > low { high - low } else { 1.0 };
    let heights = low - 0.1 * height..high + 0.2 * height;
    let mut chart = builder(area).build_cartesian_2d(range.clone(), heights)?;
    let width = range.end - range.start;
    chart
        .configure_mesh()
        .x_desc("pitch h [m/rad]")
        .y_desc(name)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .set_all_tick_mark_size(TICK)
        .y_labels(6)
        .x_label_formatter(&|x| label(*x, width))
        .y_label_formatter(&|y| label(*y, height))
        .draw()?;
    chart.draw_series(LineSeries::new(
        [(range.start, 0.0), (range.end, 0.0)],
        BLACK.mix(0.5).stroke_width(1),
    ))?;
    chart.draw_series(LineSeries::new(values.iter().copied(), COLOURS[0].stroke_width(2)))?;
    let principal = system.principal_pitches();
    let name = |h: f64| format!("h = {}", label(h, system.length()));
    let named: Vec<_> = principal.iter().map(|&h| ((h, 0.0), name(h))).collect();
    let zero = [(range.start, 0.0), (range.end, 0.0)];
    marks(&mut chart, &[&values, &zero], &named)
}

/// Points with their names, which do not touch the curves.
fn marks<Y: Ranged<ValueType = f64>>(
    chart: &mut ChartContext<'_, Fine<'_>, Cartesian2d<RangedCoordf64, Y>>,
    curves: &[&[(f64, f64)]],
    named: &[((f64, f64), String)],
) -> Drawn {
    const SIZE: u32 = 14;
    let pixels = |p: &(f64, f64)| {
        let (x, y) = chart.backend_coord(p);
        (f64::from(x) / 100.0, f64::from(y) / 100.0)
    };
    let (x, y) = chart.plotting_area().get_pixel_range();
    let side = |r: std::ops::Range<i32>| (f64::from(r.start) / 100.0, f64::from(r.end) / 100.0);
    let mut labels = Labels::new(Box { x: side(x), y: side(y) });
    for curve in curves {
        labels.avoid_line(&curve.iter().map(pixels).collect::<Vec<_>>());
    }
    let points: Vec<(f64, f64)> = named.iter().map(|(p, _)| pixels(p)).collect();
    points.iter().for_each(|p| labels.avoid_box(Box::around(*p, (6.0, 6.0))));
    chart.draw_series(named.iter().map(|(p, _)| Circle::new(*p, 5, COLOURS[1].filled())))?;
    let area = chart.plotting_area().strip_coord_spec();
    let (left, top) = area.get_base_pixel();
    for ((_, text), point) in named.iter().zip(points) {
        let (x, y) = labels.place(text, point, f64::from(SIZE));
        let place = ((x * 100.0).round() as i32 - left, (y * 100.0).round() as i32 - top);
        let style = TextStyle::from((FONT, SIZE).into_font())
            .color(&BLACK)
            .pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&Text::new(text.clone(), place, style))?;
    }
    Ok(())
}

fn size(area: &Area<'_>, system: &ScrewSystem, range: &Range<f64>) -> Drawn {
    let norms: Vec<(f64, f64)> =
        samples(range).map(|h| (h, system.projector_norm(h).min(LARGEST))).collect();
    let width = range.end - range.start;
    let mut chart =
        builder(area).build_cartesian_2d(range.clone(), (0.8..1.2 * LARGEST).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("pitch h [m/rad]")
        .y_desc("projector norm |P_h| [-], at most 1000")
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .set_all_tick_mark_size(TICK)
        .y_labels(4)
        .x_label_formatter(&|x| label(*x, width))
        .y_label_formatter(&|y| number(*y))
        .draw()?;
    if norms.iter().all(|n| n.1 >= LARGEST) {
        let middle = (0.5 * (range.start + range.end), 30.0);
        let text = "no projector exists for any pitch";
        let style = (FONT, 16).into_font().color(&COLOURS[3]);
        chart.draw_series([Text::new(text, middle, style)])?;
        return Ok(());
    }
    chart.draw_series(LineSeries::new(norms.iter().copied(), COLOURS[2].stroke_width(2)))?;
    let choice = system.choose_pitch();
    let named: Vec<_> = choice
        .pitch
        .filter(|h| range.contains(h))
        .map(|h| ((h, choice.norm), format!("smallest: h = {}", label(h, system.length()))))
        .into_iter()
        .collect();
    marks(&mut chart, &[&norms], &named)
}

/// The axes of the screws of a two-system, in its canonical frame, coloured by pitch.
fn cylindroid(area: &Area<'_>, system: &ScrewSystem, pencil: &[Screw]) -> Drawn {
    let home: Pose = system.canonical_pose().inverse();
    // In the canonical frame, each axis given by its point closest to the origin.
    let seen = |s: &Screw| {
        let line = Line { point: home * s.axis.point, direction: home.rotation * s.axis.direction };
        Screw { axis: Line { point: line.nearest(Vec3::ZERO), ..line }, ..*s }
    };
    let screws: Vec<Screw> = pencil.iter().filter(|s| !s.is_translation()).map(seen).collect();
    let finite = || screws.iter().map(|s| s.pitch).filter(|h| h.abs() < 10.0 * system.length());
    let (low, high) =
        (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let height = screws
        .iter()
        .map(|s| s.axis.point.norm())
        .filter(|z| *z < 10.0 * system.length())
        .fold(0.0, f64::max);
    let half = if height > 0.0 { 1.6 * height } else { system.length() };
    let of = if system.order() == 4 { "the reciprocal system" } else { "the system" };
    let caption = format!(
        "axes of {of} in its canonical frame [m]: pitch from {} (blue) to {} (orange) m/rad",
        label(low, system.length()),
        label(high, system.length())
    );
    let area = titled(area, &caption, 15)?;
    let cube = -half..half;
    let mut chart = ChartBuilder::on(&area).margin(px(10)).build_cartesian_3d(
        cube.clone(),
        cube.clone(),
        cube,
    )?;
    chart.with_projection(|mut view| {
        view.pitch = 0.45;
        view.yaw = 0.6;
        view.scale = 0.8;
        view.into_matrix()
    });
    chart
        .configure_axes()
        .light_grid_style(BLACK.mix(0.06))
        .max_light_lines(2)
        .tick_size(TICK)
        .label_style((FONT, 12))
        .x_labels(5)
        .y_labels(5)
        .z_labels(5)
        .x_formatter(&|x| label(*x, half))
        .y_formatter(&|y| label(*y, half))
        .z_formatter(&|z| label(*z, half))
        .draw()?;
    for screw in &screws {
        let (p, d) = (screw.axis.point, screw.axis.direction);
        let share =
            if high > low { ((screw.pitch - low) / (high - low)).max(0.0).min(1.0) } else { 0.5 };
        let ends = [p - d * half, p + d * half];
        let inside = |x: f64| x.abs() <= 1.001 * half;
        // The second axis of the chart points up: z.
        let points: Vec<(f64, f64, f64)> = ends
            .iter()
            .map(|e| {
                let clip = half / e.x.abs().max(e.y.abs()).max(half);
                let e = p + (*e - p) * clip;
                (e.x, e.z, e.y)
            })
            .collect();
        if points.iter().all(|(x, z, y)| inside(*x) && inside(*y) && inside(*z)) {
            chart.draw_series(LineSeries::new(points, blend(share).stroke_width(2)))?;
        }
    }
    Ok(())
}
