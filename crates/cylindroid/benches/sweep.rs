//! Times of a sweep by stages: rows of a panda with pose, Jacobian, singular values and Yoshikawa's
//! measure, by all threads, in memory, encoded with checksums, and written into a folder:
//! `cargo bench -p cylindroid --bench sweep -- [ROWS] [FOLDER]`. `/dev/shm` leaves out the disk.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cylindroid::ReferenceFrame;
use cylindroid::kinematics::KinematicsBatch;
use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions, WriteOptions};

fn main() {
    let given: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let rows: f64 = given.first().map_or(2e6, |rows| rows.parse().unwrap());
    let folder = given.get(1).map_or_else(std::env::temp_dir, PathBuf::from).join("sweep-bench");
    let threads = std::thread::available_parallelism().unwrap();
    println!("{threads} threads, {rows:.0} rows");
    println!("| stage | million rows/s | ns/row of a thread |");
    println!("|---|---:|---:|");
    let tell = |stage: &str, rows: u64, seconds: f64| {
        let rate = rows as f64 / seconds;
        println!("| {stage} | {:.2} | {:.0} |", rate * 1e-6, threads.get() as f64 * 1e9 / rate);
    };
    let robot = cylindroid::load("panda").unwrap();
    let of = |quantities: &[Quantity]| {
        let options = SweepOptions {
            source: Source::Samples { count: rows as u64, seed: 0 },
            quantities: quantities.to_vec(),
            ..SweepOptions::default()
        };
        Sweep::new(&robot, options).unwrap()
    };
    let all = [Quantity::Pose, Quantity::Jacobian, Quantity::SingularValues, Quantity::Yoshikawa];
    let parts = |sweep: &Sweep, work: &(dyn Fn(&Sweep, usize) + Sync)| {
        let next = AtomicUsize::new(0);
        let start = Instant::now();
        std::thread::scope(|scope| {
            for _ in 0..threads.get() {
                scope.spawn(|| {
                    loop {
                        let part = next.fetch_add(1, Ordering::Relaxed);
                        if part >= sweep.parts() {
                            return;
                        }
                        work(sweep, part);
                    }
                });
            }
        });
        start.elapsed().as_secs_f64()
    };
    // Once without looking at the clock.
    parts(&of(&all), &|sweep, part| drop(sweep.part(part).unwrap()));

    let kernel = KinematicsBatch::new(&robot, robot.tool()).unwrap();
    let samples = of(&[]).table(0..1024).unwrap();
    let q: Vec<f64> = (0..1024)
        .flat_map(|i| {
            let of = |c: &cylindroid::model::Coordinate| samples.numbers(&c.name).unwrap()[i];
            robot.coordinates().iter().map(of).collect::<Vec<_>>()
        })
        .collect();
    let of_kernel = |_: &Sweep, _: usize| {
        let (mut poses, mut jacobians) = (vec![0.0; 1024 * 16], vec![0.0; 1024 * 42]);
        let frame = ReferenceFrame::LocalWorldAligned;
        for _ in 0..64 {
            kernel.poses_and_jacobians_into(&q, frame, &mut poses, &mut jacobians).unwrap();
        }
    };
    let sweep = of(&[]);
    tell("kernel of poses and Jacobians", sweep.rows(), parts(&sweep, &of_kernel));
    for count in 0..=all.len() {
        let sweep = of(&all[..count]);
        let names: Vec<&str> = all[..count].iter().map(|q| q.name()).collect();
        let stage = format!("table of samples {}", names.join(", "));
        let seconds = parts(&sweep, &|sweep, part| drop(sweep.part(part).unwrap()));
        tell(&stage, sweep.rows(), seconds);
    }
    let sweep = of(&all);
    let seconds = parts(&sweep, &|sweep, part| drop(sweep.part_file(part).unwrap()));
    tell("encoded, with checksum", sweep.rows(), seconds);
    for time in ["", " again"] {
        let start = Instant::now();
        sweep.write(&folder, &WriteOptions::default(), |_| true).unwrap();
        let stage = format!("written to {}{time}", folder.display());
        tell(&stage, sweep.rows(), start.elapsed().as_secs_f64());
        std::fs::remove_dir_all(&folder).unwrap();
    }
    let start = Instant::now();
    sweep.statistics(None, |_| true).unwrap();
    tell("statistics", sweep.rows(), start.elapsed().as_secs_f64());
}
