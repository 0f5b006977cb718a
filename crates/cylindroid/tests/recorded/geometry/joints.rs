//! Poses, Jacobians and their derivatives, masses and axes of trees, chains and rings.

use cylindroid::ik::{Budget, Goal, IkOptions, MissReason, solve};
use cylindroid::kinematics::{Chain, MassMatrix, OrientationRates};
use cylindroid::manipulability::{actuated_inertia, body_inertia};
use cylindroid::model::{Inertial, JointKind, JointSpec, Link};
use cylindroid::spatial::{Mat3, Pose, Rotation, Rpy, Vec3, Xyz, Zyz};
use cylindroid::{Matrix, Mechanism, ReferenceFrame, State};

use super::mechanisms::{chain, configuration, frames, inertial, ring, tool, tree};
use super::{counts, error, matrix, pose, screw, sum, vector};
use crate::record::{Record, check};
use crate::robots::{self, Random};

const REFERENCES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

const RATES: [OrientationRates; 4] = [
    OrientationRates::Rpy,
    OrientationRates::Zyz,
    OrientationRates::Xyz,
    OrientationRates::RotationVector,
];

fn all(matrices: &[Matrix]) -> f64 {
    sum(&matrices.iter().map(|m| sum(m.as_slice())).collect::<Vec<_>>())
}

/// A mechanism of any family.
fn mechanism(random: &mut Random<'_>) -> Mechanism {
    match random.below(8) {
        0 => robots::robot(random, false),
        1 => robots::of_catalogue(random, false),
        2 => chain(random),
        3 => ring(random),
        _ => tree(random, false),
    }
}

fn velocities(random: &mut Random<'_>, n: usize) -> Vec<f64> {
    (0..n).map(|_| random.within(-1.0, 1.0)).collect()
}

#[test]
fn jacobians_and_derivatives() {
    check("geometry_jacobians", 60, |random, record| {
        let mechanism = mechanism(random);
        let q = configuration(random, &mechanism);
        let state = mechanism.state(&q).unwrap();
        let (of, base) = (tool(random, &mechanism), tool(random, &mechanism));
        counts(record, &[mechanism.n()]);
        pose(record, state.pose(of).unwrap());
        let speeds = velocities(random, mechanism.n());
        for reference in REFERENCES {
            let jacobian = state.jacobian(of, reference).unwrap();
            let rate = state.jacobian_dot(&speeds, of, reference).unwrap();
            let twist = state.twist(&speeds, of, reference).unwrap();
            record.number(sum(&[all(&[jacobian, rate]), sum(&twist.to_array())]));
            record.number(all(&state.hessian(of, reference).unwrap()));
        }
        let mut twists = Matrix::zeros(6, mechanism.n());
        state.joint_twists_into(&mut twists).unwrap();
        record.number(all(&[state.relative_jacobian(of, base).unwrap(), twists]));
    });
}

#[test]
fn poses_and_axes() {
    check("geometry_axes", 60, |random, record| {
        let mechanism = mechanism(random);
        let q = configuration(random, &mechanism);
        let state = mechanism.state(&q).unwrap();
        let poses = frames(&mechanism)
            .into_iter()
            .map(|frame| sum(state.pose(frame).unwrap().to_matrix().as_flattened()));
        record.number(sum(&poses.collect::<Vec<_>>()));
        let mut lines = Vec::new();
        for axis in state.joint_axes().iter().chain(&state.loop_joint_axes()) {
            for line in [axis.on_parent, axis.on_child] {
                lines.extend(line.point.to_array());
                lines.extend(line.direction.to_array());
            }
        }
        record.number(sum(&lines));
        let points = state.contact_points();
        points.iter().for_each(|[a, b]| vector(record, *a + *b * 0.5));
        let mut of_joints = Vec::new();
        for joint in 0..=mechanism.joints().len() {
            let screws = state.joint_screws(joint);
            of_joints.extend(screws.iter().flat_map(|s| s.twist().to_array()));
            of_joints.push(screws.len() as f64);
        }
        record.number(sum(&of_joints));
        for closing in 0..=mechanism.loops().len() {
            let screws = state.loop_screws(closing);
            counts(record, &[screws.len()]);
            screws.iter().take(3).for_each(|s| {
                screw(record, s);
                vector(record, s.axis.direction);
            });
        }
    });
}

