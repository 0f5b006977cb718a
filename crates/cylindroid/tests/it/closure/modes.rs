//! Assembly modes against closed forms, a scan and symmetry.

use std::f64::consts::{PI, TAU};

use cylindroid::closure::{AssemblyModes, ModeOptions, assembly_modes};
use cylindroid::model::{JointKind, JointSpec, LoopJointSpec};
use cylindroid::spatial::{Mat3, Pose, Vec3};
use cylindroid::{Mechanism, catalogue};

use super::linkage::{circles, dead_four_bar, five_bar, place};
use crate::support::Random;

fn search(
    mechanism: &Mechanism,
    guess: &[f64],
    prescribed: &[usize],
    starts: usize,
) -> AssemblyModes {
    let found =
        assembly_modes(mechanism, guess, prescribed, ModeOptions { starts, seed: 3 }).unwrap();
    assert_eq!(found.starts, starts);
    assert_eq!(found.modes.iter().map(|m| m.found).sum::<usize>(), found.closed);
    for mode in &found.modes {
        assert!(mode.assembly.closed && mode.found > 0);
        assert!(mechanism.outside_limits(&mode.assembly.q).next().is_none());
        for &i in prescribed {
            assert_eq!(mode.assembly.q[i], guess[i]);
        }
    }
    assert!(found.modes.is_sorted_by(|a, b| a.distance <= b.distance));
    found
}

/// The pose of the reference frame at each mode.
fn references(mechanism: &Mechanism, found: &AssemblyModes) -> Vec<Pose> {
    let pose = |q: &[f64]| mechanism.state(q).unwrap().pose(mechanism.reference()).unwrap();
    found.modes.iter().map(|m| pose(&m.assembly.q)).collect()
}

fn turned(p: [f64; 2], about: [f64; 2], angle: f64) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    let (x, y) = (p[0] - about[0], p[1] - about[1]);
    [about[0] + c * x - s * y, about[1] + s * x + c * y]
}

/// Every point of `expected` is one of `got`, and the other way round.
#[track_caller]
fn assert_same_points(got: &[Vec3], expected: &[Vec3], tolerance: f64) {
    assert_eq!(got.len(), expected.len(), "{got:?} instead of {expected:?}");
    for e in expected {
        assert!(got.iter().any(|g| (*g - *e).norm() < tolerance), "{e:?} is not in {got:?}");
    }
}

/// Crank 1, coupler 1.8, rocker 1.3, base 2: the law of cosines.
#[test]
fn four_bar_has_two() {
    let four_bar = catalogue::load("four-bar").unwrap();
    let rocker = four_bar.frame("rocker").unwrap();
    for turn in [0.0, 0.4, -1.5, 3.0] {
        let found = search(&four_bar, &[turn, 0.0, 0.0], &[0], 20);
        let angle = 70_f64.to_radians() + turn;
        let expected = circles([angle.cos(), angle.sin()], 1.8, [2.0, 0.0], 1.3).unwrap();
        let got: Vec<Vec3> = found
            .modes
            .iter()
            .map(|m| four_bar.state(&m.assembly.q).unwrap().pose(rocker).unwrap().translation)
            .collect();
        assert_same_points(&got, &expected.map(|[x, y]| Vec3::new(x, y, 0.0)), 1e-9);
        assert_eq!((found.self_motion_dof(), found.unseen_probability()), (0, 0.0));
        for mode in &found.modes {
            assert!(mode.assembly.q.iter().all(|x| x.abs() <= PI), "{mode:?}");
        }
    }
}

