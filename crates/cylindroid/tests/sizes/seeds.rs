//! Values that no function returns, or whose sizes must meet: mechanisms of no and one joint, and
//! the options of calls.

use std::path::Path;

use cylindroid::closure::{
    ConstraintBlocks, ContactProperties, ContinuationOptions, FingerContact, Friction, GraspMetric,
    ModeOptions, RowSelection, StaticLoad, Unit, Units, WrenchSpace,
};
use cylindroid::collision::{CollisionModel, CollisionOptions, MeshShape};
use cylindroid::control::*;
use cylindroid::ik::{Budget, IkOptions};
use cylindroid::inverse::*;
use cylindroid::kinematics::{OrientationRates, ReferenceFrame};
use cylindroid::linalg::{Interval, Threshold};
use cylindroid::manipulability::{
    BatchOptions, EllipsoidView, Index, Manipulability, Measure, Metrics, Stiffness,
};
use cylindroid::model::formats::dh::{Arm, Convention, Row};
use cylindroid::model::formats::{srdf, urdf};
use cylindroid::model::*;
use cylindroid::screws::{Complement, ScrewOptions};
use cylindroid::spatial::{Mat3, Quaternion, Rotation, Rpy, Xyz, Zyz};
use cylindroid::sweep::*;
use cylindroid::*;

use crate::world::World;

const JOINT: &str = "<link name='b'/><joint name='j' type='TYPE'><parent link='a'/>\
    <child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='1'/></joint>";
const FREE: &str = "reference = 'a'\n[[joint]]\nname = 'f'\ntype = 'free'\n\
    between = ['ground', 'a']\norigin = [0, 0, 0]\nactuated = false\n";
const TOUCH: &str = "[[contact]]\nname = 'c'\ntype = 'hard_finger'\nbetween = ['ground', 'a']\n\
    point = [1, 0, 0]\nnormal = [-1, 0, 0]\n";
const PASSIVE: &str = "reference = 'a'\n[[joint]]\nname = 'j'\ntype = 'revolute'\n\
    between = ['ground', 'a']\norigin = [0, 0, 0]\naxis = [0, 0, 1]\n";
const DESIGN: &str = "reference = 'a'\nparameters = { size = 1.0 }\n[[joint]]\nname = 'j'\n\
    type = 'revolute'\nbetween = ['ground', 'a']\norigin = ['size', 0, 0]\naxis = [0, 0, 1]\n\
    limits = { lower = -1, upper = 1 }\n";
const SRDF: &str = "<robot name='r'><group name='a'><joint name='j'/></group>\
    <group_state name='x' group='a'><joint name='j' value='0.5'/></group_state></robot>";

/// Three pins: rigid.
fn triangle(actuated: bool) -> String {
    let sides = [("ground", "a", 0, 0), ("a", "b", 1, 0), ("b", "ground", 0, 1)];
    let joints = sides.iter().enumerate().map(|(i, (from, to, x, y))| {
        format!(
            "[[joint]]\nname = 'p{i}'\ntype = 'revolute'\nbetween = ['{from}', '{to}']\n\
             origin = [{x}, {y}, 0]\naxis = [0, 0, 1]\nactuated = {actuated}\n"
        )
    });
    format!("reference = 'a'\n{}", joints.collect::<String>())
}

fn mechanisms() -> Vec<Mechanism> {
    let urdf = |inside: &str| {
        let text = format!("<robot name='r'><link name='a'/>{inside}</robot>");
        urdf::parse(&text, Path::new("r.urdf")).unwrap()
    };
    let toml = |text: &str| cylindroid::load_text(text, Path::new("m.toml")).unwrap();
    let five_bar = cylindroid::load("five-bar").unwrap();
    vec![
        urdf(""),
        urdf(&JOINT.replace("TYPE", "fixed")),
        urdf(&JOINT.replace("TYPE", "revolute")),
        urdf(&JOINT.replace("TYPE", "prismatic")),
        toml(PASSIVE),
        toml(FREE),
        toml(&format!("{FREE}{TOUCH}")),
        toml(&triangle(false)),
        toml(&triangle(true)),
        five_bar.with_actuated::<&str>(&[]).unwrap(),
        five_bar.with_actuated(&["q1"]).unwrap(),
    ]
}

