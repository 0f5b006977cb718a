//! Inverse kinematics: configurations that put end effectors where they shall be.
//!
//! [`solve`] takes any tree, any number of joints and end effectors, whole poses or some components
//! of them, and keeps all position limits. It answers with a configuration that was checked by
//! forward kinematics, or with the nearest one that it found and why it stopped. Whole poses of
//! arms whose axes have a structure are solved by formulas, which [`Analytic`] gives alone.
//!
//! ```
//! use cylindroid::ik::{Goal, IkOptions, solve};
//!
//! let robot = cylindroid::load("panda")?;
//! let target = robot.state(&[0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5])?.pose(robot.tool());
//! let found = solve(&robot, &[Goal::pose(robot.tool(), target)], &IkOptions::default())?;
//! assert!(found.success && found.position_error < 1e-5);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod analytic;
mod closed_form;
mod convergence;
mod damped_step;
mod goal;
mod levenberg_marquardt;
mod options;
mod parallel_restarts;
mod solve;

pub use analytic::{Analytic, AnalyticSolution, AnalyticSolutions, ArmGeometry, NotSolvable};
pub use goal::{Goal, Task};
pub use options::{Budget, IkOptions};
pub(crate) use solve::ITERATIONS_PER_RESTART;
pub use solve::{FoundBy, Solution, Solver, solve, solve_distinct};
