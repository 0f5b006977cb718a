//! The `[[elasticity]]` tables of a mechanism file: stiffness and compliance of joints, contacts and
//! links.
//!
//! Keys     one of joint, contact and link; stiffness: along the motion of a joint, of each of its
//!          coordinates; compliance: the diagonal or the rows of a matrix, linear part first; point
//!          (world at home): by default the origin of the joint, needed for links
//! Units    N m/rad or N/m; m/N and rad/(N m)
//! Frame    compliance at the point, in world axes at home, fixed to the link (of a joint: to the
//!          first link of `between`; of a joint of an included robot: the frame of the joint)
//! Checked  tests/formats/elasticity.rs

use super::value::Table;
use super::world::World;
use crate::error::Result;
use crate::linalg::Matrix;
use crate::model::{Dimension, ElasticBody, ElasticElement, ElasticKind, Elasticity};
use crate::spatial::{Pose, Vec3};

const KEYS: [&str; 6] = ["joint", "contact", "link", "stiffness", "compliance", "point"];

/// Writes the tables, once all links are placed. `placed` gives the first link of a joint or contact
/// of this file, and its origin.
pub(super) fn write(
    file: &Table<'_>,
    world: &mut World<'_>,
    placed: impl Fn(&str) -> Option<(String, Option<Vec3>)>,
) -> Result<()> {
    let mut elasticity = Elasticity::default();
    for table in file.tables("elasticity", "[[elasticity]]", &KEYS)? {
        let given: Vec<&str> = KEYS[..3].iter().copied().filter(|k| table.has(k)).collect();
        let [key] = given[..] else {
            let help = "name one part: joint, contact or link";
            let message = "an [[elasticity]] table is of one joint, contact or link";
            return Err(table.refuse(given.get(1).unwrap_or(&"joint"), message, help));
        };
        let name = table.required_string(key)?;
        world.note_place(&format!("elasticity of {name}"), table.at(key));
        if key == "link" {
            world.check_link(&table, key, name)?;
        }
        if !table.has("stiffness") && !table.has("compliance") {
            return Err(table.missing("compliance"));
        }
        if table.has("stiffness") {
            if key != "joint" {
                let help = "give a compliance";
                return Err(table.refuse("stiffness", "only joints have a stiffness", help));
            }
            let stiffness = table.number("stiffness")?.unwrap_or(0.0);
            elasticity.stiffness(name, stiffness);
        }
        if table.has("compliance") {
            let compliance = compliance(&table, world.dimension)?;
            let point = table.vector("point", world.dimension == Dimension::Planar)?;
            let part = if key == "link" { Some((name.to_owned(), None)) } else { placed(name) };
            let frame = match (point, part) {
                (None, Some((_, None))) => return Err(table.missing("point")),
                (None, None) => None,
                (Some(_), None) => {
                    let help = "omit it: the compliance is in the frame of the joint";
                    let message = format!("joint '{name}' is not one of this file");
                    return Err(table.refuse("point", message, help));
                }
                (given, Some((link, origin))) => {
                    let point = given.or(origin).unwrap_or(Vec3::ZERO);
                    let place = world.pose(&link).inverse() * Pose::from_translation(point);
                    Some((link, place))
                }
            };
            let body = ElasticBody { compliance, frame };
            let kind =
                if key == "link" { ElasticKind::Link(body) } else { ElasticKind::Joint(body) };
            elasticity.elements.push(ElasticElement { name: name.to_owned(), kind });
        }
    }
    world.builder.elasticity(elasticity);
    Ok(())
}

fn compliance(table: &Table<'_>, dimension: Dimension) -> Result<Matrix> {
    let d = dimension.freedoms();
    let wrong = || {
        let help = format!("write {d} numbers (the diagonal) or {d} rows of {d}");
        table.refuse("compliance", format!("the compliance must have {d} rows"), &help)
    };
    let rows = table.number_rows("compliance")?;
    match &rows[..] {
        [diagonal] if diagonal.len() == d => Ok(Matrix::diagonal(diagonal)),
        rows if rows.len() == d => {
            Matrix::from_rows(rows).filter(|m| m.cols() == d).ok_or_else(wrong)
        }
        _ => Err(wrong()),
    }
}
