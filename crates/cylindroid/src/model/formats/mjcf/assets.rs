//! Assets of MJCF: colours and meshes, referenced by geoms by name.

use std::collections::BTreeMap;

use super::mesh_inertia::{MeshInertia, Solid};
use crate::model::formats::mesh::Packages;
use crate::spatial::Vec3;

/// Assets of geoms, by name.
#[derive(Default)]
pub(super) struct Assets<'d> {
    pub(super) colours: BTreeMap<&'d str, [f64; 4]>,
    pub(super) meshes: BTreeMap<String, Mesh>,
    pub(super) packages: Option<Packages>,
}

/// A mesh of a file.
pub(super) struct Mesh {
    pub(super) uri: String,
    pub(super) scale: Vec3,
    pub(super) inertia: MeshInertia,
    /// True if the vertices are moved (`refpos`, `refquat`), which is not read.
    pub(super) is_moved: bool,
    /// Its volume and moments, computed once; `None` if it has none.
    pub(super) solid: Option<Option<Solid>>,
}
