//! The controller without DDS: joint states by name, the watchdog, frames, refusals.

#![allow(clippy::unwrap_used)] // a test that fails

use cylindroid::closure::assemble;
use cylindroid::{Mechanism, catalogue};
use cylindroid_ros2::controller::{Command, Controller, Output};
use cylindroid_ros2::messages::{
    Header, JointState, Point, Pose, PoseStamped, Quaternion, Twist, TwistStamped, Vector3,
};
use cylindroid_ros2::parameters::{CommandKind, Parameters};
use cylindroid_ros2::report::State;

const DT: f64 = 0.004;

/// A robot whose drives are ideal, and a clock.
struct Loop {
    robot: Mechanism,
    controller: Controller,
    names: Vec<String>,
    q: Vec<f64>,
    now: f64,
    is_velocity: bool,
}

impl Loop {
    fn new(robot: &str, change: impl FnOnce(&mut Parameters)) -> Self {
        let robot = catalogue::load(robot).unwrap();
        let mut parameters = Parameters { robot: Some("-".to_owned()), ..Parameters::default() };
        change(&mut parameters);
        let is_velocity = parameters.command == Some(CommandKind::Velocities);
        let controller = Controller::new(&parameters.config().unwrap(), &robot).unwrap();
        let names = controller.joint_names().map(str::to_owned).collect();
        let mut q = robot.home().to_vec();
        q.iter_mut().enumerate().for_each(|(i, x)| *x += 0.1 + 0.02 * i as f64);
        Self { robot, controller, names, q, now: 10.0, is_velocity }
    }

    fn joint_state(&self) -> JointState {
        // In another order than that of the model, and with a joint of somebody else.
        let coordinates = self.robot.coordinates().iter().rev();
        let mut name: Vec<String> = coordinates.map(|c| c.name.clone()).collect();
        let mut position: Vec<f64> = self.q.iter().rev().copied().collect();
        name.push("gripper".to_owned());
        position.push(0.04);
        JointState { name, position, ..JointState::default() }
    }

    /// A cycle without a joint state.
    fn blind(&mut self) -> Output {
        self.now += DT;
        let output = self.controller.step(self.now);
        if let Some(Command { positions, velocities }) = &output.command {
            for (i, name) in self.names.iter().enumerate() {
                let c = self.robot.coordinates().iter().position(|c| c.name == *name).unwrap();
                self.q[c] =
                    if self.is_velocity { self.q[c] + DT * velocities[i] } else { positions[i] };
            }
        }
        output
    }

    fn cycle(&mut self) -> Output {
        let message = self.joint_state();
        self.controller.joint_state(&message, self.now + DT);
        self.blind()
    }

    fn tool(&self) -> cylindroid::Pose {
        self.robot.state(&self.q).unwrap().pose(self.robot.tool()).unwrap()
    }

    fn pose(&mut self, frame_id: &str, pose: cylindroid::Pose) {
        let (p, q) = (pose.translation, pose.rotation.to_quaternion());
        let message = PoseStamped {
            header: Header { frame_id: frame_id.to_owned(), ..Header::default() },
            pose: Pose {
                position: Point { x: p.x, y: p.y, z: p.z },
                orientation: Quaternion { x: q.x, y: q.y, z: q.z, w: q.w },
            },
        };
        self.controller.pose(&message, self.now);
    }

    fn twist(&mut self, frame_id: &str, [x, y, z]: [f64; 3]) {
        let message = TwistStamped {
            header: Header { frame_id: frame_id.to_owned(), ..Header::default() },
            twist: Twist { linear: Vector3 { x, y, z }, ..Twist::default() },
        };
        self.controller.twist(&message, self.now);
    }
}

fn speed(output: &Output) -> f64 {
    let command = output.command.as_ref().unwrap();
    command.velocities.iter().fold(0.0, |most, v| v.abs().max(most))
}

