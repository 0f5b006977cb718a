//! Flags reach what they set: times of paths against their formulas, inverses against the library.

use cylindroid::control::{InverseSelection, NamedInverse};
use cylindroid::{ReferenceFrame, Rotation, Vec3, catalogue};
use serde_json::Value;

use crate::{difference, json, numbers};

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

/// The time of a move of the panda from home, 0.1 m down or 0.4 rad about the vertical.
fn time(turn: f64, flags: &[&str]) -> f64 {
    let home = &json(&["fk", "panda"], 0)["pose"];
    let (mut to, mut rpy) = (numbers(&home["position"]), numbers(&home["rpy"]));
    to[2] -= if turn == 0.0 { 0.1 } else { 0.0 };
    rpy[2] += turn;
    let (to, rpy) = (list(&to), list(&rpy));
    let path = ["move", "panda", "--to", &to, "--rpy", &rpy, "--line", "--speed", "100,100"];
    json(&[&path, flags].concat(), 0)["time"].as_f64().unwrap()
}

/// From rest to rest over a distance d: 2 sqrt(d / a), or (32 d / j)^(1/3) if jerk alone is bounded.
#[test]
fn accelerations_and_jerks_of_paths() {
    let jerk_limited = |flags: &[&str], turn: f64| {
        let law = ["--law", "jerk-limited", "--acceleration-linear", "1000"];
        time(turn, &[&law[..], &["--acceleration-angular", "1000"], flags].concat())
    };
    for (size, text) in [(0.2, "0.2"), (0.05, "0.05")] {
        for (turn, distance, part) in [(0.0, 0.1, "linear"), (0.4, 0.4, "angular")] {
            let flag = format!("--acceleration-{part}");
            let found = time(turn, &[&flag, text]);
            let expected = 2.0 * f64::sqrt(distance / size);
            assert!((found - expected).abs() < 3e-3, "{flag} {text}: {found} for {expected}");
            let flag = format!("--jerk-{part}");
            let found = jerk_limited(&[&flag, text], turn);
            let expected = (32.0 * distance / size).cbrt();
            assert!((found - expected).abs() < 3e-3, "{flag} {text}: {found} for {expected}");
        }
    }
}

/// The components x and y of the target are met in the axes that are named, and others are free.
#[test]
fn axes_of_a_task() {
    let target = ["ik", "youbot", "--to", "0.3,0.1,0.3", "--rpy", "0.3,0.4,0.5", "--task", "x,y"];
    for axes in ["world", "local"] {
        let found = json(&[&target[..], &["--task-axes", axes]].concat(), 0);
        let pose = &json(&["fk", "youbot", "--q", &list(&numbers(&found["q"]))], 0)["pose"];
        let position = numbers(&pose["position"]);
        let away: Vec<f64> = position.iter().zip([0.3, 0.1, 0.3]).map(|(at, to)| at - to).collect();
        let rows: Vec<Vec<f64>> =
            pose["matrix"].as_array().unwrap()[..3].iter().map(numbers).collect();
        let local: Vec<f64> = (0..3).map(|j| (0..3).map(|i| rows[i][j] * away[i]).sum()).collect();
        let (met, free) = if axes == "local" { (&local, &away) } else { (&away, &local) };
        assert!(met[0].hypot(met[1]) < 2e-6 && met[2].abs() > 0.02, "{axes}: {met:?}");
        assert!(free[0].hypot(free[1]) > 1e-3, "{axes}: {free:?}");
    }
}

