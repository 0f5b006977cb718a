//! Singular poses by kind, and the distance to them.

use cylindroid::Matrix;
use cylindroid::closure::{
    Constraint, ConstraintBlocks, MobilityCounts, MotionSpace, Relation, Singularities,
    SingularityKind,
};
use cylindroid::spatial::Vec3;

use super::case::{case, cases};

fn pose(constraint: &Constraint) -> (MotionSpace, Relation, MobilityCounts) {
    let motions = MotionSpace::of(constraint);
    let relation = motions.relation();
    let counts = MobilityCounts::of(&motions, &relation);
    (motions, relation, counts)
}

#[test]
fn reference_poses_are_named() {
    for (singular, regular) in
        [("fivebar_typeII", "fivebar_sec5_case_a"), ("planar_3RRR_typeI", "planar_3RRR")]
    {
        let generic = pose(&case(regular).constraint()).2;
        let singular = case(singular);
        let (motions, relation, now) = pose(&singular.constraint());
        let found = Singularities::of(&motions, &relation, &generic.generic(now));
        let labels: Vec<String> = found.kinds.iter().map(ToString::to_string).collect();
        let expected: Vec<&str> = singular.value["singularity"]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_str().unwrap())
            .collect();
        assert_eq!(labels, expected, "{}", singular.name);
    }
    // Against themselves all poses are regular.
    for case in cases() {
        let (motions, relation, now) = pose(&case.constraint());
        let found = Singularities::of(&motions, &relation, &now);
        assert!(found.is_regular() && found.distances.configuration_space > 1e-3, "{}", case.name);
    }
}

/// The distal links of a five-bar stretched but for an angle: the distance falls with it.
#[test]
fn distance_falls_in_proportion() {
    let stretched = case("fivebar_typeII");
    let generic = pose(&case("fivebar_sec5_case_a").constraint()).2;
    let distance = |height: f64| {
        let near = stretched.with_joint_at(4, Vec3::new(1.0, 1.0 + height, 0.0));
        let (motions, relation, _) = pose(&near.constraint());
        let found = Singularities::of(&motions, &relation, &generic);
        assert_eq!(found.is_regular(), height > 0.0);
        found.distances
    };
    let (one, ten) = (distance(1e-4), distance(1e-3));
    assert!((ten.type_ii / one.type_ii - 10.0).abs() < 0.01, "{one:?} {ten:?}");
    assert!(one.type_i > 0.1 && one.configuration_space > 1e-2);
    let at = distance(0.0);
    assert_eq!(at.type_ii, 0.0);
    assert!(at.type_i > 0.1);
}

/// The gained motion of the stretched five-bar: its middle joint moves across the links, and what
/// blocks it is not resisted.
#[test]
fn gained_motion_is_across_the_links() {
    let (motions, relation, now) = pose(&case("fivebar_typeII").constraint());
    let found = Singularities::of(&motions, &relation, &now);
    let gained = found.gained.column(0);
    assert!(gained[0].abs() < 1e-14 && gained[1].abs() > 0.1, "{gained:?}");
}

#[test]
fn folded_four_bar_is_a_configuration_space_singularity() {
    let regular = case("fourbar_fig1cd");
    let generic = pose(&regular.constraint()).2;
    let mut folded = regular;
    for (j, x) in [0.0, 1.0, 2.0, 3.0].into_iter().enumerate() {
        folded = folded.with_joint_at(j, Vec3::new(x, 0.0, 0.0));
    }
    let (motions, relation, _) = pose(&folded.constraint());
    let found = Singularities::of(&motions, &relation, &generic);
    assert!(found.kinds.contains(&SingularityKind::ConfigurationSpace), "{found:?}");
    assert_eq!(found.distances.configuration_space, 0.0);
}

