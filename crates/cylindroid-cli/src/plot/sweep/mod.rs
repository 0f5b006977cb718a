//! The rows of a sweep: a grid as slices, poses as clouds of points, other rows as histograms.

mod cloud;
mod histogram;
mod plan;
mod shade;
mod slices;

use std::path::Path;

use cylindroid::Result;

use self::plan::{Kind, Name};
pub(crate) use self::plan::{Picture, plan};
use self::shade::Shade;
use super::save;

impl Picture {
    /// Draws the columns, those of [`Picture::columns`].
    pub(crate) fn draw(&self, data: &[Vec<f64>], path: &Path) -> Result<()> {
        let mut columns = data.iter().map(Vec::as_slice);
        let color =
            self.color.as_ref().map(|name| self.shade(name, columns.next().unwrap_or_default()));
        let others: Vec<&[f64]> = columns.collect();
        save(path, |svg| match (&self.kind, color) {
            (Kind::Slices(axes), Some((shade, color))) => {
                slices::draw(svg, &self.title, (axes, &others), (&shade, &color))
            }
            (Kind::Cloud { pairs, .. }, color) => {
                let color = color.as_ref().map(|(shade, numbers)| (shade, numbers.as_slice()));
                cloud::draw(svg, &self.title, (pairs, &others), color)
            }
            (Kind::Histograms(names), _) => histogram::draw(svg, &self.title, names, &others),
            (Kind::Slices(_), None) => Ok(()),
        })
    }

    /// The colours of a column, and its numbers with those that have none as NaN.
    fn shade(&self, name: &Name, numbers: &[f64]) -> (Shade, Vec<f64>) {
        let of = |x: &f64| if self.leaves_out_zero && *x == 0.0 { f64::NAN } else { *x };
        let numbers: Vec<f64> = numbers.iter().map(of).collect();
        (Shade::of(name, &numbers), numbers)
    }
}