const KINDS: [CommandKind; 2] = [CommandKind::Trajectory, CommandKind::Velocities];

#[test]
fn nothing_is_commanded_before_all_joints_are_known() {
    let mut arm = Loop::new("ur5e", |_| {});
    arm.twist("", [0.0, 0.0, 0.1]);
    let output = arm.blind();
    assert_eq!((output.command, output.report.state), (None, State::Waiting));
    let mut message = arm.joint_state();
    let last = message.name.iter().position(|n| n == "elbow_joint").unwrap();
    message.name.remove(last);
    message.position.remove(last);
    arm.controller.joint_state(&message, arm.now);
    arm.twist("", [0.0, 0.0, 0.1]);
    let report = arm.blind().report;
    assert_eq!(report.text(), "waiting: no position of elbow_joint yet");
    arm.cycle();
    arm.twist("", [0.0, 0.0, 0.1]);
    assert_eq!(arm.cycle().report.state, State::Following);
}

#[test]
fn broken_joint_states_are_refused() {
    let mut arm = Loop::new("ur5e", |_| {});
    arm.cycle();
    let (good, age) = (arm.joint_state(), arm.cycle().report.age.unwrap());
    assert!(age < 1e-9);
    for (message, reason) in [
        (JointState { position: vec![0.0], ..good.clone() }, "1 positions for 7 names"),
        (
            JointState { position: vec![f64::NAN; 7], ..good.clone() },
            "(shoulder_pan_joint) is not finite",
        ),
        (JointState { position: vec![1e300; 7], ..good.clone() }, "out of range"),
    ] {
        arm.controller.joint_state(&message, arm.now);
        let report = arm.blind().report;
        assert!(report.text().contains(reason), "{}", report.text());
    }
    // One of velocities alone says nothing about positions.
    let silent = JointState { position: vec![], velocity: vec![0.0; 7], ..good };
    arm.controller.joint_state(&silent, arm.now);
    assert!(arm.blind().report.age.unwrap() > 2.0 * DT);
}

#[test]
fn a_pose_is_reached_in_the_frame_of_its_header() {
    for kind in KINDS {
        let mut arm = Loop::new("ur5e", |p| p.command = Some(kind));
        assert_eq!(arm.cycle().report.state, State::AtRest);
        let mut goal = arm.tool();
        goal.translation.z += 0.05;
        let mut last = None;
        for _ in 0..1500 {
            arm.pose("", goal);
            last = Some(arm.cycle());
        }
        let report = last.unwrap().report;
        assert_eq!(report.state, State::Reached, "{report:?}");
        assert!((arm.tool().translation - goal.translation).norm() < 1e-5);
        // Seen from the tool, where it began: 2 cm along its own x axis.
        let begun = arm.tool();
        let ahead = cylindroid::Pose::from_translation(cylindroid::Vec3::X * 0.02);
        arm.pose("tool0", ahead);
        let [position, angle] = arm.cycle().report.errors.unwrap();
        assert!((position - 0.02).abs() < 1e-5 && angle < 1e-5, "{position} {angle}");
        (0..20).for_each(|_| drop(arm.cycle()));
        let way = arm.tool().translation - begun.translation;
        assert!(way.dot(begun.rotation.x_axis()) > 0.99 * way.norm() && way.norm() > 1e-3);
    }
}

#[test]
fn a_twist_is_in_the_axes_of_its_frame() {
    for (frame, scale) in [("", 1.0), ("tool0", 1.0), ("base", 1.0), ("tool0", 0.4)] {
        let mut arm = Loop::new("ur5e", |p| p.linear_scale = Some(scale));
        arm.cycle();
        let begun = arm.tool();
        for _ in 0..250 {
            arm.twist(frame, [0.0, 0.0, 0.1]);
            assert_eq!(arm.cycle().report.state, State::Following);
        }
        let axis = if frame == "tool0" { begun.rotation.z_axis() } else { cylindroid::Vec3::Z };
        let way = arm.tool().translation - begun.translation - axis * (0.1 * scale);
        assert!(way.norm() < 3e-3, "{frame}: {way:?}");
    }
}

