//! The `[[closure]]` tables of a mechanism file: two frames that coincide.
//!
//! Keys     name; type: "pose", "point" or "axis"; between: two frames, by the names of links, of
//!          frames (`[[frame]]`, MJCF sites) or of joints; axis: for "axis", in both frames (z)
//! Formula  a loop joint at zero where the frames coincide: fixed (pose), spherical (point; in the
//!          plane revolute), revolute about the axis (axis)
//! Valid    the frames need not coincide at the poses of the file: home is assembled from there
//! Why so   links of other files have frames, and points in world axes at home are known only once
//!          the loop is closed
//! Checked  tests/formats/closures.rs

use super::value::Table;
use super::world::World;
use crate::error::{Error, Result};
use crate::model::{Dimension, JointKind, LoopJointSpec};
use crate::spatial::Vec3;
use crate::tolerance::ZERO_AXIS;

const KEYS: [&str; 4] = ["name", "type", "between", "axis"];
const TYPES: [&str; 3] = ["pose", "point", "axis"];

/// The `[[closure]]` tables.
pub(super) fn tables<'t>(file: &Table<'t>) -> Result<Vec<Table<'t>>> {
    file.tables("closure", "[[closure]]", &KEYS)
}

/// Writes the closures, once all links, joints and frames are written.
pub(super) fn write(file: &Table<'_>, world: &mut World<'_>) -> Result<()> {
    for table in tables(file)? {
        let name = table.required_string("name")?;
        let [first, second] = table.pair("between")?;
        let (kind, axis) = kind_and_axis(&table, world.dimension)?;
        let frame = |name: &str| {
            let placed = world.builder.placed_frame(name);
            placed.ok_or_else(|| {
                let unknown = Error::unknown("frame", name, world.builder.placed_frame_names());
                let help = "name two frames: a link, a [[frame]], an MJCF site or a joint";
                table.refuse("between", unknown.to_string(), help)
            })
        };
        let ((a, link_a_from_joint), (b, link_b_from_joint)) = (frame(first)?, frame(second)?);
        if a == b {
            let message = format!("'{first}' and '{second}' are frames of one link, '{a}'");
            return Err(table.refuse("between", message, "name frames of two links"));
        }
        let joint = LoopJointSpec {
            link_a_from_joint,
            link_b_from_joint,
            axis,
            ..LoopJointSpec::new(name, kind, &a, &b)
        };
        world.builder.loop_joint(joint).assemble_home(name);
    }
    Ok(())
}

fn kind_and_axis(table: &Table<'_>, dimension: Dimension) -> Result<(JointKind, Vec3)> {
    let kind = match (table.required_string("type")?, dimension) {
        ("pose", _) => JointKind::Fixed,
        ("point", Dimension::Spatial) => JointKind::Spherical,
        ("point", Dimension::Planar) | ("axis", _) => JointKind::Revolute,
        (other, _) => {
            let unknown = Error::unknown("closure type", other, TYPES);
            let help = format!("the types are {}", TYPES.join(", "));
            return Err(table.refuse("type", unknown.to_string(), help));
        }
    };
    let Some(axis) = table.vec3("axis")? else { return Ok((kind, Vec3::Z)) };
    if kind != JointKind::Revolute || dimension == Dimension::Planar {
        let message = "only a closure of type axis in space has an axis";
        return Err(table.refuse("axis", message, "remove it or change the type"));
    }
    match axis.unit(ZERO_AXIS) {
        Some(axis) => Ok((kind, axis)),
        None => {
            let help = "give a vector that is not zero";
            Err(table.refuse("axis", "the axis has no direction", help))
        }
    }
}
