//! Loading of models, with the assembly of home where a file closes loops by frames.
//!
//! Formula  home: the assembly nearest to the configuration of the file; if there is none, the
//!          nearest that random restarts find. Steps and restarts are as many as [`MOST_WORK`] allows
//! Why so   the loaders belong to the model and come before kinematics. They take the assembly as
//!          an argument, so that files included by others are assembled too
//! Checked  tests/formats/closures.rs, tests/formats/load.rs

use std::path::Path;

use super::assembly::{Assembly, MAX_STEPS, assemble_within};
use super::assembly_modes::{ModeOptions, assembly_modes};
use super::loop_closure::LoopClosure;
use crate::error::{Error, Result};
use crate::model::{Dimension, JointKind, LoopJoint, Mechanism, formats};

/// The work of assembling home, in products of the decompositions of the Jacobian: rows by columns
/// by the smaller of both for a step. All starts are made up to about 40 constraints on 40
/// coordinates; more take a second or so.
const MOST_WORK: f64 = 1e9;

/// Loads a model: the name of a catalogue model, or the path of a file.
///
/// Loops that a mechanism file closes by frames are assembled: home is the nearest configuration
/// in which all loops are closed. Of an SDF file with several models `world.sdf#arm` is the one named
/// arm; without a name, the first with a joint.
///
/// # Errors
/// A name that is neither, a file that cannot be read or understood, a loop that cannot be closed.
///
/// # Examples
/// ```
/// let robot = cylindroid::load("panda")?;
/// assert_eq!(robot.n(), 7);
/// # Ok::<(), cylindroid::Error>(())
/// ```
pub fn load(name_or_path: &str) -> Result<Mechanism> {
    load_with_parameters(name_or_path, &[])
}

/// Loads a model with these values of parameters, in place of those of its mechanism file.
///
/// # Errors
/// As [`load`]; a model without parameters, an unknown parameter with the nearest names, a value out
/// of its range. [`ParametricModel`](crate::ParametricModel) reads the file once for many values.
pub fn load_with_parameters(name_or_path: &str, parameters: &[(&str, f64)]) -> Result<Mechanism> {
    formats::load::load(name_or_path, parameters, &|mechanism| close_home(&mechanism))
}

/// Loads a model file, by its extension and content.
///
/// # Errors
/// As [`load`].
pub fn load_file(path: &Path) -> Result<Mechanism> {
    formats::load::load_file(path, &[], &|mechanism| close_home(&mechanism))
}

/// Reads the text of a mechanism file. The path is used in errors, and to find the files of
/// `[[robot]]` tables, which are read.
///
/// ```
/// let text = r#"
/// [[joint]]
/// name = "lever"
/// type = "revolute"
/// between = ["ground", "lever"]
/// origin = [0, 0, 0]
/// axis = [0, 0, 1]
/// "#;
/// let lever = cylindroid::load_text(text, "lever.toml".as_ref())?;
/// assert_eq!(lever.n(), 1);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`] with line and column for broken TOML, unknown keys, values of a wrong type, all
/// that the builder refuses, and loops that cannot be closed; the errors of included files.
pub fn load_text(text: &str, path: &Path) -> Result<Mechanism> {
    read_text(text, path, &[])
}

/// [`load_text`] with these values of parameters.
pub(super) fn read_text(text: &str, path: &Path, parameters: &[(&str, f64)]) -> Result<Mechanism> {
    formats::toml::read(text, path, parameters, &|mechanism| close_home(&mechanism))
}

/// The same mechanism with an assembled home, where closures by frames may be open.
fn close_home(mechanism: &Mechanism) -> Result<Mechanism> {
    let jacobian = LoopClosure::of(mechanism, mechanism.home())?.jacobian;
    let (rows, columns) = (jacobian.rows() as f64, jacobian.cols() as f64);
    let steps = (MOST_WORK / (rows * columns * rows.min(columns)).max(1.0)) as usize;
    let first = assemble_within(mechanism, mechanism.home(), &[], steps.min(MAX_STEPS))?;
    if first.closed {
        return Ok(mechanism.with_assembled_home(first.q));
    }
    let usual = ModeOptions::default();
    let options = ModeOptions { starts: (steps / MAX_STEPS).max(1).min(usual.starts), ..usual };
    if options.starts > 1 {
        let found = assembly_modes(mechanism, mechanism.home(), &[], options)?;
        if let Some(nearest) = found.modes.into_iter().next() {
            return Ok(mechanism.with_assembled_home(nearest.assembly.q));
        }
    }
    let mut searched = format!("home and {} random restarts within the limits", options.starts - 1);
    if options.starts < usual.starts {
        searched += &format!(
            " (a mechanism of {columns} coordinates and {rows} constraints is too large for \
             {} steps and {} restarts)",
            MAX_STEPS,
            usual.starts - 1
        );
    }
    Err(refuse(mechanism, &first, &searched)?)
}

/// The closure that is open farthest at the best attempt from home.
fn refuse(mechanism: &Mechanism, first: &Assembly, searched: &str) -> Result<Error> {
    let state = mechanism.state(&first.q)?;
    let gap = |l: &LoopJoint| {
        let on_a = state.link_pose(l.a) * l.link_a_from_joint;
        let on_b = state.link_pose(l.b) * l.link_b_from_joint;
        let (a, b) = (on_a.rotation * l.axis, on_b.rotation * l.axis);
        let angle = match l.kind {
            JointKind::Fixed => on_a.rotation.angle_to(on_b.rotation),
            JointKind::Spherical => 0.0,
            _ => a.cross(b).norm().atan2(a.dot(b)),
        };
        ((on_a.translation - on_b.translation).norm(), angle)
    };
    let by_frames = mechanism.loops().iter().filter(|l| mechanism.unassembled().contains(&l.name));
    let size = |(distance, angle): (f64, f64)| distance / mechanism.reach() + angle;
    let worst = by_frames.map(|l| (l, gap(l))).max_by(|a, b| size(a.1).total_cmp(&size(b.1)));
    let Some((joint, (distance, angle))) = worst else {
        // Only called for mechanisms with closures by frames.
        return Ok(Error::Model {
            model: mechanism.name().to_owned(),
            culprit: String::new(),
            message: "its loops cannot be closed".to_owned(),
        });
    };
    // Three digits are enough to see how far something is open.
    let mut open = format!("{distance:.3} m");
    let turns = match joint.kind {
        JointKind::Fixed => true,
        JointKind::Spherical => false,
        _ => mechanism.dimension() != Dimension::Planar,
    };
    if turns {
        open += &format!(" and {angle:.3} rad");
    }
    let links = mechanism.links();
    let message = format!(
        "closure '{}' cannot be closed: its frames on '{}' and '{}' remain {open} apart, in the \
         best configuration found from {searched}; check the frames, give a start nearer to an \
         assembly (home, or start of a [[robot]]), or widen the limits",
        joint.name, links[joint.a].name, links[joint.b].name
    );
    Ok(Error::Model { model: mechanism.name().to_owned(), culprit: joint.name.clone(), message })
}
