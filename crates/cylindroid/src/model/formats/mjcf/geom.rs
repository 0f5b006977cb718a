//! Shapes of MJCF bodies: kept as data, to the extent that a link represents them.
//!
//! Units    MJCF gives half sizes; shapes of links have full sizes
//! Checked  tests/formats/mjcf.rs::shapes_*

use std::path::Path;

use super::Mjcf;
use super::assets::Mesh;
use super::attributes::{ORIENTATIONS, used};
use super::copies::Placed;
use super::defaults::Element;
use super::mesh_inertia::MeshInertia;
use crate::error::{Error, Result};
use crate::model::formats::mesh::Packages;
use crate::model::{Collision, Geometry, Link, Visual};
use crate::spatial::{Pose, Vec3};

impl<'d> Mjcf<'d> {
    /// Colours and meshes.
    pub(super) fn assets(&mut self) -> Result<()> {
        self.assets.packages = Some(Packages::of(self.reader.source.path));
        for node in self.files.section("asset") {
            match node.tag_name().name() {
                "material" => {
                    self.reader.unread_attributes(node, &used("material"));
                    let element = self.defaults.of(&self.reader, node, 0, &["material"])?;
                    let colour = element.vector::<4>(&self.reader, "rgba")?;
                    if let (Some(name), Some(rgba)) = (node.attribute("name"), colour) {
                        self.assets.colours.insert(name, rgba);
                    }
                }
                "mesh" => {
                    self.reader.unread_attributes(node, &used("mesh"));
                    let element = self.defaults.of(&self.reader, node, 0, &["mesh"])?;
                    let Some(file) = element.text("file") else {
                        let name = node.attribute("name").unwrap_or("");
                        self.reader.note(node, "<mesh> without file", "it is not drawn", name);
                        continue;
                    };
                    let scale = element.vector::<3>(&self.reader, "scale")?;
                    let scale = scale.map_or(Vec3::new(1.0, 1.0, 1.0), Vec3::from_array);
                    let stem = Path::new(file).file_stem().map(|s| s.to_string_lossy());
                    let own = node.attribute("name").map(Into::into);
                    let name = own.or(stem).unwrap_or_default().into_owned();
                    let folder = self.compiler.meshes.trim_end_matches('/');
                    let uri =
                        if folder.is_empty() { file.into() } else { format!("{folder}/{file}") };
                    let inertia = MeshInertia::named(element.text("inertia"));
                    let is_moved =
                        ["refpos", "refquat"].iter().any(|name| element.text(name).is_some());
                    let mesh = Mesh { uri, scale, inertia, is_moved, solid: None };
                    self.assets.meshes.insert(name, mesh);
                }
                "model" => {}
                other => {
                    let what = format!("<{other}> in <asset>");
                    self.reader.note(node, what, "it is not drawn", "");
                }
            }
        }
        Ok(())
    }

    /// A geom, as visual shape and as collision shape.
    pub(super) fn geom(&mut self, link: &mut Link, placed: &Placed<'d>) -> Result<()> {
        let node = placed.node;
        let element = self.defaults.of(&self.reader, node, placed.class, &["geom"])?;
        self.reader.unread_attributes(node, &used("geom"));
        let (pose, size) = self.place_and_size(&element)?;
        self.unread_places_and_sizes(&element);
        let name = placed.name().unwrap_or_default();
        if !(name.is_empty() || self.geom_names.insert(&name)) {
            let why = "two shapes have one name, which MuJoCo refuses; both are read";
            self.reader.note(node, "name of a <geom>", why, &name);
        }
        let Some(geometry) = self.shape(&element, &size)? else { return Ok(()) };
        let own = element.vector::<4>(&self.reader, "rgba")?;
        let material = element.text("material").and_then(|m| self.assets.colours.get(m));
        let flag = |attribute: &str, missing: f64| -> Result<f64> {
            Ok(element.number(&self.reader, attribute)?.unwrap_or(missing))
        };
        let bits = |attribute: &str| Ok::<_, Error>(flag(attribute, 1.0)? as i64 as u32);
        let (category, mask) = (bits("contype")?, bits("conaffinity")?);
        // The viewer of MuJoCo shows groups 0 to 2 unless told otherwise.
        let shown = flag("group", 0.0)? < 3.0;
        let visual = Visual {
            name,
            link_from_shape: placed.place * pose,
            geometry,
            rgba: own.or(material.copied()),
        };
        if category != 0 || mask != 0 {
            let shape = Collision::from(visual.clone());
            link.collisions.push(Collision { category, mask, ..shape });
        }
        if shown {
            link.visuals.push(visual);
        }
        Ok(())
    }

