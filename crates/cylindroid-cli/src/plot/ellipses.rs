//! A mechanism with its ellipses and polytopes of velocity and force, drawn at the reference point:
//! in the plane x-y, or for mechanisms in space in the three planes of the world.

mod panel;
mod shapes;

use std::path::Path;

use cylindroid::closure::MotionSpace;
use cylindroid::manipulability::{Manipulability, Polytope, force_polytope, velocity_polytope};
use cylindroid::{Matrix, Result, Vec3};
use plotters::coord::Shift;
use plotters::prelude::*;

use self::panel::{Panel, panel};
pub(crate) use self::shapes::Drawing;
use self::shapes::{Block, Ellipse, View};
use super::fine::{Fine, at, px};
use super::skeleton::Skeleton;
use super::{COLOURS, Drawn, FONT, save};
use crate::output::number;

/// Width of the figure, and size of a panel with axes: one in each block, or three [px].
const WIDTH: u32 = 1000;
const ALONE: (u32, u32) = (500, 470);
const ROW: (u32, u32) = (333, 320);
const TITLE: u32 = 44;
const LINE: u32 = 18;
/// Width of a character of running text [px].
const CHARACTER: f64 = 6.4;
const TEXT: u32 = 13;
/// Draws.
pub(crate) fn draw(drawing: &Drawing<'_>, path: &Path) -> Result<()> {
    let planar = drawing.chain.constraint.object() == 3;
    let planes: &[[usize; 2]] = if planar { &[[0, 1]] } else { &[[0, 1], [0, 2], [1, 2]] };
    let relation = MotionSpace::of(&drawing.chain.constraint).relation();
    let (mut motion, mut force) = (Vec::new(), Vec::new());
    for &plane in planes {
        let map = Matrix::from_fn(2, relation.object(), |i, j| f64::from(u8::from(plane[i] == j)));
        let seen = relation.task(&map)?;
        let m = Manipulability::of(&seen, &drawing.metrics.for_task(&map)?)?;
        let corners = |p: Polytope| p.hull.polygon().iter().map(|v| [v[0], v[1]]).collect();
        let rates = drawing.velocity_limits.as_deref();
        let torques = drawing.torque_limits.as_deref();
        motion.push(View {
            plane,
            ellipse: Ellipse::of(&m.kinematic),
            polygon: rates.map(|l| velocity_polytope(&seen, l)).transpose()?.map(corners),
        });
        force.push(View {
            plane,
            ellipse: Ellipse::of(&m.force),
            polygon: torques.map(|l| force_polytope(&seen, l)).transpose()?.map(corners),
        });
    }
    let blocks = [
        Block {
            title: "velocity",
            unit: "m/s",
            force: false,
            colour: COLOURS[0],
            views: motion,
            drawing,
        },
        Block { title: "force", unit: "N", force: true, colour: COLOURS[1], views: force, drawing },
    ];
    let mechanism = drawing.state.mechanism();
    let frame = mechanism.frame_of(drawing.chain.reference);
    let reference = drawing.state.pose(drawing.chain.reference).translation;
    let skeleton = Skeleton::new(drawing.state, (frame.link, reference))?;
    let title = format!(
        "{}: velocity and force at '{}', actuated: {}",
        mechanism.name(),
        frame.name,
        actuated(&drawing.chain.actuated)
    );
    save(path, |svg| figure(&title, &blocks, &skeleton, reference, svg))
}

/// The names of a few joints, or the number of many.
fn actuated(names: &[String]) -> String {
    /// Most characters of a list.
    const MOST: usize = 40;
    let list = names.join(", ");
    match names.len() {
        0 => "none".to_owned(),
        _ if list.len() <= MOST => list,
        n => format!("{n} joints"),
    }
}

