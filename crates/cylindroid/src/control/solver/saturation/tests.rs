//! Conditions of optimality of a changed direction.

use super::*;
use crate::linalg::norm;

/// The next number in [-1, 1) of a fixed sequence.
fn next(state: &mut u64) -> f64 {
    2.0 * crate::scalar::uniform(state) - 1.0
}

/// The solution satisfies the conditions of Karush, Kuhn and Tucker for min |J r - x|^2 + d |r|^2 in
/// a box: zero gradient for joints between their bounds, none pointing inwards for the others.
#[test]
fn bent_rates_are_the_bounded_damped_solution() {
    let mut state = 7;
    let method = Method::Truncated { eps: 1e-9 };
    let mut changed = 0;
    for round in 0..2000 {
        let (m, n) = [(6, 7), (6, 6), (3, 7), (2, 3), (6, 4), (3, 2)][round % 6];
        let j = Matrix::from_fn(m, n, |_, _| next(&mut state));
        let x: Vec<f64> = (0..m).map(|_| 3.0 * next(&mut state)).collect();
        let bounds: Vec<VelocityBounds> = (0..n)
            .map(|i| VelocityBounds {
                lower: -next(&mut state).abs() * f64::from(u8::from(i % 3 > 0)),
                upper: next(&mut state).abs(),
                lower_cause: LimitKind::Position,
                upper_cause: LimitKind::Position,
            })
            .collect();
        let mut saturator = Saturator::new(m, n, None);
        let mut rates = vec![0.0; n];
        solve(&Svd::of(&j), &method, &mut vec![0.0; m.min(n)], &x, &mut rates);
        let goal = j.mul_vec(&rates);
        let last = vec![0.0; n];
        let problem = Problem { j: &j, bounds: &bounds, last: &last, gain: 1e4, error: &x };
        let saturation = saturator.apply(problem, &last, None, &mut rates);
        assert!(rates.iter().zip(&bounds).all(|(r, b)| b.contains(*r)), "round {round}");
        let done = j.mul_vec(&rates);
        let rest: Vec<f64> = goal.iter().zip(&done).map(|(x, y)| x - y).collect();
        if !saturation.direction_lost {
            let off: Vec<f64> =
                goal.iter().zip(&done).map(|(x, y)| saturation.scale * x - y).collect();
            assert!(norm(&off) < 1e-7 * (1.0 + norm(&goal)), "round {round}: {off:?}");
            continue;
        }
        changed += 1;
        let mut pulls = j.transpose().mul_vec(&rest);
        pulls.iter_mut().zip(&rates).for_each(|(p, r)| *p -= saturator.damping * r);
        for ((rate, bound), pull) in rates.iter().zip(&bounds).zip(pulls) {
            let (up, down) = (*rate < bound.upper - 1e-12, *rate > bound.lower + 1e-12);
            if up && down {
                assert!(pull.abs() < 1e-9, "round {round}: {pull} between {bound:?}");
            }
            assert!(!up || pull <= 1e-7, "round {round}: {pull} up");
            assert!(!down || pull >= -1e-7, "round {round}: {pull} down");
        }
    }
    assert!(changed > 300, "{changed}");
}
