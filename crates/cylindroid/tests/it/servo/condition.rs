//! What a servo says of a configuration.

use super::*;

/// The scaled Jacobian of whole poses.
fn scaled(robot: &Mechanism, q: &[f64], length: f64) -> Matrix {
    let j =
        robot.state(q).unwrap().jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    Matrix::from_fn(6, j.cols(), |i, k| if i < 3 { j[(i, k)] / length } else { j[(i, k)] })
}

fn bent(robot: &Mechanism) -> Vec<f64> {
    (0..robot.n()).map(|i| [0.3, -0.9, 0.5, -1.6, 0.4, 1.5, 0.6][i % 7]).collect()
}

#[test]
fn singular_values_are_those_of_a_step_and_the_weakest_motion_needs_most() {
    for name in ["panda", "ur5e", "youbot"] {
        let robot = catalogue::load(name).unwrap();
        let q = bent(&robot);
        let mut servo = servo(&robot, |_| ());
        let condition = servo.condition(&q).unwrap();
        let step = servo.step(&q, robot.state(&q).unwrap().pose(robot.tool()).unwrap()).unwrap();
        assert!((condition.singular_ratio - step.singular_ratio).abs() < 1e-12);
        assert_eq!(condition.inverse.rank, step.rank);
        let length = robot.reach();
        let j = scaled(&robot, &q, length);
        let values: Vec<f64> = Svd::of(&j).values().collect();
        crate::support::assert_close(name, &condition.inverse.singular_values, &values, 1e-12);
        // J^T u = s v for the last u, which has length one in scaled units.
        let weakest = condition.weakest.unwrap();
        let u = Twist { linear: weakest.linear * (1.0 / length), ..weakest }.to_array();
        let size = u.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((size - 1.0).abs() < 1e-12, "{name}");
        let mut v = vec![0.0; j.cols()];
        j.tr_mul_vec_into(&u, &mut v);
        let s = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((s - values[values.len() - 1]).abs() < 1e-12, "{name}: {s} and {values:?}");
    }
}

/// A slider cannot turn its tool: no singular value, and a ratio of zero.
#[test]
fn without_any_motion_of_the_task_the_ratio_is_zero() {
    let slider = r#"<robot name="slider"><link name="base"/><link name="cart"/>
        <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/>
        <axis xyz="1 0 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"#;
    let robot =
        cylindroid::model::formats::urdf::parse(slider, std::path::Path::new("slider.urdf"))
            .unwrap();
    let turn = Task { components: [false, false, false, true, true, true], ..Task::POSE };
    let mut servo = servo(&robot, |o| o.task = turn);
    assert_eq!(servo.condition(&[0.0]).unwrap().singular_ratio, 0.0);
    let pose = robot.state(&[0.0]).unwrap().pose(robot.tool()).unwrap();
    let turned = Pose { rotation: Rpy { roll: 0.3, pitch: 0.0, yaw: 0.0 }.rotation(), ..pose };
    let step = servo.step(&[0.0], turned).unwrap();
    assert_eq!((step.singular_ratio, step.rank), (0.0, 0));
}

/// Pointing is a task in the axes of the tool; what is lost is told in those of the world.
#[test]
fn the_weakest_motion_is_in_world_axes() {
    let robot = catalogue::load("panda").unwrap();
    let q = bent(&robot);
    let condition = |axes: ReferenceFrame| {
        let task = Task { axes, ..Task::POSE };
        servo(&robot, |o| o.task = task).condition(&q).unwrap()
    };
    let [world, local] = [ReferenceFrame::LocalWorldAligned, ReferenceFrame::Local].map(condition);
    let (a, b) = (world.weakest.unwrap(), local.weakest.unwrap());
    let sign = a.angular.dot(b.angular).signum();
    crate::support::assert_close("twist", &(b * sign).to_array(), &a.to_array(), 1e-9);
}

