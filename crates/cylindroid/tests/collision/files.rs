//! Collision shapes of files: mechanism files, MJCF, SDF, meshes, SRDF.

use std::fs;

use cylindroid::collision::{CollisionModel, CollisionOptions, MeshShape, distance};
use cylindroid::model::Geometry;
use cylindroid::model::formats::{mjcf, sdf, srdf};
use cylindroid::{Error, Pose, Vec3};

/// A box 2 x 4 x 6 as OBJ.
fn block() -> String {
    let corner = |i: usize| {
        let side = |bit: usize, x: i32| if i >> bit & 1 == 0 { -x } else { x };
        format!("v {} {} {}\n", side(0, 1), side(1, 2), side(2, 3))
    };
    (0..8).map(corner).collect()
}

#[test]
fn mechanism_files_have_shapes() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("block.obj"), block()).unwrap();
    let file = folder.path().join("crane.toml");
    let text = r#"
        name = "crane"
        [[joint]]
        name = "q1"
        type = "revolute"
        between = ["ground", "mast"]
        origin = [0, 0, 0]
        axis = [0, 0, 1]
        [[joint]]
        name = "q2"
        type = "revolute"
        between = ["mast", "boom"]
        origin = [0, 0, 2]
        axis = [0, 1, 0]
        [[collision]]
        link = "ground"
        shape = "half_space"
        xyz = [0, 0, -1]
        [[collision]]
        name = "tube"
        link = "boom"
        shape = "capsule"
        radius = 0.1
        length = 1
        xyz = [1, 0, 0]
        rpy = [0, 1.5707963267948966, 0]
        [[collision]]
        link = "mast"
        shape = "mesh"
        file = "block.obj"
        scale = [0.1, 0.1, 0.1]
        [[collision]]
        link = "mast"
        shape = "mesh"
        file = "lost.stl"
    "#;
    fs::write(&file, text).unwrap();
    let crane = cylindroid::load_file(&file).unwrap();
    let lost = |what: &str| what.contains("mesh") && what.contains("lost.stl");
    assert!(crane.report().ignored.iter().any(|i| lost(&i.what)), "{:?}", crane.report());
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(&crane, &options).unwrap();
    assert!(model.ignored()[0].why.contains("lost.stl"), "{:?}", model.ignored());
    assert_eq!(model.bodies().len(), 3);
    let (state, mut near) = (crane.state(crane.home()).unwrap(), Vec::new());
    model.near(&state, f64::INFINITY, &mut near).unwrap();
    let found: Vec<_> = near.iter().map(|n| (model.names(n.pair), n.distance)).collect();
    // Neighbours are left out.
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, ["ground", "boom"]);
    assert!((found[0].1 - 2.9).abs() < 1e-12, "{found:?}");

    for (broken, word) in [
        (text.replace("shape = \"capsule\"", "shape = \"pipe\""), "capsule"),
        (text.replace("radius = 0.1", "radius = -0.1"), "negative"),
        (text.replace("link = \"boom\"", "link = \"bom\""), "boom"),
        (text.replace("length = 1\n", "\n"), "length"),
    ] {
        fs::write(&file, broken).unwrap();
        let error = cylindroid::load_file(&file).unwrap_err();
        let Error::File(place) = &error else { panic!("{error:?}") };
        let all = format!("{error} {}", place.help);
        assert!(all.contains(word), "{all}");
    }
}

#[test]
fn meshes_are_hulls_or_capsules() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("block.obj");
    fs::write(&path, block()).unwrap();
    let scale = Vec3::new(0.8, 0.4, -1.5);
    let mesh = Geometry::Mesh { uri: "block.obj".to_owned(), path: Some(path), scale };
    let same = Geometry::Box { size: Vec3::new(1.6, 1.6, 9.0) };
    let ball = Geometry::Sphere { radius: 0.5 };
    for at in [Vec3::new(3.0, 0.2, 0.1), Vec3::new(2.0, 3.0, 5.0), Vec3::new(0.1, 0.2, 0.3)] {
        let pose = Pose::from_translation(at);
        let of = |shape| distance((&ball, pose), (shape, Pose::IDENTITY)).unwrap().distance;
        assert!((of(&mesh) - of(&same)).abs() < 1e-12, "{} {}", of(&mesh), of(&same));
    }

    let mut builder = cylindroid::Mechanism::builder("slide");
    let shape = cylindroid::model::Collision { geometry: mesh, ..Default::default() };
    builder.collision("cart", shape);
    let kind = cylindroid::model::JointKind::Prismatic;
    builder.joint(cylindroid::model::JointSpec::new("x", kind, "rail", "cart"));
    let slide = builder.build().unwrap();
    let options = CollisionOptions { meshes: MeshShape::Capsule, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(&slide, &options).unwrap();
    model.add_obstacle("ball", &ball, Pose::from_translation(Vec3::X * 4.0)).unwrap();
    let (state, mut near) = (slide.state(&[0.0]).unwrap(), Vec::new());
    model.near(&state, 10.0, &mut near).unwrap();
    // Radius 0.8 sqrt 2 around the edges along z.
    let expected = 4.0 - 0.5 - 0.8 * 2.0_f64.sqrt();
    assert!((near[0].distance - expected).abs() < 1e-2, "{} {expected}", near[0].distance);
}