#[test]
fn five_bar_has_two() {
    let five_bar = five_bar("reference = \"coupler\"\nreference_point = [1.0, 2.0]");
    let prescribed = [place(&five_bar, "q1"), place(&five_bar, "q5")];
    for (t1, t5) in [(0.0, 0.0), (-0.3, -0.2), (0.1, 1.0)] {
        let mut guess = [0.0; 4];
        (guess[prescribed[0]], guess[prescribed[1]]) = (t1, t5);
        let found = search(&five_bar, &guess, &prescribed, 20);
        let rocker =
            |q: &[f64]| five_bar.state(q).unwrap().pose(five_bar.frame("rocker").unwrap()).unwrap();
        let q4 = rocker(&guess) * (rocker(&[0.0; 4]).inverse() * Vec3::new(2.0, 1.0, 0.0));
        let (a, b) = (turned([0.0, 2.0], [0.0; 2], t1), [q4.x, q4.y]);
        let expected = circles(a, 1.0, b, 2_f64.sqrt()).unwrap();
        let got: Vec<Vec3> = references(&five_bar, &found).iter().map(|p| p.translation).collect();
        assert_same_points(&got, &expected.map(|[x, y]| Vec3::new(x, y, 0.0)), 1e-9);
    }
}

/// 3-RRR with prescribed actuators: up to six. A scan of one leg's rotation, with the circle of the
/// next, finds them all by changes of sign.
#[test]
fn three_legged_platform_as_a_scan_finds_them() {
    let platform = catalogue::load("3rrr").unwrap();
    let actuators: Vec<usize> = platform.actuated().collect();
    let at_home = platform.state(platform.home()).unwrap();
    let origin = |name: &str| at_home.pose(platform.frame(name).unwrap()).unwrap().translation;
    let base = [[0.0, 1.0], [-0.866_025_403_784_438_6, -0.5], [0.866_025_403_784_438_6, -0.5]];
    let elbow = [
        [0.499_883_076_380_133_8, 0.668_161_319_390_379_9],
        [-0.736_111_978_049_779_6, 0.085_766_593_289_413_44],
        [0.293_983_125_253_853_9, -0.681_018_318_336_949_6],
    ];
    let corner = [
        [0.010_066_633_341_268_769, 0.418_001_666_111_210_37],
        [-0.274_712_870_271_474_6, -0.213_584_143_040_705_03],
        [0.414_646_236_930_205_8, -0.144_417_523_070_505_6],
    ];
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    assert!((origin("lower1") - Vec3::new(elbow[0][0], elbow[0][1], 0.0)).norm() < 1e-12);
    let leg = [0, 1, 2].map(|i| distance(elbow[i], corner[i]));
    let mut random = Random(5);
    let mut counts = [0; 7];
    for _ in 0..12 {
        let turns = [0, 1, 2].map(|_| random.within(-1.5, 1.5));
        let mut guess = platform.home().to_vec();
        for (&i, t) in actuators.iter().zip(turns) {
            guess[i] = t;
        }
        let b = [0, 1, 2].map(|i| turned(elbow[i], base[i], turns[i]));
        // The third corner by its place beside the other two.
        let beside = {
            let (x, y) = (corner[1][0] - corner[0][0], corner[1][1] - corner[0][1]);
            let (u, v) = (corner[2][0] - corner[0][0], corner[2][1] - corner[0][1]);
            let d2 = x * x + y * y;
            [(u * x + v * y) / d2, (v * x - u * y) / d2]
        };
        let miss = |angle: f64, side: usize| {
            let p = [b[0][0] + leg[0] * angle.cos(), b[0][1] + leg[0] * angle.sin()];
            let q = circles(p, distance(corner[0], corner[1]), b[1], leg[1])?[side];
            let (x, y) = (q[0] - p[0], q[1] - p[1]);
            let r = [p[0] + beside[0] * x - beside[1] * y, p[1] + beside[0] * y + beside[1] * x];
            Some(distance(r, b[2]) - leg[2])
        };
        let mut expected = 0;
        let mut last = [miss(0.0, 0), miss(0.0, 1)];
        let steps = 40_000;
        for k in 1..=steps {
            let angle = TAU * f64::from(k) / f64::from(steps);
            for side in [0, 1] {
                let now = miss(angle, side);
                if let (Some(a), Some(b)) = (last[side], now) {
                    expected += usize::from((a > 0.0) != (b > 0.0));
                }
                last[side] = now;
            }
        }
        let found = search(&platform, &guess, &actuators, 400);
        assert_eq!(found.modes.len(), expected, "{turns:?} {found:?}");
        counts[expected] += 1;
    }
    assert!(counts[0] + counts[2] + counts[4] + counts[6] == 12 && counts[2] > 0, "{counts:?}");
    assert!(counts[0] > 0 && counts[4] + counts[6] > 0, "{counts:?}");
}

