//! Pointers of C as slices, texts and poses.
//!
//! Every function here requires of its caller what the header requires of C: a pointer is null or
//! points to as many values as its size says, which nothing else changes during the call.

use std::ffi::{CStr, c_char};

use cylindroid::{EndEffector, FrameId, Mechanism, Pose, ReferenceFrame, Twist, Vec3};

use crate::status::{Failure, cyl_status, null};

/// Stands for the frame that a mechanism has as its tool, or for the reference of a closed chain.
pub const CYL_DEFAULT_FRAME: usize = usize::MAX;

/// The axes and the point of a Jacobian.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum cyl_reference {
    /// Axes and origin of the frame.
    CYL_LOCAL = 0,
    /// World axes, twist at the world's origin.
    CYL_WORLD = 1,
    /// World axes, at the frame's origin.
    CYL_LOCAL_WORLD_ALIGNED = 2,
}

/// The reference of its number: any integer may come from C, so that none is read as the enum.
pub(crate) fn reference(number: i32) -> Result<ReferenceFrame, Failure> {
    Ok(match number {
        0 => ReferenceFrame::Local,
        1 => ReferenceFrame::World,
        2 => ReferenceFrame::LocalWorldAligned,
        _ => {
            let text = format!("no cyl_reference has the number {number}: use 0, 1 or 2");
            return Err(Failure(cyl_status::CYL_INVALID_OPTION, text));
        }
    })
}

/// The size of an array of `count` parts; an error for one that no memory has.
pub(crate) fn sized(what: &str, count: usize, part: usize) -> Result<usize, Failure> {
    let size = count.checked_mul(part).filter(|size| *size <= MOST);
    size.ok_or_else(|| {
        let text = format!("{what} has {count} x {part} entries, more than memory has");
        Failure(cyl_status::CYL_DIMENSION, text)
    })
}

/// The largest number of entries that a slice may have.
const MOST: usize = isize::MAX as usize / size_of::<f64>();

/// # Safety
/// See the module.
pub(crate) unsafe fn slice<'a>(
    what: &str,
    data: *const f64,
    size: usize,
) -> Result<&'a [f64], Failure> {
    if size == 0 {
        return Ok(&[]);
    }
    if data.is_null() {
        return Err(null(what));
    }
    let size = sized(what, size, 1)?;
    // SAFETY: not null, and of this size as the module requires.
    Ok(unsafe { std::slice::from_raw_parts(data, size) })
}

/// # Safety
/// See the module.
pub(crate) unsafe fn slice_mut<'a>(
    what: &str,
    data: *mut f64,
    size: usize,
) -> Result<&'a mut [f64], Failure> {
    if size == 0 {
        return Ok(&mut []);
    }
    if data.is_null() {
        return Err(null(what));
    }
    let size = sized(what, size, 1)?;
    // SAFETY: not null, and of this size as the module requires.
    Ok(unsafe { std::slice::from_raw_parts_mut(data, size) })
}

/// # Safety
/// See the module.
pub(crate) unsafe fn handle<'a, T>(what: &str, pointer: *const T) -> Result<&'a T, Failure> {
    // SAFETY: null or a handle that this library made and that was not freed.
    unsafe { pointer.as_ref() }.ok_or_else(|| null(what))
}

/// # Safety
/// See the module.
pub(crate) unsafe fn handle_mut<'a, T>(what: &str, pointer: *mut T) -> Result<&'a mut T, Failure> {
    // SAFETY: null or a value that the caller alone uses.
    unsafe { pointer.as_mut() }.ok_or_else(|| null(what))
}

/// Frees a handle; null is nothing.
///
/// # Safety
/// See the module.
pub(crate) unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: made by `give` and freed once.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// Gives a handle to C.
pub(crate) fn give<T>(out: &mut *mut T, value: T) {
    *out = Box::into_raw(Box::new(value));
}

/// # Safety
/// See the module.
pub(crate) unsafe fn text<'a>(what: &str, pointer: *const c_char) -> Result<&'a str, Failure> {
    if pointer.is_null() {
        return Err(null(what));
    }
    // SAFETY: not null, and ends with a zero as C's texts do.
    let text = unsafe { CStr::from_ptr(pointer) }.to_str();
    text.map_err(|_| Failure(cyl_status::CYL_NULL_OR_TEXT, format!("{what} is not UTF-8")))
}

/// # Safety
/// See the module.
pub(crate) unsafe fn pose(what: &str, matrix: *const f64) -> Result<Pose, Failure> {
    // SAFETY: sixteen numbers, as the header says.
    let m = unsafe { slice(what, matrix, 16) }?;
    let row = |r: usize| [m[r], m[4 + r], m[8 + r], m[12 + r]];
    Ok(Pose::from_matrix([row(0), row(1), row(2), row(3)])?)
}

/// Writes a pose by columns.
pub(crate) fn write_pose(pose: Pose, out: &mut [f64]) {
    for (r, row) in pose.to_matrix().into_iter().enumerate() {
        for (c, x) in row.into_iter().enumerate() {
            out[4 * c + r] = x;
        }
    }
}

/// # Safety
/// See the module. Null is zero.
pub(crate) unsafe fn twist(what: &str, data: *const f64) -> Result<Option<Twist>, Failure> {
    if data.is_null() {
        return Ok(None);
    }
    // SAFETY: six numbers, as the header says.
    let [x, y, z, a, b, c] = *unsafe { slice(what, data, 6) }? else {
        return Err(null(what));
    };
    Ok(Some(Twist { linear: Vec3::new(x, y, z), angular: Vec3::new(a, b, c) }))
}

/// The frame of an index.
pub(crate) fn frame(mechanism: &Mechanism, index: usize) -> Result<FrameId, Failure> {
    if index == CYL_DEFAULT_FRAME {
        let closed = mechanism.is_closed();
        return Ok(if closed { mechanism.reference() } else { mechanism.tool() });
    }
    mechanism.frame_ids().nth(index).ok_or_else(|| {
        let count = mechanism.frames().len();
        let text = format!("frame {index} does not exist: '{}' has {count}", mechanism.name());
        Failure(cyl_status::CYL_UNKNOWN_NAME, text)
    })
}

pub(crate) fn end_effector(mechanism: &Mechanism, index: usize) -> Result<EndEffector, Failure> {
    frame(mechanism, index).map(EndEffector::from)
}