#[test]
fn chains_in_a_loop() {
    check("geometry_chains", 70, |random, record| {
        let mechanism = if random.once_in(4) { tree(random, false) } else { chain(random) };
        let of = tool(random, &mechanism);
        let mut chain = Chain::new(&mechanism, of).unwrap();
        counts(record, chain.coordinates());
        pose(record, chain.pose());
        let q = configuration(random, &mechanism);
        pose(record, chain.set(&q));
        record.number(sum(chain.q()));
        let n = chain.n();
        let (mut jacobian, mut hessian) = (Matrix::zeros(6, n), vec![Matrix::zeros(6, n); n]);
        for reference in REFERENCES {
            chain.jacobian_into(reference, &mut jacobian);
            chain.hessian_into(reference, &mut hessian);
            record.number(all(&hessian) + 0.7 * sum(jacobian.as_slice()));
        }
    });
}

#[test]
fn rates_of_angles() {
    check("geometry_rates", 32, |random, record| {
        let mut builder = Mechanism::builder("free");
        builder.joint(JointSpec::new("float", JointKind::Free, "world", "body"));
        let mechanism = builder.build().unwrap();
        // Exactly singular angles, or this far from them; or anything.
        let away = [0.0, 0.0, 1e-8, 0.9e-6, 1.2e-6, 2e-6, 1e-3][random.below(7)];
        let right = 0.5 * std::f64::consts::PI + away;
        let rotation = match random.below(5) {
            0 => Rpy { roll: 0.75, pitch: right, yaw: -0.5 }.rotation(),
            1 => Zyz { alpha: 0.75, beta: away, gamma: -0.5 }.rotation(),
            2 => Xyz { alpha: 0.75, beta: -right, gamma: 0.25 }.rotation(),
            _ => Rotation::exp(random.vec3(1.5)),
        };
        let r = rotation.log();
        let q = [0.1, -0.2, 0.3, r.x, r.y, r.z];
        let state = mechanism.state(&q).unwrap();
        for rates in RATES {
            let found = state.analytical_jacobian(mechanism.tool(), rates).unwrap();
            record.number(found.determinant + f64::from(u8::from(found.exists)));
            if found.determinant.abs() > 1e-4 || found.determinant.abs() < 0.5e-6 {
                matrix(record, &found.matrix);
            }
        }
    });
}

fn masses(record: &mut Record, state: &State, random: &mut Random<'_>) {
    let mechanism = state.mechanism();
    let n = mechanism.n();
    let mass_matrix = state.mass_matrix();
    let mut evaluator = MassMatrix::new(mechanism);
    let mut out = Matrix::zeros(n, n);
    evaluator.evaluate(state, &mut out).unwrap();
    record.number(all(&[mass_matrix, out]));
    let mut jacobian = Matrix::zeros(3, n);
    let (mass, center) = evaluator.center_of_mass(state, &mut jacobian).unwrap();
    record.number(sum(&[mass, sum(&center.to_array()), sum(jacobian.as_slice())]));
    let frame = tool(random, mechanism).frame;
    let body = body_inertia(state, frame).unwrap();
    counts(record, &[mechanism.massless_bodies().len(), usize::from(body.is_some())]);
    if let Some(w) = body {
        matrix(record, &w);
    }
    if let Some(w) = error(record, actuated_inertia(state)) {
        matrix(record, &w);
    }
}

#[test]
fn masses_of_links() {
    check("geometry_masses", 60, |random, record| {
        let heavy = !random.once_in(4);
        let mechanism = tree(random, heavy);
        let q = configuration(random, &mechanism);
        let state = mechanism.state(&q).unwrap();
        masses(record, &state, random);
        // Of the wrong size.
        let mut evaluator = MassMatrix::new(&mechanism);
        let n = mechanism.n();
        let mut small = Matrix::zeros(n, n + 1);
        let _ = error(record, evaluator.evaluate(&state, &mut small));
        let _ = error(record, evaluator.center_of_mass(&state, &mut small));
    });
}

