//! This library, as its users call it.

use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use cylindroid::control::{SecondaryTask, ServoGains, Target};
use cylindroid::ik::{Budget, Goal, IkOptions, Solver};
use cylindroid::inverse::Method;
use cylindroid::kinematics::{Chain, KinematicsBatch};
use cylindroid::spatial::Mat3;
use cylindroid::{
    FrameId, Matrix, Mechanism, Pose, ReferenceFrame, Rotation, Servo, ServoOptions, State, Twist,
    Vec3,
};
use peers::{BLOCK, Command, Result, Robot, ik, serve, single, write};

struct Arm {
    mechanism: Mechanism,
    tip: FrameId,
    chain: Chain,
    state: State,
    jacobian: Matrix,
    batch: KinematicsBatch,
    poses: Vec<f64>,
    jacobians: Vec<f64>,
    /// Solver and its tolerance.
    solver: Option<(f64, Solver)>,
}

fn make(robot: &Robot) -> Result<Arm> {
    let mechanism = cylindroid::load(&robot.urdf)?;
    let names: Vec<_> = mechanism.coordinates().iter().map(|c| c.name.clone()).collect();
    if names != robot.names {
        return Err(format!("joints in another order: {names:?}").into());
    }
    let tip = mechanism.frame("tip0")?;
    let chain = Chain::new(&mechanism, tip)?;
    Ok(Arm {
        state: mechanism.state(&vec![0.0; mechanism.n()])?,
        jacobian: Matrix::zeros(6, mechanism.n()),
        batch: KinematicsBatch::new(&mechanism, tip)?,
        poses: Vec::new(),
        jacobians: Vec::new(),
        mechanism,
        tip,
        chain,
        solver: None,
    })
}

fn main() -> Result<()> {
    serve(make, |command, robot, arm| match command.task {
        "check" => {
            let mut out = vec![0.0; BLOCK * (12 + 6 * robot.n())];
            for (i, row) in out.chunks_exact_mut(12 + 6 * robot.n()).enumerate() {
                pose_and_jacobian(arm, robot.configuration(i), row);
            }
            check_many(robot, arm, &out)?;
            write(command.path, &out)
        }
        "single" => Ok(single(robot, command.number(0)?, |q| {
            black_box(arm.chain.set(q));
            arm.chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut arm.jacobian);
            black_box(&arm.jacobian);
        })),
        "batch" => batch(robot, arm, command.number(0)?),
        "tree" => Ok(single(robot, command.number(0)?, |q| whole_tree(arm, q))),
        "treecheck" => {
            let mut out = Vec::new();
            for i in 0..BLOCK {
                whole_tree(arm, robot.configuration(i));
                out.extend(rows(&arm.jacobian));
            }
            write(command.path, &out)
        }
        "servo" => servo(arm, command),
        "ik" => inverse(robot, &robot.targets, arm, command),
        "far" => inverse(robot, &robot.far, arm, command),
        other => Err(format!("no task {other}").into()),
    })
}

fn rows(m: &Matrix) -> impl Iterator<Item = f64> + '_ {
    (0..m.rows()).flat_map(move |r| (0..m.cols()).map(move |c| m[(r, c)]))
}

/// Rotation by rows, position, Jacobian by rows.
fn pose_and_jacobian(arm: &mut Arm, q: &[f64], out: &mut [f64]) {
    let pose = arm.chain.set(q);
    arm.chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut arm.jacobian);
    let m = pose.to_matrix();
    for (k, x) in out[..9].iter_mut().enumerate() {
        *x = m[k / 3][k % 3];
    }
    out[9..12].copy_from_slice(&pose.translation.to_array());
    out[12..].iter_mut().zip(rows(&arm.jacobian)).for_each(|(x, y)| *x = y);
}

/// ns a configuration; results of `chunk` configurations are kept at a time.
fn batch(robot: &Robot, arm: &mut Arm, chunk: usize) -> Result<String> {
    let n = robot.n();
    arm.poses.resize(chunk * 16, 1.0);
    arm.jacobians.resize(chunk * 6 * n, 1.0);
    let begin = Instant::now();
    for q in robot.q.chunks(chunk * n) {
        many(arm, q)?;
        black_box((&arm.poses, &arm.jacobians));
    }
    Ok((begin.elapsed().as_nanos() as f64 / (robot.q.len() / n) as f64).to_string())
}

/// Poses and Jacobians of many configurations.
fn many(arm: &mut Arm, q: &[f64]) -> Result<()> {
    let Arm { batch, poses, jacobians, .. } = arm;
    let (n, count) = (batch.n(), q.len() / batch.n());
    Ok(batch.poses_and_jacobians_into(
        q,
        ReferenceFrame::LocalWorldAligned,
        &mut poses[..count * 16],
        &mut jacobians[..count * 6 * n],
    )?)
}

