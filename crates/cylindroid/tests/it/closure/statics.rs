//! Torques for a wrench, forces at contacts, elastic forces.

use cylindroid::catalogue;
use cylindroid::closure::{
    ClosedChain, Mobility, MotionSpace, Relation, StaticLoad, TransmittedWrench, contact_forces,
    joint_torques, row_compliance, transmitted_wrenches,
};
use cylindroid::linalg::Metric;
use cylindroid::model::{ContactKind, ContactSpec, JointKind, JointSpec};
use cylindroid::spatial::{Pose, Vec3, Wrench};
use cylindroid::{Matrix, Mechanism};

use super::case::{Case, case, cases};
use crate::support::{Random, assert_close};

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn setup(case: &Case) -> (cylindroid::closure::Constraint, MotionSpace, Relation) {
    let constraint = case.constraint();
    let motions = MotionSpace::of(&constraint);
    let relation = motions.relation();
    (constraint, motions, relation)
}

/// Balanced torques do no work together with the wrench, are the least, and what is left of the
/// wrench works on free motions of the object alone.
#[test]
fn torques_balance_the_wrench() {
    let mut random = Random(73);
    for case in cases() {
        let (_, _, relation) = setup(&case);
        let wrench = random.vector(relation.object());
        let weights: Vec<f64> = (0..relation.joints()).map(|_| random.within(0.2, 3.0)).collect();
        let metric = Metric::diagonal("weights", &weights).unwrap();
        for (metric, weights) in [(None, vec![1.0; weights.len()]), (Some(&metric), weights)] {
            let found = joint_torques(&relation, &wrench, metric).unwrap();
            let balanced: Vec<f64> =
                wrench.iter().zip(&found.unbalanced).map(|(w, l)| w - l).collect();
            let motions = relation.motions().basis();
            let size = 1.0 + found.torques.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
            for j in 0..motions.cols() {
                let (q, u) = motions.column(j).split_at(relation.joints());
                let power = dot(&found.torques, q) + dot(&balanced, u);
                assert!(power.abs() < 1e-12 * size, "{}: {power}", case.name);
            }
            let internal = relation.forces().zero;
            for j in 0..internal.cols() {
                let weighted: f64 = internal
                    .column(j)
                    .iter()
                    .zip(&weights)
                    .zip(&found.torques)
                    .map(|((h, w), t)| h * w * t)
                    .sum();
                assert!(weighted.abs() < 1e-12 * size, "{}: {weighted}", case.name);
            }
            // The part that the structure resists lies along zero-torque wrenches, and asks no torque alone.
            let alone = joint_torques(&relation, &found.structural, metric).unwrap();
            assert_close("alone", &alone.torques, &vec![0.0; alone.torques.len()], 1e-11 * size);
            assert_close("again", &alone.structural, &found.structural, 1e-12);
            let rest: Vec<f64> =
                balanced.iter().zip(&found.structural).map(|(h, s)| h - s).collect();
            let other = joint_torques(&relation, &rest, metric).unwrap();
            assert_close("rest", &other.torques, &found.torques, 1e-11 * size);
            assert_close("none", &other.structural, &vec![0.0; wrench.len()], 1e-12);
            if relation.dimensions().indeterminacy == 0 {
                assert_close("left", &found.unbalanced, &vec![0.0; wrench.len()], 1e-14);
            }
        }
    }
}

