//! The `[[contact]]` tables of a mechanism file: a point, a normal, a tangent, in world axes at
//! home.
//!
//! Formula  world_from_contact = [x y z | point], z = normal, x = tangent less its part along the
//!          normal, y = z x x
//! Valid    the normal is optional for contacts independent of it (hard_finger, complete), the
//!          tangent for all but line contacts; in the plane the tangent follows from the normal
//! Checked  tests/formats/closed_file.rs::contacts_*

use super::names::GROUND;
use super::value::Table;
use super::world::World;
use crate::error::{Error, Result};
use crate::model::{ContactKind, ContactSpec};
use crate::spatial::{Mat3, Pose, Rotation, Vec3};
use crate::tolerance::ZERO_AXIS;

const KEYS: [&str; 7] = ["name", "type", "between", "point", "normal", "tangent", "friction"];

/// A contact as read from the file.
pub(super) struct ContactEntry<'t> {
    table: Table<'t>,
    pub(super) name: &'t str,
    kind: ContactKind,
    pub(super) between: [&'t str; 2],
    pub(super) point: Vec3,
    axes: Rotation,
    friction: Option<f64>,
}

/// The `[[contact]]` tables.
pub(super) fn tables<'t>(file: &Table<'t>) -> Result<Vec<Table<'t>>> {
    file.tables("contact", "[[contact]]", &KEYS)
}

/// The contacts as read from the file.
pub(super) fn contacts<'t>(file: &Table<'t>, planar: bool) -> Result<Vec<ContactEntry<'t>>> {
    tables(file)?.into_iter().map(|t| read(t, planar)).collect()
}

fn read(table: Table<'_>, planar: bool) -> Result<ContactEntry<'_>> {
    let name = table.required_string("name")?;
    let between = table.pair("between")?;
    let kind = ContactKind::parse(table.required_string("type")?).map_err(|e| {
        let help = format!("the types are {}", ContactKind::ALL.map(ContactKind::name).join(", "));
        table.refuse("type", e.to_string(), help)
    })?;
    let point = table.vector("point", planar)?.ok_or_else(|| table.missing("point"))?;
    let axes = axes(&table, kind, planar)?;
    let friction = table.number("friction")?;
    Ok(ContactEntry { name, kind, between, point, axes, friction, table })
}

fn axes(table: &Table<'_>, kind: ContactKind, planar: bool) -> Result<Rotation> {
    let direction = |key: &str| {
        let Some(vector) = table.vector(key, planar)? else { return Ok(None) };
        let help = "give a vector that is not zero";
        let none = || table.refuse(key, format!("the {key} has no direction"), help);
        vector.unit(ZERO_AXIS).map(Some).ok_or_else(none)
    };
    let any_normal = matches!(kind, ContactKind::HardFinger | ContactKind::Complete)
        || (planar && matches!(kind, ContactKind::SoftFinger | ContactKind::LineFriction));
    let normal = match direction("normal")? {
        Some(normal) => normal,
        None if any_normal && planar => Vec3::Y,
        None if any_normal => Vec3::Z,
        None => return Err(table.missing("normal")),
    };
    let is_line = matches!(kind, ContactKind::LineFrictionless | ContactKind::LineFriction);
    let tangent = match direction("tangent")? {
        Some(tangent) => tangent,
        None if planar => Vec3::new(normal.y, -normal.x, 0.0),
        None if is_line => return Err(table.missing("tangent")),
        None => return Ok(Rotation::z_to(normal).unwrap_or_default()),
    };
    let Some(x) = (tangent - normal * normal.dot(tangent)).unit(ZERO_AXIS) else {
        let message = "the tangent is along the normal";
        return Err(table.refuse("tangent", message, "give a direction in the contact plane"));
    };
    let columns = Mat3::from_cols(x, normal.cross(x), normal);
    Rotation::from_matrix(columns).map_err(|e| table.refuse("tangent", e.to_string(), ""))
}

/// Rejects a contact whose first link is defined nowhere else: only the touched (second) link may
/// be an object defined by its contacts alone.
pub(super) fn check(
    contacts: &[ContactEntry<'_>],
    world: &World<'_>,
    joined: &[&str],
) -> Result<()> {
    let is_object = |link: &str| contacts.iter().any(|c| c.between[1] == link);
    for contact in contacts {
        let [a, b] = contact.between;
        if a == b {
            let message = format!("contact '{}' connects link '{a}' with itself", contact.name);
            return Err(contact.table.refuse("between", message, "name two links"));
        }
        if !(world.has(a) || joined.contains(&a) || is_object(a)) {
            let mut links = world.placed();
            links.extend(joined.iter().map(|link| (*link).to_owned()));
            links.sort();
            links.dedup();
            let unknown = Error::unknown("link", a, links);
            let help = "the first link of a contact is one that a joint or a robot brings, the \
                        second may be an object";
            return Err(contact.table.refuse("between", unknown.to_string(), help));
        }
        if b == GROUND && !world.has(GROUND) {
            let root = world.placed().into_iter().next().unwrap_or_default();
            let message = format!("this mechanism has no link '{GROUND}'; its root is '{root}'");
            return Err(contact.table.refuse("between", message, "name that one"));
        }
    }
    Ok(())
}

/// Writes the contacts, once all links are placed.
pub(super) fn write(world: &mut World<'_>, contacts: &[ContactEntry<'_>]) {
    for contact in contacts {
        let world_from_contact = Pose { rotation: contact.axes, translation: contact.point };
        let [a, b] = contact.between;
        let on = |world: &World<'_>, link| world.pose(link).inverse() * world_from_contact;
        let (link_a_from_contact, link_b_from_contact) = (on(world, a), on(world, b));
        world.builder.contact(ContactSpec {
            name: contact.name.to_owned(),
            kind: contact.kind,
            a: a.to_owned(),
            b: b.to_owned(),
            link_a_from_contact,
            link_b_from_contact,
            friction: contact.friction,
        });
    }
}
