//! The quality of grasps, and the mobility of grasped objects.

use std::f64::consts::TAU;

use cylindroid::closure::{
    FingerContact, Friction, GraspMetric, GraspMobility, GraspQuality, WrenchSpace, grasp_mobility,
    grasp_quality,
};
use cylindroid::model::{ContactCurvature, SurfaceCurvature};
use cylindroid::spatial::Rotation;
use cylindroid::{Pose, Vec3};

use super::{record_error, vector, weighted, weighted_up_to_sign};
use crate::record::{Record, check};
use crate::robots::Random;

fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.norm())
}

fn friction(random: &mut Random<'_>) -> Friction {
    let mu = random.within(0.05, 1.0);
    match random.below(5) {
        0 => Friction::None,
        1 | 2 => Friction::Hard { mu },
        _ => Friction::Soft { mu, torsion: random.within(0.0, 0.6) },
    }
}

fn finger(random: &mut Random<'_>, outward: Vec3, normal: Vec3) -> FingerContact {
    FingerContact {
        point: outward,
        normal,
        friction: friction(random),
        strength: random.within(0.3, 3.0),
        curvature: ContactCurvature::default(),
    }
}

/// Around the origin, in the plane or in space.
fn fingers(random: &mut Random<'_>, planar: bool, count: usize) -> Vec<FingerContact> {
    let from = random.within(0.0, TAU);
    let one = |i: usize| {
        let turn = from + TAU * i as f64 / count as f64 + random.within(-0.3, 0.3);
        let mut outward = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let mut tilt = Vec3::new(-turn.sin(), turn.cos(), 0.0) * random.within(-0.4, 0.4);
        if !planar {
            outward.z = random.within(-0.7, 0.7);
            tilt = random.vec3(0.3);
        }
        let outward = outward * random.within(0.5, 1.5);
        finger(random, outward, unit(tilt - outward))
    };
    (0..count).map(one).collect()
}

/// Moved, turned and scaled, in the plane about z.
fn moved(random: &mut Random<'_>, fingers: &mut [FingerContact], space: &mut WrenchSpace) {
    let size = if random.once_in(2) { 1.0 } else { random.power(-2.0, 2.0) };
    let mut pose = random.pose(3.0);
    if space.planar {
        pose.rotation = Rotation::about_z(random.within(-3.0, 3.0));
        pose.translation.z = 0.0;
    }
    if random.once_in(4) {
        pose = Pose::IDENTITY;
    }
    for f in fingers {
        f.point = pose * f.point * size;
        f.normal = pose.rotation * f.normal;
        if let Friction::Soft { torsion, .. } = &mut f.friction {
            *torsion *= size;
        }
        for body in [&mut f.curvature.finger, &mut f.curvature.object] {
            body.principal = body.principal.map(|k| k / size);
            body.direction = pose.rotation * body.direction;
        }
    }
    space.point = pose * space.point * size;
    space.length *= size;
}

fn record_quality(record: &mut Record, found: &GraspQuality) {
    record.word(&found.closed);
    record.numbers(&[found.epsilon.upper, found.epsilon.lower]);
    record.number(weighted(&found.weakest));
}

fn quality_of(
    random: &mut Random<'_>,
    record: &mut Record,
    mut all: Vec<FingerContact>,
    planar: bool,
) {
    let [x, y, z] = random.vec3(0.4).to_array();
    let point = Vec3::new(x, y, if planar { 0.0 } else { z });
    let mut space = WrenchSpace { point, length: random.within(0.4, 2.0), planar };
    moved(random, &mut all, &mut space);
    for metric in [GraspMetric::L1, GraspMetric::LInf] {
        match grasp_quality(&all, space, metric) {
            Ok(found) => record_quality(record, &found),
            Err(error) => record_error(record, &error),
        }
    }
}

#[test]
fn qualities_in_the_plane() {
    check("position_grasps_plane", 80, |random, record| {
        let count = 1 + random.below(5);
        let all = fingers(random, true, count);
        quality_of(random, record, all, true);
    });
}

#[test]
fn qualities_in_space() {
    check("position_grasps_space", 24, |random, record| {
        let count = 1 + random.below(4);
        let all = fingers(random, false, count);
        quality_of(random, record, all, false);
    });
}

