//! The `[[collision]]` tables of a mechanism file: shapes of links for distances and collisions.
//!
//! Keys     link; shape: "sphere", "capsule", "cylinder" (both along z), "box", "ellipsoid",
//!          "half_space" (z <= 0) or "mesh"; radius, length, size, radii, file, scale; name; xyz and
//!          rpy on the link
//! Units    m, rad; the length of a capsule is that of its cylinder
//! Checked  tests/collision/files.rs::mechanism_files_*

use super::value::Table;
use super::world::World;
use crate::error::Result;
use crate::model::formats::mesh::Packages;
use crate::model::{Collision, Geometry};
use crate::spatial::Vec3;

const KEYS: [&str; 11] =
    ["name", "link", "shape", "radius", "length", "size", "radii", "file", "scale", "xyz", "rpy"];

const SHAPES: [&str; 7] =
    ["sphere", "capsule", "cylinder", "box", "ellipsoid", "half_space", "mesh"];

/// Writes the shapes, once all links are placed.
pub(super) fn write(file: &Table<'_>, world: &mut World<'_>) -> Result<()> {
    for table in file.tables("collision", "[[collision]]", &KEYS)? {
        let link = table.required_string("link")?;
        world.check_link(&table, "link", link)?;
        let shape = Collision {
            name: table.string("name")?.unwrap_or("").to_owned(),
            link_from_shape: table.pose()?,
            geometry: geometry(&table)?,
            ..Collision::default()
        };
        if let Geometry::Mesh { uri, path: None, .. } = &shape.geometry {
            let why = "mesh not found; the link has no shape there";
            world.note(table.at("file").start, "mesh", why, uri);
        }
        world.builder.collision(link, shape);
    }
    Ok(())
}

fn geometry(table: &Table<'_>) -> Result<Geometry> {
    let length = |key: &'static str| -> Result<f64> {
        let x = table.number(key)?.ok_or_else(|| table.missing(key))?;
        if x >= 0.0 {
            return Ok(x);
        }
        Err(table.refuse(key, format!("{key} = {x}"), "a length is not negative [m]"))
    };
    let lengths = |key: &'static str| -> Result<Vec3> {
        let v = table.vec3(key)?.ok_or_else(|| table.missing(key))?;
        if v.to_array().iter().all(|x| *x >= 0.0) {
            return Ok(v);
        }
        Err(table.refuse(key, format!("a number of {key} is negative"), "give lengths [m]"))
    };
    Ok(match table.required_string("shape")? {
        "sphere" => Geometry::Sphere { radius: length("radius")? },
        "capsule" => Geometry::Capsule { radius: length("radius")?, length: length("length")? },
        "cylinder" => Geometry::Cylinder { radius: length("radius")?, length: length("length")? },
        "box" => Geometry::Box { size: lengths("size")? },
        "ellipsoid" => Geometry::Ellipsoid { radii: lengths("radii")? },
        "half_space" => Geometry::HalfSpace,
        "mesh" => {
            let uri = table.required_string("file")?.to_owned();
            let path = Packages::of(table.source.path).find(&uri);
            let scale = table.vec3("scale")?.unwrap_or(Vec3::new(1.0, 1.0, 1.0));
            Geometry::Mesh { uri, path, scale }
        }
        other => {
            let message = format!("shape = \"{other}\"");
            return Err(table.refuse("shape", message, format!("one of {}", SHAPES.join(", "))));
        }
    })
}