fn distance_from(start: &[f64], found: &Value) -> f64 {
    let q = numbers(&found["q"]);
    q.iter().zip(start).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn the_nearest_solution() {
    let start = [0.5, -1.0, 0.4, -2.0, 1.0, 1.5, -0.7];
    let from = list(&start);
    let search = ["ik", "panda", "--to", "0.3,0.1,0.4", "--q", &from];
    let any = distance_from(&start, &json(&search, 0));
    let nearest = distance_from(&start, &json(&[&search[..], &["--nearest"]].concat(), 0));
    assert!(nearest < any - 0.1, "{nearest} {any}");
}

/// The inverse of a metric M has columns orthogonal in M to the null
/// space, and without one in the unit metric.
#[test]
fn the_metric_of_a_hyperbolic_inverse() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twists.csv");
    // Two screws of pitch 0.2 and 0.3 on one axis, each of them twice: a null space of two.
    std::fs::write(&path, "0,0,0.2,0,0,1\n0,0,0.4,0,0,2\n0,0,0.3,0,0,1\n0,0,-0.3,0,0,-1\n")
        .unwrap();
    let path = path.to_str().unwrap();
    let null_space = [[2.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0]];
    for (metric, weights) in [(None, [1.0; 4]), (Some("1,2,3,4"), [1.0, 2.0, 3.0, 4.0])] {
        let mut words = vec!["screws", path, "--h", "0.1", "--twist", "0,0,0.7,0,0,3"];
        words.extend(metric.iter().flat_map(|m| ["--joint-metric", m]));
        let found = json(&words, 0);
        let velocities = numbers(&found["inverses"][0]["velocities"]["joint_velocities"]);
        for of in null_space {
            let product: f64 = (0..4).map(|i| of[i] * weights[i] * velocities[i]).sum();
            assert!(product.abs() < 1e-9, "{metric:?}: {velocities:?}");
        }
        let rotation = velocities[0] + 2.0 * velocities[1] + velocities[2] - velocities[3];
        assert!((rotation - 3.0).abs() < 1e-9, "{velocities:?}");
    }
}

/// An efficiency is the norm of forces over that of torques, squared.
#[test]
fn the_weights_of_internal_forces() {
    let finite = |more: &[&str]| {
        numbers(
            &json(&[&["manipulability", "two-arm"], more].concat(), 0)["internal_force"]["finite"],
        )
    };
    let usual = finite(&["--wt", "1"]);
    for (weighted, plain) in finite(&["--wt", "4"]).iter().zip(&usual) {
        assert!((weighted / plain - 4.0).abs() < 1e-9, "{weighted} {plain}");
    }
}

#[test]
fn iterations_end_a_search() {
    // Far enough for one iteration and the refinement after it not to arrive.
    let search = ["ik", "youbot", "--to", "-0.3,0.1,0.1", "--iterations"];
    for (limit, code) in [("1", 1), ("2", 1), ("100", 0)] {
        let found = json(&[&search[..], &[limit]].concat(), code);
        let used = found["iterations"].as_u64().unwrap();
        assert!(used == limit.parse::<u64>().unwrap() || (code == 0 && used < 100), "{found}");
    }
}

/// Directions that the inverse truncates belong to the null space or not.
#[test]
fn null_space_of_truncated_directions() {
    let target = ["move", "ur5e", "--to", "-0.3,0.2,0.4", "--rpy", "3,0,0.5", "--eps", "0.5"];
    let more = ["--secondary", "centring", "--time-limit", "1", "--null-space"];
    let [exact, retained] = ["exact", "retained"]
        .map(|choice| numbers(&json(&[&target[..], &more, &[choice]].concat(), 1)["q"]));
    assert!(difference(&exact, &retained) > 0.1, "{exact:?} {retained:?}");
}

