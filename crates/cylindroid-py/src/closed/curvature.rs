//! Curvatures of bodies as arguments.

use cylindroid::Vec3;
use cylindroid::model::SurfaceCurvature;
use pyo3::prelude::*;

/// A curvature: one number for all directions, or two principal curvatures and the direction of the
/// first.
#[derive(Debug, FromPyObject)]
pub(crate) enum Curvature {
    Uniform(f64),
    Principal(([f64; 2], [f64; 3])),
}

impl Curvature {
    pub(crate) fn surface(&self) -> SurfaceCurvature {
        match self {
            Self::Uniform(curvature) => SurfaceCurvature::uniform(*curvature),
            Self::Principal((principal, direction)) => {
                SurfaceCurvature { principal: *principal, direction: Vec3::from_array(*direction) }
            }
        }
    }
}
