//! Continuation: where ways end, against exact geometry; ways back; limits; what cannot be followed.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cylindroid::closure::{
    ContinuationOptions, ContinuationResult, PathEnd, PathSingularity, SingularityKind, assemble,
    track_path,
};
use cylindroid::model::{JointKind, JointSpec};
use cylindroid::spatial::{Rotation, Vec3};
use cylindroid::{Mechanism, catalogue};

use super::linkage::{dead_four_bar, five_bar, linkage, place};
use crate::support::{Random, assert_close, planar};

fn go(
    mechanism: &Mechanism,
    start: &[f64],
    prescribed: &[usize],
    goal: &[f64],
) -> ContinuationResult {
    let way =
        track_path(mechanism, start, prescribed, goal, ContinuationOptions::default()).unwrap();
    check(mechanism, &way);
    way
}

/// Properties of every path.
fn check(mechanism: &Mechanism, way: &ContinuationResult) {
    let last = way.path.last().unwrap();
    assert_eq!((last.fraction, &last.q), (way.fraction, &way.q));
    assert!(way.path[0].fraction == 0.0 && way.path.is_sorted_by(|a, b| a.fraction < b.fraction));
    assert!(
        way.closure_error.distance <= 1e-10 * mechanism.reach() && way.closure_error.angle <= 1e-10
    );
    for point in &way.path {
        // Nothing to do: its loops are closed as it stands.
        let all: Vec<usize> = (0..mechanism.n()).collect();
        assert!(assemble(mechanism, &point.q, &all).unwrap().closed, "{point:?}");
    }
    assert_eq!(way.end == PathEnd::Reached, way.fraction == 1.0);
}

fn singular(way: &ContinuationResult) -> &PathSingularity {
    match &way.end {
        PathEnd::Singular(found) => found,
        other => panic!("{other} at {}", way.fraction),
    }
}

/// The crank of a four-bar whose coupler and rocker stretch at known angles: it stops before them,
/// coming from both sides and in both modes, the nearer the smaller the least distance.
#[test]
fn a_crank_stops_before_its_dead_points() {
    let four_bar = dead_four_bar("");
    let crank = place(&four_bar, "crank");
    for mode in [0.5, -0.5] {
        // Upright is 0, and so the other dead point -pi; start well between them.
        let mut guess = [mode; 3];
        guess[crank] = -1.0;
        let start = assemble(&four_bar, &guess, &[crank]).unwrap();
        assert!(start.closed);
        for (goal, dead) in [(0.5, 0.0), (-4.0, -PI)] {
            let way = go(&four_bar, &start.q, &[crank], &[goal]);
            let left = (dead - way.q[crank]) * f64::signum(goal + 1.0);
            assert!(left > 0.0 && left < 1e-5, "{left} before {dead}");
            let found = singular(&way);
            assert_eq!(found.kind, SingularityKind::TypeII);
            assert!(found.distance >= 1e-3 && found.distance < 1.0001e-3, "{found:?}");
            // The coupler turns about the knee, which rests with the crank.
            let knee = Vec3::new(0.0, if dead == 0.0 { 3.0 } else { -3.0 }, 0.0);
            let screw = found.screw.unwrap();
            assert!(screw.pitch.abs() < 1e-12 && screw.axis.direction.z.abs() > 1.0 - 1e-12);
            assert!((screw.axis.point - knee).norm() < 1e-4, "{screw:?}");
            assert!(found.joint_velocities[crank] == 0.0 && found.twist.angular.z.abs() > 0.1);
            // A fold: its angle goes with the square of the distance.
            let wide =
                ContinuationOptions { least_distance: 1e-2, ..ContinuationOptions::default() };
            let wider = track_path(&four_bar, &start.q, &[crank], &[goal], wide).unwrap();
            let ratio = (dead - wider.q[crank]) * f64::signum(goal + 1.0) / left;
            assert!((ratio - 100.0).abs() < 2.0, "{ratio}");
        }
    }
}

