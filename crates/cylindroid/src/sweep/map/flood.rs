//! One working mode over the grid: from cell to cell by certified steps.
//!
//! Formula  breadth first from a seed; a neighbour is reached by `closure/position/platform_path.rs`,
//!          which passes no singularity of type I
//! Method   a level, the cells at one number of steps from the seed, has its neighbours in common: each
//!          of them is tried from the cells of the level in their order, up to the first success. They
//!          do not depend on one another, so several threads share them
//! Shapes   numbers of a cell in rows; NaN where the mode does not reach it
//! Valid    any mechanism. What is reached does not depend on the order; with motions that nothing
//!          prescribes, configurations of a cell do. Nothing depends on the threads
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs, tests/map/threads.rs

use std::collections::BTreeMap;

use super::super::workers::{Watch, Workers};
use super::grid::Grid;
use super::problem::Problem;
use crate::closure::{Obstruction, PathNode, PlatformPath};
use crate::error::Result;
use crate::linalg::Svd;

/// Neighbours that a thread takes at once: about a millisecond.
const BLOCK: usize = 16;

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
        self.reached[cell].then(|| self.row(cell))
    }

    fn row(&self, cell: usize) -> &[f64] {
        let n = self.q.len() / self.reached.len().max(1);
        &self.q[cell * n..(cell + 1) * n]
    }

    fn arrive(&mut self, cell: usize, arrival: &Arrival) {
        let n = arrival.q.len();
        self.q[cell * n..(cell + 1) * n].copy_from_slice(&arrival.q);
        self.reached[cell] = true;
        self.type_one[cell] = arrival.type_one;
        self.type_two[cell] = arrival.type_two;
    }
}

/// The configuration in which a mode reaches a cell, with its distances.
struct Arrival {
    q: Vec<f64>,
    type_one: f64,
    type_two: f64,
}

impl Arrival {
    /// At a node, where the equations of the path are.
    fn of(problem: &Problem, path: &PlatformPath, node: PathNode) -> Self {
        let by_passive = problem.type_two.block(&path.equations.jacobian);
        Self {
            type_one: problem.type_one.value(&node.by_free, &node.svd),
            type_two: problem.type_two.value(&by_passive, &Svd::of(&by_passive)),
            q: node.q,
        }
    }
}

/// A neighbour of a level that is not reached yet.
struct Neighbour {
    cell: usize,
    /// The ways to it: the place of a cell in the level, and that of the neighbour around this cell.
    ways: Vec<(usize, usize)>,
}

/// The end of a way.
struct Step {
    way: (usize, usize),
    cell: usize,
    end: std::result::Result<Arrival, Blocked>,
}

/// Cells that were reached last.
struct Level<'a> {
    problem: &'a Problem,
    grid: &'a Grid,
    mode: &'a Flooded,
    cells: &'a [usize],
}

impl Level<'_> {
    fn neighbours(&self) -> Vec<Neighbour> {
        let mut all: Vec<Neighbour> = Vec::new();
        let mut places = BTreeMap::new();
        for (from, &cell) in self.cells.iter().enumerate() {
            for (around, next) in self.grid.neighbours(cell).into_iter().enumerate() {
                if self.mode.reached[next] {
                    continue;
                }
                let place = *places.entry(next).or_insert(all.len());
                if place == all.len() {
                    all.push(Neighbour { cell: next, ways: Vec::new() });
                }
                all[place].ways.push((from, around));
            }
        }
        all
    }

    /// The ways to some neighbours.
    fn steps(
        &self,
        path: &mut PlatformPath,
        neighbours: &[Neighbour],
        watch: Watch<'_>,
    ) -> Result<Vec<Step>> {
        let mut steps = Vec::new();
        // Neighbours of one cell lie side by side.
        let mut last: Option<(usize, PathNode)> = None;
        for neighbour in neighbours {
            let (cell, goal) = (neighbour.cell, self.grid.values(neighbour.cell));
            for &(from, around) in &neighbour.ways {
                let here = match last.take() {
                    Some((known, node)) if known == from => node,
                    _ => path.node(self.mode.row(self.cells[from]))?,
                };
                let end = match path.go(&here, &goal)? {
                    Ok(node) => Ok(Arrival::of(self.problem, path, node)),
                    Err((node, why)) => Err(Blocked { why, q: node.q }),
                };
                last = Some((from, here));
                let arrived = end.is_ok();
                steps.push(Step { way: (from, around), cell, end });
                if arrived {
                    watch.count(1);
                    break;
                }
            }
        }
        Ok(steps)
    }
}

/// The mode of a configuration at a cell; a part of it if the observer stops the workers.
pub(super) fn flood(
    problem: &Problem,
    grid: &Grid,
    path: &mut PlatformPath,
    (cell, q): (usize, &[f64]),
    workers: &mut Workers<'_>,
) -> Result<Flooded> {
    let (cells, n) = (grid.cells(), q.len());
    let mut mode = Flooded {
        q: vec![f64::NAN; cells * n],
        reached: vec![false; cells],
        type_one: vec![f64::NAN; cells],
        type_two: vec![f64::NAN; cells],
        blocked: Vec::new(),
    };
    let node = path.node(q)?;
    mode.arrive(cell, &Arrival::of(problem, path, node));
    let mut reached = vec![cell];
    while !reached.is_empty() {
        let level = Level { problem, grid, mode: &mode, cells: &reached };
        let neighbours = level.neighbours();
        let found = if neighbours.len() <= BLOCK {
            let steps = workers.run_here(|watch| level.steps(path, &neighbours, watch))?;
            steps.map(|steps| vec![steps])
        } else {
            let blocks: Vec<&[Neighbour]> = neighbours.chunks(BLOCK).collect();
            let first = &*path;
            workers.run(blocks.len(), |own: &mut Option<PlatformPath>, block, watch| {
                let path = own.get_or_insert_with(|| first.clone());
                level.steps(path, blocks[block], watch)
            })?
        };
        let Some(found) = found else { break };
        let mut steps: Vec<Step> = found.into_iter().flatten().collect();
        steps.sort_unstable_by_key(|step| step.way);
        reached.clear();
        for Step { cell, end, .. } in steps {
            match end {
                Ok(arrival) => {
                    mode.arrive(cell, &arrival);
                    reached.push(cell);
                }
                Err(blocked) => mode.blocked.push(blocked),
            }
        }
    }
    Ok(mode)
}
