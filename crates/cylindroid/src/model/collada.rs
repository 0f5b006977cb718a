//! Vertices of Collada files.
//!
//! Formula  vertices of a geometry times the transforms of the nodes that carry it, times the unit
//! Valid    meshes with positions; skins, lights and cameras are not read
//! Source   Collada 1.4.1, `<node>`, `<mesh>`, `<unit>`
//! Checked  tests in this file

use std::collections::BTreeMap;

use roxmltree::{Document, Node, ParsingOptions};

use crate::spatial::{Mat3, Rotation, Vec3};

/// Nodes inside one another, and instances of nodes, at most.
const DEPTH: usize = 64;

/// Nodes and instances of a scene at most: nodes that contain the next one twice grow without end.
const MOST_INSTANCES: usize = 100_000;

/// Numbers of all geometries at most, each as often as it is placed.
const MOST_NUMBERS: usize = 60_000_000;

/// Elements, texts and attributes of a file at most.
const MOST_NODES: u32 = 3_000_000;

/// An affine map.
#[derive(Clone, Copy)]
struct Affine {
    linear: Mat3,
    offset: Vec3,
}

impl Affine {
    const IDENTITY: Self = Self { linear: Mat3::IDENTITY, offset: Vec3::ZERO };

    fn apply(self, v: Vec3) -> Vec3 {
        self.linear * v + self.offset
    }

    fn after(self, inner: Self) -> Self {
        Self { linear: self.linear * inner.linear, offset: self.apply(inner.offset) }
    }
}

/// The vertices of all geometries, as the scene places them.
pub(super) fn vertices(text: &str) -> Result<Vec<Vec3>, String> {
    let options =
        ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document =
        Document::parse_with_options(text, options).map_err(|e| format!("broken XML: {e}"))?;
    let named =
        |name: &'static str| document.descendants().filter(move |n| n.tag_name().name() == name);
    let meter = named("unit").find_map(|n| n.attribute("meter")?.trim().parse::<f64>().ok());
    let scale = meter.filter(|m| m.is_finite() && *m > 0.0).unwrap_or(1.0);
    let unit = Affine {
        linear: Mat3::from_cols(Vec3::X * scale, Vec3::Y * scale, Vec3::Z * scale),
        offset: Vec3::ZERO,
    };
    let by_id = document.descendants().filter_map(|n| Some((n.attribute("id")?, n)));
    // The first of several elements of one id counts.
    let by_id = by_id.rev().collect();
    let mut scene = Scene { by_id, instances: 0, numbers: 0, found: Vec::new() };
    for node in named("visual_scene").flat_map(|scene| children(scene, "node")) {
        scene.add_node(node, unit, DEPTH)?;
    }
    if scene.found.is_empty() {
        for geometry in named("geometry") {
            scene.add_geometry(geometry, unit)?;
        }
    }
    Ok(scene.found)
}

fn children<'d>(node: Node<'d, 'd>, name: &'static str) -> impl Iterator<Item = Node<'d, 'd>> {
    node.children().filter(move |n| n.tag_name().name() == name)
}

/// The vertices that were placed so far.
struct Scene<'d> {
    by_id: BTreeMap<&'d str, Node<'d, 'd>>,
    instances: usize,
    numbers: usize,
    found: Vec<Vec3>,
}

impl<'d> Scene<'d> {
    fn by_url(&self, node: Node<'d, 'd>) -> Option<Node<'d, 'd>> {
        self.by_id.get(node.attribute("url")?.strip_prefix('#')?).copied()
    }

    fn count(&mut self) -> Result<(), String> {
        self.instances += 1;
        if self.instances > MOST_INSTANCES {
            return Err(format!("its scene has more than {MOST_INSTANCES} nodes and geometries"));
        }
        Ok(())
    }

