//! The joints of a mechanism file: a graph in world axes at home, with the root `ground`.
//!
//! Formula  parent_from_joint = world_from_parent^-1 Trans(origin): at home every link frame has
//!          world axes, and its origin is that of the joint towards ground
//! Why so   a joint written from the far link to the near one keeps its q, the motion of the
//!          second link relative to the first: it enters the tree reversed
//! Checked  tests/formats/mechanism_file.rs, tests/formats/closed_file.rs

use std::collections::{BTreeMap, BTreeSet};

use super::contact::ContactEntry;
use super::names::GROUND;
use super::value::Table;
use super::world::World;
use crate::error::{Error, Result};
use crate::model::formats::graph::{Branch, Coupling, Groups, Rank, spanning_tree};
use crate::model::natural_order::Natural;
use crate::model::{JointKind, JointSpec, Limits, LoopJointSpec, Mimic};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::{CLOSED, ZERO_AXIS};

const TYPES: [&str; 10] = [
    "revolute",
    "continuous",
    "prismatic",
    "helical",
    "cylindrical",
    "universal",
    "spherical",
    "planar",
    "fixed",
    "free",
];

const KEYS: [&str; 10] =
    ["name", "type", "between", "origin", "axis", "axis2", "pitch", "actuated", "limits", "mimic"];

/// A joint as read from the file.
#[derive(Clone)]
pub(super) struct JointEntry<'t> {
    table: Table<'t>,
    pub(super) name: &'t str,
    kind: JointKind,
    pub(super) between: [&'t str; 2],
    pub(super) origin: Option<Vec3>,
    axis: Vec3,
    limits: Limits,
    mimic: Option<Mimic>,
    actuated: bool,
}

/// The `[[joint]]` tables.
pub(super) fn tables<'t>(file: &Table<'t>) -> Result<Vec<Table<'t>>> {
    file.tables("joint", "[[joint]]", &KEYS)
}

/// The joints as read from the file.
pub(super) fn joints<'t>(file: &Table<'t>, planar: bool) -> Result<Vec<JointEntry<'t>>> {
    tables(file)?.into_iter().map(|t| read(t, planar)).collect()
}

/// Writes the joints: those of the tree, the loop joints, and free joints for objects with contacts
/// alone.
pub(super) fn write<'t>(
    world: &mut World<'_>,
    joints: &[JointEntry<'t>],
    contacts: &[ContactEntry<'_>],
    reference: Option<(&str, Option<Vec3>)>,
) -> Result<()> {
    let mut names: Vec<&str> = Vec::new();
    let mut index: BTreeMap<&str, usize> = BTreeMap::new();
    let placed: Vec<String> = world.placed();
    let between = joints.iter().flat_map(|j| j.between);
    let touched = contacts.iter().flat_map(|c| c.between);
    for link in placed.iter().map(String::as_str).chain(between).chain(touched) {
        index.entry(link).or_insert_with(|| {
            names.push(link);
            names.len() - 1
        });
    }
    let ends: Vec<[usize; 2]> = joints.iter().map(|j| j.between.map(|l| index[l])).collect();
    if let Some(joint) = joints.iter().find(|j| j.between[0] == j.between[1]) {
        let message =
            format!("joint '{}' connects link '{}' with itself", joint.name, joint.between[0]);
        return Err(joint.table.refuse("between", message, "name two links"));
    }

    let mut roots: Vec<usize> = (0..placed.len()).collect();
    let mut groups = Groups::new(names.len());
    roots.windows(2).for_each(|w| _ = groups.join(w[0], w[1]));
    ends.iter().for_each(|[a, b]| _ = groups.join(*a, *b));
    let mut free = Vec::new();
    for link in objects(contacts, reference.map(|r| r.0), &index, &mut groups) {
        let point = match reference {
            Some((name, Some(point))) if name == names[link] => Some(point),
            _ => first_origin(joints, names[link]),
        };
        let touching = contacts.iter().filter(|c| c.between.contains(&names[link]));
        let touching = touching.min_by_key(|c| Natural(c.name)).map(|c| c.point);
        let place = Pose::from_translation(point.or(touching).unwrap_or(Vec3::ZERO));
        free.push(world.free(names[link], place));
        roots.push(link);
    }

    let followed: BTreeSet<&str> =
        joints.iter().filter_map(|j| j.mimic.as_ref()).map(|m| m.joint.as_str()).collect();
    let rank = |j: &JointEntry<'t>| {
        let coupling = Coupling::of(j.mimic.is_some(), followed.contains(j.name));
        Rank::new(j.name, j.kind, coupling, j.actuated)
    };
    let ranks: Vec<Rank<'t>> = joints.iter().map(rank).collect();
    let graph = spanning_tree(names.len(), &ends, &ranks, &roots);
    if let Some(&loose) = graph.loose.first() {
        return Err(in_the_air(&joints[loose], joints.iter().any(|j| j.between.contains(&GROUND))));
    }
    for branch in graph.tree {
        let Branch { joint, parent, child, reversed } = branch;
        branch_out(world, &joints[joint], names[parent], names[child], reversed);
    }
    for joint in free {
        world.builder.joint(joint);
    }
    for joint in graph.loops {
        close(world, &joints[joint])?;
    }
    Ok(())
}

