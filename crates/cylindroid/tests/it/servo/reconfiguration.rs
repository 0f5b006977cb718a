//! Random motions, ways round, joint moves.

use super::*;

/// The measure: random in-limit starts to random in-limit reachable targets, no limit ever
/// left, and an honest count of what stalls and why. The share is printed; what is asserted is
/// that every run ends in a report and that what counts as reached is reached.
#[test]
fn random_starts_to_random_targets() {
    for (name, seed) in [("panda", 51), ("ur5e", 52), ("iiwa14", 53), ("puma560", 54)] {
        let robot = catalogue::load(name).unwrap();
        let mut random = Random(seed);
        let mut servo = servo(&robot, |o| {
            o.dt = 4e-3;
            o.acceleration = Some(40.0);
            o.secondary = vec![SecondaryTask::LimitAvoidance { gain: 0.5, margin: 0.2 }];
            o.tolerance = PoseTolerance { position: 1e-4, orientation: 1e-3 };
        });
        let runs = 1000;
        let mut causes = std::collections::BTreeMap::new();
        let mut reached = 0;
        for _ in 0..runs {
            let (from, to) = (random.q(&robot), random.q(&robot));
            let target = robot.state(&to).unwrap().pose(robot.tool()).unwrap();
            let outcome = run_checked(&robot, &mut servo, &from, target);
            if outcome.reached {
                reached += 1;
                let end = robot.state(&outcome.q).unwrap().pose(robot.tool()).unwrap();
                assert!((end.translation - target.translation).norm() <= 1e-4);
                assert!(end.rotation.angle_to(target.rotation) <= 1e-3);
            } else {
                let cause = match &outcome.stall {
                    None => "time ran out",
                    Some(Stall::OutOfReach { .. }) => {
                        panic!("a reachable target, proved unreachable")
                    }
                    Some(Stall::Limits { .. }) => "joint limits",
                    Some(Stall::Singular { .. }) => "singular",
                    Some(Stall::TooFewJoints { .. }) => "too few joints",
                    Some(Stall::NoInverse(_) | Stall::Projected { .. }) => "no inverse",
                    Some(Stall::Slow) => "slow",
                    Some(Stall::TypeII { .. }) => "type II",
                };
                *causes.entry(cause).or_insert(0) += 1;
            }
        }
        println!("{name}: {reached} of {runs} reached; stalled: {causes:?}");
        assert!(reached > 0);
    }
}

/// Random motions that stall are reached by reconfiguration, within all limits.
#[test]
fn a_reconfiguration_reaches_what_the_servo_does_not() {
    let arms = [("panda", 61), ("ur5e", 62), ("puma560", 63), ("iiwa14", 64)];
    for (name, seed) in arms {
        let robot = catalogue::load(name).unwrap();
        let mut random = Random(seed);
        let servo = servo(&robot, |_| {});
        let (mut most, runs) = (0, 300);
        for _ in 0..runs {
            let (from, to) = (random.q(&robot), random.q(&robot));
            let target = robot.state(&to).unwrap().pose(robot.tool()).unwrap();
            let found = find_reachable_configuration(&servo, &from, target, 200).unwrap();
            let found = found.unwrap_or_else(|| panic!("{name}: {to:?} not found"));
            assert_eq!(robot.outside_limits(&found.q).count(), 0);
            let end = robot.state(&found.q).unwrap().pose(robot.tool()).unwrap();
            assert!((end.translation - target.translation).norm() <= 1e-6);
            assert!(end.rotation.angle_to(target.rotation) <= 1e-6);
            most = most.max(found.restarts);
        }
        println!("{name}: {runs} of {runs} found, at most {most} restarts");
    }
    // What nothing reaches is not found.
    let robot = planar(3);
    let servo = servo(&robot, |o| o.task = Task::POSITION);
    let far = Pose::from_translation(Vec3::new(4.0, 0.0, 0.0));
    assert_eq!(find_reachable_configuration(&servo, &[0.0; 3], far, 20).unwrap(), None);
}

/// The move of a reconfiguration keeps every limit and ends at the configuration.
#[test]
fn joint_moves_keep_the_limits() {
    for robot in crate::support::robots() {
        let name = robot.name();
        let mut random = Random(71);
        let (from, to) = (random.q(&robot), random.q(&robot));
        let default = KinematicBounds { velocity: 1.0, acceleration: 40.0, jerk: f64::INFINITY };
        let defaults = JointDefaults { angle: default, length: default };
        let motion = JointMove::within_limits(&robot, &from, &to, &defaults).unwrap();
        let n = robot.n();
        let (mut q, mut rates, mut before) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let (steps, dt) = (1000, motion.law().duration() / 1000.0);
        for step in 0..=steps {
            let t = f64::from(step) * dt;
            motion
                .sample_into(t, JointSample { positions: &mut q, velocities: &mut rates })
                .unwrap();
            for (i, c) in robot.coordinates().iter().enumerate() {
                let (l, q, rate) = (&c.limits, q[i], rates[i]);
                assert!(q >= l.lower && q <= l.upper, "{name}: {} left its limits", c.name);
                assert!(rate.abs() <= l.velocity * (1.0 + 1e-12));
                let most = l.acceleration.min(40.0) * dt * (1.0 + 1e-9) + 1e-12;
                assert!((rate - before[i]).abs() <= most, "{name}: {}", c.name);
            }
            before.copy_from_slice(&rates);
        }
        assert_eq!(q, to);
    }
}
