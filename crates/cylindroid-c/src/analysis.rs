//! Mobility of a configuration, and inverses of matrices.

use std::ffi::c_char;

use cylindroid::closure::{ClosedChain, Mobility};
use cylindroid::inverse::{Weights, hyperbolic, weighted};
use cylindroid::{Matrix, Method};

use crate::arguments::{handle, handle_mut, sized, slice, slice_mut, text};
use crate::mechanism::cyl_mechanism;
use crate::status::{cyl_status, guard, null};

/// The counts of a configuration.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cyl_mobility {
    /// Degrees of freedom to first order.
    pub dof: usize,
    /// Motions of drives without motion of the reference.
    pub redundancy: usize,
    /// Motions of the reference that the drives do not determine.
    pub indeterminacy: usize,
    /// Zero-torque wrenches.
    pub zero_torque: usize,
    /// Hyperstatic wrenches.
    pub hyperstatic: usize,
    /// Motions of passive joints alone.
    pub idle: usize,
    /// The count of Gruebler and Kutzbach, which may be negative.
    pub gruebler_kutzbach: i64,
}

/// The mobility at a configuration of n coordinates, at which all loops are closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_mobility_at(
    mechanism: *const cyl_mechanism,
    q: *const f64,
    n: usize,
    out: *mut cyl_mobility,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, q, out) = unsafe {
            (handle("mechanism", mechanism)?, slice("q", q, n)?, handle_mut("out", out)?)
        };
        let state = mechanism.inner.state(q)?;
        let chain = ClosedChain::of(&state, None, None)?;
        let m = Mobility::of(&chain.constraint);
        *out = cyl_mobility {
            dof: m.dof.dimension(),
            redundancy: m.redundancy.dimension(),
            indeterminacy: m.indeterminacy.dimension(),
            zero_torque: m.zero_torque.dimension(),
            hyperstatic: m.hyperstatic.dimension(),
            idle: m.idle.dimension(),
            gruebler_kutzbach: m.gruebler_kutzbach,
        };
        Ok(())
    })
}

/// An inverse of an m x n matrix by columns, by a method of the command line ("truncated", "damped",
/// ...) with its default parameters: n x m numbers by columns in `out`, which may be `matrix`; the rank
/// in `rank`, which may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_inverse(
    matrix: *const f64,
    rows: usize,
    cols: usize,
    method: *const c_char,
    out: *mut f64,
    rank: *mut usize,
) -> cyl_status {
    guard(|| {
        let size = sized("matrix", rows, cols)?;
        // SAFETY: as the header requires.
        let (matrix, method) = unsafe { (slice("matrix", matrix, size)?, text("method", method)?) };
        if out.is_null() && size > 0 {
            return Err(null("out"));
        }
        let j = Matrix::from_fn(rows, cols, |r, c| matrix[rows * c + r]);
        let found = weighted(&j, Method::named(method)?, &Weights::default())?;
        // SAFETY: as the header requires; it may be `matrix`, which is no longer used.
        unsafe { slice_mut("out", out, size) }?.copy_from_slice(found.matrix.as_slice());
        // SAFETY: as the header requires.
        if let Some(rank) = unsafe { rank.as_mut() } {
            *rank = found.rank;
        }
        Ok(())
    })
}

/// The hyperbolic pseudoinverse of a 6 x n matrix of twists (linear rows first) for the pitch h
/// [m/rad]: n x 6 numbers by columns in `out`, which may be `jacobian`, if it exists.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_hyperbolic(
    jacobian: *const f64,
    cols: usize,
    h: f64,
    exists: *mut bool,
    out: *mut f64,
) -> cyl_status {
    guard(|| {
        let size = sized("jacobian", cols, 6)?;
        // SAFETY: as the header requires.
        let (jacobian, exists) =
            unsafe { (slice("jacobian", jacobian, size)?, handle_mut("exists", exists)?) };
        if out.is_null() && size > 0 {
            return Err(null("out"));
        }
        let found = hyperbolic(&Matrix::from_fn(6, cols, |r, c| jacobian[6 * c + r]), h)?;
        *exists = found.exists;
        if found.exists {
            // SAFETY: as the header requires; it may be `jacobian`, which is no longer used.
            unsafe { slice_mut("out", out, size) }?.copy_from_slice(found.matrix.as_slice());
        }
        Ok(())
    })
}
