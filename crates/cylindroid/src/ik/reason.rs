//! The reason why inverse kinematics found no solution, as a value and in words.
//!
//! Checked  tests/it/ik_misses.rs

use std::fmt;

/// The reason why no solution was found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MissReason {
    /// Proof that no solution exists: the target is farther from the first joint than the length of
    /// the chain from there (m).
    OutOfReach {
        /// Distance of the target from the first joint (m).
        distance: f64,
        /// Length of the chain (m).
        length: f64,
    },
    /// Configurations that reach the goals were found, but in all of them bodies are closer than
    /// the gap; the values are those of the returned configuration.
    Collision {
        /// The two links, or a link and an obstacle.
        between: [String; 2],
        /// Their distance (m); negative: penetration depth.
        distance: f64,
    },
    /// A solution exists outside the position limits; within them none was found.
    Limits {
        /// The coordinates whose limits that solution violates.
        joints: Vec<String>,
    },
    /// A solution exists outside half-spaces that tool points must not leave; inside none was found.
    HalfSpaces {
        /// The names of the half-spaces that it leaves.
        names: Vec<String>,
    },
    /// No solution was found, also without limits; this proves nothing.
    NotProven,
}

impl MissReason {
    /// The name: "out of reach", "collision", "half-space", "limits" or "not proven".
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::OutOfReach { .. } => "out of reach",
            Self::Collision { .. } => "collision",
            Self::HalfSpaces { .. } => "half-space",
            Self::Limits { .. } => "limits",
            Self::NotProven => "not proven",
        }
    }
}

impl fmt::Display for MissReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach { distance, length } => write!(
                f,
                "out of reach: the target is {distance:.4} m from the first joint, the chain \
                 {length:.4} m long from there"
            ),
            Self::Collision { between: [a, b], distance } if *distance < 0.0 => write!(
                f,
                "collision: bodies are too close in every solution found; here {a} and {b} \
                 penetrate each other by {:.4} m",
                -distance
            ),
            Self::Collision { between: [a, b], distance } => write!(
                f,
                "collision: bodies are too close in every solution found; here {a} is \
                 {distance:.4} m from {b}"
            ),
            Self::Limits { joints } => write!(
                f,
                "limits: a solution exists outside the position limits of {}, none was found within",
                joints.join(", ")
            ),
            Self::HalfSpaces { names } => write!(
                f,
                "half-space: a solution exists outside {}, none was found inside",
                names.join(", ")
            ),
            Self::NotProven => {
                f.write_str("not proven: none was found, which does not prove that none exists")
            }
        }
    }
}
