//! Links of SDF: mass and shapes, kept as data.
//!
//! Checked  tests/formats/sdf.rs

use roxmltree::Node;

use crate::error::Result;
use crate::model::formats::mesh::Packages;
use crate::model::formats::xml::Reader;
use crate::model::{Collision, Geometry, Inertial, Link, Visual};
use crate::spatial::{Mat3, Pose, Rotation, Vec3};

impl Reader<'_> {
    /// A link under its full name.
    pub(super) fn sdf_link(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        packages: &Packages,
    ) -> Result<Link> {
        self.leftovers(node, &["name"], &["pose", "inertial", "visual", "collision"]);
        let mut link = Link::named(name);
        if let Some(inertial) = self.child(node, "inertial") {
            link.inertial = self.sdf_inertial(inertial, name)?;
        }
        for child in node.children().filter(|c| c.has_tag_name("visual")) {
            link.visuals.extend(self.sdf_shape(child, packages)?);
        }
        for child in node.children().filter(|c| c.has_tag_name("collision")) {
            link.collisions.extend(self.sdf_shape(child, packages)?.map(Collision::from));
        }
        Ok(link)
    }

    /// The pose in a link; a pose relative to another frame is reported as unused.
    fn pose_on_link(&mut self, node: Node<'_, '_>) -> Result<Pose> {
        let Some(pose) = self.child(node, "pose") else { return Ok(Pose::IDENTITY) };
        self.unread_attributes(pose, &super::POSE);
        let given = ["relative_to", "frame"].into_iter().find_map(|a| pose.attribute(a));
        if given.is_some_and(|f| !f.trim().is_empty()) {
            let owner = self.owner(node).to_owned();
            let why = "shapes and masses are taken relative to their link";
            self.note(pose, "relative_to of shapes and masses", why, &owner);
        }
        self.pose_in(pose)
    }

    fn sdf_inertial(&mut self, node: Node<'_, '_>, link: &str) -> Result<Option<Inertial>> {
        self.leftovers(node, &[], &["pose", "mass", "inertia"]);
        let link_from_inertia = self.pose_on_link(node)?;
        let Some(mass) = self.child_number(node, "mass")? else {
            self.note(node, "<inertial>", "it gives no mass", link);
            return Ok(None);
        };
        let mut inertia = Mat3::ZERO;
        if let Some(child) = self.child(node, "inertia") {
            let mut m = [0.0; 6];
            let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
            self.leftovers(child, &[], &names);
            for (slot, name) in m.iter_mut().zip(names) {
                *slot = self.child_number(child, name)?.unwrap_or(0.0);
            }
            let [xx, xy, xz, yy, yz, zz] = m;
            inertia = Mat3::from_rows([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        }
        Ok(Some(Inertial { mass, link_from_inertia, inertia }))
    }

    fn sdf_shape(&mut self, node: Node<'_, '_>, packages: &Packages) -> Result<Option<Visual>> {
        self.leftovers(node, &["name"], &["pose", "geometry", "material"]);
        let mut link_from_shape = self.pose_on_link(node)?;
        let geometry = match self.child(node, "geometry") {
            Some(geometry) => {
                link_from_shape = link_from_shape * self.plane_normal(geometry)?;
                self.sdf_geometry(geometry, packages)?
            }
            None => None,
        };
        let Some(geometry) = geometry else {
            let what = format!("<{}> without a shape", node.tag_name().name());
            let owner = self.owner(node).to_owned();
            self.note(node, what, "there is nothing to draw", &owner);
            return Ok(None);
        };
        let mut rgba = None;
        if let Some(material) = self.child(node, "material") {
            self.leftovers(material, &[], &["diffuse", "ambient"]);
            let colour = ["diffuse", "ambient"].into_iter().find_map(|c| self.child(material, c));
            if let Some(colour) = colour {
                self.value_of(colour);
            }
            // Colours with three numbers are opaque.
            rgba = colour.and_then(|c| match self.finite::<4>(c) {
                Ok(rgba) => Some(rgba),
                Err(_) => self.finite::<3>(c).ok().map(|[r, g, b]| [r, g, b, 1.0]),
            });
        }
        let name = node.attribute("name").unwrap_or("").to_owned();
        Ok(Some(Visual { name, link_from_shape, geometry, rgba }))
    }

    /// The rotation from z to the normal of a plane; none for other shapes.
    fn plane_normal(&mut self, geometry: Node<'_, '_>) -> Result<Pose> {
        let plane = geometry.children().find(|c| c.has_tag_name("plane"));
        let Some(plane) = plane else { return Ok(Pose::IDENTITY) };
        let normal = self.child_vector(plane, "normal")?.unwrap_or(Vec3::Z);
        Ok(Pose::from_rotation(Rotation::z_to(normal).unwrap_or_default()))
    }

    fn sdf_geometry(
        &mut self,
        parent: Node<'_, '_>,
        packages: &Packages,
    ) -> Result<Option<Geometry>> {
        const SHAPES: [&str; 7] =
            ["box", "cylinder", "capsule", "sphere", "ellipsoid", "plane", "mesh"];
        self.leftovers(parent, &[], &SHAPES);
        let known = |n: &Node<'_, '_>| SHAPES.contains(&n.tag_name().name());
        let Some(node) = parent.children().find(known) else { return Ok(None) };
        let children: &[&str] = match node.tag_name().name() {
            "box" => &["size"],
            "sphere" => &["radius"],
            "cylinder" | "capsule" => &["radius", "length"],
            "ellipsoid" => &["radii"],
            "plane" => &["normal"],
            _ => &["uri", "scale"],
        };
        self.leftovers(node, &[], children);
        let radius = self.child_number(node, "radius")?;
        let length = self.child_number(node, "length")?;
        Ok(match (node.tag_name().name(), radius, length) {
            ("box", ..) => self.child_vector(node, "size")?.map(|size| Geometry::Box { size }),
            ("ellipsoid", ..) => {
                self.child_vector(node, "radii")?.map(|radii| Geometry::Ellipsoid { radii })
            }
            ("plane", ..) => Some(Geometry::HalfSpace),
            ("sphere", Some(radius), _) => Some(Geometry::Sphere { radius }),
            ("cylinder", Some(radius), Some(length)) => Some(Geometry::Cylinder { radius, length }),
            ("capsule", Some(radius), Some(length)) => Some(Geometry::Capsule { radius, length }),
            ("mesh", ..) => {
                let scale = self.child_vector(node, "scale")?.unwrap_or(Vec3::new(1.0, 1.0, 1.0));
                let Some(uri) = self.child_text(node, "uri") else { return Ok(None) };
                let path = packages.find(uri);
                if path.is_none() {
                    let why = "mesh not found: looked in the folders above the file, \
                               ROS_PACKAGE_PATH and AMENT_PREFIX_PATH";
                    self.note(node, "mesh", why, uri);
                }
                Some(Geometry::Mesh { uri: uri.to_owned(), path, scale })
            }
            _ => None,
        })
    }
}