fn figure(
    title: &str,
    blocks: &[Block<'_>; 2],
    skeleton: &Skeleton,
    reference: Vec3,
    svg: &mut String,
) -> Drawn {
    let alone = blocks[0].views.len() == 1;
    let (width, height) = if alone { ALONE } else { ROW };
    let size = skeleton_size(skeleton, reference);
    let room = if alone { ALONE.0 } else { WIDTH } - 40;
    let legends = blocks.each_ref().map(|b| b.legend(size, room));
    let lines = legends.iter().map(|l| l.iter().map(|e| e.lines.len()).sum::<usize>()).max();
    // A metre is as long in every panel.
    let metre = blocks
        .iter()
        .flat_map(|block| {
            let scales = block.scales(size);
            let panel = move |view| Panel {
                block,
                view,
                skeleton,
                reference,
                scales,
                size: (width, height),
                metre: 0.0,
            };
            block.views.iter().map(move |view| panel(view).needs())
        })
        .fold(0.0, f64::max);
    let captions = blocks
        .each_ref()
        .map(|b| b.views.iter().map(|v| wrap(&b.caption(v), width - 60)).collect::<Vec<_>>());
    let deepest = captions.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let head = 30 + LINE * u32::try_from(lines.unwrap_or(0)).unwrap_or(0);
    let foot = 12 + LINE * u32::try_from(deepest).unwrap_or(0);
    let block_height = head + height + foot;
    let total = TITLE + block_height * if alone { 1 } else { 2 } + 34;
    let root = Fine::new(svg, (px(WIDTH), px(total))).into_drawing_area();
    root.fill(&WHITE)?;
    let (top, rest) = root.split_vertically(px(TITLE));
    top.draw(&Text::new(title.to_owned(), at(20, 14), (FONT, 20)))?;
    let (body, bottom) = rest.split_vertically(px(total - TITLE - 34));
    let areas = if alone { body.split_evenly((1, 2)) } else { body.split_evenly((2, 1)) };
    for (i, (block, area)) in blocks.iter().zip(&areas).enumerate() {
        let (above, below) = area.split_vertically(px(head));
        above.draw(&Text::new(block.title, at(20, 2), (FONT, 16)))?;
        let mut y = 26;
        for entry in &legends[i] {
            entry.draw(&above, &mut y)?;
        }
        let (charts, notes) = below.split_vertically(px(height));
        let count = block.views.len();
        let (charts, notes) = (charts.split_evenly((1, count)), notes.split_evenly((1, count)));
        for (j, view) in block.views.iter().enumerate() {
            let scales = block.scales(size);
            let shown =
                Panel { block, view, skeleton, reference, scales, size: (width, height), metre };
            panel(&charts[j], &shown)?;
            for (k, line) in captions[i][j].iter().enumerate() {
                let y = i32::try_from(k).unwrap_or(0) * LINE as i32 + 2;
                notes[j].draw(&Text::new(line.clone(), at(58, y), (FONT, TEXT)))?;
            }
        }
    }
    panel::symbols(&bottom)?;
    root.present()?;
    drop((top, rest, body, bottom, areas, root));
    Ok(())
}

/// The widest side of the mechanism (m).
fn skeleton_size(skeleton: &Skeleton, reference: Vec3) -> f64 {
    let all: Vec<Vec3> = skeleton.points().chain([reference]).collect();
    let side = |of: fn(&Vec3) -> f64| {
        let (low, high) = all
            .iter()
            .map(of)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let widest = side(|p| p.x).max(side(|p| p.y)).max(side(|p| p.z));
    if widest > 0.0 { widest } else { 1.0 }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pen {
    Solid,
    Dashed,
    Filled,
}

/// A line of the legend.
struct Entry {
    pen: Pen,
    colour: RGBColor,
    lines: Vec<String>,
}

impl Entry {
    fn draw(&self, area: &DrawingArea<Fine<'_>, Shift>, y: &mut i32) -> Drawn {
        let middle = *y + 8;
        match self.pen {
            Pen::Solid => {
                let line =
                    PathElement::new([at(20, middle), at(50, middle)], self.colour.stroke_width(3));
                area.draw(&line)?;
            }
            Pen::Dashed => {
                for x in [20, 32, 44] {
                    let dash = [at(x, middle), at(x + 7, middle)];
                    area.draw(&PathElement::new(dash, self.colour.stroke_width(3)))?;
                }
            }
            Pen::Filled => {
                let corners = [at(20, middle - 6), at(50, middle + 6)];
                area.draw(&Rectangle::new(corners, self.colour.mix(0.15).filled()))?;
                area.draw(&Rectangle::new(corners, self.colour.stroke_width(1)))?;
            }
        }
        for line in &self.lines {
            area.draw(&Text::new(line.clone(), at(60, *y + 1), (FONT, TEXT)))?;
            *y += LINE as i32;
        }
        Ok(())
    }
}

impl Block<'_> {
    fn legend(&self, size: f64, room: u32) -> Vec<Entry> {
        let scales = self.scales(size);
        let drawn = |scale: Option<f64>| match scale {
            // Not broken between lines.
            Some(scale) => {
                let scale = format!("scale {} {} per m", number(scale), self.unit);
                format!("; {}", scale.replace(' ', "\u{a0}"))
            }
            None => ": none".to_owned(),
        };
        let joints = if self.force { "joint torques" } else { "joint velocities" };
        let of_size = match self.drawing.metric {
            "limits" if !self.force => {
                "joint velocities of norm 1 relative to their limits".to_owned()
            }
            metric => format!("{joints} of norm 1 (metric: {metric})"),
        };
        let entry =
            |pen, colour, text: String| Entry { pen, colour, lines: wrap(&text, room - 40) };
        let mut entries = Vec::new();
        if self.force {
            let text = format!("exerted by {of_size}{}", drawn(scales.ellipse));
            entries.push(entry(Pen::Solid, self.colour, text));
            let text = "resisted with the same torques and structural support".to_owned();
            entries.push(entry(Pen::Dashed, COLOURS[2], text));
        } else {
            let text = format!("for {of_size}{}", drawn(scales.ellipse));
            entries.push(entry(Pen::Solid, self.colour, text));
            if self.views.iter().any(|v| !v.ellipse.endless.is_empty()) {
                let text = "not controlled by the actuators: unbounded".to_owned();
                entries.push(entry(Pen::Dashed, COLOURS[3], text));
            }
        }
        if self.views.iter().any(|v| v.polygon.is_some()) {
            let text = format!("within the limits of the {joints}{}", drawn(scales.polygon));
            entries.push(entry(Pen::Filled, self.colour, text));
        }
        entries
    }

    /// The semi-axes and unbounded directions in words.
    fn caption(&self, view: &View) -> String {
        let along = |d: &[f64; 2]| {
            // Of the two signs always the same one.
            let sign = if d[0] < -1e-9 || (d[0] < 1e-9 && d[1] < 0.0) { -1.0 } else { 1.0 };
            let part = |x: f64| number((sign * x * 1000.0).round() / 1000.0 + 0.0);
            format!("({}, {})", part(d[0]), part(d[1]))
        };
        let Ellipse { axes, endless } = &view.ellipse;
        let three = |x: f64| {
            let digits = 10_f64.powf(2.0 - x.log10().floor());
            number((x * digits).round() / digits)
        };
        let sizes: Vec<String> = axes.iter().map(|a| three(a[0].hypot(a[1]))).collect();
        let (what, unit) = (self.title, self.unit);
        match (sizes.as_slice(), endless.as_slice()) {
            ([], []) if self.force => "no force is resisted in this plane".to_owned(),
            ([], []) => "no motion in this plane".to_owned(),
            ([a], []) if self.force => {
                format!("a line of {a} {unit} each way: forces across it are not resisted")
            }
            ([a], []) => format!("a line of {a} {unit} each way: no velocity across it"),
            ([], [d]) if self.force => {
                format!("forces along {} need no torque; others are not resisted", along(d))
            }
            ([], [d]) => format!("moves freely along {}; no motion across it", along(d)),
            ([a], [d]) if self.force => {
                format!("{a} {unit} across; forces along {} need no torque", along(d))
            }
            ([a], [d]) => format!("{a} {unit} across; moves freely along {}", along(d)),
            ([], _) if self.force => "all forces are resisted without torque".to_owned(),
            ([], _) => "moves freely in this plane".to_owned(),
            (all, _) => format!("semi-axes of the {what} ellipse {} {unit}", all.join(" and ")),
        }
    }
}

fn wrap(text: &str, width: u32) -> Vec<String> {
    crate::output::wrap(text, (f64::from(width) / CHARACTER) as usize)
}
