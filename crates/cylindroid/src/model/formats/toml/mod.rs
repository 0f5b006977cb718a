//! The mechanism file: one TOML table of joints in world axes at q = 0, or of Denavit-Hartenberg
//! rows.
//!
//! Keys     name, description, source, dimension (2 or 3), reference, reference_point, home, tool;
//!          `[[joint]]`, or `[dh]` with convention, rows, base, flange; `[[frame]]`
//! Units    m, rad, N, N m; pitch in m/rad
//! Valid    trees. A joint that closes a loop, `[[contact]]` and `[[robot]]` are refused in words
//! Checked  tests/formats/mechanism_file.rs, tests/formats/dh.rs, tests/formats/catalogue.rs

mod tree;
mod value;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use ::toml::de::DeTable;

use self::value::Table;
use super::dh;
use super::place::{Notes, Source};
use crate::error::{Error, Result};
use crate::model::{JointSpec, Mechanism};
use crate::spatial::Pose;

const KEYS: [&str; 13] = [
    "name",
    "description",
    "source",
    "dimension",
    "reference",
    "reference_point",
    "home",
    "tool",
    "joint",
    "dh",
    "frame",
    "contact",
    "robot",
];

/// The name of the frame that `reference_point` makes.
const REFERENCE: &str = "reference";

/// Reads the text of a mechanism file. The path is used in errors only.
///
/// # Errors
/// [`Error::File`] with line and column for broken TOML, unknown keys, values of a wrong type,
/// loops, contacts and robots, and all that the builder refuses.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    Ok(read(text, path, "mechanism file")?.0)
}

/// The mechanism and its description.
pub(in crate::model) fn read(
    text: &str,
    path: &Path,
    format: &'static str,
) -> Result<(Mechanism, String)> {
    let source = Source { format, path, text };
    let document = DeTable::parse(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        source.error(span, format!("broken TOML: {}", e.message()), "")
    })?;
    let file = Table::new(source, "a mechanism file", document.get_ref(), 0..0, &KEYS)?;
    refuse_closed(&file)?;
    let planar = dimension(&file)? == 2;

    let stem = path.file_stem().map(|s| s.to_string_lossy()).unwrap_or_default();
    let mut builder = Mechanism::builder(file.string("name")?.unwrap_or(&stem));
    let joints = joints(&file, planar)?;
    let mut places = places(&file)?;
    let poses = world_from_links(&joints);
    let mut notes = Notes::default();
    for mut joint in joints {
        let l = &mut joint.limits;
        let bounded = l.lower > f64::NEG_INFINITY || l.upper < f64::INFINITY;
        if bounded && !joint.kind.takes_position_limits() {
            (l.lower, l.upper) = (f64::NEG_INFINITY, f64::INFINITY);
            let at = places.iter().find(|p| p.0 == joint.name).map_or(0, |p| p.1.start);
            let why = "dropped: its rates are not the derivative of q, nothing could keep them";
            let what = format!("position limits of {} joints", joint.kind.name());
            notes.add(at, what, why, &joint.name);
        }
        builder.joint(joint);
    }
    for frame in file.tables("frame", "[[frame]]", &["name", "link", "xyz", "rpy"])? {
        let name = frame.required_string("name")?;
        let link = frame.required_string("link")?;
        if !poses.contains_key(link) {
            let unknown = Error::unknown("link", link, poses.keys().map(String::as_str));
            return Err(frame.refuse("link", unknown.to_string(), ""));
        }
        builder.frame(name, link, frame.pose()?);
        places.push((name.to_owned(), frame.at("name")));
    }
    if let Some(reference) = file.string("reference")? {
        let Some(world_from_link) = poses.get(reference) else {
            let unknown = Error::unknown("link", reference, poses.keys().map(String::as_str));
            return Err(file.refuse("reference", unknown.to_string(), ""));
        };
        builder.tool(reference);
        if let Some(point) = file.vector("reference_point", planar)? {
            let link_from_frame = world_from_link.inverse() * Pose::from_translation(point);
            builder.frame(REFERENCE, reference, link_from_frame).tool(REFERENCE);
            places.push((REFERENCE.to_owned(), file.at("reference_point")));
        }
    } else if file.has("reference_point") {
        let help = "name the link it belongs to: reference = \"...\"";
        return Err(file.refuse("reference_point", "a reference_point needs a reference", help));
    }
    if let Some(tool) = file.string("tool")? {
        builder.tool(tool);
        places.push((tool.to_owned(), file.at("tool")));
    }
    if let Some(home) = file.numbers("home")? {
        builder.home(&home);
        places.push(("home".to_owned(), file.at("home")));
    }
    let report = builder.report();
    report.format = format;
    report.source = file.string("source")?.unwrap_or("").to_owned();
    notes.write(&source, report);
    let mechanism = builder.build().map_err(|e| place(&source, &places, e))?;
    Ok((mechanism, file.string("description")?.unwrap_or("").to_owned()))
}

fn refuse_closed(file: &Table<'_>) -> Result<()> {
    for (key, what) in [("contact", "contacts"), ("robot", "robots from other files")] {
        if file.has(key) {
            let message = format!("[[{key}]]: this version reads trees of joints, no {what}");
            return Err(file.refuse(key, message, "leave it out"));
        }
    }
    Ok(())
}

fn dimension(file: &Table<'_>) -> Result<u8> {
    match file.number("dimension")? {
        None => Ok(3),
        Some(2.0) => Ok(2),
        Some(3.0) => Ok(3),
        Some(other) => {
            let message = format!("dimension = {other}");
            Err(file.refuse("dimension", message, "2 (the plane x-y) or 3"))
        }
    }
}

fn dh_table<'t>(file: &Table<'t>) -> Result<Option<Table<'t>>> {
    file.table("dh", "[dh]", &["convention", "rows", "base", "flange"])
}

fn joints(file: &Table<'_>, planar: bool) -> Result<Vec<JointSpec>> {
    let Some(table) = dh_table(file)? else {
        if !file.has("joint") {
            let help = "write [[joint]] tables or a [dh] table";
            return Err(file.refuse("joint", "the file has no joints", help));
        }
        return tree::joints(file, planar);
    };
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

fn rows<'t>(dh: &Table<'t>) -> Result<Vec<Table<'t>>> {
    let keys = ["name", "a", "alpha", "d", "theta", "type", "limits"];
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
        limits: table.limits()?,
    })
}

/// Where the joints stand in the file, for errors of the builder.
fn places(file: &Table<'_>) -> Result<Vec<(String, Range<usize>)>> {
    let joints = if let Some(dh) = dh_table(file)? { rows(&dh)? } else { tree::tables(file)? };
    let place = |t: &Table<'_>| Ok((t.required_string("name")?.to_owned(), t.at("name")));
    joints.iter().map(place).collect()
}

/// The pose of every link at q = 0; joints come parents first.
fn world_from_links(joints: &[JointSpec]) -> BTreeMap<String, Pose> {
    let mut poses = BTreeMap::new();
    for joint in joints {
        let parent = *poses.entry(joint.parent.clone()).or_insert(Pose::IDENTITY);
        poses.insert(joint.child.clone(), parent * joint.parent_from_joint);
    }
    poses
}

fn place(source: &Source<'_>, places: &[(String, Range<usize>)], error: Error) -> Error {
    let Error::Model { culprit, message, .. } = error else { return error };
    let span = places.iter().rev().find(|p| p.0 == culprit).map_or(0..0, |p| p.1.clone());
    source.error(span, message, "")
}
