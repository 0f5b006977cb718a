//! Inverse kinematics: configurations that place end effectors at target poses.
//!
//! [`solve`] accepts any tree with any number of joints and any number of goals: complete poses
//! of frames or some of their components, poses of frames seen from others, the centre of mass,
//! gaze. It respects all position limits and half-spaces. It returns a configuration verified by
//! forward kinematics, or the closest one found. Arms of which three axes intersect or are
//! parallel are solved in closed form for complete poses; [`Analytic`] gives direct access to it.
//!
//! Read `goal` and `options`, then `goal_rows` and `half_space_rows` (errors and Jacobians), then
//! `solve`: the closed form (`closed_form`, `analytic`) first, then random restarts of a damped
//! least-squares iteration (`levenberg_marquardt`), four at once if possible
//! (`parallel_restarts`). The closest solution is that of `nearest` and `self_motion`;
//! A [`Criterion`] takes the place of the distance (`criterion`, `ascent`).
//! `acceptance` decides what a solution is, `avoidance` keeps it apart from other bodies, and
//! `miss` finds the reason where there is none. Closed chains go their own way (`closed_chain`): by
//! assembly with the platform at its target.
//!
//! ```
//! use cylindroid::ik::{Goal, IkOptions, solve};
//!
//! let robot = cylindroid::load("panda")?;
//! let target = robot.state(&[0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5])?.pose(robot.tool())?;
//! let found = solve(&robot, &[Goal::pose(robot.tool(), target)], &IkOptions::default())?;
//! assert!(found.success && found.position_error < 1e-5);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod acceptance;
mod analytic;
mod ascent;
#[cfg(feature = "sweep")]
mod attempt;
mod avoidance;
mod branches;
mod closed_chain;
mod closed_form;
mod convergence;
mod criterion;
mod goal;
mod goal_rows;
mod half_space_rows;
mod levenberg_marquardt;
mod miss;
mod nearest;
mod options;
mod parallel_restarts;
mod reason;
mod sampling;
mod self_motion;
mod solution;
mod solve;

pub use crate::task::{HalfSpace, Task};
pub use analytic::{Analytic, AnalyticSolution, AnalyticSolutions, ArmGeometry, NotSolvable};
pub use criterion::Criterion;
pub use goal::{Goal, Objective};
pub use options::{Budget, IkOptions};
pub use reason::MissReason;
pub use solution::{FoundBy, Solution};
pub(crate) use solve::ITERATIONS_PER_RESTART;
pub use solve::{Solver, solve, solve_distinct};
