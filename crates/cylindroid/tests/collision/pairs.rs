//! The pairs that are watched.

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::model::{Collision, Geometry, JointKind, JointSpec, Limits, Link};
use cylindroid::{Mechanism, Pose, Vec3};

fn ball(x: f64) -> Collision {
    let geometry = Geometry::Sphere { radius: 0.1 };
    let link_from_shape = Pose::from_translation(Vec3::X * x);
    Collision { geometry, link_from_shape, ..Collision::default() }
}

fn link(name: &str, at: &[f64]) -> Link {
    Link { collisions: at.iter().map(|x| ball(*x)).collect(), ..Link::named(name) }
}

fn names(robot: &Mechanism, options: &CollisionOptions) -> Vec<[String; 2]> {
    let model = CollisionModel::new(robot, options).unwrap();
    (0..model.pairs().len()).map(|i| model.names(i).map(str::to_owned)).collect()
}

/// base - upper - fore = tool: the tool is fixed to the fore arm.
fn robot(range: f64) -> Mechanism {
    let mut builder = Mechanism::builder("two joints");
    for (name, at) in [("base", 0.0), ("upper", 0.5), ("fore", 0.5), ("tool", 0.2)] {
        builder.link(link(name, &[at]));
    }
    for (name, parent, child, kind) in [
        ("a", "base", "upper", JointKind::Revolute),
        ("b", "upper", "fore", JointKind::Revolute),
        ("c", "fore", "tool", JointKind::Fixed),
    ] {
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X),
            limits: Limits { lower: -range, upper: range, ..Limits::NONE },
            ..JointSpec::new(name, kind, parent, child)
        });
    }
    builder.build().unwrap()
}

#[test]
fn rigid_bodies_and_neighbours_are_left_out() {
    let all = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    assert_eq!(names(&robot(3.0), &all), [["base", "fore"], ["base", "tool"]]);
    let disabled = vec![["tool".to_owned(), "base".to_owned()]];
    let some = CollisionOptions { disabled, ..all.clone() };
    assert_eq!(names(&robot(3.0), &some), [["base", "fore"]]);
    let unknown = CollisionOptions { disabled: vec![["tol".into(), "base".into()]], ..all };
    let model = CollisionModel::new(&robot(3.0), &unknown).unwrap();
    assert!(model.ignored()[0].why.contains("tol") && model.pairs().len() == 2);
}

/// Folded back, the fore arm meets the base; with little range it does not.
#[test]
fn pairs_that_never_touch_are_left_out() {
    let options = CollisionOptions::default();
    assert!(names(&robot(0.5), &options).is_empty());
    assert_eq!(names(&robot(3.1), &options).len(), 2);
}

/// A touch in a part of 1e-4 of the space of configurations: the descent finds it, samples do not.
#[test]
fn a_rare_touch_is_found() {
    let mut builder = Mechanism::builder("rare");
    builder.link(link("base", &[0.0])).link(link("end", &[0.0]));
    let mut parent = "base".to_owned();
    for (i, name) in ["x", "y", "z", "end"].into_iter().enumerate() {
        let axis = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::X][i];
        builder.joint(JointSpec {
            axis,
            limits: Limits { lower: -0.01, upper: 5.0, ..Limits::NONE },
            parent_from_joint: Pose::from_translation(axis * 0.19),
            ..JointSpec::new(&format!("to {name}"), JointKind::Prismatic, &parent, name)
        });
        parent = name.to_owned();
    }
    let rare = builder.build().unwrap();
    let options = CollisionOptions { never_margin: 0.0, ..CollisionOptions::default() };
    assert!(names(&rare, &options).is_empty(), "the corner is 0.18 sqrt 3 away");
    let mut model =
        CollisionModel::new(&rare, &CollisionOptions { samples: 0, ..options }).unwrap();
    let mut near = Vec::new();
    let corner = rare.state(&[-0.01; 4]).unwrap();
    model.near(&corner, f64::INFINITY, &mut near).unwrap();
    let margin = near[0].distance + 1e-3;
    let options = CollisionOptions { never_margin: margin, ..CollisionOptions::default() };
    assert_eq!(names(&rare, &options).len(), 1);
}