/// Opposite fingers, whose wrenches are flat or equally weak in many directions, fingers on one side,
/// and none.
#[test]
fn qualities_of_special_grasps() {
    check("position_grasps_special", 24, |random, record| {
        let hard = Friction::Hard { mu: random.within(0.2, 0.8) };
        let soft = Friction::Soft { mu: random.within(0.2, 0.8), torsion: random.within(0.3, 0.8) };
        let case = random.below(6);
        let at = |point: Vec3, friction| FingerContact {
            point,
            normal: unit(-point),
            friction,
            strength: 1.0,
            curvature: ContactCurvature::default(),
        };
        let (x, y) = (Vec3::X, Vec3::Y);
        let all = match case {
            0 => vec![at(x, hard), at(-x, hard)],
            1 => vec![at(x, soft), at(-x, soft)],
            2 => vec![at(x, hard), at(unit(x + y), hard)],
            3 => vec![at(x, Friction::None), at(-x, Friction::None), at(y, hard)],
            4 => vec![at(Vec3::Z, soft), at(-x, hard)],
            _ => Vec::new(),
        };
        let planar = case != 4 && random.once_in(2);
        quality_of(random, record, all, planar);
    });
}

/// Of a body that is not sharp in any direction.
fn blunt(random: &mut Random<'_>) -> SurfaceCurvature {
    let (a, b) = (random.within(0.2, 2.0), random.within(0.2, 2.0));
    let direction = random.vec3(1.0);
    match random.below(6) {
        0 => SurfaceCurvature::FLAT,
        1 | 2 => SurfaceCurvature::uniform(a),
        3 => SurfaceCurvature { principal: [a, b], direction },
        4 => SurfaceCurvature::uniform(-0.3 * a),
        _ => SurfaceCurvature { principal: [0.5 * a, -0.2 * b], direction },
    }
}

/// Fingers on faces, edges and balls, now and then such that there is no point of contact.
fn bend(random: &mut Random<'_>, fingers: &mut [FingerContact]) {
    for f in fingers {
        let (a, b) = (random.within(0.2, 2.0), random.within(0.2, 2.0));
        let directions = [random.vec3(1.0), random.vec3(1.0)];
        let edge = |k: f64, i: usize| SurfaceCurvature {
            principal: [f64::INFINITY, k],
            direction: directions[i],
        };
        let sharp = SurfaceCurvature::POINT;
        let (finger, object) = match random.below(8) {
            0 => (sharp, SurfaceCurvature::FLAT),
            1..4 => (sharp, blunt(random)),
            4 => (SurfaceCurvature::uniform(a), SurfaceCurvature::uniform(b)),
            5 => {
                (edge(0.2 * a, 0), SurfaceCurvature { principal: [a, b], direction: directions[1] })
            }
            6 => (edge(0.2 * a, 0), edge(0.3 * b, 1)),
            _ => (SurfaceCurvature::uniform(2.0 + a), blunt(random)),
        };
        let exchanged = random.once_in(5);
        f.curvature = if exchanged {
            ContactCurvature { finger: object, object: finger }
        } else {
            ContactCurvature { finger, object }
        };
    }
}

fn record_mobility(record: &mut Record, found: &GraspMobility) {
    record.word(&found.immobilisation.name());
    record.word(&(found.first_order_mobility, found.second_order_mobility, found.ambiguous));
    record.word(&(found.equilibria.cols(), found.free_motions.cols()));
    record.number(found.curvatures.iter().sum());
    record.number(weighted(&found.curvatures));
    let of_all = |weights: f64| -> Vec<f64> {
        let columns = 0..found.equilibria.cols();
        columns.map(|j| weighted(found.equilibria.column(j)) * weights).collect()
    };
    record.number(of_all(1.0).iter().map(|x| x * x).sum());
    record.number(weighted(&found.forces));
    let projector = &found.free_motions * &found.free_motions.transpose();
    record.number(weighted(projector.as_slice()));
    record.number(weighted(found.free_motions.as_slice()));
    if let Some(escape) = &found.escape {
        record.number(weighted_up_to_sign(&escape.velocity));
        record.number(weighted(&escape.acceleration));
        record.number(weighted(&escape.velocity));
    }
}

fn mobility_of(
    random: &mut Random<'_>,
    record: &mut Record,
    mut all: Vec<FingerContact>,
    planar: bool,
) {
    let [x, y, z] = random.vec3(0.4).to_array();
    let point = Vec3::new(x, y, if planar { 0.0 } else { z });
    let mut space = WrenchSpace { point, length: random.within(0.4, 2.0), planar };
    moved(random, &mut all, &mut space);
    match grasp_mobility(&all, space) {
        Ok(found) => record_mobility(record, &found),
        Err(error) => record_error(record, &error),
    }
}