    fn add_node(&mut self, node: Node<'d, 'd>, outer: Affine, depth: usize) -> Result<(), String> {
        let Some(depth) = depth.checked_sub(1) else {
            return Err("its nodes contain one another".to_owned());
        };
        self.count()?;
        let mut here = outer;
        for child in node.children() {
            if let Some(map) = transform(child)? {
                here = here.after(map);
            }
        }
        for child in node.children() {
            match child.tag_name().name() {
                "node" => self.add_node(child, here, depth)?,
                "instance_node" => {
                    if let Some(other) = self.by_url(child) {
                        self.add_node(other, here, depth)?;
                    }
                }
                "instance_geometry" => {
                    if let Some(geometry) = self.by_url(child) {
                        self.add_geometry(geometry, here)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn add_geometry(&mut self, geometry: Node<'d, 'd>, map: Affine) -> Result<(), String> {
        self.count()?;
        let is = |n: &Node<'_, '_>, name: &str| n.tag_name().name() == name;
        for mesh in geometry.children().filter(|n| is(n, "mesh")) {
            for vertices in mesh.children().filter(|n| is(n, "vertices")) {
                let mut inputs = vertices.children().filter(|n| is(n, "input"));
                let position = inputs.find(|n| n.attribute("semantic") == Some("POSITION"));
                let source = position.and_then(|n| n.attribute("source")?.strip_prefix('#'));
                let Some(id) = source else { continue };
                let Some(source) = mesh.children().find(|n| n.attribute("id") == Some(id)) else {
                    continue;
                };
                let accessor = source.descendants().find(|n| is(n, "accessor"));
                let stride = accessor.and_then(|n| n.attribute("stride")?.trim().parse().ok());
                let stride: usize = stride.unwrap_or(3).max(3);
                for array in source.children().filter(|n| is(n, "float_array")) {
                    let points = numbers(array)?;
                    self.numbers += points.len();
                    if self.numbers > MOST_NUMBERS {
                        return Err(format!("it places more than {MOST_NUMBERS} numbers"));
                    }
                    let points = points.chunks_exact(stride);
                    self.found.extend(points.map(|p| map.apply(Vec3::new(p[0], p[1], p[2]))));
                }
            }
        }
        Ok(())
    }
}

fn transform(node: Node<'_, '_>) -> Result<Option<Affine>, String> {
    let name = node.tag_name().name();
    if !matches!(name, "matrix" | "translate" | "rotate" | "scale") {
        return Ok(None);
    }
    let x = numbers(node)?;
    let map = match (name, x.as_slice()) {
        ("matrix", [a, b, c, x, d, e, f, y, g, h, i, z, ..]) => Affine {
            linear: Mat3::from_rows([[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]]),
            offset: Vec3::new(*x, *y, *z),
        },
        ("translate", [x, y, z]) => Affine { offset: Vec3::new(*x, *y, *z), ..Affine::IDENTITY },
        ("rotate", [x, y, z, degrees]) => {
            let rotation = Rotation::about(Vec3::new(*x, *y, *z), degrees.to_radians());
            Affine { linear: rotation.unwrap_or_default().matrix(), ..Affine::IDENTITY }
        }
        ("scale", [x, y, z]) => Affine {
            linear: Mat3::from_cols(Vec3::X * *x, Vec3::Y * *y, Vec3::Z * *z),
            ..Affine::IDENTITY
        },
        _ => return Err(format!("<{name}> has {} numbers", x.len())),
    };
    Ok(Some(map))
}

fn numbers(node: Node<'_, '_>) -> Result<Vec<f64>, String> {
    let words = node.text().unwrap_or("").split_ascii_whitespace();
    let number = |w: &str| w.parse().map_err(|_| format!("'{w}' is not a number"));
    words.map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_place_geometries_in_metres() {
        let text = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema">
          <asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
          <library_geometries><geometry id="g"><mesh>
            <source id="p"><float_array id="f" count="6">0 0 0 1 2 3</float_array>
              <technique_common><accessor source="#f" count="2" stride="3"/></technique_common>
            </source>
            <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
          </mesh></geometry></library_geometries>
          <library_visual_scenes><visual_scene id="s"><node>
            <translate>10 0 0</translate><rotate>0 0 1 90</rotate>
            <node><scale>2 2 2</scale><instance_geometry url="#g"/></node>
          </node></visual_scene></library_visual_scenes></COLLADA>"##;
        let found = vertices(text).unwrap();
        let expected = [Vec3::new(0.01, 0.0, 0.0), Vec3::new(0.006, 0.002, 0.006)];
        for (a, b) in found.iter().zip(expected) {
            assert!((*a - b).norm() < 1e-15, "{a:?} {b:?}");
        }
        assert!(vertices("<COLLADA>").unwrap_err().contains("XML"));
    }

    /// Every node contains the next one twice: 2^40 instances.
    #[test]
    fn nodes_that_double_are_refused() {
        let nodes: String = (0..40)
            .map(|i| {
                let next = format!("<instance_node url='#n{}'/>", i + 1);
                format!("<node id='n{i}'>{next}{next}</node>")
            })
            .collect();
        let text = format!(
            "<COLLADA><library_nodes>{nodes}</library_nodes><visual_scene>\
             <node><instance_node url='#n0'/></node></visual_scene></COLLADA>"
        );
        assert!(vertices(&text).unwrap_err().contains("more than 100000 nodes"));
        let nested = format!(
            "<COLLADA><visual_scene>{}{}</visual_scene></COLLADA>",
            "<node>".repeat(100),
            "</node>".repeat(100)
        );
        assert!(vertices(&nested).unwrap_err().contains("contain one another"));
        let circle = "<COLLADA><visual_scene><node id='a'><instance_node url='#a'/></node>\
                      </visual_scene></COLLADA>";
        assert!(vertices(circle).unwrap_err().contains("contain one another"));
    }
}
