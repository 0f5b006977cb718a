//! Mesh files: STL (binary and ASCII), Wavefront OBJ, Collada.
//!
//! Units    of the file times the scale of the model; Collada's `<unit meter>` is applied, its
//!          `<up_axis>` is not, as in the viewer and in RViz
//! Valid    vertices of all formats, triangles of STL and OBJ, whose polygons become fans
//! Fails    with a reason in words, which becomes a note: a link without its mesh is still a link
//! Checked  tests in this file, tests/collision/files.rs, tests/formats/mesh_masses.rs

use std::path::Path;

use super::regular_file::read_regular_file;
use crate::spatial::Vec3;

/// The contents of a mesh file.
#[derive(Debug, PartialEq)]
pub(crate) struct MeshFile {
    pub(crate) vertices: Vec<Vec3>,
    /// Indices of vertices; `None` where the file has no triangles that this reader reads.
    pub(crate) triangles: Option<Vec<[usize; 3]>>,
}

impl MeshFile {
    /// Three vertices for each triangle.
    fn of_triangles(vertices: Vec<Vec3>) -> Self {
        let count = vertices.len() / 3;
        Self {
            vertices,
            triangles: Some((0..count).map(|i| [0, 1, 2].map(|k| 3 * i + k)).collect()),
        }
    }
}

/// Reads a mesh file; the reason why there is none.
pub(crate) fn read(path: &Path) -> Result<MeshFile, String> {
    let bytes = read_regular_file(path, LARGEST).map_err(|e| e.to_string())?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let found = match extension.as_deref() {
        Some("stl") => stl(&bytes),
        Some("obj") => obj(&String::from_utf8_lossy(&bytes)),
        #[cfg(feature = "formats")]
        Some("dae") => super::collada::vertices(&String::from_utf8_lossy(&bytes))
            .map(|vertices| MeshFile { vertices, triangles: None }),
        _ => Err("its format is not STL, OBJ or Collada".to_owned()),
    };
    let found = found.map_err(|reason| format!("{}: {reason}", path.display()))?;
    if found.vertices.is_empty() {
        return Err(format!("{}: it has no vertices", path.display()));
    }
    match found.vertices.iter().find(|v| !v.is_finite()) {
        Some(_) => Err(format!("{}: a vertex is not finite", path.display())),
        None => Ok(found),
    }
}

/// The largest mesh file (bytes): 256 MiB.
const LARGEST: u64 = 256 << 20;

/// Bytes of the header with the number of triangles, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

fn stl(bytes: &[u8]) -> Result<MeshFile, String> {
    let count = bytes.get(80..HEADER).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let count = count.map(u32::from_le_bytes).unwrap_or(0) as usize;
    let length = count.saturating_mul(TRIANGLE).saturating_add(HEADER);
    // Some binary files begin with "solid" as well: the length decides.
    if count > 0 && bytes.len() >= length && !(bytes.len() != length && is_ascii(bytes)) {
        let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let triangles = bytes[HEADER..length].chunks_exact(TRIANGLE);
        // A normal, three vertices, two bytes.
        let corners = triangles.flat_map(|t| t[12..48].chunks_exact(12));
        let corners =
            corners.map(|c| Vec3::new(number(&c[..4]), number(&c[4..8]), number(&c[8..])));
        return Ok(MeshFile::of_triangles(corners.collect()));
    }
    if is_ascii(bytes) {
        let vertices = lines_of(&String::from_utf8_lossy(bytes), "vertex")?;
        return Ok(MeshFile::of_triangles(vertices));
    }
    Err("the STL file is shorter than its number of triangles says".to_owned())
}

fn is_ascii(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"solid")
}

fn obj(text: &str) -> Result<MeshFile, String> {
    let vertices = lines_of(text, "v")?;
    let triangles = triangles(text, vertices.len()).filter(|t| !t.is_empty());
    Ok(MeshFile { vertices, triangles })
}

/// The polygons of an OBJ as fans; `None` for one of fewer than three corners or with an index of
/// none of the vertices.
fn triangles(text: &str, vertices: usize) -> Option<Vec<[usize; 3]>> {
    let mut found = Vec::new();
    let mut before = 0;
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => before += 1,
            Some("f") => {
                // From 1, or negative: from the last vertex before this line.
                let index = |word: &str| -> Option<usize> {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    let from = if number < 0 { before } else { -1 };
                    usize::try_from(from + number).ok().filter(|i| *i < vertices)
                };
                let corners: Vec<usize> = words.map(index).collect::<Option<_>>()?;
                let [first, rest @ ..] = &corners[..] else { return None };
                if rest.len() < 2 {
                    return None;
                }
                found.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Some(found)
}

/// The three numbers after the keyword, of every line that begins with it.
fn lines_of(text: &str, keyword: &str) -> Result<Vec<Vec3>, String> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        if words.next() != Some(keyword) {
            continue;
        }
        let mut next = || words.next().and_then(|w| w.parse().ok());
        match (next(), next(), next()) {
            (Some(x), Some(y), Some(z)) => found.push(Vec3::new(x, y, z)),
            _ => return Err(format!("line {}: '{keyword}' takes three numbers", number + 1)),
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, -2.0, 0.25]];

    fn expected() -> MeshFile {
        let vertices = CORNERS.iter().map(|c| Vec3::from_array(c.map(f64::from))).collect();
        MeshFile { vertices, triangles: Some(vec![[0, 1, 2]]) }
    }

    fn binary(header: &[u8; 80], count: u32) -> Vec<u8> {
        let mut bytes = [&header[..], &count.to_le_bytes()].concat();
        bytes.extend([0; 12]);
        CORNERS.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([0; 2]);
        bytes
    }

    #[test]
    fn binary_and_ascii_stl_and_obj() {
        let mut solid = [b' '; 80];
        solid[..5].copy_from_slice(b"solid");
        for header in [[0; 80], solid] {
            assert_eq!(stl(&binary(&header, 1)).unwrap(), expected());
        }
        let ascii = "solid a\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1.5 0 0\n\
                     vertex 0 -2 2.5e-1\n endloop\n endfacet\nendsolid a";
        assert_eq!(stl(ascii.as_bytes()).unwrap(), expected());
        let text = "# box\nv 0 0 0\nvn 0 0 1\nv 1.5 0 0 1.0\nv 0 -2 0.25\nf 1 2 3";
        assert_eq!(obj(text).unwrap(), expected());
    }

    #[test]
    fn polygons_of_obj_are_fans() {
        let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
        let of = |faces: &str| obj(&format!("{vertices}{faces}")).unwrap().triangles;
        let square = Some(vec![[0, 1, 2], [0, 2, 3]]);
        assert_eq!(of("f 1 2 3 4"), square);
        assert_eq!(of("f 1/9/9 2//9 3/9 4"), square);
        assert_eq!(of("f -4 -3 -2 -1\nv 5 5 5"), square);
        for wrong in ["", "f 1 2", "f 0 1 2", "f 1 2 5", "f 1 2 x", "f -5 1 2", "f"] {
            assert_eq!(of(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn broken_files_say_why() {
        assert!(stl(&binary(&[0; 80], 2)).unwrap_err().contains("shorter"));
        assert!(stl(b"").is_err());
        assert!(obj("v 1 2").unwrap_err().contains("line 1"));
        assert!(read(Path::new("none.stl")).unwrap_err().contains("none.stl"));
        assert!(read(Path::new("Cargo.toml")).unwrap_err().contains("format"));
    }
}