/// Adds them all; files are written into `folder`.
pub(crate) fn fill(world: &mut World, folder: &Path) {
    let mechanisms = mechanisms();
    for m in &mechanisms {
        world.keep(m.clone());
        world.keep(m.state(m.home()).unwrap());
        world.keep(EndEffector::from(m.tool()));
        world.keep(m.tool());
        for task in ["position", "pose"] {
            world.keep(Task::named(task, m).unwrap());
        }
        world.keep(ServoOptions::new(m));
        world.keep(TaskServoOptions::new(m));
    }
    for m in &mechanisms {
        let goal = ik::Goal::pose(m.tool(), Pose::IDENTITY);
        let solver = ik::Solver::new(m, &[goal], &IkOptions::default());
        solver.into_iter().for_each(|solver| world.keep(solver));
        world.keep(goal);
        let stiff = Stiffness::of(&m.state(m.home()).unwrap(), None, None, &springs(m));
        stiff.into_iter().for_each(|stiffness| world.keep(stiffness));
    }
    whole_robots(world);
    verdicts(world);
    matrices(world);
    model(world);
    spatial(world);
    closed_chains(world);
    control(world);
    inverses(world);
    sweeps(world);
    let design = folder.join("design.toml");
    std::fs::write(&design, DESIGN).unwrap();
    let path = Path::new("design.toml");
    world.keep(ParametricModel::of_text(DESIGN, path, &[]).unwrap());
    world.keep(srdf::parse(SRDF, Path::new("r.srdf")).unwrap());
    for path in [folder.to_owned(), design, folder.join("new"), folder.join("none/none")] {
        world.keep(path);
    }
}

fn springs(m: &Mechanism) -> Elasticity {
    let mut elasticity = Elasticity::default();
    for joint in m.actuated().map(|i| &m.coordinates()[i].name) {
        elasticity.stiffness(joint, 1.0);
    }
    elasticity
}

/// What the smallest mechanisms do not have: a closed form, bodies that come near, three screws.
fn whole_robots(world: &mut World) {
    let arm = cylindroid::load("ur5e").unwrap();
    let state = arm.state(arm.home()).unwrap();
    let pose = state.pose(arm.tool()).unwrap();
    let mut analytic = ik::Analytic::of(&arm, arm.tool()).unwrap();
    let solutions = analytic.solve(pose, arm.home()).unwrap();
    world.keep(solutions[0]);
    world.keep(solutions);
    world.keep(analytic);
    let five_bar = cylindroid::load("five-bar").unwrap();
    let state = five_bar.state(five_bar.home()).unwrap();
    let chain = closure::ClosedChain::of(&state, None, None).unwrap();
    let motions = closure::MotionSpace::of(&chain.constraint);
    let metrics = Metrics::characteristic_length(&chain.units, chain.constraint.length()).unwrap();
    let efficiencies = Manipulability::of(&motions.relation(), &metrics).unwrap().kinematic;
    efficiencies.finite.iter().for_each(|direction| world.keep(direction.pair));
    let forces = vec![0.0; chain.constraint.rows()];
    let transmitted = closure::transmitted_wrenches(&state, &chain, &forces);
    transmitted.into_iter().flatten().for_each(|wrench| world.keep(wrench));
    let options = ScrewOptions::default();
    let columns = Matrix::from_fn(6, 3, |i, j| ((i + 2 * j) % 5) as f64 - 1.5);
    let system = ScrewSystem::of_columns(&columns, &options).unwrap();
    system.pitch_conics().into_iter().for_each(|conics| world.keep(conics));
    let svd = hyperbolic_svd(&columns, 0.1, &options, None);
    svd.into_iter().for_each(|svd| world.keep(svd));
    let stiffness = Matrix::identity(6);
    screws::eigenscrews(&stiffness, 0.5).into_iter().for_each(|all| world.keep(all));
    let map = MapOptions {
        axes: vec![Axis { name: "x".to_owned(), from: 0.0, to: 0.1, count: 2 }],
        starts: 1,
        loci: false,
        ..MapOptions::default()
    };
    Map::of(&five_bar, map).into_iter().for_each(|map| world.keep(map));
    world.keep(Surface {
        kind: LocusKind::TypeTwo,
        mode: 0,
        closed: false,
        vertices: vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.1]],
        triangles: vec![[0, 1, 2]],
        q: vec![Vec::new(); 3],
    });
    let poses = [Pose::IDENTITY, Pose::from_translation(Vec3::X), Pose::IDENTITY];
    let bounds = KinematicBounds { velocity: 1.0, acceleration: 1.0, jerk: f64::INFINITY };
    let bounds = CartesianBounds { linear: bounds, angular: bounds };
    WaypointMove::new(&poses, bounds).into_iter().for_each(|way| world.keep(way));
    let mut builder = Mechanism::builder("ball");
    builder.joint(JointSpec::new("j", JointKind::Prismatic, "a", "b"));
    for link in ["a", "b"] {
        builder.collision(
            link,
            Visual { geometry: Geometry::Sphere { radius: 0.1 }, ..Visual::default() },
        );
    }
    let balls = builder.build().unwrap();
    let mut model = CollisionModel::new(&balls, &CollisionOptions::default()).unwrap();
    model
        .add_obstacle("x", &Geometry::Sphere { radius: 0.1 }, Pose::from_translation(Vec3::X))
        .unwrap();
    let state = balls.state(&[0.5]).unwrap();
    let mut near = Vec::new();
    model.near(&state, 10.0, &mut near).unwrap();
    for _ in 0..6 {
        all(world, &near[..1]);
        world.keep(model.clone());
        world.keep(state.clone());
    }
    world.keep(balls);
}

