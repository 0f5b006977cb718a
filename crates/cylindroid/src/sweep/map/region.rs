//! The region that working modes reach: its size, and the holes in it.
//!
//! Formula  size = cells x product of (to - from) / (count - 1) over the axes with several values
//!          a hole is a set of cells that are not reached, connected along the axes and across, none
//!          of them at the border of the grid
//! Units    m and rad, multiplied
//! Valid    to the resolution of the grid: a hole smaller than a cell is missed, and a bay whose mouth is
//!          narrower than a cell counts as a hole
//! Checked  tests in this file, tests/map/region.rs

use super::grid::Grid;
use super::result::WorkingMode;

/// A set of cells of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Number of cells.
    pub cells: usize,
    /// Length, area or volume: cells times the size of one [m and rad, multiplied].
    pub size: f64,
    /// True if it ends at the border of the grid, beyond which it may go on.
    pub is_cut: bool,
    /// The holes in it, the largest first.
    pub holes: Vec<Hole>,
}

/// Cells that are not reached, surrounded by cells that are.
#[derive(Debug, Clone, PartialEq)]
pub struct Hole {
    /// Number of cells.
    pub cells: usize,
    /// Length, area or volume [m and rad, multiplied].
    pub size: f64,
    /// The mean of its cells, a value for each axis [m or rad].
    pub center: Vec<f64>,
}

/// The cells that a mode reaches, or some of several.
pub(super) fn region(grid: &Grid, modes: &[&WorkingMode]) -> Region {
    let mut reached = vec![false; grid.cells()];
    for mode in modes {
        reached.iter_mut().zip(&mode.reached).for_each(|(any, own)| *any |= own);
    }
    let size = grid.cell_size();
    let cells = reached.iter().filter(|r| **r).count();
    let is_cut = (0..reached.len()).any(|cell| reached[cell] && grid.is_border(cell));
    let mut holes = Vec::new();
    // Cells that were looked at count as reached.
    for first in 0..reached.len() {
        if reached[first] {
            continue;
        }
        reached[first] = true;
        let (mut found, mut next, mut is_hole) = (vec![first], 0, true);
        while let Some(&cell) = found.get(next) {
            next += 1;
            is_hole &= !grid.is_border(cell);
            for other in grid.all_neighbours(cell) {
                if !std::mem::replace(&mut reached[other], true) {
                    found.push(other);
                }
            }
        }
        if is_hole && cells > 0 {
            let (cells, center) = (found.len(), grid.mean(&found));
            holes.push(Hole { cells, size: size * cells as f64, center });
        }
    }
    holes.sort_by_key(|hole| std::cmp::Reverse(hole.cells));
    Region { cells, size: size * cells as f64, is_cut, holes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Axis;

    fn of(counts: &[u64], is_reached: impl Fn(&[f64]) -> bool) -> Region {
        let axis = |(&count, name): (&u64, &str)| {
            let end = if count > 1 { 1.5 } else { -1.5 };
            Axis { name: name.to_owned(), from: -1.5, to: end, count }
        };
        let axes: Vec<Axis> = counts.iter().zip(["x", "y", "z"]).map(axis).collect();
        let grid = Grid::new(&axes);
        let reached: Vec<bool> =
            (0..grid.cells()).map(|cell| is_reached(&grid.values(cell))).collect();
        let none = Vec::new;
        let mode = WorkingMode {
            reached,
            q: none(),
            type_one: none(),
            type_two: none(),
            limit_distance: none(),
        };
        region(&grid, &[&mode])
    }

    fn norm(x: &[f64]) -> f64 {
        x.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    #[test]
    fn a_shell_has_a_hole() {
        let shell = of(&[61, 61, 61], |x| (0.52..1.02).contains(&norm(x)));
        let volume = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
        assert!((shell.size / (volume(1.02) - volume(0.52)) - 1.0).abs() < 0.01, "{}", shell.size);
        let [hole] = &shell.holes[..] else { panic!("{:?}", shell.holes) };
        assert!((hole.size / volume(0.52) - 1.0).abs() < 0.03, "{}", hole.size);
        assert!(norm(&hole.center) < 1e-12 && !shell.is_cut);
    }

    #[test]
    fn holes_are_enclosed_along_and_across() {
        // A square ring around 9 x 9 cells; without its corners what it encloses goes on across them.
        let edge = |x: f64| (x.abs() - 0.5).abs() < 1e-9;
        let inside = |x: f64| x.abs() < 0.5 + 1e-9;
        let ring = |x: &[f64]| (edge(x[0]) && inside(x[1])) || (edge(x[1]) && inside(x[0]));
        let closed = of(&[31, 31], ring);
        assert_eq!((closed.holes.len(), closed.holes[0].cells), (1, 81));
        let open = of(&[31, 31], |x| ring(x) && !(edge(x[0]) && edge(x[1])));
        assert!(open.holes.is_empty() && open.cells == closed.cells - 4);
        // Two of them, the larger first; one value of an axis has no border.
        let two = of(&[31, 1, 31], |x| {
            let far = |at: f64| norm(&[x[0] - at, x[2]]);
            far(0.0) < 1.25 && far(0.5) > 0.35 && far(-0.6) > 0.15
        });
        let [large, small] = &two.holes[..] else { panic!("{two:?}") };
        assert!(large.cells > small.cells && !two.is_cut);
        assert!(norm(&[large.center[0] - 0.5, large.center[2]]) < 1e-9, "{large:?}");
        assert!(norm(&[small.center[0] + 0.6, small.center[2]]) < 1e-9, "{small:?}");
        // In another order of the axes the same.
        let turned = of(&[31, 31], |x| {
            let far = |at: f64| norm(&[x[0], x[1] - at]);
            far(0.0) < 1.25 && far(0.5) > 0.35 && far(-0.6) > 0.15
        });
        assert_eq!((turned.cells, turned.size), (two.cells, two.size));
        for (a, b) in turned.holes.iter().zip(&two.holes) {
            assert_eq!((a.cells, a.center[1]), (b.cells, b.center[0]));
        }
        assert!(of(&[31, 31], |_| true).is_cut);
        let nothing = of(&[31, 31], |_| false);
        assert_eq!((nothing.cells, nothing.holes.len(), nothing.is_cut), (0, 0, false));
    }
}
