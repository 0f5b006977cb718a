//! Parallel robots in the plane, and the geometry to check them by.

use std::fmt::Write;
use std::path::Path;

use cylindroid::model::formats;
use cylindroid::{Mechanism, Pose, Vec3};

/// A joint: its name and type, its links, its origin, further lines.
pub(crate) type JointLine<'a> = ([&'a str; 2], [&'a str; 2], [f64; 2], &'a str);

/// A planar mechanism of these joints.
pub(crate) fn planar(head: &str, joints: &[JointLine<'_>]) -> Mechanism {
    let mut text = format!("name = \"planar\"\ndimension = 2\n{head}\n");
    for ([name, kind], [a, b], [x, y], more) in joints {
        write!(
            text,
            "[[joint]]\nname = \"{name}\"\ntype = \"{kind}\"\nbetween = [\"{a}\", \"{b}\"]\n\
             origin = [{x:?}, {y:?}]\n{more}\n"
        )
        .unwrap();
    }
    formats::toml::parse(&text, Path::new("planar.toml")).unwrap()
}

/// The five-bar of the catalogue, actuated at both ground joints: crank 2 and coupler 1 about the
/// origin, rocker 1 and rod sqrt 2 about (2, 0); the joint of coupler and rod is the platform.
pub(crate) fn five_bar() -> Mechanism {
    planar(
        "reference = \"coupler\"\nreference_point = [1, 2]",
        &[
            (["q1", "revolute"], ["ground", "crank"], [0.0, 0.0], "actuated = true"),
            (["q2", "revolute"], ["crank", "coupler"], [0.0, 2.0], ""),
            (["q3", "revolute"], ["coupler", "rod"], [1.0, 2.0], ""),
            (["q4", "revolute"], ["rod", "rocker"], [2.0, 1.0], ""),
            (["q5", "revolute"], ["ground", "rocker"], [2.0, 0.0], "actuated = true"),
        ],
    )
}

/// The same at another place and of another size.
pub(crate) fn five_bar_at(world_from_ground: Pose, scale: f64) -> Mechanism {
    let at = |x: f64, y: f64| {
        let p = world_from_ground * (Vec3::new(x, y, 0.0) * scale);
        [p.x, p.y]
    };
    let [tip_x, tip_y] = at(1.0, 2.0);
    planar(
        &format!("reference = \"coupler\"\nreference_point = [{tip_x:?}, {tip_y:?}]"),
        &[
            (["z5", "revolute"], ["ground", "rocker"], at(2.0, 0.0), "actuated = true"),
            (["y4", "revolute"], ["rod", "rocker"], at(2.0, 1.0), ""),
            (["x3", "revolute"], ["coupler", "rod"], at(1.0, 2.0), ""),
            (["b2", "revolute"], ["crank", "coupler"], at(0.0, 2.0), ""),
            (["a1", "revolute"], ["ground", "crank"], at(0.0, 0.0), "actuated = true"),
        ],
    )
}

/// A five-bar with these pivots, ends of its cranks, and tip.
pub(crate) fn five_bar_with(
    [left, right]: [[f64; 2]; 2],
    [first, second]: [[f64; 2]; 2],
    tip: [f64; 2],
) -> Mechanism {
    planar(
        &format!("reference = \"coupler\"\nreference_point = {tip:?}"),
        &[
            (["q1", "revolute"], ["ground", "crank"], left, "actuated = true"),
            (["q2", "revolute"], ["crank", "coupler"], first, ""),
            (["q3", "revolute"], ["coupler", "rod"], tip, ""),
            (["q4", "revolute"], ["rod", "rocker"], second, ""),
            (["q5", "revolute"], ["ground", "rocker"], right, "actuated = true"),
        ],
    )
}

/// A planar platform on three legs of variable length between the base points and those of the
/// platform, which is at the origin at home.
pub(crate) fn three_rpr(base: [[f64; 2]; 3], platform: [[f64; 2]; 3], limits: &str) -> Mechanism {
    three_rpr_at(base, platform, limits, (Pose::IDENTITY, 1.0))
}

/// The same at another place and of another size; the platform has the axes of the world there too.
pub(crate) fn three_rpr_at(
    base: [[f64; 2]; 3],
    platform: [[f64; 2]; 3],
    limits: &str,
    (world_from_ground, scale): (Pose, f64),
) -> Mechanism {
    let at = |[x, y]: [f64; 2]| {
        let p = world_from_ground * (Vec3::new(x, y, 0.0) * scale);
        [p.x, p.y]
    };
    let [reference_x, reference_y] = at([0.0, 0.0]);
    let mut names = Vec::new();
    for (i, ([ax, ay], [bx, by])) in base.map(at).into_iter().zip(platform.map(at)).enumerate() {
        let slide = format!("axis = [{:?}, {:?}]\nactuated = true\n{limits}", bx - ax, by - ay);
        let of = |what: &str| format!("{what}{i}");
        names.push((of("a"), "revolute", ["ground".to_owned(), of("cylinder")], [ax, ay], None));
        names.push((of("leg"), "prismatic", [of("cylinder"), of("rod")], [bx, by], Some(slide)));
        names.push((of("b"), "revolute", [of("rod"), "platform".to_owned()], [bx, by], None));
    }
    let joints: Vec<JointLine<'_>> = names
        .iter()
        .map(|(name, kind, [a, b], origin, more)| {
            ([name.as_str(), *kind], [a.as_str(), b], *origin, more.as_deref().unwrap_or(""))
        })
        .collect();
    let head =
        format!("reference = \"platform\"\nreference_point = [{reference_x:?}, {reference_y:?}]");
    planar(&head, &joints)
}

/// The place of a coordinate.
pub(crate) fn place(mechanism: &Mechanism, name: &str) -> usize {
    mechanism.coordinates().iter().position(|c| c.name == name).unwrap()
}

/// Where the circles about a and b meet, left of the way from a to b first.
pub(crate) fn circles(a: [f64; 2], r: f64, b: [f64; 2], s: f64) -> Option<[[f64; 2]; 2]> {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let d = x.hypot(y);
    let along = (d * d + r * r - s * s) / (2.0 * d);
    let height = (r * r - along * along).sqrt();
    let at = |h: f64| [a[0] + (x * along - y * h) / d, a[1] + (y * along + x * h) / d];
    (height >= 0.0).then(|| [at(height), at(-height)])
}
