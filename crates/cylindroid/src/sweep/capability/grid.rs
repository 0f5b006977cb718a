//! The grid of a capability map: point i is a function of i alone.
//!
//! Formula  point (i, j, k) of the grid in world axes: p = world_from_grid (x_i, y_j, z_k); z changes
//!          fastest
//! Units    m
//! Valid    arms without loops, in space and in the plane. Finite sets of orientations need six joints
//!          that move the tool (three in the plane), directions alone five, positions three (two)
//! Source   Zacharias, Borst & Hirzinger 2007 (reachability index: the share of approach directions
//!          that are reached); Porges, Stouraitis, Borst & Roa 2014 (share of all orientations)
//! Checked  tests/sweep/capability.rs

use super::super::axis::{Axis, points};
use super::super::quantity::Quantity;
use super::super::table::Column;
use crate::error::{Error, Result};
use crate::kinematics::{Chain, EndEffector};
use crate::model::{Dimension, Mechanism};
use crate::spatial::{Pose, Vec3};
use crate::task::Task;
use crate::tolerance::MAX_MAGNITUDE;

/// Approach directions at most, rolls at most, and orientations at most.
const MOST: [u64; 3] = [10_000, 360, 100_000];

/// Points of a grid with the orientations of the tool that inverse kinematics is asked for there.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelGrid {
    /// Of `x`, `y` and `z` (m), in the plane of `x` and `y`; those that are not named are 0. z changes
    /// fastest, x slowest, whatever their order.
    pub axes: Vec<Axis>,
    /// The axes in which points and orientations are given: those of the world by default.
    pub world_from_grid: Pose,
    /// Number of approach directions of the tool's z axis, evenly spread over the sphere; in the plane
    /// of angles of the tool. 0: any orientation, the position counts alone.
    pub directions: u64,
    /// Number of rotations about each direction. 0: any, the direction counts alone. Ignored in the
    /// plane and without directions.
    pub rolls: u64,
}

impl Default for VoxelGrid {
    fn default() -> Self {
        Self {
            axes: Vec::new(),
            world_from_grid: Pose::IDENTITY,
            directions: Self::DIRECTIONS,
            rolls: Self::ROLLS,
        }
    }
}

impl VoxelGrid {
    /// Approach directions by default.
    pub const DIRECTIONS: u64 = 50;

    /// Rotations about each by default.
    pub const ROLLS: u64 = 12;
}

/// A grid for a mechanism, checked.
#[derive(Debug, Clone)]
pub(in super::super) struct Voxels {
    /// Of x, y and z.
    axes: [Axis; 3],
    pub(in super::super) grid: VoxelGrid,
}

