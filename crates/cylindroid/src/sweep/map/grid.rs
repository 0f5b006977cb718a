//! The grid of a map: cells by index, the last axis changes fastest.
//!
//! Checked  tests in this file

use crate::sweep::Axis;

/// A grid over axes.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    axes: Vec<Axis>,
    counts: Vec<usize>,
}

impl Grid {
    pub(super) fn new(axes: &[Axis]) -> Self {
        let counts = axes.iter().map(|a| usize::try_from(a.count).unwrap_or(usize::MAX)).collect();
        Self { axes: axes.to_vec(), counts }
    }

    pub(super) fn cells(&self) -> usize {
        self.counts.iter().product()
    }

    /// The numbers of cells along three axes with several values each.
    pub(super) fn spatial(&self) -> Option<[usize; 3]> {
        let counts: [usize; 3] = self.counts[..].try_into().ok()?;
        counts.iter().all(|count| *count > 1).then_some(counts)
    }

    /// The places of a cell along the axes.
    fn places(&self, mut cell: usize) -> Vec<usize> {
        let mut places = vec![0; self.counts.len()];
        for (place, count) in places.iter_mut().zip(&self.counts).rev() {
            *place = cell % count;
            cell /= count;
        }
        places
    }

    /// The values of the axes at a cell.
    pub(super) fn values(&self, cell: usize) -> Vec<f64> {
        let places = self.places(cell);
        self.axes.iter().zip(places).map(|(axis, place)| axis.value(place as u64)).collect()
    }

    /// The neighbours of a cell along the axes.
    pub(super) fn neighbours(&self, cell: usize) -> Vec<usize> {
        let places = self.places(cell);
        let (mut all, mut stride) = (Vec::with_capacity(2 * places.len()), 1);
        for (place, count) in places.iter().zip(&self.counts).rev() {
            if *place > 0 {
                all.push(cell - stride);
            }
            if place + 1 < *count {
                all.push(cell + stride);
            }
            stride *= count;
        }
        all
    }

    /// The neighbours of a cell along the axes and across.
    pub(super) fn all_neighbours(&self, cell: usize) -> Vec<usize> {
        let mut all = vec![0];
        for (place, count) in self.places(cell).into_iter().zip(&self.counts) {
            let near = place.saturating_sub(1)..=(place + 1).min(count - 1);
            all = all.iter().flat_map(|a| near.clone().map(move |b| a * count + b)).collect();
        }
        all.retain(|&other| other != cell);
        all
    }

    /// True for a cell at an end of an axis with several values.
    pub(super) fn is_border(&self, cell: usize) -> bool {
        let places = self.places(cell);
        places.iter().zip(&self.counts).any(|(p, count)| *count > 1 && (*p == 0 || p + 1 == *count))
    }

    /// The size of a cell [m and rad, multiplied], of the axes with several values.
    pub(super) fn cell_size(&self) -> f64 {
        let several = self.axes.iter().filter(|axis| axis.count > 1);
        several.map(|axis| (axis.to - axis.from) / (axis.count - 1) as f64).product()
    }

    /// The mean of some cells, a value for each axis.
    pub(super) fn mean(&self, cells: &[usize]) -> Vec<f64> {
        let mut sums = vec![0; self.counts.len()];
        for cell in cells {
            sums.iter_mut().zip(self.places(*cell)).for_each(|(sum, place)| *sum += place);
        }
        let mean = |(axis, sum): (&Axis, usize)| {
            let last = axis.count.saturating_sub(1).max(1) as f64;
            let share = sum as f64 / (cells.len() as f64 * last);
            axis.from * (1.0 - share) + axis.to * share
        };
        self.axes.iter().zip(sums).map(mean).collect()
    }

    /// The cell nearest to some values of the axes.
    pub(super) fn nearest(&self, values: &[f64]) -> usize {
        let mut cell = 0;
        for ((axis, count), value) in self.axes.iter().zip(&self.counts).zip(values) {
            let share = (value - axis.from) / (axis.to - axis.from);
            let last = count - 1;
            let place =
                if share > 0.0 { (share * last as f64).round().min(last as f64) } else { 0.0 };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number from 0 to the last place"
            )]
            let place = place as usize;
            cell = cell * count + place.min(last);
        }
        cell
    }

    /// Cell `number` of a sequence that fills the grid evenly (the generalised golden ratio).
    pub(super) fn spread(&self, number: usize) -> usize {
        let ratio = match self.axes.len() {
            1 => 1.618_033_988_749_895_f64,
            2 => 1.324_717_957_244_746,
            _ => 1.220_744_084_605_759_5,
        };
        let mut share = 1.0;
        let value = |axis: &Axis| {
            share /= ratio;
            let x = (0.5 + share * number as f64).fract();
            axis.from + (axis.to - axis.from) * x
        };
        let values: Vec<f64> = self.axes.iter().map(value).collect();
        self.nearest(&values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_and_values() {
        let axis = |name: &str, from, to, count| Axis { name: name.to_owned(), from, to, count };
        let grid = Grid::new(&[axis("x", -1.0, 2.0, 4), axis("y", 0.0, 1.0, 3)]);
        assert_eq!((grid.cells(), grid.values(5)), (12, vec![0.0, 1.0]));
        assert_eq!(grid.neighbours(0), [1, 3]);
        assert_eq!(grid.neighbours(4), [3, 5, 1, 7]);
        for cell in 0..grid.cells() {
            assert_eq!(grid.nearest(&grid.values(cell)), cell);
            assert!(grid.spread(cell) < grid.cells());
        }
        assert_eq!(grid.all_neighbours(4), [0, 1, 2, 3, 5, 6, 7, 8]);
        assert_eq!(grid.all_neighbours(11), [7, 8, 10]);
        assert_eq!((0..12).filter(|&cell| !grid.is_border(cell)).collect::<Vec<_>>(), [4, 7]);
        assert_eq!(grid.cell_size(), 0.5);
        assert_eq!(grid.mean(&[0, 2, 9, 11]), [0.5, 0.5]);
        assert_eq!(grid.nearest(&[-9.0, f64::NAN]), 0);
        assert_eq!(Grid::new(&[axis("x", 1.0, 1.0, 1)]).nearest(&[3.0]), 0);
    }
}
