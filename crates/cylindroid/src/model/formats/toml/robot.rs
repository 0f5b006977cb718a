//! The `[[robot]]` tables of a mechanism file: robots of other files and of the catalogue.
//!
//! Keys     model (a name of the catalogue, or a path from this file's folder), name, link, base
//!          (xyz, rpy), start, free, actuated, passive, parameters (values of those of its file)
//! Formula  world_from_root = world_from_link base; home is the robot's start
//! Why so   links, joints and frames of a robot get the prefix `name/`; those of a robot without a
//!          name keep their names, so that joints and contacts can be added to an unchanged URDF
//! Checked  tests/formats/closed_file.rs::robots_*, tests/formats/carried_robots.rs

use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;

use super::names::GROUND;
use super::tree::{self, JointEntry};
use super::value::Table;
use super::world::World;
use crate::error::{Error, Result};
use crate::model::formats::xml_limits::MOST_LINKS;
use crate::model::{Dimension, Inclusion, Mechanism, ParameterValues};
use crate::spatial::Pose;

const KEYS: [&str; 9] =
    ["name", "model", "link", "base", "start", "free", "actuated", "passive", "parameters"];

/// Loads the model of a `[[robot]]` table: from the folder of the file, by name or path, at a
/// depth of inclusion, with these values of its parameters.
pub(in crate::model) type Loader<'a> =
    &'a dyn Fn(&Path, &str, Nesting, ParameterValues<'_>) -> Result<Mechanism>;

/// Maximum depth of inclusion; deeper nesting is treated as a cycle.
const DEEPEST: usize = 8;

/// Robots that a file and those that it includes may bring in.
const MOST_ROBOTS: usize = 1000;

/// How deep a file is included, and the robots brought in so far by all files of the outermost one.
#[derive(Debug, Clone, Default)]
pub(in crate::model) struct Nesting {
    depth: usize,
    robots: Rc<Cell<usize>>,
}

/// The `[[robot]]` tables.
pub(super) fn tables<'t>(file: &Table<'t>) -> Result<Vec<Table<'t>>> {
    file.tables("robot", "[[robot]]", &KEYS)
}

/// Adds the robots, in the order of the file, and before a robot on a link of joints these joints,
/// which are taken out of the list.
pub(super) fn include<'t>(
    file: &Table<'t>,
    world: &mut World<'_>,
    joints: &mut Vec<JointEntry<'t>>,
    nesting: &Nesting,
    loader: Loader<'_>,
) -> Result<()> {
    let tables = tables(file)?;
    if let (Some(table), true) = (tables.first(), file.has("dh")) {
        let help = "put the [dh] arm into a file of its own and bring it in as a [[robot]]";
        return Err(table.refuse("model", "a file has [dh] or [[robot]], not both", help));
    }
    let mut names: Vec<&str> = Vec::new();
    for table in &tables {
        let name = table.string("name")?.unwrap_or("");
        if names.contains(&name) {
            let message = match name {
                "" => "two robots have no name".to_owned(),
                _ => format!("two robots are named '{name}'"),
            };
            return Err(table.refuse("name", message, "give every robot a name of its own"));
        }
        if name.contains('/') {
            let message = format!("the name '{name}' has a slash");
            return Err(table.refuse("name", message, "what the robot brings is called name/..."));
        }
        names.push(name);
        let robot = load(table, nesting, loader)?;
        if let Some(link) = table.string("link")?
            && !world.has(link)
        {
            tree::write_up_to(world, joints, link)?;
        }
        add(table, name, world, robot)?;
    }
    Ok(())
}

fn add(table: &Table<'_>, name: &str, world: &mut World<'_>, robot: Mechanism) -> Result<()> {
    if world.builder.links.len() + robot.links().len() > MOST_LINKS {
        let message = format!(
            "with '{}' the mechanism has more than {MOST_LINKS} links, the limit of this reader",
            robot.name()
        );
        return Err(table.refuse("model", message, "bring in fewer or smaller robots"));
    }
    if world.dimension == Dimension::Planar && robot.dimension() == Dimension::Spatial {
        let message = format!("'{}' moves in space, this file in the plane", robot.name());
        return Err(table.refuse("model", message, "leave out dimension = 2"));
    }
    let robot = set_actuated(table, robot)?;
    let start = start(table, &robot)?;
    let parent = table.string("link")?.unwrap_or(GROUND);
    world.check_link(table, "link", parent)?;
    let base = table.table("base", "base", &["xyz", "rpy"])?;
    let parent_from_root = base.as_ref().map_or(Ok(Pose::IDENTITY), Table::pose)?;
    let free = table.boolean("free")?.unwrap_or(false);
    let how = Inclusion { name, parent, parent_from_root, free, start: &start };

    let poses = robot.link_poses(&start);
    let world_from_root = world.pose(parent) * parent_from_root;
    for (i, root_from_link) in poses.into_iter().enumerate() {
        let link = how.link(&robot, i);
        if link == parent && (free || base.is_some()) {
            let message = format!("the root of '{}' is called '{parent}' too", robot.name());
            let help = "give the robot a name, so that its root can stand elsewhere";
            return Err(table.refuse("base", message, help));
        }
        if link != parent && world.has(&link) {
            let message = format!("'{}' brings a second link '{link}'", robot.name());
            return Err(table.refuse("model", message, "give the robot a name"));
        }
        let world_from_link = world_from_root * root_from_link;
        if link == parent {
            world.place(&link, world_from_link);
        } else {
            world.bring(&link, world_from_link);
        }
    }
    world.builder.include(&robot, how)?;
    Ok(())
}

