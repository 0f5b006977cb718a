//! Times of the nearest solution of inverse kinematics, and of targets without one; with `--compare`
//! also its distance against that of a search of 1000 starts:
//! `cargo bench -p cylindroid --bench nearest -- [--compare] [--seed=N] [ROBOT ...]
//! [file.urdf:frame ...]`.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use cylindroid::ik::{Budget, Goal, IkOptions, Solver};
use cylindroid::kinematics::{Chain, ReferenceFrame};
use cylindroid::linalg::Matrix;
use cylindroid::model::Coordinate;
use cylindroid::{EndEffector, Mechanism, Vec3, catalogue};

/// Robots of the catalogue that are timed.
const ARMS: [&str; 4] = ["panda", "iiwa14", "ur5e", "puma560"];
/// Targets of a row of the table.
const TARGETS: usize = 400;
/// Targets of the comparison with many starts, and its starts.
const COMPARED: usize = 1000;
const STARTS: usize = 1000;

fn main() {
    let named = std::env::args().skip(1).filter(|a| !a.starts_with("--"));
    let (files, robots): (Vec<_>, Vec<_>) = named.partition(|name| name.contains(':'));
    let is_chosen = |name: &str| robots.is_empty() || robots.iter().any(|robot| robot == name);
    for robot in &robots {
        assert!(ARMS.contains(&robot.as_str()), "{robot}: none of {ARMS:?}");
    }
    println!("A pose with its Jacobian, panda: {:.0} ns (median).\n", pose_and_jacobian());
    println!("| robot | targets | solved | median [us] | 99 % [us] | most [us] |");
    println!("|---|---|---:|---:|---:|---:|");
    for name in ARMS.into_iter().filter(|name| is_chosen(name)) {
        let robot = catalogue::load(name).unwrap();
        let tool = robot.tool();
        rows(name, &robot, tool.into());
    }
    if std::env::args().any(|a| a == "--compare") {
        println!("| robot | targets | starts | closer | farther | farther by [rad] |");
        println!("|---|---:|---:|---:|---:|---:|");
        for name in ["panda", "iiwa14"].into_iter().filter(|name| is_chosen(name)) {
            against_starts(name, &catalogue::load(name).unwrap());
        }
    }
    for file in files {
        let (path, frame) = file.rsplit_once(':').unwrap();
        let robot = cylindroid::load(path).unwrap();
        let frame = robot.frame(frame).unwrap();
        rows(robot.name(), &robot, frame.into());
    }
}

/// Median time of what the table of peers begins with, which tells how fast the machine is (ns).
fn pose_and_jacobian() -> f64 {
    const CALLS: u32 = 1000;
    let robot = catalogue::load("panda").unwrap();
    let mut chain = Chain::new(&robot, robot.tool()).unwrap();
    let mut jacobian = Matrix::zeros(6, chain.n());
    let q = robot.home();
    let mut times: Vec<f64> = (0..TARGETS)
        .map(|_| {
            let begin = Instant::now();
            for _ in 0..CALLS {
                black_box(chain.set(black_box(q)));
                chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut jacobian);
                black_box(&jacobian);
            }
            begin.elapsed().as_secs_f64() * 1e9 / f64::from(CALLS)
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[TARGETS / 2]
}

/// The distance of the nearest solution against that of the best of many random starts, each
/// followed along its self-motion.
fn against_starts(name: &str, robot: &Mechanism) {
    let mut draw = drawn(robot);
    let tool = robot.tool();
    let (mut closer, mut farther, mut most, mut least_starts) = (0, 0, 0.0_f64, usize::MAX);
    for _ in 0..COMPARED {
        let start = draw();
        let target = robot.state(&draw()).unwrap().pose(tool).unwrap();
        let goals = [Goal::pose(tool, target)];
        let far = |q: &[f64]| {
            let squares = q.iter().zip(&start).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        let mut budget = Budget { iterations: 20_000, time: None };
        let options = |budget| {
            let initial_guess = Some(start.clone());
            IkOptions { nearest: true, initial_guess, budget, ..IkOptions::default() }
        };
        let mut solver = Solver::new(robot, &goals, &options(budget)).unwrap();
        let own = far(&solver.solve(&goals).unwrap().q);
        let (mut best, mut starts) = (f64::INFINITY, 0);
        while starts < STARTS {
            let mut solver = Solver::new(robot, &goals, &options(budget)).unwrap();
            let found = solver.solve_distinct(&goals, usize::MAX).unwrap();
            starts = found.iter().map(|s| s.restarts).max().unwrap_or(0);
            best = found.iter().map(|s| far(&s.q)).fold(best, f64::min);
            budget.iterations *= 2;
        }
        closer += usize::from(own < best - 1e-4);
        if own > best + 1e-4 {
            farther += 1;
        }
        most = most.max(own - best);
        least_starts = least_starts.min(starts);
    }
    println!("| {name} | {COMPARED} | {least_starts} | {closer} | {farther} | {most:.4} |");
}

fn rows(name: &str, robot: &Mechanism, tool: EndEffector) {
    for targets in ["reachable", "shifted by 0.2 m", "turned by pi"] {
        let mut draw = drawn(robot);
        let options = IkOptions { nearest: true, ..IkOptions::default() };
        let first = Goal::pose(tool, robot.state(robot.home()).unwrap().pose(tool).unwrap());
        let mut solver = Solver::new(robot, &[first], &options).unwrap();
        let (mut times, mut solved) = (Vec::new(), 0);
        let mut misses = Vec::new();
        for _ in 0..TARGETS {
            let start = draw();
            let mut target = robot.state(&draw()).unwrap().pose(tool).unwrap();
            match targets {
                "shifted by 0.2 m" => target.translation += Vec3::X * 0.2,
                "turned by pi" => {
                    target.rotation =
                        target.rotation * cylindroid::Rotation::exp(Vec3::new(PI, 0.0, 0.0));
                }
                _ => {}
            }
            let goal = Goal::pose(tool, target);
            solver.set_initial_guess(&start).unwrap();
            let begin = Instant::now();
            let found = solver.solve(&[goal]).unwrap();
            let time = begin.elapsed().as_secs_f64() * 1e6;
            solved += usize::from(found.success);
            if found.success {
                times.push(time);
            } else if found.out_of_reach.is_none() {
                misses.push(time);
            }
        }
        for (mut times, kind) in
            [(times, targets.to_owned()), (misses, format!("{targets}, missed"))]
        {
            times.sort_by(f64::total_cmp);
            let Some(most) = times.last() else { continue };
            let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize];
            println!(
                "| {name} | {kind} | {} of {TARGETS} | {:.0} | {:.0} | {most:.0} |",
                if kind == targets { solved } else { times.len() },
                at(0.5),
                at(0.99)
            );
        }
    }
}

/// Configurations within the limits, or half a turn where they are wider.
fn drawn(robot: &Mechanism) -> impl FnMut() -> Vec<f64> + '_ {
    let mut state: u64 = std::env::args()
        .find_map(|a| a.strip_prefix("--seed=").map(|seed| seed.parse().unwrap()))
        .unwrap_or(9);
    let mut one = move |c: &Coordinate| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
        let (lower, upper) = (c.limits.lower.max(-PI), c.limits.upper.min(PI));
        lower + (upper - lower) * share
    };
    move || robot.coordinates().iter().map(&mut one).collect()
}
