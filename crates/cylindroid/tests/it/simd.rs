//! Every form of the kernels that the processor has, forced by `CYLINDROID_SIMD`: registers of four
//! and eight lanes agree to the bit, plain numbers up to the rounding of fused products.

#![cfg(target_arch = "x86_64")]

use std::process::Command;

use cylindroid::ik::{Goal, IkOptions, solve};
use cylindroid::inverse::{InverseBatch, Method};
use cylindroid::kinematics::KinematicsBatch;
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};
use cylindroid::{Pose, ReferenceFrame, Servo, ServoOptions, catalogue};

use crate::support::{Random, zoo};

/// Marks the lines of [`results`] among those of the test harness.
const MARK: &str = "result of";

/// Prints results of all kernels, for [`forms_agree`], which runs it in processes of its own.
#[test]
#[ignore = "run by forms_agree"]
fn results() {
    let print = |what: &str, values: &[f64]| {
        let bits: Vec<String> = values.iter().map(|x| format!("{:x}", x.to_bits())).collect();
        println!("\n{MARK} {what}: {}", bits.join(" "));
    };
    let mut random = Random(5);
    for robot in [catalogue::load("panda").unwrap(), catalogue::load("ur5e").unwrap(), zoo()] {
        let (name, n, tool) = (robot.name(), robot.n(), robot.tool());
        let q: Vec<f64> = (0..21).flat_map(|_| random.q(&robot)).collect();
        let batch = KinematicsBatch::new(&robot, tool).unwrap();
        print(&format!("poses of {name}"), &batch.poses(&q).unwrap());
        let jacobians = batch.jacobians(&q, ReferenceFrame::LocalWorldAligned).unwrap();
        print(&format!("Jacobians of {name}"), &jacobians);
        let state = robot.state(&q[..n]).unwrap();
        print(&format!("pose of {name}"), state.pose(tool).unwrap().to_matrix().as_flattened());
        let jacobian = state.jacobian(tool, ReferenceFrame::Local).unwrap();
        print(&format!("Jacobian of {name}"), jacobian.as_slice());
        let values: Vec<f64> = Svd::of(&jacobian).values().collect();
        print(&format!("singular values of {name}"), &values);
        let inverses = InverseBatch::new(Method::Damped { damping: 0.1 }, 6, n).unwrap();
        let found = inverses.inverses(&jacobians).unwrap();
        print(&format!("inverses of {name}"), &found.matrices);
        let pseudoinverses = InverseBatch::new(Method::default(), 6, n).unwrap();
        let found = pseudoinverses.inverses(&jacobians).unwrap();
        print(&format!("pseudoinverses of {name}"), &found.matrices);
        print(&format!("their singular values of {name}"), &found.singular_values);
    }
    let panda = catalogue::load("panda").unwrap();
    let mut servo = Servo::new(&panda, ServoOptions::new(&panda)).unwrap();
    let target = Pose { translation: cylindroid::Vec3::new(0.4, 0.2, 0.3), ..random.pose() };
    let mut q = panda.home().to_vec();
    for _ in 0..50 {
        servo.step(&q, target).unwrap();
        servo.advance(&mut q);
    }
    print("servo", &q);
    let goal = Goal::pose(
        panda.tool(),
        panda.state(&random.q(&panda)).unwrap().pose(panda.tool()).unwrap(),
    );
    let found = solve(&panda, &[goal], &IkOptions::default()).unwrap();
    assert!(found.success);
    let reached = panda.state(&found.q).unwrap().pose(panda.tool()).unwrap().to_matrix();
    print("pose by inverse kinematics", reached.as_flattened());
    let bar = catalogue::load("five-bar").unwrap();
    let batch = ManipulabilityBatch::new(&bar, &BatchOptions::default()).unwrap();
    let analysis = batch.analyse(&bar.home().repeat(9)).unwrap();
    print("five-bar", &analysis);
}

/// The results of a process with this value of the variable.
fn run(simd: &str) -> Vec<(String, Vec<f64>)> {
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "simd::results", "--ignored", "--nocapture"])
        .env("CYLINDROID_SIMD", simd)
        .output()
        .unwrap();
    assert!(output.status.success(), "{simd}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let value = |bits: &str| f64::from_bits(u64::from_str_radix(bits, 16).unwrap());
    let line = |line: &str| {
        let (what, bits) = line.strip_prefix(MARK)?.trim().split_once(": ")?;
        Some((what.to_owned(), bits.split(' ').map(value).collect()))
    };
    text.lines().filter_map(line).collect()
}

#[test]
fn forms_agree() {
    let [scalar, avx2, avx512] = ["scalar", "avx2", "avx512"].map(run);
    assert!(scalar.len() > 20 && scalar.len() == avx2.len() && scalar.len() == avx512.len());
    let mut differ = 0;
    for (i, (what, plain)) in scalar.iter().enumerate() {
        for form in [&avx2[i], &avx512[i]] {
            assert_eq!(&form.0, what);
            let largest =
                plain.iter().filter(|x| x.is_finite()).fold(1.0_f64, |m, x| m.max(x.abs()));
            for (a, b) in plain.iter().zip(&form.1) {
                let same = a.to_bits() == b.to_bits() || (a - b).abs() <= 1e-12 * largest;
                assert!(same || a.is_nan() && b.is_nan(), "{what}: {a:e} and {b:e}");
            }
        }
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&avx2[i].1), bits(&avx512[i].1), "{what}");
        differ += usize::from(bits(plain) != bits(&avx2[i].1));
    }
    // The variable was read: fused products round once.
    let fused = std::arch::is_x86_feature_detected!("avx2");
    assert_eq!(differ > 5, fused, "{differ} results differ");
}