/// Every parameter of every inverse that `jacobian` offers: of methods near the singularity of a
/// wrist, of hyperbolic inverses for five joints.
#[test]
fn parameters_of_inverses() {
    let mut seen = 0;
    for inverse in NamedInverse::all().filter(|i| !i.takes_complement) {
        let (model, q) = match inverse.is_partial {
            true => ("youbot", vec![0.4, 0.6, 0.9, 0.5, 0.2]),
            false => ("ur5e", vec![0.3, -1.2, 1.4, 0.2, 0.01, 0.4]),
        };
        let arm = catalogue::load(model).unwrap();
        let (state, text) = (arm.state(&q).unwrap(), list(&q));
        for changed in inverse.parameters {
            let parameters: Vec<(&str, f64)> = inverse
                .parameters
                .iter()
                .map(|p| (p.name, p.default * if p.name == changed.name { 5.0 } else { 1.0 }))
                .collect();
            let mut words: Vec<String> =
                ["jacobian", model, "--q", &text, "--inverse", inverse.name]
                    .map(str::to_owned)
                    .into();
            for (name, value) in &parameters {
                words.extend([format!("--{}", name.replace('_', "-")), value.to_string()]);
            }
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let found = &json(&words, 0)["inverse"];
            let matrix = |parameters| {
                let selection =
                    InverseSelection { name: inverse.name, parameters, ..Default::default() };
                let choice = selection.choice(arm.reach()).unwrap();
                let reference = ReferenceFrame::LocalWorldAligned;
                choice.inverse(&state, arm.tool(), reference, None).unwrap().matrix.to_rows()
            };
            let rows = |value: &Value| {
                value.as_array().unwrap().iter().flat_map(numbers).collect::<Vec<f64>>()
            };
            let expected = matrix(parameters.clone()).concat();
            let place = format!("{} {}", inverse.name, changed.name);
            let usual = inverse.parameters.iter().map(|p| (p.name, p.default)).collect();
            assert!(difference(&matrix(usual).concat(), &expected) > 1e-7, "no effect of {place}");
            assert!(difference(&rows(&found["matrix"]), &expected) < 1e-9, "{place}");
            assert_eq!(found["parameters"][changed.name], changed.default * 5.0, "{place}");
            seen += 1;
        }
    }
    assert!(seen >= 10, "{seen}");
}

const MOVE: [&str; 4] = ["move", "panda", "--to", "0.4,0.1,0.4"];

/// An error falls by the gain: four times as large, it needs a quarter of the time. Steps of `--dt`
/// fill that time.
#[test]
fn gain_and_time_between_steps() {
    let moved = |flags: &[&str]| {
        let report = json(&[&MOVE[..], flags].concat(), 0);
        (report["time"].as_f64().unwrap(), report["steps"].as_f64().unwrap())
    };
    let ((slow, _), (fast, _)) = (moved(&["--gain", "2"]), moved(&["--gain", "8"]));
    assert!((slow / fast - 4.0).abs() < 0.5, "{slow} {fast}");
    let [(fine, many), (coarse, few)] = ["0.001", "0.004"].map(|dt| moved(&["--dt", dt]));
    assert!((fine - 0.001 * many).abs() < 1e-9 && (coarse - 0.004 * few).abs() < 1e-9);
    assert!((fine - coarse).abs() < 0.1, "{fine} {coarse}");
}

#[test]
fn a_heavy_joint_stays() {
    let first = |flags: &[&str]| numbers(&json(&[&MOVE[..], flags].concat(), 0)["q"])[0];
    assert!(first(&[]) > 0.05 && first(&["--joint-weights", "1e4,1,1,1,1,1,1"]).abs() < 1e-3);
}

#[test]
fn targets_by_their_rotation_vector() {
    let vector = Vec3::new(0.3, -2.9, 0.4);
    let columns = Rotation::exp(vector).matrix().cols.map(Vec3::to_array);
    for words in [&["0.3,-2.9,0.4"][..], &["17.188733853924695,-166.15775,22.918312", "--degrees"]]
    {
        let target = ["ik", "panda", "--to", "0.4,0.1,0.4", "--rotation-vector"];
        let found = json(&[&target[..], words].concat(), 0);
        let pose = &json(&["fk", "panda", "--q", &list(&numbers(&found["q"]))], 0)["pose"];
        for (i, row) in pose["matrix"].as_array().unwrap()[..3].iter().enumerate() {
            let wanted = columns.map(|column| column[i]);
            assert!(difference(&numbers(row)[..3], &wanted) < 2e-6, "{pose}");
        }
    }
}
