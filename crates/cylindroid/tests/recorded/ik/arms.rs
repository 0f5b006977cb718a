//! Arms: chains of any joints, six axes with a closed form, seven of which one is locked.

use std::f64::consts::FRAC_PI_2;

use cylindroid::model::{Collision, Geometry, Inertial, JointKind, JointSpec, Limits, Link};
use cylindroid::spatial::Mat3;
use cylindroid::{Mechanism, Pose, Rotation, Vec3};

use super::limits;
use crate::robots::Random;

/// A joint at zero: direction and point of its axis in the base.
pub(super) type Axis = (Vec3, Vec3, JointKind, Limits);

/// A chain of joints, and the place of its tool at zero; links with masses and balls.
pub(super) fn chain(axes: &[Axis], base: Pose, tool: Pose) -> Mechanism {
    let mut builder = Mechanism::builder("chain");
    let mut before = base.inverse();
    for (i, (direction, point, kind, limits)) in axes.iter().enumerate() {
        let inertial = Inertial {
            mass: 1.0 + i as f64,
            link_from_inertia: Pose::IDENTITY,
            inertia: Mat3::ZERO,
        };
        let link = format!("l{}", i + 1);
        let geometry = Geometry::Sphere { radius: 0.03 };
        // Apart from those of axes that meet there.
        let (sin, cos) = (2.4 * i as f64).sin_cos();
        let link_from_shape = Pose::from_translation(Vec3::new(0.1 * cos, 0.1 * sin, 0.05));
        let collisions = vec![Collision { geometry, link_from_shape, ..Collision::default() }];
        builder.link(Link { inertial: Some(inertial), collisions, ..Link::named(&link) });
        let here = Pose::from_translation(*point);
        builder.joint(JointSpec {
            parent_from_joint: before.inverse() * here,
            axis: *direction,
            limits: *limits,
            ..JointSpec::new(&format!("q{i}"), *kind, &format!("l{i}"), &link)
        });
        before = here;
    }
    builder.frame("tip", &format!("l{}", axes.len()), before.inverse() * tool).tool("tip");
    builder.build().unwrap()
}

/// A direction; with `square`, that of an axis of coordinates.
fn direction(random: &mut Random<'_>, square: bool) -> Vec3 {
    let sign = if random.once_in(2) { 1.0 } else { -1.0 };
    match random.below(3) {
        _ if !square => random.vec3(1.0),
        0 => Vec3::X * sign,
        1 => Vec3::Y * sign,
        _ => Vec3::Z * sign,
    }
}

/// A point; with `square`, one of a coarse grid.
fn point(random: &mut Random<'_>, square: bool) -> Vec3 {
    if !square {
        return random.vec3(0.5);
    }
    let mut place = || 0.25 * (random.below(4) as f64 - 1.0);
    Vec3::new(place(), place(), place())
}

/// Directions and points of six axes of which three meet or are parallel, and in most cases two more.
pub(super) fn six_axes(random: &mut Random<'_>) -> Vec<(Vec3, Vec3)> {
    let square = random.once_in(4);
    let mut h: Vec<Vec3> = (0..6).map(|_| direction(random, square)).collect();
    let mut o: Vec<Vec3> = (0..6).map(|_| point(random, square)).collect();
    let meet = random.once_in(2);
    if meet {
        (o[4], o[5]) = (o[3], o[3]);
    } else {
        let sign = if random.once_in(2) { 1.0 } else { -1.0 };
        (h[2], h[3]) = (h[1] * random.power(-0.5, 0.5), h[1] * sign);
    }
    match random.below(5) {
        0 if meet => o[1] = o[0],
        1 if meet => h[1] = h[0],
        2 if meet => o[2] = o[1] + h[1] * 0.2,
        3 if meet => h[2] = -h[1],
        0..3 => o[5] = o[4],
        _ => {}
    }
    if random.once_in(2) {
        h.reverse();
        o.reverse();
    }
    h.into_iter().zip(o).collect()
}

/// Hinges with random limits; without, every second time.
pub(super) fn hinges(random: &mut Random<'_>, axes: &[(Vec3, Vec3)], size: f64) -> Vec<Axis> {
    let limited = random.once_in(2);
    let mut one = |(h, o): &(Vec3, Vec3)| {
        let own = if limited { limits(random) } else { Limits::NONE };
        (*h, *o * size, JointKind::Revolute, own)
    };
    axes.iter().map(&mut one).collect()
}

