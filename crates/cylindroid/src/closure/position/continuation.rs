//! Continuation: the held coordinates go straight to their goal, the loops stay closed on the branch
//! where they are, and the way ends before a singularity or at a limit.
//!
//! Formula  predictor and corrector of `predictor_corrector.rs`; distance = smallest singular value that counts
//!          over the largest, of the rates by which the free coordinates open the loops
//! Units    fractions of the way from 0 to 1; distances have none: lengths are over the reach
//! Valid    any mechanism. The distance depends, within a factor, on where the loops are cut; that
//!          it is zero does not. The largest fraction is found by halving steps to [`SHARE_FOUND`].
//!          Limits of loop joints do not count: these joints have no coordinate
//! Source   Allgower & Georg 1990; kinds of singularity as in `singularity_types.rs`
//! Checked  tests/it/closure/continuation.rs

use std::fmt;

use super::assembly::assemble;
use super::coordinates::{free_places, unit_of};
use super::predictor_corrector::{PathTracker, Point, StepRejected, TrackerStep};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::singularity_kind::SingularityKind;
use crate::error::{Error, Result};
use crate::kinematics::ReferenceFrame;
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::screws::Screw;
use crate::spatial::Twist;
use crate::tolerance::{LEAST_PATH_SINGULAR, PATH_SINGULAR, SHARE_FOUND, VANISHING};

/// Steps at most, tried ones included.
const MOST_STEPS: usize = 20_000;

/// How a way is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuationOptions {
    /// Largest change of any coordinate in a step [rad, or reaches].
    pub step: f64,
    /// Least distance to a singularity [-], from 1e-5 to below 1.
    pub least_distance: f64,
}

impl Default for ContinuationOptions {
    fn default() -> Self {
        Self { step: 0.1, least_distance: PATH_SINGULAR }
    }
}

/// A configuration on the tracker.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint {
    /// Of the way, 0 to 1.
    pub fraction: f64,
    /// The configuration, its loops closed.
    pub q: Vec<f64>,
    /// Distance to the next singularity: 0 there, at most 1; infinite where nothing can be lost.
    pub distance: f64,
}

/// What came of following a tracker.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuationResult {
    /// The last configuration, its loops closed unless the start could not be assembled.
    pub q: Vec<f64>,
    /// How far its loops are open.
    pub closure_error: LoopClosureError,
    /// How far it got, 0 to 1.
    pub fraction: f64,
    /// All configurations on the way, start and end included.
    pub path: Vec<PathPoint>,
    /// Why it ended.
    pub end: PathEnd,
}

/// Why a way ended.
#[derive(Debug, Clone, PartialEq)]
pub enum PathEnd {
    /// The held coordinates are at their goal.
    Reached,
    /// Beyond, a singularity is nearer than the least distance: the free coordinates would no longer
    /// follow the held ones.
    Singular(Box<PathSingularity>),
    /// Beyond, this coordinate (place in `q`) leaves its position limits.
    Limit {
        /// Place in `q`.
        coordinate: usize,
    },
    /// The start does not close with the held coordinates where they are.
    Open,
    /// The held coordinates contradict each other: there are more of them than degrees of freedom,
    /// and no motion of the others keeps the loops closed.
    Contradiction,
    /// The steps shrank to nothing without a singularity in sight, or were too many.
    StepTooSmall,
}

/// A singularity in sight.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSingularity {
    /// Type II where the reference frame gains a motion while the held coordinates rest, passive
    /// where only other links do; configuration space where the loops lose a constraint, and the
    /// branch meets another.
    pub kind: SingularityKind,
    /// Distance where the way ended [-].
    pub distance: f64,
    /// The motion that is gained, as rates of all coordinates [rad/s or m/s], the held ones at rest;
    /// of length one with lengths over the reach, its sign open.
    pub rates: Vec<f64>,
    /// The twist of the reference frame in it: at the frame's origin, world axes.
    pub twist: Twist,
    /// Its screw, in the world; `None` where the reference frame rests.
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

