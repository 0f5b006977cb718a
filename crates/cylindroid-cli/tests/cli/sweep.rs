//! Sweeps: statistics, files, killed and interrupted processes.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::distance::CELL;
use crate::{json, numbers, refused, text};

/// A column of statistics.
fn column<'a>(report: &'a Value, name: &str) -> &'a Value {
    report["columns"].as_array().unwrap().iter().find(|c| c["name"] == name).unwrap()
}

#[test]
fn statistics_of_samples_and_grids() {
    let sweep = ["sweep", "panda", "--samples", "2e3", "--quantities", "pose,limit_distance"];
    let report = json(&sweep, 0);
    assert_eq!((&report["rows"], &report["frame"]), (&2000.into(), &"hand_tcp".into()));
    let distance = column(&report, "limit_distance");
    assert!(distance["smallest"].as_f64().unwrap() > 0.0, "samples are within the limits");
    let joint = column(&report, "panda_joint4");
    let middle = -0.5 * (3.0718 + 0.0698); // of its limits
    assert!((joint["mean"].as_f64().unwrap() - middle).abs() < 1e-3, "{joint}");
    assert!(text(&sweep).contains("panda_joint4"));

    let grid = ["sweep", "ur5e", "--over", "elbow_joint=-1:1:3", "--over", "wrist_1_joint=0:1:2"];
    let report = json(&grid, 0);
    assert_eq!(report["rows"], 6);
    assert_eq!(report["configurations"], "grid of 3 x 2");
    assert_eq!(column(&report, "elbow_joint")["mean"], 0.0);

    let classes = ["sweep", "youbot", "--samples", "100", "--quantities", "gibson_hunt"];
    let names = column(&json(&classes, 0), "gibson_hunt")["names"].clone();
    let count: u64 = names.as_array().unwrap().iter().map(|n| n["count"].as_u64().unwrap()).sum();
    assert_eq!(count, 100);
}

/// The payload of a direction, and of a task the measures.
#[test]
fn payloads_and_tasks() {
    let stretched = ["sweep", "panda", "--samples", "64", "--quantities", "payload"];
    let column = |extra: &[&str]| {
        let report = json(&[&stretched[..], extra].concat(), 0);
        let columns = report["columns"].as_array().unwrap();
        let own = columns.iter().find(|c| c["name"] == "payload").unwrap();
        assert_eq!(own["unit"], "N");
        own["smallest"].as_f64().unwrap()
    };
    let down = column(&[]);
    assert!(down > 0.0 && down == column(&["--direction", "0,0,2"]));
    assert!(down != column(&["--direction", "1,0,0"]));
    let message = refused(&[&stretched[..], &["--direction", "0,0,0"]].concat());
    assert!(message.contains("no length"), "{message}");
    let of_task = ["sweep", "3r", "--over", "joint3=-1:1:3", "--task", "x,y,z"];
    let report = json(&[&of_task[..], &["--quantities", "measures"]].concat(), 0);
    let columns = report["columns"].as_array().unwrap();
    let type_i = columns.iter().find(|c| c["name"] == "type_i").unwrap();
    // Straight in the middle.
    assert_eq!(type_i["smallest"], 0.0);
    assert!(type_i["largest"].as_f64().unwrap() > 0.05);
}