/// `w = G t, tau = -J_a^T t, 0 = J_p^T t`, and elastic forces are orthogonal in the compliance to
/// all that nothing determines.
#[test]
fn contact_forces_are_in_equilibrium() {
    let mut random = Random(74);
    for case in cases() {
        let (constraint, motions, relation) = setup(&case);
        let mobility = Mobility::from_parts(&constraint, &motions, &relation);
        let wrench = random.vector(constraint.object());
        let mut found = joint_torques(&relation, &wrench, None).unwrap();
        let balanced: Vec<f64> = wrench.iter().zip(&found.unbalanced).map(|(w, l)| w - l).collect();
        // Internal torques may be added at will.
        for j in 0..mobility.internal.dimension() {
            let share = random.within(-1.0, 1.0);
            let h = mobility.internal.basis.column(j);
            found.torques.iter_mut().zip(h).for_each(|(t, h)| *t += share * h);
        }
        let load = StaticLoad { torques: &found.torques, wrench: &balanced };
        let t = constraint.rows();
        let weights: Vec<f64> = (0..t).map(|_| random.within(0.1, 4.0)).collect();
        let compliance = Metric::diagonal("compliance", &weights).unwrap();
        let soft = contact_forces(&constraint, &motions, load, Some(&compliance)).unwrap();
        let least = contact_forces(&constraint, &motions, load, None).unwrap();
        let blocks = constraint.blocks();
        for (forces, weights) in [(&least, &vec![1.0; t]), (&soft, &weights)] {
            let f = &forces.forces;
            let size = 1e-12 * (1.0 + f.iter().fold(0.0, |m: f64, x| m.max(x.abs())));
            assert!(forces.unbalanced < 1e-12, "{}: {}", case.name, forces.unbalanced);
            assert_close("w", &blocks.grasp.mul_vec(f), &balanced, size);
            let torque: Vec<f64> =
                blocks.actuated.transpose().mul_vec(f).iter().map(|x| -x).collect();
            assert_close("tau", &torque, &found.torques, size);
            let passive = blocks.passive.transpose().mul_vec(f);
            assert_close("passive", &passive, &vec![0.0; constraint.passive()], size);
            let weighted: Vec<f64> = f.iter().zip(weights).map(|(f, w)| f * w).collect();
            for j in 0..mobility.hyperstatic.dimension() {
                let along = dot(mobility.hyperstatic.basis.column(j), &weighted);
                assert!(along.abs() < size, "{}: {along}", case.name);
            }
        }
        if mobility.hyperstatic.dimension() == 0 {
            assert_close(&case.name, &soft.forces, &least.forces, 1e-10);
        }
    }
}

/// Two fingers hold one force together; the stiffer of two springs in parallel takes more.
#[test]
fn stiffer_contact_takes_more() {
    // An object on two supports, both below it: f_1 + f_2 = w.
    let constraint = cylindroid::closure::Constraint::new(cylindroid::closure::ConstraintBlocks {
        actuated: Matrix::zeros(2, 0),
        passive: Matrix::zeros(2, 0),
        grasp: Matrix::from_rows(&[[1.0, 1.0]]).unwrap(),
    })
    .unwrap();
    let motions = MotionSpace::of(&constraint);
    assert_eq!((motions.dof(), motions.hyperstatic()), (0, 1));
    let load = StaticLoad { torques: &[], wrench: &[3.0] };
    let compliance = Metric::diagonal("compliance", &[1.0, 2.0]).unwrap();
    let elastic = contact_forces(&constraint, &motions, load, Some(&compliance)).unwrap();
    assert_close("elastic", &elastic.forces, &[2.0, 1.0], 1e-14);
    let least = contact_forces(&constraint, &motions, load, None).unwrap();
    assert_close("least", &least.forces, &[1.5, 1.5], 1e-14);
}

/// Torques that contradict the wrench are told by what they leave.
#[test]
fn contradiction_is_reported() {
    let (constraint, motions, _) = setup(&case("fivebar_sec5_case_a"));
    let load = StaticLoad { torques: &[1.0, 0.0], wrench: &[0.0, 0.0, 0.0] };
    let found = contact_forces(&constraint, &motions, load, None).unwrap();
    assert!(found.unbalanced > 0.1);
    let (_, _, relation) = setup(&case("fivebar_typeII"));
    let gained = relation.motions().infinite;
    // The singular five-bar does not hold a force across its stretched links.
    let found = joint_torques(&relation, gained.column(0), None).unwrap();
    assert_close("left", &found.unbalanced, gained.column(0), 1e-12);
}

/// The wrenches through joints and contacts of a mechanism under a load; a compliance for each.
fn through(m: &Mechanism, wrench: &[f64], compliance: Option<&[f64]>) -> Vec<TransmittedWrench> {
    let state = m.state(m.home()).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let motions = MotionSpace::of(&chain.constraint);
    let relation = motions.relation();
    let torques = joint_torques(&relation, wrench, None).unwrap().torques;
    let metric = compliance.map(|c| row_compliance(&state, &chain, c).unwrap());
    let load = StaticLoad { torques: &torques, wrench };
    let found = contact_forces(&chain.constraint, &motions, load, metric.as_ref()).unwrap();
    assert!(found.unbalanced < 1e-10);
    transmitted_wrenches(&state, &chain, &found.forces).unwrap()
}

