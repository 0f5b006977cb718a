//! The joints of a mechanism file: a graph in world axes at q = 0, hung up at `ground`.
//!
//! Formula  parent_from_joint = Trans(origin - parent's origin): every link frame has world axes
//!          at q = 0 and lies at the origin of the joint that leads to ground
//! Why so   a joint written from the far link to the near one keeps its q, the motion of the
//!          second link relative to the first. Its inverse is the same motion about the opposite
//!          axis for all kinds of one axis, pitch included; the others must be written near
//!          link first
//! Checked  tests/formats/mechanism_file.rs

use std::collections::{BTreeMap, VecDeque};

use super::value::Table;
use crate::error::{Error, Result};
use crate::model::{JointKind, JointSpec, Limits, Mimic};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::ZERO_AXIS;

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

/// The root of every mechanism file.
pub(super) const GROUND: &str = "ground";

/// A joint as it stands in the file.
struct Written<'t> {
    table: Table<'t>,
    name: &'t str,
    kind: JointKind,
    between: [&'t str; 2],
    origin: Option<Vec3>,
    axis: Vec3,
    limits: Limits,
    mimic: Option<Mimic>,
    actuated: bool,
}

/// The `[[joint]]` tables.
pub(super) fn tables<'t>(file: &Table<'t>) -> Result<Vec<Table<'t>>> {
    file.tables("joint", "[[joint]]", &KEYS)
}

/// The joints of the `[[joint]]` tables, parents before children.
pub(super) fn joints(file: &Table<'_>, planar: bool) -> Result<Vec<JointSpec>> {
    let written: Vec<Written<'_>> =
        tables(file)?.into_iter().map(|t| read(t, planar)).collect::<Result<_>>()?;
    refuse_loops(&written)?;

    let mut at_link: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, joint) in written.iter().enumerate() {
        for link in joint.between {
            at_link.entry(link).or_default().push(i);
        }
    }
    let mut origins = BTreeMap::from([(GROUND, Vec3::ZERO)]);
    let mut queue = VecDeque::from([GROUND]);
    let mut done = vec![false; written.len()];
    let mut specs = Vec::with_capacity(written.len());
    while let Some(parent) = queue.pop_front() {
        for &i in at_link.get(parent).map_or(&[][..], Vec::as_slice) {
            if std::mem::replace(&mut done[i], true) {
                continue;
            }
            let joint = &written[i];
            let reversed = joint.between[1] == parent;
            let child = joint.between[usize::from(!reversed)];
            let parent_origin = origins.get(parent).copied().unwrap_or(Vec3::ZERO);
            let origin = joint.origin.unwrap_or(parent_origin);
            specs.push(spec(joint, parent, child, origin - parent_origin, reversed)?);
            origins.insert(child, origin);
            queue.push_back(child);
        }
    }
    match done.iter().position(|d| !d) {
        None => Ok(specs),
        Some(i) => {
            let joint = &written[i];
            let [a, b] = joint.between;
            let grounded = at_link.contains_key(GROUND);
            let message = format!(
                "joint '{}' hangs in the air: neither '{a}' nor '{b}' is connected to '{GROUND}'",
                joint.name
            );
            let help = if grounded {
                "connect one of its links, or check the spelling of their names"
            } else {
                "name the fixed link ground, or add a joint of type free from ground"
            };
            Err(joint.table.refuse("between", message, help))
        }
    }
}

fn read(table: Table<'_>, planar: bool) -> Result<Written<'_>> {
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
    Ok(Written { name, kind, between, origin, axis, limits, mimic, actuated, table })
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

/// Refuses the first joint between two links that are already connected.
fn refuse_loops(written: &[Written<'_>]) -> Result<()> {
    let mut index: BTreeMap<&str, usize> = BTreeMap::new();
    let mut group: Vec<usize> = Vec::new();
    for joint in written {
        let [a, b] = joint.between.map(|link| {
            let i = *index.entry(link).or_insert_with(|| {
                group.push(group.len());
                group.len() - 1
            });
            representative(&mut group, i)
        });
        if a == b {
            let [a, b] = joint.between;
            let message = if a == b {
                format!("joint '{}' connects link '{a}' with itself", joint.name)
            } else {
                format!(
                    "joint '{}' closes a loop: '{a}' and '{b}' are already connected",
                    joint.name
                )
            };
            let help = "this version reads trees only; leave out one joint of the loop";
            return Err(joint.table.refuse("between", message, help));
        }
        group[a] = b;
    }
    Ok(())
}

fn representative(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

fn spec(
    joint: &Written<'_>,
    parent: &str,
    child: &str,
    parent_to_origin: Vec3,
    reversed: bool,
) -> Result<JointSpec> {
    let one_axis = !matches!(
        joint.kind,
        JointKind::Universal { .. } | JointKind::Spherical | JointKind::Planar | JointKind::Free
    );
    if reversed && !one_axis {
        let message = format!(
            "joint '{}' is {} and written from the far link to the one nearer to ground",
            joint.name,
            joint.kind.name()
        );
        let help = format!("write between = [\"{parent}\", \"{child}\"]");
        return Err(joint.table.refuse("between", message, help));
    }
    Ok(JointSpec {
        name: joint.name.to_owned(),
        kind: joint.kind,
        parent: parent.to_owned(),
        child: child.to_owned(),
        parent_from_joint: Pose::from_translation(parent_to_origin),
        joint_from_child: Pose::IDENTITY,
        axis: if reversed { -joint.axis } else { joint.axis },
        limits: joint.limits,
        mimic: joint.mimic.clone(),
        actuated: joint.actuated,
    })
}
