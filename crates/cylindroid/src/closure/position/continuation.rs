//! Continuation: the prescribed coordinates move straight to their goal while the loops stay closed
//! on one branch; the path ends before a singularity or at a limit.
//!
//! Formula  predictor and corrector of `predictor_corrector.rs`; distance = smallest generic
//!          singular value over the largest, of the Jacobian of the loops with respect to the free
//!          coordinates
//! Units    fractions of the path from 0 to 1; distances have none: lengths are divided by the
//!          reach
//! Valid    any mechanism. The distance depends, within a factor, on the choice of loop joints; its
//!          zeros do not. The largest fraction is found by halving steps to [`SHARE_FOUND`]. Limits
//!          of loop joints are not enforced: these joints have no coordinate
//! Source   Allgower & Georg 1990; kinds of singularity as in `singularity_kind.rs`
//! Checked  tests/it/closure/continuation.rs

use std::fmt;

use super::assembly::assemble;
use super::coordinates::{free_places, unit_of};
use super::predictor_corrector::{PathTracker, Point, StepRejected, TrackerStep};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::singularity_kind::SingularityKind;
use crate::error::{Error, Result};
use crate::kinematics::ReferenceFrame;
use crate::model::Mechanism;
use crate::screws::Screw;
use crate::spatial::Twist;
use crate::tolerance::{LEAST_PATH_SINGULAR, PATH_SINGULAR, SHARE_FOUND, VANISHING};

/// Maximum number of steps, rejected ones included.
const MAX_STEPS: usize = 20_000;

/// Options of path tracking.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuationOptions {
    /// Largest change of any coordinate in one step [rad, or characteristic lengths].
    pub step: f64,
    /// Smallest accepted distance to a singularity [-], from 1e-5 to below 1.
    pub least_distance: f64,
}

impl Default for ContinuationOptions {
    fn default() -> Self {
        Self { step: 0.1, least_distance: PATH_SINGULAR }
    }
}

/// A configuration on the path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint {
    /// Fraction of the path, 0 to 1.
    pub fraction: f64,
    /// The configuration, its loops closed.
    pub q: Vec<f64>,
    /// Distance to the nearest singularity, 0 there, at most 1: the smallest generic singular value
    /// over the largest, of the Jacobian of the loops with respect to the free coordinates.
    /// Infinite if there is none to reach.
    pub distance: f64,
}

/// The result of tracking a path.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuationResult {
    /// The last configuration, its loops closed unless the start could not be assembled.
    pub q: Vec<f64>,
    /// Its loop-closure error.
    pub closure_error: LoopClosureError,
    /// Fraction of the path that was tracked, 0 to 1.
    pub fraction: f64,
    /// All configurations on the path, start and end included.
    pub path: Vec<PathPoint>,
    /// Why the path ended.
    pub end: PathEnd,
}

/// Why a path ended.
#[derive(Debug, Clone, PartialEq)]
pub enum PathEnd {
    /// The prescribed coordinates are at their goal.
    Reached,
    /// Beyond this point, a singularity is nearer than the smallest accepted distance: the free
    /// coordinates would no longer follow the prescribed ones.
    Singular(Box<PathSingularity>),
    /// Beyond this point, this coordinate leaves its position limits.
    Limit {
        /// Index into `q`.
        coordinate: usize,
    },
    /// The loops cannot be closed at the start with the prescribed coordinates at their values.
    Open,
    /// The prescribed coordinates contradict each other: there are more of them than degrees of
    /// freedom, and no motion of the others keeps the loops closed.
    Contradiction,
    /// The step length fell below its minimum with no singularity nearby, or the number of steps
    /// was exhausted.
    StepTooSmall,
}

/// The singularity at the end of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSingularity {
    /// Type II if the reference frame gains a motion with the prescribed coordinates at rest,
    /// passive if only other links do; configuration space if the loops lose a constraint, and the
    /// branch meets another.
    pub kind: SingularityKind,
    /// Distance to the singularity at the end of the path [-].
    pub distance: f64,
    /// The motion that is gained, as rates of all coordinates [rad/s or m/s], the prescribed ones
    /// at rest; of unit norm with lengths divided by the characteristic length, its sign arbitrary.
    pub joint_velocities: Vec<f64>,
    /// The twist of the reference frame in this motion: at the frame's origin, world axes.
    pub twist: Twist,
    /// Its screw, in the world; `None` if the reference frame is at rest.
    pub screw: Option<Screw>,
}