/// Columns by the names of the joints, in any order, in CSV and Parquet.
#[test]
fn configurations_of_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (parts, turned) = (at("parts"), at("turned.csv"));
    let sweep = ["sweep", "youbot", "--samples", "300", "--quantities", "pose"];
    text(&[&sweep[..], &["--out", &parts]].concat());
    let part = format!("{parts}/part-000000.parquet");
    let csv = at("samples.csv");
    text(&[&sweep[..], &["--out", &csv]].concat());
    // The columns of a CSV file from the last to the first.
    let lines = fs::read_to_string(&csv).unwrap();
    let turn = |line: &str| line.split(',').rev().collect::<Vec<_>>().join(",");
    fs::write(&turned, lines.lines().map(turn).collect::<Vec<_>>().join("\n")).unwrap();
    let of = |file: &str| {
        let sweep = ["sweep", "youbot", "--configurations", file, "--quantities", "pose"];
        json(&sweep, 0)["columns"].clone()
    };
    let expected = json(&sweep, 0)["columns"].clone();
    assert_eq!(of(&part), expected);
    assert_eq!(of(&turned), expected);
    let found = ["manipulability", "youbot", "--configurations", &part];
    assert_eq!(json(&found, 0)["rows"].as_array().unwrap().len(), 300);
    let message = refused(&["sweep", "panda", "--configurations", &part]);
    assert!(message.contains("no column 'panda_joint1' among index, arm_joint_1"), "{message}");
    // Arrow files are Python's: the error says how they are converted.
    let arrow = at("samples.arrow");
    let missing = refused(&["sweep", "panda", "--configurations", &arrow]);
    assert!(!missing.contains("Arrow"), "{missing}");
    fs::write(&arrow, "ARROW1").unwrap();
    for command in ["sweep", "manipulability"] {
        let message = refused(&[command, "panda", "--configurations", &arrow]);
        for part in ["cy.sweep", "pyarrow.ipc.open_file", "samples.parquet"] {
            assert!(message.contains(part), "{message}");
        }
    }
}

/// Poses of a sweep are reached again, one farther away is not; positions alone without quaternions.
#[test]
fn poses_of_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, far, places) = (at("poses.csv"), at("far.csv"), at("places.csv"));
    text(&["sweep", "panda", "--samples", "20", "--quantities", "pose", "--out", &csv]);
    let of = |file: &str, more: &[&str]| {
        let sweep = ["sweep", "panda", "--poses", file, "--quantities", "limit_distance"];
        json(&[&sweep[..], more].concat(), 0)
    };
    let report = of(&csv, &[]);
    assert_eq!(report["configurations"], "20 poses of a file");
    assert_eq!(column(&report, "reached")["mean"], 1.0);
    assert!(column(&report, "limit_distance")["smallest"].as_f64().unwrap() >= 0.0);
    fs::write(&far, "x,y,z,qw,qx,qy,qz\n0.4,0,0.4,0,1,0,0\n4,0,0.4,0,1,0,0\n").unwrap();
    let report = of(&far, &[]);
    assert_eq!(column(&report, "reached")["mean"], 0.5);
    assert_eq!(column(&report, "limit_distance")["not_finite"], 1);
    fs::write(&places, "0.4,0,0.4\n0,0.5,0.5\n").unwrap();
    assert_eq!(column(&of(&places, &["--task", "position"]), "reached")["mean"], 1.0);
    let message = refused(&["sweep", "panda", "--poses", &places]);
    assert!(message.contains("line 1 has 3 numbers, not 7 (x, y, z, qw"), "{message}");
    // The motion of a robot with sliders x, y, z: the columns of the tool.
    let motion = at("motion.csv");
    fs::write(&motion, "q.x,q.y,q.z,x,y,z\n9,9,9,0.4,0,0.4\n").unwrap();
    assert_eq!(column(&of(&motion, &["--task", "position"]), "reached")["mean"], 1.0);
    let both = refused(&["sweep", "panda", "--poses", &places, "--samples", "3"]);
    assert!(both.contains("--samples"), "{both}");
    let axis = ["sweep", "panda", "--poses", &places, "--over", "panda_joint1=0:1:2"];
    assert!(refused(&axis).contains("--poses"));
}

/// Samples of a closed chain, of which some have no path from home.
#[test]
fn samples_of_closed_chains() {
    let sweep = ["sweep", "five-bar", "--samples", "60", "--quantities", "pose,measures"];
    let report = json(&sweep, 0);
    let closed = column(&report, "closed")["mean"].as_f64().unwrap();
    let lost = column(&report, "q4")["not_finite"].as_f64().unwrap();
    assert!(lost > 0.0 && (closed - (1.0 - lost / 60.0)).abs() < 1e-12, "{closed} {lost}");
    assert_eq!(column(&report, "dof")["largest"], 2.0);
}

/// Number of parts of [`start`].
const PARTS: usize = 120;

fn start(folder: &Path, resume: bool) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cylindroid"));
    command
        .args(["sweep", "youbot", "--samples", "60000", "--part-rows", "500", "--threads", "2"])
        .args(["--quantities", "pose,yoshikawa,gibson_hunt", "--out"])
        .arg(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if resume {
        command.arg("--resume");
    }
    command
}