#[test]
fn looking_at_a_posture_changes_no_motion() {
    for name in ["panda", "five-bar"] {
        let robot = catalogue::load(name).unwrap();
        let target = |s: &Servo| {
            let pose = robot.state(robot.home()).unwrap().pose(s.options().end_effector).unwrap();
            Pose { translation: pose.translation + Vec3::new(0.05, -0.02, 0.0), ..pose }
        };
        let mut plain = servo(&robot, |o| o.acceleration = Some(2.0));
        let mut looked = plain.clone();
        let (mut a, mut b) = (robot.home().to_vec(), robot.home().to_vec());
        for i in 0..50 {
            plain.step(&a, target(&plain)).unwrap();
            plain.advance(&mut a);
            looked.step(&b, target(&looked)).unwrap();
            looked.advance(&mut b);
            if i % 7 == 0 {
                looked.condition(robot.home()).unwrap();
                looked.self_motions(&b).unwrap();
            }
        }
        assert_eq!(a, b, "{name}");
    }
}

#[test]
fn self_motions_leave_the_tool_at_rest_at_full_speed() {
    let mut moving = 0;
    for (name, redundancy) in
        [("panda", 1), ("ur5e", 0), ("youbot", 0), ("five-bar", 0), ("stewart", 0)]
    {
        let robot = catalogue::load(name).unwrap();
        let mut servo = servo(&robot, |_| ());
        assert_eq!(servo.redundancy(), redundancy, "{name}");
        let q = if robot.is_closed() { robot.home().to_vec() } else { bent(&robot) };
        let motions = servo.self_motions(&q).unwrap();
        assert_eq!(motions.len(), redundancy, "{name}");
        for motion in motions {
            moving += 1;
            let twist =
                robot.state(&q).unwrap().twist(&motion, robot.tool(), ReferenceFrame::World);
            assert!(twist.unwrap().to_array().iter().all(|x| x.abs() < 1e-12), "{name}");
            let share =
                |(rate, c): (&f64, &cylindroid::model::Coordinate)| rate.abs() / c.limits.velocity;
            let fastest = motion.iter().zip(robot.coordinates()).map(share).fold(0.0, f64::max);
            assert!((fastest - 1.0).abs() < 1e-12, "{name}");
            // A moment later it is nearly the same, also if it went the other way.
            let next = robot.integrate(&q, &motion, 1e-3).unwrap();
            for sign in [1.0, -1.0] {
                let last: Vec<f64> = motion.iter().map(|x| sign * x).collect();
                let carried = servo.next_self_motion(&next, &last).unwrap().unwrap();
                crate::support::assert_close(name, &carried, &last, 0.05);
            }
            assert_eq!(servo.next_self_motion(&q, &vec![0.0; robot.n()]).unwrap(), None);
        }
    }
    assert_eq!(moving, 1);
    let robot = catalogue::load("panda").unwrap();
    let mut position = servo(&robot, |o| o.task = Task::POSITION);
    assert_eq!(
        (position.redundancy(), position.self_motions(&bent(&robot)).unwrap().len()),
        (4, 4)
    );
}

/// Drives that a task does not need are redundant on closed chains as well: loops stay closed.
#[test]
fn self_motions_of_closed_chains_keep_their_loops() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let task = Task::named("x", &five_bar).unwrap();
    let mut servo = servo(&five_bar, |o| o.task = task);
    let motions = servo.self_motions(five_bar.home()).unwrap();
    assert_eq!((servo.redundancy(), motions.len()), (1, 1));
    let h = 1e-5;
    let q = five_bar.integrate(five_bar.home(), &motions[0], h).unwrap();
    let gap = cylindroid::closure::LoopClosureError::of(&five_bar.state(&q).unwrap()).unwrap();
    assert!(gap.distance < 100.0 * h * h, "{gap:?}");
    let x =
        |q: &[f64]| five_bar.state(q).unwrap().pose(five_bar.reference()).unwrap().translation.x;
    assert!((x(&q) - x(five_bar.home())).abs() < 100.0 * h * h);
}

#[test]
fn condition_refuses_what_steps_refuse() {
    let robot = catalogue::load("panda").unwrap();
    let mut servo = servo(&robot, |_| ());
    assert!(servo.condition(&[0.0; 3]).is_err() && servo.self_motions(&[f64::NAN; 7]).is_err());
    assert!(servo.next_self_motion(&[0.0; 7], &[0.0; 6]).is_err());
}