/// Words of reports, all of which have a name.
fn verdicts(world: &mut World) {
    use cylindroid::closure::*;
    use cylindroid::screws::{ConicKind, EigenscrewKind};
    all(world, &[Immobilisation::Mobile, Immobilisation::NotProved]);
    all(world, &[LocalStructure::Rigid, LocalStructure::Shaky]);
    all(world, &[SecondOrderRigidity::Rigid, SecondOrderRigidity::Flexible]);
    all(world, &[SingularityKind::TypeI, SingularityKind::Passive]);
    all(world, &[ZlatanovType::RedundantInput]);
    all(world, &[ConicKind::Empty, ConicKind::Plane]);
    all(world, &[EigenscrewKind::Definite]);
}

fn all<T: Clone + 'static>(world: &mut World, values: &[T]) {
    for value in values {
        world.keep(value.clone());
    }
}

fn matrices(world: &mut World) {
    let sizes = [(0, 0), (0, 1), (1, 0), (1, 1), (3, 1), (6, 0), (6, 1), (0, 6), (1, 6), (6, 6)];
    for (rows, cols) in sizes {
        world.keep(Matrix::zeros(rows, cols));
        world.keep(Matrix::from_fn(rows, cols, |i, j| if i == j { 1.0 } else { 0.0 }));
    }
    for n in [0, 1, 1, 2, 3, 6] {
        world.keep(linalg::Metric::new("m", &Matrix::identity(n)).unwrap());
    }
    all(world, &[Threshold::Relative(1e-9), Threshold::Absolute(0.0)]);
    all(world, &[Interval::symmetric(1.0), Interval { lower: 0.0, upper: 0.0 }]);
}

fn model(world: &mut World) {
    all(world, &[Dimension::Planar, Dimension::Spatial]);
    all(world, &[CoordinateKind::Angle, CoordinateKind::Position]);
    all(world, &[ContactKind::HardFinger, ContactKind::Complete]);
    use JointKind::*;
    let kinds = [Fixed, Revolute, Prismatic, Helical { pitch: 0.0 }, Universal { second: Vec3::X }];
    all(world, &kinds);
    all(world, &[Spherical, Planar, Free, Cylindrical]);
    let flat = Geometry::Mesh { uri: String::new(), path: None, scale: Vec3::X };
    let hull = |points: &[Vec3]| Geometry::ConvexHull { points: points.to_vec() };
    let round = Geometry::Sphere { radius: 0.0 };
    let capsule = Geometry::Capsule { radius: 0.0, length: 0.0 };
    all(world, &[flat, hull(&[]), hull(&[Vec3::X]), round, capsule, Geometry::HalfSpace]);
    all(world, &[Geometry::Box { size: Vec3::ZERO }, Geometry::Box { size: Vec3::X }]);
    world.keep(Visual::default());
    let empty = Inclusion {
        name: "",
        parent: "a",
        parent_from_root: Pose::IDENTITY,
        free: false,
        start: &[],
    };
    all(world, &[Inclusion { name: "r", free: true, start: &[0.0], ..empty }, empty]);
    all(
        world,
        &[JointLimits::default(), JointLimits { upper: Some(0.0), ..JointLimits::default() }],
    );
    world.keep(Elasticity::default());
    world.keep(SurfaceCurvature::uniform(0.0));
    world.keep(ContactCurvature::default());
    world.keep(LoadReport::default());
    let row = Row {
        name: String::new(),
        a: 0.0,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        prismatic: false,
        flip: false,
        limits: Limits::NONE,
    };
    for rows in [vec![], vec![row.clone()], vec![Row { prismatic: true, ..row }]] {
        for convention in [Convention::Standard, Convention::Modified] {
            let arm = Arm {
                convention,
                rows: rows.clone(),
                ground_from_base: None,
                last_from_flange: Pose::IDENTITY,
            };
            world.keep(arm);
        }
    }
}

