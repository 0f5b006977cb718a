//! A mechanism with its ellipses and polytopes of velocity and force, drawn at the reference point:
//! in the plane x-y, or for mechanisms in space in the three planes of the world. A task of other
//! components is drawn in axes of its own.

mod chart;
mod legend;
mod mechanism;
mod panel;
mod shapes;

use std::path::Path;

use cylindroid::{Result, Vec3};
use plotters::prelude::*;

use self::panel::{Panel, panel};
use self::shapes::Block;
pub(crate) use self::shapes::{Drawing, PlaneShapes, Region, Shape};
use super::fine::{Fine, at, px};
use super::skeleton::Skeleton;
use super::{COLOURS, Drawn, FONT, save};

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
    let blocks = [
        Block { title: "velocity", force: false, colour: COLOURS[0], drawing },
        Block { title: "force", force: true, colour: COLOURS[1], drawing },
    ];
    let mechanism = drawing.state.mechanism();
    let frame = mechanism.frame_of(drawing.chain.reference);
    let reference = drawing.state.pose(drawing.chain.reference)?.translation;
    let skeleton = Skeleton::new(drawing.state, (frame.link, reference));
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
    let drawing = blocks[0].drawing;
    let planes = drawing.planes;
    let alone = planes.len() == 1;
    let (width, height) = if alone { ALONE } else { ROW };
    let size = skeleton_size(skeleton, reference);
    let room = if alone { ALONE.0 } else { WIDTH } - 40;
    let legends = blocks.each_ref().map(|b| b.legend(size, room));
    let lines = legends.iter().map(|l| l.iter().map(|e| e.lines.len()).sum::<usize>()).max();
    let of_block = |block| {
        let scales = Block::scales(block, size);
        move |plane| Panel {
            block,
            plane,
            skeleton,
            reference,
            scales,
            size: (width, height),
            metre: [0.0; 2],
        }
    };
    // A metre is as long in every panel.
    let metre = blocks
        .iter()
        .flat_map(|block| {
            let of_plane = of_block(block);
            planes.iter().map(move |plane| of_plane(plane).needs())
        })
        .fold([0.0; 2], |[a, b]: [f64; 2], [x, y]| [a.max(x), b.max(y)]);
    let captions = blocks
        .each_ref()
        .map(|b| planes.iter().map(|p| wrap(&b.caption(p), width - 60)).collect::<Vec<_>>());
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
        let count = planes.len();
        let (charts, notes) = (charts.split_evenly((1, count)), notes.split_evenly((1, count)));
        let of_plane = of_block(block);
        for (j, plane) in planes.iter().enumerate() {
            let own = of_plane(plane);
            // Axes of the quantity itself have a scale of their own in every panel.
            let metre = if drawing.in_world() { metre } else { own.needs() };
            let shown = Panel { metre, ..own };
            panel(&charts[j], &shown)?;
            for (k, line) in captions[i][j].iter().enumerate() {
                let y = i32::try_from(k).unwrap_or(0) * LINE as i32 + 2;
                notes[j].draw(&Text::new(line.clone(), at(58, y), (FONT, TEXT)))?;
            }
        }
    }
    if drawing.in_world() {
        mechanism::symbols(&bottom, !skeleton.objects.is_empty())?;
    }
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

fn wrap(text: &str, width: u32) -> Vec<String> {
    crate::output::wrap(text, (f64::from(width) / CHARACTER) as usize)
}
