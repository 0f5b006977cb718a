//! Laws of force, shared and internal-force control; inverses of single Jacobians.

use cylindroid::closure::{ClosedChain, MotionSpace};
use cylindroid::control::{
    Admittance, AdmittanceGain, AuthorityTimes, HybridController, HybridInput,
    InternalForceController, InverseChoice, OperatorAuthority, Saturation, SharedController,
    SharedInput, TaskProjection,
};
use cylindroid::inverse::HyperbolicDamping;
use cylindroid::screws::{Complement, Projector, ScrewOptions};
use cylindroid::{
    EndEffector, Inverse, Mechanism, Method, Pose, ReferenceFrame, Twist, Vec3, Wrench,
};

use super::{any_robot, fail, few_joints, of_text, of_twist, sum};
use crate::record::{Record, check};
use crate::robots::{Random, of_catalogue};

const FRAMES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

fn twist(random: &mut Random<'_>) -> Twist {
    Twist { linear: random.vec3(1.0), angular: random.vec3(1.0) }
}

fn wrench(random: &mut Random<'_>) -> Wrench {
    Wrench { force: random.vec3(10.0), moment: random.vec3(5.0) }
}

fn gain(random: &mut Random<'_>) -> f64 {
    match random.below(12) {
        0 => 0.0,
        1 => -0.1,
        2 => f64::INFINITY,
        _ => random.power(-2.0, 0.0),
    }
}

/// Rows of a map that yields, by at most `rank` independent wrenches, and now and then pushes back.
fn rows(random: &mut Random<'_>) -> [[f64; 6]; 6] {
    let rank = random.below(7);
    let parts: Vec<[f64; 6]> =
        (0..rank).map(|_| std::array::from_fn(|_| random.within(-1.0, 1.0))).collect();
    let skew = random.within(-1.0, 1.0);
    let mut rows: [[f64; 6]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let turn = (i as f64 - j as f64) * skew;
            parts.iter().map(|p| p[i] * p[j]).sum::<f64>() + turn
        })
    });
    let (i, j) = (random.below(6), random.below(6));
    match random.below(8) {
        0 => rows[i][i] -= random.power(-4.0, 0.0),
        1 => rows[i][j] += random.power(-4.0, 0.0),
        2 => rows[i][j] = f64::NAN,
        3 => rows[i].fill(0.0),
        4 => rows.iter_mut().enumerate().for_each(|(k, row)| {
            row[i] = 0.0;
            if k == i {
                row.fill(0.0);
            }
        }),
        _ => {}
    }
    rows
}

fn of_admittance(record: &mut Record, admittance: &Admittance, random: &mut Random<'_>) {
    record.number(sum(admittance.rows().as_flattened()));
    let seen = admittance.seen_from(random.pose(2.0));
    record.number(sum(seen.rows().as_flattened()));
    record.numbers(&[
        of_twist(seen.apply(wrench(random))),
        of_twist(admittance.apply(wrench(random))),
    ]);
}

#[test]
fn admittances() {
    check("control_admittances", 90, |random, record| {
        let found = if random.once_in(3) {
            let gain = AdmittanceGain { force: gain(random), moment: gain(random) };
            Admittance::at(random.vec3(2.0), gain)
        } else {
            Admittance::from_rows(rows(random))
        };
        match found {
            Ok(admittance) => of_admittance(record, &admittance, random),
            Err(error) => fail(record, &error),
        }
    });
}

/// On some motions, along those that a form or the case names.
fn projector(random: &mut Random<'_>) -> Option<Projector> {
    let count = random.below(7);
    let motions: Vec<Twist> = (0..count).map(|_| twist(random)).collect();
    let others: Vec<Twist> = (count..6).map(|_| twist(random)).collect();
    let along = match random.below(3) {
        0 => Complement::Reciprocal { h: f64::INFINITY },
        1 => Complement::Reciprocal { h: random.within(-1.0, 1.0) },
        _ => Complement::Twists(&others),
    };
    Projector::of(&motions, along, &ScrewOptions::default()).ok()?.ok()
}

