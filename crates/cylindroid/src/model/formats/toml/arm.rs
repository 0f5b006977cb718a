//! The `[dh]` table of a mechanism file: a serial arm by Denavit-Hartenberg rows.

use super::super::dh;
use super::value::Table;
use crate::error::{Error, Result};
use crate::model::JointSpec;
use crate::spatial::Pose;

pub(super) fn table<'t>(file: &Table<'t>) -> Result<Option<Table<'t>>> {
    file.table("dh", "[dh]", &["convention", "rows", "base", "flange"])
}

/// The joints of the arm, if the file has one.
pub(super) fn joints(file: &Table<'_>, planar: bool) -> Result<Vec<JointSpec>> {
    let Some(table) = table(file)? else { return Ok(Vec::new()) };
    if file.has("joint") {
        let help = "write the whole mechanism in one of the two ways";
        return Err(file.refuse("joint", "a file has [[joint]] or [dh], not both", help));
    }
    if planar {
        return Err(file.refuse("dimension", "a [dh] arm is three-dimensional", "leave it out"));
    }
    let convention = match table.required_string("convention")? {
        "standard" => dh::Convention::Standard,
        "modified" => dh::Convention::Modified,
        other => {
            let unknown = Error::unknown("convention", other, ["standard", "modified"]);
            return Err(table.refuse("convention", unknown.to_string(), ""));
        }
    };
    let pose = |key, what| match table.table(key, what, &["xyz", "rpy"])? {
        None => Ok(None),
        Some(t) => t.pose().map(Some),
    };
    Ok(dh::joints(&dh::Arm {
        convention,
        rows: rows(&table)?.iter().map(row).collect::<Result<_>>()?,
        ground_from_base: pose("base", "base")?,
        last_from_flange: pose("flange", "flange")?.unwrap_or(Pose::IDENTITY),
    }))
}

pub(super) fn rows<'t>(dh: &Table<'t>) -> Result<Vec<Table<'t>>> {
    let keys = ["name", "a", "alpha", "d", "theta", "type", "flip", "limits"];
    if !dh.has("rows") {
        return Err(dh.missing("rows"));
    }
    dh.tables("rows", "a row of [dh]", &keys)
}

fn row(table: &Table<'_>) -> Result<dh::Row> {
    let number = |key| table.number(key).map(|x| x.unwrap_or(0.0));
    let prismatic = match table.string("type")?.unwrap_or("revolute") {
        "revolute" => false,
        "prismatic" => true,
        other => {
            let unknown = Error::unknown("joint type", other, ["revolute", "prismatic"]);
            return Err(table.refuse("type", unknown.to_string(), ""));
        }
    };
    Ok(dh::Row {
        name: table.required_string("name")?.to_owned(),
        a: number("a")?,
        alpha: number("alpha")?,
        d: number("d")?,
        theta: number("theta")?,
        prismatic,
        flip: table.boolean("flip")?.unwrap_or(false),
        limits: table.limits()?,
    })
}