#[test]
fn mobilities_in_the_plane() {
    check("position_mobilities_plane", 70, |random, record| {
        let count = random.below(7);
        let mut all = fingers(random, true, count);
        bend(random, &mut all);
        mobility_of(random, record, all, true);
    });
}

#[test]
fn mobilities_in_space() {
    check("position_mobilities_space", 60, |random, record| {
        let count = 2 + random.below(8);
        let mut all = fingers(random, false, count);
        bend(random, &mut all);
        mobility_of(random, record, all, false);
    });
}

/// Normals that meet in a point, in pairs or all.
#[test]
fn mobilities_of_concurrent_fingers() {
    check("position_mobilities_concurrent", 150, |random, record| {
        let planar = random.once_in(2);
        let axes = if planar { vec![Vec3::X, Vec3::Y] } else { vec![Vec3::X, Vec3::Y, Vec3::Z] };
        let pairs = || axes.iter().flat_map(|&a| [a, -a]);
        let outward: Vec<Vec3> = match random.below(7) {
            0 => pairs().collect(),
            1 => vec![Vec3::X, -Vec3::X],
            2 => (0..3)
                .map(|i| {
                    let (s, c) = (TAU * f64::from(i) / 3.0).sin_cos();
                    Vec3::new(c, s, 0.0)
                })
                .collect(),
            3 if !planar => {
                let corner = |x, y, z| unit(Vec3::new(x, y, z));
                vec![
                    corner(1.0, 1.0, 1.0),
                    corner(1.0, -1.0, -1.0),
                    corner(-1.0, 1.0, -1.0),
                    corner(-1.0, -1.0, 1.0),
                ]
            }
            3 => vec![Vec3::X, -Vec3::X, Vec3::Y],
            4 => {
                // The others press in no equilibrium.
                let beside = |random: &mut Random<'_>| {
                    let z = if planar { 0.0 } else { random.within(-1.0, 1.0) };
                    unit(Vec3::new(random.within(-0.5, 0.5), 1.0, z))
                };
                let more = 1 + random.below(4);
                let sides = [Vec3::X, -Vec3::X].into_iter();
                sides.chain((0..more).map(|_| beside(random))).collect()
            }
            _ => pairs().take(3).chain([unit(Vec3::X - Vec3::Y)]).collect(),
        };
        let mut all: Vec<FingerContact> = outward.iter().map(|&o| finger(random, o, -o)).collect();
        bend(random, &mut all);
        if random.once_in(3) {
            let same = all[0].curvature;
            all.iter_mut().for_each(|f| f.curvature = same);
        }
        mobility_of(random, record, all, planar);
    });
}

/// More pairs of fingers than are taken, and what is refused.
#[test]
fn grasps_that_are_refused() {
    check("position_refused_grasps", 24, |random, record| {
        let planar = random.once_in(2);
        let count = [3, 3, 3, 40, 65][random.below(5)];
        let mut all = fingers(random, planar, count);
        let odd = vector(random, 3, 2.0);
        let one = random.below(3);
        let mut space = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar };
        match random.below(8) {
            0 => all[one].normal = Vec3::new(odd[0], odd[1], odd[2]),
            1 => all[one].point.z = 0.5,
            2 => all[one].normal = Vec3::Z,
            3 => all[one].friction = Friction::Hard { mu: -odd[0].abs() },
            4 => all[one].friction = Friction::Soft { mu: 0.1, torsion: f64::NAN },
            5 => all[one].strength = -1.0,
            6 => space.length = -odd[0].abs(),
            _ => all[one].curvature.object = SurfaceCurvature::POINT,
        }
        for metric in [GraspMetric::L1, GraspMetric::LInf] {
            if count > 3 {
                continue;
            }
            match grasp_quality(&all, space, metric) {
                Ok(found) => record.word(&(found.closed, found.weakest.len())),
                Err(error) => record_error(record, &error),
            }
        }
        match grasp_mobility(&all, space) {
            Ok(found) => record.word(&(found.immobilisation, found.equilibria.cols())),
            Err(error) => record_error(record, &error),
        }
    });
}
