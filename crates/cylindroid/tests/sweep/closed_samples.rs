//! Samples of closed chains: on the branch of home, functions of their index, for designs too.

use std::path::Path;

use cylindroid::closure::{ContinuationOptions, PathEnd, track_path};
use cylindroid::model::JointLimits;
use cylindroid::sweep::{
    Axis, DesignSpace, Quantity, Source, Statistics, Sweep, SweepOptions, Values,
};
use cylindroid::{Mechanism, ParametricModel};

use crate::{bits, configurations, of};

fn limited(name: &str, range: f64) -> Mechanism {
    let robot = cylindroid::load(name).unwrap();
    let names: Vec<String> =
        robot.actuated().map(|c| robot.coordinates()[c].name.clone()).collect();
    let home = robot.home().to_vec();
    let limit = |c: usize| JointLimits {
        lower: Some(home[c] - range),
        upper: Some(home[c] + range),
        ..Default::default()
    };
    let limits: Vec<(&str, _)> =
        names.iter().map(String::as_str).zip(robot.actuated().map(limit)).collect();
    robot.with_limits(&limits).unwrap()
}

/// Actuated coordinates fill their ranges, loops are closed, and what has no path has no numbers.
#[test]
fn samples_are_on_the_branch_of_home() {
    for (model, range) in [("five-bar", 1.2), ("stewart", 0.15), ("four-bar", 3.0)] {
        let robot = limited(model, range);
        let sweep = of(
            &robot,
            Source::Samples { count: 64, seed: 3 },
            &[Quantity::Pose, Quantity::Measures],
        );
        let table = sweep.table(0..64).unwrap();
        let all = configurations(&robot, &table);
        let closed = match table.column("closed").unwrap() {
            Values::Counts(closed) => closed,
            _ => panic!(),
        };
        let x = table.numbers("x").unwrap();
        let actuated: Vec<usize> = robot.actuated().collect();
        let (mut reached, mut lost) = (0, 0);
        for ((q, x), closed) in all.iter().zip(x).zip(closed) {
            if q[0].is_nan() {
                assert!(q.iter().all(|x| x.is_nan()) && x.is_nan() && *closed == 0);
                lost += 1;
                continue;
            }
            let goal: Vec<f64> = actuated.iter().map(|&c| q[c]).collect();
            let options = ContinuationOptions::default();
            let path = track_path(&robot, robot.home(), &actuated, &goal, options).unwrap();
            assert!(path.end == PathEnd::Reached && *closed == 1);
            assert!(path.q.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-9));
            for &c in &actuated {
                assert!((q[c] - robot.home()[c]).abs() <= range);
            }
            reached += 1;
        }
        assert!(reached > 8, "{model}: {reached} of 64, {lost} lost");
        if model == "five-bar" {
            assert!(lost > 0, "{model}");
        }
        // What has no configuration takes no part in statistics.
        let all = sweep.statistics(None, |_| true).unwrap().unwrap();
        let dof = &all.iter().find(|(column, _)| column.name == "dof").unwrap().1;
        let Statistics::Numbers { smallest, mean, not_finite, .. } = *dof else { panic!() };
        assert!(smallest >= 1.0 && mean >= smallest && not_finite == lost, "{model}: {dof:?}");
        let whole = bits(&table);
        for row in 0..64 {
            let one = bits(&sweep.table(row..row + 1).unwrap());
            let place = usize::try_from(row).unwrap();
            assert!(one.iter().zip(&whole).all(|(one, all)| one[0] == all[place]), "{model} {row}");
        }
    }
}

/// Each design has samples of its own, those of its mechanism alone.
#[test]
fn designs_have_samples() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/designs.toml"));
    let text = std::fs::read_to_string(path).unwrap();
    let model = ParametricModel::of_text(&text, path, &[]).unwrap();
    let axis = Axis { name: "crank".to_owned(), from: 0.45, to: 0.6, count: 3 };
    let options = SweepOptions {
        source: Source::Samples { count: 16, seed: 1 },
        quantities: vec![Quantity::Measures],
        ..SweepOptions::default()
    };
    let sweep = Sweep::of_designs(&model, DesignSpace::Grid(vec![axis]), options.clone()).unwrap();
    let table = sweep.table(0..48).unwrap();
    let own = Sweep::new(&model.with(&[("crank", 0.6)]).unwrap(), options).unwrap();
    let own = own.table(0..16).unwrap();
    for name in ["left_drive", "right_elbow", "type_ii"] {
        let (all, own) = (table.numbers(name).unwrap(), own.numbers(name).unwrap());
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        assert!(all[32..].iter().zip(own).all(same), "{name}");
        assert!(own.iter().any(|x| x.is_finite()), "{name}");
    }
}

#[test]
fn samples_need_actuated_coordinates() {
    let refused = |robot: &Mechanism| {
        let source = Source::Samples { count: 4, seed: 0 };
        let options = SweepOptions { source, quantities: vec![], ..SweepOptions::default() };
        Sweep::new(robot, options).unwrap_err().to_string()
    };
    let five_bar = cylindroid::load("five-bar").unwrap();
    let loops = five_bar.with_actuated(&["q1", "q5"]).unwrap();
    if loops.loops().iter().any(|joint| joint.actuated) {
        assert!(refused(&loops).contains("closes a loop"), "{}", refused(&loops));
    }
    let stewart = cylindroid::load("stewart").unwrap();
    let passive = stewart.with_actuated::<&str>(&[]).unwrap();
    assert!(refused(&passive).contains("actuated joints, of which it has 0"));
    let two_arm = cylindroid::load("two-arm").unwrap();
    assert!(refused(&two_arm).contains("which have 8 freedoms"), "{}", refused(&two_arm));
}
