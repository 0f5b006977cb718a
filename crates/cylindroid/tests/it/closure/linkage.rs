//! Planar linkages from their joints, and the geometry to check them by.

use std::fmt::Write;
use std::path::Path;

use cylindroid::Mechanism;
use cylindroid::model::formats;

/// Turning joints `(name, between, origin, further lines)` in the plane.
pub(crate) fn linkage(head: &str, joints: &[(&str, [&str; 2], [f64; 2], &str)]) -> Mechanism {
    let mut text = format!("name = \"linkage\"\ndimension = 2\n{head}\n");
    for (name, [a, b], [x, y], more) in joints {
        write!(
            text,
            "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = [\"{a}\", \"{b}\"]\n\
             origin = [{x:?}, {y:?}]\n{more}\n"
        )
        .unwrap();
    }
    formats::toml::parse(&text, Path::new("linkage.toml")).unwrap()
}

/// The five-bar of the catalogue, actuated at both ground joints, which then are of the tree.
pub(crate) fn five_bar(reference: &str) -> Mechanism {
    linkage(
        reference,
        &[
            ("q1", ["ground", "crank"], [0.0, 0.0], "actuated = true"),
            ("q2", ["crank", "coupler"], [0.0, 2.0], ""),
            ("q3", ["coupler", "rod"], [1.0, 2.0], ""),
            ("q4", ["rod", "rocker"], [2.0, 1.0], ""),
            ("q5", ["ground", "rocker"], [2.0, 0.0], "actuated = true"),
        ],
    )
}

/// Crank 3, coupler and rocker 2.5, base 4: stretched to 5 with the crank upright, at zero.
pub(crate) fn dead_four_bar(more_of_rocker: &str) -> Mechanism {
    linkage(
        "reference = \"coupler\"",
        &[
            ("crank", ["ground", "crank"], [0.0, 0.0], "actuated = true"),
            ("knee", ["crank", "coupler"], [0.0, 3.0], ""),
            ("elbow", ["coupler", "rocker"], [2.0, 1.5], more_of_rocker),
            ("pivot", ["rocker", "ground"], [4.0, 0.0], ""),
        ],
    )
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
