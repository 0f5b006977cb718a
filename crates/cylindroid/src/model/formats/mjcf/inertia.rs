//! Masses of MJCF bodies: `<inertial>`, otherwise those of the geoms.
//!
//! Formula  mass = density volume, or the mass of the geom; the inertias of the shapes about their
//!          centres, in the axes of the body about the common centre c:
//!          I = sum R I_k R^T + m_k (|d_k|^2 1 - d_k d_k^T), d_k = c_k - c
//! Units    kg, kg m^2; density in kg/m^3, 1000 if missing
//! Valid    spheres, capsules, cylinders, boxes and ellipsoids, all solid, and meshes
//!          (`mesh_inertia.rs`). A body with a mesh that is not found or has no volume has no mass
//!          here (noted)
//! Why so   `inertiafromgeom`: "auto" takes the geoms where there is no `<inertial>`, "true"
//!          everywhere; only groups of `inertiagrouprange` count
//! Source   mujoco.readthedocs.io, XML reference, compiler
//! Checked  tests/formats/mjcf.rs::masses_*, tests/formats/mesh_masses.rs, tests/formats/corpus.rs
//!          (against MuJoCo)

use std::f64::consts::PI;

use roxmltree::Node;

use super::Mjcf;
use super::attributes::{ORIENTATIONS, used};
use super::compiler::FromGeoms;
use super::copies::Placed;
use super::defaults::Element;
use super::mesh_inertia::{self, Solid};
use crate::error::Result;
use crate::model::{Inertial, mesh_file};
use crate::spatial::{Mat3, Pose, Vec3};

/// Density of geoms [kg/m^3], that of water.
const DENSITY: f64 = 1000.0;

/// A part of a body: mass, centre and inertia about the centre, in the axes of the body.
struct Part {
    mass: f64,
    centre: Vec3,
    inertia: Mat3,
}