/// The cranks of the five-bar moved apart until the links between them stretch:
/// (2 + 2 sin t)^2 + (2 cos t - 1)^2 = (1 + sqrt 2)^2.
#[test]
fn cranks_stop_before_the_links_between_them_stretch() {
    let t = 0.5_f64.atan() + ((2.0 * 2_f64.sqrt() - 6.0) / 80_f64.sqrt()).asin();
    for (reference, kind) in
        [("coupler", SingularityKind::TypeII), ("crank", SingularityKind::Passive)]
    {
        let five_bar = five_bar(&format!("reference = \"{reference}\""));
        let prescribed = [place(&five_bar, "q1"), place(&five_bar, "q5")];
        let way = go(&five_bar, &[0.0; 4], &prescribed, &[1.0, 0.0]);
        assert!(
            way.q[prescribed[0]] < t && way.q[prescribed[0]] > t - 1e-4,
            "{} {t}",
            way.q[prescribed[0]]
        );
        assert!((way.fraction - way.q[prescribed[0]]).abs() < 1e-12);
        let found = singular(&way);
        assert_eq!(found.kind, kind);
        assert_eq!(found.screw.is_some(), kind == SingularityKind::TypeII);
        // No further from there, but back.
        let on = go(&five_bar, &way.q, &prescribed, &[1.0, 0.0]);
        assert!(on.fraction < 1e-6 && singular(&on).kind == kind, "{on:?}");
        let back = go(&five_bar, &way.q, &prescribed, &[0.0, 0.0]);
        assert_eq!(back.end, PathEnd::Reached);
        assert_close("back", &back.q, &[0.0; 4], 1e-9);
    }
}

/// A parallelogram lies flat at zero, where it may go on as one or fold to its mirror form: a
/// configuration-space singularity, which no step of whatever length passes over.
#[test]
fn a_parallelogram_stops_before_it_lies_flat() {
    let parallelogram = linkage(
        "reference = \"coupler\"",
        &[
            ("crank", ["ground", "crank"], [0.0, 0.0], "actuated = true"),
            ("knee", ["crank", "coupler"], [0.0, 1.0], ""),
            ("elbow", ["coupler", "rocker"], [2.0, 1.0], ""),
            ("pivot", ["rocker", "ground"], [2.0, 0.0], ""),
        ],
    );
    let crank = place(&parallelogram, "crank");
    for step in [0.01, 0.1, 1.0] {
        for (goal, flat) in [(-3.0, -FRAC_PI_2), (3.0, FRAC_PI_2)] {
            let options = ContinuationOptions { step, ..ContinuationOptions::default() };
            let way = track_path(&parallelogram, &[0.0; 3], &[crank], &[goal], options).unwrap();
            check(&parallelogram, &way);
            let left = (flat - way.q[crank]) / f64::signum(flat);
            assert!(left > 1e-4 && left < 1e-2, "{left}");
            assert_eq!(singular(&way).kind, SingularityKind::ConfigurationSpace);
            // Still the parallelogram: its coupler has not turned.
            let pose =
                parallelogram.state(&way.q).unwrap().pose(parallelogram.reference()).unwrap();
            assert!(pose.rotation.log().norm() < 1e-9);
        }
    }
    // Started flat there is nowhere to go.
    let flat = assemble(&parallelogram, &[-FRAC_PI_2, FRAC_PI_2, -FRAC_PI_2], &[0, 1, 2]).unwrap();
    assert!(flat.closed, "{flat:?}");
    let way = go(&parallelogram, &flat.q, &[crank], &[0.0]);
    assert!(way.fraction == 0.0 && singular(&way).distance < 1e-9, "{way:?}");
    assert_eq!(singular(&way).kind, SingularityKind::ConfigurationSpace);
}

/// Grashof: 1 + 2 < 1.8 + 1.3. The crank goes round, to the same mode, and back.
#[test]
fn a_crank_goes_round() {
    let four_bar = catalogue::load("four-bar").unwrap();
    for turns in [TAU, -TAU, 3.0 * TAU] {
        let way = go(&four_bar, &[0.0; 3], &[0], &[turns]);
        assert_eq!((&way.end, way.q[0]), (&PathEnd::Reached, turns));
        // The coupler turns against the crank, so that it comes back as it was; the rocker rocks.
        assert_close("round", &way.q[1..], &[-turns, 0.0], 1e-9);
    }
}

/// Ways of all closed chains end in the same place whatever the steps, and lead back.
#[test]
fn ways_do_not_hang_on_the_steps_and_lead_back() {
    let mut random = Random(4);
    for name in ["four-bar", "five-bar", "3rrr", "stewart", "delta", "watt"] {
        let mechanism = catalogue::load(name).unwrap();
        let prescribed: Vec<usize> = mechanism.actuated().collect();
        let mut reached = 0;
        for _ in 0..6 {
            let goal: Vec<f64> = prescribed
                .iter()
                .map(|&i| mechanism.home()[i] + random.within(-0.25, 0.25))
                .collect();
            let way = go(&mechanism, mechanism.home(), &prescribed, &goal);
            let fine = ContinuationOptions { step: 0.02, ..ContinuationOptions::default() };
            let finer = track_path(&mechanism, mechanism.home(), &prescribed, &goal, fine).unwrap();
            assert_eq!(way.end.to_string(), finer.end.to_string(), "{name}");
            assert!((way.fraction - finer.fraction).abs() < 1e-9, "{name}");
            assert_close(name, &way.q, &finer.q, 1e-6);
            assert!(finer.path.iter().all(|p| p.distance >= 1e-3));
            let at_home: Vec<f64> = prescribed.iter().map(|&i| mechanism.home()[i]).collect();
            let back = go(&mechanism, &way.q, &prescribed, &at_home);
            assert_eq!(back.end, PathEnd::Reached, "{name}");
            assert_close(name, &back.q, mechanism.home(), 1e-6);
            reached += usize::from(way.end == PathEnd::Reached);
        }
        assert!(reached > 0, "{name}");
    }
}

