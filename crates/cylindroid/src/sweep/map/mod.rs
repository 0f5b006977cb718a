//! Maps: the workspace of a mechanism in the coordinates of its platform, for each working mode, with
//! the loci of its singularities.
//!
//! Read in this order: `options`, `problem` (what is prescribed, what is singular), `grid`, `flood`
//! (one working mode from cell to cell), `modes` (all of them), `loci` (curves over two axes), `surfaces`
//! with `tetrahedra` (triangles over three), `region` (sizes and holes). `zone` is the largest ball or box
//! around a configuration without singularities, found by `zone_search` with `zone_problem` and `zone_rays`.
//!
//! ```
//! use cylindroid::sweep::{Axis, LocusKind, Map, MapOptions};
//!
//! // Where the coupler of a five-bar gets, in steps of a quarter of a metre.
//! let five_bar = cylindroid::load("five-bar")?;
//! let axis = |name: &str, from, to, count| Axis { name: name.to_owned(), from, to, count };
//! let axes = vec![axis("x", -1.0, 3.0, 17), axis("y", 0.0, 3.0, 13)];
//! let map = Map::of(&five_bar, MapOptions { axes, ..MapOptions::default() })?;
//! assert_eq!(map.modes.len(), 4);
//! assert!(map.loci.iter().any(|locus| locus.kind == LocusKind::TypeOne));
//! # Ok::<(), cylindroid::Error>(())
//! ```
//!
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs, tests/map/surfaces.rs,
//!          tests/map/options.rs, tests/map/threads.rs

mod flood;
mod grid;
mod loci;
mod modes;
mod options;
mod problem;
mod region;
mod result;
mod surfaces;
mod tetrahedra;
mod zone;
mod zone_problem;
mod zone_rays;
mod zone_search;

pub use options::MapOptions;
pub use region::{Hole, Region};
pub use result::{Locus, LocusKind, Surface, WorkingMode};
pub use zone::{Zone, ZoneBound, ZoneComponent, ZoneOptions, ZoneShape};

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use self::grid::Grid;
use self::problem::Problem;
use self::result::working_mode;
use super::workers::Workers;
use super::{Axis, Progress};
use crate::error::{Error, Result};
use crate::model::Mechanism;

/// Between two calls of the observer at least.
const BETWEEN: Duration = Duration::from_millis(100);

/// The workspace of a mechanism over components of its platform's pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// The axes, the last of which changes fastest.
    pub axes: Vec<Axis>,
    /// Components that keep a value (m or rad).
    pub held: Vec<(String, f64)>,
    /// Motions that axes and held components leave: with some, modes are not distinguished,
    /// configurations are one of many, and there are no loci.
    pub free_motions: usize,
    /// Whether the distances to singularities of type I and II have a sign.
    pub signed: [bool; 2],
    /// The working modes, in the order in which they were found.
    pub modes: Vec<WorkingMode>,
    /// Curves of singularities and of limits, for two axes.
    pub loci: Vec<Locus>,
    /// Surfaces of singularities of type II, for three axes.
    pub surfaces: Vec<Surface>,
    grid_cells: usize,
}

impl Map {
    /// The map of a mechanism, computed by as many threads as the machine has.
    ///
    /// # Errors
    /// An unknown or repeated component, axes without values or in descending order, more than 2^22
    /// cells, a start of the wrong size, values that are not finite, a frame of another mechanism.
    #[doc(alias = "workspace")]
    #[doc(alias = "singularity locus")]
    pub fn of(mechanism: &Mechanism, options: MapOptions) -> Result<Self> {
        let mut go_on = |_: &Progress| true;
        Self::computed(mechanism, options, &mut Workers::new(None, &mut go_on))
    }

