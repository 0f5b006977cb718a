//! The rows of a capability map.
//!
//! Formula  reachability: directions of which an orientation is reached, over all directions;
//!          orientation_share: orientations that are reached, over all of them. best_*: the largest
//!          value over the solutions found, of `condition` the smallest
//! Checked  tests/sweep/capability.rs

use std::ops::Range;

use super::super::evaluate::{Evaluator, Scratch};
use super::super::quantity::Quantity;
use super::super::source::Configurations;
use super::super::table::{Column, Values, begin};
use super::search::Search;
use crate::error::Result;
use crate::model::Dimension;

/// Solutions evaluated at once.
const BLOCK: usize = 256;

/// The rows of a sweep, in its columns: those of a capability map or of configurations.
pub(in super::super) fn run(
    evaluator: &Evaluator,
    from: &Configurations,
    columns: &[Column],
    rows: Range<u64>,
    out: &mut Vec<Values>,
) -> Result<()> {
    let Some(search) = &evaluator.search else { return evaluator.run(from, columns, rows, out) };
    let mut search: Search = search.clone();
    begin(out, columns, 0);
    let mut best = Best::new(evaluator);
    let mut found = search.memory();
    let all = !evaluator.quantities.is_empty();
    let axes = if evaluator.mechanism.dimension() == Dimension::Planar { 2 } else { 3 };
    for row in rows {
        let point = search.voxels.point(row);
        best.begin();
        search.run(row, all, &mut found, |q| best.add(q))?;
        best.evaluate()?;
        let rolls = search.orientations.rolls;
        let reached = |all: &[bool]| all.iter().filter(|is| **is).count();
        let directions = found.is_reached.chunks(rolls).filter(|d| d.contains(&true)).count();
        let orientations = reached(&found.is_reached);
        let count = found.is_reached.len() as f64;
        let mut place = out.iter_mut();
        push(place.next(), row as f64);
        for x in &point.to_array()[..axes] {
            push(place.next(), *x);
        }
        push(place.next(), directions as f64);
        push(place.next(), orientations as f64);
        push(place.next(), directions as f64 * rolls as f64 / count);
        push(place.next(), orientations as f64 / count);
        for x in &best.best {
            push(place.next(), *x);
        }
    }
    Ok(())
}

fn push(column: Option<&mut Values>, x: f64) {
    match column {
        Some(Values::Numbers(column)) => column.push(x),
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "indices below 2^48 and numbers of orientations"
        )]
        Some(Values::Counts(column)) => column.push(x as u64),
        _ => {}
    }
}

/// The best values over the solutions of a point.
struct Best<'a> {
    evaluator: &'a Evaluator,
    scratch: Scratch,
    /// Solutions that are not evaluated yet.
    q: Vec<f64>,
    values: Vec<Values>,
    best: Vec<f64>,
}

impl<'a> Best<'a> {
    fn new(evaluator: &'a Evaluator) -> Self {
        let count = evaluator.quantities.len();
        Self {
            evaluator,
            scratch: Scratch::new(evaluator, BLOCK),
            q: Vec::with_capacity(BLOCK * evaluator.mechanism.n()),
            values: vec![Values::Numbers(Vec::new()); count],
            best: vec![f64::NAN; count],
        }
    }

    fn begin(&mut self) {
        self.q.clear();
        self.best.fill(f64::NAN);
    }

    fn add(&mut self, q: &[f64]) -> Result<()> {
        if self.best.is_empty() {
            return Ok(());
        }
        self.q.extend_from_slice(q);
        if self.q.len() == BLOCK * q.len() { self.evaluate() } else { Ok(()) }
    }

    fn evaluate(&mut self) -> Result<()> {
        if self.q.is_empty() {
            return Ok(());
        }
        self.evaluator.of_configurations(&mut self.scratch, &self.q, &mut self.values)?;
        self.q.clear();
        let columns = self.evaluator.quantities.iter().zip(&self.values);
        for ((quantity, values), best) in columns.zip(&mut self.best) {
            let Values::Numbers(values) = values else { continue };
            // What is not a number is left out by both.
            *best = match quantity {
                Quantity::Condition => values.iter().fold(*best, |best, x| best.min(*x)),
                _ => values.iter().fold(*best, |best, x| best.max(*x)),
            };
        }
        Ok(())
    }
}