fn spatial(world: &mut World) {
    all(world, &[Vec3::ZERO, Vec3::X, Vec3::Z]);
    all(world, &[Twist::default(), Twist::from_array([1.0; 6])]);
    all(world, &[Wrench::default(), Wrench::from_array([1.0; 6])]);
    all(world, &[Pose::IDENTITY, Pose::from_translation(Vec3::X)]);
    all(world, &[Rotation::IDENTITY, Rotation::about_z(1.0)]);
    all(world, &[Mat3::skew(Vec3::X), Rotation::IDENTITY.matrix()]);
    all(world, &[Rpy::default()]);
    all(world, &[Zyz::default()]);
    all(world, &[Xyz::default()]);
    let zero = Quaternion { w: 0.0, x: 0.0, y: 0.0, z: 0.0 };
    all(world, &[zero, Quaternion { w: 1.0, ..zero }]);
    all(world, &[ScrewOptions::default()]);
    let none = Complement::Twists(&[]);
    all(world, &[none, Complement::Reciprocal { h: 0.0 }, Complement::Reciprocal { h: 1.0 }]);
}

fn closed_chains(world: &mut World) {
    for (rows, actuated, passive, object) in [
        (0, 0, 0, 0),
        (0, 1, 0, 0),
        (0, 0, 1, 0),
        (0, 0, 0, 1),
        (1, 0, 0, 0),
        (1, 1, 1, 1),
        (6, 1, 0, 6),
    ] {
        world.keep(ConstraintBlocks {
            actuated: Matrix::from_fn(rows, actuated, |_, _| 1.0),
            passive: Matrix::from_fn(rows, passive, |_, _| 1.0),
            grasp: Matrix::from_fn(object, rows, |i, j| if i == j { 1.0 } else { 0.0 }),
        });
        let units = |n| vec![Unit::Angle; n];
        let (rows, actuated, passive) = (units(rows), units(actuated), units(passive));
        world.keep(Units { rows, actuated, passive, object: units(object) });
    }
    all(world, &[ModeOptions::default(), ModeOptions { starts: 0, ..ModeOptions::default() }]);
    all(world, &[ModeOptions { starts: 1, ..ModeOptions::default() }]);
    world.keep(ContinuationOptions::default());
    let load = |torques, wrench| StaticLoad { torques, wrench };
    all(world, &[load(&[], &[]), load(&[0.0], &[]), load(&[], &[0.0; 6]), load(&[1.0], &[1.0; 3])]);
    let finger = FingerContact {
        point: Vec3::X,
        normal: -Vec3::X,
        friction: Friction::None,
        strength: 1.0,
        curvature: ContactCurvature::default(),
    };
    let hard = Friction::Hard { mu: 0.5 };
    let soft = Friction::Soft { mu: 0.5, torsion: 0.0 };
    all(world, &[hard, soft, Friction::None]);
    all(world, &[finger, FingerContact { friction: hard, ..finger }]);
    all(world, &[FingerContact { friction: soft, ..finger }]);
    all(world, &[GraspMetric::L1, GraspMetric::LInf]);
    let space = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: false };
    all(world, &[space, WrenchSpace { planar: true, ..space }]);
    all(world, &[ContactProperties { mu: Some(0.5), torsion: Some(0.1), strength: 1.0 }]);
    all(world, &[ContactProperties { mu: None, torsion: None, strength: 1.0 }]);
    all(world, &[RowSelection::default(), RowSelection { actuated: true, ..Default::default() }]);
    world.keep(CollisionOptions::default());
    world.keep(MeshShape::Capsule);
    all(world, &[Metrics::default()]);
    all(world, &[Measure::Volume, Measure::Smallest, Measure::Largest, Measure::Anisotropy]);
    all(world, &[Index::Kinematic, Index::Force]);
    all(world, &[EllipsoidView::Projection, EllipsoidView::Section]);
    all(world, &[BatchOptions::default()]);
    all(world, &[manipulability::Goal::default()]);
}

