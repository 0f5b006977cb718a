//! What the figure says in words: the lines of the legend, and the numbers below each panel.

use cylindroid::manipulability::EllipsoidView;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::super::fine::{Fine, at};
use super::super::{COLOURS, Drawn, FONT};
use super::shapes::{Block, PlaneShapes, Shape};
use super::{LINE, TEXT, wrap};
use crate::output::number;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pen {
    Solid,
    Dashed,
    Filled,
    Strip,
    /// Words without a line.
    None,
}

/// A line of the legend.
pub(super) struct Entry {
    pen: Pen,
    colour: RGBColor,
    pub(super) lines: Vec<String>,
}

impl Entry {
    pub(super) fn draw(&self, area: &DrawingArea<Fine<'_>, Shift>, y: &mut i32) -> Drawn {
        let middle = *y + 8;
        let stroke = self.colour.stroke_width(3);
        match self.pen {
            Pen::None => {}
            Pen::Solid => {
                area.draw(&PathElement::new([at(20, middle), at(50, middle)], stroke))?;
            }
            Pen::Dashed => {
                for x in [20, 32, 44] {
                    let dash = [at(x, middle), at(x + 7, middle)];
                    area.draw(&PathElement::new(dash, self.colour.stroke_width(2)))?;
                }
            }
            Pen::Filled | Pen::Strip => {
                let corners = [at(20, middle - 6), at(50, middle + 6)];
                area.draw(&Rectangle::new(corners, self.colour.mix(0.15).filled()))?;
                if self.pen == Pen::Filled {
                    area.draw(&Rectangle::new(corners, self.colour.stroke_width(1)))?;
                } else {
                    for y in [middle - 6, middle + 6] {
                        let rim = [at(20, y), at(50, y)];
                        area.draw(&PathElement::new(rim, self.colour.stroke_width(2)))?;
                    }
                }
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
    pub(super) fn legend(&self, size: f64, room: u32) -> Vec<Entry> {
        let drawing = self.drawing;
        let scales = self.scales(size);
        let unit = drawing.planes.first().map_or("", |p| self.unit(p.components[0]));
        let drawn = |scale: Option<f64>| match scale {
            None => ": none".to_owned(),
            Some(_) if !drawing.in_world() => String::new(),
            // Not broken between lines.
            Some(scale) => {
                let scale = format!("scale {} {unit} per m", number(scale));
                format!("; {}", scale.replace(' ', "\u{a0}"))
            }
        };
        let joints = if self.force { "joint torques" } else { "joint velocities" };
        let of_size = match drawing.metric {
            "limits" if !self.force => {
                "joint velocities of norm 1 relative to their limits".to_owned()
            }
            metric => format!("{joints} of norm 1 (metric: {metric})"),
        };
        let entry = |pen, colour, text: &str| Entry { pen, colour, lines: wrap(text, room - 40) };
        let mut entries = vec![entry(Pen::None, BLACK, &self.view())];
        let outline = drawn(scales.ellipse);
        if self.force {
            let alike = if self.is_supported() { "" } else { " and resisted alike" };
            let text = format!("exerted{alike} by {of_size}{outline}");
            entries.push(entry(Pen::Solid, self.colour, &text));
            if drawing.planes.iter().any(|p| self.resisted(p).is_some_and(|r| r.endless.is_empty()))
            {
                let text = "resisted with the same torques and structural support";
                entries.push(entry(Pen::Dashed, COLOURS[2], text));
            }
            if drawing.planes.iter().any(|p| !p.resisted.endless.is_empty()) {
                let text = "resisted with the same torques and, without end, by the structure \
                            without torque";
                entries.push(entry(Pen::Strip, COLOURS[2], text));
            }
        } else {
            entries.push(entry(Pen::Solid, self.colour, &format!("for {of_size}{outline}")));
            if drawing.planes.iter().any(|p| !p.velocity.endless.is_empty()) {
                let text = "not controlled by the actuators: unbounded";
                entries.push(entry(Pen::Strip, COLOURS[3], text));
            }
        }
        if drawing.planes.iter().any(|p| self.region(p).is_some()) {
            let scale = match scales.polygon {
                Some(scale) if !drawing.in_world() && scale > 1.0 => {
                    format!("; drawn at 1/{} of its size", number(scale))
                }
                Some(scale) if !drawing.in_world() && scale < 1.0 => {
                    format!("; drawn {} times larger", number(1.0 / scale))
                }
                scale => drawn(scale),
            };
            let text = format!("within the limits of the {joints}{scale}");
            entries.push(entry(Pen::Filled, self.colour, &text));
        }
        entries
    }

    /// Which components are free and which are zero.
    fn view(&self) -> String {
        let drawing = self.drawing;
        let view = drawing.view.name();
        let state = match drawing.view {
            EllipsoidView::Projection => "free",
            EllipsoidView::Section => "zero",
        };
        let others = match drawing.planes {
            [plane] => drawing.others(plane).join(", "),
            _ => "the other components".to_owned(),
        };
        let task = match (drawing.task, self.force) {
            (false, _) => "",
            (true, false) => "; outside the task all is free",
            (true, true) => "; outside the task all is zero",
        };
        if others.is_empty() {
            return format!("all components{task}");
        }
        format!("{view}: {others} {state}{task}")
    }

    /// The semi-axes and unbounded directions in words.
    pub(super) fn caption(&self, plane: &PlaneShapes) -> String {
        let first = if self.force { "exerted" } else { "velocity" };
        let own = format!("{first}: {}", self.words(plane, self.shape(plane)));
        match self.resisted(plane) {
            Some(resisted) if resisted.is_like(self.shape(plane)) => {
                format!("{own}; resisted: the same")
            }
            Some(resisted) => format!("{own}; resisted: {}", self.words(plane, resisted)),
            None => own,
        }
    }

    fn words(&self, plane: &PlaneShapes, shape: &Shape) -> String {
        let along = |d: &[f64; 2]| {
            let part = |x: f64| number((x * 1000.0).round() / 1000.0 + 0.0);
            format!("({}, {})", part(d[0]), part(d[1]))
        };
        let three = |x: f64| {
            let digits = 10_f64.powf(2.0 - x.log10().floor());
            number((x * digits).round() / digits)
        };
        let [u, v] = plane.components.map(|c| self.unit(c));
        if u != v {
            let [a, b] = plane.components.map(|c| &self.drawing.components[c]);
            let [x, y] = shape.reach();
            let end = match shape.endless.as_slice() {
                [] => String::new(),
                [d] => format!(", unbounded along {}", along(d)),
                _ => return "unbounded".to_owned(),
            };
            let most = |x: f64| if x > 0.0 { three(x) } else { "0".to_owned() };
            return format!("{a} up to {} {u}, {b} up to {} {v}{end}", most(x), most(y));
        }
        let unit = if u.is_empty() { String::new() } else { format!(" {u}") };
        let sizes: Vec<String> = shape.sizes().map(three).collect();
        match (sizes.as_slice(), shape.endless.as_slice()) {
            ([], []) => "none in this plane".to_owned(),
            ([a], []) => format!("a line of {a}{unit} each way, nothing across"),
            ([], [d]) => format!("unbounded along {}, nothing across", along(d)),
            ([a, ..], [d]) => format!("{a}{unit} across, unbounded along {}", along(d)),
            ([], _) => "unbounded in this plane".to_owned(),
            (all, _) => format!("semi-axes {}{unit}", all.join(" and ")),
        }
    }
}