/// Two arms hold a box: what they exert and the load are in balance, about any point.
#[test]
fn transmitted_wrenches_balance_the_load() {
    let m = catalogue::load("two-arm").unwrap();
    let origin = m.state(m.home()).unwrap().pose(m.reference()).unwrap().translation;
    let load = Wrench::from_array([1.0, -2.0, -30.0, 0.5, 0.2, -0.1]);
    // About the world's origin.
    let about = |w: Wrench, point: Vec3| w.at_point(Vec3::ZERO - point);
    for compliance in [None, Some(&[1e-6, 1e-6][..]), Some(&[1e-6, 1e-3])] {
        let found = through(&m, &load.to_array(), compliance);
        assert_eq!(found.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["left", "right"]);
        let sum = found.iter().fold(about(load, origin), |s, t| s + about(t.wrench, t.point));
        assert_close("sum", &sum.to_array(), &[0.0; 6], 1e-10);
        for t in &found {
            let (normal, across) = (t.normal.unwrap(), t.tangential().unwrap());
            assert!((normal.hypot(across) - t.wrench.force.norm()).abs() < 1e-10);
        }
        // The torques of all actuators are given: they decide, whatever gives way.
        let plain = through(&m, &load.to_array(), None);
        let difference = found[0].wrench - plain[0].wrench;
        assert_close("same", &difference.to_array(), &[0.0; 6], 1e-9);
    }
}

/// A box clamped at both ends: the stiffer clamp takes more of a force along the line through both,
/// and of a moment about it.
#[test]
fn stiffer_clamp_takes_more() {
    let mut b = Mechanism::builder("clamped");
    b.joint(JointSpec::new("box", JointKind::Free, "ground", "box"));
    for (name, x) in [("left", -0.4), ("right", 0.4)] {
        let at = Pose::from_translation(Vec3::new(x, 0.0, 0.0));
        b.contact(ContactSpec {
            link_a_from_contact: at,
            link_b_from_contact: at,
            ..ContactSpec::new(name, ContactKind::Complete, "ground", "box")
        });
    }
    b.reference("box");
    let m = b.build().unwrap().with_actuated::<&str>(&[]).unwrap();
    let state = m.state(&[0.0; 6]).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let motions = MotionSpace::of(&chain.constraint);
    assert_eq!(motions.hyperstatic(), 6);
    let load = StaticLoad { torques: &[], wrench: &[3.0, 0.0, 0.0, 6.0, 0.0, 0.0] };
    let metric = row_compliance(&state, &chain, &[1e-6, 2e-6]).unwrap();
    let found = contact_forces(&chain.constraint, &motions, load, Some(&metric)).unwrap();
    let all = transmitted_wrenches(&state, &chain, &found.forces).unwrap();
    assert_close("left", &all[0].wrench.to_array(), &[-2.0, 0.0, 0.0, -4.0, 0.0, 0.0], 1e-12);
    assert_close("right", &all[1].wrench.to_array(), &[-1.0, 0.0, 0.0, -2.0, 0.0, 0.0], 1e-12);
}

/// Actuated at q1 and q5 the five-bar's rod turns freely at both ends: what goes through the ground
/// joint q5 points along it, and its motor's torque goes with it.
#[test]
fn transmitted_by_closing_joints() {
    let m = catalogue::load("five-bar").unwrap().with_actuated(&["q1", "q5"]).unwrap();
    let load = [3.0, -1.0, 0.2];
    let found = through(&m, &load, None);
    assert_eq!((found.len(), found[0].name.as_str(), found[0].normal), (1, "q5", None));
    let (force, moment) = (found[0].wrench.force, found[0].wrench.moment);
    let rod = Vec3::new(1.0, -1.0, 0.0);
    assert!(force.norm() > 0.5 && force.cross(rod).norm() < 1e-12, "{force:?}");
    let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
    let relation = MotionSpace::of(&chain.constraint).relation();
    let torques = joint_torques(&relation, &load, None).unwrap().torques;
    assert!((moment.z - torques[1]).abs() < 1e-12, "{moment:?} {torques:?}");
    let state = m.state(m.home()).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    assert!(transmitted_wrenches(&state, &chain, &[0.0]).is_err());
    assert!(row_compliance(&state, &chain, &[]).is_err());
    assert!(row_compliance(&state, &chain, &[0.0]).is_err());
}

/// A wrench across all attainable motions needs no torque: the structure balances it whole.
#[test]
fn structure_balances_what_needs_no_torque() {
    let jacobian = Matrix::from_fn(6, 2, |i, j| f64::from(u8::from(i == 3 * j)));
    let constraint = cylindroid::closure::Constraint::serial(&jacobian).unwrap();
    let relation = MotionSpace::of(&constraint).relation();
    let wrench = [2.0, -1.0, 0.5, 3.0, 0.25, -4.0];
    let found = joint_torques(&relation, &wrench, None).unwrap();
    assert_close("torques", &found.torques, &[-2.0, -3.0], 1e-12);
    assert_close("structure", &found.structural, &[0.0, -1.0, 0.5, 0.0, 0.25, -4.0], 1e-12);
    assert_close("unbalanced", &found.unbalanced, &[0.0; 6], 1e-12);
}