fn hybrid(projector: &Projector, random: &mut Random<'_>, record: &mut Record) {
    let gain = AdmittanceGain { force: random.power(-3.0, 0.0), moment: random.power(-3.0, 0.0) };
    let admittance = Admittance::at(random.vec3(1.0), gain).unwrap();
    let mut input = HybridInput {
        error: twist(random),
        feed_forward: twist(random),
        desired: wrench(random),
        measured: wrench(random),
    };
    if random.once_in(12) {
        input.measured.force.z = f64::NAN;
    }
    let controller = match HybridController::new(random.within(-0.3, 6.0), admittance) {
        Ok(controller) => controller.seen_from(random.pose(0.5)),
        Err(error) => return fail(record, &error),
    };
    match controller.command(projector, &input) {
        Ok(command) => {
            let parts = [command.twist, command.position_part, command.force_part];
            record.numbers(&parts.map(of_twist));
            record.number(sum(&command.wrench_error.to_array()));
        }
        Err(error) => fail(record, &error),
    }
}

fn shared(projector: &Projector, random: &mut Random<'_>, record: &mut Record) {
    let mut input =
        SharedInput { error: twist(random), feed_forward: twist(random), operator: twist(random) };
    if random.once_in(12) {
        input.operator.angular.x = f64::INFINITY;
    }
    let controller = match SharedController::new(random.within(-0.3, 6.0)) {
        Ok(controller) => controller,
        Err(error) => return fail(record, &error),
    };
    match controller.command(projector, &input) {
        Ok(command) => {
            let parts = [command.twist, command.robot_part, command.operator_part];
            record.numbers(&parts.map(of_twist));
        }
        Err(error) => fail(record, &error),
    }
}

#[test]
fn twists_by_projectors() {
    check("control_projected_twists", 50, |random, record| {
        let Some(projector) = projector(random) else { return };
        hybrid(&projector, random, record);
        shared(&projector, random, record);
    });
}

#[test]
fn authorities() {
    check("control_authorities", 18, |random, record| {
        let [dt, fall, rise] = [0; 3].map(|_| random.within(-0.02, 0.4));
        let mut authority = match OperatorAuthority::new(AuthorityTimes { dt, fall, rise }) {
            Ok(authority) => authority,
            Err(error) => return fail(record, &error),
        };
        for _ in 0..10 {
            let scale = [0.0, 0.5, 1.0, 1.0, 1.0][random.below(5)];
            authority.update(Saturation { scale, direction_lost: random.once_in(5) });
            record.number(authority.get());
        }
    });
}

/// Numbers of actuated joints that may be wrong.
fn torques(count: usize, random: &mut Random<'_>) -> Vec<f64> {
    let count = if random.once_in(12) { count + 1 } else { count };
    (0..count).map(|_| random.within(-10.0, 10.0)).collect()
}

#[test]
fn internal_forces() {
    check("control_internal_forces", 16, |random, record| {
        let robot = of_catalogue(random, true);
        let state = robot.state(robot.home()).unwrap();
        let Ok(chain) = ClosedChain::of(&state, None, None) else { return };
        let relation = MotionSpace::of(&chain.constraint).relation();
        let n = relation.joints();
        let mut stiffness: Vec<f64> = (0..n).map(|_| random.power(1.0, 4.0)).collect();
        if random.once_in(8) {
            stiffness[0] = 0.0;
        }
        let controller = match InternalForceController::new(random.within(0.0, 20.0), &stiffness) {
            Ok(controller) => controller,
            Err(error) => return fail(record, &error),
        };
        match controller.command(&relation, &torques(n, random), &torques(n, random)) {
            Ok(command) => {
                record.numbers(&[sum(&command.internal), sum(&command.error)]);
                record.number(1e2 * sum(&command.joint_velocities));
            }
            Err(error) => fail(record, &error),
        }
    });
}

/// A pitch that may be infinite, a principal one, or none.
fn pitch(random: &mut Random<'_>) -> f64 {
    [f64::INFINITY, 0.0, random.within(-0.5, 0.5), random.within(-0.5, 0.5)][random.below(4)]
}

/// All kinds; few of them fit their arm.
pub(super) fn projection(missing: usize, random: &mut Random<'_>) -> TaskProjection {
    let h = random.within(-0.5, 0.5);
    match random.below(6) {
        0 => TaskProjection::Orthogonal,
        1 => TaskProjection::Hyperbolic { h: pitch(random) },
        2 => {
            let damping = HyperbolicDamping::Invariant { mu: random.power(-3.0, 0.0) };
            TaskProjection::DampedHyperbolic { h, damping }
        }
        3 => {
            let lambda = [random.within(-0.3, 0.3), h, -h][random.below(3)];
            let damping = HyperbolicDamping::Gram { lambda };
            TaskProjection::DampedHyperbolic { h, damping }
        }
        _ => {
            let count = if random.once_in(8) { missing + 1 } else { missing };
            let complement = (0..count).map(|_| twist(random)).collect();
            TaskProjection::Oblique { complement, reference: FRAMES[random.below(3)] }
        }
    }
}

