//! Inverse kinematics of closed chains: the working modes of a parallel robot for a pose of its
//! platform.
//!
//! Method   the platform is tied to a chain from the target whose joints are the free components of
//!          the task (`closure/position/platform.rs`); its assemblies from the initial guess and from
//!          random restarts within the limits are the solutions, one of each assembly mode
//! Shapes   q: the n coordinates of the mechanism, passive ones included
//! Units    m, rad
//! Valid    any mechanism with loops or contacts, one frame, any translations, an orientation of which
//!          all, none, or all but one component are given. Modes may be missed, since restarts are
//!          random; failure is no proof that none exists, unless the target is farther away than the
//!          joints of the tree that carry the frame, for which no search is needed
//! Why so   loops and target are closed together: solving the tree first and closing the loops after
//!          it would leave the target
//! Checked  tests/map/inverse.rs

use super::convergence::is_admissible;
use super::goal::{Goal, Objective, check_each};
use super::options::IkOptions;
use super::reason::MissReason;
use super::solution::{FoundBy, Solution};
use crate::closure::{
    AssemblyModes, ModeOptions, Platform, PlatformChain, PlatformRotation, assemble, assembly_modes,
};
use crate::error::{Error, Result};
use crate::kinematics::{Chain, EndEffector, ReferenceFrame};
use crate::model::{Dimension, Mechanism};
use crate::spatial::{Pose, Vec3};
use crate::task::Task;

/// Iterations of the budget that one start may take.
const ITERATIONS_PER_START: usize = 200;
/// Starts of the search without limits.
const UNLIMITED_STARTS: usize = 16;

/// A frame of a closed chain and its target.
#[derive(Debug, Clone, Copy)]
struct FrameGoal {
    end_effector: EndEffector,
    task: Task,
    target: Pose,
}

/// Up to `count` configurations of a closed chain that reach the goal, the closest to the initial
/// guess first; otherwise one failure with its reason.
pub(super) fn solve_closed(
    mechanism: &Mechanism,
    goals: &[Goal],
    options: &IkOptions,
    count: usize,
) -> Result<Vec<Solution>> {
    options.check(mechanism)?;
    check_each(mechanism, goals)?;
    let goal = the_frame(mechanism, goals, options)?;
    let home = mechanism.home().to_vec();
    let guess = options.initial_guess.clone().unwrap_or(home);
    let platform = goal.platform(mechanism)?;
    let first_only = count == 1 && !options.nearest && options.posture.is_none();
    let most = (options.budget.iterations / ITERATIONS_PER_START).max(1);
    let starts = |starts: usize| ModeOptions { starts, seed: options.seed };
    let search = |platform: &Platform, how: ModeOptions| -> Result<AssemblyModes> {
        let all = platform.extended(&guess)?;
        assembly_modes(&platform.mechanism, &all, &options.fixed, how)
    };
    let mut solutions = Vec::new();
    let mut tried = 0;
    let out_of_reach = goal.out_of_reach(mechanism, options.position_tolerance)?;
    // The guess alone reaches most targets nearby.
    let numbers = match out_of_reach {
        Some(_) => Vec::new(),
        None if first_only => vec![1, 8.min(most), most],
        None => vec![most],
    };
    for number in numbers {
        let found = search(&platform, starts(number))?;
        tried += number;
        for mode in &found.modes {
            let q = &mode.assembly.q[..mechanism.n()];
            let solution = goal.solution(mechanism, q, (found.first.steps, tried))?;
            let reached = solution.position_error <= options.position_tolerance
                && solution.orientation_error <= options.orientation_tolerance
                && is_admissible(mechanism, q);
            if reached {
                solutions.push(Solution { success: true, reason: None, ..solution });
            }
        }
        if !solutions.is_empty() {
            if let Some(posture) = &options.posture {
                let from = |s: &Solution| {
                    s.q.iter().zip(posture).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
                };
                solutions.sort_by(|a, b| from(a).total_cmp(&from(b)));
            }
            solutions.truncate(count.max(1));
            return Ok(solutions);
        }
    }
    // Loops closed as near to the best attempt as possible.
    let attempt = search(&platform, starts(1))?.first.q;
    let closest = assemble(mechanism, &attempt[..mechanism.n()], &options.fixed)?.q;
    let miss = Solution { out_of_reach, ..goal.solution(mechanism, &closest, (0, tried))? };
    let unlimited = mechanism.without_position_limits();
    let proof = out_of_reach.map(|(distance, length)| MissReason::OutOfReach { distance, length });
    if proof.is_some() && goal.out_of_reach(&unlimited, options.position_tolerance)?.is_some() {
        return Ok(vec![Solution { reason: proof, ..miss }]);
    }
    let unlimited = goal.platform(&unlimited)?;
    let beyond = search(&unlimited, starts(UNLIMITED_STARTS.min(most)))?;
    let names = |q: &[f64]| -> Vec<String> {
        mechanism.outside_limits(q).map(|i| mechanism.coordinates()[i].name.clone()).collect()
    };
    let outside = beyond.modes.iter().map(|mode| names(&mode.assembly.q[..mechanism.n()]));
    let fewest = outside.filter(|joints| !joints.is_empty()).min_by_key(Vec::len);
    let limits = fewest.map(|joints| MissReason::Limits { joints });
    let reason = limits.or(proof).unwrap_or(MissReason::NotProven);
    Ok(vec![Solution { reason: Some(reason), ..miss }])
}

