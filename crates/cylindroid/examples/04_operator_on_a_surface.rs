//! An operator moves a tool along a sphere that the robot keeps it on: shared control.
#![allow(clippy::print_stdout)]

use cylindroid::control::{
    AuthorityTimes, OperatorAuthority, SharedController, SharedInput, Status, Target,
};
use cylindroid::kinematics::Chain;
use cylindroid::screws::{Complement, Projector, ScrewOptions};
use cylindroid::{Pose, Rotation, Servo, ServoOptions, Twist, Vec3};

const DT: f64 = 1e-3; // s
const DURATION: f64 = 6.0; // s
const RADIUS: f64 = 0.2; // m

/// The hand on the joystick, world axes at the tool: it circles, and all the time it pushes down
/// into the sphere and twists the tool away.
fn operator(t: f64) -> Twist {
    Twist {
        linear: Vec3::new(0.1 * (2.0 * t).cos(), 0.1 * (2.0 * t).sin(), -0.3),
        angular: Vec3::new(0.5, -0.5, (3.0 * t).sin()),
    }
}

/// Distance from the sphere (m) and the angle between the tool and its normal (rad).
fn off_surface(center: Vec3, pose: Pose) -> (f64, f64) {
    let lever = pose.translation - center;
    let sine = pose.rotation.z_axis().cross(lever * (1.0 / lever.norm())).norm();
    ((lever.norm() - RADIUS).abs(), sine.asin())
}

fn main() -> cylindroid::Result<()> {
    let robot = cylindroid::load("panda")?;
    let mut servo = Servo::new(&robot, ServoOptions { dt: DT, ..ServoOptions::new(&robot) })?;
    let mut chain = Chain::new(&robot, robot.tool())?;
    let mut q = robot.home().to_vec();

    // The sphere is 5 mm below the tool, which is tilted against its normal by 0.05 rad.
    let start = chain.set(&q);
    let down = Rotation::exp(Vec3::X * 0.05) * start.rotation.z_axis();
    let center = start.translation + down * (RADIUS + 0.005);

    let law = SharedController::new(10.0)?;
    let mut share = OperatorAuthority::new(AuthorityTimes { dt: DT, fall: 0.1, rise: 0.5 })?;
    let options = ScrewOptions::with_length(robot.reach());
    let (mut off, mut way, mut pushed_off) = ((0.0_f64, 0.0_f64), 0.0, 0.0_f64);
    for step in 0..(DURATION / DT) as u32 {
        let t = f64::from(step) * DT;
        let pose = chain.set(&q);
        let lever = pose.translation - center;
        let out = lever * (1.0 / lever.norm());
        let Some(across) = Rotation::z_to(out) else { break };

        // The operator turns the tool about the centre; the robot pulls it back along the normal
        // and tilts it about its tip. Together they are all six.
        let about = |w: Vec3| Twist { linear: w.cross(lever), angular: w };
        let tilt = |w: Vec3| Twist { linear: Vec3::ZERO, angular: w };
        let retreat = Twist { linear: out, angular: Vec3::ZERO };
        let free = [about(Vec3::X), about(Vec3::Y), about(Vec3::Z)];
        let kept = [retreat, tilt(across.x_axis()), tilt(across.y_axis())];
        let projector = match Projector::of(&free, Complement::Twists(&kept), &options)? {
            Ok(projector) => projector,
            Err(reason) => {
                println!("no shared law: {reason}");
                return Ok(());
            }
        };

        let input = SharedInput {
            error: Twist {
                linear: out * (RADIUS - lever.norm()),
                angular: pose.rotation.z_axis().cross(-out),
            },
            feed_forward: Twist::ZERO, // the sphere is at rest
            operator: operator(t) * share.get(),
        };
        let command = law.command(&projector, &input)?;
        pushed_off = pushed_off.max(command.operator_part.linear.dot(out).abs());

        // To the robot: from where it is, with this twist. Limits are the operator's to bear.
        let done = servo.step(&q, Target { pose, feed_forward: command.twist })?;
        share.update(done.saturation);
        if done.status == Status::Stalled {
            println!("stalled at {t:.3} s: {:?}", servo.stall());
            break;
        }
        servo.advance(&mut q);
        way += command.twist.linear.norm() * DT;
        if t > 1.5 {
            let (distance, angle) = off_surface(center, pose);
            off = (off.0.max(distance), off.1.max(angle));
        }
    }
    println!("the tool went {way:.2} m along the sphere");
    println!("of the operator's twist, across the surface: {pushed_off:.1e} m/s at most");
    println!("off the surface after 1.5 s: {:.1e} m, {:.1e} rad at most", off.0, off.1);
    assert!(way > 0.5 && pushed_off < 1e-12);
    // A step of DT goes along the tangent: v^2 DT / (2 RADIUS gain) remains.
    assert!(off.0 < 1e-4 && off.1 < 1e-3);
    Ok(())
}

#[test]
fn it_keeps_the_surface() {
    main().unwrap();
}
