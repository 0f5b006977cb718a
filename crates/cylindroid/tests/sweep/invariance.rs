//! Sweeps over poses do not see where the base stands, the unit of length or the order of joints.

use std::fmt::Write;
use std::path::Path;

use cylindroid::ik::Task;
use cylindroid::spatial::Rpy;
use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions, Table, Values, VelocityMetric};
use cylindroid::{Mechanism, ParametricModel, Pose, Vec3};

use crate::{configurations, of};

/// A joint: its name, origin and axis at home, and the joint before it.
type Joint = (&'static str, [f64; 3], [f64; 3], Option<usize>);

/// A torso with two arms: one of six joints, whose wrist is a point or not, and one of two.
fn arms(wrist: f64) -> Vec<Joint> {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    vec![
        ("a1", [0.0, 0.0, 0.4], z, None),
        ("a2", [0.1, 0.1, 0.5], y, Some(0)),
        ("a3", [0.1, 0.2, 1.0], y, Some(1)),
        ("a4", [0.1, 0.2, 1.4], z, Some(2)),
        ("a5", [0.1, 0.2, 1.4 + wrist], y, Some(3)),
        ("a6", [0.1 + wrist, 0.2, 1.4 + wrist], x, Some(4)),
        ("b1", [0.0, -0.2, 0.5], y, Some(0)),
        ("b2", [0.0, -0.2, 0.8], x, Some(6)),
    ]
}

/// How a robot is written down.
#[derive(Clone, Copy)]
struct View {
    world_from_base: Pose,
    scale: f64,
    /// Names that exchange the arms.
    exchanged: bool,
}

const PLAIN: View = View { world_from_base: Pose::IDENTITY, scale: 1.0, exchanged: false };

impl View {
    fn name(self, name: &str) -> String {
        match (self.exchanged, name.split_at(1)) {
            (true, ("a", rest)) => format!("b{rest}"),
            (true, ("b", rest)) => format!("a{rest}"),
            _ => name.to_owned(),
        }
    }

    fn point(self, point: [f64; 3]) -> Vec3 {
        self.world_from_base * (Vec3::from_array(point) * self.scale)
    }

    fn pose(self, pose: Pose) -> Pose {
        let rotation = self.world_from_base.rotation * pose.rotation;
        Pose { rotation, translation: self.point(pose.translation.to_array()) }
    }

    fn robot(self, joints: &[Joint]) -> Mechanism {
        let numbers = |v: Vec3| format!("{:?}", v.to_array());
        let link = |i: usize| format!("link_{}", self.name(joints[i].0));
        let mut text = "tool = 'tip'\n".to_owned();
        for (i, (name, origin, axis, before)) in joints.iter().enumerate() {
            let parent = before.map_or("ground".to_owned(), link);
            let axis = self.world_from_base.rotation * Vec3::from_array(*axis);
            writeln!(
                text,
                "[[joint]]\nname = '{}'\ntype = 'revolute'\nbetween = ['{parent}', '{}']\n\
                 origin = {}\naxis = {}\nlimits = {{ lower = -2.5, upper = 2.0 }}",
                self.name(name),
                link(i),
                numbers(self.point(*origin)),
                numbers(axis)
            )
            .unwrap();
        }
        // Links have the axes of the world at home.
        let rotation = self.world_from_base.rotation;
        let Rpy { roll, pitch, yaw } = Rpy::of(rotation);
        let tip = rotation * (Vec3::new(0.15, 0.0, 0.05) * self.scale);
        writeln!(
            text,
            "[[frame]]\nname = 'tip'\nlink = '{}'\nxyz = {}\nrpy = [{roll:?}, {pitch:?}, {yaw:?}]",
            link(5),
            numbers(tip)
        )
        .unwrap();
        ParametricModel::of_text(&text, Path::new("arms.toml"), &[]).unwrap().nominal().clone()
    }
}

const QUANTITIES: [Quantity; 6] = [
    Quantity::Pose,
    Quantity::Yoshikawa,
    Quantity::SmallestSingularValue,
    Quantity::Condition,
    Quantity::LimitDistance,
    Quantity::GibsonHunt,
];

fn swept(robot: &Mechanism, targets: Vec<Pose>) -> Table {
    let options = SweepOptions {
        source: Source::Poses { targets, task: Task::POSE },
        quantities: QUANTITIES.to_vec(),
        metric: VelocityMetric::Length,
        ..Default::default()
    };
    let sweep = Sweep::new(robot, options).unwrap();
    sweep.table(0..sweep.rows()).unwrap()
}

/// The same answers for poses that move with the base, in any unit of length and order of joints: which
/// are reached, the configurations by the names of their joints, and every quantity, the poses moved.
#[test]
fn poses_have_the_same_answers_in_every_view() {
    let turned = Rpy { roll: 0.4, pitch: -1.1, yaw: 2.3 }.rotation();
    let moved = Pose { rotation: turned, translation: Vec3::new(-3.0, 7.0, 0.5) };
    let views = [
        View { world_from_base: moved, ..PLAIN },
        View { scale: 1000.0, ..PLAIN },
        View { scale: 1e-3, ..PLAIN },
        View { exchanged: true, ..PLAIN },
        View { world_from_base: moved, scale: 39.37, exchanged: true },
    ];
    for wrist in [0.0, 0.08] {
        let joints = arms(wrist);
        let plain = PLAIN.robot(&joints);
        let samples =
            of(&plain, Source::Samples { count: 40, seed: 11 }, &[]).table(0..40).unwrap();
        let mut targets: Vec<Pose> = configurations(&plain, &samples)
            .iter()
            .map(|q| plain.state(q).unwrap().pose(plain.tool()).unwrap())
            .collect();
        // Beyond the reach, and within it where hardly any orientation is reached.
        let beyond =
            |far: f64| move |pose: &Pose| Pose { translation: pose.translation * far, ..*pose };
        let others: Vec<Pose> = targets[..4]
            .iter()
            .map(beyond(9.0))
            .chain(targets[4..8].iter().map(beyond(0.1)))
            .collect();
        targets.extend(others);
        let expected = swept(&plain, targets.clone());
        let Some(Values::Counts(reached)) = expected.column("reached") else { panic!() };
        let count: u64 = reached.iter().sum();
        assert!(count >= 40 && reached[40..44] == [0; 4], "{reached:?}");
        for view in views {
            let robot = view.robot(&joints);
            let found = swept(&robot, targets.iter().map(|pose| view.pose(*pose)).collect());
            for column in &expected.columns {
                let name = &column.name;
                let own = view.name(name);
                let is_joint = joints.iter().any(|joint| joint.0 == name);
                let own = if is_joint { own.as_str() } else { name.as_str() };
                match (expected.column(name).unwrap(), found.column(own).unwrap()) {
                    (Values::Numbers(a), Values::Numbers(b)) => {
                        if ["x", "y", "z", "qw", "qx", "qy", "qz"].contains(&name.as_str()) {
                            continue;
                        }
                        for (row, (a, b)) in a.iter().zip(b).enumerate() {
                            let scale =
                                if name.starts_with("principal") { view.scale } else { 1.0 };
                            let near = (a * scale - b).abs() <= 1e-6 * (a * scale).abs().max(1.0);
                            assert!(near || a.is_nan() && b.is_nan(), "{name} {row}: {a} {b}");
                        }
                    }
                    (a, b) => assert_eq!(a, b, "{name}"),
                }
            }
            let poses = |table: &Table| {
                let columns = ["x", "y", "z"].map(|name| table.numbers(name).unwrap().to_vec());
                (0..table.rows())
                    .map(|i| Vec3::new(columns[0][i], columns[1][i], columns[2][i]))
                    .collect::<Vec<_>>()
            };
            for (a, b) in poses(&expected).into_iter().zip(poses(&found)) {
                let expected = view.point(a.to_array());
                assert!((expected - b).norm() <= 1e-6 * view.scale || a.x.is_nan());
            }
        }
    }
}
