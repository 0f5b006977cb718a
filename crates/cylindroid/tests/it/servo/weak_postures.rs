//! Postures of joints that accelerate slowly: nothing swings about them.

use cylindroid::closure::assemble;
use cylindroid::control::{MotionTask, TaskObjective, TaskServo, TaskServoOptions};

use super::closed_edges::weakened;
use super::escape::within;
use super::*;

/// The distance from a posture, and by how much it rises at most.
struct Watch {
    goal: Vec<f64>,
    distance: f64,
    least: f64,
    rise: f64,
}

impl Watch {
    fn new(goal: &[f64]) -> Self {
        let most = f64::INFINITY;
        Self { goal: goal.to_vec(), distance: most, least: most, rise: 0.0 }
    }

    fn see(&mut self, q: &[f64]) {
        let squares = q.iter().zip(&self.goal).map(|(a, b)| (a - b) * (a - b));
        self.distance = squares.sum::<f64>().sqrt();
        self.least = self.least.min(self.distance);
        self.rise = self.rise.max(self.distance - self.least);
    }
}

/// After 30 s of a servo of tasks, a posture with this gain the last of them.
fn of_tasks(
    (robot, start): (&Mechanism, &[f64]),
    mut tasks: Vec<MotionTask>,
    (goal, gain): (&[f64], f64),
) -> Watch {
    let posture = TaskObjective::Posture { q: goal.to_vec() };
    tasks.push(MotionTask { gain, ..MotionTask::new("posture", posture) });
    let options = TaskServoOptions { dt: 1e-2, ..TaskServoOptions::new(robot) };
    let mut servo = TaskServo::new(robot, tasks, options).unwrap();
    let (mut q, mut watch) = (start.to_vec(), Watch::new(goal));
    for _ in 0..3000 {
        servo.step(&q).unwrap();
        servo.advance(&mut q);
        watch.see(&q);
    }
    watch
}

/// With the gain alone joints swing beyond a posture by 0.7 rad and more.
#[test]
fn weak_joints_rest_at_a_posture() {
    for name in ["panda", "iiwa14", "ur5e"] {
        for acceleration in [0.5, 2.0] {
            let robot = weakened(name, acceleration);
            let mut random = Random(5);
            for _ in 0..4 {
                let (start, goal) = (within(&robot, &mut random), within(&robot, &mut random));
                let Watch { distance, rise, .. } =
                    of_tasks((&robot, &start), Vec::new(), (&goal, 2.0));
                let case = format!("{name} {acceleration}: {distance:.1e} off, rise {rise:.1e}");
                println!("{case}");
                assert!(distance < 1e-3 && rise < 1e-3, "{case}");
            }
        }
    }
}

/// Beside a task they come as near as it lets them and stay there, in both servos, and towards the middle
/// of their limits too.
#[test]
fn weak_joints_rest_beside_a_task() {
    for name in ["panda", "ur5e"] {
        for acceleration in [0.5, 2.0] {
            let robot = weakened(name, acceleration);
            let mut random = Random(6);
            for round in 0..6 {
                let start = within(&robot, &mut random);
                let mut goal = within(&robot, &mut random);
                let pose = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
                let watch = if round % 3 == 0 {
                    let objective = TaskObjective::Frame {
                        end_effector: robot.tool().into(),
                        components: Task::POSITION,
                        target: pose.into(),
                    };
                    of_tasks(
                        (&robot, &start),
                        vec![MotionTask::new("tool", objective)],
                        (&goal, 2.0),
                    )
                } else {
                    let secondary = if round % 3 == 1 {
                        SecondaryTask::Posture { q: goal.clone(), gain: 2.0 }
                    } else {
                        let limits = robot.coordinates().iter().map(|c| c.limits);
                        goal = limits.map(|l| 0.5 * (l.lower + l.upper)).collect();
                        SecondaryTask::Centring { gain: 2.0 }
                    };
                    let options = ServoOptions {
                        dt: 1e-2,
                        task: Task::POSITION,
                        secondary: vec![secondary],
                        ..ServoOptions::new(&robot)
                    };
                    let mut servo = Servo::new(&robot, options).unwrap();
                    let (mut q, mut watch) = (start.clone(), Watch::new(&goal));
                    for _ in 0..3000 {
                        servo.step(&q, pose).unwrap();
                        servo.advance(&mut q);
                        watch.see(&q);
                    }
                    watch
                };
                let Watch { distance, least, rise, .. } = watch;
                let case = format!("{name} {acceleration} {round}: {distance}, rise {rise:.1e}");
                println!("{case}");
                assert!(rise < 0.02 && distance - least < 0.01, "{case}");
            }
        }
    }
}

/// Of a closed chain the drives brake, and the passive joints follow.
#[test]
fn weak_drives_of_closed_chains_rest_at_a_posture() {
    for name in ["five-bar", "3rrr"] {
        let robot = weakened(name, 0.5);
        let start = assemble(&robot, robot.home(), &[]).unwrap().q;
        let drives: Vec<usize> = robot.actuated().collect();
        let ahead = |way: f64| {
            let mut goal = start.clone();
            goal[drives[0]] += way;
            Some(assemble(&robot, &goal, &drives).unwrap()).filter(|found| found.closed)
        };
        let goal = [0.5, -0.5, 0.25, -0.25].into_iter().find_map(ahead).unwrap();
        let Watch { distance, rise, .. } = of_tasks((&robot, &start), Vec::new(), (&goal.q, 5.0));
        assert!(distance < 1e-3 && rise < 1e-3, "{name}: {distance:.1e} off, rise {rise:.1e}");
    }
}
