//! Shapes by name and sizes.

use std::path::PathBuf;

use cylindroid::model::Geometry;
use cylindroid::{Error, Vec3};

use crate::arrays::Numbers;
use crate::error::{Failure, Result};

const SHAPES: [&str; 8] =
    ["sphere", "capsule", "cylinder", "box", "ellipsoid", "half_space", "convex_hull", "mesh"];

/// The sizes that are given.
pub(crate) struct Sizes<'py> {
    pub(crate) radius: Option<f64>,
    pub(crate) length: Option<f64>,
    pub(crate) size: Option<Numbers<'py>>,
    pub(crate) points: Option<Numbers<'py>>,
    pub(crate) file: Option<PathBuf>,
}

/// The shape of this name; every size that it needs is given and no other.
pub(crate) fn geometry(shape: &str, sizes: Sizes<'_>) -> Result<Geometry> {
    let Sizes { radius, length, size, points, file } = sizes;
    let given = [
        ("radius", radius.is_some()),
        ("length", length.is_some()),
        ("size", size.is_some()),
        ("points", points.is_some()),
        ("file", file.is_some()),
    ];
    let needs: &[&str] = match shape {
        "sphere" => &["radius"],
        "capsule" | "cylinder" => &["radius", "length"],
        "box" | "ellipsoid" => &["size"],
        "half_space" => &[],
        "convex_hull" => &["points"],
        "mesh" => &["file"],
        _ => return Err(Error::unknown("shape", shape, SHAPES).into()),
    };
    if given.iter().any(|(name, is)| needs.contains(name) != *is) {
        let needs = if needs.is_empty() { "no sizes".to_owned() } else { needs.join(" and ") };
        return Err(Failure::option("shape", shape, format!("it takes {needs}")));
    }
    let (radius, length) = (radius.unwrap_or(0.0), length.unwrap_or(0.0));
    let vector = |of: Option<Numbers<'_>>| -> Result<Vec3> {
        of.map_or(Ok(Vec3::ZERO), |n| Ok(Vec3::from_array(n.entries::<3>("size")?)))
    };
    Ok(match shape {
        "sphere" => Geometry::Sphere { radius },
        "capsule" => Geometry::Capsule { radius, length },
        "cylinder" => Geometry::Cylinder { radius, length },
        "box" => Geometry::Box { size: vector(size)? },
        "ellipsoid" => Geometry::Ellipsoid { radii: vector(size)? },
        "convex_hull" => {
            let points = points.map(|p| p.matrix("points")).transpose()?;
            let points = points.filter(|p| p.cols() == 3).ok_or_else(|| {
                Failure::option("points", "an array of another shape", "give (k, 3)")
            })?;
            let row = |i| Vec3::new(points[(i, 0)], points[(i, 1)], points[(i, 2)]);
            Geometry::ConvexHull { points: (0..points.rows()).map(row).collect() }
        }
        "mesh" => {
            let path = file.unwrap_or_default();
            let uri = path.display().to_string();
            Geometry::Mesh { uri, path: Some(path), scale: Vec3::new(1.0, 1.0, 1.0) }
        }
        _ => Geometry::HalfSpace,
    })
}