#[test]
fn the_watchdog_brakes_then_falls_silent() {
    for kind in KINDS {
        for is_pose in [false, true] {
            let mut arm = Loop::new("panda", |p| p.command = Some(kind));
            let mut goal = {
                arm.cycle();
                arm.tool()
            };
            goal.translation.z += 0.2;
            for _ in 0..50 {
                if is_pose {
                    arm.pose("", goal)
                } else {
                    arm.twist("", [0.0, 0.0, 0.2])
                }
                arm.cycle();
            }
            let (mut moving, mut braking, mut before) = (0, 0, f64::INFINITY);
            loop {
                let output = arm.cycle();
                let report = output.report.clone();
                if report.state == State::Braking {
                    assert_eq!(report.reason, "no command for 0.1 s");
                    assert!(speed(&output) <= before);
                    before = speed(&output);
                    braking += 1;
                } else if report.state == State::AtRest {
                    assert_eq!(output.command, None);
                    break;
                } else {
                    moving += 1;
                }
                assert!(moving + braking < 200, "{report:?}");
            }
            assert_eq!(before, 0.0, "the last command is rest");
            // The command holds for 0.1 s, rest is commanded as long.
            assert!((24..=26).contains(&moving) && braking > 25, "{moving} {braking}");
            let still = arm.q.clone();
            (0..50).for_each(|_| assert_eq!(arm.cycle().command, None));
            assert_eq!(arm.q, still);
        }
    }
}

#[test]
fn old_joint_states_stop_the_robot() {
    for kind in KINDS {
        let mut arm = Loop::new("panda", |p| p.command = Some(kind));
        for _ in 0..50 {
            arm.twist("", [0.0, 0.1, 0.0]);
            assert!(arm.cycle().command.is_some());
        }
        let (mut states, mut last) = (vec![], None);
        for _ in 0..150 {
            arm.twist("", [0.0, 0.1, 0.0]);
            let output = arm.blind();
            states.push(output.report.state);
            last = output.command.map(|c| c.velocities).or(last);
        }
        let kept = states.iter().filter(|s| **s == State::Following).count();
        assert!((48..=51).contains(&kept), "0.2 s: {kept}");
        assert_eq!(states.last(), Some(&State::Stopped));
        assert!(last.unwrap().iter().all(|v| *v == 0.0));
        // It goes on with the next joint state.
        arm.twist("", [0.0, 0.1, 0.0]);
        assert_eq!(arm.cycle().report.state, State::Following);
    }
}

#[test]
fn drives_that_do_not_follow_stop_the_robot() {
    let mut arm = Loop::new("ur5e", |_| {});
    arm.cycle();
    let stuck = arm.q.clone();
    let mut last = None;
    for _ in 0..2000 {
        arm.twist("", [0.0, 0.0, 0.2]);
        arm.q.copy_from_slice(&stuck);
        last = Some(arm.cycle());
    }
    let report = last.unwrap().report;
    assert_eq!(report.state, State::Stopped);
    assert!(report.reason.contains("from its command: it does not follow"), "{report:?}");
    // The client lets go, and may begin again.
    (0..50).for_each(|_| drop(arm.cycle()));
    arm.twist("", [0.0, 0.0, 0.2]);
    assert_eq!(arm.cycle().report.state, State::Following);
}

#[test]
fn a_stall_has_its_reason() {
    let mut arm = Loop::new("ur5e", |_| {});
    arm.cycle();
    let mut goal = arm.tool();
    goal.translation.x += 5.0;
    let mut last = None;
    for _ in 0..2000 {
        arm.pose("", goal);
        last = Some(arm.cycle().report);
    }
    let report = last.unwrap();
    assert_eq!(report.state, State::Stalled);
    assert!(report.reason.contains("m from the first joint, the stretched arm"), "{report:?}");
}