/// Moves the coordinates `held` from their values in `start` straight to `goal`, the others keeping
/// the loops closed: on the branch where they are, within position limits, and no nearer to a
/// singularity than the options say (from a start that is nearer, only away from it). Angles go the
/// way that the numbers say, whole turns too; spherical and free joints, which are held as a whole,
/// by the screw to their goal.
///
/// The start is assembled first, the held coordinates resting. Where they leave motions free, the
/// others move by the least. The path keeps its branch by steps in which the rates of the loops
/// change by no more than half their smallest singular value: no singular pose between two points
/// is passed over.
///
/// ```
/// use cylindroid::closure::{ContinuationOptions, PathEnd, track_path};
///
/// // The crank of this four-bar (1, 1.8, 1.3 on a base of 2) goes all the way round, and back to
/// // the same mode.
/// let four_bar = cylindroid::load("four-bar")?;
/// let turn = std::f64::consts::TAU;
/// let way = track_path(&four_bar, &[0.0; 3], &[0], &[turn], ContinuationOptions::default())?;
/// assert_eq!(tracker.end, PathEnd::Reached);
/// assert!((tracker.q[2]).abs() < 1e-9);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A start or goal of the wrong size or not finite; a held place that is no coordinate, is named
/// twice, or is one of a spherical or free joint that is not held as a whole; options out of range.
pub fn track_path(
    mechanism: &Mechanism,
    start: &[f64],
    held: &[usize],
    goal: &[f64],
    options: ContinuationOptions,
) -> Result<ContinuationResult> {
    mechanism.check_q("start", start)?;
    Error::check_len("goal", held.len(), goal.len())?;
    Error::check_finite("goal", goal)?;
    Error::check_positive("step", options.step)?;
    if !(LEAST_PATH_SINGULAR..1.0).contains(&options.least_distance) {
        return Err(Error::InvalidOption {
            option: "least_distance",
            value: options.least_distance.to_string(),
            reason: format!("it is from {LEAST_PATH_SINGULAR:e} to below 1"),
        });
    }
    let free = free_places(mechanism, held)?;
    if let Some(i) = (1..held.len()).find(|&i| held[..i].contains(&held[i])) {
        return Err(Error::InvalidOption {
            option: "held",
            value: mechanism.coordinates()[held[i]].name.clone(),
            reason: "it is named twice".to_owned(),
        });
    }
    let assembly = assemble(mechanism, start, held)?;
    if !assembly.closed {
        return Ok(ContinuationResult {
            q: assembly.q,
            closure_error: assembly.closure_error,
            fraction: 0.0,
            path: Vec::new(),
            end: PathEnd::Open,
        });
    }
    let tracker = PathTracker::from(mechanism, &assembly.q, (held, free), goal)?;
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

/// Steps along the branch until it ends: the fraction of the way and why.
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
    for _ in 0..MOST_STEPS {
        if !possible {
            return Ok((fraction, PathEnd::Contradiction));
        }
        step = step.min(options.step / tracker.speed(&tangent)).min(1.0 - fraction);
        // To the goal itself, without the rounding of a sum.
        let to = if step >= 1.0 - fraction { 1.0 } else { fraction + step };
        // From where it is already nearer, only away.
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

/// The motion that is gained where the distance falls to zero.
fn in_sight(tracker: &PathTracker<'_>, point: &Point) -> Result<PathSingularity> {
    let mechanism = tracker.mechanism();
    let distance = tracker.distance(point);
    let (motion, taken) =
        tracker.nearly_free(point).unwrap_or_else(|| (vec![0.0; mechanism.n()], 0.0));
    let rates: Vec<f64> =
        motion.iter().enumerate().map(|(i, x)| x * unit_of(mechanism, i)).collect();
    let state = mechanism.state(&point.closure.q)?;
    let twist = |at: ReferenceFrame| {
        let jacobian: Matrix = state.jacobian(mechanism.reference(), at);
        let of = jacobian.mul_vec(&rates);
        Twist::from_array(std::array::from_fn(|i| of[i]))
    };
    let (here, world) = (twist(ReferenceFrame::LocalWorldAligned), twist(ReferenceFrame::World));
    let small = distance.sqrt().max(VANISHING);
    let moves = (here.linear.norm() / mechanism.reach()).hypot(here.angular.norm()) > small;
    let kind = match (taken > small, moves) {
        (false, _) => SingularityKind::ConfigurationSpace,
        (true, true) => SingularityKind::TypeII,
        (true, false) => SingularityKind::Passive,
    };
    let screw = moves.then(|| Screw::of(world)).flatten();
    Ok(PathSingularity { kind, distance, rates, twist: here, screw })
}