fn control(world: &mut World) {
    let bounds = KinematicBounds { velocity: 1.0, acceleration: 1.0, jerk: 1.0 };
    let none = KinematicBounds { velocity: 0.0, acceleration: 0.0, jerk: 0.0 };
    all(world, &[bounds, none]);
    all(world, &[CartesianBounds { linear: bounds, angular: bounds }]);
    let none = SpeedLimit { linear: 0.0, angular: 0.0 };
    all(world, &[none, SpeedLimit { linear: 0.1, angular: f64::INFINITY }]);
    all(world, &[JointDefaults { angle: bounds, length: bounds }]);
    all(
        world,
        &[AdmittanceGain { force: 0.0, moment: 0.0 }, AdmittanceGain { force: 1.0, moment: 1.0 }],
    );
    all(world, &[HybridInput::default()]);
    all(world, &[SharedInput::default()]);
    all(world, &[AuthorityTimes { dt: 0.01, fall: 1.0, rise: 1.0 }]);
    all(world, &[AxisRotation { centre: Vec3::ZERO, axis: Vec3::Z, angle: 0.0 }]);
    all(world, &[JointState { position: 0.0, velocity: 0.0, acceleration: 0.0 }]);
    all(world, &[Target::from(Pose::IDENTITY)]);
    all(world, &[Saturation { scale: 0.0, direction_lost: true }]);
    all(world, &[Stall::Slow, Stall::Limits { coordinates: vec![] }]);
    all(world, &[Status::Moving, Status::Reached]);
    all(world, &[TwistStatus::AtRest, TwistStatus::Stalled]);
    all(world, &[LimitKind::Position, LimitKind::Jerk]);
    all(world, &[Plant { delay: 0.0, time_constant: 0.0, noise: 0.0 }]);
    all(world, &[TaskProjection::Orthogonal, TaskProjection::Hyperbolic { h: 0.0 }]);
    let complement = vec![];
    all(world, &[TaskProjection::Oblique { complement, reference: ReferenceFrame::World }]);
    all(
        world,
        &[InverseSelection::default(), InverseSelection { name: "damped", ..Default::default() }],
    );
    all(world, &SecondaryTask::all(&[]));
    all(world, &SecondaryTask::all(&[0.0]));
    all(world, &[TaskObjective::Posture { q: vec![] }, TaskObjective::Posture { q: vec![0.0] }]);
    all(world, &[TaskObjective::JointVelocities { velocities: vec![0.0] }]);
    all(world, &[TaskObjective::LimitAvoidance { margin: 0.0 }]);
    all(world, &[IkOptions::default()]);
    let budget = Budget { iterations: 0, time: None };
    all(world, &[IkOptions { budget, ..IkOptions::default() }]);
    let one = Budget { iterations: 1, time: None };
    all(world, &[IkOptions { budget: one, ..IkOptions::default() }]);
    let away = ik::Criterion::LimitAvoidance { margin: 0.5 };
    all(world, &[IkOptions { criterion: Some(away), ..IkOptions::default() }]);
    all(world, &[away]);
    all(world, &[ik::MissReason::NotProven, ik::MissReason::Limits { joints: vec![] }]);
    all(world, &[ik::FoundBy::Numerical]);
}

