//! Many tasks in moved, turned, scaled and reordered scenes: the same motions.

use cylindroid::closure::assemble;
use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::control::{
    CollisionAvoidance, HalfSpace, MotionTask, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::kinematics::MassMatrix;
use cylindroid::model::{Geometry, Inclusion, Inertial, Link, Visual};
use cylindroid::spatial::Mat3;

use super::*;

/// How a scene is seen and written down.
#[derive(Debug, Clone, Copy)]
struct View {
    /// The scene's own frame in the world; lengths after `size`.
    world: Pose,
    /// New units of length in an old one.
    size: f64,
    /// In another order: arms, tasks, half-spaces, obstacles.
    reordered: [bool; 4],
    /// Of all joints [rad/s^2, a tenth in m/s^2].
    acceleration: f64,
}

impl View {
    const OWN: Self =
        Self { world: Pose::IDENTITY, size: 1.0, reordered: [false; 4], acceleration: 12.0 };

    fn point(&self, p: Vec3) -> Vec3 {
        self.world.rotation * (p * self.size) + self.world.translation
    }

    fn pose(&self, p: Pose) -> Pose {
        self.world * Pose { translation: p.translation * self.size, ..p }
    }
}

/// A lift and a torso with two arms of spheres and a head.
fn two_armed(view: View) -> Mechanism {
    let mut builder = Mechanism::builder("two-armed");
    let size = view.size;
    let mut add = |name: &str, parent: &str, axis: Vec3, at: Pose| {
        let link = format!("{name}_link");
        let sphere = |x: f64| Visual {
            geometry: Geometry::Sphere { radius: 0.04 * size },
            link_from_shape: Pose::from_translation(Vec3::X * (x * size)),
            ..Visual::default()
        };
        builder.link(Link {
            inertial: Some(Inertial {
                mass: 2.0,
                link_from_inertia: Pose::from_translation(Vec3::new(0.05, -0.02, 0.1) * size),
                inertia: Mat3::ZERO,
            }),
            collisions: vec![sphere(0.0).into(), sphere(0.1).into()],
            ..Link::named(&link)
        });
        let slides = name == "lift";
        let kind = if slides { JointKind::Prismatic } else { JointKind::Revolute };
        let mut joint = JointSpec::new(name, kind, parent, &link);
        joint.axis = axis;
        joint.parent_from_joint = Pose { translation: at.translation * size, ..at };
        let unit = if slides { 0.1 * size } else { 1.0 };
        joint.limits = Limits {
            lower: -2.6 * unit,
            upper: 2.6 * unit,
            velocity: 1.5 * unit,
            acceleration: view.acceleration * unit,
            ..Limits::NONE
        };
        builder.joint(joint);
        link
    };
    let root = Pose { translation: view.world.translation * (1.0 / size), ..view.world };
    let lift = add("lift", "world", Vec3::Z, root);
    let torso = add("torso", &lift, Vec3::Z, Pose::from_translation(Vec3::Z * 0.5));
    let mut sides = [("left", 1.0), ("right", -1.0)];
    if view.reordered[0] {
        sides.reverse();
    }
    for (side, sign) in sides {
        let mut parent = torso.clone();
        let axes = [Vec3::Y, Vec3::X, Vec3::Z, Vec3::Y, Vec3::Z, Vec3::Y, Vec3::X];
        for (i, axis) in axes.into_iter().enumerate() {
            let at = if i == 0 { Vec3::new(0.0, 0.2 * sign, 0.4) } else { Vec3::X * 0.15 };
            parent = add(&format!("{side}_{i}"), &parent, axis, Pose::from_translation(at));
        }
    }
    add("pan", &torso, Vec3::Y, Pose::from_translation(Vec3::Z * 0.6));
    builder.build().unwrap()
}

/// A start by the joints' names.
fn start(robot: &Mechanism, size: f64) -> Vec<f64> {
    let angle = |name: &str| match name.rsplit_once('_').map(|(_, i)| i.parse::<i32>()) {
        Some(Ok(i)) => 0.5 * f64::from(1 - 2 * (i % 2)) + 0.04 * f64::from(i),
        _ if name == "lift" => 0.05 * size,
        _ => 0.1,
    };
    robot.coordinates().iter().map(|c| angle(&c.name)).collect()
}

/// Tasks of every kind on three levels, beside walls and two obstacles.
fn scene(view: View) -> (Mechanism, TaskServo) {
    let robot = two_armed(view);
    let own = two_armed(View::OWN);
    let before = own.state(&start(&own, 1.0)).unwrap();
    let frame = |name: &str| robot.frame(name).unwrap();
    let seen = |name: &str, way: Vec3| {
        let pose = before.pose(own.frame(name).unwrap()).unwrap();
        Pose { translation: pose.translation + way, ..pose }
    };
    let left = TaskObjective::Frame {
        end_effector: frame("left_6_link").into(),
        components: Task::POSE,
        target: view.pose(seen("left_6_link", Vec3::new(0.1, -0.25, 0.3))).into(),
    };
    let [l, r] = ["left_6_link", "right_6_link"].map(|name| seen(name, Vec3::ZERO));
    let apart = l.inverse() * Pose { translation: r.translation + Vec3::X * 0.1, ..r };
    let relative = TaskObjective::RelativeFrame {
        end_effector: frame("right_6_link").into(),
        reference: frame("left_6_link").into(),
        components: Task::POSE,
        target: Pose { translation: apart.translation * view.size, ..apart },
    };
    let mut masses = MassMatrix::new(&own);
    let center = masses.center_of_mass(&before, &mut Matrix::zeros(3, own.n())).unwrap().1;
    let balance = TaskObjective::CenterOfMass {
        axes: [true; 3],
        target: view.point(center + Vec3::new(0.02, 0.02, -0.03)),
        velocity: Vec3::ZERO,
    };
    let gaze = TaskObjective::Gaze {
        end_effector: frame("pan_link").into(),
        point: view.point(Vec3::new(1.0, 0.4, 0.8)),
    };
    let posture = TaskObjective::Posture { q: vec![0.0; robot.n()] };
    let mut tasks = vec![
        MotionTask::new("left", left),
        MotionTask { weight: 2.0, ..MotionTask::new("apart", relative) },
        MotionTask::new("balance", balance).at_level(1),
        MotionTask::new("gaze", gaze).at_level(2),
        MotionTask { gain: 0.5, ..MotionTask::new("posture", posture) },
    ];
    let hand = |name: &str| seen(name, Vec3::ZERO).translation;
    let wall = |name: &str, frame_name: &str, way: Vec3, normal: Vec3| HalfSpace {
        name: name.to_owned(),
        end_effector: frame(frame_name).into(),
        point: view.point(hand(frame_name) + way),
        normal: view.world.rotation * normal,
    };
    let mut walls = vec![
        wall("table", "left_6_link", Vec3::Z * 0.2, -Vec3::Z),
        wall("side", "right_6_link", Vec3::new(0.0, -0.1, 0.0), Vec3::new(0.3, 1.0, 0.0)),
    ];
    let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let ball = Geometry::Sphere { radius: 0.05 * view.size };
    let cube = Geometry::Box { size: Vec3::new(0.1, 0.1, 0.1) * view.size };
    let beside = hand("left_6_link") + Vec3::new(0.05, -0.3, 0.12);
    let below = hand("right_6_link") + Vec3::new(0.3, 0.2, -0.1);
    let mut obstacles = vec![("ball", ball, beside), ("cube", cube, below)];
    if view.reordered[1] {
        tasks.reverse();
    }
    if view.reordered[2] {
        walls.reverse();
    }
    if view.reordered[3] {
        obstacles.reverse();
    }
    for (name, shape, at) in obstacles {
        model.add_obstacle(name, &shape, view.pose(Pose::from_translation(at))).unwrap();
    }
    let mut options = TaskServoOptions::new(&robot);
    options.dt = 2e-3;
    options.half_spaces = walls;
    // Weights have units where joints slide.
    let weight = |is_length: bool| if is_length { view.size.powi(-2) } else { 1.0 };
    options.joint_weights =
        robot.coordinates().iter().map(|c| weight(c.kind.is_length())).collect();
    let (gap, margin) = (0.01 * view.size, 0.2 * view.size);
    options.collisions = Some(CollisionAvoidance { model, gap, margin });
    let servo = TaskServo::new(&robot, tasks, options).unwrap();
    (robot, servo)
}

/// Configurations of a scene by the joints' names, lengths in old units, every 50 steps.
fn motion(view: View, steps: usize) -> Vec<Vec<(String, f64)>> {
    let (robot, mut servo) = scene(view);
    let mut q = start(&robot, view.size);
    let mut seen = Vec::new();
    let mut limited = 0;
    for step in 0..=steps {
        if step % 50 == 0 {
            let mut named: Vec<(String, f64)> = robot
                .coordinates()
                .iter()
                .zip(&q)
                .map(|(c, x)| (c.name.clone(), if c.kind.is_length() { x / view.size } else { *x }))
                .collect();
            named.sort_by(|a, b| a.0.cmp(&b.0));
            seen.push(named);
        }
        servo.step(&q).unwrap();
        limited += usize::from(servo.reports().iter().any(|r| r.stopped_by.is_some()));
        servo.advance(&mut q);
    }
    println!("{view:?}: limited in {limited} steps");
    assert!(limited > 50, "nothing is in the way");
    seen
}

fn differs(a: &[Vec<(String, f64)>], b: &[Vec<(String, f64)>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| {
        a.iter().zip(b).fold(most, |most, (a, b)| {
            assert_eq!(a.0, b.0);
            most.max((a.1 - b.1).abs())
        })
    })
}

#[test]
fn scenes_of_trees_move_alike_in_every_view() {
    move_alike(View::OWN);
}

/// Where the joints brake in time for their tasks.
#[test]
fn weak_joints_move_alike_in_every_view() {
    move_alike(View { acceleration: 0.8, ..View::OWN });
}

fn move_alike(as_it_is: View) {
    let steps = 600;
    let own = motion(as_it_is, steps);
    let travelled = differs(&own[..1], &own[own.len() - 1..]);
    assert!(travelled > 0.3, "{travelled}");
    let mut random = Random(7);
    for _ in 0..3 {
        let view = View { world: random.pose(), ..as_it_is };
        let most = differs(&own, &motion(view, steps));
        let all = motion(view, steps);
        for k in 0..own.len() {
            println!("{k}: {:.1e}", differs(&own[k..=k], &all[k..=k]));
        }
        println!("moved {most:.1e}");
        assert!(most < 1e-6, "{view:?}: {most}");
    }
    for size in [1e-3, 40.0] {
        let view = View { size, ..as_it_is };
        let most = differs(&own, &motion(view, steps));
        println!("scaled {most:.1e}");
        assert!(most < 1e-6, "{view:?}: {most}");
    }
    for i in 0..4 {
        let mut view = as_it_is;
        view.reordered[i] = true;
        let most = differs(&own, &motion(view, steps));
        println!("reordered {i} {most:.1e}");
        assert!(most < 1e-6, "{view:?}: {most}");
    }
}

/// Closed chains on moved and turned foundations.
#[test]
fn objects_of_closed_chains_move_alike_on_any_foundation() {
    let mut random = Random(9);
    for (name, way) in [
        ("five-bar", Vec3::new(0.2, 0.1, 0.0)),
        ("stewart", Vec3::new(0.1, 0.05, 0.1)),
        ("two-arm", Vec3::new(0.05, 0.0, 0.05)),
    ] {
        let robot = catalogue::load(name).unwrap();
        let planar = robot.dimension() == cylindroid::model::Dimension::Planar;
        // With a wall, and with weak drives on their way, which brake in time.
        for (acceleration, is_weak) in [(5.0, false), (0.5, true)] {
            let drive = |robot: &Mechanism, foundation: Pose| {
                let reference = robot.reference();
                let mut q = assemble(robot, robot.home(), &[]).unwrap().q;
                let before = robot.state(&q).unwrap().pose(reference).unwrap();
                let target =
                    Pose { translation: before.translation + foundation.rotation * way, ..before };
                let objective = TaskObjective::Frame {
                    end_effector: reference.into(),
                    components: if planar { Task::PLANAR } else { Task::POSE },
                    target: target.into(),
                };
                let mut options = TaskServoOptions::new(robot);
                (options.dt, options.acceleration) = (2e-3, acceleration);
                options.half_spaces = vec![HalfSpace {
                    name: "wall".to_owned(),
                    end_effector: reference.into(),
                    point: before.translation
                        + foundation.rotation * (way * if is_weak { 2.0 } else { 0.6 }),
                    normal: foundation.rotation * -way,
                }];
                let mut servo =
                    TaskServo::new(robot, vec![MotionTask::new("object", objective)], options)
                        .unwrap();
                let result =
                    servo.simulate(&q, if is_weak { 1.2 } else { 3.0 }, |_, _, _| ()).unwrap();
                q.copy_from_slice(&result.q);
                let after = robot.state(&q).unwrap().pose(reference).unwrap().translation;
                let way = foundation.rotation.inverse() * (after - before.translation);
                (q, way)
            };
            let (q, own) = drive(&robot, Pose::IDENTITY);
            let share = own.dot(way) / way.dot(way);
            println!("{name} {acceleration}: {share:.3} of the way");
            assert!(
                if is_weak { share > 0.1 } else { (share - 0.6).abs() < 0.02 },
                "{name}: {own:?}"
            );
            for _ in 0..2 {
                let foundation = if planar {
                    Pose {
                        rotation: Rotation::exp(Vec3::Z * random.within(-3.0, 3.0)),
                        translation: Vec3::new(
                            random.within(-2.0, 2.0),
                            random.within(-2.0, 2.0),
                            0.0,
                        ),
                    }
                } else {
                    random.pose()
                };
                let mut builder = Mechanism::builder("moved");
                builder.dimension(robot.dimension());
                let how = Inclusion {
                    name: "",
                    parent: "foundation",
                    parent_from_root: foundation,
                    free: false,
                    start: robot.home(),
                };
                builder.include(&robot, how).unwrap();
                builder.reference(&robot.frame_of(robot.reference()).name);
                let moved = builder.build().unwrap();
                let (turned, way) = drive(&moved, foundation);
                let most = q.iter().zip(&turned).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
                println!("{name}: {most:.1e} {:.1e}", (way - own).norm());
                assert!(
                    most < 1e-6 && (way - own).norm() < 1e-6,
                    "{name}: {most}, {way:?} {own:?}"
                );
            }
        }
    }
}