/// Writes the joints that connect a link with those that are placed, and all others that they
/// reach, and takes them out of the list; links of robots that are still to come are not reached.
pub(super) fn write_up_to<'t>(
    world: &mut World<'_>,
    joints: &mut Vec<JointEntry<'t>>,
    link: &str,
) -> Result<()> {
    let mut reached: BTreeSet<&str> = BTreeSet::new();
    let is_of_robot = |link: &str| link.contains('/') && !world.has(link);
    let mut count = usize::MAX;
    while count != reached.len() {
        count = reached.len();
        for joint in joints.iter().filter(|j| !j.between.into_iter().any(is_of_robot)) {
            if joint.between.into_iter().any(|l| world.has(l) || reached.contains(l)) {
                reached.extend(joint.between);
            }
        }
    }
    if !reached.contains(link) {
        return Ok(());
    }
    let is_reached = |j: &JointEntry<'t>| j.between.into_iter().all(|l| reached.contains(l));
    let (chosen, others) = std::mem::take(joints).into_iter().partition(is_reached);
    *joints = others;
    write(world, &chosen, &[], None)
}

/// The links that are connected by contacts alone, one for each connected component: the reference
/// link if it is among them, otherwise the first touched (second) link of a contact by name,
/// otherwise the first link by name.
fn objects(
    contacts: &[ContactEntry<'_>],
    reference: Option<&str>,
    index: &BTreeMap<&str, usize>,
    groups: &mut Groups,
) -> Vec<usize> {
    let mut touched: Vec<(usize, &str)> =
        contacts.iter().flat_map(|c| [(0, c.between[1]), (1, c.between[0])]).collect();
    touched.sort_by_key(|(end, link)| (*end, Natural(link)));
    let touched: Vec<usize> = touched.into_iter().map(|(_, link)| index[link]).collect();
    let reference = reference.and_then(|r| index.get(r).copied());
    let is_touched = |groups: &mut Groups, link: usize| {
        let group = groups.of(link);
        touched.iter().any(|&t| groups.of(t) == group)
    };
    let first = reference.filter(|&r| is_touched(groups, r));
    let mut objects = Vec::new();
    // The first link that was placed, or ground, is index 0.
    for link in first.into_iter().chain(touched.iter().copied()) {
        if groups.join(0, link) {
            objects.push(link);
        }
    }
    objects
}

/// The origin of the first joint of a link, by name.
pub(super) fn first_origin(joints: &[JointEntry<'_>], link: &str) -> Option<Vec3> {
    let of_link = joints.iter().filter(|j| j.between.contains(&link));
    of_link.min_by_key(|j| Natural(j.name)).and_then(|j| j.origin)
}

fn in_the_air(joint: &JointEntry<'_>, grounded: bool) -> Error {
    let [a, b] = joint.between;
    let message = format!(
        "joint '{}' hangs in the air: neither '{a}' nor '{b}' is connected to '{GROUND}'",
        joint.name
    );
    let help = if grounded {
        "connect one of its links, or check the spelling of their names"
    } else {
        "name the fixed link ground, or add a joint of type free from ground"
    };
    joint.table.refuse("between", message, help)
}

fn branch_out(
    world: &mut World<'_>,
    joint: &JointEntry<'_>,
    parent: &str,
    child: &str,
    reversed: bool,
) {
    let world_from_parent = world.pose(parent);
    let origin = joint.origin.unwrap_or(world_from_parent.translation);
    let world_from_joint = Pose::from_translation(origin);
    world.place(child, world_from_joint);
    world.joint(JointSpec {
        name: joint.name.to_owned(),
        kind: joint.kind,
        parent: parent.to_owned(),
        child: child.to_owned(),
        parent_from_joint: world_from_parent.inverse() * world_from_joint,
        joint_from_child: Pose::IDENTITY,
        axis: joint.axis,
        reversed,
        limits: joint.limits,
        mimic: joint.mimic.clone(),
        actuated: joint.actuated,
        armature: 0.0,
    });
}

fn close(world: &mut World<'_>, joint: &JointEntry<'_>) -> Result<()> {
    let [a, b] = joint.between;
    if joint.mimic.is_some() {
        let message = format!(
            "joint '{}' closes a loop and has no coordinate: it cannot follow another joint",
            joint.name
        );
        let help = "every loop needs a joint that follows nothing";
        return Err(joint.table.refuse("mimic", message, help));
    }
    let [world_from_a, world_from_b] = [world.pose(a), world.pose(b)];
    if joint.kind == JointKind::Fixed
        && joint.origin.is_none()
        && world.is_brought(a)
        && world.is_brought(b)
    {
        let apart = world_from_a.inverse() * world_from_b;
        let (distance, angle) = (apart.translation.norm(), apart.rotation.log().norm());
        if distance > CLOSED * (1.0 + world_from_a.translation.norm()) || angle > CLOSED {
            let message = format!(
                "joint '{}' is fixed and closes a loop between the frames of '{a}' and '{b}', \
                 which are {distance:.3} m and {angle:.3} rad apart",
                joint.name
            );
            let help = "write [[closure]] with type = \"pose\" to bring the frames together, or \
                        origin = [...] to weld the links where they are";
            return Err(joint.table.refuse("type", message, help));
        }
    }
    let world_from_joint = Pose::from_translation(joint.origin.unwrap_or(world_from_a.translation));
    world.builder.closing_joint(LoopJointSpec {
        name: joint.name.to_owned(),
        kind: joint.kind,
        a: a.to_owned(),
        b: b.to_owned(),
        link_a_from_joint: world_from_a.inverse() * world_from_joint,
        link_b_from_joint: world_from_b.inverse() * world_from_joint,
        axis: joint.axis,
        limits: joint.limits,
        actuated: joint.actuated,
    });
    Ok(())
}

fn read(table: Table<'_>, planar: bool) -> Result<JointEntry<'_>> {
    let name = table.required_string("name")?;
    let between = table.pair("between")?;
    let (kind, axis) = kind_and_axis(&table, planar)?;
    let origin = table.vector("origin", planar)?;
    let place_matters = !matches!(kind, JointKind::Fixed | JointKind::Prismatic | JointKind::Free);
    if origin.is_none() && place_matters {
        return Err(table.missing("origin"));
    }
    let mimic = match table.table("mimic", "mimic", &["joint", "multiplier", "offset"])? {
        None => None,
        Some(mimic) => Some(Mimic {
            joint: mimic.required_string("joint")?.to_owned(),
            multiplier: mimic.number("multiplier")?.unwrap_or(1.0),
            offset: mimic.number("offset")?.unwrap_or(0.0),
        }),
    };
    let limits = table.limits()?;
    let actuated = table.boolean("actuated")?.unwrap_or(false);
    Ok(JointEntry { name, kind, between, origin, axis, limits, mimic, actuated, table })
}

fn kind_and_axis(table: &Table<'_>, planar: bool) -> Result<(JointKind, Vec3)> {
    let word = table.required_string("type")?;
    let leaves_plane =
        matches!(word, "helical" | "cylindrical" | "universal" | "spherical" | "free");
    if planar && leaves_plane {
        let help = "with dimension = 2 joints are revolute, prismatic, planar or fixed";
        return Err(table.refuse("type", format!("a {word} joint leaves the plane"), help));
    }
    let kind = match word {
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        "helical" => JointKind::Helical {
            pitch: table.number("pitch")?.ok_or_else(|| table.missing("pitch"))?,
        },
        "cylindrical" => JointKind::Cylindrical,
        "universal" => JointKind::Universal {
            second: table.vec3("axis2")?.ok_or_else(|| table.missing("axis2"))?,
        },
        "spherical" => JointKind::Spherical,
        "planar" => JointKind::Planar,
        "fixed" => JointKind::Fixed,
        "free" => JointKind::Free,
        other => {
            let unknown = Error::unknown("joint type", other, TYPES);
            let help = format!("the types are {}", TYPES.join(", "));
            return Err(table.refuse("type", unknown.to_string(), help));
        }
    };
    for (key, kind_word) in [("pitch", "helical"), ("axis2", "universal")] {
        if table.has(key) && word != kind_word {
            let message = format!("a {word} joint has no {key}, only a {kind_word} one has");
            return Err(table.refuse(key, message, "remove it or change the type"));
        }
    }
    let normal = planar && !matches!(kind, JointKind::Prismatic);
    let given = if normal { table.vec3("axis")? } else { table.vector("axis", planar)? };
    let axis = match (kind, given) {
        (JointKind::Fixed | JointKind::Spherical | JointKind::Free, _) => Vec3::Z,
        (_, None) if normal => Vec3::Z,
        (_, None) => return Err(table.missing("axis")),
        (_, Some(axis)) => axis,
    };
    if normal && (axis.x != 0.0 || axis.y != 0.0) {
        let help = "with dimension = 2 the axis is [0, 0, 1], [0, 0, -1] or left out";
        return Err(table.refuse("axis", format!("the axis of a {word} joint leaves z"), help));
    }
    if axis.unit(ZERO_AXIS).is_none() {
        return Err(table.refuse(
            "axis",
            "the axis has no direction",
            "give a vector that is not zero",
        ));
    }
    Ok((kind, axis))
}
