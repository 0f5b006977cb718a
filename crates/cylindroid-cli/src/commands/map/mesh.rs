//! The surfaces of a map as an OBJ file: vertices are values of the axes, a group for each mode.

use std::fmt::Write;
use std::path::Path;

use cylindroid::sweep::{Axis, Map};
use cylindroid::{Error, Mechanism, Result};

use crate::output_file;

fn refused(path: &Path, reason: String) -> Error {
    Error::InvalidOption { option: "--mesh", value: path.display().to_string(), reason }
}

/// Rejects axes without surfaces and names that do not end in .obj.
pub(super) fn check(path: &Path, axes: &[Axis]) -> Result<()> {
    if axes.len() != 3 {
        let reason = format!("a map of three axes has surfaces, this one has {}", axes.len());
        return Err(refused(path, reason + "; name --over three times"));
    }
    if let Some(axis) = axes.iter().find(|axis| axis.count < 2) {
        let reason = format!("axis '{}' has one value; give it two at least", axis.name);
        return Err(refused(path, reason));
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
        return Ok(());
    }
    Err(refused(path, "the name must end in .obj".to_owned()))
}

/// Rejects maps in which nothing has a sign whose changes were the surfaces.
pub(super) fn check_map(map: &Map, path: &Path) -> Result<()> {
    if map.free_motions > 0 {
        let reason = format!(
            "the platform has {} free motions, with which there are no surfaces; hold components with \
             --at",
            map.free_motions
        );
        return Err(refused(path, reason));
    }
    if !map.signed[1] {
        let reason = "the distance to singularities of type II has no sign here, whose changes are the \
                      surfaces";
        return Err(refused(path, reason.to_owned()));
    }
    Ok(())
}

/// Writes the file.
pub(super) fn write(robot: &Mechanism, map: &Map, path: &Path) -> Result<()> {
    output_file::write(path, text(robot, map)).map_err(|error| Error::Io {
        path: path.to_owned(),
        action: "write",
        message: error.to_string(),
    })
}

fn text(robot: &Mechanism, map: &Map) -> String {
    let axes: Vec<String> =
        map.axes.iter().map(|a| format!("{} [{}]", a.name, Map::unit(&a.name))).collect();
    let held = map.held.iter().map(|(name, x)| format!("\n# {name} = {x} {}", Map::unit(name)));
    let mut text = format!(
        "# cylindroid {}\n# singularities of type II of {}\n# v {}{}\n",
        env!("CARGO_PKG_VERSION"),
        // In one line whatever the name.
        robot.name().split_whitespace().collect::<Vec<_>>().join(" "),
        axes.join(", "),
        held.collect::<String>()
    );
    let mut first = 1; // numbers of vertices begin with 1
    for mode in 0..map.modes.len() {
        let mut own = map.surfaces.iter().filter(|surface| surface.mode == mode).peekable();
        if own.peek().is_some() {
            // Writing into text cannot fail.
            let _ = writeln!(text, "g mode_{}", mode + 1);
        }
        for surface in own {
            let ends = if surface.closed { "closed" } else { "open" };
            let _ = writeln!(text, "# {}, {ends}", surface.kind.name());
            for [x, y, z] in &surface.vertices {
                let _ = writeln!(text, "v {x} {y} {z}");
            }
            for [a, b, c] in surface.triangles.iter().map(|t| t.map(|v| v + first)) {
                let _ = writeln!(text, "f {a} {b} {c}");
            }
            first += surface.vertices.len();
        }
    }
    text
}