fn load(table: &Table<'_>, nesting: &Nesting, loader: Loader<'_>) -> Result<Mechanism> {
    let model = table.required_string("model")?;
    let (depth, robots) = (nesting.depth, &nesting.robots);
    if depth >= DEEPEST {
        let message = format!("'{model}' is included by {DEEPEST} files, one in the other");
        return Err(table.refuse("model", message, "does a file include itself?"));
    }
    if robots.get() >= MOST_ROBOTS {
        let message = format!("'{model}' is one more than {MOST_ROBOTS} robots");
        let help = "more are not loaded; bring in fewer, or write them as joints of one file";
        return Err(table.refuse("model", message, help));
    }
    robots.set(robots.get() + 1);
    let inner = Nesting { depth: depth + 1, robots: Rc::clone(robots) };
    let folder = table.source.path.parent().unwrap_or_else(|| Path::new(""));
    let values = table.named_numbers("parameters")?.unwrap_or_default();
    let values: Vec<(&str, f64)> = values.iter().map(|(name, x, _)| (*name, *x)).collect();
    match loader(folder, model, inner, &values) {
        Err(
            error @ (Error::UnknownName { what: "parameter", .. }
            | Error::InvalidOption { option: "parameter", .. }),
        ) => Err(table.refuse("parameters", error.to_string(), "")),
        Err(error) if !matches!(error, Error::File(_)) => {
            let help = "name a catalogue model, or a file by its path from this file's folder";
            Err(table.refuse("model", error.to_string(), help))
        }
        result => result,
    }
}

/// The robot with the actuated joints of the table.
fn set_actuated(table: &Table<'_>, robot: Mechanism) -> Result<Mechanism> {
    let refuse = |key: &'static str| move |e: Error| table.refuse(key, e.to_string(), "");
    match (table.names("actuated")?, table.names("passive")?) {
        (None, None) => Ok(robot),
        (Some(names), None) => robot.with_actuated(&names).map_err(refuse("actuated")),
        (None, Some(names)) => {
            // Every name must be that of a joint that can be actuated.
            let passive = robot.with_actuated(&names).map_err(refuse("passive"))?;
            let coordinates = robot.actuated().filter(|&i| !passive.coordinates()[i].actuated);
            let closing = robot.loops().iter().zip(passive.loops());
            let actuated: Vec<&str> = coordinates
                .map(|i| robot.coordinates()[i].name.as_str())
                .chain(
                    closing
                        .filter(|(was, now)| was.actuated && !now.actuated)
                        .map(|(l, _)| l.name.as_str()),
                )
                .collect();
            robot.with_actuated(&actuated).map_err(refuse("passive"))
        }
        (Some(_), Some(_)) => {
            let message = "a robot has actuated or passive joints listed, not both";
            Err(table.refuse("passive", message, "leave one of the lists out"))
        }
    }
}

/// The start configuration: all coordinates, or some by name, the others at the robot's home.
fn start(table: &Table<'_>, robot: &Mechanism) -> Result<Vec<f64>> {
    if let Some(named) = table.named_numbers("start")? {
        let mut q = robot.home().to_vec();
        for (name, value, span) in named {
            let Some(i) = robot.coordinates().iter().position(|c| c.name == name) else {
                let known = robot.coordinates().iter().map(|c| c.name.as_str());
                let unknown = Error::unknown("joint", name, known);
                return Err(table.source.error(span, unknown.to_string(), ""));
            };
            q[i] = value;
        }
        return Ok(q);
    }
    let Some(q) = table.numbers("start")? else { return Ok(robot.home().to_vec()) };
    robot.check_q("start", &q).map_err(|e| table.refuse("start", e.to_string(), ""))?;
    Ok(q)
}
