//! Configurations that reach given poses of the tool, by inverse kinematics.
//!
//! Method   of pose i the solution of `ik::solve` from home: the same restarts for each, so that a row
//!          depends on its own pose alone
//! Units    m, rad; tolerances of inverse kinematics, that of positions times the reach of the mechanism
//! Valid    any mechanism; of closed chains one frame, its orientation whole, without one component or
//!          not at all. What is not reached is proven for exact closed forms and targets beyond the
//!          length of the chain, otherwise not found
//! Why so   the solution of the pose before would be a better guess, but a part could not be computed
//!          alone
//! Checked  tests/sweep/pose_files.rs

use std::ops::Range;

use crate::error::{Error, Result};
use crate::ik::{Budget, Goal, IkOptions, Solution, Solver, solve};
use crate::kinematics::EndEffector;
use crate::model::Mechanism;
use crate::spatial::Pose;
use crate::task::Task;
use crate::tolerance::{IK_POSITION, MAX_MAGNITUDE};

/// Poses, and what is needed to reach them.
#[derive(Debug, Clone)]
pub(super) struct PoseSolutions {
    mechanism: Mechanism,
    targets: Vec<Pose>,
    end_effector: EndEffector,
    task: Task,
    options: IkOptions,
    /// Of trees.
    solver: Option<Solver>,
}

impl PoseSolutions {
    pub(super) fn new(
        mechanism: &Mechanism,
        end_effector: EndEffector,
        targets: &[Pose],
        task: Task,
    ) -> Result<Self> {
        for (row, pose) in targets.iter().enumerate() {
            let what = format!("poses, row {row} from 0");
            if !pose.is_finite() {
                return Err(Error::NotFinite { what, value: f64::NAN });
            }
            Error::check_within(&what, &pose.translation.to_array(), MAX_MAGNITUDE)?;
        }
        let options = IkOptions {
            position_tolerance: IK_POSITION * mechanism.reach(),
            ..IkOptions::default()
        };
        let all = Self {
            mechanism: mechanism.clone(),
            targets: targets.to_vec(),
            end_effector,
            task,
            options,
            solver: None,
        };
        let goal = all.goal(mechanism.state(mechanism.home())?.pose_of(end_effector));
        if mechanism.is_closed() {
            // Tasks that closed chains do not have are refused before the first row.
            let budget = Budget { iterations: 1, ..all.options.budget };
            solve(mechanism, &goal, &IkOptions { budget, ..all.options.clone() })?;
            return Ok(all);
        }
        let solver = Some(Solver::new(mechanism, &goal, &all.options)?);
        Ok(Self { solver, ..all })
    }

    pub(super) fn rows(&self) -> u64 {
        self.targets.len() as u64
    }

    fn goal(&self, target: Pose) -> [Goal; 1] {
        [Goal::frame(self.end_effector, self.task, target)]
    }

    /// Those of `rows` into `out`; rows whose pose is not reached have home, and are returned.
    pub(super) fn write(&self, rows: Range<u64>, out: &mut [f64]) -> Result<Vec<usize>> {
        let at = |row: u64| usize::try_from(row).unwrap_or(usize::MAX);
        let targets = &self.targets[at(rows.start)..at(rows.end)];
        let mut solver = self.solver.clone();
        let mut absent = Vec::new();
        let configurations = out.chunks_exact_mut(self.mechanism.n());
        for (row, (q, target)) in configurations.zip(targets).enumerate() {
            let goal = self.goal(*target);
            let found = match &mut solver {
                Some(solver) => solver.solve(&goal)?,
                None => solve(&self.mechanism, &goal, &self.options)?,
            };
            match found {
                Solution { success: true, q: solution, .. } => q.copy_from_slice(&solution),
                _ => {
                    q.copy_from_slice(self.mechanism.home());
                    absent.push(row);
                }
            }
        }
        Ok(absent)
    }
}