impl fmt::Display for PathEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reached => "reached",
            Self::Singular(_) => "singular",
            Self::Limit { .. } => "limit",
            Self::Open => "open",
            Self::Contradiction => "contradiction",
            Self::StepTooSmall => "step-too-small",
        })
    }
}

/// Path tracking by predictor-corrector continuation: moves the `prescribed` coordinates (indices
/// into `q`) from their values in `start` straight to `goal`, while the others keep the loops
/// closed.
///
/// ```text
/// r(h, f) = 0,  h(s) = h0 + s d:   predictor J_f f' = -J_h d,   corrector J_f df = -r
/// step accepted if |J_f' - J_f| <= (s_min + s_min') / 2
/// ```
///
/// h are the prescribed and f the free coordinates, r the residuals of the loops, s_min and s_min'
/// the smallest generic singular values of J_f at both ends of a step, lengths divided by the
/// reach. By Weyl's inequality no singular configuration between two points is passed over. The
/// path stays on the branch of the start, within position limits, and no nearer to a singularity
/// than `options` permit (from a start that is nearer, only away from it).
///
/// Angles move by the difference of their values, full turns included; spherical and free joints,
/// which must be prescribed as a whole, along the screw to their goal. The start is assembled
/// first, with the prescribed coordinates fixed. If free coordinates remain undetermined, they move
/// by the least norm.
///
/// Source: Allgower & Georg 1990, chapters 3 and 6.
///
/// ```
/// use cylindroid::closure::{ContinuationOptions, PathEnd, track_path};
///
/// // The crank of this four-bar (1, 1.8, 1.3 on a base of 2) makes a full turn and returns to
/// // the same assembly mode.
/// let four_bar = cylindroid::load("four-bar")?;
/// let turn = std::f64::consts::TAU;
/// let path = track_path(&four_bar, &[0.0; 3], &[0], &[turn], ContinuationOptions::default())?;
/// assert_eq!(path.end, PathEnd::Reached);
/// assert!((path.q[2]).abs() < 1e-9);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A start or goal of the wrong size or with non-finite values; a prescribed index that is no
/// coordinate or is repeated, or some but not all coordinates of a spherical or free joint; options
/// out of range.
#[doc(alias = "homotopy")]
#[doc(alias = "predictor-corrector")]
#[doc(alias = "continuation")]
pub fn track_path(
    mechanism: &Mechanism,
    start: &[f64],
    prescribed: &[usize],
    goal: &[f64],
    options: ContinuationOptions,
) -> Result<ContinuationResult> {
    mechanism.check_q("start", start)?;
    Error::check_len("goal", prescribed.len(), goal.len())?;
    Error::check_finite("goal", goal)?;
    Error::check_positive("step", options.step)?;
    if !(LEAST_PATH_SINGULAR..1.0).contains(&options.least_distance) {
        return Err(Error::InvalidOption {
            option: "least_distance",
            value: options.least_distance.to_string(),
            reason: format!("it must be from {LEAST_PATH_SINGULAR:e} to below 1"),
        });
    }
    let free = free_places(mechanism, prescribed)?;
    if let Some(i) = (1..prescribed.len()).find(|&i| prescribed[..i].contains(&prescribed[i])) {
        return Err(Error::InvalidOption {
            option: "prescribed",
            value: mechanism.coordinates()[prescribed[i]].name.clone(),
            reason: "it is prescribed twice".to_owned(),
        });
    }
    let assembly = assemble(mechanism, start, prescribed)?;
    if !assembly.closed {
        return Ok(ContinuationResult {
            q: assembly.q,
            closure_error: assembly.closure_error,
            fraction: 0.0,
            path: Vec::new(),
            end: PathEnd::Open,
        });
    }
    let tracker = PathTracker::from(mechanism, &assembly.q, (prescribed, free), goal)?;
    let mut here = tracker.at(&assembly.q)?;
    let mut path = vec![path_point(&tracker, &here, 0.0)];
    let (fraction, end) = walk(&tracker, &mut here, &mut path, options)?;
    Ok(ContinuationResult {
        closure_error: here.closure.closure_error,
        q: here.closure.q,
        fraction,
        path,
        end,
    })
}

