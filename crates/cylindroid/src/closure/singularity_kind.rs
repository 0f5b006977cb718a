//! The kinds of singularity of a closed chain (type I, II, III and others), and their names.
//!
//! Source   Gosselin & Angeles 1990 (types I, II, III); Park & Kim 1999 and Zlatanov et al. 1995
//!          (configuration space, passive)
//! Checked  tests/it/closure/singularity.rs

use std::fmt;

/// The kinds of singularity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum SingularityKind {
    /// Type I (serial, end-effector singularity): the object loses a motion.
    TypeI,
    /// Type II (parallel, actuator singularity): the object gains a motion that the actuated joints
    /// do not control.
    TypeII,
    /// Type III: both types I and II.
    TypeIII,
    /// The constraint loses rank: the mechanism gains a degree of freedom.
    ConfigurationSpace,
    /// Passive joints gain a motion of their own.
    Passive,
}

impl SingularityKind {
    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TypeI => "type-i",
            Self::TypeII => "type-ii",
            Self::TypeIII => "type-iii",
            Self::ConfigurationSpace => "configuration-space",
            Self::Passive => "passive",
        }
    }
}

impl fmt::Display for SingularityKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TypeI => "type I / end-effector (object loses motion)",
            Self::TypeII => "type II / actuator (object gains uncontrolled motion)",
            Self::TypeIII => "type III (object loses one motion and gains another)",
            Self::ConfigurationSpace => "configuration space (the mechanism gains a motion)",
            Self::Passive => "passive (passive joints gain a motion of their own)",
        })
    }
}
