//! Closed forms: which one an arm has, and all its solutions.

use std::f64::consts::PI;

use cylindroid::ik::{Analytic, AnalyticSolution, AnalyticSolutions};
use cylindroid::model::{JointKind, Limits};
use cylindroid::{Matrix, Mechanism, ReferenceFrame, Vec3};

use super::arms::{hinges, industrial, placed, six, six_axes};
use super::sum;
use crate::record::{Record, check};
use crate::robots::Random;

/// The first letters of words.
fn initials(text: &str) -> String {
    text.split(' ').filter_map(|word| word.chars().next()).take(14).collect()
}

fn note_geometry(record: &mut Record, ik: &Analytic) {
    let exact = if ik.is_exact() { "exact" } else { "nearly" };
    let places = [&ik.coordinates()[..], ik.locked()].concat();
    record.word(&format!("{}_{exact}_{places:?}", initials(&ik.geometry().to_string())));
}

fn note(record: &mut Record, ik: &Analytic, found: &AnalyticSolutions) {
    let bits = |free: &[bool]| free.iter().fold(0, |bits, free| 2 * bits + i32::from(*free));
    let all: Vec<f64> =
        found.iter().map(|s| sum(&s.q) + 100.0 * f64::from(bits(&s.free))).collect();
    record.word(&format!("{}{}", found.len(), if found.is_open() { "open" } else { "" }));
    record.number(sum(&all));
    let turned: Vec<f64> =
        found.iter().take(1).flat_map(|s| ik.with_full_turns(s)).flatten().collect();
    if turned.len() > 6 {
        record.number(sum(&turned));
    }
}

/// Angles, of which some are those of singular configurations.
fn angles(random: &mut Random<'_>, robot: &Mechanism) -> Vec<f64> {
    let mut one = |_| match random.below(6) {
        0 => 0.5 * PI * (random.below(5) as f64 - 2.0),
        _ => random.within(-PI, PI),
    };
    (0..robot.n()).map(&mut one).collect()
}

fn solve(random: &mut Random<'_>, record: &mut Record, robot: &Mechanism, ik: &mut Analytic) {
    for round in 0..2 {
        let q = if round == 0 { random.configuration(robot) } else { angles(random, robot) };
        let mut target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        if random.once_in(6) {
            let away = random.vec3(0.5 * robot.reach());
            target.translation += away;
        }
        let start = match random.below(3) {
            0 => q,
            1 => random.configuration(robot),
            _ => q.iter().map(|x| x + random.within(-9.0, 9.0)).collect(),
        };
        let found = ik.solve(target, &start).unwrap();
        note(record, ik, &found);
    }
}

#[test]
fn all_solutions() {
    check("ik_analytic", 200, |random, record| {
        let size = random.power(-2.0, 2.0);
        let robot = six(random, size);
        match Analytic::of(&robot, robot.tool()) {
            Ok(mut ik) => {
                note_geometry(record, &ik);
                solve(random, record, &robot, &mut ik);
            }
            Err(reason) => record.word(&initials(&reason.to_string())),
        }
    });
}

/// One solution for each target, of arms that differ from a geometry by little.
#[test]
fn nearly_a_geometry() {
    check("ik_analytic_near", 300, |random, record| {
        let size = random.power(-2.0, 2.0);
        let mut axes = six_axes(random);
        let (share, which) = (random.power(-8.0, -2.7), random.below(6));
        let (turn, shift) = (random.vec3(share), random.vec3(share));
        axes[which].0 += turn;
        axes[which].1 += shift;
        let axes = hinges(random, &axes, size);
        let robot = placed(random, &axes, size);
        let mut ik = match Analytic::of(&robot, robot.tool()) {
            Ok(ik) => ik,
            Err(reason) => return record.word(&initials(&reason.to_string())),
        };
        note_geometry(record, &ik);
        let q = random.configuration(&robot);
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let start = random.configuration(&robot);
        let found = ik.solve(target, &start).unwrap();
        note(record, &ik, &found);
    });
}

/// Angles between axes, and their distances, about the thresholds at which they count.
#[test]
fn oblique_axes() {
    check("ik_analytic_oblique", 200, |random, record| {
        let mut axes = six_axes(random);
        let (i, share) = (random.below(5), random.power(-3.0, -1.0));
        axes[i + 1].0 = axes[i].0 + axes[i + 1].0 * share;
        let axes = hinges(random, &axes, 1.0);
        let robot = placed(random, &axes, 1.0);
        match Analytic::of(&robot, robot.tool()) {
            Ok(ik) => record.word(&ik.geometry().to_string()),
            Err(reason) => record.word(&initials(&reason.to_string())),
        }
    });
}