fn path_point(tracker: &PathTracker<'_>, point: &Point, fraction: f64) -> PathPoint {
    PathPoint { fraction, q: point.closure.q.clone(), distance: tracker.distance(point) }
}

/// Steps along the branch until it ends: the fraction of the path and the reason.
fn walk(
    tracker: &PathTracker<'_>,
    here: &mut Point,
    path: &mut Vec<PathPoint>,
    options: ContinuationOptions,
) -> Result<(f64, PathEnd)> {
    if tracker.distance(here) < LEAST_PATH_SINGULAR {
        return Ok((0.0, PathEnd::Singular(Box::new(in_sight(tracker, here)?))));
    }
    if let Some(coordinate) = tracker.outside(&here.closure.q) {
        return Ok((0.0, PathEnd::Limit { coordinate }));
    }
    let (mut fraction, mut step) = (0.0, 1.0_f64);
    let (mut tangent, mut possible) = tracker.tangent(here);
    for _ in 0..MAX_STEPS {
        if !possible {
            return Ok((fraction, PathEnd::Contradiction));
        }
        step = step.min(options.step / tracker.speed(&tangent)).min(1.0 - fraction);
        // Exactly to the goal, without the rounding of a sum.
        let to = if step >= 1.0 - fraction { 1.0 } else { fraction + step };
        // From a start that is nearer already, only away.
        let least = options.least_distance.min(tracker.distance(here));
        match tracker.step(here, &tangent, TrackerStep { step, to, least })? {
            Ok(next) => {
                fraction = to;
                *here = next;
                path.push(path_point(tracker, here, fraction));
                if fraction >= 1.0 {
                    return Ok((fraction, PathEnd::Reached));
                }
                (tangent, possible) = tracker.tangent(here);
                step *= 2.0;
            }
            Err(why) => {
                step *= 0.5;
                if step < SHARE_FOUND {
                    let end = match why {
                        StepRejected::Singular => {
                            PathEnd::Singular(Box::new(in_sight(tracker, here)?))
                        }
                        StepRejected::Limit(coordinate) => PathEnd::Limit { coordinate },
                        StepRejected::Far => PathEnd::StepTooSmall,
                    };
                    return Ok((fraction, end));
                }
            }
        }
    }
    Ok((fraction, PathEnd::StepTooSmall))
}

/// The motion that is gained at the singularity.
fn in_sight(tracker: &PathTracker<'_>, point: &Point) -> Result<PathSingularity> {
    let mechanism = tracker.mechanism();
    let distance = tracker.distance(point);
    let (motion, taken) =
        tracker.nearly_free(point).unwrap_or_else(|| (vec![0.0; mechanism.n()], 0.0));
    let rates: Vec<f64> =
        motion.iter().enumerate().map(|(i, x)| x * unit_of(mechanism, i)).collect();
    let state = mechanism.state(&point.closure.q)?;
    let twist = |at| state.twist(&rates, mechanism.reference(), at);
    let (here, world) = (twist(ReferenceFrame::LocalWorldAligned)?, twist(ReferenceFrame::World)?);
    let small = distance.sqrt().max(VANISHING);
    let moves = (here.linear.norm() / mechanism.reach()).hypot(here.angular.norm()) > small;
    let kind = match (taken > small, moves) {
        (false, _) => SingularityKind::ConfigurationSpace,
        (true, true) => SingularityKind::TypeII,
        (true, false) => SingularityKind::Passive,
    };
    let screw = moves.then(|| Screw::of(world)).flatten();
    Ok(PathSingularity { kind, distance, joint_velocities: rates, twist: here, screw })
}
