//! Assets of MJCF: colours and meshes, referenced by geoms by name.

use std::collections::BTreeMap;

use crate::model::formats::mesh::Packages;
use crate::spatial::Vec3;

/// Assets of geoms, by name.
#[derive(Default)]
pub(super) struct Assets<'d> {
    pub(super) colours: BTreeMap<&'d str, [f64; 4]>,
    /// Files and scales.
    pub(super) meshes: BTreeMap<String, (String, Vec3)>,
    pub(super) packages: Option<Packages>,
}