    /// The pose of a geom on its frame, and its sizes.
    pub(super) fn place_and_size(&self, element: &Element<'d>) -> Result<(Pose, Vec<f64>)> {
        let pose = self.compiler.pose(&self.reader, element)?;
        let mut size = element.list(&self.reader, "size", 3)?.unwrap_or_default();
        let kind = self.kind_of(element);
        let Some((between, half_length)) = element.between(&self.reader, kind)? else {
            return Ok((pose, size));
        };
        let is_box = matches!(kind, "box" | "ellipsoid");
        // The first size is across; the length comes from the two points.
        size.truncate(1);
        if is_box {
            size.push(size.first().copied().unwrap_or(0.0));
        }
        size.push(half_length);
        Ok((between, size))
    }

    /// Logs the sizes that a shape does not have, and the pose of a geom between two points.
    fn unread_places_and_sizes(&mut self, element: &Element<'d>) {
        let between = element.source_element("fromto");
        let kind = self.kind_of(element);
        let used_sizes = match kind {
            "plane" | "mesh" | "hfield" | "sdf" => 0,
            "sphere" => 1,
            _ if between.is_some() => 1,
            "capsule" | "cylinder" => 2,
            _ => 3,
        };
        let body = self.reader.owner(element.node).to_owned();
        let mut note = |node, attribute: &str, why| {
            self.reader.note(node, format!("attribute '{attribute}' of <geom>"), why, &body);
        };
        if let Some(node) = element.source_element("size") {
            let text = node.attribute("size").unwrap_or("");
            let is_zero = |word: &str| word.parse() == Ok(0.0);
            // The third size of a plane is the distance of the grid lines that are drawn on it.
            let sizes = text.split_whitespace().take(if kind == "plane" { 2 } else { usize::MAX });
            if sizes.skip(used_sizes).any(|word| !is_zero(word)) {
                let why = match kind {
                    "plane" => "a plane is unbounded",
                    _ => "a shape of this type has fewer sizes",
                };
                note(node, "size", why);
            }
        }
        if between.is_some() {
            for attribute in ["pos"].into_iter().chain(ORIENTATIONS) {
                if let Some(node) = element.source_element(attribute) {
                    note(node, attribute, "fromto gives the pose");
                }
            }
        }
    }

    /// The type of a geom.
    pub(super) fn kind_of(&self, element: &Element<'d>) -> &'d str {
        let implied = if element.source_element("mesh").is_some() { "mesh" } else { "sphere" };
        element.text("type").unwrap_or(implied)
    }

    fn shape(&mut self, element: &Element<'d>, size: &[f64]) -> Result<Option<Geometry>> {
        let node = element.node;
        let body = self.reader.owner(node).to_owned();
        let kind = self.kind_of(element);
        let shape = match (kind, size) {
            ("sphere", [radius, ..]) => Some(Geometry::Sphere { radius: *radius }),
            ("capsule", [radius, half, ..]) => {
                Some(Geometry::Capsule { radius: *radius, length: 2.0 * half })
            }
            ("cylinder", [radius, half, ..]) => {
                Some(Geometry::Cylinder { radius: *radius, length: 2.0 * half })
            }
            ("box", [x, y, z]) => Some(Geometry::Box { size: Vec3::new(*x, *y, *z) * 2.0 }),
            ("ellipsoid", [x, y, z]) => Some(Geometry::Ellipsoid { radii: Vec3::new(*x, *y, *z) }),
            ("plane", _) => Some(Geometry::HalfSpace),
            ("mesh", _) => {
                let mesh = element.text("mesh").and_then(|m| self.assets.meshes.get(m));
                mesh.map(|mesh| {
                    let path = self.assets.packages.as_ref().and_then(|p| p.find(&mesh.uri));
                    Geometry::Mesh { uri: mesh.uri.clone(), path, scale: mesh.scale }
                })
            }
            _ => None,
        };
        match &shape {
            None => {
                let what = format!("<geom> of type {kind}");
                let why = "there is no such shape here, or its size or mesh is missing";
                self.reader.note(node, what, why, &body);
            }
            Some(Geometry::Mesh { uri, path: None, .. }) => {
                let why = "mesh not found in the folder of the model";
                self.reader.note(node, "mesh", why, uri);
            }
            Some(_) => {}
        }
        Ok(shape)
    }
}
