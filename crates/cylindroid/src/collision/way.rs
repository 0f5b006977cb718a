//! How far bodies move: bounds from the levers of the joints before them.
//!
//! Formula  way of a body <= sum_c l_c |change of q_c|, l_c the largest speed of its points for a unit
//!          velocity of coordinate c: that of its centre and its radius times the angular speed
//! Shapes   n levers
//! Units    m for each unit of the coordinate
//! Valid    to first order in the change of the configuration
//! Checked  tests/it/servo/braking_path.rs

use super::body::Body;
use super::scene::Pair;
use crate::kinematics::{State, Tip};

/// Calls `f` with each coordinate above the slot `end` that moves the body, and its lever.
fn for_each_lever(state: &State, body: &Body, end: usize, mut f: impl FnMut(usize, f64)) {
    let (center, radius) = (tip(state, body).world_from_tip.translation, body.bound());
    tip(state, body).for_each_column_above(end, center, |_, c, t| {
        let turn = t.angular.norm();
        f(c, t.linear.norm() + if turn > 0.0 { turn * radius } else { 0.0 });
    });
}

fn tip<'a>(state: &'a State, body: &Body) -> Tip<'a> {
    Tip {
        nodes: state.mechanism().nodes(),
        slots: state.slots(),
        slot: body.slot,
        world_from_tip: state.slots()[body.slot].pose() * body.slot_from_body,
    }
}

/// A bound of the way of a body for these changes of the coordinates (m).
pub(super) fn way(state: &State, body: &Body, change: &[f64]) -> f64 {
    let mut way = 0.0;
    for_each_lever(state, body, 0, |c, lever| {
        if change[c] != 0.0 {
            way += lever * change[c].abs();
        }
    });
    way
}

/// The levers of the motion of the bodies of a pair relative to one another, into `row`.
pub(super) fn levers_into(state: &State, bodies: &[Body], pair: Pair, row: &mut [f64]) {
    row.fill(0.0);
    let (a, b) = (&bodies[pair.a], &bodies[pair.b]);
    let shared = tip(state, a).common_slot(&tip(state, b));
    for body in [a, b] {
        for_each_lever(state, body, shared, |c, lever| row[c] += lever);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::{CollisionModel, CollisionOptions};
    use crate::model::{Collision, Geometry, JointKind, JointSpec, Link, Mechanism};
    use crate::scalar::uniform;
    use crate::spatial::{Pose, Vec3};

    /// No distance changes by more than the levers say, and no body moves further.
    #[test]
    fn distances_change_by_the_way_at_most() {
        let mut builder = Mechanism::builder("arm");
        for i in 0..5 {
            let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
            let kind = if i == 3 { JointKind::Prismatic } else { JointKind::Revolute };
            let mut joint = JointSpec::new(&format!("q{i}"), kind, &parent, &child);
            joint.axis = [Vec3::Z, Vec3::Y, Vec3::X][i % 3];
            joint.parent_from_joint = Pose::from_translation(Vec3::new(0.3, 0.1, 0.2));
            joint.limits.lower = -1.5;
            joint.limits.upper = 1.5;
            builder.joint(joint);
            let ball = Geometry::Sphere { radius: 0.03 };
            let shape = Collision { geometry: ball, ..Collision::default() };
            builder.link(Link { collisions: vec![shape], ..Link::named(&child) });
        }
        let robot = builder.build().unwrap();
        let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let table = Geometry::Box { size: Vec3::new(2.0, 2.0, 0.1) };
        model.add_obstacle("table", &table, Pose::from_translation(Vec3::Z * -1.0)).unwrap();
        let (mut near, mut row, mut seed) = (Vec::new(), vec![0.0; robot.n()], 5);
        let at_rest = robot.state(robot.home()).unwrap();
        model.near(&at_rest, f64::INFINITY, &mut near).unwrap();
        for Pair { a, b } in near.iter().map(|pair| model.pairs()[pair.pair]) {
            // Twice as far for twice the change.
            let way = |body, change: f64| model.way(&at_rest, body, &[change; 5]);
            assert_eq!((way(a, 2.0), way(b, 2.0)), (2.0 * way(a, 1.0), 2.0 * way(b, 1.0)));
            assert_eq!((way(a, 0.0), way(b, 0.0)), (0.0, 0.0));
        }
        let mut tight = 0;
        for _ in 0..200 {
            let limits = robot.coordinates().iter().map(|c| c.limits);
            let q: Vec<f64> =
                limits.map(|l| l.lower + uniform(&mut seed) * (l.upper - l.lower)).collect();
            let change: Vec<f64> = q.iter().map(|_| 1e-3 * (uniform(&mut seed) - 0.5)).collect();
            let moved: Vec<f64> = q.iter().zip(&change).map(|(q, c)| q + c).collect();
            let (state, later) = (robot.state(&q).unwrap(), robot.state(&moved).unwrap());
            model.near(&state, f64::INFINITY, &mut near).unwrap();
            model.place(&later);
            for pair in &near {
                model.levers_into(&state, pair.pair, &mut row);
                let own: f64 = row.iter().zip(&change).map(|(l, c)| l * c.abs()).sum();
                let Pair { a, b } = model.pairs()[pair.pair];
                let all = model.way(&state, a, &change) + model.way(&state, b, &change);
                let changed = (model.distance_of(pair.pair) - pair.distance).abs();
                let rounded = all * (1.0 + 1e-12);
                assert!(changed <= own + 1e-6 && own <= rounded, "{changed} {own} {all}");
                tight += usize::from(changed > 0.3 * own);
            }
        }
        assert!(tight > 100, "{tight}");
    }
}