impl Voxels {
    pub(in super::super) fn new(mechanism: &Mechanism, grid: &VoxelGrid) -> Result<Self> {
        let refuse = |option: &'static str, value: String, reason: &str| {
            Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
        };
        let is_planar = mechanism.dimension() == Dimension::Planar;
        let names = if is_planar { &["x", "y"][..] } else { &["x", "y", "z"] };
        if grid.axes.is_empty() {
            return refuse("reach", String::new(), "name at least one of x, y, z");
        }
        let mut axes = ["x", "y", "z"].map(|name| Axis {
            name: name.to_owned(),
            from: 0.0,
            to: 0.0,
            count: 1,
        });
        for (i, axis) in grid.axes.iter().enumerate() {
            let place = names.iter().position(|name| *name == axis.name);
            let place = place.ok_or_else(|| Error::unknown("axis", &axis.name, names))?;
            if grid.axes[..i].iter().any(|other| other.name == axis.name) {
                return refuse("reach", axis.name.clone(), "an axis can be named only once");
            }
            Error::check_within(&axis.name, &[axis.from, axis.to], MAX_MAGNITUDE)?;
            axes[place] = axis.clone();
        }
        points(&axes)?;
        if !grid.world_from_grid.is_finite() {
            return Err(Error::NotFinite { what: "world_from_grid".to_owned(), value: f64::NAN });
        }
        let z = grid.world_from_grid.rotation * Vec3::Z;
        let is_in_plane = z == Vec3::Z && grid.world_from_grid.translation.z == 0.0;
        if is_planar && !is_in_plane {
            let reason = "in the plane a grid is turned about z and moved along x and y";
            return refuse("world_from_grid", "a pose out of the plane".to_owned(), reason);
        }
        let grid = match grid.directions {
            0 => VoxelGrid { rolls: 0, ..grid.clone() },
            _ if is_planar => VoxelGrid { rolls: 1, ..grid.clone() },
            _ => grid.clone(),
        };
        let [directions, rolls, all] = MOST;
        if grid.directions > directions {
            return refuse(
                "directions",
                grid.directions.to_string(),
                "at most 10 000 are possible",
            );
        }
        if grid.rolls > rolls {
            return refuse("rolls", grid.rolls.to_string(), "at most 360 are possible");
        }
        if grid.directions * grid.rolls.max(1) > all {
            let value = format!("{} x {}", grid.directions, grid.rolls);
            return refuse("directions", value, "at most 100 000 orientations are possible");
        }
        Ok(Self { axes, grid })
    }

    pub(in super::super) fn rows(&self) -> u64 {
        self.axes.iter().map(|axis| axis.count).product()
    }

    /// The point of a row, in axes of the grid.
    pub(super) fn point(&self, row: u64) -> Vec3 {
        let mut left = row;
        let mut values = [0.0; 3];
        for (axis, value) in self.axes.iter().zip(&mut values).rev() {
            *value = axis.value(left % axis.count);
            left /= axis.count;
        }
        Vec3::from_array(values)
    }

    /// The components of the tool's pose that count. An error for a tool that too few joints move.
    pub(super) fn task(&self, mechanism: &Mechanism, end_effector: EndEffector) -> Result<Task> {
        let is_planar = mechanism.dimension() == Dimension::Planar;
        let (task, needed) = match (self.grid.directions, self.grid.rolls, is_planar) {
            (0, _, false) => (Task::POSITION, 3),
            (_, 0, false) => (Task::POINTING, 5),
            (_, _, false) => (Task::POSE, 6),
            (0, _, true) => {
                let components = [true, true, false, false, false, false];
                (Task { components, ..Task::POSITION }, 2)
            }
            (_, _, true) => (Task::PLANAR, 3),
        };
        let joints = Chain::of(mechanism, end_effector).n();
        if joints >= needed {
            return Ok(task);
        }
        let (option, value, other) = match (self.grid.directions, self.grid.rolls) {
            (0, _) => ("reach", 0, "no volume of positions"),
            (n, 0) => ("directions", n, "no finite set of directions; 0 asks for positions alone"),
            (_, n) if joints == 5 => {
                ("rolls", n, "no finite set of orientations; 0 asks for directions alone")
            }
            (n, _) => {
                ("directions", n, "no finite set of orientations; 0 asks for positions alone")
            }
        };
        Err(Error::InvalidOption {
            option,
            value: value.to_string(),
            reason: format!("{joints} joints move the tool, which reach {other}"),
        })
    }
}

/// True for quantities that have a best value over the solutions of a point.
const fn is_index(quantity: Quantity) -> bool {
    matches!(
        quantity,
        Quantity::SmallestSingularValue
            | Quantity::Condition
            | Quantity::Yoshikawa
            | Quantity::LimitDistance
            | Quantity::SelfDistance
            | Quantity::ObstacleDistance
            | Quantity::Payload
    )
}

/// The columns of a capability map, after `index`.
pub(in super::super) fn columns(
    mechanism: &Mechanism,
    quantities: &[Quantity],
) -> Result<Vec<Column>> {
    let is_planar = mechanism.dimension() == Dimension::Planar;
    let names = if is_planar { &["x", "y"][..] } else { &["x", "y", "z"] };
    let place = "point of the grid, in its axes";
    let mut columns: Vec<Column> =
        names.iter().map(|name| Column::number(name, "m", place)).collect();
    columns.extend([
        Column::count("directions", "approach directions that are reached with some roll"),
        Column::count("orientations", "orientations that are reached"),
        Column::number("reachability", "1", "share of the approach directions"),
        Column::number("orientation_share", "1", "share of the orientations"),
    ]);
    for quantity in quantities {
        if !is_index(*quantity) {
            return Err(Error::InvalidOption {
                option: "quantities",
                value: quantity.name().to_owned(),
                reason:
                    "a capability map has the best value of yoshikawa, smallest_singular_value, \
                         condition, limit_distance, self_distance, obstacle_distance or payload"
                        .to_owned(),
            });
        }
        for column in quantity.columns(mechanism, 1, false) {
            let name = format!("best_{}", column.name);
            let description = match quantity {
                Quantity::Condition => "smallest over the solutions found, NaN without one",
                _ => "largest over the solutions found, NaN without one",
            };
            columns.push(Column { name, description, ..column });
        }
    }
    Ok(columns)
}
