//! The configurations of `sweep` and `optimise`.

use std::path::{Path, PathBuf};

use cylindroid::control::Task;
use cylindroid::spatial::Rpy;
use cylindroid::sweep::{Axis, AxisKinds, Source, VoxelGrid};
use cylindroid::{Error, Mechanism, Pose, Vec3};

use crate::args::{AxisArg, Count, OptimiseArgs, SweepArgs};
use crate::number_file;
use crate::output;
use crate::values::Joints;

/// The arguments that choose configurations.
pub(crate) struct Chosen<'a> {
    pub(crate) over: &'a [AxisArg],
    pub(crate) samples: Option<Count>,
    pub(crate) seed: u64,
    pub(crate) configurations: Option<&'a PathBuf>,
    /// Poses that inverse kinematics reaches, and the components that count.
    pub(crate) poses: Option<(&'a Path, Option<&'a str>)>,
    /// The points of a capability map.
    pub(crate) reach: Option<VoxelGrid>,
    pub(crate) q: &'a Joints,
    pub(crate) srdf: Option<&'a Path>,
}

impl<'a> From<&'a SweepArgs> for Chosen<'a> {
    fn from(args: &'a SweepArgs) -> Self {
        let SweepArgs { over, samples, seed, configurations, poses, task, q, model, .. } = args;
        Self {
            over,
            samples: *samples,
            seed: *seed,
            configurations: configurations.as_ref(),
            poses: poses.as_deref().map(|path| (path, task.as_deref())),
            reach: reach(args),
            q,
            srdf: model.srdf.as_deref(),
        }
    }
}

/// The points of a capability map.
fn reach(args: &SweepArgs) -> Option<VoxelGrid> {
    let grid = VoxelGrid::default();
    let world_from_grid = args.reach_from.map_or(grid.world_from_grid, |from| {
        let [x, y, z, roll, pitch, yaw] = from.0;
        let rotation = Rpy { roll, pitch, yaw }.rotation();
        Pose { rotation, translation: Vec3::new(x, y, z) }
    });
    (!args.reach.is_empty()).then(|| VoxelGrid {
        axes: args.reach.iter().map(|axis| axis.0.clone()).collect(),
        world_from_grid,
        directions: args.directions.map_or(grid.directions, |count| count.0),
        rolls: args.rolls.map_or(grid.rolls, |count| count.0),
    })
}

impl<'a> From<&'a OptimiseArgs> for Chosen<'a> {
    fn from(args: &'a OptimiseArgs) -> Self {
        let OptimiseArgs { over, samples, seed, configurations, q, model, .. } = args;
        Self {
            over,
            samples: *samples,
            seed: *seed,
            configurations: configurations.as_ref(),
            poses: None,
            reach: None,
            q,
            srdf: model.srdf.as_deref(),
        }
    }
}

impl Chosen<'_> {
    fn kinds(&self, robot: &Mechanism) -> cylindroid::Result<AxisKinds> {
        AxisKinds::of(self.over.iter().map(|axis| axis.0.clone()).collect(), robot)
    }

    /// The axes of parameters.
    pub(crate) fn parameters(&self, robot: &Mechanism) -> cylindroid::Result<Vec<Axis>> {
        Ok(self.kinds(robot)?.parameters)
    }

    /// The configurations, of each design if there are designs.
    pub(crate) fn source(&self, robot: &Mechanism) -> cylindroid::Result<Source> {
        let kinds = self.kinds(robot)?;
        let chosen = [
            ("samples", self.samples.is_some()),
            ("configurations", self.configurations.is_some()),
            ("poses", self.poses.is_some()),
            ("reach", self.reach.is_some()),
        ];
        let chosen = chosen.iter().find(|(_, is_given)| *is_given).map(|(name, _)| name);
        if let (Some(axis), Some(chosen)) = (kinds.coordinates.first(), chosen) {
            return Err(Error::InvalidOption {
                option: "--over",
                value: axis.name.clone(),
                reason: format!("a coordinate is an axis or one of --{chosen}, not both"),
            });
        }
        if let Some(grid) = &self.reach {
            return Ok(Source::Voxels(grid.clone()));
        }
        if let Some((path, task)) = self.poses {
            let task = Task::named(task.unwrap_or("pose"), robot)?;
            let numbers = number_file::columns(path, Source::pose_columns(task))?;
            return Source::poses(&numbers, task);
        }
        if let Some(path) = self.configurations {
            let names = output::joint_names(robot);
            return Ok(Source::Configurations(number_file::configurations(path, &names)?));
        }
        if let Some(count) = self.samples {
            return Ok(Source::Samples { count: count.0, seed: self.seed });
        }
        let rest = self.q.configuration(robot, self.srdf, false)?;
        Ok(match kinds.coordinates {
            axes if !axes.is_empty() => Source::Grid { axes, rest },
            _ if *self.q == Joints::Home => Source::Home,
            _ => Source::Configurations(rest),
        })
    }

    /// The configurations in words; `rows` of them.
    pub(crate) fn words(&self, source: &Source, rows: u64) -> String {
        match source {
            Source::Samples { seed, .. } => format!("{rows} samples, seed {seed}"),
            Source::Grid { axes, .. } => {
                let counts: Vec<String> = axes.iter().map(|a| a.count.to_string()).collect();
                format!("grid of {}", counts.join(" x "))
            }
            Source::Voxels(grid) => {
                let counts: Vec<String> = grid.axes.iter().map(|a| a.count.to_string()).collect();
                let orientations = match (grid.directions, grid.rolls) {
                    (0, _) => "any orientation".to_owned(),
                    (directions, 0) => format!("{directions} directions, any roll"),
                    (directions, 1) => format!("{directions} directions"),
                    (directions, rolls) => format!("{directions} directions x {rolls} rolls"),
                };
                format!("{} points, {orientations}", counts.join(" x "))
            }
            Source::Poses { .. } => format!("{rows} poses of a file"),
            Source::Home => "home".to_owned(),
            _ if self.configurations.is_none() => "that of --q".to_owned(),
            _ => format!("{rows} of a file"),
        }
    }
}
