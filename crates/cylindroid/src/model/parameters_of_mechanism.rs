//! The parameters of a mechanism.

use super::mechanism::Mechanism;
use super::parameter::Parameter;

impl Mechanism {
    /// The parameters of its file, with the values that it was built with.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.report().parameters
    }
}