/// A shape inside another one for all configurations.
#[test]
fn pairs_that_always_touch_are_left_out() {
    let mut builder = Mechanism::builder("sleeve");
    for (name, at) in [("outer", 0.0), ("middle", 0.0), ("inner", 0.05)] {
        builder.link(link(name, &[at]));
    }
    builder.joint(JointSpec::new("a", JointKind::Continuous, "outer", "middle"));
    builder.joint(JointSpec::new("b", JointKind::Continuous, "middle", "inner"));
    let sleeve = builder.build().unwrap();
    let all = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    assert_eq!(names(&sleeve, &all), [["outer", "inner"]]);
    assert!(names(&sleeve, &CollisionOptions::default()).is_empty());
}

/// A free body may be anywhere: it stays watched, also against the link that it hangs on.
#[test]
fn free_bodies_are_watched() {
    let mut builder = Mechanism::builder("free");
    builder.link(link("world", &[0.0])).link(link("body", &[100.0]));
    builder.joint(JointSpec::new("float", JointKind::Free, "world", "body"));
    let free = builder.build().unwrap();
    assert_eq!(names(&free, &CollisionOptions::default()), [["world", "body"]]);
}

/// Equal seeds give equal pairs.
#[test]
fn the_choice_repeats() {
    let options = CollisionOptions { samples: 20, ..CollisionOptions::default() };
    let robot = robot(2.0);
    assert_eq!(names(&robot, &options), names(&robot, &options));
}

/// A star of links without an end of pairs is refused before they are made.
#[test]
fn pairs_have_a_limit() {
    let star = |n: usize| {
        let mut builder = Mechanism::builder("star");
        builder.link(Link::named("hub"));
        for i in 0..n {
            builder.link(link(&format!("l{i}"), &[0.5]));
            let joint =
                JointSpec::new(&format!("j{i}"), JointKind::Revolute, "hub", &format!("l{i}"));
            builder.joint(joint);
        }
        builder.build().unwrap()
    };
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    assert_eq!(names(&star(100), &options).len(), 100 * 99 / 2);
    let error = CollisionModel::new(&star(3000), &options).unwrap_err().to_string();
    assert!(error.contains("3000 shapes") && error.contains("more than 4000000 pairs"), "{error}");
}

/// An obstacle is watched against the links that move, a half-space not against another: they have no
/// distance.
#[test]
fn obstacles_are_watched_against_links_that_move() {
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let of_obstacle = |robot: &Mechanism, obstacle: &Geometry| -> Vec<String> {
        let mut model = CollisionModel::new(robot, &options).unwrap();
        let own = model.pairs().len();
        model.add_obstacle("obstacle", obstacle, Pose::IDENTITY).unwrap();
        (own..model.pairs().len()).map(|i| model.names(i)[0].to_owned()).collect()
    };
    let sphere = Geometry::Sphere { radius: 0.1 };
    assert_eq!(of_obstacle(&robot(3.0), &sphere), ["upper", "fore", "tool"]);
    let mut builder = Mechanism::builder("a board that turns");
    builder.link(Link::named("base"));
    let board = Collision { geometry: Geometry::HalfSpace, ..Collision::default() };
    builder.link(Link { collisions: vec![board, ball(0.5)], ..Link::named("board") });
    builder.joint(JointSpec::new("a", JointKind::Revolute, "base", "board"));
    let board = builder.build().unwrap();
    assert_eq!(of_obstacle(&board, &sphere), ["board", "board"]);
    assert_eq!(of_obstacle(&board, &Geometry::HalfSpace), ["board"]);
}