/// The manifest, which has the checksums of all parts.
fn manifest(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("manifest.json")).unwrap()).unwrap()
}

/// The number of parts that a manifest lists; zero where there is none.
fn listed(folder: &Path) -> usize {
    if folder.join("manifest.json").exists() {
        manifest(folder)["parts"].as_array().unwrap().len()
    } else {
        0
    }
}

/// Killed ten times while it writes parts, at moments that a generator chooses: each run goes on with the
/// parts of those before, and at the end they are those of an uninterrupted run.
#[test]
fn killed_processes_are_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, own) = (folder.path().join("whole"), folder.path().join("own"));
    assert!(start(&whole, false).status().unwrap().success());
    let (mut random, mut before, mut kills) = (12_345_u64, 0, 0);
    'runs: for run in 0..10 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let mut child = start(&own, own.join("manifest.json").exists()).spawn().unwrap();
        while listed(&own) == before {
            if child.try_wait().unwrap().is_some() {
                break 'runs; // a machine that is faster than ten kills
            }
            sleep(Duration::from_millis(1));
        }
        sleep(Duration::from_millis((random >> 33) % 30));
        child.kill().unwrap();
        child.wait().unwrap();
        let parts = listed(&own);
        assert!(parts > before, "run {run}: {parts} parts after {before}");
        kills += usize::from(parts < PARTS);
        before = parts;
    }
    assert!(kills >= 3, "{kills} kills while parts were missing");
    assert!(start(&own, true).status().unwrap().success());
    let (a, b) = (manifest(&own), manifest(&whole));
    assert_eq!(a["complete"], true);
    assert_eq!(a["parts"].as_array().unwrap().len(), PARTS);
    assert_eq!(a, b);
    for part in a["parts"].as_array().unwrap() {
        let name = part["file"].as_str().unwrap();
        assert!(fs::read(own.join(name)).unwrap() == fs::read(whole.join(name)).unwrap());
    }
}

/// Forms of the kernels that round otherwise are another recipe; four and eight lanes are the same.
#[cfg(target_arch = "x86_64")]
#[test]
fn arithmetic_is_part_of_the_recipe() {
    let folder = tempfile::tempdir().unwrap();
    let run = |simd: &str, name: &str, more: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_cylindroid"))
            .args(["sweep", "panda", "--samples", "100", "--quantities", "pose", "--out"])
            .arg(folder.path().join(name))
            .args(more)
            .env("CYLINDROID_SIMD", simd)
            .output()
            .unwrap()
    };
    for simd in ["scalar", "avx2", "avx512"] {
        assert!(run(simd, simd, &[]).status.success());
    }
    let [plain, four, eight] =
        ["scalar", "avx2", "avx512"].map(|s| manifest(&folder.path().join(s)));
    assert_eq!(four, eight);
    assert!(run("avx2", "avx512", &["--resume"]).status.success());
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        assert_ne!(four, plain);
        let message = String::from_utf8(run("avx2", "scalar", &["--resume"]).stderr).unwrap();
        assert!(message.contains("arithmetic is \"x86_64\" there and"), "{message}");
    }
}

/// Ctrl-C ends a run in order.
#[cfg(unix)]
#[test]
fn interrupted_processes_are_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    let mut child = start(&own, false).spawn().unwrap();
    while !own.join("part-000003.parquet").exists() {
        sleep(Duration::from_millis(1));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let code = child.wait().unwrap().code();
    let parts = manifest(&own)["parts"].as_array().unwrap().len();
    assert!(code == Some(130) && (4..PARTS).contains(&parts), "{code:?}, {parts} parts");
    assert!(start(&own, true).status().unwrap().success());
    assert_eq!(manifest(&own)["complete"], true);
}

/// With a limit on the size of files, which is an error of writing as a full disk is.
#[cfg(unix)]
pub(crate) fn limited(blocks: u32, arguments: &[&str]) -> std::process::Output {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_cylindroid")])
        .args(arguments)
        .output()
        .unwrap()
}

