//! Dominance: which designs are trade-offs of several objectives.
//!
//! Formula  a dominates b: a_i <= b_i for all i and a_i < b_i for one (all to be minimised). A
//!          refinement of p minimises max_i (f_i - u_i) / (p_i - u_i) with u below the best values: 1
//!          at p, below 1 only where all objectives are better than at p
//! Units    every objective its own; distances along the front are shares of its extent
//! Why so   sums with weights find no trade-off where the front is not convex; with this ratio every
//!          refined design is as good as its start in each objective, and so no start is worse off
//! Source   Wierzbicki 1980 (achievement functions); Miettinen 1999, section 3.4
//! Checked  tests in this file, tests/sweep/optimise.rs::refined_trade_offs_dominate_their_starts

/// How far the reference point lies below the best values, of the extent of the front.
const BELOW: f64 = 0.1;
/// The share of the other objectives where one is optimised alone.
const OTHERS: f64 = 1e-6;
/// Designs nearer than this share of the extent of the front are the same trade-off.
const SAME: f64 = 1e-9;

/// True if `a` is as good as `b` in all objectives and better in one.
fn dominates(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && a.iter().zip(b).any(|(a, b)| a < b)
}

/// The places of those that no other one dominates; of equal ones the first.
pub(super) fn front(all: &[Vec<f64>]) -> Vec<usize> {
    // A design is dominated by one before it in the order of the alphabet, if by any.
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| {
        let by_values = all[a].iter().zip(&all[b]).map(|(a, b)| a.total_cmp(b));
        by_values.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then).then(a.cmp(&b))
    });
    let mut kept: Vec<usize> = Vec::new();
    for place in order {
        let worse = |&k: &usize| dominates(&all[k], &all[place]) || all[k] == all[place];
        if !kept.iter().any(worse) {
            kept.push(place);
        }
    }
    kept.sort_unstable();
    kept
}

/// The places of the front, then of what is the front without it, and so on until there are `count`.
pub(super) fn layers(all: &[Vec<f64>], count: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..all.len()).collect();
    let mut chosen = Vec::new();
    while chosen.len() < count && !left.is_empty() {
        let own: Vec<Vec<f64>> = left.iter().map(|&i| all[i].clone()).collect();
        let layer: Vec<usize> = front(&own).into_iter().map(|i| left[i]).collect();
        left.retain(|i| !layer.contains(i));
        chosen.extend(layer);
    }
    chosen
}

/// Smallest value and extent of each objective.
pub(super) struct Extent {
    least: Vec<f64>,
    size: Vec<f64>,
}

impl Extent {
    pub(super) fn of(all: &[Vec<f64>]) -> Self {
        let width = all.first().map_or(0, Vec::len);
        let column = |i: usize| all.iter().map(move |f| f[i]);
        let least: Vec<f64> = (0..width).map(|i| column(i).fold(f64::INFINITY, f64::min)).collect();
        let most = (0..width).map(|i| column(i).fold(f64::NEG_INFINITY, f64::max));
        let size =
            most.zip(&least).map(|(most, least)| if most > *least { most - least } else { 1.0 });
        Self { size: size.collect(), least }
    }

    /// The largest difference of an objective, as a share of the extent.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let shares = a.iter().zip(b).zip(&self.size).map(|((a, b), size)| (a - b).abs() / size);
        shares.fold(0.0, f64::max)
    }

    /// An objective with a small share of the others, by which designs that are equal in it differ.
    pub(super) fn mostly(&self, objective: usize, f: &[f64]) -> f64 {
        let share = |i: usize| (f[i] - self.least[i]) / self.size[i];
        let others: f64 = (0..f.len()).filter(|i| *i != objective).map(share).sum();
        share(objective) + OTHERS * others
    }

    /// What a refinement of `p` minimises.
    pub(super) fn ratio(&self, p: &[f64], f: &[f64]) -> f64 {
        let below = self.least.iter().zip(&self.size).map(|(least, size)| least - BELOW * size);
        let ratios = f.iter().zip(p).zip(below).map(|((f, p), u)| (f - u) / (p - u));
        ratios.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Up to `count` of a front, spread over its extent: first the best of the first objective, then
/// always the farthest from those before.
pub(super) fn spread(front: &[Vec<f64>], count: usize) -> Vec<usize> {
    let extent = Extent::of(front);
    let first = (0..front.len()).min_by(|&a, &b| front[a][0].total_cmp(&front[b][0]));
    let mut chosen: Vec<usize> = first.into_iter().take(count).collect();
    while chosen.len() < count.min(front.len()) {
        let away = |i: usize| {
            let distances = chosen.iter().map(|&c| extent.distance(&front[i], &front[c]));
            distances.fold(f64::INFINITY, f64::min)
        };
        let left = (0..front.len()).filter(|i| !chosen.contains(i));
        // The first of equally far ones.
        let next = left.rev().max_by(|&a, &b| away(a).total_cmp(&away(b)));
        let Some(next) = next else { break };
        chosen.push(next);
    }
    chosen
}

/// Of designs that are the same trade-off the first.
pub(super) fn distinct(all: &[Vec<f64>]) -> Vec<usize> {
    let extent = Extent::of(all);
    let mut kept: Vec<usize> = Vec::new();
    for i in 0..all.len() {
        if kept.iter().all(|&k| extent.distance(&all[i], &all[k]) > SAME) {
            kept.push(i);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fronts_have_what_nothing_dominates() {
        let all = [[1.0, 4.0], [2.0, 2.0], [2.0, 3.0], [4.0, 1.0], [1.0, 4.0], [5.0, 5.0]];
        let all: Vec<Vec<f64>> = all.iter().map(|f| f.to_vec()).collect();
        assert_eq!(front(&all), [0, 1, 3]);
        // By definition.
        for (i, f) in all.iter().enumerate() {
            let dominated = all.iter().any(|g| dominates(g, f));
            assert_eq!(dominated, [2, 5].contains(&i));
        }
        assert_eq!(layers(&all, 3), [0, 1, 3]);
        assert_eq!(layers(&all, 4), [0, 1, 3, 2, 4]);
        assert_eq!(layers(&all, 9), [0, 1, 3, 2, 4, 5]);
        assert_eq!(front(&[]), [0_usize; 0]);
        assert_eq!(front(&[vec![2.0], vec![1.0], vec![1.0]]), [1]);
    }

    #[test]
    fn ratios_are_below_one_where_all_is_better() {
        let all = vec![vec![0.0, 8.0], vec![3.0, 3.0], vec![8.0, 0.0]];
        let extent = Extent::of(&all);
        for p in &all {
            assert!((extent.ratio(p, p) - 1.0).abs() < 1e-15);
            assert!(extent.ratio(p, &[p[0] - 1e-3, p[1] - 1e-3]) < 1.0);
            assert!(extent.ratio(p, &[p[0] - 1.0, p[1] + 1e-3]) > 1.0);
            assert!(extent.mostly(0, &[p[0] - 1e-3, 8.0]) < extent.mostly(0, p));
            assert!(extent.mostly(0, &[p[0], p[1] - 1e-3]) < extent.mostly(0, p));
        }
        assert_eq!(spread(&all, 2), [0, 2]);
        assert_eq!(spread(&all, 9), [0, 2, 1]);
        assert_eq!(distinct(&[vec![0.0, 8.0], vec![1e-9, 8.0], vec![8.0, 0.0]]), [0, 2]);
    }
}
