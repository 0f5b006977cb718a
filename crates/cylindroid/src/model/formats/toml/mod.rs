//! The mechanism file (TOML): a graph of joints and contacts in world axes at home, robots from
//! other files, or a table of Denavit-Hartenberg rows.
//!
//! Keys     name, description, source, dimension (2 or 3), reference, reference_point, home, tool;
//!          `[[joint]]`, or `[dh]` with convention, rows, base, flange; `[[link]]`, `[[collision]]`, `[[contact]]`,
//!          `[[robot]]`, `[[frame]]`, `[[closure]]`, `[[elasticity]]`; `[parameters]`, and expressions of
//!          them in place of numbers
//! Units    m, rad, N, N m; pitch in m/rad
//! Valid    any connected graph. Home is q = 0, for included robots their start configuration; a
//!          joint between links that are already connected is a loop joint
//! Checked  tests/formats/mechanism_file.rs, tests/formats/closed_file.rs, tests/formats/dh.rs,
//!          tests/formats/catalogue.rs

mod arm;
mod body;
mod closure;
mod collision;
mod contact;
mod elasticity;
mod expression;
mod limit;
mod limits_file;
mod names;
mod parameters;
mod parse;
mod robot;
mod tree;
mod value;
mod values;
mod world;

pub use self::limits_file::{with_limits_of_file, with_limits_of_text};
pub(in crate::model) use self::parameters::none;
pub use self::parse::parse;
pub(crate) use self::parse::read;
pub(in crate::model) use self::robot::{Loader, Nesting};

use std::path::Path;

use ::toml::de::DeTable;

use self::names::{GROUND, REFERENCE};
use self::parameters::Parameters;
use self::value::Table;
use self::world::World;
use super::span::Source;
use crate::error::Result;
use crate::model::{CloseHome, Dimension, Mechanism, ParameterValues};
use crate::spatial::{Pose, Vec3};

const KEYS: [&str; 18] = [
    "name",
    "description",
    "source",
    "dimension",
    "reference",
    "reference_point",
    "home",
    "tool",
    "joint",
    "link",
    "collision",
    "dh",
    "frame",
    "contact",
    "closure",
    "elasticity",
    "robot",
    "parameters",
];

/// The mechanism and its description.
pub(in crate::model) fn describe(
    text: &str,
    path: &Path,
    format: &'static str,
    given: ParameterValues<'_>,
    (nesting, loader): (Nesting, Loader<'_>),
    close: CloseHome<'_>,
) -> Result<(Mechanism, String)> {
    let source = Source { format, path, text };
    limit::check(&source)?;
    let document = DeTable::parse(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        source.error(span, format!("broken TOML: {}", e.message()), "")
    })?;
    let parameters = Parameters::read(&source, document.get_ref(), given)?;
    let file = Table::new(source, "a mechanism file", document.get_ref(), 0..0, &KEYS)?
        .with_parameters(parameters.as_ref().map(Parameters::values));
    let dimension = dimension(&file)?;
    let planar = dimension == Dimension::Planar;

    let stem = path.file_stem().map(|s| s.to_string_lossy()).unwrap_or_default();
    let mut world = World::new(source, file.string("name")?.unwrap_or(&stem), dimension);
    note_places(&mut world, &file)?;
    let arm = arm::joints(&file, planar)?;
    if arm.is_empty() {
        if !["joint", "robot", "contact"].iter().any(|key| file.has(key)) {
            let help = "write [[joint]] tables, [[robot]] tables or a [dh] table";
            return Err(file.refuse("joint", "the file has no joints", help));
        }
        world.place(GROUND, Pose::IDENTITY);
    }
    if !file.has("robot") {
        world.builder.by_name();
    }
    world.arm(arm);
    let joints = tree::joints(&file, planar)?;
    let mut rest = joints.clone();
    robot::include(&file, &mut world, &mut rest, &nesting, loader)?;
    let brought: Vec<String> = world.placed();
    let brought: Vec<String> = brought.into_iter().filter(|l| world.is_brought(l)).collect();
    let contacts = contact::contacts(&file, planar)?;
    let joined: Vec<&str> = joints.iter().flat_map(|j| j.between).collect();
    contact::check(&contacts, &world, &joined)?;

    let reference = file.string("reference")?;
    let point = file.vector("reference_point", planar)?;
    let frames = file.tables("frame", "[[frame]]", &["name", "link", "xyz", "rpy"])?;
    let site = match reference {
        Some(name) if !joined.contains(&name) && !world.has(name) => {
            site_link(&world, &frames, name)?
        }
        _ => None,
    };
    let reference_link = site.as_deref().or(reference);
    tree::write(&mut world, &rest, &contacts, reference_link.map(|r| (r, point)))?;
    contact::write(&mut world, &contacts);
    body::write(&file, &mut world, &brought)?;
    collision::write(&file, &mut world)?;
    let of_joints = joints.iter().map(|j| (j.name, j.between[0], j.origin));
    let of_contacts = contacts.iter().map(|c| (c.name, c.between[0], Some(c.point)));
    let parts: Vec<_> = of_joints.chain(of_contacts).collect();
    elasticity::write(&file, &mut world, |name| {
        let part = parts.iter().find(|p| p.0 == name);
        part.map(|(_, link, origin)| ((*link).to_owned(), *origin))
    })?;

    for frame in frames {
        let name = frame.required_string("name")?;
        let link = frame.required_string("link")?;
        world.check_link(&frame, "link", link)?;
        world.builder.frame(name, link, frame.pose()?);
    }
    closure::write(&file, &mut world)?;
    if let (Some(reference), Some(_)) = (reference, &site) {
        if point.is_some() {
            let message = format!("'{reference}' is a frame, and its origin the reference point");
            return Err(file.refuse("reference_point", message, "remove one of them"));
        }
        world.builder.tool(reference).reference(reference);
    } else if let Some(reference) = reference {
        world.check_reference(&file, reference)?;
        refer(&mut world, reference, point.or(tree::first_origin(&joints, reference)));
    } else if file.has("reference_point") {
        let help = "name the link it belongs to: reference = \"...\"";
        return Err(file.refuse("reference_point", "a reference_point needs a reference", help));
    }
    if let Some(tool) = file.string("tool")? {
        world.builder.tool(tool);
    }
    if let Some(home) = file.numbers("home")? {
        world.builder.home(&home);
    }
    let report = world.builder.report();
    report.format = format;
    report.source = file.string("source")?.unwrap_or("").to_owned();
    report.parameters = parameters.as_ref().map_or_else(Vec::new, |p| p.list().to_vec());
    Ok((world.build(close)?, file.string("description")?.unwrap_or("").to_owned()))
}

