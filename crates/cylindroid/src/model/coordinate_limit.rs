//! The limit of the coordinates of a mechanism.
//!
//! Why so   a link without a joint has six coordinates, so a small file can exhaust memory: a
//!          coordinate takes up to 400 bytes with its name, its limits and its node
//! Checked  tests/formats/large_models.rs

use super::builder::Builder;
use crate::error::Result;

/// Coordinates of a mechanism, those of mimic joints included.
const MOST_COORDINATES: usize = 120_000;

impl Builder {
    /// Refuses the joint with which there are more coordinates than a mechanism may have.
    pub(super) fn check_coordinates(&self) -> Result<()> {
        let mut count = 0;
        for joint in &self.joints {
            count += joint.kind.dof();
            if count > MOST_COORDINATES {
                let name = &joint.name;
                let message = format!(
                    "with joint '{name}' the mechanism has more than {MOST_COORDINATES} \
                     coordinates, the limit of this library"
                );
                return self.refuse(name, message);
            }
        }
        Ok(())
    }
}
