//! Links of a URDF: inertia, shapes, materials. Kept as data and not used by kinematics, so missing
//! values are reported and never prevent a robot from being loaded.
//!
//! Checked  tests/formats/urdf.rs::shapes_*, tests/formats/lax.rs::meshes_*

use std::collections::BTreeMap;

use roxmltree::Node;

use crate::error::Result;
use crate::model::formats::mesh::Packages;
use crate::model::formats::xml::Reader;
use crate::model::{Collision, Geometry, Inertial, Link, Visual};
use crate::spatial::{Mat3, Vec3};

/// Colours by the name of the material.
pub(super) type Materials = BTreeMap<String, [f64; 4]>;

impl Reader<'_> {
    /// The colours of all named materials: global ones, then those defined in a link.
    pub(super) fn materials(&mut self, robot: Node<'_, '_>) -> Materials {
        let global = robot.children().filter(|n| self.is(*n, "material"));
        let nested = robot.descendants().filter(|n| self.is(*n, "material"));
        let all: Vec<_> = global.chain(nested).collect();
        let mut materials = Materials::new();
        for node in all {
            self.leftovers(node, &["name"], &["color"]);
            let name = node.attribute("name").unwrap_or("");
            if name.is_empty() || materials.contains_key(name) {
                continue;
            }
            if let Some(rgba) = self.color(node) {
                materials.insert(name.to_owned(), rgba);
            }
        }
        materials
    }

    /// The colour given in a material itself.
    fn color(&mut self, material: Node<'_, '_>) -> Option<[f64; 4]> {
        let color = self.child(material, "color")?;
        self.leftovers(color, &["rgba"], &[]);
        match self.vector::<4>(color, "rgba") {
            Ok(Some(rgba)) => Some(rgba),
            // Files with three numbers are common.
            _ => self.vector::<3>(color, "rgba").ok()?.map(|[r, g, b]| [r, g, b, 1.0]),
        }
    }

    pub(super) fn link(
        &mut self,
        node: Node<'_, '_>,
        materials: &Materials,
        packages: &Packages,
    ) -> Result<Link> {
        let name = self.required(node, "name")?;
        self.leftovers(node, &["name"], &["inertial", "visual", "collision"]);
        let mut link = Link::named(name);
        link.inertial = self.inertial(node)?;
        for child in node.children().filter(Node::is_element) {
            if self.is(child, "visual") {
                link.visuals.extend(self.shape(child, materials, packages)?);
            } else if self.is(child, "collision") {
                link.collisions
                    .extend(self.shape(child, materials, packages)?.map(Collision::from));
            }
        }
        Ok(link)
    }

    fn inertial(&mut self, link: Node<'_, '_>) -> Result<Option<Inertial>> {
        let Some(node) = self.child(link, "inertial") else { return Ok(None) };
        self.leftovers(node, &[], &["origin", "mass", "inertia"]);
        let owner = link.attribute("name").unwrap_or("");
        let link_from_inertia = self.origin(node)?;
        let mass = match self.child(node, "mass") {
            Some(mass) => {
                self.leftovers(mass, &["value"], &[]);
                self.number(mass, "value")?
            }
            None => None,
        };
        let Some(mass) = mass else {
            self.notes.add(node.range().start, "<inertial>", "it gives no mass", owner);
            return Ok(None);
        };
        let mut inertia = Mat3::ZERO;
        if let Some(child) = self.child(node, "inertia") {
            self.leftovers(child, &["ixx", "iyy", "izz", "ixy", "ixz", "iyz"], &[]);
            let entry = |name| self.number(child, name).map(|x| x.unwrap_or(0.0));
            let (xx, yy, zz) = (entry("ixx")?, entry("iyy")?, entry("izz")?);
            let (xy, xz, yz) = (entry("ixy")?, entry("ixz")?, entry("iyz")?);
            inertia = Mat3::from_rows([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        } else {
            let why = "moments of inertia are missing and read as zero";
            self.notes.add(node.range().start, "<inertia> missing", why, owner);
        }
        Ok(Some(Inertial { mass, link_from_inertia, inertia }))
    }

    /// A `<visual>` or `<collision>`; `None` (and a note) if it has no shape.
    fn shape(
        &mut self,
        node: Node<'_, '_>,
        materials: &Materials,
        packages: &Packages,
    ) -> Result<Option<Visual>> {
        self.leftovers(node, &["name"], &["origin", "geometry", "material"]);
        let link_from_shape = self.origin(node)?;
        let Some(geometry) = self.geometry(node, packages)? else {
            let what = format!("<{}> without a shape", node.tag_name().name());
            let link = self.owner(node);
            self.notes.add(node.range().start, what, "there is nothing to draw", link);
            return Ok(None);
        };
        let rgba = match self.child(node, "material") {
            None => None,
            Some(material) => {
                let named = material.attribute("name").and_then(|n| materials.get(n).copied());
                let rgba = self.color(material).or(named);
                if rgba.is_none() {
                    let name = material.attribute("name").unwrap_or("");
                    let why = "it has no colour that can be read";
                    self.notes.add(material.range().start, "<material>", why, name);
                }
                rgba
            }
        };
        let name = node.attribute("name").unwrap_or("").to_owned();
        Ok(Some(Visual { name, link_from_shape, geometry, rgba }))
    }

    fn geometry(&mut self, shape: Node<'_, '_>, packages: &Packages) -> Result<Option<Geometry>> {
        let Some(parent) = self.child(shape, "geometry") else { return Ok(None) };
        self.leftovers(parent, &[], &["box", "cylinder", "capsule", "sphere", "mesh"]);
        let Some(node) = parent.children().find(Node::is_element) else { return Ok(None) };
        let attributes: &[&str] = match node.tag_name().name() {
            "box" => &["size"],
            "cylinder" | "capsule" => &["radius", "length"],
            "sphere" => &["radius"],
            "mesh" => &["filename", "scale"],
            _ => &[],
        };
        self.leftovers(node, attributes, &[]);
        let radius_and_length = |reader: &Self| -> Result<Option<(f64, f64)>> {
            let (radius, length) = (reader.number(node, "radius")?, reader.number(node, "length")?);
            Ok(radius.zip(length))
        };
        Ok(match node.tag_name().name() {
            "box" => self
                .vector::<3>(node, "size")?
                .map(|size| Geometry::Box { size: Vec3::from_array(size) }),
            "cylinder" => radius_and_length(self)?
                .map(|(radius, length)| Geometry::Cylinder { radius, length }),
            "capsule" => radius_and_length(self)?
                .map(|(radius, length)| Geometry::Capsule { radius, length }),
            "sphere" => self.number(node, "radius")?.map(|radius| Geometry::Sphere { radius }),
            "mesh" => self.mesh(node, packages)?,
            _ => None,
        })
    }

    fn mesh(&mut self, node: Node<'_, '_>, packages: &Packages) -> Result<Option<Geometry>> {
        let Some(uri) = node.attribute("filename") else { return Ok(None) };
        let scale =
            self.vector::<3>(node, "scale")?.map_or(Vec3::new(1.0, 1.0, 1.0), Vec3::from_array);
        let path = packages.find(uri);
        if path.is_none() {
            let why = "mesh not found: looked in the folders above the file, ROS_PACKAGE_PATH \
                       and AMENT_PREFIX_PATH";
            self.notes.add(node.range().start, "mesh", why, uri);
        }
        Ok(Some(Geometry::Mesh { uri: uri.to_owned(), path, scale }))
    }
}