/// A leg whose two passive joints come into line.
#[test]
fn joints_in_line_spin_idly() {
    let leg = |angle: f64| {
        let (s, c) = angle.sin_cos();
        Constraint::new(ConstraintBlocks {
            actuated: Matrix::from_rows(&[[1.0], [0.0], [0.0]]).unwrap(),
            passive: Matrix::from_rows(&[[0.0, 0.0], [1.0, c], [0.0, s]]).unwrap(),
            grasp: Matrix::from_rows(&[[1.0, 0.0, 0.0]]).unwrap(),
        })
        .unwrap()
    };
    assert_eq!(leg(0.5).length(), 1.0, "columns are as they are given");
    let generic = pose(&leg(0.5)).2;
    let (motions, relation, now) = pose(&leg(0.0));
    assert_eq!((generic.idle, now.idle), (0, 1));
    let found = Singularities::of(&motions, &relation, &generic);
    assert_eq!(found.kinds, [SingularityKind::ConfigurationSpace, SingularityKind::Passive]);
}

/// A serial arm of two links: stretched it loses a motion, and the wrench along it is resisted
/// without torque.
#[test]
fn stretched_arm_is_type_i() {
    let arm = |elbow: f64| {
        let (s, c) = elbow.sin_cos();
        Constraint::serial(&Matrix::from_rows(&[[-s, -s], [1.0 + c, c]]).unwrap()).unwrap()
    };
    let generic = pose(&arm(1.0)).2;
    let (motions, relation, _) = pose(&arm(0.0));
    let found = Singularities::of(&motions, &relation, &generic);
    assert_eq!(found.kinds, [SingularityKind::TypeI]);
    let blocked = found.blocked.column(0);
    assert!(blocked[0].abs() > 0.1 && blocked[1].abs() < 1e-14, "{blocked:?}");
}

/// Six legs by their lines, `l_i = n_i . (v + w x b_i)`: the platform above the base turned about
/// the vertical by `yaw`.
fn platform(yaw: f64) -> Constraint {
    let at = |radius: f64, angle: f64, height: f64| {
        Vec3::new(radius * angle.cos(), radius * angle.sin(), height)
    };
    let rows: Vec<[f64; 6]> = (0..6)
        .map(|i| {
            let third = f64::from(i / 2) * 2.0 * std::f64::consts::FRAC_PI_3;
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            let foot = at(2.0, third + 0.2 * side, -1.5);
            let head = at(1.0, third + 0.8 * side + yaw, 0.0);
            let leg = head - foot;
            let n = leg * (1.0 / leg.norm());
            let m = head.cross(n);
            [n.x, n.y, n.z, m.x, m.y, m.z]
        })
        .collect();
    let lines = Matrix::from_rows(&rows).unwrap();
    Constraint::new(ConstraintBlocks {
        actuated: Matrix::identity(6),
        passive: Matrix::zeros(6, 0),
        grasp: lines.transpose(),
    })
    .unwrap()
}

/// A symmetric Stewart platform turned by a right angle: six legs of one linear complex, a
/// screw about the vertical that no leg resists (Fichter 1986).
#[test]
fn stewart_platform_turned_by_a_right_angle() {
    let generic = pose(&platform(0.3)).2;
    let right = std::f64::consts::FRAC_PI_2;
    for yaw in [right, -right] {
        let (motions, relation, _) = pose(&platform(yaw));
        let found = Singularities::of(&motions, &relation, &generic);
        assert_eq!(found.kinds, [SingularityKind::TypeII], "{found:?}");
        assert_eq!(found.gained.cols(), 1);
        let u = found.gained.column(0);
        // A screw about the vertical axis: v and w along z.
        for i in [0, 1, 3, 4] {
            assert!(u[i].abs() < 1e-12, "{u:?}");
        }
        assert!(u[5].abs() > 0.1);
        assert_eq!(found.distances.type_ii, 0.0);
    }
    let (motions, relation, _) = pose(&platform(right - 1e-4));
    let near = Singularities::of(&motions, &relation, &generic);
    assert!(near.is_regular() && near.distances.type_ii < 1e-3, "{near:?}");
}
