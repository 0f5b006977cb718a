//! Names of overlays, reports, sessions and opened models.

use cylindroid::{Error, Result};

/// Longest name of a session.
const LONGEST_NAME: usize = 60;

/// The reports.
pub(super) const REPORTS: [&str; 4] = ["info", "mobility", "manipulability", "screws"];

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Overlay {
    Velocity,
    AngularVelocity,
    ActiveForce,
    PassiveForce,
    JointAxes,
    PrincipalScrews,
    Reciprocal,
    Cylindroid,
    LostDirection,
}

impl Overlay {
    pub(super) const ALL: [Self; 9] = [
        Self::Velocity,
        Self::AngularVelocity,
        Self::ActiveForce,
        Self::PassiveForce,
        Self::JointAxes,
        Self::PrincipalScrews,
        Self::Reciprocal,
        Self::Cylindroid,
        Self::LostDirection,
    ];

    pub(super) fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|o| o.name() == name);
        found.ok_or_else(|| Error::unknown("overlay", name, Self::ALL.map(Self::name)))
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity-ellipsoid",
            Self::AngularVelocity => "angular-velocity-ellipsoid",
            Self::ActiveForce => "active-force-ellipsoid",
            Self::PassiveForce => "passive-force-ellipsoid",
            Self::JointAxes => "joint-axes",
            Self::PrincipalScrews => "principal-screws",
            Self::Reciprocal => "reciprocal-system",
            Self::Cylindroid => "cylindroid",
            Self::LostDirection => "lost-direction",
        }
    }

    pub(super) const fn title(self) -> &'static str {
        match self {
            Self::Velocity => "Velocity ellipsoid",
            Self::AngularVelocity => "Angular velocity ellipsoid",
            Self::ActiveForce => "Force ellipsoid, exerted (active)",
            Self::PassiveForce => "Force ellipsoid, resisted (passive)",
            Self::JointAxes => "Joint axes as screws",
            Self::PrincipalScrews => "Principal screws",
            Self::Reciprocal => "Reciprocal system",
            Self::Cylindroid => "Cylindroid of a two-system",
            Self::LostDirection => "Lost direction",
        }
    }

    pub(super) const fn unit(self) -> &'static str {
        match self {
            Self::Velocity => "m/s, for joint velocities of norm 1 (rad/s, m/s)",
            Self::AngularVelocity => "rad/s, for joint velocities of norm 1 (rad/s, m/s)",
            Self::ActiveForce => "N, for joint torques of norm 1 (N m, N)",
            Self::PassiveForce => "N, resisted with joint torques of norm 1 (N m, N)",
            Self::JointAxes | Self::PrincipalScrews | Self::Reciprocal => "pitch in m/rad",
            Self::Cylindroid => "pitch in m/rad, along each axis",
            Self::LostDirection => "m and rad, of norm 1 with lengths relative to the reach",
        }
    }

    pub(super) const fn frame(self) -> &'static str {
        match self {
            Self::Velocity | Self::AngularVelocity | Self::LostDirection => {
                "at the tool point, world axes"
            }
            Self::ActiveForce | Self::PassiveForce => {
                "forces at the tool point without moment, world axes"
            }
            Self::JointAxes | Self::PrincipalScrews | Self::Reciprocal | Self::Cylindroid => {
                "seen from the world"
            }
        }
    }
}

/// True for 1 to 60 letters, digits and characters of `-._~`, which name sessions.
pub(super) fn is_plain(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-._~".contains(c);
    (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(is_plain)
}

/// So many random bytes in hexadecimal.
pub(crate) fn random_name<const BYTES: usize>() -> std::result::Result<String, getrandom::Error> {
    let mut bits = [0; BYTES];
    getrandom::fill(&mut bits)?;
    Ok(bits.iter().map(|byte| format!("{byte:02x}")).collect())
}
