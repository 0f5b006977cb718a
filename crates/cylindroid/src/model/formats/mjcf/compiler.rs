//! The `<compiler>` of MJCF and its settings: units of angles, orientations, mesh folder.
//!
//! Formula  quat w x y z; axisangle x y z a; euler by eulerseq, lower case about moving axes, upper
//!          case about fixed ones; xyaxes x y, y made orthogonal to x; zaxis: the smallest rotation
//!          of z onto it
//! Units    degrees unless angle = "radian"; lengths in m
//! Source   mujoco.readthedocs.io, Modeling, frame orientations and compiler
//! Checked  tests/formats/mjcf.rs::poses_*

use super::attributes::ORIENTATIONS;
use super::defaults::Element;
use super::files::Files;
use crate::error::{Error, Result};
use crate::model::formats::xml::Reader;
use crate::spatial::{Mat3, Pose, Quaternion, Rotation, Vec3};
use crate::tolerance::ZERO_AXIS;

/// When the masses of bodies are those of their geoms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FromGeoms {
    Never,
    Always,
    WithoutInertial,
}

/// The settings of a model.
#[derive(Debug, Clone)]
pub(super) struct Compiler {
    /// The file's unit of angle in rad.
    pub(super) unit: f64,
    sequence: [char; 3],
    pub(super) autolimits: bool,
    /// Folder of meshes, relative to that of the model.
    pub(super) meshes: String,
    pub(super) inertia_from_geoms: FromGeoms,
    /// First and last group of the geoms that have mass.
    pub(super) inertia_groups: [f64; 2],
    pub(super) total_mass: Option<f64>,
    /// True if all bodies get some mass and inertia in MuJoCo.
    pub(super) bounds_masses: bool,
}

impl Compiler {
    pub(super) fn read(files: &Files<'_>, reader: &mut Reader<'_>) -> Result<Self> {
        let degree = std::f64::consts::PI / 180.0;
        let mut it = Self {
            unit: degree,
            sequence: ['x', 'y', 'z'],
            autolimits: true,
            meshes: String::new(),
            inertia_from_geoms: FromGeoms::WithoutInertial,
            inertia_groups: [0.0, 5.0],
            total_mass: None,
            bounds_masses: false,
        };
        let root = files.children(files.main.root_element());
        for node in root.into_iter().filter(|n| n.has_tag_name("compiler")) {
            let known = [
                "angle",
                "eulerseq",
                "autolimits",
                "meshdir",
                "assetdir",
                "coordinate",
                "inertiafromgeom",
                "inertiagrouprange",
                "settotalmass",
            ];
            reader.unread_attributes(node, &known);
            match node.attribute("angle").map(str::trim) {
                None => {}
                Some("radian") => it.unit = 1.0,
                Some("degree") => it.unit = degree,
                Some(other) => {
                    let unknown = Error::unknown("angle", other, ["radian", "degree"]);
                    return Err(reader.refuse(node, "angle", unknown.to_string()));
                }
            }
            if let Some(text) = node.attribute("eulerseq") {
                let letters: Vec<char> = text.trim().chars().collect();
                match <[char; 3]>::try_from(letters) {
                    Ok(three) if three.iter().all(|c| "xyzXYZ".contains(*c)) => it.sequence = three,
                    _ => {
                        let message = format!("eulerseq is '{text}', three letters of xyzXYZ");
                        return Err(reader.refuse(node, "eulerseq", message));
                    }
                }
            }
            match node.attribute("autolimits").map(str::trim) {
                None => {}
                Some("true") => it.autolimits = true,
                Some("false") => it.autolimits = false,
                Some(other) => {
                    let message = format!("autolimits is '{other}', not true or false");
                    return Err(reader.refuse(node, "autolimits", message));
                }
            }
            match node.attribute("inertiafromgeom").map(str::trim) {
                Some("true") => it.inertia_from_geoms = FromGeoms::Always,
                Some("false") => it.inertia_from_geoms = FromGeoms::Never,
                _ => {}
            }
            if let Some(groups) = reader.vector::<2>(node, "inertiagrouprange")? {
                it.inertia_groups = groups;
            }
            let is_positive = |attribute: &str| -> Result<bool> {
                Ok(reader.number(node, attribute)?.is_some_and(|least| least > 0.0))
            };
            it.bounds_masses |= is_positive("boundmass")? && is_positive("boundinertia")?;
            it.total_mass = reader.number(node, "settotalmass")?.or(it.total_mass);
            if node.attribute("coordinate").is_some_and(|c| c.trim() == "global") {
                let message = "coordinate = \"global\" was removed from MJCF";
                return Err(reader.refuse(node, "coordinate", message));
            }
            if let Some(folder) = node.attribute("meshdir").or(node.attribute("assetdir")) {
                folder.trim().clone_into(&mut it.meshes);
            }
        }
        Ok(it)
    }

