//! Many configurations in one call, on all threads.

use cylindroid::kinematics::KinematicsBatch;
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};

use crate::arguments::{
    end_effector, free, give, handle, handle_mut, reference, sized, slice, slice_mut,
};
use crate::mechanism::cyl_mechanism;
use crate::status::{Failure, cyl_status, guard};

/// Poses, Jacobians and measures of many configurations for one frame.
#[derive(Debug)]
pub struct cyl_batch {
    kinematics: KinematicsBatch,
    measures: ManipulabilityBatch,
    n: usize,
}

/// A batch for a frame, an index or CYL_DEFAULT_FRAME.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_batch_new(
    mechanism: *const cyl_mechanism,
    frame: usize,
    out: *mut *mut cyl_batch,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, out) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("out", out)?) };
        let robot = &mechanism.inner;
        let of = end_effector(robot, frame)?;
        let options = BatchOptions { reference: Some(of.frame), ..BatchOptions::default() };
        let measures = ManipulabilityBatch::new(robot, &options)?;
        give(
            out,
            cyl_batch { kinematics: KinematicsBatch::new(robot, of)?, measures, n: robot.n() },
        );
        Ok(())
    })
}

/// Frees a batch; null is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_batch_free(batch: *mut cyl_batch) {
    // SAFETY: as the header requires.
    unsafe { free(batch) }
}

/// Number of measures of a configuration.
#[unsafe(no_mangle)]
pub extern "C" fn cyl_measure_count() -> usize {
    ManipulabilityBatch::WIDTH
}

/// The place of a measure ("dof", "volume", ...) in those of a configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_measure_index(
    name: *const std::ffi::c_char,
    index: *mut usize,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (name, index) =
            unsafe { (crate::arguments::text("name", name)?, handle_mut("index", index)?) };
        *index = ManipulabilityBatch::column(name).ok_or_else(|| {
            let known = ManipulabilityBatch::COLUMNS.join(", ");
            Failure(cyl_status::CYL_UNKNOWN_NAME, format!("no measure named '{name}': {known}"))
        })?;
        Ok(())
    })
}

/// Poses of N configurations (N x n numbers in `q`): 16 numbers by columns for each in `poses`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_batch_poses(
    batch: *const cyl_batch,
    q: *const f64,
    count: usize,
    poses: *mut f64,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let batch = unsafe { handle("batch", batch) }?;
        // SAFETY: as the header requires.
        let (q, out) = unsafe {
            (
                slice("q", q, sized("q", count, batch.n)?)?,
                slice_mut("poses", poses, sized("poses", count, 16)?)?,
            )
        };
        batch.kinematics.poses_into(q, out)?;
        // The library stores them by rows.
        for pose in out.chunks_exact_mut(16) {
            for r in 0..4 {
                for c in 0..r {
                    pose.swap(4 * r + c, 4 * c + r);
                }
            }
        }
        Ok(())
    })
}

/// Jacobians of N configurations: 6 x n numbers by columns for each. `reference` is a cyl_reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_batch_jacobians(
    batch: *const cyl_batch,
    q: *const f64,
    count: usize,
    reference_number: i32,
    jacobians: *mut f64,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let batch = unsafe { handle("batch", batch) }?;
        let n = batch.n;
        // SAFETY: as the header requires.
        let (q, out) = unsafe {
            (
                slice("q", q, sized("q", count, n)?)?,
                slice_mut("jacobians", jacobians, sized("jacobians", count, 6 * n)?)?,
            )
        };
        batch.kinematics.jacobians_into(q, reference(reference_number)?, out)?;
        // The library stores them by rows.
        let mut columns = vec![0.0; 6 * n];
        for jacobian in out.chunks_exact_mut((6 * n).max(1)) {
            for r in 0..6 {
                for c in 0..n {
                    columns[6 * c + r] = jacobian[n * r + c];
                }
            }
            jacobian.copy_from_slice(&columns);
        }
        Ok(())
    })
}

/// Counts of mobility, distances to singularities and kinematic manipulability of N configurations:
/// cyl_measure_count() numbers for each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_batch_measures(
    batch: *const cyl_batch,
    q: *const f64,
    count: usize,
    measures: *mut f64,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let batch = unsafe { handle("batch", batch) }?;
        let width = ManipulabilityBatch::WIDTH;
        // SAFETY: as the header requires.
        let (q, out) = unsafe {
            (
                slice("q", q, sized("q", count, batch.n)?)?,
                slice_mut("measures", measures, sized("measures", count, width)?)?,
            )
        };
        Ok(batch.measures.analyse_into(q, out)?)
    })
}
