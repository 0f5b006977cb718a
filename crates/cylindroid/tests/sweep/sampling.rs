//! Configuration i is a function of i.

use std::path::Path;

use cylindroid::Mechanism;
use cylindroid::sweep::{Axis, Quantity, Source, Sweep, SweepOptions};

use crate::{configurations, of, samples};

/// One point in each of 2^m intervals of each coordinate, whatever the seed.
#[test]
fn every_prefix_is_a_net() {
    let robot = cylindroid::load("panda").unwrap();
    for seed in [0, 1, u64::MAX] {
        let sweep = of(&robot, Source::Samples { count: 4096, seed }, &[]);
        for m in [1_u32, 4, 9, 12] {
            let count = 1_u64 << m;
            for first in [0, 4096 - count] {
                let table = sweep.table(first..first + count).unwrap();
                for c in robot.coordinates() {
                    let (lower, upper) = (c.limits.lower, c.limits.upper);
                    let mut places: Vec<u64> = (table.numbers(&c.name).unwrap().iter())
                        .map(|x| ((x - lower) / (upper - lower) * count as f64) as u64)
                        .collect();
                    places.sort_unstable();
                    assert!(places.into_iter().eq(0..count), "{}: {count} from {first}", c.name);
                }
            }
        }
    }
}

/// In two dimensions too: the first two coordinates have one point in each elementary interval.
#[test]
fn two_dimensions_are_a_net() {
    let robot = cylindroid::load("panda").unwrap();
    let table = samples("panda", 256, &[]).table(0..256).unwrap();
    let unit = |i: usize| {
        let c = &robot.coordinates()[i];
        let (lower, upper) = (c.limits.lower, c.limits.upper);
        let column = table.numbers(&c.name).unwrap();
        column.iter().map(|x| (x - lower) / (upper - lower)).collect::<Vec<f64>>()
    };
    let (a, b) = (unit(0), unit(1));
    for k in 0..=8 {
        let (wide, high) = (f64::from(1 << k), f64::from(256 >> k));
        let mut cells: Vec<u64> =
            a.iter().zip(&b).map(|(x, y)| ((x * wide) as u64) * 256 + (y * high) as u64).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 256, "{wide} by {high}");
    }
}

#[test]
fn seeds_give_other_samples() {
    let robot = cylindroid::load("ur5e").unwrap();
    let [a, b] =
        [0, 1].map(|seed| of(&robot, Source::Samples { count: 10, seed }, &[]).table(0..10));
    assert_ne!(a.unwrap(), b.unwrap());
}

/// Joints without limits turn through [-pi, pi); sliders without limits are named.
#[test]
fn joints_without_limits() {
    let arm = |slider: &str| {
        format!(
            "name = \"arm\"\n[[joint]]\nname = \"a\"\ntype = \"revolute\"\nbetween = [\"ground\", \
             \"one\"]\norigin = [0, 0, 0]\naxis = [0, 0, 1]\n[[joint]]\nname = \"b\"\ntype = \
             \"prismatic\"\nbetween = [\"one\", \"two\"]\norigin = [1, 0, 0]\naxis = [1, 0, \
             0]\n{slider}"
        )
    };
    let bounded =
        cylindroid::load_text(&arm("limits = { lower = -2, upper = 1 }"), Path::new("arm.toml"));
    let bounded = bounded.unwrap();
    let table = of(&bounded, Source::Samples { count: 1024, seed: 0 }, &[]).table(0..1024).unwrap();
    let a = table.numbers("a").unwrap();
    let (least, most) = a.iter().fold((9.0_f64, -9.0_f64), |(l, m), x| (l.min(*x), m.max(*x)));
    let turn = std::f64::consts::PI;
    assert!(least >= -turn && least < 0.01 - turn && most < turn && most > turn - 0.01);
    assert!(table.numbers("b").unwrap().iter().all(|x| (-2.0..=1.0).contains(x)));
    let free = cylindroid::load_text(&arm(""), Path::new("arm.toml")).unwrap();
    let source = Source::Samples { count: 4, seed: 0 };
    let error = Sweep::new(&free, SweepOptions { source, ..Default::default() }).unwrap_err();
    assert!(error.to_string().contains("coordinate 'b' has no position limits"), "{error}");
}