/// Six legs lengthened alike lift the platform straight: h^2 + d^2 = l^2; and no further than their
/// strokes.
#[test]
fn stewart_legs_lift_to_their_limits() {
    let stewart = catalogue::load("stewart").unwrap();
    let legs: Vec<usize> = stewart.actuated().collect();
    let height = |q: &[f64]| stewart.state(q).unwrap().pose(stewart.reference()).unwrap();
    // The axis of a leg is (d, 1) / l.
    let length = 1.0 / 0.833_117_367_473_659_8;
    let lifted = |by: f64| ((length + by).powi(2) - length * length + 1.0).sqrt();
    let way = go(&stewart, stewart.home(), &legs, &[0.3; 6]);
    assert_eq!(way.end, PathEnd::Reached);
    let pose = height(&way.q);
    assert_close("pose", &pose.translation.to_array(), &[0.0, 0.0, lifted(0.3)], 1e-9);
    assert!(pose.rotation.log().norm() < 1e-9);
    let way = go(&stewart, stewart.home(), &legs, &[0.5; 6]);
    assert!(matches!(way.end, PathEnd::Limit { coordinate } if legs.contains(&coordinate)));
    assert!((way.fraction - 0.8).abs() < 1e-9);
    assert!(stewart.outside_limits(&way.q).all(|i| (way.q[i] - 0.4).abs() < 1e-11));
    let top = height(&way.q).translation.z;
    assert!((top - lifted(0.4)).abs() < 1e-8, "{top}");
}

/// Legs lengthened and shortened in turn twist the platform about the vertical: it stops just before
/// a right angle, where a screw about the vertical is lost to the legs (Fichter 1986).
#[test]
fn a_stewart_platform_stops_before_a_right_angle() {
    let stewart = catalogue::load("stewart").unwrap();
    let legs: Vec<usize> = stewart.actuated().collect();
    for side in [1.0, -1.0] {
        let goal = [0.4, -0.4, 0.4, -0.4, 0.4, -0.4].map(|x| side * x);
        let way = go(&stewart, stewart.home(), &legs, &goal);
        let found = singular(&way);
        assert_eq!(found.kind, SingularityKind::TypeII);
        let pose = stewart.state(&way.q).unwrap().pose(stewart.reference()).unwrap();
        let turn = pose.rotation.log();
        assert!(turn.x.abs() < 1e-9 && turn.y.abs() < 1e-9 && pose.translation.x.abs() < 1e-9);
        assert!(turn.z.abs() < FRAC_PI_2 && turn.z.abs() > FRAC_PI_2 - 0.02, "{turn:?}");
        let screw = found.screw.unwrap();
        assert!(
            screw.axis.direction.z.abs() > 0.999 && screw.axis.point.norm() < 0.05,
            "{screw:?}"
        );
    }
}

/// A limit of a passive joint on the way: the law of cosines says where the elbow is at it.
#[test]
fn a_passive_limit_ends_the_way() {
    let four_bar = dead_four_bar("limits = { lower = -1.2, upper = 1.2 }");
    let (crank, elbow) = (place(&four_bar, "crank"), place(&four_bar, "elbow"));
    for mode in [0.5, -0.5] {
        let mut guess = [mode; 3];
        guess[crank] = -0.1;
        let start = assemble(&four_bar, &guess, &[crank]).unwrap();
        assert!(start.closed);
        let way = go(&four_bar, &start.q, &[crank], &[-1.5]);
        assert_eq!(way.end, PathEnd::Limit { coordinate: elbow });
        let at = way.q[elbow].abs();
        assert!(at > 1.2 - 1e-9 && at <= 1.2, "{at}");
        // From knee to pivot: 2 * 2.5 cos(0.6); the crank's own triangle gives its angle.
        let across = 5.0 * 0.6_f64.cos();
        let angle = ((9.0 + 16.0 - across * across) / 24.0).acos();
        assert!((way.q[crank] - (angle - FRAC_PI_2)).abs() < 1e-9);
    }
}

