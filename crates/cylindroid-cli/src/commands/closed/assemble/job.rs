//! What `assemble` is asked for, and words that its answers share.

use cylindroid::closure::LoopClosureError;
use cylindroid::model::Mechanism;

use crate::output::{self, number};

/// What is asked for: a mechanism, a guess, the coordinates that keep their values.
pub(super) struct Job<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) names: Vec<&'a str>,
    pub(super) guess: Vec<f64>,
    pub(super) prescribed: Vec<usize>,
}

impl Job<'_> {
    pub(super) fn names_of(&self, places: &[usize]) -> Vec<&str> {
        places.iter().map(|&i| self.names[i]).collect()
    }
}

pub(super) fn open_by(closure_error: LoopClosureError) -> String {
    format!("{} m, {} rad", number(closure_error.distance), number(closure_error.angle))
}

/// An argument for `--q`, in full.
pub(super) fn q_line(q: &[f64]) -> String {
    q.iter().map(|x| output::without_rounding(*x).to_string()).collect::<Vec<_>>().join(",")
}