    /// The same, watched. `threads` and `observe` as in [`Sweep::write`](super::Sweep::write): it is
    /// called ten times a second until it returns false, which stops the computation; `None` then. The
    /// map is the same to the bit whatever the number of threads.
    ///
    /// ```
    /// use cylindroid::sweep::{Axis, Map, MapOptions};
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let axes = vec![Axis { name: "x".to_owned(), from: -1.0, to: 3.0, count: 9 }];
    /// let options = MapOptions { axes, ..MapOptions::default() };
    /// let found = Map::run(&five_bar, options, None, |progress| {
    ///     println!("{} of {} {}", progress.done, progress.rows, progress.unit);
    ///     true // go on
    /// })?;
    /// assert!(found.is_some());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Map::of`].
    pub fn run(
        mechanism: &Mechanism,
        options: MapOptions,
        threads: Option<NonZeroUsize>,
        mut observe: impl FnMut(&Progress) -> bool,
    ) -> Result<Option<Self>> {
        let mut last: Option<(&'static str, Instant)> = None;
        let mut seldom = |progress: &Progress| {
            let recent =
                |(unit, at): (&str, Instant)| unit == progress.unit && at.elapsed() < BETWEEN;
            if last.is_some_and(recent) {
                return true;
            }
            last = Some((progress.unit, Instant::now()));
            observe(progress)
        };
        let mut workers = Workers::new(threads, &mut seldom);
        let map = Self::computed(mechanism, options, &mut workers)?;
        Ok(workers.goes_on().then_some(map))
    }

    /// The map; a part of it if the observer stops the workers.
    fn computed(
        mechanism: &Mechanism,
        options: MapOptions,
        workers: &mut Workers<'_>,
    ) -> Result<Self> {
        let cells = options.cells()?;
        let problem = Problem::new(mechanism, &options)?;
        let grid = Grid::new(&options.axes);
        let modes = modes::modes(&problem, &grid, &options, workers)?;
        let free_motions = problem.free_motions();
        let wanted = options.loci
            && workers.goes_on()
            && free_motions == 0
            && options.axes.iter().all(|axis| axis.count > 1);
        let (loci, surfaces) = match options.axes.len() {
            2 if wanted => {
                (loci::loci(&problem, &grid, &options.axes, &modes, workers)?, Vec::new())
            }
            3 if wanted => (Vec::new(), surfaces::surfaces(&problem, &grid, &modes, workers)?),
            _ => (Vec::new(), Vec::new()),
        };
        let name = |i: usize| {
            let named = problem.components.iter().find(|(_, place)| *place == i);
            named.map_or_else(String::new, |(name, _)| (*name).to_owned())
        };
        Ok(Self {
            held: problem.held.iter().map(|(i, value)| (name(*i), *value)).collect(),
            free_motions,
            signed: [problem.type_one.is_signed(), problem.type_two.is_signed()],
            modes: modes.into_iter().map(|mode| working_mode(mechanism, mode)).collect(),
            loci,
            surfaces,
            axes: options.axes,
            grid_cells: cells,
        })
    }

    /// Number of cells of the grid.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.grid_cells
    }

    /// What the modes reach together: its size, and its holes.
    #[must_use]
    pub fn workspace(&self) -> Region {
        region::region(&Grid::new(&self.axes), &self.modes.iter().collect::<Vec<_>>())
    }

    /// What one of its modes reaches, by its place in `modes`.
    ///
    /// # Errors
    /// A number that is not below the number of modes.
    pub fn workspace_of(&self, mode: usize) -> Result<Region> {
        Ok(region::region(&Grid::new(&self.axes), &[self.mode(mode)?]))
    }

    fn mode(&self, mode: usize) -> Result<&WorkingMode> {
        self.modes.get(mode).ok_or_else(|| Error::InvalidOption {
            option: "mode",
            value: mode.to_string(),
            reason: format!("the map has {} modes, from 0 on", self.modes.len()),
        })
    }

    /// The sections of the surfaces of a mode with the plane of the cells at a place along the third axis:
    /// the values of the other axes at both ends of each segment. They separate the cells of both signs.
    ///
    /// # Errors
    /// A mode that there is not; a place beyond the third axis, or a map without one.
    pub fn section(&self, mode: usize, place: u64) -> Result<Vec<(LocusKind, [[f64; 2]; 2])>> {
        self.mode(mode)?;
        let third = self.axes.get(2).filter(|axis| place < axis.count);
        let third = third.ok_or_else(|| Error::InvalidOption {
            option: "place",
            value: place.to_string(),
            reason: match self.axes.get(2) {
                None => format!("the map has {} axes, a section needs three", self.axes.len()),
                Some(axis) => {
                    format!("'{}' has {} values, from 0 on", axis.name, axis.count)
                }
            },
        })?;
        let own = self.surfaces.iter().filter(|surface| surface.mode == mode);
        let of = |surface: &Surface| {
            let segments = surface.section(third.value(place), place == 0);
            segments.into_iter().map(|ends| (surface.kind, ends)).collect::<Vec<_>>()
        };
        Ok(own.flat_map(of).collect())
    }

    /// The unit of the size of a region, such as "m^2" or "m rad": of the axes with several values.
    #[must_use]
    pub fn size_unit(&self) -> String {
        let several: Vec<&Axis> = self.axes.iter().filter(|axis| axis.count > 1).collect();
        let power = |unit: &str| {
            let of_it = several.iter().filter(|axis| Self::unit(&axis.name) == unit).count();
            match of_it {
                0 => None,
                1 => Some(unit.to_owned()),
                power => Some(format!("{unit}^{power}")),
            }
        };
        let units: Vec<String> = ["m", "rad"].into_iter().filter_map(power).collect();
        if units.is_empty() { "1".to_owned() } else { units.join(" ") }
    }

    /// The unit of a component: "m" of x, y and z, otherwise "rad".
    #[must_use]
    pub fn unit(component: &str) -> &'static str {
        if matches!(component, "x" | "y" | "z") { "m" } else { "rad" }
    }

    /// The values of the axes at a cell.
    #[must_use]
    pub fn values(&self, cell: usize) -> Vec<f64> {
        Grid::new(&self.axes).values(cell)
    }
}
