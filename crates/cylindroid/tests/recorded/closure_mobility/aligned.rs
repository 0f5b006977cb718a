//! Rings and planar linkages: hinges in line, through a point, or anywhere.

use cylindroid::model::{Builder, Dimension, JointKind, JointSpec, LoopJointSpec};
use cylindroid::spatial::Rotation;
use cylindroid::{Mechanism, Pose, Vec3};

use super::chains::seen_from_elsewhere;
use crate::robots::Random;

/// A ring of joints about axes, closed at zero, the first joint actuated; its reference is the
/// link half-way.
pub(super) fn ring(axes: &[(Vec3, Vec3)], dimension: Dimension) -> Mechanism {
    let mut b = Mechanism::builder("ring");
    b.dimension(dimension);
    let link = |i: usize| if i == 0 { "ground".to_owned() } else { format!("l{i}") };
    let mut from = Vec3::ZERO;
    let last = axes.len() - 1;
    for (i, &(point, axis)) in axes[..last].iter().enumerate() {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(point - from),
            axis,
            actuated: i == 0,
            ..JointSpec::new(&format!("q{i}"), JointKind::Revolute, &link(i), &link(i + 1))
        });
        from = point;
    }
    b.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(axes[last].0 - from),
        link_b_from_joint: Pose::from_translation(axes[last].0),
        axis: axes[last].1,
        ..LoopJointSpec::new(&format!("q{last}"), JointKind::Revolute, &link(last), "ground")
    });
    b.reference(&link(last / 2 + 1));
    b.build().unwrap()
}

/// Axes along z through points of a line: shaky, rigid, folded, a bifurcation or a cone.
pub(super) fn flat_ring(random: &mut Random<'_>) -> Mechanism {
    let count = 3 + random.below(4);
    let scale = random.power(-0.5, 0.5);
    let mut at = 0.0;
    let bends = random.once_in(3);
    let axes: Vec<(Vec3, Vec3)> = (0..count)
        .map(|i| {
            let y = if bends && i == 1 { random.power(-2.5, -0.2) } else { 0.0 };
            let point = Vec3::new(scale * at, scale * y, 0.0);
            let forth = if random.once_in(3) { -1.0 } else { 1.0 };
            at += forth * (1 + random.below(2)) as f64;
            (point, Vec3::Z)
        })
        .collect();
    let spatial = random.once_in(3);
    let m = ring(&axes, if spatial { Dimension::Spatial } else { Dimension::Planar });
    seen_from_elsewhere(&m, random)
}

/// Parallel axes in space, anywhere or nearly in line: three equations are dependent everywhere, and
/// motions turn back before long.
pub(super) fn parallel_ring(random: &mut Random<'_>) -> Mechanism {
    let (count, width) = (4 + random.below(2), random.power(-1.5, 0.0));
    let axes: Vec<(Vec3, Vec3)> = (0..count)
        .map(|_| {
            let at = random.vec3(1.0);
            (Vec3::new(at.x, width * at.y, 0.0), Vec3::Z)
        })
        .collect();
    seen_from_elsewhere(&ring(&axes, Dimension::Spatial), random)
}

/// Links whose hinges lie on one line (or whose axes meet in a point and lie in a plane), with
/// several loops: many first-order motions, dependent equations and branches.
pub(super) fn aligned(random: &mut Random<'_>) -> Mechanism {
    let (links, loops) = (3 + random.below(2), 1 + random.below(2));
    let spherical = random.once_in(4);
    let mut b = Mechanism::builder("aligned");
    if !spherical && !random.once_in(4) {
        b.dimension(Dimension::Planar);
    }
    let size = random.power(-0.5, 0.5);
    let link = |i: usize| if i == 0 { "ground".to_owned() } else { format!("l{i}") };
    // All link frames are that of the world at zero.
    let hinge = |random: &mut Random<'_>| {
        let at = random.below(9) as f64;
        let off = if random.once_in(12) { random.within(0.2, 0.8) } else { 0.0 };
        if spherical {
            (Pose::IDENTITY, Vec3::new((0.4 * at).cos(), (0.4 * at).sin(), off))
        } else {
            (Pose::from_translation(Vec3::new(at, off, 0.0) * size), Vec3::Z)
        }
    };
    for i in 1..=links {
        let (place, axis) = hinge(random);
        let slides = !spherical && random.once_in(10);
        let (kind, axis) =
            if slides { (JointKind::Prismatic, Vec3::X) } else { (JointKind::Revolute, axis) };
        b.joint(JointSpec {
            parent_from_joint: place,
            joint_from_child: place.inverse(),
            axis,
            actuated: i == 1 || random.once_in(4),
            ..JointSpec::new(&format!("q{i}"), kind, &link(random.below(i)), &link(i))
        });
    }
    for i in 0..loops {
        let ((place, axis), one) = (hinge(random), 1 + random.below(links));
        let other = (one + 1 + random.below(links)) % (links + 1);
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: place,
            link_b_from_joint: place,
            axis,
            ..LoopJointSpec::new(&format!("l{i}"), JointKind::Revolute, &link(one), &link(other))
        });
    }
    b.reference(&link(1 + random.below(links)));
    seen_from_elsewhere(&b.build().unwrap(), random)
}

