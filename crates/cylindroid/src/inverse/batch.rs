//! Inverses of many Jacobians in one call (batched pseudoinverses).
//!
//! Formula  that of the single inverses, to the bit; of truncated ones to rounding
//! Shapes   J: N x m x n, inverses: N x n x m, singular values: N x min(m, n); all row-major
//! Units    those of the Jacobians
//! Valid    as the method; selectively damped least squares for unit motions along every direction
//! Why so   arrays of numbers, without the truncated directions: a report for each of many would
//!          allocate for each of its parts. Truncated inverses of regular Jacobians, most of what is
//!          asked for, are batched ([`truncated_batched`](super::truncated_batched))
//! Checked  tests/it/inverse_batch.rs

use super::Method;
use super::report::rank;
use super::truncated_batched::{Kernel, Work};
use crate::error::{Error, Result, all_finite};
use crate::linalg::{Matrix, Rank, Svd, run_all};

/// Inverts many Jacobians of one shape in one call.
///
/// Calls with more than [`InverseBatch::CHUNK`] of them use the threads of rayon
/// (`RAYON_NUM_THREADS`, or
/// `ThreadPool::install` around the call); results do not depend on how many there are. Each inverse
/// is that of [`Method::inverse`]: of [`Method::Truncated`] to rounding, of the other methods to the
/// bit.
///
/// ```
/// use cylindroid::inverse::InverseBatch;
/// use cylindroid::{Method, ReferenceFrame, kinematics};
///
/// let robot = cylindroid::load("panda")?;
/// let q = [robot.home(), robot.home()].concat();
/// let jacobians = kinematics::KinematicsBatch::new(&robot, robot.tool())?
///     .jacobians(&q, ReferenceFrame::Local)?;
/// let inverses = InverseBatch::new(Method::default(), 6, robot.n())?.inverses(&jacobians)?;
/// assert_eq!(inverses.matrices.len(), 2 * robot.n() * 6);
/// assert!(inverses.ranks.iter().all(|r| r.rank == 6));
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseBatch {
    method: Method,
    rows: usize,
    cols: usize,
}

/// Inverses with their singular values and ranks; see [`Inverse`](super::Inverse) for a full
/// report.
#[derive(Debug, Clone, PartialEq)]
pub struct Inverses {
    /// The inverses, N x n x m row-major: joint velocities = matrix * task.
    pub matrices: Vec<f64>,
    /// The singular values of the Jacobians, N x min(m, n), largest first.
    pub singular_values: Vec<f64>,
    /// For each the number of directions of which at least one half is realised, with threshold
    /// and gap as in [`Inverse`](super::Inverse).
    pub ranks: Vec<Rank>,
}

impl InverseBatch {
    /// Jacobians in one task of the thread pool, some tenths of a millisecond of work: smaller
    /// calls run on the thread of the caller.
    pub const CHUNK: usize = 256;

    /// A batch of Jacobians of `rows` x `cols`.
    ///
    /// # Errors
    /// Parameters outside their domains; Jacobians without entries.
    pub fn new(method: Method, rows: usize, cols: usize) -> Result<Self> {
        method.check()?;
        if rows == 0 || cols == 0 {
            return Err(Error::InvalidOption {
                option: "shape",
                value: format!("{rows} x {cols}"),
                reason: "a Jacobian must have rows and columns".to_owned(),
            });
        }
        Ok(Self { method, rows, cols })
    }

    /// The inverse of each Jacobian.
    ///
    /// # Errors
    /// A slice that is not a whole number of Jacobians; a non-finite entry.
    pub fn inverses(&self, jacobians: &[f64]) -> Result<Inverses> {
        let (each, values) = (self.rows * self.cols, self.rows.min(self.cols));
        let count = jacobians.len() / each;
        if count * each != jacobians.len() {
            return Err(Error::rows(
                "J",
                jacobians.len().next_multiple_of(each),
                jacobians.len(),
                each,
            ));
        }
        if !all_finite(jacobians)
            && let Some(i) = jacobians.iter().position(|x| !x.is_finite())
        {
            let (row, column) = (i % each / self.cols, i % self.cols);
            return Err(Error::NotFinite {
                what: format!("entry ({row}, {column}) of J[{}]", i / each),
                value: jacobians[i],
            });
        }
        let mut inverses = Inverses {
            matrices: vec![0.0; jacobians.len()],
            singular_values: vec![0.0; count * values],
            ranks: vec![Rank { rank: 0, threshold: 0.0, gap: 0.0 }; count],
        };
        let Inverses { matrices, singular_values, ranks } = &mut inverses;
        if count <= Self::CHUNK {
            self.chunk(jacobians, matrices, singular_values, ranks);
        } else {
            let jobs = jacobians
                .chunks(Self::CHUNK * each)
                .zip(matrices.chunks_mut(Self::CHUNK * each))
                .zip(singular_values.chunks_mut(Self::CHUNK * values))
                .zip(ranks.chunks_mut(Self::CHUNK));
            run_all(jobs.collect(), |(((j, m), s), r)| self.chunk(j, m, s, r));
        }
        Ok(inverses)
    }

    /// On one thread.
    fn chunk(
        &self,
        jacobians: &[f64],
        matrices: &mut [f64],
        values: &mut [f64],
        ranks: &mut [Rank],
    ) {
        let (m, n) = (self.rows, self.cols);
        let mut svd = Svd::workspace(m, n);
        let mut gains = vec![0.0; svd.len()];
        let mut j = Matrix::zeros(m, n);
        let mut done = vec![false; ranks.len()];
        if let Method::Truncated { eps } = self.method {
            let work = Work { jacobians, matrices, values, ranks };
            Kernel::new(m, n, eps).run(work, &mut done);
        }
        let all = jacobians.chunks_exact(m * n).zip(matrices.chunks_exact_mut(m * n));
        let reports = values.chunks_exact_mut(svd.len()).zip(ranks).zip(done);
        for ((from, to), ((values, report), done)) in all.zip(reports) {
            if done {
                continue;
            }
            to.fill(0.0);
            for (i, row) in from.chunks_exact(n).enumerate() {
                row.iter().enumerate().for_each(|(k, x)| j[(i, k)] = *x);
            }
            svd.decompose(&j);
            let threshold = self.method.gains(&svd, &[], &mut gains);
            *report = rank(&svd, &gains, threshold);
            for (i, (gain, value)) in gains.iter().zip(values).enumerate() {
                *value = svd.value(i);
                for (row, v) in to.chunks_exact_mut(m).zip(svd.v(i)) {
                    row.iter_mut().zip(svd.u(i)).for_each(|(x, u)| *x += gain * u * v);
                }
            }
        }
    }
}
