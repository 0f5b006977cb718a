//! `move`: moves a frame to a target and reports whether and how it was reached.

mod bounds;
mod idle;
pub(crate) mod inverse;
mod job;
mod joints;
mod report;
pub(crate) mod sentences;
mod tasks;
mod twist;
mod twist_goal;
mod waypoint_columns;
mod waypoints;

use std::io::Write;

use cylindroid::Servo;
use cylindroid::closure::LoopClosureError;
use cylindroid::control::{
    JointMove, MotionResult, Stall, Status, Target, TrajectorySample, find_reachable_configuration,
    simulate,
};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use self::job::{Goal, Job};
use self::report::{Deviation, Result, Way};
pub(crate) use self::tasks::load_tasks;
use crate::args::MoveArgs;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::plot;
use crate::trajectory::{self, Trajectory};

/// Restarts of the search for another configuration after a stall: sufficient in all tests, about
/// a second at worst.
const MAX_RESTARTS: usize = 200;
/// Steps between two progress messages.
const PROGRESS_STEPS: u64 = 256;

pub(crate) fn run(args: &MoveArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    if tasks::are_asked_for(args) {
        return tasks::run(args, style, out);
    }
    if let Some(option) = args.tasks.without_effect() {
        anyhow::bail!("{option} has no effect without --avoid or --obstacle");
    }
    if args.tasks.least_squares {
        anyhow::bail!(
            "--least-squares has no effect on the servo of one frame: add --tasks, --task \
             FRAME=..., --avoid or --obstacle"
        );
    }
    let job = Job::new(args)?;
    let format = args.out.as_deref().map(trajectory::format_of).transpose()?;
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }

    let keep = args.out.is_some() || args.plot.is_some();
    let mut trajectory = keep.then(|| Trajectory::new(&job.robot, &job.frame));
    let result = perform(&job, trajectory.as_mut())?;
    if let Some(trajectory) = &trajectory {
        if let (Some(path), Some(format)) = (&args.out, format) {
            trajectory.write(path, format)?;
        }
        if let Some(path) = &args.plot {
            plot::draw(trajectory, path)?;
        }
    }

    report::write(&job, &result, style, out)?;
    Ok(Exit::answer(result.outcome.reached))
}

/// Runs the motion.
fn perform(job: &Job, mut trajectory: Option<&mut Trajectory>) -> anyhow::Result<Result> {
    let mut servo = Servo::new(&job.robot, job.options.clone())?;
    let turns = job.options.task.components[3..].contains(&true);
    let mut deviation: Option<Deviation> = None;
    let mut closure_error: Option<LoopClosureError> = None;
    let progress = Progress::new(job.time_limit);
    let mut observe = |sample: TrajectorySample<'_>| {
        progress.show(&sample);
        if job.robot.is_closed()
            && let Ok(now) =
                job.robot.state(sample.q).and_then(|state| LoopClosureError::of(&state))
        {
            let most = closure_error.get_or_insert_default();
            most.distance = most.distance.max(now.distance);
            most.angle = most.angle.max(now.angle);
        }
        if let Goal::Along(motion) = &job.goal {
            let now = motion.path().deviation(sample.step.pose);
            let most = deviation.get_or_insert_default();
            most.position = most.position.max(now.position);
            if turns {
                let before = most.orientation.unwrap_or(0.0);
                most.orientation = Some(before.max(now.orientation));
            }
        }
        if let Some(trajectory) = &mut trajectory {
            trajectory.push(&sample);
        }
    };
    let dt = job.options.dt;
    let outcome = match &job.goal {
        Goal::Pose(pose) => {
            let target = |_| (Target::from(*pose), true);
            simulate(&mut servo, &job.start, job.time_limit, target, &mut observe)?
        }
        Goal::Along(motion) => {
            let target = |t| (motion.target(t, dt), t >= motion.law().duration());
            simulate(&mut servo, &job.start, job.time_limit, target, &mut observe)?
        }
        Goal::Waypoints(motion) => {
            let target = |t| (motion.target(t, dt), t >= motion.duration());
            simulate(&mut servo, &job.start, job.time_limit, target, &mut observe)?
        }
        Goal::Joints(motion) => joints::simulate(&mut servo, job, motion, &mut observe)?,
        Goal::Twist(goal) => twist::simulate(&mut servo, job, goal, &mut observe)?,
    };
    drop(progress);
    let direct = |way| Ok(Result { outcome: outcome.clone(), deviation, closure_error, way });
    let Some(configuration) = other_configuration(job, &servo, &outcome)? else {
        return direct(Way::Direct);
    };
    if !job.reconfigure {
        return direct(Way::Offered { configuration });
    }
    // Again from the start, straight through joint space: the stalled motion is not executed.
    let motion = JointMove::within_limits(&job.robot, &job.start, &configuration, &job.defaults)?
        .within_tool_speed(&job.robot, job.options.end_effector, job.options.speed)?;
    if let Some(trajectory) = &mut trajectory {
        trajectory.clear();
    }
    let push = |sample: TrajectorySample<'_>| {
        if let Some(trajectory) = &mut trajectory {
            trajectory.push(&sample);
        }
    };
    let outcome_of_joints = joints::simulate_with_plant(&mut servo, job, &motion, push)?;
    Ok(Result {
        outcome: outcome_of_joints,
        deviation: None,
        closure_error: None,
        way: Way::Reconfigured { stalled: outcome.into() },
    })
}

/// A configuration that reaches the target at which the servo stalled, if one is found.
fn other_configuration(
    job: &Job,
    servo: &Servo,
    outcome: &MotionResult,
) -> cylindroid::Result<Option<Vec<f64>>> {
    let stalled = outcome.stall.is_some()
        && outcome.last.status == Status::Stalled
        && !matches!(job.goal, Goal::Twist(_));
    // A proof that there is none, and the choice of an inverse by the user, are final.
    let final_word = matches!(outcome.stall, Some(Stall::OutOfReach { .. } | Stall::NoInverse(_)));
    if !stalled || final_word {
        return Ok(None);
    }
    let found = find_reachable_configuration(servo, &job.start, job.target_pose, MAX_RESTARTS)?;
    Ok(found.map(|found| found.q))
}

/// A progress line on stderr, if stderr is a terminal.
#[derive(Debug)]
struct Progress(ProgressBar);

impl Progress {
    fn new(time_limit: f64) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}") {
            bar.set_style(style);
        }
        bar.set_message(format!("moving, at most {time_limit} s"));
        Self(bar)
    }

    fn show(&self, sample: &TrajectorySample<'_>) {
        self.0.inc(1);
        if self.0.position().is_multiple_of(PROGRESS_STEPS) && !self.0.is_hidden() {
            self.0.set_message(format!(
                "{:.2} s, position error {:.1e} m, orientation error {:.1e} rad",
                sample.time, sample.step.position_error, sample.step.orientation_error
            ));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
