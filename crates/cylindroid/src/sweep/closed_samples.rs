//! Samples of a closed chain: actuated coordinates within their limits, the others on the branch of
//! home.
//!
//! Formula  sample i of the actuated coordinates: lower + x (upper - lower), x the point i of sobol.rs;
//!          the others are those at the end of the path from home on which the actuated ones move
//!          straight
//! Units    rad, m
//! Valid    chains whose actuated joints are in the tree, and not more than they have freedoms. A sample that its path does not reach, since
//!          a singularity, a limit or open loops end it, has no configuration
//! Why so   with loops closed from a guess alone, neighbouring samples would belong to different
//!          assembly modes
//! Checked  tests/sweep/closed_samples.rs

use std::ops::Range;

use super::sobol::Sobol;
use crate::closure::{ClosedChain, ContinuationOptions, MotionSpace, PathEnd, track_path};
use crate::error::{Error, Result};
use crate::model::Mechanism;

/// The samples of a closed chain.
#[derive(Debug, Clone)]
pub(super) struct ClosedSamples {
    mechanism: Mechanism,
    actuated: Vec<usize>,
    sobol: Sobol,
    ranges: Vec<[f64; 2]>,
}

impl ClosedSamples {
    /// `range` is that of a coordinate within its limits.
    pub(super) fn new(
        mechanism: &Mechanism,
        seed: u64,
        range: impl Fn(usize) -> Result<[f64; 2]>,
    ) -> Result<Self> {
        let refuse = |reason: String| {
            let value = mechanism.name().to_owned();
            Err(Error::InvalidOption { option: "samples", value, reason })
        };
        if let Some(joint) = mechanism.loops().iter().find(|joint| joint.actuated) {
            return refuse(format!(
                "the actuated joint '{}' closes a loop and has no coordinate; give closed \
                 configurations (`assemble`) as a file or array",
                joint.name
            ));
        }
        let actuated: Vec<usize> = mechanism.actuated().collect();
        if actuated.is_empty() || actuated.len() > Sobol::DIMENSIONS {
            let reason = format!(
                "samples are those of actuated joints, of which it has {}; 1 to {} are possible",
                actuated.len(),
                Sobol::DIMENSIONS
            );
            return refuse(reason);
        }
        let chain = ClosedChain::of(&mechanism.state(mechanism.home())?, None, None)?;
        let dof = MotionSpace::of(&chain.constraint).dof();
        if actuated.len() > dof {
            return refuse(format!(
                "its loops couple the {} actuated joints, which have {dof} freedoms, so they cannot be \
                 sampled one by one; give closed configurations (`assemble`) as a file or array",
                actuated.len()
            ));
        }
        let ranges = actuated.iter().map(|&c| range(c)).collect::<Result<_>>()?;
        let sobol = Sobol::new(actuated.len(), seed);
        Ok(Self { mechanism: mechanism.clone(), actuated, sobol, ranges })
    }

    /// Those of `rows` into `out`; rows without a configuration have home, and are returned.
    pub(super) fn write(&self, rows: Range<u64>, out: &mut [f64]) -> Vec<usize> {
        let (n, width) = (self.mechanism.n(), self.actuated.len());
        let mut points = vec![0.0; out.len() / n * width];
        self.sobol.write(u32::try_from(rows.start).unwrap_or(u32::MAX), &mut points);
        let mut absent = Vec::new();
        for (row, (q, x)) in out.chunks_exact_mut(n).zip(points.chunks_exact_mut(width)).enumerate()
        {
            for (x, [lower, upper]) in x.iter_mut().zip(&self.ranges) {
                *x = lower + *x * (upper - lower);
            }
            let home = self.mechanism.home();
            let options = ContinuationOptions::default();
            match track_path(&self.mechanism, home, &self.actuated, x, options) {
                Ok(found) if found.end == PathEnd::Reached => q.copy_from_slice(&found.q),
                _ => {
                    q.copy_from_slice(home);
                    absent.push(row);
                }
            }
        }
        absent
    }
}
