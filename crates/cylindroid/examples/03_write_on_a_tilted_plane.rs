//! Writes an eight on a tilted plane with a pen, at a constant force: hybrid control.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;

use cylindroid::control::{Admittance, AdmittanceGain, HybridController, HybridInput, Target};
use cylindroid::kinematics::Chain;
use cylindroid::screws::{Complement, Projector, ScrewOptions};
use cylindroid::{Pose, Rotation, Servo, ServoOptions, Twist, Vec3, Wrench};

const DT: f64 = 1e-3; // s
const DURATION: f64 = 8.0; // s
const STIFFNESS: f64 = 2000.0; // of pen and paper, N/m
const FRICTION: f64 = 0.3;
const FORCE: f64 = 5.0; // N

fn main() -> cylindroid::Result<()> {
    let robot = cylindroid::load("panda")?;
    let mut servo = Servo::new(&robot, ServoOptions { dt: DT, ..ServoOptions::new(&robot) })?;
    let mut chain = Chain::new(&robot, robot.tool())?;
    let mut q = robot.home().to_vec();

    // A plane through the tip of the pen, tilted by 30 degrees; the pen keeps its orientation.
    let start = chain.set(&q);
    let plane = Pose { rotation: Rotation::exp(Vec3::Y * (TAU / 12.0)), ..start };
    let (x, y, normal) =
        (plane.rotation.x_axis(), plane.rotation.y_axis(), plane.rotation.z_axis());

    // World axes at the tip: the pen slides in the plane and turns about its tip as the path says.
    let turn = |angular| Twist { linear: Vec3::ZERO, angular };
    let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    let motions = [slide(x), slide(y), turn(x), turn(y), turn(normal)];
    // The wrenches that do no work on them are the forces along the normal. What gives way to them
    // is reciprocal to the motions in the limit of an infinite pitch: sliding along the normal.
    let along = Complement::Reciprocal { h: f64::INFINITY };
    let options = ScrewOptions::with_length(robot.reach());
    let projector = match Projector::of(&motions, along, &options)? {
        Ok(projector) => projector,
        Err(reason) => {
            println!("no hybrid law: {reason}");
            return Ok(());
        }
    };
    let law = HybridController::new(
        10.0,
        Admittance::at(Vec3::ZERO, AdmittanceGain { force: 0.01, moment: 0.0 })?,
    )?;

    // The same law as somebody sees it who stands far off and looks another way.
    let g = Pose { rotation: Rotation::exp(Vec3::new(0.4, -1.0, 2.0)), translation: Vec3::X * 9.0 };
    let far_law = law.seen_from(g);
    let far_motions = motions.map(|t| g.adjoint(t));
    let Ok(far_projector) = Projector::of(&far_motions, along, &options)? else { return Ok(()) };

    let (mut force_error, mut off_path, mut off_frame) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut velocity = Vec3::ZERO;
    for step in 0..(DURATION / DT) as u32 {
        let t = f64::from(step) * DT;
        let pose = chain.set(&q);

        // The eight, 8 cm by 4 cm, and its velocity.
        let (phase, rate) = (TAU * t / DURATION, TAU / DURATION);
        let path = x * (0.04 * phase.sin()) + y * (0.02 * (2.0 * phase).sin());
        let speed = (x * (0.04 * phase.cos()) + y * (0.04 * (2.0 * phase).cos())) * rate;
        let target = Pose { translation: start.translation + path, ..start };

        // The simulated contact: a spring along the normal, and friction against the motion.
        let depth = (start.translation - pose.translation).dot(normal).max(0.0);
        let across = velocity - normal * velocity.dot(normal);
        let drag = across.unit(1e-6).unwrap_or(Vec3::ZERO) * (FRICTION * STIFFNESS * depth);
        let measured = normal * (-STIFFNESS * depth) + drag;

        let force = |force| Wrench { force, moment: Vec3::ZERO };
        let input = HybridInput {
            error: pose.screw_to(target),
            feed_forward: slide(speed),
            desired: force(normal * -FORCE),
            measured: force(measured),
        };
        let twist = law.command(&projector, &input)?.twist;
        // To the robot: from where it is, with this twist.
        servo.step(&q, Target { pose, feed_forward: twist })?;
        servo.advance(&mut q);
        velocity = (chain.set(&q).translation - pose.translation) * (1.0 / DT);

        let far_input = HybridInput {
            error: g.adjoint(input.error),
            feed_forward: g.adjoint(input.feed_forward),
            desired: g.coadjoint(input.desired),
            measured: g.coadjoint(input.measured),
        };
        let far = g.inverse().adjoint(far_law.command(&far_projector, &far_input)?.twist);
        off_frame = off_frame.max((far.linear - twist.linear).norm());
        off_frame = off_frame.max((far.angular - twist.angular).norm());
        if t > 1.0 {
            let gap = target.translation - pose.translation;
            force_error = force_error.max((STIFFNESS * depth - FORCE).abs());
            off_path = off_path.max((gap - normal * gap.dot(normal)).norm());
        }
    }
    println!("after the first second of {DURATION} s, at {FORCE} N:");
    println!("largest force error: {force_error:.1e} N");
    println!("largest distance from the path, in the plane: {off_path:.1e} m");
    println!("largest difference of the commands of two frames 9 m apart: {off_frame:.1e}");
    assert!(force_error < 0.01 && off_path < 2e-5 && off_frame < 1e-12);
    Ok(())
}

#[test]
fn it_writes() {
    main().unwrap();
}
