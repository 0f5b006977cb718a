//! Vertices of mesh files: STL (binary and ASCII), Wavefront OBJ, Collada.
//!
//! Units    of the file times the scale of the model; Collada's `<unit meter>` is applied, its
//!          `<up_axis>` is not, as in the viewer and in RViz
//! Valid    vertices alone, faces are not read: a convex shape is made of them
//! Fails    with a reason in words, which becomes a note: a link without its mesh is still a link
//! Checked  tests in this file, tests/collision/files.rs

use std::path::Path;

use crate::model::read_regular_file;
use crate::spatial::Vec3;

/// The vertices of a mesh file, or the reason why there are none.
pub(super) fn vertices(path: &Path) -> Result<Vec<Vec3>, String> {
    let bytes = read_regular_file(path, LARGEST).map_err(|e| e.to_string())?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let found = match extension.as_deref() {
        Some("stl") => stl(&bytes),
        Some("obj") => obj(&String::from_utf8_lossy(&bytes)),
        #[cfg(feature = "formats")]
        Some("dae") => super::collada::vertices(&String::from_utf8_lossy(&bytes)),
        _ => Err("its format is not STL, OBJ or Collada".to_owned()),
    };
    let found = found.map_err(|reason| format!("{}: {reason}", path.display()))?;
    if found.is_empty() {
        return Err(format!("{}: it has no vertices", path.display()));
    }
    match found.iter().find(|v| !v.is_finite()) {
        Some(_) => Err(format!("{}: a vertex is not finite", path.display())),
        None => Ok(found),
    }
}

/// The largest mesh file (bytes): 256 MiB.
const LARGEST: u64 = 256 << 20;

/// Bytes of the header with the number of triangles, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

fn stl(bytes: &[u8]) -> Result<Vec<Vec3>, String> {
    let count = bytes.get(80..HEADER).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let count = count.map(u32::from_le_bytes).unwrap_or(0) as usize;
    let length = count.saturating_mul(TRIANGLE).saturating_add(HEADER);
    // Some binary files begin with "solid" as well: the length decides.
    if count > 0 && bytes.len() >= length && !(bytes.len() != length && is_ascii(bytes)) {
        let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let triangles = bytes[HEADER..length].chunks_exact(TRIANGLE);
        // A normal, three vertices, two bytes.
        let corners = triangles.flat_map(|t| t[12..48].chunks_exact(12));
        return Ok(corners
            .map(|c| Vec3::new(number(&c[..4]), number(&c[4..8]), number(&c[8..])))
            .collect());
    }
    if is_ascii(bytes) {
        return lines_of(&String::from_utf8_lossy(bytes), "vertex");
    }
    Err("the STL file is shorter than its number of triangles says".to_owned())
}

fn is_ascii(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"solid")
}

fn obj(text: &str) -> Result<Vec<Vec3>, String> {
    lines_of(text, "v")
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

    fn expected() -> Vec<Vec3> {
        CORNERS.iter().map(|c| Vec3::from_array(c.map(f64::from))).collect()
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
    fn broken_files_say_why() {
        assert!(stl(&binary(&[0; 80], 2)).unwrap_err().contains("shorter"));
        assert!(stl(b"").is_err());
        assert!(obj("v 1 2").unwrap_err().contains("line 1"));
        assert!(vertices(Path::new("none.stl")).unwrap_err().contains("none.stl"));
        assert!(vertices(Path::new("Cargo.toml")).unwrap_err().contains("format"));
    }
}