/// A planar linkage of hinges anywhere and some slides, with several loops that share joints or not.
pub(super) fn planar_loops(random: &mut Random<'_>) -> Mechanism {
    let (links, loops) = (4 + random.below(5), 1 + random.below(3));
    let mut b = Mechanism::builder("loops");
    b.dimension(Dimension::Planar);
    let size = random.power(-1.0, 1.0);
    let link = |i: usize| if i == 0 { "ground".to_owned() } else { format!("l{i}") };
    let hinge = |random: &mut Random<'_>| {
        let mut point = random.vec3(size);
        point.z = 0.0;
        Pose::from_translation(point)
    };
    for i in 1..=links {
        let place = hinge(random);
        let kind = if random.once_in(5) { JointKind::Prismatic } else { JointKind::Revolute };
        let axis = match kind {
            JointKind::Prismatic => Rotation::exp(Vec3::Z * random.within(-3.0, 3.0)) * Vec3::X,
            _ => Vec3::Z,
        };
        b.joint(JointSpec {
            parent_from_joint: place,
            joint_from_child: place.inverse(),
            axis,
            actuated: random.below(3) > 0,
            ..JointSpec::new(&format!("q{i}"), kind, &link(random.below(i)), &link(i))
        });
    }
    for i in 0..loops {
        let (place, one) = (hinge(random), 1 + random.below(links));
        let other = (one + 1 + random.below(links)) % (links + 1);
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: place,
            link_b_from_joint: place,
            axis: Vec3::Z,
            actuated: random.once_in(4),
            ..LoopJointSpec::new(&format!("l{i}"), JointKind::Revolute, &link(one), &link(other))
        });
    }
    b.reference(&link(1 + random.below(links)));
    b.build().unwrap()
}

/// Two or three links in line, tied to the ground by bars in line: a form of second order for each
/// bar, of which combinations are definite or not.
pub(super) fn barred(random: &mut Random<'_>) -> Mechanism {
    let mut b = Mechanism::builder("barred");
    b.dimension(Dimension::Planar);
    let links = 2 + random.below(2);
    let at = |x: f64| Pose::from_translation(Vec3::X * x);
    let hinge = |b: &mut Builder, name: &str, x: f64, [parent, child]: [&str; 2]| {
        b.joint(JointSpec {
            parent_from_joint: at(x),
            joint_from_child: at(-x),
            actuated: name == "q1",
            ..JointSpec::new(name, JointKind::Revolute, parent, child)
        });
    };
    let link = |i: usize| if i == 0 { "ground".to_owned() } else { format!("l{i}") };
    for i in 1..=links {
        hinge(&mut b, &format!("q{i}"), i as f64 - 1.0, [&link(i - 1), &link(i)]);
    }
    // Neither a combination of these is definite, nor do both vanish for a motion.
    let hyperbolas = links == 2 && random.once_in(3);
    // A form that is hardly definite.
    let hardly = links == 2 && random.once_in(3);
    let bars = if hyperbolas { 2 } else { 1 + random.below(3) };
    let bars = if hardly { 1 } else { bars };
    for i in 0..bars {
        let bar = format!("bar{i}");
        let mut half = || 0.5 * random.below(9) as f64;
        let (from, to) = match (hardly, hyperbolas) {
            (true, _) => (-random.power(-4.5, -2.5), 2.0),
            (_, true) => [(1.0, 2.0), (1.5, 3.0)][i],
            _ => (half(), half() + 0.25),
        };
        hinge(&mut b, &format!("p{i}"), from, ["ground", &bar]);
        let end = at(to);
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: end,
            link_b_from_joint: end,
            ..LoopJointSpec::new(&format!("l{i}"), JointKind::Revolute, &bar, &link(links))
        });
    }
    b.reference(&link(links));
    seen_from_elsewhere(&b.build().unwrap(), random)
}

/// Axes through one point, some of them in one plane: a spherical linkage.
pub(super) fn spherical_ring(random: &mut Random<'_>) -> Mechanism {
    let count = 3 + random.below(3);
    let in_plane = random.once_in(2);
    let axes: Vec<(Vec3, Vec3)> = (0..count)
        .map(|_| {
            let mut axis = random.vec3(1.0);
            if in_plane {
                axis.z = 0.0;
            }
            (Vec3::ZERO, axis.unit(0.0).unwrap())
        })
        .collect();
    let m = ring(&axes, Dimension::Spatial);
    seen_from_elsewhere(&m, random)
}