/// A chain with a random base and tool.
pub(super) fn placed(random: &mut Random<'_>, axes: &[Axis], size: f64) -> Mechanism {
    let far = if random.once_in(5) { 30.0 } else { 1.0 };
    let (base, tool) = (random.pose(far * size), random.pose(0.5 * size));
    chain(axes, base, tool)
}

/// Six hinges with a closed form, in most cases.
pub(super) fn six(random: &mut Random<'_>, size: f64) -> Mechanism {
    let axes = six_axes(random);
    let axes = hinges(random, &axes, size);
    placed(random, &axes, size)
}

/// Seven hinges of which six have a closed form.
pub(super) fn seven(random: &mut Random<'_>, size: f64) -> Mechanism {
    let mut axes = six_axes(random);
    let further = (random.vec3(1.0), random.vec3(0.4));
    axes.insert([0, 6, random.below(7)][random.below(3)], further);
    let axes = hinges(random, &axes, size);
    placed(random, &axes, size)
}

/// A kind of one coordinate.
fn kind(random: &mut Random<'_>, size: f64, simple: bool) -> JointKind {
    match random.below(if simple { 5 } else { 12 }) {
        0 => JointKind::Prismatic,
        1 => JointKind::Continuous,
        5 => JointKind::Helical { pitch: 0.05 * size },
        6 => JointKind::Spherical,
        7 => JointKind::Universal { second: random.vec3(1.0) },
        8 => JointKind::Cylindrical,
        9 => JointKind::Planar,
        10 => JointKind::Free,
        _ => JointKind::Revolute,
    }
}

/// A chain of `n` joints in general position; with `simple`, of one coordinate each.
pub(super) fn general(random: &mut Random<'_>, n: usize, size: f64, simple: bool) -> Mechanism {
    let mut axes = Vec::new();
    for _ in 0..n {
        let kind = kind(random, size, simple);
        let mut own = limits(random);
        match kind {
            JointKind::Revolute => {}
            JointKind::Prismatic | JointKind::Helical { .. } => {
                (own.lower, own.upper) = (own.lower * size, own.upper * size);
            }
            _ => own = Limits::NONE,
        }
        axes.push((random.vec3(1.0), random.vec3(0.6 * size), kind, own));
    }
    placed(random, &axes, size)
}

/// Axes of rows (alpha, a, d) of a standard Denavit-Hartenberg table, and the tool.
fn table(rows: [[f64; 3]; 6]) -> (Vec<Axis>, Pose) {
    let mut here = Pose::IDENTITY;
    let axes = rows.map(|[alpha, a, d]| {
        let axis = (here.rotation.z_axis(), here.translation, JointKind::Revolute, Limits::NONE);
        let turn = Rotation::about(Vec3::X, alpha).unwrap();
        here = here * Pose { rotation: turn, translation: Vec3::new(a, 0.0, d) };
        axis
    });
    (axes.into(), here)
}

/// An arm like a UR5 or a Puma, with right angles and lengths of which some are zero, and the place of
/// the middle of its wrist in the tool.
pub(super) fn industrial(random: &mut Random<'_>, size: f64) -> (Mechanism, Vec3) {
    let mut length = || if random.once_in(3) { 0.0 } else { random.within(0.1, 0.5) * size };
    let d = [length(), length(), length(), length()];
    let (a, end, turn) = ([length(), length()], length(), FRAC_PI_2);
    let (upper, lower) = (random.within(0.2, 0.5) * size, random.within(0.2, 0.5) * size);
    let rows = if random.once_in(2) {
        [
            [turn, 0.0, d[0]],
            [0.0, -upper, 0.0],
            [0.0, -lower, 0.0],
            [turn, 0.0, d[1]],
            [-turn, 0.0, d[2]],
            [0.0, 0.0, end],
        ]
    } else {
        [
            [turn, a[0], d[0]],
            [0.0, upper, d[1]],
            [turn, a[1], 0.0],
            [-turn, 0.0, lower],
            [turn, 0.0, 0.0],
            [0.0, 0.0, end],
        ]
    };
    let (axes, tool) = table(rows);
    (chain(&axes, random.pose(size), tool), Vec3::Z * -end)
}