#[test]
fn mjcf_planes_and_ellipsoids() {
    let text = r#"<mujoco><worldbody>
        <geom type="plane" size="0 0 0.1" pos="0 0 -0.5"/>
        <body name="egg" pos="0 0 1"><freejoint/>
          <geom type="ellipsoid" size="0.1 0.2 0.3"/>
        </body></worldbody></mujoco>"#;
    let egg = mjcf::parse(text, "egg.xml".as_ref()).unwrap();
    assert!(egg.report().ignored.is_empty(), "{:?}", egg.report());
    let mut model = CollisionModel::new(&egg, &CollisionOptions::default()).unwrap();
    let (state, mut near) = (egg.state(egg.home()).unwrap(), Vec::new());
    model.near(&state, 10.0, &mut near).unwrap();
    assert_eq!(model.names(near[0].pair), ["world", "egg"]);
    assert!((near[0].distance - 1.2).abs() < 1e-12);

    // Contacts with a plane know no edge, whatever is drawn; the file says otherwise, so it is noted.
    let egg = mjcf::parse(&text.replace("0 0 0.1\"", "1 1 0.1\""), "egg.xml".as_ref()).unwrap();
    let notes: Vec<_> = egg.report().ignored.iter().map(|i| i.why.as_str()).collect();
    assert_eq!(notes, ["a plane is unbounded"]);
}

#[test]
fn sdf_planes_and_ellipsoids() {
    let text = r#"<sdf version="1.9"><model name="m">
        <link name="wall"><collision name="c"><pose>2 0 0 0 0 0</pose>
          <geometry><plane><normal>-1 0 0</normal></plane></geometry></collision></link>
        <link name="egg"><collision name="c">
          <geometry><ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid></geometry></collision></link>
        <joint name="j" type="prismatic"><parent>world</parent><child>wall</child>
          <axis><xyz>1 0 0</xyz></axis></joint>
        <joint name="k" type="prismatic"><parent>world</parent><child>egg</child>
          <axis><xyz>1 0 0</xyz></axis></joint>
        </model></sdf>"#;
    let model = sdf::parse(text, "m.sdf".as_ref()).unwrap();
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut shapes = CollisionModel::new(&model, &options).unwrap();
    let (state, mut near) = (model.state(model.home()).unwrap(), Vec::new());
    shapes.near(&state, 10.0, &mut near).unwrap();
    assert!((near[0].distance - 1.9).abs() < 1e-12, "{near:?}");
}

/// A geom of type 0 and affinity 2 meets type 2 alone; excluded bodies never meet.
#[test]
fn mjcf_types_affinities_and_exclusions() {
    let text = r#"<mujoco><worldbody>
        <geom name="plain" size="0.1"/>
        <body name="a"><freejoint/><geom size="0.1" contype="2" conaffinity="0"/></body>
        <body name="b"><freejoint/><geom size="0.1" contype="0" conaffinity="2"/></body>
        <body name="c"><freejoint/><geom size="0.1"/></body>
        <body name="d"><freejoint/><geom size="0.1"/></body>
        </worldbody>
        <contact><exclude body1="c" body2="d"/><exclude body1="c" body2="e"/></contact></mujoco>"#;
    let robot = mjcf::parse(text, "types.xml".as_ref()).unwrap();
    assert!(robot.report().ignored[0].what.contains("exclude"), "{:?}", robot.report());
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let names: Vec<_> = (0..model.pairs().len()).map(|i| model.names(i).join(" ")).collect();
    assert_eq!(names, ["world c", "world d", "a b"]);
}

#[test]
fn srdf_disables_pairs() {
    let text = r#"<robot name="r">
        <group name="arm"/>
        <disable_collisions link1="a" link2="b" reason="Never"/>
        <disable_default_collisions link="c"/>
        <enable_collisions link1="c" link2="a"/>
    </robot>"#;
    let srdf = srdf::parse(text, "r.srdf".as_ref()).unwrap();
    let mut builder = cylindroid::Mechanism::builder("r");
    for (name, parent, child) in [("j", "base", "a"), ("k", "a", "b"), ("l", "b", "c")] {
        let kind = cylindroid::model::JointKind::Revolute;
        builder.joint(cylindroid::model::JointSpec::new(name, kind, parent, child));
    }
    let pairs = srdf.pairs(&builder.build().unwrap());
    let names: Vec<String> = pairs.iter().map(|p| p.join(" ")).collect();
    assert_eq!(names, ["a b", "c base", "c b"]);
    for (broken, word) in [
        (text.replace("link2=\"b\"", ""), "link2"),
        (text.replace("robot", "sdf"), "SRDF"),
        (text.replace("</robot>", ""), "XML"),
    ] {
        let error = srdf::parse(&broken, "r.srdf".as_ref()).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
    assert!(srdf::load("none.srdf".as_ref()).is_err());
}
