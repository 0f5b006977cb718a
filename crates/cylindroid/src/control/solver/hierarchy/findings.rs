//! Problems on which the solver failed.
//!
//! Checked  tests in this file

use super::super::active_set::{Level, Precision};
use super::optimality;
use super::problem::{Problem, Random};
use crate::linalg::Matrix;

/// Bytes that made the solver fail, and a few at random.
#[test]
fn findings_stay_mended() {
    let of = |folder: &str| -> Vec<Vec<u8>> {
        let folder = format!("{}/tests/data/findings/{folder}", env!("CARGO_MANIFEST_DIR"));
        let entries = std::fs::read_dir(folder).into_iter().flatten();
        entries.map(|entry| std::fs::read(entry.unwrap().path()).unwrap()).collect()
    };
    for bytes in of("solver-guided") {
        optimality::check(&bytes);
    }
    for bytes in of("solver") {
        optimality::check_changed(&bytes, |_| {});
        optimality::check_changed(&bytes, Problem::reverse_and_scale);
    }
    let mut random = Random::seeded(41);
    let (mut unclear, mut unclear_coarse) = (0, 0);
    for _ in 0..2000 {
        let length = random.below(400);
        let bytes: Vec<u8> = (0..length).map(|_| random.below(256) as u8).collect();
        unclear += u32::from(!optimality::check_changed(&bytes, |_| {}));
        optimality::check_changed(&bytes, Problem::reverse_and_scale);
        unclear_coarse += u32::from(!optimality::check(&bytes));
    }
    assert!(unclear <= 4, "{unclear} of 2000 problems have levels that are not looked at");
    assert_eq!(unclear_coarse, 0, "eighths leave ranks unclear");
}

/// A direction that is too weak to take part in steps holds no bound for the levels after it, whatever its
/// unit.
#[test]
fn weak_directions_hold_no_bounds() {
    for (weak, unit) in [1e-7, 1e-8, 0.0].into_iter().flat_map(|w| [1.0, 1e6, 1e-6].map(|u| (w, u)))
    {
        let row = |i: usize| (0..3).map(|j| if i == j { unit } else { 0.0 }).collect();
        let (lower, upper) = (vec![-unit; 3], vec![0.0, 0.0, unit]);
        let (boxed, rows) = (unit == 1.0, (0..3).map(row).collect());
        let problem = Problem { n: 3, boxed, rows, lower, upper, levels: Vec::new() };
        let mut set = problem.active_set();
        // At the upper bounds of the first two.
        assert!(set.start(&[5.0, 5.0, 0.0]));
        for (row, target) in [([1.0, weak, weak], 1.0), ([0.0, 1.0, 0.0], -0.5)] {
            let mut level = Level::new(1, 3);
            level.rows = Matrix::from_fn(1, 3, |_, j| row[j]);
            level.target[0] = target;
            set.solve(&mut level, Precision::STRAIGHT);
        }
        let y = set.point();
        let is_reached = y[0].abs() < 1e-12 && (y[1] + 0.5).abs() < 1e-6;
        assert!(is_reached, "{weak} {unit}: {y:?}");
    }
}

/// A row that depends on others but for 1e-11 keeps its bound in motions that are long enough to show it,
/// whatever its unit.
#[test]
fn dependent_rows_keep_their_bounds() {
    for (far, unit) in [(1.0, 1.0), (1e3, 1.0), (1e6, 1.0), (1e6, 1e4), (1e6, 1e-4)] {
        let rows = vec![vec![1.0, 0.0], vec![0.0, 1.0], vec![unit, 1e-11 * unit]];
        let (lower, upper) = (vec![-1.0, -1e6, -unit], vec![0.0, 1e6, 0.0]);
        let problem = Problem { n: 2, boxed: true, rows, lower, upper, levels: Vec::new() };
        let mut set = problem.active_set();
        assert!(set.start(&[1.0, 0.0]));
        let mut level = Level::new(2, 2);
        level.rows = Matrix::identity(2);
        level.target.copy_from_slice(&[1.0, far]);
        set.solve(&mut level, Precision::STRAIGHT);
        let y = set.point();
        assert!(y[0] <= 0.0 && y[0] + 1e-11 * y[1] <= 1.1e-10, "{far} {unit}: {y:?}");
        assert!((y[1] - far).abs() <= 1e-9 * far && y[0] > -1e-4, "{far} {unit}: {y:?}");
    }
}

/// Rows that depended on one that another has replaced are rows like others again: the corner of three
/// rows that differ by 1e-11 is reached.
#[test]
fn rows_depend_on_those_that_stay_alone() {
    let rows = vec![vec![1.0, 0.0, 0.0], vec![1.0, 1e-11, 0.0], vec![1.0, 0.0, 1e-11]];
    let (lower, upper) = (vec![-1.0; 3], vec![0.0; 3]);
    let problem = Problem { n: 3, boxed: false, rows, lower, upper, levels: Vec::new() };
    let mut set = problem.active_set();
    assert!(set.start(&[1.0, 0.0, 0.0]));
    let mut level = Level::new(3, 3);
    level.rows = Matrix::identity(3);
    level.target.copy_from_slice(&[1.0, 1e6, 2e6]);
    set.solve(&mut level, Precision::STRAIGHT);
    let y = set.point();
    let excess = [y[0], y[0] + 1e-11 * y[1], y[0] + 1e-11 * y[2]];
    assert!(excess.iter().all(|x| *x <= 1.1e-10), "{y:?}");
    // The least of y_0 = -1e-11 max(y_1, y_2), from which y_1 and y_2 gain more than y_0 loses.
    assert!((y[1] - 1e6).abs() < 1.0 && (y[2] - 2e6).abs() < 1.0, "{y:?}");
}