/// Of many configurations in one call, in the form of [`pose_and_jacobian`].
fn check_many(robot: &Robot, arm: &mut Arm, expected: &[f64]) -> Result<()> {
    let n = robot.n();
    arm.poses.resize(BLOCK * 16, 1.0);
    arm.jacobians.resize(BLOCK * 6 * n, 1.0);
    many(arm, &robot.q[..BLOCK * n])?;
    let rows = arm.poses.chunks_exact(16).zip(arm.jacobians.chunks_exact(6 * n));
    for ((pose, jacobian), row) in rows.zip(expected.chunks_exact(12 + 6 * n)) {
        let rotation = (0..9).map(|k| pose[k / 3 * 4 + k % 3]);
        let found = rotation.chain((0..3).map(|i| pose[i * 4 + 3])).chain(jacobian.iter().copied());
        if let Some((x, y)) = found.zip(row).find(|(x, y)| (x - **y).abs() > 1e-12) {
            return Err(format!("{x} in a batch, {y} alone").into());
        }
    }
    Ok(())
}

/// All poses of the tree, and the twists of all joints in world axes at the world's origin.
fn whole_tree(arm: &mut Arm, q: &[f64]) {
    let _ = arm.state.set(q);
    let _ = arm.state.joint_twists_into(&mut arm.jacobian);
    black_box(&arm.jacobian);
}

/// A circle of 10 cm in 4 s from home, followed for some steps; the last q behind the times.
fn servo(arm: &Arm, command: &Command<'_>) -> Result<String> {
    let (steps, dt): (usize, f64) = (command.number(0)?, 1e-3);
    let home = [0.0, -PI / 4.0, 0.0, -0.75 * PI, 0.0, PI / 2.0, PI / 4.0];
    let mut servo = Servo::new(
        &arm.mechanism,
        ServoOptions {
            end_effector: arm.tip.into(),
            dt,
            gain: ServoGains { position: 5.0, orientation: 5.0 },
            method: Method::Truncated { eps: 1e-3 },
            length: 1.0,
            secondary: vec![SecondaryTask::Posture { q: home.to_vec(), gain: 1.0 }],
            ..ServoOptions::new(&arm.mechanism)
        },
    )?;
    let mut q = home.to_vec();
    let start = arm.mechanism.state(&q)?.pose(arm.tip)?;
    let mut out = Vec::with_capacity(steps + q.len());
    for i in 0..steps {
        let (w, r) = (2.0 * PI / 4.0, 0.1);
        let (sin, cos) = (w * i as f64 * dt).sin_cos();
        let target = Target {
            pose: Pose {
                translation: start.translation + Vec3::new(0.0, r * sin, r * (cos - 1.0)),
                ..start
            },
            feed_forward: Twist {
                linear: Vec3::new(0.0, r * w * cos, -r * w * sin),
                angular: Vec3::ZERO,
            },
        };
        let begin = Instant::now();
        black_box(servo.step(&q, target)?);
        out.push(begin.elapsed().as_nanos() as f64);
        servo.advance(&mut q);
    }
    out.extend(q);
    write(command.path, &out)
}

fn inverse(robot: &Robot, targets: &[f64], arm: &mut Arm, command: &Command<'_>) -> Result<String> {
    let tolerance: f64 = command.number(0)?;
    let (from, to): (usize, usize) = (command.number(1)?, command.number(2)?);
    let tip = arm.tip;
    let goal = |target: &[f64]| -> Result<[Goal; 1]> {
        let rows = |i: usize| [target[3 * i], target[3 * i + 1], target[3 * i + 2]];
        let rotation = Rotation::from_matrix(Mat3::from_rows([rows(0), rows(1), rows(2)]))?;
        let translation = Vec3::new(target[9], target[10], target[11]);
        Ok([Goal::pose(tip, Pose { rotation, translation })])
    };
    if arm.solver.as_ref().is_none_or(|(of, _)| *of != tolerance) {
        let options = IkOptions {
            position_tolerance: tolerance,
            orientation_tolerance: tolerance,
            initial_guess: Some(robot.middle()),
            budget: Budget { iterations: 20_000, time: None },
            ..IkOptions::default()
        };
        arm.solver =
            Some((tolerance, Solver::new(&arm.mechanism, &goal(&targets[..12])?, &options)?));
    }
    let Some((_, solver)) = &mut arm.solver else { return Err("no solver".into()) };
    ik(robot, &targets[12 * from..12 * to], command.path, |target, q| {
        let Ok(found) = goal(target).and_then(|goal| Ok(solver.solve(&goal)?)) else {
            return false;
        };
        q.copy_from_slice(&found.q);
        found.success
    })
}