/// Further joints that are locked at values that change: before, between and beyond the six.
#[test]
fn locked_joints() {
    check("ik_analytic_locked", 160, |random, record| {
        let size = random.power(-1.0, 1.0);
        let mut axes = hinges(random, &[], size);
        let six = six_axes(random);
        axes.extend(six.iter().map(|(h, o)| (*h, *o * size, JointKind::Revolute, Limits::NONE)));
        let mut locked = Vec::new();
        for _ in 0..1 + random.below(2) {
            let kind =
                [JointKind::Revolute, JointKind::Prismatic, JointKind::Helical { pitch: 0.1 }];
            let at = [0, axes.len(), random.below(axes.len())][random.below(3)];
            locked.iter_mut().for_each(|c| *c += usize::from(*c >= at));
            locked.push(at);
            let own = (random.vec3(1.0), random.vec3(size), kind[random.below(3)], Limits::NONE);
            axes.insert(at, own);
        }
        if random.once_in(8) {
            locked.pop();
        }
        let robot = placed(random, &axes, size);
        match Analytic::with_locked(&robot, robot.tool(), &locked) {
            Ok(mut ik) => {
                note_geometry(record, &ik);
                solve(random, record, &robot, &mut ik);
            }
            Err(reason) => record.word(&initials(&reason.to_string())),
        }
    });
}

/// Full turns within limits of all kinds.
#[test]
fn full_turns() {
    check("ik_analytic_turns", 60, |random, record| {
        let robot = six(random, 1.0);
        let Ok(ik) = Analytic::of(&robot, robot.tool()) else { return };
        let q = random.configuration(&robot);
        let solution = AnalyticSolution {
            q: q[..6].try_into().unwrap(),
            free: [false; 6],
            position_error: 0.0,
            orientation_error: 0.0,
        };
        let all = ik.with_full_turns(&solution);
        record.word(&all.len());
        record.numbers(&[sum(all.as_flattened()), sum(&all[all.len() - 1])]);
    });
}

/// Straight wrists and elbows, wrists on the first axis, joints that the pose leaves free.
#[test]
fn singular_configurations() {
    check("ik_analytic_singular", 260, |random, record| {
        let size = random.power(-2.0, 2.0);
        let (robot, wrist) = industrial(random, size);
        let mut ik = match Analytic::of(&robot, robot.tool()) {
            Ok(ik) => ik,
            Err(reason) => return record.word(&initials(&reason.to_string())),
        };
        note_geometry(record, &ik);
        let mut q = angles(random, &robot);
        if random.once_in(3) {
            // The last axis parallel to those of the elbow, which is nearly straight.
            (q[2], q[4]) = (random.within(-0.4, 0.4), 0.0);
        }
        let mut target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        if random.once_in(4) {
            // On the first axis.
            let base = robot.joints()[0].parent_from_joint;
            let inverse = base.inverse();
            let center = inverse * (target * wrist);
            let away = Vec3::new(center.x, center.y, 0.0);
            target.translation += base.rotation * -away;
        }
        let start = if random.once_in(4) { q } else { angles(random, &robot) };
        let found = ik.solve(target, &start).unwrap();
        note(record, &ik, &found);
    });
}

/// The determinant of a square matrix, by elimination.
fn determinant(mut a: Matrix) -> f64 {
    let n = a.rows();
    let mut product = 1.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[(*i, k)].abs().total_cmp(&a[(*j, k)].abs()));
        let pivot = pivot.unwrap();
        if pivot != k {
            product = -product;
        }
        for j in 0..n {
            (a[(k, j)], a[(pivot, j)]) = (a[(pivot, j)], a[(k, j)]);
        }
        product *= a[(k, k)];
        for i in k + 1..n {
            let share = a[(i, k)] / a[(k, k)];
            for j in k..n {
                let above = a[(k, j)];
                a[(i, j)] -= share * above;
            }
        }
    }
    product
}

/// A singular configuration between two, by bisection.
fn singular(robot: &Mechanism, [a, b]: [&[f64]; 2]) -> Vec<f64> {
    let at = |t: f64| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + t * (b - a)).collect() };
    let sign = |t: f64| {
        let state = robot.state(&at(t)).unwrap();
        determinant(state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap()) > 0.0
    };
    let (mut low, mut high) = (0.0, 1.0);
    let first = sign(low);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if sign(middle) == first { &mut low } else { &mut high }) = middle;
    }
    at(low)
}

/// Two solutions in one, or nearly: how many there are.
#[test]
fn double_solutions() {
    check("ik_analytic_double", 240, |random, record| {
        let robot = six(random, 1.0);
        let Ok(mut ik) = Analytic::of(&robot, robot.tool()) else { return };
        let ends = [random.configuration(&robot), random.configuration(&robot)];
        let mut q = singular(&robot, ends.each_ref().map(|q| &q[..]));
        if random.once_in(2) {
            let beside = random.power(-10.0, -2.0);
            q[random.below(6)] += beside;
        }
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let found = ik.solve(target, &ends[0]).unwrap();
        record.word(&found.len());
        let sums: Vec<f64> = found.iter().map(|s| s.q.iter().map(|x| x.cos()).sum()).collect();
        record.number(sums.iter().sum());
    });
}
