//! The `[[link]]` tables of a mechanism file: masses of the links of joints and contacts.
//!
//! Keys     name, mass, center (world at home), inertia: [ixx, iyy, izz] or with ixy, ixz, iyz
//!          after them, in the plane one number
//! Formula  link_from_inertia = world_from_link^-1 Trans(center), in world axes
//! Valid    inertia about the centre of mass; zero (a point mass) by default
//! Checked  tests/formats/closed_file.rs::links_*

use super::value::Table;
use super::world::World;
use crate::error::Result;
use crate::model::{Dimension, Inertial, Link};
use crate::spatial::{Mat3, Pose};

const KEYS: [&str; 4] = ["name", "mass", "center", "inertia"];

/// Writes the masses, once all links are placed. `brought` are the links of included robots.
pub(super) fn write(file: &Table<'_>, world: &mut World<'_>, brought: &[String]) -> Result<()> {
    let mut seen: Vec<&str> = Vec::new();
    for table in file.tables("link", "[[link]]", &KEYS)? {
        let name = table.required_string("name")?;
        world.check_link(&table, "name", name)?;
        if brought.iter().any(|link| link == name) {
            let message = format!("link '{name}' is not one of this file's joints or contacts");
            return Err(table.refuse("name", message, "its mass belongs into the file it is from"));
        }
        if seen.contains(&name) {
            let message = format!("link '{name}' has two tables");
            return Err(table.refuse("name", message, "write all of it into one"));
        }
        seen.push(name);
        let inertial = inertial(&table, world, name)?;
        world.builder.link(Link { inertial: Some(inertial), ..Link::named(name) });
    }
    Ok(())
}

fn inertial(table: &Table<'_>, world: &World<'_>, name: &str) -> Result<Inertial> {
    let mass = table.number("mass")?.ok_or_else(|| table.missing("mass"))?;
    if !(mass > 0.0) {
        return Err(table.refuse("mass", format!("mass = {mass}"), "a mass is positive [kg]"));
    }
    let planar = world.dimension == Dimension::Planar;
    let center = table.vector("center", planar)?.ok_or_else(|| table.missing("center"))?;
    let entries = match (planar, table.has("inertia")) {
        (_, false) => vec![0.0; 6],
        (true, true) => vec![0.0, 0.0, table.number("inertia")?.unwrap_or(0.0), 0.0, 0.0, 0.0],
        (false, true) => table.numbers("inertia")?.unwrap_or_default(),
    };
    let (xx, yy, zz, xy, xz, yz) = match entries[..] {
        [xx, yy, zz] => (xx, yy, zz, 0.0, 0.0, 0.0),
        [xx, yy, zz, xy, xz, yz] => (xx, yy, zz, xy, xz, yz),
        _ => {
            let help = "write [ixx, iyy, izz] or [ixx, iyy, izz, ixy, ixz, iyz]";
            let message = format!("inertia has {} numbers", entries.len());
            return Err(table.refuse("inertia", message, help));
        }
    };
    if xx < 0.0 || yy < 0.0 || zz < 0.0 {
        let help = "moments of inertia are not negative [kg m^2]";
        return Err(table.refuse("inertia", "a moment of inertia is negative", help));
    }
    // In files without robots, link frames have world axes at home; otherwise rotate to them.
    let link_from_inertia = world.pose(name).inverse() * Pose::from_translation(center);
    let inertia = Mat3::from_rows([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
    Ok(Inertial { mass, link_from_inertia, inertia })
}
