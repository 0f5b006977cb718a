//! What maps take and refuse; serial arms and spatial platforms.

use cylindroid::model::{Dimension, JointKind, JointSpec, Limits, formats};
use cylindroid::sweep::{LocusKind, Map, MapOptions};
use cylindroid::{Mechanism, Pose, Vec3, catalogue};

use crate::five_bar::{axis, map};
use crate::robots::{five_bar, three_rpr};

fn refused(mechanism: &Mechanism, options: MapOptions) -> String {
    Map::of(mechanism, options).unwrap_err().to_string()
}

/// The workspace of a planar arm is a ring.
#[test]
fn a_serial_arm_has_a_ring() {
    let arm = catalogue::load("3r").unwrap();
    let map = map(&arm, vec![axis("x", -3.03, 3.01, 25), axis("y", -3.01, 3.07, 25)]);
    assert!(!map.modes.is_empty() && map.free_motions == 0, "{:?}", map.held);
    for locus in map.loci.iter().filter(|l| l.kind == LocusKind::TypeOne) {
        for q in &locus.q {
            let jacobian = arm
                .state(q)
                .unwrap()
                .jacobian(arm.tool(), cylindroid::ReferenceFrame::World)
                .unwrap();
            let rows = cylindroid::Matrix::from_fn(3, 3, |i, j| jacobian[([0, 1, 5][i], j)]);
            let svd = cylindroid::linalg::Svd::of(&rows);
            assert!(svd.value(2) < 1e-8, "{}", svd.value(2));
        }
    }
}

/// Where the tip is on the first axis, that joint turns and nothing else moves: one curve for each
/// elbow, not one for each angle of the joint.
#[test]
fn self_motions_are_one_curve() {
    let arm = catalogue::load("3r").unwrap();
    let map = map(&arm, vec![axis("x", -1.01, 1.0, 41), axis("z", -0.52, 1.3, 41)]);
    let of_kind = map.loci.iter().filter(|l| l.kind == LocusKind::TypeOne);
    let (on_axis, others): (Vec<_>, Vec<_>) =
        of_kind.partition(|l| l.points.iter().all(|p| p[0].abs() < 1e-9));
    assert!((2..=4).contains(&on_axis.len()), "{}", on_axis.len());
    let heights = || on_axis.iter().flat_map(|l| &l.points).map(|p| p[1]);
    let (lowest, highest) =
        (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    assert!((lowest + 0.4).abs() < 1e-3 && (highest - 1.2).abs() < 1e-3, "{lowest} {highest}");
    let points: usize = map.loci.iter().map(|l| l.points.len()).sum();
    assert!(points < 10_000, "{points} points in {} curves", map.loci.len());
    for locus in on_axis.iter().chain(&others) {
        for (q, point) in locus.q.iter().zip(&locus.points) {
            let jacobian = arm
                .state(q)
                .unwrap()
                .jacobian(arm.tool(), cylindroid::ReferenceFrame::World)
                .unwrap();
            let tip = arm.state(q).unwrap().pose(arm.tool()).unwrap().translation;
            assert!((tip.x - point[0]).abs() < 1e-9 && (tip.z - point[1]).abs() < 1e-9);
            assert!(jacobian.cols() == 3 && tip.y.abs() < 1e-9);
            let sine = q[2].sin();
            assert!((0.16 * sine * tip.x.hypot(tip.y)).abs() < 1e-8, "{q:?}");
        }
    }
}

/// The same in other units: what rests in a self-motion is a matter of the length of the arm.
#[test]
fn self_motions_are_one_curve_in_every_unit() {
    let curves = |size: f64| {
        let text = include_str!("../../src/model/catalogue/3r.toml");
        let text = text.replace("0.4", &format!("{:?}", 0.4 * size));
        let arm = formats::toml::parse(&text, "3r.toml".as_ref()).unwrap();
        let of = |from: f64, to: f64, name| axis(name, from * size, to * size, 21);
        let map = map(&arm, vec![of(-1.01, 1.0, "x"), of(-0.52, 1.3, "z")]);
        let loci = map.loci.iter().filter(|l| l.kind == LocusKind::TypeOne);
        loci.map(|l| l.points.len()).collect::<Vec<_>>()
    };
    let own = curves(1.0);
    assert!(own.iter().sum::<usize>() < 10_000, "{own:?}");
    for size in [1e-4, 1e4] {
        assert_eq!(curves(size).len(), own.len(), "{size}: {own:?}");
    }
}

/// A horizontal slice of a Stewart platform: everything else is held.
#[test]
fn a_stewart_platform_keeps_its_height() {
    let stewart = catalogue::load("stewart").unwrap();
    let map = map(&stewart, vec![axis("x", -0.3, 0.3, 7), axis("y", -0.3, 0.3, 7)]);
    assert_eq!(map.free_motions, 0);
    let names: Vec<&str> = map.held.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["z", "yaw", "pitch", "roll"]);
    assert_eq!(map.signed, [true, true]);
    let mode = &map.modes[0];
    assert!(mode.cells() > 5);
    let n = stewart.n();
    for cell in (0..map.cells()).filter(|&cell| mode.reached[cell]) {
        let q = &mode.q[cell * n..(cell + 1) * n];
        let pose = stewart.state(q).unwrap().pose(stewart.reference()).unwrap().translation;
        let expected = map.values(cell);
        assert!((pose.x - expected[0]).abs() < 1e-9 && (pose.y - expected[1]).abs() < 1e-9);
        assert!((pose.z - 1.0).abs() < 1e-9 && mode.limit_distance[cell] > -1e-9);
    }
}

