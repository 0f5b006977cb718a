//! The orientations of a tool at a point: approach directions, evenly spread over the sphere, and
//! rotations about each.
//!
//! Formula  direction i of N: cos theta = 1 - (2 i + 1) / N, phi = i pi (3 - sqrt 5), the spiral of
//!          the golden angle; orientation (i, r) of M rolls: Rz(phi) Ry(theta) Rz(2 pi r / M), whose z
//!          axis is the direction. In the plane Rz(2 pi i / N)
//! Shapes   N M orientations, those of a direction one after the other
//! Valid    any N: areas per direction differ by a few per cent, the caps at the poles included
//! Why so   points of polyhedra and of HEALPix exist for some N only; random ones leave gaps
//! Source   Vogel 1979; Swinbank & Purser 2006
//! Checked  tests::directions_are_evenly_spread, tests::neighbours_are_near

use std::f64::consts::{PI, TAU};

use crate::scalar::sin_cos;
use crate::spatial::{Mat3, Rotation, Vec3};

/// Neighbours of a direction.
const NEIGHBOURS: usize = 6;

/// The orientations.
#[derive(Debug, Clone)]
pub(super) struct Orientations {
    pub(super) all: Vec<Rotation>,
    /// Of each direction.
    pub(super) rolls: usize,
    /// Places of orientations near each.
    pub(super) neighbours: Vec<Vec<usize>>,
}

impl Orientations {
    /// Of a tool in space. Without directions one orientation, without rolls one of each direction.
    pub(super) fn in_space(directions: usize, rolls: usize) -> Self {
        let rolls = rolls.max(1);
        let roll = |r: usize| Rotation::about_z(TAU * r as f64 / rolls as f64);
        let of = |i: usize| (0..rolls).map(move |r| direction(i, directions) * roll(r));
        let all: Vec<Rotation> = if directions == 0 {
            vec![Rotation::IDENTITY]
        } else {
            (0..directions).flat_map(of).collect()
        };
        let neighbours = neighbours(&all, rolls);
        Self { all, rolls, neighbours }
    }

    /// Of a tool in the plane.
    pub(super) fn in_plane(directions: usize) -> Self {
        let count = directions.max(1);
        let all: Vec<Rotation> =
            (0..count).map(|i| Rotation::about_z(TAU * i as f64 / count as f64)).collect();
        let beside = |i: usize| {
            let mut beside = vec![(i + 1) % count, (i + count - 1) % count];
            beside.retain(|j| *j != i);
            beside.dedup();
            beside
        };
        Self { neighbours: (0..count).map(beside).collect(), all, rolls: 1 }
    }
}

/// A rotation that takes z to direction `i` of `count`.
fn direction(i: usize, count: usize) -> Rotation {
    let cos = 1.0 - (2 * i + 1) as f64 / count as f64;
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    // Full turns are left out before they cost digits.
    let turns = i as f64 * (0.5 * (3.0 - 5.0_f64.sqrt()));
    let (s, c) = sin_cos(2.0 * PI * turns.fract());
    Rotation::assume(Mat3::from_cols(
        Vec3::new(c * cos, s * cos, -sin),
        Vec3::new(-s, c, 0.0),
        Vec3::new(c * sin, s * sin, cos),
    ))
}

/// Of each orientation those of the next rolls, and of each near direction the one nearest.
fn neighbours(all: &[Rotation], rolls: usize) -> Vec<Vec<usize>> {
    let directions = all.len() / rolls;
    let axis = |i: usize| all[i * rolls] * Vec3::Z;
    let near = |i: usize| {
        let mut others: Vec<(f64, usize)> =
            (0..directions).filter(|j| *j != i).map(|j| (-axis(i).dot(axis(j)), j)).collect();
        let last = NEIGHBOURS.min(others.len());
        if last < others.len() {
            others.select_nth_unstable_by(last, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        others.truncate(last);
        others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        others.into_iter().map(|(_, j)| j).collect::<Vec<_>>()
    };
    let mut found = Vec::with_capacity(all.len());
    for i in 0..directions {
        let near = near(i);
        for r in 0..rolls {
            let own = all[i * rolls + r].matrix();
            let alike = |place: usize| -> f64 {
                let other = all[place].matrix();
                (0..3).map(|k| own.cols[k].dot(other.cols[k])).sum()
            };
            let mut beside: Vec<usize> = [r + 1, r + rolls - 1]
                .into_iter()
                .map(|other| i * rolls + other % rolls)
                .filter(|place| *place != i * rolls + r)
                .collect();
            beside.dedup();
            beside.extend(near.iter().filter_map(|j| {
                let places = j * rolls..(j + 1) * rolls;
                places.max_by(|a, b| alike(*a).total_cmp(&alike(*b)).then(b.cmp(a)))
            }));
            found.push(beside);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_evenly_spread() {
        for count in [1, 2, 13, 50, 500] {
            let o = Orientations::in_space(count, 1);
            let axes: Vec<Vec3> = o.all.iter().map(|r| *r * Vec3::Z).collect();
            let sum = axes.iter().fold(Vec3::ZERO, |sum, axis| sum + *axis);
            assert!(sum.norm() < 1.5, "{count}: {sum:?}");
            if count < 13 {
                continue;
            }
            // Of each cap a share that is that of its area: 2 pi (1 - cos a) of 4 pi.
            let cos = 0.5;
            for cap in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(-0.6, 0.0, -0.8)] {
                let inside = axes.iter().filter(|axis| axis.dot(cap) > cos).count() as f64;
                let expected = 0.25 * count as f64;
                assert!((inside - expected).abs() < 2.0 + 0.04 * expected, "{count}: {inside}");
            }
            // No two closer than half of the mean distance.
            let apart = (4.0 * PI / count as f64).sqrt();
            for (i, a) in axes.iter().enumerate() {
                assert!(axes[..i].iter().all(|b| (*a - *b).norm() > 0.5 * apart), "{count}");
            }
        }
    }

    #[test]
    fn neighbours_are_near() {
        let o = Orientations::in_space(100, 12);
        assert_eq!(o.all.len(), 1200);
        for (own, near) in o.all.iter().zip(&o.neighbours) {
            assert_eq!(near.len(), 8);
            for place in near {
                let apart = (own.inverse() * o.all[*place]).log().norm();
                assert!(apart < 0.8, "{apart}");
            }
        }
        let rolls = Orientations::in_space(1, 4);
        assert_eq!(rolls.neighbours, [[1, 3], [2, 0], [3, 1], [0, 2]]);
        assert_eq!(Orientations::in_space(0, 0).neighbours, [Vec::<usize>::new()]);
        assert_eq!(Orientations::in_plane(2).neighbours, [[1], [0]]);
        assert_eq!(Orientations::in_plane(3).neighbours, [[1, 2], [2, 0], [0, 1]]);
    }
}