/// The link of a frame of this name, of the file or of a robot in it; `None` for links.
fn site_link(world: &World<'_>, frames: &[Table<'_>], name: &str) -> Result<Option<String>> {
    for frame in frames {
        if frame.required_string("name")? == name {
            return Ok(Some(frame.required_string("link")?.to_owned()));
        }
    }
    let known = world.builder.frames.iter().find(|(frame, ..)| frame == name);
    Ok(known.map(|(_, link, _)| link.clone()))
}

/// The reference frame: the link's own frame, or one with world axes at the reference point.
fn refer(world: &mut World<'_>, link: &str, point: Option<Vec3>) {
    let world_from_link = world.pose(link);
    let frame = match point {
        Some(point) if point != world_from_link.translation => {
            let link_from_frame = world_from_link.inverse() * Pose::from_translation(point);
            world.builder.frame(REFERENCE, link, link_from_frame);
            REFERENCE
        }
        _ => link,
    };
    world.builder.tool(frame).reference(frame);
}

fn dimension(file: &Table<'_>) -> Result<Dimension> {
    match file.number("dimension")? {
        None | Some(3.0) => Ok(Dimension::Spatial),
        Some(2.0) => Ok(Dimension::Planar),
        Some(other) => {
            let message = format!("dimension = {other}");
            Err(file.refuse("dimension", message, "2 (the plane x-y) or 3"))
        }
    }
}

/// Records the places of joints, contacts, robots and frames in the file.
fn note_places(world: &mut World<'_>, file: &Table<'_>) -> Result<()> {
    let rows = match arm::table(file)? {
        Some(dh) => arm::rows(&dh)?,
        None => Vec::new(),
    };
    let frames = file.tables("frame", "[[frame]]", &["name", "link", "xyz", "rpy"])?;
    let named = [contact::tables(file)?, closure::tables(file)?].concat();
    for table in rows.iter().chain(&tree::tables(file)?).chain(&named).chain(&frames) {
        world.note_place(table.required_string("name")?, table.at("name"));
    }
    for table in robot::tables(file)? {
        let name = table.string("name")?.unwrap_or("");
        world.note_place(name, table.span.clone());
    }
    world.note_place(REFERENCE, file.at("reference_point"));
    if let Some(tool) = file.string("tool")? {
        world.note_place(tool, file.at("tool"));
    }
    world.note_place("home", file.at("home"));
    Ok(())
}