/// A redundant arm has one mode without curves, and says so.
#[test]
fn a_redundant_arm_has_free_motions() {
    let panda = catalogue::load("panda").unwrap();
    let map = map(&panda, vec![axis("x", 0.2, 0.7, 6), axis("z", 0.2, 0.8, 5)]);
    assert_eq!((map.free_motions, map.signed[0]), (1, false));
    assert!(map.loci.is_empty() && map.modes[0].cells() > 10);
}

#[test]
fn options_are_checked() {
    let five_bar = five_bar();
    let with = |axes| MapOptions { axes, ..MapOptions::default() };
    let xy = || vec![axis("x", -1.0, 1.0, 5), axis("y", 1.0, 2.0, 5)];
    assert!(refused(&five_bar, with(Vec::new())).contains("one, two or three"));
    let unknown = refused(&five_bar, with(vec![axis("z", 0.0, 1.0, 3)]));
    assert!(unknown.contains('z') && unknown.contains("rz"), "{unknown}");
    assert!(refused(&five_bar, with(vec![axis("x", 0.0, 1.0, 0)])).contains("one value"));
    assert!(refused(&five_bar, with(vec![axis("x", 1.0, 0.0, 3)])).contains("smaller"));
    assert!(refused(&five_bar, with(vec![axis("x", 0.0, f64::NAN, 3)])).contains('x'));
    let large = with(vec![axis("x", 0.0, 1.0, 1 << 40), axis("y", 0.0, 1.0, 1 << 40)]);
    assert!(refused(&five_bar, large).contains("cells"));
    let twice = with(vec![axis("x", 0.0, 1.0, 2), axis("x", 0.0, 1.0, 2)]);
    assert!(refused(&five_bar, twice).contains("once"));
    let held =
        |name: &str, value| MapOptions { held: vec![(name.to_owned(), value)], ..with(xy()) };
    assert!(refused(&five_bar, held("x", Some(1.0))).contains("once"));
    assert!(refused(&five_bar, held("rz", Some(f64::INFINITY))).contains("rz"));
    assert!(refused(&five_bar, held("roll", None)).contains("roll"));
    let start = MapOptions { start: Some(vec![0.0]), ..with(xy()) };
    assert!(Map::of(&five_bar, start).is_err());
    assert!(refused(&five_bar, MapOptions { starts: 0, ..with(xy()) }).contains("starts"));
    let panda = catalogue::load("panda").unwrap();
    let other = MapOptions { end_effector: Some(panda.tool().into()), ..with(xy()) };
    assert!(Map::of(&five_bar, other).is_err());
    // Nothing is there, which is a value.
    let far = with(vec![axis("x", 20.0, 21.0, 3), axis("y", 20.0, 21.0, 3)]);
    assert!(Map::of(&five_bar, far).unwrap().modes.is_empty());
}

