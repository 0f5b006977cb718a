//! Statistics of 10 000 samples against Pinocchio and NumPy, which compute the samples themselves
//! (xtask/vectors/sweep_vectors.py).

use std::path::{Path, PathBuf};

use cylindroid::sweep::{Quantity, Source, Statistics, Sweep, SweepOptions};
use serde_json::Value;

fn robots_folder() -> PathBuf {
    std::env::var_os("CYLINDROID_TEST_ROBOTS").map_or_else(
        || {
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../../target/test-data/models/cmeel.prefix/share/example-robot-data/robots")
        },
        PathBuf::from,
    )
}

#[test]
fn statistics_agree_with_pinocchio() {
    for name in ["ur5", "panda"] {
        let file = format!("{}/tests/vectors/sweep/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let data: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let urdf = robots_folder().join(data["urdf"].as_str().unwrap());
        let robot = cylindroid::load_file(&urdf).unwrap();
        let names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
        let joints = data["joints"].as_array().unwrap();
        assert!(joints.iter().map(|j| j.as_str().unwrap()).eq(names), "{name}: other coordinates");
        let options = SweepOptions {
            source: Source::Samples {
                count: data["count"].as_u64().unwrap(),
                seed: data["seed"].as_u64().unwrap(),
            },
            quantities: vec![
                Quantity::Pose,
                Quantity::Yoshikawa,
                Quantity::SmallestSingularValue,
                Quantity::Condition,
            ],
            end_effector: Some(robot.frame(data["frame"].as_str().unwrap()).unwrap().into()),
            length: data["length"].as_f64(),
            part_rows: 777,
            ..Default::default()
        };
        let found = Sweep::new(&robot, options).unwrap().statistics(None, |_| true);
        let found = found.unwrap().unwrap();
        for (column, expected) in data["statistics"].as_object().unwrap() {
            let own = &found.iter().find(|(c, _)| c.name == *column).unwrap().1;
            let Statistics::Numbers { smallest, mean, largest, not_finite: 0 } = own else {
                panic!("{name}: {column}")
            };
            for (key, x) in [("smallest", smallest), ("mean", mean), ("largest", largest)] {
                let y = expected[key].as_f64().unwrap();
                // Of the smallest singular values the last digits are rounding of the largest.
                let error = (x - y).abs() / y.abs().max(1.0);
                assert!(error < 1e-9, "{name}: {key} of {column} is {x}, Pinocchio's {y}");
            }
        }
    }
}