/// A Stewart platform with prescribed legs: base joints in a plane and platform joints in another,
/// so that the mirror image of an assembly below the base is an assembly.
#[test]
fn stewart_platform_comes_in_mirror_pairs() {
    let stewart = catalogue::load("stewart").unwrap();
    let legs: Vec<usize> = stewart.actuated().collect();
    let found = search(&stewart, stewart.home(), &legs, 120);
    let poses = references(&stewart, &found);
    assert!(found.modes[0].distance < 1e-12);
    assert!(found.self_motion_dof() == 0 && found.closed > 100);
    let mirror = Mat3::from_rows([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
    assert!(poses.len() >= 2 && poses.len().is_multiple_of(2) && poses.len() <= 40);
    for (i, a) in poses.iter().enumerate() {
        let image = (mirror * a.translation, mirror * a.rotation.matrix() * mirror);
        let stands = |b: &&Pose| {
            (b.translation - image.0).norm() < 1e-7
                && (0..3).all(|i| {
                    let (r, m) = (b.rotation.matrix().to_rows(), image.1.to_rows());
                    (0..3).all(|j| (r[i][j] - m[i][j]).abs() < 1e-7)
                })
        };
        assert_eq!(poses.iter().filter(stands).count(), 1, "{a:?}");
        for b in &poses[..i] {
            let apart = (a.translation - b.translation).norm().max(a.rotation.angle_to(b.rotation));
            assert!(apart > 1e-3, "{a:?} {b:?}");
        }
    }
}

/// A Delta robot with prescribed arms: among its modes are the two points where the spheres of the
/// three pairs of rods meet, its platform not turned.
#[test]
fn delta_where_three_spheres_meet() {
    let delta = catalogue::load("delta").unwrap();
    let arms: Vec<usize> = delta.actuated().collect();
    let found = search(&delta, delta.home(), &arms, 80);
    // Elbows less the platform's joints seen from its reference point: rods 1a, 2a, 3a.
    let reference = Vec3::new(0.05, -0.03, -0.45);
    let spheres = [
        ([0.474_781_429_024_095_3, 0.04, -0.120_395_873_116_465_55], [0.1, 0.01, -0.45]),
        (
            [-0.248_688_363_837_005_04, 0.350_740_881_416_867_54, -0.194_866_133_392_886_66],
            [-0.009_641_016_151_377_534, -0.006_698_729_810_778_049, -0.45],
        ),
        (
            [-0.192_320_191_456_596_4, -0.413_108_342_924_198_4, -0.159_760_467_734_981_18],
            [0.059_641_016_151_377_52, -0.093_301_270_189_221_94, -0.45],
        ),
    ]
    .map(|(u, s)| Vec3::from_array(u) - (Vec3::from_array(s) - reference));
    let (a, b, c) = (spheres[0], spheres[1], spheres[2]);
    // All radii are 0.5: the axis goes through the centre of the circle through the three centres.
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let centre = a
        + (normal.cross(ab) * ac.dot(ac) + ac.cross(normal) * ab.dot(ab))
            * (0.5 / normal.dot(normal));
    let height = (0.25 - (centre - a).dot(centre - a)).sqrt() / normal.norm();
    let straight: Vec<Vec3> = references(&delta, &found)
        .iter()
        .filter(|p| p.rotation.log().norm() < 1e-7)
        .map(|p| p.translation)
        .collect();
    assert_same_points(&straight, &[centre + normal * height, centre - normal * height], 1e-8);
    assert!((found.modes[0].distance < 1e-12) && found.modes.len().is_multiple_of(2));
}

/// At its dead point a four-bar's two modes are one: a double root, not a motion.
#[test]
fn a_double_root_is_one_isolated_mode() {
    let four_bar = dead_four_bar("");
    let prescribed = [place(&four_bar, "crank")];
    let found = search(&four_bar, &[0.0; 3], &prescribed, 40);
    assert_eq!((found.modes.len(), found.self_motion_dof()), (1, 0), "{found:?}");
    // A little before, two; a little beyond, none.
    assert_eq!(search(&four_bar, &[-1e-3, 0.0, 0.0], &prescribed, 40).modes.len(), 2);
    let beyond = search(&four_bar, &[1e-3, 0.0, 0.0], &prescribed, 40);
    assert!(beyond.modes.is_empty() && beyond.closed == 0 && beyond.unseen_probability() == 1.0);
    assert!(!beyond.first.closed && beyond.first.closure_error.distance > 0.0);
}

/// Where motions are left they are counted, not sampled.
#[test]
fn a_continuum_is_said() {
    for (name, free) in [("four-bar", 1), ("five-bar", 2), ("3rrr", 3), ("watt", 1)] {
        let mechanism = catalogue::load(name).unwrap();
        let found = search(&mechanism, mechanism.home(), &[], 10);
        let modes: Vec<(usize, usize)> =
            found.modes.iter().map(|m| (m.self_motion_dof, m.found)).collect();
        assert_eq!(modes, [(free, found.closed)], "{name}");
        assert!(found.modes[0].distance < 1e-12);
    }
    // A tree is closed wherever it stands; prescribed as a whole it is where it was put.
    let panda = catalogue::load("panda").unwrap();
    let all: Vec<usize> = (0..7).collect();
    assert_eq!(search(&panda, panda.home(), &[], 5).self_motion_dof(), 7);
    let prescribed = search(&panda, panda.home(), &all, 5);
    assert_eq!((prescribed.modes.len(), prescribed.self_motion_dof()), (1, 0));
    assert_eq!(prescribed.modes[0].assembly.q, panda.home());
}

/// A crank and an arm joined by a rod with balls at both ends: the rod spins about itself, which
/// moves no joint, so that the two places of the arm are told apart.
#[test]
fn spins_do_not_hide_modes() {
    let mut b = Mechanism::builder("balls");
    let at = |x: f64, y: f64| Pose::from_translation(Vec3::new(x, y, 0.0));
    b.joint(JointSpec::new("arm", JointKind::Revolute, "ground", "arm"));
    b.joint(JointSpec {
        parent_from_joint: at(1.0, 0.0),
        ..JointSpec::new("ball", JointKind::Spherical, "arm", "rod")
    });
    b.joint(JointSpec {
        parent_from_joint: at(2.5, 0.0),
        ..JointSpec::new("drive", JointKind::Revolute, "ground", "crank")
    });
    b.loop_joint(LoopJointSpec {
        link_a_from_joint: at(0.0, 2.0),
        link_b_from_joint: at(0.0, 1.0),
        ..LoopJointSpec::new("socket", JointKind::Spherical, "rod", "crank")
    });
    let mechanism = b.build().unwrap();
    let drive = place(&mechanism, "drive");
    let found = search(&mechanism, &[0.0; 5], &[drive], 30);
    assert_eq!(
        found.modes.iter().map(|m| m.self_motion_dof).collect::<Vec<_>>(),
        [1, 1],
        "{found:?}"
    );
    let rod = mechanism.frame("rod").unwrap();
    let got: Vec<Vec3> = found
        .modes
        .iter()
        .map(|m| mechanism.state(&m.assembly.q).unwrap().pose(rod).unwrap().translation)
        .collect();
    let expected = circles([0.0, 0.0], 1.0, [2.5, 1.0], 2.0).unwrap();
    assert_same_points(&got, &expected.map(|[x, y]| Vec3::new(x, y, 0.0)), 1e-9);
}

#[test]
fn modes_are_the_same_on_every_run_and_refuse_nonsense() {
    let stewart = catalogue::load("stewart").unwrap();
    let legs: Vec<usize> = stewart.actuated().collect();
    let (a, b) =
        (search(&stewart, stewart.home(), &legs, 10), search(&stewart, stewart.home(), &legs, 10));
    assert_eq!(a, b);
    let none = ModeOptions { starts: 0, seed: 0 };
    assert!(assembly_modes(&stewart, stewart.home(), &legs, none).is_err());
    assert!(assembly_modes(&stewart, &[0.0], &legs, ModeOptions::default()).is_err());
}
