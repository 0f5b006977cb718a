//! What of a sweep is drawn, decided before it is computed.

use cylindroid::model::Dimension;
use cylindroid::sweep::{Axis, Column, Source, Sweep};
use cylindroid::{Error, Mechanism, Result};

/// Width of the bar of colours [px].
pub(super) const BAR: u32 = 160;
/// Most panels that are drawn.
pub(super) const PANELS: usize = 12;
/// Cells of slices at most.
const MOST_CELLS: u64 = 250_000;
/// Rows of a cloud or histogram at most.
const ROWS: u64 = 1 << 14;

/// A column: its name and unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Name {
    pub(super) name: String,
    pub(super) unit: String,
}

impl Name {
    /// For an axis.
    pub(super) fn label(&self) -> String {
        format!("{}{}", self.name, self.unit_label())
    }

    /// The unit in brackets.
    pub(super) fn unit_label(&self) -> String {
        match self.unit.as_str() {
            "" | "1" => String::new(),
            unit => format!(" [{unit}]"),
        }
    }
}

/// An axis of a slice.
#[derive(Debug, Clone)]
pub(super) struct SliceAxis {
    pub(super) axis: Axis,
    pub(super) name: Name,
}

#[derive(Debug, Clone)]
pub(super) enum Kind {
    /// Two axes, and a third with a slice at each of its values.
    Slices(Vec<SliceAxis>),
    /// Places of the columns that are drawn against one another, a panel for each.
    Cloud {
        names: Vec<Name>,
        pairs: Vec<[usize; 2]>,
    },
    Histograms(Vec<Name>),
}

/// A drawing of a sweep.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pub(super) title: String,
    pub(super) color: Option<Name>,
    /// Zero is nothing: what is not reached has no colour.
    pub(super) leaves_out_zero: bool,
    pub(super) kind: Kind,
    /// Number of rows that are drawn.
    pub(crate) rows: u64,
}

impl Picture {
    /// The columns that [`Picture::draw`] needs.
    pub(crate) fn columns(&self) -> Vec<&str> {
        let names: Vec<&Name> = match &self.kind {
            Kind::Slices(axes) => axes.iter().map(|axis| &axis.name).collect(),
            Kind::Cloud { names, .. } | Kind::Histograms(names) => names.iter().collect(),
        };
        self.color.iter().chain(names).map(|name| name.name.as_str()).collect()
    }

    /// True if all rows are drawn, not some of them.
    pub(crate) const fn is_of_all(&self) -> bool {
        matches!(self.kind, Kind::Slices(_))
    }
}

fn refuse<T>(option: &'static str, value: &str, reason: &str) -> Result<T> {
    Err(Error::InvalidOption { option, value: value.to_owned(), reason: reason.to_owned() })
}

/// The drawing of a sweep; `parameters` are the axes of its designs.
pub(crate) fn plan(
    robot: &Mechanism,
    sweep: &Sweep,
    (source, parameters): (&Source, &[Axis]),
    color: Option<&str>,
) -> Result<Picture> {
    let name = |column: &Column| Name { name: column.name.clone(), unit: column.unit.to_string() };
    let columns = sweep.columns().iter().filter(|column| column.is_number());
    let columns: Vec<Name> = columns.map(name).collect();
    let find = |own: &str| columns.iter().find(|column| column.name == own).cloned();
    let is_map = sweep.voxels().is_some();
    // Columns of single quantities; those of several are vectors, or too many.
    let index = |column: &&Name| {
        let of_quantity = sweep.quantities().iter().any(|q| q.name() == column.name);
        of_quantity || is_map && (column.name == "reachability" || column.name.starts_with("best_"))
    };
    let is_chosen = color.is_some();
    let color = match color {
        None => columns.iter().find(index).cloned(),
        Some(own) => match find(own) {
            Some(own) => Some(own),
            None => {
                let known = columns.iter().map(|column| &column.name);
                return Err(Error::unknown("column", own, known));
            }
        },
    };
    let axes: &[Axis] = match source {
        Source::Grid { axes, .. } => axes,
        Source::Voxels(grid) => &grid.axes,
        _ => &[],
    };
    let is_grid = sweep.rows() == parameters.iter().chain(axes).map(|a| a.count).product::<u64>();
    let axes: Vec<SliceAxis> = parameters
        .iter()
        .chain(axes)
        .filter(|axis| axis.count > 1)
        .filter_map(|axis| Some(SliceAxis { axis: axis.clone(), name: find(&axis.name)? }))
        .collect();
    let frame = &robot.frame_of(sweep.end_effector().frame).name;
    let base = sweep.relative_to().map(|base| &robot.frame_of(base).name);
    let base = base.map(|base| format!(" relative to {base}")).unwrap_or_default();
    let title = format!("{}: {frame}{base}", robot.name());
    let leaves_out_zero = is_map
        && color.as_ref().is_some_and(|c| {
            ["reachability", "orientation_share", "directions", "orientations"]
                .contains(&c.name.as_str())
        });
    let picture =
        |kind: Kind, color, rows| Ok(Picture { title, color, leaves_out_zero, kind, rows });
    if is_grid && (2..=3).contains(&axes.len()) && color.is_some() {
        if sweep.rows() > MOST_CELLS {
            let value = format!("{} cells", sweep.rows());
            return refuse("--plot", &value, "at most 250 000 can be drawn; take fewer values");
        }
        return picture(Kind::Slices(with_panels_last(axes)), color, sweep.rows());
    }
    let rows = sweep.rows().min(ROWS);
    let position: Vec<Name> = ["x", "y", "z"].iter().filter_map(|own| find(own)).collect();
    let is_pose = sweep.quantities().iter().any(|q| q.name() == "pose") || is_map;
    if is_pose && position.len() > 1 {
        let is_planar = robot.dimension() == Dimension::Planar || position.len() == 2;
        let pairs = if is_planar { vec![[0, 1]] } else { vec![[0, 1], [0, 2], [1, 2]] };
        return picture(Kind::Cloud { names: position, pairs }, color, rows);
    }
    let is_place = |column: &Name| {
        let before = ["index", "design", "design_valid"].contains(&column.name.as_str());
        let coordinate = robot.coordinates().iter().any(|c| c.name == column.name);
        before || coordinate || parameters.iter().any(|axis| axis.name == column.name)
    };
    let names = match color {
        Some(color) if is_chosen => vec![color],
        _ => columns.iter().filter(|c| !is_place(c)).take(PANELS).cloned().collect(),
    };
    if names.is_empty() {
        return refuse("--plot", "no column of numbers", "name quantities or --color");
    }
    picture(Kind::Histograms(names), None, rows)
}

/// Of three axes the one with fewest values last: it has the panels.
fn with_panels_last(mut axes: Vec<SliceAxis>) -> Vec<SliceAxis> {
    if axes.len() == 3 {
        let fewest = (0..3).rev().min_by_key(|i| axes[*i].axis.count).unwrap_or(2);
        let panels = axes.remove(fewest);
        axes.push(panels);
    }
    axes
}
