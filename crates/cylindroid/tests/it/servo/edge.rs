//! Targets beyond reach: an arm comes to rest at the nearest pose, and says so.

use cylindroid::control::{Stall, Status};
use cylindroid::inverse::Method;
use cylindroid::{Mechanism, Servo, ServoOptions, Vec3, catalogue};

/// A motion to the edge of reach.
#[derive(Debug)]
struct ToTheEdge {
    /// Time until the stall is named (s).
    time: f64,
    /// Motion of the tool away from the target (m).
    back: f64,
    /// Error left, angles times the characteristic length (m).
    left: f64,
    stall: Option<Stall>,
}

/// From home towards a target 1.5 m away in this direction, at most a minute.
fn to_the_edge(name: &str, direction: Vec3, acceleration: f64, dt: f64) -> ToTheEdge {
    let robot = catalogue::load(name).unwrap();
    let options = ServoOptions { acceleration, dt, ..ServoOptions::new(&robot) };
    to_the_edge_with(&robot, direction, options)
}

fn to_the_edge_with(robot: &Mechanism, direction: Vec3, options: ServoOptions) -> ToTheEdge {
    let (dt, length) = (options.dt, options.length);
    let mut servo = Servo::new(robot, options).unwrap();
    let mut q = robot.home().to_vec();
    let mut target = robot.state(&q).unwrap().pose(robot.tool());
    target.translation += direction * 1.5;
    let mut last = f64::INFINITY;
    let mut motion = ToTheEdge { time: f64::INFINITY, back: 0.0, left: 0.0, stall: None };
    let mut time = 0.0;
    while time < 60.0 {
        let step = servo.step(&q, target).unwrap();
        servo.advance(&mut q);
        motion.back += (step.position_error - last).max(0.0);
        last = step.position_error;
        motion.left = last.hypot(length * step.orientation_error);
        time += dt;
        if step.status == Status::Stalled {
            motion.time = time;
            motion.stall = Some(servo.stall());
            break;
        }
    }
    motion
}

/// From 5 rad/s^2 on without a millimetre of motion backwards; weaker arms move back by up to 2 cm on
/// their way, because they brake for the configuration of the nearest pose, not for a path.
#[test]
fn arms_come_to_rest_at_the_edge_of_their_reach() {
    let directions = [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.0, 0.8)];
    let arms = ["ur5e", "iiwa14", "puma560"];
    for (name, direction) in arms.iter().flat_map(|n| directions.map(|d| (n, d))) {
        let ideal = to_the_edge(name, direction, f64::INFINITY, 1e-2);
        let cases = [(0.5, 1e-2), (1.0, 1e-2), (2.0, 1e-2), (5.0, 2e-3), (5.0, 1e-2)];
        let strong = [(10.0, 1e-2), (20.0, 5e-3), (40.0, 1e-2)];
        for (acceleration, dt) in cases.into_iter().chain(strong) {
            let motion = to_the_edge(name, direction, acceleration, dt);
            let case =
                format!("{name} {direction:?} at {acceleration} rad/s^2, {dt} s: {motion:?}");
            println!("{case}");
            assert!(matches!(motion.stall, Some(Stall::OutOfReach { .. })), "{case}");
            assert!(motion.left < ideal.left + 0.005, "{case}, {ideal:?}");
            let (back, time) = if acceleration < 5.0 { (0.02, 20.0) } else { (1e-3, 8.0) };
            assert!(motion.back < back && motion.time < time, "{case}, {ideal:?}");
        }
    }
}

/// The same with every inverse.
#[test]
fn all_inverses_come_to_rest_at_the_edge() {
    let robot = catalogue::load("ur5e").unwrap();
    for (method, acceleration) in Method::ALL.into_iter().flat_map(|m| [2.0, 10.0].map(|a| (m, a)))
    {
        for direction in [Vec3::X, Vec3::new(-0.6, 0.64, 0.48)] {
            let options =
                ServoOptions { acceleration, dt: 1e-2, method, ..ServoOptions::new(&robot) };
            let motion = to_the_edge_with(&robot, direction, options);
            let case =
                format!("{} {direction:?} at {acceleration} rad/s^2: {motion:?}", method.name());
            println!("{case}");
            assert!(matches!(motion.stall, Some(Stall::OutOfReach { .. })), "{case}");
            assert!(motion.back < 1e-3 && motion.time < 20.0, "{case}");
        }
    }
}
