//! Forward kinematics and Jacobians of one end effector at many configurations (batched).
//!
//! Formula  serial.rs, with several configurations at once
//! Shapes   q: N x n, poses: N x 4 x 4, Jacobians: N x 6 x n; row-major, n of the mechanism
//! Units    rad, m; m/s and rad/s for each unit of joint velocity
//! Frame    [`ReferenceFrame`]
//! Why so   the chain is traversed once for four or eight configurations, with a register for each
//!          number (structure of arrays); configurations are transposed on input and output. Every
//!          configuration takes the same path whatever its place and the number of threads, so
//!          results do not depend on them
//! Checked  tests/it/batch.rs

use super::chain::Chain;
use super::jacobian::ReferenceFrame;
use super::serial_batched::{self, Work};
use super::state::EndEffector;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, run_all};
use crate::model::Mechanism;

/// Numbers for each pose.
const POSE: usize = 16;
/// Results beyond this many numbers (32 MiB) exceed most caches.
const LARGE: usize = 4 << 20;

/// The kinematics of one end effector, for many configurations in one call.
///
/// Calls with more than [`KinematicsBatch::CHUNK`] configurations use the threads of rayon
/// (`RAYON_NUM_THREADS`, or `ThreadPool::install` around the call); results do not depend on how
/// many there are. They differ from those of [`Chain`] by rounding: at most 16 units in the last
/// place of 1 m and 1 rad for arms of that size.
///
/// ```
/// use cylindroid::ReferenceFrame;
/// use cylindroid::kinematics::KinematicsBatch;
///
/// let robot = cylindroid::load("panda")?;
/// let batch = KinematicsBatch::new(&robot, robot.tool())?;
/// let q = [robot.home(), robot.home()].concat();
/// let jacobians = batch.jacobians(&q, ReferenceFrame::LocalWorldAligned)?;
/// assert_eq!(jacobians.len(), 2 * 6 * robot.n());
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct KinematicsBatch {
    mechanism: Mechanism,
    chain: Chain,
}

impl KinematicsBatch {
    /// Configurations in one task of the thread pool, some tenths of a millisecond of work: smaller
    /// calls run on the thread of the caller.
    pub const CHUNK: usize = 4096;

    /// For an end effector.
    ///
    /// # Errors
    /// A frame of another mechanism.
    pub fn new(mechanism: &Mechanism, of: impl Into<EndEffector>) -> Result<Self> {
        Ok(Self { mechanism: mechanism.clone(), chain: Chain::new(mechanism, of)? })
    }

    /// Number of coordinates of a configuration: that of the mechanism.
    #[must_use]
    pub fn n(&self) -> usize {
        self.mechanism.n()
    }

    /// `world_from_tool` of each configuration.
    ///
    /// # Errors
    /// A `q` that is not a whole number of configurations, or with a non-finite entry.
    pub fn poses(&self, q: &[f64]) -> Result<Vec<f64>> {
        let mut out = vec![0.0; self.mechanism.count_rows("q", q)? * POSE];
        self.run(q, Some(&mut out), None)?;
        Ok(out)
    }

    /// [`KinematicsBatch::poses`] into `out`.
    ///
    /// # Errors
    /// As there; an `out` of another size.
    pub fn poses_into(&self, q: &[f64], out: &mut [f64]) -> Result<()> {
        self.run(q, Some(out), None)
    }

    /// The Jacobian of each configuration.
    ///
    /// # Errors
    /// As [`KinematicsBatch::poses`].
    pub fn jacobians(&self, q: &[f64], reference: ReferenceFrame) -> Result<Vec<f64>> {
        let mut out = vec![0.0; self.mechanism.count_rows("q", q)? * 6 * self.mechanism.n()];
        self.run(q, None, Some((reference, &mut out)))?;
        Ok(out)
    }

    /// [`KinematicsBatch::jacobians`] into `out`.
    ///
    /// # Errors
    /// As there; an `out` of another size.
    pub fn jacobians_into(
        &self,
        q: &[f64],
        reference: ReferenceFrame,
        out: &mut [f64],
    ) -> Result<()> {
        self.run(q, None, Some((reference, out)))
    }

    /// [`KinematicsBatch::poses_into`] and [`KinematicsBatch::jacobians_into`] in one go, which
    /// costs little more than either.
    ///
    /// # Errors
    /// As there.
    pub fn poses_and_jacobians_into(
        &self,
        q: &[f64],
        reference: ReferenceFrame,
        poses: &mut [f64],
        jacobians: &mut [f64],
    ) -> Result<()> {
        self.run(q, Some(poses), Some((reference, jacobians)))
    }

    fn run(
        &self,
        q: &[f64],
        poses: Option<&mut [f64]>,
        jacobians: Option<(ReferenceFrame, &mut [f64])>,
    ) -> Result<()> {
        let (n, count) = (self.mechanism.n(), self.mechanism.count_rows("q", q)?);
        self.mechanism.check_rows("q", q)?;
        for (what, got, each) in [
            ("poses", poses.as_ref().map(|p| p.len()), POSE),
            ("jacobians", jacobians.as_ref().map(|j| j.1.len()), 6 * n),
        ] {
            if let Some(got) = got.filter(|got| *got != count * each) {
                return Err(Error::rows(what, count * each, got, each));
            }
        }
        let size =
            poses.as_ref().map_or(0, |p| p.len()) + jacobians.as_ref().map_or(0, |(_, j)| j.len());
        let large = size > LARGE;
        if count <= Self::CHUNK {
            if count > 0 {
                self.chunk(q, poses, jacobians, large);
            }
            return Ok(());
        }
        let mut poses = poses.map(|p| p.chunks_mut(Self::CHUNK * POSE));
        let mut jacobians = jacobians.map(|(r, j)| (r, j.chunks_mut(Self::CHUNK * 6 * n)));
        let chunks: Vec<_> = q
            .chunks(Self::CHUNK * n)
            .map(|q| {
                let poses = poses.as_mut().and_then(Iterator::next);
                (q, poses, jacobians.as_mut().and_then(|(r, j)| Some((*r, j.next()?))))
            })
            .collect();
        run_all(chunks, |(q, poses, j)| self.chunk(q, poses, j, large));
        Ok(())
    }

    /// On one thread.
    fn chunk(
        &self,
        q: &[f64],
        poses: Option<&mut [f64]>,
        jacobians: Option<(ReferenceFrame, &mut [f64])>,
        large: bool,
    ) {
        let n = self.mechanism.n();
        if let Some(serial) = self.chain.serial() {
            let coordinates = self.chain.coordinates();
            return serial_batched::run(Work {
                serial,
                coordinates,
                n,
                q,
                poses,
                jacobians,
                large,
            });
        }
        // One after the other.
        let mut chain = self.chain.clone();
        let (mut poses, mut jacobians) = (poses, jacobians);
        let mut local = Matrix::zeros(6, chain.n());
        for (i, q) in q.chunks(n).enumerate() {
            let pose = chain.set(q);
            if let Some(poses) = &mut poses {
                let rows = pose.to_matrix();
                poses[i * POSE..(i + 1) * POSE].copy_from_slice(rows.as_flattened());
            }
            if let Some((reference, out)) = &mut jacobians {
                chain.jacobian_into(*reference, &mut local);
                let out = &mut out[i * 6 * n..(i + 1) * 6 * n];
                out.fill(0.0);
                for (k, &c) in chain.coordinates().iter().enumerate() {
                    for (row, x) in local.column(k).iter().enumerate() {
                        out[row * n + c] = *x;
                    }
                }
            }
        }
    }
}