/// Where a part or the manifest cannot be written, the parts before it stay, the error says so, and a run
/// with room goes on to the bytes of an uninterrupted one.
#[cfg(unix)]
#[test]
fn full_disks_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // Parts of 60 kB, beside whose first ones there is no room for others; 600 parts of 3 kB, whose
    // manifest has no room. Blocks have 512 or 1024 bytes.
    for (name, rows, part_rows, blocks, file) in
        [("parts", "8000", "400", 24, "part-"), ("manifest", "2400", "4", 60, "manifest.json")]
    {
        let [whole, own] = ["whole", "own"].map(|run| folder.path().join(format!("{name}-{run}")));
        let of = |folder: &Path| {
            let sweep = ["sweep", "youbot", "--samples", rows, "--part-rows", part_rows];
            let more = ["--quantities", "pose,yoshikawa", "--threads", "2", "--out"];
            let all = [&sweep[..], &more, &[folder.to_str().unwrap()]].concat();
            all.into_iter().map(str::to_owned).collect::<Vec<_>>()
        };
        let run = |folder: &Path, resume: bool| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_cylindroid"));
            command.args(of(folder)).stdout(Stdio::null()).stderr(Stdio::null());
            if resume {
                command.arg("--resume");
            }
            command
        };
        assert!(run(&whole, false).status().unwrap().success());
        let mut arguments = of(&own);
        let mut kept = Vec::new();
        if name == "parts" {
            // Some parts are there.
            let mut child = run(&own, false).spawn().unwrap();
            while listed(&own) < 2 && child.try_wait().unwrap().is_none() {
                sleep(Duration::from_millis(1));
            }
            child.kill().unwrap();
            child.wait().unwrap();
            let mut all = manifest(&own);
            kept = all["parts"].as_array().unwrap()[..2].to_vec();
            // On a machine that was faster, the others are gone.
            for part in all["parts"].as_array_mut().unwrap().drain(2..) {
                fs::remove_file(own.join(part["file"].as_str().unwrap())).unwrap();
            }
            all["complete"] = false.into();
            fs::write(own.join("manifest.json"), all.to_string()).unwrap();
            arguments.push("--resume".to_owned());
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = limited(blocks, &arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("cannot write") && message.contains(file), "{message}");
        assert!(message.contains("finished parts are kept, --resume continues"), "{message}");
        let after = manifest(&own);
        assert_eq!(after["complete"], false);
        let parts = after["parts"].as_array().unwrap();
        assert!(kept.iter().all(|part| parts.contains(part)));
        for part in parts {
            let path = own.join(part["file"].as_str().unwrap());
            assert_eq!(Some(fs::metadata(path).unwrap().len()), part["bytes"].as_u64());
        }
        let names = fs::read_dir(&own).unwrap().map(|entry| entry.unwrap().file_name());
        let half = names.filter(|name| name.to_string_lossy().starts_with(".part-"));
        assert_eq!(half.count(), 0, "parts that were not finished give their room back");
        assert!(run(&own, true).status().unwrap().success());
        assert_eq!(manifest(&own), manifest(&whole));
        for part in manifest(&own)["parts"].as_array().unwrap() {
            let file = part["file"].as_str().unwrap();
            assert!(fs::read(own.join(file)).unwrap() == fs::read(whole.join(file)).unwrap());
        }
    }
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let some = ["sweep", "panda", "--samples", "10"];
    let with = |more: &[&str]| refused(&[&some[..], more].concat());
    assert!(with(&["--quantities", "poze"]).contains("--quantities: no quantity named 'poze'"));
    assert!(with(&["--task", "w"]).contains("--task: no task or task component named 'w'"));
    assert!(with(&["--over", "a=0:1:2"]).contains("--over: no coordinate named 'a'"));
    assert!(with(&["--over", "panda_joint1=0:1:2"]).contains("--samples"));
    assert!(with(&["--resume"]).contains("--out"));
    text(&[&some[..], &["--out", out]].concat());
    assert!(with(&["--out", out]).contains("it has a sweep already"));
    let other = with(&["--seed", "3", "--out", out, "--resume"]);
    assert!(other.contains("configurations.seed is 0 there and 3 now"), "{other}");
    let none = refused(&["sweep", "panda"]);
    assert!(none.contains("--samples"), "{none}");
    let closed = refused(&["sweep", "five-bar", "--over", "q1=0:1:3", "--quantities", "measures"]);
    assert!(closed.contains("--over = five-bar") && closed.contains("assemble"), "{closed}");
    let axis = refused(&["sweep", "panda", "--over", "panda_joint1=0:1"]);
    assert!(axis.contains("name=first:last:number"), "{axis}");
}