impl<'d> Mjcf<'d> {
    /// The mass of a body.
    pub(super) fn mass_of(
        &mut self,
        inertial: Option<(Node<'d, 'd>, Pose)>,
        geoms: &[Placed<'d>],
        body: &str,
    ) -> Result<Option<Inertial>> {
        let from_geoms = match self.compiler.inertia_from_geoms {
            FromGeoms::Never => false,
            FromGeoms::Always => true,
            FromGeoms::WithoutInertial => inertial.is_none(),
        };
        match inertial {
            Some((node, pose)) if !from_geoms => self.inertial(node, pose),
            Some((node, _)) => {
                let why = "inertiafromgeom: the masses of the geoms count";
                self.reader.note(node, "<inertial>", why, body);
                self.of_geoms(geoms, body)
            }
            None if from_geoms => self.of_geoms(geoms, body),
            None => Ok(None),
        }
    }

    fn inertial(&mut self, node: Node<'d, 'd>, link_from_frame: Pose) -> Result<Option<Inertial>> {
        self.reader.unread_attributes(node, &used("inertial"));
        let element = Element::bare(node);
        let mut link_from_inertia = link_from_frame * self.compiler.pose(&self.reader, &element)?;
        for attribute in ["pos", "mass"] {
            self.reader.required(node, attribute)?;
        }
        let mass = element.number(&self.reader, "mass")?.unwrap_or_default();
        let diagonal = element.vector::<3>(&self.reader, "diaginertia")?;
        let full = element.vector::<6>(&self.reader, "fullinertia")?;
        let others = ["diaginertia"].into_iter().chain(ORIENTATIONS);
        if let (Some(_), Some(other)) = (full, others.into_iter().find(|a| node.has_attribute(*a)))
        {
            let message = format!("<inertial> has both fullinertia and {other}");
            return Err(self.reader.refuse(node, other, message));
        }
        let [xx, yy, zz, xy, xz, yz] = match (full, diagonal) {
            (Some(full), _) => {
                // Its axes are those of the frame.
                link_from_inertia.rotation = link_from_frame.rotation;
                full
            }
            (None, Some([x, y, z])) => [x, y, z, 0.0, 0.0, 0.0],
            (None, None) => [0.0; 6],
        };
        let inertia = Mat3::from_rows([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        Ok(Some(Inertial { mass, link_from_inertia, inertia }))
    }

    fn of_geoms(&mut self, geoms: &[Placed<'d>], body: &str) -> Result<Option<Inertial>> {
        let mut parts = Vec::new();
        for Placed { node, place, class, .. } in geoms {
            let element = self.defaults.of(&self.reader, *node, *class, &["geom"])?;
            let group = element.number(&self.reader, "group")?.unwrap_or(0.0);
            let [first, last] = self.compiler.inertia_groups;
            let mass = element.number(&self.reader, "mass")?;
            let density = element.number(&self.reader, "density")?.unwrap_or(DENSITY);
            if group < first || group > last || mass.map_or(density, |m| m) == 0.0 {
                continue;
            }
            if let Some(attribute) = [("mass", mass), ("density", Some(density))]
                .into_iter()
                .find_map(|(name, value)| value.filter(|x| *x < 0.0).map(|_| name))
            {
                let message = format!("{attribute} of <geom> is negative");
                return Err(element.refuse(&self.reader, attribute, message));
            }
            let (pose, size) = self.place_and_size(&element)?;
            let kind = self.kind_of(&element);
            let found = match kind {
                "mesh" => element.text("mesh").and_then(|name| self.solid_of_mesh(name)),
                _ => primitive(kind, &size),
            };
            let Some(Solid { volume, centre, inertia }) = found else {
                if !matches!(kind, "plane" | "hfield") {
                    let why = "its mesh has no volume, or was not read: its body has no mass here";
                    self.reader.note(*node, "mass of a geom", why, body);
                    self.of_unread_mass.insert(body.to_owned());
                    return Ok(None);
                }
                continue;
            };
            let mass = mass.unwrap_or(density * volume);
            let pose = *place * pose;
            let axes = pose.rotation.matrix();
            let inertia = axes * (inertia * mass) * axes.transpose();
            parts.push(Part { mass, centre: pose * centre, inertia });
        }
        let mass: f64 = parts.iter().map(|p| p.mass).sum();
        if mass <= 0.0 || !mass.is_finite() {
            return Ok(None);
        }
        let centre = parts.iter().fold(Vec3::ZERO, |c, p| c + p.centre * (p.mass / mass));
        let inertia = parts.iter().fold(Mat3::ZERO, |sum, p| {
            let d = p.centre - centre;
            let [x, y, z] = d.to_array();
            let square = d.dot(d);
            let away = Mat3::from_rows([
                [square - x * x, -x * y, -x * z],
                [-x * y, square - y * y, -y * z],
                [-x * z, -y * z, square - z * z],
            ]);
            sum + p.inertia + away * p.mass
        });
        Ok(Some(Inertial { mass, link_from_inertia: Pose::from_translation(centre), inertia }))
    }

    /// The solid of a mesh asset; its file is read once.
    fn solid_of_mesh(&mut self, name: &str) -> Option<Solid> {
        let mesh = self.assets.meshes.get_mut(name)?;
        if mesh.solid.is_none() {
            let path = self.assets.packages.as_ref().and_then(|p| p.find(&mesh.uri));
            let file = path.and_then(|path| mesh_file::read(&path).ok()).filter(|_| !mesh.is_moved);
            mesh.solid = Some(file.and_then(|f| mesh_inertia::solid(f, mesh.scale, mesh.inertia)));
        }
        mesh.solid?
    }

    /// Scales all masses to the total that the compiler sets.
    pub(super) fn set_total_mass(&mut self) {
        let Some(total) = self.compiler.total_mass.filter(|total| *total > 0.0) else { return };
        let sum: f64 = self.links.iter().filter_map(|l| l.inertial).map(|i| i.mass).sum();
        if sum > 0.0 {
            for inertial in self.links.iter_mut().filter_map(|l| l.inertial.as_mut()) {
                inertial.mass *= total / sum;
                inertial.inertia = inertial.inertia * (total / sum);
            }
        }
    }
}

/// The solid of a shape; sizes as in MJCF, half of the whole.
fn primitive(kind: &str, size: &[f64]) -> Option<Solid> {
    let (volume, [x, y, z]) = volume_and_moments(kind, size)?;
    let inertia = Mat3::from_rows([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
    Some(Solid { volume, centre: Vec3::ZERO, inertia })
}

/// Volume of a solid, and its moments of inertia about its axes for a mass of 1 kg.
fn volume_and_moments(kind: &str, size: &[f64]) -> Option<(f64, [f64; 3])> {
    let square = |x: f64| x * x;
    Some(match (kind, size) {
        ("sphere", [r, ..]) => (4.0 / 3.0 * PI * r * r * r, [0.4 * r * r; 3]),
        ("ellipsoid", [a, b, c]) => {
            let [a2, b2, c2] = [square(*a), square(*b), square(*c)];
            (4.0 / 3.0 * PI * a * b * c, [b2 + c2, a2 + c2, a2 + b2].map(|x| x / 5.0))
        }
        ("box", [a, b, c]) => {
            let [a2, b2, c2] = [square(*a), square(*b), square(*c)];
            (8.0 * a * b * c, [b2 + c2, a2 + c2, a2 + b2].map(|x| x / 3.0))
        }
        ("cylinder", [r, half, ..]) => {
            let across = (3.0 * r * r + 4.0 * half * half) / 12.0;
            (2.0 * PI * r * r * half, [across, across, r * r / 2.0])
        }
        ("capsule", [r, half, ..]) => {
            let length = 2.0 * half;
            let (tube, ball) = (PI * r * r * length, 4.0 / 3.0 * PI * r * r * r);
            let (t, b) = (tube / (tube + ball), ball / (tube + ball));
            let across = t * (3.0 * r * r + length * length) / 12.0
                + b * (0.4 * r * r + 0.375 * r * length + 0.25 * length * length);
            (tube + ball, [across, across, t * r * r / 2.0 + b * 0.4 * r * r])
        }
        _ => return None,
    })
}