#[test]
fn targets_that_cannot_be_followed_are_refused() {
    let mut arm = Loop::new("ur5e", |_| {});
    arm.cycle();
    let goal = arm.tool();
    arm.pose("camera", goal);
    let report = arm.cycle().report;
    assert!(report.text().contains("no frame named 'camera'"), "{}", report.text());
    arm.twist("", [f64::NAN, 0.0, 0.0]);
    assert!(arm.cycle().report.text().contains("a twist is not finite"));
    let none = PoseStamped::default(); // its quaternion is zero
    arm.controller.pose(&none, arm.now);
    assert!(arm.cycle().report.text().contains("has length 0.000"));
    assert_eq!(arm.cycle().command, None);
}

#[test]
fn a_shut_down_brakes() {
    let mut arm = Loop::new("panda", |_| {});
    for _ in 0..50 {
        arm.twist("", [0.0, 0.0, 0.2]);
        arm.cycle();
    }
    arm.controller.shut_down();
    let mut last = None;
    while !arm.controller.is_idle() {
        arm.twist("", [0.0, 0.0, 0.2]);
        last = arm.cycle().command.or(last);
    }
    assert!(last.unwrap().velocities.iter().all(|v| *v == 0.0));
    arm.twist("", [0.0, 0.0, 0.2]);
    let report = arm.cycle().report;
    assert_eq!(report.text(), "stopped: the node is shut down");
}

/// The object of a closed chain, by its drives: passive joints are measured, but not commanded.
#[test]
fn closed_chains_are_commanded_their_drives() {
    let mut linkage = Loop::new("five-bar", |p| p.task = Some("x,y".to_owned()));
    let actuated: Vec<usize> = linkage.robot.actuated().collect();
    assert!(linkage.names.len() == actuated.len() && actuated.len() < linkage.robot.n());
    linkage.q.copy_from_slice(linkage.robot.home());
    let reference =
        |l: &Loop| l.robot.state(&l.q).unwrap().pose(l.robot.reference()).unwrap().translation;
    let begun = reference(&linkage);
    for _ in 0..100 {
        linkage.twist("", [0.0, 0.1, 0.0]);
        assert_eq!(linkage.cycle().report.state, State::Following);
        linkage.q = assemble(&linkage.robot, &linkage.q, &actuated).unwrap().q;
    }
    let way = reference(&linkage) - begun;
    assert!((way - cylindroid::Vec3::Y * 0.04).norm() < 2e-3, "{way:?}");
}

#[test]
fn commanded_joints_have_the_order_of_the_controller() {
    let mut order: Vec<String> = Loop::new("ur5e", |_| {}).names;
    order.rotate_left(2);
    let mut arm = Loop::new("ur5e", |p| p.joints = Some(order.clone()));
    assert_eq!(arm.names, order);
    arm.cycle();
    arm.twist("", [0.0, 0.0, 0.1]);
    arm.cycle();
    let expected: Vec<f64> = order
        .iter()
        .map(|n| arm.q[arm.robot.coordinates().iter().position(|c| c.name == *n).unwrap()])
        .collect();
    arm.twist("", [0.0, 0.0, 0.1]);
    let positions = arm.cycle().command.unwrap().positions;
    let near = positions.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 0.01);
    assert!(near, "{positions:?} {expected:?}");

    let robot = catalogue::load("ur5e").unwrap();
    let refused = |joints: &[&str]| {
        let joints = Some(joints.iter().map(|j| (*j).to_owned()).collect());
        let config = Parameters { joints, ..Parameters::default() }.config().unwrap();
        Controller::new(&config, &robot).unwrap_err().to_string()
    };
    assert!(refused(&["elbow"]).contains("no joint named 'elbow'"));
    assert!(refused(&["elbow_joint"]).contains("'shoulder_pan_joint' moves the frame"));
}