    /// The pose of an element: `pos` and one of the orientation attributes.
    pub(super) fn pose(&self, reader: &Reader<'_>, element: &Element<'_>) -> Result<Pose> {
        let translation = element.vector::<3>(reader, "pos")?.map_or(Vec3::ZERO, Vec3::from_array);
        Ok(Pose { rotation: self.orientation(reader, element)?, translation })
    }

    fn orientation(&self, reader: &Reader<'_>, element: &Element<'_>) -> Result<Rotation> {
        let mut given = ORIENTATIONS.into_iter().filter(|a| element.node.has_attribute(*a));
        if let (Some(first), Some(second)) = (given.next(), given.next()) {
            let message =
                format!("<{}> has both {first} and {second}", element.node.tag_name().name());
            return Err(element.refuse(reader, second, message));
        }
        let refuse = |attribute: &str, message: &str| {
            Err(element.refuse(reader, attribute, message.to_owned()))
        };
        if let Some([w, x, y, z]) = element.vector::<4>(reader, "quat")? {
            return Quaternion { w, x, y, z }
                .rotation()
                .map_err(|e| element.refuse(reader, "quat", e.to_string()));
        }
        if let Some([x, y, z, angle]) = element.vector::<4>(reader, "axisangle")? {
            return match Rotation::about(Vec3::new(x, y, z), angle * self.unit) {
                Some(rotation) => Ok(rotation),
                None => refuse("axisangle", "the axis has no direction"),
            };
        }
        if let Some(angles) = element.vector::<3>(reader, "euler")? {
            return Ok(self.euler(angles));
        }
        if let Some([a, b, c, d, e, f]) = element.vector::<6>(reader, "xyaxes")? {
            let (x, y) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
            let axes = x.unit(ZERO_AXIS).and_then(|x| {
                let y = (y - x * x.dot(y)).unit(ZERO_AXIS)?;
                Rotation::from_matrix(Mat3::from_cols(x, y, x.cross(y))).ok()
            });
            let none = || refuse("xyaxes", "the two axes are zero or parallel");
            return axes.map_or_else(none, Ok);
        }
        if let Some(z) = element.vector::<3>(reader, "zaxis")? {
            return match turn_z_to(Vec3::from_array(z)) {
                Some(rotation) => Ok(rotation),
                None => refuse("zaxis", "the axis has no direction"),
            };
        }
        Ok(Rotation::IDENTITY)
    }

    /// The rotation by three angles in the file's unit, by `eulerseq`.
    pub(super) fn euler(&self, angles: [f64; 3]) -> Rotation {
        let mut rotation = Rotation::IDENTITY;
        for (letter, angle) in self.sequence.into_iter().zip(angles) {
            let axis = match letter.to_ascii_lowercase() {
                'x' => Vec3::X,
                'y' => Vec3::Y,
                _ => Vec3::Z,
            };
            let turn = Rotation::about(axis, angle * self.unit).unwrap_or_default();
            rotation = if letter.is_lowercase() { rotation * turn } else { turn * rotation };
        }
        rotation
    }
}

/// The least distance of the points of `fromto` [m]: MuJoCo refuses 1e-7 and accepts 1e-6.
const LEAST_LENGTH: f64 = 5e-7;

impl Element<'_> {
    /// The pose between the two points of `fromto`, z from the second to the first, and half their
    /// distance; `None` without the attribute. It is of a shape of this type.
    pub(super) fn between(&self, reader: &Reader<'_>, kind: &str) -> Result<Option<(Pose, f64)>> {
        let Some([a, b, c, d, e, f]) = self.vector::<6>(reader, "fromto")? else { return Ok(None) };
        let (from, to) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let refuse = |why: &str| {
            let tag = self.node.tag_name().name();
            Err(self.refuse(reader, "fromto", format!("fromto of <{tag}>: {why}")))
        };
        if !matches!(kind, "capsule" | "cylinder" | "box" | "ellipsoid") {
            return refuse(&format!(
                "it gives capsules, cylinders, boxes and ellipsoids, and the type is {kind}"
            ));
        }
        if self.source_element("mesh").is_some() {
            return refuse("it does not give the place of a mesh");
        }
        if (from - to).norm() < LEAST_LENGTH {
            return refuse("its two points are one");
        }
        let rotation = turn_z_to(from - to).unwrap_or_default();
        let pose = Pose { rotation, translation: (from + to) * 0.5 };
        Ok(Some((pose, (from - to).norm() * 0.5)))
    }
}

/// The smallest rotation of z to a direction; half a turn about x if it is -z.
pub(super) fn turn_z_to(direction: Vec3) -> Option<Rotation> {
    let direction = direction.unit(ZERO_AXIS)?;
    let across = Vec3::Z.cross(direction);
    let sine = across.norm();
    if sine <= ZERO_AXIS {
        let half = Rotation::about(Vec3::X, std::f64::consts::PI);
        return if direction.z > 0.0 { Some(Rotation::IDENTITY) } else { half };
    }
    Rotation::about(across, sine.atan2(direction.z))
}
