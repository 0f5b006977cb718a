//! Curvatures of contacts in mechanism files.

use cylindroid::Vec3;
use cylindroid::model::SurfaceCurvature;

use crate::closed_file::FINGERS;
use crate::mechanism_file::check;
use crate::read_toml;

/// Curvatures of both links: numbers, in space tables with a direction in world axes.
#[test]
fn contacts_have_curvatures() {
    let plain = read_toml(FINGERS).unwrap();
    assert!(plain.contacts().iter().all(|c| c.curvature.is_none()));
    let with = |curvature: &str| FINGERS.replace("friction = 0.6", curvature);
    let found = read_toml(&with("curvature = [inf, -2]")).unwrap().contacts()[0].curvature.unwrap();
    assert_eq!(found.finger, SurfaceCurvature::POINT);
    assert_eq!(found.object, SurfaceCurvature::uniform(-2.0));
    let refused = |curvature: &str, place: &str, message: &str| {
        check(&with(curvature), place, message);
    };
    refused("curvature = 3", "3", "curvature in [[contact]] is an integer");
    refused("curvature = [3]", "[3]", "two entries");
    refused("curvature = [nan, 3]", "nan", "neither a number nor a table");
    refused("curvature = [-inf, 3]", "[-inf, 3]", "the first body is -inf");
    refused("curvature = [0, 0]", "[0, 0]", "line_frictionless");
    refused("curvature = [inf, inf]", "[inf, inf]", "both bodies are sharp");
    let table = "curvature = [1, { principal = [1, 2], direction = [1, 0, 0] }]";
    refused(table, "[1, 2]", "in the plane a curvature is one number");
    check(
        &FINGERS
            .replace("hard_finger", "line_frictionless")
            .replace("friction = 0.6", "curvature = [1, 2]"),
        "[1, 2]",
        "line_frictionless has no curvature",
    );
    let bare = with("curvature = [1, 2]").replace("normal = [1, 0]\n", "");
    check(&bare, "[1, 2]", "needs a normal");

    let space = |curvature: &str| {
        format!(
            "[[joint]]\nname = \"j\"\ntype = \"revolute\"\nbetween = [\"ground\", \"arm\"]\n\
             origin = [0, 0, 0]\naxis = [0, 0, 1]\n[[contact]]\nname = \"c\"\n\
             type = \"hard_finger\"\nbetween = [\"arm\", \"box\"]\npoint = [1, 0, 0]\n\
             normal = [0, 0.6, 0.8]\ncurvature = [{curvature}]\n"
        )
    };
    let cylinder = "{ principal = [4, 0], direction = [2, 0, 0] }";
    let m = read_toml(&space(&format!("100, {cylinder}"))).unwrap();
    let contact = &m.contacts()[0];
    let object = contact.curvature.unwrap().object;
    assert_eq!(object.principal, [4.0, 0.0]);
    let direction = contact.link_a_from_contact.rotation * object.direction;
    assert!((direction - Vec3::X * 2.0).norm() < 1e-12, "{direction:?}");
    let wrong = |entry: &str, place: &str, message: &str| {
        check(&space(entry), place, message);
    };
    wrong(&format!("0, {cylinder}"), "[0, {", "touch along a line");
    wrong("1, { principal = [4, 0] }", "{ principal", "has no direction");
    wrong("1, { principal = [4], direction = [1, 0, 0] }", "[4]", "not a list of two numbers");
    wrong("1, { principal = [4, 0], direction = [0, 3, 4] }", "[1, {", "along the normal");
    wrong("1, { principal = [4, 0], axis = [0, 3, 4] }", "axis", "axis");
}