/// The one frame of the goals, after a check of goals and options.
fn the_frame(mechanism: &Mechanism, goals: &[Goal], options: &IkOptions) -> Result<FrameGoal> {
    let refuse = |option: &'static str, value: &str, reason: &str| {
        Err(Error::InvalidOption { option, value: value.to_owned(), reason: reason.to_owned() })
    };
    if !options.half_spaces.is_empty() {
        return refuse("half_spaces", "of a closed chain", "they count for serial arms only");
    }
    if let Some(criterion) = &options.criterion {
        let reason = "the self-motion of a closed chain is not followed; ask for the nearest of its \
                      modes, or for all of them";
        return refuse("criterion", criterion.name(), reason);
    }
    let [Goal { objective: Objective::Frame { end_effector, components, target }, .. }] = *goals
    else {
        let reason = "inverse kinematics of a closed chain takes one frame with its target";
        return refuse("goals", &format!("{} of '{}'", goals.len(), mechanism.name()), reason);
    };
    Ok(FrameGoal { end_effector, task: components, target })
}

impl FrameGoal {
    /// The mechanism tied to a chain of the components that the task leaves free.
    fn platform(&self, mechanism: &Mechanism) -> Result<Platform> {
        let Self { end_effector, task, target } = *self;
        let local = task.axes == ReferenceFrame::Local;
        // The axes of the task are those of the zero pose; the tool is rotated along.
        let (zero, tool) = if local || mechanism.dimension() == Dimension::Planar {
            (target, end_effector)
        } else {
            let turn = target.rotation.inverse();
            let mut tool = end_effector;
            tool.frame_from_tool.rotation = tool.frame_from_tool.rotation * turn;
            (Pose::from_translation(target.translation), tool)
        };
        let [.., rx, ry, rz] = task.components;
        let rotation = match [rx, ry, rz] {
            _ if mechanism.dimension() == Dimension::Planar && rz => PlatformRotation::Fixed,
            [true, true, true] => PlatformRotation::Fixed,
            [false, true, true] => PlatformRotation::About(Vec3::X),
            [true, false, true] => PlatformRotation::About(Vec3::Y),
            [true, true, false] => PlatformRotation::About(Vec3::Z),
            [false, false, false] => PlatformRotation::Free,
            _ if mechanism.dimension() == Dimension::Planar => PlatformRotation::Free,
            _ => {
                return Err(Error::InvalidOption {
                    option: "task",
                    value: "one rotation".to_owned(),
                    reason: "of the orientation of a closed chain give all components, two or none"
                        .to_owned(),
                });
            }
        };
        let [x, y, z, ..] = task.components;
        let chain = PlatformChain { world_from_zero: zero, slides: [!x, !y, !z], rotation };
        Platform::of(mechanism, tool, chain)
    }

    /// The distance of the target from the first joint that carries the frame, over the components of
    /// the task, and the length of the chain from there, if that is shorter: loops only take motions
    /// away.
    fn out_of_reach(&self, mechanism: &Mechanism, tolerance: f64) -> Result<Option<(f64, f64)>> {
        let Task { components: [x, y, z, ..], axes } = self.task;
        let on = [x, y, z && mechanism.dimension() == Dimension::Spatial];
        if axes == ReferenceFrame::Local && on != [true; 3] {
            return Ok(None);
        }
        let chain = Chain::new(mechanism, self.end_effector)?;
        let away = (self.target.translation - chain.first_origin()).to_array();
        let along = away.iter().zip(on).map(|(x, on)| if on { *x } else { 0.0 });
        let far = crate::linalg::norm(&along.collect::<Vec<_>>());
        let length = chain.length_after_first_joint(mechanism);
        Ok((far > length * (1.0 + 1e-12) + tolerance).then_some((far, length)))
    }

    /// The errors of a configuration.
    fn solution(
        &self,
        mechanism: &Mechanism,
        q: &[f64],
        (iterations, restarts): (usize, usize),
    ) -> Result<Solution> {
        let pose = mechanism.state(q)?.pose_of(self.end_effector);
        let mut task = self.task;
        if mechanism.dimension() == Dimension::Planar {
            for (on, in_plane) in task.components.iter_mut().zip(Task::PLANAR.components) {
                *on &= in_plane;
            }
        }
        let error = task.error(pose, self.target);
        Ok(Solution {
            success: false,
            q: q.to_vec(),
            position_error: error.linear.norm(),
            orientation_error: error.angular.norm(),
            found_by: FoundBy::Numerical,
            iterations,
            restarts,
            out_of_reach: None,
            criterion: None,
            reason: None,
        })
    }
}
