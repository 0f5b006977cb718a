//! Times of the nearest solution of inverse kinematics, and of targets without one:
//! `cargo bench -p cylindroid --bench nearest -- [file.urdf:frame ...]`.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::PI;
use std::time::Instant;

use cylindroid::ik::{Goal, IkOptions, Solver};
use cylindroid::model::Coordinate;
use cylindroid::{EndEffector, Mechanism, Vec3, catalogue};

/// Targets of a row of the table.
const TARGETS: usize = 400;

fn main() {
    let files = std::env::args().skip(1).filter(|a| !a.starts_with("--"));
    println!("| robot | targets | solved | median [us] | 99 % [us] | most [us] |");
    println!("|---|---|---:|---:|---:|---:|");
    for name in ["panda", "iiwa14", "ur5e", "puma560"] {
        let robot = catalogue::load(name).unwrap();
        let tool = robot.tool();
        rows(name, &robot, tool.into());
    }
    for file in files {
        let (path, frame) = file.rsplit_once(':').unwrap();
        let robot = cylindroid::load(path).unwrap();
        let frame = robot.frame(frame).unwrap();
        rows(robot.name(), &robot, frame.into());
    }
}

fn rows(name: &str, robot: &Mechanism, tool: EndEffector) {
    for targets in ["reachable", "shifted by 0.2 m", "turned by pi"] {
        let mut draw = drawn(robot);
        let options = IkOptions { nearest: true, ..IkOptions::default() };
        let first = Goal::pose(tool, robot.state(robot.home()).unwrap().pose(tool));
        let mut solver = Solver::new(robot, &[first], &options).unwrap();
        let (mut times, mut solved) = (Vec::new(), 0);
        let mut misses = Vec::new();
        for _ in 0..TARGETS {
            let start = draw();
            let mut target = robot.state(&draw()).unwrap().pose(tool);
            match targets {
                "shifted by 0.2 m" => target.translation += Vec3::X * 0.2,
                "turned by pi" => {
                    target.rotation =
                        target.rotation * cylindroid::Rotation::exp(Vec3::new(PI, 0.0, 0.0));
                }
                _ => {}
            }
            let goal = Goal { target, ..first };
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
    let mut state = 9_u64;
    let mut one = move |c: &Coordinate| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
        let (lower, upper) = (c.limits.lower.max(-PI), c.limits.upper.min(PI));
        lower + (upper - lower) * share
    };
    move || robot.coordinates().iter().map(&mut one).collect()
}
