//! Names, paths, extensions.

use std::fs;

use cylindroid::{Error, load};

use crate::{ARM_TOML, ARM_URDF};

#[test]
fn a_missing_file_is_an_io_error_and_a_misspelt_name_is_not() {
    for path in ["no/such.urdf", "such.urdf", "./such", "such.TOML"] {
        let error = load(path).unwrap_err();
        assert!(error.to_string().starts_with(&format!("cannot read {path}: ")), "{error}");
    }
    let error = load("pandas").unwrap_err();
    assert!(matches!(error, Error::UnknownName { .. }), "{error}");
    assert!(error.to_string().contains("nearest: panda,"), "{error}");
}

#[test]
fn the_format_is_told_by_extension_and_content() {
    let folder = tempfile::tempdir().unwrap();
    let load_as = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        load(&path.to_string_lossy())
    };
    assert_eq!(load_as("a.urdf", ARM_URDF).unwrap().report().format, "URDF");
    assert_eq!(load_as("a.xml", ARM_URDF).unwrap().report().format, "URDF");
    assert_eq!(load_as("a.XML", ARM_URDF).unwrap().report().format, "URDF");
    assert_eq!(load_as("robot_description", ARM_URDF).unwrap().report().format, "URDF");
    let mujoco = include_str!("../data/zoo.xml");
    for name in ["m.xml", "m.mjcf", "m.urdf", "mujoco"] {
        assert_eq!(load_as(name, mujoco).unwrap().report().format, "MJCF");
    }
    for name in ["s.sdf", "s.xml", "gazebo"] {
        assert_eq!(load_as(name, include_str!("../data/bars.sdf")).unwrap().report().format, "SDF");
    }
    assert_eq!(load_as("bom.urdf", &format!("\u{feff}{ARM_URDF}")).unwrap().n(), 3);
    assert_eq!(load_as("a.toml", ARM_TOML).unwrap().report().format, "mechanism file");
    assert_eq!(load_as("bom.toml", &format!("\u{feff}{ARM_TOML}")).unwrap().n(), 2);
    // Where xacro is installed, it expands the file.
    let xacro = load_as("a.urdf.xacro", ARM_URDF);
    assert!(xacro.map_or_else(|e| e.to_string().contains("xacro"), |m| m.n() == 3));
    let text = cylindroid::model::formats::urdf::parse(ARM_URDF, "a.urdf.xacro".as_ref());
    assert!(text.unwrap_err().to_string().contains("xacro"));
    assert!(load_as("a.sdf", "<sdf/>").unwrap_err().to_string().contains("SDF"));
    assert!(load_as("a.txt", "hello").unwrap_err().to_string().contains("cannot be told"));
    assert!(load(&folder.path().to_string_lossy()).is_err());
}
