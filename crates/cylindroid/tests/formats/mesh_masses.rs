//! Masses of MJCF bodies whose geoms are meshes, against MuJoCo.
//!
//! The vectors were written by `xtask/vectors/mesh_mass_vectors.py` (`cargo xtask vectors`).

use std::fs;
use std::path::Path;

use cylindroid::Mechanism;
use serde_json::Value;

use crate::mjcf::numbers;
use crate::report;

/// Mass, centre and inertia about it in the axes of the link; MuJoCo's vertices have single
/// precision.
fn numbers_of(m: &Mechanism, name: &str) -> [f64; 10] {
    let link = m.links().iter().find(|l| l.name == name).unwrap();
    let i = link.inertial.unwrap();
    let axes = i.link_from_inertia.rotation.matrix();
    let [x, y, z] = i.link_from_inertia.translation.to_array();
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = (axes * i.inertia * axes.transpose()).to_rows();
    [i.mass, x, y, z, xx, xy, xz, yy, yz, zz]
}

#[test]
fn masses_of_meshes_are_those_of_mujoco() {
    let m = cylindroid::load_file(Path::new("tests/data/meshes.xml")).unwrap();
    assert_eq!(report(&m), "");
    let vectors = fs::read_to_string("tests/vectors/mesh_masses/meshes.json").unwrap();
    let vectors: Value = serde_json::from_str(&vectors).unwrap();
    let bodies = vectors["bodies"].as_object().unwrap();
    assert_eq!(bodies.len(), 7);
    for (name, expected) in bodies {
        let (got, expected) = (numbers_of(&m, name), numbers(expected));
        let size = expected.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        for (got, expected) in got.iter().zip(&expected) {
            assert!((got - expected).abs() < 1e-6 * size, "{name}: {got} instead of {expected}");
        }
    }
    // 0.006 times that of the file, 2 m^3, in closed form.
    assert!((numbers_of(&m, "exact")[0] - 500.0 * 0.006 * 2.0).abs() < 1e-12);
}

/// A body whose mesh is missing, flat, of another format or moved has no mass, which is noted.
#[test]
fn meshes_without_volume_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n");
    write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n");
    write("wrong.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 9\n");
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    write("good.obj", tetrahedron);
    let with = |mesh: &str| {
        let text = format!(
            "<mujoco><asset><mesh name='m' {mesh}/></asset><worldbody><body name='b'><joint/>\
             <geom type='mesh' mesh='m'/></body></worldbody></mujoco>"
        );
        let path = folder.path().join("m.xml");
        fs::write(&path, text).unwrap();
        cylindroid::load_file(&path).unwrap()
    };
    let good = with("file='good.obj'");
    assert!((good.links()[1].inertial.unwrap().mass - 1000.0 / 6.0).abs() < 1e-10);
    assert!(!report(&good).contains("mass of a geom"), "{}", report(&good));
    for mesh in [
        "file='flat.obj'",
        "file='points.obj'",
        "file='wrong.obj'",
        "file='none.obj'",
        "file='good.obj' refpos='1 0 0'",
    ] {
        let m = with(mesh);
        assert!(m.links()[1].inertial.is_none(), "{mesh}");
        assert!(report(&m).contains("mass of a geom"), "{mesh}: {}", report(&m));
    }
}