fn inverses(world: &mut World) {
    for (_, frame) in ReferenceFrame::NAMES {
        world.keep(frame);
    }
    use OrientationRates as Rates;
    all(world, &[Rates::Rpy, Rates::Zyz, Rates::Xyz, Rates::RotationVector]);
    all(world, &[HyperbolicOptions::default()]);
    all(world, &[Weights::default()]);
    all(world, &[PolarKind::Positive, PolarKind::Signed]);
    all(world, &[Domain::Positive, Domain::Fraction, Domain::Finite, Domain::Extended]);
    for inverse in NamedInverse::all() {
        all(world, inverse.parameters);
        if let Ok(method) = Method::named(inverse.name) {
            world.keep(method);
        }
    }
    world.keep(InverseChoice {
        method: Method::named("truncated").unwrap(),
        projection: TaskProjection::Orthogonal,
        length: 1.0,
    });
}

fn sweeps(world: &mut World) {
    let axis = Axis { name: "j".to_owned(), from: -1.0, to: 1.0, count: 1 };
    let none = Axis { count: 0, ..axis.clone() };
    let design = Axis { name: "size".to_owned(), ..axis.clone() };
    all(world, &[axis.clone(), none, design.clone()]);
    let range = ParameterRange { name: "size".to_owned(), from: 0.5, to: 1.0 };
    for count in [0, 1] {
        let samples = DesignSpace::Samples { ranges: vec![range.clone()], count, seed: 0 };
        all(world, &[samples, DesignSpace::Samples { ranges: vec![], count, seed: 0 }]);
    }
    all(world, &[DesignSpace::Grid(vec![]), DesignSpace::Grid(vec![design])]);
    world.keep(range.clone());
    let sources = [
        Source::Samples { count: 0, seed: 0 },
        Source::Samples { count: 1, seed: 0 },
        Source::Grid { axes: vec![], rest: vec![] },
        Source::Grid { axes: vec![axis.clone()], rest: vec![0.0] },
        Source::Home,
        Source::Configurations(vec![]),
        Source::Configurations(vec![0.0]),
        Source::Poses { targets: vec![], task: Task::POSE },
        Source::Poses { targets: vec![Pose::IDENTITY], task: Task::POSITION },
        Source::Voxels(VoxelGrid::default()),
        Source::Voxels(VoxelGrid {
            axes: vec![Axis { name: "x".to_owned(), ..axis.clone() }],
            directions: 1,
            rolls: 0,
            ..VoxelGrid::default()
        }),
        Source::Voxels(VoxelGrid {
            axes: vec![Axis { name: "x".to_owned(), ..axis.clone() }],
            directions: 0,
            ..VoxelGrid::default()
        }),
    ];
    all(world, &sources);
    all(world, &[Values::Numbers(vec![]), Values::Counts(vec![1]), Values::Texts(vec!["a"])]);
    for source in sources {
        for quantities in [vec![], vec![Quantity::Pose], vec![Quantity::Measures]] {
            world.keep(SweepOptions { source: source.clone(), quantities, ..Default::default() });
        }
    }
    all(world, &[Quantity::Pose, Quantity::Measures]);
    all(world, &[VelocityMetric::Unit, VelocityMetric::Limits]);
    all(world, &[WriteOptions::default(), WriteOptions { resume: true, ..Default::default() }]);
    all(world, &[Part { bytes: 0, checksum: String::new() }]);
    all(world, &[LocusKind::TypeOne, LocusKind::Limit]);
    all(world, &[Statistic::Mean]);
    all(world, &[Sense::Minimise]);
    let axes = vec![Axis { name: "x".to_owned(), count: 2, ..axis }];
    all(world, &[MapOptions::default(), MapOptions { axes, starts: 1, ..Default::default() }]);
    let components = vec!["x".to_owned()];
    all(
        world,
        &[ZoneOptions::default(), ZoneOptions { components, rays: 1, ..Default::default() }],
    );
    all(world, &ZoneShape::ALL);
    let objective = DesignObjective::named("condition", Sense::Minimise).ok();
    let (designs, starts, evaluations) = (1, 0, 1);
    let sweep =
        SweepOptions { source: Source::Samples { count: 1, seed: 0 }, ..Default::default() };
    for objectives in [vec![], objective.into_iter().collect()] {
        let ranges = vec![range.clone()];
        world.keep(OptimisationOptions {
            ranges,
            objectives,
            designs,
            starts,
            evaluations,
            sweep: sweep.clone(),
            ..Default::default()
        });
    }
}
