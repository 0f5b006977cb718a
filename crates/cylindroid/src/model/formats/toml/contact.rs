//! The `[[contact]]` tables of a mechanism file: a point, a normal, a tangent, in world axes at
//! home, and the curvature of both bodies.
//!
//! Formula  world_from_contact = [x y z | point], z = normal, x = tangent less its part along the
//!          normal, y = z x x
//! Valid    the normal is optional for contacts independent of it (hard_finger, complete), the
//!          tangent for all but line contacts; in the plane the tangent follows from the normal.
//!          A curvature is a number, or in space a table of two principal curvatures and the
//!          direction of the first, for point contacts with a normal
//! Checked  tests/formats/closed_file.rs::contacts_*, tests/formats/contact_curvature.rs

use super::names::GROUND;
use super::value::{NumberOrTable, Table};
use super::world::World;
use crate::error::{Error, Result};
use crate::model::{ContactCurvature, ContactKind, ContactSpec, SurfaceCurvature};
use crate::spatial::{Mat3, Pose, Rotation, Vec3};
use crate::tolerance::ZERO_AXIS;

const KEYS: [&str; 8] =
    ["name", "type", "between", "point", "normal", "tangent", "friction", "curvature"];
const POINTS: [ContactKind; 3] =
    [ContactKind::PointFrictionless, ContactKind::HardFinger, ContactKind::SoftFinger];

/// A contact as read from the file.
pub(super) struct ContactEntry<'t> {
    table: Table<'t>,
    pub(super) name: &'t str,
    kind: ContactKind,
    pub(super) between: [&'t str; 2],
    pub(super) point: Vec3,
    axes: Rotation,
    friction: Option<f64>,
    curvature: Option<ContactCurvature>,
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
    let curvature = curvature(&table, kind, axes, planar)?;
    Ok(ContactEntry { name, kind, between, point, axes, friction, curvature, table })
}

/// The curvature of both links, in the axes of the contact frame.
fn curvature(
    table: &Table<'_>,
    kind: ContactKind,
    axes: Rotation,
    planar: bool,
) -> Result<Option<ContactCurvature>> {
    let keys = ["principal", "direction"];
    let Some(entries) = table.numbers_or_tables("curvature", "curvature", &keys)? else {
        return Ok(None);
    };
    if !POINTS.contains(&kind) {
        let message = format!("a contact of type {} has no curvature", kind.name());
        let help = format!(
            "leave it out; only contacts in a point have one: {}",
            POINTS.map(ContactKind::name).join(", ")
        );
        return Err(table.refuse("curvature", message, help));
    }
    if !table.has("normal") {
        let message = "a contact with a curvature needs a normal";
        return Err(table.refuse("curvature", message, "write normal = [...]"));
    }
    let Ok([finger, object]) = <[NumberOrTable<'_>; 2]>::try_from(entries) else {
        let message = "curvature does not consist of two entries";
        let help = "give the curvatures of the first and of the second link [1/m], \
                    curvature = [100, 0]";
        return Err(table.refuse("curvature", message, help));
    };
    let read = |entry: NumberOrTable<'_>| match entry {
        NumberOrTable::Number(curvature) => Ok(SurfaceCurvature::uniform(curvature)),
        NumberOrTable::Table(own) if planar => {
            let message = "in the plane a curvature is one number";
            Err(own.refuse("principal", message, "write curvature = [100, 0]"))
        }
        NumberOrTable::Table(own) => {
            let principal = own.two_bounds("principal")?.ok_or_else(|| own.missing("principal"))?;
            let direction = own.vec3("direction")?.ok_or_else(|| own.missing("direction"))?;
            Ok(SurfaceCurvature { principal, direction }.rotated(axes.inverse()))
        }
    };
    let curvature = ContactCurvature { finger: read(finger)?, object: read(object)? };
    let normal = if planar { Vec3::Y } else { Vec3::Z };
    let refuse = |message| table.refuse("curvature", message, "correct the curvatures");
    curvature.check(normal, planar).map_err(refuse)?;
    Ok(Some(curvature))
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
            curvature: contact.curvature,
        });
    }
}
