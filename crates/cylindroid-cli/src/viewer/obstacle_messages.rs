//! Messages about obstacles: shapes and poses as JSON.

use cylindroid::Vec3;
use cylindroid::model::Geometry;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "AddObstacleMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct AddObstacle {
    pub(super) name: String,
    pub(super) shape: Shape,
    pub(super) position: [f64; 3],
    /// w, x, y, z.
    #[serde(default = "identity")]
    pub(super) quaternion: [f64; 4],
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "MoveObstacleMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct MoveObstacle {
    pub(super) name: String,
    pub(super) position: [f64; 3],
    pub(super) quaternion: [f64; 4],
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "DistancesMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Distances {
    /// Without it no distances are computed.
    pub(super) margin: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "AvoidCollisionsMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct AvoidCollisions {
    pub(super) on: bool,
    pub(super) gap: Option<f64>,
    pub(super) margin: Option<f64>,
}

/// The shapes of obstacles. Meshes are files, which a client cannot name.
#[derive(Debug, Deserialize)]
#[cfg_attr(
    test,
    derive(ts_rs::TS),
    ts(rename = "SimpleShape", tag = "kind", rename_all = "snake_case")
)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Shape {
    Sphere { radius: f64 },
    Box { size: [f64; 3] },
    Cylinder { radius: f64, length: f64 },
    Capsule { radius: f64, length: f64 },
    Ellipsoid { radii: [f64; 3] },
    HalfSpace {},
}

fn identity() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

impl Shape {
    pub(super) fn geometry(&self) -> Geometry {
        match *self {
            Self::Sphere { radius } => Geometry::Sphere { radius },
            Self::Box { size } => Geometry::Box { size: Vec3::from_array(size) },
            Self::Cylinder { radius, length } => Geometry::Cylinder { radius, length },
            Self::Capsule { radius, length } => Geometry::Capsule { radius, length },
            Self::Ellipsoid { radii } => Geometry::Ellipsoid { radii: Vec3::from_array(radii) },
            Self::HalfSpace {} => Geometry::HalfSpace,
        }
    }

    /// A length that is not positive, with its field.
    pub(super) fn faulty_length(&self) -> Option<(&'static str, f64)> {
        let lengths: Vec<(&'static str, f64)> = match *self {
            Self::Sphere { radius } => vec![("radius", radius)],
            Self::Cylinder { radius, length } | Self::Capsule { radius, length } => {
                vec![("radius", radius), ("length", length)]
            }
            Self::Box { size: lengths } => lengths.map(|x| ("size", x)).to_vec(),
            Self::Ellipsoid { radii: lengths } => lengths.map(|x| ("radii", x)).to_vec(),
            Self::HalfSpace {} => Vec::new(),
        };
        lengths.into_iter().find(|(_, x)| !(*x > 0.0))
    }
}
