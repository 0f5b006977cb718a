//! One working mode over the grid: from cell to cell by certified steps.
//!
//! Formula  breadth first from a seed; a neighbour is reached by `closure/position/platform_path.rs`,
//!          which passes no singularity of type I
//! Shapes   numbers of a cell in rows; NaN where the mode does not reach it
//! Valid    any mechanism. What is reached depends neither on order nor on threads; with motions that
//!          nothing prescribes, configurations of a cell do
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs

use std::collections::VecDeque;

use super::grid::Grid;
use super::problem::Problem;
use crate::closure::{Obstruction, PathNode, PlatformPath};
use crate::error::Result;
use crate::linalg::Svd;

/// A way to a neighbour that ended before it.
#[derive(Debug, Clone)]
pub(super) struct Blocked {
    pub(super) why: Obstruction,
    /// The last configuration.
    pub(super) q: Vec<f64>,
}

/// A working mode over the grid.
#[derive(Debug, Clone)]
pub(super) struct Flooded {
    /// Coordinates, platform included, of each cell.
    pub(super) q: Vec<f64>,
    pub(super) reached: Vec<bool>,
    pub(super) type_one: Vec<f64>,
    pub(super) type_two: Vec<f64>,
    pub(super) blocked: Vec<Blocked>,
}

impl Flooded {
    /// The configuration at a cell.
    pub(super) fn at(&self, cell: usize) -> Option<&[f64]> {
        let n = self.q.len() / self.reached.len().max(1);
        self.reached[cell].then(|| &self.q[cell * n..(cell + 1) * n])
    }
}

/// The mode of a configuration at a cell.
pub(super) fn flood(
    problem: &Problem,
    grid: &Grid,
    path: &mut PlatformPath,
    (cell, q): (usize, &[f64]),
) -> Result<Flooded> {
    let (cells, n) = (grid.cells(), q.len());
    let mut mode = Flooded {
        q: vec![f64::NAN; cells * n],
        reached: vec![false; cells],
        type_one: vec![f64::NAN; cells],
        type_two: vec![f64::NAN; cells],
        blocked: Vec::new(),
    };
    let mut queue = VecDeque::new();
    let node = path.node(q)?;
    arrive(problem, path, &mut mode, cell, &node);
    queue.push_back(cell);
    while let Some(cell) = queue.pop_front() {
        let here = path.node(&mode.q[cell * n..(cell + 1) * n])?;
        for next in grid.neighbours(cell) {
            if mode.reached[next] {
                continue;
            }
            match path.go(&here, &grid.values(next))? {
                Ok(node) => {
                    arrive(problem, path, &mut mode, next, &node);
                    queue.push_back(next);
                }
                Err((last, why)) => mode.blocked.push(Blocked { why, q: last.q }),
            }
        }
    }
    Ok(mode)
}

fn arrive(
    problem: &Problem,
    path: &PlatformPath,
    mode: &mut Flooded,
    cell: usize,
    node: &PathNode,
) {
    let n = node.q.len();
    mode.q[cell * n..(cell + 1) * n].copy_from_slice(&node.q);
    mode.reached[cell] = true;
    mode.type_one[cell] = problem.type_one.value(&node.by_free, &node.svd);
    let by_passive = problem.type_two.block(&path.equations.jacobian);
    mode.type_two[cell] = problem.type_two.value(&by_passive, &Svd::of(&by_passive));
}