/// All links of a mechanism get a mass, or a point mass.
fn heavy(random: &mut Random<'_>, mechanism: &Mechanism) -> Mechanism {
    let mut builder = Mechanism::builder(mechanism.name());
    let names: Vec<&str> = mechanism.links().iter().map(|l| l.name.as_str()).collect();
    let points = random.once_in(4);
    for link in mechanism.links() {
        let own = inertial(random);
        let inertia = if points { Mat3::ZERO } else { own.inertia };
        builder.link(Link { inertial: Some(Inertial { inertia, ..own }), ..link.clone() });
    }
    for joint in mechanism.joints() {
        builder.joint(JointSpec {
            parent_from_joint: joint.parent_from_joint,
            joint_from_child: joint.joint_from_child,
            axis: joint.axis,
            reversed: joint.reversed,
            mimic: joint.mimic.clone(),
            actuated: joint.actuated,
            ..JointSpec::new(&joint.name, joint.kind, names[joint.parent], names[joint.child])
        });
    }
    for joint in mechanism.loops() {
        builder.loop_joint(cylindroid::model::LoopJointSpec {
            link_a_from_joint: joint.link_a_from_joint,
            link_b_from_joint: joint.link_b_from_joint,
            axis: joint.axis,
            actuated: joint.actuated,
            ..cylindroid::model::LoopJointSpec::new(
                &joint.name,
                joint.kind,
                names[joint.a],
                names[joint.b],
            )
        });
    }
    for frame in mechanism.frames().iter().skip(names.len()) {
        builder.frame(&frame.name, names[frame.link], frame.link_from_frame);
    }
    builder.dimension(mechanism.dimension()).home(mechanism.home());
    builder.reference(&mechanism.frame_of(mechanism.reference()).name);
    builder.build().unwrap()
}

#[test]
fn masses_in_loops() {
    check("geometry_loop_masses", 44, |random, record| {
        let (mechanism, q) = match random.below(4) {
            0 => {
                let ring = ring(random);
                let q = configuration(random, &ring);
                (ring, q)
            }
            1 => {
                let bars = robots::five_bar(random);
                let q = bars.home().to_vec();
                (bars, q)
            }
            2 => {
                let ring = robots::spatial_loop(random);
                let q = ring.home().to_vec();
                (ring, q)
            }
            _ => {
                let name = ["five-bar", "3rrr", "four-bar"][random.below(3)];
                let mechanism = cylindroid::catalogue::load(name).unwrap();
                let q = mechanism.home().to_vec();
                (mechanism, q)
            }
        };
        let mechanism = heavy(random, &mechanism);
        let state = mechanism.state(&q).unwrap();
        masses(record, &state, random);
    });
}

/// More massless links than a message names.
#[test]
fn links_without_masses() {
    check("geometry_massless", 10, |random, record| {
        let mut builder = Mechanism::builder("massless");
        for i in 0..1 + random.below(9) {
            let kind = [JointKind::Revolute, JointKind::Fixed][random.below(2)];
            let (a, b) = (format!("l{i}"), format!("l{}", i + 1));
            builder.joint(JointSpec {
                parent_from_joint: Pose::from_translation(Vec3::X),
                ..JointSpec::new(&format!("j{i}"), kind, &a, &b)
            });
        }
        let mechanism = builder.build().unwrap();
        record.word(&format_args!("{}.", mechanism.massless_bodies().join(".")));
        let _ = error(record, mechanism.check_masses());
    });
}

/// Targets beyond the longest reach of a chain, whose length is told.
#[test]
fn lengths_of_chains() {
    check("geometry_lengths", 60, |random, record| {
        let mechanism = match random.below(3) {
            0 => robots::robot(random, false),
            1 => tree(random, false),
            _ => robots::of_catalogue(random, false),
        };
        let mut target = random.pose(1.0);
        target.translation = target.translation * 1e7;
        let frame = tool(random, &mechanism).frame;
        let budget = Budget { iterations: 1, time: None };
        let options = IkOptions { budget, ..IkOptions::default() };
        let found = solve(&mechanism, &[Goal::pose(frame, target)], &options);
        let Some(found) = error(record, found) else { return };
        if let Some(MissReason::OutOfReach { distance, length }) = found.reason {
            record.number(length);
            record.number(1e-7 * distance);
        }
    });
}