/// Limits end the workspace, and each point of such a curve has a leg at its limit.
#[test]
fn limits_have_curves() {
    let base = [[-1.0, -0.8], [1.2, -0.7], [0.1, 1.3]];
    let platform = [[-0.4, -0.2], [0.5, -0.3], [0.1, 0.4]];
    let mechanism = three_rpr(base, platform, "limits = { lower = -0.3, upper = 0.4 }");
    let axes = vec![axis("x", -1.0, 1.0, 41), axis("y", -1.0, 1.0, 41)];
    let map = map(&mechanism, axes);
    let limits: Vec<_> = map.loci.iter().filter(|l| l.kind == LocusKind::Limit).collect();
    assert!(limits.len() >= 3, "{}", limits.len());
    for locus in limits {
        let name = locus.limit.as_ref().unwrap();
        let leg = crate::robots::place(&mechanism, name);
        for q in &locus.q {
            assert!((q[leg] + 0.3).abs().min((q[leg] - 0.4).abs()) < 1e-9);
        }
    }
    let one = &map.modes[0];
    for cell in 0..map.cells() {
        let p = map.values(cell);
        let lengths = [0, 1, 2].map(|i: usize| {
            let ([ax, ay], [bx, by]) = (base[i], platform[i]);
            (p[0] + bx - ax).hypot(p[1] + by - ay) - (bx - ax).hypot(by - ay)
        });
        let slack = lengths.iter().map(|l| (l + 0.3).min(0.4 - l)).fold(f64::INFINITY, f64::min);
        if slack.abs() > 1e-6 {
            assert_eq!(one.reached[cell], slack > 0.0, "{p:?} {slack}");
        }
    }
}

/// The limits of a gantry are the sides of its workspace. A side along which a map ends has no curve,
/// others go on to it.
#[test]
fn limits_of_a_gantry_are_its_sides() {
    let slider = |name: &str, parent: &str, child: &str, axis: Vec3, upper: f64| JointSpec {
        axis,
        limits: Limits { lower: 0.0, upper, ..Limits::NONE },
        ..JointSpec::new(name, JointKind::Prismatic, parent, child)
    };
    let mut builder = Mechanism::builder("gantry");
    builder.dimension(Dimension::Planar);
    builder.joint(slider("bridge", "ground", "bridge", Vec3::X, 1.0));
    builder.joint(slider("carriage", "bridge", "carriage", Vec3::Y, 2.0));
    builder.frame("tip", "carriage", Pose::IDENTITY).tool("tip");
    let gantry = builder.build().unwrap();
    for beyond in [0.13, 0.0] {
        let axes = vec![axis("x", -beyond, 1.0 + beyond, 11), axis("y", -0.2, 2.1, 17)];
        let map = map(&gantry, axes);
        let sides = [(1, 0.0, 1.0), (1, 2.0, 1.0), (0, 0.0, 2.0), (0, 1.0, 2.0)];
        let inside = if beyond == 0.0 { 2 } else { 4 };
        for (own, value, length) in sides.into_iter().take(inside) {
            let points = map.loci.iter().flat_map(|l| &l.points);
            let on = points.filter(|p| (p[own] - value).abs() < 1e-9);
            let along: Vec<f64> = on.map(|p| p[1 - own]).collect();
            let from = along.iter().copied().fold(f64::INFINITY, f64::min);
            let to = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!(from.abs() < 1e-9 && (to - length).abs() < 1e-9, "{own} {value}: {along:?}");
        }
        assert_eq!(map.loci.len(), inside);
        assert!(map.loci.iter().all(|l| l.kind == LocusKind::Limit));
    }
}
