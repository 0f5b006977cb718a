//! Arms whose axes have a structure: published ones, and random ones of each.

use std::f64::consts::FRAC_PI_2;

use cylindroid::model::{JointKind, JointSpec, Limits};
use cylindroid::{Mechanism, Pose, Rotation, Vec3, catalogue};

use crate::support::{Random, unlimited};

/// An arm from its axes at zero: directions and points in the base, the tool in the base.
pub(super) fn arm(axes: &[(Vec3, Vec3)], base: Pose, tool: Pose, limits: Limits) -> Mechanism {
    let mut b = Mechanism::builder("arm");
    let mut before = base.inverse();
    for (i, (direction, point)) in axes.iter().enumerate() {
        let here = Pose::from_translation(*point);
        b.joint(JointSpec {
            parent_from_joint: before.inverse() * here,
            axis: *direction,
            limits,
            ..JointSpec::new(
                &format!("q{}", i + 1),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
        before = here;
    }
    b.frame("tip", &format!("l{}", axes.len()), before.inverse() * tool);
    b.tool("tip");
    b.build().unwrap()
}

/// Axes of rows (alpha, a, d) of a standard Denavit-Hartenberg table, and the tool.
pub(super) fn table(rows: &[[f64; 3]; 6]) -> ([(Vec3, Vec3); 6], Pose) {
    let mut here = Pose::IDENTITY;
    let axes = rows.map(|[alpha, a, d]| {
        let axis = (here.rotation.z_axis(), here.translation);
        let turn = Rotation::about(Vec3::X, alpha).unwrap();
        here = here * Pose { rotation: turn, translation: Vec3::new(a, 0.0, d) };
        axis
    });
    (axes, here)
}

pub(super) fn unit(random: &mut Random) -> Vec3 {
    random.vec3(1.0).unit(0.1).unwrap_or(Vec3::X)
}

/// A random arm whose axes have a structure, by its name.
pub(super) fn random_arm(name: &str, random: &mut Random) -> Mechanism {
    let mut h: [Vec3; 6] = std::array::from_fn(|_| unit(random));
    let mut o: [Vec3; 6] = std::array::from_fn(|_| random.vec3(0.5));
    let reversed = name.contains("shoulder") || name.contains("3, 4 and 5");
    if name.contains("spherical") {
        (o[4], o[5]) = (o[3], o[3]);
    } else {
        (h[2], h[3]) = (h[1], -h[1]);
    }
    let pair = |name: &str| -> Option<(usize, usize)> {
        let digits: Vec<usize> = name
            .split(", ")
            .last()?
            .chars()
            .filter_map(|c| c.to_digit(10))
            .map(|d| d as usize)
            .collect();
        let [a, b] = digits[..] else { return None };
        Some(if reversed { (6 - b, 6 - a) } else { (a - 1, b - 1) })
    };
    if let Some((a, b)) = pair(name).filter(|_| name.contains("meet")) {
        o[b] = o[a];
    } else if let Some((a, b)) = pair(name).filter(|_| name.contains("spherical")) {
        h[b] = h[a];
    }
    if reversed {
        h.reverse();
        o.reverse();
    }
    let axes: Vec<_> = h.into_iter().zip(o).collect();
    arm(&axes, random.pose(), random.pose(), Limits::NONE)
}

pub(super) const STRUCTURES: [&str; 14] = [
    "spherical wrist, parallel axes 2 and 3",
    "spherical wrist, parallel axes 1 and 2",
    "spherical wrist, axes 2 and 3 meet",
    "spherical wrist, axes 1 and 2 meet",
    "spherical wrist",
    "spherical shoulder, parallel axes 4 and 5",
    "spherical shoulder, parallel axes 5 and 6",
    "spherical shoulder, axes 4 and 5 meet",
    "spherical shoulder, axes 5 and 6 meet",
    "spherical shoulder",
    "parallel axes 2, 3 and 4, axes 5 and 6 meet",
    "parallel axes 2, 3 and 4",
    "parallel axes 3, 4 and 5, axes 1 and 2 meet",
    "parallel axes 3, 4 and 5",
];

/// UR5 and UR10: parameters for calculations of kinematics and dynamics, Universal Robots.
pub(super) fn ur(a: [f64; 2], d: [f64; 4]) -> ([(Vec3, Vec3); 6], Pose) {
    table(&[
        [FRAC_PI_2, 0.0, d[0]],
        [0.0, a[0], 0.0],
        [0.0, a[1], 0.0],
        [FRAC_PI_2, 0.0, d[1]],
        [-FRAC_PI_2, 0.0, d[2]],
        [0.0, 0.0, d[3]],
    ])
}

pub(super) fn published() -> Vec<Mechanism> {
    let mut all: Vec<Mechanism> =
        ["ur5e", "puma560"].map(|name| unlimited(&catalogue::load(name).unwrap())).into();
    let ur5 = ur([-0.425, -0.392_25], [0.089_159, 0.109_15, 0.094_65, 0.0823]);
    let ur10 = ur([-0.612, -0.5723], [0.1273, 0.163_941, 0.1157, 0.0922]);
    for (axes, tool) in [ur5, ur10] {
        all.push(arm(&axes, Pose::IDENTITY, tool, Limits::NONE));
    }
    all
}

/// A wrist whose axes miss each other by a fraction of the reach has the same structure in every
/// unit of length.
#[test]
fn structure_does_not_depend_on_the_unit() {
    let mut random = Random(1612);
    let h: [Vec3; 6] = std::array::from_fn(|_| unit(&mut random));
    let mut o: [Vec3; 6] = std::array::from_fn(|_| random.vec3(0.5));
    (o[4], o[5]) = (o[3], o[3]);
    // Axes 1 and 2 meet, too.
    o[1] = o[0];
    let across = h[4].cross(h[5]);
    for (miss, expected) in [(0.0, true), (1e-6, true), (1e-3, false)] {
        for scale in [1e-3, 1.0, 1e3] {
            let mut points = o;
            points[5] += across * miss;
            let axes: Vec<_> = h.into_iter().zip(points.map(|p| p * scale)).collect();
            let tool = Pose::from_translation((o[5] + Vec3::X * 0.1) * scale);
            let robot = arm(&axes, Pose::IDENTITY, tool, Limits::NONE);
            let found = cylindroid::ik::Analytic::of(&robot, robot.tool()).is_ok();
            assert_eq!(found, expected, "{miss} {scale}");
        }
    }
}