/// Spherical joints: rotations whose matrices have mean zero.
#[test]
fn rotations_are_uniform() {
    use cylindroid::model::{JointKind, JointSpec};
    let mut builder = Mechanism::builder("ball");
    builder.joint(JointSpec::new("ball", JointKind::Spherical, "ground", "link"));
    let ball = builder.build().unwrap();
    let source = Source::Samples { count: 4096, seed: 3 };
    let table = of(&ball, source, &[Quantity::Pose]).table(0..4096).unwrap();
    let mut mean = [0.0_f64; 9];
    for q in configurations(&ball, &table) {
        let r = cylindroid::Rotation::exp(cylindroid::Vec3::new(q[0], q[1], q[2])).matrix();
        let rows = r.to_rows();
        for (m, x) in mean.iter_mut().zip(rows.as_flattened()) {
            *m += x / 4096.0;
        }
    }
    assert!(mean.iter().all(|m| m.abs() < 2e-3), "{mean:?}");
}

#[test]
fn grids_have_their_last_axis_first() {
    let robot = cylindroid::load("panda").unwrap();
    let axis = |name: &str, from: f64, to: f64, count: u64| Axis {
        name: name.to_owned(),
        from,
        to,
        count,
    };
    let axes = vec![axis("panda_joint1", -1.0, 1.0, 3), axis("panda_joint4", -2.0, -1.0, 5)];
    let grid = |axes: Vec<Axis>| Source::Grid { axes, rest: vec![] };
    let sweep = of(&robot, grid(axes), &[Quantity::Yoshikawa]);
    assert_eq!(sweep.rows(), 15);
    let rows = configurations(&robot, &sweep.table(0..15).unwrap());
    assert_eq!((rows[0][0], rows[0][3], rows[1][3]), (-1.0, -2.0, -1.75));
    assert_eq!((rows[14][0], rows[14][3], rows[5][0]), (1.0, -1.0, 0.0));
    assert_eq!(rows[7][1], robot.home()[1]);
    let refused = |axes: Vec<Axis>| {
        let options = SweepOptions { source: grid(axes), ..Default::default() };
        Sweep::new(&robot, options).unwrap_err().to_string()
    };
    assert!(refused(vec![axis("panda_joint9", 0.0, 1.0, 2)]).contains("nearest: panda_joint"));
    assert!(refused(vec![axis("panda_joint1", 0.0, 1.0, 0)]).contains("one value"));
    assert!(refused(vec![axis("panda_joint1", 0.0, f64::NAN, 2)]).contains("not finite"));
    assert!(refused(vec![]).contains("one axis"));
    let huge = || axis("panda_joint1", 0.0, 1.0, 1 << 45);
    assert!(refused(vec![huge()]).contains("more than 10 000 000 parts"));
    assert!(refused(vec![huge(), axis("panda_joint2", 0.0, 1.0, 9)]).contains("2^48"));
    let many = of(&robot, grid(vec![axis("panda_joint1", 0.0, 1.0, 1 << 35)]), &[]);
    assert!(many.collect(None, |_| true).unwrap_err().to_string().contains("too many for memory"));
    let two = axis("panda_joint1", 0.0, 1.0, 2);
    assert!(refused(vec![two.clone(), two]).contains("one axis only"));
}

/// Closed chains have no grids of their coordinates; closed configurations of theirs are swept.
#[test]
fn closed_chains_need_configurations() {
    let five_bar = cylindroid::load("five-bar").unwrap();
    let axis = Axis { name: "q1".to_owned(), from: 0.0, to: 1.0, count: 3 };
    let source = Source::Grid { axes: vec![axis], rest: vec![] };
    let quantities = vec![Quantity::Measures];
    let options = SweepOptions { source, quantities, ..Default::default() };
    let error = Sweep::new(&five_bar, options).unwrap_err();
    assert!(error.to_string().contains("loops leave no free choice"), "{error}");
    let source = Source::Configurations(five_bar.home().to_vec());
    let table = of(&five_bar, source, &[Quantity::Measures]).table(0..1).unwrap();
    assert_eq!(table.column("dof"), Some(&cylindroid::sweep::Values::Counts(vec![2])));
}