const DESIGNS: &str = "../../docs/designs.toml";

#[test]
fn designs_by_grid_and_samples() {
    let sweep = ["sweep", DESIGNS, "--quantities", "pose,measures"];
    let grid = ["--over", "crank=0.4:0.7:4", "--over", "point_x=-0.1:0.1:3"];
    let report = json(&[&sweep[..], &grid].concat(), 0);
    assert_eq!(
        (&report["rows"], &report["configurations"]),
        (&12.into(), &"home of 12 designs".into())
    );
    assert_eq!(column(&report, "crank")["largest"], 0.7);
    assert_eq!(column(&report, "crank")["unit"], "m");
    assert_eq!(column(&report, "design")["largest"], 11.0);
    assert_eq!(column(&report, "design_valid")["smallest"], 1.0);
    let samples = ["--vary", "rod=0.1:1", "--designs", "64", "--seed", "5"];
    let report = json(&[&sweep[..], &samples].concat(), 0);
    assert_eq!(report["rows"], 64);
    let share = column(&report, "design_valid")["mean"].as_f64().unwrap();
    assert!(share > 0.3 && share < 0.8, "{share}");
    let other = json(&[&sweep[..], &samples[..4], &["--seed", "6"]].concat(), 0);
    assert_ne!(column(&report, "rod")["mean"], column(&other, "rod")["mean"]);
    // Values of --parameter are those of all designs.
    let fixed = [&sweep[..], &grid, &["--parameter", "point_y=0.9"]].concat();
    let y = column(&json(&fixed, 0), "y")["mean"].as_f64().unwrap();
    assert!((y - 0.9).abs() < 1e-12, "{y}");

    let refused = |more: &[&str]| refused(&[&["sweep", DESIGNS], more].concat());
    assert!(refused(&["--over", "cranck=0.4:0.7:4"]).contains("no coordinate or parameter"));
    assert!(refused(&["--over", "crank=0.4:3:4"]).contains("its range is 0.05 to 2"));
    assert!(refused(&["--vary", "crank=0.4:1"]).contains("--designs"));
    assert!(refused(&["--vary", "crank=0.4", "--designs", "3"]).contains("name=smallest:largest"));
    let both = ["--over", "rod=0.4:1:3", "--vary", "crank=0.4:1", "--designs", "3"];
    assert!(refused(&both).contains("designs are a grid or samples"));
}

/// Distances to obstacles, as of `distance`, and options that nothing sees.
#[test]
fn distances_to_obstacles() {
    let near_home = ["sweep", CELL, "--over", "panda_joint7=0.78:0.79:2", "--quantities"];
    let least = |obstacle: &str| {
        let own = [&near_home[..], &["obstacle_distance", "--obstacle", obstacle]].concat();
        column(&json(&own, 0), "obstacle_distance")["smallest"].as_f64().unwrap()
    };
    assert!(least("ball=sphere:0.1@0.3,0,0.55") < 0.0);
    let (far, farther) = (least("ball=sphere:0.1@0,0,50"), least("ball=sphere:0.1@0,0,51"));
    assert!(far > 48.0 && (farther - far - 1.0).abs() < 1e-3, "{far} {farther}");
    let with = |extra: &[&str]| refused(&[&near_home[..], extra].concat());
    let ball = ["pose", "--obstacle", "ball=sphere:0.1@0,0,5"];
    assert!(with(&ball).contains("obstacle_distance alone"));
    assert!(with(&["pose", "--meshes", "convex_hull"]).contains("self_distance"));
    assert!(with(&["obstacle_distance"]).contains("no obstacle"));

    // Designs have their own shapes, and no obstacles.
    let designs = ["sweep", DESIGNS, "--over", "crank=0.4:0.5:2", "--quantities"];
    let of_designs = |extra: &[&str]| refused(&[&designs[..], extra].concat());
    let shapes = "each design has the shapes of its own links";
    let ball = ["obstacle_distance", "--obstacle", "ball=sphere:0.1@0,0,5"];
    assert!(of_designs(&ball).contains(shapes));
    let meshes = ["self_distance", "--meshes", "convex_hull"];
    assert!(of_designs(&meshes).contains(shapes));
    assert!(of_designs(&["obstacle_distance"]).contains("designs have no obstacles"));
    let bare = of_designs(&["self_distance"]);
    assert!(bare.contains("self_distance") && bare.contains("collision shape"), "{bare}");
}

