//! Payloads: torques at the limit, the force polytope, closed chains.

use cylindroid::closure::{ClosedChain, MotionSpace, joint_torques};
use cylindroid::model::JointLimits;
use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions};
use cylindroid::{Mechanism, Rotation, Vec3};

use crate::configurations;

fn payloads(robot: &Mechanism, source: Source, direction: Vec3) -> (Vec<Vec<f64>>, Vec<f64>) {
    let quantities = vec![Quantity::Payload];
    let options = SweepOptions { source, quantities, direction, ..SweepOptions::default() };
    let sweep = Sweep::new(robot, options).unwrap();
    let table = sweep.table(0..sweep.rows()).unwrap();
    (configurations(robot, &table), table.numbers("payload").unwrap().to_vec())
}

/// The torques that balance the force reach a limit, and none is beyond its own.
#[test]
fn torques_of_an_arm_reach_a_limit() {
    let arm = cylindroid::load("panda").unwrap();
    let efforts: Vec<f64> = arm.coordinates().iter().map(|c| c.limits.effort).collect();
    for direction in [Vec3::new(0.0, 0.0, -3.0), Vec3::new(1.0, -2.0, 0.5)] {
        let source = Source::Samples { count: 200, seed: 4 };
        let (all, found) = payloads(&arm, source, direction);
        let d = direction.unit(0.0).unwrap();
        for (q, force) in all.iter().zip(found) {
            let chain = ClosedChain::of(&arm.state(q).unwrap(), Some(arm.tool()), None).unwrap();
            let wrench = [d.x * force, d.y * force, d.z * force, 0.0, 0.0, 0.0];
            let relation = MotionSpace::of(&chain.constraint).relation();
            let torques = joint_torques(&relation, &wrench, None).unwrap().torques;
            let most = torques.iter().zip(&efforts).map(|(t, e)| t.abs() / e).fold(0.0, f64::max);
            assert!((most - 1.0).abs() < 1e-9, "{most}");
        }
    }
}

/// An arm that turns about its first axis bears the same along a direction that turns with it.
#[test]
fn payloads_turn_with_the_arm() {
    let arm = cylindroid::load("panda").unwrap();
    let q = vec![0.3, -0.6, 0.4, -2.0, 0.5, 1.7, -0.3];
    let (direction, turn) = (Vec3::new(0.5, 0.2, -0.7), 0.9);
    let mut turned = q.clone();
    turned[0] += turn;
    let (_, here) = payloads(&arm, Source::Configurations(q), direction);
    let direction = Rotation::exp(Vec3::Z * turn) * direction;
    let (_, there) = payloads(&arm, Source::Configurations(turned), direction);
    assert!((here[0] / there[0] - 1.0).abs() < 1e-12, "{here:?} {there:?}");
}

/// A planar arm of links 1 and 1: along x only the height of the joints below the tip loads them.
#[test]
fn a_vertical_arm_bears_any_weight() {
    let arm = cylindroid::load("3r").unwrap();
    let limit = |effort| JointLimits { effort: Some(effort), ..JointLimits::default() };
    let limits = [("joint1", limit(9.0)), ("joint2", limit(10.0)), ("joint3", limit(4.0))];
    let arm = arm.with_limits(&limits).unwrap();
    let source = |q: [f64; 3]| Source::Configurations(q.to_vec());
    let down = Vec3::new(0.0, 0.0, -1.0);
    // Stretched out: levers 0.8 and 0.4.
    let (_, found) = payloads(&arm, source([0.3, 0.0, 0.0]), down);
    assert!((found[0] - 10.0_f64.min(4.0 / 0.4).min(10.0 / 0.8)).abs() < 1e-9, "{found:?}");
    let up = std::f64::consts::FRAC_PI_2;
    let (_, found) = payloads(&arm, source([0.3, up, 0.0]), down);
    assert!(found[0] > 1e12, "{found:?}");
    // About the vertical axis the lever is 0.8.
    let aside = Vec3::new(-0.3_f64.sin(), 0.3_f64.cos(), 0.0);
    let (_, found) = payloads(&arm, source([0.3, 0.0, 0.0]), aside);
    assert!((found[0] - 9.0 / 0.8).abs() < 1e-9, "{found:?}");
}

/// One leg at its limit, of a platform that six legs hold; more actuators bear more.
#[test]
fn closed_chains_take_the_best_torques() {
    let stewart = cylindroid::load("stewart").unwrap();
    let direction = Vec3::new(0.3, 0.1, -1.0);
    let q = stewart.home().to_vec();
    let (_, found) = payloads(&stewart, Source::Configurations(q.clone()), direction);
    let chain = ClosedChain::of(&stewart.state(&q).unwrap(), None, None).unwrap();
    let d = direction.unit(0.0).unwrap();
    let relation = MotionSpace::of(&chain.constraint).relation();
    let wrench = [d.x, d.y, d.z, 0.0, 0.0, 0.0].map(|x| x * found[0]);
    let forces = joint_torques(&relation, &wrench, None).unwrap().torques;
    let most = forces.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
    assert!((most / 2000.0 - 1.0).abs() < 1e-9, "{most}");
    let five_bar = cylindroid::load("five-bar").unwrap();
    let with = |names: &[&str]| {
        let limit = JointLimits { effort: Some(5.0), ..JointLimits::default() };
        let limits: Vec<(&str, JointLimits)> =
            ["q1", "q2", "q3", "q4"].iter().map(|name| (*name, limit)).collect();
        let robot = five_bar.with_actuated(names).unwrap().with_limits(&limits).unwrap();
        let home = Source::Configurations(robot.home().to_vec());
        payloads(&robot, home, Vec3::new(0.4, 1.0, 0.0)).1[0]
    };
    let (two, four) = (with(&["q1", "q2"]), with(&["q1", "q2", "q3", "q4"]));
    assert!(two.is_finite() && four > two, "{two} {four}");
}

#[test]
fn payloads_that_do_not_exist_are_refused() {
    let refused = |model: &str, direction: Vec3| {
        let robot = cylindroid::load(model).unwrap();
        let source = Source::Configurations(robot.home().to_vec());
        let quantities = vec![Quantity::Payload];
        let options = SweepOptions { source, quantities, direction, ..SweepOptions::default() };
        Sweep::new(&robot, options).unwrap_err().to_string()
    };
    assert!(refused("panda", Vec3::ZERO).contains("no length"));
    assert!(refused("panda", Vec3::new(f64::NAN, 0.0, 0.0)).contains("finite"));
    assert!(refused("3r", Vec3::Z).contains("no effort limit"));
}
