//! The working modes of a map: assemblies at some cells, each followed over the grid.
//!
//! Method   random restarts with the platform at a cell: many at the cell of the start, few at others,
//!          spread evenly over the grid; a configuration that no mode has at its cell begins a new one.
//!          Several threads share the cells of the restarts, then those of a mode
//! Valid    any mechanism. Modes may be missed if they fill few cells; the number of starts finds more
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs, tests/map/threads.rs

use super::super::workers::{Counted, Workers};
use super::flood::{Flooded, flood};
use super::grid::Grid;
use super::options::MapOptions;
use super::problem::Problem;
use crate::closure::{
    Landmarks, ModeOptions, PlatformPath, assembly_modes_while, link_poses, signature_distance,
};
use crate::error::Result;
use crate::tolerance::{PLATFORM_SINGULAR, SAME_ASSEMBLY};

/// Further cells in which restarts look for modes, and the restarts of each.
const CELLS: usize = 32;
const STARTS: usize = 6;
/// Largest number of modes.
const MAX_MODES: usize = 64;

/// A cell in which restarts look for modes.
struct Search {
    cell: usize,
    guess: Vec<f64>,
    options: ModeOptions,
}

fn searches(problem: &Problem, grid: &Grid, options: &MapOptions) -> Vec<Search> {
    let at_start: Vec<f64> = problem.axes.iter().map(|&i| problem.start[i]).collect();
    let first = grid.nearest(&at_start);
    let mut all: Vec<Search> = Vec::new();
    for number in 0..=CELLS {
        let cell = if number == 0 { first } else { grid.spread(number) };
        if all.iter().any(|search| search.cell == cell) {
            continue;
        }
        let mut guess = problem.start.clone();
        for (&i, value) in problem.axes.iter().zip(grid.values(cell)) {
            guess[i] = value;
        }
        for &(i, value) in &problem.held {
            guess[i] = value;
        }
        let starts = if number == 0 { options.starts } else { STARTS };
        let seed = options.seed.wrapping_add(number as u64);
        all.push(Search { cell, guess, options: ModeOptions { starts, seed } });
    }
    all
}

/// All modes found; some of them if the observer stops the workers.
pub(super) fn modes(
    problem: &Problem,
    grid: &Grid,
    options: &MapOptions,
    workers: &mut Workers<'_>,
) -> Result<Vec<Flooded>> {
    let mechanism = &problem.platform.mechanism;
    let landmarks = Landmarks::of(mechanism);
    let places =
        |q: &[f64]| -> Result<Vec<_>> { Ok(landmarks.at(&link_poses(&mechanism.state(q)?))) };
    let prescribed = problem.prescribed();
    let mut path = PlatformPath::new(
        problem.equations.clone(),
        problem.axes.clone(),
        problem.type_one.clone(),
    );
    let searches = searches(problem, grid, options);
    let starts: u64 = searches.iter().map(|search| search.options.starts as u64).sum();
    workers.begin(Counted { unit: "starts", all: starts, at_most: false }, 0);
    let found = workers.run(searches.len(), |(): &mut (), number, watch| {
        let Search { guess, options, .. } = &searches[number];
        let go_on = || {
            watch.count(1);
            watch.goes_on()
        };
        Ok(assembly_modes_while(mechanism, guess, &prescribed, *options, go_on)?.modes)
    })?;
    let (cells, mut modes) = (grid.cells() as u64, Vec::<Flooded>::new());
    for (search, found) in searches.iter().zip(found.into_iter().flatten()) {
        let cell = search.cell;
        for (number, mode) in found.iter().enumerate() {
            let q = &mode.assembly.q;
            if modes.len() >= MAX_MODES || mechanism.outside_limits(q).next().is_some() {
                continue;
            }
            let here = places(q)?;
            let mut known = false;
            for other in &modes {
                if let Some(there) = other.at(cell) {
                    // With motions left, all configurations of a cell are one.
                    known |= problem.free_motions() > 0
                        || signature_distance(&here, &places(there)?, |_| true) <= SAME_ASSEMBLY;
                }
            }
            // Where modes meet, none of them begins.
            let node = path.node(q)?;
            known |= path.by_free.distance(&node.svd) < PLATFORM_SINGULAR;
            if known {
                continue;
            }
            // The others of this cell are modes too, unless limits or a singularity rule them out.
            let (before, left) = (modes.len() as u64, (found.len() - number) as u64);
            let all = cells * (before + left);
            // Modes reach a part of them, and the ways to the others are not counted.
            workers.begin(Counted { unit: "cells", all, at_most: true }, cells * before);
            modes.push(flood(problem, grid, &mut path, (cell, q), workers)?);
            if !workers.goes_on() {
                return Ok(modes);
            }
        }
    }
    Ok(modes)
}
