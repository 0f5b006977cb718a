//! The solutions of the closed form for one pose.
//!
//! Units    rad, m
//! Valid    at most eight; equal ones, up to full turns, are one
//! Checked  tests/it/analytic/, tests in this file

use std::ops::Deref;

use crate::scalar::nearest_turn;
use crate::tolerance::ANALYTIC_SAME;

/// One solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalyticSolution {
    /// The angles of the six joints, in the order of [`Analytic::coordinates`](super::Analytic::coordinates) (rad).
    pub q: [f64; 6],
    /// True for joints whose angle the pose leaves free: the configuration is singular, one of a
    /// continuum of solutions. The angle is that of the initial guess, or one that the other joints
    /// permit.
    pub free: [bool; 6],
    /// (m)
    pub position_error: f64,
    /// (rad)
    pub orientation_error: f64,
}

/// The solutions for a pose: at most eight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalyticSolutions {
    list: [AnalyticSolution; 8],
    len: usize,
    open: bool,
}

impl Deref for AnalyticSolutions {
    type Target = [AnalyticSolution];

    fn deref(&self) -> &[AnalyticSolution] {
        &self.list[..self.len]
    }
}

impl AnalyticSolutions {
    pub(super) const NONE: Self = Self {
        list: [AnalyticSolution {
            q: [0.0; 6],
            free: [false; 6],
            position_error: 0.0,
            orientation_error: 0.0,
        }; 8],
        len: 0,
        open: false,
    };

    /// Remembers that the pose may leave these joints free.
    pub(super) fn note_free(&mut self, free: &[bool; 6]) {
        self.open |= *free != [false; 6];
    }

    /// True if the pose may leave a joint free: there are then further solutions.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Adds a new solution, up to full turns; of two equal ones the more accurate.
    pub(super) fn insert(&mut self, solution: AnalyticSolution) {
        let same = |other: &AnalyticSolution| {
            let mut pairs = other.q.iter().zip(solution.q);
            pairs.all(|(a, b)| nearest_turn(a - b, 0.0).abs() < ANALYTIC_SAME)
        };
        let error = |p: &AnalyticSolution| p.position_error + p.orientation_error;
        if let Some(other) = self.list[..self.len].iter_mut().find(|other| same(other)) {
            if error(&solution) < error(other) {
                *other = solution;
            }
        } else if self.len < self.list.len() {
            self.list[self.len] = solution;
            self.len += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_equal_solutions_the_more_accurate_is_kept() {
        let of = |turn: f64, position_error: f64, orientation_error: f64| AnalyticSolution {
            q: [0.1, 0.2, turn, 0.4, 0.5, 0.6],
            free: [false; 6],
            position_error,
            orientation_error,
        };
        let mut found = AnalyticSolutions::NONE;
        found.insert(of(0.3, 2e-9, 1e-9));
        found.insert(of(0.3 + std::f64::consts::TAU, 1e-9, 3e-9));
        found.insert(of(1.3, 5e-9, 5e-9));
        assert_eq!(&found[..], [of(0.3, 2e-9, 1e-9), of(1.3, 5e-9, 5e-9)]);
        found.insert(of(0.3, 1e-9, 1e-9));
        found.insert(of(1.3, 0.0, 4e-9));
        assert_eq!(&found[..], [of(0.3, 1e-9, 1e-9), of(1.3, 0.0, 4e-9)]);
    }
}