pub(crate) const TWO_ARMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/two-arms.toml");

/// One hand as seen from the other: the columns of `jacobian --relative-to`, in statistics, folders and
/// the table, and what has no other frame.
#[test]
fn two_arms_together() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    let seen = ["--frame", "left/hand_tcp", "--relative-to", "right/hand_tcp"];
    let at_home = ["sweep", TWO_ARMS, "--over", "torso=0:1:2", "--quantities"];
    let with = |more: &[&str]| -> Vec<String> {
        [&at_home[..], more, &seen].concat().into_iter().map(str::to_owned).collect()
    };
    let json_with =
        |more: &[&str]| json(&with(more).iter().map(String::as_str).collect::<Vec<_>>(), 0);
    let text_with =
        |more: &[&str]| text(&with(more).iter().map(String::as_str).collect::<Vec<_>>());
    let report = json_with(&["pose,jacobian,singular_values,yoshikawa"]);
    assert_eq!(report["frame"], "left/hand_tcp");
    assert_eq!(report["relative_to"], "right/hand_tcp");
    let single = json(&[&["jacobian", TWO_ARMS][..], &seen].concat(), 0);
    let values = numbers(&single["singular_values"]);
    for (i, value) in values.iter().enumerate() {
        let own = column(&report, &format!("singular_value_{}", i + 1));
        for entry in ["smallest", "largest"] {
            let x = own[entry].as_f64().unwrap();
            assert!((x - value).abs() < 1e-12 * values[0], "{i}: {x} for {value}");
        }
    }
    for (row, name) in ["vx", "vy", "vz", "wx", "wy", "wz"].iter().enumerate() {
        let matrix = numbers(&single["matrix"][row]);
        for (joint, x) in single["joint_names"].as_array().unwrap().iter().zip(matrix) {
            let own = column(&report, &format!("jacobian_{name}_{}", joint.as_str().unwrap()));
            assert!((own["smallest"].as_f64().unwrap() - x).abs() < 1e-12);
        }
    }
    assert!(column(&report, "x")["description"].as_str().unwrap().contains("relative_to"));
    let shown = text_with(&["pose"]);
    assert!(shown.contains("relative to     right/hand_tcp"), "{shown}");
    let out = ["pose", "--out", own.to_str().unwrap()];
    text_with(&out);
    let plot = folder.path().join("hands.svg");
    text_with(&["pose", "--plot", plot.to_str().unwrap()]);
    let drawn = fs::read_to_string(plot).unwrap();
    assert!(drawn.contains("left/hand_tcp relative to right/hand_tcp"), "{drawn:.500}");
    assert_eq!(manifest(&own)["recipe"]["relative_to"], "right/hand_tcp");
    let other = [&at_home[..], &out, &seen[..2], &["--resume", "--relative-to", "chest"]].concat();
    let other = refused(&other);
    assert!(other.contains(r#"relative_to is "right/hand_tcp" there and "chest" now"#), "{other}");
    let refused =
        |more: &[&str]| crate::refused(&with(more).iter().map(String::as_str).collect::<Vec<_>>());
    let measures = refused(&["measures"]);
    assert!(measures.contains("--relative-to") && measures.contains("measures"), "{measures}");
    assert!(refused(&["payload"]).contains("payload"));
    let unknown =
        crate::refused(&[&at_home[..], &["pose", "--relative-to", "right/hand"]].concat());
    assert!(unknown.contains("right/hand_tcp"), "{unknown}");
    let map = ["sweep", TWO_ARMS, "--reach", "x=0:1:2", "--relative-to", "chest"];
    assert!(crate::refused(&map).contains("--relative-to"));
}