#[test]
fn what_cannot_be_followed_is_said() {
    let five_bar = catalogue::load("five-bar").unwrap();
    // Three coordinates on two degrees of freedom; all of them.
    for prescribed in [&[0, 1, 2][..], &[0, 1, 2, 3]] {
        let mut goal = vec![0.0; prescribed.len()];
        goal[0] = 0.1;
        let way = go(&five_bar, &[0.0; 4], prescribed, &goal);
        assert_eq!((way.fraction, &way.end), (0.0, &PathEnd::Contradiction));
        assert_eq!(
            go(&five_bar, &[0.0; 4], prescribed, &vec![0.0; prescribed.len()]).end,
            PathEnd::Reached
        );
    }
    // A start that does not close.
    let options = ContinuationOptions::default();
    let open = track_path(&five_bar, &[FRAC_PI_2, 0.0, 0.0, 0.0], &[0], &[0.0], options).unwrap();
    assert!(open.end == PathEnd::Open && open.path.is_empty() && open.closure_error.distance > 0.1);
    // One coordinate of two: the others move by the least. None: it is there.
    let way = go(&five_bar, &[0.0; 4], &[0], &[-0.5]);
    assert_eq!((&way.end, way.q[0]), (&PathEnd::Reached, -0.5));
    assert_eq!(go(&five_bar, &[0.0; 4], &[], &[]).end, PathEnd::Reached);
    // Nonsense.
    let refused = |prescribed: &[usize], goal: &[f64], options: ContinuationOptions| {
        track_path(&five_bar, &[0.0; 4], prescribed, goal, options).unwrap_err().to_string()
    };
    assert!(refused(&[0], &[], options).contains("goal"));
    assert!(refused(&[0], &[f64::NAN], options).contains("goal"));
    assert!(refused(&[7], &[0.0], options).contains("4 coordinates"));
    assert!(refused(&[0, 0], &[0.0, 1.0], options).contains("twice"));
    assert!(refused(&[0], &[0.0], ContinuationOptions { step: 0.0, ..options }).contains("step"));
    for least_distance in [0.0, 1.0, f64::NAN] {
        let text = refused(&[0], &[0.0], ContinuationOptions { least_distance, ..options });
        assert!(text.contains("least_distance"), "{text}");
    }
}

/// A tree has nothing to close: its joints go where they are sent, to their limits.
#[test]
fn a_tree_follows() {
    let arm = planar(3);
    let way = go(&arm, &[0.1, 0.2, 0.3], &[0, 2], &[1.0, -1.0]);
    assert_eq!((&way.end, &way.q), (&PathEnd::Reached, &vec![1.0, 0.2, -1.0]));
    assert!(way.path.iter().all(|p| p.distance == f64::INFINITY));
    let way = go(&arm, &[0.0; 3], &[1], &[4.0]);
    assert_eq!(way.end, PathEnd::Limit { coordinate: 1 });
    assert!((way.fraction - 0.75).abs() < 1e-9);
}

/// A ball joint goes to its goal about one axis, also where the numbers are of another half turn.
#[test]
fn a_ball_turns_about_one_axis() {
    let mut b = Mechanism::builder("ball");
    b.joint(JointSpec::new("ball", JointKind::Spherical, "ground", "body"));
    b.joint(JointSpec::new("body", JointKind::Free, "ground", "satellite"));
    let mechanism = b.build().unwrap();
    let body = mechanism.frame("body").unwrap();
    let (from, to) = (Vec3::new(2.0, -0.4, 0.3), Vec3::new(-2.5, 1.0, 0.2));
    let mut start = vec![0.0; 9];
    let balls: Vec<usize> =
        (0..9).filter(|&i| mechanism.coordinates()[i].name.starts_with("ball")).collect();
    assert_eq!(balls.len(), 3);
    balls.iter().zip(from.to_array()).for_each(|(&i, x)| start[i] = x);
    let way = go(&mechanism, &start, &balls, &to.to_array());
    assert_eq!(way.end, PathEnd::Reached);
    assert!(balls.iter().zip(to.to_array()).all(|(&i, x)| way.q[i] == x));
    let turn = Rotation::exp(from).inverse() * Rotation::exp(to);
    for point in &way.path {
        let now = mechanism.state(&point.q).unwrap().pose(body).unwrap().rotation;
        let expected = Rotation::exp(from) * Rotation::exp(turn.log() * point.fraction);
        assert!(now.angle_to(expected) < 1e-9);
    }
    assert!(way.path.len() > 5);
}
