//! The motion of several tasks: joints, errors, realised velocities and the nearest distance over time.

use std::path::Path;

use cylindroid::Result;
use plotters::prelude::*;

use super::fine::{Fine, px};
use super::{COLOURS, Drawn, Line, SMALLEST_ERROR, linear_panel, log_panel, save, thinned, titled};
use crate::task_trajectory::{TaskRow, TaskTrajectory};

const WIDTH: u32 = px(960);
const PANEL: u32 = px(290);
const TITLE: u32 = px(30);

/// Draws a motion with several tasks.
pub(crate) fn draw(trajectory: &TaskTrajectory, path: &Path) -> Result<()> {
    save(path, |svg| panels(trajectory, svg))
}

fn panels(trajectory: &TaskTrajectory, svg: &mut String) -> Drawn {
    let count = if trajectory.avoids { 4 } else { 3 };
    let size = (WIDTH, TITLE + PANEL * u32::try_from(count)?);
    let root = Fine::new(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!("{}: motion of {}", trajectory.model, trajectory.tasks.join(", "));
    let root = titled(&root, &title, 20)?;
    let areas = root.split_evenly((count, 1));
    let rows = thinned(&trajectory.samples);
    let end = rows.last().map_or(1.0, |row| row.time);
    let time = 0.0..if end > 0.0 { end } else { 1.0 };
    let line = |name: String, i: usize, value: &dyn Fn(&TaskRow) -> Option<f64>| Line {
        name,
        colour: COLOURS[i % COLOURS.len()],
        points: rows.iter().filter_map(|row| Some((row.time, value(row)?))).collect(),
    };

    let joints = trajectory.joint_names.iter().enumerate();
    let joints: Vec<Line> =
        joints.map(|(i, name)| line(name.clone(), i, &|row| Some(row.q[i]))).collect();
    let mut units = trajectory.units.clone();
    units.sort_unstable();
    units.dedup();
    linear_panel(&areas[0], &joints, &time, &format!("joints [{}]", units.join(", ")))?;

    // Tasks have lengths, angles or both.
    let mut errors = Vec::new();
    for (i, name) in trajectory.tasks.iter().enumerate() {
        if rows.iter().any(|row| row.tasks[i].position_error > 0.0) {
            let value = |row: &TaskRow| Some(row.tasks[i].position_error.max(SMALLEST_ERROR));
            errors.push(line(format!("{name} [m]"), errors.len(), &value));
        }
        if rows.iter().any(|row| row.tasks[i].orientation_error > 0.0) {
            let value = |row: &TaskRow| Some(row.tasks[i].orientation_error.max(SMALLEST_ERROR));
            errors.push(line(format!("{name} [rad]"), errors.len(), &value));
        }
    }
    log_panel(&areas[1], &errors, &time, "error [m, rad]")?;

    let names = trajectory.tasks.iter().enumerate().filter(|(i, _)| trajectory.are_scaled[*i]);
    let scales: Vec<Line> =
        names.map(|(i, name)| line(name.clone(), i, &|row| Some(row.tasks[i].scale))).collect();
    linear_panel(&areas[2], &scales, &time, "realised velocity [-]")?;

    if trajectory.avoids {
        let nearest = [line("nearest bodies".to_owned(), 0, &|row| row.nearest)];
        linear_panel(&areas[3], &nearest, &time, "distance [m]")?;
    }
    root.present()?;
    drop((areas, root));
    Ok(())
}
