//! The options of a map.
//!
//! Checked  tests/map/options.rs

use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::sweep::Axis;
use crate::tolerance::MAX_MAGNITUDE;

/// Largest number of cells of a map.
const MAX_CELLS: u64 = 1 << 22;

/// What a map covers. [`Map::of`](super::Map::of) checks all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MapOptions {
    /// One to three components of the platform's pose: `x`, `y` and `z` (m), `roll`, `pitch` and `yaw`
    /// (rad, `R = Rz(yaw) Ry(pitch) Rx(roll)`); in the plane `x`, `y` and `rz`. The last axis changes
    /// fastest.
    pub axes: Vec<Axis>,
    /// Other components with the value that they keep, or `None` where they are free. Components that
    /// are not named keep their value at the start as far as the mechanism has freedoms for them, and
    /// follow otherwise.
    pub held: Vec<(String, Option<f64>)>,
    /// The platform: the reference of a closed chain, otherwise the tool, by default.
    pub end_effector: Option<EndEffector>,
    /// A configuration in the workspace: home by default.
    pub start: Option<Vec<f64>>,
    /// Number of random restarts that look for working modes at the start; others look in other
    /// cells.
    pub starts: usize,
    /// Selects other random restarts.
    pub seed: u64,
    /// Follow the singularity loci and the boundaries of limits as curves, for two axes, or find those of
    /// type II as surfaces, for three.
    pub loci: bool,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            axes: Vec::new(),
            held: Vec::new(),
            end_effector: None,
            start: None,
            starts: 64,
            seed: 0,
            loci: true,
        }
    }
}

impl MapOptions {
    /// The number of cells, after a check of the axes.
    pub(super) fn cells(&self) -> Result<usize> {
        let refuse = |value: String, reason: String| {
            Err(Error::InvalidOption { option: "over", value, reason })
        };
        if !(1..=3).contains(&self.axes.len()) {
            let value = format!("{} axes", self.axes.len());
            return refuse(value, "a map has one, two or three axes".to_owned());
        }
        let mut cells = 1_u64;
        for axis in &self.axes {
            Error::check_within(&axis.name, &[axis.from, axis.to], MAX_MAGNITUDE)?;
            if axis.count == 0 {
                return refuse(axis.name.clone(), "an axis has one value at least".to_owned());
            }
            if axis.count > 1 && axis.from >= axis.to {
                let reason = "the first value must be smaller than the last one".to_owned();
                return refuse(axis.name.clone(), reason);
            }
            cells = cells.saturating_mul(axis.count);
        }
        if cells > MAX_CELLS {
            let reason = format!("a map has at most {MAX_CELLS} cells; take fewer values");
            return refuse(format!("{cells} cells"), reason);
        }
        if self.starts == 0 {
            return Err(Error::InvalidOption {
                option: "starts",
                value: "0".to_owned(),
                reason: "the start itself is the first, so at least 1 is needed".to_owned(),
            });
        }
        Ok(usize::try_from(cells).unwrap_or(usize::MAX))
    }
}
