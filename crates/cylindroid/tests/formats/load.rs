//! Names, paths, extensions.

use std::fs;
use std::path::PathBuf;

use cylindroid::model::files_read;
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

/// Those of includes as well, and of a file that fails up to its fault.
#[test]
fn files_that_are_read_are_listed_once() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| -> PathBuf {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let part = write(
        "part.xml",
        "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>",
    );
    let main =
        write("main.xml", "<mujoco><include file='part.xml'/><include file='more.xml'/></mujoco>");
    let loaded = || load(&main.to_string_lossy());
    let (failed, read) = files_read(loaded);
    assert!(failed.unwrap_err().to_string().contains("more.xml"));
    let more = folder.path().join("more.xml");
    assert_eq!(read, [main.clone(), part.clone(), more.clone()]);

    fs::write(&more, "<mujoco/>").unwrap();
    let ((loaded, inner), read) = files_read(|| {
        let inner = files_read(loaded);
        let _ = files_read(loaded);
        inner
    });
    assert_eq!(loaded.unwrap().n(), 1);
    assert_eq!((&inner, read), (&vec![main.clone(), part, more], inner.clone()));
    assert_eq!(files_read(|| load("panda").unwrap().n()), (7, vec![]));
}
