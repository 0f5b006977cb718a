//! Mechanisms: loading, names, sizes, limits.

use std::ffi::{CString, c_char};
use std::path::Path;

use cylindroid::Mechanism;
use cylindroid::model::formats::{mjcf, sdf, urdf};
use cylindroid::model::{Coordinate, Limits};

use crate::arguments::{frame, free, give, handle, handle_mut, slice_mut, text};
use crate::status::{Failure, cyl_status, guard, null};

/// A robot or mechanism; immutable.
#[derive(Debug)]
pub struct cyl_mechanism {
    pub(crate) inner: Mechanism,
    name: CString,
    coordinates: Vec<CString>,
    frames: Vec<CString>,
}

impl cyl_mechanism {
    fn new(inner: Mechanism) -> Self {
        let c = |name: &str| CString::new(name.replace('\0', "?")).unwrap_or_default();
        Self {
            name: c(inner.name()),
            coordinates: inner.coordinates().iter().map(|x| c(&x.name)).collect(),
            frames: inner.frames().iter().map(|x| c(&x.name)).collect(),
            inner,
        }
    }
}

/// Loads a model: a file (URDF, MJCF, SDF, mechanism file) or a name of the catalogue.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_load(name: *const c_char, out: *mut *mut cyl_mechanism) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (name, out) = unsafe { (text("name", name)?, handle_mut("out", out)?) };
        give(out, cyl_mechanism::new(cylindroid::load(name)?));
        Ok(())
    })
}

/// Loads the text of a model. The path stands for the file: its extension gives the format, and files
/// that the text names are looked for beside it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_load_text(
    model: *const c_char,
    path: *const c_char,
    out: *mut *mut cyl_mechanism,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (model, path, out) =
            unsafe { (text("model", model)?, text("path", path)?, handle_mut("out", out)?) };
        give(out, cyl_mechanism::new(parse(model, path.as_ref())?));
        Ok(())
    })
}

/// By the extension; other files than those of robots are mechanism files.
fn parse(text: &str, path: &Path) -> cylindroid::Result<Mechanism> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("urdf") => urdf::parse(text, path),
        Some("sdf") => sdf::parse(text, path),
        Some("xml" | "mjcf") => mjcf::parse(text, path),
        _ => cylindroid::load_text(text, path),
    }
}

/// The mechanism with the drives of these coordinates or loop joints only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_with_actuated(
    mechanism: *const cyl_mechanism,
    names: *const *const c_char,
    count: usize,
    out: *mut *mut cyl_mechanism,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, out) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("out", out)?) };
        if names.is_null() && count > 0 {
            return Err(null("names"));
        }
        let name = |i: usize| {
            // SAFETY: not null and of this size.
            unsafe { text("a name", *names.add(i)) }
        };
        let names = (0..count).map(name).collect::<Result<Vec<_>, Failure>>()?;
        give(out, cyl_mechanism::new(mechanism.inner.with_actuated(&names)?));
        Ok(())
    })
}

/// Frees a mechanism; null is nothing. States, solvers and servos made of it stay valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_mechanism_free(mechanism: *mut cyl_mechanism) {
    // SAFETY: as the header requires.
    unsafe { free(mechanism) }
}

/// The name of a mechanism, valid as long as the mechanism; null for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_name(mechanism: *const cyl_mechanism) -> *const c_char {
    // SAFETY: as the header requires.
    unsafe { mechanism.as_ref() }.map_or(std::ptr::null(), |m| m.name.as_ptr())
}

/// Number of coordinates n; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_n(mechanism: *const cyl_mechanism) -> usize {
    // SAFETY: as the header requires.
    unsafe { mechanism.as_ref() }.map_or(0, |m| m.inner.n())
}

/// Number of actuated coordinates, for `cyl_servo_step_actuated`; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_actuated_count(mechanism: *const cyl_mechanism) -> usize {
    // SAFETY: as the header requires.
    unsafe { mechanism.as_ref() }.map_or(0, |m| m.inner.actuated().count())
}

/// Index in q of the i-th actuated coordinate; SIZE_MAX if there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_actuated_index(mechanism: *const cyl_mechanism, i: usize) -> usize {
    // SAFETY: as the header requires.
    let mechanism = unsafe { mechanism.as_ref() };
    mechanism.and_then(|m| m.inner.actuated().nth(i)).unwrap_or(usize::MAX)
}

/// The name of coordinate i, valid as long as the mechanism; null beyond the last.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_coordinate_name(
    mechanism: *const cyl_mechanism,
    i: usize,
) -> *const c_char {
    // SAFETY: as the header requires.
    let names = unsafe { mechanism.as_ref() }.map(|m| &m.coordinates);
    names.and_then(|names| names.get(i)).map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Number of frames; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_frame_count(mechanism: *const cyl_mechanism) -> usize {
    // SAFETY: as the header requires.
    unsafe { mechanism.as_ref() }.map_or(0, |m| m.frames.len())
}

/// The name of a frame, valid as long as the mechanism; null for an index that does not exist.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_frame_name(
    mechanism: *const cyl_mechanism,
    index: usize,
) -> *const c_char {
    // SAFETY: as the header requires.
    let Some(mechanism) = (unsafe { mechanism.as_ref() }) else { return std::ptr::null() };
    let Ok(id) = frame(&mechanism.inner, index) else { return std::ptr::null() };
    let place = mechanism.inner.frame_ids().position(|other| other == id);
    place.and_then(|i| mechanism.frames.get(i)).map_or(std::ptr::null(), |name| name.as_ptr())
}

/// The index of the frame of this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_frame(
    mechanism: *const cyl_mechanism,
    name: *const c_char,
    index: *mut usize,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, name, index) = unsafe {
            (handle("mechanism", mechanism)?, text("name", name)?, handle_mut("index", index)?)
        };
        let id = mechanism.inner.frame(name)?;
        let place = mechanism.inner.frame_ids().position(|other| other == id);
        *index = place.ok_or_else(|| null("frame"))?;
        Ok(())
    })
}

/// The home configuration, n numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_home(mechanism: *const cyl_mechanism, q: *mut f64) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let mechanism = unsafe { handle("mechanism", mechanism) }?;
        let home = mechanism.inner.home();
        // SAFETY: n numbers, as the header says.
        unsafe { slice_mut("q", q, home.len()) }?.copy_from_slice(home);
        Ok(())
    })
}

/// Limits of coordinates: position, velocity, acceleration, jerk, effort. Infinite if unknown.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cyl_limits {
    /// Smallest position [rad or m].
    pub lower: f64,
    /// Largest position [rad or m].
    pub upper: f64,
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
    /// Largest acceleration [rad/s^2 or m/s^2].
    pub acceleration: f64,
    /// Largest jerk [rad/s^3 or m/s^3].
    pub jerk: f64,
    /// Largest torque or force [N m or N].
    pub effort: f64,
}

/// The limits of coordinate i.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_coordinate_limits(
    mechanism: *const cyl_mechanism,
    i: usize,
    out: *mut cyl_limits,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, out) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("out", out)?) };
        let coordinates: &[Coordinate] = mechanism.inner.coordinates();
        let Some(coordinate) = coordinates.get(i) else {
            let text = format!("coordinate {i} does not exist: there are {}", coordinates.len());
            return Err(Failure(cyl_status::CYL_DIMENSION, text));
        };
        let Limits { lower, upper, velocity, acceleration, jerk, effort } = coordinate.limits;
        *out = cyl_limits { lower, upper, velocity, acceleration, jerk, effort };
        Ok(())
    })
}