pub(super) fn method(random: &mut Random<'_>) -> Method {
    let mut method = Method::ALL[random.below(Method::ALL.len())];
    for (_, value) in method.parameters_mut() {
        *value *= random.power(-0.5, 0.5);
    }
    method
}

fn of_inverse(record: &mut Record, inverse: &Inverse) {
    record.word(&(inverse.exists, inverse.rank));
    if let Some(reason) = &inverse.reason {
        return of_text(record, &format!("{reason:?}"));
    }
    record.number(sum(inverse.matrix.as_slice()));
}

fn choice(robot: &Mechanism, random: &mut Random<'_>) -> InverseChoice {
    let missing = 6_usize.saturating_sub(robot.n());
    let length = robot.reach() * random.power(-0.5, 0.5);
    InverseChoice { method: method(random), projection: projection(missing, random), length }
}

fn tool(robot: &Mechanism, random: &mut Random<'_>) -> EndEffector {
    let frame = if robot.is_closed() { robot.reference() } else { robot.tool() };
    let size = 0.1 * robot.reach();
    EndEffector { frame_from_tool: random.pose(size), ..frame.into() }
}

#[test]
fn inverses() {
    check("control_inverses", 80, |random, record| {
        let is_closed = random.once_in(6);
        let robot = match random.below(2) {
            _ if is_closed => of_catalogue(random, true),
            0 => few_joints(random),
            _ => any_robot(random),
        };
        let q = if is_closed { robot.home().to_vec() } else { random.configuration(&robot) };
        let (choice, tool) = (choice(&robot, random), tool(&robot, random));
        let frame = FRAMES[random.below(3)];
        let asked = random.once_in(2).then(|| twist(random));
        match choice.inverse(&robot.state(&q).unwrap(), tool, frame, asked) {
            Ok(inverse) => of_inverse(record, &inverse),
            Err(error) => fail(record, &error),
        }
    });
}

#[test]
fn reference_points() {
    check("control_reference_points", 60, |random, record| {
        let robot = if random.once_in(2) { any_robot(random) } else { few_joints(random) };
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let (choice, tool) = (choice(&robot, random), tool(&robot, random));
        let asked = twist(random);
        let point = random.vec3(robot.reach());
        let point =
            if random.once_in(4) { state.pose(tool.frame).unwrap().translation } else { point };
        let compared = match choice.at_two_points(&state, tool, asked, point) {
            Ok(compared) => compared,
            Err(error) => return fail(record, &error),
        };
        record.word(&(compared.invariant, compared.coordinates.len()));
        for side in [&compared.at_tool, &compared.at_point] {
            if let (Some(rates), Some(achieved)) = (&side.joint_velocities, side.achieved) {
                record.numbers(&[sum(rates), of_twist(achieved)]);
            }
            of_text(record, &format!("{:?}", side.reason));
        }
        record.number(compared.difference.unwrap_or_default());
    });
}

/// A tool on a surface: it slides and turns.
#[test]
fn twists_of_surfaces() {
    check("control_surfaces", 20, |random, record| {
        let normal = random.vec3(1.0);
        let tangents = [normal.cross(Vec3::X), normal.cross(Vec3::Y)];
        let slides = tangents.map(|linear| Twist { linear, angular: Vec3::ZERO });
        let turns =
            [Vec3::X, Vec3::Y, Vec3::Z].map(|angular| Twist { linear: Vec3::ZERO, angular });
        let place = Pose::from_translation(random.vec3(1.0));
        let all: Vec<Twist> =
            slides.iter().chain(&turns).map(|motion| place.adjoint(*motion)).collect();
        let along = Complement::Reciprocal { h: f64::INFINITY };
        let found = Projector::of(&all, along, &ScrewOptions::with_length(0.1)).unwrap();
        let Ok(projector) = found else { return };
        hybrid(&projector, random, record);
        shared(&projector, random, record);
    });
}
