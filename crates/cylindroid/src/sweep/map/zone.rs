//! Singularity-free zones as options and results: the largest ball or box around a configuration that
//! a mode fills without a singularity, in components of the platform's pose or in coordinates of
//! joints.
//!
//! Method   rays from the centre (zone_rays.rs) end at the first singularity or limit, or at the
//!          smallest distance known; from each singular end the nearest point of its locus is found by
//!          descent (nearest_singularity.rs) and kept if the way from the centre to it meets nothing
//!          before. The smallest distance is the size. Rays that pass near a singularity lead to it
//!          too: that of a wrist has a smaller dimension in the space of the tool, where no ray meets it
//! Units    e_i = (component - centre) / scale; the size is in multiples of the scales
//! Valid    mechanisms in which the components leave no motion free, and whose singularities are
//!          surfaces: with redundant joints they are not. The bounds are singular to rounding, or at a
//!          limit, so no ball or box is larger; where Newton's method does not get there, a ray ends
//!          before the singularity. That nothing is nearer is checked along rays alone
//! Source   Li, Gosselin & Richard 2007; Jiang & Gosselin 2009 (maximal singularity-free zones of
//!          Gough-Stewart platforms, there by the determinant in closed form)
//! Checked  tests/map/zone.rs

use super::result::LocusKind;
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;

/// The shape of a zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ZoneShape {
    /// The Euclidean norm of the components over their scales.
    #[default]
    Ball,
    /// The largest of them: a box with sides along the components.
    Box,
}

impl ZoneShape {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Ball, Self::Box];

    /// The shape of this name.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|shape| shape.name() == name);
        found.ok_or_else(|| Error::unknown("shape", name, Self::ALL.map(Self::name)))
    }

    /// Its name: "ball" or "box".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Box => "box",
        }
    }
}

/// A zone that is sought. [`Zone::of`] checks all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoneOptions {
    /// Components of the platform's pose, as in [`axes`](crate::sweep::MapOptions::axes) of maps, or
    /// actuated coordinates of joints (then all others of these keep their value): those of one kind.
    pub components: Vec<String>,
    /// The lengths of the axes of the ball, or half the sides of the box, for a size of 1 (m or rad).
    /// Empty: 1 where all components are lengths or all are angles, otherwise the characteristic length
    /// and 1.
    pub scales: Vec<f64>,
    /// Ball or box.
    pub shape: ZoneShape,
    /// Values of components of the pose, or `None` where one is free. Those of the zone are its centre;
    /// the others as in [`held`](crate::sweep::MapOptions::held) of maps.
    pub held: Vec<(String, Option<f64>)>,
    /// The platform: the reference of a closed chain, otherwise the tool, by default.
    pub end_effector: Option<EndEffector>,
    /// The configuration in the centre: home by default. Values of `held` change it.
    pub start: Option<Vec<f64>>,
    /// Position limits are bounds too; otherwise they are ignored.
    pub limits: bool,
    /// Number of rays beside those along the components. Of one component those are all.
    pub rays: usize,
    /// Selects other rays.
    pub seed: u64,
}

impl Default for ZoneOptions {
    fn default() -> Self {
        Self {
            components: Vec::new(),
            scales: Vec::new(),
            shape: ZoneShape::Ball,
            held: Vec::new(),
            end_effector: None,
            start: None,
            limits: true,
            rays: 256,
            seed: 0,
        }
    }
}

/// A component of a zone.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoneComponent {
    /// Its name.
    pub name: String,
    /// "m" or "rad".
    pub unit: &'static str,
    /// Its value in the centre.
    pub centre: f64,
    /// Its scale.
    pub scale: f64,
}

/// A singularity or limit, nearest to the centre among its neighbours.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoneBound {
    /// What happens there.
    pub kind: LocusKind,
    /// The coordinate at its limit.
    pub limit: Option<String>,
    /// Its distance from the centre, in multiples of the scales.
    pub distance: f64,
    /// The components there (m or rad).
    pub point: Vec<f64>,
    /// The configuration there (m or rad).
    pub q: Vec<f64>,
}

/// A ball or box without singularities.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    /// The components, with centre and scales.
    pub components: Vec<ZoneComponent>,
    /// Ball or box.
    pub shape: ZoneShape,
    /// Components of the pose that keep a value (m or rad).
    pub held: Vec<(String, f64)>,
    /// Radius of the ball or half the side of the box in multiples of the scales.
    pub size: f64,
    /// What bounds it: local minima of the distance, the nearest first; empty if nothing was met up to
    /// half a turn or four characteristic lengths.
    pub bounds: Vec<ZoneBound>,
    /// Number of rays of the length of the size that met nothing before.
    pub confirmed: usize,
    /// Number of those on each step of which the Jacobians change by less than their smallest singular
    /// values: none vanishes if they change linearly within a step.
    pub certified: usize,
    /// The configuration in the centre (m or rad).
    pub q: Vec<f64>,
}
