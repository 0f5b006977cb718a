//! Rows are the same whatever others are computed with them.

use cylindroid::model::JointLimits;
use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions};

use crate::{bits, of};

pub(crate) fn in_any_order(sweep: &Sweep) {
    let rows = sweep.rows();
    let whole = bits(&sweep.table(0..rows).unwrap());
    // From the end, in pieces of many lengths: rows come to lie in every lane and every tail.
    let (mut end, mut length) = (rows, 1);
    while end > 0 {
        let start = end.saturating_sub(length);
        let piece = bits(&sweep.table(start..end).unwrap());
        for (column, own) in whole.iter().zip(&piece) {
            let (a, b) = (usize::try_from(start).unwrap(), usize::try_from(end).unwrap());
            assert_eq!(column[a..b], own[..], "rows {start} to {end}");
        }
        (end, length) = (start, (length * 5 + 2) % 701);
    }
}

#[test]
fn rows_are_functions_of_their_index() {
    let effort = JointLimits { effort: Some(10.0), ..JointLimits::default() };
    for model in ["panda", "ur5e", "3r"] {
        let robot = cylindroid::load(model).unwrap();
        let robot = match model {
            // Payloads need them.
            "3r" => {
                robot.with_limits(&["joint1", "joint2", "joint3"].map(|j| (j, effort))).unwrap()
            }
            _ => robot,
        };
        // Distances of collision shapes, which these have none of, are in clearances.rs.
        let all: Vec<Quantity> = Quantity::ALL
            .into_iter()
            .filter(|q| !matches!(q, Quantity::SelfDistance | Quantity::ObstacleDistance))
            .collect();
        for (count, quantities) in [(5000, &all[..7]), (300, &all[..])] {
            in_any_order(&of(&robot, Source::Samples { count, seed: 7 }, quantities));
        }
    }
}

#[test]
fn rows_of_a_closed_chain_are_functions_of_their_index() {
    let stewart = cylindroid::load("stewart").unwrap();
    let mut q = Vec::new();
    for i in 0..400 {
        let mut guess = stewart.home().to_vec();
        guess.iter_mut().enumerate().for_each(|(k, x)| *x += 0.03 * f64::sin((i * 7 + k) as f64));
        q.extend(cylindroid::closure::assemble(&stewart, &guess, &[]).unwrap().q);
    }
    in_any_order(&of(&stewart, Source::Configurations(q), &[Quantity::Pose, Quantity::Measures]));
}

#[test]
fn collected_rows_are_those_of_the_table() {
    let options = SweepOptions {
        source: Source::Samples { count: 1000, seed: 2 },
        quantities: vec![Quantity::Pose, Quantity::GibsonHunt],
        part_rows: 77,
        ..Default::default()
    };
    let sweep = Sweep::new(&cylindroid::load("youbot").unwrap(), options).unwrap();
    let expected = bits(&sweep.table(0..1000).unwrap());
    for threads in [1, 3] {
        let found = sweep.collect(threads.try_into().ok(), |_| true).unwrap().unwrap();
        assert_eq!(bits(&found), expected);
    }
    assert!(sweep.collect(None, |_| false).unwrap().is_none());
}
